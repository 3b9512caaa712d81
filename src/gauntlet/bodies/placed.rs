//! A block drawn over an arch, as it is and elsewhere.
use crate::gauntlet::drawn::difference;
use crate::gauntlet::scenes::solution;
use crate::gauntlet::{CaseError, Outcome, Trial};
use covact_geometry::Vec3;
use nalgebra::{Rotation3, Unit};
use serde_json::{Value, json};

/// The block's top is moved by (.1, .05, -.3), turned by `turn`; both bodies are placed by it.
fn scene(contact: &Value, turn: &Rotation3<f64>, to: [f64; 3]) -> Value {
    let way = turn * Vec3::new(0.1, 0.05, -0.3);
    let (axis, angle) = turn
        .axis_angle()
        .map_or(([0.0, 0.0, 1.0], 0.0), |(axis, angle)| {
            ([axis.x, axis.y, axis.z], angle.to_degrees())
        });
    let placement = json!({ "axis": axis, "angle": angle, "translation": to });
    let mut scene = json!({
        "covact": 1,
        "materials": {
            "m": { "neo_hooke": { "E": 100, "nu": 0.3 } }, "hard": { "neo_hooke": { "E": 300, "nu": 0.2 } }
        },
        "bodies": {
            "arch": {
                "mesh": { "cylinder_panel": {
                    "radius": 3, "thickness": 0.5, "angles": [-50, 50], "y": [0, 2], "elements": [10, 5]
                } },
                "material": "m",
                "placement": placement
            },
            "block": {
                "mesh": { "block": { "min": [-0.6, 0.3, 3.26], "max": [0.7, 1.5, 4], "elements": [5, 4, 2] } },
                "material": "hard",
                "element": "h8_displacement",
                "placement": placement
            }
        },
        "contacts": { "c": contact },
        "supports": {
            "cut": { "on": ["arch.phi_min", "arch.phi_max"], "fixed": true },
            "push": { "on": "block.top", "displacement": {
                "x": format!("{:?}*t", way.x), "y": format!("{:?}*t", way.y), "z": format!("{:?}*t", way.z)
            } }
        },
        "solution": solution(4),
        "output": { "every": 0 }
    });
    let contact = &mut scene["contacts"]["c"];
    if contact["slave"].is_null() {
        contact["slave"] = "block.bottom".into();
        contact["master"] = "arch.outer".into();
    }
    contact["penalty"] = json!({ "value": 2e3 });
    if !contact["friction"].is_null() {
        contact["tangential_penalty"] = json!({ "value": 1e3 });
    }
    scene
}

/// Force of the push.
fn push(out: &Outcome) -> Result<Vec3, CaseError> {
    let [x, y, z] = ["x", "y", "z"].map(|a| out.last(&format!("force.push.{a}")));
    Ok(Vec3::new(x?, y?, z?))
}

pub fn placed(trial: &mut Trial) -> Result<(), CaseError> {
    let axis = Unit::new_normalize(Vec3::new(1.0, 2.0, -0.5));
    let turn = Rotation3::from_axis_angle(&axis, 77f64.to_radians());
    for (name, contact) in [
        (
            "faces",
            json!({ "points": { "gauss": 3 }, "passes": "one", "friction": 0.2 }),
        ),
        (
            "smooth master",
            json!({ "points": { "gauss": 2 }, "master_surface": "smooth", "passes": "one", "friction": 0.2 }),
        ),
        (
            "averaged gaps",
            json!({ "points": { "gauss": 3 }, "gap": "averaged", "passes": "one" }),
        ),
        (
            "segments",
            json!({ "points": { "segments": 2 }, "passes": "one", "friction": 0.2 }),
        ),
        (
            "edges",
            json!({ "points": { "gauss": 2 }, "passes": "edges", "friction": 0.2 }),
        ),
    ] {
        let here = trial.done(&scene(&contact, &Rotation3::identity(), [0.0; 3]))?;
        let there = trial.done(&scene(&contact, &turn, [3.0, -2.0, 5.0]))?;
        let force = push(&here)?;
        trial.holds(format!("contact, {name}"), force.norm() > 1.0);
        let off = (turn * force - push(&there)?).norm() / force.norm();
        trial.within(format!("force, {name}"), off, 1e-9);
        let columns = ["energy.internal", "energy.contact", "pressure.max"];
        let off = difference(&here, &there, &columns)?;
        trial.within(format!("energies and pressure, {name}"), off, 1e-9);
        if !contact["friction"].is_null() {
            let off = difference(&here, &there, &["energy.friction", "energy.dissipated"])?;
            trial.within(format!("friction, {name}"), off, 1e-9);
        }
    }
    trial.iterations(345);
    Ok(())
}

pub fn exchanged(trial: &mut Trial) -> Result<(), CaseError> {
    let contact = |slave: &str, master: &str| {
        json!({
            "slave": slave, "master": master, "points": { "gauss": 2 }, "passes": "two_half", "friction": 0.2
        })
    };
    let identity = Rotation3::identity();
    let one = scene(&contact("block.bottom", "arch.outer"), &identity, [0.0; 3]);
    let other = scene(&contact("arch.outer", "block.bottom"), &identity, [0.0; 3]);
    let [one, other] = [trial.done(&one)?, trial.done(&other)?];
    let columns = [
        "force.push.x",
        "force.push.z",
        "energy.internal",
        "energy.contact",
        "energy.dissipated",
        "pressure.max",
    ];
    trial.within("difference", difference(&one, &other, &columns)?, 1e-9);
    trial.iterations(75);
    Ok(())
}
