//! Supports: which displacement components are prescribed, and by whom.
use super::super::constraints::{MeanPrescribed, Prescribed};
use super::super::error::{At, number, text};
use super::{Builder, ModelError};
use crate::assembly::{DofMap, DofMapBuilder};
use crate::mesh::ThicknessColumns;
use crate::scene::{self, Axis, POSITION_AND_TIME, TimeFunction, Value};
use covact_geometry::Vec3;
use std::collections::{BTreeMap, BTreeSet};

/// What the supports come to.
pub(super) struct Supports {
    pub names: Vec<String>,
    pub prescribed: Vec<Prescribed>,
    pub means: Vec<MeanPrescribed>,
    pub dofs: DofMap,
}

/// The support that already prescribes a component of a node.
struct Claim {
    support: u32,
    value: Option<TimeFunction>,
    /// For a mid-surface support, which prescribes a mean: the component on the other face.
    bottom: Option<u32>,
}

/// Supports on their way into the model.
struct Collector<'b> {
    nodes: &'b [Vec3],
    end_time: f64,
    names: Vec<String>,
    claims: BTreeMap<u32, Claim>,
    prescribed: Vec<Prescribed>,
    means: Vec<MeanPrescribed>,
    dofs: DofMapBuilder,
}

impl Builder<'_> {
    pub(super) fn supports(&self) -> Result<Supports, ModelError> {
        let mut collector = Collector {
            nodes: &self.nodes,
            end_time: self.scene.solution.end_time,
            names: Vec::new(),
            claims: BTreeMap::new(),
            prescribed: Vec::new(),
            means: Vec::new(),
            dofs: DofMapBuilder::new(self.nodes.len()),
        };
        let mut columns: BTreeMap<usize, ThicknessColumns> = BTreeMap::new();
        for (name, support) in &self.scene.supports {
            let pointer = |field: &str| format!("/supports/{name}/{field}");
            collector.names.push(name.clone());
            let (body, nodes) = self.set_nodes(&support.on, &pointer("on"))?;
            let (mesh, first) = (&self.bodies[body].mesh, self.bodies[body].first_node);
            for (component, value) in components(support) {
                let value = match &value {
                    None => None,
                    Some(v) => Some(
                        v.compile(&POSITION_AND_TIME)
                            .at(|| pointer("displacement"))?,
                    ),
                };
                let dof = |n: u32| 3 * n + component;
                if !support.mid_surface {
                    for &node in &nodes {
                        collector.prescribe(&pointer("on"), dof(node), &value)?;
                    }
                    continue;
                }
                let columns = columns
                    .entry(body)
                    .or_insert_with(|| ThicknessColumns::new(mesh));
                let mut done = BTreeSet::new();
                for &node in &nodes {
                    let Some([bottom, top]) = columns.ends(node - first) else {
                        let message =
                            format!("node {} has no partner through the thickness", node - first);
                        let help = "a mid-surface support needs nodes on both faces of a shell";
                        return Err(text(pointer("mid_surface"), message).help(help));
                    };
                    if done.insert(bottom) {
                        let ends = [dof(bottom + first), dof(top + first)];
                        collector.prescribe_mean(&pointer("on"), ends, &value)?;
                    }
                }
            }
        }
        let dofs = collector.dofs.build().at(|| "/supports".to_owned())?;
        Ok(Supports {
            names: collector.names,
            prescribed: collector.prescribed,
            means: collector.means,
            dofs,
        })
    }
}

impl Collector<'_> {
    /// The present support prescribes one component.
    fn prescribe(
        &mut self,
        pointer: &str,
        dof: u32,
        value: &Option<TimeFunction>,
    ) -> Result<(), ModelError> {
        if let Some(claim) = self.claims.get(&dof) {
            self.compare(pointer, dof, value, claim)?;
            return match claim.bottom {
                // The mean of both faces and this one are prescribed alike: then the other one is, too.
                Some(bottom) if !self.claims.contains_key(&bottom) => {
                    self.prescribe(pointer, bottom, value)
                }
                _ => Ok(()),
            };
        }
        let support = self.claim(dof, value, None);
        self.dofs.prescribe(dof).at(|| pointer.to_owned())?;
        self.prescribed.push(Prescribed {
            dof,
            support,
            value: value.clone(),
        });
        Ok(())
    }

    /// The present support prescribes the mean of a component over both faces, `[bottom, top]`.
    fn prescribe_mean(
        &mut self,
        pointer: &str,
        [bottom, top]: [u32; 2],
        value: &Option<TimeFunction>,
    ) -> Result<(), ModelError> {
        if let Some(claim) = self.claims.get(&top) {
            self.compare(pointer, top, value, claim)?;
            // With one face and the mean prescribed alike the other face is, too.
            return match claim.bottom {
                Some(_) => Ok(()),
                None => self.prescribe(pointer, bottom, value),
            };
        }
        let support = self.claim(top, value, Some(bottom));
        self.dofs.tie(top, bottom, -1.0).at(|| pointer.to_owned())?;
        self.means.push(MeanPrescribed {
            free: bottom,
            tied: top,
            support,
            mean: value.clone(),
        });
        Ok(())
    }

    fn claim(&mut self, dof: u32, value: &Option<TimeFunction>, bottom: Option<u32>) -> u32 {
        let support = self.names.len() as u32 - 1;
        let value = value.clone();
        self.claims.insert(
            dof,
            Claim {
                support,
                value,
                bottom,
            },
        );
        support
    }

    /// Refuses a value that differs from an earlier support's.
    fn compare(
        &self,
        pointer: &str,
        dof: u32,
        value: &Option<TimeFunction>,
        claim: &Claim,
    ) -> Result<(), ModelError> {
        let x = self.nodes[dof as usize / 3];
        if agree(&claim.value, value, x, self.end_time) {
            return Ok(());
        }
        let message = format!(
            "supports `{}` and `{}` prescribe different displacements along {} of the node at ({}, {}, {})",
            self.names[claim.support as usize],
            self.names.last().map_or("", String::as_str),
            ["x", "y", "z"][dof as usize % 3],
            number(x.x),
            number(x.y),
            number(x.z),
        );
        let help = "take the node out of one of the two sets, or prescribe the same value in both";
        Err(text(pointer, message).help(help))
    }
}

/// Whether two supports prescribe the same displacement at `x`, as they may where a symmetry plane meets another
/// support: compared at a few times, relative to the largest value.
fn agree(a: &Option<TimeFunction>, b: &Option<TimeFunction>, x: Vec3, end: f64) -> bool {
    let value = |f: &Option<TimeFunction>, t: f64| match f {
        None => Some(0.0),
        Some(f) => f.eval_at(&x, t).ok(),
    };
    [0.0, 0.31, 0.77, 1.0].iter().all(|s| {
        let t = s * end;
        match (value(a, t), value(b, t)) {
            (Some(a), Some(b)) => (a - b).abs() <= 1e-12 * a.abs().max(b.abs()),
            _ => false,
        }
    })
}

/// Constrained components of a support, `None` standing for zero.
fn components(support: &scene::Support) -> Vec<(u32, Option<Value>)> {
    if support.fixed {
        return (0..3).map(|c| (c, None)).collect();
    }
    if let Some(axis) = support.symmetry {
        let c = match axis {
            Axis::X => 0,
            Axis::Y => 1,
            Axis::Z => 2,
        };
        return vec![(c, None)];
    }
    let Some(d) = &support.displacement else {
        return Vec::new();
    };
    let zero = |v: &Value| *v == Value::Number(0.0);
    ([&d.x, &d.y, &d.z].into_iter().enumerate())
        .filter_map(|(c, v)| {
            v.as_ref()
                .map(|v| (c as u32, (!zero(v)).then(|| v.clone())))
        })
        .collect()
}
