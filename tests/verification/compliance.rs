//! What the compliance of contact takes away from forces is told, with its size, and nothing is told where it is small.
use crate::support::{Outcome, scene_json, set, solve};
use serde_json::{Value, json};

/// Young's modulus of the sheets.
const E: f64 = 1000.0;
/// Squeeze as a part of the thickness.
const SQUEEZE: f64 = 1e-3;

/// A square sheet of length 10, squeezed by two rigid planes. nu = 0, so that the squeezed state is one of uniform strain.
fn squeezed(slenderness: f64) -> Value {
    let t = 10.0 * slenderness;
    let plane = |z: f64, normal: f64, sign: f64| {
        json!({
            "plane": { "center": [5, 5, z], "normal": [0, 0, normal], "size": [40, 40] },
            "motion": { "translation": [0, 0, format!("{}*t", sign * 0.5 * SQUEEZE * t)] }
        })
    };
    json!({
        "covact": 1,
        "materials": { "m": { "st_venant_kirchhoff": { "E": E, "nu": 0 } } },
        "bodies": { "sheet": {
            "mesh": { "plate": { "size": [10, 10], "thickness": t, "elements": [4, 4], "layers": 2 } },
            "material": "m",
            "sets": { "middle": {
                "nodes_near_plane": { "point": [0, 0, 0], "normal": [0, 0, 1], "tolerance": 0.1 * t }
            } }
        } },
        "surfaces": { "below": plane(-0.5 * t, 1.0, 1.0), "above": plane(0.5 * t, -1.0, -1.0) },
        "contacts": {
            "a": { "slave": "sheet.bottom", "master": "below" },
            "b": { "slave": "sheet.top", "master": "above" }
        },
        "supports": {
            "x": { "on": "sheet.x_min", "symmetry": "x" },
            "y": { "on": "sheet.y_min", "symmetry": "y" },
            "middle": { "on": "sheet.middle", "displacement": { "z": 0 } }
        },
        "solution": { "step": { "initial": 0.5, "max": 0.5 }, "threads": 1 },
        "output": { "every": 0 }
    })
}

/// The part of the force that a run leaves out: exact is `A l E (1 - l^2) / 2` at the stretch `l`.
fn missing(outcome: &Outcome) -> f64 {
    let l = 1.0 - SQUEEZE;
    let exact = 100.0 * l * E * (1.0 - l * l) / 2.0;
    1.0 - outcome.at("force.above.z", 1.0).abs() / exact
}

fn told(outcome: &Outcome) -> Vec<&String> {
    let all = outcome.summary.warnings.iter();
    all.filter(|w| w.starts_with("contact gives way")).collect()
}

fn run(scene: &Value) -> Outcome {
    let outcome = solve(scene);
    assert!(outcome.summary.reason.is_none(), "{:?}", outcome.summary);
    outcome
}

#[test]
fn thin_sheets_squeezed_through_their_thickness_are_told_how_much_force_is_missing() {
    for slenderness in [1e-1, 1e-2, 5e-3, 3.3e-3, 2e-3, 1e-3, 1e-4] {
        let mut scene = squeezed(slenderness);
        for contact in ["a", "b"] {
            scene["contacts"][contact]["penalty"] = json!({ "scaled": 1 });
        }
        let outcome = run(&scene);
        let off = missing(&outcome);
        assert!(off > 0.01, "t/L {slenderness}: off by {off} only");
        let told = told(&outcome);
        assert_eq!(told.len(), 1, "t/L {slenderness}, off by {off}: {told:?}");
        let found = outcome.summary.accuracy.force_error;
        match off > 0.5 {
            true => assert!(told[0].contains("by more than half"), "{}", told[0]),
            false => {
                assert!(found / off < 1.5 && off / found < 1.5, "{found} {off}");
                let text = format!("by about {:.1} %", 100.0 * found);
                assert!(told[0].contains(&text), "{}", told[0]);
            }
        }
    }
}

/// The automatic penalty starts soft and is raised by the error that it makes: thin sheets squeezed through their thickness
/// lack less than a per cent of their force, the bound of the error that it keeps, whatever their thickness, and nothing is to
/// be told.
#[test]
fn thin_sheets_squeezed_through_their_thickness_have_their_force() {
    for slenderness in [1e-1, 1e-2, 5e-3, 3.3e-3, 2e-3, 1e-3, 1e-4] {
        let outcome = run(&squeezed(slenderness));
        let off = missing(&outcome);
        println!(
            "t/L {slenderness}: {off:.2e}, {} iterations",
            outcome.summary.newton_iterations
        );
        assert!(off.abs() < 1e-2, "t/L {slenderness}: {off}");
        assert_eq!(told(&outcome), Vec::<&String>::new());
    }
}

/// The remedies that the warning names end it, and the force is right.
#[test]
fn a_stiffer_penalty_or_augmentation_ends_the_warning() {
    for slenderness in [1e-1, 1e-2, 2e-3] {
        let t = 10.0 * slenderness;
        let mut stiff = squeezed(slenderness);
        let mut augmented = squeezed(slenderness);
        for contact in ["a", "b"] {
            stiff["contacts"][contact]["penalty"] = json!({ "value": 2000.0 * E / t });
            augmented["contacts"][contact]["penalty"] = json!({ "value": 200.0 * E / t });
            augmented["contacts"][contact]["augmentation"] = json!({ "gap": 1e-6 * slenderness });
        }
        for scene in [stiff, augmented] {
            let outcome = run(&scene);
            let off = missing(&outcome);
            assert!(off.abs() < 5e-3, "t/L {slenderness}: {off}");
            assert_eq!(told(&outcome), Vec::<&String>::new());
            let account = &outcome.summary.accuracy;
            assert!(
                account.energy_ratio < 0.01 && account.step > 0,
                "{account:?}"
            );
        }
    }
}

/// A plane that ends in nodes whose displacement is prescribed penetrates as prescribed, whatever the penalty: that is no
/// error of the penalty and hides none, but what it adds to the force is told.
#[test]
fn prescribed_penetrations_do_not_count() {
    let mut scene = squeezed(0.1);
    for contact in ["a", "b"] {
        scene["contacts"][contact]["penalty"] = json!({ "value": 2000.0 * E });
    }
    scene["supports"]["floor"] = json!({ "on": "sheet.bottom", "displacement": { "z": "5e-4*t" } });
    scene["surfaces"]["below"]["motion"]["translation"] = json!([0, 0, "6e-4*t"]);
    let outcome = run(&scene);
    let (stored, internal) = (
        outcome.at("energy.contact", 1.0),
        outcome.at("energy.internal", 1.0),
    );
    assert!(stored > 0.1 * internal, "{stored} {internal}");
    assert_eq!(told(&outcome), Vec::<&String>::new());
    assert!(missing(&outcome).abs() < 5e-3);
    let held: Vec<&String> = (outcome.summary.warnings.iter())
        .filter(|w| w.contains("acts at points that supports hold"))
        .collect();
    assert!(
        held.len() == 1 && held[0].contains("contact `a`: 100 %"),
        "{held:?}"
    );
}

/// Where most of the strain energy is that of another load, the penetration tells: a stretched sheet under a penalty that holds
/// nothing.
#[test]
fn tools_that_pass_through_are_told() {
    let mut scene = squeezed(0.1);
    for contact in ["a", "b"] {
        scene["contacts"][contact]["penalty"] = json!({ "scaled": 1e-6 });
    }
    scene["supports"]["pull"] = json!({ "on": "sheet.x_max", "displacement": { "x": "0.5*t" } });
    let outcome = run(&scene);
    let account = &outcome.summary.accuracy;
    assert!(account.energy_ratio < 1e-6, "{account:?}");
    assert!(account.penetration_ratio > 0.99, "{account:?}");
    let told = told(&outcome);
    assert!(
        told.len() == 1 && told[0].contains("by more than half"),
        "{told:?}"
    );
}

/// A strip bent over a roll lies on few points, whose gaps show in neither energies nor penetrations by as much as they change
/// the force: what rigid contact would change is found from the tractions of the last step, and falls with the penalty. The
/// reference is the same strip under a penalty at which nothing is left.
#[test]
fn what_the_penalty_takes_away_from_a_bent_strip_is_told() {
    let bent = |penalty: f64| {
        run(&json!({
            "covact": 1,
            "materials": { "m": { "st_venant_kirchhoff": { "E": 1000, "nu": 0.3 } } },
            "bodies": { "strip": {
                "mesh": { "plate": {
                    "size": [20, 2], "thickness": 0.5, "elements": [24, 1], "origin": [0, 0, 0.25]
                } },
                "material": "m"
            } },
            "surfaces": { "roll": {
                "cylinder": { "radius": 6, "length": 10, "center": [10, 1, -6.01] },
                "motion": { "translation": [0, 0, "4*t"] }
            } },
            "contacts": { "over": {
                "slave": "strip.bottom", "master": "roll", "penalty": { "value": penalty }
            } },
            "supports": {
                "held": { "on": "strip.x_min", "fixed": true },
                "guided": { "on": "strip.x_max", "displacement": { "z": 0 } },
                "middle": { "on": "strip.y_min", "symmetry": "y" }
            },
            "solution": { "threads": 1 },
            "output": { "every": 0 }
        }))
    };
    let force = |outcome: &Outcome| outcome.at("force.roll.z", 1.0);
    let rigid = force(&bent(1e5));
    let mut last = f64::INFINITY;
    for penalty in [100.0, 300.0, 1000.0] {
        let outcome = bent(penalty);
        let off = 1.0 - force(&outcome) / rigid;
        let found = outcome.summary.accuracy.force_error;
        println!("{penalty}: off by {off:.2e}, told {found:.2e}");
        assert!(off > 1e-3 && found / off < 1.5 && off / found < 1.5);
        assert!(found < 0.6 * last, "{found} after {last}");
        assert_eq!(told(&outcome).len(), usize::from(found > 0.01));
        last = found;
    }
}

/// The force on the balls of `pinched_tube` grows threefold in its last step, where what a step leaves shows too late: the rule
/// sees what rigid contact would change, and the default has the force of one that is ruled forty times as sharply over
/// half the steps.
#[test]
fn a_force_that_rises_at_the_end_is_right_at_the_end() {
    let pinched = |sharp: bool| {
        let mut scene = scene_json("pinched_tube.json");
        set(
            &mut scene,
            "/bodies/tube/mesh/cylinder_panel/elements",
            vec![24, 14],
        );
        scene["output"] = json!({ "every": 0 });
        if sharp {
            scene["solution"]["step"] = json!({ "initial": 0.025, "max": 0.025 });
            for contact in ["ball_above", "ball_below", "walls"] {
                scene["contacts"][contact]["accuracy"] = json!(1e-4);
            }
        }
        run(&scene)
    };
    let [default, sharp] = [false, true].map(pinched);
    let [force, exact] = [&default, &sharp].map(|o| o.at("force.above.z", 1.0));
    let off = (force / exact - 1.0).abs();
    let found = default.summary.accuracy.force_error;
    println!("{force} for {exact}: off by {off:.2e}, told {found:.2e}");
    assert!(sharp.summary.accuracy.force_error < 1e-3);
    assert!(exact < -5.0 && off < 0.01 && found < 0.01, "{off} {found}");
    assert_eq!(told(&default), Vec::<&String>::new());
}

/// A strip wrapped on a drum by a pressure that follows it: all forces are in proportion to the pressure. The penalty is raised at the
/// last step alone, and the run tells by how much that puts the steps before in the wrong.
#[test]
fn steps_before_a_raise_at_the_last_one_are_told() {
    let mut scene = json!({
        "covact": 1,
        "materials": { "s": { "st_venant_kirchhoff": { "E": 2000, "nu": 0.35 } } },
        "bodies": { "s": {
            "mesh": { "plate": { "size": [40, 4], "thickness": 0.6, "elements": [80, 1], "origin": [0, 0, 20.3] } },
            "material": "s"
        } },
        "surfaces": { "drum": {
            "cylinder": { "radius": 20, "length": 20, "center": [0, 2, 0], "axis": [0, 1, 0] }, "side": "outward"
        } },
        "contacts": { "c": { "slave": "s.bottom", "master": "drum", "friction": 0.15 } },
        "supports": {
            "root": { "on": "s.x_min", "fixed": true },
            "y": { "on": ["s.y_min", "s.y_max"], "symmetry": "y" }
        },
        "loads": { "p": { "on": "s.top", "pressure": "0.05*t", "follower": true } },
        "output": { "every": 0 }
    });
    let before = |outcome: &Outcome| {
        let [times, forces] = ["time", "force.drum.x"].map(|name| outcome.column(name));
        let last = times.len() - 2;
        forces[last] / times[last]
    };
    let ruled = run(&scene);
    let penalty = ruled.summary.accuracy.contacts[0].penalty;
    let told = |outcome: &Outcome| {
        let all = outcome.summary.warnings.iter();
        all.filter(|w| w.contains("before the last one are off"))
            .count()
    };
    scene["contacts"]["c"]["penalty"] = json!({ "value": penalty });
    let given = run(&scene);
    let off = (before(&ruled) / before(&given) - 1.0).abs();
    println!("{off} {:?}", ruled.summary.warnings);
    assert!(off > 0.05, "{off}");
    assert_eq!((told(&ruled), told(&given)), (1, 0));
}

/// A thin rubber sheet bends under next to nothing, and its penalty starts soft. Under a vacuum it would sink into its tool by its
/// whole thickness in the first step: it starts where the pressure of that step, .01, sinks in by a tenth of the thickness.
#[test]
fn a_sheet_under_pressure_starts_as_stiff_as_its_pressure_asks_for() {
    let sheet = |loads: Value| {
        let scene = json!({
            "covact": 1,
            "materials": { "rubber": { "neo_hooke": { "E": 3, "nu": 0.45 } } },
            "bodies": { "sheet": {
                "mesh": { "plate": { "size": [32, 32], "thickness": 1, "elements": [8, 8], "origin": [0, 0, 0.6] } },
                "material": "rubber"
            } },
            "surfaces": { "mould": { "cylinder": {
                "radius": 12, "length": 60, "center": [0, 16, -12], "axis": [0, 1, 0]
            } } },
            "contacts": { "c": { "slave": "sheet.bottom", "master": "mould" } },
            "supports": {
                "a": { "on": "sheet.x_min", "symmetry": "x" }, "b": { "on": "sheet", "plane_strain": "y" }
            },
            "loads": loads,
            "output": { "every": 0 }
        });
        let loaded = covact::scene::parse(&scene.to_string(), "sheet.json").expect("a scene");
        let model = covact::model::build::build(&loaded).expect("a model");
        (model.pairs[0].eps_n, scene)
    };
    let (alone, _) = sheet(json!({}));
    let (pressed, scene) =
        sheet(json!({ "v": { "on": "sheet.top", "pressure": ".1*t", "follower": true } }));
    assert!(alone < 0.01, "{alone}");
    assert!((pressed - 0.01 / 0.1).abs() < 1e-12, "{pressed}");
    // It lies around the mould at its end, and what it weighs on it is the pressure on what is above the mould's middle.
    let outcome = solve(&scene);
    assert_eq!(outcome.summary.status.name(), "done");
}
