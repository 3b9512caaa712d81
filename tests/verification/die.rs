//! Sheet stretched into a die whose faces are trimmed in the IGES file, against the same die put together from whole
//! patches of revolution: a ring for the top, a quarter of a torus for the fillet, a cylinder for the opening. Both are
//! exact, so the trims, the joints between trimmed faces and the reader must not be felt at all.
use crate::support::{scene_json, set, solve};
use serde_json::{Value, json};

/// A full turn of a rational quadratic profile about z, as a surface of geomdl's format; profile points are (r, z, w).
fn turned(profile: &[[f64; 3]]) -> Value {
    let half = 0.5f64.sqrt();
    // Nine points of a circle of radius one, between them the corners of the square around it.
    let circle: Vec<[f64; 3]> = (0..9)
        .map(|k| {
            let (sin, cos) = (std::f64::consts::FRAC_PI_4 * f64::from(k)).sin_cos();
            if k % 2 == 0 {
                [cos.round(), sin.round(), 1.0]
            } else {
                [cos.signum(), sin.signum(), half]
            }
        })
        .collect();
    let degree = profile.len() - 1;
    let ends = |x: f64| vec![x; degree + 1];
    let mut points = Vec::new();
    let mut weights = Vec::new();
    // u around the axis, v along the profile and fastest.
    for [x, y, w] in circle {
        for &[r, z, v] in profile {
            points.push([r * x, r * y, z]);
            weights.push(w * v);
        }
    }
    let knots = [ends(0.0), ends(1.0)].concat();
    json!({
        "type": "spline", "rational": true, "dimension": 3,
        "degree_u": 2, "degree_v": degree,
        "knotvector_u": [0.0, 0.0, 0.0, 1.0, 1.0, 2.0, 2.0, 3.0, 3.0, 4.0, 4.0, 4.0],
        "knotvector_v": knots,
        "size_u": 9, "size_v": degree + 1,
        "control_points": { "points": points, "weights": weights }
    })
}

/// The shipped scene on a coarse mesh, pushed in by 6 mm.
fn coarse() -> Value {
    let mut scene = scene_json("sheet_in_die.json");
    set(
        &mut scene,
        "/bodies/sheet/mesh/plate/elements",
        vec![12, 12],
    );
    scene["surfaces"]["punch"]["motion"]["translation"] = json!([0, 0, "-6*t"]);
    scene["solution"]["newton"] = json!({ "tolerance": 1e-11 });
    scene["solution"]["step"] = json!({ "initial": 0.125, "max": 0.125 });
    scene
}

#[test]
fn a_trimmed_die_is_the_die_of_whole_patches() {
    let trimmed = solve(&coarse());
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("die.json");
    let half = 0.5f64.sqrt();
    let data = [
        turned(&[[26.0, 0.0, 1.0], [60.0, 0.0, 1.0]]),
        turned(&[[26.0, 0.0, 1.0], [20.0, 0.0, half], [20.0, -6.0, 1.0]]),
        turned(&[[20.0, -6.0, 1.0], [20.0, -20.0, 1.0]]),
    ];
    let file = json!({ "shape": { "type": "surface", "count": 3, "data": data } });
    std::fs::write(&path, file.to_string()).unwrap();
    let mut scene = coarse();
    scene["surfaces"]["die"] = json!({ "cad": { "file": path }, "depth": 11.4891 });
    let whole = solve(&scene);
    for outcome in [&trimmed, &whole] {
        let summary = &outcome.summary;
        assert_eq!(summary.status.name(), "done", "{:?}", summary.reason);
    }
    let mut compared = 0;
    for name in [
        "force.punch.z",
        "force.die.z",
        "force.clamped_x.x",
        "energy.internal",
    ] {
        let (a, b) = (trimmed.column(name), whole.column(name));
        let (a, b) = (a[a.len() - 1], b[b.len() - 1]);
        println!("{name}: trimmed {a}, whole {b}");
        assert!(a.abs() > 1e-3, "{name}: {a}");
        assert!((a / b - 1.0).abs() < 1e-8, "{name}: {a} {b}");
        compared += 1;
    }
    assert_eq!(compared, 4);
}
