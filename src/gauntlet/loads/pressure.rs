//! Pressure that follows the faces on which it acts.
use crate::gauntlet::scenes::solution;
use crate::gauntlet::{CaseError, Trial};
use covact_geometry::Vec3;
use serde_json::json;

/// Stretch of a neo-Hookean body under hydrostatic pressure.
fn shrunk(e: f64, nu: f64, pressure: f64) -> f64 {
    let lambda = e * nu / ((1.0 + nu) * (1.0 - 2.0 * nu));
    let mu = 0.5 * e / (1.0 + nu);
    let (mut low, mut high) = (0.3, 1.0);
    for _ in 0..200 {
        let l: f64 = 0.5 * (low + high);
        let nominal = mu * (l - 1.0 / l) + 3.0 * lambda * l.ln() / l;
        match nominal / (l * l) < -pressure {
            true => low = l,
            false => high = l,
        }
    }
    low
}

/// Corner of the block outside.
fn corner(longitude: f64, latitude: f64) -> Vec3 {
    let (s, c) = longitude.to_radians().sin_cos();
    let (sin, cos) = latitude.to_radians().sin_cos();
    Vec3::new(cos * s, sin, cos * c) * 3.5
}

pub fn hydrostatic(trial: &mut Trial) -> Result<(), CaseError> {
    let (e, nu) = (100.0, 0.3);
    let corners = [(-40.0, -30.0), (20.0, -30.0), (-40.0, 50.0), (20.0, 50.0)];
    let corners = corners.map(|(a, b)| corner(a, b));
    let mut errors = Vec::new();
    for (element, n, pressure) in [
        ("h8_displacement", 3, 30.0),
        ("h8_mean_dilatation", 3, 30.0),
        ("h8", 3, 1.0),
        ("h8", 6, 1.0),
    ] {
        let mut scene = json!({
            "covact": 1,
            "materials": { "m": { "neo_hooke": { "E": e, "nu": nu } } },
            "bodies": { "block": {
                "mesh": { "sphere_panel": {
                    "radius": 3, "thickness": 1, "longitude": [-40, 20], "latitude": [-30, 50], "elements": [n, n],
                    "layers": n / 3
                } },
                "material": "m",
                "element": element,
                "sets": {}
            } },
            // Six components at three corners leave every strain free.
            "supports": {
                "first": { "on": "block.corner0", "fixed": true },
                "second": { "on": "block.corner1", "displacement": { "y": 0, "z": 0 } },
                "third": { "on": "block.corner2", "displacement": { "x": 0 } }
            },
            "loads": { "sea": {
                "on": [
                    "block.outer", "block.inner", "block.longitude_min", "block.longitude_max", "block.latitude_min",
                    "block.latitude_max"
                ],
                "pressure": format!("{pressure:?}*t"), "follower": true
            } },
            "probes": { "far": { "on": "block.corner3" }, "stress": { "body": "block", "quantity": "von_mises" } },
            "solution": solution(4),
            "output": { "every": 0 }
        });
        for (i, x) in corners.iter().enumerate() {
            scene["bodies"]["block"]["sets"][format!("corner{i}")] = json!({ "nodes_near_point": {
                "point": [x.x, x.y, x.z], "tolerance": 1e-3
            } });
        }
        let out = trial.done(&scene)?;
        let way = ["x", "y", "z"].map(|a| out.last(&format!("probe.far.{a}")));
        let [x, y, z] = way;
        let before = corners[3] - corners[0];
        let found = (before + Vec3::new(x?, y?, z?)).norm() / before.norm();
        let right = shrunk(e, nu, pressure);
        if element == "h8" {
            errors.push(((found - right) / (1.0 - right)).abs());
        } else {
            trial.equal(format!("size, {element}"), found, right, 1e-9);
            let shear = out.last("probe.stress")? / pressure;
            trial.within(
                format!("von Mises stress over pressure, {element}"),
                shear,
                1e-9,
            );
        }
        let held = out.last("force.first.x")?.abs() + out.last("force.third.x")?.abs();
        trial.within(
            format!("force that holds it, {element}"),
            held / pressure,
            1e-8,
        );
    }
    // Assumed strains are those of a curved shell, of which its flat elements are an image of second order.
    trial.within("shrinkage of h8, half the size", errors[1] / errors[0], 0.3);
    trial.iterations(100);
    Ok(())
}

pub fn balloon(trial: &mut Trial) -> Result<(), CaseError> {
    let (mu, a, b, stretch) = (10.0, 1.0f64, 2.0f64, 1.5f64);
    let nu = 0.499;
    // Of an incompressible tube, inner and outer stretch: p = mu (ln (s / o) + (1 / o^2 - 1 / s^2) / 2).
    let outer = (b * b - a * a + (stretch * a).powi(2)).sqrt() / b;
    let pressure = mu * ((stretch / outer).ln() + 0.5 * (outer.powi(-2) - stretch.powi(-2)));
    let mut errors = Vec::new();
    for n in [3, 6] {
        let scene = json!({
            "covact": 1,
            "materials": { "m": { "neo_hooke": { "E": 2.0 * mu * (1.0 + nu), "nu": nu } } },
            "bodies": { "tube": {
                "mesh": { "cylinder_panel": {
                    "radius": 0.5 * (a + b), "thickness": b - a, "angles": [0, 90], "y": [0, 0.3],
                    "elements": [2 * n, 1], "layers": n
                } },
                "material": "m",
                "element": "h8_mean_dilatation",
                "sets": { "bore": { "nodes_near_point": { "point": [0, 0, a], "tolerance": 1e-3 } } }
            } },
            "supports": {
                "x": { "on": "tube.phi_min", "symmetry": "x" },
                "z": { "on": "tube.phi_max", "symmetry": "z" },
                "y": { "on": ["tube.y_min", "tube.y_max"], "symmetry": "y" }
            },
            "loads": { "air": { "on": "tube.inner", "pressure": format!("{pressure:?}*t"), "follower": true } },
            "probes": { "bore": { "on": "tube.bore" } },
            "solution": solution(10),
            "output": { "every": 0 }
        });
        let out = trial.done(&scene)?;
        errors.push((out.last("probe.bore.z")? / (stretch - 1.0) / a - 1.0).abs());
    }
    trial.within("widening on 6 layers", errors[1], 4e-3);
    trial.within("error of 6 layers by that of 3", errors[1] / errors[0], 0.3);
    trial.iterations(120);
    Ok(())
}
