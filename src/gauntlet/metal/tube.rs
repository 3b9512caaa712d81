//! A thick tube of perfect plasticity (R. Hill, The Mathematical Theory of Plasticity, 1950, chapter V).
use crate::gauntlet::scenes::solution;
use crate::gauntlet::{CaseError, Trial};
use serde_json::json;

/// Inner and outer radius, and radius up to which the tube is plastic.
const A: f64 = 1.0;
const B: f64 = 2.0;
const C: f64 = 1.5;
const E: f64 = 200e3;
const YIELD: f64 = 200.0;
/// Hill's solution is that of a material that keeps its volume; this is as near as the law allows.
const NU: f64 = 0.49;

pub fn expanded(trial: &mut Trial) -> Result<(), CaseError> {
    // Yield stress in shear. The elastic shell from C to B is Lame's tube at its limit.
    let k = YIELD / 3f64.sqrt();
    let pressure = k * (2.0 * (C / A).ln() + 1.0 - C * C / (B * B));
    let outside = 2.0 * (1.0 - NU * NU) * k * C * C / (E * B);
    let mut errors = Vec::new();
    for n in [4, 8] {
        let scene = json!({
            "covact": 1,
            "materials": { "m": { "j2": {
                "E": E, "nu": NU, "hardening": { "linear": { "yield_stress": YIELD } }
            } } },
            "bodies": { "tube": {
                "mesh": { "cylinder_panel": {
                    "radius": 0.5 * (A + B), "thickness": B - A, "angles": [0, 90], "y": [0, 0.2],
                    "elements": [2 * n, 1], "layers": n
                } },
                "material": "m",
                "element": "h8_mean_dilatation",
                "sets": { "outside": { "nodes_near_point": { "point": [0, 0, B], "tolerance": 0.01 } } }
            } },
            "supports": {
                "x": { "on": "tube.phi_min", "symmetry": "x" },
                "z": { "on": "tube.phi_max", "symmetry": "z" },
                "y": { "on": ["tube.y_min", "tube.y_max"], "symmetry": "y" }
            },
            "loads": { "inside": { "on": "tube.inner", "pressure": format!("{pressure:?}*t") } },
            "probes": { "outside": { "on": "tube.outside" } },
            "solution": solution(10),
            "output": { "every": 0 }
        });
        let out = trial.done(&scene)?;
        trial.holds("it flows", out.last("energy.plastic")? > 0.0);
        errors.push((out.last("probe.outside.z")? / outside - 1.0).abs());
    }
    trial.within("expansion on 8 layers", errors[1], 6e-3);
    trial.within("error of 8 layers by that of 4", errors[1] / errors[0], 0.3);
    trial.iterations(68);
    Ok(())
}
