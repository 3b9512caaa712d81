//! How the problem is solved, and what is written.
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
    pub step: Step,
    pub newton: Newton,
    pub linear_solver: LinearSolver,
    /// Threads; 0 takes what the machine has.
    pub threads: u32,
}

/// Step sizes, in time.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Step {
    /// First step.
    pub initial: f64,
    /// A step that would have to be smaller ends the run as not converged.
    pub min: f64,
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
    pub line_search: bool,
}

/// Factorization.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
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
}

/// What is written.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Output {
    /// Write fields at every n-th accepted step (the last is always written); 0 writes none.
    pub every: u32,
    /// Subdivisions of a Bezier piece in the tessellated copy of rigid surfaces.
    pub tessellation: u32,
    /// Write the slave points of contacts with friction too, with their values.
    pub contact_points: bool,
}

impl Default for Solution {
    fn default() -> Self {
        Solution {
            end_time: 1.0,
            stops: Vec::new(),
            step: Step::default(),
            newton: Newton::default(),
            linear_solver: LinearSolver::Auto,
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
        }
    }
}

impl Default for Output {
    fn default() -> Self {
        Output {
            every: 1,
            tessellation: 16,
            contact_points: false,
        }
    }
}
