//! Supports that hold both faces of a shell where its mid-surface may have been meant: fibres, the lines through the thickness,
//! cannot turn there.
use super::supports::components;
use super::{Builder, ModelError};
use crate::mesh::ThicknessColumns;
use crate::model::BodyModel;
use crate::model::error::At;
use crate::model::stretched::Stretched;
use crate::scene::{POSITION_AND_TIME, TimeFunction};
use covact_geometry::Vec3;
use std::collections::{BTreeMap, BTreeSet, HashSet};

/// Thickness over the size of the body up to which it is a shell.
const SHELL: f64 = 0.1;
/// Part of a held direction that points into the shell, across its border, from which on fibres cannot turn about the border; and along
/// them, from which on they are stretched where they do.
const ACROSS: f64 = 0.7;
/// Parts of the time of a run at which displacements of both ends of a fibre are compared.
const TIMES: [f64; 4] = [0.0, 0.31, 0.77, 1.0];

impl Builder<'_> {
    /// What supports mean for the fibres of shells. Warns of those that hold both ends of fibres alike in the direction that points
    /// into the shell, across its border, and leave another component free: the border cannot turn. A single component that is
    /// zero is a symmetry plane. Where all three are held that is a clamp, which is noted, as is a hinge: a support at the
    /// mid-surface. Held along the border and across the shell alone, as by a diaphragm, fibres turn, but where both ends move alike along
    /// them they are stretched by that ([`Stretched`]).
    ///
    /// # Errors
    /// As for [`Builder::supports`].
    pub(super) fn held_fibres(&mut self) -> Result<(), ModelError> {
        let scene = self.scene;
        let (mut warnings, mut notes) = (Vec::new(), Vec::new());
        let flat = self.held_along()?;
        for (name, support) in &scene.supports {
            let pointer = |field: &str| format!("/supports/{name}/{field}");
            let held = components(support);
            if held.is_empty() {
                continue;
            }
            let plane = held.len() == 1 && held[0].1.is_none();
            let mut values = Vec::new();
            for (component, value) in &held {
                let value = (value.as_ref().map(|v| v.compile(&POSITION_AND_TIME))).transpose();
                values.push((*component as usize, value.at(|| pointer("displacement"))?));
            }
            let mut sets: BTreeMap<usize, BTreeSet<u32>> = BTreeMap::new();
            for (at, reference) in support.on.places(&pointer("on")) {
                let (body, nodes) = self.set_nodes(reference, &at)?;
                sets.entry(body).or_default().extend(nodes);
            }
            for (body, set) in sets {
                let number = body;
                let body = &self.bodies[body];
                // A sheet has none: `fixed` is a hinge there and `clamped` a clamp.
                if body.block.sheet().is_some() {
                    continue;
                }
                let end = scene.solution.end_time;
                let border = border_fibres(body, (&set, &flat));
                let turns = |f: &&BorderFibre| !f.held(&f.inward, &values, end);
                let fibres = border.iter().filter(|f| !turns(f)).count();
                if !support.mid_surface {
                    let along = (border.iter().filter(turns))
                        .filter(|f| f.held(&f.along, &values, end))
                        .map(|f| (f.nodes, (f.ends[1] - f.ends[0]).norm(), f.width));
                    self.stretched
                        .extend(Stretched::new(name, (number, body), along));
                }
                if fibres == 0 || plane {
                    continue;
                }
                let all = held.len() == 3;
                let of = format!("support `{name}`: along the border of body `{}`", body.name);
                match (support.mid_surface, all) {
                    (true, true) => notes.push(format!(
                        "{of} fibres through the thickness turn freely at {fibres} place(s): hinged"
                    )),
                    (true, false) => {}
                    (false, true) => notes.push(format!(
                        "{of} both faces are held at {fibres} place(s), so that fibres through the thickness cannot turn: clamped \
                         (hinged with `mid_surface`)"
                    )),
                    (false, false) => {
                        let axes: Vec<&str> = held
                            .iter()
                            .map(|(c, _)| ["x", "y", "z"][*c as usize])
                            .collect();
                        warnings.push(format!(
                            "support `{name}`: it holds both faces of body `{}` alike along {} at {fibres} place(s), so that fibres through \
                             the thickness cannot turn: the border is clamped, not hinged, which may change stiffness by a large part. With \
                             `mid_surface` they turn freely; hold all three components where a clamp is meant",
                            body.name,
                            axes.join(" and ")
                        ));
                    }
                }
            }
        }
        self.warnings.extend(warnings);
        self.notes.extend(notes);
        Ok(())
    }
}

impl Builder<'_> {
    /// Nodes that supports hold where they are along an axis, with its number.
    ///
    /// # Errors
    /// A set that there is not.
    fn held_along(&self) -> Result<HashSet<(u32, usize)>, ModelError> {
        let mut held = HashSet::new();
        for (name, support) in &self.scene.supports {
            let plane = support.symmetry.or(support.plane_strain);
            let Some(&[(axis, _)]) = plane.map(|_| components(support)).as_deref() else {
                continue;
            };
            for (at, reference) in support.on.places(&format!("/supports/{name}/on")) {
                let (_, nodes) = self.set_nodes(reference, &at)?;
                held.extend(nodes.into_iter().map(|node| (node, axis as usize)));
            }
        }
        Ok(held)
    }
}

/// A line through the thickness of a thin body at its border.
struct BorderFibre {
    /// Its ends, as nodes of the model.
    nodes: [u32; 2],
    ends: [Vec3; 2],
    /// Unit vectors along it, and into the body across the border.
    along: Vec3,
    inward: Vec3,
    /// Length of the elements across the border.
    width: f64,
}

impl BorderFibre {
    /// Whether both ends are held alike in a direction of which a large part lies along `way`.
    fn held(&self, way: &Vec3, values: &[(usize, Option<TimeFunction>)], end: f64) -> bool {
        let mut parts = (values.iter())
            .filter(|(c, _)| way[*c].abs() > ACROSS)
            .peekable();
        parts.peek().is_some() && parts.all(|(_, v)| alike(v.as_ref(), self.ends, end))
    }
}

/// Fibres at the border of a thin body both of whose ends are in the set.
fn border_fibres(
    body: &BodyModel,
    (set, flat): (&BTreeSet<u32>, &HashSet<(u32, usize)>),
) -> Vec<BorderFibre> {
    let columns = ThicknessColumns::new(&body.mesh);
    let [low, high] = body.mesh.bounds();
    let mut beside: BTreeMap<u32, Vec<usize>> = BTreeMap::new();
    for e in 0..body.mesh.elements() {
        for node in body.mesh.element(e) {
            if set.contains(&(node + body.first_node)) {
                beside.entry(*node).or_default().push(e);
            }
        }
    }
    let fibre = |node: &u32| {
        let [bottom, top] = columns.ends(*node - body.first_node)?;
        let nodes = [bottom, top].map(|n| n + body.first_node);
        // Every fibre once.
        if *node != nodes[0] || !set.contains(&nodes[1]) {
            return None;
        }
        let ends = [bottom, top].map(|n| body.mesh.nodes[n as usize]);
        let along = ends[1] - ends[0];
        if along.norm() > SHELL * (high - low).norm() {
            return None;
        }
        let along = along.normalize();
        // A slice in plane strain is thin, and no shell.
        let axis = along.iamax();
        if nodes.iter().all(|n| flat.contains(&(*n, axis))) {
            return None;
        }
        let middle = (ends[0] + ends[1]) * 0.5;
        let own = &beside[&bottom];
        let (mut inward, mut width) = (Vec3::zeros(), 0.0);
        for e in own {
            let way = body.mesh.element_center(*e) - middle;
            let way = way - along * along.dot(&way);
            inward += way.try_normalize(0.0).unwrap_or_default();
        }
        // Inside of the shell, or at an end of the border, nothing is said.
        let inward = inward.try_normalize(0.1)?;
        for e in own {
            let way = body.mesh.element_center(*e) - middle;
            width += 2.0 * way.dot(&inward) / own.len() as f64;
        }
        Some(BorderFibre {
            nodes,
            ends,
            along,
            inward,
            width,
        })
    };
    set.iter().filter_map(fibre).collect()
}

/// Whether a prescribed displacement is the same at both ends of a fibre.
fn alike(value: Option<&TimeFunction>, ends: [Vec3; 2], end: f64) -> bool {
    let Some(value) = value else { return true };
    TIMES.iter().all(|part| {
        let at = |x: &Vec3| value.eval_at(x, part * end).ok();
        match (at(&ends[0]), at(&ends[1])) {
            (Some(a), Some(b)) => (a - b).abs() <= 1e-9 * a.abs().max(b.abs()),
            _ => false,
        }
    })
}
