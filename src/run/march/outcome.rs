//! What comes of a step.
use crate::output::RunStatus;

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

/// How a run ended.
#[derive(Debug, Clone)]
pub(in crate::run) struct Ending {
    pub status: RunStatus,
    pub reason: Option<String>,
    /// Numbers of the bodies whose enhanced strains are what the run could not go on with.
    pub squeezed: Vec<usize>,
    /// The last step was accepted before they were looked into.
    pub accepted: bool,
    /// It was given up since edges of masters lie in slaves.
    pub on_rims: bool,
    /// It was given up since surfaces sink into the slaves of these pairs, between their points.
    pub between: Vec<usize>,
    /// It was given up since slave points of these pairs slide over flat faces of curved masters, which may be smooth.
    pub slid: Vec<usize>,
}

impl Ending {
    /// One that neither elements nor edges account for.
    pub fn new(status: RunStatus, reason: Option<String>) -> Self {
        Ending {
            status,
            reason,
            squeezed: Vec::new(),
            accepted: false,
            on_rims: false,
            between: Vec::new(),
            slid: Vec::new(),
        }
    }
}
