//! Step sizes: adapted to the iterations they take, cut on failure, ending on every kink of what is prescribed.
use crate::scene;

/// Chooses the steps of a run.
#[derive(Debug, Clone)]
pub struct Stepping {
    settings: scene::Step,
    end: f64,
    /// Kinks of what is prescribed.
    kinks: Vec<f64>,
    /// Kinks and times asked for, ascending.
    stops: Vec<f64>,
    /// Spans in which no step is larger than a size, and these sizes.
    bounds: Vec<([f64; 2], f64)>,
    dt: f64,
}

/// Iterations above which the next step is smaller, and below which it is larger. A thin shell takes six or seven at any
/// size, so that fewer would freeze its steps.
const MANY: u32 = 16;
const FEW: u32 = 10;
/// By how much.
const LARGER: f64 = 1.6;
const SMALLER: f64 = 0.7;
/// Equivalent plastic strain that a step may bring: stresses follow the flow of one step along one direction.
const FLOW: f64 = 0.02;
/// Part of its work that a step may leave out because flow turns within it.
const LAG: f64 = 0.08;
/// Part of friction that may act aside of where it should: a step turns its direction by 6 degrees.
const ASIDE: f64 = 0.05;
/// Part of the largest step from which on a step counts as large.
const LARGE: f64 = 1.0 / 8.0;
/// Least part that is left of a step that is cut.
const MOST_CUT: f64 = 1.0 / 64.0;

impl Stepping {
    /// Steps from 0 to `end` that end on every kink and on every time of `stops`, and are no larger than those of `bounds` within
    /// their spans.
    pub fn new(
        settings: scene::Step,
        end: f64,
        kinks: &[f64],
        stops: &[f64],
        bounds: Vec<([f64; 2], f64)>,
    ) -> Self {
        let mut all: Vec<f64> = kinks.iter().chain(stops).copied().collect();
        all.sort_by(f64::total_cmp);
        Stepping {
            settings,
            end,
            kinks: kinks.to_vec(),
            stops: all,
            bounds,
            dt: settings.initial.min(settings.max),
        }
    }

    /// Size of the first step.
    pub fn initial(&self) -> f64 {
        self.settings.initial
    }

    /// End of the step that starts at `time`: what is left up to the next stop is divided into equal steps no larger
    /// than the present size, so that no sliver remains.
    pub fn next(&self, time: f64) -> f64 {
        let tiny = 1e-9 * self.end;
        let target = (self.stops.iter().copied())
            .find(|b| *b > time + tiny)
            .unwrap_or(self.end)
            .min(self.end);
        let left = target - time;
        let bounds = self.bounds.iter();
        let dt = bounds
            .filter(|([from, to], _)| *from <= time + tiny && time < to - tiny)
            .fold(self.dt, |dt, (_, size)| dt.min(*size));
        let count = (left / dt - 1e-6).ceil().max(1.0);
        if count <= 1.0 {
            target
        } else {
            time + left / count
        }
    }

    /// Whether a step is not yet small beside the largest one that may be taken; those of a scene that fixes them are as they are to be.
    pub fn large(&self, dt: f64) -> bool {
        self.settings.adaptive && dt > LARGE * self.settings.max
    }

    /// Whether what is prescribed has a kink at `time`: the path so far says nothing about what follows.
    pub fn at_kink(&self, time: f64) -> bool {
        self.kinks
            .iter()
            .any(|b| (b - time).abs() <= 1e-9 * self.end)
    }

    /// The present size, for a run that is continued: all else is given by the scene.
    pub fn size(&self) -> f64 {
        let Stepping {
            settings: _,
            end: _,
            kinks: _,
            stops: _,
            bounds: _,
            dt,
        } = self;
        *dt
    }

    /// Goes on with a size.
    pub fn set_size(&mut self, dt: f64) {
        self.dt = dt;
    }

    /// Whether the end is reached.
    pub fn done(&self, time: f64) -> bool {
        time >= self.end * (1.0 - 1e-12)
    }

    /// A step was accepted after `iterations`.
    pub fn accepted(&mut self, iterations: u32) {
        if !self.settings.adaptive {
            self.dt = self.settings.initial.min(self.settings.max);
        } else if iterations < FEW {
            self.dt = (LARGER * self.dt).min(self.settings.max);
        } else if iterations > MANY {
            self.dt = (SMALLER * self.dt).max(self.settings.min);
        }
    }

    /// A step of size `dt` was accepted after `iterations`, by whose error the next one may be `factor` times as large.
    pub fn paced(&mut self, dt: f64, factor: f64, iterations: u32) {
        if !self.settings.adaptive {
            return self.accepted(iterations);
        }
        let factor = if iterations > MANY {
            factor.min(SMALLER)
        } else {
            factor
        };
        self.dt = (factor * dt).max(self.settings.min).min(self.settings.max);
    }

    /// An accepted step of size `dt` brought a plastic strain of at most `flow` and left out a part `lag` of its work: the next one
    /// is no larger than what brings [`FLOW`] and [`LAG`].
    pub fn flowed(&mut self, dt: f64, flow: f64, lag: f64) {
        let times = (flow / FLOW).max(lag / LAG);
        if self.settings.adaptive && times > 0.0 {
            let most = (dt / times).max(self.settings.min);
            self.dt = self.dt.min(most);
        }
    }

    /// A part `aside` of friction acted aside in an accepted step of size `dt`, because its direction turned: the next one is no larger
    /// than what leaves [`ASIDE`].
    pub fn headed(&mut self, dt: f64, aside: f64) {
        if self.settings.adaptive && aside > 0.0 {
            let most = (dt * ASIDE / aside).max(self.settings.min);
            self.dt = self.dt.min(most);
        }
    }

    /// Whether a step of this size would not be cut.
    pub fn smallest(&self, dt: f64) -> bool {
        0.5 * dt < self.settings.min
    }

    /// A step of size `dt` failed, of which a `part` may do: the size to try next, at most half, or `None` where it would be below
    /// the smallest.
    pub fn failed(&mut self, dt: f64, part: f64) -> Option<f64> {
        if self.smallest(dt) {
            return None;
        }
        self.dt = (part.clamp(MOST_CUT, 0.5) * dt).max(self.settings.min);
        Some(self.dt)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn stepping(stops: &[f64]) -> Stepping {
        let settings = scene::Step {
            initial: 0.3,
            min: 0.01,
            max: 0.3,
            adaptive: true,
        };
        Stepping::new(settings, 1.0, &[], stops, Vec::new())
    }

    #[test]
    fn steps_end_on_stops_and_leave_no_slivers() {
        let s = stepping(&[0.5]);
        let mut times = vec![0.0];
        while !s.done(*times.last().unwrap()) {
            times.push(s.next(*times.last().unwrap()));
            assert!(times.len() < 20);
        }
        assert_eq!(times, [0.0, 0.25, 0.5, 0.75, 1.0]);
    }

    #[test]
    fn a_span_has_its_own_largest_step() {
        let mut s = stepping(&[0.5]);
        s.bounds = vec![([0.5, 1.0], 0.1)];
        let mut times = vec![0.0];
        while !s.done(*times.last().unwrap()) {
            times.push(s.next(*times.last().unwrap()));
            assert!(times.len() < 20);
        }
        assert_eq!(times.len(), 8);
        assert!((times[3] - 0.6).abs() < 1e-12, "{times:?}");
    }

    #[test]
    fn cuts_stop_at_the_smallest_step() {
        let mut s = stepping(&[]);
        let mut dt = 0.3;
        let mut cuts = 0;
        while let Some(next) = s.failed(dt, 0.5) {
            assert_eq!(next, 0.5 * dt);
            dt = next;
            cuts += 1;
        }
        assert_eq!(cuts, 4);
        // A step that bent far too much is cut at once, though never below the smallest.
        let mut s = stepping(&[]);
        assert_eq!(s.failed(0.3, 0.1), Some(0.03));
        assert_eq!(s.failed(0.3, 1e-9), Some(0.01));
        assert_eq!(s.failed(0.01, 0.1), None);
    }
}
