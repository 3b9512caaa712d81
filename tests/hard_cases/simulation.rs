//! Runs in memory: stepped from outside they are those of [`run`](covact::run::run) to the last bit, with watchdogs, penalties
//! that the run chooses, elements that are replaced, and interruptions.
use crate::support::{Outcome, scene_json, set, solve};
use covact::output::{RunStatus, Summary};
use covact::run::{
    Opened, Options, ReadError, ResultsFolder, RunError, RunOptions, Simulation, Sink, StepError,
    open,
};
use covact::scene::{self, LoadedScene};
use covact::solve::event::{Event, Observer};
use serde_json::{Value, json};
use std::sync::atomic::{AtomicBool, Ordering};

fn loaded(scene: &Value) -> LoadedScene {
    let text = serde_json::to_string_pretty(scene).expect("serialisable");
    let mut loaded = scene::parse(&text, "scene.json").expect("valid scene");
    loaded.dir = "examples/scenes".into();
    // As in runs that these are compared with.
    loaded.scene.output.full_precision = true;
    loaded
}

fn simulation(scene: &Value) -> Simulation<'static> {
    Simulation::new(loaded(scene), Options::default()).expect("valid model")
}

/// Steps to the end.
fn stepped(scene: &Value) -> Simulation<'static> {
    let mut simulation = simulation(scene);
    while simulation.step().expect("an equilibrium").is_some() {}
    assert!(simulation.done());
    simulation
}

fn same(simulation: &Simulation, outcome: &Outcome) {
    let (a, b) = (simulation.history(), &outcome.history);
    assert_eq!(a.columns, b.columns);
    let bits = |rows: &[Vec<f64>]| -> Vec<Vec<u64>> {
        let of = |row: &Vec<f64>| row.iter().map(|x| x.to_bits()).collect();
        rows.iter().map(of).collect()
    };
    assert!(a.rows.len() > 1);
    assert_eq!(bits(&a.rows), bits(&b.rows));
    let [mut a, b] = [simulation.summary(), outcome.summary.clone()];
    // What depends on the clock.
    (a.wall_s, a.cpu_s, a.peak_memory_mb) = (b.wall_s, b.cpu_s, b.peak_memory_mb);
    a.phases = b.phases.clone();
    assert_eq!(a, b);
}

/// A quarter of the shipped plate under a ball, on a coarse mesh.
fn coarse_plate() -> Value {
    let mut scene = scene_json("ball_on_plate.json");
    set(
        &mut scene,
        "/bodies/plate/mesh/plate/elements",
        json!([8, 8]),
    );
    scene["probes"] =
        json!({ "middle": { "on": "plate.x_min", "quantity": "displacement", "take": "max" } });
    scene["solution"]["threads"] = json!(1);
    scene
}

#[test]
fn a_stepped_run_is_that_of_the_command_line() {
    let scene = coarse_plate();
    let outcome = solve(&scene);
    let simulation = stepped(&scene);
    same(&simulation, &outcome);
    assert!(simulation.summary().probes.contains_key("probe.middle"));

    // Its fields are those of the files, with all digits.
    let last = outcome.summary.steps;
    let file = outcome.body("plate", last);
    let fields = simulation.fields("plate").expect("a body");
    assert!(fields.len() > 6);
    for field in &fields {
        let written = file.field(&field.name);
        assert_eq!(written.len(), field.data.len(), "{}", field.name);
        for (a, b) in field.data.iter().zip(written) {
            assert!(
                a == b || a.is_nan() && b.is_nan(),
                "{}: {a} {b}",
                field.name
            );
        }
    }
    let pressure = simulation
        .field("plate", "contact_pressure")
        .expect("a slave");
    assert!(pressure.data.iter().any(|p| *p > 0.0));
    let u = simulation.displacements("plate").expect("a body");
    assert_eq!(u.len(), simulation.model().bodies[0].mesh.nodes.len());
    // The ball has pushed the middle of the plate down by about its way.
    assert!(u.iter().any(|u| u.z < -8.0));
    // Nothing but the ball acts on what the supports hold.
    let force = |name: &str| simulation.force(name).expect("something that acts").force;
    let supports = ["clamped_x", "clamped_y", "symmetry_x", "symmetry_y"].map(force);
    let ball = force("ball");
    assert!(ball.z < -100.0);
    let sum = supports.iter().fold(ball, |sum, f| sum + f);
    assert!(sum.norm() < 1e-6 * ball.norm(), "{sum}");
}

/// Two penalties that the run chooses, and friction.
#[test]
fn penalties_that_the_run_chooses_are_the_same_when_stepped() {
    let mut scene = coarse_plate();
    scene["contacts"]["press"] = json!({ "slave": "plate.top", "master": "ball", "friction": 0.2 });
    let outcome = solve(&scene);
    let simulation = stepped(&scene);
    same(&simulation, &outcome);
    let [given, chosen] =
        [&solve(&coarse_plate()), &outcome].map(|o| o.summary.accuracy.contacts[0].penalty);
    assert!(given != chosen, "{given} {chosen}");
}

/// A block of rubber whose default elements give way: it goes on with others.
fn squeezed() -> Value {
    json!({
        "covact": 1,
        "materials": { "rubber": { "neo_hooke": { "E": 5, "nu": 0.45 } } },
        "bodies": { "block": {
            "mesh": { "block": { "min": [-2, -2, 0], "max": [2, 2, 2], "elements": [6, 6, 3] } },
            "material": "rubber"
        } },
        "supports": {
            "below": { "on": "block.z_min", "fixed": true },
            "above": { "on": "block.z_max", "displacement": { "x": 0, "y": 0, "z": "-1.2*t" } }
        },
        "solution": { "threads": 1 },
        "output": { "every": 0 }
    })
}

#[test]
fn a_stepped_run_goes_on_with_other_elements() {
    let mut scene = squeezed();
    let outcome = solve(&scene);
    let mut simulation = simulation(&scene);
    let mut steps = Vec::new();
    while let Some(step) = simulation.step().expect("an equilibrium") {
        steps.push((step.attempt, step.number));
    }
    same(&simulation, &outcome);
    let all: Vec<_> = (1..=outcome.summary.steps).map(|step| (1, step)).collect();
    assert_eq!(steps, all);
    assert_eq!(outcome.summary.given_up.runs, 0);
    let told = "from there the run went on with `h8_mean_dilatation`";
    let told = simulation.warnings().iter().filter(|w| w.contains(told));
    assert_eq!(told.count(), 1);
    // Elastic, without friction: at its end it is where those elements are that were there from the start, and before that it is
    // where its own were.
    let mut others = scene.clone();
    others["bodies"]["block"]["element"] = json!("h8_mean_dilatation");
    let [force, expected] = [&outcome, &solve(&others)].map(|run| run.at("force.above.z", 1.0));
    assert!(
        force < -10.0 && (force / expected - 1.0).abs() < 1e-6,
        "{force} {expected}"
    );
    let balance = |column: &str| outcome.at(column, 1.0).abs();
    assert!(balance("energy.imbalance") < 0.01 * balance("energy.external"));
    assert!(balance("energy.adjusted") > 0.0);

    // Whoever names the elements keeps them, and learns why there is no further step, as often as it is asked for.
    scene["bodies"]["block"]["element"] = json!("h8");
    let named = solve(&scene);
    let before = |run: &Outcome| [0.1, 0.2].map(|time| run.at("force.above.z", time));
    assert_eq!(before(&named), before(&outcome));
    let mut simulation = self::simulation(&scene);
    let error = loop {
        match simulation.step() {
            Ok(step) => assert!(step.is_some()),
            Err(error) => break error,
        }
    };
    assert_eq!(Some(error.to_string()), named.summary.reason);
    assert!(matches!(
        simulation.step(),
        Err(StepError::NotConverged { .. })
    ));
    assert_eq!(simulation.status(), Some(RunStatus::NotConverged));
    same(&simulation, &named);
}

/// What a sink is called for.
#[derive(Default)]
struct Calls {
    calls: Vec<&'static str>,
    /// Fails at this step.
    fails: Option<u32>,
    status: Option<RunStatus>,
}

impl Sink for Calls {
    fn begin(&mut self, _: &Simulation) -> Result<(), RunError> {
        self.calls.push("begin");
        Ok(())
    }
    fn step(&mut self, run: &Simulation) -> Result<(), RunError> {
        self.calls.push("step");
        match self.fails == Some(run.steps()) {
            true => Err(RunError::Sink("no more".into())),
            false => Ok(()),
        }
    }
    fn keep(&mut self, _: &Simulation) -> Result<(), RunError> {
        self.calls.push("keep");
        Ok(())
    }
    fn close(&mut self, run: &Simulation) -> Result<(), RunError> {
        self.calls.push("close");
        self.status = run.status();
        Ok(())
    }
    fn summary(&mut self, _: &Simulation, summary: &Summary) -> Result<(), RunError> {
        self.calls.push("summary");
        assert_eq!(Some(summary.status), self.status);
        Ok(())
    }
}

#[test]
fn sinks_are_called_in_order_and_end_a_run_that_they_cannot_take() {
    let mut scene = coarse_plate();
    scene["solution"]["end_time"] = json!(0.25);
    let mut sink = Calls::default();
    let summary = simulation(&scene).run(&mut [&mut sink]).expect("a run");
    assert_eq!(summary.steps, 2);
    let all = [
        "begin", "keep", "step", "keep", "step", "keep", "close", "summary",
    ];
    assert_eq!(sink.calls, all);
    assert_eq!(sink.status, Some(RunStatus::Done));

    let mut sink = Calls {
        fails: Some(1),
        ..Calls::default()
    };
    let mut simulation = simulation(&scene);
    let error = simulation
        .run(&mut [&mut sink])
        .expect_err("a sink that fails");
    assert_eq!(error.to_string(), "no more");
    assert_eq!(sink.calls, ["begin", "keep", "step", "close", "summary"]);
    assert_eq!(sink.status, Some(RunStatus::Failed));
    assert_eq!(simulation.summary().reason.as_deref(), Some("no more"));
}

/// Sinks of a stepped run hear what those of a run as a whole hear, and are closed once.
#[test]
fn sinks_follow_a_stepped_run() {
    let mut scene = coarse_plate();
    scene["solution"]["end_time"] = json!(0.25);
    let mut sink = Calls::default();
    let mut simulation = simulation(&scene);
    let mut steps = 0;
    while let Some(step) = simulation.step_into(&mut [&mut sink]).expect("a step") {
        steps += 1;
        assert_eq!(step.number, steps);
    }
    assert_eq!(steps, 2);
    let all = [
        "begin", "keep", "step", "keep", "step", "keep", "close", "summary",
    ];
    assert_eq!(sink.calls, all);
    let again = simulation.step_into(&mut [&mut sink]).expect("the end");
    assert!(again.is_none() && sink.calls == all);
}

/// A run is opened where a folder keeps it, and goes on to the same end.
#[test]
fn an_open_run_goes_on_in_its_folder() {
    let scene = loaded(&coarse_plate());
    let outcome = solve(&coarse_plate());
    let folder = tempfile::tempdir().expect("temporary folder");
    let start = RunOptions::default();
    let resume = RunOptions {
        resume: true,
        ..start
    };
    let open = |options: &RunOptions| open(&scene, folder.path(), options, Options::default());
    let Ok(Opened::Going(mut first, mut files)) = open(&start) else {
        panic!("a run at its start");
    };
    for _ in 0..3 {
        first.step_into(&mut [&mut *files]).expect("a step");
    }
    drop((first, files));
    let Ok(Opened::Going(mut second, mut files)) = open(&resume) else {
        panic!("a run under way");
    };
    let kept = second.steps();
    assert!(kept > 0 && second.history().rows.len() == kept as usize);
    while let Some(_step) = second.step_into(&mut [&mut *files]).expect("a step") {}
    let (a, b) = (&second.history().rows, &outcome.history.rows);
    assert_eq!(a.len(), b.len());
    let column = |name: &str| second.history().columns.iter().position(|c| c == name);
    let force = column("force.ball.z").expect("a column");
    for (a, b) in a.iter().zip(b) {
        assert!((a[force] - b[force]).abs() <= 1e-9 * b[force].abs());
    }
    drop(files);
    assert!(matches!(open(&resume), Ok(Opened::Finished(_))));
    assert!(open(&start).is_err());
}

/// A folder that comes late has the whole history, and one that holds a run is refused.
#[test]
fn a_folder_takes_over_a_run_under_way() {
    let scene = coarse_plate();
    let outcome = solve(&scene);
    let mut simulation = simulation(&scene);
    for _ in 0..3 {
        simulation.step().expect("an equilibrium");
    }
    let folder = tempfile::tempdir().expect("temporary folder");
    let out = folder.path().join("out");
    let mut files = ResultsFolder::new(&out).expect("nothing there");
    assert!(!out.exists());
    simulation.run(&mut [&mut files]).expect("a run");
    drop(files);
    let read = |path: &std::path::Path| std::fs::read(path.join("history.csv")).expect("a history");
    assert_eq!(read(&out), read(outcome.folder.path()));
    assert!(!out.join("plate_0002.vtu").exists() && out.join("plate_0003.vtu").is_file());
    assert!(matches!(ResultsFolder::new(&out), Err(RunError::Folder(_))));
    assert!(ResultsFolder::replace(&out).is_ok());
}

/// Interrupts at the second iteration of the third step, once.
struct Interrupter<'a>(&'a AtomicBool, bool);

impl Observer for Interrupter<'_> {
    fn event(&mut self, event: &Event) {
        if let Event::Iteration {
            step: 3,
            iteration: 2,
            ..
        } = event
            && std::mem::replace(&mut self.1, false)
        {
            self.0.store(true, Ordering::Relaxed);
        }
    }
}

#[test]
fn an_interrupted_step_is_taken_up_again() {
    let scene = coarse_plate();
    let outcome = solve(&scene);
    let flag = AtomicBool::new(false);
    let options = Options {
        observer: Box::new(Interrupter(&flag, true)),
        interrupt: &flag,
        ..Options::default()
    };
    let mut simulation = Simulation::new(loaded(&scene), options).expect("valid model");
    let mut interrupted = 0;
    while !simulation.done() {
        match simulation.step() {
            Ok(_) => {}
            Err(StepError::Interrupted) => {
                interrupted += 1;
                assert_eq!(simulation.steps(), 2);
                flag.store(false, Ordering::Relaxed);
            }
            Err(error) => panic!("{error}"),
        }
    }
    assert_eq!(interrupted, 1);
    let z = simulation.force("ball").expect("a surface").force.z;
    assert_eq!(z, outcome.at("force.ball.z", 1.0));
}

#[test]
fn names_that_are_wrong_are_told_with_the_nearest() {
    let mut simulation = simulation(&coarse_plate());
    assert_eq!(simulation.force("ball"), Err(ReadError::NoStep));
    simulation.step().expect("an equilibrium");
    let told = |error: ReadError| error.to_string();
    let cases = [
        (
            told(simulation.force("bal").expect_err("wrong")),
            "there is no surface or support `bal`: did you mean `ball`?",
        ),
        (
            told(simulation.fields("plat").expect_err("wrong")),
            "there is no body `plat`: did you mean `plate`?",
        ),
        (
            told(simulation.field("plate", "displacemnt").expect_err("wrong")),
            "there is no field `displacemnt`: did you mean `displacement`?",
        ),
        (
            told(simulation.value("gap.mn").expect_err("wrong")),
            "there is no column `gap.mn`: did you mean `gap.min`?",
        ),
        (
            told(simulation.contact_force("press").expect_err("rigid")),
            "there is no contact between bodies `press`",
        ),
    ];
    for (told, expected) in cases {
        assert_eq!(told, expected);
    }
}
