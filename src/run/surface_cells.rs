//! Rigid surfaces in pieces for output.
use crate::model::surface::{SurfaceModel, SurfaceSet};
use crate::output::SurfacePiece;
use crate::scene::FacetKind;
use covact_geometry::{BezierPiece, PatchSet, Surface};

/// Quadrilaterals of the flat copy of a whole surface of curved facets, roughly and at most.
const FLAT: f64 = 2e4;

/// The surface in exact pieces, whose degree is that of the patches or facets. `tessellation` quadrilaterals a side are
/// asked for in the flat copy; facets, which are small, get fewer, and bilinear ones are their own flat copy.
pub(super) fn pieces(surface: &SurfaceModel, tessellation: u32) -> Vec<SurfacePiece> {
    let sides = surface.set.sides();
    if let (SurfaceSet::Nurbs(set), None) = (&surface.set, &surface.facets) {
        let patches = set.patches().iter().enumerate();
        return patches
            .flat_map(|(i, p)| SurfacePiece::of_patch(p, i as u32, i as u32, sides[i] < 0.0))
            .collect();
    }
    let divisions = surface.facets.as_ref().map(|facets| {
        if facets.kind == FacetKind::Bilinear {
            return 1;
        }
        let share = (FLAT / facets.count.max(1) as f64).sqrt() as u32;
        share.clamp(2, tessellation.max(2))
    });
    let origin = |i: usize| {
        let facets = surface.facets.as_ref();
        facets.and_then(|f| f.origin.get(i)).map_or(0, |o| *o)
    };
    let piece = |(i, bezier): (usize, BezierPiece)| SurfacePiece {
        degree: bezier.degree,
        points: bezier.points,
        patch: i as u32,
        entity: origin(i),
        reversed: sides[i] < 0.0,
        divisions,
    };
    match &surface.set {
        SurfaceSet::Nurbs(set) => beziers(set).map(piece).collect(),
        SurfaceSet::Bilinear(set) => beziers(set).map(piece).collect(),
        SurfaceSet::Biquadratic(set) => beziers(set).map(piece).collect(),
    }
}

/// Bezier pieces of all patches with the number of the patch.
fn beziers<S: Surface>(set: &PatchSet<S>) -> impl Iterator<Item = (usize, BezierPiece)> {
    (set.patches().iter().enumerate())
        .flat_map(|(i, p)| p.bezier_pieces().into_iter().map(move |b| (i, b)))
}
