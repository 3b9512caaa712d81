//! Strips bent to the curvature of a tool.
use crate::gauntlet::scenes::{arc, solution};
use crate::gauntlet::{CaseError, Outcome, Trial};
use serde_json::{Value, json};

pub fn matched(trial: &mut Trial) -> Result<(), CaseError> {
    let (radius, thickness, e, width) = (10.0, 0.2, 1000.0, 0.4);
    let lift = 8.0;
    let patch = arc(
        [0.0, lift - radius],
        radius + 0.5 * thickness,
        [1.62, 0.22],
        [-2.0, 2.0],
    )?;
    let file = trial.cad("bore", vec![patch])?;
    let contact = |slave: &str, master: &str| {
        json!({
            "slave": slave, "master": master, "penalty": { "value": 500 }, "points": { "gauss": 2 }
        })
    };
    let moment = e * thickness.powi(3) / 12.0 / radius * width;
    let mut errors = Vec::new();
    for n in [18, 36] {
        let mut solution = solution(40);
        solution["newton"]["tolerance"] = json!(1e-9);
        let scene = json!({
            "covact": 1,
            "materials": { "m": { "st_venant_kirchhoff": { "E": e, "nu": 0 } } },
            "bodies": { "strip": {
                "mesh": { "plate": { "size": [9, width], "thickness": thickness, "elements": [n, 1] } }, "material": "m"
            } },
            "surfaces": {
                "die": {
                    "cylinder": {
                        "radius": radius - 0.5 * thickness, "length": 4, "center": [0, 0.5 * width, -radius], "axis": [0, 1, 0]
                    },
                    "side": "outward"
                },
                "bore": {
                    "cad": file, "side": "inward", "depth": 1, "motion": { "translation": [0, 0, format!("-{lift}*t")] }
                }
            },
            "contacts": { "below": contact("strip.bottom", "die"), "above": contact("strip.top", "bore") },
            "supports": {
                "middle": { "on": "strip.x_min", "symmetry": "x" },
                "faces": { "on": ["strip.y_min", "strip.y_max"], "symmetry": "y" }
            },
            "solution": solution,
            "output": { "every": 0 }
        });
        let out = trial.done(&scene)?;
        let found = out.last("moment.middle.y")?;
        errors.push((found.abs() / moment - 1.0).abs());
        trial.equal(
            "force of both dies",
            out.last("force.die.z")?,
            -out.last("force.bore.z")?,
            1e-3,
        );
    }
    // Half of a penetration on either side changes the radius by less than 1e-4.
    trial.within("moment, 18 elements", errors[0], 1.5e-3);
    trial.within("moment, 36 elements", errors[1], 1e-3);
    trial.iterations(490);
    Ok(())
}

/// Young's modulus of plane strain of the metal that is wrapped.
const PLANE: f64 = 200e3 / (1.0 - 0.09);
const YIELD: f64 = 200.0;
const SLOPE: f64 = 2000.0;

/// Moment per width that bends a sheet of thickness 1 to a curvature: the bilinear law of plane strain, integrated.
fn moment(curvature: f64) -> f64 {
    let s = 2.0 * YIELD / 3f64.sqrt();
    let hardening = 4.0 / 3.0 * SLOPE;
    let tangent = PLANE * hardening / (PLANE + hardening);
    let y = (s / (PLANE * curvature)).min(0.5);
    let beyond = curvature * (0.125 - y.powi(3)) / 3.0 - y * curvature * (0.25 - y * y) / 2.0;
    2.0 * (PLANE * curvature * y.powi(3) / 3.0 + s * (0.25 - y * y) / 2.0 + tangent * beyond)
}

/// Turn of the fibre at a station of the strip from its two ends (radians).
fn turn(out: &Outcome, station: &str, time: f64) -> Result<f64, CaseError> {
    let at = |end: &str, axis: &str| out.at(&format!("probe.{station}_{end}.{axis}"), time);
    let x = at("top", "x")? - at("bottom", "x")?;
    let z = 1.0 + at("top", "z")? - at("bottom", "z")?;
    Ok(x.atan2(z))
}

pub fn springback(trial: &mut Trial) -> Result<(), CaseError> {
    let (radius, n) = (10.0, 30u32);
    let length = 2.4 * radius;
    let size = length / f64::from(n);
    let (mut sets, mut probes) = (json!({}), json!({}));
    // Where the strip lies on the cylinder.
    let stations = [("near", 1), ("far", 6)];
    for (station, column) in stations {
        let x = f64::from(column) * size;
        for (end, z) in [("top", 0.5), ("bottom", -0.5)] {
            let name = format!("{station}_{end}");
            sets[&name] = json!({ "nodes_in_box": {
                "min": [x - 0.01, -1, z - 0.1], "max": [x + 0.01, 9, z + 0.1]
            } });
            probes[&name] = json!({ "on": format!("strip.{name}") });
        }
    }
    let scene = json!({
        "covact": 1,
        "materials": { "m": { "j2": {
            "E": 200e3, "nu": 0.3, "hardening": { "linear": { "yield_stress": YIELD, "slope": SLOPE } }
        } } },
        "bodies": { "strip": {
            "mesh": { "plate": { "size": [length, size], "thickness": 1, "elements": [n, 1] } },
            "material": "m",
            "sets": sets
        } },
        "surfaces": { "cylinder": {
            "cylinder": {
                "center": [0, 0.5 * size, -radius], "axis": [0, 1, 0], "radius": radius - 0.5, "length": 3.0 * size
            },
            "side": "outward"
        } },
        "contacts": { "wrap": { "slave": "strip.bottom", "master": "cylinder", "penalty": { "value": 1e5 } } },
        "supports": {
            "middle": { "on": "strip.x_min", "symmetry": "x" },
            "flat": { "on": "strip", "plane_strain": "y" },
            "end": {
                "on": "strip.x_max", "mid_surface": true,
                "displacement": { "z": { "table": [[0, 0], [1, -1.4 * radius]] } }
            }
        },
        "probes": probes,
        "stages": [
            { "name": "wrap", "until": 1 },
            { "name": "release", "release": "forces", "supports": ["middle", "flat", "automatic"] }
        ],
        "solution": { "end_time": 1.3 },
        "output": { "every": 0 }
    });
    let out = trial.done(&scene)?;
    let between = f64::from(stations[1].1 - stations[0].1) * size;
    let curvature = |time: f64| {
        Ok::<f64, CaseError>((turn(&out, "far", time)? - turn(&out, "near", time)?) / between)
    };
    let (bent, released) = (curvature(1.0)?, curvature(1.3)?);
    // What a chord of the mesh leaves of the cylinder's curvature.
    trial.equal("curvature on the cylinder", bent * radius, 1.0, 1e-2);
    // The moment that has bent it comes off elastically.
    let right = 12.0 * moment(bent) / PLANE;
    trial.equal("springback", bent - released, right, 1e-2);
    trial.iterations(195);
    Ok(())
}

pub fn released(trial: &mut Trial) -> Result<(), CaseError> {
    let tool = |x: f64, z: f64| {
        json!({
            "cylinder": { "radius": 2, "length": 9, "center": [x, 1, z], "axis": [0, 1, 0] }, "side": "outward"
        })
    };
    let contact = |slave: &str, master: &str| {
        json!({
            "slave": slave, "master": master, "penalty": { "value": 2e4 }, "points": { "gauss": 3 }
        })
    };
    let run = |trial: &mut Trial, how: Value| {
        let mut solution = solution(20);
        solution["newton"]["tolerance"] = json!(1e-9);
        solution["end_time"] = json!(1.5);
        let scene = json!({
            "covact": 1,
            "materials": { "m": { "j2": {
                "E": 200e3, "nu": 0.3, "hardening": { "linear": { "yield_stress": 200, "slope": 800 } }
            } } },
            "bodies": { "strip": {
                "mesh": { "plate": { "size": [20, 2], "thickness": 1, "elements": [16, 1] } }, "material": "m"
            } },
            "surfaces": { "punch": tool(0.0, 2.5), "die": tool(10.0, -2.5) },
            "contacts": { "above": contact("strip.top", "punch"), "below": contact("strip.bottom", "die") },
            "supports": {
                "middle": { "on": "strip.x_min", "symmetry": "x" }, "flat": { "on": "strip", "plane_strain": "y" }
            },
            "probes": { "tip": { "on": "strip.x_max" } },
            "stages": [
                { "name": "press", "until": 1, "tools": { "punch": [0, 0, -4] } },
                { "name": "release", "release": how }
            ],
            "solution": solution,
            "output": { "every": 0 }
        });
        trial.done(&scene)
    };
    let forces = run(trial, json!("forces"))?;
    let tools = run(trial, json!("tools"))?;
    let springback = forces.last("probe.tip.x")? - forces.at("probe.tip.x", 1.0)?;
    trial.holds("it springs back", springback > 0.1);
    let off = (tools.last("probe.tip.x")? - forces.last("probe.tip.x")?) / springback;
    trial.within("way of the tip by springback", off, 1e-6);
    for name in ["energy.internal", "energy.plastic"] {
        trial.equal(name, tools.last(name)?, forces.last(name)?, 1e-6);
    }
    for (name, out) in [("forces", &forces), ("tools", &tools)] {
        let left = out.last("force.punch.z")?;
        trial.holds(format!("nothing presses, by {name}"), left == 0.0);
    }
    trial.iterations(530);
    Ok(())
}
