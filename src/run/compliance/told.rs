//! What the user is told of the compliance of contact.
use super::{Compliance, MEAN, Measured, WARNED};
use crate::model::Model;
use crate::model::error::number;
use crate::output::Accuracy;

/// Error that the proposed penalty leaves.
const WANTED: f64 = 0.003;
/// Error from which on the linear estimate says no more than that contact gives way.
const ALL: f64 = 0.5;

impl Compliance {
    /// The larger of the errors at the last step and at that of the largest force, by what rigid contact would change; where
    /// that could not be measured, the largest by what shows in energies and penetrations.
    fn told(&self) -> &Measured {
        let [peak, last] = &self.limits;
        match (last.step > 0, peak.error > last.error) {
            (true, true) => peak,
            (true, false) => last,
            (false, _) => &self.worst,
        }
    }

    /// What the user is told at the end of a run, under the penalties that it ended with.
    pub fn warning(&self, model: &Model, penalties: &[f64]) -> Option<String> {
        let Measured {
            measures,
            error,
            step,
            time,
            pair,
            ..
        } = *self.told();
        let (pair, eps) = (model.pairs.get(pair as usize)?, penalties[pair as usize]);
        if error <= WARNED {
            return None;
        }
        let off = match error > ALL {
            true => "more than half".to_owned(),
            false => format!("about {:.1} %", 100.0 * error),
        };
        // The larger the measure that the error comes from, the stiffer.
        let shows = (measures.energy)
            .max(MEAN * measures.penetration)
            .max(measures.growth);
        let measure = if error > ALL { error.max(shows) } else { error };
        let times = (measure / WANTED).clamp(2.0, 1e15);
        let remedy = match pair.augmentation {
            Some(_) => "take a smaller `gap` of its `augmentation`".to_owned(),
            None => format!(
                "take a `penalty` of about {{\"value\": {:.0e}}} there ({times:.0e} times the present one), or `augmentation`",
                eps * times
            ),
        };
        let growth = match measures.growth > 0.0 {
            true => format!(
                ", and {:.2} % of the work of the last steps went into contact",
                100.0 * measures.growth
            ),
            false => String::new(),
        };
        Some(format!(
            "contact gives way: forces (displacements, where loads are given) are off by {off}. At step {step} (time {}) the \
             energy of contact was {} of the strain energy, most of it in contact `{}`, and the deepest penetration {} of \
             the approach{growth}: {remedy}",
            number(time),
            share(measures.energy),
            pair.name,
            share(measures.penetration)
        ))
    }

    /// The measures as they stand in the summary.
    pub fn account(&self, model: &Model) -> Accuracy {
        let Measured {
            measures,
            error,
            step,
            time,
            pair,
            ..
        } = *self.told();
        let name = model.pairs.get(pair as usize);
        Accuracy {
            force_error: error,
            energy_ratio: measures.energy.min(f64::MAX),
            penetration_ratio: measures.penetration.min(f64::MAX),
            energy_growth: measures.growth,
            step,
            time,
            contact: name.filter(|_| step > 0).map(|p| p.name.clone()),
            contacts: Vec::new(),
        }
    }
}

/// A part in percent, or a multiple.
fn share(x: f64) -> String {
    match x < 1.0 {
        true => format!("{:.2} %", 100.0 * x),
        false => format!("{x:.1e} times"),
    }
}
