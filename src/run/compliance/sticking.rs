//! What the elastic slip of points that stick takes away from friction, and the tangential penalty that follows from it.
use crate::model::Model;
use crate::model::error::number;
use crate::run::checkpoint::bytes::{Malformed, Reader, Writer};
use crate::solve::newton::StickLimit;

/// Error above which the user is told, and above which a tangential penalty that the run may choose is raised for the next step,
/// the error that it is to leave then, and the factor at most.
const WARNED: f64 = 0.03;
const RAISED: f64 = 0.03;
const LEFT: f64 = 0.01;
const FACTOR: f64 = 10.0;
/// What is missing of friction below this part of the largest force of its contact is nothing.
const JUDGED: f64 = 0.01;
/// Error from which on the estimate says no more than that the contact gives way.
const ALL: f64 = 0.5;

/// A contact with friction at one step.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
struct Measured {
    error: f64,
    step: u32,
    time: f64,
}

/// What has been measured of a contact.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
struct Pair {
    /// Largest friction, as it would be with rigid sticking, and largest force.
    friction: f64,
    force: f64,
    /// At the step of the largest friction, and at the last one measured.
    peak: Measured,
    last: Measured,
}

/// Steps without a raise after one that took many iterations, at first and at most.
const WAITS: [u32; 2] = [4, 32];

/// What has been measured since the start.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Sticking {
    /// Per pair; empty before the first step that was measured.
    pairs: Vec<Pair>,
    /// Steps since the last one that took many iterations, and those that have to pass before a penalty is raised: the double from
    /// each to the next.
    calm: u32,
    wait: u32,
}

impl Sticking {
    /// Takes down a step with the forces of its pairs, and whether it took many iterations; the factors by which their tangential
    /// penalties are to rise.
    pub fn step(
        &mut self,
        limits: &[StickLimit],
        forces: impl Iterator<Item = f64>,
        (step, time): (u32, f64),
        struggles: bool,
    ) -> Vec<f64> {
        self.calm = self.calm.saturating_add(1);
        if struggles {
            let [first, most] = WAITS;
            (self.calm, self.wait) = (0, (2 * self.wait).clamp(first, most));
        }
        let raises = self.calm >= self.wait;
        if limits.is_empty() {
            return vec![1.0; forces.count()];
        }
        self.pairs.resize(limits.len(), Pair::default());
        let pairs = self.pairs.iter_mut().zip(limits).zip(forces);
        pairs
            .map(|((pair, limit), force)| {
                pair.force = pair.force.max(force);
                let missing = limit.missing;
                let rigid = limit.friction + missing;
                let largest = pair.friction.max(rigid);
                let judged = missing > JUDGED * pair.force;
                let error = if judged { missing / largest } else { 0.0 };
                pair.last = Measured { error, step, time };
                if rigid >= pair.friction {
                    pair.peak = pair.last;
                }
                pair.friction = largest;
                match raises && error > RAISED {
                    true => (error / LEFT).min(FACTOR),
                    false => 1.0,
                }
            })
            .collect()
    }

    /// Whether the next step is to be measured: the last one showed too much.
    pub fn is_due(&self) -> bool {
        self.pairs.iter().any(|p| p.last.error > RAISED)
    }

    /// The error of a pair's friction: the larger of those at its largest and at the end.
    pub fn error(&self, pair: usize) -> f64 {
        (self.pairs.get(pair)).map_or(0.0, |p| p.peak.error.max(p.last.error))
    }

    /// What the user is told at the end of a run, under the tangential penalties that it ended with.
    pub fn warnings(&self, model: &Model, eps: &[f64]) -> Vec<String> {
        let pairs = model.pairs.iter().zip(&self.pairs).zip(eps);
        let told = pairs.filter_map(|((pair, own), eps)| {
            let Measured { error, step, time } = match own.peak.error > own.last.error {
                true => own.peak,
                false => own.last,
            };
            let off = match error > ALL {
                true => "more than half".to_owned(),
                false => format!("up to about {:.0} %", 100.0 * error),
            };
            (error > WARNED).then(|| {
                format!(
                    "contact `{}`: points that stick give way by their elastic slip, so that friction may be off by {off} at step {step} \
                     (time {}): take a `tangential_penalty` of about {{\"value\": {:.0e}}}, {:.0e} times the present one",
                    pair.name,
                    number(time),
                    eps * (error / LEFT),
                    error / LEFT
                )
            })
        });
        told.collect()
    }

    /// Into a checkpoint.
    pub fn put(&self, out: &mut Writer) {
        out.u32(self.calm);
        out.u32(self.wait);
        out.count(self.pairs.len());
        for pair in &self.pairs {
            out.f64s(&[pair.friction, pair.force]);
            for measured in [pair.peak, pair.last] {
                out.f64s(&[measured.error, measured.time]);
                out.u32(measured.step);
            }
        }
    }

    /// [`Self::put`], read back for the same model.
    pub fn take(&mut self, model: &Model, from: &mut Reader) -> Result<(), Malformed> {
        (self.calm, self.wait) = (from.u32()?, from.u32()?);
        let count = from.count(56)?;
        if count > model.pairs.len() {
            return Err(from.malformed("friction of more contacts than there are"));
        }
        self.pairs = (0..count)
            .map(|_| {
                let mut sums = [0.0; 2];
                from.f64s(&mut sums)?;
                let mut measured = || {
                    let mut numbers = [0.0; 2];
                    from.f64s(&mut numbers)?;
                    let [error, time] = numbers;
                    let step = from.u32()?;
                    Ok(Measured { error, step, time })
                };
                Ok(Pair {
                    friction: sums[0],
                    force: sums[1],
                    peak: measured()?,
                    last: measured()?,
                })
            })
            .collect::<Result<_, Malformed>>()?;
        Ok(())
    }
}
