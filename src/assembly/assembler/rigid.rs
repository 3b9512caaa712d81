//! Contact with rigid surfaces: the slave points of a pair are evaluated in parallel and summed in order.
use super::answer::PointAnswer;
use super::pressed::{Pressed, PressedSums};
use super::{Assembler, Fault, Manner, PairForce, SurfaceForce, Totals, touched};
use crate::contact::closest::ClosestPoint;
use crate::contact::friction::history::PointHistory;
use crate::contact::friction::law::{FrictionLaw, Secant};
use crate::contact::friction::rigid::Friction;
use crate::contact::law::{
    Augmented, GapOffset, Held, Multipliers, NoOffset, NormalLaw, Offsets, Penalty,
};
use crate::contact::published::Parts;
use crate::contact::rigid::{Exact, PointFault, RigidMaster, RigidTangent, Touch};
use crate::model::master::Master;
use crate::model::state::{PointState, State};
use crate::model::{Model, PairModel};
use crate::scene::Tangent;
use crate::{with_law, with_patches};
use rayon::prelude::*;

impl Assembler<'_> {
    pub(super) fn contacts<const TANGENT: bool>(
        &mut self,
        state: &mut State,
        time: f64,
        increments: Option<&[f64]>,
        residual: &mut [f64],
        rhs: &mut [f64],
        totals: &mut Totals,
    ) -> Result<(), Fault> {
        totals.surfaces = vec![SurfaceForce::default(); self.model.surfaces.len()];
        totals.pairs = vec![PairForce::default(); self.model.pairs.len()];
        self.contact.fill(0.0);
        self.clear_borders();
        let (mut first, mut rounding) = (0, 0.0);
        for (index, pair) in self.model.pairs.iter().enumerate() {
            if pair.averaged.is_some() {
                let n = pair.points.len();
                self.meet_rigid(index, &state.u, time, &mut state.points[first..first + n])?;
                self.average::<TANGENT>(
                    index, first, state, time, increments, residual, rhs, totals,
                )?;
                self.rounding(state, index, first, &mut rounding);
                first += n;
                continue;
            }
            let Master::Rigid(number) = pair.master else {
                let count = state.slaves(self.model, index).len();
                let range = first..first + count;
                self.moving::<TANGENT>(
                    index, state, range, time, increments, residual, rhs, totals,
                );
                self.rounding(state, index, first, &mut rounding);
                first += count;
                continue;
            };
            let surface = &self.model.surfaces[number];
            let master = surface.at(time, &state.u)?;
            let n = pair.points.len();
            let points = &mut state.points[first..first + n];
            let Manner { hold, secant } = self.manner;
            // A surface driven by force follows the points as they are.
            let hold = hold && surface.driven.is_none();
            self.held.clear();
            if hold && pair.friction.is_none() {
                self.held.extend(points.iter().map(|p| p.closed));
            }
            let touches = &mut self.touches[..n];
            let u = &state.u;
            let law = Penalty {
                eps_n: self.penalties[index],
            };
            let friction = match (&pair.friction, pair.history()) {
                (Some(friction), Some(range)) => Some((
                    friction.law.at(time)?,
                    friction.ratio * law.eps_n,
                    &state.histories[range],
                )),
                _ => None,
            };
            with_patches!(master.surface, patches => {
                let batch = Batch {
                    model: self.model,
                    pair,
                    master: &RigidMaster {
                        surface: patches,
                        pose: master.pose,
                        depth: master.depth,
                    },
                    law: &law,
                    u,
                };
                match (pair.offsets(time), &friction) {
                    (offsets, None) if hold => {
                        let augmented = pair.history().filter(|_| pair.augmentation.is_some());
                        let histories = &state.histories[augmented.unwrap_or(0..0)];
                        let held = Held { held: &self.held, histories, offsets };
                        batch.choose(points, touches, &held);
                    }
                    (offsets, None) if pair.augmentation.is_some() => {
                        let histories = &state.histories[pair.history().unwrap_or(0..0)];
                        let multipliers = Multipliers { histories, offsets };
                        batch.choose(points, touches, &multipliers);
                        let answers = &mut self.answers[pair.history().unwrap_or(0..0)];
                        for (answer, touch) in answers.iter_mut().zip(touches.iter()) {
                            *answer = touched::of(touch)
                                .map(|t| PointAnswer::without_friction(t.n, t.gap));
                        }
                    }
                    (None, None) => batch.choose(points, touches, &NoOffset),
                    (Some(over), None) => batch.choose(points, touches, &over),
                    (over, Some((now, eps_t, histories))) => with_law!(*now, law => {
                        let law = Secant { law, on: secant };
                        let friction = Friction { law, eps_t: *eps_t };
                        let answers = &mut self.answers[pair.history().unwrap_or(0..0)];
                        batch.slide(points, touches, answers, &friction, histories, over, hold)
                    }),
                }
            });
            let mut pressed = Pressed {
                eps_n: law.eps_n,
                residual,
                contact: &mut self.contact,
                matrix: &mut self.matrix,
                maps: &self.point_maps[index],
                dofs: self.dofs,
                work: &mut self.work,
                increments,
                rhs,
                sums: PressedSums::default(),
            };
            let may_open = surface.driven.is_none();
            let each = pair.points.iter().zip(touches.iter()).zip(points);
            for (i, ((p, touch), state)) in each.enumerate() {
                let touch = match touch {
                    Err(fault) => {
                        let x = self.model.point_position(p, u);
                        return Err(Fault::contact(pair, i, &x, *fault));
                    }
                    Ok(touch) => touch,
                };
                totals.changed += usize::from(touch.is_some() != state.closed);
                totals.opened += usize::from(state.closed && touch.is_none() && may_open);
                state.closed = touch.is_some();
                let Some(touch) = touch else { continue };
                rounding += (law.eps_n * p.area * f64::EPSILON * touch.x.norm()).powi(2);
                pressed.add::<TANGENT>(i, p, touch);
            }
            pressed.sums.note(number, totals);
            first += n;
            if surface.driven.is_some() {
                self.carry::<TANGENT>(index, &state.u, time)?;
            }
        }
        self.close_borders::<TANGENT>(&state.u, increments, residual, rhs)?;
        totals.contact_rounding = rounding.sqrt();
        totals.contact_norm = self.contact.iter().map(|f| f * f).sum::<f64>().sqrt();
        Ok(())
    }

    /// What a pair adds to the square of [`Totals::contact_rounding`]. A gap is a difference of positions, whose digits end at
    /// theirs, however small the displacements are.
    fn rounding(&self, state: &State, index: usize, first: usize, sum: &mut f64) {
        let eps = self.penalties[index];
        let slaves = state.slaves(self.model, index);
        let points = &state.points[first..first + slaves.len()];
        for (p, _) in slaves.iter().zip(points).filter(|(_, s)| s.closed) {
            let x = self.model.point_position(p, &state.u).norm();
            *sum += (eps * p.area * f64::EPSILON * x).powi(2);
        }
    }
}

/// The slave points of a pair at one trial state.
struct Batch<'a, P, L> {
    model: &'a Model,
    pair: &'a PairModel,
    master: &'a RigidMaster<'a, P>,
    law: &'a L,
    u: &'a [f64],
}

impl<P: ClosestPoint> Batch<'_, P, Penalty> {
    /// Evaluates every point with friction; surface and law of friction are types here. `hold` keeps closed points closed.
    #[allow(clippy::too_many_arguments)]
    fn slide<F: FrictionLaw>(
        &self,
        states: &mut [PointState],
        touches: &mut [Result<Option<Touch>, PointFault>],
        answers: &mut [Option<PointAnswer>],
        friction: &Friction<F>,
        histories: &[PointHistory],
        offsets: Option<Offsets>,
        hold: bool,
    ) {
        let augmented = self.pair.augmentation.is_some();
        let placed = self.master.placed();
        (self.pair.points.par_iter())
            .zip(states.par_iter_mut())
            .zip(touches.par_iter_mut())
            .zip(answers.par_iter_mut())
            .zip(histories)
            .enumerate()
            .with_min_len(64)
            .for_each(|(i, ((((p, s), out), answer), history))| {
                let x = self.model.position_of(p, self.u);
                let law = Augmented {
                    held: hold && s.closed,
                    ..history.law(self.law.eps_n, offsets.map_or(0.0, |o| o.at(i)))
                };
                let touch = placed.touch_with_friction(&x, &mut s.hint, &law, friction, history);
                if augmented {
                    *answer = touched::of(&touch)
                        .map(|t| PointAnswer::with_friction(t, history, friction.eps_t));
                }
                *out = touch.map(|t| t.map(|t| t.touch));
            });
    }
}

impl<P: ClosestPoint, L: NormalLaw + Copy> Batch<'_, P, L> {
    /// Evaluates every point with the tangent that the pair asks for.
    fn choose<O: GapOffset>(
        &self,
        states: &mut [PointState],
        touches: &mut [Result<Option<Touch>, PointFault>],
        offset: &O,
    ) {
        match self.pair.tangent {
            Tangent::Exact => self.evaluate(states, touches, &Exact, offset),
            Tangent::Published {
                rotational,
                curvature,
            } => {
                let parts = Parts {
                    rotational,
                    curvature,
                };
                self.evaluate(states, touches, &parts, offset)
            }
        }
    }

    /// Evaluates every point; surface, law, tangent and offset are types here, nothing is chosen inside the loop.
    fn evaluate<T: RigidTangent, O: GapOffset>(
        &self,
        states: &mut [PointState],
        touches: &mut [Result<Option<Touch>, PointFault>],
        tangent: &T,
        offset: &O,
    ) {
        let placed = self.master.placed();
        (self.pair.points.par_iter())
            .zip(states.par_iter_mut())
            .zip(touches.par_iter_mut())
            .enumerate()
            .with_min_len(64)
            .for_each(|(i, ((p, s), out))| {
                let x = self.model.position_of(p, self.u);
                let law = offset.law(i, self.law);
                placed.touch_into(&x, &mut s.hint, &law, tangent, out);
            });
    }
}
