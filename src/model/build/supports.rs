//! Supports as constraints: which degrees of freedom they prescribe or tie, and whether they contradict each other.
use super::super::Tied;
use super::super::constraints::{MeanPrescribed, Prescribed};
use super::super::error::{At, number, text};
use super::sheet_supports::{HeldAnchors, SheetSupports, held_anchors};
use super::{BodyModel, Builder, ModelError};
use crate::mesh::{Border, ThicknessColumns};
use crate::scene::{AUTOMATIC, Axis, POSITION_AND_TIME, Support, TimeFunction, Value};
use crate::shell::HeldNormal;
use crate::system::{Dof, DofMap, DofMapBuilder};
use covact_geometry::Vec3;
use std::collections::{BTreeMap, BTreeSet};

/// All supports of a scene.
pub(super) struct Supports {
    /// Names, in the order of the indices below.
    pub names: Vec<String>,
    pub prescribed: Vec<Prescribed>,
    pub means: Vec<MeanPrescribed>,
    pub tied: Vec<Tied>,
    pub dofs: DofMap,
    /// Borders of sheets, by body, whose normal is held.
    pub held_normals: Vec<(usize, Border, HeldNormal)>,
    /// Of each body the anchors on curves of trims that are held.
    pub held_anchors: Vec<HeldAnchors>,
}

/// Displacement over time, `None` standing for zero.
type Prescription = Option<TimeFunction>;

struct Collector<'a> {
    nodes: &'a [Vec3],
    end_time: f64,
    names: Vec<String>,
    prescribed: Vec<Prescribed>,
    means: Vec<MeanPrescribed>,
    dofs: DofMapBuilder,
    /// Support and displacement of every prescribed degree of freedom.
    owners: BTreeMap<u32, (u32, Prescription)>,
    /// The same of every prescribed mean, by the degree of freedom at the bottom.
    mean_owners: BTreeMap<u32, (u32, Prescription)>,
}

impl Builder<'_> {
    /// Resolves all supports; `held` are degrees of freedom that stay zero besides.
    ///
    /// # Errors
    /// [`ModelError`] for unknown sets, values that do not compile, and supports that contradict each other.
    pub(super) fn supports(&self, held: &[u32]) -> Result<Supports, ModelError> {
        let scene = self.scene;
        let mut all = Collector {
            nodes: &self.nodes,
            end_time: scene.solution.end_time,
            names: (scene.supports.keys().cloned())
                .chain(scene.finds_supports().then(|| AUTOMATIC.to_owned()))
                .collect(),
            prescribed: Vec::new(),
            means: Vec::new(),
            dofs: DofMapBuilder::new(self.nodes.len()),
            owners: BTreeMap::new(),
            mean_owners: BTreeMap::new(),
        };
        let mut columns: BTreeMap<usize, ThicknessColumns> = BTreeMap::new();
        let mut sheets = SheetSupports::default();
        let stage = scene.stages.get(self.stage);
        let active = |name: &str| stage.is_none_or(|stage| stage.holds(name));
        // Supports of single nodes first: where one of a column is held, the mean moves the other.
        for mid_surface in [false, true] {
            for (index, (name, support)) in scene.supports.iter().enumerate() {
                if support.mid_surface != mid_surface || !active(name) {
                    continue;
                }
                self.sheet_support((index as u32, name, support), &mut sheets)?;
                let pointer = |field: &str| format!("/supports/{name}/{field}");
                let (mut nodes, mut pairs) = (Vec::new(), BTreeSet::new());
                for (at, reference) in support.on.places(&pointer("on")) {
                    let (body, own) = self.set_nodes(reference, &at)?;
                    if mid_surface {
                        let body = &self.bodies[body];
                        let columns = (columns.entry(body.first_node as usize))
                            .or_insert_with(|| ThicknessColumns::new(&body.mesh));
                        pairs.extend(ends(body, columns, &own).map_err(|node| {
                            let message =
                                format!("node {node} has no partner through the thickness");
                            text(pointer("mid_surface"), message)
                                .help("a mid-surface support needs nodes on both faces of a shell")
                        })?);
                    }
                    nodes.extend(own);
                }
                for (component, value) in components(support) {
                    let value = (value.map(|v| v.compile(&POSITION_AND_TIME)).transpose())
                        .at(|| pointer("displacement"))?;
                    let index = index as u32;
                    if mid_surface {
                        for [bottom, top] in &pairs {
                            all.mean(index, component, [*bottom, *top], &value)?;
                        }
                    } else {
                        for node in &nodes {
                            all.node(index, 3 * node + component, &value)?;
                        }
                    }
                }
            }
        }
        for &dof in held {
            (all.dofs.prescribe(dof)).at(|| "/surfaces".to_owned())?;
        }
        let owner = |dof: u32| all.owners.get(&dof).map(|(support, _)| *support);
        let unused: BTreeSet<u32> = (self.bodies.iter())
            .filter_map(|body| Some((body.block.sheet()?, body.first_node)))
            .flat_map(|(sheet, first)| sheet.unused().into_iter().map(move |[n, _]| n + first))
            .collect();
        let tied = (sheets.tie(&mut all.dofs, &unused, owner)).at(|| "/supports".to_owned())?;
        for body in &self.bodies {
            let unused = body.block.sheet().map(|s| s.unused());
            for pair in unused.into_iter().flatten() {
                for c in 0..3 {
                    let [dof, to] = pair.map(|n| 3 * (n + body.first_node) + c);
                    if all.dofs.get(dof) == Some(Dof::Free) {
                        (all.dofs.tie(dof, to, 1.0)).at(|| "/supports".to_owned())?;
                    }
                }
            }
        }
        let held_anchors =
            held_anchors(&self.bodies, &mut all.dofs).at(|| "/supports".to_owned())?;
        let dofs = all.dofs.build().at(|| "/supports".to_owned())?;
        Ok(Supports {
            names: all.names,
            prescribed: all.prescribed,
            means: all.means,
            tied,
            dofs,
            held_normals: sheets.held,
            held_anchors,
        })
    }
}

/// Bottom and top node of the columns through `nodes`, in numbers of the model; the error is a node of the mesh without
/// a column.
fn ends(
    body: &BodyModel,
    columns: &ThicknessColumns,
    nodes: &[u32],
) -> Result<BTreeSet<[u32; 2]>, u32> {
    let first = body.first_node;
    (nodes.iter())
        .map(|node| {
            let node = node - first;
            let ends = columns.ends(node).ok_or(node)?;
            Ok(ends.map(|n| n + first))
        })
        .collect()
}

impl Collector<'_> {
    fn node(&mut self, support: u32, dof: u32, value: &Prescription) -> Result<(), ModelError> {
        let x = self.nodes[dof as usize / 3];
        if let Some((other, earlier)) = self.owners.get(&dof) {
            if agree(&[(earlier, x)], value, x, self.end_time) {
                return Ok(());
            }
            return Err(self.conflict(*other, support, dof));
        }
        self.owners.insert(dof, (support, value.clone()));
        self.dofs.prescribe(dof).at(|| self.pointer(support))?;
        self.prescribed.push(Prescribed {
            dof,
            support,
            value: value.clone(),
        });
        Ok(())
    }

    fn mean(
        &mut self,
        support: u32,
        component: u32,
        ends: [u32; 2],
        value: &Prescription,
    ) -> Result<(), ModelError> {
        let [bottom, top] = ends.map(|n| 3 * n + component);
        let [low, high] = ends.map(|n| self.nodes[n as usize]);
        let middle = (low + high) * 0.5;
        if let Some((other, earlier)) = self.mean_owners.get(&bottom) {
            if agree(&[(earlier, middle)], value, middle, self.end_time) {
                return Ok(());
            }
            return Err(self.conflict(*other, support, bottom));
        }
        let (free, tied, held_by) = match (self.owners.get(&bottom), self.owners.get(&top)) {
            (Some((other, below)), Some((_, above))) => {
                let both = [(below, low), (above, high)];
                if agree(&both, value, middle, self.end_time) {
                    return Ok(());
                }
                return Err(self.conflict(*other, support, bottom));
            }
            (None, Some((other, _))) => (top, bottom, Some(*other)),
            (Some((other, _)), None) => (bottom, top, Some(*other)),
            (None, None) => (bottom, top, None),
        };
        self.mean_owners.insert(bottom, (support, value.clone()));
        self.dofs
            .tie(tied, free, -1.0)
            .at(|| self.pointer(support))?;
        self.means.push(MeanPrescribed {
            free,
            tied,
            support,
            held_by,
            mean: value.clone(),
        });
        Ok(())
    }

    fn pointer(&self, support: u32) -> String {
        format!("/supports/{}/on", self.names[support as usize])
    }

    fn conflict(&self, one: u32, other: u32, dof: u32) -> ModelError {
        // In the order of their names, whichever was met first.
        let [first, second] = [one.min(other), one.max(other)];
        let name = |s: u32| &self.names[s as usize];
        let x = self.nodes[dof as usize / 3];
        let message = format!(
            "supports `{}` and `{}` prescribe different displacements along {} of the node at ({}, {}, {})",
            name(first),
            name(second),
            ["x", "y", "z"][dof as usize % 3],
            number(x.x),
            number(x.y),
            number(x.z)
        );
        text(self.pointer(second), message)
            .help("take the node out of one of the two sets, or prescribe the same value in both")
    }
}

/// Whether the mean of what others prescribe at their positions is `value` at `x`, as where a symmetry plane meets
/// another support: compared at a few times, relative to the largest value.
fn agree(others: &[(&Prescription, Vec3)], value: &Prescription, x: Vec3, end: f64) -> bool {
    let at = |f: &Prescription, x: &Vec3, t: f64| match f {
        None => Some(0.0),
        Some(f) => f.eval_at(x, t).ok(),
    };
    [0.0, 0.31, 0.77, 1.0].iter().all(|s| {
        let t = s * end;
        let given: Option<Vec<f64>> = others.iter().map(|(f, x)| at(f, x, t)).collect();
        match (given, at(value, &x, t)) {
            (Some(given), Some(value)) => {
                let mean = given.iter().sum::<f64>() / given.len() as f64;
                let largest = given.iter().fold(value.abs(), |a, v| a.max(v.abs()));
                (mean - value).abs() <= 1e-12 * largest
            }
            _ => false,
        }
    })
}

/// Constrained components of a support, `None` standing for zero.
pub(super) fn components(support: &Support) -> Vec<(u32, Option<Value>)> {
    let zero = |v: &Value| *v == Value::Number(0.0);
    if support.fixed || support.clamped {
        let moved = support.displacement.as_ref().filter(|_| support.clamped);
        let value = |c: u32| {
            let d = moved.map(|d| [&d.x, &d.y, &d.z][c as usize]);
            d.and_then(|v| v.as_ref().filter(|v| !zero(v)).cloned())
        };
        return (0..3).map(|c| (c, value(c))).collect();
    }
    if let Some(axis) = support.symmetry.or(support.plane_strain) {
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
    ([&d.x, &d.y, &d.z].into_iter().enumerate())
        .filter_map(|(c, v)| {
            v.as_ref()
                .map(|v| (c as u32, (!zero(v)).then(|| v.clone())))
        })
        .collect()
}
