//! What a case found.
use super::CaseError;
use serde::Serialize;

/// A number held against its limit.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Check {
    /// What the number is, in words.
    pub what: String,
    /// The number that came out.
    pub value: f64,
    /// Largest value that passes.
    pub limit: f64,
}

impl Check {
    /// Whether the value is finite and within its limit.
    pub fn passed(&self) -> bool {
        self.value <= self.limit && self.value.is_finite()
    }

    /// Share of the limit that the value takes up.
    fn share(&self) -> f64 {
        match self.value.is_finite() {
            true if self.limit > 0.0 => self.value / self.limit,
            true if self.value <= self.limit => 0.0,
            _ => f64::INFINITY,
        }
    }
}

/// How a case came out.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Verdict {
    /// All numbers that were compared.
    pub checks: Vec<Check>,
    /// Newton iterations of all runs of the case, those of failed attempts included.
    pub iterations: u64,
    /// Largest number of iterations that passes.
    pub allowed: u64,
    /// Elapsed time (s).
    pub seconds: f64,
    /// Why the case did not come to its end; none: it did.
    pub broken: Option<String>,
}

impl Verdict {
    pub(super) fn broken(broken: CaseError) -> Self {
        Verdict {
            checks: Vec::new(),
            iterations: 0,
            allowed: 0,
            seconds: 0.0,
            broken: Some(broken.to_string()),
        }
    }

    /// Whether all checks hold, there is one, and the iterations are within their limit.
    pub fn passed(&self) -> bool {
        self.broken.is_none()
            && !self.checks.is_empty()
            && self.checks.iter().all(Check::passed)
            && self.iterations <= self.allowed
    }

    /// The check that comes nearest to its limit, or passes it farthest.
    pub fn tightest(&self) -> Option<&Check> {
        (self.checks.iter()).reduce(|a, b| if b.share() > a.share() { b } else { a })
    }

    /// Everything that does not hold, in words, a line each.
    pub fn failures(&self) -> Vec<String> {
        let mut out: Vec<String> = self.broken.iter().cloned().collect();
        let failed = self.checks.iter().filter(|c| !c.passed());
        out.extend(failed.map(|c| format!("{}: {:.3e}, limit {:.1e}", c.what, c.value, c.limit)));
        if self.iterations > self.allowed {
            out.push(format!(
                "{} Newton iterations, at most {} allowed",
                self.iterations, self.allowed
            ));
        }
        if self.checks.is_empty() && self.broken.is_none() {
            out.push("nothing was checked".to_owned());
        }
        out
    }
}
