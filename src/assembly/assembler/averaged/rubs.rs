//! The points of a pair with averaged gaps and friction, evaluated once the tractions of its nodes are known.
use super::super::sliding::Slides;
use super::super::touched;
use super::super::{Assembler, Fault};
use super::{Averaged, NEAR, facet};
use crate::contact::averaged::{self, GapRow};
use crate::contact::fault::PointFault;
use crate::contact::friction::given::{Drawn, GivenMoving, GivenRigid, Pressed};
use crate::contact::friction::history::PointHistory;
use crate::contact::friction::law::{FrictionLaw, Slip};
use crate::contact::friction::rigid::Friction;
use crate::contact::friction::scatter::PointNodes;
use crate::contact::friction::turning::Turning;
use crate::contact::law::PairLaw;
use crate::contact::meeting::Meeting;
use crate::contact::moving::MovingMaster;
use crate::contact::points::SlavePoint;
use crate::model::averaged::{Share, SlaveNodes};
use crate::model::friction::{LawNow, with_law};
use crate::model::state::heap;
use crate::model::{Model, PairModel};
use covact_geometry::{CurvedRows, Hint, ShapeRows};
use nalgebra::Isometry3;
use rayon::prelude::*;

/// A point that carries; nothing where it does not.
type Found<T> = Result<Option<T>, PointFault>;

/// The points of a pair at the state evaluated last: those that carry. One of the lists is empty, by the kind of the master.
#[derive(Default)]
pub(in crate::assembly::assembler) struct Rubs {
    pub(super) rigid: Vec<Found<GivenRigid>>,
    pub(super) moving: Vec<Found<GivenMoving>>,
    pub(super) nodes: PointNodes,
    pub(super) shape: CurvedRows,
    pub(super) anchor: ShapeRows,
    /// What a node's traction makes of the residual.
    pub(super) forces: GapRow,
}

impl Rubs {
    /// Bytes of heap for each point of a pair, and for all of it at the start; nothing where this is not for the pair.
    pub fn sizes(pair: &PairModel) -> Option<[usize; 2]> {
        (pair.averaged.as_ref()).and(pair.friction.as_ref())?;
        let point = match pair.body_master() {
            None => size_of::<Found<GivenRigid>>(),
            Some(_) => size_of::<Found<GivenMoving>>(),
        };
        Some([point, size_of::<Rubs>()])
    }

    /// Bytes of heap that it holds, and its own.
    pub fn bytes(&self) -> usize {
        let Rubs {
            rigid,
            moving,
            nodes: _,
            shape: _,
            anchor: _,
            forces,
        } = self;
        size_of::<Rubs>() + heap(rigid) + heap(moving) + forces.bytes()
    }

    /// Room for a pair; nothing without friction.
    pub fn new(pair: &PairModel) -> Option<Box<Self>> {
        pair.friction.as_ref()?;
        let points = pair.points.len();
        let mut out = Rubs::default();
        match pair.body_master() {
            None => out.rigid = vec![Ok(None); points],
            Some(_) => out.moving = vec![Ok(None); points],
        }
        Some(Box::new(out))
    }
}

/// The slave points of a pair at a state whose nodes are known.
struct Batch<'a> {
    model: &'a Model,
    pair: &'a PairModel,
    u: &'a [f64],
    own: &'a Averaged,
    eps_t: f64,
    slides: Slides,
}

impl Batch<'_> {
    /// Evaluates every point that carries.
    fn each<F: FrictionLaw, T: Send + Sync>(
        &self,
        law: F,
        histories: &[PointHistory],
        (found, slips): (&mut [Found<T>], &mut [Turning]),
        touch: impl Touching<T>,
        slip_of: impl Fn(&T) -> &Slip + Sync,
    ) {
        let Some(nodes) = &self.pair.averaged else {
            return;
        };
        let (own, small) = (self.own, NEAR * self.pair.element_size);
        let friction = Friction {
            law,
            eps_t: self.eps_t,
        };
        let drawn = Friction {
            law: Drawn,
            eps_t: self.eps_t,
        };
        (self.pair.points.par_iter())
            .zip(found.par_iter_mut())
            .zip(slips.par_iter_mut())
            .zip(histories)
            .enumerate()
            .with_min_len(32)
            .for_each(|(i, (((p, out), slip), history))| {
                let (true, Share::Gap(gap), Ok(Some(met))) =
                    (own.carries[i], own.shares[i], &own.met[i])
                else {
                    *out = Ok(None);
                    if self.slides.note {
                        slip.note(None);
                    }
                    return;
                };
                let lambda = own.traction(nodes, i, p);
                let pressed = Pressed {
                    x: &self.model.point_position(p, self.u),
                    geometry: &met.steady(small),
                    gap,
                    lambda,
                };
                let presses = lambda < 0.0;
                *out = match presses {
                    true => {
                        let secant = friction.sliding(self.slides.slide, slip);
                        touch.touch(&pressed, met, &secant, history)
                    }
                    false => touch.touch(&pressed, met, &drawn, history),
                }
                .map(Some);
                if self.slides.note {
                    slip.note(touched::of(out).filter(|_| presses).map(&slip_of));
                }
            });
    }
}

/// Evaluates a point on a kind of master, under any law.
trait Touching<T>: Sync {
    fn touch<F: FrictionLaw>(
        &self,
        pressed: &Pressed,
        met: &Meeting,
        friction: &Friction<F>,
        history: &PointHistory,
    ) -> Result<T, PointFault>;
}

impl Touching<GivenRigid> for Isometry3<f64> {
    fn touch<F: FrictionLaw>(
        &self,
        pressed: &Pressed,
        _met: &Meeting,
        friction: &Friction<F>,
        history: &PointHistory,
    ) -> Result<GivenRigid, PointFault> {
        Ok(pressed.on_rigid(self, friction, history))
    }
}

impl Touching<GivenMoving> for MovingMaster<'_> {
    fn touch<F: FrictionLaw>(
        &self,
        pressed: &Pressed,
        met: &Meeting,
        friction: &Friction<F>,
        history: &PointHistory,
    ) -> Result<GivenMoving, PointFault> {
        let foot = Hint {
            patch: facet(met).unwrap_or_default(),
            xi: met.xi,
        };
        pressed.on_body(self, foot, friction, history)
    }
}

impl Averaged {
    /// Bytes of heap that friction holds.
    pub fn rubs(&self) -> usize {
        self.rubbing.as_ref().map_or(0, |r| r.bytes())
    }

    /// Normal traction of a point.
    fn traction(&self, nodes: &SlaveNodes, i: usize, p: &SlavePoint) -> f64 {
        averaged::traction(nodes.terms(i, p).map(|(a, w)| (w, self.normals[a].n)))
    }

    /// Evaluates the points of a pair on a rigid master in this pose, once its nodes are known.
    pub(super) fn rub_rigid(
        &mut self,
        (model, pair, u): (&Model, &PairModel, &[f64]),
        pose: &Isometry3<f64>,
        (law, eps_t, slides): (LawNow, f64, Slides),
        histories: &[PointHistory],
        slips: &mut [Turning],
    ) {
        let Some(mut rubbing) = self.rubbing.take() else {
            return;
        };
        let batch = Batch {
            model,
            pair,
            u,
            own: self,
            eps_t,
            slides,
        };
        let found = (&mut rubbing.rigid[..], slips);
        with_law!(law, law => {
            batch.each(law, histories, found, *pose, |t: &GivenRigid| &t.touch.traction.slip);
        });
        self.rubbing = Some(rubbing);
    }

    /// Evaluates the points of a pair on faces of a body, once its nodes are known.
    ///
    /// # Errors
    /// That of the first point that has one.
    pub(super) fn rub_bodies(
        &mut self,
        (model, pair, u): (&Model, &PairModel, &[f64]),
        facets: &MovingMaster,
        (law, eps_t, slides): (LawNow, f64, Slides),
        histories: &[PointHistory],
        slips: &mut [Turning],
    ) -> Result<(), Fault> {
        let Some(mut rubbing) = self.rubbing.take() else {
            return Ok(());
        };
        let batch = Batch {
            model,
            pair,
            u,
            own: self,
            eps_t,
            slides,
        };
        let found = (&mut rubbing.moving[..], slips);
        with_law!(law, law => {
            batch.each(law, histories, found, *facets, |t: &GivenMoving| &t.touch.response.slip);
        });
        let fault =
            (rubbing.moving.iter().enumerate()).find_map(|(i, f)| Some((i, *f.as_ref().err()?)));
        self.rubbing = Some(rubbing);
        match fault {
            None => Ok(()),
            Some((i, fault)) => {
                let x = model.point_position(&pair.points[i], u);
                Err(Fault::contact(pair, i, &x, fault))
            }
        }
    }
}

impl<L: PairLaw> Assembler<'_, L> {
    /// The points of a pair with averaged gaps and friction at the state evaluated last; nothing for others.
    pub fn rubbed_points(&self, index: usize) -> Option<RubbedPoints<'_, L>> {
        let own = self.averaged.get(index)?;
        Some(RubbedPoints {
            own,
            rubbing: own.rubbing.as_ref()?,
            pair: &self.model.pairs[index],
            law: L::of(self.penalties[index]),
        })
    }
}

/// What slave points with averaged gaps and friction did at a state.
pub struct RubbedPoints<'a, L> {
    own: &'a Averaged,
    rubbing: &'a Rubs,
    pair: &'a PairModel,
    law: L,
}

impl<L: PairLaw> RubbedPoints<'_, L> {
    /// A point that is pressed against a rigid master.
    pub fn rigid(&self, point: usize) -> Option<&GivenRigid> {
        let found = touched::of(self.rubbing.rigid.get(point)?)?;
        (found.touch.touch.n < 0.0).then_some(found)
    }

    /// A point that is pressed against faces of a body.
    pub fn moving(&self, point: usize) -> Option<&GivenMoving> {
        let found = touched::of(self.rubbing.moving.get(point)?)?;
        (found.touch.n < 0.0).then_some(found)
    }

    /// What the law would make of a point that is pressed no more: the tractions of its nodes, those of open ones continued above the
    /// surface, zero at least (force / length^2).
    pub fn beyond(&self, point: usize) -> f64 {
        let Some(nodes) = &self.pair.averaged else {
            return 0.0;
        };
        let at = |a: usize| (self.own.gaps[a].gap()).map_or(0.0, |gap| self.law.response(gap).n);
        let terms = nodes.terms(point, &self.pair.points[point]);
        averaged::traction(terms.map(|(a, w)| (w, at(a)))).max(0.0)
    }
}
