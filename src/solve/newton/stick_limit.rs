//! What friction would be if points that stick did not give way.
//!
//! A tangential penalty lets a point that sticks creep by its elastic slip, and carries the less the softer it is. To first order a
//! stiffer one adds the tractions of that slip, which change the displacements by `K du = -f(t)`, and friction by `f(t)` and by
//! what `du` makes of it: what the bodies do not follow is missing. Penalty and bodies are two springs in series, whose stiffnesses
//! tell the whole of it: of the ratio of both is what is missing beside the friction of the points that stick. Points that slide have
//! their traction from the pressure, whatever the penalty is.
use super::Workspace;
use super::rigid_limit::{PART, force, place};
use crate::assembly::{Assembler, Fault, SurfaceForce};
use crate::contact::friction::history::{PointHistory, PointStatus};
use crate::model::Model;
use crate::model::state::State;
use crate::system::linear::LinearSolver;
use covact_geometry::Vec3;

/// The friction of a contact at the end of a step, and what rigid sticking would add to it (force).
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct StickLimit {
    /// Sum of the sizes of the tractions times their areas.
    pub friction: f64,
    /// Of the resultant of the points that stick, or of its moment about their middle over their mean distance from it.
    pub missing: f64,
}

impl Workspace {
    /// Measures the contacts with friction at the end of the step that was just solved for and taken into the histories of `state`, as
    /// [`Workspace::rigid_limit`] does before it; nothing where the linear solver cannot, or contact has no value beside the
    /// state. Nothing acts where there is no friction.
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
    ) -> Result<Option<Vec<StickLimit>>, Fault> {
        if model.small.is_some() || assembler.has_new_pattern() || !self.factored {
            return Ok(None);
        }
        self.beside(state, histories);
        let ratios = assembler.ratios.clone();
        let found: Result<Vec<StickLimit>, ()> = (0..model.pairs.len())
            .map(|index| {
                let limit = self.stick_limit(model, assembler, solver, (state, index), time);
                assembler.ratios.copy_from_slice(&ratios);
                limit
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
    ) -> Result<StickLimit, ()> {
        let pair = &model.pairs[index];
        let stuck = Stuck::new(model, index, state);
        let Some(stuck) = stuck.filter(|s| s.sticks()) else {
            return Ok(stuck.map_or(StickLimit::default(), |s| s.missing([0.0; 2])));
        };
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
        let [w, s] = [&totals, &more].map(|t| *force(pair, index, t));
        let all = was.iter().map(|f| f.abs()).sum::<f64>();
        let [was_both, stiffer_both] = [&w, &s].map(|f| stuck.of(f));
        let added = [0, 1].map(|k| (stiffer_both[k] - was_both[k]) / PART);
        if added.iter().all(|a| a.norm() <= ROUNDING * all) {
            return Ok(stuck.missing([0.0; 2]));
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
        let moved = stuck.of(force(pair, index, &moved));
        // Of all nodes, along what is added at each.
        let (mut size, mut along) = (0.0, 0.0);
        let nodes = was.as_chunks::<3>().0.iter().zip(now.as_chunks::<3>().0);
        for ((w, n), s) in nodes.zip(stiffer.as_chunks::<3>().0) {
            let [w, n, s] = [w, n, s].map(|f| Vec3::from_column_slice(f));
            let more = s - w;
            size += more.norm();
            along += (more + n - w).dot(&more) / more.norm().max(f64::MIN_POSITIVE);
        }
        let ratio = |k: usize| {
            let own = added[k].norm() * PART;
            // A resultant of what nearly balances is mostly rounding.
            let bodies = if own < BALANCED * size {
                along / size
            } else {
                let change = added[k] * PART + moved[k] - was_both[k];
                change.dot(&added[k]) * PART / (own * own)
            };
            let bodies = bodies.clamp(0.0, STIFFEST);
            bodies / (1.0 - bodies)
        };
        let ratios = [ratio(0), ratio(1)];
        if ratios.iter().all(|r| r.is_finite()) {
            Ok(stuck.missing(ratios))
        } else {
            Err(())
        }
    }
}

/// The friction of a pair, and what of it acts at points that stick.
#[derive(Clone, Copy)]
struct Stuck {
    friction: f64,
    /// Middle of the slave points, and their mean distance from it (length).
    centre: Vec3,
    lever: f64,
    /// Sizes of the resultant of the points that stick, and of its moment about the middle over the distance (force).
    sizes: [f64; 2],
}

impl Stuck {
    /// Nothing without friction.
    fn new(model: &Model, index: usize, state: &State) -> Option<Stuck> {
        let pair = &model.pairs[index];
        let range = (state.history(model, index)).filter(|_| pair.friction.is_some())?;
        let points = state.slaves(model, index);
        let at = || {
            points
                .iter()
                .map(|p| (model.point_position(p, &state.u), p.area))
        };
        let area: f64 = at().map(|(_, a)| a).sum();
        let centre = at().map(|(x, a)| x * a).sum::<Vec3>() / area;
        let square: f64 = at().map(|(x, a)| (x - centre).norm_squared() * a).sum();
        let lever = (square / area).sqrt();
        let (mut friction, mut sum, mut moment) = (0.0, Vec3::zeros(), Vec3::zeros());
        for ((x, area), history) in at().zip(&state.histories[range]) {
            friction += history.t.norm() * area;
            if history.status == PointStatus::Stick {
                sum += history.t * area;
                moment += (x - centre).cross(&history.t) * area;
            }
        }
        Some(Stuck {
            friction,
            centre,
            lever,
            sizes: [sum.norm(), moment.norm() / lever],
        })
    }

    fn sticks(&self) -> bool {
        self.sizes[0] > 0.0
    }

    /// A force and its moment about the middle over the distance.
    fn of(&self, f: &SurfaceForce) -> [Vec3; 2] {
        [
            f.force,
            (f.moment - self.centre.cross(&f.force)) / self.lever,
        ]
    }

    /// What is missing where the bodies are so many times as stiff as the penalty.
    fn missing(&self, ratios: [f64; 2]) -> StickLimit {
        let [a, b] = [0, 1].map(|k| ratios[k] * self.sizes[k]);
        StickLimit {
            friction: self.friction,
            missing: a.max(b),
        }
    }
}

/// Part of all forces of contact below which what is added is rounding.
const ROUNDING: f64 = 1e-9;
/// Part of the sizes of what is added at all nodes below which its resultant says nothing.
const BALANCED: f64 = 0.1;
/// Share of the bodies in the stiffness of both springs above which nothing but the penalty gives way.
const STIFFEST: f64 = 0.999;
