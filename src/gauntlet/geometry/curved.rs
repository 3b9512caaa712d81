//! Radii far from the size of what is in contact.
use super::super::scenes::{block_under, solution};
use super::{Case, CaseError, Trial, difference, tool};
use crate::output::RunStatus;
use covact_geometry::primitives::{cylinder, plane};
use covact_geometry::{NurbsPatch, Vec3};
use serde_json::{Value, json};

pub const FLAT_CYLINDER: Case = Case {
    name: "flat_cylinder",
    what: "a cylinder of a radius 1e6 times the block's size, whole and as a narrow patch, pressed on it",
    right: "a plane, but for about the sagitta 1e-7; whole and patch alike",
    run: flat_cylinder,
};

pub const SMALL_RADIUS: Case = Case {
    name: "small_radius",
    what: "a bar with a tip of a fifth of the shell's thickness bends it; slave points too coarse for it",
    right: "beam with shear to 1.5 %; where points are too coarse a message with the remedy",
    run: small_radius,
};

const DOWN: [&str; 3] = ["0", "0", "-0.05*t"];

/// A patch of a cylinder along y, 2 wide, that touches z = 0.5 from above.
fn flat_patch(radius: f64) -> Result<NurbsPatch, CaseError> {
    let x = 1.0;
    // Ends of the arc at x = -1 and 1, the middle point where their tangents meet.
    let root = (radius * radius - x * x).sqrt();
    let up = x * x / (radius + root);
    let weight = root / radius;
    let bottom = radius - radius * radius / root;
    let mut points = Vec::new();
    for y in [-1.0, 1.0] {
        points.extend([
            Vec3::new(-x, y, 0.5 + up),
            Vec3::new(0.0, y, 0.5 + bottom),
            Vec3::new(x, y, 0.5 + up),
        ]);
    }
    let knots = [vec![0.0, 0.0, 0.0, 1.0, 1.0, 1.0], vec![0.0, 0.0, 1.0, 1.0]];
    let weights = [1.0, weight, 1.0, 1.0, weight, 1.0];
    Ok(NurbsPatch::new(
        [2, 1],
        knots,
        [3, 2],
        &points,
        Some(&weights),
    )?)
}

fn flat_cylinder(trial: &mut Trial) -> Result<(), CaseError> {
    const RADIUS: f64 = 1e6;
    let flat = plane(Vec3::new(0.0, 0.0, 0.5), -Vec3::z(), [2.0, 2.0])?;
    let center = Vec3::new(0.0, 0.0, 0.5 + RADIUS);
    let whole = cylinder(RADIUS, 2.0, center, Vec3::y())?;
    let mut run = |name: &str, patch: NurbsPatch| {
        let tool = tool(trial, name, vec![patch], DOWN)?;
        trial.done(&block_under(tool, 4, 2))
    };
    let flat = run("plane", flat)?;
    let whole = run("whole", whole)?;
    let patch = run("patch", flat_patch(RADIUS)?)?;
    trial.holds("contact", flat.last("force.tool.z")? < -1.0);
    // The sagitta of the block, 1.25e-7, against the depth .05: 2.5e-6, and a part of that in the force.
    let off = |other| -> Result<f64, CaseError> { Ok(flat.last("force.tool.z")? / other - 1.0) };
    let bent = off(patch.last("force.tool.z")?)?;
    trial.equal("loss of force of the patch", bent, 8e-7, 0.5);
    trial.within("whole and patch", difference(&patch, &whole)?, 1e-8);
    trial.iterations(28);
    Ok(())
}

/// A strip of length 20, thickness 1 and width 1 in plane strain, held at both ends, under a bar across it.
fn strip(radius: f64, elements: u32, gauss: u32) -> Value {
    let depth = 0.1;
    json!({
        "covact": 1,
        "materials": { "steel": { "st_venant_kirchhoff": { "E": 1000, "nu": 0.3 } } },
        "bodies": { "strip": {
            "mesh": { "block": {
                "min": [0, 0, -0.5], "max": [10, 1, 0.5], "elements": [elements, 1, 1],
                "spacing": [{ "fine": { "length": 0.4, "fine": 4 } }, "uniform", "uniform"]
            } },
            "material": "steel"
        } },
        "surfaces": { "tool": {
            "cylinder": { "radius": radius, "length": 4, "center": [0, 0.5, 0.5 + radius] },
            "motion": { "translation": [0, 0, format!("-{depth}*t")] }
        } },
        "contacts": { "press": {
            "slave": "strip.top", "master": "tool", "points": { "gauss": gauss }, "penalty": { "value": 1e6 }
        } },
        "supports": {
            "middle": { "on": "strip.x_min", "symmetry": "x" },
            "end": { "on": "strip.x_max", "fixed": true },
            "front": { "on": "strip.y_min", "symmetry": "y" },
            "back": { "on": "strip.y_max", "symmetry": "y" }
        },
        "solution": solution(2),
        "output": { "every": 0 }
    })
}

fn small_radius(trial: &mut Trial) -> Result<(), CaseError> {
    // Half of a beam of length 20 held at both ends, line load in its middle: w = F L^3 / (192 E I) + F L / (4 k G A).
    let (e, nu, l, w): (f64, f64, f64, f64) = (1000.0, 0.3, 20.0, 0.1);
    let bending = l.powi(3) * (1.0 - nu * nu) * 12.0 / (192.0 * e);
    let shear = l / (4.0 * 5.0 / 6.0 * e / (2.0 * (1.0 + nu)));
    let force = 0.5 * w / (bending + shear);
    for radius in [0.2, 2.0] {
        let run = trial.done(&strip(radius, 30, 4))?;
        let what = format!("force at radius {radius}");
        trial.equal(what, -run.last("force.tool.z")?, force, 0.015);
    }
    // A wire between the slave points: it goes through, and is not taken for an answer.
    let wire = trial.solve(&strip(0.005, 30, 2))?;
    trial.holds("not done", wire.summary.status != RunStatus::Done);
    let told = wire.warnings("too coarse").join(" ");
    trial.says(
        &told,
        &[
            "`press`",
            "`tool`",
            "0.005",
            "refine the mesh or take more `points`",
        ],
    );
    trial.iterations(60);
    Ok(())
}
