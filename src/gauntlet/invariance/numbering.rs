//! The same model in another order.
use super::{SAME, difference, some, still};
use crate::gauntlet::scenes::{block_under, solution};
use crate::gauntlet::{CaseError, Trial};
use crate::mesh::{self, ElementKind, Mesh};
use crate::scene::Block;
use crate::soak::Frame;
use fastrand::Rng;
use serde_json::{Value, json};
use std::fmt::Write;

pub fn threads(trial: &mut Trial) -> Result<(), CaseError> {
    for scene in some(6, false) {
        let written = scene.write(&Frame::default());
        let mut json = written.scene;
        if !written.patches.is_empty() {
            trial.cad("tool", written.patches)?;
        }
        let one = trial.done(&json)?;
        json["solution"]["threads"] = 4.into();
        let four = trial.done(&json)?;
        trial.holds(
            format!("seed {}: contact", scene.seed),
            one.last("energy.internal")? > 0.0,
        );
        let same = one.history == four.history;
        trial.holds(format!("seed {}: the same rows", scene.seed), same);
    }
    trial.iterations(1300);
    Ok(())
}

/// Nodes of a C3D8 element in the order of ours, and its face number of ours.
const FILE_ORDER: [usize; 8] = [0, 1, 3, 2, 4, 5, 7, 6];
const FILE_FACE: [u8; 6] = [6, 4, 3, 5, 1, 2];

/// A mesh as an Abaqus file, nodes and elements in the given orders and numbered from 1 in them.
fn inp(mesh: &Mesh, nodes: &[usize], elements: &[usize]) -> String {
    let mut number = vec![0; nodes.len()];
    for (i, &n) in nodes.iter().enumerate() {
        number[n] = i + 1;
    }
    let mut text = String::from("*NODE\n");
    for (i, &n) in nodes.iter().enumerate() {
        let x = mesh.nodes[n];
        // Writing to a String does not fail.
        let _ = writeln!(text, "{}, {:?}, {:?}, {:?}", i + 1, x.x, x.y, x.z);
    }
    text += "*ELEMENT, TYPE=C3D8\n";
    let mut row = vec![0; elements.len()];
    for (i, &e) in elements.iter().enumerate() {
        row[e] = i + 1;
        let own = mesh.element(e);
        let list = FILE_ORDER.map(|a| number[own[a] as usize].to_string());
        let _ = writeln!(text, "{}, {}", i + 1, list.join(", "));
    }
    for (name, faces) in &mesh.face_sets {
        let _ = writeln!(text, "*SURFACE, TYPE=ELEMENT, NAME={name}");
        for f in faces {
            let _ = writeln!(
                text,
                "{}, S{}",
                row[f.element as usize], FILE_FACE[f.face as usize]
            );
        }
    }
    text
}

pub fn renumbered(trial: &mut Trial) -> Result<(), CaseError> {
    let block = Block {
        min: [-0.5, -0.5, 0.0],
        max: [0.5, 0.5, 0.5],
        elements: [5, 5, 2],
        spacing: Default::default(),
    };
    let mesh = mesh::block(&block, ElementKind::H8).map_err(|e| CaseError::new(e.to_string()))?;
    let ball = json!({
        "sphere": { "radius": 0.5, "center": [0.03, 0.01, 1.01] },
        "motion": { "translation": ["0.1*t", 0, "-0.12*t"] }
    });
    let mut scene = block_under(ball, 1, 5);
    scene["contacts"]["press"]["friction"] = json!({ "coulomb": { "mu": 0.3 } });
    scene["solution"]["step"]["adaptive"] = json!(false);
    scene["bodies"]["block"]["mesh"] = json!({ "file": { "path": "block.inp" } });
    let mut nodes: Vec<usize> = (0..mesh.nodes.len()).collect();
    let mut elements: Vec<usize> = (0..mesh.elements()).collect();
    let mut rng = Rng::with_seed(11);
    let mut given = None;
    for order in 0..4 {
        let text = inp(&mesh, &nodes, &elements);
        std::fs::write(trial.folder().join("block.inp"), text)
            .map_err(|e| CaseError::new(e.to_string()))?;
        let outcome = trial.done(&scene)?;
        match &given {
            None => given = Some(outcome),
            Some(given) => {
                let off = difference(given, &outcome, still)?;
                trial.within(format!("order {order}: difference"), off, SAME);
            }
        }
        rng.shuffle(&mut nodes);
        rng.shuffle(&mut elements);
    }
    trial.iterations(400);
    Ok(())
}

/// A block on a block between two tools; names decide about the order of everything.
fn named(names: [&str; 7]) -> Value {
    let [upper, lower, above, below, press, meet, stand] = names;
    let block = |z: f64| json!({ "min": [-0.5, -0.5, z], "max": [0.5, 0.5, z + 0.5], "elements": [4, 3, 2] });
    let body = |z: f64| json!({ "mesh": { "block": block(z) }, "material": "rubber", "element": "h8_displacement" });
    let contact = |slave: String, master: String| {
        json!({ "slave": slave, "master": master, "points": { "gauss": 2 },
            "penalty": { "value": 2e4 }, "friction": { "coulomb": { "mu": 0.2 } } })
    };
    let sphere = |z: f64, way: &str| {
        json!({
            "sphere": { "radius": 0.6, "center": [0.05, 0.02, z] },
            "motion": { "translation": [0, 0, way] }
        })
    };
    json!({
        "covact": 1,
        "materials": { "rubber": { "neo_hooke": { "E": 100, "nu": 0.3 } } },
        "bodies": { upper: body(0.501), lower: body(0.0) },
        "surfaces": { above: sphere(1.602, "-0.08*t"), below: sphere(-0.601, "0.05*t") },
        "contacts": {
            press: contact(format!("{upper}.top"), above.into()),
            meet: contact(format!("{upper}.bottom"), format!("{lower}.top")),
            stand: contact(format!("{lower}.bottom"), below.into())
        },
        "supports": {
            "side_u": { "on": format!("{upper}.x_min"), "fixed": true },
            "side_l": { "on": format!("{lower}.x_min"), "fixed": true }
        },
        "solution": solution(10),
        "output": { "every": 0 }
    })
}

pub fn order(trial: &mut Trial) -> Result<(), CaseError> {
    let names = ["a_upper", "b_lower", "c_above", "d_below", "e", "f", "g"];
    let others = ["z_upper", "a_lower", "y_above", "c_below", "n", "p", "b"];
    let given = trial.done(&named(names))?;
    let other = trial.done(&named(others))?;
    let mut worst = 0.0f64;
    let mut largest = 0.0f64;
    for (a, b) in [
        ("c_above", "y_above"),
        ("d_below", "c_below"),
        ("side_u", "side_u"),
        ("side_l", "side_l"),
    ] {
        for axis in ["x", "y", "z"] {
            let [a, b] = [
                given.column(&format!("force.{a}.{axis}"))?,
                other.column(&format!("force.{b}.{axis}"))?,
            ];
            for (a, b) in a.iter().zip(&b) {
                worst = worst.max((a - b).abs());
                largest = largest.max(a.abs());
            }
        }
    }
    trial.holds(
        "both tools press",
        given.last("force.c_above.z")? < -0.1 && given.last("force.d_below.z")? > 0.1,
    );
    trial.within("forces: difference", worst / largest, SAME);
    let energy = "energy.internal";
    trial.equal(energy, other.last(energy)?, given.last(energy)?, SAME);
    trial.iterations(600);
    Ok(())
}
