//! Slave points on faces of bodies: their attraction points are material points of these faces.
use super::Limited;
use super::averaged::Beyond;
use crate::assembly::{Fault, RubbedPoints};
use crate::contact::friction::history::{PointHistory, Turn};
use crate::contact::friction::law::FrictionLaw;
use crate::contact::friction::moving::Reduced;
use crate::contact::friction::rigid::Friction;
use crate::contact::friction::touch::MovingFrictionTouch;
use crate::contact::friction::trial::Traction;
use crate::contact::law::{NormalLaw, Offsets, PairLaw};
use crate::contact::moving::MovingMaster;
use crate::contact::points::SlavePoint;
use crate::contact::rigid::Overhang;
use crate::model::friction::LawNow;
use crate::model::friction::with_law;
use crate::model::master::{BodyMaster, BodySurface, Masters};
use crate::model::self_contact::{Accept, All, Opposing};
use crate::model::state::PointState;
use crate::model::{Model, PairModel};
use covact_geometry::{Hint, MovingFoot, Vec3};
use nalgebra::Matrix3;
use rayon::prelude::*;

/// The points of a pair whose master is a body, at an accepted state.
pub(super) struct Batch<'a, L> {
    model: &'a Model,
    pair: &'a PairModel,
    points: &'a [SlavePoint],
    body: &'a BodyMaster,
    surface: &'a BodySurface,
    u: &'a [f64],
    offsets: Option<Offsets<'a>>,
    law: L,
}

impl<'a, L: PairLaw> Batch<'a, L> {
    /// Of a pair with these slave points, its master where [`Masters::update`] put it last; none where that is a rigid surface.
    pub fn new(
        model: &'a Model,
        masters: &'a Masters,
        index: usize,
        (points, u, time): (&'a [SlavePoint], &'a [f64], f64),
        law: L,
    ) -> Option<Self> {
        let pair = &model.pairs[index];
        Some(Batch {
            model,
            pair,
            points,
            body: pair.body_master()?,
            surface: masters.surface(index)?,
            u,
            offsets: pair.offsets(time),
            law,
        })
    }

    /// Sets the points that slip is measured from, before anything has moved.
    pub fn start(&self, points: &[PointState], histories: &mut [PointHistory]) {
        match &self.body.own {
            None => self.open_all(points, histories, &All),
            Some(own) => self.open_all(points, histories, &self.opposing(own)),
        }
    }

    fn open_all<A: Accept>(
        &self,
        points: &[PointState],
        histories: &mut [PointHistory],
        accept: &A,
    ) {
        let master = self.master();
        (histories.par_iter_mut().zip(points).enumerate())
            .with_min_len(64)
            .for_each(|(i, (history, point))| {
                let at = accept.point(i);
                let facet = |f| accept.facet(at, f);
                self.open(&master, i, point.hint, history, facet);
            });
    }

    /// Takes the end of a step into the histories. `limited` is the traction that the law allowed at its start, for a
    /// trial traction, a normal and a pressure, and the direction of the master there; `rubbed` has the points as they were
    /// evaluated last, where gaps are averaged.
    ///
    /// # Errors
    /// A point that cannot be evaluated.
    pub fn commit(
        &self,
        points: &[PointState],
        histories: &mut [PointHistory],
        (law, eps_t): (LawNow, f64),
        limited: &impl Limited,
        rubbed: Option<&RubbedPoints<'_, L>>,
    ) -> Result<(), Fault> {
        with_law!(law, law => {
            let friction = Friction { law, eps_t };
            let (friction, with) = (&friction, (limited, rubbed));
            match &self.body.own {
                None => self.accept(points, histories, friction, with, &All),
                Some(own) => self.accept(points, histories, friction, with, &self.opposing(own)),
            }
        })
    }

    fn opposing(
        &self,
        own: &'a crate::model::self_contact::OwnFacets,
    ) -> Opposing<'a, impl Fn(u32) -> Vec3 + Sync + 'a> {
        let (model, u) = (self.model, self.u);
        Opposing {
            own,
            normals: &self.surface.normals,
            position: move |n: u32| model.position(n as usize, u),
        }
    }

    fn master(&self) -> MovingMaster<'a> {
        MovingMaster {
            facets: &self.surface.facets,
            undeformed: &self.body.facets,
            depth: self.body.depth,
            keep: true,
        }
    }

    fn accept<F: FrictionLaw, A: Accept>(
        &self,
        points: &[PointState],
        histories: &mut [PointHistory],
        friction: &Friction<F>,
        (limited, rubbed): (&impl Limited, Option<&RubbedPoints<'_, L>>),
        accept: &A,
    ) -> Result<(), Fault> {
        let master = self.master();
        (histories.par_iter_mut().zip(points).enumerate())
            .with_min_len(32)
            .try_for_each(|(i, (history, point))| {
                let at = accept.point(i);
                let facet = |f| accept.facet(at, f);
                if let Some(rubbed) = rubbed {
                    let touch = rubbed.moving(i).map(|found| found.touch);
                    let at = (point.hint, Overhang::default());
                    let end = (touch, Beyond(rubbed.beyond(i)), at);
                    self.end(&master, i, end, friction, limited, history, facet);
                    return Ok(());
                }
                self.point(&master, i, *point, friction, limited, history, facet)
            })
    }

    #[expect(clippy::too_many_arguments)]
    fn point<F: FrictionLaw>(
        &self,
        master: &MovingMaster<'_>,
        i: usize,
        state: PointState,
        friction: &Friction<F>,
        limited: &impl Limited,
        history: &mut PointHistory,
        accept: impl Fn(u32) -> bool + Copy,
    ) -> Result<(), Fault> {
        let x = (self.model).point_position(&self.points[i], self.u);
        let law = history.law(self.law, self.offset(i));
        let (mut hint, overhang) = (state.hint, self.points[i].overhang(state.closed));
        let touch = master
            .touch_with_friction(
                &x,
                (&mut hint, overhang),
                &law,
                friction,
                history,
                &Reduced,
                accept,
            )
            .map_err(|fault| Fault::contact(self.pair, i, &x, fault))?;
        let end = (touch, self.law, (hint, overhang));
        self.end(master, i, end, friction, limited, history, accept);
        Ok(())
    }

    /// Takes the end of a step into the history of a point, which touches or not; `law` is that of its traction where it does not.
    #[expect(clippy::too_many_arguments)]
    fn end<F: FrictionLaw>(
        &self,
        master: &MovingMaster<'_>,
        i: usize,
        (touch, law, (hint, overhang)): (
            Option<MovingFrictionTouch>,
            impl NormalLaw,
            (Option<Hint>, Overhang),
        ),
        friction: &Friction<F>,
        limited: &impl Limited,
        history: &mut PointHistory,
        accept: impl Fn(u32) -> bool + Copy,
    ) {
        let x = (self.model).point_position(&self.points[i], self.u);
        // Where the master is now, its coordinates are those of space: what follows is as on a rigid master that does not
        // move, until the point is attached again.
        let still = Turn::none();
        let (place, base, tied) = (history.place, history.base, history.approach == 0.0);
        let mut stays = None;
        master.detach(history, &x);
        let foot = match touch {
            Some(touch) => {
                let traction = Traction {
                    trial: touch.response.trial,
                    slip: touch.response.slip,
                    tangent: Matrix3::zeros(),
                };
                let heading = master.heading(&friction.law, touch.foot, &touch.normal);
                let along = heading.map(|h| h.e);
                let first = limited(&traction.trial, &touch.normal, -history.n, along.as_ref());
                history.accept(&x, &traction, &first, touch.n, friction.eps_t, &still);
                if self.pair.augmentation.is_some() {
                    history.lambda_n = touch.n;
                    stays = (tied && !traction.slip.slides).then_some(traction.slip.t);
                }
                Some(touch.foot)
            }
            None => {
                let foot = (master.facets).project(&x, hint, f64::INFINITY, accept);
                let z0 = self.offset(i);
                let gap = |f: &MovingFoot| {
                    let over = master.over_border(&x, f, overhang, z0).flatten();
                    over.map_or(f.signed_distance, |(_, over)| over.gap) - z0
                };
                let left = foot.as_ref().map(|f| (gap(f), f.normal));
                history.leave(&x, left, &law, friction.eps_t, &still);
                foot.map(|f| f.hint())
            }
        };
        if let (Some(t), Some(at)) = (stays, place) {
            // It stays tied to where it was, so that what elastic slip is left does not add up.
            history.lambda = t;
            master.attach(history, Some(at));
            (history.place, history.base) = (place, base);
        } else {
            master.attach(history, foot);
        }
    }

    /// History of an open point at the start.
    fn open(
        &self,
        master: &MovingMaster<'_>,
        i: usize,
        hint: Option<Hint>,
        history: &mut PointHistory,
        accept: impl Fn(u32) -> bool,
    ) {
        let x = (self.model).point_position(&self.points[i], self.u);
        let foot = (master.facets).project(&x, hint, f64::INFINITY, accept);
        history.release(
            &x,
            foot.as_ref().map(|f| f.signed_distance - self.offset(i)),
        );
        master.attach(history, foot.map(|f| f.hint()));
    }

    fn offset(&self, i: usize) -> f64 {
        self.offsets.map_or(0.0, |o| o.at(i))
    }
}
