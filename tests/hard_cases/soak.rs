//! Random scenes reach their end or say why they do not, and what they report passes the audit.
use crate::support::solve_in;
use covact::output::RunStatus;
use covact::soak::{Frame, audit, draw};

/// Runs a seed in this process, with fewer elements.
fn play(seed: u64) -> bool {
    let mut scene = draw(seed);
    scene.elements = scene.elements.map(|n| n.min(5));
    let written = scene.write(&Frame::default());
    let folder = tempfile::tempdir().expect("temporary folder");
    if let Some(cad) = written.cad().expect("serialisable") {
        std::fs::write(folder.path().join("tool.json"), cad).expect("writable");
    }
    let outcome = solve_in(&written.scene, folder.path());
    if let Err(finding) = audit(&scene, &outcome.summary, &outcome.history) {
        panic!("seed {seed}, {}: {finding}", scene.story());
    }
    outcome.summary.status == RunStatus::Done
}

#[test]
fn random_scenes_are_done_or_told() {
    let seeds = 201..=212;
    let done = seeds.clone().filter(|seed| play(*seed)).count();
    println!("{done} of {} done", seeds.clone().count());
    assert!(10 * done >= 8 * seeds.count(), "{done}");
}

/// The audit finds what is wrong.
#[test]
fn the_audit_can_fail() {
    let scene = draw(1);
    let written = scene.write(&Frame::default());
    let folder = tempfile::tempdir().expect("temporary folder");
    if let Some(cad) = written.cad().expect("serialisable") {
        std::fs::write(folder.path().join("tool.json"), cad).expect("writable");
    }
    let outcome = solve_in(&written.scene, folder.path());
    let place = |name: &str| {
        let found = outcome.history.columns.iter().position(|c| c == name);
        found.expect(name)
    };
    let spoilt = |column: &str, change: &dyn Fn(f64) -> f64| {
        let mut history = outcome.history.clone();
        let at = place(column);
        let last = history.rows.last_mut().expect("a step");
        last[at] = change(last[at]);
        audit(&scene, &outcome.summary, &history)
    };
    assert!(audit(&scene, &outcome.summary, &outcome.history).is_ok());
    assert!(spoilt("force.tool.z", &|f| 1.01 * f + 1e-3).is_err());
    assert!(spoilt("energy.internal", &|_| f64::NAN).is_err());
    assert!(spoilt("points.active", &|_| 0.0).is_err() == scene.motion.pressed);
}
