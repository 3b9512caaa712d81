//! Linear elements: patch tests, plate bending, and what they take.
use crate::support::{Outcome, solve, solve_in};
use crate::{displacements, factorizations, large, off, scene};
use serde_json::{Value, json};

/// `u = H x` with gradients of order one: where anything were not linear it would show.
const H: [[f64; 3]; 3] = [[0.3, -0.2, 0.1], [0.15, -0.25, 0.05], [0.2, 0.1, 0.4]];

/// A block of 2 x 2 x 2 elements in Abaqus' format whose middle nodes are moved; along all three axes, or in the plane.
fn patch(solid: bool) -> String {
    let mut text = String::from("*NODE\n");
    for n in 0..27 {
        let at = [n % 3, n / 3 % 3, n / 9].map(|i| i as f64);
        let middle = |c: usize| at[c] == 1.0;
        let mut x = at;
        if middle(0) && middle(1) && (!solid || middle(2)) {
            x = [1.2, 0.85, if solid { 1.1 } else { x[2] }];
        }
        text += &format!("{}, {}, {}, {}\n", n + 1, x[0], x[1], x[2]);
    }
    text += "*ELEMENT, TYPE=C3D8, ELSET=all\n";
    for e in 0..8 {
        let at =
            |i: usize, j: usize, k: usize| 1 + (e % 2 + i) + 3 * (e / 2 % 2 + j) + 9 * (e / 4 + k);
        let nodes = [
            [0, 0, 0],
            [1, 0, 0],
            [1, 1, 0],
            [0, 1, 0],
            [0, 0, 1],
            [1, 0, 1],
            [1, 1, 1],
            [0, 1, 1],
        ]
        .map(|[i, j, k]| at(i, j, k).to_string());
        text += &format!("{}, {}\n", e + 1, nodes.join(", "));
    }
    text
}

fn linear(row: [f64; 3]) -> String {
    format!("{}*x+({})*y+({})*z", row[0], row[1], row[2])
}

#[test]
fn patches_are_exact_at_any_gradient() {
    let (lambda, mu) = (100.0 * 0.3 / (1.3 * 0.4), 100.0 / 2.6);
    for (element, solid) in [("h8_displacement", true), ("h8", false)] {
        let folder = tempfile::tempdir().unwrap();
        std::fs::write(folder.path().join("patch.inp"), patch(solid)).unwrap();
        let held = json!({"x": linear(H[0]), "y": linear(H[1]), "z": linear(H[2])});
        let sides = ["x_min", "x_max", "y_min", "y_max", "z_min", "z_max"];
        let supports: serde_json::Map<String, Value> = sides
            .iter()
            .map(|s| {
                (
                    s.to_string(),
                    json!({"on": format!("b.{s}"), "displacement": held}),
                )
            })
            .collect();
        let sets: serde_json::Map<String, Value> = (0..6)
            .map(|i| {
                let (axis, at) = (i / 2, if i % 2 == 0 { 0.0 } else { 2.0 });
                let (mut low, mut high) = ([-0.1; 3], [2.1; 3]);
                (low[axis], high[axis]) = (at - 0.01, at + 0.01);
                (
                    sides[i].to_owned(),
                    json!({"nodes_in_box": {"min": low, "max": high}}),
                )
            })
            .collect();
        let scene = scene(
            0.3,
            json!({
                "bodies": {"b": {
                    "mesh": {"file": {"path": "patch.inp"}}, "material": "m", "element": element, "sets": sets
                }},
                "supports": supports
            }),
            1,
        );
        let outcome = solve_in(&scene, folder.path());
        assert_eq!(factorizations(&outcome), 1);
        let body = outcome.body("b", 1);
        let (u, stress) = (body.field("displacement"), body.field("cauchy_stress"));
        let trace = H[0][0] + H[1][1] + H[2][2];
        let sigma = |i: usize, j: usize| {
            mu * (H[i][j] + H[j][i]) + if i == j { lambda * trace } else { 0.0 }
        };
        let expected = [(0, 0), (1, 1), (2, 2), (0, 1), (1, 2), (0, 2)].map(|(i, j)| sigma(i, j));
        let mut inner = 0;
        for (n, x) in body.points.iter().enumerate() {
            let exact: [f64; 3] = std::array::from_fn(|i| (0..3).map(|j| H[i][j] * x[j]).sum());
            for c in 0..3 {
                assert!(
                    (u[3 * n + c] - exact[c]).abs() < 1e-13,
                    "{element}, node {n}"
                );
            }
            for (c, e) in expected.iter().enumerate() {
                let s = stress[6 * n + c];
                assert!(
                    (s - e).abs() < 1e-11,
                    "{element}, node {n}: {s} instead of {e}"
                );
            }
            inner += usize::from(x.iter().all(|x| *x > 0.01 && *x < 1.99));
        }
        assert!(inner > 0, "a node has to be found");
        // Strains of .4 are told of.
        let told = "displacements are not small, strains of body `b`";
        assert!(outcome.summary.warnings.iter().any(|w| w.starts_with(told)));
    }
}

/// A quarter of a clamped plate of side 10 under a pressure that bends it by `by` thicknesses.
fn clamped(element: &str, n: u32, t: f64, by: f64) -> (Value, f64) {
    let d = 100.0 * t.powi(3) / (12.0 * (1.0 - 0.09));
    // S. Timoshenko and S. Woinowsky-Krieger, Theory of Plates and Shells (1959), table 35: w = .00126 q a^4 / D; the
    // fourth digit of the series is .0012653.
    let q = by * t * d / (0.001_265_3 * 1e4);
    let scene = scene(
        0.3,
        json!({
            "bodies": {"p": {
                "mesh": {"plate": {"size": [5, 5], "thickness": t, "elements": [n, n]}},
                "material": "m", "element": element,
                "sets": {"middle": {"nodes_near_point": {"point": [0, 0, 0], "tolerance": t}}}
            }},
            "supports": {
                "x": {"on": "p.x_max", "fixed": true}, "y": {"on": "p.y_max", "fixed": true},
                "sx": {"on": "p.x_min", "symmetry": "x"}, "sy": {"on": "p.y_min", "symmetry": "y"}
            },
            "loads": {"q": {"on": "p.bottom", "pressure": format!("{q}*t")}}
        }),
        1,
    );
    (scene, by * t)
}

fn deflection(outcome: &Outcome) -> f64 {
    let body = outcome.body("p", outcome.summary.steps);
    let u = body.field("displacement");
    let at = |n: &usize| body.points[*n][0].abs() + body.points[*n][1].abs() < 1e-9;
    let n = (0..body.points.len()).find(at).expect("the middle");
    u[3 * n + 2]
}

#[test]
fn clamped_plate_under_pressure() {
    for (element, n, tolerance) in [("h8", 16, 5e-3), ("q18", 8, 3e-3)] {
        let (scene, w) = clamped(element, n, 0.05, 1e-3);
        let outcome = solve(&scene);
        let error = deflection(&outcome) / w - 1.0;
        println!("{element}: {:.3} %", 100.0 * error);
        // Thickness / side of 1 / 200 adds .02 % of shear.
        assert!(error.abs() < tolerance, "{element}: {error}");
        assert!(outcome.summary.warnings.is_empty());
        assert_eq!(factorizations(&outcome), 1);
        let effects = &outcome.summary.effects;
        assert!(effects.iter().any(|e| e == "small_displacements"));
        assert!(!effects.iter().any(|e| e == "large_rotation"));
    }
}

/// Towards small loads the large-rotation elements give the same: the difference vanishes with the load.
#[test]
fn linear_elements_are_the_limit_of_the_large_ones() {
    for element in ["h8", "h8_displacement", "q18"] {
        let mut last = None;
        for scale in [1e-2, 1e-3, 1e-4] {
            let pressure = format!("{}*t", 0.05 * scale);
            let scene = scene(
                0.3,
                json!({
                    "bodies": {"p": {
                        "mesh": {"cylinder_panel": {
                            "radius": 5, "thickness": 0.5, "angles": [0, 60], "y": [0, 4], "elements": [4, 3]
                        }},
                        "material": "m", "element": element
                    }},
                    "supports": {"x": {"on": "p.phi_min", "fixed": true}},
                    "loads": {"q": {"on": "p.outer", "pressure": pressure, "follower": true}}
                }),
                1,
            );
            let (small, mut large) = (solve(&scene), large(&scene));
            large["solution"]["newton"] = json!({"tolerance": 1e-12});
            let large = solve(&large);
            let difference = off(
                &displacements(&large, "p"),
                &displacements(&small, "p"),
                1.0,
            );
            println!("{element} at {scale}: {difference:e}");
            if let Some(last) = last {
                let rate: f64 = f64::log10(last / difference);
                assert!((rate - 1.0).abs() < 0.1, "{element}: order {rate}");
            }
            last = Some(difference);
        }
        assert!(last.is_some_and(|d| d < 1e-3));
    }
}
