//! Random scenes reach their end or say why they do not, and what they report passes the audit.
use crate::support::Outcome;
use crate::support::solve_in;
use covact::output::RunStatus;
use covact::soak::{
    Frame, Matter, RandomScene, audit, draw, draw_with_effects, finer, is_of_mesh, off, repetition,
};
use serde_json::Value;

/// Runs a scene, changed by `change`, in this process, and audits what it reports.
fn audited(scene: &RandomScene, change: &dyn Fn(&Value) -> Value) -> Outcome {
    let written = scene.write(&Frame::default());
    let folder = tempfile::tempdir().expect("temporary folder");
    for (name, text) in [
        ("tool.json", written.cad()),
        ("sheet.json", written.sheet()),
    ] {
        if let Some(text) = text.expect("serialisable") {
            std::fs::write(folder.path().join(name), text).expect("writable");
        }
    }
    let outcome = solve_in(&change(&written.scene), folder.path());
    if let Err(finding) = audit(scene, &outcome.summary, &outcome.history) {
        panic!("seed {}, {}: {finding}", scene.seed, scene.story());
    }
    outcome
}

/// Runs a seed in this process, with fewer elements.
fn play(seed: u64) -> bool {
    let mut scene = draw(seed);
    scene.elements = scene.elements.map(|n| n.min(5));
    audited(&scene, &Value::clone).summary.status == RunStatus::Done
}

#[test]
fn random_scenes_are_done_or_told() {
    let seeds = 201..=212;
    let done = seeds.clone().filter(|seed| play(*seed)).count();
    println!("{done} of {} done", seeds.clone().count());
    assert!(10 * done >= 8 * seeds.count(), "{done}");
}

/// Scenes of metal, of faces that bend, with inertia and pressure, and what the program chooses by itself: they pass the audit, and a
/// repetition in half of the steps under ten times the penalty has the same forces, unless one of both warns.
#[test]
fn random_scenes_with_effects_have_the_forces_of_their_repetitions() {
    let (mut metal, mut faces, mut judged) = (0, 0, 0);
    for seed in [2, 18, 22, 24, 25] {
        let scene = draw_with_effects(seed);
        metal += u32::from(matches!(scene.effects.matter, Matter::Metal(_)));
        faces += u32::from(scene.effects.matter == Matter::Face);
        let [first, second] = [
            audited(&scene, &Value::clone),
            audited(&scene, &|s| repetition(&scene, s)),
        ];
        assert_eq!(first.summary.status, RunStatus::Done, "{}", scene.story());
        let apart = off(&scene, &first.history, &second.history).expect("a force");
        println!("{seed}, {}: {apart:.1e} apart", scene.story());
        if first.summary.warnings.is_empty() && second.summary.warnings.is_empty() {
            judged += 1;
            assert!(apart < 0.02, "{seed}, {}: {apart}", scene.story());
        }
        // They are not the same run.
        assert!(apart > 0.0 && second.summary.steps > first.summary.steps);
    }
    assert!(
        metal > 0 && faces > 0 && judged > 1,
        "{metal} {faces} {judged}"
    );
}

/// A tool that sinks in between slave points is told, and is a matter of the mesh: with half of the step the force is the same, with
/// elements of half the size another.
#[test]
fn a_warning_about_the_mesh_is_true_on_a_finer_one() {
    let scene = draw_with_effects(46928);
    let first = audited(&scene, &Value::clone);
    let told = &first.summary.warnings;
    assert!(
        !told.is_empty() && told.iter().all(|w| is_of_mesh(w)),
        "{told:?}"
    );
    for (warning, of_mesh) in [
        (
            "its slave points are 2 apart, too coarse for the smallest convex radius 1 of surface `s`",
            true,
        ),
        (
            "acts within one spacing of slave points (5) of sharp convex edges or tips",
            true,
        ),
        ("its default elements (`h8`) gave way at time 0.2", true),
        ("contact gives way: forces are off by about 2 %", false),
    ] {
        assert_eq!(is_of_mesh(warning), of_mesh, "{warning}");
    }
    let fine = finer(&scene);
    assert_eq!(fine.elements, scene.elements.map(|n| 2 * n));
    let [again, finer] = [
        audited(&scene, &|s| repetition(&scene, s)),
        audited(&fine, &Value::clone),
    ]
    .map(|other| off(&scene, &first.history, &other.history).expect("a force"));
    println!("{again:.1e} with half of the step, {finer:.1e} on the finer mesh");
    assert!(again < 0.001 && finer > 0.01, "{again} {finer}");
}

/// A block jumps from stick to slip, and viscous forces carry it past: the forces of one step do not balance, and that is told.
#[test]
fn a_step_that_viscous_forces_held_is_told() {
    let outcome = audited(&draw(1017), &Value::clone);
    assert_eq!(outcome.summary.status, RunStatus::Done);
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
