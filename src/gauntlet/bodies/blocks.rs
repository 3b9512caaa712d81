//! Blocks with plane faces: closed forms of uniform compression.
use crate::gauntlet::elements::between_planes;
use crate::gauntlet::scenes::solution;
use crate::gauntlet::{CaseError, Trial};
use serde_json::{Map, Value, json};

fn block(min: [f64; 3], max: [f64; 3], elements: [u32; 3]) -> Value {
    json!({
        "mesh": { "block": { "min": min, "max": max, "elements": elements } },
        "material": "m",
        "element": "h8_displacement"
    })
}

pub fn every_rule(trial: &mut Trial) -> Result<(), CaseError> {
    let penalty = 1e4;
    // Both blocks are one of height 1, whose contact is a spring in the middle.
    let (right, _) = between_planes(0.8, false, penalty);
    for (name, contact, n) in [
        ("nodes", json!({ "points": "nodes" }), 3),
        ("gauss", json!({ "points": { "gauss": 2 } }), 3),
        ("lobatto", json!({ "points": { "lobatto": 3 } }), 3),
        ("segments", json!({ "points": { "segments": 2 } }), 4),
        (
            "averaged",
            json!({ "points": { "gauss": 2 }, "gap": "averaged" }),
            3,
        ),
        (
            "two half passes",
            json!({ "points": { "gauss": 2 }, "passes": "two_half" }),
            3,
        ),
    ] {
        let mut scene = json!({
            "covact": 1,
            "materials": { "m": { "neo_hooke": { "E": 100, "nu": 0.3 } } },
            "bodies": {
                "low": block([0.0; 3], [1.0, 1.0, 0.5], [3, 3, 2]),
                "up": block([0.0, 0.0, 0.5], [1.0; 3], [n, n, 2])
            },
            "contacts": { "c": contact },
            "supports": {
                "x": { "on": ["low.x_min"], "symmetry": "x" },
                "y": { "on": ["low.y_min"], "symmetry": "y" },
                "up_x": { "on": ["up.x_min"], "symmetry": "x" },
                "up_y": { "on": ["up.y_min"], "symmetry": "y" },
                "floor": { "on": "low.bottom", "symmetry": "z" },
                "press": { "on": "up.top", "displacement": { "z": "-0.2*t" } }
            },
            "solution": solution(4),
            "output": { "every": 0 }
        });
        let contact = &mut scene["contacts"]["c"];
        contact["slave"] = "up.bottom".into();
        contact["master"] = "low.top".into();
        contact["penalty"] = json!({ "value": penalty });
        let out = trial.done(&scene)?;
        trial.equal(
            format!("force, {name}"),
            out.last("force.press.z")?,
            right,
            1e-9,
        );
        trial.equal(
            format!("largest pressure, {name}"),
            out.last("pressure.max")?,
            -right,
            1e-9,
        );
    }
    trial.iterations(95);
    Ok(())
}

pub fn pile(trial: &mut Trial) -> Result<(), CaseError> {
    let (count, penalty) = (5, 1e4);
    let (mut bodies, mut contacts) = (Map::new(), Map::new());
    let (mut left, mut front) = (Vec::new(), Vec::new());
    for i in 0..count {
        let [z, top] = [i, i + 1].map(|k| f64::from(k) / f64::from(count));
        let n = 2 + i % 2;
        let name = format!("plate{i}");
        bodies.insert(
            name.clone(),
            block([-0.5, -0.5, z], [0.5, 0.5, top], [n, n, 1]),
        );
        let mut contact =
            json!({ "slave": format!("{name}.bottom"), "penalty": { "value": penalty } });
        match i {
            0 => contact["master"] = "floor".into(),
            _ => {
                contact["master"] = format!("plate{}.top", i - 1).into();
                contact["points"] = json!({ "segments": 2 });
            }
        }
        contacts.insert(format!("below{i}"), contact);
        left.push(format!("{name}.x_min"));
        front.push(format!("{name}.y_min"));
    }
    contacts.insert(
        "top".to_owned(),
        json!({ "slave": format!("plate{}.top", count - 1), "master": "tool", "penalty": { "value": penalty } }),
    );
    let scene = json!({
        "covact": 1,
        "materials": { "m": { "neo_hooke": { "E": 100, "nu": 0.3 } } },
        "bodies": bodies,
        "surfaces": {
            "floor": { "plane": { "size": [9, 9] } },
            "tool": {
                "plane": { "size": [9, 9], "center": [0, 0, 1], "normal": [0, 0, -1] },
                "motion": { "translation": [0, 0, { "table": [[0, 0], [0.5, -0.3], [1, -0.3]] }] }
            }
        },
        "contacts": contacts,
        // What holds the plates along the planes bears nothing but Poisson's effect.
        "supports": { "x": { "on": left, "symmetry": "x" }, "y": { "on": front, "symmetry": "y" } },
        "solution": solution(6),
        "output": { "every": 0 }
    });
    let out = trial.done(&scene)?;
    // Six springs in series stand for one.
    let (right, _) = between_planes(0.7, false, penalty / f64::from(count + 1));
    trial.equal("force", out.last("force.tool.z")?, right, 1e-9);
    trial.equal(
        "force of the floor",
        out.last("force.floor.z")?,
        -right,
        1e-9,
    );
    trial.equal("largest pressure", out.last("pressure.max")?, -right, 1e-9);
    for i in 1..count {
        let force = out.last(&format!("slave.force.below{i}.z"))?;
        trial.equal(format!("force under plate {i}"), force, -right, 1e-9);
    }
    trial.iterations(74);
    Ok(())
}

pub fn small_on_big(trial: &mut Trial) -> Result<(), CaseError> {
    let scene = |contact: Value| {
        json!({
            "covact": 1,
            "materials": {
                "m": { "neo_hooke": { "E": 1, "nu": 0.3 } },
                "hard": { "neo_hooke": { "E": 1e6, "nu": 0.3 } }
            },
            "bodies": { "small": block([0.13, 0.21, 0.0], [1.13, 1.21, 0.5], [6, 6, 3]) },
            "surfaces": { "ball": {
                "sphere": { "radius": 2, "center": [0.63, 0.71, 2.5] },
                "motion": { "translation": [0, 0, "-0.15*t"] }
            } },
            "contacts": {
                "press": {
                    "slave": "small.top", "master": "ball", "penalty": { "value": 100 }, "points": { "gauss": 2 }
                },
                "below": contact
            },
            "supports": {
                "x": { "on": "small.middle_x", "displacement": { "x": 0 } },
                "y": { "on": "small.middle_y", "displacement": { "y": 0 } }
            },
            "solution": solution(5),
            "output": { "every": 0 }
        })
    };
    let sets = json!({
        "middle_x": { "nodes_near_plane": { "point": [0.63, 0, 0], "normal": [1, 0, 0], "tolerance": 1e-6 } },
        "middle_y": { "nodes_near_plane": { "point": [0, 0.71, 0], "normal": [0, 1, 0], "tolerance": 1e-6 } }
    });
    let contact = |master: &str| json!({ "slave": "small.bottom", "master": master, "penalty": { "value": 100 } });
    let mut body = scene(contact("big.top"));
    body["bodies"]["big"] = block([-20.0, -20.0, -10.0], [20.0, 20.0, 0.0], [2, 2, 1]);
    body["bodies"]["big"]["material"] = "hard".into();
    body["supports"]["ground"] = json!({ "on": "big.bottom", "fixed": true });
    body["bodies"]["small"]["sets"] = sets.clone();
    let mut rigid = scene(contact("table"));
    rigid["surfaces"]["table"] = json!({ "plane": { "size": [40, 40] } });
    rigid["bodies"]["small"]["sets"] = sets;
    let [body, rigid] = [trial.done(&body)?, trial.done(&rigid)?];
    trial.holds("contact", rigid.last("force.ball.z")? < -0.1);
    for name in [
        "force.ball.z",
        "energy.internal",
        "energy.contact",
        "pressure.max",
    ] {
        trial.equal(name, body.last(name)?, rigid.last(name)?, 1e-6);
    }
    trial.iterations(65);
    Ok(())
}
