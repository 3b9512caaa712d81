//! Impact of a sphere on a half space (H. Hertz; K. L. Johnson, "Contact Mechanics", 1985, section 11.4): the approach at most is
//! `(15 m V^2 / (16 R^(1/2) E*))^(2/5)`, the contact lasts 2.943 times as long as the sphere takes for that way at its first speed,
//! and it leaves as fast as it came.
use crate::support::{column, fixed, largest, run};
use serde_json::json;

#[test]
fn a_sphere_on_a_half_space() {
    let (radius, deepest, v): (f64, f64, f64) = (100.0, 0.01, 0.01);
    let plane = 1.0 / (1.0 - 0.3f64.powi(2));
    let mass = deepest.powf(2.5) * 16.0 * radius.sqrt() * plane / 15.0 / (v * v);
    let lasts = 2.9432 * deepest / v;
    let force = 4.0 / 3.0 * plane * radius.sqrt() * deepest.powf(1.5);
    // A quarter of a stiff piece of the sphere that weighs what a quarter of the sphere does.
    let angle = 2.0f64.to_radians();
    let volume = (radius.powi(3) - (radius - 10.0).powi(3)) / 3.0 * angle * angle.sin();
    let fine =
        |from_end: bool| json!({ "fine": { "length": 1.5, "fine": 5, "from_end": from_end } });
    let gap = 0.002;
    let mut solution = fixed(lasts / 40.0, 1.3 * lasts);
    solution["newton"]["tolerance"] = json!(1e-8);
    let scene = json!({
        "covact": 1,
        "materials": {
            "half_space": { "st_venant_kirchhoff": { "E": 1.0, "nu": 0.3, "density": 1e-9 } },
            "stiff": { "st_venant_kirchhoff": { "E": 1e3, "nu": 0.3, "density": 0.25 * mass / volume } }
        },
        "bodies": {
            "block": {
                "mesh": { "block": {
                    "min": [0, 0, -30], "max": [30, 30, 0], "elements": [9, 9, 9],
                    "spacing": [fine(false), fine(false), fine(true)]
                } },
                "material": "half_space", "element": "h8_displacement",
                "sets": { "zone": { "faces_in_box": { "min": [-0.01, -0.01, -0.01], "max": [2.5, 2.5, 0.01] } } }
            },
            "sphere": {
                "mesh": { "sphere_panel": {
                    "radius": radius - 5.0, "thickness": 10, "longitude": [178, 180], "latitude": [0, 2], "elements": [8, 8]
                } },
                "material": "stiff", "velocity": [0, 0, -v], "placement": { "translation": [0, 0, radius + gap] }
            }
        },
        "contacts": { "c": {
            "slave": "block.zone", "master": "sphere.outer", "master_surface": "smooth", "points": "nodes", "penalty": { "value": 200 }
        } },
        "supports": {
            "far": { "on": ["block.x_max", "block.y_max", "block.bottom"], "fixed": true },
            "block_x": { "on": "block.x_min", "symmetry": "x" },
            "block_y": { "on": "block.y_min", "symmetry": "y" },
            "sphere_x": { "on": "sphere.longitude_max", "symmetry": "x" },
            "sphere_y": { "on": "sphere.latitude_min", "symmetry": "y" }
        },
        "solution": solution,
        "output": { "every": 0 }
    });
    let simulation = run(&scene, |_| {});
    let (time, up) = (
        column(&simulation, "time"),
        column(&simulation, "master.force.c.z"),
    );
    let touching = || {
        time.iter()
            .zip(&up)
            .filter(|(_, f)| **f > 0.0)
            .map(|(t, _)| *t)
    };
    let (first, last) = (gap / v, touching().fold(0.0, f64::max));
    let most = 4.0 * largest(&up);
    let [p, _] = simulation.momentum().expect("inertia");
    let speed = p.z / (0.25 * mass * v);
    println!(
        "{} steps: contact lasts {:.4} of {lasts:.4}, force {most:.5} of {force:.5}, leaves at {speed:.4}",
        simulation.steps(),
        last - first
    );
    // Elements are a third of a contact radius, and the faces of the block, thirty radii away, are held: 2 % of the approach.
    assert!(
        ((last - first) / lasts - 1.0).abs() < 0.04,
        "{} {lasts}",
        last - first
    );
    assert!((most / force - 1.0).abs() < 0.04, "{most} {force}");
    assert!((0.95..1.0 + 1e-3).contains(&speed), "{speed}");
}
