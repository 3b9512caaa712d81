//! Warnings of a run: each is told once, and counted where it comes with several steps.
use super::March;
use crate::model::state::State;
use crate::solve::event::Event;

/// Couple of stretched fibres beside that which bends the shell, from which on a border is held by them.
const HOLDS: f64 = 0.1;

/// Steps out of balance that are each told in full; what every warning of one has, and what is told of further ones.
const IN_FULL: usize = 3;
const NOWHERE: &str = " nowhere, ";
const AGAIN: &str = "the energies are out of balance again, as told of steps before; `energy.imbalance` in history.csv says by how \
                     much";

/// The first of the steps that the head of a warning names, `step 3: ` or `steps 3 to 9 (4 of them): `, and how many they are.
fn steps_told(head: &str) -> Option<(u32, u32)> {
    if let Some(step) = head.strip_prefix("step ") {
        return Some((step.strip_suffix(": ")?.parse().ok()?, 1));
    }
    let (first, rest) = head.strip_prefix("steps ")?.split_once(" to ")?;
    let (_, count) = rest.strip_suffix(" of them): ")?.split_once(" (")?;
    Some((first.parse().ok()?, count.parse().ok()?))
}

/// Whether what there is to tell of the balance of a step is told in full, after these warnings.
fn in_full(before: &[String], text: &str) -> bool {
    let told = before.iter().filter(|told| told.contains(NOWHERE)).count();
    told < IN_FULL || !text.contains(NOWHERE)
}

impl March<'_, '_> {
    /// Tells of supports that hold a border as a clamp would, since they stretch the fibres there where these tilt. Of each once.
    pub(super) fn tell_stretched(&mut self, state: &State, step: u32) {
        for held in &self.model.stretched {
            let head = format!(
                "support `{}`: it moves both faces of body `{}` alike through the thickness",
                held.support, self.model.bodies[held.body].name
            );
            let told = |text: &String| text.starts_with(&head);
            if self.progress.warnings.iter().any(told) {
                continue;
            }
            let [tilt, holds] = held.worst(self.model, &state.u);
            if holds > HOLDS {
                self.warn(format!(
                    "{head}, where fibres have tilted by {:.1} degrees at step {step}: they are stretched by that, and the border resists \
                     turning as if it were clamped. With `mid_surface` it turns freely; hold the other components too where a clamp is \
                     meant",
                    tilt.to_degrees()
                ));
            }
        }
    }

    /// Reports a warning of a step. What is told of several steps in the same words is reported when it is first, and kept as
    /// one warning that counts them.
    pub(in crate::run) fn warn_of_step(&mut self, step: u32, text: &str) {
        let counted = (self.progress.warnings.iter_mut()).find_map(|told| {
            let (first, count) = steps_told(told.strip_suffix(text)?)?;
            Some((told, first, count + 1))
        });
        match counted {
            Some((told, first, count)) => {
                *told = format!("steps {first} to {step} ({count} of them): {text}");
            }
            None => self.warn(format!("step {step}: {text}")),
        }
    }

    /// Reports a step whose energies are out of balance. Where many are, the first few say what there is to say.
    pub(super) fn warn_of_balance(&mut self, step: u32, text: String) {
        match in_full(&self.progress.warnings, &text) {
            true => self.warn(text),
            false => self.warn_of_step(step, AGAIN),
        }
    }

    /// Reports a warning once.
    pub(in crate::run) fn warn(&mut self, text: String) {
        if !self.progress.warnings.contains(&text) {
            self.observer.event(&Event::Warning { text: text.clone() });
            self.progress.warnings.push(text);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::{AGAIN, in_full, steps_told};
    use crate::run::watch::Jump;

    /// Three steps out of balance are told each, others counted; AGAIN is none of them.
    #[test]
    fn many_steps_out_of_balance_are_counted() {
        let jump =
            |lost: f64| Jump { lost, part: 0.02 }.words((4, 0.5), false, "Take smaller steps");
        for text in [jump(0.1), jump(-0.1)] {
            let mut warnings = vec!["contact `c`: it opened".to_owned()];
            for _ in 0..3 {
                assert!(in_full(&warnings, &text));
                warnings.push(text.clone());
            }
            assert!(!in_full(&warnings, &text));
            assert!(in_full(&warnings, "step 9 moved 20 times as fast"));
        }
        assert!(!AGAIN.contains(super::NOWHERE));
    }

    #[test]
    fn steps_of_a_warning_are_counted() {
        assert_eq!(steps_told("step 3: "), Some((3, 1)));
        assert_eq!(steps_told("steps 3 to 19 (4 of them): "), Some((3, 4)));
        assert_eq!(steps_told("contact `c`: "), None);
        assert_eq!(steps_told("step 3"), None);
    }
}
