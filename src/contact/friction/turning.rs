//! Points whose sliding turns round from one linearisation to the next.
use super::law::Slip;
use covact_geometry::Vec3;

/// How a point slid at the last linearisations of a solution.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Turning {
    /// Traction at the last one (force / length^2); zero where there was none.
    last: Vec3,
    /// A bit for each of the last ones, the lowest for the last of them: whether the point turned there.
    turns: u8,
}

/// The linearisations that count: points that go round come back after at most four.
const LATELY: u8 = 0b1111;

impl Turning {
    /// The traction that a point that slides the other way has turned from.
    pub fn last(&self) -> &Vec3 {
        &self.last
    }

    /// Whether it has turned more than once in the last linearisations: it goes to and fro.
    pub fn oscillates(&self) -> bool {
        (self.turns & LATELY).count_ones() > 1
    }

    /// Takes what a linearisation found; none where the point is open.
    pub fn note(&mut self, slip: Option<&Slip<f64>>) {
        self.take(slip.map(|slip| (&slip.t, slip.slides)));
    }

    /// [`Self::note`] of a traction (force / length^2), and whether the point slides under it.
    pub fn take(&mut self, found: Option<(&Vec3, bool)>) {
        let Some((t, slides)) = found else {
            *self = Turning::default();
            return;
        };
        let turned = slides && t.dot(&self.last) < 0.0;
        self.turns = self.turns << 1 | u8::from(turned);
        self.last = *t;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::contact::friction::law::{Coulomb, FrictionLaw};

    /// Whether a point whose trial tractions along x are these in succession, zero where it is open, goes to and fro.
    fn oscillates(trials: &[f64]) -> bool {
        let mut turning = Turning::default();
        for x in trials {
            let slip = Coulomb { mu: 0.5 }.slip(&(Vec3::x() * *x), &Vec3::z(), 1.0);
            turning.note(Some(&slip).filter(|_| *x != 0.0));
        }
        turning.oscillates()
    }

    #[test]
    fn points_that_turn_and_turn_back_oscillate() {
        assert!(oscillates(&[1.0, -1.0, 1.0]));
        assert!(oscillates(&[1.0, -1.0, -1.0, 1.0]));
        assert!(oscillates(&[0.1, -1.0, 1.0, 1.0, 0.1]));
        // Once, long ago, or only up to where it sticks.
        assert!(!oscillates(&[1.0, -1.0, -1.0]));
        assert!(!oscillates(&[1.0, -1.0, 1.0, 1.0, 1.0, 1.0]));
        assert!(!oscillates(&[1.0, -0.1, 0.1, -0.1]));
    }

    #[test]
    fn an_open_point_has_nothing_to_turn_from() {
        assert!(!oscillates(&[1.0, -1.0, 1.0, 0.0]));
        assert!(!oscillates(&[1.0, 0.0, -1.0, 1.0]));
    }
}
