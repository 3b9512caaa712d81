//! A scene from file to results: what `covact run` and `covact check` do, without the printing.
mod check;
mod error;
mod fields;
mod history;

pub use check::{CheckReport, PairReport, check};
pub use error::RunError;

use crate::assembly::Assembler;
use crate::model::{self, Model, penalty};
use crate::output::{History, OutputError, Phases, Results, RunStatus, Summary, Versions};
use crate::output::{cpu_seconds, peak_memory_mb};
use crate::scene::{LoadedScene, Scene};
use crate::solve::event::{Event, Observer};
use crate::solve::linear::{DirectSolver, LinearSolver, SolverOptions};
use crate::solve::newton::{Converged, Newton, StepFailure, Workspace};
use crate::solve::state::State;
use crate::solve::stepping::Stepping;
use fields::Fields;
use std::path::Path;
use std::sync::atomic::AtomicBool;
use std::time::Instant;

/// Choices that are the caller's, not the scene's.
#[derive(Debug, Clone, Copy, Default)]
pub struct RunOptions {
    /// Threads; 0 takes the scene's number, and where that is 0 too, what the machine has.
    pub threads: usize,
}

/// Solves a scene and writes its results into the folder `out`. A run that does not reach its end returns its summary
/// with a status that says so: what was computed is kept.
///
/// # Errors
/// [`RunError`] where the scene or a file it names is wrong, or a result cannot be written.
pub fn run(
    scene: &LoadedScene,
    out: &Path,
    options: &RunOptions,
    observer: &mut (dyn Observer + Send),
    interrupt: &AtomicBool,
) -> Result<Summary, RunError> {
    let asked = match options.threads {
        0 => scene.scene.solution.threads as usize,
        n => n,
    };
    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(asked)
        .build()
        .map_err(|e| RunError::scene(scene, "/solution/threads", e.to_string()))?;
    let threads = pool.current_num_threads();
    pool.install(|| solve(scene, out, threads, observer, interrupt))
}

fn solve(
    loaded: &LoadedScene,
    out: &Path,
    threads: usize,
    observer: &mut (dyn Observer + Send),
    interrupt: &AtomicBool,
) -> Result<Summary, RunError> {
    let (wall, cpu) = (Instant::now(), cpu_seconds());
    let mut phases = Phases::new();
    phases.start("model");
    let model = model::build::build(loaded).map_err(|e| RunError::model(loaded, e))?;
    phases.stop("model");
    observer.event(&Event::Model {
        dofs: model.unknowns(),
        contact_points: model.contact_points(),
        effects: model.effects.clone(),
        notes: model.notes.clone(),
    });
    for text in &model.warnings {
        observer.event(&Event::Warning { text: text.clone() });
    }
    phases.start("analysis");
    let mut assembler = Assembler::new(&model, &model.dofs).map_err(|e| RunError::internal(&e))?;
    let mut solver = DirectSolver::new(SolverOptions {
        mode: mode(&loaded.scene),
        threads,
        ..SolverOptions::default()
    });
    let pattern = assembler.matrix().pattern().clone();
    solver
        .analyze(&pattern)
        .map_err(|e| RunError::internal(&e))?;
    phases.stop("analysis");
    let mut march = March {
        scene: &loaded.scene,
        model: &model,
        assembler: &mut assembler,
        solver: &mut solver,
        workspace: Workspace::new(&model),
        observer,
        interrupt,
        phases,
        warnings: model.warnings.clone(),
        iterations: 0,
        cuts: 0,
        steps: 0,
        time: 0.0,
        touched: vec![false; model.pairs.len()],
    };
    let (status, reason) = march.run(out)?;
    let March {
        phases,
        mut warnings,
        iterations,
        cuts,
        steps,
        time,
        ..
    } = march;
    warnings.dedup();
    let summary = Summary {
        status,
        reason,
        time,
        wall_s: wall.elapsed().as_secs_f64(),
        cpu_s: cpu_seconds().zip(cpu).map(|(now, then)| now - then),
        phases: phases.seconds(),
        peak_memory_mb: peak_memory_mb(),
        threads,
        dofs: model.unknowns(),
        contact_points: model.contact_points(),
        newton_iterations: iterations,
        steps,
        cuts,
        effects: model.effects.clone(),
        warnings,
        versions: Versions::default(),
    };
    summary.write(&out.join("summary.json"))?;
    observer.event(&Event::Finished {
        status: status.name().to_owned(),
        wall_s: summary.wall_s,
    });
    Ok(summary)
}

fn mode(scene: &Scene) -> crate::solve::linear::Mode {
    use crate::scene::LinearSolver as Choice;
    use crate::solve::linear::Mode;
    match scene.solution.linear_solver {
        Choice::Auto => Mode::Auto,
        Choice::Llt => Mode::Llt,
        Choice::Ldlt => Mode::Ldlt,
    }
}

/// The march through time.
struct March<'a, 'm> {
    scene: &'a Scene,
    model: &'m Model,
    assembler: &'a mut Assembler<'m>,
    solver: &'a mut DirectSolver,
    workspace: Workspace,
    observer: &'a mut (dyn Observer + Send),
    interrupt: &'a AtomicBool,
    phases: Phases,
    warnings: Vec<String>,
    iterations: u64,
    cuts: u32,
    steps: u32,
    time: f64,
    /// Pairs that were in contact at some accepted step.
    touched: Vec<bool>,
}

impl March<'_, '_> {
    fn run(&mut self, out: &Path) -> Result<(RunStatus, Option<String>), RunError> {
        let settings = &self.scene.solution;
        let mut results = Results::create(out)?;
        let mut table = History::create(&out.join("history.csv"), history::columns(self.model))?;
        let mut fields = Fields::new(self.model, self.scene.output.tessellation)?;
        for note in fields.notes() {
            self.warn(note);
        }
        let mut stepping = Stepping::new(
            settings.step,
            settings.end_time,
            &self.model.kinks,
            &settings.stops,
        );
        let mut committed = State::new(self.model);
        let mut trial = committed.clone();
        // The state before the last accepted step and that step's size, while the path is smooth.
        let mut before: Option<(State, f64)> = None;
        self.write(&mut results, &mut fields, &committed)?;
        while !stepping.done(self.time) {
            let end = stepping.next(self.time);
            let dt = end - self.time;
            let step = self.steps + 1;
            self.observer.event(&Event::StepStarted {
                step,
                time: end,
                dt,
            });
            let penalties = self.assembler.penalties.clone();
            let cuts_before = self.cuts;
            match &before {
                Some((state, size)) => committed.extrapolate(state, dt / size, &mut trial),
                None => trial.copy_from(&committed),
            }
            let mut attempt = self.step(step, end, &mut trial);
            if before.is_some() && matches!(&attempt, Err(f) if *f != StepFailure::Interrupted) {
                // The continued path may have led astray: once more from where the last step ended.
                self.assembler.penalties.copy_from_slice(&penalties);
                trial.copy_from(&committed);
                attempt = self.step(step, end, &mut trial);
            }
            match attempt {
                Ok(converged) => {
                    self.accept(step, end, &converged);
                    match &mut before {
                        Some((state, size)) => {
                            std::mem::swap(state, &mut committed);
                            *size = dt;
                        }
                        None => before = Some((committed.clone(), dt)),
                    }
                    committed.copy_from(&trial);
                    if stepping.at_kink(end) {
                        before = None;
                    }
                    stepping.accepted(converged.iterations);
                    let every = self.scene.output.every;
                    let last = stepping.done(self.time);
                    let wanted = every > 0 && (last || step.is_multiple_of(every));
                    self.phases.start("output");
                    fields.gather(self.model, &self.assembler.penalties, &committed, self.time)?;
                    let row = history::row(&history::Record {
                        model: self.model,
                        step,
                        time: self.time,
                        dt,
                        cuts: self.cuts - cuts_before,
                        converged: &converged,
                        residual: self.workspace.residual(),
                        fields: &fields,
                    });
                    table.push(&row)?;
                    self.phases.stop("output");
                    if wanted {
                        self.write(&mut results, &mut fields, &committed)?;
                    }
                }
                Err(StepFailure::Interrupted) => {
                    return Ok((
                        RunStatus::Interrupted,
                        Some("stopped by the user".to_owned()),
                    ));
                }
                Err(failure) => {
                    self.assembler.penalties = penalties;
                    self.cuts += 1;
                    let reason = failure.to_string();
                    let Some(next_dt) = stepping.failed(dt) else {
                        return Ok((
                            RunStatus::NotConverged,
                            Some(format!(
                                "step {step} from time {} failed at the smallest step size: {reason}",
                                self.time
                            )),
                        ));
                    };
                    self.observer.event(&Event::StepCut {
                        step,
                        dt,
                        next_dt,
                        reason,
                    });
                }
            }
        }
        let never: Vec<&str> = (self.touched.iter().zip(&self.model.pairs))
            .filter(|(touched, _)| !**touched)
            .map(|(_, pair)| pair.name.as_str())
            .collect();
        if never.is_empty() {
            return Ok((RunStatus::Done, None));
        }
        Ok((
            RunStatus::NoContact,
            Some(format!(
                "the surfaces of contact {} never touched: check the motion, the `side` and the `depth` of the surface",
                never.join(", ")
            )),
        ))
    }

    /// One step; an automatic penalty that lets a point sink in too far is raised, and the step solved on.
    fn step(&mut self, step: u32, end: f64, trial: &mut State) -> Result<Converged, StepFailure> {
        let mut iterations = 0;
        for _ in 0..4 {
            let converged = Newton {
                model: self.model,
                assembler: self.assembler,
                solver: self.solver,
                workspace: &mut self.workspace,
                settings: &self.scene.solution.newton,
                phases: &mut self.phases,
                interrupt: self.interrupt,
            }
            .solve(step, end, trial, self.observer);
            let mut converged = match converged {
                Ok(c) => c,
                Err(failure) => {
                    if let StepFailure::TooManyIterations { iterations, .. } = &failure {
                        self.iterations += u64::from(*iterations);
                    }
                    return Err(failure);
                }
            };
            self.iterations += u64::from(converged.iterations);
            iterations += converged.iterations;
            converged.iterations = iterations;
            let mut raised = false;
            for (i, pair) in self.model.pairs.iter().enumerate() {
                let allowed = penalty::TOLERATED * pair.element_size;
                let deepest = converged.totals.penetration[i];
                if pair.automatic && deepest > allowed {
                    let eps = self.assembler.penalties[i] * 2.0 * deepest / allowed;
                    self.assembler.penalties[i] = eps;
                    raised = true;
                    let text = format!(
                        "contact `{}`: penetration {deepest:.3e} above {allowed:.3e} (1 % of an element) at step {step}: \
                         automatic penalty raised to {eps:.6e}",
                        pair.name
                    );
                    self.observer.event(&Event::Warning { text: text.clone() });
                    self.warnings.push(text);
                }
            }
            if !raised {
                return Ok(converged);
            }
        }
        Err(StepFailure::PenetrationStays)
    }

    fn accept(&mut self, step: u32, end: f64, converged: &Converged) {
        self.steps = step;
        self.time = end;
        let mut first = 0;
        for (i, pair) in self.model.pairs.iter().enumerate() {
            let deepest = converged.totals.penetration[i];
            self.touched[i] |= deepest > 0.0;
            first += pair.points.len();
            let allowed = penalty::TOLERATED * pair.element_size;
            if !pair.automatic && deepest > allowed {
                self.warn(format!(
                    "contact `{}`: penetration above 1 % of an element ({allowed:.3e}) under the given penalty",
                    pair.name
                ));
            }
        }
        debug_assert_eq!(first, self.model.contact_points());
        if converged.negative_pivots > 0 {
            self.warn(format!(
                "step {step}: the tangent had {} negative pivot(s) on the way: the equilibrium may be unstable",
                converged.negative_pivots
            ));
        }
        self.observer.event(&Event::StepAccepted {
            step,
            time: end,
            iterations: converged.iterations,
            active: converged.totals.active,
            penetration: converged
                .totals
                .penetration
                .iter()
                .fold(0.0, |a, b| a.max(*b)),
        });
    }

    /// Reports a warning once.
    fn warn(&mut self, text: String) {
        if !self.warnings.contains(&text) {
            self.observer.event(&Event::Warning { text: text.clone() });
            self.warnings.push(text);
        }
    }

    fn write(
        &mut self,
        results: &mut Results,
        fields: &mut Fields,
        state: &State,
    ) -> Result<(), RunError> {
        if self.scene.output.every == 0 {
            return Ok(());
        }
        self.phases.start("output");
        if self.steps == 0 {
            fields.gather(self.model, &self.assembler.penalties, state, 0.0)?;
        }
        let written = fields.write(self.model, results, self.steps, self.time, state);
        self.phases.stop("output");
        written.map_err(|e: OutputError| RunError::from(e))
    }
}
