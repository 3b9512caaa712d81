//! Motion without contact, in closed form.
use super::steps;
use crate::gauntlet::{CaseError, Trial};
use serde_json::json;
use std::f64::consts::{FRAC_PI_4, PI};

pub fn pendulum(trial: &mut Trial) -> Result<(), CaseError> {
    let (length, width, thickness, g) = (2.0f64, 0.2, 0.1, 10.0f64);
    // A quarter of the period from the horizontal on: the complete elliptic integral by the arithmetic-geometric mean.
    let (mut a, mut b) = (1.0f64, FRAC_PI_4.cos());
    for _ in 0..30 {
        (a, b) = (0.5 * (a + b), (a * b).sqrt());
    }
    let inertia = length * length / 3.0 + thickness * thickness / 12.0;
    let right = 0.5 * PI / a / (g * 0.5 * length / inertia).sqrt();
    for (dt, tolerance, lost) in [(0.02, 5e-4, 4e-3), (0.01, 2e-4, 2e-3)] {
        let scene = json!({
            "covact": 1,
            "materials": { "m": { "st_venant_kirchhoff": { "E": 1e5, "nu": 0.3, "density": 1 } } },
            "bodies": { "bar": {
                "mesh": { "plate": { "size": [length, width], "thickness": thickness, "elements": [4, 1] } },
                "material": "m"
            } },
            "supports": { "hinge": {
                "on": "bar.x_min", "mid_surface": true, "displacement": { "x": 0, "y": 0, "z": 0 }
            } },
            "loads": { "weight": { "on": "bar", "gravity": [0, 0, -g] } },
            "probes": { "tip": { "on": "bar.x_max" } },
            "solution": steps(dt, 0.8),
            "output": { "every": 0 }
        });
        let out = trial.done(&scene)?;
        let [time, tip] = [out.column("time")?, out.column("probe.tip.x")?];
        let passed = (1..tip.len()).find(|i| tip[*i] < -length);
        let i = passed.ok_or_else(|| CaseError::new("the bar does not come down"))?;
        let part = (-length - tip[i - 1]) / (tip[i] - tip[i - 1]);
        let found = time[i - 1] + part * (time[i] - time[i - 1]);
        trial.equal(format!("time, steps of {dt}"), found, right, tolerance);
        // Its height has become speed.
        let kinetic = out.column("energy.kinetic")?;
        let highest = kinetic.iter().copied().fold(0.0, f64::max);
        let height = length * width * thickness * g * 0.5 * length;
        trial.equal(format!("energy, steps of {dt}"), highest, height, lost);
    }
    trial.iterations(560);
    Ok(())
}

pub fn slowed(trial: &mut Trial) -> Result<(), CaseError> {
    let c = 2.0f64;
    let right = (1.0 - (-c).exp()) / c;
    let mut errors = Vec::new();
    for n in [20, 40] {
        let mut solution = steps(1.0 / f64::from(n), 1.0);
        solution["dynamics"] = json!({ "damping": { "mass": c } });
        let scene = json!({
            "covact": 1,
            "materials": { "m": { "neo_hooke": { "E": 50, "nu": 0.3, "density": 1 } } },
            "bodies": { "block": {
                "mesh": { "block": { "min": [0, 0, 0], "max": [1, 1, 1], "elements": [2, 2, 2] } },
                "material": "m",
                "velocity": [1, 0, 0]
            } },
            "probes": { "block": { "body": "block" } },
            "solution": solution,
            "output": { "every": 0 }
        });
        let out = trial.done(&scene)?;
        errors.push((out.last("probe.block.x")? / right - 1.0).abs());
        let energy = 0.5 * (-2.0 * c).exp();
        let what = format!("energy, {n} steps");
        trial.equal(
            what,
            out.last("energy.kinetic")?,
            energy,
            2.0 / f64::from(n * n),
        );
    }
    trial.within("way, 40 steps", errors[1], 1e-4);
    trial.within(
        "error of 40 steps by that of 20",
        errors[1] / errors[0],
        0.27,
    );
    trial.iterations(90);
    Ok(())
}
