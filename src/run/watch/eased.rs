//! What a change of penalties puts into a step.
use super::{Watch, Work};

impl Watch {
    /// The largest ratio, above one, of a penalty, normal or tangential, to that of the last accepted step or the other way round.
    pub(super) fn eased(&self, [penalties, ratios]: [&[f64]; 2]) -> f64 {
        let before = self.penalties.iter().zip(&self.ratios);
        let now = penalties.iter().zip(ratios);
        let all = before
            .zip(now)
            .flat_map(|((p, r), (p_now, r_now))| [(*p, *p_now), (r * p, r_now * p_now)]);
        let known = all.filter(|(before, now)| *before > 0.0 && *now > 0.0);
        known
            .map(|(before, now)| (before / now).max(now / before))
            .fold(1.0, f64::max)
    }

    /// The part of what a step stores more than was put in (`lacks`; negative where it lost some) that a change of penalties explains.
    /// Taken at its start it changes what they store there: as their inverse where forces stay, as themselves where penetrations do.
    /// What the trapezoidal rule may be off by is not told apart.
    pub(super) fn put_in_by_penalties(&self, step: u32, work: &Work, lacks: f64) -> f64 {
        let (ratio, stored) = (work.eased.max(1.0), self.stored.max(0.0));
        let part = lacks.clamp(-stored * (1.0 - 1.0 / ratio), stored * (ratio - 1.0));
        match step > 1 && (lacks - part).abs() > work.coarse {
            true => part,
            false => lacks,
        }
    }
}
