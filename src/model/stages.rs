//! Stages: the model of a part of the run. It has the bodies, surfaces and contacts of the whole scene, under the same numbers;
//! contacts that do not act in it have no slave points, and its supports are those that are active.
use super::constraints::Prescribed;
use super::error::{At, text};
use super::loads::DeadLoad;
use super::motion::WayBack;
use super::stabilization::StabilizationModel;
use super::{Model, ModelError, found_supports, histories};
use crate::scene::{AUTOMATIC, Load, Points, Scene, TIME, TimeFunction, Value};
use crate::system::{Dof, DofMapBuilder};
use std::collections::BTreeSet;

/// What a stage begins with beside the state that the one before has left.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct StageStart {
    /// Number of the stage in the scene.
    pub index: usize,
    /// Whether the first stage has a stabilisation, whose columns the history has.
    pub stabilized: bool,
    /// Energy that contacts which have ended have dissipated by friction.
    pub dissipated: f64,
    /// Largest force of a tool, or between bodies, when the stage before ended (force).
    pub force: f64,
    /// Forces that are let down in the course of the stage, by degrees of freedom (force).
    pub released: Vec<(u32, f64)>,
    /// Displacements that supports found by the program hold, by degrees of freedom (length).
    pub held: Vec<(u32, f64)>,
}

/// A stage of a model.
#[derive(Debug, Clone, PartialEq)]
pub struct StageModel {
    pub name: String,
    /// Times from which to which it goes.
    pub span: [f64; 2],
    /// No stage comes after it.
    pub last: bool,
    /// Contacts that end with it, because their tools go back.
    pub ending: Vec<String>,
    pub start: StageStart,
}

/// The scene with the motions and loads that its stages give as tables over time; nothing where they give none.
pub fn lowered(scene: &Scene) -> Option<Scene> {
    let given = |s: &crate::scene::Stage| !s.tools.is_empty() || !s.loads.is_empty();
    if !scene.stages.iter().any(given) {
        return None;
    }
    let mut out = scene.clone();
    let ends: Vec<f64> = (0..scene.stages.len())
        .map(|k| scene.stage_span(k)[1])
        .collect();
    // Rows of a table: nothing at the start, and what stages say at their ends.
    let table = |of: &dyn Fn(usize) -> Option<f64>| {
        let mut rows = vec![[0.0, 0.0]];
        for (k, end) in ends.iter().enumerate() {
            let before = rows[rows.len() - 1][1];
            rows.push([*end, of(k).unwrap_or(before)]);
        }
        Value::Table { table: rows }
    };
    for (name, surface) in &mut out.surfaces {
        if !scene.stages.iter().any(|s| s.tools.contains_key(name)) {
            continue;
        }
        for (c, value) in surface.motion.translation.iter_mut().enumerate() {
            *value = table(&|k| scene.stages[k].tools.get(name).map(|way| way[c]));
        }
    }
    for (name, load) in &mut out.loads {
        if !scene.stages.iter().any(|s| s.loads.contains_key(name)) {
            continue;
        }
        for value in numbers(load) {
            if let Value::Number(full) = *value {
                *value = table(&|k| scene.stages[k].loads.get(name).map(|f| f * full));
            }
        }
    }
    Some(out)
}

/// All values of a load.
fn numbers(load: &mut Load) -> impl Iterator<Item = &mut Value> {
    let vectors = [&mut load.force, &mut load.traction, &mut load.gravity];
    let vectors = vectors.into_iter().flatten().flatten();
    vectors.chain(&mut load.pressure).chain(&mut load.couple)
}

/// Makes of the model of a whole scene that of a stage. Where displacements `u` are given, supports are found for where they put
/// the bodies; else they are those of the start.
///
/// # Errors
/// [`ModelError`]: a support that is found on what is tied otherwise, which is a fault of the program.
pub fn enter(
    scene: &Scene,
    model: &mut Model,
    mut start: StageStart,
    u: Option<&[f64]>,
) -> Result<(), ModelError> {
    let index = start.index;
    let Some(stage) = scene.stages.get(index) else {
        return Ok(());
    };
    let active = scene.active_contacts(index);
    leave_out(model, &active);
    let mut held = rest(model);
    for (name, surface) in scene.surfaces.keys().zip(&mut model.surfaces) {
        let gone = (1..=index).find(|k| scene.returning_tools(*k).contains(name.as_str()));
        if let Some(gone) = gone {
            let [from, to] = scene.stage_span(gone);
            surface.motion.go_back(WayBack { from, to });
        }
    }
    if let (Some(u), true) = (u, stage.finds_supports()) {
        start.held = (found_supports::find(model, u).into_iter())
            .map(|dof| (dof, u[dof as usize]))
            .collect();
    }
    let given = start.held.iter().chain(&start.released);
    if given
        .into_iter()
        .any(|(dof, _)| *dof as usize >= model.dofs.dofs())
    {
        let message = "what the stage begins with belongs to another model";
        return Err(text(format!("/stages/{index}"), message));
    }
    let automatic = model.supports.iter().position(|name| name == AUTOMATIC);
    for &(dof, value) in &start.held {
        held.push(dof);
        model.prescribed.push(Prescribed {
            dof,
            support: automatic.unwrap_or_default() as u32,
            value: (value != 0.0).then(|| TimeFunction::constant(value)),
        });
    }
    hold(model, &held).at(|| format!("/stages/{index}/supports"))?;
    let span = scene.stage_span(index);
    if index > 0 {
        let [from, to] = span;
        let table = vec![[from, 1.0], [to, 0.0]];
        let factor =
            (Value::Table { table }.compile(&TIME)).at(|| format!("/stages/{index}/until"))?;
        let forces = start.released.clone();
        (model.dead_loads).push((stage.name.clone(), DeadLoad::Nodal { forces, factor }));
    }
    let ending = match scene.returning_tools(index).is_empty() {
        true => BTreeSet::new(),
        false => scene.ending_contacts(index),
    };
    model.stage = Some(StageModel {
        name: stage.name.clone(),
        span,
        last: index + 1 == scene.stages.len(),
        ending: ending.into_iter().map(str::to_owned).collect(),
        start,
    });
    Ok(())
}

/// Takes the slave points of contacts that do not act.
fn leave_out(model: &mut Model, active: &BTreeSet<&str>) {
    let mut nodes = 0;
    for pair in &mut model.pairs {
        if !active.contains(pair.name.as_str()) {
            pair.points.clear();
            pair.bow.clear();
            pair.below = None;
            (pair.overclosure, pair.averaged, pair.sampled) = (None, None, Points::Nodes);
        }
        if let Some(averaged) = &mut pair.averaged {
            averaged.renumber(nodes);
            nodes += averaged.len();
        }
    }
    histories::number(&mut model.pairs);
}

/// Lets surfaces that forces drive stand still where none of their contacts acts; returns their degrees of freedom.
fn rest(model: &mut Model) -> Vec<u32> {
    let mut held = Vec::new();
    for (index, surface) in model.surfaces.iter_mut().enumerate() {
        let acts = |p: &super::PairModel| p.rigid_master() == Some(index) && !p.points.is_empty();
        let touched = model.pairs.iter().any(acts);
        if let Some(driven) = surface.driven.as_mut().filter(|_| !touched) {
            driven.loads = Default::default();
            held.extend((0..6).map(|c| driven.dof(c) as u32));
        }
    }
    held
}

/// Prescribes more degrees of freedom.
fn hold(model: &mut Model, more: &[u32]) -> Result<(), crate::system::ConstraintError> {
    if more.is_empty() {
        return Ok(());
    }
    let mut builder = DofMapBuilder::new(model.nodes.len());
    for dof in 0..model.dofs.dofs() {
        match model.dofs.dof(dof) {
            Dof::Free => {}
            Dof::Prescribed => builder.prescribe(dof as u32)?,
            Dof::Tied {
                dof: to,
                coefficient,
            } => builder.tie(dof as u32, to, coefficient)?,
        }
    }
    more.iter().try_for_each(|dof| builder.prescribe(*dof))?;
    model.dofs = builder.build()?;
    Ok(())
}

/// The stabilisation of a later stage: its columns are in the history where the first stage has one, and in no other case may
/// it have one.
///
/// # Errors
/// A body that nothing holds in a stage, where the stages before needed no stabilisation.
pub fn stabilized(model: &mut Model) -> Result<(), ModelError> {
    let Some(stage) = &model.stage else {
        return Ok(());
    };
    let StageStart {
        index, stabilized, ..
    } = stage.start;
    match (index, &model.stabilization, stabilized) {
        (0, ..) | (_, Some(_), true) | (_, None, false) => {}
        (_, None, true) => {
            model.stabilization = Some(StabilizationModel {
                coefficient: 0.0,
                until: 0.0,
                released: false,
                weights: vec![0.0; 3 * model.nodes.len()],
                free: Vec::new(),
                size: 0.0,
            });
        }
        (_, Some(stabilization), false) => {
            let free = stabilization.free.first().map(|piece| &piece.motion);
            let (body, motion) = free.map_or(("", ""), |f| (&f.body, &f.motion));
            let message = format!(
                "in the stage `{}` body `{body}` can move freely {motion}: no active support hinders it",
                stage.name
            );
            let help = format!(
                "where the body is free of forces, add `{AUTOMATIC}` to the `supports` of the stage, which holds it without any; where \
                 friction drives or holds it, keep a support that acts along another direction, or write the stages as tables over \
                 time in one run, where contact may hold a body"
            );
            return Err(text(format!("/stages/{index}/supports"), message).help(help));
        }
    }
    Ok(())
}

/// Times at which stages end and tools that go back have a kink, beside those of values.
pub fn kinks<'a>(scene: &'a Scene, model: &'a Model) -> impl Iterator<Item = f64> + 'a {
    let ends = scene.stages.iter().filter_map(|s| s.until);
    ends.chain(model.surfaces.iter().flat_map(|s| s.motion.kinks_back()))
}
