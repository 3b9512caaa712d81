//! The kernel that a plan names is the one that runs: it is told by what the loop over the points was compiled for.
use crate::scenes::{blocks, coulomb, loaded, plate, with};
use covact::assembly::Assembler;
use covact::model::build::build;
use covact::model::state::State;
use covact::run::{RunOptions, run};
use covact::scene;
use covact::solve::event::Silent;
use serde_json::{Value, json};
use std::sync::atomic::AtomicBool;

/// Runs a scene; kernels that were planned and run, pair by pair.
fn kernels(scene: &Value) -> Vec<(String, Option<String>)> {
    let folder = tempfile::tempdir().unwrap();
    let summary = run(
        &loaded(scene),
        folder.path(),
        &RunOptions::default(),
        &mut Silent,
        &AtomicBool::new(false),
    )
    .unwrap();
    assert_eq!(summary.status.name(), "done", "{:?}", summary.reason);
    // What the file says is what was returned.
    let path = folder.path().join("summary.json");
    let read = covact::output::Summary::read(&path).unwrap();
    assert_eq!(read.plan, summary.plan);
    let plan = summary.plan.unwrap();
    assert_eq!(plan.symmetric, plan.unsymmetric.is_empty());
    let pairs = plan.pairs.into_iter();
    pairs.map(|p| (p.kernel, p.ran)).collect()
}

fn orthotropic() -> Value {
    json!({"orthotropic": {"mu": [0.1, 0.3], "direction": [1, 0, 0]}})
}

/// Changes of a scene, the kernel that they ask for, and the number of pairs.
type Case<'c> = (&'c [(&'c str, Value)], &'c str, usize);

fn runs_as(scene: &Value, expected: &str, pairs: usize) {
    let found = kernels(scene);
    assert_eq!(found.len(), pairs);
    for (planned, ran) in found {
        assert_eq!(planned, expected);
        assert_eq!(ran.as_deref(), Some(expected));
    }
}

#[test]
fn on_rigid_surfaces() {
    let contact = |key: &str| format!("/contacts/press/{key}");
    let facets = |kind: &str| json!({"kind": kind, "count": [6, 6]});
    let published = json!({"published": {"curvature": false}});
    let (offset, none) = (json!(0.1), json!({}));
    let cases: [(&[(&str, Value)], &str); 11] = [
        (&[], "rigid_nurbs.penalty.frictionless.exact"),
        (
            &[("friction", coulomb())],
            "rigid_nurbs.penalty.coulomb.exact",
        ),
        (
            &[("friction", orthotropic()), ("offset", offset.clone())],
            "rigid_nurbs.offset.orthotropic.exact",
        ),
        (
            &[("augmentation", none.clone())],
            "rigid_nurbs.multipliers.frictionless.exact",
        ),
        (
            &[("augmentation", none), ("friction", coulomb())],
            "rigid_nurbs.multipliers.coulomb.exact",
        ),
        (
            &[("offset", offset)],
            "rigid_nurbs.offset.frictionless.exact",
        ),
        (
            &[("tangent", published)],
            "rigid_nurbs.penalty.frictionless.published_without_curvature",
        ),
        (
            &[("points", json!({"gauss": 2})), ("gap", json!("averaged"))],
            "averaged.rigid_nurbs.penalty.frictionless.exact",
        ),
        (
            &[
                ("points", json!({"gauss": 2})),
                ("gap", json!("averaged")),
                ("friction", coulomb()),
            ],
            "averaged.rigid_nurbs.penalty.coulomb.exact",
        ),
        (
            &[("/surfaces/ball/facets", facets("bilinear"))],
            "rigid_bilinear.penalty.frictionless.exact",
        ),
        (
            &[("/surfaces/ball/facets", facets("biquadratic"))],
            "rigid_biquadratic.penalty.frictionless.exact",
        ),
    ];
    for (changes, expected) in cases {
        let changes: Vec<(String, Value)> = (changes.iter())
            .map(|(key, value)| match key.starts_with('/') {
                true => ((*key).to_owned(), value.clone()),
                false => (contact(key), value.clone()),
            })
            .collect();
        let changes: Vec<_> = changes
            .iter()
            .map(|(k, v)| (k.as_str(), v.clone()))
            .collect();
        runs_as(&with(plate(), &changes), expected, 1);
    }
    let small = with(plate(), &[("/solution/kinematics", json!("small"))]);
    runs_as(
        &small,
        "linearised.rigid_nurbs.penalty.frictionless.exact",
        1,
    );
    let rubbed = with(small, &[("/contacts/press/friction", coulomb())]);
    runs_as(&rubbed, "linearised.rigid_nurbs.penalty.coulomb.exact", 1);
}

#[test]
fn between_bodies() {
    let main = json!({"published": {"rotational": false, "curvature": false}});
    let halves = || ("/contacts/press/passes", json!("two_half"));
    let friction = || ("/contacts/press/friction", coulomb());
    let ellipse = || ("/contacts/press/friction", orthotropic());
    let cases: [Case; 9] = [
        (&[], "faces.penalty.frictionless.exact", 1),
        (&[friction()], "faces.penalty.coulomb.exact", 1),
        (
            &[("/contacts/press/augmentation", json!({}))],
            "faces.multipliers.frictionless.exact",
            1,
        ),
        (
            &[("/contacts/press/gap", json!("averaged"))],
            "averaged.faces.penalty.frictionless.exact",
            1,
        ),
        (
            &[("/contacts/press/gap", json!("averaged")), ellipse()],
            "averaged.faces.penalty.orthotropic.exact",
            1,
        ),
        (
            &[halves()],
            "faces.penalty.frictionless.exact.slave_rows",
            2,
        ),
        (
            &[halves(), friction()],
            "faces.penalty.coulomb.exact.slave_rows",
            2,
        ),
        (&[ellipse()], "faces.penalty.orthotropic.exact", 1),
        (
            &[("/contacts/press/tangent", main)],
            "faces.penalty.frictionless.published_main_part",
            1,
        ),
    ];
    for (changes, expected, pairs) in cases {
        runs_as(&with(blocks(), changes), expected, pairs);
    }
}

#[test]
fn of_a_body_with_itself() {
    let path = concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/examples/scenes/pinched_tube.json"
    );
    let model = build(&scene::load(path).unwrap()).unwrap();
    let own = (model.pairs.iter()).position(|p| p.body_master().is_some_and(|m| m.own.is_some()));
    let own = own.expect("self contact");
    let mut assembler = Assembler::new(&model, &model.dofs).unwrap();
    assert_eq!(assembler.ran(), vec![None; model.pairs.len()]);
    let (mut state, mut r) = (State::new(&model), vec![0.0; 3 * model.nodes.len()]);
    assembler.contact(&mut state, 0.0, &mut r).unwrap();
    for (pair, ran) in assembler.ran().iter().enumerate() {
        assert_eq!(*ran, Some(model.kernel(pair)));
    }
    assert_eq!(
        model.kernel(own).to_string(),
        "own_faces.penalty.frictionless.exact"
    );
}
