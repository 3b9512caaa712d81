//! What comes of a step.
use super::Ending;

/// What came of a step.
pub(in crate::run) enum Outcome {
    /// It was accepted; with an ending where the run does not go on from there.
    Accepted(AcceptedStep, Option<Ending>),
    /// It was not.
    Stopped(Ending),
}

/// An accepted step.
pub(in crate::run) struct AcceptedStep {
    pub dt: f64,
    pub iterations: u32,
    pub cuts: u32,
}
