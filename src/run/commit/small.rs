//! Slave points with friction at small displacements: slip is measured by displacements relative to the master, in space, and
//! normals are those of the start.
use super::FrictionTotals;
use crate::assembly::Fault;
use crate::contact::friction::history::Turn;
use crate::contact::friction::law::FrictionLaw;
use crate::contact::friction::rigid::Friction;
use crate::contact::friction::steady::Directed;
use crate::contact::law::{NormalLaw, Penalty};
use crate::model::Model;
use crate::model::friction::with_law;
use crate::model::small::SmallModel;
use crate::model::state::State;
use rayon::prelude::*;

/// Sets the displacements that slip is measured from, at a time at which contacts begin: those of the pairs that are told.
///
/// # Errors
/// A motion without a value at that time.
pub(super) fn start(
    model: &Model,
    small: &SmallModel,
    state: &mut State,
    (time, begins): (f64, &dyn Fn(usize) -> bool),
) -> Result<(), Fault> {
    for (index, (pair, own)) in model.pairs.iter().zip(&small.pairs).enumerate() {
        let (Some(range), Some(_), true) =
            (state.history(model, index), &pair.friction, begins(index))
        else {
            continue;
        };
        let motion = model.small_motion(pair, time)?;
        let offsets = pair.offsets(time);
        for (i, history) in state.histories[range].iter_mut().enumerate() {
            let Some(at) = &own.points[i] else { continue };
            let w = own.slip(i, at, &pair.points[i], motion.as_ref(), &state.u);
            let gap = at.gap - offsets.map_or(0.0, |o| o.at(i)) + at.normal.dot(&w);
            history.release(&w, Some(gap));
        }
    }
    Ok(())
}

/// Takes the end of a step into the histories, and adds up what friction did in it.
///
/// # Errors
/// A motion or a coefficient without a value at either time.
pub(super) fn commit(
    model: &Model,
    small: &SmallModel,
    (penalties, ratios): (&[f64], &[f64]),
    state: &mut State,
    (start, time): (f64, f64),
    total: &mut FrictionTotals,
) -> Result<(), Fault> {
    let mut first = 0;
    for (index, (pair, own)) in model.pairs.iter().zip(&small.pairs).enumerate() {
        let points = first..first + pair.points.len();
        first = points.end;
        let (Some(range), Some(friction)) = (state.history(model, index), &pair.friction) else {
            continue;
        };
        let law_n = Penalty {
            eps_n: penalties[index],
        };
        let eps_t = ratios[index] * penalties[index];
        let motion = model.small_motion(pair, time)?;
        let offsets = pair.offsets(time);
        let pose = model.small_pose(pair)?;
        let (was, now) = (friction.law.at(start)?, friction.law.at(time)?);
        let (u, states) = (&state.u, &state.points[points]);
        let histories = &mut state.histories[range];
        with_law!(was, was => {
            let was = Directed::new(was, |e| pose * e);
            with_law!(now, now => {
                let law = Directed::new(now, |e| pose * e);
                let friction = Friction { law, eps_t };
                (histories.par_iter_mut().zip(states).enumerate())
                    .with_min_len(64)
                    .for_each(|(i, (history, point))| {
                        let Some(at) = &own.points[i] else { return };
                        let still = Turn::none();
                        let w = own.slip(i, at, &pair.points[i], motion.as_ref(), u);
                        // The same digits as those of the evaluation that converged.
                        let approach = own.approach(i, at, &pair.points[i], motion.as_ref(), u);
                        let gap = at.gap - offsets.map_or(0.0, |o| o.at(i)) + approach;
                        if !(point.closed && gap < 0.0) {
                            history.leave(&w, Some((gap, at.normal)), &law_n, eps_t, &still);
                            return;
                        }
                        let normal = law_n.response(gap);
                        let traction = friction.steady(history, &w, &at.normal, gap, &normal);
                        let first = was.slip(&traction.trial, &at.normal, -history.n).t;
                        history.accept(&w, &traction, &first, normal.n, eps_t, &still);
                    });
            });
        });
        total.add(histories, None, &pair.points, eps_t, pair.share());
    }
    Ok(())
}
