//! Faces that are joined along curves of trims.
use super::trim_supports::{corner, quarter};
use super::trims::{face, file, line};
use super::{arc, off, solve_sheet_file};
use crate::support::{Outcome, scene_json, set, solve, solve_in};
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
        points.extend(arc(0.0, FRAC_PI_2).map(|[x, y, w]| [radius * x, radius * y, 0.0, w]));
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
                "solution": {"step": {"initial": 1.0, "max": 1.0}, "newton": {"tolerance": 1e-8}},
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

/// `folded_panel`, coarser and with the first part of the punch's way: the same panel whose face with the hole is four faces without a
/// trim takes the same force.
#[test]
fn a_folded_panel_with_a_hole() {
    let mut scene = scene_json("folded_panel.json");
    set(&mut scene, "/bodies/panel/nurbs/size", 6);
    scene["solution"]["end_time"] = json!(0.4);
    scene["output"] = json!({"every": 0});
    let force = |outcome: Outcome| {
        assert_eq!(
            outcome.summary.status.name(),
            "done",
            "{:?}",
            outcome.summary.reason
        );
        outcome.at("force.punch.z", 0.4)
    };
    let trimmed = force(solve(&scene));
    // From the hole outwards: the middle (-34, 25), radius 9; the sides are those of the face.
    let sides = [[-60.0, 0.0], [0.0, 0.0], [0.0, 50.0], [-60.0, 50.0]];
    let (c, radius): ([f64; 2], f64) = ([-34.0, 25.0], 9.0);
    let (sin, cos) = 25f64.to_radians().sin_cos();
    let down = [40.0 * cos, -40.0 * sin];
    let mut all = Vec::new();
    // The first one says which side is the top.
    for (entity, [x, z], [x1, z1]) in [(5, [0.0, 0.0], down), (6, down, [down[0] + 20.0, down[1]])]
    {
        let points = [[x, 0.0, z], [x1, 0.0, z1], [x, 50.0, z], [x1, 50.0, z1]];
        all.push(face(
            entity,
            [1, 1],
            &points.map(|[x, y, z]| [x, y, z, 1.0]),
            Value::Null,
        ));
    }
    for k in 0..4 {
        // Counter-clockwise from the right-hand side.
        let ends = [[1, 2], [2, 3], [3, 0], [0, 1]][k].map(|i: usize| sides[i]);
        let angles = ends.map(|[x, y]| (y - c[1]).atan2(x - c[0]));
        let [a, mut b] = angles;
        if b < a {
            b += 2.0 * PI;
        }
        let inner = arc(a, b);
        let mut points: Vec<[f64; 4]> = (inner.iter())
            .map(|[x, y, w]| [w * (c[0] + radius * x), w * (c[1] + radius * y), 0.0, *w])
            .collect();
        for (i, inner) in inner.iter().enumerate() {
            let (w, s) = (inner[2], 0.5 * i as f64);
            let at = [0, 1].map(|d| ends[0][d] + s * (ends[1][d] - ends[0][d]));
            points.push([w * at[0], w * at[1], 0.0, w]);
        }
        all.push(face(k as u32 + 1, [2, 1], &points, Value::Null));
    }
    let mut other = scene.clone();
    other["bodies"]["panel"]["nurbs"]["file"] = json!("face.json");
    let punch = concat!(env!("CARGO_MANIFEST_DIR"), "/assets/cad/round_punch.step");
    other["surfaces"]["punch"]["cad"]["file"] = json!(punch);
    other["supports"]["frame"]["on"] = json!([
        "panel.2.edge.4",
        "panel.3.edge.4",
        "panel.4.edge.4",
        "panel.5.edge.3",
        "panel.5.edge.4",
        "panel.6.edge.2",
        "panel.6.edge.3",
        "panel.6.edge.4"
    ]);
    let folder = tempfile::tempdir().expect("temporary folder");
    std::fs::write(folder.path().join("face.json"), file(all).to_string()).expect("written");
    let whole = force(solve_in(&other, folder.path()));
    println!("{trimmed} trimmed, {whole} of faces without a trim");
    assert!(
        trimmed.abs() > 1.0 && off(trimmed, whole) < 1e-2,
        "{trimmed} {whole}"
    );
}
