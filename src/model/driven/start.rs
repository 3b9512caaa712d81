//! Where driven surfaces stand before the first step: a surface that touches nothing has no stiffness, so it is moved
//! along its force until it touches.
use super::press::Presser;
use super::{Driven, Model, ModelError, SurfaceModel, text};
use crate::contact::law::Penalty;
use crate::model::error::{At, number};
use crate::scene::{LoadedScene, ValueError};
use nalgebra::Vector6;

/// Part of an element below which lengths have to be told apart: contact rests on penetrations not much larger.
const RESOLVED: f64 = 1e-6;

/// The surface is neither so large nor so far away that its closest points have no digits left on the scale of the elements
/// it meets. The search for its first contact would creep on for hours there, and find nothing of meaning.
fn resolved(
    model: &Model,
    (index, surface, driven): (usize, &SurfaceModel, &Driven),
) -> Result<(), ModelError> {
    let pairs = model
        .pairs
        .iter()
        .filter(|p| p.rigid_master() == Some(index));
    let element = pairs.fold(f64::INFINITY, |a, p| a.min(p.element_size));
    let name = &surface.name;
    let pose = (surface.motion.pose(0.0)).at(|| format!("/surfaces/{name}/motion"))?;
    let corners = surface.set.bounds().map(|b| b.norm());
    let placed = [driven.center.norm(), pose.translation.vector.norm()];
    let largest = corners.into_iter().chain(placed).fold(0.0, f64::max);
    let rounding = f64::EPSILON * largest;
    // Not finite is no better.
    if rounding <= RESOLVED * element || element.is_infinite() {
        return Ok(());
    }
    let message = format!(
        "surface `{name}` has coordinates up to {largest:.1e}, where double precision tells lengths of {rounding:.1e} apart, \
         and presses on elements of {}: the contact cannot be resolved",
        number(element)
    );
    Err(text(format!("/surfaces/{name}"), message)
        .help("check the units, the radius and the centre of the surface"))
}

/// Moves every driven surface along its force (where it has none, about its moment) until it first touches, and notes
/// how far. One that is free to turn only, which friction alone resists, stays where it is, as does one whose force sets in
/// later.
///
/// # Errors
/// [`ModelError`] where it would never touch, has no contact at all, or nothing ever drives it.
pub fn approach(model: &mut Model, loaded: &LoadedScene) -> Result<(), ModelError> {
    let first = first_step(model, loaded);
    let penalties: Vec<f64> = model.pairs.iter().map(|p| p.eps_n).collect();
    let u = vec![0.0; 3 * model.nodes.len()];
    let (mut starts, mut frictional, mut waiting) = (Vec::new(), Vec::new(), Vec::new());
    for entry in model.driven() {
        let (index, surface, driven) = entry;
        let name = &surface.name;
        let pointer = || format!("/surfaces/{name}/motion/free");
        resolved(model, entry)?;
        let mut presser = Presser::<Penalty>::new(model, entry, &penalties, &[], &u);
        if presser.is_empty() {
            let message =
                format!("surface `{name}` is driven by force, but takes part in no contact");
            return Err(text(pointer(), message)
                .help("name it as `master` of a contact, or leave `free` out"));
        }
        let driving = driven.driving(first, &u).at(pointer)?;
        let e = Presser::<Penalty>::direction(&driving);
        let turns = presser.turns_with_friction();
        let mut waits = None;
        let e = match e {
            Some(e) => e,
            None if turns => {
                frictional.push(index);
                continue;
            }
            None => {
                let (later, e) = sets_in(model, loaded, driven, first).at(pointer)?.ok_or_else(|| {
                    let message = format!(
                        "surface `{name}` is driven by force {}, but the force is zero at all times: nothing presses it \
                         against a body",
                        driven.words()
                    );
                    text(pointer(), message).help("give it a force, or prescribe its motion")
                })?;
                waits = Some(later);
                e
            }
        };
        let q = Vector6::zeros();
        let found = (presser.advance(0.0, &q, &e)).map_err(|f| text(pointer(), f.to_string()))?;
        if turns {
            let resisted = match &found {
                Some(s) => (presser.resists(0.0, &(e * *s), &e))
                    .map_err(|f| text(pointer(), f.to_string()))?,
                None => false,
            };
            if !resisted {
                frictional.push(index);
                continue;
            }
        }
        let Some(s) = found else {
            let message = format!(
                "surface `{name}` is driven by force {}, but no slave point lies in its way {}",
                driven.words(),
                driven.direction_words(&e.into())
            );
            return Err(text(pointer(), message).help(
                "forces act on the surface: check their sign, the `placement`, the `side` and which components are free",
            ));
        };
        match waits {
            None => starts.push((index, e * s)),
            Some(later) => waiting.push(format!(
                "surface `{name}`: no force acts on it before t = {}: it waits where it is placed",
                number(later)
            )),
        }
    }
    model.notes.append(&mut waiting);
    for index in frictional {
        if let Some(driven) = &mut model.surfaces[index].driven {
            driven.by_friction = true;
        }
    }
    for (index, start) in starts {
        let surface = &mut model.surfaces[index];
        if let Some(driven) = &mut surface.driven {
            driven.start = start.into();
            let how = match start.norm() > 0.0 {
                true => format!("{} until it touches", driven.start_words()),
                false => "it starts in contact".to_owned(),
            };
            (model.notes).push(format!("surface `{}`: {how}", surface.name));
        }
    }
    Ok(())
}

/// Times at which a force is looked for that is zero at first.
const LOOKED_AT: u32 = 1000;

/// When something drives a surface that nothing drives at time `first`, to a kink or a thousandth of the run, and in which
/// direction. The time is the last one before it at which there was no force.
fn sets_in(
    model: &Model,
    loaded: &LoadedScene,
    driven: &Driven,
    first: f64,
) -> Result<Option<(f64, Vector6<f64>)>, ValueError> {
    let u = vec![0.0; 3 * model.nodes.len()];
    let end = loaded.scene.solution.end_time;
    let even = (1..=LOOKED_AT).map(|i| end * f64::from(i) / f64::from(LOOKED_AT));
    let kinks = model
        .kinks
        .iter()
        .chain(&loaded.scene.solution.stops)
        .copied();
    let mut times: Vec<f64> = (even.chain(kinks))
        .filter(|t| first < *t && *t <= end)
        .collect();
    times.sort_by(f64::total_cmp);
    let mut before = first;
    for t in times {
        if let Some(e) = Presser::<Penalty>::direction(&driven.driving(t, &u)?) {
            return Ok(Some((before, e)));
        }
        before = t;
    }
    Ok(None)
}

/// The end of the first step.
fn first_step(model: &Model, loaded: &LoadedScene) -> f64 {
    let stops = model.kinks.iter().chain(&loaded.scene.solution.stops);
    (stops.copied().filter(|t| *t > 0.0)).fold(loaded.first_step(), f64::min)
}

/// Which surfaces friction alone resists, in a stage after the first: seen from where they start, so that a run that is continued
/// knows the same.
pub fn resisted(model: &mut Model, loaded: &LoadedScene) {
    let first = first_step(model, loaded);
    let penalties: Vec<f64> = model.pairs.iter().map(|p| p.eps_n).collect();
    let u = vec![0.0; 3 * model.nodes.len()];
    let mut frictional = Vec::new();
    for entry in model.driven() {
        let (index, _, driven) = entry;
        let mut presser = Presser::<Penalty>::new(model, entry, &penalties, &[], &u);
        if !presser.turns_with_friction() {
            continue;
        }
        let mut pressed = || {
            let e = Presser::<Penalty>::direction(&driven.driving(first, &u).ok()?)?;
            let s = presser.advance(0.0, &Vector6::zeros(), &e).ok()??;
            presser.resists(0.0, &(e * s), &e).ok()
        };
        if pressed() != Some(true) {
            frictional.push(index);
        }
    }
    for index in frictional {
        if let Some(driven) = &mut model.surfaces[index].driven {
            driven.by_friction = true;
        }
    }
}
