//! What equilibrium does not tell: steps that friction cannot follow, and states that no body can reach.
use crate::assembly::Fault;
use crate::contact::rigid::{self, RigidMaster};
use crate::model::Model;
use crate::model::state::State;
use crate::model::surface::SurfaceSet;
use crate::scene::ValueError;
use crate::shell::with_block;
use crate::solve::newton::StepFailure;
use covact_geometry::Vec3;
use nalgebra::Point3;

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

/// Instants within a step that are looked at.
const BETWEEN: u32 = 7;

/// Fails where points of `to`, at time `end`, touch a rigid surface on its far side: moving evenly since `from`, at time
/// `start`, they were in it deeper than its depth in between. Only points that moved farther than that are looked at.
pub(super) fn far_side(
    model: &Model,
    (from, start): (&State, f64),
    (to, end): (&State, f64),
) -> Result<(), StepFailure> {
    let mut first = 0;
    for (index, pair) in model.pairs.iter().enumerate() {
        let slaves = to.slaves(model, index);
        let range = first..first + slaves.len();
        first = range.end;
        let Some(surface) = pair.rigid_master() else {
            continue;
        };
        let surface = &model.surfaces[surface];
        let at = |t: f64, u: &[f64]| surface.at(t, u).map_err(Fault::from);
        let (before, after) = (at(start, &from.u)?, at(end, &to.u)?);
        let behind = |master: &RigidMaster<'_, SurfaceSet>, x: &Vec3| {
            let foot = master.foot(x, None, f64::INFINITY);
            foot.is_some_and(|foot| rigid::behind(&foot, master.depth))
        };
        // Those that may have gone through, by where they began and ended.
        let suspects: Vec<[Vec3; 2]> = (slaves.iter().zip(&to.points[range]))
            .filter(|(_, now)| now.closed)
            .map(|(p, _)| [from, to].map(|state| model.point_position(p, &state.u)))
            .filter(|[a, b]| {
                let seen = after.pose * before.pose.inverse_transform_point(&Point3::from(*a));
                (b - seen.coords).norm() > after.depth && !behind(&before, a)
            })
            .collect();
        if suspects.is_empty() {
            continue;
        }
        let mut through = vec![false; suspects.len()];
        for k in 1..=BETWEEN {
            let s = f64::from(k) / f64::from(BETWEEN + 1);
            let u: Vec<f64> = match surface.driven {
                Some(_) => (from.u.iter().zip(&to.u))
                    .map(|(a, b)| a + (b - a) * s)
                    .collect(),
                None => Vec::new(),
            };
            let master = at(start + (end - start) * s, &u)?;
            for (through, [a, b]) in through.iter_mut().zip(&suspects) {
                *through = *through || behind(&master, &(a + (b - a) * s));
            }
        }
        let points = through.iter().filter(|t| **t).count();
        if points > 0 {
            return Err(StepFailure::FarSide {
                pair: pair.name.clone(),
                master: pair.master_words(model),
                points,
                depth: after.depth,
            });
        }
    }
    Ok(())
}

/// Corners of a Q18 element in the order of those of an H8 element: along the first, the second, the third direction.
const CORNERS_Q18: [usize; 8] = [0, 2, 6, 8, 9, 11, 15, 17];
const CORNERS_H8: [usize; 8] = [0, 1, 2, 3, 4, 5, 6, 7];

/// Fails where an element is turned inside out at its middle. Strains are the same for a position and its mirror image, so
/// that the energy of a mirrored element is that of a sound one, and Newton's method can jump there.
pub(super) fn inside_out(model: &Model, state: &State) -> Result<(), StepFailure> {
    // A sheet has no volume to be turned inside out.
    for body in model.bodies.iter().filter(|b| b.block.sheet().is_none()) {
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
