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

/// How far from the box around the slave's faces a rim may come near them, as a part of its diagonal: bodies move as well.
const NEAR: f64 = 0.5;
/// Places of a motion that are looked at, besides its kinks.
const PLACES: usize = 64;

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

    /// Whether edges of rigid surfaces are slaves of any contact.
    pub fn has_rims(&self) -> bool {
        self.pairs.iter().any(|pair| self.of_rims(pair))
    }
}

/// The surroundings of a slave: its box, and as much around it as it may move.
#[derive(Debug, Clone)]
struct Near {
    low: Vec3,
    high: Vec3,
}

impl Near {
    /// Around places of the slave's nodes, where contact begins at `offset` (length).
    fn new(places: impl Iterator<Item = Vec3>, offset: f64) -> Self {
        let start = [f64::INFINITY, f64::NEG_INFINITY].map(Vec3::repeat);
        let [low, high] = places.fold(start, |[low, high], x| [low.inf(&x), high.sup(&x)]);
        let grown = Vec3::repeat(NEAR * (high - low).norm() + offset);
        Near {
            low: low - grown,
            high: high + grown,
        }
    }

    /// Whether a place is in it.
    fn holds(&self, x: &Point3<f64>) -> bool {
        (0..3).all(|c| self.low[c] <= x[c] && x[c] <= self.high[c])
    }
}

/// Where the motion of a surface that ends at the time `end` puts it, at the start first.
///
/// # Errors
/// A motion without a value at some time.
fn poses(surface: &SurfaceModel, end: f64) -> Result<Vec<Isometry3<f64>>, ValueError> {
    let even = (0..=PLACES).map(|i| end * i as f64 / PLACES as f64);
    let functions = surface.motion.functions();
    let kinks = functions.flat_map(|f| f.breakpoints());
    let times = even.chain(kinks.filter(|t| (0.0..=end).contains(t)));
    times.map(|t| surface.motion.pose(t)).collect()
}

/// The faces of a slave where they start.
pub struct SlaveFaces<'a> {
    pub facets: &'a MovingFacets,
    /// Places of its nodes in the model.
    pub position: &'a dyn Fn(u32) -> Vec3,
    /// Size of the elements (length).
    pub size: f64,
    /// Where contact begins in front of the other side (length).
    pub offset: f64,
}

/// Points on the rims of a surface, in its own coordinates, with the length of rim around each: those that its motion until the time
/// `end` brings near the slave, without those that are flush with the border of the slave's faces at the start.
///
/// # Errors
/// A motion without a value at some time.
pub fn points(
    surface: &SurfaceModel,
    slave: &SlaveFaces,
    end: f64,
) -> Result<Vec<(RimPoint, f64)>, ValueError> {
    let nodes = (0..slave.facets.len() as u32).flat_map(|f| slave.facets.nodes(f));
    let near = Near::new(nodes.map(|n| (slave.position)(*n)), slave.offset);
    let poses = poses(surface, end)?;
    let comes_near = |p: &RimPoint| {
        let x = Point3::from(p.x);
        poses.iter().any(|pose| near.holds(&(pose * x)))
    };
    let flush = |p: &RimPoint| {
        let at = (poses[0] * Point3::from(p.x)).coords;
        edges::flush_with(&at, &(poses[0] * p.along), slave.facets, slave.size)
    };
    let rims = with_patches!(&surface.set, set => set.rims(ANGLE, SPACING * slave.size));
    Ok((rims.iter())
        .flat_map(|rim| rim.points.iter().map(|p| (*p, rim.piece)))
        .filter(|(p, _)| comes_near(p) && !flush(p))
        .collect())
}
