//! How a run that reached its end time ended, and which contacts have touched by then.
use super::{Ending, March};
use crate::model::PairModel;
use crate::model::master::Master;
use crate::output::RunStatus;
use crate::solve::event::Event;
use std::collections::BTreeSet;

/// What accepted steps tell of equilibria that would not last.
pub(super) const UNSTABLE: &str = "the equilibrium may be unstable";

impl March<'_, '_> {
    /// How a run that reached its end time ended.
    pub(super) fn ending(&self) -> Ending {
        let (never, _) = self.untouched();
        if never.is_empty() {
            return Ending::new(RunStatus::Done, None);
        }
        // A straight body under more than its critical load stays straight: nothing tells Newton's method which way to bend.
        let unstable = (self.progress.warnings.iter()).find(|w| w.contains(UNSTABLE));
        let unstable = unstable.map_or(String::new(), |told| {
            format!(
                "; or the bodies would have buckled, as the tangent tells ({}): take smaller steps, and give them a small load or \
                 motion to the side",
                told.split(": ").next().unwrap_or_default()
            )
        });
        let reason = format!(
            "the surfaces of contact `{}` never touched: check the motion, the `side` and the `depth` of the surface{unstable}",
            never.join("`, `")
        );
        Ending::new(RunStatus::NoContact, Some(reason))
    }

    /// Contacts that never touched: those that were to, and those that only might have, with whether that is to be a warning. A body
    /// in contact with itself guards against what need not happen, and so does a contact of which both sides have touched in others;
    /// a surface that stands still, in front of which a slave starts that has touched elsewhere, may be a stop that was not reached,
    /// or one that was to be, and one that moves with a surface that has touched may be the part of a tool that the slave bends away
    /// from: a warning. Where nothing has touched at all, every contact was to.
    pub(super) fn untouched(&self) -> (Vec<&str>, Vec<(&str, bool)>) {
        let pairs = &self.model.pairs;
        let sides = |pair: &PairModel| match &pair.master {
            Master::Rigid(surface) => [(false, pair.body), (true, *surface)],
            Master::Body(master) => [(false, pair.body), (false, master.body)],
        };
        let touched = |i: usize| self.either(self.touched, i);
        let met: BTreeSet<(bool, usize)> = (pairs.iter().enumerate())
            .filter(|(i, _)| touched(*i))
            .flat_map(|(_, pair)| sides(pair))
            .collect();
        let mut out = (Vec::new(), Vec::new());
        for (i, pair) in pairs.iter().enumerate() {
            if touched(i) || pair.is_second() {
                continue;
            }
            let own = sides(pair);
            let name = pair.name.as_str();
            let itself = own[0] == own[1];
            let guards = itself || !met.is_empty() && own.iter().all(|side| met.contains(side));
            let still = pair.rigid_master().is_some_and(|surface| {
                let surface = &self.model.surfaces[surface];
                !surface.motion.moves() && surface.driven.is_none()
            });
            let stop = still && pair.starts_in_front;
            let part =
                (pair.rigid_master()).is_some_and(|surface| self.moves_with_one_of(surface, &met));
            let stop = (stop || part) && met.contains(&own[0]);
            match (guards, stop) {
                (true, _) => out.1.push((name, false)),
                (false, true) => out.1.push((name, true)),
                (false, false) => out.0.push(name),
            }
        }
        out
    }

    /// Whether a rigid surface goes the prescribed way of another one, which has touched.
    fn moves_with_one_of(&self, surface: usize, met: &BTreeSet<(bool, usize)>) -> bool {
        let scene = self.scene;
        let of = |surface: usize| {
            let name = &self.model.surfaces[surface].name;
            let ways = scene.stages.iter().map(move |stage| stage.tools.get(name));
            Some((&scene.surfaces.get(name)?.motion, ways))
        };
        let same = |other: usize| {
            let Some(((motion, ways), (its, others))) = of(surface).zip(of(other)) else {
                return false;
            };
            motion.free.is_none() && motion == its && ways.eq(others)
        };
        let moves = self.model.surfaces[surface].motion.moves();
        let mut touched = met
            .iter()
            .filter(|(rigid, other)| *rigid && *other != surface);
        moves && touched.any(|(_, other)| same(*other))
    }

    /// Tells which contacts never touched that only might have.
    pub(super) fn tell_untouched(&mut self) {
        let (_, guards) = self.untouched();
        let of = |warned: bool| -> Vec<&str> {
            let chosen = guards.iter().filter(|(_, w)| *w == warned);
            chosen.map(|(name, _)| *name).collect()
        };
        let [notes, stops] = [of(false), of(true)];
        let text = |names: &[&str]| format!("contact `{}` never touched", names.join("`, `"));
        let note = (!notes.is_empty()).then(|| text(&notes));
        let warning = (!stops.is_empty()).then(|| {
            format!(
                "{}: a surface that stands still may be a stop that was not reached, and one that moves with another a part of a tool; \
                 where it was to touch, check the motions and the `side` of the surface",
                text(&stops)
            )
        });
        if let Some(text) = note {
            self.observer.event(&Event::Note { text });
        }
        if let Some(text) = warning {
            self.warn(text);
        }
    }

    /// Whether a flag is set for pair `i`, or for another pass of its contact: of two curved sides one may have no slave
    /// point where they touch, and an edge may bear all.
    pub(super) fn either(&self, flags: &[bool], i: usize) -> bool {
        let edges = |j: usize| self.model.pairs[j].edges_of == Some(i) && flags[j];
        flags[i]
            || self.model.pairs[i].half.is_some_and(|h| flags[h.other])
            || (0..flags.len()).any(edges)
    }
}
