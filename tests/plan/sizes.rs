//! What states and assemblers hold: nothing of an effect that is off, and of one that is on what the plan announced.
use crate::scenes::{blocks, coulomb, loaded, model, plate, with};
use covact::assembly::{Assembler, Fault};
use covact::contact::friction::history::PointHistory;
use covact::contact::friction::turning::Turning;
use covact::model::Model;
use covact::model::state::State;
use covact::plan::{Holder, Plan};
use covact::solve::newton::Workspace;
use serde_json::{Value, json};
use std::collections::BTreeMap;

/// Parts that every run has, whatever its effects.
const COMMON: [&str; 6] = [
    "displacements",
    "matrix",
    "pattern",
    "element maps",
    "element work",
    "scatter work",
];

type Parts = BTreeMap<&'static str, usize>;

/// What is held at the start, of the state and of the assembler; compared with what the plan announced, and again after an
/// evaluation at `time`.
fn held(scene: &Value, time: f64) -> (Model, Parts) {
    let model = model(scene);
    let plan = Plan::new(&loaded(scene), &model);
    let mut parts = Parts::new();
    {
        let mut state = State::new(&model);
        let mut assembler = Assembler::new(&model, &model.dofs).expect("a pattern");
        let compare = |exactly: bool, state: &State, assembler: &Assembler| {
            let mut parts = Parts::new();
            let own = state.parts().into_iter().map(|p| (Holder::State, p));
            let all = own.chain((assembler.parts().into_iter()).map(|p| (Holder::Assembler, p)));
            for (holder, (part, bytes)) in all {
                if COMMON.contains(&part) {
                    continue;
                }
                let (announced, grows) = plan.announced(holder, part);
                match grows {
                    true => assert!(bytes >= announced, "{part}: {bytes}, planned {announced}"),
                    false if exactly || announced == 0 => {
                        assert_eq!(bytes, announced, "{part}\n{scene}");
                    }
                    false => {}
                }
                parts.insert(part, bytes);
            }
            parts
        };
        parts.extend(compare(true, &state, &assembler));
        // Everything that is announced is a part of something.
        for held in plan.effects().flat_map(|e| &e.held) {
            if matches!(held.holder, Holder::State | Holder::Assembler) {
                assert!(parts.contains_key(held.part), "nothing holds {}", held.part);
            }
        }
        // Newton's method holds a state more, and vectors.
        let workspace: Parts = Workspace::new(&model).parts().into_iter().collect();
        let n = 3 * model.nodes.len();
        assert_eq!(workspace["vectors"], 6 * 8 * n);
        for (part, bytes) in state.parts() {
            assert_eq!(workspace[part], bytes, "{part}");
        }
        let (mut residual, mut rhs) = (vec![0.0; n], vec![0.0; n]);
        // A driven surface that does not yet touch is a fault.
        if model.small.is_none() && model.driven().next().is_none() {
            (assembler.linearize(&mut state, time, None, &mut residual, &mut rhs))
                .unwrap_or_else(|e| panic!("{e}"));
            compare(false, &state, &assembler);
        }
        if model.small.is_some() {
            let refused = assembler.linearize(&mut state, time, None, &mut residual, &mut rhs);
            assert_eq!(refused.unwrap_err(), Fault::Small);
            let refused = assembler.residual(&mut state, time, &mut residual);
            assert_eq!(refused.unwrap_err(), Fault::Small);
            let refused =
                assembler.linearize_contact(&mut state, time, None, &mut residual, &mut rhs);
            assert_eq!(refused.unwrap_err(), Fault::Small);
        }
    }
    (model, parts)
}

#[test]
fn eight_combinations_hold_what_their_effects_need_and_nothing_else() {
    for (friction, deformable, augmentation) in (0..8).map(|k| (k & 1 != 0, k & 2 != 0, k & 4 != 0))
    {
        let mut changes = Vec::new();
        if friction {
            changes.push(("/contacts/press/friction", coulomb()));
        }
        if augmentation {
            changes.push(("/contacts/press/augmentation", json!({})));
        }
        let base = if deformable { blocks() } else { plate() };
        let (model, parts) = held(&with(base, &changes), 0.5);
        let points = model.contact_points();
        assert!(points > 0);
        let which = format!("friction {friction}, deformable {deformable}, {augmentation}");
        for (part, on) in [
            ("histories", friction || augmentation),
            ("answers", augmentation),
            ("transposed matrix", friction),
            ("rigid maps", !deformable),
            ("rigid points", !deformable),
            ("clearances", !deformable),
            ("masters", deformable),
            ("couplings", deformable),
            ("points on bodies", deformable && !friction),
            ("sliding points", deformable && friction),
            ("links", deformable && friction),
            ("averaged nodes", false),
            ("averaged gaps", false),
            ("rubbing points", false),
            ("segments", false),
            ("driven", false),
            ("driven friction", false),
            ("loads", false),
            ("follower maps", false),
            ("stabilization", false),
            ("linear", false),
            ("inertia", false),
            ("dashpots", false),
        ] {
            assert_eq!(parts[part] > 0, on, "{part}: {} ({which})", parts[part]);
        }
        if friction || augmentation {
            assert_eq!(parts["histories"], points * size_of::<PointHistory>());
        }
    }
}

#[test]
fn further_effects_one_by_one() {
    let gauss = || ("/contacts/press/points", json!({"gauss": 2}));
    let viscous = json!({"viscous": {}});
    let free = json!({"force": {"z": "-10*t"}});
    let motion = json!({"free": free});
    let push = |follower: bool| json!({"p": {"on": "plate.bottom", "pressure": 1e-3, "follower": follower}});
    let dense = |mut scene: Value| {
        for material in scene["materials"].as_object_mut().into_iter().flatten() {
            material.1["st_venant_kirchhoff"]["density"] = json!(1.0);
        }
        with(scene, &[("/solution/dynamics", json!({}))])
    };
    let small = |scene: Value| {
        let small = ("/solution/kinematics", json!("small"));
        with(scene, &[small, ("/contacts/press/friction", coulomb())])
    };
    let cases: [(Value, &[&str]); 18] = [
        (
            with(plate(), &[("/solution/stabilization", viscous)]),
            &["stabilization"],
        ),
        (
            with(
                plate(),
                &[gauss(), ("/contacts/press/gap", json!("averaged"))],
            ),
            &["averaged nodes", "averaged gaps"],
        ),
        (
            with(blocks(), &[("/contacts/press/gap", json!("averaged"))]),
            &["averaged nodes", "averaged gaps"],
        ),
        (
            with(
                plate(),
                &[
                    gauss(),
                    ("/contacts/press/gap", json!("averaged")),
                    ("/contacts/press/friction", coulomb()),
                ],
            ),
            &[
                "averaged nodes",
                "averaged gaps",
                "rubbing points",
                "histories",
            ],
        ),
        (
            with(
                blocks(),
                &[
                    ("/contacts/press/gap", json!("averaged")),
                    ("/contacts/press/friction", coulomb()),
                ],
            ),
            &[
                "averaged nodes",
                "averaged gaps",
                "rubbing points",
                "histories",
            ],
        ),
        (
            with(
                blocks(),
                &[("/contacts/press/points", json!({"segments": 2}))],
            ),
            &["segments"],
        ),
        (
            with(plate(), &[("/surfaces/ball/motion", motion.clone())]),
            &["driven", "loads"],
        ),
        (
            with(
                plate(),
                &[
                    ("/surfaces/ball/motion", motion),
                    ("/contacts/press/friction", coulomb()),
                ],
            ),
            &[
                "driven",
                "driven friction",
                "loads",
                "histories",
                "transposed matrix",
            ],
        ),
        (with(plate(), &[("/loads", push(false))]), &["loads"]),
        (
            with(plate(), &[("/loads", push(true))]),
            &["loads", "follower maps", "transposed matrix"],
        ),
        (
            with(plate(), &[("/solution/kinematics", json!("small"))]),
            &["linear"],
        ),
        (
            small(plate()),
            &["linear", "histories", "transposed matrix"],
        ),
        (
            small(blocks()),
            &["linear", "histories", "transposed matrix"],
        ),
        (dense(plate()), &["inertia"]),
        (dense(blocks()), &["inertia"]),
        (
            with(
                dense(blocks()),
                &[(
                    "/solution/dynamics",
                    json!({"damping": {"viscosity": 0.01}}),
                )],
            ),
            &["inertia", "dashpots"],
        ),
        (
            with(
                blocks(),
                &[
                    ("/contacts/press/points", json!({"segments": 2})),
                    ("/contacts/press/friction", coulomb()),
                    ("/contacts/press/augmentation", json!({})),
                ],
            ),
            &["segments", "histories", "answers", "transposed matrix"],
        ),
        (
            with(
                plate(),
                &[
                    gauss(),
                    ("/contacts/press/gap", json!("averaged")),
                    ("/contacts/press/augmentation", json!({})),
                ],
            ),
            &["averaged nodes", "averaged gaps", "histories", "answers"],
        ),
    ];
    for (scene, on) in &cases {
        let (model, parts) = held(scene, 0.5);
        for part in [
            "stabilization",
            "averaged nodes",
            "averaged gaps",
            "rubbing points",
            "segments",
            "driven",
            "driven friction",
            "loads",
            "follower maps",
            "histories",
            "answers",
            "transposed matrix",
            "linear",
            "inertia",
            "dashpots",
        ] {
            // A follower pressure may keep the symmetry.
            if part == "transposed matrix" {
                assert_eq!(parts[part] > 0, !model.symmetric);
                continue;
            }
            let wanted = on.contains(&part);
            assert_eq!(parts[part] > 0, wanted, "{part}: {}\n{scene}", parts[part]);
        }
    }
    // Elements for small displacements keep nothing, and points have no loops of their own.
    for (scene, on) in cases.iter().filter(|case| case.1.contains(&"linear")) {
        let (model, parts) = held(scene, 0.5);
        for part in [
            "element states",
            "rigid points",
            "rigid maps",
            "points on bodies",
            "sliding points",
            "links",
        ] {
            assert_eq!(parts[part], 0, "{part}");
        }
        let rubs = on.contains(&"histories");
        let slips = if rubs { model.contact_points() } else { 0 };
        assert_eq!(parts["slips"], slips * size_of::<Turning>());
    }
}

#[test]
fn without_contact_nothing_of_it_is_held() {
    let mut scene = plate();
    for key in ["contacts", "surfaces"] {
        scene.as_object_mut().unwrap().remove(key);
    }
    let (_, parts) = held(&scene, 0.5);
    for (part, bytes) in &parts {
        assert_eq!(*bytes > 0, *part == "element states", "{part}: {bytes}");
    }
    let bricks = with(
        scene,
        &[("/bodies/plate/element", json!("h8_displacement"))],
    );
    let (_, parts) = held(&bricks, 0.5);
    assert!(parts.values().all(|bytes| *bytes == 0), "{parts:?}");
}

/// Faces of a CAD file joined along five common edges.
#[test]
fn seams_hold_what_is_announced() {
    let file = concat!(env!("CARGO_MANIFEST_DIR"), "/assets/cad/flanged.igs");
    let scene = json!({
        "covact": 1,
        "units": {"length": "mm"},
        "materials": {"m": {"st_venant_kirchhoff": {"E": 70000, "nu": 0.33}}},
        "bodies": {"panel": {"nurbs": {"file": file, "thickness": 1, "size": 10}, "material": "m"}},
        "supports": {"clamped": {"on": "panel.rim", "clamped": true}}
    });
    let (model, parts) = held(&scene, 0.5);
    assert!(model.bodies[0].block.seams().len() > 20);
    assert!(parts["seams"] > 8 * 96 * 96, "{}", parts["seams"]);
    let (_, parts) = held(&plate(), 0.5);
    assert_eq!(parts["seams"], 0);
}
