//! What a run tells while it goes: the library never prints, it calls an [`Observer`].
use serde::Serialize;

/// Events of a run, in the order they happen. Serialised as one JSON object a line by `covact run --json`.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(tag = "event", rename_all = "snake_case")]
pub enum Event {
    /// The model is built; nothing has been solved.
    Model {
        /// Unknowns.
        dofs: usize,
        /// Slave points of all contacts.
        contact_points: usize,
        /// Effects that are on, by name.
        effects: Vec<String>,
        /// Automatic choices, e.g. penalties and sides, in words.
        notes: Vec<String>,
    },
    /// A step from `time - dt` to `time` starts.
    StepStarted {
        /// Number of the step, from 1.
        step: u32,
        /// Time at its end.
        time: f64,
        /// Its size (time).
        dt: f64,
    },
    /// One Newton iteration is done.
    Iteration {
        /// Number of the step, from 1.
        step: u32,
        /// Number of the iteration in the attempt.
        iteration: u32,
        /// Residual relative to the largest force.
        residual: f64,
        /// Energy measure |du . R| relative to the first iteration of the step.
        energy: f64,
        /// Points in contact.
        active: usize,
        /// Points whose status changed.
        changed: usize,
        /// Factor of the line search (1: full step).
        line_search: f64,
    },
    /// Tractions have become multipliers, and the step is in equilibrium again.
    Augmented {
        /// Number of the step, from 1.
        step: u32,
        /// Number of the augmentation within the step; 0 is the equilibrium before the first.
        augmentation: u32,
        /// The contact that is farthest from its tolerances.
        contact: String,
        /// Its largest gap of a point in contact (length).
        gap: f64,
        /// Its largest elastic slip of a point that sticks (length).
        slip: f64,
    },
    /// An augmentation raised a penalty, because the gaps shrank too slowly under it.
    PenaltyRaised {
        /// Number of the step, from 1.
        step: u32,
        /// Name of the contact.
        contact: String,
        /// The new penalty (force / length^3).
        penalty: f64,
        /// Part of the gaps that the last augmentation left.
        left: f64,
    },
    /// An automatic penalty made too large an error, and the step is solved again under a stiffer one.
    PenaltyRuled {
        /// Number of the step, from 1.
        step: u32,
        /// Name of the contact.
        contact: String,
        /// The new penalty (force / length^3).
        penalty: f64,
        /// Relative error of forces under the one before.
        error: f64,
    },
    /// A step is in equilibrium, and its results are kept.
    StepAccepted {
        /// Number of the step, from 1.
        step: u32,
        /// Time at its end.
        time: f64,
        /// Iterations of the attempt that was accepted.
        iterations: u32,
        /// Iterations of the step's attempts that failed before.
        failed_iterations: u32,
        /// Points in contact.
        active: usize,
        /// Largest penetration of a point (length).
        penetration: f64,
    },
    /// Contact points switched between open and closed round and round; the next iterations break the cycle.
    PingPong {
        /// Number of the step, from 1.
        step: u32,
        /// Number of the iteration in the attempt.
        iteration: u32,
        /// The contact with most of them.
        contact: String,
        /// Their number.
        points: usize,
        /// Iterations after which all was as it was.
        period: usize,
        /// Where one of them is.
        at: [f64; 3],
        /// How the cycle is broken, in words.
        broken: String,
    },
    /// An attempt at a step failed, everything was rolled back, and the step is tried again from another start.
    StepRetried {
        /// Number of the step, from 1.
        step: u32,
        /// The new start, in words.
        start: String,
        /// Why the attempt failed, in words.
        reason: String,
    },
    /// A step failed from every start, everything was rolled back, and a smaller one is tried.
    StepCut {
        /// Number of the step, from 1.
        step: u32,
        /// Size of the step that failed (time).
        dt: f64,
        /// Size of the step that is tried next (time).
        next_dt: f64,
        /// Why the step failed, in words.
        reason: String,
    },
    /// Something that is as it should be, in words.
    Note {
        /// The note.
        text: String,
    },
    /// Something the user should know.
    Warning {
        /// The warning.
        text: String,
    },
    /// The run ended.
    Finished {
        /// `status` of `summary.json`, e.g. `done`.
        status: String,
        /// Elapsed time (s).
        wall_s: f64,
    },
}

/// Receives the events of a run.
pub trait Observer {
    /// Takes an event, in the order in which they happen.
    fn event(&mut self, event: &Event);
}

/// Ignores every event.
pub struct Silent;

impl Observer for Silent {
    fn event(&mut self, _: &Event) {}
}

impl<O: Observer + ?Sized> Observer for &mut O {
    fn event(&mut self, event: &Event) {
        (**self).event(event);
    }
}
