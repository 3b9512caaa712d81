//! Bodies that touch their own mirror images: a plane of symmetry says what is right.
//!
//! Between mirror images a gap g is twice the gap to the plane, so that a penalty p on it is a penalty 2 p on the plane.
use crate::gauntlet::scenes::solution;
use crate::gauntlet::{CaseError, Trial};
use serde_json::{Value, json};

/// A quarter of a tube about y, its crown at the angle 0 (lower arch) or 180 degrees (upper arch, moved up).
fn arch(angles: [f64; 2], up: f64) -> Value {
    json!({
        "mesh": { "cylinder_panel": {
            "radius": 5, "thickness": 0.5, "angles": angles, "y": [0, 1], "elements": [12, 1]
        } },
        "material": "m",
        "placement": { "translation": [0, 0, up] }
    })
}

/// Arches that are pushed together by 1 each; or one of them against a plane half way.
fn pressed(penalty: f64, passes: Option<&str>) -> Value {
    let mut scene = json!({
        "covact": 1,
        "materials": { "m": { "st_venant_kirchhoff": { "E": 100, "nu": 0.3 } } },
        "bodies": { "low": arch([0.0, 90.0], 0.0) },
        "supports": {
            "foot": { "on": "low.phi_max", "displacement": { "x": 0, "z": 0 } },
            "crown": { "on": "low.phi_min", "symmetry": "x" },
            "sides": { "on": ["low.y_min", "low.y_max"], "symmetry": "y" }
        },
        "solution": solution(10),
        "output": { "every": 0 }
    });
    match passes {
        Some(passes) => {
            scene["bodies"]["up"] = arch([90.0, 180.0], 10.5);
            scene["contacts"]["c"] = json!({
                "slave": "up.outer", "master": "low.outer", "penalty": { "value": penalty }, "points": { "gauss": 3 },
                "passes": passes
            });
            let supports = &mut scene["supports"];
            supports["head"] =
                json!({ "on": "up.phi_min", "displacement": { "x": 0, "z": "-2*t" } });
            supports["upper_crown"] = json!({ "on": "up.phi_max", "symmetry": "x" });
            supports["upper_sides"] = json!({ "on": ["up.y_min", "up.y_max"], "symmetry": "y" });
        }
        None => {
            scene["surfaces"]["plane"] = json!({
                "plane": { "size": [30, 30], "center": [0, 0.5, 5.25], "normal": [0, 0, -1] },
                "motion": { "translation": [0, 0, "-t"] }
            });
            scene["contacts"]["c"] = json!({
                "slave": "low.outer", "master": "plane", "penalty": { "value": 2.0 * penalty }, "points": { "gauss": 3 }
            });
        }
    }
    scene
}

pub fn arches(trial: &mut Trial) -> Result<(), CaseError> {
    let mut errors = Vec::new();
    for penalty in [1e3, 1e4] {
        let plane = trial.done(&pressed(penalty, None))?;
        trial.holds("contact", plane.last("force.plane.z")? < -0.1);
        let force = plane.last("force.foot.z")?;
        let one = trial.done(&pressed(penalty, Some("one")))?;
        // Penetrated faces are not quite in the plane: what they lean by goes with the penetration.
        errors.push((one.last("force.foot.z")? / force - 1.0).abs());
        trial.equal(
            "strain energy, one pass",
            one.last("energy.internal")?,
            2.0 * plane.last("energy.internal")?,
            1e-6,
        );
        trial.equal(
            "force of the other foot",
            one.last("force.head.z")?,
            -one.last("force.foot.z")?,
            1e-9,
        );
        let two = trial.done(&pressed(penalty, Some("two_half")))?;
        let what = "force, two half passes";
        trial.equal(what, two.last("force.foot.z")?, force, 1e-4);
    }
    trial.within("force, one pass", errors[0], 1e-6);
    trial.within("force, one pass, ten times the penalty", errors[1], 1e-7);
    trial.iterations(470);
    Ok(())
}

/// A part of a ring between planes at z = 2.05 and -2.05 that come together; a quarter of it has a plane in the middle.
fn squashed(whole: bool, penalty: f64) -> Value {
    let contact = |slave: &str, master: &str, penalty: f64| {
        json!({
            "slave": slave, "master": master, "penalty": { "value": penalty }, "points": "nodes"
        })
    };
    let tool = |side: f64| {
        json!({
            "plane": { "size": [20, 20], "center": [0, 0, side * 2.05], "normal": [0, 0, -side] },
            "motion": { "translation": [0, 0, format!("{}*t", -side * 1.93)] }
        })
    };
    let (angle, elements) = if whole { (180, 64) } else { (90, 32) };
    let mut scene = json!({
        "covact": 1,
        "materials": { "m": { "neo_hooke": { "E": 100, "nu": 0.3 } } },
        "bodies": { "ring": {
            "mesh": { "cylinder_panel": {
                "radius": 2, "thickness": 0.1, "angles": [0, angle], "y": [0, 0.1], "elements": [elements, 1], "layers": 2
            } },
            "material": "m",
            "element": "h8_mean_dilatation",
            "sets": { "side": { "nodes_near_plane": { "point": [0, 0, 0], "normal": [0, 0, 1], "tolerance": 1e-6 } } }
        } },
        "surfaces": { "top": tool(1.0) },
        "contacts": { "top": contact("ring.outer", "top", penalty) },
        "supports": {
            "cut": { "on": "ring.phi_min", "symmetry": "x" },
            "side": { "on": "ring.side", "displacement": { "z": 0 } },
            "faces": { "on": ["ring.y_min", "ring.y_max"], "symmetry": "y" }
        },
        "solution": solution(30),
        "output": { "every": 0 }
    });
    if whole {
        scene["surfaces"]["bottom"] = tool(-1.0);
        scene["contacts"]["bottom"] = contact("ring.outer", "bottom", penalty);
        scene["contacts"]["self"] = contact("ring.inner", "ring.inner", penalty);
        scene["supports"]["cut"]["on"] = json!(["ring.phi_min", "ring.phi_max"]);
    } else {
        // Each side is the slave of the other, which doubles the penalty once more.
        scene["surfaces"]["middle"] = json!({ "plane": { "size": [20, 20] } });
        scene["contacts"]["self"] = contact("ring.inner", "middle", 4.0 * penalty);
    }
    scene
}

pub fn ring(trial: &mut Trial) -> Result<(), CaseError> {
    let mut errors = Vec::new();
    for penalty in [300.0, 3000.0] {
        let quarter = trial.done(&squashed(false, penalty))?;
        let half = trial.done(&squashed(true, penalty))?;
        let [pressed, force] = [
            quarter.last("force.middle.z")?,
            quarter.last("force.top.z")?,
        ];
        // What it bears on itself is thirty times what the forces may differ by.
        trial.holds("it touches itself", pressed > 1e-3 * force.abs());
        let energy = 2.0 * quarter.last("energy.internal")?;
        errors.push([
            (half.last("force.top.z")? / force - 1.0).abs(),
            (half.last("energy.internal")? / energy - 1.0).abs(),
        ]);
        let points = 2.0 * quarter.last("points.active")?;
        trial.equal("points", half.last("points.active")?, points, 0.0);
    }
    // Faces that have sunk in lean a little, on a plane they do not.
    for (i, name) in ["force", "strain energy"].into_iter().enumerate() {
        trial.within(name, errors[0][i], 3e-5);
        let ratio = errors[1][i] / errors[0][i];
        trial.within(
            format!("{name}: error at ten times the penalty, by that"),
            ratio,
            0.3,
        );
    }
    trial.iterations(1390);
    Ok(())
}

/// A sheet of 4 x 1 between rollers that come down and up, or its upper half.
fn rolled(whole: bool) -> Value {
    let roller = |side: f64| {
        json!({
            "cylinder": { "radius": 1, "length": 4, "center": [2, 0.5, side * 1.2], "axis": [0, 1, 0] },
            "side": "outward",
            "motion": { "translation": [0, 0, format!("{}*t", -side * 0.08)] }
        })
    };
    let contact = |slave: &str, master: &str| {
        json!({
            "slave": slave, "master": master, "penalty": { "value": 2e3 }, "points": { "gauss": 2 },
            "friction": 0.2, "tangential_penalty": { "value": 1e3 }
        })
    };
    let (thickness, layers, middle) = if whole { (0.4, 4, 0.0) } else { (0.2, 2, 0.1) };
    let mut scene = json!({
        "covact": 1,
        "materials": { "m": { "neo_hooke": { "E": 100, "nu": 0.3 } } },
        "bodies": { "sheet": {
            "mesh": { "plate": {
                "size": [4, 1], "thickness": thickness, "elements": [12, 2], "layers": layers, "origin": [0, 0, middle]
            } },
            "material": "m",
            "element": "h8_displacement",
            // Enough of the middle plane to hold the whole sheet, which bears nothing.
            "sets": { "line": { "nodes_in_box": { "min": [-0.01, -0.01, -0.01], "max": [9, 0.01, 0.01] } } }
        } },
        "surfaces": { "above": roller(1.0) },
        "contacts": { "above": contact("sheet.top", "above") },
        "supports": {
            "x": { "on": "sheet.x_min", "symmetry": "x" },
            "y": { "on": "sheet.y_min", "symmetry": "y" },
            "z": { "on": "sheet.line", "displacement": { "z": 0 } }
        },
        "solution": solution(4),
        "output": { "every": 0 }
    });
    if whole {
        scene["surfaces"]["below"] = roller(-1.0);
        scene["contacts"]["below"] = contact("sheet.bottom", "below");
    } else {
        scene["supports"]["z"] = json!({ "on": "sheet.bottom", "symmetry": "z" });
    }
    scene
}

pub fn sheet(trial: &mut Trial) -> Result<(), CaseError> {
    let half = trial.done(&rolled(false))?;
    let whole = trial.done(&rolled(true))?;
    trial.holds("something slides", half.last("points.slip")? > 0.0);
    for name in ["force.above.z", "force.above.x", "pressure.max"] {
        trial.equal(name, whole.last(name)?, half.last(name)?, 1e-10);
    }
    for name in ["energy.internal", "energy.dissipated"] {
        trial.equal(name, whole.last(name)?, 2.0 * half.last(name)?, 1e-10);
    }
    trial.equal(
        "force of the other roller",
        whole.last("force.below.z")?,
        -half.last("force.above.z")?,
        1e-10,
    );
    trial.iterations(42);
    Ok(())
}
