//! Rims of rigid surfaces, their sharp convex edges and free borders, as slaves. Between two slave points such a line sinks into
//! the slave's faces unseen, and those beside it pass by. Nodes on it, which move with the surface and have no unknowns, are slave
//! points once more, with the slave's faces as their master.
use super::surface::with_patches;
use super::{Model, PairModel, SurfaceModel, edges};
use crate::scene::ValueError;
use covact_geometry::project::RimPoint;
use covact_geometry::{MovingFacets, Vec3};
use nalgebra::{Isometry3, Point3};

/// Angle between the normals of both sides above which an edge is sharp (radians), as where edges are told ([`super::sharp`]).
const ANGLE: f64 = 0.5;
/// Distance of neighbouring nodes on a rim, as a part of the slave's elements: every element that it crosses has two.
const SPACING: f64 = 0.5;

/// Nodes of the model on the rims of a rigid surface.
#[derive(Debug, Clone)]
pub struct RimNodes {
    /// Number of the surface.
    pub surface: usize,
    /// Number of the first of them in the model; the others follow.
    pub first_node: u32,
    /// Where they are in the surface's own coordinates.
    pub points: Vec<Vec3>,
}

impl RimNodes {
    /// Their degrees of freedom, which nothing is solved for.
    pub fn dofs(&self) -> impl Iterator<Item = u32> {
        let first = 3 * self.first_node;
        first..first + 3 * self.points.len() as u32
    }
}

impl Model {
    /// Number of nodes on rims of rigid surfaces.
    pub fn rim_nodes(&self) -> usize {
        self.rims.iter().map(|rim| rim.points.len()).sum()
    }

    /// Puts the nodes on rims to where their surfaces are at `time`.
    ///
    /// # Errors
    /// A motion without a value at that time.
    pub fn move_rims(&self, u: &mut [f64], time: f64) -> Result<(), ValueError> {
        for rim in &self.rims {
            let pose = self.surfaces[rim.surface].pose(time, u)?;
            for (node, x) in (rim.first_node as usize..).zip(&rim.points) {
                let moved = (pose * Point3::from(*x)).coords - self.nodes[node];
                u[3 * node..3 * node + 3].copy_from_slice(moved.as_slice());
            }
        }
        Ok(())
    }

    /// Whether a pair is contact between bodies.
    pub fn between_bodies(&self, pair: &PairModel) -> bool {
        pair.body_master().is_some() && !self.of_rims(pair)
    }

    /// Whether the slave points of a pair are on the rims of a rigid surface.
    pub fn of_rims(&self, pair: &PairModel) -> bool {
        let of = pair.edges_of.map(|of| &self.pairs[of]);
        of.is_some_and(|of| of.rigid_master().is_some())
    }
}

/// Points on the rims of a surface, in its own coordinates, with the length of rim around each; without those that are flush with
/// the border of the slave's faces where `pose` puts them. `slave`: these faces at the start; `size`: that of their elements
/// (length).
pub fn points(
    surface: &SurfaceModel,
    pose: &Isometry3<f64>,
    slave: &MovingFacets,
    size: f64,
) -> Vec<(RimPoint, f64)> {
    let rims = with_patches!(&surface.set, set => set.rims(ANGLE, SPACING * size));
    let flush = |p: &RimPoint| {
        let at = (pose * Point3::from(p.x)).coords;
        edges::flush_with(&at, &(pose * p.along), slave, size)
    };
    (rims.iter())
        .flat_map(|rim| rim.points.iter().map(|p| (*p, rim.piece)))
        .filter(|(p, _)| !flush(p))
        .collect()
}
