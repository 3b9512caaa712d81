//! The plan of a run, as its summary states it.
use crate::model::plan::{Effect, Kernel, Plan};
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
    pub pairs: Vec<PairSummary>,
}

/// An effect that was on.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct EffectSummary {
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
    /// The loop over its points that was planned.
    pub kernel: String,
    /// The one that evaluated the points last, told by what it was compiled for; none where none did.
    pub ran: Option<String>,
    /// Effects that were on.
    pub effects: Vec<EffectSummary>,
}

impl PlanSummary {
    /// Of a run whose pairs were evaluated by these kernels.
    pub fn new(plan: &Plan, ran: &[Option<Kernel>]) -> PlanSummary {
        let on = |effects: &[Effect]| -> Vec<EffectSummary> {
            let on = effects.iter().filter(|e| e.on);
            on.map(|e| EffectSummary {
                name: e.name.to_owned(),
                why: e.why.clone(),
                at: e.place.to_string(),
            })
            .collect()
        };
        PlanSummary {
            symmetric: plan.symmetric,
            unsymmetric: plan.unsymmetric.clone(),
            effects: plan.groups.iter().flat_map(|g| on(&g.effects)).collect(),
            pairs: (plan.pairs.iter().zip(ran))
                .map(|(pair, ran)| PairSummary {
                    name: pair.name.clone(),
                    back: pair.back,
                    kernel: pair.kernel.to_string(),
                    ran: ran.map(|k| k.to_string()),
                    effects: on(&pair.effects),
                })
                .collect(),
        }
    }
}
