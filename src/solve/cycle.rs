//! Contact points that switch their status round and round: Newton's method goes through the same sets of closed points
//! again and again, because each set's own equilibrium asks for the next one.
use super::event::Event;
use crate::model::Model;
use crate::model::state::{PointState, State};
use covact_geometry::Vec3;
use std::fmt;
use std::hash::{DefaultHasher, Hash, Hasher};

/// Longest period that is looked for.
const LONGEST: usize = 4;
/// Times that a set has to have come back.
const TIMES: usize = 2;

/// Which points were closed at the last iterates.
#[derive(Debug, Clone, Default)]
pub(super) struct Cycle {
    sets: Vec<u64>,
}

impl Cycle {
    /// Forgets what was.
    pub fn clear(&mut self) {
        self.sets.clear();
    }

    /// Takes an iterate at which points switched; the number of iterations after which the sets come back, where they have
    /// done so twice.
    pub fn add(&mut self, points: &[PointState], nodes: &[bool]) -> Option<usize> {
        let mut hasher = DefaultHasher::new();
        points.iter().for_each(|p| p.closed.hash(&mut hasher));
        nodes.hash(&mut hasher);
        self.sets.push(hasher.finish());
        let sets = &self.sets;
        (2..=LONGEST).find(|&period| {
            let Some(first) = sets.len().checked_sub(period * TIMES + 1) else {
                return false;
            };
            let again = (first..sets.len() - period).all(|k| sets[k] == sets[k + period]);
            again && sets[first] != sets[first + 1]
        })
    }
}

/// Contact points that switch round and round.
#[derive(Debug, Clone, PartialEq)]
pub struct PingPong {
    /// The contact with most of them.
    pub contact: String,
    /// Their number there.
    pub points: usize,
    /// Iterations after which all is as it was.
    pub period: usize,
    /// Where one of them is.
    pub at: [f64; 3],
}

impl PingPong {
    /// Those that switched from `before` to `state`, the points of two iterates in succession.
    pub(super) fn find(
        model: &Model,
        before: &[PointState],
        state: &State,
        period: usize,
    ) -> Option<Self> {
        let mut first = 0;
        let mut most: Option<PingPong> = None;
        for (index, pair) in model.pairs.iter().enumerate() {
            let slaves = state.slaves(model, index);
            let range = first..first + slaves.len();
            first = range.end;
            let both = before[range.clone()].iter().zip(&state.points[range]);
            let mut switched = (both.zip(slaves)).filter(|((a, b), _)| a.closed != b.closed);
            let Some((_, point)) = switched.next() else {
                continue;
            };
            let points = 1 + switched.count();
            if most.as_ref().is_none_or(|m| points > m.points) {
                let x: Vec3 = model.point_position(point, &state.u);
                most = Some(PingPong {
                    contact: pair.name.clone(),
                    points,
                    period,
                    at: x.into(),
                });
            }
        }
        most
    }
}

impl PingPong {
    /// What is told of it; `held` says how the cycle is broken.
    pub(super) fn event(&self, step: u32, iteration: u32, held: bool) -> Event {
        let broken = match held {
            true => "the next linearisation keeps them in contact",
            false => "the next iterations go half of the way",
        };
        Event::PingPong {
            step,
            iteration,
            contact: self.contact.clone(),
            points: self.points,
            period: self.period,
            at: self.at,
            broken: broken.to_owned(),
        }
    }
}

impl fmt::Display for PingPong {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [x, y, z] = self.at;
        write!(
            f,
            "; {} point(s) of contact `{}`, one of them near ({x:.6e}, {y:.6e}, {z:.6e}), switch between open and closed, every \
             {} iterations the same: take a smaller penalty, `augmentation` with it, or smaller steps",
            self.points, self.contact, self.period
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Runs sets of two points through the watch; where a cycle is first seen, and its period.
    fn seen(sets: &[[bool; 2]]) -> Option<(usize, usize)> {
        let mut cycle = Cycle::default();
        sets.iter().enumerate().find_map(|(k, set)| {
            let points = set.map(|closed| PointState { hint: None, closed });
            cycle.add(&points, &[]).map(|period| (k, period))
        })
    }

    #[test]
    fn sets_that_come_back_twice_are_a_cycle() {
        let [a, b, c] = [[true, false], [false, true], [true, true]];
        assert_eq!(seen(&[c, a, b, a, b, a]), Some((5, 2)));
        assert_eq!(seen(&[a, b, c, a, b, c, a]), Some((6, 3)));
        assert_eq!(seen(&[a, b, a, c, a, b, c, c]), None);
        assert_eq!(seen(&[a; 8]), None);
    }
}
