//! What slave points with history remember of a step that is accepted.
mod averaged;
mod moving;
mod small;

use crate::assembly::{Assembler, Fault, PointAnswer};
use crate::contact::friction::history::{PointHistory, PointStatus, Turn};
use crate::contact::friction::law::FrictionLaw;
use crate::contact::friction::rigid::Friction;
use crate::contact::law::{NormalLaw, Offsets, PairLaw, Penalty};
use crate::contact::points::SlavePoint;
use crate::contact::rigid::RigidMaster;
use crate::model::friction::with_law;
use crate::model::master::{Master, Masters};
use crate::model::state::{PointState, State, slaves};
use crate::model::surface::SurfaceSet;
use crate::model::{Model, PairModel};
use covact_geometry::{Hint, Vec3};
use nalgebra::Point3;
use rayon::prelude::*;

/// Energies and counts of all points with history at an accepted step.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct FrictionTotals {
    /// Points that stick.
    pub stick: usize,
    /// Points that slide.
    pub slip: usize,
    /// Energy stored in the tangential penalties.
    pub stored: f64,
    /// Energy dissipated since the start.
    pub dissipated: f64,
    /// The part of what the last step dissipated that a trapezoid between the forces at its ends leaves out: [`PointHistory::sudden`].
    pub sudden: f64,
}

impl FrictionTotals {
    /// Adds the points of a pair, of whose energies `share` counts. With multipliers the tangential penalty carries only what
    /// `answers` say is elastic.
    pub(super) fn add(
        &mut self,
        histories: &[PointHistory],
        answers: Option<&[Option<PointAnswer>]>,
        points: &[SlavePoint],
        eps_t: f64,
        share: f64,
    ) {
        for (i, (history, p)) in histories.iter().zip(points).enumerate() {
            match history.status {
                PointStatus::Open => {}
                PointStatus::Stick => self.stick += 1,
                PointStatus::Slip => self.slip += 1,
            }
            let elastic = match answers {
                Some(answers) => answers[i].as_ref().map_or(0.0, |a| a.elastic),
                None => history.t.norm() / eps_t,
            };
            self.stored += 0.5 * share * eps_t * elastic.powi(2) * p.area;
            self.dissipated += share * history.dissipated * p.area;
            self.sudden += share * history.sudden * p.area;
        }
    }
}

/// Sets the points that slip is measured from, at a time at which contacts begin: those of the pairs that are told.
///
/// # Errors
/// A motion without a value at that time.
pub fn start(
    model: &Model,
    masters: &mut Masters,
    state: &mut State,
    (time, begins): (f64, &dyn Fn(usize) -> bool),
) -> Result<(), Fault> {
    if model.histories() == 0 {
        return Ok(());
    }
    if let Some(small) = &model.small {
        return small::start(model, small, state, (time, begins));
    }
    masters.update(model, &state.u);
    let mut first = 0;
    for (index, pair) in model.pairs.iter().enumerate() {
        let points = first..first + state.slaves(model, index).len();
        first = points.end;
        let (Some(range), Some(_), true) =
            (state.history(model, index), &pair.friction, begins(index))
        else {
            continue;
        };
        let Master::Rigid(surface) = &pair.master else {
            let slaves = slaves(&state.cuts, model, index);
            let at = (slaves, &state.u[..], time);
            let batch = moving::Batch::new(model, masters, index, at, Penalty::of(0.0));
            if let Some(batch) = batch {
                batch.start(&state.points[points], &mut state.histories[range]);
            }
            continue;
        };
        let master = model.surfaces[*surface].at(time, &state.u)?;
        let offsets = pair.offsets(time);
        let (u, hints) = (&state.u, &state.points[points]);
        (state.histories[range]
            .par_iter_mut()
            .zip(&pair.points)
            .zip(hints)
            .enumerate())
        .with_min_len(64)
        .for_each(|(i, ((history, p), point))| {
            let z0 = offsets.map_or(0.0, |o| o.at(i));
            let x = model.point_position(p, u);
            release(&master, (p, &x), point.hint, z0, history);
        });
    }
    Ok(())
}

/// History of an open point: slip is measured from where it is now.
fn release(
    master: &RigidMaster<'_, SurfaceSet>,
    (point, x): (&SlavePoint, &Vec3),
    hint: Option<Hint>,
    z0: f64,
    history: &mut PointHistory,
) {
    let local = (master.pose.inverse_transform_point(&Point3::from(*x))).coords;
    let foot = master.foot(x, hint, f64::INFINITY);
    let gap = foot.map(|f| master.gap(x, &f, z0, point.overhang(false)).0);
    history.release(&local, gap);
}

/// Takes the state at the end of a step, which began at time `start` with displacements `before`, into the histories.
///
/// # Errors
/// A point that cannot be evaluated, or a motion or a coefficient without a value at `time`.
pub fn commit<L: PairLaw>(
    model: &Model,
    assembler: &mut Assembler<L>,
    state: &mut State,
    (before, start): (&[f64], f64),
    time: f64,
) -> Result<FrictionTotals, Fault> {
    let mut total = FrictionTotals {
        dissipated: model.stage.as_ref().map_or(0.0, |s| s.start.dissipated),
        ..FrictionTotals::default()
    };
    if model.histories() == 0 {
        return Ok(total);
    }
    if let Some(small) = &model.small {
        let stiffness = (&assembler.penalties[..], &assembler.ratios[..]);
        small::commit(model, small, stiffness, state, (start, time), &mut total)?;
        return Ok(total);
    }
    assembler.masters.update(model, &state.u);
    let (masters, answers) = (&assembler.masters, assembler.answers());
    let (penalties, ratios) = (&assembler.penalties, &assembler.ratios);
    let mut first = 0;
    for (index, pair) in model.pairs.iter().enumerate() {
        let points = first..first + state.slaves(model, index).len();
        first = points.end;
        let Some(range) = state.history(model, index) else {
            continue;
        };
        let Some(friction) = &pair.friction else {
            press(&answers[range.clone()], &mut state.histories[range]);
            continue;
        };
        let (was, now) = (friction.law.at(start)?, friction.law.at(time)?);
        let limited = |trial: &Vec3, normal: &Vec3, pressure: f64, along: Option<&Vec3>| {
            with_law!(was, law => match along {
                None => law.slip(trial, normal, pressure).t,
                Some(e) => law.slip_along(trial, normal, pressure, e).0.t,
            })
        };
        let law_n = L::of(penalties[index]);
        let eps_t = ratios[index] * penalties[index];
        // What the tangential penalties carry beside the multipliers.
        let elastic = pair.augmentation.map(|_| &answers[range.clone()]);
        let rubbed = assembler.rubbed_points(index);
        let (hints, histories) = (&state.points[points], &mut state.histories[range]);
        match pair.master {
            Master::Rigid(surface) => {
                let master = model.surfaces[surface].at(time, &state.u)?;
                let batch = Batch {
                    model,
                    pair,
                    turn: Turn {
                        start: model.surfaces[surface].at(start, before)?.pose.rotation,
                        end: master.pose.rotation,
                    },
                    master,
                    u: &state.u,
                    offsets: pair.offsets(time),
                    law: law_n,
                };
                if let Some(rubbed) = &rubbed {
                    batch.rubbed(hints, histories, eps_t, &limited, rubbed);
                } else {
                    with_law!(now, law => {
                    let friction = Friction { law, eps_t };
                    (histories.par_iter_mut().zip(hints).enumerate())
                        .with_min_len(64)
                        .try_for_each(|(i, (history, point))| {
                            batch.accept(i, point, &friction, &limited, history)
                        })?;
                    });
                }
            }
            Master::Body(_) => {
                let at = (slaves(&state.cuts, model, index), &state.u[..], time);
                let batch = moving::Batch::new(model, masters, index, at, law_n);
                if let Some(batch) = batch {
                    batch.commit(hints, histories, (now, eps_t), &limited, rubbed.as_ref())?;
                }
            }
        }
        let slaves = slaves(&state.cuts, model, index);
        total.add(histories, elastic, slaves, eps_t, pair.share());
    }
    Ok(total)
}

/// The traction that a law allows for a trial traction, a normal, a pressure, and the direction of a master that deforms.
trait Limited: Fn(&Vec3, &Vec3, f64, Option<&Vec3>) -> Vec3 + Sync {}
impl<F: Fn(&Vec3, &Vec3, f64, Option<&Vec3>) -> Vec3 + Sync> Limited for F {}

/// Points without friction take their tractions as multipliers into the next step.
fn press(answers: &[Option<PointAnswer>], histories: &mut [PointHistory]) {
    for (history, answer) in histories.iter_mut().zip(answers) {
        *history = match answer {
            Some(answer) => PointHistory {
                lambda_n: answer.n,
                n: answer.n,
                status: PointStatus::Stick,
                ..PointHistory::default()
            },
            None => PointHistory::default(),
        };
    }
}

/// The points of a pair with a rigid master at an accepted state.
struct Batch<'a, L> {
    model: &'a Model,
    pair: &'a PairModel,
    master: RigidMaster<'a, SurfaceSet>,
    turn: Turn,
    u: &'a [f64],
    offsets: Option<Offsets<'a>>,
    law: L,
}

impl<L: PairLaw> Batch<'_, L> {
    /// `limited` is the traction that the law allowed at the start of the step, for a trial traction, a normal and a
    /// pressure.
    fn accept<F: FrictionLaw>(
        &self,
        i: usize,
        state: &PointState,
        friction: &Friction<F>,
        limited: &impl Limited,
        history: &mut PointHistory,
    ) -> Result<(), Fault> {
        let (mut hint, point) = (state.hint, &self.pair.points[i]);
        let x = (self.model).point_position(point, self.u);
        let z0 = self.offsets.map_or(0.0, |o| o.at(i));
        let law = history.law(self.law, z0);
        let touch = (self.master)
            .touch_with_friction(
                &x,
                (&mut hint, point.overhang(state.closed)),
                &law,
                friction,
                history,
            )
            .map_err(|fault| Fault::contact(self.pair, i, &x, fault))?;
        match touch {
            Some(touch) => {
                let turn = &self.turn;
                let (n, eps_t) = (touch.touch.n, friction.eps_t);
                let first = limited(&touch.traction.trial, &touch.normal, -history.n, None);
                let (local, traction) = (&touch.local, &touch.traction);
                match self.pair.augmentation {
                    None => history.accept(local, traction, &first, n, eps_t, turn),
                    Some(_) => history.accept_augmented(local, traction, &first, n, eps_t, turn),
                }
            }
            None => self.leave(i, hint, &self.law, friction.eps_t, history),
        }
        Ok(())
    }

    /// History of a point that touches no more, under the law that its traction would have.
    fn leave(
        &self,
        i: usize,
        hint: Option<Hint>,
        law: &impl NormalLaw,
        eps_t: f64,
        history: &mut PointHistory,
    ) {
        let point = &self.pair.points[i];
        let x = (self.model).point_position(point, self.u);
        let z0 = self.offsets.map_or(0.0, |o| o.at(i));
        let local = (self.master.pose.inverse_transform_point(&Point3::from(x))).coords;
        let foot = self.master.foot(&x, hint, f64::INFINITY);
        let foot = foot.map(|f| self.master.gap(&x, &f, z0, point.overhang(false)));
        history.leave(&local, foot, law, eps_t, &self.turn);
    }
}
