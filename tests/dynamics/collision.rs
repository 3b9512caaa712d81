//! Two bodies that hit each other.
use crate::support::{energies, fixed, largest, run, simulation};
use serde_json::{Value, json};

/// A bar along x of 20 elements, from here on, at this velocity.
fn bar(from: f64, velocity: f64) -> Value {
    json!({
        "mesh": { "block": { "min": [from, 0, 0], "max": [from + 1.0, 1, 1], "elements": [20, 1, 1] } },
        "material": "m", "element": "h8_displacement", "velocity": [velocity, 0, 0]
    })
}

/// Closed form: equal bars that hit along their axis exchange their velocities, and part after `2 L / c`. Momentum is kept to
/// rounding.
#[test]
fn equal_bars_exchange_their_velocities() {
    let v = 1e-4;
    let scene = json!({
        "covact": 1,
        "materials": { "m": { "st_venant_kirchhoff": { "E": 1.0, "nu": 0.0, "density": 1.0 } } },
        "bodies": { "a": bar(0.0, v), "b": bar(1.0, 0.0) },
        "contacts": { "c": { "slave": "a.x_max", "master": "b.x_min", "penalty": { "value": 200 } } },
        "supports": {
            "y": { "on": ["a.y_min", "a.y_max", "b.y_min", "b.y_max"], "symmetry": "y" },
            "z": { "on": ["a.z_min", "a.z_max", "b.z_min", "b.z_max"], "symmetry": "z" }
        },
        "solution": fixed(0.05, 3.0),
        "output": { "every": 0 }
    });
    let [start, _] = simulation(&scene).momentum().expect("inertia");
    assert!((start.x - v).abs() < 1e-15 * v.max(1.0), "{start}");
    let (mut drift, mut contact) = (0.0f64, 0.0f64);
    let found = run(&scene, |s| {
        let [p, _] = s.momentum().expect("inertia");
        drift = drift.max((p - start).norm() / start.norm());
        if s.value("points.active").expect("a column") > 0.0 {
            contact = s.time();
        }
    });
    let mean = |body: &str| {
        let v = found.field(body, "velocity").expect("velocities");
        let index = if body == "a" { 0 } else { 1 };
        let mesh = &found.model().bodies[index].mesh;
        let volumes = mesh.nodal_volumes();
        let sum: f64 = volumes
            .iter()
            .enumerate()
            .map(|(n, w)| w * v.at(n, 0))
            .sum();
        sum / volumes.iter().sum::<f64>()
    };
    let [a, b] = ["a", "b"].map(mean);
    let energy = energies(&found, 0.5 * v * v);
    println!(
        "drift {drift:.1e}, a {:.4}, b {:.4}, parted at {contact}, energy at most {:.6}",
        a / v,
        b / v,
        largest(&energy) / energy[0]
    );
    assert!(drift < 1e-11, "{drift}");
    assert!((contact - 2.0).abs() < 0.16, "{contact}");
    assert!(a.abs() < 0.05 * v && (b / v - 1.0).abs() < 0.05, "{a} {b}");
    assert!(largest(&energy) < energy[0] * (1.0 + 1e-4));
}

/// A wall at a steady speed hits a block, whose energy grows from nothing: while next to nothing is there, the errors of its sums are
/// as large, and no reason to say that energy came from nowhere.
#[test]
fn energies_that_begin_with_nothing_are_not_told() {
    let scene = json!({
        "covact": 1,
        "materials": { "m": { "neo_hooke": { "E": 20, "nu": 0, "density": 1.1e-9 } } },
        "bodies": { "b": {
            "mesh": { "block": { "size": [10, 10, 10], "elements": [5, 5, 5] } }, "material": "m"
        } },
        "surfaces": { "wall": {
            "plane": { "size": [40, 40], "center": [-0.5, 5, 5], "normal": [1, 0, 0] },
            "motion": { "translation": ["1000*t", 0, 0] }
        } },
        "contacts": { "c": { "slave": "b.x_min", "master": "wall" } },
        "solution": { "dynamics": {}, "end_time": 0.004 },
        "output": { "every": 0 }
    });
    let simulation = run(&scene, |_| {});
    let told = simulation.warnings().concat();
    assert!(!told.contains("gained"), "{told}");
    // It flies ahead of the wall, slower than at twice its speed by what the impact has taken.
    let [p, _] = simulation.momentum().expect("inertia");
    let speed = p.x / (1000.0 * 1.1e-9);
    assert!((1700.0..2001.0).contains(&speed), "{speed}");
}
