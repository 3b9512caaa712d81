//! From one stage of the scene to the next: the run goes on with another model.
use super::joined::take_out;
use super::{Running, Simulation};
use crate::output::RunStatus;
use crate::run::RunError;
use crate::run::history;
use crate::run::march::{Problem, RunState};
use crate::scene::{self, LoadedScene, Scene, Stage};

impl Simulation<'_> {
    /// Goes on to the next stage, where the last accepted step ended one.
    ///
    /// # Errors
    /// A body that nothing holds in the stage, what has no room in memory, or a fault of the program.
    pub(super) fn enter_stage(&mut self) -> Result<(), RunError> {
        if !self.run_state().stage_is_over() {
            return Ok(());
        }
        let loaded = self.running.borrow_owner().loaded.clone();
        self.go_on_with(loaded)
    }

    /// Ends the present stage at the last accepted step and goes on in another one, which becomes the last of the run: it replaces
    /// those of the scene that were to come, and the run ends with it. Tools and loads go on from where they are to what the
    /// stage says for its end. So a program that steps a run decides from its results what comes next.
    ///
    /// The scene needs [stages](crate::scene::Stage), at least one. A run that begins again ([`Step::attempt`](super::Step)) has the
    /// stages that were begun at the times at which they were. Checkpoints are those of the scene as it was given: a run that
    /// is continued from its folder goes on from the last step before.
    ///
    /// # Errors
    /// [`RunError::Scene`]: the run has no stage that could end (it has no stages, has taken no step, or has ended), or the new
    /// stage is wrong; the run is then as it was. Otherwise what has no room in memory, or a fault of the program.
    ///
    /// ```
    /// use covact::run::{Options, Simulation};
    /// use covact::scene::{self, Stage};
    /// let scene = scene::parse(
    ///     r#"{
    ///         "covact": 1,
    ///         "materials": { "rubber": { "neo_hooke": { "E": 2, "nu": 0.45 } } },
    ///         "bodies": {
    ///             "block": { "mesh": { "block": { "min": [0, 0, -2], "max": [4, 4, 0], "elements": [4, 4, 2] } }, "material": "rubber" }
    ///         },
    ///         "surfaces": { "ball": { "sphere": { "radius": 5, "center": [2, 2, 5] }, "side": "outward" } },
    ///         "contacts": { "press": { "slave": "block.top", "master": "ball" } },
    ///         "supports": { "ground": { "on": "block.bottom", "fixed": true } },
    ///         "stages": [{ "name": "down", "tools": { "ball": [0, 0, -1] } }]
    ///     }"#,
    ///     "press.json",
    /// )?;
    /// let mut simulation = Simulation::new(scene, Options::default())?;
    /// while simulation.force("ball").is_err() || simulation.force("ball")?.force.z > -1.0 {
    ///     simulation.step()?.expect("the run has a step");
    /// }
    /// // Deep enough: back to where it came from.
    /// let mut up = Stage { name: "up".into(), until: Some(simulation.time() + 1.0), ..Stage::default() };
    /// up.tools.insert("ball".into(), [0.0; 3]);
    /// simulation.begin_stage(up)?;
    /// while simulation.step()?.is_some() {}
    /// assert!(simulation.done() && simulation.force("ball")?.force.z.abs() < 1e-6);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn begin_stage(&mut self, stage: Stage) -> Result<(), RunError> {
        let wrong = |text: &str| Err(RunError::scene(&self.scene, "/stages", text.to_owned()));
        let time = self.time();
        let Some(now) = &self.model().stage else {
            return wrong("the scene has no stages, of which one could end: give it a first one");
        };
        let status = self.status();
        // A run that is repeated takes the new stage along, which begins at the same time.
        let repeated = status == Some(RunStatus::NotConverged) && self.closed.is_none();
        if !(repeated || matches!(status, None | Some(RunStatus::Interrupted))) {
            return wrong("the run has ended: no stage follows it");
        }
        // A stage that ends here by itself has ended; the one after it has not begun.
        let [from, _] = now.span;
        if time <= from {
            return wrong("the present stage has taken no step yet, so that it cannot end");
        }
        let index = now.start.index;
        let mut scene = self.scene.clone();
        cut(&mut scene.scene, index, time, stage);
        // The history has columns for supports that are found, or it has none.
        match [&self.scene, &scene].map(|s| s.scene.finds_supports()) {
            [false, true] => {
                return wrong(
                    "the new stage would find supports, which the scene does not: list its `supports`, or let a stage of the \
                     scene find some",
                );
            }
            [true, false] => {
                return wrong(
                    "the scene finds supports in a stage that was to come, and so has to the new one: list `automatic` among its \
                     `supports`",
                );
            }
            _ => {}
        }
        RunError::of(scene::check(&scene))?;
        let mut loaded = self.running.borrow_owner().loaded.clone();
        (loaded.scene.stages).clone_from(&scene.scene.stages);
        loaded.scene.solution.end_time = scene.scene.solution.end_time;
        let joined = self.safe.as_ref().map_or(&[][..], |safe| &safe.joined);
        take_out(&mut loaded.scene.stages, joined);
        if !repeated {
            let observer = &mut *self.options.observer;
            (self.running).with_dependent_mut(|_, run| run.end_stage(observer, true));
            let pool = std::sync::Arc::clone(&self.pool);
            pool.install(|| self.go_on_with(loaded.clone()))?;
        }
        if let Some(safe) = &mut self.safe {
            safe.loaded = loaded;
        }
        (self.scene, self.steered) = (scene, true);
        Ok(())
    }

    /// Goes on in the next stage of a scene.
    fn go_on_with(&mut self, loaded: LoadedScene) -> Result<(), RunError> {
        let mut hand = (self.running).with_dependent_mut(|_, run| run.hand_over(&loaded.scene))?;
        let Problem {
            plan,
            replaceable,
            exchangeable,
            sides_may,
            may_see,
            patience,
            changes,
            ..
        } = &**self.running.borrow_owner();
        let (mut model, state) = hand.next(&loaded)?;
        model.warnings.clone_from(&self.model().warnings);
        if history::columns(&model) != self.history.columns {
            let text = "a stage has other columns of the history than the first".to_owned();
            return Err(RunError::Internal(text));
        }
        let problem = Box::new(Problem {
            loaded,
            model,
            plan: plan.clone(),
            replaceable: replaceable.clone(),
            exchangeable: *exchangeable,
            sides_may: *sides_may,
            may_see: may_see.clone(),
            patience: *patience,
            changes: changes.clone(),
        });
        let (threads, observer) = (rayon::current_num_threads(), &mut *self.options.observer);
        self.running = Running::try_new(problem, |problem| {
            RunState::enter(problem, hand, state, threads, observer)
        })?;
        Ok(())
    }
}

/// Ends a stage at a time within it and lets another follow as the last.
fn cut(scene: &mut Scene, index: usize, time: f64, next: Stage) {
    let [from, to] = scene.stage_span(index);
    let part = ((time - from) / (to - from)).min(1.0);
    let (before, now) = scene.stages.split_at_mut(index);
    for (name, way) in &mut now[0].tools {
        let start = before.iter().rev().find_map(|s| s.tools.get(name));
        for (c, end) in way.iter_mut().enumerate() {
            let start = start.map_or(0.0, |way| way[c]);
            *end = start + part * (*end - start);
        }
    }
    for (name, end) in &mut now[0].loads {
        let start = before.iter().rev().find_map(|s| s.loads.get(name));
        let start = start.copied().unwrap_or(0.0);
        *end = start + part * (*end - start);
    }
    now[0].until = Some(time);
    scene.stages.truncate(index + 1);
    if let Some(until) = next.until {
        scene.solution.end_time = until;
    }
    scene.stages.push(next);
}
