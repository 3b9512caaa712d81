//! Rigid surfaces in pieces for output.
use crate::model::Model;
use crate::model::surface::{SurfaceModel, SurfaceSet};
use crate::output::SurfacePiece;
use crate::scene::FacetKind;
use covact_geometry::{BezierPiece, PatchSet, Surface, Vec3};

/// Quadrilaterals of the flat copy of a whole surface of curved facets, roughly and at most.
const FLAT: f64 = 2e4;

/// The surface in exact pieces, whose degree is that of the patches or facets. In the flat copy whole patches have as many
/// quadrilaterals as their curvature asks for, `tessellation` a side of a piece at most; facets, which are small, get fewer, and
/// bilinear ones are their own flat copy.
pub(super) fn pieces(
    surface: &SurfaceModel,
    tessellation: u32,
    model: &Model,
) -> Vec<SurfacePiece> {
    let sides = surface.set.sides();
    if let (SurfaceSet::Nurbs(set), None) = (&surface.set, &surface.facets) {
        let of = |(i, p)| SurfacePiece::of_patch(p, i as u32, i as u32, sides[i] < 0.0);
        let mut patches: Vec<_> = set.patches().iter().enumerate().map(of).collect();
        let tolerance = flat_within(patches.iter().flatten(), model);
        for (pieces, patch) in patches.iter_mut().zip(set.patches()) {
            // Those along trim curves have their own.
            if patch.trim().is_none() {
                let columns = patch.basis(0).span_count();
                SurfacePiece::divide(pieces, columns, tolerance, tessellation);
            }
        }
        return patches.into_iter().flatten().collect();
    }
    let divisions = surface.facets.as_ref().map(|facets| {
        if facets.kind == FacetKind::Bilinear {
            return [1; 2];
        }
        let share = (FLAT / facets.count.max(1) as f64).sqrt() as u32;
        [share.clamp(2, tessellation.max(2)); 2]
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

/// Share of the size of what is looked at by which a flat copy may be off: a fifth of a pixel in a picture of 1000.
const OFF: f64 = 2e-4;

/// How far the flat copy of a surface in these pieces may lie off it (length), by its own size or that of the bodies, whichever is
/// smaller: of a large tool a small part may be all that they touch.
fn flat_within<'a>(pieces: impl Iterator<Item = &'a SurfacePiece>, model: &Model) -> f64 {
    let points = pieces.flat_map(|piece| &piece.points);
    let own = diagonal(points.map(|[x, y, z, w]| Vec3::new(*x, *y, *z) / *w));
    let bodies = diagonal(model.nodes.iter().copied());
    OFF * own.min(bodies)
}

/// Diagonal of the box around some points.
fn diagonal(points: impl Iterator<Item = Vec3>) -> f64 {
    let none = [
        Vec3::from_element(f64::INFINITY),
        Vec3::from_element(f64::NEG_INFINITY),
    ];
    let [low, high] = points.fold(none, |[low, high], x| [low.inf(&x), high.sup(&x)]);
    (high - low).norm()
}

/// Bezier pieces of all patches with the number of the patch.
fn beziers<S: Surface>(set: &PatchSet<S>) -> impl Iterator<Item = (usize, BezierPiece)> {
    (set.patches().iter().enumerate())
        .flat_map(|(i, p)| p.bezier_pieces().into_iter().map(move |b| (i, b)))
}
