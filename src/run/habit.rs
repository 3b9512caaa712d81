//! What the steps so far say of how the next one should start.
use super::checkpoint::bytes::{Malformed, Reader, Writer};

/// What a start is taken to cost before it was tried (iterations).
const SOFTENED: u32 = 0;
const SEARCHED: u32 = 10;
/// Iterations that a search may have cost per step that it has solved, and above which it is not tried where all else fails.
const TOO_MANY: u32 = 40;
/// Failures in a row after which a kind of start is left out of steps that have not been cut: a shorter step costs less.
const MISSES: u32 = 2;

/// What a kind of start has cost and brought.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Account {
    iterations: u32,
    solved: u32,
    /// Failures since the last step that it has solved.
    misses: u32,
}

impl Account {
    fn new(iterations: u32) -> Self {
        Account {
            iterations,
            solved: 0,
            misses: 0,
        }
    }

    /// Whether it is worth a try in a step that has been `cut`, or has not.
    pub fn serves(&self, cut: bool) -> bool {
        cut || self.misses < MISSES
    }

    /// Iterations per step that it has solved.
    fn price(&self) -> f64 {
        f64::from(self.iterations) / f64::from(self.solved.max(1))
    }

    /// Takes down a try.
    pub fn tried(&mut self, iterations: u32, solved: bool) {
        self.iterations += iterations;
        self.solved += u32::from(solved);
        self.misses = if solved { 0 } else { self.misses + 1 };
    }

    fn put(&self, out: &mut Writer) {
        out.u32(self.iterations);
        out.u32(self.solved);
        out.u32(self.misses);
    }

    fn take(from: &mut Reader) -> Result<Self, Malformed> {
        Ok(Account {
            iterations: from.u32()?,
            solved: from.u32()?,
            misses: from.u32()?,
        })
    }
}

/// What the last steps needed, which the next one is likely to need as well.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Habit {
    /// The last step needed its points kept.
    pub hold: bool,
    /// The last step was solved by searching along every increment.
    pub search: bool,
    /// Starts from the last accepted state that search along every increment.
    pub searched: Account,
    /// Starts from a softened penalty.
    pub softened: Account,
    /// Starts from the last accepted state without mixed integration points, where those with them have failed.
    pub plain: Account,
}

impl Default for Habit {
    fn default() -> Self {
        Habit {
            hold: false,
            search: false,
            searched: Account::new(SEARCHED),
            softened: Account::new(SOFTENED),
            plain: Account::new(0),
        }
    }
}

impl Habit {
    /// Whether a search is worth a try where a step has failed without.
    pub fn may_search(&self) -> bool {
        self.searched.price() < f64::from(TOO_MANY)
    }

    /// Whether it is so before a penalty is softened.
    pub fn search_first(&self) -> bool {
        self.searched.price() < self.softened.price()
    }

    pub fn put(&self, out: &mut Writer) {
        let Habit {
            hold,
            search,
            searched,
            softened,
            plain,
        } = self;
        out.bool(*hold);
        out.bool(*search);
        searched.put(out);
        softened.put(out);
        plain.put(out);
    }

    pub fn take(from: &mut Reader) -> Result<Self, Malformed> {
        Ok(Habit {
            hold: from.bool()?,
            search: from.bool()?,
            searched: Account::take(from)?,
            softened: Account::take(from)?,
            plain: Account::take(from)?,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_cheaper_start_comes_first() {
        let mut habit = Habit::default();
        assert!(habit.may_search() && !habit.search_first());
        // Softened penalties take long: a search is tried, and kept while it is cheaper.
        habit.softened.tried(30, true);
        assert!(habit.search_first());
        habit.searched.tried(8, true);
        assert!(habit.search_first());
        habit.searched.tried(10, false);
        assert!(habit.search_first());
        habit.searched.tried(10, false);
        assert!(!habit.search_first() && habit.may_search());
        // What has never helped is given up.
        let mut habit = Habit::default();
        for _ in 0..3 {
            habit.searched.tried(10, false);
        }
        assert!(!habit.may_search());
    }
}
