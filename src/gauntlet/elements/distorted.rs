//! Meshes at the edge of inversion, and beyond.
use super::super::scenes::solution;
use super::super::{CaseError, Trial};
use super::squeezed::between_planes;
use serde_json::{Value, json};
use std::fmt::Write;

/// Flat, so that the thickness of the solid-shells is along z.
const HEIGHT: f64 = 0.2;

/// A block of 1 x 1 x [`HEIGHT`], 2 x 2 x 2 elements, as an Abaqus file; nodes of the lines at x = 1/2 are where `place` puts
/// them (column y = 0, 1/2, 1).
fn block(place: [[f64; 2]; 3]) -> String {
    let mut text = String::from("*NODE\n");
    for k in 0..3 {
        for (j, line) in place.iter().enumerate() {
            for i in 0..3 {
                let [x, y] = match i {
                    1 => *line,
                    _ => [0.5 * i as f64, 0.5 * j as f64],
                };
                let (number, z) = (1 + i + 3 * j + 9 * k, 0.5 * HEIGHT * k as f64);
                let _ = writeln!(text, "{number}, {x:?}, {y:?}, {z:?}");
            }
        }
    }
    text += "*ELEMENT, TYPE=C3D8, ELSET=ALL\n";
    for e in 0..8usize {
        let first = 1 + (e & 1) + 3 * ((e >> 1) & 1) + 9 * (e >> 2);
        let nodes = [0, 1, 4, 3, 9, 10, 13, 12].map(|n| (first + n).to_string());
        let _ = writeln!(text, "{}, {}", e + 1, nodes.join(", "));
    }
    text
}

/// The block pressed by a plane by the part `amount`.
fn pressed(
    trial: &Trial,
    place: [[f64; 2]; 3],
    element: &str,
    amount: f64,
) -> Result<Value, CaseError> {
    let path = trial.folder().join("block.inp");
    std::fs::write(path, block(place)).map_err(|e| CaseError::new(e.to_string()))?;
    let near = |normal: [i32; 3]| json!({ "nodes_near_plane": { "point": [0, 0, 0], "normal": normal, "tolerance": 1e-9 } });
    Ok(json!({
        "covact": 1,
        "materials": { "m": { "neo_hooke": { "E": 100, "nu": 0.3 } } },
        "bodies": { "block": {
            "mesh": { "file": { "path": "block.inp" } },
            "material": "m",
            "element": element,
            "sets": {
                "floor": near([0, 0, 1]), "left": near([1, 0, 0]), "front": near([0, 1, 0]),
                "head": { "faces_facing": { "normal": [0, 0, 1], "angle": 5 } }
            }
        } },
        "surfaces": { "tool": {
            "plane": { "center": [0, 0, HEIGHT], "normal": [0, 0, -1], "size": [10, 10] },
            "motion": { "translation": [0, 0, format!("-{:?}*t", amount * HEIGHT)] }
        } },
        "contacts": { "press": {
            "slave": "block.head", "master": "tool", "points": { "gauss": 2 }, "penalty": { "value": 1e4 / HEIGHT }
        } },
        "supports": {
            "floor": { "on": "block.floor", "symmetry": "z" },
            "left": { "on": "block.left", "symmetry": "x" },
            "front": { "on": "block.front", "symmetry": "y" }
        },
        "solution": solution(4),
        "output": { "every": 0 }
    }))
}

/// The middle node on a diagonal, so near the line between its neighbours that the corner's Jacobian is 1e-3 of the mean.
const EDGE: [[f64; 2]; 3] = [[0.5, 0.0], [0.25025, 0.25025], [0.5, 1.0]];
/// A whole line so near the left one that an edge is 1e-3 of its neighbours: wedges.
const WEDGE: [[f64; 2]; 3] = [[0.5, 0.0], [5e-4, 0.5], [0.5, 1.0]];

pub fn distorted(trial: &mut Trial) -> Result<(), CaseError> {
    let amount = 0.3;
    let (right, _) = between_planes(1.0 - amount, false, 1e4);
    for (name, place) in [("edge", EDGE), ("wedge", WEDGE)] {
        for element in ["h8", "h8_displacement"] {
            let scene = pressed(trial, place, element, amount)?;
            let out = trial.done(&scene)?;
            let force = out.last("force.tool.z")?;
            trial.equal(format!("force, {name}, {element}"), force, right, 1e-9);
            // Uniform: the largest pressure is the mean one, on an area of 1.
            let largest = out.last("pressure.max")?;
            trial.equal(
                format!("largest pressure, {name}, {element}"),
                largest,
                -force,
                1e-9,
            );
            // The enhanced strains of such elements may have a tangent that is not stable, which is told; without them it is.
            if element == "h8_displacement" {
                trial.holds(
                    format!("no negative pivot, {name}, {element}"),
                    out.warnings("negative pivot").is_empty(),
                );
            }
        }
    }
    trial.iterations(80);
    Ok(())
}

pub fn inverted(trial: &mut Trial) -> Result<(), CaseError> {
    // The middle line beyond the left one: the elements there are inside out.
    let scene = pressed(trial, [[0.5, 0.0], [-0.4, 0.5], [0.5, 1.0]], "h8", 0.1)?;
    let message = trial.refused(&scene)?;
    trial.says(&message, &["element", "mesher"]);
    // By 110 % within one step: there is no answer.
    let mut scene = pressed(trial, [[0.5, 0.0], [0.5, 0.5], [0.5, 1.0]], "h8", 1.1)?;
    scene["solution"]["step"] = json!({ "initial": 1, "max": 1, "min": 1 });
    let out = trial.solve(&scene)?;
    trial.says(out.reason(), &["smallest step size"]);
    trial.holds("no step accepted", out.summary.steps == 0);
    trial.iterations(200);
    Ok(())
}
