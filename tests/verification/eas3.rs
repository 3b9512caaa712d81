//! `h8_eas3`: the enhanced strains of `h8` that act through the thickness, and none in the plane.
use crate::support::solve;
use serde_json::{Value, json};

const E: f64 = 1000.0;
const SIZE: [f64; 3] = [100.0, 10.0, 1.0];
const TIP: f64 = 0.1;

/// A cantilever of `n` elements along its length whose end is pushed by `TIP`, under small displacements.
fn cantilever(element: &str, n: u32, nu: f64, supports: Value) -> f64 {
    let mut scene = json!({
        "covact": 1,
        "materials": {"m": {"st_venant_kirchhoff": {"E": E, "nu": nu}}},
        "bodies": {"s": {
            "mesh": {"plate": {"size": [SIZE[0], SIZE[1]], "thickness": SIZE[2], "elements": [n, 2]}},
            "material": "m", "element": element
        }},
        "supports": supports,
        "solution": {"kinematics": "small", "step": {"initial": 1, "max": 1}},
        "output": {"every": 0}
    });
    scene["supports"]["wall"] = json!({"on": "s.x_min", "fixed": true});
    let outcome = solve(&scene);
    assert_eq!(outcome.summary.status.name(), "done");
    let force = |axis: &str| outcome.at(&format!("force.tip.{axis}"), 1.0);
    force("x").hypot(force("y")).hypot(force("z"))
}

/// Across its plane: `F = 3 D b w / L^3` in plane strain (S. Timoshenko, Theory of Plates and Shells), as `h8`; linear elements
/// bend too little by `1 / (4 n^2)`.
#[test]
fn a_sheet_bends_as_with_h8() {
    let nu = 0.3;
    let [l, b, h] = SIZE;
    let exact = 3.0 * E * h.powi(3) / 12.0 / (1.0 - nu * nu) * b * TIP / l.powi(3);
    let n = 20;
    let [eas3, eas7] = ["h8_eas3", "h8"].map(|element| {
        let sides = json!({
            "sides": {"on": ["s.y_min", "s.y_max"], "symmetry": "y"},
            "tip": {"on": "s.x_max", "mid_surface": true, "displacement": {"z": TIP}}
        });
        cantilever(element, n, nu, sides) / exact
    });
    println!("{eas3} {eas7}");
    let order = 1.0 / f64::from(4 * n * n);
    assert!((eas3 - 1.0 - order).abs() < 0.2 * order, "{eas3}");
    assert!((eas3 / eas7 - 1.0).abs() < 1e-6, "{eas3} {eas7}");
}

/// In its plane: as stiff as plain bricks (49 % too stiff with elements twice as long as wide), where `h8` has beam theory's
/// force within half a percent.
#[test]
fn a_sheet_is_stiff_in_its_plane_as_plain_bricks_are() {
    let [l, b, h] = SIZE;
    let exact = 3.0 * E * h * b.powi(3) / 12.0 * TIP / l.powi(3);
    let [eas3, plain, eas7] = ["h8_eas3", "h8_displacement", "h8"].map(|element| {
        let flat = json!({
            "flat": {"on": "s.bottom", "symmetry": "z"},
            "tip": {"on": "s.x_max", "displacement": {"y": TIP}}
        });
        cantilever(element, 10, 0.0, flat) / exact
    });
    println!("{eas3} {plain} {eas7}");
    assert!((eas3 / plain - 1.0).abs() < 1e-6, "{eas3} {plain}");
    assert!(eas3 > 1.4, "{eas3}");
    assert!((eas7 - 1.0).abs() < 5e-3, "{eas7}");
}
