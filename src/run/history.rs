//! Rows of `history.csv`.
use super::commit::FrictionTotals;
use super::fields::Fields;
use super::probes;
use super::watch::Watch;
use crate::assembly::PairForce;
use crate::model::{Model, PairModel};
use crate::solve::newton::Converged;
use covact_geometry::Vec3;

/// What a row is made of.
pub struct Record<'a> {
    pub model: &'a Model,
    pub step: u32,
    pub time: f64,
    pub dt: f64,
    pub cuts: u32,
    /// Iterations of the step's attempts that failed.
    pub failed: u32,
    pub converged: &'a Converged,
    pub sliding: &'a FrictionTotals,
    /// Energy that stabilisation has dissipated since the start, and the share of its forces in this step.
    pub stabilized: (f64, f64),
    /// Residual at all degrees of freedom: reactions at the constrained ones.
    pub residual: &'a [f64],
    /// Displacements, 3 per node.
    pub u: &'a [f64],
    pub fields: &'a Fields,
    pub watch: &'a Watch,
}

const AXES: [&str; 3] = ["x", "y", "z"];

/// Column names of a model, in the order of [`row`].
pub fn columns(model: &Model) -> Vec<String> {
    let start = [
        "step",
        "time",
        "dt",
        "iterations",
        "iterations.failed",
        "cuts",
        "residual",
    ];
    let mut names: Vec<String> = start.map(String::from).to_vec();
    let acting = (model.surfaces.iter().map(|s| &s.name)).chain(&model.supports);
    for name in acting {
        for quantity in ["force", "moment"] {
            names.extend(AXES.map(|axis| format!("{quantity}.{name}.{axis}")));
        }
    }
    for (_, surface, _) in model.driven() {
        for quantity in [
            "displacement",
            "rotation",
            "force_balance",
            "moment_balance",
        ] {
            names.extend(AXES.map(|axis| format!("{quantity}.{}.{axis}", surface.name)));
        }
    }
    for (_, pair) in deformable(model) {
        for side in ["slave", "master"] {
            for quantity in ["force", "moment"] {
                names.extend(AXES.map(|axis| format!("{side}.{quantity}.{}.{axis}", pair.name)));
            }
        }
        for quantity in ["force", "moment"] {
            names.push(format!("imbalance.{quantity}.{}", pair.name));
        }
    }
    names.extend(
        [
            "energy.internal",
            "energy.contact",
            "penetration.max",
            "gap.min",
            "pressure.max",
            "area.contact",
            "points.active",
            "points.changed",
        ]
        .map(String::from),
    );
    if augmented(model) {
        names.push("augmentations".into());
    }
    if frictional(model) {
        names.extend(
            [
                "energy.friction",
                "energy.dissipated",
                "points.stick",
                "points.slip",
            ]
            .map(String::from),
        );
    }
    if model.flows() {
        names.push("energy.plastic".into());
    }
    if model.stabilization.is_some() {
        names.extend(["energy.stabilization", "stabilization.share"].map(String::from));
    }
    if model.dynamics.is_some() {
        names.extend(["energy.kinetic", "energy.damping"].map(String::from));
        if viscous(model) {
            names.push("energy.viscosity".into());
        }
    }
    names.extend(["energy.external", "energy.adjusted"].map(String::from));
    names.push(match model.dynamics {
        Some(_) => "energy.integrator".into(),
        None => "energy.imbalance".into(),
    });
    names.extend(probes::columns(model));
    names
}

/// The values of one accepted step.
pub fn row(r: &Record) -> Vec<f64> {
    let totals = &r.converged.totals;
    let last = r.converged.history.last().copied().unwrap_or((0.0, 0));
    let changed = r.converged.history.iter().map(|h| h.1).max().unwrap_or(0);
    let mut out = vec![
        f64::from(r.step),
        r.time,
        r.dt,
        f64::from(r.converged.iterations),
        f64::from(r.failed),
        f64::from(r.cuts),
        last.0,
    ];
    for s in &totals.surfaces {
        out.extend(s.force.iter().chain(s.moment.iter()));
    }
    for (force, moment) in reactions(r.model, r.residual, r.u) {
        out.extend(force.iter().chain(moment.iter()));
    }
    for (index, surface, driven) in r.model.driven() {
        let (moved, theta) = driven.motion(r.u);
        let given = driven
            .given(r.time)
            .and_then(|given| Ok((given, surface.center(r.time, r.u)?)));
        let on = &totals.surfaces[index];
        let (force, moment) = match given {
            Ok(((force, moment), center)) => (
                force - on.force,
                moment - (on.moment - center.cross(&on.force)),
            ),
            Err(_) => (Vec3::repeat(f64::NAN), Vec3::repeat(f64::NAN)),
        };
        for v in [moved, theta * 180.0 / std::f64::consts::PI, force, moment] {
            out.extend(v.iter());
        }
    }
    for (index, _) in deformable(r.model) {
        let PairForce { slave, master } = totals.pairs[index];
        for side in [slave, master] {
            out.extend(side.force.iter().chain(side.moment.iter()));
        }
        out.push((slave.force + master.force).norm());
        out.push((slave.moment + master.moment).norm());
    }
    out.extend([
        totals.internal_energy,
        totals.contact_energy,
        totals.penetration.iter().fold(0.0, |a, b| f64::max(a, *b)),
        r.fields.smallest_gap,
        r.fields.largest_pressure,
        r.fields.area,
        totals.active as f64,
        changed as f64,
    ]);
    if augmented(r.model) {
        out.push(f64::from(r.converged.augmentations));
    }
    if frictional(r.model) {
        let s = r.sliding;
        out.extend([s.stored, s.dissipated, s.stick as f64, s.slip as f64]);
    }
    if r.model.flows() {
        out.push(totals.plastic_work);
    }
    if r.model.stabilization.is_some() {
        out.extend([r.stabilized.0, r.stabilized.1]);
    }
    if r.model.dynamics.is_some() {
        out.extend([totals.motion.kinetic, totals.motion.damped]);
        if viscous(r.model) {
            out.push(totals.motion.viscous);
        }
    }
    out.extend([r.watch.external, r.watch.adjusted, r.watch.imbalance]);
    out.extend(probes::values(r.model, r.time, r.u, r.residual, r.fields));
    out
}

/// Whether material is viscous.
fn viscous(model: &Model) -> bool {
    let own = model.dynamics.as_ref();
    own.is_some_and(|d| !d.dashpots.is_empty())
}

/// Whether any contact has multipliers.
fn augmented(model: &Model) -> bool {
    model.pairs.iter().any(|p| p.augmentation.is_some())
}

/// Whether any contact has friction.
fn frictional(model: &Model) -> bool {
    model.pairs.iter().any(|p| p.friction.is_some())
}

/// Contacts whose master is a body, with their numbers; all passes of one are one.
fn deformable(model: &Model) -> impl Iterator<Item = (usize, &PairModel)> {
    let pairs = model.pairs.iter().enumerate();
    pairs.filter(|(_, p)| p.body_master().is_some() && !p.is_second())
}

/// Force and moment about the origin that each support exerts on the deformed body.
fn reactions(model: &Model, residual: &[f64], u: &[f64]) -> Vec<(Vec3, Vec3)> {
    let mut out = vec![(Vec3::zeros(), Vec3::zeros()); model.supports.len()];
    let mut add = |support: u32, dof: u32, value: f64| {
        let mut f = Vec3::zeros();
        f[dof as usize % 3] = value;
        let (force, moment) = &mut out[support as usize];
        *force += f;
        let at = match model.small {
            None => model.position(dof as usize / 3, u),
            // In equilibrium where everything was at the start.
            Some(_) => model.nodes[dof as usize / 3],
        };
        *moment += at.cross(&f);
    };
    for p in &model.prescribed {
        add(p.support, p.dof, residual[p.dof as usize]);
    }
    for t in &model.tied {
        add(t.support, t.dof, residual[t.dof as usize]);
    }
    for m in &model.means {
        let half = residual[m.tied as usize];
        add(m.support, m.tied, half);
        match m.held_by {
            None => add(m.support, m.free, residual[m.free as usize]),
            // The residual there is that of two supports.
            Some(other) => {
                add(m.support, m.free, half);
                add(other, m.free, -half);
            }
        }
    }
    out
}
