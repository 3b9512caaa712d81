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
use super::bearing::{Bearings, Deepest};
use crate::model::error::number;
use crate::model::master::Master;
use crate::model::state::State;
use crate::model::{Model, PairModel};
use crate::output::Accuracy;
use crate::run::checkpoint::bytes::{Malformed, Reader, Writer};
use crate::scene::ValueError;
use covact_geometry::Vec3;
use nalgebra::Isometry3;

/// Error above which the user is warned.
const WARNED: f64 = 0.01;
/// Error that the proposed penalty leaves.
const WANTED: f64 = 0.003;
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

/// The step with the largest error.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
struct Worst {
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
    worst: Worst,
    /// Energy of contact and work at the last two steps, the last one first.
    path: [[f64; 2]; 2],
    /// Penalty per pair at the last step; empty before the first.
    penalties: Vec<f64>,
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
    /// Work of supports, loads and surfaces since the start.
    pub work: f64,
    /// Penalty per pair.
    pub penalties: &'a [f64],
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
            worst: Worst::default(),
            path: [[0.0; 2]; 2],
            penalties: Vec::new(),
            poses: model.surfaces.iter().map(pose).collect::<Result<_, _>>()?,
        })
    }

    /// Into a checkpoint.
    pub(super) fn put(&self, out: &mut Writer) {
        let Compliance {
            largest,
            worst,
            path,
            penalties,
            // Known from the model.
            poses: _,
        } = self;
        let Worst {
            measures,
            error,
            energy,
            step,
            time,
            pair,
        } = worst;
        out.f64s(&[*largest, *error, *energy, *time]);
        out.f64s(&[measures.energy, measures.penetration, measures.growth]);
        out.u32(*step);
        out.u32(*pair);
        out.f64s(path.as_flattened());
        out.count(penalties.len());
        out.f64s(penalties);
    }

    /// [`Self::put`], read back for the same model.
    pub(super) fn take(&mut self, model: &Model, from: &mut Reader) -> Result<(), Malformed> {
        let (mut sums, mut measures) = ([0.0; 4], [0.0; 3]);
        from.f64s(&mut sums)?;
        from.f64s(&mut measures)?;
        [
            self.largest,
            self.worst.error,
            self.worst.energy,
            self.worst.time,
        ] = sums;
        let [energy, penetration, growth] = measures;
        self.worst.measures = Measures {
            energy,
            penetration,
            growth,
        };
        (self.worst.step, self.worst.pair) = (from.u32()?, from.u32()?);
        if self.worst.pair as usize >= model.pairs.len().max(1) {
            return Err(from.malformed("a contact that there is not"));
        }
        from.f64s(self.path.as_flattened_mut())?;
        let count = from.count(8)?;
        if count > model.pairs.len() {
            return Err(from.malformed("penalties of more contacts than there are"));
        }
        self.penalties.resize(count, 0.0);
        from.f64s(&mut self.penalties)
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
            if let (Some(ruled), Some(deepest)) = (&pair.ruled, &sum.deepest) {
                *sunk = deepest.depth / ruled.deepest;
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
            }
            *error = measures.largest();
        }
        Ok(found)
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
        let error = measures.error();
        if error > self.worst.error || self.worst.energy < JUDGED * self.largest {
            let most = (pairs.iter().enumerate()).max_by(|a, b| a.1.energy.total_cmp(&b.1.energy));
            self.worst = Worst {
                measures,
                error,
                energy: end.internal,
                step: end.step,
                time: end.time,
                pair: most.map_or(0, |(index, _)| index as u32),
            };
        }
        Ok(measures.growth)
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

    /// What the user is told at the end of a run, under the penalties that it ended with.
    pub fn warning(&self, model: &Model, penalties: &[f64]) -> Option<String> {
        let Worst {
            measures,
            error,
            step,
            time,
            pair,
            ..
        } = self.worst;
        let (pair, eps) = (model.pairs.get(pair as usize)?, penalties[pair as usize]);
        if error <= WARNED {
            return None;
        }
        let off = match error > 0.5 {
            true => "more than half".to_owned(),
            false => format!("about {:.1} %", 100.0 * error),
        };
        // The larger the measure that the error comes from, the stiffer.
        let measure = (measures.energy)
            .max(MEAN * measures.penetration)
            .max(measures.growth);
        let times = (measure / WANTED).clamp(2.0, 1e15);
        let remedy = match pair.augmentation {
            Some(_) => "take a smaller `gap` of its `augmentation`".to_owned(),
            None => format!(
                "take a `penalty` of about {{\"value\": {:.0e}}} there ({times:.0e} times the present one), or `augmentation`",
                eps * times
            ),
        };
        let growth = match measures.growth > 0.0 {
            true => format!(
                ", and {:.2} % of the work of the last steps went into contact",
                100.0 * measures.growth
            ),
            false => String::new(),
        };
        Some(format!(
            "contact gives way: forces (displacements, where loads are given) are off by {off}. At step {step} (time {}) the \
             energy of contact was {} of the strain energy, most of it in contact `{}`, and the deepest penetration {} of \
             the approach{growth}: {remedy}",
            number(time),
            share(measures.energy),
            pair.name,
            share(measures.penetration)
        ))
    }

    /// The measures as they stand in the summary.
    pub fn account(&self, model: &Model) -> Accuracy {
        let Worst { measures, .. } = self.worst;
        let touched = self.worst.step > 0;
        let name = model.pairs.get(self.worst.pair as usize);
        Accuracy {
            force_error: self.worst.error,
            energy_ratio: measures.energy.min(f64::MAX),
            penetration_ratio: measures.penetration.min(f64::MAX),
            energy_growth: measures.growth,
            step: self.worst.step,
            time: self.worst.time,
            contact: name.filter(|_| touched).map(|p| p.name.clone()),
            contacts: Vec::new(),
        }
    }
}

/// A part in percent, or a multiple.
fn share(x: f64) -> String {
    match x < 1.0 {
        true => format!("{:.2} %", 100.0 * x),
        false => format!("{x:.1e} times"),
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
