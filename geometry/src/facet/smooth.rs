//! The smooth surface over quadrilaterals as patches.

use crate::parallel::*;

use super::{FacetError, FacetMesh};
use crate::moving::MovingFacets;
use crate::patch::NurbsPatch;
use crate::project::PatchSet;
use crate::surface::{Surface, Vec3};

/// One smooth surface through the nodes of a mesh of quadrilaterals: a bicubic patch over `[-1, 1]^2` for each facet, that
/// of [`MovingFacets::smooth`] at rest.
///
/// # Errors
/// Nodes that are not there or not finite, and meshes that [`MovingFacets::smooth`] refuses.
pub fn smooth_patches(mesh: &FacetMesh<4>) -> Result<Vec<NurbsPatch>, FacetError> {
    let corners = mesh.surfaces()?;
    let facets: Vec<(&[u32], [u8; 2])> = (mesh.facets.iter())
        .map(|nodes| (nodes.as_slice(), [2, 2]))
        .collect();
    let position = |node: u32| mesh.nodes[node as usize];
    let mut moving = MovingFacets::smooth(&facets, position)?;
    moving.update(position);
    (0..corners.len() as u32)
        .map(|facet| bicubic(&moving, facet))
        .collect()
}

/// Control points from the points, tangents and twists at the corners: a bicubic piece is Hermite's.
fn bicubic(moving: &MovingFacets, facet: u32) -> Result<NurbsPatch, FacetError> {
    let mut points = [Vec3::zeros(); 16];
    for corner in 0..4 {
        let end = [corner % 2, corner / 2];
        let sign = end.map(|e| if e == 0 { 1.0 } else { -1.0 });
        let jet = moving.jet(facet, sign.map(|s: f64| -s));
        // The parameter runs over an interval of length 2, a third of which belongs to each leg of the control polygon.
        let [a, b] = [0, 1].map(|k| jet.rho_i[k] * (sign[k] * 2.0 / 3.0));
        let twist = jet.rho_ij[1] * (sign[0] * sign[1] * 4.0 / 9.0);
        for (m, part) in [Vec3::zeros(), a, b, a + b + twist].into_iter().enumerate() {
            let [i, j] = [0, 1].map(|k| {
                let step = (m >> k) & 1;
                if end[k] == 0 { step } else { 3 - step }
            });
            points[i + 4 * j] = jet.rho + part;
        }
    }
    let knots = || vec![-1.0, -1.0, -1.0, -1.0, 1.0, 1.0, 1.0, 1.0];
    Ok(NurbsPatch::new(
        [3, 3],
        [knots(), knots()],
        [4, 4],
        &points,
        None,
    )?)
}

/// Points of a patch in each direction at which its distance from a surface is measured.
const POINTS: usize = 5;

/// Largest distance of patches from a surface at 5 x 5 points of each, as the closest points say.
pub fn distance_from<S: Surface, T: Surface>(surface: &PatchSet<S>, patches: &[T]) -> f64 {
    let one = |patch: &T| {
        let domain = patch.domain();
        let mut hint = None;
        let mut largest = 0.0f64;
        for k in 0..POINTS * POINTS {
            let step = [k % POINTS, k / POINTS].map(|i| i as f64 / (POINTS - 1) as f64);
            let xi = [0, 1].map(|d| domain[d][0] + (domain[d][1] - domain[d][0]) * step[d]);
            if let Some(foot) = surface.project(&patch.point(xi), hint, f64::INFINITY) {
                hint = Some(foot.hint());
                largest = largest.max(foot.distance);
            }
        }
        largest
    };
    let all: Vec<f64> = patches.par_iter().map(one).collect();
    all.into_iter().fold(0.0, f64::max)
}
