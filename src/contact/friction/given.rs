//! Friction of a slave point whose normal traction is given: with averaged gaps it is that of the nodes around.
//!
//! The traction `lambda` of the point does not hang on where the point itself is. Residual and tangent are those of a point under
//! `N = lambda`, `N' = 0`; what the nodes' tractions make of the residual is told beside, by its derivative with respect to `lambda`:
//!
//! ```text
//! r = lambda g3 + w(T)          dr/dlambda = g3 + w(T,N)
//! ```
//!
//! with the work `w` of a tangential traction ([`Form`]), which is linear in it, and `T,N = 0` where the point sticks. The part of a
//! step after an impact is the one of the point's own gap: a point that comes into contact while it is above the surface itself is
//! held by friction from the next step on.
use super::anchor::dual;
use super::history::PointHistory;
use super::law::{FrictionLaw, Slip};
use super::moving::{Form, Full, respond_with_friction};
use super::rigid::{Friction, FrictionTouch};
use super::touch::MovingFrictionTouch;
use crate::contact::fault::PointFault;
use crate::contact::kernel::{Normal, Slots, in_slot};
use crate::contact::moving::MovingMaster;
use crate::contact::point::{PointGeometry, respond};
use crate::contact::rigid::{Exact, Touch};
use covact_geometry::{Hint, Vec3};
use nalgebra::{Isometry3, Matrix3, Point3, Vector3};
use num_dual::DualNum;

/// A point with what its residual changes by with its normal traction.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Given<T, R> {
    /// The point under its given normal traction.
    pub touch: T,
    /// `dr/dlambda`, in space.
    pub by_traction: R,
}

/// A point on a rigid master.
pub type GivenRigid = Given<FrictionTouch, Vec3>;
/// A point on faces of a body.
pub type GivenMoving = Given<MovingFrictionTouch, Slots>;

/// Where a point is and what presses it.
#[derive(Debug, Clone, Copy)]
pub struct Pressed<'a> {
    /// In space.
    pub x: &'a Vec3,
    /// In space too.
    pub geometry: &'a PointGeometry,
    /// The point's own gap (length).
    pub gap: f64,
    /// Normal traction; positive where it draws (force / length^2).
    pub lambda: f64,
}

impl Pressed<'_> {
    fn normal(&self) -> Normal {
        Normal {
            n: self.lambda,
            dn: 0.0,
        }
    }

    /// The point on a rigid master in this pose.
    pub fn on_rigid<F: FrictionLaw>(
        &self,
        pose: &Isometry3<f64>,
        friction: &Friction<F>,
        history: &PointHistory,
    ) -> GivenRigid {
        let turn: Matrix3<f64> = pose.rotation.to_rotation_matrix().into_inner();
        let local = pose.inverse_transform_point(&Point3::from(*self.x)).coords;
        let n = self.geometry.normal();
        let own = pose.rotation.inverse_transform_vector(&n);
        let turns = turn.transpose() * self.geometry.turn() * turn;
        let traction = history.attraction(friction.eps_t).traction(
            &friction.law,
            &local,
            &own,
            &turns,
            self.gap,
            &self.normal(),
        );
        let (residual, tangent) = respond(self.geometry, &self.normal(), &Exact);
        let residual: Vec3 = residual.fixed_rows::<3>(0).into();
        let tangent: Matrix3<f64> = tangent.fixed_view::<3, 3>(0, 0).into();
        Given {
            touch: FrictionTouch {
                touch: Touch {
                    x: *self.x,
                    residual: residual + turn * traction.slip.t,
                    tangent: tangent + turn * traction.tangent * turn.transpose(),
                    xi3: self.geometry.xi3(),
                    gap: self.gap,
                    n: self.lambda,
                },
                traction,
                local,
                normal: own,
            },
            by_traction: n - turn * traction.slip.d_pressure,
        }
    }

    /// The point on faces of a body, with its foot at `foot`.
    ///
    /// # Errors
    /// The facet of the attraction point has degenerated.
    pub fn on_body<F: FrictionLaw>(
        &self,
        master: &MovingMaster,
        foot: Hint,
        friction: &Friction<F>,
        history: &PointHistory,
    ) -> Result<GivenMoving, PointFault> {
        let pull = master.pull(history, friction.eps_t, self.x, self.gap)?;
        let normal = self.geometry.normal();
        let heading = master.heading(&friction.law, foot, &normal);
        let response = respond_with_friction(
            self.geometry,
            &self.normal(),
            &friction.law,
            &pull,
            heading.as_ref(),
            &Full,
        );
        let by_traction =
            in_slot(0, &normal) + work::<_, Full>(self.geometry, &-response.slip.d_pressure);
        Ok(Given {
            touch: MovingFrictionTouch {
                foot,
                anchor: history.place,
                response,
                gap: self.gap,
                n: self.lambda,
                normal,
            },
            by_traction,
        })
    }
}

/// No friction, whatever pulls: the traction of a node may be negative at a point where those of its neighbours are none, because the
/// shape functions of quadratic faces are negative in parts. There the point is drawn, and friction has nothing to press with.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Drawn;

impl FrictionLaw for Drawn {
    #[inline]
    fn slip<D: DualNum<f64> + Copy>(
        &self,
        _trial: &Vector3<D>,
        _normal: &Vector3<D>,
        _pressure: D,
    ) -> Slip<D> {
        let none = Matrix3::from_element(D::zero());
        Slip {
            t: Vector3::from_element(D::zero()),
            d_trial: none,
            d_pressure: Vector3::from_element(D::zero()),
            d_normal: none,
            slides: false,
        }
    }
}

/// Generalised forces of a tangential traction in the nine slots: what of [`super::moving::Response::residual`] is friction.
pub fn work<D: DualNum<f64> + Copy, M: Form>(
    geometry: &PointGeometry<D>,
    t: &Vector3<D>,
) -> Slots<D> {
    let mut out = in_slot(0, t);
    match geometry {
        PointGeometry::Face { frame, xi3 } if M::FULL => {
            for (i, up) in dual(frame).iter().enumerate() {
                out += in_slot(1 + i, &(frame.n * (*xi3 * up.dot(t))));
            }
        }
        PointGeometry::Edge {
            xi3,
            direction,
            rho_s,
            ..
        } if M::FULL => {
            let tau = t.dot(rho_s) * rho_s.dot(rho_s).recip();
            for (i, part) in direction.iter().enumerate() {
                out += in_slot(1 + i, &(geometry.normal() * (*xi3 * tau * *part)));
            }
        }
        _ => {}
    }
    out
}

#[cfg(test)]
mod tests {
    use super::super::anchor::{Columns, Pull};
    use super::super::law::Coulomb;
    use super::*;
    use covact_geometry::{Frame, Jet};
    use num_dual::Dual64;

    type V = Vector3<Dual64>;

    fn vector(x: f64, y: f64, z: f64) -> V {
        V::new(x.into(), y.into(), z.into())
    }

    /// A point above a face, beside an edge, at a vertex, and at a pole.
    fn geometries() -> Vec<(&'static str, PointGeometry<Dual64>)> {
        let jet = Jet {
            rho: vector(0.1, 0.2, 0.3),
            rho_i: [vector(1.1, 0.2, -0.1), vector(-0.3, 0.9, 0.2)],
            rho_ij: [
                vector(0.1, 0.0, 0.3),
                vector(0.0, -0.1, 0.2),
                vector(0.1, 0.2, -0.4),
            ],
        };
        let frame = Frame::new(&jet, 1.0).expect("a tangent plane");
        let xi3 = Dual64::from(-0.07);
        // Orthogonal to the edge.
        let along = jet.rho_i[0] * Dual64::from(0.8) + jet.rho_i[1] * Dual64::from(0.6);
        let d = vector(0.2, -0.1, 0.4).cross(&along);
        let direction = [0.8.into(), 0.6.into()];
        let short = -d.dot(&d).sqrt();
        vec![
            ("face", PointGeometry::Face { frame, xi3 }),
            ("edge", PointGeometry::edge(&jet, direction, d, short)),
            ("vertex", PointGeometry::Vertex { d, xi3: short }),
            (
                "pole",
                PointGeometry::Pole {
                    normal: frame.n,
                    xi3,
                },
            ),
        ]
    }

    /// The residual is that of the normal traction and the work of the tangential one, and changes with the former as it is told to, where the
    /// point slides and where it sticks.
    #[test]
    fn residual_follows_the_given_traction() {
        for (name, geometry) in geometries() {
            for (mu, slides) in [(0.3, true), (1e3, false)] {
                let normal = Normal {
                    n: Dual64::new(-0.9, 1.0),
                    dn: Dual64::from(0.0),
                };
                let pull = Pull {
                    v: vector(0.7, -1.2, 0.4),
                    columns: Columns::from_element(0.0.into()),
                    along_gap: vector(0.0, 0.0, 0.0),
                };
                let law = Coulomb { mu };
                let found = respond_with_friction(&geometry, &normal, &law, &pull, None, &Full);
                assert_eq!(found.slip.slides, slides, "{name}");
                let (pressed, _) = respond(&geometry, &normal, &Exact);
                let rubbed = work::<_, Full>(&geometry, &found.slip.t);
                let error = (found.residual - pressed - rubbed).map(|x| x.re).norm();
                assert!(
                    error < 1e-14 && rubbed.map(|x| x.re).norm() > 0.1,
                    "{name}: {error:e}"
                );
                let told = in_slot(0, &geometry.normal())
                    + work::<_, Full>(&geometry, &-found.slip.d_pressure);
                let error = (found.residual.map(|x| x.eps) - told.map(|x| x.re)).norm();
                assert!(error < 1e-14, "{name}, slides {slides}: {error:e}");
                let by_friction = found.slip.d_pressure.map(|x| x.re).norm();
                assert_eq!(by_friction > 0.1, slides, "{name}");
                let levers = rubbed.rows(3, 6).map(|x| x.re).norm();
                assert_eq!(levers > 1e-3, name == "face" || name == "edge", "{name}");
            }
        }
    }

    #[test]
    fn what_is_drawn_does_not_rub() {
        let slip = Drawn.slip(&Vec3::x(), &Vec3::z(), -1.0);
        assert_eq!((slip.t, slip.d_trial), (Vec3::zeros(), Matrix3::zeros()));
        assert!(!slip.slides);
    }
}
