//! What a run says of its stabilisation.
use super::march::{Ending, March};
use crate::assembly::Drag;
use crate::model::error::number;
use crate::model::stabilization::{DISSIPATES, RESTS};
use crate::model::state::State;
use crate::output::RunStatus;
use crate::solve::newton::{Converged, StepFailure};
use std::collections::HashSet;

/// Part of the size of the model that a body without supports may move in the time of a run and still be at rest, and the
/// part of [`RESTS`] that the stabilisation has to carry for it to be told.
const MOVES: f64 = 0.05;
/// Part of the largest forces of a run from which on those at its end are taken for what acts there.
const REMEMBERED: f64 = 0.01;

impl March<'_, '_> {
    /// Ends a run whose body runs away, and says at the end whether the answer rests on the stabilisation.
    pub(super) fn stabilized(
        &mut self,
        state: &State,
        drag: &Drag,
        converged: &Converged,
        last: bool,
    ) -> Option<Ending> {
        let model = self.model.stabilization.as_ref()?;
        if drag.share > RESTS
            && let Some((piece, way)) = model.run_away(&state.u)
        {
            let failure = StepFailure::RunsAway {
                body: piece.motion.body.clone(),
                motion: piece.motion.motion.clone(),
                reached: format!(
                    "at time {} it is ({}, {}, {}) away from where it started, {:.0} times the size of the model; \
                     stabilization alone slows it",
                    number(self.progress.time),
                    number(way.x),
                    number(way.y),
                    number(way.z),
                    way.norm() / model.size
                ),
                loaded: self.model.loaded(),
            };
            let reason = Some(failure.to_string());
            return Some(Ending::new(RunStatus::NotConverged, reason));
        }
        if !last {
            return None;
        }
        // What flows, slides or is released stores little of what was done on it.
        let later = self.model.stage.as_ref().is_some_and(|s| s.start.index > 0);
        let slides = self.model.pairs.iter().any(|p| p.friction.is_some());
        let (all, name) = match later || slides || converged.totals.plastic_work > 0.0 {
            true => (self.watch.turned_over(), "work"),
            // Of what was loaded and let go again no strain is left at the end.
            false => {
                let most = 0.5 * self.watch.turned_over();
                match converged.totals.internal_energy {
                    strain if strain >= most => (strain, "strain energy"),
                    _ => (most, "work"),
                }
            }
        };
        if state.stabilized > DISSIPATES * all {
            self.warn(format!(
                "stabilization has dissipated {}, more than {:.0} % of the {name} {} at the end: something snapped or \
                 moved freely, or its `factor` is too large",
                number(state.stabilized),
                100.0 * DISSIPATES,
                number(all)
            ));
        }
        let moving = model.free.iter().find_map(|piece| {
            let viscous = self.assembler.effects.viscous.as_ref()?;
            let mut velocity = viscous.velocity(&state.u, &piece.motion.nodes);
            // What is prescribed moves as it is meant to.
            let nodes: HashSet<u32> = piece.motion.nodes.iter().copied().collect();
            for p in self.model.prescribed.iter().filter(|p| p.value.is_some()) {
                if nodes.contains(&(p.dof / 3)) {
                    velocity[p.dof as usize % 3] = 0.0;
                }
            }
            let way = velocity * self.scene.solution.end_time;
            let slides = way.norm() > MOVES * model.size && drag.share > MOVES * RESTS;
            slides.then_some((piece, velocity))
        });
        if let Some((piece, v)) = moving {
            self.warn(format!(
                "the answer rests on the stabilization: body `{}` still moves at the end, at ({}, {}, {}) in a unit of time, \
                 and no support hinders it {}: hold it, or read what follows as one moment of its way",
                piece.motion.body,
                number(v.x),
                number(v.y),
                number(v.z),
                piece.motion.motion
            ));
        } else if drag.share * self.loaded(converged) > RESTS {
            self.warn(format!(
                "the answer rests on the stabilization: at the end its forces are {:.2e} of the others, more than {RESTS}: \
                 something still moves; give it time to come to rest, hold it, or take a smaller `factor`",
                drag.share
            ));
        }
        None
    }

    /// How much of what once acted still does, from 0 to 1: where next to nothing is left, no answer rests on what holds the rest.
    fn loaded(&self, converged: &Converged) -> f64 {
        let once = REMEMBERED * self.workspace.largest_force;
        converged.force / once.max(converged.force).max(f64::MIN_POSITIVE)
    }
}
