//! Scenes that read well and cannot be meant: sets, supports, motions and tools.
use crate::support::*;
use serde_json::json;

#[test]
fn a_set_that_selects_nothing() {
    let sets = json!({ "edge": { "nodes_in_box": { "min": [50, 0, 0], "max": [60, 1, 1] } } });
    plate_refused(
        &[("/bodies/plate/sets", sets)],
        "/bodies/plate/sets/edge",
        &[
            "nodes_in_box",
            "selects nothing",
            "the nearest node is 10.0",
            "help: body `plate` lies in x 0 to 40, y 0 to 40, z -1 to 1",
        ],
    );
}

#[test]
fn a_body_that_can_move() {
    let none = ("/solution/stabilization", json!("none"));
    let held = json!({ "held": { "on": "plate.x_min", "symmetry": "x" } });
    plate_refused(
        &[("/supports", held), none.clone()],
        "/bodies/plate",
        &[
            "body `plate` can move freely along y, along z and about x: no support hinders it",
            "help: add or extend a support",
        ],
    );
    plate_refused(
        &[("/supports", json!({})), none.clone()],
        "/bodies/plate",
        &["along x, along y, along z, about x, about y and about z"],
    );
    // A hinge: turning about it is one motion, seen from the middle of the plate a turn and a translation.
    let hinge = json!({ "hinge": {
        "on": "plate.x_min", "displacement": { "x": 0, "y": 0, "z": 0 }, "mid_surface": true
    } });
    plate_refused(
        &[("/supports", hinge), none],
        "/bodies/plate",
        &["in 1 way(s) that combine motions along z, about y"],
    );
}

/// A pressure that follows faces with a free border has no potential.
#[test]
fn a_symmetric_factorization_of_an_unsymmetric_system() {
    for solver in ["llt", "ldlt"] {
        let load = json!({ "blow": { "on": "plate.bottom", "pressure": "t", "follower": true } });
        // One edge of the plate may move across and up.
        let slides = json!({ "on": "plate.y_max", "symmetry": "x" });
        plate_refused(
            &[
                ("/loads", load),
                ("/supports/clamp_y", slides),
                ("/solution/linear_solver", json!(solver)),
            ],
            "/solution/linear_solver",
            &[
                &format!("`{solver}` is for symmetric systems, and this one is not"),
                "the follower pressure `blow` acts on faces whose border is free to move",
                "help: take `auto` or `lu`",
            ],
        );
    }
}

/// The back stress of a metal recovers.
#[test]
fn a_symmetric_factorization_of_a_metal_whose_yield_surface_moves() {
    let metal = json!({ "armstrong_frederick": {
        "E": 12000, "nu": 0.3, "hardening": { "linear": { "yield_stress": 200 } },
        "back_stress": { "modulus": 1000, "recovery": 20 }
    } });
    plate_refused(
        &[
            ("/materials/steel", metal),
            ("/solution/linear_solver", json!("llt")),
        ],
        "/solution/linear_solver",
        &[
            "`llt` is for symmetric systems, and this one is not",
            "the back stress of the material of body `plate` recovers as it flows",
        ],
    );
}

/// A program that was built without it is asked to factorize on a graphics processor, or by MUMPS.
#[test]
fn a_factorization_that_the_program_does_not_have() {
    let solvers = [
        ("cudss", json!("cudss"), cfg!(feature = "cudss")),
        ("mumps", json!("mumps"), cfg!(feature = "mumps")),
        (
            "mumps",
            json!({ "mumps": { "ordering": "amd" } }),
            cfg!(feature = "mumps"),
        ),
    ];
    for (name, solver, built) in solvers {
        if built {
            continue;
        }
        plate_refused(
            &[("/solution/linear_solver", solver)],
            "/solution/linear_solver",
            &[
                &format!("this program was built without `{name}`"),
                &format!(
                    "help: build it with `cargo install covact --features {name}`, or take `auto`"
                ),
            ],
        );
    }
}

/// Settings of MUMPS that cannot be meant.
#[test]
fn settings_of_a_library() {
    for (settings, pointer, parts) in [
        (
            json!({ "out_of_core": "nowhere" }),
            "out_of_core",
            [
                "there is no folder `./nowhere`",
                "help: paths are relative to the scene file",
            ],
        ),
        (
            json!({ "out_of_core": 3 }),
            "out_of_core",
            ["`true`, `false` or a folder", ""],
        ),
        (
            json!({ "ordering": "metiss" }),
            "ordering",
            ["unknown name `metiss`", "`metis`"],
        ),
    ] {
        plate_refused(
            &[("/solution/linear_solver", json!({ "mumps": settings }))],
            &format!("/solution/linear_solver/mumps/{pointer}"),
            &parts,
        );
    }
}

/// Where there is no cuDSS, or no graphics processor, a run that asks for it says which.
#[cfg(feature = "cudss")]
#[test]
fn a_factorization_without_a_device() {
    let folder = tempfile::tempdir().unwrap();
    let mut scene = plate_scene();
    scene["solution"]["linear_solver"] = json!("cudss");
    std::fs::write(folder.path().join("scene.json"), scene.to_string()).unwrap();
    let run = covact(
        folder.path(),
        &["run", "scene.json", "-o", "out", "--quiet"],
    );
    if run.status.success() {
        println!("skipped: there is a device");
        return;
    }
    assert_eq!(run.status.code(), Some(3), "{}", stderr(&run));
    assert_parts(
        &unfolded(&stderr(&run)),
        &["cuDSS: ", "help: take `auto`, which needs no other library"],
    );
}

#[test]
fn two_supports_that_contradict_each_other() {
    for mid_surface in [false, true] {
        let push = json!({
            "on": "plate.x_max", "displacement": { "z": "-t" }, "mid_surface": mid_surface
        });
        plate_refused(
            &[("/supports/push", push)],
            "/supports/push/on",
            &[
                "supports `clamp_x` and `push` prescribe different displacements along z of the node at (40, 0,",
                "help: take the node out of one of the two sets",
            ],
        );
    }
}

#[test]
fn a_name_that_two_things_share() {
    plate_refused(
        &[(
            "/supports/ball",
            json!({ "on": "plate.x_max", "fixed": true }),
        )],
        "/supports/ball",
        &["the name `ball` is also used in `surfaces`", "help:"],
    );
    let sets = json!({ "top": { "nodes_near_point": { "point": [0, 0, 1], "tolerance": 1 } } });
    plate_refused(
        &[("/bodies/plate/sets", sets)],
        "/bodies/plate/sets/top",
        &[
            "the plate has a set `top` of its own",
            "choose another name",
        ],
    );
    // Two bodies of one name are a key given twice.
    let text = serde_json::to_string(&plate_scene()).unwrap();
    let body = serde_json::to_string(&plate_scene()["bodies"]["plate"]).unwrap();
    let twice = text.replace("\"bodies\":{", &format!("\"bodies\":{{\"plate\":{body},"));
    let folder = tempfile::tempdir().unwrap();
    assert_parts(
        &refused_in(folder.path(), twice.as_bytes()),
        &["the key `plate` is given twice", "help: the first one is"],
    );
}

#[test]
fn numbers_that_cannot_be_meant() {
    let law = "/materials/steel/st_venant_kirchhoff";
    let plate = "/bodies/plate/mesh/plate";
    let (nu, e) = (format!("{law}/nu"), format!("{law}/E"));
    let thickness = format!("{plate}/thickness");
    for (pointer, value, message, help) in [
        (&nu, json!(-1.5), "Poisson's ratio `nu` is -1.5", "-1 < nu"),
        (&nu, json!(0.5), "Poisson's ratio `nu` is 0.5", "0.499"),
        (&e, json!(0), "Young's modulus `E` is 0", "must be positive"),
        (
            &thickness,
            json!(-1),
            "the thickness is -1",
            "must be positive",
        ),
        (
            &"/surfaces/ball/sphere/radius".to_owned(),
            json!(-2.5),
            "the radius is -2.5",
            "must be positive",
        ),
        (
            &"/solution/end_time".to_owned(),
            json!(0),
            "the end time is 0",
            "must be positive",
        ),
    ] {
        plate_refused(&[(pointer, value)], pointer, &[message, "help: ", help]);
    }
    plate_refused(
        &[("/contacts/press/penalty", json!({ "value": -1 }))],
        "/contacts/press/penalty/value",
        &["the penalty is -1"],
    );
}

#[test]
fn a_value_that_is_undefined_during_the_run() {
    plate_refused(
        &[(
            "/surfaces/ball/motion/translation",
            json!([0, 0, "sqrt(0.7-t)-sqrt(0.7)"]),
        )],
        "/surfaces/ball/motion",
        &["`sqrt(0.7-t)-sqrt(0.7)` is NaN at t = 0.7", "help:"],
    );
    plate_refused(
        &[(
            "/loads",
            json!({ "p": { "on": "plate.top", "pressure": "sqrt(x-5)" } }),
        )],
        "/loads/p",
        &["`sqrt(x-5)` is NaN at t = 0, x = "],
    );
    let supports = json!({
        "pull": { "on": "plate.x_max", "displacement": { "x": "1/(1-2*t)", "y": 0, "z": 0 } }
    });
    plate_refused(
        &[("/supports", supports)],
        "/supports/pull/displacement",
        &["`1/(1-2*t)` is inf at t = 0.5"],
    );
}

#[test]
fn a_tool_that_starts_deep_inside() {
    plate_refused(
        &[
            ("/surfaces/ball/sphere/center", json!([20, 20, 20])),
            ("/surfaces/ball/side", json!("as_given")),
        ],
        "/surfaces/ball",
        &[
            // Its lowest point is at z = -5, the slave face at z = 1; elements are 10 wide.
            "surface `ball` starts 6 deep inside body `plate` (contact `press`), more than half an element, 5",
            "help: move it back with `placement`, or choose the other `side`",
        ],
    );
}

#[test]
fn a_slave_on_both_sides() {
    plate_refused(
        &[("/surfaces/ball/sphere/center", json!([20, 20, 20]))],
        "/surfaces/ball",
        &[
            "the outside of surface `ball` is not clear: the slave starts on both sides of the sphere",
            "help: move the surface clear of the body with `placement`, or say `side`",
        ],
    );
    // Of a CAD file the entity is named. The lowest face of the punch is at z = -0.5, the slave at z = 1.
    let folder = tempfile::tempdir().unwrap();
    let punch = concat!(env!("CARGO_MANIFEST_DIR"), "/assets/punch.igs");
    std::fs::copy(punch, folder.path().join("punch.igs")).unwrap();
    let surface = json!({
        "cad": { "file": "punch.igs" }, "placement": { "translation": [0, 0, -0.5] }
    });
    plate_refused_in(
        folder.path(),
        &[("/surfaces/ball", surface)],
        "/surfaces/ball",
        &[
            "the slave starts on both sides of entity ",
            "which belongs to a part of 45 patches (entity 1, entity 3,",
        ],
    );
}

/// `covact check` of a changed plate succeeds with these warnings.
fn warned(changes: &[(&str, serde_json::Value)], parts: &[&str]) {
    let folder = tempfile::tempdir().unwrap();
    write_plate(folder.path(), changes);
    let output = covact(folder.path(), &["check", "scene.json"]);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    let count = parts.iter().filter(|p| p.starts_with("warning:")).count();
    assert_parts(&stderr(&output), parts);
    assert_parts(&stdout(&output), &[&format!("{count} warning(s)")]);
}

#[test]
fn slave_points_too_coarse_for_the_tool() {
    warned(
        &[(
            "/surfaces/ball/sphere",
            json!({ "radius": 3, "center": [0, 0, 4] }),
        )],
        &[
            // 25 nodes share 1600 mm^2.
            "warning: contact `press`: its slave points are 8 apart, too coarse for the smallest convex radius 3 of \
             surface `ball`",
            "at most 1.5 apart",
        ],
    );
}

/// At two thirds of the radius it sinks in by a twentieth of that, which is measured in the run: a note.
#[test]
fn slave_points_somewhat_coarse_for_the_tool() {
    let folder = tempfile::tempdir().unwrap();
    let ball = json!({ "radius": 12, "center": [0, 0, 13] });
    write_plate(folder.path(), &[("/surfaces/ball/sphere", ball)]);
    let output = covact(folder.path(), &["check", "scene.json"]);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    assert!(!stderr(&output).contains("warning"), "{}", stderr(&output));
    let said: Vec<String> = stdout(&output)
        .split_whitespace()
        .map(str::to_owned)
        .collect();
    let told = "its slave points are 8 apart, more than half of the smallest convex radius 12";
    assert!(said.join(" ").contains(told), "{}", stdout(&output));
}

/// A flat patch above the plate, and far from it a half cylinder, nearly, of a small radius.
fn flat_and_far() -> String {
    let patch = |entity: u32, degree: u32, points: Vec<[f64; 4]>| {
        let knots: Vec<f64> = [
            vec![0.0; degree as usize + 1],
            vec![1.0; degree as usize + 1],
        ]
        .concat();
        json!({ "entity": entity, "degree": [degree, 1], "knots": [knots, [0, 0, 1, 1]], "points": points })
    };
    let flat = [-60.0, 60.0].map(|y| [[60.0, y, 0.0, 1.0], [-60.0, y, 0.0, 1.0]]);
    let bent = [0.0, 100.0].map(|y| {
        [
            [903.0, y, 0.0, 1.0],
            [900.0, y, -6.0, 1.0],
            [897.0, y, 0.0, 1.0],
        ]
    });
    let patches = [patch(1, 1, flat.concat()), patch(2, 2, bent.concat())];
    json!({ "covact_geometry": 1, "unit": "mm", "resolution": null, "patches": patches })
        .to_string()
}

#[test]
fn radii_that_the_slave_cannot_reach_do_not_count() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("two.json"), flat_and_far()).unwrap();
    let coarse = |translation: serde_json::Value| {
        let surface = json!({
            "cad": "two.json", "side": "as_given", "placement": { "translation": [0, 0, 1.5] },
            "motion": { "translation": translation },
        });
        write_plate(folder.path(), &[("/surfaces/ball", surface)]);
        let output = covact(folder.path(), &["check", "scene.json"]);
        assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
        stderr(&output).contains("too coarse for the smallest convex radius")
    };
    assert!(!coarse(json!([0, 0, "-t"])));
    // On its way it passes the plate.
    assert!(coarse(json!(["-1800*t", 0, 0])));
    assert!(coarse(
        json!([{ "table": [[0, 0], [0.4, -880], [0.5, 0]] }, 0, "-t"])
    ));
}

#[test]
fn tools_in_the_wrong_place() {
    let plane = |z: f64| json!({ "plane": { "center": [20, 20, z], "size": [60, 60] } });
    warned(
        &[("/surfaces/ball", plane(-3.0))],
        &["warning: contact `press`: body `plate` lies between its slave faces and surface `ball`"],
    );
    let mut above = plane(30.0);
    above["side"] = json!("as_given");
    warned(
        &[("/surfaces/ball", above)],
        &[
            "warning: contact `press`: body `plate` lies between",
            "warning: contact `press`: 25 point(s) start behind surface `ball`, deeper than its `depth` 8.48528",
            "choose the other `side`",
        ],
    );
    warned(
        &[("/surfaces/ball/sphere/center", json!([0, 0, 25.99]))],
        &["warning: contact `press` starts with an overclosure of 0.01 at 1 point(s)"],
    );
}

#[test]
fn a_face_on_the_surface_finds_its_side() {
    // Every slave point lies on the plane; the elements below tell that the plate is under it.
    let folder = tempfile::tempdir().unwrap();
    let plane = json!({ "plane": { "center": [20, 20, 1], "size": [60, 60] } });
    write_plate(folder.path(), &[("/surfaces/ball", plane)]);
    let output = covact(folder.path(), &["check", "scene.json"]);
    assert_eq!(stderr(&output), "");
    assert_parts(
        &unfolded(&stdout(&output)),
        &[
            "where the slave starts (normals of 1 of 1 patch(es) turned round)",
            "no warnings",
        ],
    );
}

#[test]
fn a_surface_without_a_contact() {
    for side in ["auto", "as_given"] {
        let floor = json!({ "plane": { "center": [0, 0, -5], "size": [100, 100] }, "side": side });
        warned(
            &[("/surfaces/floor", floor)],
            &["warning: surface `floor` takes part in no contact"],
        );
    }
}
