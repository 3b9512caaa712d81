//! What the compliance of contact takes away from its forces.
//!
//! A penalty puts springs between the bodies, and with them the energy `E_c = sum p |g| A / 2` (with multipliers, only what the
//! penalties still carry). A rigid contact is the limit of no compliance, and to first order in it a force on a given motion is
//! off by `dE_c / d(motion)`: relative to the force by `dE_c / dW`, `W` being the work done. Where everything is linear, two
//! springs in series, that is `r / (1 + r)` of the ratio `r = E_c / E_int` to the strain energy. Where loads are given,
//! displacements are off by as much.
//!
//! `r` alone is no sure measure: under far too soft a penalty a tool passes through, and little of anything is stored. So
//! the deepest penetration stands beside it, relative to the approach: how far master and slave bodies move towards each
//! other along the normal of the deepest point. In a dent the mean penetration counts, which is some .3 of the deepest. And
//! where contact stiffens fast at the end of a path, its energy grows faster than in proportion to the work: the exponent
//! that the last steps show is then a factor on `E_c / W`.
//!
//! What such measures do not show, a wrap whose pressure is concentrated or a path that is about to turn, the linear answer to
//! the tractions of the step itself does ([`RigidLimit`]): it is what the user is told, of the last step and of that of the
//! largest force, and it rules the penalty where two steps in a row show too much, at the last step, and where a first touch gives
//! way beside bodies that are bent far. It costs as much as a few assemblies of contact: as long as it shows little it is made at
//! fewer and fewer steps, and wherever forces have grown or motions have turned.
mod growing;
mod kept;
mod lasting;
mod sticking;
mod told;

use super::bearing::{Bearings, Deepest};
use super::penalty_rule;
use crate::model::master::Master;
use crate::model::state::State;
use crate::model::{Model, PairModel};
use crate::scene::ValueError;
use crate::solve::newton::RigidLimit;
use covact_geometry::Vec3;
use growing::Growing;
use lasting::Lasting;
use nalgebra::Isometry3;
use sticking::Sticking;

/// Mean penetration over the deepest one.
const MEAN: f64 = 0.3;
/// Steps whose strain energy is below this part of the largest are not judged: first touches rest on single points.
const JUDGED: f64 = 0.1;
/// Penetration over approach that tells of a tool on its way through the body even where next to nothing is strained.
const THROUGH: f64 = 0.3;
/// Growth of the work in a step below which its exponent is not judged.
const GROWN: f64 = 1e-3;
/// Factor by which the energy of contact grows in a step above which the step is a first touch rather than growth.
const TOUCHED: f64 = 20.0;

/// Error above which the user is warned.
const WARNED: f64 = 0.01;
/// Steps from one measurement of what rigid contact would change to the next at most, and the growth of the largest force above
/// which none is left out.
const SELDOM: u32 = 8;
const LARGER: f64 = 1.2;
/// Part of a force that rigid contact would have to change for it to rule the penalty where no energy tells of it.
const GIVES_WAY: f64 = 0.2;
/// Part of the smallest error that raises a penalty below which fewer steps are measured.
const LITTLE: f64 = 0.4;
/// Part of the error to rigid contact that a raise between two steps may leave for another one to follow.
const HELPED: f64 = 0.9;

/// Measures of an accepted step.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
struct Measures {
    /// Energy of contact over strain energy.
    energy: f64,
    /// Deepest penetration over approach.
    penetration: f64,
    /// Change of the energy of contact over the work done; 0 where it is not judged.
    growth: f64,
}

impl Measures {
    /// The largest of them, which is the error as long as it is small.
    fn largest(&self) -> f64 {
        (self.energy.min(f64::MAX))
            .max(MEAN * self.penetration.min(1.0))
            .max(self.growth)
    }

    /// Relative error of forces.
    fn error(&self) -> f64 {
        let series = match self.energy.is_finite() {
            true => self.energy / (1.0 + self.energy),
            false => 1.0,
        };
        // As long as penetrations are small `MEAN` of their ratio, and all of the force where nothing but the contact gives way.
        let p = self.penetration.min(1.0);
        let sunk = MEAN * p / (1.0 - (1.0 - MEAN) * p);
        series.max(sunk).max(self.growth.min(1.0))
    }
}

/// What was measured at a step.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
struct Measured {
    measures: Measures,
    error: f64,
    /// Strain energy.
    energy: f64,
    step: u32,
    time: f64,
    /// The pair that stores most.
    pair: u32,
}

/// What has been measured since the start.
#[derive(Debug, Clone, PartialEq)]
pub struct Compliance {
    /// Largest strain energy.
    largest: f64,
    /// The step with the largest error by what shows there.
    worst: Measured,
    /// The steps of the largest force and the last one, with the errors that rigid contact shows; without where it could not be
    /// measured.
    limits: [Measured; 2],
    /// Steps from the last one to the next that is to show it, and the largest force between bodies at such steps.
    gap: u32,
    bearing: f64,
    /// What steps in a row showed of that error.
    lasting: Lasting,
    /// Energy of contact and work at the last two steps, the last one first.
    path: [[f64; 2]; 2],
    /// Penalty per pair at the last step; empty before the first.
    penalties: Vec<f64>,
    /// How fast the energy of contact grows beside metal that flows.
    growing: Growing,
    /// Largest force and displacement so far.
    force: f64,
    displacement: f64,
    /// What elastic slip takes from friction.
    pub sticking: Sticking,
    /// Poses of the surfaces at the start.
    poses: Vec<Isometry3<f64>>,
}

/// What the penalties of a step that is not accepted yet leave, per pair.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Errors {
    /// Relative error of forces.
    pub forces: Vec<f64>,
    /// Deepest penetration over what is too deep; 0 where the penalty is not ruled.
    pub sunk: Vec<f64>,
}

impl Errors {
    /// Nothing is left, or known.
    pub fn none(model: &Model) -> Self {
        Errors {
            forces: vec![0.0; model.pairs.len()],
            sunk: vec![0.0; model.pairs.len()],
        }
    }

    /// Relative error of forces of all pairs.
    pub fn sum(&self) -> f64 {
        self.forces.iter().sum()
    }

    /// The deepest of all.
    pub fn deepest(&self) -> f64 {
        self.sunk.iter().fold(0.0, |a, b| a.max(*b))
    }
}

/// An accepted step.
pub struct StepEnd<'a> {
    pub step: u32,
    pub time: f64,
    pub state: &'a State,
    pub bearings: &'a Bearings,
    /// Strain energy.
    pub internal: f64,
    /// What elements have taken, plastic work included (energy).
    pub taken: f64,
    /// Work of supports, loads and surfaces since the start.
    pub work: f64,
    /// Penalty per pair.
    pub penalties: &'a [f64],
    /// What rigid contact would change, where it was measured.
    pub limit: Option<&'a RigidLimit>,
}

impl Compliance {
    /// Nothing measured yet.
    ///
    /// # Errors
    /// A motion without a value at time 0.
    pub fn new(model: &Model) -> Result<Self, ValueError> {
        let start = State::new(model);
        let pose = |s: &crate::model::SurfaceModel| s.pose(0.0, &start.u);
        Ok(Compliance {
            largest: 0.0,
            worst: Measured::default(),
            limits: [Measured::default(); 2],
            gap: 0,
            bearing: 0.0,
            lasting: Lasting::NONE,
            path: [[0.0; 2]; 2],
            penalties: Vec::new(),
            growing: Growing::new(model),
            sticking: Sticking::default(),
            force: 0.0,
            displacement: 0.0,
            poses: model.surfaces.iter().map(pose).collect::<Result<_, _>>()?,
        })
    }

    /// Whether a step has enough strain energy to be judged.
    fn judges(&self, end: &StepEnd) -> bool {
        end.internal >= JUDGED * self.largest
    }

    /// The error that every pair makes in forces at the end of a step that is not accepted yet, as far as it shows there; above
    /// one where contact gives way more than the bodies do.
    ///
    /// # Errors
    /// A motion without a value at its time.
    pub fn errors(&self, model: &Model, end: &StepEnd) -> Result<Errors, ValueError> {
        let mut found = Errors::none(model);
        for ((sunk, sum), pair) in
            (found.sunk.iter_mut().zip(&end.bearings.pairs)).zip(&model.pairs)
        {
            if pair.ruled.is_some() {
                *sunk = sum.sunk;
            }
        }
        let errors = &mut found.forces;
        let judges = self.judges(end);
        for (index, (error, sum)) in errors.iter_mut().zip(&end.bearings.pairs).enumerate() {
            if sum.energy <= 0.0 {
                continue;
            }
            let mut measures = Measures {
                energy: sum.energy / end.internal,
                penetration: self.sunk(model, index, end)?,
                growth: 0.0,
            };
            if !judges && measures.penetration < THROUGH {
                continue;
            }
            if !judges {
                measures.energy = 0.0;
            } else if model.flows() {
                measures.energy = measures.energy.max(self.growing.of(index, end));
            }
            *error = measures.largest();
        }
        Ok(found)
    }

    /// Relative error of a step by what rigid contact would change: of forces, relative to the largest so far, and of
    /// displacements where loads are given.
    fn relative(&self, model: &Model, limit: &RigidLimit) -> f64 {
        let part = |change: f64, size: f64| if size > 0.0 { change / size } else { 0.0 };
        let forces = part(limit.change(), limit.force().max(self.force));
        let [moved, largest] = limit.moved;
        match model.loaded() {
            true => forces.max(part(moved, largest.max(self.displacement))),
            false => forces,
        }
    }

    /// Whether what rigid contact would change is to be measured at a step; `turned` says that motions or loads had a kink at its
    /// start, behind which nothing is known.
    pub fn is_due(&mut self, step: u32, bearings: &Bearings, turned: bool) -> bool {
        if turned {
            self.gap = 0;
        }
        let last = self.limits[1].step;
        last == 0 || step >= last + self.gap || bearings.force() > LARGER * self.bearing
    }

    /// Whether a force that is larger than all before gives way by so much that its penalty is ruled by what rigid contact would
    /// change, in this very step: beside bodies that are bent far, what little it stores shows in no energy.
    pub fn gives_way(&self, model: &Model, limit: Option<&RigidLimit>, errors: &Errors) -> bool {
        limit.is_some_and(|limit| {
            limit.force() > LARGER * self.force && limit.change() > GIVES_WAY * limit.force()
        }) && errors.sum() <= penalty_rule::raises_from(model)
    }

    /// What rigid contact would have changed at the last step at which it was measured.
    pub fn last_error(&self) -> f64 {
        self.limits[1].error
    }

    /// Whether a force is as large as any before.
    pub fn is_largest(&self, limit: Option<&RigidLimit>) -> bool {
        limit.is_some_and(|limit| limit.force() >= self.force)
    }

    /// The error below which it does not matter how it comes about, given penalties included.
    pub fn little(model: &Model) -> f64 {
        LITTLE * penalty_rule::raises_from(model).min(WARNED)
    }

    /// Raises the errors of a step to what rigid contact would change, each pair's by its share of the energy of contact.
    pub fn add_limit(&self, model: &Model, end: &StepEnd, errors: &mut Errors) {
        if let Some(limit) = end.limit {
            add(self.relative(model, limit), end, errors);
        }
    }

    /// The same for an accepted step, with what showed in the last two steps that were measured.
    pub fn add_lasting(&self, end: &StepEnd, errors: &mut Errors) {
        add(self.lasting.now, end, errors);
    }

    /// The deepest penetration of a pair over the approach of its bodies.
    fn sunk(&self, model: &Model, index: usize, end: &StepEnd) -> Result<f64, ValueError> {
        let pair = (index, &model.pairs[index]);
        match &end.bearings.pairs[index].deepest {
            Some(deepest) => Ok(deepest.depth / self.approach(model, pair, end, deepest)?),
            None => Ok(0.0),
        }
    }

    /// Measures an accepted step; the error that shows in its growth over the last steps.
    ///
    /// # Errors
    /// A motion without a value at its time.
    pub fn step(&mut self, model: &Model, end: &StepEnd) -> Result<f64, ValueError> {
        let pairs = &end.bearings.pairs;
        let stored: f64 = pairs.iter().map(|p| p.energy).sum();
        self.largest = self.largest.max(end.internal);
        if model.flows() {
            self.growing.step(end);
        }
        let [before, first] = match self.penalties == end.penalties {
            true => self.path,
            // Energies under two penalties say nothing of growth.
            false => [[0.0; 2]; 2],
        };
        self.path = [[stored, end.work], before];
        self.penalties.clear();
        self.penalties.extend_from_slice(end.penalties);
        if stored <= 0.0 || !self.judges(end) {
            return Ok(0.0);
        }
        let mut penetration = 0.0f64;
        for index in 0..pairs.len() {
            penetration = penetration.max(self.sunk(model, index, end)?);
        }
        let slides = model.pairs.iter().any(|p| p.friction.is_some());
        let measures = Measures {
            energy: stored / end.internal,
            penetration,
            // Work against friction stores nothing.
            growth: match slides {
                true => 0.0,
                false => growth([self.path[0], before, first]),
            },
        };
        let most = (pairs.iter().enumerate()).max_by(|a, b| a.1.energy.total_cmp(&b.1.energy));
        let mut here = Measured {
            measures,
            error: measures.error(),
            energy: end.internal,
            step: end.step,
            time: end.time,
            pair: most.map_or(0, |(index, _)| index as u32),
        };
        if here.error > self.worst.error || self.worst.energy < JUDGED * self.largest {
            self.worst = here;
        }
        let Some(limit) = end.limit else {
            return Ok(measures.growth);
        };
        here.error = self.relative(model, limit);
        self.bearing = self.bearing.max(end.bearings.force());
        self.gap = match here.error < LITTLE * penalty_rule::raises_from(model) {
            true => (2 * self.gap).clamp(1, SELDOM),
            false => 1,
        };
        self.displacement = self.displacement.max(limit.moved[1]);
        let [peak, last] = &mut self.limits;
        if limit.force() >= self.force {
            self.force = limit.force();
            *peak = here;
        }
        *last = here;
        let bound = penalty_rule::raises_from(model);
        match self.lasting.step(here.error, bound) {
            true => Ok(measures.growth.max(self.lasting.now)),
            false => Ok(measures.growth),
        }
    }

    /// How far the bodies of a pair have moved towards each other along the normal at its deepest point: the spread of the
    /// displacements of their nodes and of a rigid master there.
    fn approach(
        &self,
        model: &Model,
        (index, pair): (usize, &PairModel),
        end: &StepEnd,
        deepest: &Deepest,
    ) -> Result<f64, ValueError> {
        let n = &deepest.normal;
        let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
        let mut add = |u: f64| (low, high) = (low.min(u), high.max(u));
        let mut body = |number: usize| {
            let body = &model.bodies[number];
            let first = 3 * body.first_node as usize;
            let nodes = &end.state.u[first..first + 3 * body.mesh.nodes.len()];
            for u in nodes.as_chunks::<3>().0 {
                add(Vec3::from_column_slice(u).dot(n));
            }
        };
        body(pair.body);
        match &pair.master {
            Master::Body(master) if master.body != pair.body => body(master.body),
            Master::Body(_) => {}
            Master::Rigid(surface) => add(match model.small {
                Some(_) => {
                    let motion = model.small_motion(&model.pairs[index], end.time)?;
                    motion.map_or(0.0, |m| m.at(&deepest.x).dot(n))
                }
                None => {
                    let now = model.surfaces[*surface].pose(end.time, &end.state.u)?;
                    let start = self.poses[*surface] * now.inverse();
                    (deepest.x - (start * nalgebra::Point3::from(deepest.x)).coords).dot(n)
                }
            }),
        }
        Ok(high - low)
    }
}

/// Raises the errors of all pairs by what rigid contact would change, each by its share of the energy of contact.
fn add(error: f64, end: &StepEnd, errors: &mut Errors) {
    let pairs = &end.bearings.pairs;
    let all: f64 = pairs.iter().map(|p| p.energy).sum();
    if all <= 0.0 {
        return;
    }
    for (own, pair) in errors.forces.iter_mut().zip(pairs) {
        *own = own.max(error * pair.energy / all);
    }
}

/// `dE_c / dW` at the last of three points of a path, each the energy of contact and the work, the last one first: the
/// smaller exponent of two steps by `E_c / W`, so that a single step decides nothing. 0 where it is not to be judged.
fn growth(path: [[f64; 2]; 3]) -> f64 {
    let exponent = |[e1, w1]: [f64; 2], [e0, w0]: [f64; 2]| {
        let grows = e0 > 0.0 && w0 > 0.0 && e1 < TOUCHED * e0 && w1 > (1.0 + GROWN) * w0;
        grows.then(|| (e1 / e0).ln() / (w1 / w0).ln())
    };
    let [last, before, first] = path;
    match (exponent(last, before), exponent(before, first)) {
        (Some(a), Some(b)) => (a.min(b) * last[0] / last[1]).max(0.0),
        _ => 0.0,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn energy_that_grows_with_a_power_of_the_work_is_measured() {
        let at = |w: f64| [1e-3 * w.powi(4), w];
        let found = growth([at(1.2), at(1.1), at(1.0)]);
        let exact = 4e-3 * 1.2f64.powi(3);
        assert!((found / exact - 1.0).abs() < 1e-12, "{found} {exact}");
        // A first touch, and a step that does no work.
        assert_eq!(growth([at(1.2), [0.0, 1.1], [0.0, 1.0]]), 0.0);
        assert_eq!(growth([at(1.1), at(1.1), at(1.0)]), 0.0);
    }

    #[test]
    fn springs_in_series_are_exact_and_passing_through_is_all() {
        let of = |energy: f64, penetration: f64| {
            let growth = 0.0;
            Measures {
                energy,
                penetration,
                growth,
            }
            .error()
        };
        // A contact as stiff as the body takes half of the force.
        let all = |part: f64| assert!((part - 1.0).abs() < 1e-15, "{part}");
        assert_eq!(of(1.0, 0.0), 0.5);
        all(of(f64::INFINITY, 0.0));
        all(of(0.0, 1.0));
        all(of(0.0, f64::INFINITY));
        assert!((of(0.0, 1e-3) / 3e-4 - 1.0).abs() < 1e-3);
    }
}
