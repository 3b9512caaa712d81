//! What a run found about the accuracy of its contact forces.
use serde::{Deserialize, Serialize};

/// How much of the forces the compliance of contact takes away, and which slave points carry them.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct Accuracy {
    /// Estimated relative error of forces, and of displacements where loads are given, to first order in the compliance of contact:
    /// the larger of those at the last step and at the step of the largest force, relative to that force; 0 without contact.
    pub force_error: f64,
    /// Energy of contact over strain energy at the step that it is of.
    pub energy_ratio: f64,
    /// Penetration over the approach of the bodies there.
    pub penetration_ratio: f64,
    /// Change of the energy of contact over the work done there, where the last steps tell; else 0.
    pub energy_growth: f64,
    /// That step; 0 without contact.
    pub step: u32,
    /// Its time.
    pub time: f64,
    /// The contact that stores most there.
    pub contact: Option<String>,
    /// Per contact, at the step of its largest force.
    pub contacts: Vec<ContactAccuracy>,
}

/// Which slave points carried the largest force of a contact.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ContactAccuracy {
    /// Name of the contact.
    pub name: String,
    /// Which part of it, where it has two: none for the slave as the scene has it, `edges` for the edges of the master as slaves,
    /// `exchanged` for the half pass with its sides exchanged.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub part: Option<String>,
    /// Sum of pressure times area (force).
    pub force: f64,
    /// The step in which it acted; 0 without contact.
    pub step: u32,
    /// Points in contact.
    pub active: usize,
    /// Number of points that carried 90 % of it where these were fewer than five.
    pub few: Option<usize>,
    /// Part of it that points near sharp convex edges of the tool carried.
    pub edge_share: f64,
    /// Penalty at the end of the run, and the tangential one (0 without friction; force / length^3).
    #[serde(default)]
    pub penalty: f64,
    /// Tangential penalty at the end of the run; 0 without friction (force / length^3).
    #[serde(default)]
    pub tangential_penalty: f64,
    /// Estimated relative error of its friction by the elastic slip of points that stick; 0 without friction.
    #[serde(default)]
    pub friction_error: f64,
}
