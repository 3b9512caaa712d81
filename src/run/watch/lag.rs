//! Plastic work that steps leave out because flow turns within them.
use super::{Watch, Work};
use crate::shell::Flow;

/// Share of the work above which it is told. Where a sheet is bent and straightened within a step twice as much is left out, where
/// flow turns once and goes on a third to a half.
const TOLD: f64 = 0.03;

impl Watch {
    /// Takes how materials flowed in a step of this work; returns what of the work it left out, as a part. Where what is prescribed
    /// has a kink at its start (`turns`), flow may turn there at once.
    pub fn flowed(&mut self, mut flow: Flow, work: &Work, turns: bool) -> f64 {
        if turns {
            flow.lag = 0.0;
        }
        self.flow = [self.flow, flow].into_iter().sum();
        let all = work.external.abs().max(flow.work);
        if all > 0.0 { flow.lag / all } else { 0.0 }
    }

    /// What is said at the end of a run whose steps left out too much.
    pub fn lagging(&self) -> Option<String> {
        let all = (self.external + self.adjusted).abs().max(self.flow.work);
        let part = self.flow.lag / all;
        (part > TOLD).then(|| {
            format!(
                "the steps are large for how material flows in them: its direction turns within a step, by which about {:.0} % of the \
                 work may be left out, and forces be off by some per cent. Take a smaller `solution.step.max`",
                100.0 * part
            )
        })
    }
}
