//! What must not change an answer: motion, numbering, parametrisation, order, threads. Over random scenes.
mod frames;
mod numbering;
mod parameters;

use super::{Case, CaseError, Group, Outcome, Trial};
use crate::soak::{BodyKind, Frame, RandomScene, Tool, draw};
use covact_geometry::Vec3;
use nalgebra::Rotation3;
use serde_json::{Value, json};

pub const GROUP: Group = Group {
    name: "invariance",
    cases: &[
        Case {
            name: "placed_elsewhere",
            what: "six random scenes, turned and moved as a whole",
            right: "forces turn along, all else is the same",
            run: frames::placed,
        },
        Case {
            name: "carried_along",
            what: "a ball presses a block with friction while both are turned by 90 degrees and carried off",
            right: "forces turn along, all else as at rest",
            run: frames::carried,
        },
        Case {
            name: "mirrored",
            what: "six random scenes, mirrored",
            right: "forces are mirrored, all else is the same",
            run: frames::mirrored,
        },
        Case {
            name: "renumbered",
            what: "nodes and elements of a mesh file in random order",
            right: "the same",
            run: numbering::renumbered,
        },
        Case {
            name: "order_of_pairs",
            what: "two tools, two bodies and their pairs named in another order",
            right: "the same",
            run: numbering::order,
        },
        Case {
            name: "threads",
            what: "six random scenes, on one thread and on four",
            right: "the same bits",
            run: numbering::threads,
        },
        Case {
            name: "swapped_and_reversed",
            what: "three random scenes with patches, parameters swapped and reversed",
            right: "the same",
            run: parameters::turned,
        },
        Case {
            name: "elevated_and_refined",
            what: "three random scenes with patches, degrees elevated, knots inserted",
            right: "the same",
            run: parameters::refined,
        },
    ],
};

/// Largest difference that rounding explains, relative to the largest value of a column.
const SAME: f64 = 1e-9;

/// A random scene made small: few elements and steps.
fn small(seed: u64) -> RandomScene {
    let mut scene = draw(seed);
    let quadratic = scene.element == "q18";
    let n = if quadratic { 2 } else { 4 };
    scene.elements = [n, n + 1];
    scene.steps = 5;
    scene.augmented = false;
    // A force along z does not turn with the scene.
    scene.motion.force = None;
    if scene.facets.is_some() {
        scene.facets = Some(("smooth", 10));
    }
    scene
}

/// The first `count` random scenes with a patch as tool, or of any kind.
fn some(count: usize, patches: bool) -> Vec<RandomScene> {
    let fit = |s: &RandomScene| {
        // An arch may snap through, where two equal runs may take different ways.
        !matches!(s.body, BodyKind::Arch { .. }) && (!patches || matches!(s.tool, Tool::Patch(_)))
    };
    (1..).map(small).filter(fit).take(count).collect()
}

/// Runs a random scene in a frame, with equal steps and a tolerance below what is compared.
fn run(trial: &mut Trial, scene: &RandomScene, frame: &Frame) -> Result<Outcome, CaseError> {
    let written = scene.write(frame);
    let mut json = written.scene;
    if !written.patches.is_empty() {
        trial.cad("tool", written.patches)?;
    }
    json["solution"]["step"]["adaptive"] = json!(false);
    // Penalties that the run rules would turn a last digit of an error into another penalty.
    for contact in json["contacts"].as_object_mut().into_iter().flatten() {
        contact.1["penalty"] = json!({ "scaled": 1 });
        if contact.1.get("friction").is_some_and(|f| !f.is_null()) {
            contact.1["tangential_penalty"] = json!({ "scaled": 1 });
        }
    }
    json["solution"]["newton"] = json!({ "tolerance": 1e-11, "max_iterations": 40 });
    let outcome = trial.done(&json);
    outcome.map_err(|e| CaseError::new(format!("seed {}: {e}", scene.seed)))
}

/// Columns that turn with the scene: vectors named up to their axis.
fn vectors(outcome: &Outcome) -> Vec<String> {
    let heads = outcome
        .history
        .columns
        .iter()
        .filter_map(|c| c.strip_suffix(".x"));
    heads
        .filter(|h| h.starts_with("force."))
        .map(str::to_owned)
        .collect()
}

/// Columns that no frame changes.
const SCALARS: [&str; 5] = [
    "energy.internal",
    "energy.contact",
    "energy.dissipated",
    "penetration.max",
    "points.active",
];

/// Largest difference of two runs over all steps: forces, which `turn` takes from the first to the second, relative to the
/// largest of them, and scalars relative to their largest value.
fn difference(a: &Outcome, b: &Outcome, turn: impl Fn(Vec3) -> Vec3) -> Result<f64, CaseError> {
    let times = [a.column("time")?, b.column("time")?];
    if times[0].len() != times[1].len() {
        return Err(CaseError::new(format!(
            "{} steps against {}",
            times[0].len(),
            times[1].len()
        )));
    }
    let mut worst = 0.0f64;
    let mut largest = 0.0f64;
    for head in vectors(a) {
        let read = |o: &Outcome| -> Result<Vec<Vec3>, CaseError> {
            let [x, y, z] = ["x", "y", "z"].map(|axis| o.column(&format!("{head}.{axis}")));
            let (x, y, z) = (x?, y?, z?);
            Ok((0..x.len()).map(|i| Vec3::new(x[i], y[i], z[i])).collect())
        };
        for (a, b) in read(a)?.into_iter().zip(read(b)?) {
            worst = worst.max((turn(a) - b).norm());
            largest = largest.max(a.norm());
        }
    }
    if largest <= 0.0 {
        return Err(CaseError::new("no force acts"));
    }
    worst /= largest;
    for name in SCALARS {
        let Some(a) = a.history.column(name) else {
            continue;
        };
        let scale = a.iter().fold(0.0f64, |s, x| s.max(x.abs()));
        for (a, b) in a.iter().zip(b.column(name)?) {
            if scale > 0.0 {
                worst = worst.max((a - b).abs() / scale);
            }
        }
    }
    Ok(worst)
}

/// Nothing turns.
fn still(v: Vec3) -> Vec3 {
    v
}

fn rotation(axis: [f64; 3], degrees: f64) -> Rotation3<f64> {
    let axis = nalgebra::Unit::new_normalize(Vec3::from(axis));
    Rotation3::from_axis_angle(&axis, degrees.to_radians())
}

/// A block of 1 x 1 x 0.5 under a ball, with friction.
fn block_and_ball(motion: Value) -> Value {
    let ball = json!({
        "sphere": { "radius": 0.5, "center": [0, 0, 1.01] },
        "motion": motion
    });
    let mut scene = super::scenes::block_under(ball, 5, 6);
    scene["contacts"]["press"]["friction"] = json!({ "coulomb": { "mu": 0.3 } });
    scene["solution"]["step"]["adaptive"] = json!(false);
    scene
}
