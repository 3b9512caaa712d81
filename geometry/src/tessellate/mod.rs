//! Triangles that follow a set of patches within a tolerance, trims included.
//!
//! Edges come first: each is cut until its chords keep to it, and the nodes of an edge are handed on to the edges that it is
//! joined with, so that the triangles on both sides share them. Each patch is then triangulated in its parameter plane (a
//! constrained Delaunay triangulation of its borders), and nodes are added where a triangle leaves the surface. What closes a
//! volume gives triangles that close it too, without gaps or T-joints.

mod borders;
mod face;

use crate::project::PatchSet;
use crate::surface::{Surface, Vec3};
use borders::Borders;
use std::collections::HashMap;

/// Triangles above this number are refused.
const MOST: usize = 20_000_000;

/// Why there are no triangles.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum TessellateError {
    /// The tolerance is not a positive finite number.
    #[error("the tolerance {0} is not a positive number")]
    Tolerance(f64),
    /// The borders of a patch cannot be triangulated in its parameter plane.
    #[error("patch {patch} cannot be triangulated: {reason}")]
    Patch {
        /// Number of the patch.
        patch: u32,
        /// Why not.
        reason: String,
    },
    /// More triangles than can be handled.
    #[error("more than {0} triangles would be needed")]
    TooMany(usize),
}

/// Triangles on shared nodes.
#[derive(Debug, Clone, PartialEq)]
pub struct Tessellation {
    nodes: Vec<Vec3>,
    triangles: Vec<[u32; 3]>,
    patches: Vec<u32>,
    deviation: f64,
    crossed: Vec<u32>,
}

impl Tessellation {
    /// Positions of the nodes.
    pub fn nodes(&self) -> &[Vec3] {
        &self.nodes
    }

    /// Nodes of every triangle, counter-clockwise as seen from outside.
    pub fn triangles(&self) -> &[[u32; 3]] {
        &self.triangles
    }

    /// Number of the patch that each triangle lies on, in ascending order.
    pub fn patches(&self) -> &[u32] {
        &self.patches
    }

    /// Corners of every triangle.
    pub fn corners(&self) -> impl Iterator<Item = [Vec3; 3]> + '_ {
        let corner = |k: u32| self.nodes[k as usize];
        self.triangles.iter().map(move |t| t.map(corner))
    }

    /// Largest distance of the surface from the triangles that was found, at the middles of triangles and of their sides.
    pub fn deviation(&self) -> f64 {
        self.deviation
    }

    /// Patches whose borders cross themselves in the parameter plane, so that the triangles there may leave gaps.
    pub fn crossed(&self) -> &[u32] {
        &self.crossed
    }

    /// Number of sides that belong to one triangle only: 0 where the triangles close a volume.
    pub fn open_sides(&self) -> usize {
        let mut count: HashMap<[u32; 2], u32> = HashMap::new();
        for t in &self.triangles {
            for k in 0..3 {
                let (a, b) = (t[k], t[(k + 1) % 3]);
                *count.entry([a.min(b), a.max(b)]).or_default() += 1;
            }
        }
        count.values().filter(|&&n| n == 1).count()
    }

    /// Area of all triangles.
    pub fn area(&self) -> f64 {
        let twice = self
            .corners()
            .map(|[a, b, c]| (b - a).cross(&(c - a)).norm());
        0.5 * twice.sum::<f64>()
    }

    /// Volume that the triangles enclose, where they are closed.
    pub fn volume(&self) -> f64 {
        let origin = self.nodes.first().copied().unwrap_or_default();
        let six = self.corners().map(|t| {
            let [a, b, c] = t.map(|x| x - origin);
            a.dot(&b.cross(&c))
        });
        six.sum::<f64>() / 6.0
    }
}

impl<S: Surface> PatchSet<S> {
    /// Triangles whose distance from the surface is at most about `tolerance` (a length): along edges, and inside of patches at
    /// the middles of triangles and of their sides, which all are looked at. Normals point out of the set.
    ///
    /// # Errors
    /// A tolerance that is no positive number, patches whose borders cannot be triangulated, and too many triangles.
    ///
    /// ```
    /// use covact_geometry::io;
    /// let file = io::read_path("../assets/sphere.igs".as_ref())?;
    /// let set = file.into_surface()?.into_set();
    /// let triangles = set.tessellate(1e-2)?;
    /// // A closed surface, whose flat triangles lose a little of its area.
    /// assert_eq!(triangles.open_sides(), 0);
    /// assert!(triangles.triangles().len() > 100 && triangles.deviation() <= 1e-2);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn tessellate(&self, tolerance: f64) -> Result<Tessellation, TessellateError> {
        if !(tolerance.is_finite() && tolerance > 0.0) {
            return Err(TessellateError::Tolerance(tolerance));
        }
        let mut borders = Borders::of(self, tolerance);
        let mut triangles = Vec::new();
        let mut patches = Vec::new();
        let mut crossed = Vec::new();
        let mut deviation = borders.deviation;
        for patch in 0..self.patches().len() as u32 {
            let found = face::triangulate(self, patch, tolerance, &mut borders)?;
            deviation = deviation.max(found.deviation);
            if found.crossed {
                crossed.push(patch);
            }
            if triangles.len() + found.triangles.len() > MOST {
                return Err(TessellateError::TooMany(MOST));
            }
            patches.resize(triangles.len() + found.triangles.len(), patch);
            triangles.extend(found.triangles);
        }
        // Nodes by the number of the group that they became a part of.
        let mut number = HashMap::new();
        let mut nodes = Vec::new();
        let mut kept = Vec::with_capacity(triangles.len());
        let mut owners = Vec::with_capacity(triangles.len());
        for (triangle, patch) in triangles.into_iter().zip(patches) {
            let roots = triangle.map(|k| borders.root(k));
            if roots[0] == roots[1] || roots[1] == roots[2] || roots[2] == roots[0] {
                continue;
            }
            kept.push(roots.map(|k| {
                *number.entry(k).or_insert_with(|| {
                    nodes.push(borders.position(k));
                    nodes.len() as u32 - 1
                })
            }));
            owners.push(patch);
        }
        Ok(Tessellation {
            nodes,
            triangles: kept,
            patches: owners,
            deviation,
            crossed,
        })
    }
}
