//! Curves that a scene asks for.
use super::SetNames;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// A curve in `history.csv`, for the nodes of sets (`on`), the node nearest a point (`near`), or a whole body (`body`).
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Probe {
    /// Node or face set, `body.set`, or a list of them.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub on: Option<SetNames>,
    /// The node that is nearest to this point of the undeformed bodies.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub near: Option<[f64; 3]>,
    /// All nodes of this body; with `near` the body whose node is meant.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub body: Option<String>,
    /// What is recorded.
    pub quantity: ProbeQuantity,
    /// What is taken of several nodes. Default: the mean of displacements, the sum of reactions, the largest stress.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub take: Option<ProbeTake>,
}

/// What a probe records.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum ProbeQuantity {
    /// Displacement, by components.
    #[default]
    Displacement,
    /// Force that supports exert on the nodes, by components.
    Reaction,
    /// Von Mises stress at the nodes, as fields have it.
    VonMises,
}

/// What a probe takes of several nodes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum ProbeTake {
    /// The mean over the nodes, each of them counted alike.
    Mean,
    /// The largest value; of vectors the largest length.
    Max,
    /// The sum over the nodes.
    Sum,
}

impl Probe {
    /// What is taken of several nodes.
    pub fn taken(&self) -> ProbeTake {
        self.take.unwrap_or(match self.quantity {
            ProbeQuantity::Displacement => ProbeTake::Mean,
            ProbeQuantity::Reaction => ProbeTake::Sum,
            ProbeQuantity::VonMises => ProbeTake::Max,
        })
    }
}
