//! `h8_mean_dilatation`: bricks that share one change of volume, in rubber and in bending.
use crate::support::solve;
use serde_json::json;

const E: f64 = 6.0;
const RADII: [f64; 2] = [1.0, 2.0];
const WIDTH: f64 = 0.5;
const WAY: f64 = 1e-3;

/// A quarter of a tube in plane strain, `n` elements through its wall, whose inner face moves outwards by `WAY`: the pressure there, from the
/// energy stored.
fn tube(element: &str, n: u32, nu: f64) -> f64 {
    let [a, b] = RADII;
    let out = |axis: &str| format!("{WAY} * {axis} / {a}");
    let scene = json!({
        "covact": 1,
        "materials": {"rubber": {"neo_hooke": {"E": E, "nu": nu}}},
        "bodies": {"tube": {
            "mesh": {"cylinder_panel": {
                "radius": 0.5 * (a + b), "thickness": b - a, "angles": [0, 90], "y": [0, WIDTH],
                "elements": [2 * n, 1], "layers": n
            }},
            "material": "rubber", "element": element
        }},
        "supports": {
            "bottom": {"on": "tube.phi_min", "symmetry": "x"},
            "side": {"on": "tube.phi_max", "symmetry": "z"},
            "ends": {"on": ["tube.y_min", "tube.y_max"], "symmetry": "y"},
            "bore": {"on": "tube.inner", "displacement": {"x": out("x"), "z": out("z")}}
        },
        "solution": {"kinematics": "small", "step": {"initial": 1, "max": 1}},
        "output": {"every": 0}
    });
    let outcome = solve(&scene);
    assert_eq!(outcome.summary.status.name(), "done");
    let bore = 0.5 * std::f64::consts::PI * a * WIDTH;
    2.0 * outcome.at("energy.internal", 1.0) / (bore * WAY)
}

/// Lamé's tube in plane strain: at an inner pressure p the bore widens by `p a (1 + nu) ((1 - 2 nu) a^2 + b^2) / (E (b^2 - a^2))`
/// (S. Timoshenko and J. N. Goodier, Theory of Elasticity, section 28). Nearly incompressible, its error falls with the
/// square of the size of elements, while that of plain bricks is many times the force.
#[test]
fn a_tube_of_rubber_has_lames_stiffness() {
    let nu = 0.4999;
    let [a, b] = RADII;
    let exact = WAY * E * (b * b - a * a) / (a * (1.0 + nu) * ((1.0 - 2.0 * nu) * a * a + b * b));
    let errors = [4, 8, 16].map(|n| tube("h8_mean_dilatation", n, nu) / exact - 1.0);
    let plain = tube("h8_displacement", 8, nu) / exact - 1.0;
    println!("{errors:?} {plain}");
    for pair in errors.windows(2) {
        let rate = (pair[0] / pair[1]).log2();
        assert!((1.8..2.2).contains(&rate), "{errors:?}: rate {rate}");
    }
    assert!(errors[2].abs() < 5e-3, "{errors:?}");
    assert!(plain > 1.0, "{plain}");
}

/// Energy of a cantilever, 10 by 1 by 1 and clamped, under a small force at its end, of elements `1 / n` long.
fn cantilever(n: u32, element: Option<&str>) -> f64 {
    let mut scene = json!({
        "covact": 1,
        "materials": { "m": { "neo_hooke": { "E": 1000, "nu": 0.3 } } },
        "bodies": { "beam": { "mesh": { "block": { "size": [10, 1, 1], "elements": [10 * n, n, n] } }, "material": "m" } },
        "supports": { "root": { "on": "beam.x_min", "fixed": true } },
        "loads": { "end": { "on": "beam.x_max", "force": [0, 0, -0.01] } },
        "solution": { "step": { "initial": 1, "max": 1 } },
        "output": { "every": 0 }
    });
    if let Some(element) = element {
        scene["bodies"]["beam"]["element"] = json!(element);
    }
    solve(&scene).at("energy.internal", 1.0)
}

/// A beam of four bricks through its height bends within a hundredth of solid-shells half as large, which are a hundredth below
/// Timoshenko's beam: bricks are the default from there on. The plain brick, which locks in bending, is three times as far off.
#[test]
fn four_bricks_through_the_height_bend() {
    let finer = cantilever(8, Some("h8"));
    let timoshenko = 0.5
        * 0.01
        * (0.01 * 1000.0 / (3.0 * 1000.0 / 12.0) + 0.01 * 10.0 / (5.0 / 6.0 * 1000.0 / 2.6));
    assert!(
        (finer / timoshenko - 1.0).abs() < 0.01,
        "{}",
        finer / timoshenko
    );
    let bricks = cantilever(4, None);
    assert_eq!(bricks, cantilever(4, Some("h8_mean_dilatation")));
    let [off, plain] = [bricks, cantilever(4, Some("h8_displacement"))].map(|e| 1.0 - e / finer);
    assert!(off.abs() < 0.01 && plain > 3.0 * off, "{off} {plain}");
}
