//! The plan of a run and the kernels that ran, as the run's summary states them.
use super::{Effect, Plan};
use crate::model::kernel::Kernel;
use crate::output::{EffectSummary, PairSummary, PlanSummary};

impl Plan {
    /// For the summary of a run whose pairs were evaluated by these kernels.
    pub fn summary(&self, ran: &[Option<Kernel>]) -> PlanSummary {
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
            symmetric: self.symmetric,
            unsymmetric: self.unsymmetric.clone(),
            effects: self.groups.iter().flat_map(|g| on(&g.effects)).collect(),
            pairs: (self.pairs.iter().zip(ran))
                .map(|(pair, ran)| PairSummary {
                    name: pair.name.clone(),
                    back: pair.back,
                    edges: pair.edges,
                    kernel: pair.kernel.to_string(),
                    ran: ran.map(|k| k.to_string()),
                    effects: on(&pair.effects),
                })
                .collect(),
        }
    }
}
