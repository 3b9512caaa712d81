//! How the problem is solved, and what is written.
use super::dynamics::Dynamics;
use super::mumps::Mumps;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// How the problem is solved.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Solution {
    /// The run goes from time 0 to this time.
    pub end_time: f64,
    /// Times at which a step must end, ascending; steps end at the rows of tables in any case.
    pub stops: Vec<f64>,
    /// How far displacements may go.
    pub kinematics: Kinematics,
    /// Motion with inertia; without it a run is a sequence of equilibria.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub dynamics: Option<Dynamics>,
    /// Step sizes, in time.
    pub step: Step,
    /// Newton's method.
    pub newton: Newton,
    /// Factorization.
    pub linear_solver: LinearSolver,
    /// Stabilisation, written `"auto"`, `"none"` or `{"viscous": {"factor": 1e-3, "until": 0.5}}`.
    pub stabilization: Stabilization,
    /// Threads; 0 takes what the machine has.
    pub threads: u32,
}

/// What displacements and rotations may be.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Kinematics {
    /// Of any size.
    #[default]
    Large,
    /// Small: elements are linear, and contact is linearised where it starts, with the normals and feet of the undeformed
    /// bodies. One factorization serves every step with the same points in contact. What is neglected is measured, and
    /// told where it is not small. Without augmentation and the like.
    Small,
}

/// Step sizes, in time.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Step {
    /// First step.
    pub initial: f64,
    /// A step that would have to be smaller ends the run as not converged.
    pub min: f64,
    /// Largest step.
    pub max: f64,
    /// Adapt the step to the iterations it takes; a step that fails is cut in any case.
    pub adaptive: bool,
}

/// Newton's method.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Newton {
    /// Iterations a step may take before it is cut.
    pub max_iterations: u32,
    /// Residual relative to the largest force in the system, or to its round-off floor where that is higher.
    pub tolerance: f64,
    /// Shorten steps of Newton's method that do not lower the residual, and all that go too far where a material flows.
    pub line_search: bool,
    /// Mixed integration points: stresses in the tangent of shells are continued along the last correction, which lets a
    /// step rotate a thin shell much farther. The equilibrium is the same. Tried first, and left out where it does not help.
    pub mixed: bool,
}

/// Factorization.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum LinearSolver {
    /// Cholesky, and LDL^T where the matrix turns out indefinite; LU where an effect makes it unsymmetric.
    #[default]
    Auto,
    /// Cholesky: the run fails where the matrix is indefinite.
    Llt,
    /// LDL^T without pivoting, for symmetric matrices.
    Ldlt,
    /// LU, for symmetric matrices too (about twice the cost).
    Lu,
    /// LDL^T or LU on a graphics processor, by NVIDIA's cuDSS; needs a program that was built with the feature `cudss`.
    Cudss,
    /// LDL^T or LU by MUMPS; needs a program that was built with the feature `mumps`.
    Mumps(Mumps),
}

/// Stabilisation, written `"auto"`, `"none"` or `{"viscous": {"factor": 1e-3, "until": 0.5}}`.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum Stabilization {
    /// `viscous` with its default factor on bodies that only contact holds, and next to nothing of it in steps in which contact
    /// does; nothing where supports hold all. The motion that supports prescribe for such a body meets no force.
    #[default]
    Auto,
    /// Equilibrium without help: a body must be held by its supports, and a structure that snaps fails.
    None,
    /// Every unknown of a body feels a force `c m (u - u_start) / dt` in every step, `m` being the volume of its node and
    /// `c = factor * end_time * E (h / L)^2 / L^2` (force time / length^4) of the body that bends most easily: E Young's
    /// modulus, L its length, h its mean thickness. A motion spread over the whole run meets forces of about `factor` times
    /// those that bend that body as far. Bodies may then be held by contact alone, and structures snap through.
    Viscous {
        /// Positive; large enough to hold, small enough to dissipate little (which is told).
        #[serde(default = "default_factor")]
        factor: f64,
        /// Steps that start at this time or later are not stabilised.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        until: Option<f64>,
    },
}

/// Factor of the viscous stabilisation where none is given.
pub const VISCOUS_FACTOR: f64 = 1e-3;

fn default_factor() -> f64 {
    VISCOUS_FACTOR
}

/// What is written.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Output {
    /// Write fields at every n-th accepted step (the last is always written); 0 writes none.
    pub every: u32,
    /// Most subdivisions of a Bezier piece, in either direction, in the tessellated copy of rigid surfaces; fewer where the copy is
    /// within 2e-4 of the size of the surface, or of the bodies.
    pub tessellation: u32,
    /// Write the slave points of contacts with friction too, with their values.
    pub contact_points: bool,
    /// Write the stresses of shells at the bottom, in the middle and at the top of the thickness too, in the directions of the
    /// mid-surface.
    pub shell_stresses: bool,
    /// Write the fields of bodies with all digits of double precision; else displacements have nearly ten of them and all other fields
    /// nearly five, which takes half the room.
    pub full_precision: bool,
}

impl Default for Solution {
    fn default() -> Self {
        Solution {
            end_time: 1.0,
            stops: Vec::new(),
            kinematics: Kinematics::Large,
            dynamics: None,
            step: Step::default(),
            newton: Newton::default(),
            linear_solver: LinearSolver::Auto,
            stabilization: Stabilization::Auto,
            threads: 0,
        }
    }
}

impl Default for Step {
    fn default() -> Self {
        Step {
            initial: 0.1,
            min: 1e-5,
            max: 0.1,
            adaptive: true,
        }
    }
}

impl Default for Newton {
    fn default() -> Self {
        Newton {
            max_iterations: 25,
            tolerance: 1e-8,
            line_search: true,
            mixed: true,
        }
    }
}

impl Default for Output {
    fn default() -> Self {
        Output {
            every: 1,
            tessellation: 16,
            contact_points: false,
            shell_stresses: false,
            full_precision: false,
        }
    }
}
