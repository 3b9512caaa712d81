//! Scenes with 18-node solid-shells: supports, loads and contact beside those of the linear ones.
use crate::support::{BodyFile, Outcome, scene_json, set, solve};
use serde_json::{Value, json};

fn done(scene: &Value) -> Outcome {
    let outcome = solve(scene);
    assert_eq!(outcome.summary.status.name(), "done");
    outcome
}

/// A strip 10 x 4 x 1 of 3 x 2 unequal elements in two layers pulled to the stretch 1.1, free to contract. St. Venant-
/// Kirchhoff: S = E (l^2 - 1) / 2, force l S A; stress l S / lt^2 with lt^2 = 1 - nu (l^2 - 1). Uniform to round-off.
#[test]
fn uniaxial_tension_is_exact() {
    let (e, nu, stretch) = (1000.0, 0.3, 1.1f64);
    let scene = json!({
        "covact": 1,
        "materials": { "m": { "st_venant_kirchhoff": { "E": e, "nu": nu } } },
        "bodies": { "strip": {
            "element": "q18",
            "mesh": { "plate": {
                "size": [10, 4], "thickness": 1, "elements": [3, 2], "layers": 2,
                "spacing": [{ "geometric": { "ratio": 1.7 } }, { "geometric": { "ratio": 0.6 } }]
            } },
            "material": "m"
        } },
        "supports": {
            "x": { "on": "strip.x_min", "symmetry": "x" },
            "y": { "on": "strip.y_min", "symmetry": "y" },
            "z": { "on": "strip.bottom", "symmetry": "z" },
            "pull": { "on": "strip.x_max", "displacement": { "x": format!("{}*t", 10.0 * (stretch - 1.0)) } }
        },
        "output": { "every": 1 }
    });
    let outcome = done(&scene);
    let effects = &outcome.summary.effects;
    assert!(
        effects.iter().any(|e| e == "element.q18_solid_shell"),
        "{effects:?}"
    );
    let strain = 0.5 * (stretch * stretch - 1.0);
    let force = stretch * e * strain * 4.0;
    let close = |a: f64, b: f64| assert!((a - b).abs() < 1e-9 * force, "{a} is not {b}");
    close(outcome.at("force.pull.x", 1.0), force);
    close(outcome.at("force.x.x", 1.0), -force);
    let across = (1.0 - 2.0 * nu * strain).sqrt();
    let body = outcome.body("strip", outcome.summary.steps);
    let u = body.field("displacement");
    for (x, u) in body.points.iter().zip(u.chunks_exact(3)) {
        // The bottom, z = -1/2, stays.
        let expected = [
            x[0] * (stretch - 1.0),
            x[1] * (across - 1.0),
            (x[2] + 0.5) * (across - 1.0),
        ];
        (0..3).for_each(|c| assert!((u[c] - expected[c]).abs() < 1e-11));
    }
    let stress = body.field("cauchy_stress");
    assert!(stress.len() == 6 * body.points.len());
    for s in stress.chunks_exact(6) {
        close(s[0], force / 4.0 / (across * across));
        s[1..].iter().for_each(|s| close(*s, 0.0));
    }
}

/// Half a tube, mean radius 10, .4 thick, 6 long, held along its straight edges, its ends in their planes.
fn half_tube(element: &str, load: Value) -> Value {
    json!({
        "covact": 1,
        "materials": { "m": { "neo_hooke": { "E": 1000, "nu": 0.3 } } },
        "bodies": { "tube": {
            "element": element,
            "mesh": { "cylinder_panel": {
                "radius": 10, "thickness": 0.4, "angles": [-90, 90], "y": [0, 6], "elements": [6, 2]
            } },
            "material": "m"
        } },
        "supports": {
            "left": { "on": "tube.phi_min", "fixed": true },
            "right": { "on": "tube.phi_max", "fixed": true },
            "front": { "on": "tube.y_min", "symmetry": "y" },
            "back": { "on": "tube.y_max", "symmetry": "y" }
        },
        "loads": { "load": load },
        "output": { "every": 1 }
    })
}

/// What holds the tube up: the vertical reaction of both straight edges, and the largest displacement.
fn held(element: &str, load: Value) -> (f64, f64) {
    let outcome = done(&half_tube(element, load));
    let lift = outcome.at("force.left.z", 1.0) + outcome.at("force.right.z", 1.0);
    let body = outcome.body("tube", outcome.summary.steps);
    let largest = (body.field("displacement").chunks_exact(3))
        .map(|u| u.iter().map(|u| u * u).sum::<f64>().sqrt())
        .fold(0.0, f64::max);
    (lift, largest)
}

/// Totals in closed form, for both elements. The resultant of a pressure depends on the border of the loaded surface only:
/// p times the area 2 R L that it spans, with the dead pressure and, the border being held in its planes, with the one
/// that follows. Tractions act on the surface of the mesh: its area is that of the facets with H8, and with Q18 that of
/// the cylinder up to the fourth power of the elements' angle.
#[test]
fn total_loads_on_curved_faces() {
    for element in ["h8", "q18"] {
        let mut moved = Vec::new();
        for (follower, on, radius, p) in [
            // Far below what buckles it: E (t / R)^3 / (12 (1 - nu^2)) * 3 = .018.
            (false, "tube.outer", 10.2, 0.002),
            (false, "tube.inner", 9.8, 0.2),
            (true, "tube.inner", 9.8, 0.2),
        ] {
            let load = json!({ "on": on, "pressure": format!("{p}*t"), "follower": follower });
            let (lift, largest) = held(element, load);
            let sign = if on == "tube.outer" { 1.0 } else { -1.0 };
            let total = sign * p * 2.0 * radius * 6.0;
            assert!(
                (lift / total - 1.0).abs() < 1e-9,
                "{element}: {lift} for {total}"
            );
            moved.push(largest);
        }
        // Following pressure on a shape that has moved is not the dead one.
        assert!(
            moved[2] > 0.01 && (moved[2] / moved[1] - 1.0).abs() > 1e-3,
            "{moved:?}"
        );
        let (lift, _) = held(
            element,
            json!({ "on": "tube.outer", "traction": [0, 0, "-0.002*t"] }),
        );
        let arc = std::f64::consts::PI * 10.2 * 6.0 * 0.002;
        let angle = 30f64.to_radians();
        let (expected, tolerance) = match element {
            "h8" => (arc * (angle / 2.0).sin() / (angle / 2.0), 1e-9),
            _ => (arc, 2.0 * (angle / 2.0).powi(4) / 45.0),
        };
        let error = (lift / expected - 1.0).abs();
        assert!(error < tolerance, "{element}: {error:e}");
    }
    // A force is shared among the nodes, and nothing of it is lost.
    let (lift, _) = held(
        "q18",
        json!({ "on": "tube.outer", "force": [0, 0, "-0.2*t"] }),
    );
    assert!((lift / 0.2 - 1.0).abs() < 1e-9);
}

/// Radial displacement of the inner face of a quarter tube (mean radius 10, .2 thick, plane strain) under a small inner
/// pressure: Lame's solution. `n` elements along the quarter.
fn lame(element: &str, n: u32) -> f64 {
    let scene = json!({
        "covact": 1,
        "materials": { "m": { "st_venant_kirchhoff": { "E": 1e6, "nu": 0.3 } } },
        "bodies": { "tube": {
            "element": element,
            "mesh": { "cylinder_panel": {
                "radius": 10, "thickness": 0.2, "angles": [0, 90], "y": [0, 1], "elements": [n, 1]
            } },
            "material": "m"
        } },
        "supports": {
            "x": { "on": "tube.phi_min", "symmetry": "x" },
            "z": { "on": "tube.phi_max", "symmetry": "z" },
            "front": { "on": "tube.y_min", "symmetry": "y" },
            "back": { "on": "tube.y_max", "symmetry": "y" }
        },
        "loads": { "p": { "on": "tube.inner", "pressure": 0.02, "follower": true } },
        "output": { "every": 1 }
    });
    let outcome = done(&scene);
    let body = outcome.body("tube", outcome.summary.steps);
    let (a, b) = (9.9f64, 10.1f64);
    let exact = 0.02 * a * 1.3 / (1e6 * (b * b - a * a)) * (0.4 * a * a + b * b);
    let u = body.field("displacement");
    let inner = (body.points.iter().zip(u.chunks_exact(3)))
        .filter(|(x, _)| (x[0].hypot(x[2]) - a).abs() < 1e-9);
    let radial: Vec<f64> = inner
        .map(|(x, u)| (x[0] * u[0] + x[2] * u[2]) / a / exact - 1.0)
        .collect();
    assert!(radial.len() >= 2 * n as usize);
    radial.iter().fold(0.0, |m, r| r.abs().max(m))
}

/// Four quadratic elements along the quarter hold Lame's displacement everywhere; linear ones see a polygon and lose
/// what its angle takes, at rate 2.
#[test]
fn tube_under_inner_pressure() {
    let quadratic = lame("q18", 4);
    let linear = [4, 8].map(|n| lame("h8", n));
    println!("quadratic {quadratic:e}, linear {linear:?}");
    // Linear through the thickness: (t / R)^2 of the strain; the arcs: fourth power of half their angle.
    assert!(quadratic < 1e-3, "{quadratic}");
    assert!(linear[0] > 5.0 * quadratic);
    let rate = (linear[0] / linear[1]).log2();
    assert!((rate - 2.0).abs() < 0.4, "{rate}");
}

/// The plate under a ball of `plate_under_ball`, with quadratic elements.
fn ball(n: u32, points: Value) -> Outcome {
    let mut scene = scene_json("ball_on_plate.json");
    set(&mut scene, "/bodies/plate/mesh/plate/elements", vec![n, n]);
    set(&mut scene, "/contacts/press/points", points);
    scene["bodies"]["plate"]["element"] = "q18".into();
    // The steps change the way to a force, not the force.
    scene["solution"]["step"] = json!({ "initial": 0.25, "max": 0.25 });
    scene["output"] = json!({ "every": 0 });
    done(&scene)
}

fn forces(outcome: &Outcome) -> [f64; 4] {
    [0.25, 0.5, 0.75, 1.0].map(|t| -4.0 * outcome.at("force.ball.z", t))
}

/// An independent program (numpy, another recipe of a quadratic solid-shell, 10 x 10 and 20 x 20) gave 16626 and 16578 at
/// 10 mm; 80 x 80 linear elements give the curve that both go to. Quadratic elements: the forces of a bending problem
/// converge faster than at rate 2, scattered by the edge of the contact zone that cuts through elements.
#[test]
fn plate_under_a_ball_converges_to_the_curve_of_linear_elements() {
    let fine: Value = serde_json::from_str(include_str!("reference/ball_on_plate.json")).unwrap();
    let curve: [f64; 4] = std::array::from_fn(|i| fine["force"][i].as_f64().unwrap());
    let runs = [5, 10, 20].map(|n| forces(&ball(n, json!({ "gauss": 3 }))));
    for (run, reference) in runs[1..].iter().zip([16626.0, 16578.0]) {
        let error = run[3] / reference - 1.0;
        assert!(error.abs() < 3e-3, "{} instead of {reference}", run[3]);
    }
    let errors = runs.map(|f| {
        let sum: f64 = (f.iter().zip(curve))
            .map(|(f, r)| (f / r - 1.0).abs())
            .sum();
        sum / 4.0
    });
    let rates = [errors[0] / errors[1], errors[1] / errors[2]].map(f64::log2);
    println!("errors {errors:?}, rates {rates:?}");
    assert!(errors[2] < 1e-3, "{errors:?}");
    assert!(rates.iter().all(|r| *r > 1.7), "{rates:?}");
}

/// Where contact is sampled matters little: Gauss points, and nodes. Three Lobatto points a direction are the nodes, with
/// Simpson's weights their tributary areas: the same run.
#[test]
fn contact_at_nodes_and_at_quadrature_points() {
    let [nodes, lobatto] =
        [json!("nodes"), json!({ "lobatto": 3 })].map(|points| forces(&ball(5, points)));
    for i in 0..4 {
        assert!(
            (lobatto[i] / nodes[i] - 1.0).abs() < 1e-9,
            "{lobatto:?} {nodes:?}"
        );
    }
    let two = forces(&ball(10, json!({ "gauss": 2 })));
    assert!((two[3] / 16626.0 - 1.0).abs() < 3e-3, "{two:?}");
    // Nodes are 2.5 apart where the contact's edge moves over them.
    let nodes = forces(&ball(10, json!("nodes")));
    assert!((nodes[3] / 16626.0 - 1.0).abs() < 1e-2, "{nodes:?}");
    assert_ne!(nodes[3], two[3]);
}

/// A plate lying on a wide flat tool under uniform pressure: every slave point of a quadratic face carries the
/// pressure, whatever the rule, nodes with their Simpson areas included. The pressure at the nodes of the output is
/// uniform, and nowhere negative.
#[test]
fn uniform_pressure_through_quadratic_faces() {
    for points in [
        json!("nodes"),
        json!({ "gauss": 2 }),
        json!({ "gauss": 3 }),
        json!({ "lobatto": 4 }),
    ] {
        let scene = json!({
            "covact": 1,
            "materials": { "m": { "st_venant_kirchhoff": { "E": 1000, "nu": 0 } } },
            "bodies": { "plate": {
                "element": "q18",
                "mesh": { "plate": {
                    "size": [3, 2], "thickness": 0.5, "elements": [3, 2],
                    "spacing": [{ "geometric": { "ratio": 1.4 } }, "uniform"]
                } },
                "material": "m"
            } },
            "surfaces": { "table": { "plane": { "size": [20, 20], "center": [0, 0, -0.25], "normal": [0, 0, 1] } } },
            "contacts": { "lie": { "slave": "plate.bottom", "master": "table", "points": points, "penalty": { "value": 2000 } } },
            "supports": {
                "x": { "on": "plate.x_min", "symmetry": "x" },
                "y": { "on": "plate.y_min", "symmetry": "y" },
                "press": { "on": "plate.top", "displacement": { "z": "-0.01*t" } }
            },
            "output": { "every": 1 }
        });
        let outcome = done(&scene);
        // Springs in a row: penalty and thickness, the latter with S = E (e + e^2 / 2), e = -d / t.
        let pressure = {
            let mut p = 8.0;
            for _ in 0..50 {
                let e = -(0.01 - p / 2000.0) / 0.5;
                // The slope of this map is close to -1: the mean of both converges.
                p = 0.5 * (p - 1000.0 * (e + 0.5 * e * e) * (1.0 + e));
            }
            p
        };
        assert!((outcome.at("force.table.z", 1.0) / (6.0 * pressure) - 1.0).abs() < 1e-8);
        let body: BodyFile = outcome.body("plate", outcome.summary.steps);
        let p = body.field("contact_pressure");
        let status = body.field("contact_status");
        let mut nodes = 0;
        for (x, (p, s)) in body.points.iter().zip(p.iter().zip(status)) {
            let below = x[2] < 0.0;
            assert_eq!(*s, if below { 2.0 } else { 0.0 });
            let expected = if below { pressure } else { 0.0 };
            assert!((p - expected).abs() < 1e-8 * pressure, "{p} at {x:?}");
            nodes += usize::from(below);
        }
        assert_eq!(nodes, 35);
    }
}
