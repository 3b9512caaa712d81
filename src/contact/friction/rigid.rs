//! Contact with friction on a rigid master.
use super::history::PointHistory;
use super::law::{FrictionLaw, Secant, Slide};
use super::trial::{Attraction, Traction};
use super::turning::Turning;
use crate::contact::clearance::Clearance;
use crate::contact::closest::ClosestPoint;
use crate::contact::corner::Steady;
use crate::contact::fault::PointFault;
use crate::contact::kernel::Normal;
use crate::contact::law::{Augmented, NormalLaw, PairLaw};
use crate::contact::placed::Placed;
use crate::contact::rigid::{
    Exact, Overhang, RigidMaster, Touch, free, respond_rigid, respond_steady,
};
use covact_geometry::{Foot, Hint, Vec3};

/// Friction of a pair at the present time: a type per law, so that the law is chosen outside the loop over points.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Friction<F> {
    /// The law of friction.
    pub law: F,
    /// Tangential penalty (force / length^3).
    pub eps_t: f64,
}

/// A point in contact with friction, per unit area.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FrictionTouch {
    /// Residual and tangent with both tractions, in space. The tangent has no symmetry.
    pub touch: Touch,
    /// Tangential traction, in the surface's own coordinates.
    pub traction: Traction,
    /// The slave point in the surface's own coordinates.
    pub local: Vec3,
    /// Unit normal at the foot, in the same coordinates.
    pub normal: Vec3,
}

impl<F> Friction<F> {
    /// The law of a point that slid as told before. Only points that slide to and fro are taken to stick.
    pub fn sliding(&self, slide: Slide, turning: &Turning) -> Friction<Secant<F>>
    where
        F: Copy,
    {
        Friction {
            law: Secant {
                law: self.law,
                slide: match slide {
                    Slide::Stick if !turning.oscillates() => Slide::Tangent,
                    slide => slide,
                },
                last: *turning.last(),
            },
            eps_t: self.eps_t,
        }
    }
}

impl PointHistory {
    /// The attraction point of a rigid master, under a tangential penalty.
    #[inline]
    pub fn attraction(&self, eps_t: f64) -> Attraction {
        Attraction {
            eps_t,
            base: self.tied_to(),
            lambda: self.lambda,
            approach: self.closes_from(),
        }
    }
}

impl<P: ClosestPoint> RigidMaster<'_, P> {
    /// [`Placed::touch_with_friction`] of a single point.
    ///
    /// # Errors
    /// [`PointFault`] as there.
    pub fn touch_with_friction<L: PairLaw, F: FrictionLaw>(
        &self,
        x: &Vec3,
        (hint, overhang): (&mut Option<Hint>, Overhang),
        law: &Augmented<L>,
        friction: &Friction<F>,
        history: &PointHistory,
    ) -> Result<Option<FrictionTouch>, PointFault> {
        (self.placed()).touch_with_friction(
            x,
            (hint, &mut Clearance::default(), overhang),
            law,
            friction,
            history,
        )
    }
}

impl<P: ClosestPoint> Placed<'_, P> {
    /// Evaluates a slave point with friction; `None` where it is open. What is known of it as for [`Placed::touch_into`].
    ///
    /// # Errors
    /// [`PointFault`] as there.
    #[inline]
    pub fn touch_with_friction<L: PairLaw, F: FrictionLaw>(
        &self,
        x: &Vec3,
        (hint, clear, overhang): (&mut Option<Hint>, &mut Clearance, Overhang),
        law: &Augmented<L>,
        friction: &Friction<F>,
        history: &PointHistory,
    ) -> Result<Option<FrictionTouch>, PointFault> {
        self.at_foot(x, (hint, clear, overhang), law, |local, foot| {
            let attraction = history.attraction(friction.eps_t);
            if free(foot) {
                return Ok(self.slide_past(x, local, foot, (law, overhang), friction, history));
            }
            let geometry = self.geometry(local, foot)?;
            let xi3 = geometry.xi3();
            let normal = law.response(xi3);
            let limit = limit(law, &normal, history);
            let gap = law.gap(xi3);
            let (mut residual, mut k, n, traction) = match self.master.steady(foot, &geometry, law)
            {
                None => {
                    let (residual, k) = respond_rigid(&geometry, &normal, &Exact);
                    let (n, turn) = (geometry.normal(), geometry.turn());
                    let friction =
                        attraction.traction(&friction.law, local, &n, &turn, gap, &limit);
                    (residual, k, n, friction)
                }
                Some(steady) => {
                    let (residual, k) = respond_steady(&steady, &normal);
                    let Steady { n, turn, gradient } = &steady;
                    let friction = attraction.traction_towards(
                        &friction.law,
                        local,
                        n,
                        gradient,
                        turn,
                        gap,
                        &limit,
                    );
                    (residual, k, *n, friction)
                }
            };
            residual += traction.slip.t;
            k += traction.tangent;
            Ok(Some(FrictionTouch {
                touch: self.in_space(x, xi3, law, &normal, residual, k),
                traction,
                local: *local,
                normal: n,
            }))
        })
    }

    /// [`Self::touch_with_friction`] of a point whose foot lies on a free border.
    #[cold]
    #[inline(never)]
    fn slide_past<L: PairLaw, F: FrictionLaw>(
        &self,
        x: &Vec3,
        local: &Vec3,
        foot: &Foot,
        (law, overhang): (&Augmented<L>, Overhang),
        friction: &Friction<F>,
        history: &PointHistory,
    ) -> Option<FrictionTouch> {
        let rounded = self.rounded(local, foot, law, overhang)?;
        let xi3 = rounded.xi3;
        let normal = law.response(xi3);
        let limit = limit(law, &normal, history);
        let attraction = history.attraction(friction.eps_t);
        let (residual, k) = respond_steady(&rounded.at, &normal);
        let Steady { n, turn, gradient } = &rounded.at;
        let gap = law.gap(xi3);
        let traction =
            attraction.traction_towards(&friction.law, local, n, gradient, turn, gap, &limit);
        let (residual, k) = (residual + traction.slip.t, k + traction.tangent);
        Some(FrictionTouch {
            touch: self.in_space(x, xi3, law, &normal, residual, k),
            traction,
            local: *local,
            normal: *n,
        })
    }
}

/// What limits friction. The pressure of a point that is held is nothing to go by: it is far from the surface.
fn limit<L: PairLaw>(law: &Augmented<L>, normal: &Normal, history: &PointHistory) -> Normal {
    match law.held {
        true => Normal {
            n: history.n,
            dn: 0.0,
        },
        false => *normal,
    }
}
