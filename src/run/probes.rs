//! Columns of the history that follow tools and probes.
use super::fields::Fields;
use crate::model::probe::ProbeModel;
use crate::model::{Model, SurfaceModel};
use crate::output::{ProbeSummary, Table};
use crate::scene::{ProbeQuantity, ProbeTake};
use covact_geometry::Vec3;
use std::collections::BTreeMap;

const AXES: [&str; 3] = ["x", "y", "z"];

/// Surfaces that move.
fn moving(model: &Model) -> impl Iterator<Item = &SurfaceModel> {
    let moves = |s: &&SurfaceModel| s.motion.moves() || s.driven.is_some();
    model.surfaces.iter().filter(moves)
}

/// Names of the columns, in the order of [`values`].
pub fn columns(model: &Model) -> Vec<String> {
    let mut names = Vec::new();
    for surface in moving(model) {
        names.extend(AXES.map(|axis| format!("way.{}.{axis}", surface.name)));
        if surface.motion.turns() {
            names.push(format!("way.{}.angle", surface.name));
        }
    }
    for probe in &model.probes {
        match probe.is_scalar() {
            true => names.push(format!("probe.{}", probe.name)),
            false => names.extend(AXES.map(|axis| format!("probe.{}.{axis}", probe.name))),
        }
    }
    names
}

/// The values at an accepted state: displacements `u`, and the `residual` at all degrees of freedom, which is the reaction
/// at the constrained ones.
pub fn values(model: &Model, time: f64, u: &[f64], residual: &[f64], fields: &Fields) -> Vec<f64> {
    let mut out = Vec::new();
    for surface in moving(model) {
        let (prescribed, angle) = surface
            .motion
            .way(time)
            .unwrap_or((Vec3::repeat(f64::NAN), Some(f64::NAN)));
        let free = surface.driven.as_ref().map(|d| d.motion(u).0);
        out.extend((prescribed + free.unwrap_or_default()).iter());
        if surface.motion.turns() {
            out.extend(angle);
        }
    }
    if model.probes.is_empty() {
        return out;
    }
    let held = model
        .probes
        .iter()
        .any(|p| p.quantity == ProbeQuantity::Reaction)
        .then(|| held(model));
    for probe in &model.probes {
        match (probe.quantity, &held) {
            (ProbeQuantity::VonMises, _) => {
                let stress = probe.nodes.iter().map(|n| fields.von_mises[*n as usize]);
                out.push(scalar(probe.take, stress));
            }
            (ProbeQuantity::Reaction, Some(held)) => {
                let reaction = |dof: usize| if held[dof] { residual[dof] } else { 0.0 };
                vector(probe, reaction, &mut out);
            }
            (ProbeQuantity::Displacement | ProbeQuantity::Reaction, _) => {
                vector(probe, |dof| u[dof], &mut out);
            }
        }
    }
    out
}

/// Degrees of freedom that supports hold.
fn held(model: &Model) -> Vec<bool> {
    let mut held = vec![false; 3 * model.nodes.len()];
    let means = model.means.iter().flat_map(|m| [m.tied, m.free]);
    for dof in model.prescribed.iter().map(|p| p.dof).chain(means) {
        held[dof as usize] = true;
    }
    held
}

fn vector(probe: &ProbeModel, at: impl Fn(usize) -> f64, out: &mut Vec<f64>) {
    let nodes = probe.nodes.iter().map(|n| 3 * *n as usize);
    let values = nodes.map(|n| Vec3::new(at(n), at(n + 1), at(n + 2)));
    match probe.take {
        ProbeTake::Max => out.push(values.map(|v| v.norm()).fold(0.0, f64::max)),
        ProbeTake::Sum => out.extend(values.sum::<Vec3>().iter()),
        ProbeTake::Mean => {
            let count = probe.nodes.len().max(1) as f64;
            out.extend((values.sum::<Vec3>() / count).iter());
        }
    }
}

fn scalar(take: ProbeTake, values: impl ExactSizeIterator<Item = f64>) -> f64 {
    let count = values.len().max(1) as f64;
    match take {
        ProbeTake::Max => values.fold(f64::NEG_INFINITY, f64::max),
        ProbeTake::Sum => values.sum(),
        ProbeTake::Mean => values.sum::<f64>() / count,
    }
}

/// The last, the smallest and the largest value of every column of a probe.
pub fn summary(model: &Model, table: &Table) -> BTreeMap<String, ProbeSummary> {
    let own = |column: &&String| {
        let mut probes = model.probes.iter();
        probes.any(|p| {
            let rest = column
                .strip_prefix("probe.")
                .and_then(|c| c.strip_prefix(p.name.as_str()));
            rest.is_some_and(|rest| rest.is_empty() || rest.starts_with('.'))
        })
    };
    let columns = table.columns.iter().filter(own);
    let of = |column: &String| {
        let values = table.column(column)?;
        let last = *values.last()?;
        let min = values.iter().copied().fold(f64::INFINITY, f64::min);
        let max = values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        Some((column.clone(), ProbeSummary { last, min, max }))
    };
    columns.filter_map(of).collect()
}
