//! Trimmed faces as masters: there is no contact where a trim leaves nothing.
use super::trims::{circle, face, square};
use super::{off, solve_sheet_file};
use serde_json::{Value, json};

/// Centres and sizes of the faces of the block's bottom: 9 x 6 over [0.13, 1.63] x [-0.4, 0.5].
fn gauss_area(counts: impl Fn(f64, f64) -> bool) -> f64 {
    let rule = [
        (-0.6f64.sqrt(), 5.0 / 9.0),
        (0.0, 8.0 / 9.0),
        (0.6f64.sqrt(), 5.0 / 9.0),
    ];
    let size = [1.5 / 9.0, 0.9 / 6.0];
    let mut area = 0.0;
    for k in 0..54 {
        for (s, v) in rule {
            for (t, w) in rule {
                let x = 0.13 + size[0] * (f64::from(k % 9) + 0.5 + 0.5 * s);
                let y = -0.4 + size[1] * (f64::from(k / 9) + 0.5 + 0.5 * t);
                if counts(x, y) {
                    area += 0.25 * v * w * size[0] * size[1];
                }
            }
        }
    }
    area
}

/// A block that is moved as a whole onto a plate that is held, partly over its hole of radius 1: pressed are the points outside of the
/// hole, all alike, and those over a face that fills the hole, also beside the curve along which both are joined.
#[test]
fn points_over_a_hole_are_free() {
    let (penalty, depth) = (50.0, 0.04);
    let run = |file: &Value, counts: &dyn Fn(f64, f64) -> bool| {
        let scene = json!({
            "covact": 1,
            "materials": {"m": {"st_venant_kirchhoff": {"E": 100, "nu": 0.3}}},
            "bodies": {
                "plate": {"nurbs": {"file": "face.json", "thickness": 0.2, "elements": [5, 5]}, "material": "m"},
                "block": {
                    "mesh": {"block": {"min": [0.13, -0.4, 0.1], "max": [1.63, 0.5, 0.9], "elements": [9, 6, 1]}},
                    "material": "m"
                }
            },
            "supports": {
                "held": {"on": "plate", "fixed": true},
                "grip": {"on": "block", "displacement": {"x": 0, "y": 0, "z": format!("-{depth}*t")}}
            },
            "contacts": {"c": {
                "slave": "block.bottom", "master": "plate.top", "points": {"gauss": 3}, "penalty": {"value": penalty}
            }},
            "solution": {"step": {"initial": 0.5, "max": 0.5}},
            "output": {"every": 0}
        });
        let outcome = solve_sheet_file(file, &scene);
        let found = outcome.at("force.grip.z", 1.0).abs();
        let exact = penalty * depth * gauss_area(counts);
        println!("{found} {exact}");
        assert!(off(found, exact) < 1e-9, "{found} {exact}");
    };
    let hole = square(1.0);
    run(&hole, &|x, y| x.hypot(y) > 1.0);
    let points = [[-2.0, -2.0], [2.0, -2.0], [-2.0, 2.0], [2.0, 2.0]];
    let points = points.map(|[x, y]| [x, y, 0.0, 1.0]);
    let mut filled = hole.clone();
    let plug = face(2, [1, 1], &points, json!([circle(0.25)]));
    filled["patches"]
        .as_array_mut()
        .expect("patches")
        .push(plug);
    run(&filled, &|_, _| true);
}
