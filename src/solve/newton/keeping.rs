//! Points that are kept in contact where an iterate opens them, or taken to stick where they slide to and fro, for the linearisation
//! that follows.
use super::{MANY_OPENED, MOST_OPEN, Newton, SECANTS};
use crate::assembly::{Fault, Linearization, Totals};
use crate::contact::friction::law::Slide;
use crate::model::state::{PointState, State};
use crate::solve::convergence::Verdict;
use crate::system::linear::LinearSolver;

impl<S: LinearSolver + ?Sized> Newton<'_, '_, S> {
    /// The first linearisation, and the number of those that take secants.
    pub(super) fn begin(
        &mut self,
        trial: &mut State,
        time: f64,
        pending: bool,
    ) -> Result<(Totals, u32), Fault> {
        let secants = if self.first.secants { SECANTS } else { 0 };
        self.assembler.linearization = Linearization {
            keep_active: false,
            slide: Slide::secant(secants > 0),
            keep_facets: false,
        };
        self.workspace.base.points.clone_from(&trial.points);
        self.assembler.begin_solution();
        let totals = self.linearize(trial, time, (pending, false));
        let before = &self.workspace.base.points;
        let pressed = || before.iter().filter(|point| point.closed).count();
        let (opened, most) = match &totals {
            Ok(totals) => (
                totals.opened > 0 || MANY_OPENED * totals.opened_on_bodies > pressed(),
                MOST_OPEN * totals.active < pressed(),
            ),
            // What has opened may have been all that holds a surface driven by force.
            Err(_) => {
                let switched = trial.points != *before;
                (switched, switched)
            }
        };
        self.opened = opened;
        let mut keeps = self.first.hold && opened || self.first.keep && most;
        if let (true, false, Ok(totals)) = (keeps, pending, &totals) {
            // In equilibrium without them: what lies on its master before anything moves is not to be held by rounding.
            let verdict = self
                .norms(trial, totals)
                .judge(self.settings.tolerance, true);
            keeps = verdict != Verdict::Converged;
        }
        if !keeps {
            return Ok((totals?, secants));
        }
        trial.points.copy_from_slice(&self.workspace.base.points);
        self.assembler.linearization = Linearization {
            keep_active: true,
            slide: Slide::Secant,
            keep_facets: false,
        };
        Ok((self.linearize(trial, time, (pending, false))?, SECANTS))
    }

    /// Linearises with the points that switched in the last iteration kept in contact, where that can be done.
    pub(super) fn keep(&mut self, trial: &mut State, time: f64) -> Result<Option<Totals>, Fault> {
        let now = trial.points.clone();
        let kept = self.kept(trial, time);
        if kept.is_none() && trial.points != now {
            trial.points = now;
            self.linearize(trial, time, (false, false))?;
        }
        Ok(kept)
    }

    /// [`Newton::keep`], with nothing to go on with where a point cannot be kept.
    pub(super) fn kept(&mut self, trial: &mut State, time: f64) -> Option<Totals> {
        let now: Vec<PointState> = trial.points.clone();
        for (point, before) in trial.points.iter_mut().zip(&self.workspace.base.points) {
            point.closed |= before.closed;
        }
        if trial.points == now {
            return None;
        }
        let linearization = self.assembler.linearization;
        self.assembler.linearization = Linearization {
            keep_active: true,
            slide: Slide::Secant,
            keep_facets: false,
        };
        let kept = self.linearize(trial, time, (false, false)).ok();
        if kept.is_none() {
            self.assembler.linearization = linearization;
        }
        kept
    }

    /// Linearises with the points that slide to and fro taken to stick; none where there is none. Between its two directions a point
    /// sticks, over a way so short under a stiff penalty that full steps pass it each time. One that does not stick in the end
    /// slides on from there in its own direction.
    pub(super) fn stick(&mut self, trial: &mut State, time: f64) -> Result<Option<Totals>, Fault> {
        if !self.assembler.oscillates() {
            return Ok(None);
        }
        self.assembler.linearization = Linearization {
            slide: Slide::Stick,
            ..Linearization::default()
        };
        self.linearize(trial, time, (false, false)).map(Some)
    }
}
