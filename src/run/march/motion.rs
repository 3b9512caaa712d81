//! Steps of bodies with inertia: how long they may be, and what is told of their energy.
use super::March;
use crate::effects::inertia::MotionEnergy;
use crate::model::error::number;
use crate::model::state::State;
use crate::run::watch::Work;
use crate::scene::ContactTiming;
use crate::solve::newton::StepFailure;
use crate::solve::stepping::Stepping;

/// Multiple of the error that a step is to make above which it is taken back.
const TOO_LARGE: f64 = 4.0;
/// The next step, by the error of the last one: a part of what would make the error asked for, and its bounds.
const SAFETY: f64 = 0.9;
const NEXT: [f64; 2] = [0.3, 2.0];
/// Part of the points of a pair that have to open or close for the step to be an event: accelerations jump in it.
const EVENT: f64 = 0.05;
/// Times that a step in which contact opens or closes is shortened for its error: in contact that lasts, and at a first touch.
const CUTS: [u32; 2] = [1, 6];
/// Part of the greatest energy that the integration may take in a step in which bodies touch: an impact is over within a few steps.
/// One that is cut and then takes as much in the same time, but for the factor, is not made better by shorter ones: what it damps are
/// vibrations of the mesh.
const TAKEN: f64 = 0.01;
const HELPS: f64 = 0.7;
const SHORTER: [f64; 2] = [0.25, 0.7];
/// Part of the size of the model that the largest displacement counts as at least: below it rounding is all there is.
const SMALL: f64 = 1e-8;
/// Part of the time of a run below which no step is too long in which the largest displacement more than doubles: at the start of
/// a motion from rest all errors are as large as what they are compared with, however short the step.
const BEGINS: f64 = 1e-4;
/// Part of the greatest energy that the integration may gain without a word, and that it may take: of the speeds it is half.
const GAINS: f64 = 0.01;
const TAKES: f64 = 0.04;

/// Steps, times the circular frequency of a penalty on the lightest node, above which contact must not be weighted.
const WEIGHTED: f64 = 0.3;

/// What is known of the motion in a step that is solved.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Moved {
    /// Energies at its end.
    pub energy: MotionEnergy,
    /// The shortest time that a wave takes along an element of a pair many of whose points open or close; infinite without.
    event: f64,
    /// Such a pair touches for the first time, or again.
    touches: bool,
    /// Error of the step over the one that it is to make.
    error: f64,
    /// The largest displacement has more than doubled.
    begins: bool,
    /// Part of the greatest energy that its integration takes while bodies touch.
    taken: f64,
    /// No longer than a wave takes along an element.
    short: bool,
}

impl Moved {
    /// Size of the next step, or of this one once more, over its own.
    fn next(&self) -> f64 {
        match self.error > 0.0 {
            true => (SAFETY / self.error.cbrt()).clamp(NEXT[0], NEXT[1]),
            false => NEXT[1],
        }
    }
}

impl Moved {
    /// The same, by the energy that is taken while bodies touch.
    fn paced(&self) -> f64 {
        let least = if self.short { 1.0 } else { NEXT[0] };
        match self.taken > 0.0 {
            true => (SAFETY * (TAKEN / self.taken).cbrt()).clamp(least, NEXT[1]),
            false => NEXT[1],
        }
    }
}

impl March<'_, '_> {
    /// Looks at the motion of a step; nothing without inertia.
    pub(super) fn moved(&self, committed: &State, trial: &State) -> Option<Moved> {
        let (inertia, own) = (
            self.assembler.effects.inertia.as_ref()?,
            self.model.dynamics.as_ref()?,
        );
        let (mut event, mut touches) = (f64::INFINITY, false);
        let mut first = 0;
        for (index, wave) in own.waves.iter().enumerate() {
            let points = first..first + trial.slaves(self.model, index).len();
            first = points.end;
            let count = points.len() as f64;
            let (before, now) = (&committed.points[points.clone()], &trial.points[points]);
            let switched = before.iter().zip(now).filter(|(a, b)| a.closed != b.closed);
            if switched.count() as f64 > EVENT * count {
                event = event.min(*wave);
                touches |= before.iter().all(|p| !p.closed);
            }
        }
        let [error, farthest] = inertia.local_error(&trial.u);
        let allowed = own.settings.tolerance * farthest.max(SMALL * own.size);
        Some(Moved {
            energy: inertia.energy(self.model, &trial.u),
            event,
            touches,
            error: error / allowed,
            begins: farthest > 2.0 * inertia.motion().farthest,
            taken: 0.0,
            short: false,
        })
    }

    /// Why a step of size `dt` that is solved, after so many `cuts`, is too long for its motion. Where contact opens or closes the
    /// accelerations jump, and with them the error that is told: such a step is shortened a few times where it is the first touch,
    /// else once, and never below the time that a wave takes along an element.
    pub(super) fn too_long(
        &self,
        moved: &Moved,
        (dt, cuts): (f64, u32),
        stepping: &Stepping,
    ) -> Option<StepFailure> {
        let adaptive = self.scene.solution.step.adaptive;
        let most = CUTS[usize::from(moved.touches)];
        let short = moved.event.is_finite() && (dt <= moved.event || cuts >= most);
        let begins = moved.begins && dt <= BEGINS * self.scene.solution.end_time;
        let fine = moved.error <= TOO_LARGE || short || begins || stepping.smallest(dt);
        let tolerance = self.model.dynamics.as_ref()?.settings.tolerance;
        (adaptive && !fine).then_some(StepFailure::TooLong {
            error: moved.error * tolerance,
            allowed: TOO_LARGE * tolerance,
            part: moved.next(),
        })
    }

    /// Why a step of size `dt` that is solved, after so many `cuts`, takes too much energy while bodies touch: accelerations turn within
    /// less than the step there, and displacements, which fell for long before, hardly tell. `before` is what the last attempt took by
    /// the time it took.
    pub(super) fn damped(
        &self,
        moved: &mut Moved,
        (dt, cuts, before): (f64, u32, &mut Option<f64>),
        (work, energy, touching): (&Work, f64, &[bool]),
        stepping: &Stepping,
    ) -> Option<StepFailure> {
        let own = self.model.dynamics.as_ref()?;
        let greatest = self.assembler.effects.inertia.as_ref()?.motion().greatest;
        let greatest = greatest.max(self.watch.external.abs());
        let touch = |i: &usize| touching[*i] || self.touching[*i];
        let touch = (0..own.waves.len()).filter(touch);
        let wave = touch.map(|i| own.waves[i]).fold(f64::INFINITY, f64::min);
        if work.changed || greatest <= 0.0 || wave == f64::INFINITY {
            return None;
        }
        moved.taken = (self.watch.lost(work, energy) / greatest).max(0.0);
        moved.short = dt <= wave;
        let adaptive = self.scene.solution.step.adaptive;
        if moved.taken <= TAKEN
            || moved.short
            || cuts >= CUTS[1]
            || !adaptive
            || stepping.smallest(dt)
        {
            return None;
        }
        let rate = moved.taken / dt;
        let helps = before.replace(rate).is_none_or(|last| rate < HELPS * last);
        helps.then(|| StepFailure::Damped {
            taken: moved.taken,
            part: moved.paced().clamp(SHORTER[0], SHORTER[1]),
        })
    }

    /// Accepts a step of size `dt` to `u`, with this strain energy at its end, and chooses the size of the next one.
    pub(super) fn move_on(
        &mut self,
        moved: &Moved,
        (u, dt): (&[f64], f64),
        (internal, iterations): (f64, u32),
        stepping: &mut Stepping,
    ) {
        let event = moved.event.is_finite();
        let factor = match event {
            // Its error says nothing of the next one.
            true => moved.next().max(1.0),
            false => moved.next(),
        };
        let factor = factor.min(moved.paced());
        stepping.paced(dt, factor, iterations);
        if let Some(inertia) = &mut self.assembler.effects.inertia {
            inertia.commit(u, moved.energy, internal, event);
        }
    }

    /// Tells where contact that is weighted between the ends of a step of size `dt` is too stiff for it.
    pub(super) fn tell_weighted(&mut self, step: u32, dt: f64) {
        let Some(own) = self.model.dynamics.as_ref() else {
            return;
        };
        if own.settings.contact != ContactTiming::Weighted {
            return;
        }
        for (index, pair) in self.model.pairs.iter().enumerate() {
            let square = self.assembler.penalties[index] * own.lightest[index];
            if self.touching[index] && square.sqrt() * dt > WEIGHTED {
                let text = format!(
                    "contact `{}` is weighted between the ends of the step (`solution.dynamics.contact`), which is more than \
                     {WEIGHTED} over the frequency of its penalty: it may vibrate and gain energy; take steps below {}, a softer \
                     `penalty`, or `implicit` contact",
                    pair.name,
                    number(WEIGHTED / square.sqrt())
                );
                self.warn_of_step(step, &text);
            }
        }
    }

    /// Tells at the end of energy that came from nowhere, and of what the integration has taken. While a run begins all that there is
    /// is as small as the errors of its sums.
    pub(super) fn tell_energy(&mut self, last: bool) {
        let (Some(inertia), true) = (&self.assembler.effects.inertia, last) else {
            return;
        };
        let (greatest, lost) = (inertia.motion().greatest, self.watch.imbalance);
        let greatest = greatest.max(self.watch.external.abs());
        let (gained, step) = (self.watch.gained, self.watch.gained_step);
        if gained > GAINS * greatest {
            self.warn(format!(
                "the time integration had gained {} by step {step}, {:.0} % of the greatest energy: take smaller steps \
                 (`solution.dynamics.tolerance`, `solution.step.max`)",
                number(gained),
                100.0 * gained / greatest
            ));
        }
        if lost > TAKES * greatest {
            self.warn(format!(
                "the time integration has taken {} in all, {:.0} % of the greatest energy: what moves too fast for the steps is \
                 damped, and at impacts penalties act as dampers; take smaller steps (`solution.dynamics.tolerance`, \
                 `solution.step.max`) to see what of it remains",
                number(lost),
                100.0 * lost / greatest
            ));
        }
    }
}
