//! Where geometry decides about a contact force: how many slave points carried it, and how much of it acted at sharp convex
//! edges of the tool, each at the step in which the contact's force was the largest.
use super::bearing::{Bearing, Bearings, FEW};
use super::crest::Crests;
use super::law_range;
use crate::assembly::{PairForce, Totals};
use crate::model::error::number;
use crate::model::initial::point_spacing;
use crate::model::{Model, PairModel, sharp};
use crate::output::ContactAccuracy;
use crate::run::checkpoint::bytes::{Malformed, Reader, Writer};
use covact_geometry::Vec3;

/// Part of a force at sharp convex edges and tips above which the user is warned.
const AT_EDGES: f64 = 0.1;

/// Part of the largest force of all contacts below which that of one is rounding.
const ROUNDING: f64 = 1e-9;
/// Part of a force at points whose penetration is prescribed above which the user is warned.
const PRESCRIBED: f64 = 0.01;

/// Part of the largest forces of contact that may be without balance without a word.
const RELIABLE: f64 = 1e-4;

/// Part of the largest force of all contacts from which on the peak of one is looked at.
const LARGE: f64 = 0.1;

/// Part of a force by which the two half passes of a contact may disagree without a word.
const UNBALANCED: f64 = 0.02;

/// A contact at its largest force.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
struct Peak {
    force: f64,
    at_edges: f64,
    /// The part of it at points whose penetration is prescribed.
    prescribed: f64,
    /// Most of what the forces on both sides did not balance in a step, and that step; zero but for two half passes.
    unbalanced: f64,
    unbalanced_step: u32,
    active: usize,
    /// Points that carried most of it, where these were few; else 0.
    few: usize,
    step: u32,
    /// What the steps show of the peaks of its forces.
    crests: Crests,
}

/// The largest force of every pair so far, and the largest stress of every body of a metal of known strength.
#[derive(Debug, Clone, PartialEq)]
pub struct Peaks(Vec<Peak>, Vec<Stress>, Rounded);

/// Where rounding left most of the forces of contact without balance (force), and that step.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
struct Rounded {
    force: f64,
    step: u32,
    /// Most that contacts carried in a step (force).
    carried: f64,
}

/// The largest von Mises stress of a body, and its step.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
struct Stress {
    stress: f64,
    step: u32,
}

impl Peaks {
    pub fn new(model: &Model) -> Self {
        let metals = model.bodies.iter().any(|b| b.metal.is_some());
        let bodies = if metals { model.bodies.len() } else { 0 };
        Peaks(
            vec![Peak::default(); model.pairs.len()],
            vec![Stress::default(); bodies],
            Rounded::default(),
        )
    }

    /// Into a checkpoint.
    pub(super) fn put(&self, out: &mut Writer) {
        out.count(self.0.len());
        for Peak {
            force,
            at_edges,
            prescribed,
            unbalanced,
            unbalanced_step,
            active,
            few,
            step,
            crests,
        } in &self.0
        {
            out.f64s(&[*force, *at_edges, *prescribed, *unbalanced]);
            out.u64(*active as u64);
            out.u64(*few as u64);
            out.u32(*step);
            out.u32(*unbalanced_step);
            crests.put(out);
        }
        for Stress { stress, step } in &self.1 {
            out.f64s(&[*stress]);
            out.u32(*step);
        }
        out.f64s(&[self.2.force, self.2.carried]);
        out.u32(self.2.step);
    }

    /// [`Self::put`], read back for the same model.
    pub(super) fn take(&mut self, from: &mut Reader) -> Result<(), Malformed> {
        from.exactly(self.0.len(), "largest forces")?;
        for peak in &mut self.0 {
            let mut sums = [0.0; 4];
            from.f64s(&mut sums)?;
            [peak.force, peak.at_edges, peak.prescribed, peak.unbalanced] = sums;
            (peak.active, peak.few) = (from.u64()? as usize, from.u64()? as usize);
            (peak.step, peak.unbalanced_step) = (from.u32()?, from.u32()?);
            peak.crests = Crests::take(from)?;
        }
        for highest in &mut self.1 {
            let mut stress = [0.0];
            from.f64s(&mut stress)?;
            *highest = Stress {
                stress: stress[0],
                step: from.u32()?,
            };
        }
        let mut forces = [0.0; 2];
        from.f64s(&mut forces)?;
        self.2 = Rounded {
            force: forces[0],
            carried: forces[1],
            step: from.u32()?,
        };
        Ok(())
    }

    /// Takes an accepted step and its end, at which the forces of `totals` act, and all are balanced but for a part `residual` of
    /// them. Those along axes are, where the master is a rigid surface, all that act on it, as histories have them.
    pub fn step(
        &mut self,
        model: &Model,
        (step, time, residual): (u32, f64, f64),
        bearings: &Bearings,
        totals: &Totals,
    ) {
        let kink = (model.kinks.iter()).any(|k| (k - time).abs() <= 1e-9 * time);
        let carried = bearings.force();
        self.2.carried = self.2.carried.max(carried);
        if residual * carried > self.2.force {
            (self.2.force, self.2.step) = (residual * carried, step);
        }
        for (highest, stress) in self.1.iter_mut().zip(&bearings.stress) {
            if *stress > highest.stress {
                *highest = Stress {
                    stress: *stress,
                    step,
                };
            }
        }
        let pairs = model.pairs.iter().zip(&totals.pairs);
        let pairs = self.0.iter_mut().zip(&bearings.pairs).zip(pairs);
        for ((peak, sum), (pair, PairForce { slave, master })) in pairs {
            let Bearing {
                force,
                at_edges,
                prescribed,
                active,
                ..
            } = *sum;
            if force > 0.0 && force >= peak.force {
                *peak = Peak {
                    force,
                    at_edges,
                    prescribed,
                    active,
                    few: sum.few().unwrap_or(0),
                    step,
                    ..*peak
                };
            }
            let along = match pair.rigid_master() {
                // Friction on what vibrates comes and goes with the normal force, which is looked at already.
                Some(_) if model.dynamics.is_some() => Vec3::zeros(),
                Some(surface) => totals.surfaces[surface].force,
                None => slave.force,
            };
            peak.crests.step(step, time, (force, along), kink);
            let unbalanced = match pair.half {
                Some(half) if !half.back => (slave.force + master.force).norm(),
                _ => 0.0,
            };
            if unbalanced > peak.unbalanced {
                (peak.unbalanced, peak.unbalanced_step) = (unbalanced, step);
            }
        }
    }

    /// What the user is warned of at the end of a run.
    pub fn warnings(&self, model: &Model) -> Vec<String> {
        let largest = self.0.iter().fold(0.0f64, |most, p| most.max(p.force));
        let pairs = model.pairs.iter().zip(&self.0).enumerate();
        // Shares of what rounding makes of a contact say nothing.
        let pairs = pairs.filter(|(_, (_, peak))| peak.force > ROUNDING * largest);
        let of = |(index, (pair, peak)): (usize, (&PairModel, &Peak))| {
            // What edges bear as slaves they bear where they are.
            let mut edges = model.pairs.iter().zip(&self.0);
            let edges = edges.find(|(other, _)| other.edges_of == Some(index));
            [
                peak.at_edges(model, pair, edges.map_or(0.0, |(_, edges)| edges.force)),
                peak.prescribed(model, pair),
                peak.unbalanced(pair),
            ]
        };
        let told = pairs.flat_map(of).flatten();
        (told.chain(self.between_steps(model)))
            .chain(self.rounded())
            .collect()
    }

    /// The step whose contact is known least for want of digits.
    fn rounded(&self) -> Option<String> {
        let Rounded {
            force,
            step,
            carried,
        } = self.2;
        (force > RELIABLE * carried).then(|| {
            format!(
                "step {step} is balanced to {:.1e} of the forces of contact only, which is what rounding leaves: a penalty, a \
                 stiffness or a displacement is too large for double precision",
                force / carried
            )
        })
    }

    /// The largest force that is known least of those of contacts that carry much.
    fn between_steps(&self, model: &Model) -> Option<String> {
        let largest = (self.0.iter()).fold(0.0f64, |most, p| most.max(p.crests.force()));
        let pairs = model.pairs.iter().zip(&self.0);
        let worst = pairs.filter_map(|(pair, p)| Some((pair, p.crests.worst(LARGE * largest)?)));
        let (pair, (what, crest, part)) = worst.max_by(|(_, a), (_, b)| a.2.total_cmp(&b.2))?;
        let of = match pair.second_part() {
            None => "",
            Some("edges") => " at the edges of its master",
            Some(_) => " in the half pass with its sides exchanged",
        };
        Some(format!(
            "contact `{}`: its {what}{of} is largest at step {} (time {}), and changes so much from there to the steps beside it that it \
             may have been {:.0} % larger between them: take a smaller `solution.step.max` to see its peak",
            pair.name,
            crest.step,
            number(crest.time()),
            100.0 * part
        ))
    }

    /// What else is said at the end of a run, with displacements `u`.
    pub fn notes(&self, model: &Model, u: &[f64]) -> Vec<String> {
        let pairs = model.pairs.iter().zip(&self.0).enumerate();
        let few = pairs.filter_map(|(index, (pair, peak))| peak.few(model, index, pair));
        few.chain(self.yielded(model))
            .chain(law_range::notes(model, u))
            .collect()
    }

    /// Bodies of a metal of known strength whose stress passed it.
    fn yielded(&self, model: &Model) -> impl Iterator<Item = String> {
        let bodies = model.bodies.iter().zip(&self.1);
        bodies.filter_map(|(body, highest)| {
            let (metal, strength) = body.metal.filter(|(_, s)| highest.stress > *s)?;
            Some(format!(
                "body `{}`: its von Mises stress of {} at step {} passes the yield strength {} of `{metal}`: metal yields there, \
                 which an elastic law does not know",
                body.name,
                number(highest.stress),
                highest.step,
                number(strength)
            ))
        })
    }

    /// The same as it stands in the summary.
    /// `penalties` are those at the end, and the tangential ones over them; `friction` tells the error of a pair's friction.
    pub fn account(
        &self,
        model: &Model,
        [penalties, ratios]: [&[f64]; 2],
        friction: impl Fn(usize) -> f64,
    ) -> Vec<ContactAccuracy> {
        let pairs = model.pairs.iter().zip(&self.0);
        let pairs = pairs.zip(penalties.iter().zip(ratios));
        let pairs = pairs.enumerate();
        pairs
            .map(|(index, ((pair, peak), (eps, ratio)))| ContactAccuracy {
                name: pair.name.clone(),
                part: pair.second_part().map(str::to_owned),
                force: peak.force,
                step: peak.step,
                active: peak.active,
                few: (peak.few > 0).then_some(peak.few),
                edge_share: match peak.force > 0.0 {
                    true => peak.at_edges / peak.force,
                    false => 0.0,
                },
                penalty: *eps,
                tangential_penalty: ratio * eps,
                friction_error: friction(index),
            })
            .collect()
    }
}

impl Peak {
    /// A warning of what acts at edges; `as_slaves` is what these bear as slaves themselves at most (force).
    fn at_edges(&self, model: &Model, pair: &PairModel, as_slaves: f64) -> Option<String> {
        let spacing = sharp::spacing(model, pair);
        (self.at_edges > AT_EDGES * (self.force + as_slaves)).then(|| {
            format!(
                "contact `{}`: {:.0} % of its force at step {} acts within one spacing of slave points ({}) of sharp convex edges \
                 or tips of {}: force and pressure there depend on where the points happen to lie, and may move by many per cent \
                 with the mesh. Round them with a radius of at least {}, or refine the slave there and compare",
                pair.name,
                100.0 * self.at_edges / self.force,
                self.step,
                number(spacing),
                pair.master_words(model),
                number(2.0 * spacing)
            )
        })
    }

    fn prescribed(&self, model: &Model, pair: &PairModel) -> Option<String> {
        (self.prescribed > PRESCRIBED * self.force).then(|| {
            format!(
                "contact `{}`: {:.0} % of its force at step {} acts at points that supports hold where {} is moved into them: \
                 that is the penalty times a penetration that nothing can give way to, and no force of the bodies. Move the \
                 surface elsewhere, or take these faces out of the slave",
                pair.name,
                100.0 * self.prescribed / self.force,
                self.step,
                pair.master_words(model)
            )
        })
    }

    fn unbalanced(&self, pair: &PairModel) -> Option<String> {
        (self.unbalanced > UNBALANCED * self.force).then(|| {
            format!(
                "contact `{}`: the forces of its two half passes differ at step {} by {:.0} % of the largest force, and so far do the \
                 forces on its two sides: too few points carry them. Refine both sides there, or take one pass",
                pair.name,
                self.unbalanced_step,
                100.0 * self.unbalanced / self.force
            )
        })
    }

    fn few(&self, model: &Model, index: usize, pair: &PairModel) -> Option<String> {
        let slaves = match &pair.averaged {
            Some(nodes) => nodes.len(),
            None => pair.points.len(),
        };
        // All of the slave's points in contact: faces lie flat on each other, and no finer mesh is asked for.
        (self.few > 0 && self.active < slaves).then(|| {
            let what = match &pair.averaged {
                Some(_) => "nodes",
                None => "points",
            };
            format!(
                "contact `{}`: {} of the places of its {slaves} slave {what} carry 90 % of its force at step {}: fewer than {FEW} do \
                 not resolve how it is spread, pressures are those of the mesh, and forces may be. Refine the slave faces there \
                 (points are {} apart), or take more `points` a face",
                pair.name,
                self.few,
                self.step,
                number(point_spacing(model, index))
            )
        })
    }
}
