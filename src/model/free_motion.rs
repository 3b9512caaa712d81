//! Can a body move without being strained? Six rigid motions against its supports.
use super::{Model, Support};
use crate::mesh::nurbs::Kept;
use crate::scene::ValueError;
use crate::shell::{Block, SEAM_NODES};
use covact_geometry::Vec3;
use nalgebra::{Matrix3, Matrix6, SymmetricEigen, Vector6};
use std::collections::BTreeSet;

/// A rigid motion that no support hinders.
#[derive(Debug, Clone, PartialEq)]
pub struct FreeMotion {
    pub body: String,
    /// How many independent motions are free.
    pub count: usize,
    /// In words: along and about which axes they go.
    pub motion: String,
    /// Nodes of the piece that moves, in the model.
    pub nodes: Vec<u32>,
}

impl FreeMotion {
    /// Part of the increments `du` (3 per node of the model) of its nodes, at these positions, that is one rigid motion: the
    /// sum of its squares over that of all, zero where nothing moves.
    pub fn rigid_share(&self, position: impl Fn(u32) -> Vec3, du: &[f64]) -> f64 {
        let moved = |n: u32| Vec3::from_column_slice(&du[3 * n as usize..3 * n as usize + 3]);
        let nodes = || self.nodes.iter().copied();
        let count = self.nodes.len() as f64;
        let center = nodes().map(&position).sum::<Vec3>() / count;
        let shift = nodes().map(moved).sum::<Vec3>() / count;
        // The rotation nearest to the increments in the mean.
        let (mut inertia, mut momentum) = (Matrix3::zeros(), Vec3::zeros());
        for n in nodes() {
            let r = position(n) - center;
            inertia += Matrix3::identity() * r.norm_squared() - r * r.transpose();
            momentum += r.cross(&moved(n));
        }
        let spin = inertia
            .try_inverse()
            .map_or_else(Vec3::zeros, |i| i * momentum);
        let (mut rigid, mut all) = (0.0, 0.0);
        for n in nodes() {
            rigid += (shift + spin.cross(&(position(n) - center))).norm_squared();
            all += moved(n).norm_squared();
        }
        match all > 0.0 {
            true => rigid / all,
            false => 0.0,
        }
    }

    /// The rigid motion that supports prescribe for the piece from the displacements `u` to `time`: the least one that fits
    /// their increments best, and none along the motions that are free. Calls `add` with each node and its way; does nothing
    /// where no support moves the piece.
    ///
    /// # Errors
    /// A prescribed value that cannot be evaluated.
    pub fn carried(
        &self,
        model: &Model,
        u: &[f64],
        time: f64,
        mut add: impl FnMut(u32, Vec3),
    ) -> Result<(), ValueError> {
        let own = |dof: u32| self.nodes.binary_search(&(dof / 3)).is_ok();
        let supports = || model.supports().filter(|s| own(s.dofs[0]));
        if !supports().any(|s| s.moves()) {
            return Ok(());
        }
        let position = |n: u32| model.position(n as usize, u);
        let frame = Frame::new(self.nodes.iter().map(|n| position(*n)));
        let (mut gram, mut right) = (Matrix6::zeros(), Vector6::zeros());
        for support in supports() {
            let row = frame.held(&support, position);
            gram += row * row.transpose();
            right += row * support.missing(u, time)?;
        }
        let eigen = SymmetricEigen::new(gram);
        let limit = HINDERED * eigen.eigenvalues.max().max(1e-300);
        let mut motion = Vector6::zeros();
        for (value, vector) in (eigen.eigenvalues.iter()).zip(eigen.eigenvectors.column_iter()) {
            if *value > limit {
                motion += vector * (vector.dot(&right) / value);
            }
        }
        for &n in &self.nodes {
            add(n, frame.motion(&motion, position(n)));
        }
        Ok(())
    }
}

/// Stiffness of a motion against the supports, relative to the stiffest, above which they hinder it.
const HINDERED: f64 = 1e-10;

/// Rigid motions of a piece: three shifts, and three turns about its centre at a radius of its size.
pub(super) struct Frame {
    center: Vec3,
    size: f64,
}

impl Frame {
    pub(super) fn new(nodes: impl Iterator<Item = Vec3> + Clone) -> Frame {
        let (sum, count) = (nodes.clone()).fold((Vec3::zeros(), 0.0), |(s, n), x| (s + x, n + 1.0));
        let center = sum / count;
        let squares: f64 = nodes.map(|x| (x - center).norm_squared()).sum();
        Frame {
            center,
            size: (squares / count).sqrt().max(f64::MIN_POSITIVE),
        }
    }

    /// What the six motions do to a component of a point.
    pub(super) fn row(&self, x: Vec3, component: usize) -> Vector6<f64> {
        Vector6::from_fn(|k, _| {
            let mut unit = Vector6::zeros();
            unit[k] = 1.0;
            self.motion(&unit, x)[component]
        })
    }

    /// What they do to the mean that a support holds, of nodes at these positions.
    fn held(&self, support: &Support, position: impl Fn(u32) -> Vec3) -> Vector6<f64> {
        let [a, b] = (support.dofs).map(|d| self.row(position(d / 3), d as usize % 3));
        (a + b) * 0.5
    }

    /// The way of a point.
    fn motion(&self, amounts: &Vector6<f64>, x: Vec3) -> Vec3 {
        let (shift, turn) = (amounts.fixed_rows::<3>(0), amounts.fixed_rows::<3>(3));
        shift + turn.into_owned().cross(&((x - self.center) / self.size))
    }
}

/// Checks every connected piece of every body. Those that a stage has found supports for are held where they are by then.
pub fn free_motions(model: &Model) -> Vec<FreeMotion> {
    let found = model.stage.iter().flat_map(|s| &s.start.held);
    let found: BTreeSet<u32> = found.map(|(dof, _)| dof / 3).collect();
    let mut out = Vec::new();
    for body in &model.bodies {
        for piece in pieces(body.mesh.nodes.len(), body) {
            if (piece.iter()).any(|n| found.contains(&(body.first_node + n))) {
                continue;
            }
            if let Some(free) = free_motion(model, body, &piece) {
                out.push(FreeMotion {
                    body: body.name.clone(),
                    ..free
                });
            }
        }
    }
    out
}

fn pieces(nodes: usize, body: &super::BodyModel) -> Vec<Vec<u32>> {
    let mut parent: Vec<u32> = (0..nodes as u32).collect();
    fn root(parent: &mut [u32], mut i: u32) -> u32 {
        while parent[i as usize] != i {
            parent[i as usize] = parent[parent[i as usize] as usize];
            i = parent[i as usize];
        }
        i
    }
    // What a trim cuts away joins nothing, and its control points are no pieces.
    let trimmed = body.block.sheet().filter(|s| s.is_trimmed());
    let gone = |e: &usize| trimmed.is_some_and(|s| *s.kept(*e) == Kept::Nothing);
    for e in (0..body.mesh.elements()).filter(|e| !gone(e)) {
        let conn = body.mesh.element(e);
        let first = root(&mut parent, conn[0]);
        for &n in &conn[1..] {
            let r = root(&mut parent, n);
            parent[r as usize] = first;
        }
    }
    for spring in body.block.anchors() {
        if let [first, .., last] = spring.nodes() {
            let [a, b] = [first, last].map(|n| root(&mut parent, *n));
            parent[b as usize] = a;
        }
    }
    for seam in body.block.seams() {
        let [a, b] = [seam.nodes[0], seam.nodes[SEAM_NODES - 1]].map(|n| root(&mut parent, n));
        parent[b as usize] = a;
    }
    let mut groups = std::collections::BTreeMap::<u32, Vec<u32>>::new();
    let unused = trimmed.map(|s| s.unused()).unwrap_or_default();
    let held: BTreeSet<u32> = body
        .block
        .anchors()
        .iter()
        .filter_map(|s| s.nodes().last().copied())
        .collect();
    // Neither are points of curves that nothing holds.
    let anchors = trimmed.into_iter().flat_map(|s| s.anchors.iter());
    let loose = anchors.map(|a| a.node).filter(|n| !held.contains(n));
    let unused: BTreeSet<u32> = unused.into_iter().map(|[n, _]| n).chain(loose).collect();
    for n in (0..nodes as u32).filter(|n| !unused.contains(n)) {
        let r = root(&mut parent, n);
        groups.entry(r).or_default().push(n);
    }
    groups.into_values().collect()
}

/// What supports and ties hold of the rigid motions of a piece of a body, with its nodes at these positions: calls `add` with a
/// row for each.
pub(super) fn held_rows(
    model: &Model,
    body: &super::BodyModel,
    frame: &Frame,
    own: impl Fn(u32) -> bool,
    position: impl Fn(u32) -> Vec3 + Copy,
    mut add: impl FnMut(Vector6<f64>),
) {
    for support in model.supports().filter(|s| own(s.dofs[0] / 3)) {
        add(frame.held(&support, position));
    }
    // What a sheet's control points follow moves with them, and normals that are held do not turn.
    for tied in (model.tied.iter()).filter(|t| own(t.dof / 3) && t.to != t.dof) {
        let [a, b] = [tied.dof, tied.to].map(|d| frame.row(position(d / 3), d as usize % 3));
        add(a - b);
    }
    if let Block::Nurbs(block) = &body.block {
        for axis in block.held_turns() {
            let mut row = Vector6::zeros();
            row.fixed_rows_mut::<3>(3).copy_from(&axis);
            add(row);
        }
    }
}

fn free_motion(model: &Model, body: &super::BodyModel, piece: &[u32]) -> Option<FreeMotion> {
    let first = body.first_node;
    let nodes = piece.iter().map(|n| model.nodes[(first + n) as usize]);
    let frame = Frame::new(nodes);
    let mut gram = Matrix6::<f64>::zeros();
    let own = |node: u32| node >= first && piece.binary_search(&(node - first)).is_ok();
    held_rows(
        model,
        body,
        &frame,
        own,
        |n| model.nodes[n as usize],
        |row| {
            gram += row * row.transpose();
        },
    );
    let eigen = SymmetricEigen::new(gram);
    let largest = eigen.eigenvalues.max();
    let limit = HINDERED * largest.max(1e-300);
    let free = eigen.eigenvalues.iter().filter(|&&l| l <= limit).count();
    if free == 0 {
        return None;
    }
    // Columns of the eigenvectors without stiffness span the free motions.
    let along = |k: usize| -> f64 {
        let free = (0..6).filter(|&i| eigen.eigenvalues[i] <= limit);
        free.map(|i| eigen.eigenvectors[(k, i)].powi(2)).sum()
    };
    Some(FreeMotion {
        body: String::new(),
        count: free,
        motion: describe(&std::array::from_fn(along), free),
        nodes: piece.iter().map(|n| first + n).collect(),
    })
}

/// Words for the free motions: the axes that are free by themselves (share 1), and how many motions remain that combine
/// several.
fn describe(share: &[f64; 6], count: usize) -> String {
    let names = [
        "along x", "along y", "along z", "about x", "about y", "about z",
    ];
    let mut words: Vec<String> = (share.iter().zip(names))
        .filter(|(s, _)| **s > 1.0 - 1e-6)
        .map(|(_, name)| name.to_owned())
        .collect();
    let rest = count - words.len().min(count);
    if rest > 0 {
        let partly: Vec<&str> = (share.iter().zip(names))
            .filter(|(s, _)| **s > 1e-6 && **s <= 1.0 - 1e-6)
            .map(|(_, name)| name)
            .collect();
        words.push(format!(
            "in {rest} way(s) that combine motions {}",
            partly.join(", ")
        ));
    }
    match words.split_last() {
        Some((last, [])) => last.clone(),
        Some((last, before)) => format!("{} and {last}", before.join(", ")),
        None => String::new(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A shift and a turn are one rigid motion; a stretch is none.
    #[test]
    fn a_rigid_motion_is_told_from_a_deformation() {
        let motion = FreeMotion {
            body: String::new(),
            count: 6,
            motion: String::new(),
            nodes: (0..8).collect(),
        };
        let at = |n: u32| Vec3::from_fn(|c, _| f64::from(n >> c & 1) + 3.0);
        let share = |field: &dyn Fn(Vec3) -> Vec3| {
            let du: Vec<f64> = (0..8).flat_map(|n| field(at(n)).data.0[0]).collect();
            motion.rigid_share(at, &du)
        };
        let spin = Vec3::new(0.3, -0.2, 0.9);
        let rigid = share(&|x| Vec3::new(5.0, 1.0, -2.0) + spin.cross(&x));
        assert!((rigid - 1.0).abs() < 1e-12, "{rigid}");
        let middle = Vec3::repeat(3.5);
        let stretched = share(&|x| (x - middle).component_mul(&Vec3::new(2.0, -1.0, 0.5)));
        assert!(stretched < 1e-24, "{stretched}");
        assert_eq!(share(&|_| Vec3::zeros()), 0.0);
    }
}
