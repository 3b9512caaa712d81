use super::*;
use crate::run::{RunOptions, run};
use crate::scene;
use crate::solve::event::{Event, Observer};
use std::sync::atomic::AtomicBool;

struct Silent;

impl Observer for Silent {
    fn event(&mut self, _: &Event) {}
}

fn solve(bench: &mut Bench, id: &str, scene: &Json) {
    let folder = bench.done(id);
    let loaded = match scene::parse(&scene.to_string(), "scene.json") {
        Ok(loaded) => loaded,
        Err(e) => panic!("{e}"),
    };
    let options = RunOptions::default();
    let never = AtomicBool::new(false);
    run(&loaded, &folder, &options, &mut Silent, &never).expect("a run");
}

const LENGTH: f64 = 10.0;
const THICKNESS: f64 = 0.1;
const E: f64 = 1000.0;
const TIP: f64 = 1e-4;

/// A cantilever of width 1 whose tip is moved a little; without Poisson's ratio it is a beam.
fn cantilever(element: &str, n: u32) -> Json {
    json!({
        "covact": 1,
        "materials": { "m": { "st_venant_kirchhoff": { "E": E, "nu": 0 } } },
        "bodies": { "beam": {
            "mesh": { "plate": { "size": [LENGTH, 1], "thickness": THICKNESS, "elements": [n, 1] } },
            "material": "m",
            "element": element
        } },
        "supports": {
            "clamp": { "on": "beam.x_min", "fixed": true },
            "tip": { "on": "beam.x_max", "displacement": { "z": format!("{TIP}*t") } }
        },
        "solution": { "step": { "initial": 1, "max": 1 } }
    })
}

/// Force at the tip by Timoshenko's beam, shear factor 5/6.
fn beam_force() -> f64 {
    let bending = LENGTH.powi(3) / (3.0 * E * THICKNESS.powi(3) / 12.0);
    let shear = LENGTH / (5.0 / 6.0 * 0.5 * E * THICKNESS);
    TIP / (bending + shear)
}

/// Richardson's estimate from three runs with H8 against what is known of the beam: the order is 2, and the estimate within
/// some percent of the error of the finest, as its next term is of order 4.
#[test]
fn estimate_of_a_cantilever() {
    let mut bench = Bench::new();
    solve(&mut bench, "q18", &cantilever("q18", 8));
    for n in [4, 8, 16] {
        solve(&mut bench, &format!("h8 {n}"), &cantilever("h8", n));
    }
    bench.refinement("fine", 3);
    let force = json!({ "column": { "name": "force.tip.z" } });
    let quantities = json!([
        { "name": "force", "of": force, "reference": finest() },
        { "name": "true force", "of": force, "reference":
            { "value": { "value": beam_force(), "source": "Timoshenko's beam" } } },
        { "name": "displacement", "of": { "field": { "body": "beam", "name": "displacement" } },
            "reference": finest() },
        { "name": "iterations", "of": { "summary": { "name": "newton_iterations" } } }
    ]);
    let (records, warnings) = bench.measure(quantities, refinement(json!({})));
    let truth = |run: usize| bench.runs[run].measured[1].error.unwrap();
    let reference = records[0].reference.as_ref().unwrap();
    assert!(reference.observed);
    near(reference.order.unwrap(), 2.0, 0.02);
    near(reference.error.unwrap(), truth(3), 0.04);
    // Quadratic elements are nearer to the beam than the reference is: the study says that it cannot tell how near.
    assert!(truth(0) < 0.02 * truth(3), "{} {}", truth(0), truth(3));
    says(&warnings, &["`force`", "cannot be told apart", "`q18`"]);
    let field = records[2].reference.as_ref().unwrap();
    near(field.order.unwrap(), 2.0, 0.05);
    let of_field = |run: usize| bench.runs[run].measured[2].error.unwrap();
    // Fields with errors e and e/4 of one shape are 3/4 e apart.
    near(of_field(2), 3.0 * field.error.unwrap(), 0.05);
    assert!(bench.runs[0].measured[3].value.unwrap() >= 1.0);
}

/// A plate under a ball on two kinds of elements: contact fields of real results are compared on the slave faces.
#[test]
fn contact_fields_of_a_plate_under_a_ball() {
    let path = concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/examples/scenes/ball_on_plate.json"
    );
    let text = std::fs::read_to_string(path).expect("a shipped scene");
    let mut scene: Json = serde_json::from_str(&text).expect("a scene");
    scene["solution"] = json!({ "step": { "initial": 0.25, "max": 0.25 }, "end_time": 0.5 });
    let mut bench = Bench::new();
    for (id, element, n) in [("h8", "h8", 6), ("q18", "q18", 3), ("fine", "q18", 6)] {
        scene["bodies"]["plate"]["element"] = json!(element);
        scene["bodies"]["plate"]["mesh"]["plate"]["elements"] = json!([n, n]);
        solve(&mut bench, id, &scene);
    }
    bench.refinement("fine", 2);
    let field = |name: &str| {
        json!({ "name": name, "of": { "field": { "body": "plate", "name": name } },
            "reference": finest() })
    };
    let names = [
        "displacement",
        "contact_pressure",
        "contact_gap",
        "cauchy_stress",
    ];
    let quantities = names.map(field).to_vec();
    let (_, warnings) = bench.measure(json!(quantities), refinement(json!({ "order": 2 })));
    let error = |run: usize, q: usize| {
        let measured = &bench.runs[run].measured[q];
        measured
            .error
            .unwrap_or_else(|| panic!("{run} {q}: {measured:?}"))
    };
    for run in [0, 1] {
        assert!(error(run, 0) < 0.1, "{}", error(run, 0));
        // The contact is smaller than an element: pressures are far off, and not nothing.
        assert!(
            error(run, 1) > 0.1 && error(run, 1) < 10.0,
            "{}",
            error(run, 1)
        );
        assert!(error(run, 2) < 0.1, "{}", error(run, 2));
    }
    assert!(
        warnings.iter().all(|w| !w.contains("nearest place")),
        "{warnings:?}"
    );
}
