//! Stages that a program begins while a run is stepped: the same as stages that the scene has from the start.
use covact::run::{Options, RunError, Simulation};
use covact::scene::{self, LoadedScene, Stage};
use serde_json::{Value, json};

/// A block of rubber under a ball and a pressure, both by stages.
fn scene(stages: &Value, end: f64) -> LoadedScene {
    let scene = json!({
        "covact": 1,
        "materials": {"rubber": {"neo_hooke": {"E": 2, "nu": 0.4}}},
        "bodies": {"block": {
            "mesh": {"block": {"min": [0, 0, -2], "max": [4, 4, 0], "elements": [4, 4, 2]}},
            "material": "rubber"
        }},
        "surfaces": {"ball": {"sphere": {"radius": 5, "center": [2, 2, 5]}, "side": "outward"}},
        "contacts": {"press": {
            "slave": "block.top", "master": "ball", "friction": 0.2, "penalty": {"value": 20},
            "points": {"gauss": 3}
        }},
        "supports": {"ground": {"on": "block.bottom", "fixed": true}},
        "loads": {"side": {"on": "block.x_min", "pressure": 0.05}},
        "stages": stages,
        "solution": {"end_time": end, "step": {"initial": 0.1, "max": 0.1, "adaptive": false}}
    });
    scene::parse(&scene.to_string(), "stages.json").unwrap_or_else(|e| panic!("{e:?}"))
}

fn start(stages: &Value, end: f64) -> Simulation<'static> {
    Simulation::new(scene(stages, end), Options::default()).unwrap_or_else(|e| panic!("{e}"))
}

fn stage(value: Value) -> Stage {
    serde_json::from_value(value).expect("a stage")
}

fn back() -> Value {
    json!({"name": "back", "until": 0.8, "tools": {"ball": [0.3, 0, -0.2]}, "loads": {"side": 0}})
}

/// Cut short at half of its time, a stage has brought its tools and loads half of their way.
#[test]
fn a_stage_that_is_begun_is_one_of_the_scene() {
    let down = json!({"name": "down", "tools": {"ball": [0, 0, -1]}, "loads": {"side": 1}});
    let mut begun = start(&json!([down]), 1.0);
    while begun.time() < 0.45 {
        begun.step().unwrap().expect("a step");
    }
    let pressed = begun.force("ball").unwrap().force.z;
    assert!(pressed < -0.1, "{pressed}");
    begun.begin_stage(stage(back())).unwrap();
    assert_eq!(begun.force("ball").unwrap().force.z, pressed);
    while begun.step().unwrap().is_some() {}

    let half = json!({"name": "down", "until": 0.5, "tools": {"ball": [0, 0, -0.5]}, "loads": {"side": 0.5}});
    let mut written = start(&json!([half, back()]), 0.8);
    while written.step().unwrap().is_some() {}

    assert!(begun.done() && written.done());
    let [a, b] = [&begun, &written].map(Simulation::history);
    assert_eq!((a.rows.len(), &a.columns), (8, &b.columns));
    assert_eq!(a.rows.len(), b.rows.len());
    let (mut largest, mut dissipated) = (0.0f64, 0.0);
    for (column, name) in a.columns.iter().enumerate() {
        let physical = ["force.", "energy.", "way.", "points."];
        if !physical.iter().any(|p| name.starts_with(p)) {
            continue;
        }
        for (x, y) in a.rows.iter().zip(&b.rows) {
            let (x, y) = (x[column], y[column]);
            assert!((x - y).abs() < 1e-7, "{name}: {x} {y}");
            largest = largest.max(x.abs());
            if name == "energy.dissipated" {
                dissipated = x;
            }
        }
    }
    assert!(largest > 0.5 && dissipated > 1e-4, "{largest} {dissipated}");
    // The tools are where the new stage has led them.
    assert!((begun.value("way.ball.z").unwrap() + 0.2).abs() < 1e-12);
    let names: Vec<String> = (begun.summary().stages.iter())
        .map(|s| s.name.clone())
        .collect();
    assert_eq!(names, ["down", "back"]);
}

/// A planned stage that has not begun gives way to the new one.
#[test]
fn planned_stages_give_way() {
    let planned = json!([
        {"name": "down", "until": 0.2, "tools": {"ball": [0, 0, -0.2]}},
        {"name": "further", "tools": {"ball": [0, 0, -1]}}
    ]);
    let mut run = start(&planned, 1.0);
    while run.time() < 0.15 {
        run.step().unwrap();
    }
    let up = json!({"name": "up", "until": 0.4, "tools": {"ball": [0, 0, 0.1]}});
    run.begin_stage(stage(up)).unwrap();
    while run.step().unwrap().is_some() {}
    assert!(run.done() && (run.time() - 0.4).abs() < 1e-12);
    assert_eq!(run.force("ball").unwrap().force.z, 0.0);
    assert!((run.value("way.ball.z").unwrap() - 0.1).abs() < 1e-12);
}

/// Where slave points turn out to be too few the run begins again, and ends with the stage that was begun.
#[test]
fn a_run_that_begins_again_has_the_stages_that_were_begun() {
    let down = json!([{"name": "down", "tools": {"ball": [0, 0, -0.5]}}]);
    let mut loaded = scene(&down, 1.0);
    let contact = loaded.scene.contacts.get_mut("press").expect("the contact");
    contact.points = Default::default();
    let surface = loaded.scene.surfaces.get_mut("ball").expect("the ball");
    // Between four nodes.
    surface.placement.translation = [0.5, 0.5, 0.0];
    let mut run = Simulation::new(loaded, Options::default()).unwrap();
    let (mut begun, mut attempts) = (None, 0);
    while let Some(step) = run.step().unwrap() {
        attempts = step.attempt;
        if begun.is_none() {
            begun = Some((step.time, step.attempt));
            let up =
                json!({"name": "up", "until": step.time + 0.4, "tools": {"ball": [0, 0, 0.1]}});
            run.begin_stage(stage(up)).unwrap();
        }
    }
    let (time, attempt) = begun.expect("a stage");
    assert!(attempt == 1 && attempts > 1, "{attempt} {attempts}");
    assert!(run.done() && (run.time() - time - 0.4).abs() < 1e-12);
    let way = run.history().column("way.ball.z").expect("the way");
    let deepest = way.iter().copied().fold(0.0, f64::min);
    assert!((deepest + 0.5 * time).abs() < 1e-12, "{deepest} {time}");
    assert!((way.last().unwrap() - 0.1).abs() < 1e-12);
}

#[test]
fn what_cannot_begin_is_refused_and_the_run_goes_on() {
    let down = json!({"name": "down", "tools": {"ball": [0, 0, -0.3]}});
    let mut run = start(&json!([down]), 0.3);
    let refused = |run: &mut Simulation, value: Value, words: &str| {
        let error = run.begin_stage(stage(value)).expect_err(words);
        assert!(matches!(error, RunError::Scene { .. }), "{error}");
        assert!(error.to_string().contains(words), "{error}");
    };
    refused(&mut run, back(), "has taken no step yet");
    run.step().unwrap();
    refused(
        &mut run,
        json!({"name": "past", "until": 0.05}),
        "ends at 0.05",
    );
    refused(
        &mut run,
        json!({"name": "down", "until": 1}),
        "two stages have the name",
    );
    refused(
        &mut run,
        json!({"name": "who", "until": 1, "tools": {"bal": [0, 0, 0]}}),
        "bal",
    );
    let free = json!({"name": "free", "until": 1, "release": "forces"});
    refused(&mut run, free, "would find supports");
    while run.step().unwrap().is_some() {}
    assert!(run.done() && run.steps() == 3);
    refused(&mut run, back(), "has ended");
    let mut plain = Simulation::new(
        {
            let mut plain = scene(&json!([]), 0.2);
            plain.scene.stages.clear();
            plain
        },
        Options::default(),
    )
    .unwrap();
    refused(&mut plain, back(), "no stages");
}
