//! Bodies that only contact holds, with the help of viscous stabilisation.
use crate::support::{Outcome, solve};
use serde_json::{Value, json};

/// A cube of edge 1 at height `gap` over a rigid floor, without any support, under the force `load` on its top; `mu` on the
/// floor. The modulus is 1000.
fn cube(gap: f64, load: [Value; 3], mu: Option<f64>) -> Value {
    let mut scene = json!({
        "covact": 1,
        "materials": {"m": {"neo_hooke": {"E": 1000, "nu": 0.3}}},
        "bodies": {"cube": {
            "mesh": {"block": {"min": [0, 0, gap], "max": [1, 1, gap + 1.0], "elements": [3, 3, 3]}},
            "material": "m"
        }},
        "surfaces": {"floor": {"plane": {"size": [10, 10]}}},
        "contacts": {"on_floor": {"slave": "cube.bottom", "master": "floor"}},
        "loads": {"weight": {"on": "cube.top", "force": load}},
        "solution": {"stabilization": {"viscous": {}}, "threads": 1},
        "output": {"every": 0}
    });
    if let Some(mu) = mu {
        scene["contacts"]["on_floor"]["friction"] = json!({"coulomb": {"mu": mu}});
    }
    scene
}

fn show(outcome: &Outcome) {
    let s = &outcome.summary;
    println!(
        "{} at {}: {:?}\n{} steps, {} cuts, {} iterations",
        s.status.name(),
        s.time,
        s.reason,
        s.steps,
        s.cuts,
        s.newton_iterations
    );
    for name in [
        "time",
        "dt",
        "force.floor.z",
        "force.floor.x",
        "energy.internal",
        "energy.stabilization",
        "stabilization.share",
        "penetration.max",
    ] {
        println!("{name}: {:.3e?}", outcome.column(name));
    }
    for w in &s.warnings {
        println!("warning: {w}");
    }
}

#[test]
fn falls_and_rests() {
    for gap in [0.0, 0.2, 1e-9] {
        let outcome = solve(&cube(gap, [json!(0), json!(0), json!("-10*t")], None));
        show(&outcome);
    }
    for gap in [0.0, 0.2] {
        let outcome = solve(&cube(gap, [json!(0), json!(0), json!(-10)], None));
        show(&outcome);
    }
}

#[test]
fn incline() {
    for (mu, pull) in [(0.3, 2.9), (0.3, 3.1)] {
        let outcome = solve(&cube(
            0.0,
            [json!(format!("{pull}*t")), json!(0), json!(-10)],
            Some(mu),
        ));
        show(&outcome);
    }
}
