//! Why a step has no solution, in words that name the place and the remedy.
use crate::assembly::Fault;
use crate::scene::ValueError;
use crate::system::linear::LinearError;

/// Why a step failed. All but [`StepFailure::Interrupted`] call for a smaller step.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum StepFailure {
    /// Newton's method did not converge.
    #[error(
        "no convergence in {iterations} iterations (residual {residual:.3e} of the forces){oscillation}"
    )]
    TooManyIterations {
        /// Iterations that were done.
        iterations: u32,
        /// Residual relative to the forces.
        residual: f64,
        /// Empty, or a word on points that switch status round and round.
        oscillation: String,
    },
    /// The forces became infinite or not a number.
    #[error("not a finite number at iteration {iteration}: {place}")]
    NotFinite {
        /// Number of the iteration.
        iteration: u32,
        /// What is not finite, in words: an element, a slave point, a load.
        place: String,
    },
    /// Increments grew from one iteration to the next.
    #[error(
        "increments grow without bounds: that of iteration {iteration} moves neighbouring nodes by {stretch:.0e} times their distance"
    )]
    Diverges {
        /// Number of the last iteration.
        iteration: u32,
        /// Relative motion of neighbouring nodes by their distance, at most.
        stretch: f64,
    },
    /// Something in the scene has no value.
    #[error("`{pointer}`: {error}")]
    NoValue {
        /// JSON pointer of what has none.
        pointer: String,
        /// Why it has none.
        error: ValueError,
    },
    /// An element or a slave point could not be evaluated.
    #[error("{0}")]
    Fault(#[from] Fault),
    /// The linear system could not be solved.
    #[error("linear solver: {error}{place}")]
    Solve {
        /// What the solver says.
        error: LinearError,
        /// Body and place of the node that it names, or nothing.
        place: String,
    },
    /// Nothing resists a motion of a body.
    #[error("linear solver: {error}; {words}")]
    Singular {
        /// What the solver says.
        error: LinearError,
        /// The motion and its remedy, in words.
        words: String,
    },
    /// Only viscous forces held a body, and it moved off.
    #[error("body `{body}` runs away: {}", runs_away(motion, reached, *loaded))]
    RunsAway {
        /// Name of the body.
        body: String,
        /// Its free motions, in words.
        motion: String,
        /// How far it has got, in words.
        reached: String,
        /// Whether the scene has loads that may drive it.
        loaded: bool,
    },
    /// Points that touched in iterates before are all open.
    #[error("all contact was lost on the way, to an equilibrium that is unstable")]
    LostContact,
    /// The penalty had to be softened more than forces allow.
    #[error(
        "the step was solved only under a penalty so soft that forces would be off by {:.2} %", 100.0 * error
    )]
    TooSoft {
        /// Relative error of forces.
        error: f64,
    },
    /// The step ended with more energy than it can have.
    #[error(
        "the step gained {part:.1} times the energy that there was out of nothing, which no path through equilibria does: its \
         solution is another, folded one"
    )]
    GainedEnergy {
        /// Energy gained over the energy that there was.
        part: f64,
    },
    /// The path jumped in the step, or the step is too large for what happens in it: energy went nowhere.
    #[error("an energy of {:.1} % of the work so far went nowhere, more than the size of the step explains", 100.0 * part)]
    Jumped {
        /// Energy lost over the work so far.
        part: f64,
    },
    /// The step was solved from a softened penalty only, and may have come to another equilibrium.
    #[error(
        "solved from a softened penalty only, it moved {times:.0} times as fast as the step before"
    )]
    Faster {
        /// Its speed over that of the step before.
        times: f64,
    },
    /// The step began at a stable equilibrium and came to one that may be none.
    #[error("from a stable equilibrium it came to one where {tangent}, which may be unstable")]
    Unstable {
        /// What its tangent is like.
        tangent: String,
    },
    /// The step is too long for its motion.
    #[error(
        "the time integration errs by {error:.1e} of the largest displacement within the step, more than {allowed:.1e}"
    )]
    TooLong {
        /// Error of the displacements, relative to the largest.
        error: f64,
        /// Largest error that is accepted.
        allowed: f64,
        /// Part of the step that would err by what is asked for.
        part: f64,
    },
    /// An impact is over within less than the step, whose integration takes its energy.
    #[error(
        "the time integration would take {:.1} % of the greatest energy within the step, in which bodies touch",
        100.0 * taken
    )]
    Damped {
        /// Energy taken over the greatest energy so far.
        taken: f64,
        /// Part of the step that would take what is allowed.
        part: f64,
    },
    /// Points in contact lie deeper than the depth of their master.
    #[error(
        "contact `{pair}`: {points} point(s) that were in contact sank deeper than the `depth` {depth:.6e} of \
         {master}: the penalty is too soft for it, or the step too large"
    )]
    Sunk {
        /// Name of the contact.
        pair: String,
        /// The master, in words.
        master: String,
        /// Number of such points.
        points: usize,
        /// Depth of the master (length).
        depth: f64,
    },
    /// Points went through their master within the step.
    #[error(
        "contact `{pair}`: {points} point(s), one of them at ({:.6e}, {:.6e}, {:.6e}), passed through {master} within the \
         step, or below its `depth` {depth:.6e}: take smaller steps", at[0], at[1], at[2]
    )]
    PassedThrough {
        /// Name of the contact.
        pair: String,
        /// The master, in words.
        master: String,
        /// Number of such points.
        points: usize,
        /// Where one of them ended.
        at: [f64; 3],
        /// Depth of the master (length).
        depth: f64,
    },
    /// Augmentations did not reach their tolerances.
    #[error(
        "contact `{pair}`: after {augmentations} augmentation(s) {what} of {left:.3e} is left, more than {allowed:.3e} \
         (`augmentation`): take a larger penalty, smaller steps or a larger `max`"
    )]
    NotAugmented {
        /// Name of the contact.
        pair: String,
        /// Augmentations that were done.
        augmentations: u32,
        /// A gap or an elastic slip, in words.
        what: &'static str,
        /// What is left (length).
        left: f64,
        /// The tolerance (length).
        allowed: f64,
    },
    /// Elements have turned inside out.
    #[error(
        "{count} element(s) of body `{body}` are turned inside out, element {element} first: the step is too large, or the \
         body pressed harder than its mesh and material carry"
    )]
    InsideOut {
        /// Name of the body.
        body: String,
        /// The first such element.
        element: usize,
        /// How many such elements there are.
        count: usize,
    },
    /// Points went through their master and touch its other side.
    #[error(
        "contact `{pair}`: {points} point(s) went through {master} within the step, deeper than its `depth` {depth:.6e}, and \
         touch it on its far side: take smaller steps or a larger `depth`"
    )]
    FarSide {
        /// Name of the contact.
        pair: String,
        /// The master, in words.
        master: String,
        /// Number of such points.
        points: usize,
        /// Depth of the master (length).
        depth: f64,
    },
    /// A rigid surface with friction turns too far in one step.
    #[error(
        "surface `{surface}` turns by {degrees:.0} degrees within the step, more than the {largest:.0} over which the slip of \
         contact `{pair}` can be followed: take smaller steps"
    )]
    TurnedTooFar {
        /// Name of the contact.
        pair: String,
        /// Name of the surface.
        surface: String,
        /// Its turn within the step (degrees).
        degrees: f64,
        /// Largest turn that is accepted (degrees).
        largest: f64,
    },
    /// The user, or a program, asked the run to stop.
    #[error("interrupted")]
    Interrupted,
}

impl StepFailure {
    /// Whether no equilibrium was found, or only one under softened penalties; not where one is refused for what it is, nor where a
    /// scene has no value.
    pub fn finds_none(&self) -> bool {
        match self {
            StepFailure::Fault(fault) => !matches!(fault, Fault::Value(_)),
            StepFailure::TooManyIterations { .. }
            | StepFailure::NotFinite { .. }
            | StepFailure::Diverges { .. }
            | StepFailure::Solve { .. }
            | StepFailure::Singular { .. }
            | StepFailure::RunsAway { .. }
            | StepFailure::LostContact
            | StepFailure::TooSoft { .. } => true,
            _ => false,
        }
    }

    /// Whether the step went elsewhere than its path, and is to be halved.
    pub fn halves(&self) -> bool {
        use StepFailure::{Faster, Jumped, Unstable};
        matches!(self, Jumped { .. } | Faster { .. } | Unstable { .. })
    }

    /// Whether points of this contact fell through their master.
    pub fn fell_through(&self, contact: &str) -> bool {
        matches!(self, StepFailure::Sunk { pair, .. } | StepFailure::FarSide { pair, .. } if pair == contact)
    }
}

/// Why a body runs away, and what helps; of loads only where there are any.
fn runs_away(motion: &str, reached: &str, loaded: bool) -> String {
    let (driven, remedy) = match loaded {
        true => ("loads drive it on, ", "more friction, or turn the loads"),
        false => ("", "or more friction"),
    };
    format!(
        "{driven}no support hinders it {motion}, and contact does not stop it ({reached}): add a support or a contact, {remedy}"
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A body that surfaces push is not driven by loads.
    #[test]
    fn loads_are_named_only_where_there_are_any() {
        let told = |loaded| {
            StepFailure::RunsAway {
                body: "cube".into(),
                motion: "along x".into(),
                reached: "far".into(),
                loaded,
            }
            .to_string()
        };
        assert!(told(true).contains("loads drive it on") && told(true).ends_with("turn the loads"));
        assert!(!told(false).contains("load"), "{}", told(false));
        for text in [told(true), told(false)] {
            assert!(text.contains("no support hinders it along x"), "{text}");
        }
    }
}
