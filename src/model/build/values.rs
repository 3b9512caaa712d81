//! What is prescribed over a run: its kinks, and expressions that have no value somewhere, found before anything is solved.
use super::super::error::At;
use super::{Model, ModelError, Scene};
use crate::model::stages;
use crate::scene::{InitialOverclosure, LoadedScene, Stabilization, TimeFunction, ValueError};
use covact_geometry::Vec3;
use std::collections::BTreeMap;

/// Times at which functions of time alone are tried.
const TIMES: usize = 64;
/// Times at which functions of position are tried, each at up to [`POINTS`] points.
const FEW_TIMES: usize = 4;
const POINTS: usize = 300;

/// Evaluates everything prescribed at times over the run (its stops and kinks included).
pub(super) fn check(scene: &Scene, model: &Model) -> Result<(), ModelError> {
    let end = scene.solution.end_time;
    let stops = (scene.solution.stops.iter())
        .chain(&model.kinks)
        .filter(|t| **t <= end);
    let times: Vec<f64> = evenly(end, TIMES).chain(stops.copied()).collect();
    let help = "everything prescribed needs a value at all times of the run";
    let told = |r: Result<(), ValueError>, pointer: &dyn Fn() -> String| {
        r.at(pointer).map_err(|e| e.help(help))
    };
    for surface in &model.surfaces {
        for f in surface.motion.functions() {
            told(in_time(f, &times), &|| {
                format!("/surfaces/{}/motion", surface.name)
            })?;
        }
    }
    for (_, surface, driven) in model.driven() {
        for f in driven.loads.iter().flatten() {
            told(in_time(f, &times), &|| {
                format!("/surfaces/{}/motion/free", surface.name)
            })?;
        }
    }
    for pair in &model.pairs {
        if let Some(friction) = &pair.friction {
            let pointer = || format!("/contacts/{}/friction", pair.name);
            told(
                times.iter().try_for_each(|&t| friction.law.at(t).map(drop)),
                &pointer,
            )?;
        }
    }
    let mut supports: BTreeMap<u32, Vec<(u32, &TimeFunction)>> = BTreeMap::new();
    let means = (model.means.iter()).map(|m| (m.support, m.free, &m.mean));
    for (support, dof, value) in (model.prescribed.iter())
        .map(|p| (p.support, p.dof, &p.value))
        .chain(means)
    {
        if let Some(value) = value {
            supports.entry(support).or_default().push((dof, value));
        }
    }
    for (support, values) in supports {
        let pointer = || {
            format!(
                "/supports/{}/displacement",
                model.supports[support as usize]
            )
        };
        let every = values.len().div_ceil(POINTS);
        for (dof, value) in values.into_iter().step_by(every) {
            let x = model.nodes[dof as usize / 3];
            told(at_point(value, &x, &times, end), &pointer)?;
        }
    }
    let mut scratch = Vec::new();
    for (name, load) in &model.dead_loads {
        let pointer = || format!("/loads/{name}");
        if load
            .functions()
            .iter()
            .any(TimeFunction::depends_on_position)
        {
            scratch.resize(3 * model.nodes.len(), 0.0);
            for t in evenly(end, FEW_TIMES) {
                told(load.add(t, &mut scratch), &pointer)?;
            }
            continue;
        }
        for f in load.functions() {
            told(in_time(f, &times), &pointer)?;
        }
    }
    for (name, load) in &model.follower_loads {
        told(in_time(&load.value, &times), &|| {
            format!("/loads/{name}/pressure")
        })?;
    }
    Ok(())
}

/// `0` to `end` in equal parts.
fn evenly(end: f64, parts: usize) -> impl Iterator<Item = f64> {
    (0..=parts).map(move |i| end * i as f64 / parts as f64)
}

fn in_time(f: &TimeFunction, times: &[f64]) -> Result<(), ValueError> {
    if f.depends_on_time() {
        times.iter().try_for_each(|&t| f.eval(t).map(drop))
    } else {
        f.eval(0.0).map(drop)
    }
}

fn at_point(f: &TimeFunction, x: &Vec3, times: &[f64], end: f64) -> Result<(), ValueError> {
    match (f.depends_on_position(), f.depends_on_time()) {
        (false, _) => in_time(f, times),
        (true, false) => f.eval_at(x, 0.0).map(drop),
        (true, true) => evenly(end, FEW_TIMES).try_for_each(|t| f.eval_at(x, t).map(drop)),
    }
}

/// Takes down the kinks of what is prescribed, and how large steps may be between them.
pub(super) fn times(loaded: &LoadedScene, model: &mut Model) {
    model.kinks = kinks(&loaded.scene, model);
    model.bound_steps(loaded);
}

/// Times inside the run at which something prescribed has a kink.
fn kinks(scene: &Scene, model: &Model) -> Vec<f64> {
    let end = scene.solution.end_time;
    let shrunk = (scene.contacts.values()).filter_map(|c| match c.initial_overclosure {
        InitialOverclosure::Shrink { until } => Some(until),
        _ => None,
    });
    let mut times: Vec<f64> = (model.functions())
        .flat_map(|(f, _)| f.breakpoints())
        .chain(shrunk)
        .chain(stages::kinks(scene, model))
        .chain(match scene.solution.stabilization {
            Stabilization::Viscous { until, .. } => until,
            Stabilization::Auto | Stabilization::None => None,
        })
        .filter(|t| *t > 0.0 && *t < end)
        .collect();
    times.sort_by(f64::total_cmp);
    times.dedup();
    times
}
