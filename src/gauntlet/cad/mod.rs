//! Tools from CAD files and the facets that stand for them.
mod facets;
mod files;

use super::{Case, CaseError, Group};
use serde_json::{Value, json};

pub const GROUP: Group = Group {
    name: "cad",
    cases: &[
        Case {
            name: "step_solid",
            what: "a round punch, a solid in a STEP file whose sphere is trimmed, drawn over a block with friction",
            right: "as the exact sphere, to 1e-9",
            run: files::step,
        },
        Case {
            name: "inches",
            what: "that STEP file, which states millimetres, in a scene in inches",
            right: "the same numbers after scaling, to 1e-9",
            run: files::inches,
        },
        Case {
            name: "formats",
            what: "a ball of six rational patches as JSON and as IGES",
            right: "the same forces, energies and pressures, to 1e-9",
            run: files::formats,
        },
        Case {
            name: "one_file_or_two",
            what: "two balls of different size in one file as one tool, and as two tools",
            right: "the forces add up, all else is the same, to 1e-9",
            run: files::pieces,
        },
        Case {
            name: "facets",
            what: "a cylinder by plane facets of three sizes pressed into a block",
            right: "the error against the exact cylinder falls with the square of their size",
            run: facets::order,
        },
        Case {
            name: "triangles",
            what: "those facets cut into triangles, as an STL file",
            right: "the same as by facets, to the single precision of the file",
            run: facets::triangles,
        },
    ],
};

/// A block of 20 x 20 x 10, its bottom fixed, lengths times `length`, under a tool that is drawn over it.
fn block(tool: Value, length: f64) -> Value {
    let stress = 1.0 / (length * length);
    let mut solution = super::scenes::solution(3);
    solution["newton"]["tolerance"] = json!(1e-11);
    let mut scene = json!({
        "covact": 1,
        "materials": { "rubber": { "neo_hooke": { "E": 100.0 * stress, "nu": 0.3 } } },
        "bodies": { "block": {
            "mesh": { "block": {
                "min": [-10.0 * length, -10.0 * length, -10.0 * length], "max": [10.0 * length, 10.0 * length, 0],
                "elements": [6, 6, 3]
            } },
            "material": "rubber",
            "element": "h8_displacement"
        } },
        "surfaces": { "tool": tool },
        "contacts": { "press": {
            "slave": "block.top", "master": "tool", "points": { "gauss": 2 }, "friction": 0.2,
            "penalty": { "value": 100.0 * stress / length }, "tangential_penalty": { "value": 50.0 * stress / length }
        } },
        "supports": { "floor": { "on": "block.bottom", "fixed": true } },
        "solution": solution,
        "output": { "every": 0 }
    });
    scene["surfaces"]["tool"]["motion"] = json!({ "translation": [
        format!("{:?}*t", 1.5 * length), 0, format!("{:?}*t", -1.5 * length)
    ] });
    scene
}

/// Columns that tell the state of the block, of which the first ones are forces.
const STATE: [&str; 6] = [
    "force.tool.x",
    "force.tool.z",
    "energy.internal",
    "energy.contact",
    "energy.dissipated",
    "pressure.max",
];

/// Writes a file beside the scenes.
fn write(trial: &super::Trial, name: &str, content: &[u8]) -> Result<(), CaseError> {
    std::fs::write(trial.folder().join(name), content).map_err(|e| CaseError::new(e.to_string()))
}
