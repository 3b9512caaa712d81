//! Contact with rigid surfaces: the slave points of a pair are evaluated in parallel and summed in order.
use super::answer::PointAnswer;
use super::maps::PointMaps;
use super::pressed::{Pressed, PressedSums};
use super::sliding::Slides;
use super::{Assembler, Fault, Linearization, PairForce, SurfaceForce, Totals, touched};
use crate::contact::clearance::Clearance;
use crate::contact::closest::ClosestPoint;
use crate::contact::friction::history::PointHistory;
use crate::contact::friction::law::{FrictionLaw, Slide};
use crate::contact::friction::rigid::{Friction, FrictionTouch};
use crate::contact::friction::turning::Turning;
use crate::contact::kind::{FrictionKind, LawKind, TangentKind};
use crate::contact::law::{
    Augmented, Held, Multipliers, NoOffset, NormalLaw, Offsets, PairLaw, PointLaw,
};
use crate::contact::points::SlavePoint;
use crate::contact::rigid::{Exact, PointFault, RigidMaster, RigidTangent, Touch};
use crate::model::friction::with_law;
use crate::model::kernel::{GapKind, Kernel, SideKind};
use crate::model::master::Master;
use crate::model::state::{PointState, State};
use crate::model::surface::with_patches;
use crate::model::{Model, PairModel};
use covact_geometry::Vec3;
use rayon::prelude::*;

/// Most points of a pair that are evaluated at once.
pub(super) fn most(model: &Model) -> usize {
    if model.small.is_some() {
        return 0;
    }
    let rigid = (model.pairs.iter()).filter(|p| p.rigid_master().is_some() && p.averaged.is_none());
    rigid.map(|p| p.points.len()).max().unwrap_or(0)
}

/// Points of all pairs that are evaluated here, whose clearances are known.
pub(super) fn cleared(model: &Model) -> usize {
    if model.small.is_some() {
        return 0;
    }
    let rigid = (model.pairs.iter()).filter(|p| p.rigid_master().is_some() && p.averaged.is_none());
    rigid.map(|p| p.points.len()).sum()
}

impl<L: PairLaw> Assembler<'_, L> {
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
        let (mut first, mut known) = (0, 0);
        for (index, pair) in self.model.pairs.iter().enumerate() {
            let kernel = self.model.kernel(index);
            if kernel.gap == GapKind::Averaged {
                let n = pair.points.len();
                self.meet_rigid::<TANGENT>(index, first, state, time)?;
                self.average::<TANGENT>(
                    index, first, state, time, increments, residual, rhs, totals,
                )?;
                first += n;
                continue;
            }
            let Master::Rigid(number) = pair.master else {
                let count = state.slaves(self.model, index).len();
                let range = first..first + count;
                self.moving::<TANGENT>(
                    index, state, range, time, increments, residual, rhs, totals,
                );
                first += count;
                continue;
            };
            let surface = &self.model.surfaces[number];
            let master = surface.at(time, &state.u)?;
            let n = pair.points.len();
            let remembered = state.history(self.model, index);
            let points = &mut state.points[first..first + n];
            let Linearization {
                keep_active: hold,
                slide,
                keep_facets: keep,
            } = self.linearization;
            self.held.clear();
            if hold && pair.friction.is_none() {
                self.held.extend(points.iter().map(|p| p.closed));
            }
            let touches = &mut self.touches[..n];
            let clear = &mut self.clearances[known..known + n];
            known += n;
            let u = &state.u;
            let law = L::of(self.penalties[index]);
            let friction = match (&pair.friction, remembered.clone()) {
                (Some(friction), Some(range)) => Some((
                    friction.law.at(time)?,
                    self.ratios[index] * self.penalties[index],
                    &state.histories[range],
                )),
                _ => None,
            };
            let (friction_kind, (law_kind, tangent_kind)) = with_patches!(master.surface, patches => {
                let batch = Batch {
                    model: self.model,
                    pair,
                    master: &RigidMaster {
                        surface: patches,
                        pose: master.pose,
                        depth: master.depth,
                        keep,
                    },
                    law: &law,
                    kernel: &kernel,
                    u,
                };
                let offsets = pair.offsets(time);
                match (kernel.law, &friction) {
                    (_, None) if hold => {
                        let augmented = remembered.filter(|_| pair.augmentation.is_some());
                        let histories = &state.histories[augmented.unwrap_or(0..0)];
                        let held = Held { held: &self.held, histories, offsets };
                        (FrictionKind::None, batch.choose(points, clear, touches, &held))
                    }
                    (LawKind::Multipliers, None) => {
                        let histories = &state.histories[remembered.clone().unwrap_or(0..0)];
                        let multipliers = Multipliers { histories, offsets };
                        let ran = batch.choose(points, clear, touches, &multipliers);
                        let answers = &mut self.answers[remembered.clone().unwrap_or(0..0)];
                        for (answer, touch) in answers.iter_mut().zip(touches.iter()) {
                            *answer = touched::of(touch)
                                .map(|t| PointAnswer::without_friction(t.n, t.gap));
                        }
                        (FrictionKind::None, ran)
                    }
                    (LawKind::Offset, None) => {
                        let offsets = offsets.unwrap_or_default();
                        (FrictionKind::None, batch.choose(points, clear, touches, &offsets))
                    }
                    (LawKind::Penalty | LawKind::Held, None) => {
                        (FrictionKind::None, batch.choose(points, clear, touches, &NoOffset))
                    }
                    (planned, Some((now, eps_t, histories))) => with_law!(*now, law => {
                        let friction = Friction { law, eps_t: *eps_t };
                        let slips = &mut self.slips[remembered.clone().unwrap_or(0..0)];
                        let slips = (slips, Slides {
                            slide,
                            note: TANGENT && slide != Slide::Stick && planned != LawKind::Multipliers,
                        });
                        let ran = match planned {
                            LawKind::Multipliers => {
                                let told = &mut self.answers[remembered.clone().unwrap_or(0..0)];
                                let (s, c, t) = (&mut *points, &mut *clear, &mut *touches);
                                batch.slide(s, c, t, told, slips, &friction, histories, offsets, hold)
                            }
                            _ => {
                                let told = &mut vec![(); n][..];
                                let (s, c, t) = (&mut *points, &mut *clear, &mut *touches);
                                batch.slide(s, c, t, told, slips, &friction, histories, offsets, hold)
                            }
                        };
                        (now.kind(), ran)
                    }),
                }
            });
            if law_kind != LawKind::Held {
                self.ran[index] = Some(Kernel {
                    gap: GapKind::Pointwise,
                    master: surface.kind(),
                    law: law_kind,
                    friction: friction_kind,
                    tangent: tangent_kind,
                    sides: SideKind::Both,
                });
            }
            let none = PointMaps::default();
            let mut pressed = Pressed {
                law,
                residual,
                contact: &mut self.contact,
                matrix: &mut self.matrix,
                maps: self.point_maps.get(index).unwrap_or(&none),
                dofs: self.dofs,
                work: &mut self.work,
                increments,
                rhs,
                sums: PressedSums::default(),
                model: self.model,
                u,
            };
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
                totals.opened += usize::from(state.closed && touch.is_none());
                state.closed = touch.is_some();
                let Some(touch) = touch else { continue };
                totals.contact_rounding += rounding(&law, touch.gap, p, &touch.x);
                pressed.add::<TANGENT>(i, p, touch);
            }
            pressed.sums.note(number, totals);
            first += n;
            if surface.driven.is_some() {
                self.carry::<TANGENT>(index, &state.u, time)?;
            }
        }
        self.close_borders::<TANGENT>((&state.u, time), increments, residual, rhs)?;
        totals.contact_rounding = totals.contact_rounding.sqrt();
        totals.contact_norm = self.contact.iter().map(|f| f * f).sum::<f64>().sqrt();
        Ok(())
    }
}

/// What a point in contact adds to the square of [`Totals::contact_rounding`]. A gap is a difference of positions, whose
/// digits end at theirs, however small the displacements are.
pub(super) fn rounding(law: &impl NormalLaw, gap: f64, p: &SlavePoint, x: &Vec3) -> f64 {
    (law.response(gap).dn * p.area * f64::EPSILON * x.norm()).powi(2)
}

/// The slave points of a pair at one trial state.
struct Batch<'a, P, L> {
    model: &'a Model,
    pair: &'a PairModel,
    master: &'a RigidMaster<'a, P>,
    law: &'a L,
    kernel: &'a Kernel,
    u: &'a [f64],
}

/// What is told of a point with friction: a type, so that without augmentation nothing is.
trait Told: Send {
    const LAW: Option<LawKind>;
    fn tell(&mut self, touch: Option<&FrictionTouch>, history: &PointHistory, eps_t: f64);
}

impl Told for () {
    const LAW: Option<LawKind> = None;
    #[inline]
    fn tell(&mut self, _: Option<&FrictionTouch>, _: &PointHistory, _: f64) {}
}

impl Told for Option<PointAnswer> {
    const LAW: Option<LawKind> = Some(LawKind::Multipliers);
    #[inline]
    fn tell(&mut self, touch: Option<&FrictionTouch>, history: &PointHistory, eps_t: f64) {
        *self = touch.map(|t| PointAnswer::with_friction(t, history, eps_t));
    }
}

impl<P: ClosestPoint, L: PairLaw> Batch<'_, P, L> {
    /// Evaluates every point with friction; surface, law of friction and what is told are types here. `hold` keeps closed
    /// points closed. Returns what was run.
    #[allow(clippy::too_many_arguments)]
    fn slide<F: FrictionLaw, A: Told>(
        &self,
        states: &mut [PointState],
        clear: &mut [Clearance],
        touches: &mut [Result<Option<Touch>, PointFault>],
        answers: &mut [A],
        (slips, slides): (&mut [Turning], Slides),
        friction: &Friction<F>,
        histories: &[PointHistory],
        offsets: Option<Offsets>,
        hold: bool,
    ) -> (LawKind, TangentKind) {
        let placed = self.master.placed();
        (self.pair.points.par_iter())
            .zip(states.par_iter_mut())
            .zip(clear.par_iter_mut())
            .zip(touches.par_iter_mut())
            .zip(answers.par_iter_mut())
            .zip(slips.par_iter_mut())
            .zip(histories)
            .enumerate()
            .with_min_len(64)
            .for_each(|(i, ((((((p, s), clear), out), answer), slip), history))| {
                let x = self.model.position_of(p, self.u);
                let law = Augmented {
                    held: hold && s.closed,
                    ..history.law(*self.law, offsets.map_or(0.0, |o| o.at(i)))
                };
                let secant = friction.sliding(slides.slide, slip);
                let touch = placed.touch_with_friction(
                    &x,
                    (&mut s.hint, clear, p.overhang(s.closed)),
                    &law,
                    &secant,
                    history,
                );
                if slides.note {
                    slip.note(touched::of(&touch).map(|t| &t.traction.slip));
                }
                answer.tell(touched::of(&touch), history, friction.eps_t);
                *out = touch.map(|t| t.map(|t| t.touch));
            });
        let law = match (hold, A::LAW, offsets) {
            (true, ..) => LawKind::Held,
            (_, Some(law), _) => law,
            (_, None, Some(_)) => LawKind::Offset,
            (_, None, None) => LawKind::Penalty,
        };
        (law, TangentKind::Exact)
    }
}

impl<P: ClosestPoint, L: PairLaw> Batch<'_, P, L> {
    /// Evaluates every point with the tangent that the plan names. Returns what was run.
    fn choose<O: PointLaw>(
        &self,
        states: &mut [PointState],
        clear: &mut [Clearance],
        touches: &mut [Result<Option<Touch>, PointFault>],
        offset: &O,
    ) -> (LawKind, TangentKind) {
        match self.kernel.tangent {
            TangentKind::Exact => self.evaluate(states, clear, touches, &Exact, offset),
            TangentKind::Published(parts) => self.evaluate(states, clear, touches, &parts, offset),
        }
    }

    /// Evaluates every point; surface, law, tangent and offset are types here, nothing is chosen inside the loop.
    fn evaluate<T: RigidTangent, O: PointLaw>(
        &self,
        states: &mut [PointState],
        clear: &mut [Clearance],
        touches: &mut [Result<Option<Touch>, PointFault>],
        tangent: &T,
        offset: &O,
    ) -> (LawKind, TangentKind) {
        let placed = self.master.placed();
        (self.pair.points.par_iter())
            .zip(states.par_iter_mut())
            .zip(touches.par_iter_mut())
            .zip(clear.par_iter_mut())
            .enumerate()
            .with_min_len(64)
            .for_each(|(i, (((p, s), out), clear))| {
                let x = self.model.position_of(p, self.u);
                let law = offset.law(i, self.law);
                placed.touch_into(
                    &x,
                    (&mut s.hint, clear, p.overhang(s.closed)),
                    &law,
                    tangent,
                    out,
                );
            });
        (O::KIND, tangent.kind())
    }
}
