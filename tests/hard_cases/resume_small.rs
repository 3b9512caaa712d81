//! Runs with small displacements that are stopped and continued, as in [`crate::resume`].
use crate::resume::{assembled, in_pieces, ironed, pieces, sledge};
use covact::output::RunStatus;
use serde_json::json;

/// Small displacements: the factorization that a part had at hand is made anew by the next, and does not count again; a
/// penalty that is raised, doubts that were told.
#[test]
fn small_displacements() {
    let mut scene = ironed(json!({"penalty": "auto"}));
    let contact = scene["contacts"]["iron"].as_object_mut().unwrap();
    contact.remove("friction");
    scene["solution"]["kinematics"] = json!("small");
    scene["output"] = json!({"every": 2});
    // Most steps take fewer iterations than some pieces wait for.
    let (found, parts) = pieces(&scene);
    assert!(parts >= 3, "{parts} parts");
    assert_eq!(found.status, RunStatus::Done);
    let told = |part: &str| found.warnings.iter().any(|w| w.contains(part));
    assert!(told("displacements may not be small enough"), "{found:?}");
    let end = found.accuracy.contacts[0].penalty;
    assert!((end / assembled(&scene) - 1.0).abs() > 0.5, "{end}");
    // Between bodies, whose set of points in contact stays while they are drawn along.
    let mut scene = sledge(0.02, 8, json!({}));
    scene["solution"]["kinematics"] = json!("small");
    let (found, parts) = pieces(&scene);
    assert!(parts >= 2, "{parts} parts");
    assert_eq!(found.status, RunStatus::Done);
    let factorizations: u64 = found.factorizations.values().sum();
    assert!(factorizations < found.newton_iterations, "{found:?}");
}

/// Histories of friction at small displacements, between bodies and on a tool: points that stick, slide and come back, whatever the
/// number of threads.
#[test]
fn small_displacements_with_friction() {
    let friction = json!({"coulomb": {"mu": 0.2}});
    let mut scene = sledge(0.02, 12, json!({"friction": friction}));
    scene["solution"]["kinematics"] = json!("small");
    let there_and_back = json!({"table": [[0, 0], [0.25, 0], [0.5, 0.02], [1, -0.02]]});
    scene["supports"]["push"]["displacement"]["x"] = there_and_back;
    let found = in_pieces(&scene);
    assert_eq!(found.status, RunStatus::Done);
    assert!(
        found.newton_iterations > u64::from(found.steps),
        "{found:?}"
    );
    let mut scene = ironed(json!({}));
    scene["solution"]["kinematics"] = json!("small");
    let (found, parts) = pieces(&scene);
    assert!(parts >= 3, "{parts} parts");
    assert_eq!(found.status, RunStatus::Done);
}
