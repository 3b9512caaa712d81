//! Stages of a run: what acts from when on, and how a formed body is released.
use super::SetNames;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// A part of the run. Stages follow each other without a break: each goes on from the state in which the one before ended, plastic
/// strains included.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Stage {
    /// Name of the stage, for messages and the summary.
    pub name: String,
    /// Time at which it ends; left out in the last stage, which ends with the run.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub until: Option<f64>,
    /// How contacts end that were active before and are not listed in `contacts` (all of them where there is no list); default:
    /// `forces`. Not for the first stage.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub release: Option<Release>,
    /// The active contacts, by their names; default: those of the stage before, all in the first stage, and none in a stage with
    /// `release`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub contacts: Option<SetNames>,
    /// The active supports: a list of their names, in which `automatic` stands for those that the program finds where the others
    /// leave a body free, or `"automatic"` for all supports and these. Default: all supports, with `automatic` where `release` is
    /// `forces`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub supports: Option<SetNames>,
    /// Translations of rigid surfaces at the end of the stage (length); they go there evenly from where they were. Only for
    /// surfaces without a `motion.translation` of their own.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub tools: BTreeMap<String, [f64; 3]>,
    /// Factors of loads at the end of the stage, to which they grow evenly from what they were (0 before the first stage that names
    /// them). Only for loads that are given by numbers.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub loads: BTreeMap<String, f64>,
}

/// How the contacts of a formed body end.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Release {
    /// The tools are taken away: the forces of the contacts become loads on the bodies and are let down to zero in the course of the
    /// stage.
    Forces,
    /// The tools go back the way that they came, from the start of the stage to its end, with contact.
    Tools,
}

/// The name of the supports that the program finds.
pub const AUTOMATIC: &str = "automatic";

impl Stage {
    /// Whether supports are found where those that are given leave a body free.
    pub fn finds_supports(&self) -> bool {
        match &self.supports {
            Some(names) => names.iter().any(|n| n == AUTOMATIC),
            None => self.release == Some(Release::Forces),
        }
    }

    /// Whether a support of the scene is active.
    pub fn holds(&self, support: &str) -> bool {
        match &self.supports {
            None => true,
            Some(SetNames::One(name)) if name == AUTOMATIC => true,
            Some(names) => names.iter().any(|n| n == support),
        }
    }
}
