//! The energies of a run: what is put in against what is stored and dissipated, and paths that jump.
use crate::common::{done, plate};
use crate::support::Outcome;
use serde_json::{Value, json};

/// Half of a shallow clamped arch in plane strain, top at x = 0: radius 100, thickness 1, 12 degrees to its end.
fn arch(angle: f64, elements: u32, dt: f64) -> Value {
    json!({
        "covact": 1,
        "materials": { "m": { "st_venant_kirchhoff": { "E": 1000, "nu": 0.3 } } },
        "bodies": { "arch": { "material": "m", "mesh": { "cylinder_panel": {
            "radius": 100, "thickness": 1, "angles": [0, angle], "y": [0, 5], "elements": [elements, 1]
        } } } },
        "supports": {
            "top": { "on": "arch.phi_min", "symmetry": "x" },
            "end": { "on": "arch.phi_max", "fixed": true },
            "a": { "on": "arch.y_min", "symmetry": "y" },
            "b": { "on": "arch.y_max", "symmetry": "y" }
        },
        "solution": { "step": { "initial": dt, "max": dt }, "threads": 1 },
        "output": { "every": 0 }
    })
}

fn told(outcome: &Outcome) -> Vec<String> {
    let all = outcome.summary.warnings.iter();
    all.filter(|w| w.contains("an energy of"))
        .cloned()
        .collect()
}

/// Under a dead load the arch snaps through in one step, in which load does more work than the arch takes up. The step is
/// told, and no other; before it the sums balance to the error of the rule.
#[test]
fn an_arch_that_snaps_through_is_told() {
    let mut scene = arch(12.0, 12, 0.05);
    scene["loads"] = json!({ "press": { "on": "arch.outer", "pressure": "0.1*t" } });
    let outcome = done(&scene);
    let [lost, stored] = ["energy.imbalance", "energy.internal"].map(|c| outcome.column(c));
    let jump = (1..stored.len())
        .max_by(|&a, &b| (stored[a] - stored[a - 1]).total_cmp(&(stored[b] - stored[b - 1])));
    let jump = jump.expect("steps");
    assert!(stored[jump] > 5.0 * stored[jump - 1]);
    for (i, e) in lost[..jump].iter().enumerate() {
        assert!(e.abs() < 0.02 * stored[i], "{i}: {e}");
    }
    assert!(lost[jump] > 0.1 * stored[jump]);
    let told = told(&outcome);
    assert_eq!(told.len(), 1, "{told:?}");
    assert!(
        told[0].starts_with(&format!("step {} (", jump + 1)) && told[0].contains("snap-through"),
        "{told:?}"
    );
}

/// Pressed by a ball instead, it goes the same way without a jump, though the force falls on it; what is left of the balance
/// falls with the square of the step.
#[test]
fn an_arch_led_by_a_tool_balances_to_second_order() {
    let run = |dt: f64| {
        let mut scene = arch(20.0, 20, dt);
        scene["surfaces"] = json!({ "ball": {
            "sphere": { "radius": 5, "center": [0, 0, 105.6] }, "motion": { "translation": [0, 0, "-14*t"] }
        } });
        scene["contacts"] = json!({ "press": { "slave": "arch.outer", "master": "ball" } });
        scene["solution"]["end_time"] = json!(0.5);
        let outcome = done(&scene);
        assert!(told(&outcome).is_empty(), "{:?}", told(&outcome));
        let force = outcome.column("force.ball.z");
        let largest = force.iter().fold(0.0f64, |a, f| a.max(-f));
        assert!(-force[force.len() - 1] < 0.6 * largest);
        outcome.at("energy.imbalance", 0.5) - outcome.at("energy.imbalance", 0.25)
    };
    let [coarse, fine] = [run(0.05), run(0.025)];
    assert!(
        coarse.abs() > 1e-4 && (3.5..4.5).contains(&(coarse / fine)),
        "{coarse} {fine}"
    );
}

/// The relative imbalance at the end of a run.
fn left(scene: &Value) -> (f64, Outcome) {
    let outcome = done(scene);
    let [external, imbalance] =
        ["energy.external", "energy.imbalance"].map(|c| *outcome.column(c).last().expect("a row"));
    assert!(external > 0.0);
    (imbalance.abs() / external, outcome)
}

/// Overclosures put in the same energy whether they shrink over time or are resolved at once, and the sums balance; the
/// equilibrium at the end is the same.
#[test]
fn overclosures_do_work() {
    for gap in ["pointwise", "averaged"] {
        let run = |choice: Value, dt: f64| {
            let mut scene = plate(6, 0.0, 1);
            scene["surfaces"]["ball"]["sphere"]["center"] = json!([0, 0, 25.2]);
            scene["contacts"]["press"]["gap"] = json!(gap);
            scene["contacts"]["press"]["initial_overclosure"] = choice;
            scene["solution"]["step"] = json!({ "initial": dt, "max": dt });
            left(&scene)
        };
        let (coarse, _) = run(json!({ "shrink": { "until": 1 } }), 0.25);
        let (fine, shrunk) = run(json!({ "shrink": { "until": 1 } }), 0.0625);
        let (_, strained) = run(json!("strain"), 1.0);
        assert!(fine < 0.01 && fine < 0.5 * coarse, "{coarse} {fine}");
        let [a, b] =
            [&shrunk, &strained].map(|o| *o.column("energy.internal").last().expect("a row"));
        assert!((a - b).abs() < 1e-6 * a, "{a} {b}");
        let external = *strained.column("energy.external").last().expect("a row");
        assert!((external / a - 1.0).abs() < 0.35, "{external} {a}");
    }
}

/// A penalty that is raised in the course of a run and multipliers put in what `energy.adjusted` says: with it the balance is
/// that of a run under a penalty that stays, without it worse.
#[test]
fn changing_penalties_and_multipliers_are_accounted_for() {
    let with = |contact: Value| {
        let mut scene = plate(6, 4.0, 16);
        for (key, value) in contact.as_object().expect("an object") {
            scene["contacts"]["press"][key] = value.clone();
        }
        left(&scene)
    };
    let (plain, _) = with(json!({}));
    let (augmented, multipliers) =
        with(json!({ "penalty": { "value": 600 }, "augmentation": { "gap": 1e-4 } }));
    let adjusted = *multipliers.column("energy.adjusted").last().expect("a row");
    assert!(adjusted != 0.0);
    assert!(augmented < 2.0 * plain + 1e-3, "{plain} {augmented}");
    let (raised, automatic) = with(json!({ "penalty": "auto" }));
    assert!(
        raised < 2.0 * plain + 1e-3,
        "{plain} {raised} {:?}",
        automatic.summary.warnings
    );
}

/// The force of a ball that presses an arch down grows, and falls before the arch is flat. In large steps its peak lies between
/// them, which is told with about what is missing of that of small ones, of which nothing is.
#[test]
fn a_peak_between_the_steps_is_told() {
    let run = |dt: f64| {
        let mut scene = arch(20.0, 20, dt);
        scene["surfaces"] = json!({ "ball": {
            "sphere": { "radius": 5, "center": [0, 0, 105.6] }, "motion": { "translation": [0, 0, "-14*t"] }
        } });
        scene["contacts"] = json!({ "press": { "slave": "arch.outer", "master": "ball" } });
        scene["solution"]["end_time"] = json!(0.6);
        let outcome = done(&scene);
        let force = outcome.column("force.ball.z");
        let largest = force.iter().fold(0.0f64, |a, f| a.max(f.abs()));
        let mut told = outcome.summary.warnings.into_iter();
        (
            largest,
            told.find(|w| w.contains("its force") && w.contains("is largest at step")),
        )
    };
    let [(coarse, told), (fine, none)] = [run(0.1), run(0.01)];
    assert_eq!(none, None);
    let told = told.expect("a warning");
    println!("{coarse} {fine} {told}");
    let part: f64 = (told.split("may have been ").nth(1))
        .and_then(|t| t.split(' ').next()?.parse().ok())
        .expect("a number");
    let missing = 100.0 * (fine / coarse - 1.0);
    assert!(
        missing > 1.0 && (0.4..4.0).contains(&(part / missing)),
        "{part} {missing}"
    );
}

/// A cube of metal whose top goes round a circle: flow turns all the time. Work that steps leave out because of it is told in
/// steps of 30 degrees, where it is 12 % of that of steps of 2 degrees, and not in these. Steps that may change are taken smaller.
#[test]
fn flow_that_turns_within_the_steps_is_told() {
    let run = |degrees: f64, adaptive: bool| {
        let dt = degrees / 360.0;
        let scene = json!({
            "covact": 1,
            "materials": { "m": { "j2": { "E": 200e3, "nu": 0.3, "hardening": { "linear": { "yield_stress": 200, "slope": 100 } } } } },
            "bodies": { "cube": { "material": "m", "mesh": { "block": {
                "min": [0, 0, 0], "max": [1, 1, 1], "elements": [1, 1, 1]
            } } } },
            "supports": {
                "bottom": { "on": "cube.bottom", "fixed": true },
                "top": { "on": "cube.top", "displacement": {
                    "x": "0.04*(1-cos(2*pi*t))", "y": "0.04*sin(2*pi*t)", "z": 0
                } }
            },
            "solution": { "step": { "initial": dt, "max": dt, "adaptive": adaptive }, "threads": 1 },
            "output": { "every": 0 }
        });
        let outcome = done(&scene);
        let told = outcome
            .summary
            .warnings
            .iter()
            .any(|w| w.contains("its direction turns within a step"));
        let work = outcome.at("energy.external", 1.0);
        println!(
            "{degrees} degrees: {work}, told {told}, {} steps",
            outcome.summary.steps
        );
        (work, told, outcome.summary.steps)
    };
    let [coarse, fine] = [run(30.0, false), run(2.0, false)];
    assert!(coarse.1 && !fine.1);
    let left_out = 1.0 - coarse.0 / fine.0;
    assert!((0.05..0.15).contains(&left_out), "{left_out}");
    let chosen = run(30.0, true);
    assert!(chosen.2 >= 18, "{} steps", chosen.2);
    assert!(
        1.0 - chosen.0 / fine.0 < 0.5 * left_out,
        "{}",
        chosen.0 / fine.0
    );
}

/// A ball pressed on a sheet that is held at one edge, with high friction, in `steps` steps, from time `begins` on: what is told, and
/// the force along x.
fn rubbed(steps: u32, begins: f64) -> (Vec<String>, f64) {
    let size = 1.0 / f64::from(steps);
    let mut way = vec![[0.0, 0.0], [1.0, -0.8986]];
    if begins > 0.0 {
        way.insert(1, [begins, 0.0]);
    }
    let outcome = done(&json!({
        "covact": 1,
        "materials": { "m": { "st_venant_kirchhoff": { "E": 99952, "nu": 0.052 } } },
        "bodies": { "b": { "material": "m", "mesh": { "plate": {
            "elements": [10, 8], "origin": [-4.2348, -5.6437, -0.2277], "size": [8.4695, 11.2874], "thickness": 0.4555
        } } } },
        "surfaces": { "s": {
            "sphere": { "radius": 4.303, "center": [-0.9322, -0.6863, 4.4813] },
            "motion": { "translation": [0, 0, { "table": way }] }
        } },
        "contacts": { "c": {
            "slave": "b.top", "master": "s", "friction": 0.8514, "penalty": { "value": 2.146e8 }, "points": { "lobatto": 3 }
        } },
        "supports": { "h": { "on": "b.x_min", "fixed": true } },
        "solution": { "step": { "initial": size, "max": size }, "threads": 1 },
        "output": { "every": 0 }
    }));
    (told(&outcome), outcome.at("force.s.x", 1.0))
}

/// The ball grips the sheet where it touches it first, and holds it there. Friction that hardly sets in before the step after the
/// first touch leaves forces from -128 to 431 of 538 in steps as large as these, without a word.
#[test]
fn a_ball_grips_a_sheet_at_once_in_large_steps() {
    let (_, fine) = rubbed(52, 0.0);
    assert!((fine / 537.8 - 1.0).abs() < 1e-3, "{fine}");
    for (steps, begins) in [(3, 0.0), (6, 0.0), (13, 0.0), (6, 0.5), (13, 0.5)] {
        let (told, force) = rubbed(steps, begins);
        println!("{steps} from {begins}: {force}, {told:?}");
        assert!((force / fine - 1.0).abs() < 1e-3, "{force} of {fine}");
    }
}
