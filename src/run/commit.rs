//! What slave points with history remember of a step that is accepted.
use crate::assembly::Fault;
use crate::contact::friction::history::{PointHistory, PointStatus};
use crate::contact::friction::law::FrictionLaw;
use crate::contact::friction::rigid::Friction;
use crate::contact::rigid::RigidMaster;
use crate::model::master::Master;
use crate::model::state::State;
use crate::model::surface::SurfaceSet;
use crate::model::{Model, PairModel};
use crate::with_law;
use covact_geometry::{Hint, Vec3};
use nalgebra::Point3;
use rayon::prelude::*;

/// Energies and counts of all points with history at an accepted step.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Sliding {
    /// Points that stick.
    pub stick: usize,
    /// Points that slide.
    pub slip: usize,
    /// Energy stored in the tangential penalties.
    pub stored: f64,
    /// Energy dissipated since the start.
    pub dissipated: f64,
}

/// Sets the points that slip is measured from, before anything has moved.
///
/// # Errors
/// A motion without a value at time 0.
pub fn start(model: &Model, state: &mut State) -> Result<(), Fault> {
    let mut first = 0;
    for (index, pair) in model.pairs.iter().enumerate() {
        let points = first..first + state.slaves(model, index).len();
        first = points.end;
        let (Some(range), Master::Rigid(surface)) = (pair.history(), &pair.master) else {
            continue;
        };
        let master = model.surfaces[*surface].at(0.0, &state.u)?;
        let offsets = pair.offsets(0.0);
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
            release(&master, &x, point.hint, z0, history);
        });
    }
    Ok(())
}

/// History of an open point: slip is measured from where it is now.
fn release(
    master: &RigidMaster<'_, SurfaceSet>,
    x: &Vec3,
    hint: Option<Hint>,
    z0: f64,
    history: &mut PointHistory,
) {
    let local = (master.pose.inverse_transform_point(&Point3::from(*x))).coords;
    let foot = master.foot(x, hint, f64::INFINITY);
    history.release(&local, foot.map(|f| f.signed_distance - z0));
}

/// Takes the state at the end of a step into the histories.
///
/// # Errors
/// A point that cannot be evaluated, or a motion or a coefficient without a value at `time`.
pub fn commit(
    model: &Model,
    penalties: &[f64],
    state: &mut State,
    time: f64,
) -> Result<Sliding, Fault> {
    let mut total = Sliding::default();
    let mut first = 0;
    for (index, pair) in model.pairs.iter().enumerate() {
        let points = first..first + state.slaves(model, index).len();
        first = points.end;
        let (Some(friction), Some(range)) = (&pair.friction, pair.history()) else {
            continue;
        };
        let Master::Rigid(surface) = pair.master else {
            continue;
        };
        let master = model.surfaces[surface].at(time, &state.u)?;
        let now = friction.law.at(time)?;
        let eps_n = penalties[index];
        let batch = Batch {
            model,
            pair,
            master,
            u: &state.u,
            time,
            eps_n,
        };
        let eps_t = friction.ratio * eps_n;
        let histories = &mut state.histories[range.clone()];
        let hints = &state.points[points];
        with_law!(now, law => {
            let friction = Friction { law, eps_t };
            (histories.par_iter_mut().zip(hints).enumerate())
                .with_min_len(64)
                .try_for_each(|(i, (history, point))| {
                    batch.accept(i, point.hint, &friction, history)
                })?;
        });
        for (history, p) in state.histories[range].iter().zip(&pair.points) {
            match history.status {
                PointStatus::Open => {}
                PointStatus::Stick => total.stick += 1,
                PointStatus::Slip => total.slip += 1,
            }
            total.stored += 0.5 * history.t.norm_squared() / eps_t * p.area;
            total.dissipated += history.dissipated * p.area;
        }
    }
    Ok(total)
}

/// The points of a pair with a rigid master at an accepted state.
struct Batch<'a> {
    model: &'a Model,
    pair: &'a PairModel,
    master: RigidMaster<'a, SurfaceSet>,
    u: &'a [f64],
    time: f64,
    eps_n: f64,
}

impl Batch<'_> {
    fn accept<F: FrictionLaw>(
        &self,
        i: usize,
        mut hint: Option<Hint>,
        friction: &Friction<F>,
        history: &mut PointHistory,
    ) -> Result<(), Fault> {
        let x = (self.model).point_position(&self.pair.points[i], self.u);
        let z0 = self.pair.offsets(self.time).map_or(0.0, |o| o.at(i));
        let law = history.law(self.eps_n, z0);
        let touch = (self.master)
            .touch_with_friction(&x, &mut hint, &law, friction, history)
            .map_err(|fault| Fault::Contact {
                pair: self.pair.name.clone(),
                point: i,
                at: [x.x, x.y, x.z],
                fault,
            })?;
        match touch {
            Some(touch) => {
                let turn = &self.master.pose.rotation;
                let (n, eps_t) = (touch.touch.n, friction.eps_t);
                history.accept(&touch.local, &touch.traction, n, eps_t, turn);
            }
            None => release(&self.master, &x, hint, z0, history),
        }
        Ok(())
    }
}
