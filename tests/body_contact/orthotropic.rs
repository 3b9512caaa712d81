//! Friction with two coefficients whose direction is one of a body: it turns and stretches with that.
use crate::blocks::done;
use crate::friction::{last, layers};
use crate::support::Outcome;
use nalgebra::{Rotation3, Vector3};
use serde_json::{Value, json};

const ALONG: f64 = 0.1;
const ACROSS: f64 = 0.4;

fn ellipse(direction: [f64; 3]) -> Value {
    json!({"orthotropic": {"mu": [ALONG, ACROSS], "direction": direction}})
}

/// Steps that end after `time`, with the forces on the slave there.
fn forces(outcome: &Outcome, contact: &str, after: f64) -> Vec<Vector3<f64>> {
    let time = outcome.column("time");
    let c = ["x", "y", "z"].map(|c| outcome.column(&format!("slave.force.{contact}.{c}")));
    (0..time.len())
        .filter(|&i| time[i] > after)
        .map(|i| Vector3::new(c[0][i], c[1][i], c[2][i]))
        .collect()
}

/// Forces that hold back a block that is drawn along x over faces that are held where `face` puts them, at a load of 1.
fn drag(direction: [f64; 3], face: &Value) -> Vector3<f64> {
    let mut scene = layers([2, 2], [7, 3], "upper.bottom", 0.002, "1.3*max(0, t-0.25)");
    for support in ["ground", "face"] {
        scene["supports"][support]["displacement"] = face.clone();
    }
    (scene["supports"]["ground"].as_object_mut().expect("keys")).remove("fixed");
    scene["contacts"]["rub"]["friction"] = ellipse(direction);
    let outcome = done(&scene);
    assert_eq!(last(&outcome, "points.stick"), 0.0);
    assert!(last(&outcome, "points.slip") > 30.0);
    assert!(last(&outcome, "imbalance.force.rub") < 1e-12);
    let force = *forces(&outcome, "rub", 0.0).last().expect("steps");
    assert!(force.z.abs() > 1.0, "{force}");
    force / force.z.abs()
}

/// Closed form: a point that slides along `v` has the traction `p M v / sqrt(v . M v)`, `M = mu_1^2 a a + mu_2^2 b b`.
fn expected(a: [f64; 2], v: [f64; 2]) -> [f64; 2] {
    let length = a[0].hypot(a[1]);
    let a = a.map(|a| a / length);
    let b = [-a[1], a[0]];
    let along = |a: [f64; 2]| a[0] * v[0] + a[1] * v[1];
    let m = |i: usize| ALONG.powi(2) * a[i] * along(a) + ACROSS.powi(2) * b[i] * along(b);
    let limit = (m(0) * v[0] + m(1) * v[1]).sqrt();
    [m(0) / limit, m(1) / limit]
}

#[test]
fn a_block_is_held_back_by_the_ellipse_about_the_direction() {
    let still = json!({"x": 0, "y": 0, "z": 0});
    for direction in [
        [1.0, 0.0, 0.0],
        [0.0, 2.0, 0.0],
        [0.8, 0.6, 0.3],
        [-0.5, 0.8, -1.0],
    ] {
        let force = drag(direction, &still);
        let [x, y] = expected([direction[0], direction[1]], [1.0, 0.0]);
        println!("{direction:?}: {} {}, {x} {y}", force.x, force.y);
        let sign = -force.x.signum();
        assert!((force.x.abs() - x).abs() < 1e-9, "{direction:?}");
        assert!((-sign * force.y - y).abs() < 1e-9, "{direction:?}");
        match direction {
            [1.0, ..] => assert!((x - ALONG).abs() < 1e-15),
            [0.0, ..] => assert!((x - ACROSS).abs() < 1e-15),
            _ => assert!(y.abs() > 0.05),
        }
    }
}

/// Faces that are sheared and stretched to twice their width take the direction with them as a line drawn on them.
#[test]
fn the_direction_stretches_with_the_faces() {
    let part = "min(1, 4*t)";
    let moved = json!({"x": format!("0.5*y*{part}"), "y": format!("1.2*(y+0.1)*{part}"), "z": 0});
    let (direction, fibre) = ([0.6, 0.8, 0.0], [0.6 + 0.4, 2.2 * 0.8]);
    let force = drag(direction, &moved);
    let [x, y] = expected(fibre, [1.0, 0.0]);
    println!("{} {}, {x} {y}", force.x, force.y);
    assert!((force.x.abs() - x).abs() < 1e-9);
    assert!((force.x.signum() * force.y - y).abs() < 1e-9);
    // A direction that stays in space would be far off.
    let [other, _] = expected([0.6, 0.8], [1.0, 0.0]);
    assert!((other - x).abs() > 0.02, "{other} {x}");
}

/// Two soft blocks pressed on each other, turned as a whole about z by `angle[0]` and about y by `angle[1]`, then drawn over each other.
fn turned(angle: [f64; 2], direction: [f64; 3]) -> Outcome {
    let part = "min(1, max(0, t-1)/8)";
    let [ca, cb] = angle.map(|a| format!("cos({a}*{part})"));
    let [sa, sb] = angle.map(|a| format!("sin({a}*{part})"));
    let motion = |d: [&str; 3]| {
        let [x, y, z] = [0, 1, 2].map(|k| format!("({}+{})", ["x", "y", "z"][k], d[k]));
        let p = format!("({ca}*{x} - {sa}*{y})");
        json!({
            "x": format!("{cb}*{p} + {sb}*{z} - x"),
            "y": format!("{sa}*{x} + {ca}*{y} - y"),
            "z": format!("{cb}*{z} - {sb}*{p} - z")
        })
    };
    let drawn = ["0.12*max(0, t-9)/4", "0.07*max(0, t-9)/4"];
    done(&json!({
        "covact": 1,
        "materials": {"m": {"neo_hooke": {"E": 100, "nu": 0.3}}},
        "bodies": {
            "lower": {"mesh": {"block": {
                "min": [-0.7, -0.7, -0.5], "max": [0.7, 0.7, 0], "elements": [3, 3, 2]
            }}, "material": "m"},
            "upper": {"mesh": {"block": {
                "min": [-0.5, -0.5, 0], "max": [0.5, 0.5, 0.5], "elements": [4, 2, 2]
            }}, "material": "m"}
        },
        "contacts": {"rub": {
            "slave": "upper.bottom", "master": "lower.top", "points": {"gauss": 2},
            "penalty": {"value": 2000}, "tangential_penalty": {"value": 1500},
            "friction": ellipse(direction)
        }},
        "supports": {
            "ground": {"on": "lower.bottom", "displacement": motion(["0", "0", "0"])},
            "push": {"on": "upper.top", "displacement": motion([drawn[0], drawn[1], "-0.04*min(1, t)"])}
        },
        "solution": {
            "end_time": 13, "step": {"initial": 1, "max": 1},
            "newton": {"tolerance": 1e-11}, "threads": 1
        },
        "output": {"every": 0}
    }))
}

#[test]
fn turning_both_bodies_turns_the_forces_between_them() {
    let angle: [f64; 2] = [1.9, -1.1];
    let direction = [0.8, 0.5, 0.2];
    let (still, moved) = (turned([0.0; 2], direction), turned(angle, direction));
    let [a, b] = [&still, &moved].map(|o| forces(o, "rub", 9.5));
    assert!(a.len() == b.len() && a.len() >= 4);
    let axis = |k: usize| Vector3::<f64>::ith_axis(k);
    let r = Rotation3::from_axis_angle(&axis(1), angle[1])
        * Rotation3::from_axis_angle(&axis(2), angle[0]);
    for (a, b) in a.iter().zip(&b) {
        let error = (r * a - b).norm() / a.norm();
        println!("{} {} {}: {error:e}", a.x, a.y, a.z);
        assert!(a.z.abs() > 1.0 && error < 1e-7, "{error:e}");
    }
    for c in ["points.slip", "points.stick"] {
        assert_eq!(last(&still, c), last(&moved, c));
    }
    assert!(last(&still, "points.slip") > 20.0);
    // Of the steps in which all points slide: before, rounding decides which of those at their limit do.
    let [a_lost, b_lost] = [&still, &moved].map(|o| {
        let lost = o.column("energy.dissipated");
        lost[lost.len() - 1] - lost[lost.len() - 4]
    });
    println!("{a_lost} {b_lost}");
    assert!(a_lost > 1e-2 && (a_lost - b_lost).abs() < 1e-7 * a_lost);
    // What a direction that stays in space would do, seen by the bodies.
    let back = r.inverse() * Vector3::from(direction);
    let other = forces(&turned([0.0; 2], back.into()), "rub", 9.5);
    let apart = (other.last().expect("steps") - a[a.len() - 1]).norm();
    assert!(apart > 0.5 && other.len() == a.len(), "{apart}");
}

/// With multipliers a soft penalty leaves no elastic slip, and the drag is that of a stiff one, along and across the way.
#[test]
fn augmentation_resolves_elastic_slip_about_the_direction() {
    let run = |penalty: f64, augmented: bool| {
        let mut scene = crate::sliding::slide(0.4, 4);
        let press = &mut scene["contacts"]["press"];
        press["friction"] = ellipse([0.8, 0.6, 0.0]);
        press["penalty"] = json!({ "value": penalty });
        if augmented {
            press["augmentation"] = json!({"gap": 1e-4, "slip": 1e-4, "max": 25});
        }
        let outcome = done(&scene);
        *forces(&outcome, "press", 0.0).last().expect("steps")
    };
    let (soft, augmented, stiff) = (run(2e3, false), run(2e3, true), run(2e5, false));
    println!("{soft} {augmented} {stiff}");
    assert!(stiff.y.abs() > 0.05 * stiff.z.abs(), "{stiff}");
    assert!((augmented - stiff).norm() < 5e-3 * stiff.norm());
    assert!((augmented - stiff).norm() < 0.2 * (soft - stiff).norm());
}

#[test]
fn equal_coefficients_rub_as_coulombs_law() {
    let run = |friction: Value| {
        let mut scene = layers([2, 2], [7, 3], "upper.bottom", 0.002, "0.5*max(0, t-0.25)");
        scene["contacts"]["rub"]["friction"] = friction;
        done(&scene)
    };
    let two = run(json!({"orthotropic": {"mu": [0.3, 0.3], "direction": [0.3, 1, 0.4]}}));
    let one = run(json!({"coulomb": {"mu": 0.3}}));
    for column in [
        "slave.force.rub.x",
        "slave.force.rub.z",
        "energy.dissipated",
        "energy.friction",
        "points.slip",
    ] {
        let (a, b) = (two.column(column), one.column(column));
        let scale = a.iter().fold(0.0f64, |s, x| s.max(x.abs()));
        assert!(a.len() == b.len() && scale > 1e-3, "{column}: {scale}");
        for (a, b) in a.iter().zip(&b) {
            assert!((a - b).abs() < 1e-9 * scale, "{column}: {a} {b}");
        }
    }
}

/// Along the normal the direction says nothing, which is told.
#[test]
fn a_direction_along_the_normal_draws_a_warning() {
    let warned = |direction: [f64; 3]| {
        let mut scene = layers([1, 1], [2, 1], "upper.bottom", 0.002, "0");
        scene["contacts"]["rub"]["friction"] = ellipse(direction);
        let warnings = done(&scene).summary.warnings;
        (warnings.iter()).any(|w| w.contains("nearly that of the normal of faces `lower.top`"))
    };
    assert!(warned([0.0, 0.05, 1.0]));
    assert!(!warned([0.0, 0.2, 1.0]));
}

/// Where the master's points slide over the slave, its direction is not one of what they meet.
#[test]
fn passes_that_slide_over_the_slave_are_refused() {
    for (passes, what) in [
        ("two_half", "two half passes"),
        ("edges", "edges as slaves"),
    ] {
        let mut scene = layers([2, 2], [7, 3], "upper.bottom", 0.002, "0");
        scene["contacts"]["rub"]["friction"] = ellipse([1.0, 0.0, 0.0]);
        scene["contacts"]["rub"]["passes"] = json!(passes);
        let loaded = covact::scene::parse(&scene.to_string(), "scene.json").expect("a scene");
        let told: Vec<String> = (covact::scene::check(&loaded).iter())
            .map(|p| p.to_string())
            .collect();
        assert_eq!(told.len(), 1, "{told:?}");
        let start = format!("{what} do not go with orthotropic friction");
        assert!(told[0].contains(&start), "{told:?}");
    }
}
