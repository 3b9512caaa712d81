//! What slave points with history do at a state: what an augmentation makes multipliers of.
use crate::contact::friction::anchor::Anchor;
use crate::contact::friction::history::PointHistory;
use crate::contact::friction::rigid::FrictionTouch;
use crate::contact::friction::touch::MovingFrictionTouch;
use covact_geometry::{MovingFacets, Vec3};

/// Tractions of a point in contact, and what its penalties leave open.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PointAnswer {
    /// Normal traction, `<= 0` (force / length^2).
    pub n: f64,
    /// Tangential traction, returned to its limit, in the coordinates of [`PointHistory::lambda`] (force / length^2).
    pub t: Vec3,
    /// Gap (length).
    pub gap: f64,
    /// Distance that the tangential penalty has to stretch for what the multiplier does not carry, `|T - lambda| / eps_T`
    /// (length).
    pub elastic: f64,
    /// Whether friction has reached its limit at the point.
    pub slides: bool,
}

impl PointAnswer {
    /// That of a point without friction.
    pub fn without_friction(n: f64, gap: f64) -> Self {
        PointAnswer {
            n,
            t: Vec3::zeros(),
            gap,
            elastic: 0.0,
            slides: false,
        }
    }

    /// That of a point on `facets` of a body.
    pub fn between(
        touch: &MovingFrictionTouch,
        history: &PointHistory,
        facets: &MovingFacets,
        eps_t: f64,
    ) -> Self {
        let (t, n) = (touch.response.slip.t, &touch.normal);
        let anchor = (history.place).and_then(|p| Anchor::new(&facets.jet(p.patch, p.xi)));
        // The multiplier turns with the facet that it is attached to, and with the tangent plane.
        let lambda = anchor.map_or_else(Vec3::zeros, |a| a.vector(&history.lambda));
        let lambda = lambda - n * n.dot(&lambda);
        PointAnswer {
            n: touch.n,
            t: anchor.map_or_else(Vec3::zeros, |a| a.components(&t)),
            gap: touch.gap,
            elastic: (t - lambda).norm() / eps_t,
            slides: touch.response.slip.slides,
        }
    }

    /// That of a point on a rigid master.
    pub fn with_friction(touch: &FrictionTouch, history: &PointHistory, eps_t: f64) -> Self {
        let (t, n) = (touch.traction.slip.t, &touch.normal);
        // The multiplier turns with the tangent plane.
        let lambda = history.lambda - n * n.dot(&history.lambda);
        PointAnswer {
            n: touch.touch.n,
            t,
            gap: touch.touch.gap,
            elastic: (t - lambda).norm() / eps_t,
            slides: touch.traction.slip.slides,
        }
    }
}
