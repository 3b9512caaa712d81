//! What small displacements neglect is told, and nothing is told where it is small.
use crate::support::{scene_json, set, solve};
use crate::{large, scene};
use serde_json::{Value, json};

fn warnings(scene: &Value) -> Vec<String> {
    let outcome = solve(scene);
    let about = |w: &&String| w.starts_with("displacements ");
    outcome
        .summary
        .warnings
        .iter()
        .filter(about)
        .cloned()
        .collect()
}

/// A cantilever of length 20 and thickness 1 whose end is prescribed to go down by `w`: its lower edge, or the whole face, which
/// a turn stretches.
fn cantilever(w: f64, steps: u32, end: &str) -> Value {
    scene(
        0.3,
        json!({
            "bodies": {"b": {
                "mesh": {"block": {"min": [0, 0, 0], "max": [20, 2, 1], "elements": [20, 2, 1]}}, "material": "m",
                "sets": {"edge": {"nodes_in_box": {"min": [19.9, -0.1, -0.1], "max": [20.1, 2.1, 0.1]}}}
            }},
            "supports": {
                "clamp": {"on": "b.x_min", "fixed": true},
                "end": {"on": format!("b.{end}"), "displacement": {"z": format!("-{w}*t")}}
            }
        }),
        steps,
    )
}

#[test]
fn rotations_are_told_once() {
    // The slope in the last but half an element is next to 1.5 w / L.
    assert_eq!(warnings(&cantilever(0.02, 1, "edge")), Vec::<String>::new());
    let told = warnings(&cantilever(1.0, 4, "edge"));
    let turn = |w: &&String| {
        w.starts_with("displacements may not be small enough, rotations of body `b`: elements turn by up to 0.0")
    };
    assert_eq!(told.iter().filter(turn).count(), 1, "{told:?}");
    // By its thickness, but free to draw in: nothing stiffens it.
    assert!(
        !told.iter().any(|w| w.contains("forces of the elements")),
        "{told:?}"
    );
    let far = warnings(&cantilever(6.0, 4, "edge"));
    let wrong = |w: &&String| {
        w.starts_with("displacements are not small, rotations of body `b`: elements turn by")
    };
    assert_eq!(far.iter().filter(wrong).count(), 1, "{far:?}");
}

/// What is told of the forces is what large rotations make of them: for the cantilever whose end face keeps its height, and for
/// the one whose edge does, which draws in and is not stiffened.
#[test]
fn the_next_terms_of_the_forces_are_those_of_large_rotations() {
    let forces = "displacements may not be small enough, forces of the elements: strains that are quadratic in the displacements \
                  change them by about ";
    for (w, end, stiffened) in [(1.0, "x_max", true), (1.0, "edge", false)] {
        let small = cantilever(w, 1, end);
        let [a, b] = [solve(&small), solve(&large(&small))];
        let actual = b.at("force.end.z", 1.0) / a.at("force.end.z", 1.0) - 1.0;
        let told = a
            .summary
            .warnings
            .iter()
            .find_map(|t| t.strip_prefix(forces));
        let percent = told.map(|t| {
            t.split(' ')
                .next()
                .unwrap_or("")
                .parse::<f64>()
                .expect("a number")
        });
        println!("{end}: {:.2} %, told {percent:?}", 100.0 * actual);
        match percent {
            // The expansion ends with these terms: right to the square of what it says.
            Some(p) => assert!(stiffened && (0.01 * p - actual).abs() < 2.0 * actual * actual),
            None => assert!(!stiffened && actual.abs() < 0.02),
        }
    }
}

/// A clamped plate bent by its thickness turns by a few hundredths only, and is stiffened by half all the same.
#[test]
fn membrane_forces_are_told_where_rotations_are_small() {
    let plate = |w: f64| {
        let mut scene = scene_json("ball_on_plate.json");
        scene["solution"] = json!({"kinematics": "small", "step": {"initial": 1, "max": 1}});
        scene["bodies"]["plate"]["mesh"]["plate"]["elements"] = json!([8, 8]);
        set(
            &mut scene,
            "/surfaces/ball/motion/translation",
            json!([0, 0, format!("-{w}*t")]),
        );
        warnings(&scene)
    };
    let t = scene_json("ball_on_plate.json")["bodies"]["plate"]["mesh"]["plate"]["thickness"]
        .as_f64()
        .expect("a thickness");
    assert_eq!(plate(0.1 * t), Vec::<String>::new());
    let told = plate(1.0 * t);
    let stiffened = "forces of the elements: strains that are quadratic in the displacements change them by about";
    assert!(told.iter().any(|w| w.contains(stiffened)), "{told:?}");
}

/// A plate pushed along under a wavy tool: the normal at the start is not the one met.
#[test]
fn points_that_slide_to_other_normals_are_told() {
    let block = |slide: f64| {
        let scene = scene(
            0.0,
            json!({
                "bodies": {"b": {
                    "mesh": {"block": {"min": [-2, -2, -2], "max": [2, 2, 0], "elements": [8, 8, 2]}},
                    "material": "m", "element": "h8_displacement"
                }},
                "surfaces": {"ball": {
                    "sphere": {"radius": 10, "center": [0, 0, 10]},
                    "motion": {"translation": [format!("{slide}*t"), 0, "-0.01*t"]}
                }},
                "contacts": {"c": {"slave": "b.z_max", "master": "ball"}},
                "supports": {"floor": {"on": "b.z_min", "fixed": true}}
            }),
            1,
        );
        warnings(&scene)
    };
    assert_eq!(block(0.0), Vec::<String>::new());
    let told = block(1.5);
    let normals = "normals of contact `c`: at points in contact the normal of surface `ball` has turned by up to 0.";
    assert!(told.iter().any(|w| w.contains(normals)), "{told:?}");
    let gaps = "gaps of contact `c`: points in contact are off by up to 0.";
    assert!(told.iter().any(|w| w.contains(gaps)), "{told:?}");
}

/// A load that goes up and comes back to nothing between two kinks is seen where it was large: bent by its thickness at most, the
/// end face kept upright, the cantilever is stiffened.
#[test]
fn what_goes_up_and_down_between_kinks_is_told() {
    let mut scene = cantilever(1.0, 4, "x_max");
    set(
        &mut scene,
        "/supports/end/displacement/z",
        json!("-4*t*(1-t)"),
    );
    let told = warnings(&scene);
    let forces = "displacements may not be small enough, forces of the elements: ";
    assert!(told.iter().any(|w| w.starts_with(forces)), "{told:?}");
}
