//! Supports that hold a body without straining it: as many degrees of freedom as it has rigid motions left, at three nodes far from
//! each other (the 3-2-1 principle of location). Being statically determinate, they carry nothing where no force acts on the body.
//! Bodies that stay in contact are held side by side, so that what one does between its supports the other may do, too.
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
    let mut out: Vec<u32> = Vec::new();
    let mut placed: Vec<(usize, std::ops::Range<usize>)> = Vec::new();
    let mut all = free_motions(model);
    // Small ones first: larger ones that they touch have nodes beside theirs.
    all.sort_by(|a, b| size(model, &a.nodes, u).total_cmp(&size(model, &b.nodes, u)));
    for free in all {
        let Some(index) = model.bodies.iter().position(|b| b.name == free.body) else {
            continue;
        };
        let body = &model.bodies[index];
        let position = |n: u32| model.position(n as usize, u);
        let frame = Frame::new(free.nodes.iter().map(|n| position(*n)));
        let own = |n: u32| free.nodes.binary_search(&n).is_ok();
        let mut held = Held::default();
        held_rows(model, body, &frame, own, position, |row| held.add(row));
        let dofs = |n: &u32| (0..3).map(|c| 3 * n + c).collect::<Vec<_>>();
        let whole: Vec<u32> = (free.nodes.iter().copied())
            .filter(|n| dofs(n).into_iter().all(may))
            .collect();
        let near = if whole.is_empty() {
            &free.nodes
        } else {
            &whole
        };
        let beside = (placed.iter())
            .filter(|(other, _)| meet(model, index, *other))
            .flat_map(|(_, held)| out[held.clone()].iter())
            .filter_map(|dof| Some(3 * nearest(near, dof / 3, position)? + dof % 3))
            .collect();
        let anchors = anchors(&whole, position).iter().flat_map(dofs).collect();
        // Where the three nodes do not do, all others may help.
        let all = free.nodes.iter().flat_map(dofs).collect();
        let first = out.len();
        let candidates: [Vec<u32>; 3] = [beside, anchors, all];
        for dofs in &candidates {
            loop {
                let best = (dofs.iter().copied())
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
        placed.push((index, first..out.len()));
    }
    out.sort_unstable();
    out
}

/// The longest side of the box around nodes.
fn size(model: &Model, nodes: &[u32], u: &[f64]) -> f64 {
    let place = |n: &u32| model.position(*n as usize, u);
    let (low, high) = nodes.iter().map(place).fold(
        (Vec3::repeat(f64::INFINITY), Vec3::repeat(f64::NEG_INFINITY)),
        |(low, high), x| (low.inf(&x), high.sup(&x)),
    );
    (high - low).max()
}

/// Whether a contact that acts is one between these two bodies.
fn meet(model: &Model, a: usize, b: usize) -> bool {
    let acting = model.pairs.iter().filter(|p| !p.points.is_empty());
    let bodies = acting.filter_map(|p| Some((p.body, p.body_master()?.body)));
    a != b
        && bodies
            .into_iter()
            .any(|pair| pair == (a, b) || pair == (b, a))
}

/// The node nearest to another one.
fn nearest(nodes: &[u32], to: u32, position: impl Fn(u32) -> Vec3) -> Option<u32> {
    let distance = |n: &u32| (position(*n) - position(to)).norm_squared();
    (nodes.iter().copied()).min_by(|a, b| distance(a).total_cmp(&distance(b)))
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
