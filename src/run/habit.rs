//! What the steps so far say of how the next one should start.
use super::checkpoint::bytes::{Malformed, Reader, Writer};

/// What a kind of start is taken to cost before it was tried (iterations), and how many steps that weighs as much as.
const UNTRIED: f64 = 10.0;
const WEIGHT: f64 = 0.5;
/// What is left of each try when the next one comes.
const REMEMBERED: f64 = 0.7;
/// Steps lately solved that make a kind of start one that solves steps.
const SOLVES: f64 = 0.25;
/// Iterations that a search may have cost per step that it has solved, and above which it is not tried where all else fails.
const TOO_MANY: f64 = 40.0;
/// Failures in a row after which a kind of start is put off, and how often at most the time doubles for which it is.
const MISSES: u32 = 2;
const DOUBLINGS: u32 = 3;

/// What a kind of start has cost and brought lately.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(super) struct Account {
    iterations: f64,
    solved: f64,
    /// Failures since the last step that it has solved.
    misses: u32,
    /// Whether the attempt at hand has tried it, and how many before it have done without since the last try.
    tried: bool,
    without: u32,
}

impl Account {
    /// Iterations per step that it solves, those of failures included.
    pub fn price(&self) -> f64 {
        (self.iterations + UNTRIED * WEIGHT) / (self.solved + WEIGHT)
    }

    /// Whether it is put off: after two failures in a row the next attempt at a step does without it, after a third one the next
    /// two do, and so on.
    pub fn put_off(&self) -> bool {
        let doublings = self.misses.saturating_sub(MISSES).min(DOUBLINGS);
        self.misses >= MISSES && self.without < 1 << doublings
    }

    /// Whether it has solved steps lately.
    pub fn solves(&self) -> bool {
        self.solved > SOLVES
    }

    /// Takes down a try.
    pub fn tried(&mut self, iterations: u32, solved: bool) {
        self.iterations = REMEMBERED * self.iterations + f64::from(iterations);
        self.solved = REMEMBERED * self.solved + f64::from(u8::from(solved));
        self.misses = if solved { 0 } else { self.misses + 1 };
        self.tried = true;
    }

    /// The attempt at hand has ended.
    fn ended(&mut self) {
        self.without = if self.tried { 0 } else { self.without + 1 };
        self.tried = false;
    }

    fn put(&self, out: &mut Writer) {
        out.f64(self.iterations);
        out.f64(self.solved);
        out.u32(self.misses);
        out.bool(self.tried);
        out.u32(self.without);
    }

    fn take(from: &mut Reader) -> Result<Self, Malformed> {
        Ok(Account {
            iterations: from.f64()?,
            solved: from.f64()?,
            misses: from.u32()?,
            tried: from.bool()?,
            without: from.u32()?,
        })
    }
}

/// What the last steps needed, which the next one is likely to need as well.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(super) struct Habit {
    /// The last step needed its points kept.
    pub hold: bool,
    /// The last step was solved by searching along every increment.
    pub search: bool,
    /// Starts that go on with the path.
    pub path: Account,
    /// Starts from the last accepted state.
    pub accepted: Account,
    /// Starts from the last accepted state that search along every increment.
    pub searched: Account,
    /// Starts from a softened penalty.
    pub softened: Account,
}

impl Habit {
    /// Whether a search is worth a try where a step has failed without.
    pub fn may_search(&self) -> bool {
        self.searched.price() < TOO_MANY
    }

    /// An attempt at a step has ended.
    pub fn ended(&mut self) {
        for account in [
            &mut self.path,
            &mut self.accepted,
            &mut self.searched,
            &mut self.softened,
        ] {
            account.ended();
        }
    }

    pub fn put(&self, out: &mut Writer) {
        let Habit {
            hold,
            search,
            path,
            accepted,
            searched,
            softened,
        } = self;
        out.bool(*hold);
        out.bool(*search);
        for account in [path, accepted, searched, softened] {
            account.put(out);
        }
    }

    pub fn take(from: &mut Reader) -> Result<Self, Malformed> {
        Ok(Habit {
            hold: from.bool()?,
            search: from.bool()?,
            path: Account::take(from)?,
            accepted: Account::take(from)?,
            searched: Account::take(from)?,
            softened: Account::take(from)?,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_start_that_fails_is_put_off_for_ever_longer() {
        let mut account = Account::default();
        for _ in 0..20 {
            account.tried(5, true);
            account.ended();
        }
        assert!(account.price() < 6.0 && account.solves());
        let mut steps = Vec::new();
        for step in 0..30 {
            if !account.put_off() {
                account.tried(12, false);
                steps.push(step);
            }
            account.ended();
        }
        assert_eq!(steps, [0, 1, 3, 6, 11, 20, 29]);
        assert!(account.price() > 12.0 && account.put_off());
        account.tried(5, true);
        assert!(!account.put_off());
    }

    #[test]
    fn a_search_that_never_helps_is_given_up() {
        let mut habit = Habit::default();
        assert!(habit.may_search());
        for _ in 0..3 {
            habit.searched.tried(10, false);
        }
        assert!(!habit.may_search());
    }
}
