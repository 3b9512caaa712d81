//! The same scene elsewhere, on its way, and in the mirror.
use super::{SAME, block_and_ball, difference, rotation, run, some};
use crate::gauntlet::{CaseError, Trial};
use crate::soak::{Frame, RandomScene, Tool};
use covact_geometry::Vec3;
use nalgebra::{Isometry3, Translation3, UnitQuaternion};
use serde_json::json;

pub fn placed(trial: &mut Trial) -> Result<(), CaseError> {
    for scene in some(6, false) {
        let turn = rotation([1.0, -2.0, 0.5], 40.0 + 50.0 * scene.seed as f64);
        let to = Translation3::new(7.0, -3.0, 12.0);
        let frame = Frame(Isometry3::from_parts(
            to,
            UnitQuaternion::from_rotation_matrix(&turn),
        ));
        let here = run(trial, &scene, &Frame::default())?;
        let there = run(trial, &scene, &frame)?;
        let off = difference(&here, &there, |v| turn * v)?;
        trial.within(format!("seed {}: difference", scene.seed), off, SAME);
    }
    trial.iterations(1300);
    Ok(())
}

/// The superposed motion is a rotation about the x axis by 90 degrees t, and a translation.
pub fn carried(trial: &mut Trial) -> Result<(), CaseError> {
    let rest = block_and_ball(json!({
        "translation": ["0.1*t", 0, "-0.1*t"]
    }));
    let at_rest = trial.done(&rest)?;
    let angle = "(pi/2*t)";
    let [s, c] = ["sin", "cos"].map(|f| format!("{f}{angle}"));
    let mut scene = block_and_ball(json!({
        // R(t) p(t) + d(t) for the way p = (0.1 t, 0, -0.1 t) at rest; the ball turns about the origin.
        "translation": [
            "0.1*t + 3*t",
            format!("0.1*t*{s} - 2*t"),
            format!("-0.1*t*{c} + t")
        ],
        "rotation": { "center": [0, 0, 0], "axis": [1, 0, 0], "angle": "90*t" }
    }));
    scene["supports"]["floor"] = json!({ "on": "block.bottom", "displacement": {
        "x": "3*t",
        "y": format!("y*({c} - 1) - z*{s} - 2*t"),
        "z": format!("y*{s} + z*({c} - 1) + t")
    } });
    let moved = trial.done(&scene)?;
    let times = at_rest.column("time")?;
    let (mut worst, mut largest) = (0.0f64, 0.0f64);
    for name in ["tool", "floor"] {
        let read = |o: &crate::gauntlet::Outcome| -> Result<Vec<Vec3>, CaseError> {
            let [x, y, z] = ["x", "y", "z"].map(|a| o.column(&format!("force.{name}.{a}")));
            let (x, y, z) = (x?, y?, z?);
            Ok((0..x.len()).map(|i| Vec3::new(x[i], y[i], z[i])).collect())
        };
        for ((t, a), b) in times.iter().zip(read(&at_rest)?).zip(read(&moved)?) {
            let turn = rotation([1.0, 0.0, 0.0], 90.0 * t);
            worst = worst.max((turn * a - b).norm());
            largest = largest.max(a.norm());
        }
    }
    trial.holds("something slides", at_rest.last("points.slip")? > 0.0);
    trial.within("forces, turned back", worst / largest, SAME);
    for energy in ["energy.internal", "energy.dissipated"] {
        trial.equal(energy, moved.last(energy)?, at_rest.last(energy)?, SAME);
    }
    trial.iterations(300);
    Ok(())
}

pub fn mirrored(trial: &mut Trial) -> Result<(), CaseError> {
    for mut scene in some(6, false) {
        // Facets of a mirrored sphere are others.
        scene.facets = None;
        let image = mirror(&scene)?;
        let here = run(trial, &scene, &Frame::default())?;
        let there = run(trial, &image, &Frame::default())?;
        let flip = |v: Vec3| Vec3::new(-v.x, v.y, v.z);
        let off = difference(&here, &there, flip)?;
        trial.within(format!("seed {}: difference", scene.seed), off, SAME);
    }
    trial.iterations(1300);
    Ok(())
}

/// The scene in the mirror x -> -x; meshes are their own images.
fn mirror(scene: &RandomScene) -> Result<RandomScene, CaseError> {
    let mut image = scene.clone();
    image.center[0] = -image.center[0];
    for (_, v) in &mut image.motion.path {
        v[0] = -v[0];
    }
    image.motion.turn = -image.motion.turn;
    image.mirrored = true;
    match &mut image.tool {
        Tool::Sphere { .. } => {}
        Tool::Cylinder { axis, .. } => axis[0] = -axis[0],
        Tool::Plane { normal } => normal[0] = -normal[0],
        Tool::Patch(patch) => {
            let flipped = patch.transformed(&|p| Vec3::new(-p.x, p.y, p.z));
            // Turned round, so that its normal is the image of the normal.
            let flipped = flipped.and_then(|p| p.reversed(0));
            **patch = flipped.map_err(|e| CaseError::new(e.to_string()))?;
        }
    }
    Ok(image)
}
