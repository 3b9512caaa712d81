//! Which parts of a rigid surface a body can come to.
use super::{Model, PairModel, SurfaceModel};
use covact_geometry::Vec3;
use nalgebra::{Isometry3, Point3};

/// Intervals of the run between which motions are sampled, beside the kinks: at least, and at most where a surface turns.
const INTERVALS: [usize; 2] = [64, 1024];

/// Turn of a surface between two samples, up to the most intervals (degrees).
const TURN: f64 = 10.0;

/// Smallest convex radius of what the slave of a pair can come to of a rigid surface: pieces that pass its body, as it starts, at
/// a distance below its size, and below what moves it in addition. Of the whole surface where the motion of either is not
/// prescribed, and of facets, whose radii are not known one by one: `smallest`.
pub fn convex_radius(
    model: &Model,
    (pair, surface): (&PairModel, &SurfaceModel),
    smallest: f64,
    end: f64,
) -> Option<f64> {
    match Region::new(model, pair, surface, end) {
        Some(region) if surface.facets.is_none() => {
            surface.convex_radius_of(|[low, high]| region.meets(low, high))
        }
        _ => Some(smallest),
    }
}

/// Where a body may be, and how a surface moves.
struct Region {
    bounds: [Vec3; 2],
    /// Largest distance at which a surface counts.
    margin: f64,
    poses: Vec<Isometry3<f64>>,
}

impl Region {
    /// None where motions are not prescribed.
    fn new(model: &Model, pair: &PairModel, surface: &SurfaceModel, end: f64) -> Option<Region> {
        let mut all = model.surfaces.iter();
        if model.dynamics.is_some() || all.any(|s| s.driven.is_some()) {
            return None;
        }
        let turn = surface.motion.turn(0.0, end).ok()?.abs();
        let intervals = ((turn / TURN) as usize).clamp(INTERVALS[0], INTERVALS[1]);
        let even = (0..=intervals).map(|i| end * i as f64 / intervals as f64);
        let mut times: Vec<f64> = even.chain(model.kinks.iter().copied()).collect();
        times.sort_by(f64::total_cmp);
        let poses = |surface: &SurfaceModel| -> Option<Vec<Isometry3<f64>>> {
            times.iter().map(|t| surface.motion.pose(*t).ok()).collect()
        };
        // What carries the body along: its supports, and other tools.
        let mut way = 0.0f64;
        let body = &model.bodies[pair.body];
        let [first, nodes] = [body.first_node, body.mesh.nodes.len() as u32];
        let zero = vec![0.0; 3 * model.nodes.len()];
        let own = |dof: u32| (first..first + nodes).contains(&(dof / 3));
        for support in model.supports().filter(|s| s.moves() && own(s.dofs[0])) {
            for t in &times {
                way = way.max(support.missing(&zero, *t).ok()?.abs());
            }
        }
        for other in &model.surfaces {
            if !std::ptr::eq(other, surface) {
                let [low, high] = other.set.bounds();
                let middle = Point3::from(0.5 * (low + high));
                let places = poses(other)?;
                let moved = places.iter().map(|p| p * middle - places[0] * middle);
                way = moved.fold(way, |way, moved| way.max(moved.norm()));
            }
        }
        let bounds = body.mesh.bounds();
        Some(Region {
            bounds,
            margin: (bounds[1] - bounds[0]).norm() + way,
            poses: poses(surface)?,
        })
    }

    /// Whether a piece of the surface, in a box of the surface's own coordinates, ever comes within the margin.
    fn meets(&self, low: &Vec3, high: &Vec3) -> bool {
        let middle = Point3::from(0.5 * (low + high));
        let reach = self.margin + 0.5 * (high - low).norm();
        let places: Vec<Vec3> = self.poses.iter().map(|p| (p * middle).coords).collect();
        // Between two samples it is near the line that joins them.
        places.windows(2).any(|w| {
            let [from, to] = [w[0].inf(&w[1]), w[0].sup(&w[1])];
            let apart = (self.bounds[0] - to).sup(&(from - self.bounds[1]));
            apart.sup(&Vec3::zeros()).norm() <= reach
        })
    }
}
