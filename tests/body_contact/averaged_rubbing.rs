//! Runs with friction under averaged gaps: closed forms, and the same with gaps of points.
use crate::blocks::done;
use crate::friction::{last, layers, stick, stick_as, turn};
use crate::self_contact::{R, T, pinched};
use crate::shells::{arch_on_plate, balance};
use crate::support::Outcome;
use covact::model::build::build;
use covact::scene;
use serde_json::{Value, json};

const MU: f64 = 0.3;
const E: f64 = 1e4;
const EPS: f64 = 1e5;
const SINK: f64 = 0.002;

fn averaged(mut scene: Value) -> Value {
    for contact in scene["contacts"]
        .as_object_mut()
        .expect("contacts")
        .values_mut()
    {
        contact["gap"] = json!("averaged");
        contact["points"] = json!({"gauss": 3});
    }
    scene
}

/// The upper one of two layers on a rigid plane.
fn on_plane(way: &str) -> Value {
    let mut scene = averaged(layers([3, 2], [1, 1], "upper.bottom", SINK, way));
    for (of, gone) in [
        ("bodies", "lower"),
        ("supports", "ground"),
        ("supports", "face"),
    ] {
        scene[of].as_object_mut().expect("an object").remove(gone);
    }
    scene["surfaces"] = json!({"plane": {"plane": {"size": [8, 8]}, "side": {"point": [0, 0, 5]}}});
    scene["contacts"]["rub"]["master"] = json!("plane");
    scene
}

/// Strain `gamma` of a layer of height 1/2 in shear over its tangential penalty, where its top has moved by `d`:
/// `E gamma (1 + gamma^2) / 2 = eps_T (d - gamma / 2)` (St. Venant-Kirchhoff, nu = 0, heights kept), and the traction.
fn sheared(d: f64) -> [f64; 2] {
    let mut gamma = 0.0;
    for _ in 0..50 {
        let f = 0.5 * E * gamma * (1.0 + gamma * gamma) - EPS * (d - 0.5 * gamma);
        gamma -= f / (0.5 * E * (1.0 + 3.0 * gamma * gamma) + 0.5 * EPS);
    }
    [gamma, EPS * (d - 0.5 * gamma)]
}

/// A block on a rigid plane sticks with the stiffness of its shear and of the tangential penalty in series, and slides under `H = mu V`
/// (Coulomb's law) from where that is reached.
#[test]
fn a_block_on_a_plane_sticks_in_series_and_slides_under_mu_times_its_load() {
    let way = |t: f64| 0.02 * (t - 0.25).max(0.0);
    let mut scene = on_plane("0.02*max(0, t-0.25)");
    scene["output"] = json!({"every": 1, "contact_points": true});
    let outcome = done(&scene);
    let [h, v] = ["x", "z"].map(|c| outcome.column(&format!("force.plane.{c}")));
    let (time, slip) = (outcome.column("time"), outcome.column("points.slip"));
    let (mut stuck, mut slid) = (0, 0);
    for i in 0..time.len() {
        let [gamma, t] = sheared(way(time[i]));
        assert!((v[i].abs() / (EPS * SINK * time[i].min(0.25) * 4.0) - 1.0).abs() < 1e-9);
        println!(
            "{} H {} V {} sticking {t}, {} slide",
            time[i], h[i], v[i], slip[i]
        );
        if t < 0.9 * MU * v[i].abs() && time[i] > 0.3 {
            // Free ends, which the tractions of a large shear bend, add terms of the order of its square.
            assert!((h[i].abs() / t - 1.0).abs() < gamma * gamma, "{} {t}", h[i]);
            assert_eq!(slip[i], 0.0);
            stuck += 1;
        }
        if t > 1.1 * MU * v[i].abs() {
            assert!((h[i].abs() - MU * v[i].abs()).abs() < 1e-9 * v[i].abs());
            assert_eq!(last(&outcome, "points.stick"), 0.0);
            slid += 1;
        }
    }
    assert!(stuck >= 2 && slid >= 2, "{stuck} {slid}");
    // The same at nodes and points of the last step.
    let file = outcome.body("upper", outcome.summary.steps);
    let (status, t) = (
        file.field("contact_status"),
        file.field("friction_traction"),
    );
    let rubbing: Vec<usize> = (0..status.len()).filter(|i| status[*i] == 3.0).collect();
    assert_eq!(rubbing.len(), 12);
    for i in rubbing {
        assert!(
            (t[3 * i] + MU * EPS * SINK).abs() < 1e-9 * EPS * SINK,
            "{}",
            t[3 * i]
        );
    }
    // What is dissipated is the work along what the top goes on from where the block begins to slide.
    let limit = MU * EPS * SINK;
    let mut begins = 0.0;
    while sheared(begins)[1] < limit {
        begins += 1e-6;
    }
    let (expected, ours) = (
        limit * (way(1.0) - begins),
        last(&outcome, "energy.dissipated"),
    );
    println!("dissipated {ours}, {expected}");
    assert!((ours / expected - 1.0).abs() < 1e-3);
    assert!(last(&outcome, "energy.imbalance").abs() < 1e-3 * expected);
}

/// `H = mu V` between bodies, over many facets and past their borders, whichever side is the slave; both sides feel the same.
#[test]
fn a_block_that_slides_is_held_back_by_mu_times_its_load() {
    for slave in ["upper.bottom", "lower.top"] {
        let scene = averaged(layers([2, 2], [7, 3], slave, SINK, "1.3*max(0, t-0.25)"));
        let outcome = done(&scene);
        let slide = |side: &str, c: &str| outcome.column(&format!("{side}.force.rub.{c}"));
        let (h, v) = (slide("slave", "x"), slide("slave", "z"));
        let (hm, vm) = (slide("master", "x"), slide("master", "z"));
        let time = outcome.column("time");
        let mut sliding = 0;
        for i in 0..time.len() {
            assert!(v[i].abs() > 1.0);
            assert!((v[i] + vm[i]).abs() < 1e-12 * v[i].abs());
            if time[i] > 0.4 {
                println!("{slave} {} {} {}", time[i], h[i], v[i]);
                assert!((h[i].abs() - MU * v[i].abs()).abs() < 1e-9 * v[i].abs());
                assert!((h[i] + hm[i]).abs() < 1e-9 * v[i].abs() && h[i] != 0.0);
                sliding += 1;
            }
        }
        assert!(sliding >= 4 && last(&outcome, "points.slip") > 30.0);
        assert_eq!(last(&outcome, "points.stick"), 0.0);
        let [_, force, moment] = balance(&outcome, "rub");
        println!("{slave}: off by {force:e} and {moment:e}");
        assert!(force < 1e-12 * v[0].abs() && moment < 1e-12 * v[0].abs());
    }
}

/// The patch test of sticking ([`stick`]): what slip is asked of is points, so that averaged gaps are as far off as those of the same
/// points, and as near with 10 x 10 of them.
#[test]
fn meshes_that_do_not_match_stick_in_uniform_shear() {
    let found = [3, 5, 10].map(|n| {
        let points = json!({"gauss": n});
        let own = stick(points.clone(), false);
        [stick_as(points, ("gap", json!("averaged"))), own]
    });
    println!("averaged gaps, those of points: {found:?}");
    for [ours, own] in found {
        assert!((ours / own - 1.0).abs() < 0.2, "{ours:e} {own:e}");
    }
    assert!(found[2][0] < 0.1 * found[0][0] && found[2][0] < 1e-3);
}

#[test]
fn turning_a_sticking_pair_changes_nothing_in_its_traction() {
    turn(json!({"gauss": 3}), 0, "averaged");
}

/// An arch that comes down on a plate and is shoved along it: both sides feel the same, in force and in moment.
#[test]
fn both_sides_feel_the_same() {
    for (points, surface) in [(3, "faces"), (3, "smooth"), (2, "faces")] {
        let mut scene = averaged(arch_on_plate(2.0, 5, json!({"gauss": points})));
        let press = &mut scene["contacts"]["press"];
        press["points"] = json!({"gauss": points});
        press["master_surface"] = json!(surface);
        press["friction"] = json!({"coulomb": {"mu": MU}});
        let outcome = done(&scene);
        let [force, sum, moment] = balance(&outcome, "press");
        let rubbed = outcome.column("slave.force.press.x");
        let dissipated = last(&outcome, "energy.dissipated");
        println!(
            "{points} {surface}: force {force:.4}, off by {sum:.1e}, {moment:.1e}; {rubbed:?} {dissipated}"
        );
        assert!(force > 1.0 && dissipated > 1e-3);
        assert!(sum < 1e-12 * force && moment < 1e-11 * force);
    }
}

/// The walls of a tube that is pinched and sheared, slave and master at once: both sides feel the same.
#[test]
fn a_body_rubs_on_itself() {
    let mut scene = averaged(pinched(2.0 * R - T + 0.6, json!({"gauss": 3})));
    scene["contacts"]["walls"]["friction"] = json!({"coulomb": {"mu": MU}});
    let outcome = done(&scene);
    let [force, sum] = ["force.push.z", "imbalance.force.walls"].map(|c| outcome.at(c, 1.0));
    let points = ["points.stick", "points.slip"].map(|c| last(&outcome, c));
    println!("force {force}, off by {sum:.1e}, {points:?} stick and slide");
    assert!(points[0] + points[1] > 0.0 && force < -0.01 && sum < 1e-12);
}

#[test]
fn any_number_of_threads_gives_the_same_bits() {
    let history = |threads: u32| {
        let mut scene = averaged(arch_on_plate(2.0, 3, json!({"gauss": 3})));
        scene["contacts"]["press"]["friction"] = json!({"coulomb": {"mu": MU}});
        scene["solution"]["threads"] = json!(threads);
        let outcome = done(&scene);
        std::fs::read(outcome.folder.path().join("history.csv")).expect("history")
    };
    assert!(history(1) == history(2));
}

/// Multipliers of nodes and friction of points are refused together, by the check and by whoever builds without it.
#[test]
fn multipliers_do_not_go_with_it() {
    let mut scene = on_plane("0.02*max(0, t-0.25)");
    let loaded = |scene: &Value| scene::parse(&scene.to_string(), "scene.json").expect("a scene");
    assert_eq!(scene::check(&loaded(&scene)), vec![]);
    scene["contacts"]["rub"]["augmentation"] = json!({});
    let problems = scene::check(&loaded(&scene));
    assert_eq!(problems.len(), 1, "{problems:?}");
    let told = format!("{:?}", problems[0]);
    assert!(told.contains("/contacts/rub/augmentation"), "{told}");
    let error = build(&loaded(&scene)).expect_err("both");
    assert_eq!(error.pointer, "/contacts/rub/augmentation");
}

/// A slab that a cylinder is pressed into and drawn over: forces on the cylinder at the end of the way.
fn ironed(gap: &str, elements: u32, element: &str) -> [f64; 2] {
    let scene = json!({
        "covact": 1,
        "materials": {"rubber": {"neo_hooke": {"E": 10, "nu": 0.3}}},
        "bodies": {"slab": {
            "mesh": {"block": {
                "min": [0, 0, -1], "max": [6, 0.5, 0], "elements": [elements, 1, 2]
            }},
            "material": "rubber", "element": element
        }},
        "surfaces": {"die": {
            "cylinder": {"radius": 3, "length": 2, "center": [2, 0, 3]},
            "motion": {"translation": [
                {"table": [[0, 0], [0.25, 0], [1, 1.5]]}, 0, {"table": [[0, 0], [0.25, -0.2], [1, -0.2]]}
            ]}
        }},
        "contacts": {"iron": {
            "slave": "slab.top", "master": "die", "points": {"gauss": 3}, "penalty": {"value": 300},
            "gap": gap, "friction": {"coulomb": {"mu": 0.3}}
        }},
        "supports": {
            "floor": {"on": "slab.bottom", "fixed": true},
            "front": {"on": "slab.y_min", "symmetry": "y"},
            "back": {"on": "slab.y_max", "symmetry": "y"}
        },
        "solution": {"step": {"initial": 0.05, "max": 0.05}, "threads": 1},
        "output": {"every": 0}
    });
    let outcome: Outcome = done(&scene);
    println!(
        "{gap}, {elements} {element}: {} iterations, {} cuts, dissipated {}, out of balance by {}",
        outcome.summary.newton_iterations,
        outcome.summary.cuts,
        last(&outcome, "energy.dissipated"),
        last(&outcome, "energy.imbalance")
    );
    let external = last(&outcome, "energy.external");
    assert!(last(&outcome, "energy.imbalance").abs() < 0.01 * external.abs());
    ["force.die.x", "force.die.z"].map(|c| last(&outcome, c))
}

/// A cylinder drawn over rubber needs the forces that it needs with gaps of points: the difference falls under refinement.
#[test]
fn a_cylinder_is_drawn_over_rubber_with_the_same_forces() {
    for element in ["h8", "q18"] {
        let off = [12, 24, 48].map(|elements| {
            let [a, b] = ["averaged", "pointwise"].map(|gap| ironed(gap, elements, element));
            let off = [0, 1].map(|c| (a[c] / b[c] - 1.0).abs());
            println!("{elements} {element}: {a:?} {b:?}, off by {off:?}");
            assert!(a[0].abs() > 0.2 * a[1].abs() && a[1].abs() > 0.1);
            off
        });
        assert!(
            off[2][0] < 0.5 * off[0][0] && off[2][1] < 0.5 * off[0][1],
            "{off:?}"
        );
        assert!(off[2][0] < 0.01 && off[2][1] < 0.01, "{off:?}");
    }
}
