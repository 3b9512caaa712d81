//! How fast the energy of contact grows beside metal that flows.
//!
//! Beside what a body has taken since the start the energy of contact looks small once metal flows: plastic work grows without
//! bounds, and contact stores its part again with every new force. What counts is the next bit of work: to first order a force is
//! off by `dE_c / dW`. Metal that flows on against a constant force leaves nothing of that; a tool that stops the flow shows by it
//! in the very step in which metal flows past the place where it should have come to rest, from where it does not flow back.
use super::StepEnd;
use crate::model::Model;
use crate::run::checkpoint::bytes::{Malformed, Reader, Writer};

/// Part of what bodies have taken that a path has to add for it to be judged: less may be rounding, or a pause.
const ADDED: f64 = 1e-3;

/// Energies at the last step from which the path is judged.
#[derive(Debug, Clone, Default, PartialEq)]
pub(super) struct Growing {
    /// Energy of contact and penalty (force / length^3) per pair.
    pairs: Vec<[f64; 2]>,
    /// What elements had taken, plastic work included (energy).
    taken: f64,
}

impl Growing {
    /// Before anything has moved.
    pub fn new(model: &Model) -> Self {
        Growing {
            pairs: vec![[0.0, 1.0]; model.pairs.len()],
            taken: 0.0,
        }
    }

    /// The work since then, and whether it is enough to be judged.
    fn work(&self, end: &StepEnd) -> (f64, bool) {
        let all = end.bearings.pairs.iter().zip(end.penalties);
        let stored: f64 = (all.zip(&self.pairs))
            .map(|((now, penalty), before)| now.energy - under(before, *penalty))
            .sum();
        let added = end.taken - self.taken;
        (added + stored, added > ADDED * end.taken)
    }

    /// Growth of the energy of contact of a pair over the work done; 0 where too little was.
    pub fn of(&self, pair: usize, end: &StepEnd) -> f64 {
        let (work, judged) = self.work(end);
        let before = under(&self.pairs[pair], end.penalties[pair]);
        match judged && work > 0.0 {
            true => (end.bearings.pairs[pair].energy - before).max(0.0) / work,
            false => 0.0,
        }
    }

    /// Goes on to an accepted step, where enough was done until there, or something was let go.
    pub fn step(&mut self, end: &StepEnd) {
        let (work, judged) = self.work(end);
        if !judged && work > 0.0 {
            return;
        }
        self.taken = end.taken;
        let all = end.bearings.pairs.iter().zip(end.penalties);
        for (own, (now, penalty)) in self.pairs.iter_mut().zip(all) {
            *own = [now.energy, *penalty];
        }
    }

    pub fn put(&self, out: &mut Writer) {
        let Growing { pairs, taken } = self;
        out.f64s(pairs.as_flattened());
        out.f64(*taken);
    }

    pub fn take(&mut self, from: &mut Reader) -> Result<(), Malformed> {
        from.f64s(self.pairs.as_flattened_mut())?;
        self.taken = from.f64()?;
        Ok(())
    }
}

/// Energy of contact at an earlier step as it would be under a penalty, at the same forces.
fn under([energy, earlier]: &[f64; 2], penalty: f64) -> f64 {
    match penalty > 0.0 {
        true => energy * earlier / penalty,
        false => *energy,
    }
}
