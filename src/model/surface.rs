//! Rigid surfaces: exact patches or facets, their motion and their depth.
use super::driven::Driven;
use super::motion::Motion;
use crate::contact::closest::ClosestPoint;
use crate::contact::rigid::RigidMaster;
use crate::scene::{FacetKind, ValueError};
use covact_geometry::project::{ComponentSide, EdgeReport, SideError};
use covact_geometry::{Bilinear, Biquadratic, Foot, Frame, Hint, Jet, NurbsPatch, PatchSet, Vec3};

/// A rigid surface.
#[derive(Debug)]
pub struct SurfaceModel {
    /// Name in the scene.
    pub name: String,
    /// Patches or facets in the scene's length unit and the surface's own coordinates.
    pub set: SurfaceSet,
    /// How facets stand for an exact surface; none where the patches are used as they are.
    pub facets: Option<FacetModel>,
    /// How it moves over time.
    pub motion: Motion,
    /// What forces drive of its motion.
    pub driven: Option<Driven>,
    /// Depth below which a point does not count (length).
    pub depth: f64,
}

/// Facets in place of an exact surface, or the triangles of a file.
#[derive(Debug, Clone, PartialEq)]
pub struct FacetModel {
    /// The kind of facets.
    pub kind: FacetKind,
    /// Number of facets.
    pub count: usize,
    /// Largest distance of a facet from the exact surface at the points measured (length); none for triangles of a
    /// file, which know of no other surface.
    pub chord: Option<f64>,
    /// Smallest radii of curvature of the exact surface where `rho_1 x rho_2` finds it convex and hollow; none where it
    /// is nowhere so, or not known.
    pub radii: [Option<f64>; 2],
    /// Patch of the exact surface that each facet is cut from, or triangle of the file.
    pub origin: Vec<u32>,
}

/// Bytes of a facet with its place in the search; of a patch of a CAD file where there are no facets.
pub fn facet_bytes(kind: Option<FacetKind>) -> u64 {
    match kind {
        Some(FacetKind::Bilinear) => 1_000,
        Some(FacetKind::Biquadratic) => 2_000,
        Some(FacetKind::Smooth) => 6_000,
        None => 20_000,
    }
}

/// Patches of one kind: what runs over points is compiled for each, and the choice is made outside (see
/// `with_patches`).
#[derive(Debug)]
pub enum SurfaceSet {
    /// Exact patches, or the bicubic ones of a smooth surface over facets.
    Nurbs(PatchSet<NurbsPatch>),
    /// Facets of four nodes.
    Bilinear(PatchSet<Bilinear>),
    /// Facets of nine nodes.
    Biquadratic(PatchSet<Biquadratic>),
}

/// Evaluates an expression with the patches of a [`SurfaceSet`], compiled once for each kind.
macro_rules! with_patches {
    ($set:expr, $patches:ident => $then:expr) => {
        match $set {
            $crate::model::surface::SurfaceSet::Nurbs($patches) => $then,
            $crate::model::surface::SurfaceSet::Bilinear($patches) => $then,
            $crate::model::surface::SurfaceSet::Biquadratic($patches) => $then,
        }
    };
}
pub(crate) use with_patches;

impl ClosestPoint for SurfaceSet {
    fn project(&self, q: &Vec3, hint: Option<Hint>, reach: f64) -> Option<Foot> {
        with_patches!(self, s => s.project(q, hint, reach))
    }

    fn project_above(&self, q: &Vec3, hint: Option<Hint>, reach: f64, above: f64) -> Option<Foot> {
        with_patches!(self, s => s.project_above(q, hint, reach, above))
    }

    fn project_on(&self, q: &Vec3, on: Hint, beyond: f64) -> Option<Foot> {
        with_patches!(self, s => s.project_on(q, on, beyond))
    }

    fn edge_derivatives(&self, patch: u32, edge: u32, xi: [f64; 2]) -> Option<[Vec3; 2]> {
        with_patches!(self, s => s.edge_derivatives(patch, edge, xi))
    }

    fn normal_along(&self, foot: &Foot, along: &Vec3) -> Vec3 {
        with_patches!(self, s => s.normal_along(foot, along))
    }

    fn pole_jet(&self, foot: &Foot, q: &Vec3) -> Option<Jet> {
        with_patches!(self, s => s.pole_jet(foot, q))
    }

    fn size(&self) -> f64 {
        with_patches!(self, s => s.size())
    }
}

impl SurfaceSet {
    /// Number of patches or facets.
    pub fn count(&self) -> usize {
        self.sides().len()
    }

    /// Lowest and highest corner of a box around the surface.
    pub fn bounds(&self) -> [Vec3; 2] {
        with_patches!(self, s => s.bounds())
    }

    /// What was found about the edges.
    pub fn edges(&self) -> &EdgeReport {
        with_patches!(self, s => s.edges())
    }

    /// Patches of every connected component.
    pub fn components(&self) -> &[Vec<usize>] {
        with_patches!(self, s => s.components())
    }

    /// Side of every patch; see [`PatchSet::sides`].
    pub fn sides(&self) -> &[f64] {
        with_patches!(self, s => s.sides())
    }

    /// See [`PatchSet::set_side_as_given`].
    pub fn set_side_as_given(&mut self, reversed: bool) {
        with_patches!(self, s => s.set_side_as_given(reversed))
    }

    /// See [`PatchSet::set_component_side`].
    pub fn set_component_side(&mut self, component: usize, side: f64) {
        with_patches!(self, s => s.set_component_side(component, side))
    }

    /// See [`PatchSet::set_sides_outward`].
    ///
    /// # Errors
    /// A component that has no outward side.
    pub fn set_sides_outward(&mut self, inward: bool) -> Result<(), usize> {
        with_patches!(self, s => s.set_sides_outward(inward))
    }

    /// See [`PatchSet::orient_towards`].
    ///
    /// # Errors
    /// Points on both sides of a component.
    pub fn orient_towards(&mut self, points: &[Vec3]) -> Result<Vec<ComponentSide>, SideError> {
        with_patches!(self, s => s.orient_towards(points))
    }
}

impl SurfaceModel {
    /// Number of polynomial pieces: spans of patches, or facets.
    pub fn pieces(&self) -> usize {
        match &self.set {
            SurfaceSet::Nurbs(set) => {
                let spans = |p: &NurbsPatch| p.spans(0).len() * p.spans(1).len();
                set.patches().iter().map(spans).sum()
            }
            other => other.count(),
        }
    }

    /// Smallest radius of curvature at a point, either way; infinite where it is flat, and zero where that is not known.
    pub fn radius_at(&self, hint: Hint) -> f64 {
        let SurfaceSet::Nurbs(set) = &self.set else {
            return 0.0;
        };
        let patch = set.patches().get(hint.patch as usize);
        let frame = patch.and_then(|patch| Frame::new(&patch.jet(hint.xi), 1.0));
        frame.map_or(0.0, |frame| {
            let [low, high] = frame.principal_curvatures();
            low.abs().max(high.abs()).recip()
        })
    }

    /// Smallest convex radius of those pieces of the patches for whose boxes `counts` holds.
    pub fn convex_radius_of(&self, counts: impl Fn(&[Vec3; 2]) -> bool) -> Option<f64> {
        let range = with_patches!(&self.set, s => s.curvature_range_of(&counts));
        range.convex.map(|c| c.radius())
    }

    /// The surface at its position of time `t` and, where forces drive it, of the displacements `u` of the system.
    pub fn at(&self, t: f64, u: &[f64]) -> Result<RigidMaster<'_, SurfaceSet>, ValueError> {
        Ok(RigidMaster {
            surface: &self.set,
            pose: self.pose(t, u)?,
            depth: self.depth,
            keep: true,
        })
    }

    /// Smallest radius of curvature where the surface bulges towards the slave, and where it is hollow; none: nowhere,
    /// or not known.
    pub fn radii(&self) -> [Option<f64>; 2] {
        let Some(facets) = &self.facets else {
            let range = with_patches!(&self.set, s => s.curvature_range());
            return [range.convex, range.concave].map(|c| c.map(|c| c.radius()));
        };
        let [convex, concave] = facets.radii;
        let turned = self.set.sides().iter().filter(|s| **s < 0.0).count();
        match turned {
            0 => [convex, concave],
            n if n == self.set.count() => [concave, convex],
            // Some parts are turned round, others not: what is convex and what hollow is not known, so both may be.
            _ => {
                let smaller = [convex, concave].into_iter().flatten().reduce(f64::min);
                [smaller; 2]
            }
        }
    }
}
