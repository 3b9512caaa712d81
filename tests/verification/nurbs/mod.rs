//! Kirchhoff-Love shells on NURBS patches, as bodies of kind `nurbs` in scenes.
//!
//! Where no published value is named the reference is an independent program (numpy; the same element, its own code for splines,
//! assembly, Newton's method and contact) on the same mesh, whose printed digits are compared. The element alone is proved in
//! the crate itself (derivatives, rigid motions, patch test).
mod contact;
mod linear;
mod nets;
mod nonlinear;
mod pair;
mod panel;
mod refusals;
mod scenes;
mod seams;
mod self_contact;
mod trim_masters;
mod trim_seams;
mod trim_supports;
mod trims;

use crate::support::{Outcome, solve_in};
use serde_json::{Value, json};
use std::f64::consts::PI;

/// A patch as a file of geometry has it.
pub struct Patch {
    degree: [usize; 2],
    knots: [Vec<f64>; 2],
    /// Homogeneous control points, xi1 fastest.
    points: Vec<[f64; 4]>,
}

/// Clamped knots of one span.
fn knots(degree: usize) -> Vec<f64> {
    [vec![0.0; degree + 1], vec![1.0; degree + 1]].concat()
}

/// Control points (cos, sin) of an arc below 180 degrees (radians), with weights.
fn arc(a: f64, b: f64) -> [[f64; 3]; 3] {
    let (m, w) = (0.5 * (a + b), (0.5 * (b - a)).cos());
    [
        [a.cos(), a.sin(), 1.0],
        [m.cos() / w, m.sin() / w, w],
        [b.cos(), b.sin(), 1.0],
    ]
}

impl Patch {
    /// A rectangle from the origin in the plane z = `z`.
    pub fn plate(size: [f64; 2], z: f64) -> Patch {
        Patch {
            degree: [1, 1],
            knots: [knots(1), knots(1)],
            points: (0..4)
                .map(|k| [size[0] * (k % 2) as f64, size[1] * (k / 2) as f64, z, 1.0])
                .collect(),
        }
    }

    /// A cylinder about y: xi1 is the angle from z towards x, in radians, xi2 is y from 0.
    pub fn cylinder(radius: f64, [a, b]: [f64; 2], length: f64) -> Patch {
        let points = [0.0, length]
            .into_iter()
            .flat_map(|y| arc(a, b).map(|[c, s, w]| [w * radius * s, w * y, w * radius * c, w]));
        Patch {
            degree: [2, 1],
            knots: [knots(2), knots(1)],
            points: points.collect(),
        }
    }

    /// A part of a sphere: xi1 is the longitude from x towards y, xi2 the latitude between two (radians).
    pub fn sphere(radius: f64, latitudes: [f64; 2]) -> Patch {
        let points = arc(latitudes[0], latitudes[1])
            .into_iter()
            .flat_map(|[c, s, w]| {
                arc(0.0, 0.5 * PI).map(|[x, y, v]| {
                    let w = w * v;
                    [w * radius * c * x, w * radius * c * y, w * radius * s, w]
                })
            });
        Patch {
            degree: [2, 2],
            knots: [knots(2), knots(2)],
            points: points.collect(),
        }
    }

    pub fn json(&self) -> Value {
        json!({"covact_geometry": 1, "unit": "mm", "resolution": null, "patches": [{
            "entity": 1, "degree": self.degree, "knots": self.knots, "points": self.points
        }]})
    }
}

/// Runs a scene whose body `sheet` is a shell of this patch; the scene gives the rest of it.
pub fn solve_sheet(patch: &Patch, scene: &Value) -> Outcome {
    solve_sheet_file(&patch.json(), scene)
}

/// Runs a scene beside which this geometry lies as `face.json`.
pub fn solve_sheet_file(geometry: &Value, scene: &Value) -> Outcome {
    let folder = tempfile::tempdir().expect("temporary folder");
    std::fs::write(folder.path().join("face.json"), geometry.to_string()).expect("written");
    solve_in(scene, folder.path())
}

/// A body of kind `nurbs`.
pub fn sheet(thickness: f64, elements: [u32; 2]) -> Value {
    json!({
        "nurbs": {"file": "face.json", "thickness": thickness, "elements": elements},
        "material": "m"
    })
}

/// A scene of one sheet under small loads, of which `probe` is looked at.
pub fn small_scene(
    material: [f64; 2],
    body: Value,
    supports: Value,
    loads: Value,
    corner: &str,
) -> Value {
    json!({
        "covact": 1,
        "materials": {"m": {"st_venant_kirchhoff": {"E": material[0], "nu": material[1]}}},
        "bodies": {"sheet": body},
        "supports": supports,
        "loads": loads,
        "probes": {"tip": {"on": format!("sheet.{corner}"), "quantity": "displacement"}},
        // Positions have sixteen digits, of which small displacements leave few.
        "solution": {"step": {"initial": 1.0, "max": 1.0}, "newton": {"tolerance": 1e-6}},
        "output": {"every": 0}
    })
}

/// Relative difference.
pub fn off(found: f64, reference: f64) -> f64 {
    (found / reference - 1.0).abs()
}
