//! Beginning again at time 0: which other form of the scene a run that stopped is repeated with, and which one it goes back to where
//! none of them came to the end.
use super::changes::Changes;
use super::smooth::{flat_again, with_smooth_below};
use super::substitute::instead_of_kept;
use super::variant::{
    BEGUN, Safe, WENT_ON, safe_variant, seeing_less, with_edges, with_exchanged, with_points,
    with_rims, with_sides, with_smooth,
};
use super::{Rims, Simulation, running};
use crate::model::BodyModel;
use crate::model::error::number;
use crate::output::RunStatus;
use crate::run::RunError;
use crate::scene::LoadedScene;
use serde::{Deserialize, Serialize};

/// Part of the whole time by which a run came farther than the last one, for it to be followed once more.
const FARTHER: f64 = 0.02;

/// The run that came farthest of those that stopped.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Farthest {
    /// How far.
    time: f64,
    /// What it had other than the scene, as checkpoints keep it.
    changes: String,
}

impl Farthest {
    /// The run with `safe`, which stopped at `time`.
    fn new(scene: &LoadedScene, safe: Option<&Safe>, time: f64) -> Self {
        let mut safe = safe.cloned();
        if let Some(safe) = &mut safe {
            safe.farthest = None;
        }
        Farthest {
            time,
            changes: Changes::of(scene, safe.as_ref(), Rims::Last).text(),
        }
    }

    /// The scene of this run, to be followed to its end, where the last one stopped long before it (`time` of `end`).
    fn again(self, scene: &LoadedScene, (time, end): (f64, f64)) -> Option<Safe> {
        if self.time < time + FARTHER * end {
            return None;
        }
        let (safe, _) = Changes::apply(&self.changes, scene)?;
        let mut safe = Safe::of(scene, safe.as_ref());
        safe.former = None;
        safe.changed.push(format!(
            "no run came to the end of the scene, and the last one stopped at time {}: the one that came farthest, to time {}, was \
             repeated and followed as far as it goes",
            number(time),
            number(self.time)
        ));
        Some(safe)
    }
}

/// Whether a body has faces all around, of solid elements, and more than one layer of them.
pub(super) fn is_block(bodies: &[BodyModel], name: &str) -> bool {
    let block = |b: &BodyModel| b.is_block() && b.block.sheet().is_none();
    bodies.iter().any(|b| b.name == name && block(b))
}

impl Simulation<'_> {
    /// Begins again at time 0 where other elements may replace those that gave way, or do so less well than these, where the run
    /// stopped while an edge of a master lay on its slave, or in contact with a body that is softer than its slave, or with flat
    /// faces that may be smooth; and where nothing of that is left, with the run that came farthest.
    pub(super) fn begin_again(&mut self) -> Result<bool, RunError> {
        let ending = self.ended.clone().filter(|_| self.rims != Rims::Last);
        let Some(ending) = ending else {
            return Ok(false);
        };
        let rims_sunk = ending.on_rims
            || ending.status == RunStatus::NotConverged
                && (self.running).with_dependent_mut(|_, run| run.rims_sunk());
        let bodies = &self.running.borrow_owner().model.bodies;
        let squeezed = (ending.squeezed.iter()).map(|&body| bodies[body].name.as_str());
        let before = self.safe.as_ref();
        let time = self.time();
        // A run that reached its end is kept, whatever is to be said of its last state.
        let run = self.running.borrow_dependent();
        let stopped =
            ending.status == RunStatus::NotConverged && !run.course.walk.stepping.done(time);
        let edges = || {
            let found = stopped && run.edges_on_slaves();
            found.then(|| with_edges(&self.scene, before, Some(time)))?
        };
        let block = |name: &str| is_block(bodies, name);
        let exchanged = || {
            let found = stopped && run.on_bodies();
            found.then(|| with_exchanged(&self.scene, before, Some(time), &block))?
        };
        let sides = || {
            let found = stopped && run.edges_on_slaves();
            found.then(|| with_sides(&self.scene, before, Some(time), &block))?
        };
        let smooth = || {
            let found = stopped && run.on_bodies();
            found.then(|| with_smooth(&self.scene, before, Some(time)))?
        };
        let rims = || {
            let found = rims_sunk && (stopped || ending.on_rims);
            found.then(|| with_rims(&self.scene, before, Some(time)))?
        };
        let names = |of: &[usize]| -> Vec<&str> {
            let pairs = &self.running.borrow_owner().model.pairs;
            of.iter().map(|&pair| pairs[pair].name.as_str()).collect()
        };
        let points = |before: Option<&Safe>| {
            with_points(&self.scene, before, Some(time), &names(&ending.between))
        };
        let below = || with_smooth_below(&self.scene, before, time, &names(&ending.slid));
        // What else was found wrong with it is changed first.
        let nothing_else =
            !ending.on_rims && ending.between.is_empty() && ending.squeezed.is_empty();
        let flat = (stopped && nothing_else)
            .then(|| flat_again(&self.scene, before, time))
            .flatten();
        // What is seen of both in the same step is changed at once.
        let unseen = || {
            let safe = if ending.on_rims { rims() } else { None };
            points(safe.as_ref().or(before)).or(safe)
        };
        let safe = || {
            safe_variant(
                &self.scene,
                before,
                squeezed,
                (time, &self.history, ending.accepted),
            )
        };
        let contacts = || edges().or_else(exchanged).or_else(sides).or_else(smooth);
        let kept = self.kept_elements();
        let kept_none = kept.is_none();
        let instead = stopped.then(|| instead_of_kept(before));
        let instead = instead.flatten();
        let found = match self.rims {
            rims if kept.is_some() => kept.map(|safe| (safe, rims)),
            rims if !ending.slid.is_empty() => below().map(|safe| (safe, rims)),
            Rims::Out | Rims::Instead if ending.on_rims || !ending.between.is_empty() => {
                unseen().map(|safe| (safe, Rims::Instead))
            }
            rims if instead.is_some() => instead.map(|safe| (safe, rims)),
            rims if flat.is_some() => flat.map(|safe| (safe, rims)),
            Rims::Out => (safe().map(|safe| (safe, Rims::Out)))
                .or_else(|| Some((rims()?, Rims::Settled)))
                .or_else(|| Some((contacts()?, Rims::Out))),
            // In a block elements that give way do so without them as well; a shell of other elements would bend too little,
            // and a run that was given up for their sake may come to its end without them.
            Rims::Instead => {
                let block = |b: &usize| bodies[*b].is_block();
                let found = ending.squeezed.iter().all(block).then(safe).flatten();
                (found.map(|safe| (safe, Rims::Instead))).or_else(|| {
                    let found = stopped.then(|| seeing_less(&self.scene, before, Some(time)));
                    Some((found??, Rims::Settled))
                })
            }
            Rims::Settled => (safe().or_else(contacts)).map(|safe| (safe, Rims::Settled)),
            Rims::Last => None,
        };
        // What was given up for what it does not see, or for its elements, is no answer to go back to.
        let failed = stopped && kept_none && nothing_else && ending.slid.is_empty();
        let mut farthest = before.and_then(|safe| safe.farthest.clone());
        let found = found.or_else(|| {
            let farthest = farthest.take().filter(|_| stopped)?;
            let end = self.scene.scene.solution.end_time;
            let safe = farthest.again(&self.scene, (time, end))?;
            Some((safe, Rims::Last))
        });
        let Some((mut safe, rims)) = found else {
            return Ok(false);
        };
        if failed && farthest.as_ref().is_none_or(|f| f.time < time) {
            farthest = Some(Farthest::new(&self.scene, before, time));
        }
        safe.farthest = farthest;
        // A run with other slaves is no measure of this one.
        let contacts = |safe: &Safe| safe.loaded.scene.contacts.clone();
        if before.map_or(&self.scene, |b| &b.loaded).scene.contacts != contacts(&safe) {
            safe.former = None;
        }
        // Elements that were exchanged on the way are there from the start now.
        for text in &mut safe.changed {
            *text = text.replace(WENT_ON, BEGUN);
        }
        let spent = run.give_up();
        let observer = &mut *self.options.observer;
        // What cannot be built in another way stays as it ended.
        let made = running(&self.scene, Some(&safe), None, rims, observer);
        let Ok(running) = made else {
            return Ok(false);
        };
        self.running = running;
        (self.running).with_dependent_mut(|_, run| run.charge(spent));
        (self.safe, self.rims) = (Some(safe), rims);
        self.history.rows.clear();
        (self.whole, self.ended, self.concluded) = (true, None, false);
        (self.begun, self.closed) = (false, None);
        self.attempt += 1;
        Ok(true)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{self, Element};

    /// What was told of it is told again, and what it was solved with comes back, from checkpoints too.
    #[test]
    fn the_run_that_came_farthest_is_taken_again() {
        let scene = scene::parse(
            r#"{
                "covact": 1,
                "materials": {"m": {"neo_hooke": {"E": 1, "nu": 0.3}}},
                "bodies": {"b": {"mesh": {"block": {"min": [0, 0, 0], "max": [1, 1, 1], "elements": [1, 1, 1]}}, "material": "m"}}
            }"#,
            "scene.json",
        )
        .unwrap();
        let mut safe = Safe::of(&scene, None);
        safe.loaded.scene.bodies.get_mut("b").unwrap().element = Element::H8MeanDilatation;
        safe.changed.push("bricks".to_owned());
        let far = Farthest::new(&scene, Some(&safe), 0.8);
        assert!(far.clone().again(&scene, (0.79, 1.0)).is_none());
        let again = far.again(&scene, (0.5, 1.0)).unwrap();
        assert_eq!(again.loaded.scene, safe.loaded.scene);
        assert_eq!(again.changed[0], "bricks");
        let told = &again.changed[1];
        assert!(
            [
                "no run came to the end",
                "stopped at time 0.5",
                "to time 0.8"
            ]
            .iter()
            .all(|part| told.contains(part)),
            "{told}"
        );
        // Of the scene as it was given nothing is other but what is told.
        let given = Farthest::new(&scene, None, 0.8).again(&scene, (0.5, 1.0));
        let given = given.unwrap();
        assert!(given.loaded.scene == scene.scene && given.changed.len() == 1);
        let kept = Changes::of(&scene, Some(&given), Rims::Last).text();
        let (back, rims) = Changes::apply(&kept, &scene).unwrap();
        assert_eq!(back.unwrap().changed, given.changed);
        assert_eq!(rims, Rims::Last);
    }
}
