//! Why a step has no solution, in words that name the place and the remedy.
use crate::assembly::Fault;
use crate::scene::ValueError;
use crate::system::linear::LinearError;

/// Why a step failed. All but [`StepFailure::Interrupted`] call for a smaller step.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum StepFailure {
    #[error(
        "no convergence in {iterations} iterations (residual {residual:.3e} of the forces){oscillation}"
    )]
    TooManyIterations {
        iterations: u32,
        residual: f64,
        /// Empty, or a word on points that switch status round and round.
        oscillation: String,
    },
    #[error("not a finite number at iteration {iteration}: {place}")]
    NotFinite {
        iteration: u32,
        /// What is not finite, in words: an element, a slave point, a load.
        place: String,
    },
    #[error(
        "increments grow without bounds: that of iteration {iteration} moves neighbouring nodes by {stretch:.0e} times their distance"
    )]
    Diverges {
        iteration: u32,
        /// Relative motion of neighbouring nodes by their distance, at most.
        stretch: f64,
    },
    /// Something in the scene has no value.
    #[error("`{pointer}`: {error}")]
    NoValue {
        /// JSON pointer of what has none.
        pointer: String,
        error: ValueError,
    },
    #[error("{0}")]
    Fault(#[from] Fault),
    #[error("linear solver: {error}{place}")]
    Solve {
        error: LinearError,
        /// Body and place of the node that it names, or nothing.
        place: String,
    },
    /// Nothing resists a motion of a body.
    #[error("linear solver: {error}; {words}")]
    Singular { error: LinearError, words: String },
    #[error("body `{body}` runs away: {}", runs_away(motion, reached, *loaded))]
    RunsAway {
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
    #[error(
        "the step was solved only under a penalty so soft that forces would be off by {:.2} %", 100.0 * error
    )]
    TooSoft {
        /// Relative error of forces.
        error: f64,
    },
    #[error(
        "the step gained {part:.1} times the energy that there was out of nothing, which no path through equilibria does: its \
         solution is another, folded one"
    )]
    GainedEnergy { part: f64 },
    /// The path jumped in the step, or the step is too large for what happens in it: energy went nowhere.
    #[error("an energy of {:.1} % of the work so far went nowhere, more than the size of the step explains", 100.0 * part)]
    Jumped { part: f64 },
    #[error(
        "the time integration errs by {error:.1e} of the largest displacement within the step, more than {allowed:.1e}"
    )]
    TooLong {
        error: f64,
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
        taken: f64,
        /// Part of the step that would take what is allowed.
        part: f64,
    },
    #[error(
        "contact `{pair}`: {points} point(s) that were in contact sank deeper than the `depth` {depth:.6e} of \
         {master}: the penalty is too soft for it, or the step too large"
    )]
    Sunk {
        pair: String,
        /// The master, in words.
        master: String,
        points: usize,
        depth: f64,
    },
    #[error(
        "contact `{pair}`: {points} point(s), one of them at ({:.6e}, {:.6e}, {:.6e}), passed through {master} within the \
         step, deeper than its `depth` {depth:.6e}: take smaller steps or a larger `depth`", at[0], at[1], at[2]
    )]
    PassedThrough {
        pair: String,
        /// The master, in words.
        master: String,
        points: usize,
        /// Where one of them ended.
        at: [f64; 3],
        depth: f64,
    },
    #[error(
        "contact `{pair}`: after {augmentations} augmentation(s) {what} of {left:.3e} is left, more than {allowed:.3e} \
         (`augmentation`): take a larger penalty, smaller steps or a larger `max`"
    )]
    NotAugmented {
        pair: String,
        augmentations: u32,
        /// A gap or an elastic slip, in words.
        what: &'static str,
        left: f64,
        allowed: f64,
    },
    #[error(
        "{count} element(s) of body `{body}` are turned inside out, element {element} first: the step is too large, or the \
         body pressed harder than its mesh and material carry"
    )]
    InsideOut {
        body: String,
        element: usize,
        count: usize,
    },
    #[error(
        "contact `{pair}`: {points} point(s) went through {master} within the step, deeper than its `depth` {depth:.6e}, and \
         touch it on its far side: take smaller steps or a larger `depth`"
    )]
    FarSide {
        pair: String,
        /// The master, in words.
        master: String,
        points: usize,
        depth: f64,
    },
    #[error(
        "surface `{surface}` turns by {degrees:.0} degrees within the step, more than the {largest:.0} over which the slip of \
         contact `{pair}` can be followed: take smaller steps"
    )]
    TurnedTooFar {
        pair: String,
        surface: String,
        degrees: f64,
        largest: f64,
    },
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
