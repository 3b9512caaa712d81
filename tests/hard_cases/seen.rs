//! What slave points see of their masters by default: scenes that give no `points` and no `passes`, against the same with the
//! tool over a node, with closed forms, and with what is asked for.
use crate::support::{Outcome, solve, stl_box};
use covact::output::RunStatus;
use serde_json::{Value, json};

fn done(scene: &Value) -> Outcome {
    let outcome = solve(scene);
    let s = &outcome.summary;
    println!(
        "{} iterations in {} steps, warnings {:?}",
        s.newton_iterations, s.steps, s.warnings
    );
    assert_eq!(s.status, RunStatus::Done, "{:?}", s.reason);
    outcome
}

/// A roller of radius 5 pressed by .5 into a clamped strip of elements of 2, `beside` a node.
fn roller(beside: f64) -> Value {
    json!({
        "covact": 1,
        "materials": { "steel": { "st_venant_kirchhoff": { "E": 210000, "nu": 0 } } },
        "bodies": { "strip": {
            "mesh": { "plate": { "size": [80, 4], "thickness": 2, "elements": [40, 1], "origin": [-40, -2, 0] } },
            "material": "steel"
        } },
        "surfaces": { "roller": {
            "cylinder": { "radius": 5, "length": 20, "center": [beside, 0, 6], "axis": [0, 1, 0] },
            "motion": { "translation": [0, 0, "-0.5*t"] }
        } },
        "contacts": { "c": { "slave": "strip.top", "master": "roller" } },
        "supports": { "ends": { "on": ["strip.x_min", "strip.x_max"], "fixed": true } },
        "output": { "every": 0 }
    })
}

/// Forces do not depend on where a roller stands between two nodes, and without friction none acts along the strip: between nodes
/// alone a fifth of the force was missing, and an eighth of it pushed to a side.
#[test]
fn a_round_tool_between_two_nodes_is_seen() {
    let over = done(&roller(0.0)).at("force.roller.z", 1.0);
    let outcome = done(&roller(1.0));
    let [z, x] = ["force.roller.z", "force.roller.x"].map(|c| outcome.at(c, 1.0));
    println!("{over}, beside {z} and {x}");
    assert!(over < -50.0 && (z / over - 1.0).abs() < 0.02, "{over} {z}");
    assert!((x / z).abs() < 0.01, "{x}");
    assert!(outcome.summary.warnings.is_empty());
    // Who asks for nodes has them, and is told.
    let mut asked = roller(1.0);
    asked["contacts"]["c"]["points"] = json!("nodes");
    let outcome = done(&asked);
    let z = outcome.at("force.roller.z", 1.0);
    assert!((z / over - 1.0).abs() > 0.1, "{z}");
    let told = |w: &String| w.contains("sinks") && w.contains("between its slave points");
    assert_eq!(
        outcome.summary.warnings.iter().filter(|w| told(w)).count(),
        1
    );
}

/// Two blocks of 10 on each other, `lower` and `upper` of so many elements along each axis, shortened by `by`.
fn blocks(lower: [u32; 3], upper: [u32; 3], (material, by): (Value, f64)) -> Value {
    json!({
        "covact": 1,
        "materials": { "m": material },
        "bodies": {
            "lower": { "mesh": { "block": { "min": [0, 0, 0], "max": [10, 10, 10], "elements": lower } }, "material": "m" },
            "upper": { "mesh": { "block": { "min": [0, 0, 10], "max": [10, 10, 20], "elements": upper } }, "material": "m" }
        },
        "contacts": { "joint": { "slave": "upper.bottom", "master": "lower.top" } },
        "supports": {
            "bottom": { "on": "lower.bottom", "symmetry": "z" },
            "top": { "on": "upper.top", "displacement": { "z": format!("-{by}*t") } },
            "x": { "on": ["lower.x_min", "upper.x_min"], "symmetry": "x" },
            "y": { "on": ["lower.y_min", "upper.y_min"], "symmetry": "y" }
        },
        "output": { "every": 0 }
    })
}

/// Blocks whose meshes do not match are compressed evenly: E A times the strain, less what the penalty lets sink in (told). The
/// coarser side is the slave; its nodes alone would find 56 and 75 % of the force.
#[test]
fn a_coarse_slave_sees_a_finer_master() {
    let steel = json!({ "st_venant_kirchhoff": { "E": 1000, "nu": 0.3 } });
    for (lower, upper) in [
        ([9, 9, 5], [2, 2, 2]),
        ([8, 8, 4], [4, 4, 4]),
        ([5, 5, 5], [4, 3, 4]),
    ] {
        let outcome = done(&blocks(lower, upper, (steel.clone(), 0.02)));
        let force = outcome.at("force.bottom.z", 1.0);
        println!("{upper:?} on {lower:?}: {force}");
        assert!(
            (force / 100.0 - 1.0).abs() < 0.012,
            "{upper:?} on {lower:?}: {force}"
        );
    }
    // Where nodes meet they see all there is.
    let matching = blocks([4, 4, 4], [4, 4, 4], (steel, 0.02));
    let scene = covact::scene::parse(&matching.to_string(), "blocks").expect("a scene");
    let model = covact::model::build::build(&scene).expect("a model");
    assert_eq!(model.pairs[0].points.len(), 25);
}

/// Soft blocks of other meshes compressed by a fifth: at the nodes of the coarser one the run did not end in 9,800 iterations.
#[test]
fn soft_blocks_of_other_meshes_end() {
    let soft = json!({ "neo_hooke": { "E": 100, "nu": 0.3 } });
    let outcome = done(&blocks([5, 5, 5], [4, 3, 4], (soft.clone(), 4.0)));
    let force = outcome.at("force.bottom.z", 1.0);
    let same = done(&blocks([4, 4, 4], [4, 4, 4], (soft, 4.0))).at("force.bottom.z", 1.0);
    println!("{force} {same}");
    assert!(same > 100.0 && (force / same - 1.0).abs() < 0.01);
    assert!(outcome.summary.newton_iterations <= 120);
}

/// A plate laid on two bars and pressed by a third, all of them bodies whose edges lie between the nodes of the plate: the force is that
/// of edges asked for as slaves.
#[test]
fn edges_of_bodies_between_nodes_are_seen() {
    let bar = |x: [f64; 2], z: [f64; 2], elements: [u32; 3]| json!({ "mesh": { "block": { "min": [x[0], -4, z[0]], "max": [x[1], 4, z[1]], "elements": elements } }, "material": "steel" });
    let mut scene = json!({
        "covact": 1,
        "materials": { "steel": { "st_venant_kirchhoff": { "E": 210000, "nu": 0 } } },
        "bodies": {
            "plate": { "mesh": { "plate": { "size": [100, 8], "thickness": 2, "elements": [50, 2], "origin": [-50, -4, 0] } },
                       "material": "steel",
                       "sets": { "middle": { "nodes_near_plane": { "point": [0, 0, 0], "normal": [1, 0, 0], "tolerance": 0.01 } } } },
            "left": bar([-45.0, -35.0], [-11.0, -1.0], [5, 2, 4]),
            "right": bar([35.0, 45.0], [-11.0, -1.0], [5, 2, 4]),
            "punch": bar([-3.0, 3.0], [1.0, 9.0], [3, 2, 3])
        },
        "contacts": {
            "l": { "slave": "plate.bottom", "master": "left.top" },
            "r": { "slave": "plate.bottom", "master": "right.top" },
            "p": { "slave": "plate.top", "master": "punch.bottom" }
        },
        "supports": {
            "feet": { "on": ["left.bottom", "right.bottom"], "fixed": true },
            "push": { "on": "punch.top", "displacement": { "x": 0, "y": 0, "z": "-1*t" } },
            "x": { "on": "plate.middle", "symmetry": "x" }
        },
        "output": { "every": 0 }
    });
    let found = done(&scene).at("force.push.z", 1.0);
    for contact in ["l", "r", "p"] {
        scene["contacts"][contact]["passes"] = json!("edges");
    }
    let asked = done(&scene).at("force.push.z", 1.0);
    println!("{found} {asked}");
    assert!(asked < -100.0 && (found / asked - 1.0).abs() < 0.01);
}

/// A block is pressed on a floor by 400 and pushed to and fro by 5 and 10: coefficient times force on a way of 30. The traction turns
/// within the first of the steps after each turn, which a trapezoid between the ends of the step does not see.
#[test]
fn friction_that_turns_keeps_the_energies_in_balance() {
    let way = json!({ "table": [[0, 0], [1, 0], [2, 5], [3, -5], [4, 5], [5, 0]] });
    let force = json!({ "table": [[0, 0], [1, -400], [5, -400]] });
    let outcome = done(&json!({
        "covact": 1,
        "materials": { "steel": { "st_venant_kirchhoff": { "E": 210000, "nu": 0.3 } } },
        "bodies": { "block": {
            "mesh": { "block": { "min": [0, 0, 0], "max": [20, 10, 5], "elements": [6, 3, 2] } }, "material": "steel"
        } },
        "surfaces": { "floor": { "plane": { "size": [100, 60], "center": [10, 5, 0] } } },
        "contacts": { "c": { "slave": "block.bottom", "master": "floor", "friction": 0.25 } },
        "supports": { "top": { "on": "block.top", "displacement": { "x": way, "y": 0 } } },
        "loads": { "weight": { "on": "block.top", "force": [0, 0, force] } },
        "solution": { "end_time": 5 },
        "output": { "every": 0 }
    }));
    let [taken, put_in, left] =
        ["energy.dissipated", "energy.external", "energy.imbalance"].map(|c| outcome.at(c, 5.0));
    println!("{taken} {put_in} {left}");
    assert!((taken / 3000.0 - 1.0).abs() < 0.005);
    assert!((put_in / 3000.0 - 1.0).abs() < 0.005);
    assert!(left.abs() < 0.005 * 3000.0);
    assert!(outcome.summary.warnings.is_empty());
}

/// A strip that bends over an edge of a box, which lies exactly under a row of its nodes or between two of them. A node over an edge
/// that slips down beside it was held along the strip: 1,233 N to a side in place of 100 upwards.
#[test]
fn an_edge_under_a_row_of_nodes_is_seen() {
    let folder = tempfile::tempdir().unwrap();
    let pulled = |to: f64| {
        let name = format!("box_{to}.stl");
        std::fs::write(
            folder.path().join(&name),
            stl_box([-5.0, -5.0, -20.0], [to, 15.0, 0.0]),
        )
        .unwrap();
        let scene = json!({
            "covact": 1,
            "materials": { "m": { "st_venant_kirchhoff": { "E": 210000, "nu": 0.3 } } },
            "bodies": { "strip": {
                "mesh": { "plate": { "size": [40, 10], "thickness": 0.5, "elements": [40, 2], "origin": [0, 0, 0.25] } },
                "material": "m"
            } },
            "surfaces": { "box": { "cad": folder.path().join(&name) } },
            "contacts": { "c": { "slave": "strip.bottom", "master": "box" } },
            "supports": {
                "x": { "on": "strip.x_min", "fixed": true },
                "y": { "on": "strip.y_min", "symmetry": "y" }
            },
            "loads": { "pull": { "on": "strip.x_max", "force": [0, 0, "-40*t"] } },
            "output": { "every": 0 }
        });
        let outcome = done(&scene);
        let force = ["force.box.x", "force.box.z"].map(|c| outcome.at(c, 1.0));
        (force, outcome.summary.given_up.runs)
    };
    let ([x, z], repeated) = pulled(20.0);
    let ([beside_x, beside], _) = pulled(20.25);
    println!("{x} {z}, beside {beside_x} {beside}");
    assert!(beside > 80.0 && beside_x.abs() < 0.3 * beside);
    assert!(
        (z / beside - 1.0).abs() < 0.05 && x.abs() < 0.3 * z,
        "{x} {z}"
    );
    assert_eq!(repeated, 1);
}

/// Two sheets that are clamped flush on each other and bent together share the force of the roller: by symmetry each takes half of it.
/// Their meshes do not fit each other where they bend; under a stiff penalty they press on each other with their corners, nine times as
/// hard. What the run chooses stays near the half, and tells.
#[test]
fn faces_that_do_not_fit_do_not_jam() {
    let plate = |x: usize, z: f64| json!({ "plate": { "size": [60, 10], "thickness": 1, "elements": [x, 2], "origin": [0, 0, z] } });
    let scene = json!({
        "covact": 1,
        "materials": { "m": { "st_venant_kirchhoff": { "E": 210000, "nu": 0.3 } } },
        "bodies": {
            "lower": { "mesh": plate(30, 0.5), "material": "m" },
            "upper": { "mesh": plate(24, 1.5), "material": "m" }
        },
        "surfaces": { "roller": {
            "cylinder": { "radius": 5, "length": 30, "center": [50, 5, 7.05], "axis": [0, 1, 0] },
            "motion": { "translation": [0, 0, "-20*t"] }
        } },
        "contacts": {
            "between": { "slave": "upper.bottom", "master": "lower.top", "friction": 0.2 },
            "press": { "slave": "upper.top", "master": "roller", "friction": 0.2 }
        },
        "supports": {
            "of_lower": { "on": "lower.x_min", "fixed": true },
            "of_upper": { "on": "upper.x_min", "fixed": true }
        },
        "output": { "every": 0 }
    });
    let outcome = done(&scene);
    let [roller, lower] = ["force.roller.z", "force.of_lower.z"].map(|c| outcome.at(c, 1.0));
    let share = lower / -roller;
    println!("{roller} {lower}: {share}");
    assert!(roller < -50.0 && (0.45..0.75).contains(&share), "{share}");
    let told = |w: &&String| w.contains("its force follows its penalty");
    assert_eq!(outcome.summary.warnings.iter().filter(told).count(), 1);
}

/// Three leaves that are clamped flush on each other at one end and pressed down: each takes a third of the pressure's force of 2, and
/// their meshes of 40, 30 and 50 elements do not fit each other where they bend. With corners that press, the clamps pull against
/// each other with 8 and 10.
#[test]
fn a_stack_of_leaves_shares_its_load() {
    let leaf = |x: usize, z: f64| {
        let plate =
            json!({"size": [100, 10], "thickness": 1, "elements": [x, 2], "origin": [0, 0, z]});
        json!({"mesh": {"plate": plate}, "material": "m"})
    };
    let scene = json!({
        "covact": 1,
        "materials": {"m": {"st_venant_kirchhoff": {"E": 200000, "nu": 0}}},
        "bodies": {"a": leaf(40, 0.0), "b": leaf(30, 1.0), "c": leaf(50, 2.0)},
        "contacts": {
            "ab": {"slave": "b.bottom", "master": "a.top"},
            "bc": {"slave": "c.bottom", "master": "b.top"}
        },
        "supports": {
            "of_a": {"on": "a.x_min", "fixed": true},
            "of_b": {"on": "b.x_min", "fixed": true},
            "of_c": {"on": "c.x_min", "fixed": true}
        },
        "loads": {"p": {"on": "c.top", "pressure": "0.002*t"}},
        "output": {"every": 0}
    });
    let outcome = done(&scene);
    let forces = ["a", "b", "c"].map(|leaf| outcome.at(&format!("force.of_{leaf}.z"), 1.0));
    println!("{forces:?}");
    assert!((forces.iter().sum::<f64>() - 2.0).abs() < 1e-2);
    assert!(forces.iter().all(|f| (0.3..1.0).contains(f)), "{forces:?}");
    let told = |w: &&String| w.contains("its force follows its penalty");
    assert!(outcome.summary.warnings.iter().any(|w| told(&w)));
}
