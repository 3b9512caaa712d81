//! Plane facets in place of a cylinder.
use super::write;
use crate::gauntlet::drawn::difference;
use crate::gauntlet::scenes::solution;
use crate::gauntlet::{CaseError, Outcome, Trial};
use covact_geometry::io::write_stl;
use covact_geometry::{Vec3, primitives};
use serde_json::{Value, json};

const RADIUS: f64 = 6.0;

/// A cylinder on a slab of 8 x 2 x 2.
fn pressed(trial: &mut Trial, mut tool: Value) -> Result<Outcome, CaseError> {
    tool["side"] = "outward".into();
    tool["motion"] = json!({ "translation": [0, 0, "-0.4*t"] });
    let scene = json!({
        "covact": 1,
        "materials": { "rubber": { "neo_hooke": { "E": 100, "nu": 0.3 } } },
        "bodies": { "slab": {
            "mesh": { "block": { "min": [-4, -1, -2], "max": [4, 1, 0], "elements": [20, 2, 4] } },
            "material": "rubber",
            "element": "h8_displacement"
        } },
        "surfaces": { "tool": tool },
        "contacts": { "press": {
            "slave": "slab.top", "master": "tool", "penalty": { "value": 1000 }, "points": { "gauss": 3 }, "passes": "one"
        } },
        "supports": {
            "floor": { "on": "slab.bottom", "fixed": true },
            "faces": { "on": ["slab.y_min", "slab.y_max"], "symmetry": "y" }
        },
        "solution": solution(3),
        "output": { "every": 0 }
    });
    trial.done(&scene)
}

fn cylinder(facets: Option<Value>) -> Value {
    let mut tool = json!({ "cylinder": { "radius": RADIUS, "length": 5, "center": [0.13, 0, RADIUS], "axis": [0, 1, 0] } });
    if let Some(facets) = facets {
        tool["facets"] = facets;
    }
    tool
}

pub fn order(trial: &mut Trial) -> Result<(), CaseError> {
    let exact = pressed(trial, cylinder(None))?.last("force.tool.z")?;
    trial.holds("contact", exact < -10.0);
    let mut errors = Vec::new();
    for size in [1.0, 0.5, 0.25] {
        let facets = json!({ "kind": "bilinear", "size": size });
        let found = pressed(trial, cylinder(Some(facets)))?.last("force.tool.z")?;
        errors.push((found / exact - 1.0).abs());
    }
    trial.within("force, facets of a 24th of the radius", errors[2], 4e-3);
    for i in 1..3 {
        let ratio = errors[i] / errors[i - 1];
        trial.within("error of half the size", ratio, 0.35);
    }
    trial.iterations(80);
    Ok(())
}

pub fn triangles(trial: &mut Trial) -> Result<(), CaseError> {
    let (around, along) = (60usize, 2usize);
    let facets = json!({ "kind": "bilinear", "count": [around, along] });
    let facets = pressed(trial, cylinder(Some(facets)))?;
    // Facets lie evenly in the parameters of the cylinder.
    let patch = primitives::cylinder(RADIUS, 5.0, Vec3::new(0.13, 0.0, RADIUS), Vec3::y())?;
    let [[from, to], [low, high]] = patch.domain();
    let mut nodes = Vec::new();
    for j in 0..=along {
        for i in 0..around {
            let [u, v] = [i as f64 / around as f64, j as f64 / along as f64];
            nodes.push(patch.point([from + u * (to - from), low + v * (high - low)]));
        }
    }
    let mut triangles = Vec::new();
    for j in 0..along {
        for i in 0..around {
            let at = |i: usize, j: usize| (i % around + around * j) as u32;
            let [a, b, c, d] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
            triangles.extend([[a, b, c], [a, c, d]]);
        }
    }
    write(trial, "tool.stl", &write_stl(&nodes, &triangles))?;
    let stl = pressed(trial, json!({ "cad": "tool.stl" }))?;
    let columns = [
        "force.tool.z",
        "energy.internal",
        "energy.contact",
        "pressure.max",
    ];
    let off = difference(&facets, &stl, &columns)?;
    trial.within("difference", off, 1e-5);
    trial.iterations(40);
    Ok(())
}
