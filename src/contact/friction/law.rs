//! Laws of friction: trial traction and pressure in, traction and derivatives out. Chosen outside every loop.
use nalgebra::{Matrix3, Vector3};
use num_dual::DualNum;

/// What a law makes of a trial traction.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Slip<D = f64> {
    /// Traction in the tangent plane (force / length^2).
    pub t: Vector3<D>,
    /// Its derivative with respect to the trial traction.
    pub d_trial: Matrix3<D>,
    /// With respect to the pressure `-N`.
    pub d_pressure: Vector3<D>,
    /// With respect to the unit normal, for laws that know directions; zero otherwise (force / length^2).
    pub d_normal: Matrix3<D>,
    /// Whether the traction is at its limit.
    pub slides: bool,
}

impl<D: DualNum<f64> + Copy> Slip<D> {
    /// The trial traction as it is: the point sticks.
    pub fn stick(trial: &Vector3<D>) -> Self {
        Slip {
            t: *trial,
            d_trial: diagonal(D::one()),
            d_pressure: Vector3::from_element(D::zero()),
            d_normal: Matrix3::from_element(D::zero()),
            slides: false,
        }
    }
}

/// `s I`.
pub fn diagonal<D: DualNum<f64> + Copy>(s: D) -> Matrix3<D> {
    let z = D::zero();
    Matrix3::new(s, z, z, z, s, z, z, z, s)
}

/// A law of friction. Adding one takes a type that implements this, and a name in the scene.
pub trait FrictionLaw: Sync + Copy {
    /// Traction for a trial traction in the plane of `normal` (a unit vector) under `pressure > 0`, in the coordinates of
    /// the master.
    fn slip<D: DualNum<f64> + Copy>(
        &self,
        trial: &Vector3<D>,
        normal: &Vector3<D>,
        pressure: D,
    ) -> Slip<D>;

    /// The direction of the master that the law knows, in the coordinates in which the master is given; none where all directions
    /// are alike.
    #[inline]
    fn direction(&self) -> Option<&Vector3<f64>> {
        None
    }

    /// [`Self::slip`] where the direction of the master is the unit vector `direction` at this point, whatever it was given
    /// as; with the derivative of the traction with respect to that (force / length^2).
    #[inline]
    fn slip_along<D: DualNum<f64> + Copy>(
        &self,
        trial: &Vector3<D>,
        normal: &Vector3<D>,
        pressure: D,
        _direction: &Vector3<D>,
    ) -> (Slip<D>, Matrix3<D>) {
        let slip = self.slip(trial, normal, pressure);
        (slip, Matrix3::from_element(D::zero()))
    }
}

/// Coulomb's law: the traction is at most `mu` times the pressure, and as the trial traction directs.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Coulomb {
    /// Coefficient of friction.
    pub mu: f64,
}

impl FrictionLaw for Coulomb {
    #[inline]
    fn slip<D: DualNum<f64> + Copy>(
        &self,
        trial: &Vector3<D>,
        _normal: &Vector3<D>,
        pressure: D,
    ) -> Slip<D> {
        let limit = pressure * self.mu;
        let square = trial.dot(trial);
        if square.re() <= limit.re() * limit.re() {
            return Slip::stick(trial);
        }
        let norm = square.sqrt();
        let direction = trial * norm.recip();
        let scale = limit / norm;
        Slip {
            t: direction * limit,
            d_trial: diagonal(scale) - direction * direction.transpose() * scale,
            d_pressure: direction * D::from(self.mu),
            d_normal: Matrix3::from_element(D::zero()),
            slides: true,
        }
    }
}

/// How sliding is linearised.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum Slide {
    /// By its tangent, but by the secant where a point has turned.
    #[default]
    Tangent,
    /// By the secant.
    Secant,
    /// Not at all: the traction is the trial traction, whatever the law allows.
    Stick,
}

impl Slide {
    /// By the secant, or not.
    pub const fn secant(on: bool) -> Slide {
        if on { Slide::Secant } else { Slide::Tangent }
    }
}

/// A law with the tangent of its secant where a point slides: `dT/dT_tr = |T| / |T_tr|` in all directions. A traction that slides
/// offers no resistance along its direction, so that Newton's method overshoots points that should stick, whose range is as
/// small as the penalty is stiff, and sends them to and fro. The secant holds all points until it shows which way they go, and
/// brings back one that has gone past where it should have stopped.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Secant<F> {
    /// The law itself.
    pub law: F,
    /// How sliding is linearised.
    pub slide: Slide,
    /// Traction at the last linearisation (force / length^2): a point that slides the other way now has gone too far. Zero where
    /// there is none.
    pub last: Vector3<f64>,
}

impl<F> Secant<F> {
    /// What a law made of a trial traction, by its secant where that is to be.
    #[inline]
    fn held<D: DualNum<f64> + Copy>(&self, trial: &Vector3<D>, slip: Slip<D>) -> Slip<D> {
        let turned = || slip.t.map(|x| x.re()).dot(&self.last) < 0.0;
        let norm = |v: &Vector3<D>| v.map(|x| x.re()).norm();
        if !slip.slides || !(self.slide == Slide::Secant || turned()) {
            return slip;
        }
        Slip {
            d_trial: diagonal(D::from(norm(&slip.t) / norm(trial))),
            ..slip
        }
    }
}

impl<F: FrictionLaw> FrictionLaw for Secant<F> {
    #[inline]
    fn slip<D: DualNum<f64> + Copy>(
        &self,
        trial: &Vector3<D>,
        normal: &Vector3<D>,
        pressure: D,
    ) -> Slip<D> {
        match self.slide {
            Slide::Stick => Slip::stick(trial),
            _ => self.held(trial, self.law.slip(trial, normal, pressure)),
        }
    }

    #[inline]
    fn direction(&self) -> Option<&Vector3<f64>> {
        self.law.direction()
    }

    #[inline]
    fn slip_along<D: DualNum<f64> + Copy>(
        &self,
        trial: &Vector3<D>,
        normal: &Vector3<D>,
        pressure: D,
        direction: &Vector3<D>,
    ) -> (Slip<D>, Matrix3<D>) {
        if self.slide == Slide::Stick {
            return (Slip::stick(trial), Matrix3::from_element(D::zero()));
        }
        let (slip, by_direction) = self.law.slip_along(trial, normal, pressure, direction);
        (self.held(trial, slip), by_direction)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn secant_leaves_the_traction_and_resists_along_it() {
        let law = Coulomb { mu: 0.25 };
        let (n, trial) = (Vector3::z(), Vector3::new(3.0, 4.0, 0.0));
        let exact = law.slip(&trial, &n, 2.0);
        // A point that was drawn the other way has turned; one that was drawn as now, or not at all, has not.
        let secant = |slide, last: f64| Secant {
            law,
            slide,
            last: exact.t * last,
        };
        assert_eq!(secant(Slide::Tangent, 0.0).slip(&trial, &n, 2.0), exact);
        assert_eq!(secant(Slide::Tangent, 0.7).slip(&trial, &n, 2.0), exact);
        let turned = secant(Slide::Tangent, -0.1).slip(&trial, &n, 2.0);
        assert_eq!(turned, secant(Slide::Secant, 0.0).slip(&trial, &n, 2.0));
        assert_ne!(turned.d_trial, exact.d_trial);
        let stuck = secant(Slide::Stick, -0.1).slip(&trial, &n, 2.0);
        assert_eq!((stuck, stuck.t), (Slip::stick(&trial), trial));
        let secant = secant(Slide::Secant, 0.0);
        let slip = secant.slip(&trial, &n, 2.0);
        assert_eq!((slip.t, slip.d_pressure), (exact.t, exact.d_pressure));
        assert!((exact.d_trial * trial).norm() < 1e-15);
        assert!((slip.d_trial * trial - slip.t).norm() < 1e-15);
        let sticks = Vector3::new(0.3, 0.4, 0.0);
        assert_eq!(secant.slip(&sticks, &n, 2.0), law.slip(&sticks, &n, 2.0));
    }

    #[test]
    fn coulomb_sticks_below_the_limit_and_slides_along_the_trial_above() {
        let law = Coulomb { mu: 0.25 };
        let n = Vector3::z();
        let stick = law.slip(&Vector3::new(0.3, 0.4, 0.0), &n, 2.0);
        assert!(!stick.slides && stick.t == Vector3::new(0.3, 0.4, 0.0));
        let slip = law.slip(&Vector3::new(3.0, 4.0, 0.0), &n, 2.0);
        assert!(slip.slides);
        assert!((slip.t - Vector3::new(0.3, 0.4, 0.0)).norm() < 1e-15);
        // A limit of zero leaves nothing.
        let none = law.slip(&Vector3::new(3.0, 4.0, 0.0), &n, 0.0);
        assert_eq!(none.t, Vector3::zeros());
    }
}
