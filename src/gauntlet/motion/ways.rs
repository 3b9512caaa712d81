//! Straight ways over what surfaces are made of.
use crate::gauntlet::drawn::{FRICTION, STATE, block, cylinder, difference, steps};
use crate::gauntlet::scenes::arc;
use crate::gauntlet::{CaseError, Outcome, Trial};
use covact_geometry::{Vec3, primitives};
use serde_json::{Value, json};
use std::f64::consts::PI;

fn broken(e: impl std::fmt::Display) -> CaseError {
    CaseError::new(e.to_string())
}

pub fn borders(trial: &mut Trial) -> Result<(), CaseError> {
    let top = json!({
        "x": { "table": [[0, 0], [0.25, 0], [1, 0.6]] }, "y": 0,
        "z": { "table": [[0, 0], [0.25, -0.06], [1, -0.06]] }
    });
    // The seam of the cylinder on its crown, in the middle of the way.
    let mut seam = cylinder(0.0);
    seam["cylinder"]["center"] = json!([0, 0, 0]);
    seam["placement"] = json!({ "axis": [0, 1, 0], "angle": -90, "translation": [-0.3, 0, -2] });
    let mut four = Vec::new();
    for i in 0..4 {
        let from = (150.0 - 30.0 * f64::from(i)).to_radians();
        let patch = arc([-0.3, -2.0], 2.0, [from, from - PI / 6.0], [-2.0, 2.0])?;
        four.push(match i {
            0 => patch,
            1 => patch.swapped().map_err(broken)?,
            2 => patch.reversed(0).map_err(broken)?,
            _ => patch
                .swapped()
                .map_err(broken)?
                .reversed(1)
                .map_err(broken)?,
        });
    }
    let file = trial.cad("four", four)?;
    let four = json!({ "cad": { "file": file }, "side": { "point": [0, 0, 5] }, "depth": 0.4 });
    for (mu, columns) in [(None, &STATE[..]), (Some(json!(0.3)), &FRICTION[..])] {
        let word = if mu.is_some() {
            "with friction"
        } else {
            "without"
        };
        let one = trial.done(&block(cylinder(-0.3), top.clone(), mu.clone(), 16))?;
        trial.holds("contact", one.last("points.active")? > 0.0);
        for (name, tool) in [("seam", &seam), ("four patches", &four)] {
            let other = trial.done(&block(tool.clone(), top.clone(), mu.clone(), 16))?;
            let off = difference(&one, &other, columns)?;
            trial.within(format!("{name}, {word}: against one patch"), off, 1e-9);
        }
    }
    trial.iterations(1150);
    Ok(())
}

/// A panel with a round bottom over a plate 1.2 long, its upper face moved along x and z.
fn panel(x: Value, z: Value, solution: Value) -> Value {
    json!({
        "covact": 1,
        "materials": { "m": { "st_venant_kirchhoff": { "E": 100, "nu": 0.3 } } },
        "bodies": { "panel": {
            "mesh": { "cylinder_panel": {
                "radius": 1.5, "thickness": 0.3, "angles": [-25, 25], "y": [0, 0.3], "elements": [16, 1], "layers": 2
            } },
            "material": "m",
            "element": "h8_displacement",
            "placement": { "axis": [0, 1, 0], "angle": 180 }
        } },
        "surfaces": { "tool": {
            "plane": { "size": [1.2, 4] }, "placement": { "translation": [0, 0, -1.65] }, "side": { "point": [0, 0, 0] }
        } },
        "contacts": { "slide": {
            "slave": "panel.outer", "master": "tool", "points": { "gauss": 2 }, "penalty": { "value": 2e4 }
        } },
        "supports": { "top": { "on": "panel.inner", "displacement": { "x": x, "y": 0, "z": z } } },
        "solution": solution,
        "output": { "every": 0 }
    })
}

pub fn open_edges(trial: &mut Trial) -> Result<(), CaseError> {
    let down = -0.05;
    let pressed = json!({ "table": [[0, 0], [1, down]] });
    let there = trial.done(&panel(json!(0), pressed, steps(0.25, 1.0)))?;
    // Beside the plate, down, and over it.
    let x = json!({ "table": [[0, 0], [0.1, -1.5], [0.5, 0], [0.9, 1.5]] });
    let z = json!({ "table": [[0, 0], [0.05, 0.2], [0.1, down], [0.9, down]] });
    let slid = trial.done(&panel(x, z, steps(0.02, 0.9)))?;
    for name in ["force.tool.z", "energy.internal", "energy.contact"] {
        let (on, right) = (slid.at(name, 0.5)?, there.last(name)?);
        trial.equal(
            format!("{name} in the middle of the plate"),
            on,
            right,
            1e-9,
        );
    }
    let stored = there.last("energy.internal")?;
    let largest = slid
        .column("energy.internal")?
        .into_iter()
        .fold(0.0, f64::max);
    trial.holds(
        "the body is pressed on its way",
        stored > 0.0 && largest >= stored,
    );
    trial.within(
        "force after the other edge",
        slid.last("force.tool.z")?,
        0.0,
    );
    let left = slid.last("energy.internal")? + slid.last("energy.contact")?;
    trial.within("energy left / largest", left / largest, 1e-12);
    // Two runs, one of them with the edge as a slave, are given up on the way.
    trial.iterations(900);
    Ok(())
}

const TENSION: f64 = 40.0;
/// Steps in which its end is bent over.
const BEND: f64 = 32.0;

/// A strip on a table whose end is bent over its edge until t = 1, and drawn down from then on.
///
/// ```text
///   T <--- strip =========.
///   ~~~~~ table ~~~~~~~~.  \
///                       ~  |  end: guided, drawn down
/// ```
struct Corner {
    /// Of the table (length; 0: sharp), and of the end's way while it is bent over.
    fillet: f64,
    bend: f64,
    gauss: u32,
    /// Way drawn and its steps.
    way: f64,
    steps: u32,
}

impl Corner {
    fn run(&self, trial: &mut Trial) -> Result<Outcome, CaseError> {
        let Corner {
            fillet: r,
            bend: b,
            gauss,
            way,
            steps,
        } = *self;
        let plane = |center: Vec3, normal: Vec3| {
            primitives::plane(center, normal, [20.0, 20.0]).map_err(broken)
        };
        let mut patches = vec![
            plane(Vec3::new(-10.0, 0.0, 0.0), Vec3::z())?,
            plane(Vec3::new(r, 0.0, -10.0 - r), Vec3::x())?,
        ];
        let file = match r > 0.0 {
            true => {
                patches.push(arc([0.0, -r], r, [0.5 * PI, 0.0], [-10.0, 10.0])?);
                "fillet"
            }
            false => "sharp",
        };
        let file = trial.cad(file, patches)?;
        // The end's mid-line turns on a circle of radius `bend`, which leads to the table's side.
        let middle = b + 0.25;
        let turn = "(pi/2*min(1,t))";
        let part = f64::from(steps) / BEND;
        let drawn = format!("{}*max(0,t-1)", way / part);
        let x = format!("x-{middle}*{turn}+{drawn}");
        let aside = r - b;
        let scene = json!({
            "covact": 1,
            "materials": { "m": { "st_venant_kirchhoff": { "E": 2000, "nu": 0 } } },
            "bodies": { "strip": {
                "mesh": { "plate": {
                    "size": [20, 1], "thickness": 0.5, "elements": [50, 1], "origin": [-9, 0, 0.25]
                } },
                "material": "m"
            } },
            "surfaces": { "tool": { "cad": { "file": file }, "side": { "point": [0, 0, 5] }, "depth": 2 } },
            "contacts": { "slide": {
                "slave": "strip.bottom", "master": "tool", "points": { "gauss": gauss }, "penalty": { "value": 2000 }
            } },
            "supports": {
                "front": { "on": "strip.y_min", "symmetry": "y" },
                "back": { "on": "strip.y_max", "symmetry": "y" },
                "end": { "on": "strip.x_max", "displacement": {
                    "x": format!("{aside}*min(1,t) + ({b}+z)*sin{turn} + ({x})*cos{turn} - x"),
                    "z": format!("{}*min(1,t) + ({b}+z)*cos{turn} - ({x})*sin{turn} - {b} - z", -aside)
                } }
            },
            "loads": { "tension": {
                "on": "strip.x_min", "force": [{ "table": [[0, 0], [0.05, -TENSION], [9, -TENSION]] }, 0, 0]
            } },
            "solution": {
                "end_time": 1.0 + part, "stops": [1],
                "step": { "initial": 1.0 / BEND, "max": 1.0 / BEND, "adaptive": false },
                "newton": { "tolerance": 1e-9 }
            },
            "output": { "every": 0 }
        });
        trial.done(&scene)
    }
}

/// Pull of the end from t = 1 on; the tool must balance it and the tension.
fn pull(trial: &mut Trial, outcome: &Outcome) -> Result<Vec<f64>, CaseError> {
    let times = outcome.column("time")?;
    let [ex, ez] = [
        outcome.column("force.end.x")?,
        outcome.column("force.end.z")?,
    ];
    let [tx, tz] = [
        outcome.column("force.tool.x")?,
        outcome.column("force.tool.z")?,
    ];
    let (mut pull, mut left) = (Vec::new(), 0.0f64);
    for i in (0..times.len()).filter(|i| times[*i] > 1.0 - 1e-9) {
        pull.push(-ez[i]);
        left = left.max((ex[i] + tx[i] - TENSION).hypot(ez[i] + tz[i]));
    }
    trial.within(
        "balance of tool, end and tension / tension",
        left / TENSION,
        1e-7,
    );
    Ok(pull)
}

pub fn fillet(trial: &mut Trial) -> Result<(), CaseError> {
    // Ten elements of 0.4.
    let corner = Corner {
        fillet: 3.0,
        bend: 3.0,
        gauss: 2,
        way: 4.0,
        steps: 40,
    };
    let outcome = corner.run(trial)?;
    let pull = pull(trial, &outcome)?;
    let mean = pull[1..].iter().sum::<f64>() / (pull.len() - 1) as f64;
    trial.equal("mean pull against the tension", mean, TENSION, 3e-4);
    let ripple = pull.iter().fold(0.0f64, |r, p| r.max((p - TENSION).abs()));
    trial.within("ripple as elements pass / tension", ripple / TENSION, 3e-3);
    trial.iterations(330);
    Ok(())
}

pub fn sharp_corner(trial: &mut Trial) -> Result<(), CaseError> {
    // Four elements of 0.4; the first two are the way into steady motion.
    let corner = Corner {
        fillet: 0.0,
        bend: 1.0,
        gauss: 5,
        way: 1.6,
        steps: 64,
    };
    let outcome = corner.run(trial)?;
    let pull = pull(trial, &outcome)?;
    // The bend, three elements long, goes over the edge in kinks, at which a share of an element's stiffness comes and goes.
    let late = &pull[pull.len() - 32..];
    let mean = late.iter().sum::<f64>() / late.len() as f64;
    let what = "mean pull over two elements against the tension";
    trial.equal(what, mean, TENSION, 0.04);
    // A run with the edge as a slave is given up on the way.
    trial.iterations(600);
    Ok(())
}
