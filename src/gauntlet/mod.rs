//! Hard cases: scenes that break contact codes, each with what is right.
//!
//! A [`Case`] solves scenes and states what must hold of them: a closed form, an invariance, a balance, a converged
//! reference, or, where there is no answer, what the message must name. `covact gauntlet` runs them and prints a table,
//! `tests/hard_cases/gauntlet.rs` makes each a test.
mod bodies;
mod cad;
mod check;
mod conditioning;
mod drawn;
mod dynamics;
mod elements;
mod forming;
mod friction;
mod geometry;
mod instability;
mod invariance;
mod loads;
mod metal;
mod motion;
mod nurbs;
mod scenes;
mod stages;
mod table;
mod trial;

pub use check::{Check, Verdict};
pub use table::{markdown, plain};
pub use trial::{CaseError, Outcome, Trial};

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::time::Instant;

/// A hard case.
#[derive(Debug, Clone, Copy)]
pub struct Case {
    /// Unique within its group; letters, digits and `_`.
    pub name: &'static str,
    /// What is done, in a few words.
    pub what: &'static str,
    /// What is right, and where that is known from, in a few words.
    pub right: &'static str,
    run: fn(&mut Trial) -> Result<(), CaseError>,
}

/// Cases of one kind.
#[derive(Debug, Clone, Copy)]
pub struct Group {
    /// What the cases have in common, as the table shows it.
    pub name: &'static str,
    /// The cases, in the order of the table.
    pub cases: &'static [Case],
}

/// All cases.
pub const GROUPS: [Group; 15] = [
    geometry::GROUP,
    motion::GROUP,
    conditioning::GROUP,
    instability::GROUP,
    friction::GROUP,
    invariance::GROUP,
    elements::GROUP,
    bodies::GROUP,
    metal::GROUP,
    forming::GROUP,
    dynamics::GROUP,
    loads::GROUP,
    stages::GROUP,
    nurbs::GROUP,
    cad::GROUP,
];

/// The case `group/name`.
pub fn find(group: &str, name: &str) -> Option<&'static Case> {
    let group = GROUPS.iter().find(|g| g.name == group)?;
    group.cases.iter().find(|c| c.name == name)
}

impl Case {
    /// Runs the case, its scenes on one thread. A panic in it is a verdict, not the end of the program.
    pub fn run(&self) -> Verdict {
        self.run_on(1)
    }

    /// As [`Case::run`], with this many threads for every scene that does not set its own number.
    pub fn run_on(&self, threads: u32) -> Verdict {
        let start = Instant::now();
        let mut trial = match Trial::new(threads) {
            Ok(trial) => trial,
            Err(broken) => return Verdict::broken(broken),
        };
        let ended = catch_unwind(AssertUnwindSafe(|| (self.run)(&mut trial)));
        let broken = match ended {
            Ok(Ok(())) => None,
            Ok(Err(broken)) => Some(broken),
            Err(_) => Some(CaseError::new("the program panicked")),
        };
        trial.verdict(broken, start.elapsed().as_secs_f64())
    }
}

#[cfg(test)]
mod tests {
    use super::GROUPS;

    #[test]
    fn names_are_unique_and_texts_fit_a_table() {
        for group in GROUPS {
            for (i, case) in group.cases.iter().enumerate() {
                let name = case.name;
                let plain = |c: char| c.is_ascii_lowercase() || c.is_ascii_digit() || c == '_';
                assert!(!name.is_empty() && name.chars().all(plain), "{name}");
                assert!(
                    group.cases[..i].iter().all(|c| c.name != name),
                    "{name} is there twice"
                );
                for text in [case.what, case.right] {
                    assert!(
                        !text.is_empty() && !text.contains('|') && text.len() < 160,
                        "{name}: {text}"
                    );
                }
            }
        }
    }
}
