//! Contact with friction on faces of a body.
use super::anchor::{Anchor, Pull};
use super::history::PointHistory;
use super::law::FrictionLaw;
use super::moving::{Form, Response, respond_with_friction};
use super::rigid::Friction;
use crate::contact::fault::{Piece, PointFault};
use crate::contact::law::{Augmented, NormalLaw, PairLaw};
use crate::contact::moving::MovingMaster;
use crate::contact::overhang::Overhang;
use crate::contact::point::PointGeometry;
use covact_geometry::{Hint, Vec3};

/// A point in contact with friction on faces of a body, per unit area and in space coordinates.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MovingFrictionTouch {
    /// Facet and parameters of the foot.
    pub foot: Hint,
    /// Facet and parameters of the attraction point, where there is one.
    pub anchor: Option<Hint>,
    /// Residual and tangent in the slots.
    pub response: Response,
    /// Gap that the law sees, negative in a pure penalty (length).
    pub gap: f64,
    /// Normal traction, negative.
    pub n: f64,
    /// Outward unit vector that it acts along.
    pub normal: Vec3,
}

impl MovingMaster<'_> {
    /// Evaluates a slave point with friction; `None` where it is open. `hint`, `overhang` and `accept` as for
    /// [`MovingMaster::touch`].
    ///
    /// # Errors
    /// [`PointFault`] as there, and where the facet of the attraction point has degenerated.
    #[expect(clippy::too_many_arguments)]
    pub fn touch_with_friction<L: PairLaw, F: FrictionLaw, M: Form>(
        &self,
        x: &Vec3,
        (hint, overhang): (&mut Option<Hint>, Overhang),
        law: &Augmented<L>,
        friction: &Friction<F>,
        history: &PointHistory,
        form: &M,
        accept: impl Fn(u32) -> bool,
    ) -> Result<Option<MovingFrictionTouch>, PointFault> {
        let Some((foot, meeting)) = self.contact_at(x, (hint, overhang), law, accept)? else {
            return Ok(None);
        };
        let normal = meeting.pressed(law)?;
        let gap = law.gap(meeting.xi3);
        let pull = self.pull(history, friction.eps_t, x, gap)?;
        let geometry = &meeting.geometry;
        let (law, n) = (&friction.law, geometry.normal());
        let heading = self.heading(law, foot.hint(), &n);
        let heading = heading.as_ref();
        let response = match (&meeting.hanging, geometry) {
            (Some(hanging), PointGeometry::Face { frame, xi3 }) => {
                let along = hanging.along_normal(&normal);
                let mut response =
                    respond_with_friction(geometry, &along, law, &pull, heading, form);
                let Response {
                    residual, tangent, ..
                } = &mut response;
                hanging.add_along_facet((frame, *xi3), &normal, residual, tangent);
                // The limit of friction is that of the pressure along the normal.
                let change = hanging.normal_along(frame, *xi3, &normal);
                let rows = response.slip.d_pressure * change.transpose();
                let mut slot = response.tangent.fixed_rows_mut::<3>(0);
                slot -= rows;
                response
            }
            _ => respond_with_friction(geometry, &normal, law, &pull, heading, form),
        };
        Ok(Some(MovingFrictionTouch {
            foot: foot.hint(),
            anchor: history.place,
            response,
            gap,
            n: normal.n,
            normal: n,
        }))
    }

    /// What pulls at a slave point at `x` with this gap, by its history.
    ///
    /// # Errors
    /// The facet of the attraction point has degenerated.
    #[inline]
    pub(super) fn pull(
        &self,
        history: &PointHistory,
        eps_t: f64,
        x: &Vec3,
        gap: f64,
    ) -> Result<Pull, PointFault> {
        let Some(place) = history.place else {
            return Ok(Pull::none());
        };
        let anchor = Anchor::new(&self.facets.jet(place.patch, place.xi)).ok_or(
            PointFault::DegenerateFrame {
                piece: Piece::Facet(place.patch),
                xi: place.xi,
            },
        )?;
        let components = [&history.tied_to(), &history.lambda];
        Ok(Pull::new(
            &anchor,
            components,
            eps_t,
            history.closes_from(),
            x,
            gap,
        ))
    }

    /// Attaches an attraction point, its traction and the way of an open point, in space, to the surface at `foot`, to move with it from now on. Where
    /// the facet has no normal there, the place is moved a little towards its middle; where it has none anywhere near,
    /// or there is no foot, the point is attached to nothing and nothing pulls at it.
    pub fn attach(&self, history: &mut PointHistory, foot: Option<Hint>) {
        let found = foot.and_then(|Hint { patch, xi }| {
            [0.0, 1e-3, 0.1].into_iter().find_map(|step| {
                let xi = xi.map(|x| x * (1.0 - step));
                let anchor = Anchor::new(&self.facets.jet(patch, xi))?;
                Some((Hint { patch, xi }, anchor))
            })
        });
        let PointHistory {
            base, way, lambda, ..
        } = history;
        match &found {
            Some((_, anchor)) => {
                *base -= anchor.rho;
                for v in [base, way, lambda] {
                    *v = anchor.components(v);
                }
            }
            None => [*base, *way, *lambda] = [Vec3::zeros(); 3],
        }
        history.place = found.map(|(place, _)| place);
    }

    /// Turns attraction point and traction of a history into those of space, where the surface is now; of a history without
    /// a place the attraction point is `x`. The way that an open point went before has no use then.
    pub fn detach(&self, history: &mut PointHistory, x: &Vec3) {
        let place = history.place.take();
        let anchor = place.and_then(|p| Anchor::new(&self.facets.jet(p.patch, p.xi)));
        (history.base, history.lambda) = match anchor {
            Some(a) => (a.rho + a.vector(&history.base), a.vector(&history.lambda)),
            None => (*x, Vec3::zeros()),
        };
    }
}
