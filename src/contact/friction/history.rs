//! What a slave point remembers between steps.
use super::trial::Traction;
use crate::contact::law::{Augmented, NormalLaw};
use covact_geometry::{Hint, Vec3};
use nalgebra::UnitQuaternion;

/// Whether a point touches, and whether it slides there.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum PointStatus {
    /// Not in contact.
    #[default]
    Open,
    /// In contact without sliding (or without friction).
    Stick,
    /// In contact, and friction is at its limit.
    Slip,
}

/// History of a slave point. It changes when a step is accepted, and with the multipliers of an augmentation.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct PointHistory {
    /// On a master that deforms: the facet and its parameters that `base` and `lambda` are attached to. Nothing on a rigid
    /// one.
    pub place: Option<Hint>,
    /// Attraction point that slip is measured from: in the own coordinates of a rigid surface; on a facet the components,
    /// along `rho_1`, `rho_2` and `n` at `place`, of its distance from the facet (length).
    pub base: Vec3,
    /// Tangential traction when the base was set, or its multiplier, in the coordinates of `base` (force / length^2). What
    /// of it lies along a normal that has turned since counts for nothing.
    pub lambda: Vec3,
    /// Multiplier of the normal traction, `<= 0` (force / length^2).
    pub lambda_n: f64,
    /// Gap at the last accepted step where the point was open (length, infinite where no foot was found), else zero.
    pub approach: f64,
    /// Of a point that is open: its way relative to the master in the last accepted step, at both ends of which it was open, in the
    /// coordinates of `base` (length). Zero where that is not known.
    pub way: Vec3,
    /// Within a step, of an open point that is expected to touch: its way from `base` to where it does. It is tied to where it is held
    /// first, by the full penalty, and the way before is none of friction's. Else zero.
    pub ahead: Vec3,
    /// Status at the last accepted step.
    pub status: PointStatus,
    /// Normal traction at the last accepted step, `<= 0` (force / length^2).
    pub n: f64,
    /// Tangential traction at the last accepted step, in space; the master pulls the slave by its negative.
    pub t: Vec3,
    /// Length of the path slid so far.
    pub slip: f64,
    /// Energy dissipated so far (force / length).
    pub dissipated: f64,
    /// What a trapezoid between the tractions at both ends of the last step leaves of what that step dissipated (force / length):
    /// a traction that turns, or rises to its limit before the point slides, works at its limit all the way.
    pub sudden: f64,
}

/// What turns the coordinates of the base into those of space, at the start of a step and at its end.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Turn {
    /// Rotation at the start of the step.
    pub start: UnitQuaternion<f64>,
    /// Rotation at its end.
    pub end: UnitQuaternion<f64>,
}

impl Turn {
    /// They are those of space.
    pub fn none() -> Self {
        Turn {
            start: UnitQuaternion::identity(),
            end: UnitQuaternion::identity(),
        }
    }
}

impl PointHistory {
    /// Whether the point slid at the last accepted step.
    pub fn slides(&self) -> bool {
        self.status == PointStatus::Slip
    }

    /// Law of the normal traction of the point under the law of its pair, its gap measured from `z0` (length).
    #[inline]
    pub fn law<L>(&self, law: L, z0: f64) -> Augmented<L> {
        Augmented {
            law,
            z0,
            lambda_n: self.lambda_n,
            held: false,
        }
    }

    /// Where the point is tied to, in the coordinates of the base.
    #[inline]
    pub fn tied_to(&self) -> Vec3 {
        self.base + self.ahead
    }

    /// The gap that a point touches from evenly within the step; zero where it is tied to where it touches, or touched before.
    #[inline]
    pub fn closes_from(&self) -> f64 {
        match self.ahead == Vec3::zeros() {
            true => self.approach,
            false => 0.0,
        }
    }

    /// Takes over the end of an accepted step in which the point is in contact: at `local` and under `traction`, both in the
    /// coordinates of the base, which `to_space` turns into those of space; `first` is the traction that the law allowed at
    /// the start of the step, `n` the normal traction now and `eps_t` the tangential penalty. The point is tied to where it is
    /// now: with the traction it has where it slides or has come into contact, with what it was tied by where it sticks.
    pub fn accept(
        &mut self,
        local: &Vec3,
        traction: &Traction,
        first: &Vec3,
        n: f64,
        eps_t: f64,
        to_space: &Turn,
    ) {
        let (t, slides) = (traction.slip.t, traction.slip.slides);
        self.sudden = 0.0;
        if slides {
            // The mean of the tractions at both ends of the step; of a point that stuck at its start, or slid the other way, or
            // did not touch, the traction at the start is the limit there. Either is of second order in the step, and neither
            // gives energy back.
            let slid = self.slid(local, traction, eps_t);
            let before = to_space.start.inverse_transform_vector(&self.t);
            let went_on = self.status == PointStatus::Slip && before.dot(&slid) > 0.0;
            let first = if went_on { &before } else { first };
            self.dissipated += 0.5 * (first + t).dot(&slid);
            self.sudden = 0.5 * (first - before).dot(&slid);
            self.slip += slid.norm();
        }
        // Where it sticks nothing changes by this, but that a later penalty works on later displacements only.
        self.lambda = match slides || self.approach > 0.0 {
            true => t,
            false => self.attraction(eps_t).unprojected(local),
        };
        self.base = *local;
        self.approach = 0.0;
        (self.way, self.ahead) = (Vec3::zeros(), Vec3::zeros());
        self.status = match slides {
            true => PointStatus::Slip,
            false => PointStatus::Stick,
        };
        self.n = n;
        self.t = to_space.end * t;
    }

    /// [`Self::accept`] with augmentation: both tractions become multipliers. A point that sticks stays tied to where it was,
    /// so that what elastic slip is left of every step does not add up.
    pub fn accept_augmented(
        &mut self,
        local: &Vec3,
        traction: &Traction,
        first: &Vec3,
        n: f64,
        eps_t: f64,
        to_space: &Turn,
    ) {
        let (base, tied) = (self.base, self.approach == 0.0);
        self.accept(local, traction, first, n, eps_t, to_space);
        self.lambda_n = n;
        if tied && self.status == PointStatus::Stick {
            (self.base, self.lambda) = (base, traction.slip.t);
        }
    }

    /// Takes over the end of an accepted step in which a point is open, or has opened, at `local` in the coordinates
    /// of the base. `foot` is its gap (length) and the unit normal at its foot, nothing where there is none. What has opened slides,
    /// and its traction falls to nothing, in the part of the step before it opens: the normal traction is taken to pass evenly to
    /// what the law of the pair would make of the gap, or later where it goes along the surface.
    pub fn leave(
        &mut self,
        local: &Vec3,
        foot: Option<(f64, Vec3)>,
        law: &impl NormalLaw,
        eps_t: f64,
        to_space: &Turn,
    ) {
        let mut way = Vec3::zeros();
        if self.status == PointStatus::Open {
            if self.approach.is_finite() && foot.is_some() {
                way = local - self.base;
            }
        } else {
            let before = to_space.start.inverse_transform_vector(&self.t);
            // Without a foot the point has gone at once.
            let mut trial = before;
            if let Some((gap, normal)) = foot {
                let beyond = self.lambda_n + law.response(gap).n;
                if beyond > self.n {
                    let v = self.attraction(eps_t).unprojected(local);
                    // Going away from the surface is no slip.
                    let more = v - normal * normal.dot(&v) - before;
                    let part = self.n / (self.n - beyond);
                    trial += more * part.max(grazing(more.norm() / eps_t, gap));
                }
            }
            let slid = trial / eps_t;
            self.dissipated += (0.5 * before.dot(&slid)).max(0.0);
            self.slip += slid.norm();
        }
        self.release(local, foot.map(|(gap, _)| gap));
        self.way = way;
    }

    /// How far the point slid in a step that it ends in contact (length, a vector in the tangent plane).
    fn slid(&self, local: &Vec3, traction: &Traction, eps_t: f64) -> Vec3 {
        let slid = traction.slid(eps_t);
        let trial = traction.trial.norm();
        if self.approach == 0.0 || !self.approach.is_finite() || trial == 0.0 {
            return slid;
        }
        // Along the surface, the trial traction is the way times the part of the step that contact lasted.
        let way = (local - self.base).dot(&traction.trial) / trial;
        let part = trial / (eps_t * way);
        let more = (grazing(way, self.approach) - part).max(0.0);
        slid + traction.trial * (more * way / trial)
    }

    /// Takes over the end of an accepted step in which the point is open: slip will be measured from where it is, `local`, in
    /// the part of a step after it has touched. `gap` is its distance (length), nothing where there is no foot.
    pub fn release(&mut self, local: &Vec3, gap: Option<f64>) {
        *self = PointHistory {
            base: *local,
            approach: gap.map_or(f64::INFINITY, |g| g.max(0.0)),
            slip: self.slip,
            dissipated: self.dissipated,
            ..PointHistory::default()
        };
    }
}

/// Part of a step that a point touches in the mean which goes `way` along the surface while a gap closes or opens (lengths).
///
/// Where surfaces slide into each other, at any slope that a tool's curvature makes, other points bear before and after: the mean
/// of the forces at both ends of the step, which the works of tools and supports count, is then right for the sum over the points,
/// each with all of its way. Where they meet head on a way along the surface counts for little. So the part is the squared cosine of
/// the angle at which the point comes or goes.
fn grazing(way: f64, gap: f64) -> f64 {
    let slope = gap.max(0.0) / way;
    match way > 0.0 {
        true => 1.0 / (1.0 + slope * slope),
        false => 0.0,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::contact::friction::law::Coulomb;
    use crate::contact::kernel::Normal;
    use crate::contact::law::Penalty;
    use nalgebra::Matrix3;

    /// A point that half of the step takes to open: `N` from -1 to 1.
    fn left(traction: Vec3, to: Vec3) -> PointHistory {
        let mut history = PointHistory {
            lambda: traction,
            t: traction,
            n: -1.0,
            status: PointStatus::Stick,
            ..PointHistory::default()
        };
        let foot = Some((to.z, Vec3::z()));
        let law = Penalty { eps_n: 1.0 / to.z };
        history.leave(&to, foot, &law, 1.0, &Turn::none());
        assert_eq!((history.base, history.approach), (to, to.z));
        assert_eq!((history.lambda, history.t), (Vec3::zeros(), Vec3::zeros()));
        history
    }

    #[test]
    fn a_point_that_leaves_slides_along_the_surface_only() {
        let up = left(Vec3::zeros(), Vec3::new(0.0, 0.0, 0.5));
        assert_eq!((up.slip, up.dissipated), (0.0, 0.0));
        // Half of the way, without a traction.
        let aside = left(Vec3::zeros(), Vec3::new(0.2, 0.0, 0.5));
        assert!((aside.slip - 0.1).abs() < 1e-15 && aside.dissipated == 0.0);
        // What was elastic too, under half of the traction in the mean.
        let held = left(Vec3::new(0.3, 0.0, 0.0), Vec3::new(0.2, 0.0, 0.5));
        assert!((held.slip - 0.4).abs() < 1e-15 && (held.dissipated - 0.06).abs() < 1e-15);
    }

    #[test]
    fn a_point_that_is_gone_lets_go_of_what_was_elastic() {
        let mut history = PointHistory {
            t: Vec3::new(0.0, 0.3, 0.0),
            n: -1.0,
            status: PointStatus::Slip,
            ..PointHistory::default()
        };
        let still = Turn::none();
        let law = Penalty { eps_n: 2.0 };
        history.leave(&Vec3::new(5.0, 0.0, 9.0), None, &law, 1.0, &still);
        assert!((history.slip - 0.3).abs() < 1e-15 && (history.dissipated - 0.045).abs() < 1e-15);
        assert!(history.approach.is_infinite() && history.status == PointStatus::Open);
    }

    /// It comes down at 45 degrees in steps of 2 and 1, touches half way through the second and slides on, under a traction of 1 at a
    /// tangential penalty of 10.
    #[test]
    fn a_point_that_was_expected_to_touch_is_tied_to_where_it_does() {
        let (still, law) = (Turn::none(), Penalty { eps_n: 2.0 });
        let at = |x: f64, z: f64| Vec3::new(x, 0.0, z);
        let mut history = PointHistory::default();
        history.release(&at(-2.0, 2.5), Some(2.5));
        assert_eq!(history.way, Vec3::zeros());
        let foot = Some((0.5, Vec3::z()));
        history.leave(&at(0.0, 0.5), foot, &law, 10.0, &still);
        assert_eq!((history.way, history.closes_from()), (at(2.0, -2.0), 0.5));
        history.ahead = history.way / 4.0;
        assert!((history.tied_to() - at(0.5, 0.0)).norm() < 1e-15);
        assert_eq!(history.closes_from(), 0.0);

        let (local, n) = (at(0.9, 0.0), Vec3::z());
        let normal = Normal { n: -2.0, dn: 1.0 };
        let traction = (history.attraction(10.0)).traction(
            &Coulomb { mu: 0.5 },
            &local,
            &n,
            &Matrix3::zeros(),
            -1e-6,
            &normal,
        );
        assert!((traction.trial - at(4.0, 0.0)).norm() < 1e-12);
        history.accept(&local, &traction, &Vec3::zeros(), -2.0, 10.0, &still);
        // Of the way of .9 the part of a point that comes at this angle, less the elastic slip of .1 as of the way after it touched.
        let part = 1.0 / (1.0 + (0.5f64 / 0.9).powi(2));
        assert!((history.slip - (0.9 * part - 0.1)).abs() < 1e-12);
        assert!((history.dissipated - 0.5 * history.slip).abs() < 1e-12);
        assert_eq!((history.way, history.ahead), (Vec3::zeros(), Vec3::zeros()));
    }
}
