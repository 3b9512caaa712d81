//! The starts of a step, and their order.
use super::Attempts;
use crate::run::habit::Account;
use crate::solve::newton::StepFailure;

/// Cuts from which on an attempt leaves no start out.
const SMALL: u32 = 4;

/// Starts of a step.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Start {
    /// The path, continued.
    Path,
    Accepted,
    /// The same without mixed integration points, where nothing is in contact: with contact it has solved 2 of 383 steps.
    Plain,
    Searched,
    Softened,
}

impl Start {
    pub fn words(self) -> &'static str {
        match self {
            Start::Path => "the continued path",
            Start::Accepted => "the last accepted state",
            Start::Plain => "the last accepted state, without mixed integration points",
            Start::Searched => "the last accepted state, searching along every increment",
            Start::Softened => "a softened penalty",
        }
    }
}

/// Whether another start may do better: none brings tractions nearer to multipliers.
pub(super) fn another(failure: &StepFailure) -> bool {
    !matches!(
        failure,
        StepFailure::Interrupted | StepFailure::NotAugmented { .. }
    )
}

impl Attempts<'_, '_> {
    /// The starts of a step in their order; there is a path or not.
    pub(super) fn starts(&self, path: bool, touching: bool) -> Vec<Start> {
        let searched = self.habit.search;
        let softens = touching && !self.put_off(Start::Softened);
        // Where the path fails, what lies behind the last step is seldom much nearer: of 430 runs softened penalties then solved half
        // of the steps, starts from the last accepted state a fifth.
        let sooner = path && softens && !searched;
        let mut starts = Vec::with_capacity(4);
        if path {
            starts.push(Start::Path);
        }
        if sooner {
            starts.push(Start::Softened);
        }
        if searched {
            starts.push(Start::Searched);
        } else if !path || !self.put_off(Start::Accepted) {
            starts.push(Start::Accepted);
        }
        if softens && !sooner {
            starts.push(Start::Softened);
        }
        // A step that was cut is near enough to the path that a search is unlikely to leave it for another equilibrium.
        let searches = self.settings.line_search && self.habit.may_search();
        if self.cuts > 0 && !searched && searches && !self.model.flows() {
            let cheaper = self.habit.searched.price() < self.habit.softened.price();
            let softened = starts.iter().position(|s| *s == Start::Softened);
            let at = softened.filter(|_| cheaper).unwrap_or(starts.len());
            starts.insert(at, Start::Searched);
        }
        if self.put_off(starts[0])
            && let Some(cheapest) = (1..starts.len())
                .filter(|i| self.account(starts[*i]).solves())
                .min_by(|i, j| {
                    let [i, j] = [i, j].map(|i| self.account(starts[*i]).price());
                    i.total_cmp(&j)
                })
            && self.account(starts[cheapest]).price() < self.account(starts[0]).price()
        {
            starts[..=cheapest].rotate_right(1);
        }
        starts
    }

    /// Whether an attempt does without a start, which has failed again and again. One at a step that is small already has all.
    pub(super) fn put_off(&self, start: Start) -> bool {
        self.cuts < SMALL && self.account(start).put_off()
    }

    pub(super) fn account(&self, start: Start) -> &Account {
        match start {
            Start::Path => &self.habit.path,
            Start::Accepted | Start::Plain => &self.habit.accepted,
            Start::Searched => &self.habit.searched,
            Start::Softened => &self.habit.softened,
        }
    }
}
