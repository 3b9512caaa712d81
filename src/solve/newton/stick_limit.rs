//! What friction would be if points that stick did not give way.
//!
//! A tangential penalty lets a point that sticks creep by its elastic slip, and carries the less the softer it is. To first order a
//! stiffer one adds the tractions of that slip, which change the displacements by `K du = -f(t)`, and friction by `f(t)` and by
//! what `du` makes of it: what the bodies do not follow is missing. Penalty and bodies are two springs in series, whose stiffnesses
//! tell the whole of it. What is measured is the elastic slip of the step: what earlier steps have not carried stays missing as long as
//! points stick. Points that slide have their traction from the pressure, whatever the penalty is, and add
//! nothing.
use super::Workspace;
use super::rigid_limit::{PART, force, place};
use crate::assembly::{Assembler, Fault, SurfaceForce};
use crate::contact::friction::history::PointHistory;
use crate::model::state::State;
use crate::model::{Model, PairModel};
use crate::system::linear::LinearSolver;
use covact_geometry::Vec3;

impl Workspace {
    /// Change of the friction of every pair from its tangential penalty to rigid sticking: of its resultant, or of its moment about
    /// the middle of the slave points over their mean distance from it (force), of the step that was just solved for, as [`Workspace::rigid_limit`]; nothing where the linear solver
    /// cannot, or contact has no value beside the state.
    ///
    /// # Errors
    /// A point that cannot be evaluated at the state itself.
    pub fn stick_limits<S: LinearSolver + ?Sized>(
        &mut self,
        model: &Model,
        assembler: &mut Assembler,
        solver: &mut S,
        (state, histories): (&State, &[PointHistory]),
        time: f64,
    ) -> Result<Option<Vec<f64>>, Fault> {
        if model.small.is_some() || assembler.has_new_pattern() || !self.factored {
            return Ok(None);
        }
        let base = &mut self.base;
        base.cuts.clone_from(&state.cuts);
        base.histories.copy_from_slice(histories);
        place(base, state);
        let ratios = assembler.ratios.clone();
        let found: Result<Vec<f64>, ()> = (model.pairs.iter().enumerate())
            .map(|(index, pair)| match pair.friction {
                Some(_) => {
                    let limit = self.stick_limit(model, assembler, solver, (state, index), time);
                    assembler.ratios.copy_from_slice(&ratios);
                    limit
                }
                None => Ok(0.0),
            })
            .collect();
        place(&mut self.base, state);
        assembler.contact(&mut self.base, time, &mut self.scratch)?;
        Ok(found.ok())
    }

    /// The measurement of a pair; leaves the assembler beside the state.
    fn stick_limit<S: LinearSolver + ?Sized>(
        &mut self,
        model: &Model,
        assembler: &mut Assembler,
        solver: &mut S,
        (state, index): (&State, usize),
        time: f64,
    ) -> Result<f64, ()> {
        let Workspace {
            rhs: was,
            du,
            scratch: now,
            absolute: stiffer,
            base,
            ..
        } = self;
        place(base, state);
        let ratio = assembler.ratios[index];
        assembler.ratios[index] = ratio * (1.0 + PART);
        let more = assembler.contact(base, time, stiffer).map_err(drop)?;
        assembler.ratios[index] = ratio;
        let totals = assembler.contact(base, time, was).map_err(drop)?;
        let pair = &model.pairs[index];
        let [w, s] = [&totals, &more].map(|t| *force(pair, index, t));
        let (centre, lever) = lever(model, pair, &state.u);
        let about = |f: &SurfaceForce| f.moment - centre.cross(&f.force);
        let forces = [(w.force, s.force), (about(&w) / lever, about(&s) / lever)];
        let all = was.iter().map(|f| f.abs()).sum::<f64>();
        let added = forces.map(|(w, s)| (s - w) / PART);
        if added.iter().all(|a| a.norm() <= ROUNDING * all) {
            return Ok(0.0);
        }
        for ((d, s), w) in du.iter_mut().zip(&**stiffer).zip(&**was) {
            *d = (w - s) / PART;
        }
        model.dofs.fold(du);
        // An estimate needs few digits.
        solver.solve_in_place(du).map_err(drop)?;
        model.dofs.expand(du, None);
        for (u, d) in base.u.iter_mut().zip(&*du) {
            *u += PART * d;
        }
        let moved = assembler.contact(base, time, now).map_err(drop)?;
        let m = force(pair, index, &moved);
        let missing = (added.iter().zip([m.force, about(m) / lever]).zip(forces))
            .map(|((added, moved), (was, _))| {
                let size = added.norm();
                if size <= ROUNDING * all {
                    return 0.0;
                }
                // Two springs in series: what the bodies do not follow of the added tractions, and so on for what that adds.
                let change = added + (moved - was) / PART;
                let stiff = (change.dot(added) / (size * size)).clamp(0.0, STIFFEST);
                size * stiff / (1.0 - stiff)
            })
            .fold(0.0, f64::max);
        if missing.is_finite() {
            Ok(missing)
        } else {
            Err(())
        }
    }
}

/// Centre of the slave points of a pair, and their mean distance from it (length).
fn lever(model: &Model, pair: &PairModel, u: &[f64]) -> (Vec3, f64) {
    let at = || (pair.points.iter()).map(|p| (model.point_position(p, u), p.area));
    let area: f64 = at().map(|(_, a)| a).sum();
    let centre = at().map(|(x, a)| x * a).sum::<Vec3>() / area;
    let square: f64 = at().map(|(x, a)| (x - centre).norm_squared() * a).sum();
    (centre, (square / area).sqrt().max(f64::MIN_POSITIVE))
}

/// Part of all forces of contact below which what is added is rounding.
const ROUNDING: f64 = 1e-9;
/// Share of the bodies in the stiffness of both springs above which nothing but the penalty gives way.
const STIFFEST: f64 = 0.999;
