//! Supports that hold a body without straining it: as many degrees of freedom as it has rigid motions left, at three nodes far from
//! each other (the 3-2-1 principle of location). Being statically determinate, they carry nothing where no force acts on the body.
use super::Model;
use super::free_motion::{Frame, free_motions, held_rows};
use crate::system::{Dof, Link};
use covact_geometry::Vec3;
use nalgebra::Vector6;

/// Part of a row that is new beside those that are held already, below which it holds nothing: an edge that is held along itself and
/// has been bent a little holds a turn by a lever that leaves the body to wobble.
const NEW: f64 = 1e-3;

/// Degrees of freedom `3 node + component` that hold what the supports of a model leave free, where the displacements `u` put its
/// nodes.
pub fn find(model: &Model, u: &[f64]) -> Vec<u32> {
    let mut targets = vec![false; model.dofs.dofs()];
    for dof in model.dofs.removed() {
        if let Link::To(target, _) = model.dofs.link(dof as usize) {
            targets[target as usize] = true;
        }
    }
    let may = |dof: u32| model.dofs.dof(dof as usize) == Dof::Free && !targets[dof as usize];
    let mut out = Vec::new();
    for free in free_motions(model) {
        let Some(body) = model.bodies.iter().find(|b| b.name == free.body) else {
            continue;
        };
        let position = |n: u32| model.position(n as usize, u);
        let frame = Frame::new(free.nodes.iter().map(|n| position(*n)));
        let own = |n: u32| free.nodes.binary_search(&n).is_ok();
        let mut held = Held::default();
        held_rows(model, body, &frame, own, position, |row| held.add(row));
        let dofs = |n: u32| (0..3).map(move |c| 3 * n + c);
        let whole: Vec<u32> = (free.nodes.iter().copied())
            .filter(|n| dofs(*n).all(may))
            .collect();
        let anchors = anchors(&whole, position);
        // Where the three nodes do not do, all others may help.
        for nodes in [&anchors[..], &free.nodes[..]] {
            loop {
                let best = (nodes.iter())
                    .flat_map(|n| dofs(*n))
                    .filter(|dof| may(*dof) && !out.contains(dof))
                    .map(|dof| {
                        (
                            dof,
                            held.rest(frame.row(position(dof / 3), dof as usize % 3)),
                        )
                    })
                    .max_by(|a, b| a.1.norm().total_cmp(&b.1.norm()));
                match best {
                    Some((dof, rest)) if held.0.len() < 6 && rest.norm() > NEW => {
                        held.add(rest);
                        out.push(dof);
                    }
                    _ => break,
                }
            }
        }
    }
    out.sort_unstable();
    out
}

/// An orthonormal basis of the rows that are held.
#[derive(Default)]
struct Held(Vec<Vector6<f64>>);

impl Held {
    /// What of a row is new. Twice, so that rounding leaves nothing of the others.
    fn rest(&self, row: Vector6<f64>) -> Vector6<f64> {
        let without = |row: Vector6<f64>| self.0.iter().fold(row, |r, q| r - q * q.dot(&r));
        without(without(row))
    }

    fn add(&mut self, row: Vector6<f64>) {
        let rest = self.rest(row);
        if rest.norm() > NEW * row.norm().max(1.0) {
            self.0.push(rest.normalize());
        }
    }
}

/// Up to three nodes: one farthest from the middle, the one farthest from it, and the one farthest from the line through both.
fn anchors(nodes: &[u32], position: impl Fn(u32) -> Vec3) -> Vec<u32> {
    let farthest = |measure: &dyn Fn(Vec3) -> f64| {
        let all = nodes.iter().map(|n| (*n, measure(position(*n))));
        // The first of equals: the same nodes on every machine.
        all.fold(None, |best: Option<(u32, f64)>, (n, d)| match best {
            Some((_, most)) if d <= most => best,
            _ => Some((n, d)),
        })
        .map(|(n, _)| n)
    };
    let count = nodes.len().max(1) as f64;
    let middle = nodes.iter().map(|n| position(*n)).sum::<Vec3>() / count;
    let Some(a) = farthest(&|x| (x - middle).norm()) else {
        return Vec::new();
    };
    let from = position(a);
    let b = farthest(&|x| (x - from).norm()).unwrap_or(a);
    let line = (position(b) - from).try_normalize(0.0).unwrap_or_default();
    let c = farthest(&|x| (x - from).cross(&line).norm()).unwrap_or(a);
    let mut out = vec![a, b, c];
    out.dedup();
    out
}
