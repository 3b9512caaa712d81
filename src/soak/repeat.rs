//! The same scene in half of the steps and under ten times the penalty: what its forces ought to be.
use super::draw::RandomScene;
use super::effects::Matter;
use crate::output::Table;
use serde_json::{Value, json};

/// Part by which penalties and tolerances are tighter.
const TIGHTER: f64 = 0.1;

/// The scene to repeat a written one by.
pub fn repetition(of: &RandomScene, scene: &Value) -> Value {
    let mut scene = scene.clone();
    let inert = matches!(of.effects.matter, Matter::Inertia { .. });
    let contacts = scene["contacts"].as_object_mut().into_iter();
    for contact in contacts.flat_map(|contacts| contacts.values_mut()) {
        if contact.get("augmentation").is_some() || inert && contact.get("penalty").is_none() {
            continue;
        }
        match contact.get("penalty").and_then(|p| p["scaled"].as_f64()) {
            Some(factor) => contact["penalty"]["scaled"] = json!(factor / TIGHTER),
            None => contact["accuracy"] = json!(TIGHTER * 4e-3),
        }
    }
    let step = match scene["solution"].get("step") {
        _ if inert => {
            scene["solution"]["dynamics"]["tolerance"] = json!(TIGHTER * 1e-3);
            return scene;
        }
        Some(step) => ["initial", "max", "min"].map(|key| step[key].as_f64().unwrap_or(0.0)),
        // Half of the default.
        None => [0.1, 0.1, 1e-5],
    };
    let [initial, max, min] = step.map(|size| 0.5 * size);
    scene["solution"]["step"] = json!({ "initial": initial, "max": max, "min": min });
    scene
}

/// What warnings about the mesh say, which steps and penalties do not change.
const OF_MESH: [&str; 4] = [
    "between its slave points",
    "too coarse for the smallest convex radius",
    "of sharp convex edges",
    "its default elements",
];

/// Whether a warning is one about the mesh: it is true where a finer one has other forces.
pub fn is_of_mesh(warning: &str) -> bool {
    OF_MESH.iter().any(|words| warning.contains(words))
}

/// The scene with elements of half the size in its faces.
pub fn finer(scene: &RandomScene) -> RandomScene {
    let mut finer = scene.clone();
    finer.elements = finer.elements.map(|n| 2 * n);
    finer
}

/// How far the force on the tool is off where its way turns and at the end of it, where most, relative to its largest one; with
/// inertia, which makes it swing, its mean over the run. None: a history says nothing of it.
pub fn off(of: &RandomScene, run: &Table, repeated: &Table) -> Option<f64> {
    let inert = matches!(of.effects.matter, Matter::Inertia { .. });
    let mut squares = vec![0.0f64; of.motion.path.len().max(1)];
    let mut largest = 0.0f64;
    for axis in ["x", "y", "z"] {
        let column = format!("force.tool.{axis}");
        let forces = |table: &Table| -> Option<(Vec<f64>, f64)> {
            let (times, forces) = (table.column("time")?, table.column(&column)?);
            let rows = || (times.iter().copied()).zip(forces.iter().copied());
            let most = forces.iter().fold(0.0f64, |most, f| most.max(f.abs()));
            if inert {
                let mut mean = 0.0;
                for ((t, f), (next, g)) in rows().zip(rows().skip(1)) {
                    mean += 0.5 * (f + g) * (next - t);
                }
                return Some((vec![mean / times.last()?], most));
            }
            let nearest =
                |t: f64| rows().min_by(|a, b| (a.0 - t).abs().total_cmp(&(b.0 - t).abs()));
            // Nothing touches before it sets out.
            let way = of.motion.path.iter().map(|p| p.0).filter(|t| *t > 0.0);
            let found: Option<Vec<f64>> = match way.clone().next() {
                None => rows().next_back().map(|row| vec![row.1]),
                Some(_) => way.map(|t| nearest(t).map(|row| row.1)).collect(),
            };
            Some((found?, most))
        };
        let [(a, _), (b, most)] = [forces(run)?, forces(repeated)?];
        for ((sum, a), b) in squares.iter_mut().zip(a).zip(b) {
            *sum += (a - b).powi(2);
        }
        largest = largest.max(most);
    }
    let apart = squares.into_iter().fold(0.0, f64::max);
    (largest > 0.0).then(|| apart.sqrt() / largest)
}
