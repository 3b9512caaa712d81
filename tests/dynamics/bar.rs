//! An elastic bar that hits a rigid wall along its axis: the wave equation with unilateral contact. Closed form: the wall
//! carries `E A v0 / c` from the first touch on, until the wave is back after `2 L / c`; the bar then leaves with `v0` and
//! without vibration (code_aster V5.03.100, "impact of a bar on a rigid wall", has the same reference).
use crate::support::{column, energies, fixed, largest, run};
use serde_json::json;

const ELEMENTS: usize = 100;
/// Speed over that of waves: strains are as large, and what is not linear in them is 1e-4 of what is.
const V: f64 = 1e-4;

#[test]
fn a_bar_on_a_wall_at_every_penalty() {
    let h = 1.0 / ELEMENTS as f64;
    for penalty in [10.0, 100.0, 1000.0] {
        let scene = json!({
            "covact": 1,
            "materials": { "m": { "st_venant_kirchhoff": { "E": 1.0, "nu": 0.0, "density": 1.0 } } },
            "bodies": { "bar": {
                "mesh": { "block": { "min": [0, 0, 0], "max": [1, 1, 1], "elements": [ELEMENTS, 1, 1] } },
                "material": "m", "element": "h8_displacement", "velocity": [-V, 0, 0]
            } },
            "surfaces": { "wall": { "plane": {
                "center": [0, 0.5, 0.5], "normal": [1, 0, 0], "size": [3, 3] }, "side": { "point": [1, 0.5, 0.5] }
            } },
            "contacts": { "c": { "slave": "bar.x_min", "master": "wall", "penalty": { "value": penalty / h } } },
            "supports": {
                "y": { "on": ["bar.y_min", "bar.y_max"], "symmetry": "y" },
                "z": { "on": ["bar.z_min", "bar.z_max"], "symmetry": "z" }
            },
            "solution": fixed(h, 2.5),
            "output": { "every": 0 }
        });
        let simulation = run(&scene, |_| {});
        let (time, force) = (
            column(&simulation, "time"),
            column(&simulation, "force.wall.x"),
        );
        let middle: Vec<f64> = (time.iter().zip(&force))
            .filter(|(t, _)| (0.3..1.7).contains(*t))
            .map(|(_, f)| f / V)
            .collect();
        let mean = middle.iter().sum::<f64>() / middle.len() as f64;
        let noise = middle.iter().map(|f| (f - mean).powi(2)).sum::<f64>() / middle.len() as f64;
        let noise = noise.sqrt();
        let touching = time.iter().zip(&force).filter(|(_, f)| **f > 1e-3 * V);
        let end = touching.map(|(t, _)| *t).fold(0.0, f64::max);
        let energy = energies(&simulation, 0.5 * V * V);
        let highest = largest(&energy) / energy[0];
        let left = energy[energy.len() - 1] / energy[0];
        let [p, _] = simulation.momentum().expect("inertia");
        println!(
            "penalty {penalty}: force {mean:.5}, noise {noise:.5}, end {end:.3}, energy at most {highest:.6}, left {left:.4}, \
             exit {:.4}",
            p.x / V
        );
        assert!((mean - 1.0).abs() < 5e-4, "penalty {penalty}: force {mean}");
        assert!(noise < 2e-3, "penalty {penalty}: noise {noise}");
        assert!((end - 2.0).abs() < 2.5 * h, "penalty {penalty}: {end}");
        assert!(highest < 1.0 + 1e-4, "penalty {penalty}: energy {highest}");
        // The front of the wave is spread over elements: first order in their size.
        assert!(left > 0.98 && p.x / V > 0.98, "penalty {penalty}");
    }
}
