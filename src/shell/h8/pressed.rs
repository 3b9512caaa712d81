//! What presses on elements, and what they take off their thickness strain for it ([`pressed`]).
use super::{Formulation, H8Block, arrays, fault};
use crate::shell::Law;
use crate::shell::error::ElementFault;
use crate::shell::history::pressing;
use crate::shell::kinematics::Fields;
use crate::shell::material::{Memory, with_law};
use crate::shell::pressed;
use covact_geometry::Vec3;

/// Smallest part of a change of shares that is tried.
const SMALLEST: f64 = 0.1;

impl Formulation {
    /// Numbers of state of an element whose law remembers so much.
    pub(in crate::shell) const fn numbers(self, memory: Memory) -> usize {
        self.state_len(memory.symmetric)
            + self.points() * memory.numbers
            + 2 * (self.may_share() && memory.numbers == 0) as usize
    }

    /// Whether elements of a material that does not flow may take something off their thickness strain: those with assumed strains.
    pub(in crate::shell) const fn may_share(self) -> bool {
        matches!(
            self,
            Formulation::Eas7 | Formulation::Eas3 | Formulation::Eas0
        )
    }
}

impl H8Block {
    /// Whether the states of elements have numbers for what they take off their thickness strain. Dashpots are not pressed.
    pub(crate) fn has_shares(&self) -> bool {
        let flows = self.law.state_len() > 0 || matches!(self.law, Law::Dashpot(_));
        self.formulation.may_share() && !flows
    }

    /// Whether elements take something off their thickness strain where they are pressed: those of a single layer, whose faces are
    /// those of their body, where something may press on both. Between others, elements with strains of their own stand in where they give
    /// way.
    pub fn may_be_pressed(&self) -> bool {
        self.pressed && self.has_shares()
    }

    /// Whether an element takes something off its thickness strain.
    pub fn is_pressed(&self, state: &[f64]) -> bool {
        pressed::any(self.shares(state))
    }

    /// Tells whether anything may press on both faces of the body; elements of one layer begin with that.
    pub fn press_both_faces(&mut self, may: bool) {
        self.pressed &= may;
    }

    /// The shares that an element has; none where its state has no such numbers.
    pub(super) fn shares(&self, state: &[f64]) -> [f64; 2] {
        let last = match self.has_shares() {
            true => state.get(self.state_len() - 2..),
            false => None,
        };
        last.and_then(|last| last.first_chunk())
            .copied()
            .unwrap_or_default()
    }

    /// Sets the shares that are taken off the thickness strain to what presses on the faces at displacements `u`; returns by how much
    /// they, at most, and the energy of the element change.
    ///
    /// # Errors
    /// [`ElementFault`] where the strain is impossible.
    pub fn press(
        &self,
        e: usize,
        u: &[Vec3; 8],
        state: &mut [f64],
    ) -> Result<[f64; 2], ElementFault> {
        let (was, may) = (self.shares(state), self.may_be_pressed());
        if !may && !pressed::any(was) {
            return Ok([0.0; 2]);
        }
        let [before, s33] = self.pressing(e, u, state)?;
        let asked = match may {
            true => pressed::shares(&self.reference[e], s33, self.law.young()),
            // A stage before this one left it there.
            false => [0.0; 2],
        };
        let first = self.state_len() - 2;
        let mut part = 1.0;
        while asked != was && part > SMALLEST {
            let shares = [0, 1].map(|k| was[k] + part * (asked[k] - was[k]));
            state[first..first + 2].copy_from_slice(&shares);
            if let Ok([after, _]) = self.pressing(e, u, state) {
                let changes = [0, 1].map(|k| f64::abs(shares[k] - was[k]));
                return Ok([changes[0].max(changes[1]), after - before]);
            }
            // One that leans far would be turned inside out by all of it at once.
            part *= 0.5;
        }
        state[first..first + 2].copy_from_slice(&was);
        Ok([0.0; 2])
    }

    /// Strain energy of an element, and its mean stress along the thickness.
    fn pressing(&self, e: usize, u: &[Vec3; 8], state: &[f64]) -> Result<[f64; 2], ElementFault> {
        let (re, u) = (&self.reference[e], arrays(u));
        let states = &state[self.condensation_len()..];
        let fault = |(g, c)| fault(e, g, c);
        let (big, du) = (Fields::new(&re.nodes), Fields::new(&u));
        let strain = self.strains(re, (&big, &du), state).map_err(fault)?;
        let at = |g: usize| (re.metric[g], strain[g], re.volume[g]);
        with_law!(&self.law, law => pressing(law, at, states)).map_err(fault)
    }
}
