//! Slave points on faces of bodies: their attraction points are material points of these faces.
use crate::assembly::Fault;
use crate::contact::friction::history::{PointHistory, PointStatus};
use crate::contact::friction::law::FrictionLaw;
use crate::contact::friction::moving::Reduced;
use crate::contact::friction::rigid::Friction;
use crate::contact::friction::touch::Attached;
use crate::contact::moving::MovingMaster;
use crate::model::friction::LawNow;
use crate::model::master::{BodyMaster, BodySurface, Masters};
use crate::model::self_contact::{Accept, All, Opposing};
use crate::model::state::PointState;
use crate::model::{Model, PairModel};
use crate::with_law;
use covact_geometry::{Hint, Vec3};
use rayon::prelude::*;

/// The points of a pair whose master is a body, at an accepted state.
pub(super) struct Batch<'a> {
    model: &'a Model,
    pair: &'a PairModel,
    body: &'a BodyMaster,
    surface: &'a BodySurface,
    u: &'a [f64],
    time: f64,
    eps_n: f64,
}

impl<'a> Batch<'a> {
    /// Of a pair, its master where [`Masters::update`] put it last; none where that is a rigid surface.
    pub fn new(
        model: &'a Model,
        masters: &'a Masters,
        index: usize,
        u: &'a [f64],
        time: f64,
        eps_n: f64,
    ) -> Option<Self> {
        let pair = &model.pairs[index];
        Some(Batch {
            model,
            pair,
            body: pair.body_master()?,
            surface: masters.surface(index)?,
            u,
            time,
            eps_n,
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
                let x = self.model.point_position(&self.pair.points[i], self.u);
                let at = accept.point(i);
                let facet = |f| accept.facet(at, f);
                *history = self.open(&master, i, &x, point.hint, history, facet);
            });
    }

    /// Takes the end of a step into the histories.
    ///
    /// # Errors
    /// A point that cannot be evaluated.
    pub fn commit(
        &self,
        points: &[PointState],
        histories: &mut [PointHistory],
        law: LawNow,
        eps_t: f64,
    ) -> Result<(), Fault> {
        with_law!(law, law => {
            let friction = Friction { law, eps_t };
            match &self.body.own {
                None => self.accept(points, histories, &friction, &All),
                Some(own) => self.accept(points, histories, &friction, &self.opposing(own)),
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
            depth: self.body.depth,
        }
    }

    fn accept<F: FrictionLaw, A: Accept>(
        &self,
        points: &[PointState],
        histories: &mut [PointHistory],
        friction: &Friction<F>,
        accept: &A,
    ) -> Result<(), Fault> {
        let master = self.master();
        (histories.par_iter_mut().zip(points).enumerate())
            .with_min_len(32)
            .try_for_each(|(i, (history, point))| {
                let at = accept.point(i);
                let facet = |f| accept.facet(at, f);
                self.point(&master, i, point.hint, friction, history, facet)
            })
    }

    fn point<F: FrictionLaw>(
        &self,
        master: &MovingMaster<'_>,
        i: usize,
        mut hint: Option<Hint>,
        friction: &Friction<F>,
        history: &mut PointHistory,
        accept: impl Fn(u32) -> bool + Copy,
    ) -> Result<(), Fault> {
        let x = (self.model).point_position(&self.pair.points[i], self.u);
        let law = history.law(self.eps_n, self.offset(i));
        let touch = master
            .touch_with_friction(&x, &mut hint, &law, friction, history, &Reduced, accept)
            .map_err(|fault| Fault::Contact {
                pair: self.pair.name.clone(),
                point: i,
                at: [x.x, x.y, x.z],
                fault,
            })?;
        let Some(touch) = touch else {
            *history = self.open(master, i, &x, hint, history, accept);
            return Ok(());
        };
        let t = touch.response.slip.t;
        let slides = touch.response.slip.slides;
        if slides {
            // Of second order in the step. The tractions are along what is slid, at either end of it, but the one before
            // lies as the master lay then: its size alone does not ask how that has turned.
            let slid = touch.response.slid(friction.eps_t).norm();
            history.dissipated += 0.5 * (history.t.norm() + t.norm()) * slid;
            history.slip += slid;
        }
        if slides || history.approach > 0.0 || history.place.is_none() {
            set(history, master.attach(touch.foot, &x, &t));
        }
        history.approach = 0.0;
        history.status = match slides {
            true => PointStatus::Slip,
            false => PointStatus::Stick,
        };
        history.n = touch.n;
        history.t = t;
        Ok(())
    }

    /// History of an open point: slip is measured from where it is now, seen from the nearest facet, in the part of a step
    /// after it has touched.
    fn open(
        &self,
        master: &MovingMaster<'_>,
        i: usize,
        x: &Vec3,
        hint: Option<Hint>,
        before: &PointHistory,
        accept: impl Fn(u32) -> bool,
    ) -> PointHistory {
        let mut history = PointHistory {
            approach: f64::INFINITY,
            slip: before.slip,
            dissipated: before.dissipated,
            ..PointHistory::default()
        };
        if let Some(foot) = (master.facets).project(x, hint, f64::INFINITY, accept) {
            history.approach = (foot.signed_distance - self.offset(i)).max(0.0);
            set(&mut history, master.attach(foot.hint(), x, &Vec3::zeros()));
        }
        history
    }

    fn offset(&self, i: usize) -> f64 {
        (self.pair.offsets(self.time)).map_or(0.0, |o| o.at(i))
    }
}

/// Sets the attraction point; none where it could not be kept, and nothing pulls until it can.
fn set(history: &mut PointHistory, attached: Option<Attached>) {
    history.place = attached.map(|a| a.place);
    (history.base, history.lambda) = match attached {
        Some(a) => (a.base, a.lambda),
        None => (Vec3::zeros(), Vec3::zeros()),
    };
}
