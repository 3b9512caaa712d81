//! A strip of four solid-shells that falls tilted on a plane: no energy comes from nowhere, and it rebounds as in an independent
//! program (a prototype in Python with the same elements, nodal penalties and steps, written before this one).
use crate::support::{energies, fixed, largest, run};
use serde_json::json;

const E: f64 = 1e4;
/// Half of its thickness, by which penalties and steps are told.
const H: f64 = 0.1;
const MASS: f64 = 1.5 * 0.5 * 2.0 * H;

#[test]
fn a_tilted_strip_never_gains_energy() {
    // Penalty in E/h, step in h/c; part of the energy that is left, and velocity of the centre over that before.
    for (penalty, step, left, rebound) in [
        (1.0, 1.0, 0.670, 0.273),
        (1.0, 0.25, 0.888, 0.322),
        (10.0, 1.0, 0.679, 0.191),
        (10.0, 0.25, 0.828, 0.198),
    ] {
        let dt = step * H / 100.0;
        let scene = json!({
            "covact": 1,
            "materials": { "m": { "st_venant_kirchhoff": { "E": E, "nu": 0.3, "density": 1.0 } } },
            "bodies": { "s": {
                "mesh": { "plate": { "size": [1.5, 0.5], "thickness": 2.0 * H, "elements": [4, 1], "origin": [0, 0, 0] } },
                "material": "m", "velocity": [0, 0, -2],
                "placement": { "axis": [0, 1, 0], "angle": -5 }
            } },
            "surfaces": { "floor": { "plane": { "center": [0.7, 0.2, 0], "size": [8, 8] }, "side": { "point": [0, 0, 1] } } },
            "contacts": { "c": { "slave": "s.bottom", "master": "floor", "penalty": { "value": penalty * E / H } } },
            "solution": fixed(dt, 0.12),
            "output": { "every": 0 }
        });
        let mut scene = scene;
        // The lowest node starts 1e-3 above the floor.
        let low = lowest(&scene);
        scene["bodies"]["s"]["placement"]["translation"] = json!([0, 0, 1e-3 - low]);
        let simulation = run(&scene, |_| {});
        let start = 0.5 * MASS * 4.0;
        let energy = energies(&simulation, start);
        let (highest, last) = (largest(&energy) / start, energy[energy.len() - 1] / start);
        let [p, _] = simulation.momentum().expect("inertia");
        let speed = p.z / (MASS * 2.0);
        println!(
            "penalty {penalty} E/h, dt {step} h/c: at most {highest:.6}, left {last:.4} ({left}), rebound {speed:.4} ({rebound})"
        );
        assert!(
            highest < 1.0 + 1e-6,
            "penalty {penalty}, step {step}: {highest}"
        );
        assert!(
            (last - left).abs() < 0.01,
            "penalty {penalty}, step {step}: {last}"
        );
        assert!(
            (speed - rebound).abs() < 0.01,
            "penalty {penalty}, step {step}: {speed}"
        );
        assert!(simulation.warnings().iter().all(|w| !w.contains("gained")));
    }
}

fn lowest(scene: &serde_json::Value) -> f64 {
    let simulation = crate::support::simulation(scene);
    let nodes = simulation.model().bodies[0].mesh.nodes.iter();
    nodes.map(|x| x.z).fold(f64::INFINITY, f64::min)
}
