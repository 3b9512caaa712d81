//! The plan of a run, as its summary states it.
use serde::{Deserialize, Serialize};

/// What a run did, in its summary.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct PlanSummary {
    /// Whether the system was symmetric.
    pub symmetric: bool,
    /// What made it unsymmetric.
    pub unsymmetric: Vec<String>,
    /// Effects of the scene as a whole that were on.
    pub effects: Vec<EffectSummary>,
    /// What was done at the points of every contact pair.
    pub pairs: Vec<PairSummary>,
}

/// An effect that was on.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct EffectSummary {
    /// Name of the effect.
    pub name: String,
    /// What of the scene or its geometry decides, in words.
    pub why: String,
    /// Line and column of the key in the scene file, or of what would hold it.
    pub at: String,
}

/// A contact pair.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct PairSummary {
    /// Name of the contact.
    pub name: String,
    /// The second of two half passes.
    #[serde(default)]
    pub back: bool,
    /// The sharp edges of the master as slaves.
    #[serde(default)]
    pub edges: bool,
    /// The loop over its points that was planned.
    pub kernel: String,
    /// The one that evaluated the points last, told by what it was compiled for; none where none did.
    pub ran: Option<String>,
    /// Effects that were on.
    pub effects: Vec<EffectSummary>,
}
