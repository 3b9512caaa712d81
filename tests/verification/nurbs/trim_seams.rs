//! Faces that are joined along curves of trims.
use super::trim_supports::{corner, quarter};
use super::trims::{face, file, line};
use super::{arc, off, solve_sheet_file};
use crate::support::{scene_json, set, solve};
use serde_json::{Value, json};
use std::f64::consts::{FRAC_PI_2, PI};

const INNER: f64 = 0.5;

/// A curve the other way round.
fn reversed(mut curve: Value) -> Value {
    curve["points"].as_array_mut().expect("points").reverse();
    curve
}

/// The inner part of a disc, cut out of a square whose elements lie askew to those of the outer part.
fn inner() -> Value {
    let side = 0.66;
    let r = INNER / side;
    let trim = json!([[
        line([0.0, 0.0], [r, 0.0]),
        quarter(r),
        line([0.0, r], [0.0, 0.0])
    ]]);
    corner(1, side, trim)
}

/// The outer part, cut out of a square of another side, twice.
fn trimmed() -> Value {
    let side = 1.2;
    let [a, b] = [INNER, 1.0].map(|r| r / side);
    let trim = json!([[
        line([a, 0.0], [b, 0.0]),
        quarter(b),
        line([0.0, b], [0.0, a]),
        reversed(quarter(a))
    ]]);
    corner(2, side, trim)
}

/// The outer part as a patch whose edge is the circle.
fn whole() -> Value {
    let mut points = Vec::new();
    for radius in [INNER, 1.0] {
        points
            .extend(arc(0.0, FRAC_PI_2).map(|[x, y, w]| [w * radius * x, w * radius * y, 0.0, w]));
    }
    face(2, [2, 1], &points, Value::Null)
}

/// Discs of an inner and an outer face under pressure against the closed form: joined along a curve that trims both, and one that is an
/// edge of one. (Timoshenko and Woinowsky-Krieger, article 16.)
#[test]
fn discs_of_two_faces() {
    let (e, nu, t, q): (f64, f64, f64, f64) = (1e6, 0.3, 0.01, 1e-5);
    let clamped = q * 12.0 * (1.0 - nu * nu) / (64.0 * e * t.powi(3));
    let hinged = clamped * (5.0 + nu) / (1.0 + nu);
    for (outer, rim, edges) in [
        (
            trimmed(),
            "plate.2.trim.1.2",
            ["plate.2.edge.1", "plate.2.edge.3"],
        ),
        (
            whole(),
            "plate.2.edge.4",
            ["plate.2.edge.2", "plate.2.edge.1"],
        ),
    ] {
        for (mut support, exact) in [
            (json!({"clamped": true}), clamped),
            (json!({"displacement": {"z": 0}}), hinged),
        ] {
            support["on"] = json!(rim);
            let scene = json!({
                "covact": 1,
                "materials": {"m": {"st_venant_kirchhoff": {"E": e, "nu": nu}}},
                "bodies": {"plate": {"nurbs": {"file": "face.json", "thickness": t, "size": 0.1}, "material": "m"}},
                "supports": {
                    "x": {"on": ["plate.1.edge.1", edges[0]], "symmetry": "x"},
                    "y": {"on": ["plate.1.edge.3", edges[1]], "symmetry": "y"},
                    "rim": support
                },
                "loads": {"q": {"on": "plate.top", "traction": [0, 0, -q]}},
                "probes": {"w": {"on": "plate.1.corner.1", "quantity": "displacement"}},
                "solution": {"step": {"initial": 1.0, "max": 1.0}, "newton": {"tolerance": 1e-6}},
                "output": {"every": 0}
            });
            let outcome = solve_sheet_file(&file(vec![inner(), outer.clone()]), &scene);
            let w = -outcome.at("probe.w.z", 1.0);
            let force = outcome.at("force.rim.z", 1.0);
            println!("{rim}: {} {}", w / exact, force / (0.25 * PI * q));
            assert!(off(w, exact) < 2e-4, "{w} {exact}");
            assert!(off(force, 0.25 * PI * q) < 1e-8, "{force}");
        }
    }
}

/// `folded_panel`, coarser and with the first part of the punch's way. The reference is the same panel with four faces without a trim in place
/// of the one with the hole, at elements of 3; without the hole it is 4 % more.
#[test]
fn a_folded_panel_with_a_hole() {
    let mut scene = scene_json("folded_panel.json");
    set(&mut scene, "/bodies/panel/nurbs/size", 5);
    scene["solution"] = json!({"end_time": 0.4, "step": {"initial": 0.2, "max": 0.2}});
    scene["output"] = json!({"every": 0});
    let outcome = solve(&scene);
    assert_eq!(
        outcome.summary.status.name(),
        "done",
        "{:?}",
        outcome.summary.reason
    );
    let force = outcome.at("force.punch.z", 0.4);
    println!("{force}");
    assert!(off(force, -1.45149) < 1e-2, "{force}");
}
