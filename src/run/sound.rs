//! What equilibrium does not tell: steps that friction cannot follow, and states that no body can reach.
use crate::model::Model;
use crate::model::state::State;
use crate::scene::ValueError;
use crate::shell::with_block;
use crate::solve::newton::StepFailure;
use covact_geometry::Vec3;

/// Largest turn of a surface with friction within a step (degrees). Slip is the chord from where a point was on the surface:
/// half of the turn away from the direction it ends in, and at half a turn it points backwards.
const LARGEST_TURN: f64 = 90.0;

/// Fails where a surface with friction turns too far from `start` to `end`.
pub(super) fn turns(
    model: &Model,
    start: f64,
    end: f64,
) -> Result<Option<StepFailure>, ValueError> {
    for pair in model.pairs.iter().filter(|p| p.friction.is_some()) {
        let Some(index) = pair.rigid_master() else {
            continue;
        };
        let surface = &model.surfaces[index];
        let degrees = surface.motion.turn(start, end)?.abs();
        if degrees > LARGEST_TURN * (1.0 + 1e-9) {
            return Ok(Some(StepFailure::TurnedTooFar {
                pair: pair.name.clone(),
                surface: surface.name.clone(),
                degrees,
                largest: LARGEST_TURN,
            }));
        }
    }
    Ok(None)
}

/// Corners of a Q18 element in the order of those of an H8 element: along the first, the second, the third direction.
const CORNERS_Q18: [usize; 8] = [0, 2, 6, 8, 9, 11, 15, 17];
const CORNERS_H8: [usize; 8] = [0, 1, 2, 3, 4, 5, 6, 7];

/// Fails where an element is turned inside out at its middle. Strains are the same for a position and its mirror image, so
/// that the energy of a mirrored element is that of a sound one, and Newton's method can jump there.
pub(super) fn inside_out(model: &Model, state: &State) -> Result<(), StepFailure> {
    for body in &model.bodies {
        let position = |node: u32| {
            let n = (body.first_node + node) as usize;
            let u = &state.u[3 * n..3 * n + 3];
            model.nodes[n] + Vec3::new(u[0], u[1], u[2])
        };
        let (mut count, mut first) = (0, None);
        with_block!(&body.block, block => {
            for e in 0..body.block.elements() {
                let nodes = block.nodes_of(e);
                let corners = if nodes.len() == 18 { CORNERS_Q18 } else { CORNERS_H8 };
                if middle(&corners.map(|c| position(nodes[c]))) <= 0.0 {
                    count += 1;
                    first = first.or(Some(e));
                }
            }
        });
        if let Some(element) = first {
            return Err(StepFailure::InsideOut {
                body: body.name.clone(),
                element,
                count,
            });
        }
    }
    Ok(())
}

/// Jacobian determinant in the middle of a hexahedron, times a positive number: its corners count along the first, the
/// second, the third direction.
fn middle(x: &[Vec3; 8]) -> f64 {
    let along = |bit: usize| {
        (x.iter().enumerate()).fold(Vec3::zeros(), |sum, (i, x)| match (i >> bit) & 1 {
            0 => sum - x,
            _ => sum + x,
        })
    };
    along(0).cross(&along(1)).dot(&along(2))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_mirrored_hexahedron_is_inside_out() {
        let x: [Vec3; 8] = std::array::from_fn(|i| {
            let at = |bit: usize| ((i >> bit) & 1) as f64;
            Vec3::new(at(0) + 0.3 * at(2), at(1), 0.5 * at(2))
        });
        assert!((middle(&x) - 32.0).abs() < 1e-13);
        assert!((middle(&x.map(|x| Vec3::new(x.x, x.y, -x.z))) + 32.0).abs() < 1e-13);
    }
}
