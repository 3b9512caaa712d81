//! Motion with inertia.
use super::solution::{Solution, Step};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Motion with inertia, integrated in time by the generalised-alpha method (J. Chung and G. M. Hulbert, Journal of Applied
/// Mechanics 60, 1993). Times, densities and velocities are in the units of the scene; every material needs a `density`.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Dynamics {
    /// What is left after a step of vibrations that are far too fast for it, from 0 (nothing) to 1 (all). Below 1 the method
    /// damps what a step cannot resolve.
    pub rho_inf: f64,
    /// Forces against the velocity.
    pub damping: Damping,
    /// Error of the displacements that a step may make, relative to the largest displacement so far. It chooses the steps,
    /// where these are `adaptive`.
    pub tolerance: f64,
    /// When contact and friction act within a step.
    pub contact: ContactTiming,
}

/// Forces against the velocity.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Damping {
    /// Force over mass and velocity (1 / time). It slows rigid motions too. A vibration of circular frequency `w` has the
    /// damping ratio `mass / (2 w)`.
    pub mass: f64,
    /// Viscosity of the material over its moduli (time), after Kelvin and Voigt: stresses against the rate of strain, with the
    /// moduli at small strain. Rigid motions are free. A vibration of circular frequency `w` has the damping ratio
    /// `viscosity w / 2`.
    pub viscosity: f64,
}

/// When contact and friction act within a step.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum ContactTiming {
    /// At its end: impacts neither vibrate nor gain energy, at any penalty and step. A penalty acts as a damper too, so that
    /// what hardly deforms rebounds too little unless the steps are short.
    #[default]
    Implicit,
    /// As all other forces, weighted between its start and its end: for bodies that hardly deform on a soft penalty, with steps
    /// that resolve their contact (ten or more in a contact time).
    Weighted,
}

/// A rotation about a point at the start.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Spin {
    /// Angular velocity vector (radians / time).
    pub rate: [f64; 3],
    /// A point that it leaves at rest; the centre of mass where none is given.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub about: Option<[f64; 3]>,
}

impl Default for Dynamics {
    fn default() -> Self {
        Dynamics {
            rho_inf: 0.8,
            damping: Damping::default(),
            tolerance: 1e-3,
            contact: ContactTiming::Implicit,
        }
    }
}

/// Parts of the time of a run that its first, smallest and largest steps are in dynamics, where the scene gives none.
const STEPS: [f64; 3] = [1e-2, 1e-7, 0.05];
/// Times of a static run within which its steps do not depend on them, where the scene gives none: a shorter one has as many steps as
/// one of the first, a longer one as many as one of the second.
const USUAL: [f64; 2] = [1.0, 10.0];

impl Solution {
    /// The sizes of steps: those that are not `given`, by their keys, are bounded by those that are; in dynamics they are parts of the
    /// time of the run, and in statics fit to it where it is not one of the usual ones.
    pub fn steps(&self, given: impl Fn(&str) -> bool) -> Step {
        let Step {
            initial,
            min,
            max,
            adaptive,
        } = self.step;
        let [short, long] = USUAL;
        // What is wrong with the time is told where it stands.
        let fit = match self.end_time > 0.0 && self.end_time.is_finite() {
            true => (self.end_time / short).min(1.0) * (self.end_time / long).max(1.0),
            false => 1.0,
        };
        let part = |key: &str, own: f64, part: f64| match (given(key), &self.dynamics) {
            (true, _) => own,
            (false, None) => own * fit,
            (false, Some(_)) => part * self.end_time,
        };
        let [first, smallest, largest] = STEPS;
        let mut large = part("max", max, largest);
        let mut begin = part("initial", initial, first);
        match given("initial") {
            true if !given("max") => large = large.max(begin),
            true => {}
            false => begin = begin.min(large),
        }
        let mut small = part("min", min, smallest);
        if given("min") && !given("initial") {
            begin = begin.max(small);
            large = if given("max") {
                large
            } else {
                large.max(begin)
            };
        }
        if !given("min") && self.dynamics.is_some() {
            small = small.min(begin);
        }
        Step {
            initial: begin,
            min: small,
            max: large,
            adaptive,
        }
    }
}
