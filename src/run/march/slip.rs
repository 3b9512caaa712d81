//! Tangential penalties: what they leave of friction at a step, and what they are at the next one.
use super::March;
use crate::contact::friction::history::PointHistory;
use crate::model::PairModel;
use crate::model::friction::FrictionModel;
use crate::model::state::State;
use crate::run::RunError;
use crate::run::bearing::{Bearing, Bearings};
use crate::scene::ValueError;
use crate::solve::newton::{Converged, StickLimit};

/// Iterations of a step, those of failed attempts included, above which tangential penalties are softened.
const STRUGGLES: u32 = 16;
/// Factor by which they are softened at most after one step: what it struggled with may have been something else.
const SOFTER: f64 = 0.1;

impl March<'_, '_> {
    /// What rigid sticking would change, per pair, where it is `due`; empty without friction, and where it cannot be measured.
    pub(super) fn sticking(
        &mut self,
        due: bool,
        state: &State,
        histories: &[PointHistory],
        bearings: &Bearings,
        time: f64,
    ) -> Result<Vec<StickLimit>, RunError> {
        if !due || self.model.pairs.iter().all(|p| p.friction.is_none()) {
            return Ok(Vec::new());
        }
        self.phases.start("accuracy");
        let found = self.workspace.stick_limits(
            self.model,
            self.assembler,
            self.solver,
            (state, histories),
            time,
        );
        self.phases.stop("accuracy");
        let found = found.ok().flatten().unwrap_or_default();
        let pairs = self.model.pairs.iter().zip(&bearings.pairs).zip(found);
        let friction = |((pair, bearing), limit): ((&PairModel, &Bearing), StickLimit)| {
            let area = bearing.area;
            let largest = match &pair.friction {
                Some(model) if area > 0.0 => area * model.largest(bearing.force / area, time)?,
                _ => 0.0,
            };
            // Rigid sticking adds no more than there is to sliding.
            let room = (largest - limit.friction).max(0.0);
            Ok(StickLimit {
                missing: limit.missing.min(room),
                ..limit
            })
        };
        let found: Result<_, ValueError> = pairs.map(friction).collect();
        found.map_err(|e| RunError::internal(&e))
    }

    /// Takes down how the direction of friction turned in the step that was accepted last; the part that acts aside by it.
    pub(super) fn headed(
        &mut self,
        before: &Option<(State, f64)>,
        (now, start, end): (&State, f64, f64),
        turns: bool,
    ) -> Result<f64, RunError> {
        let Some((before, _)) = before else {
            return Ok(0.0);
        };
        if self.model.pairs.iter().all(|p| p.friction.is_none()) {
            return Ok(0.0);
        }
        let of = (self.model, &mut self.assembler.masters);
        (self.watch.headed(of, (before, start), (now, end), turns))
            .map_err(|e| RunError::internal(&e))
    }

    /// Tells where the flow of a material or friction turned too far within steps.
    pub(super) fn tell_turns(&mut self) {
        for text in [self.watch.lagging(), self.watch.turned(self.model)] {
            text.into_iter().for_each(|text| self.warn(text));
        }
    }

    /// Raises the tangential penalties of the next step, where the run may, by what was measured of the elastic slip, and softens
    /// them after a step with friction that took many iterations.
    pub(super) fn adapt_slip(
        &mut self,
        bearings: &Bearings,
        time: f64,
        converged: &Converged,
        sticking: &[StickLimit],
    ) -> Result<(), ValueError> {
        let forces = bearings.pairs.iter().map(|b| b.force);
        let struggles = converged.iterations + self.failed > STRUGGLES;
        let factors = (self.compliance.sticking).step(
            sticking,
            forces,
            (self.progress.steps, time),
            struggles,
        );
        let ratios = self.assembler.ratios.iter_mut();
        let pairs = (self.model.pairs.iter().zip(&bearings.pairs)).zip(factors);
        let pairs = pairs.zip(ratios.zip(&self.assembler.penalties));
        for (((pair, bearing), factor), (ratio, eps_n)) in pairs {
            let Some(friction) = pair.friction.as_ref().filter(|f| f.ruled) else {
                continue;
            };
            let raised = (*ratio * factor).min(stiffest(pair, friction, *eps_n));
            if raised > *ratio {
                *ratio = raised;
            } else if struggles && bearing.force > 0.0 {
                // That under which friction is carried: the mean over a wide holder says nothing of the edge that a sheet is drawn over.
                let pressure = bearing.squared / bearing.force;
                let suits = friction.suitable(pressure, *eps_n, pair.element_size, time)?;
                *ratio = suits.map_or(*ratio, |suits| suits.max(SOFTER * *ratio));
            }
        }
        Ok(())
    }

    /// Tangential penalties that are given stay what they are, whatever the normal ones are now, and those that the run chooses
    /// within their bounds.
    pub(super) fn hold_given(&mut self) {
        let ratios = self
            .assembler
            .ratios
            .iter_mut()
            .zip(&self.assembler.penalties);
        for (pair, (ratio, eps_n)) in self.model.pairs.iter().zip(ratios) {
            let Some(friction) = &pair.friction else {
                continue;
            };
            if let Some(eps_t) = friction.given {
                *ratio = eps_t / eps_n;
            } else if friction.ruled {
                *ratio = ratio.min(stiffest(pair, friction, *eps_n));
            }
        }
    }
}

/// The largest multiple of a normal penalty that a tangential one is raised to. Friction may need a stiff one where the normal one
/// serves as it is: a ring that gives way when it is squeezed hardly does along the line where it sticks. It is not to be stiffer
/// than the stiffest normal one would make it.
fn stiffest(pair: &PairModel, friction: &FrictionModel, eps_n: f64) -> f64 {
    let times = pair.ruled.map_or(1.0, |ruled| ruled.stiffest / eps_n);
    friction.ratio * times.max(1.0)
}
