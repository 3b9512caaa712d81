//! Contact with friction on faces of a body.
use super::anchor::{Anchor, Pull};
use super::history::PointHistory;
use super::law::FrictionLaw;
use super::moving::{Form, Response, respond_with_friction};
use super::rigid::Friction;
use crate::contact::fault::{Piece, PointFault};
use crate::contact::law::{Augmented, NormalLaw};
use crate::contact::moving::MovingMaster;
use covact_geometry::{Hint, Vec3};

/// A point in contact with friction on faces of a body, per unit area and in space coordinates.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MovingFrictionTouch {
    /// Facet and parameters of the foot.
    pub foot: Hint,
    /// Facet and parameters of the attraction point, where there is one.
    pub anchor: Option<Hint>,
    pub response: Response,
    /// Gap that the law sees, negative in a pure penalty (length).
    pub gap: f64,
    /// Normal traction, negative.
    pub n: f64,
}

/// An attraction point that is to be kept, as [`PointHistory`] keeps it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Attached {
    pub place: Hint,
    pub base: Vec3,
    pub lambda: Vec3,
}

/// How near the direction of the distance is lost on an edge or a vertex, relative to the size of the surface.
const NEAR: f64 = 1e-12;

impl MovingMaster<'_> {
    /// Evaluates a slave point with friction; `None` where it is open. `hint` and `accept` as for
    /// [`MovingMaster::touch`].
    ///
    /// # Errors
    /// [`PointFault`] as there, and where the facet of the attraction point has degenerated.
    pub fn touch_with_friction<F: FrictionLaw, M: Form>(
        &self,
        x: &Vec3,
        hint: &mut Option<Hint>,
        law: &Augmented,
        friction: &Friction<F>,
        history: &PointHistory,
        form: &M,
        accept: impl Fn(u32) -> bool,
    ) -> Result<Option<MovingFrictionTouch>, PointFault> {
        let Some(foot) = self.search(x, hint, self.depth, accept)? else {
            return Ok(None);
        };
        let meeting = self.at(x, &foot)?;
        if meeting.free || !law.closes(meeting.xi3) {
            return Ok(None);
        }
        meeting.check()?;
        let normal = law.normal(meeting.xi3);
        let gap = law.gap(meeting.xi3);
        let pull = match history.place {
            None => Pull::none(),
            Some(place) => {
                let anchor = Anchor::new(&self.facets.jet(place.patch, place.xi)).ok_or(
                    PointFault::DegenerateFrame {
                        piece: Piece::Facet(place.patch),
                        xi: place.xi,
                    },
                )?;
                let components = [&history.base, &history.lambda];
                Pull::new(&anchor, components, friction.eps_t, history.approach, x, gap)
            }
        };
        let geometry = meeting.steady(NEAR * self.facets.size());
        Ok(Some(MovingFrictionTouch {
            foot: foot.hint(),
            anchor: history.place,
            response: respond_with_friction(&geometry, &normal, &friction.law, &pull, form),
            gap,
            n: normal.n,
        }))
    }

    /// The space point `base` and the traction `lambda` as components at a place of the surface, so that they move with it
    /// from now on. Where the facet has no normal there, the place is moved a little towards its middle; `None` where it
    /// has none anywhere near.
    pub fn attach(&self, place: Hint, base: &Vec3, lambda: &Vec3) -> Option<Attached> {
        [0.0, 1e-3, 0.1].into_iter().find_map(|step| {
            let xi = place.xi.map(|x| x * (1.0 - step));
            let anchor = Anchor::new(&self.facets.jet(place.patch, xi))?;
            Some(Attached {
                place: Hint {
                    patch: place.patch,
                    xi,
                },
                base: anchor.components(&(base - anchor.rho)),
                lambda: anchor.components(lambda),
            })
        })
    }

    /// A traction with components at a place of the surface, in space; zero where there is none.
    pub fn carried(&self, place: Option<Hint>, components: &Vec3) -> Vec3 {
        let anchor = place.and_then(|p| Anchor::new(&self.facets.jet(p.patch, p.xi)));
        anchor.map_or_else(Vec3::zeros, |a| a.vector(components))
    }
}
