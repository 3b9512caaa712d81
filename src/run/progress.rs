//! What a run has done so far.

/// What a run has done so far.
#[derive(Debug, Clone, Default)]
pub(super) struct Progress {
    pub warnings: Vec<String>,
    /// Newton iterations, those of failed attempts included.
    pub iterations: u64,
    /// Newton iterations that accepted steps are made of.
    pub accepted: u64,
    /// [`Self::iterations`] when the last step was accepted.
    pub counted: u64,
    pub cuts: u32,
    /// Cycles of contact points that were broken.
    pub ping_pongs: u32,
    pub steps: u32,
    pub time: f64,
    /// Largest strain energy at which the terms beyond linear elements were measured.
    pub measured: f64,
}

impl Progress {
    /// Takes back warnings that begin like this, since what they told has passed.
    pub fn forget(&mut self, head: &str) {
        self.warnings.retain(|warning| !warning.starts_with(head));
    }
}
