//! Supports of sheets beside what they prescribe: clamped edges, planes of symmetry, plane strain.
//!
//! The normal of a sheet along an edge depends on the row of control points beside it. Where that row may simply follow the
//! edge its degrees of freedom are tied to those of the edge, which is exact for rotations of any size: the net of a plane of
//! symmetry is orthogonal to the plane, or a clamped edge has the same normal, along an axis, everywhere. Elsewhere the normal is
//! held by an energy along the edge ([`HeldNormal`]).
use super::super::Tied;
use super::super::error::text;
use super::{BodyModel, Builder, ModelError};
use crate::mesh::{Border, Edge, NurbsSheet};
use crate::scene::{Axis, Support};
use crate::shell::HeldNormal;
use crate::system::{ConstraintError, Dof, DofMapBuilder};
use covact_geometry::Vec3;
use std::collections::{BTreeMap, BTreeSet};

/// Part of a length, or sine of an angle, that counts as round-off of a control net.
const ROUND: f64 = 1e-9;

/// Numbers of the anchors of a body that are held, with the components that are.
pub(super) type HeldAnchors = Vec<(usize, [bool; 3])>;

/// What supports ask of sheets beside prescribed displacements.
#[derive(Default)]
pub(super) struct SheetSupports {
    /// Degrees of freedom that go together, with the support that says so.
    ties: Vec<([u32; 2], u32)>,
    /// Body, border, and what the normal along it is held to.
    pub held: Vec<(usize, Border, HeldNormal)>,
}

impl Builder<'_> {
    /// Collects what a support asks of the sheets among its sets.
    ///
    /// # Errors
    /// What needs a whole edge, on sets that are none; a clamp of a solid body; plane strain of a net that is not extruded.
    pub(super) fn sheet_support(
        &self,
        (index, name, support): (u32, &str, &Support),
        out: &mut SheetSupports,
    ) -> Result<(), ModelError> {
        let pointer = |field: &str| format!("/supports/{name}/{field}");
        for (at, reference) in support.on.places(&pointer("on")) {
            let (body, nodes) = self.set_nodes(reference, &at)?;
            let (_, set) = reference.split_once('.').unwrap_or((reference, ""));
            let Some(sheet) = self.bodies[body].block.sheet() else {
                if !support.clamped {
                    continue;
                }
                let message = format!(
                    "`{reference}` belongs to a body of elements, not to one of kind `nurbs`"
                );
                return Err(text(pointer("clamped"), message)
                    .help("take `fixed`, which holds both faces of a shell made of elements"));
            };
            if support.mid_surface {
                let message = format!(
                    "`{reference}` belongs to a body of kind `nurbs`, which is a mid-surface already"
                );
                return Err(text(pointer("mid_surface"), message).help("leave `mid_surface` out"));
            }
            let first = self.bodies[body].first_node;
            if let Some(axis) = support.plane_strain {
                let lines = extruded(sheet, component(axis)).ok_or_else(|| {
                    let message =
                        format!("the control net of `{reference}` is not extruded along the axis");
                    text(pointer("plane_strain"), message).help(
                        "plane strain is for faces that a straight line along this axis sweeps",
                    )
                })?;
                out.plane_strain(&lines, first, component(axis), index);
                continue;
            }
            let edges = sheet.edge_sets.get(set).map_or(&[][..], Vec::as_slice);
            if support.clamped && edges.is_empty() {
                let message =
                    format!("`{reference}` is no whole edge, and only edges can be clamped");
                return Err(text(at, message).help(
                    "take an edge (`edge.1` to `edge.4`), a curve of a trim (`trim.1`), or a set of nodes that holds a whole one",
                ));
            }
            // A symmetry of all control points, as of plane problems, holds no normal.
            if nodes.len() >= sheet.nodes() {
                continue;
            }
            for edge in edges {
                match (edge, support.symmetry) {
                    (Border::Edge(edge), _) if support.clamped => {
                        out.clamp(sheet, body, *edge, first, index);
                    }
                    (Border::Edge(edge), Some(axis)) => {
                        out.mirror(sheet, body, *edge, (first, component(axis)), index);
                    }
                    (Border::Trim(_), _) if support.clamped => {
                        out.held.push((body, *edge, HeldNormal::Clamped));
                    }
                    (Border::Trim(_), Some(axis)) => {
                        let normal = Vec3::ith(component(axis), 1.0);
                        out.held.push((body, *edge, HeldNormal::InPlane(normal)));
                    }
                    (_, None) => {}
                }
            }
        }
        Ok(())
    }
}

fn component(axis: Axis) -> usize {
    match axis {
        Axis::X => 0,
        Axis::Y => 1,
        Axis::Z => 2,
    }
}

/// Lines of control points along an axis, that all points belong to.
fn extruded(sheet: &NurbsSheet, axis: usize) -> Option<Vec<Vec<u32>>> {
    let points = sheet.positions();
    let [low, high] = sheet.bounds();
    let slack = ROUND * (high - low).norm();
    let straight = |line: &Vec<u32>| {
        let first = points[line[0] as usize];
        line.iter().all(|n| {
            let off = points[*n as usize] - first;
            (0..3).all(|c| c == axis || off[c].abs() <= slack)
        })
    };
    let of_patch = |k: usize| {
        let patch = &sheet.patches[k].patch;
        let edges = Edge::of(k);
        [edges[0], edges[2]].into_iter().find_map(|edge| {
            // Lines across the edge: one point of every row.
            let rows: Vec<Vec<u32>> = (0..patch.counts()[edge.direction()])
                .map(|k| sheet.row(edge, k))
                .collect();
            let lines: Vec<Vec<u32>> = (0..rows[0].len())
                .map(|k| rows.iter().map(|row| row[k]).collect())
                .collect();
            lines.iter().all(straight).then_some(lines)
        })
    };
    let all: Option<Vec<_>> = (0..sheet.patches.len()).map(of_patch).collect();
    all.map(|lines| lines.concat())
}

/// What is held of the anchors on curves of trims, by body; what is not held of them follows the control point that is nearest.
///
/// # Errors
/// Degrees of freedom that are tied otherwise.
pub(super) fn held_anchors(
    bodies: &[BodyModel],
    dofs: &mut DofMapBuilder,
) -> Result<Vec<HeldAnchors>, ConstraintError> {
    let mut out = Vec::with_capacity(bodies.len());
    for body in bodies {
        let mut own = Vec::new();
        let anchors = body.block.sheet().map_or(&[][..], |s| &s.anchors);
        for (k, anchor) in anchors.iter().enumerate() {
            let dof = |node: u32, c: u32| 3 * (node + body.first_node) + c;
            let held = [0, 1, 2].map(|c| dofs.get(dof(anchor.node, c)) == Some(Dof::Prescribed));
            let p = &anchor.at.at;
            let most = (0..16).max_by(|a, b| p.n[*a].total_cmp(&p.n[*b]));
            for c in (0..3).filter(|c| !held[*c as usize]) {
                let to = dof(p.nodes[most.unwrap_or_default()], c);
                dofs.tie(dof(anchor.node, c), to, 1.0)?;
            }
            if held.contains(&true) {
                own.push((k, held));
            }
        }
        out.push(own);
    }
    Ok(out)
}

impl SheetSupports {
    fn plane_strain(&mut self, lines: &[Vec<u32>], first: u32, axis: usize, support: u32) {
        for line in lines {
            for node in &line[1..] {
                for c in (0..3).filter(|c| *c != axis) {
                    let dof = |n: u32| 3 * (n + first) + c as u32;
                    self.ties.push(([dof(*node), dof(line[0])], support));
                }
            }
        }
    }

    /// The second row follows the edge along the normal where that is the same axis everywhere; else the normal is held.
    fn clamp(&mut self, sheet: &NurbsSheet, body: usize, edge: Edge, first: u32, support: u32) {
        let points = sheet.positions();
        let rows = [0, 1].map(|row| sheet.row(edge, row));
        let spread: Vec<Vec3> = (rows.iter().flatten())
            .map(|n| points[*n as usize] - points[rows[0][0] as usize])
            .collect();
        let size = spread.iter().map(|x| x.norm()).fold(0.0, f64::max);
        let flat = (0..3).find(|&c| spread.iter().all(|x| x[c].abs() <= ROUND * size));
        let Some(axis) = flat else {
            self.held
                .push((body, Border::Edge(edge), HeldNormal::Clamped));
            return;
        };
        for (edge, beside) in rows[0].iter().zip(&rows[1]) {
            let dof = |n: u32| 3 * (n + first) + axis as u32;
            self.ties.push(([dof(*beside), dof(*edge)], support));
        }
    }

    /// The second row follows the edge in the plane where it stands straight on it; else the normal is held in the plane.
    fn mirror(
        &mut self,
        sheet: &NurbsSheet,
        body: usize,
        edge: Edge,
        (first, axis): (u32, usize),
        support: u32,
    ) {
        let points = sheet.positions();
        let weights: Vec<f64> = (sheet.patches.iter())
            .flat_map(|p| p.patch.weights())
            .collect();
        let rows = [0, 1].map(|row| sheet.row(edge, row));
        let orthogonal = rows[0].iter().zip(&rows[1]).all(|(a, b)| {
            let off = points[*b as usize] - points[*a as usize];
            let across = (0..3).filter(|c| *c != axis).map(|c| off[c].abs());
            let [a, b] = [*a, *b].map(|n| weights[n as usize]);
            // The tangent across the edge is that of one pair of points where their weights go in step along it.
            across.fold(0.0, f64::max) <= ROUND * off.norm()
                && (a * weights[rows[1][0] as usize] - b * weights[rows[0][0] as usize]).abs()
                    <= ROUND * a * b
        });
        if !orthogonal {
            let normal = Vec3::ith(axis, 1.0);
            let normal = HeldNormal::InPlane(normal);
            self.held.push((body, Border::Edge(edge), normal));
            return;
        }
        for (edge, beside) in rows[0].iter().zip(&rows[1]) {
            for c in (0..3).filter(|c| *c != axis) {
                let dof = |n: u32| 3 * (n + first) + c as u32;
                self.ties.push(([dof(*beside), dof(*edge)], support));
            }
        }
    }

    /// Ties everything that goes together to one of its members: to a prescribed one where there is any. `unused` nodes, which a trim
    /// cuts away, follow others already.
    ///
    /// # Errors
    /// Degrees of freedom that are tied otherwise.
    pub fn tie(
        &self,
        dofs: &mut DofMapBuilder,
        unused: &BTreeSet<u32>,
        owner: impl Fn(u32) -> Option<u32>,
    ) -> Result<Vec<Tied>, ConstraintError> {
        let mut parent: BTreeMap<u32, u32> = BTreeMap::new();
        fn root(parent: &mut BTreeMap<u32, u32>, mut dof: u32) -> u32 {
            while let Some(&next) = parent.get(&dof) {
                if next == dof {
                    break;
                }
                dof = next;
            }
            dof
        }
        let mut support = BTreeMap::new();
        for ([a, b], by) in &self.ties {
            for dof in [a, b] {
                parent.entry(*dof).or_insert(*dof);
                support.entry(*dof).or_insert(*by);
            }
            let (a, b) = (root(&mut parent, *a), root(&mut parent, *b));
            parent.insert(a.max(b), a.min(b));
        }
        let mut groups: BTreeMap<u32, Vec<u32>> = BTreeMap::new();
        for dof in support.keys().filter(|dof| !unused.contains(&(**dof / 3))) {
            let root = root(&mut parent, *dof);
            groups.entry(root).or_default().push(*dof);
        }
        let mut out = Vec::new();
        for members in groups.values() {
            let held = |dof: &&u32| dofs.get(**dof) == Some(Dof::Prescribed);
            let to = members.iter().find(held).copied().unwrap_or(members[0]);
            for dof in members {
                if *dof != to && dofs.get(*dof) == Some(Dof::Free) {
                    dofs.tie(*dof, to, 1.0)?;
                }
                if dofs.get(*dof) != Some(Dof::Prescribed) {
                    let support = owner(to).unwrap_or(support[dof]);
                    out.push(Tied {
                        dof: *dof,
                        to,
                        support,
                    });
                }
            }
        }
        Ok(out)
    }
}
