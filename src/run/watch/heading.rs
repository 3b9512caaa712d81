//! How far the direction of friction turns within steps.
//!
//! Slip is the chord of the path over a step, so that friction acts along the chord where it should along the end of the path: behind
//! by half of what the path turns within the step. A tool that moves in a circle is resisted aside by as much, with the right
//! size. What points turn by that go round an axis under them cancels out in their sum.
use super::Watch;
use crate::model::error::number;
use crate::model::master::{MasterNow, Masters};
use crate::model::state::State;
use crate::model::{Model, histories};
use crate::run::checkpoint::bytes::{Malformed, Reader, Writer};
use crate::scene::ValueError;
use covact_geometry::Vec3;
use nalgebra::UnitQuaternion;
use std::ops::Range;

/// Part of the largest friction of a contact that may act aside before the user is told.
const TOLD: f64 = 0.03;

/// What acts aside because the direction of friction turns within steps.
#[derive(Debug, Clone, Default, PartialEq)]
pub(super) struct Heading {
    /// How long the last step was; zero before the first.
    size: f64,
    /// Per pair; empty before the first step.
    pairs: Vec<Pair>,
}

/// Of one contact.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
struct Pair {
    /// Largest friction so far, the sum of its sizes at all points (force).
    friction: f64,
    /// What acted aside in the last step, the most in two steps in succession (force), and when.
    last: Vec3,
    worst: f64,
    time: f64,
}

impl Heading {
    pub fn put(&self, out: &mut Writer) {
        let Heading { size, pairs } = self;
        out.f64s(&[*size]);
        out.count(pairs.len());
        for pair in pairs {
            out.f64s(&[pair.friction, pair.worst, pair.time]);
            out.f64s(pair.last.as_slice());
        }
    }

    pub fn take(model: &Model, from: &mut Reader) -> Result<Self, Malformed> {
        let mut size = [0.0];
        from.f64s(&mut size)?;
        let count = from.count(48)?;
        if count > model.pairs.len() {
            return Err(from.malformed("directions of friction of more contacts than there are"));
        }
        let mut pair = || {
            let mut numbers = [0.0; 3];
            from.f64s(&mut numbers)?;
            let [friction, worst, time] = numbers;
            let mut last = Vec3::zeros();
            from.f64s(last.as_mut_slice())?;
            Ok(Pair {
                friction,
                last,
                worst,
                time,
            })
        };
        Ok(Heading {
            size: size[0],
            pairs: (0..count).map(|_| pair()).collect::<Result<_, _>>()?,
        })
    }
}

impl Watch {
    /// Takes how friction turned in an accepted step from one state and time to the next; returns the largest part of the friction of
    /// a contact that acts aside by it, in this step and in the one before: a path that has a corner turns once. Where what is
    /// prescribed has a kink at the start (`turns`), friction may turn at once.
    ///
    /// # Errors
    /// A motion of a surface without a value at one of the times.
    pub fn headed(
        &mut self,
        (model, masters): (&Model, &mut Masters),
        (from, start): (&State, f64),
        (to, end): (&State, f64),
        turns: bool,
    ) -> Result<f64, ValueError> {
        let heading = &mut self.heading;
        let size = end - start;
        // Directions are those of chords, between whose middles lies half of either step.
        let own = match heading.size > 0.0 {
            true => 2.0 * size / (heading.size + size),
            false => 1.0,
        };
        heading.size = size;
        heading.pairs.resize(model.pairs.len(), Pair::default());
        masters.update(model, &to.u);
        let (mut first, mut most) = (0, 0.0);
        for (index, pair) in heading.pairs.iter_mut().enumerate() {
            let points = first..first + to.slaves(model, index).len();
            first = points.end;
            if model.pairs[index].friction.is_none() {
                continue;
            }
            let master = masters.at(model, index, &to.u, end)?;
            let span = ((from, start), (to, end));
            let (friction, aside) =
                turned(model, (index, points), &master, span).unwrap_or_default();
            let aside = if turns { Vec3::zeros() } else { aside * own };
            pair.friction = pair.friction.max(friction);
            // What goes to and fro does not lag.
            let [now, before] = [aside, pair.last].map(|f| f.norm());
            let both = aside.dot(&pair.last) / now.max(before).max(f64::MIN_POSITIVE);
            pair.last = aside;
            if both > pair.worst {
                (pair.worst, pair.time) = (both, end);
            }
            if both > 0.0 {
                most = f64::max(most, both / pair.friction);
            }
        }
        Ok(most)
    }

    /// What is said at the end of a run in whose steps friction turned too far.
    pub fn turned(&self, model: &Model) -> Option<String> {
        let pairs = model.pairs.iter().zip(&self.heading.pairs);
        let parts = pairs.filter(|(_, own)| own.worst > 0.0);
        let parts = parts.map(|(pair, own)| (own.worst / own.friction, pair, own.time));
        let (part, pair, time) = parts.max_by(|a, b| a.0.total_cmp(&b.0))?;
        (part > TOLD).then(|| {
            format!(
                "contact `{}`: the direction of sliding turns within the steps, behind which friction lags: up to {:.0} % of it acts aside \
                 (time {}). Take a smaller `solution.step.max`",
                pair.name,
                100.0 * part,
                number(time)
            )
        })
    }
}

/// The friction of a pair, with these points in the state, at the end of a step, and what of it acts aside (force): of the points that
/// slid at both of its ends. Nothing where their histories are not the same ones.
fn turned(
    model: &Model,
    (pair, points): (usize, Range<usize>),
    master: &MasterNow,
    ((from, start), (to, end)): ((&State, f64), (&State, f64)),
) -> Option<(f64, Vec3)> {
    let own = &model.pairs[pair];
    let ranges = [from, to].map(|state| histories::range(&state.cuts, model, pair));
    let [Some(before), Some(now)] = ranges else {
        return None;
    };
    // Segments are cut anew, and a node with an averaged gap has no history.
    if own.segments().is_some() || before.len() != now.len() || now.len() != points.len() {
        return None;
    }
    // A tool that turns has the path on it.
    let turn = |time: f64, u: &[f64]| match own.rigid_master() {
        Some(index) => Some((model.surfaces[index].at(time, u).ok()?).pose.rotation),
        None => Some(UnitQuaternion::identity()),
    };
    let turned = turn(end, &to.u)? * turn(start, &from.u)?.inverse();
    let both = from.histories[before].iter().zip(&to.histories[now]);
    let slaves = to.slaves(model, pair).iter().zip(&to.points[points]);
    let mut sum = 0.0;
    let mut lateral = Vec3::zeros();
    for (i, ((before, now), (p, state))) in both.zip(slaves).enumerate() {
        if !(before.slides() && now.slides()) {
            continue;
        }
        let x = model.point_position(p, &to.u);
        let Some(seen) = master.see(i, &x, state.hint) else {
            continue;
        };
        sum += p.area * now.t.norm();
        // What the tangent plane tilts by is none of it.
        let across = seen.normal.cross(&(turned * before.t));
        if let Some(across) = across.try_normalize(0.0) {
            lateral += across * (0.5 * p.area * now.t.dot(&across));
        }
    }
    Some((sum, lateral))
}
