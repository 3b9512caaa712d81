//! How much larger the largest forces of a contact may have been between the steps.
//!
//! Of a force that goes up and down again steps show the top where they happen to lie. Where it is smooth it stands above its
//! chord over a step of length h by up to `|f''| h^2 / 8`, with the bend `f''` as it is both at the largest force and at the nearer
//! of the forces beside it: a force that rises and stays has none there. Where it rises and drops, as friction does that gives
//! way, it may have gone on as it rose; a quarter of that is counted, which is the same for a parabola with its top at a step.
//!
//! Where a tool turns, friction turns round within a small part of the next step, and falls from there on as the tool goes back: the
//! top lies near the turn, where the line through the forces after it leads to.
use crate::run::checkpoint::bytes::{Malformed, Reader, Writer};
use covact_geometry::Vec3;

/// Part of a force from which on it is told.
const TOLD: f64 = 0.02;

/// A time and the force then.
type At = [f64; 2];

/// The largest force so far.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(super) struct Crest {
    /// Its end and its force.
    top: At,
    pub step: u32,
    /// What is prescribed had a kink there, so that the force may have another slope from there on.
    kink: bool,
    /// The same at the step before it.
    from_kink: bool,
    /// The two steps before it, and what is known of those after it.
    before: [At; 2],
    after: [Option<At>; 2],
    /// The last two steps, and whether the last one ended with a kink.
    last: [At; 2],
    last_kink: bool,
}

impl Crest {
    /// Takes the force of an accepted step, whose end is a `kink` of what is prescribed or not.
    pub fn step(&mut self, step: u32, time: f64, force: f64, kink: bool) {
        let now = [time, force];
        if force >= self.force() {
            *self = Crest {
                top: now,
                step,
                kink,
                from_kink: self.last_kink,
                before: self.last,
                after: [None; 2],
                ..*self
            };
        } else if let Some(free) = self.after.iter_mut().find(|a| a.is_none()) {
            *free = Some(now);
        }
        self.last = [self.last[1], now];
        self.last_kink = kink;
    }

    /// The largest force.
    pub fn force(&self) -> f64 {
        self.top[1]
    }

    pub fn time(&self) -> f64 {
        self.top[0]
    }

    /// What part of the largest force is missing, where it is to be told.
    pub fn missing(&self) -> Option<f64> {
        let [Some(next), beyond] = self.after else {
            return None;
        };
        if self.kink {
            return None;
        }
        let slope = |[a, f]: At, [b, g]: At| (g - f) / (b - a);
        // How much it bends down.
        let bend =
            |a: At, b: At, c: At| (2.0 * (slope(a, b) - slope(b, c)) / (c[0] - a[0])).max(0.0);
        let ([first, second], top) = (self.before, self.top);
        let (rise, fall) = (top[1] - second[1], top[1] - next[1]);
        let beside = match (rise < fall, beyond) {
            (true, _) if second[0] > first[0] => bend(first, second, top),
            (false, Some(beyond)) => bend(top, next, beyond),
            _ => 0.0,
        };
        let longest = (next[0] - top[0]).max(top[0] - second[0]);
        let smooth = bend(second, top, next).min(beside) * longest * longest / 8.0;
        // A force that rises past the turn of a tool and falls evenly from then on.
        let turned = match (self.from_kink, beyond) {
            (true, Some(beyond)) if rise > fall => {
                let falls = -slope(top, next);
                let straight = bend(top, next, beyond) * longest < falls.max(0.0);
                if straight {
                    falls * (top[0] - second[0])
                } else {
                    0.0
                }
            }
            _ => 0.0,
        };
        let part = smooth.max(0.25 * rise.min(fall)).max(turned) / top[1];
        (part > TOLD).then_some(part)
    }

    /// Into a checkpoint.
    pub fn put(&self, out: &mut Writer) {
        let Crest {
            top,
            step,
            kink,
            from_kink,
            before,
            after,
            last,
            last_kink,
        } = self;
        for at in [*top].iter().chain(before).chain(last) {
            out.f64s(at);
        }
        out.u32(*step);
        for kink in [kink, from_kink, last_kink] {
            out.bool(*kink);
        }
        for at in after {
            out.bool(at.is_some());
            out.f64s(&at.unwrap_or_default());
        }
    }

    /// [`Self::put`], read back.
    pub fn take(from: &mut Reader) -> Result<Self, Malformed> {
        let mut crest = Crest::default();
        let [before, last] = [&mut crest.before, &mut crest.last];
        for at in [&mut crest.top].into_iter().chain(before).chain(last) {
            from.f64s(at)?;
        }
        crest.step = from.u32()?;
        let Crest {
            kink,
            from_kink,
            last_kink,
            ..
        } = &mut crest;
        for kink in [kink, from_kink, last_kink] {
            *kink = from.bool()?;
        }
        for at in &mut crest.after {
            let (known, mut value) = (from.bool()?, At::default());
            from.f64s(&mut value)?;
            *at = known.then_some(value);
        }
        Ok(crest)
    }
}

/// What the largest of a contact's forces are called: the sum of its normal forces, and the parts along the axes of the sum of all
/// of them, both ways.
const NAMES: [&str; 7] = [
    "force",
    "force along +x",
    "force along -x",
    "force along +y",
    "force along -y",
    "force along +z",
    "force along -z",
];

/// The largest of a contact's forces so far, in the order of [`NAMES`].
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(super) struct Crests([Crest; 7]);

impl Crests {
    /// Takes the `normal` forces of an accepted step as one sum, and the force on the slave, as [`Crest::step`].
    pub fn step(&mut self, step: u32, time: f64, (normal, force): (f64, Vec3), kink: bool) {
        let [x, y, z] = force.into();
        let forces = [normal, x, -x, y, -y, z, -z];
        for (crest, force) in self.0.iter_mut().zip(forces) {
            crest.step(step, time, force, kink);
        }
    }

    /// The largest sum of normal forces.
    pub fn force(&self) -> f64 {
        self.0[0].force()
    }

    /// The one that steps show least of, of those above `large`: what it is called, and what part of it is missing.
    pub fn worst(&self, large: f64) -> Option<(&'static str, Crest, f64)> {
        let crests = NAMES.iter().zip(&self.0);
        let large = crests.filter(|(_, crest)| crest.force() > large);
        large
            .filter_map(|(name, crest)| Some((*name, *crest, crest.missing()?)))
            .max_by(|a, b| a.2.total_cmp(&b.2))
    }

    /// Into a checkpoint.
    pub fn put(&self, out: &mut Writer) {
        for crest in &self.0 {
            crest.put(out);
        }
    }

    /// [`Self::put`], read back.
    pub fn take(from: &mut Reader) -> Result<Self, Malformed> {
        let mut crests = Crests::default();
        for crest in &mut crests.0 {
            *crest = Crest::take(from)?;
        }
        Ok(crests)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Forces at times 1, 2, 3, ...
    fn crest(forces: &[f64]) -> Crest {
        let mut crest = Crest::default();
        for (i, force) in forces.iter().enumerate() {
            crest.step(i as u32 + 1, (i + 1) as f64, *force, false);
        }
        crest
    }

    /// A sine whose top is 5 % above the steps beside it, one whose top is at a step, and one in small steps.
    #[test]
    fn a_smooth_top() {
        let sine = |from: f64, h: f64| {
            let force = |i| (std::f64::consts::PI * (from + h * f64::from(i))).sin();
            crest(&(0..7).map(force).collect::<Vec<_>>())
        };
        let between = sine(0.0, 0.2);
        assert!([3, 4].contains(&between.step));
        let above = between.missing().unwrap() * between.force();
        let exact = 1.0 - between.force();
        assert!((0.6..1.3).contains(&(above / exact)), "{above} {exact}");
        assert!(sine(0.0, 0.25).missing().unwrap() < 0.08);
        assert_eq!(sine(0.3, 0.05).missing(), None);
    }

    /// Forces that end at their largest, that stay there (from the step on or from one before), and that drop.
    #[test]
    fn other_tops() {
        assert_eq!(crest(&[1.0, 2.0, 3.0]).missing(), None);
        assert_eq!(crest(&[1.0, 2.0, 3.0, 2.99, 2.98, 2.97]).missing(), None);
        assert_eq!(crest(&[1.0, 3.0, 3.0, 3.0, 0.1, 0.1]).missing(), None);
        let drops = crest(&[1.0, 2.0, 3.0, 0.0, 0.1]).missing().unwrap();
        assert!((drops - 0.25 / 3.0).abs() < 1e-12, "{drops}");
        let mut turns = crest(&[1.0, 2.0]);
        turns.step(3, 3.0, 3.0, true);
        turns.step(4, 4.0, 2.0, false);
        assert_eq!(
            (turns.force(), turns.time(), turns.missing()),
            (3.0, 3.0, None)
        );
    }

    /// Friction that turns round after the third step, at which the tool does: from 109.9 there (air bending, force along the die).
    #[test]
    fn a_top_past_a_turn() {
        let turned = |kink: bool| {
            let mut crest = crest(&[52.6]);
            crest.step(2, 2.0, 66.5, kink);
            let after = [(3.0, 93.55), (3.692, 82.2), (4.384, 71.64)];
            for (i, (time, force)) in after.into_iter().enumerate() {
                crest.step(i as u32 + 3, time, force, false);
            }
            crest.missing()
        };
        let part = turned(true).unwrap();
        assert!((93.55 * (1.0 + part) - 109.9).abs() < 0.2, "{part}");
        assert!(turned(false).is_none_or(|part| part < 0.04));
    }

    /// A pin that is pushed in under a spring: what holds it back along its way has its top long before the spring's force.
    #[test]
    fn a_force_along_an_axis_has_a_top_of_its_own() {
        let mut crests = Crests::default();
        for (i, back) in [0.0, 2.0, 4.0, 1.0, 1.0, 1.0].into_iter().enumerate() {
            let normal = 5.0 + i as f64;
            let force = Vec3::new(-back, 0.0, normal);
            crests.step(i as u32 + 1, (i + 1) as f64, (normal, force), false);
        }
        let (name, crest, part) = crests.worst(1.0).unwrap();
        assert_eq!(
            (name, crest.step, crest.force()),
            ("force along -x", 3, 4.0)
        );
        assert!((part - 0.125).abs() < 1e-12, "{part}");
        assert_eq!(crests.worst(4.5), None);
    }
}
