//! Contact linearised at the start: Hertz, superposition, one factorization for every change of the points in contact.
use crate::support::{Outcome, scene_json, set, solve};
use crate::{displacements, factorizations, large, off, scene};
use covact::output::RunStatus;
use covact::solve::event::Event;
use serde_json::{Value, json};

const FORCE: f64 = 2.93040;
const P0: f64 = 1.39916;

/// Sets of points that were solved with, as the events tell them.
fn sets(outcome: &Outcome) -> u64 {
    let next = |e: &&Event| matches!(e, Event::Iteration { iteration, changed, .. } if *iteration > 0 && *changed > 0);
    1 + outcome.events.iter().filter(next).count() as u64
}

/// The Hertz scene with `cells` elements within 1.5 contact radii and `all` along each axis.
fn hertz(all: u32, cells: u32, steps: u32) -> Value {
    let mut scene = scene_json("hertz_block.json");
    set(
        &mut scene,
        "/bodies/block/mesh/block/elements",
        vec![all, all, all],
    );
    for axis in 0..3 {
        let fine = format!("/bodies/block/mesh/block/spacing/{axis}/fine/fine");
        set(&mut scene, &fine, cells);
    }
    let size = 1.0 / f64::from(steps);
    scene["solution"] = json!({"kinematics": "small", "step": {"initial": size, "max": size}});
    scene
}

/// Hertz' theory is one of small displacements, so that refinement leads to its numbers. Of the large-rotation elements it
/// does not quite: at strains of half a per cent they differ by as much.
#[test]
fn hertz_beside_large_rotations() {
    let small = hertz(14, 6, 1);
    let [a, b] = [solve(&small), solve(&large(&small))];
    let of = |o: &Outcome| {
        let force = -4.0 * o.at("force.sphere.z", 1.0) / FORCE - 1.0;
        (force, o.at("pressure.max", 1.0) / P0 - 1.0)
    };
    let seconds = |o: &Outcome| o.summary.cpu_s.unwrap_or(f64::NAN);
    for (name, o) in [("small", &a), ("large", &b)] {
        println!(
            "{name}: F, p0 off by {:?}, {} iterations, {} factorizations, {:.2} s",
            of(o),
            o.summary.newton_iterations,
            factorizations(o),
            seconds(o)
        );
    }
    // Measured: -.27 % and -.21 %; with large rotations -.75 % and -1.30 %.
    assert!(of(&a).0.abs() < 5e-3 && of(&a).1.abs() < 5e-3);
    assert!(of(&a).0.abs() < of(&b).0.abs() && of(&a).1.abs() < of(&b).1.abs());
    assert!(a.summary.newton_iterations <= b.summary.newton_iterations);
    assert!(a.summary.warnings.is_empty(), "{:?}", a.summary.warnings);
    assert_eq!(factorizations(&a), sets(&a));
}

#[test]
fn one_factorization_for_every_set() {
    let outcome = solve(&hertz(10, 4, 8));
    let active = outcome.column("points.active");
    let mut counts = active.clone();
    counts.dedup();
    println!(
        "{active:?}: {} factorizations, {} iterations",
        factorizations(&outcome),
        outcome.summary.newton_iterations
    );
    // Some steps keep their points, and cost no factorization.
    assert!(counts.len() < active.len());
    assert_eq!(factorizations(&outcome), sets(&outcome));
    assert!(factorizations(&outcome) < outcome.summary.newton_iterations);
}

/// A clamped plate between a plane above and a block below, pressed together so that all points are in contact from the first
/// step on; the plane turns, too. Meshes do not match.
fn sandwich(factor: f64, steps: u32) -> Value {
    let region = |z: f64| json!({"faces_in_box": {"min": [1.9, -0.1, z - 0.01], "max": [6.1, 4.1, z + 0.01]}});
    scene(
        0.0,
        json!({
            "bodies": {
                "plate": {
                    "mesh": {"block": {"min": [0, 0, 0], "max": [6, 4, 1], "elements": [6, 4, 1]}},
                    "material": "m", "sets": {"above": region(1.0), "below": region(0.0)}
                },
                "base": {
                    "mesh": {"block": {"min": [2, 0, -2], "max": [6, 4, 0], "elements": [5, 3, 2]}},
                    "material": "m", "element": "h8_displacement"
                }
            },
            "surfaces": {"tool": {
                "plane": {"center": [4, 2, 1], "normal": [0, 0, 1], "size": [20, 20]},
                "motion": {
                    "translation": [0, 0, format!("-{}*t", 1e-2 * factor)],
                    "rotation": {"center": [4, 2, 1], "axis": [0, 1, 0], "angle": format!("{}*t", 1e-2 * factor)}
                },
                "depth": 1
            }},
            "contacts": {
                "top": {"slave": "plate.above", "master": "tool", "penalty": {"scaled": 1}},
                "bottom": {
                    "slave": "plate.below", "master": "base.z_max", "points": {"gauss": 3}, "penalty": {"scaled": 1}
                }
            },
            "supports": {
                "clamp": {"on": "plate.x_min", "fixed": true}, "floor": {"on": "base.z_min", "fixed": true}
            },
            "loads": {"side": {"on": "plate.y_max", "traction": [0, format!("{}*t", 1e-2 * factor), 0]}}
        }),
        steps,
    )
}

#[test]
fn what_is_doubled_doubles_everything() {
    let [one, two] = [1.0, 2.0].map(|factor| solve(&sandwich(factor, 4)));
    let points = one.column("points.active");
    assert!(points.iter().all(|n| *n == points[0]), "{points:?}");
    for body in ["plate", "base"] {
        let [a, b] = [&two, &one].map(|o| displacements(o, body));
        let difference = off(&a, &b, 2.0);
        assert!(difference < 1e-12, "{body}: {difference:e}");
        let last = two.summary.steps;
        let [a, b] = [&two, &one].map(|o| o.body(body, last).field("cauchy_stress").to_vec());
        let difference = off(&a, &b, 2.0);
        assert!(difference < 1e-11, "stress of {body}: {difference:e}");
    }
    let mut compared = 0;
    for name in &one.history.columns {
        let factor = match name.as_str() {
            n if n.starts_with("force.") || n.starts_with("moment.") || n.contains(".force.") => {
                2.0
            }
            "pressure.max" | "penetration.max" => 2.0,
            "energy.internal" | "energy.contact" | "energy.external" => 4.0,
            _ => continue,
        };
        let [a, b] = [&two, &one].map(|o| *o.column(name).last().unwrap());
        let size = one.at("force.tool.z", 1.0).abs();
        if name.starts_with("imbalance") {
            continue;
        }
        assert!(
            (a - factor * b).abs() < 1e-11 * a.abs().max(size),
            "{name}: {a} {b}"
        );
        compared += usize::from(a != 0.0);
    }
    assert!(compared > 20, "{compared} columns");
    // The set is found in the first step; all others solve with its factorization, once each.
    let iterations = one.column("iterations");
    println!(
        "{iterations:?} iterations, {} factorizations",
        factorizations(&one)
    );
    assert_eq!(iterations[1..], [1.0; 3]);
    assert_eq!(factorizations(&one), iterations[0] as u64);
    assert_eq!(factorizations(&one), sets(&one));
    // Work is what is stored, to rounding.
    let [work, left] = ["energy.external", "energy.imbalance"].map(|c| two.at(c, 1.0));
    assert!(left.abs() < 1e-12 * work, "{left:e} of {work:e}");
    // Both sides of the contact between bodies balance.
    let side = |s: &str| two.at(&format!("{s}.force.bottom.z"), 1.0);
    assert!(side("slave") > 0.0 && (side("slave") + side("master")).abs() < 1e-13 * side("slave"));
}

#[test]
fn the_steps_do_not_matter() {
    let [one, many] = [1, 5].map(|steps| solve(&sandwich(1.0, steps)));
    let [a, b] = [&one, &many].map(|o| displacements(o, "plate"));
    assert!(off(&a, &b, 1.0) < 1e-12);
    assert_eq!(factorizations(&many), factorizations(&one));
}

/// As loads become small, large rotations come to the same, with an error of the first order.
#[test]
fn contact_is_the_limit_of_the_large_one() {
    let mut last = None;
    for scale in [1.0, 0.1, 0.01] {
        let small = sandwich(3.0 * scale, 1);
        let mut other = large(&small);
        other["solution"]["newton"] = json!({"tolerance": 1e-12});
        let [a, b] = [solve(&small), solve(&other)];
        let all = |o: &Outcome| [displacements(o, "plate"), displacements(o, "base")].concat();
        let difference = off(&all(&b), &all(&a), 1.0);
        println!("{scale}: {difference:e}");
        if let Some(last) = last {
            let rate: f64 = f64::log10(last / difference);
            assert!((rate - 1.0).abs() < 0.15, "order {rate}");
        }
        last = Some(difference);
    }
    assert!(last.is_some_and(|d| d < 1e-3));
}

/// A sphere that is offset, and one that starts too deep: as the same sphere moved.
#[test]
fn offsets_and_overclosures() {
    let plain = hertz(8, 3, 1);
    let expected = solve(&plain).at("force.sphere.z", 1.0);
    assert!(expected < 0.0);
    let mut offset = plain.clone();
    set(&mut offset, "/surfaces/sphere/sphere/radius", 99.5);
    offset["contacts"]["press"]["offset"] = json!(0.5);
    let mut deep = plain.clone();
    set(
        &mut deep,
        "/surfaces/sphere/sphere/center",
        vec![0.0, 0.0, 99.99],
    );
    set(
        &mut deep,
        "/surfaces/sphere/motion/translation",
        vec![0, 0, 0],
    );
    let mut shrunk = deep.clone();
    shrunk["contacts"]["press"]["initial_overclosure"] = json!({"shrink": {"until": 1.0}});
    for (name, scene, tolerance) in [
        ("offset", offset, 1e-9),
        ("strain", deep.clone(), 1e-6),
        ("shrink", shrunk, 1e-6),
    ] {
        let found = solve(&scene).at("force.sphere.z", 1.0);
        println!("{name}: {found} {expected}");
        assert!(
            (found / expected - 1.0).abs() < tolerance,
            "{name}: {found} {expected}"
        );
    }
    // What counts as touching is flatter than the sphere: it takes more.
    deep["contacts"]["press"]["initial_overclosure"] = json!("stress_free");
    let motion = "/surfaces/sphere/motion/translation";
    set(&mut deep, motion, json!([0, 0, "-0.01*t"]));
    let flat = solve(&deep).at("force.sphere.z", 1.0);
    assert!(flat < 1.1 * expected, "{flat} {expected}");
}

/// A block on another one is pressed down, let go to where it was, and pulled off: at rest nothing is left but rounding, of
/// which no set of points can be drawn.
#[test]
fn loads_that_come_back_to_nothing() {
    let block = |low: f64, high: f64, n: u32| {
        json!({"mesh": {"block": {
            "min": [0, 0, low], "max": [1, 1, high], "elements": [n, n, 2]
        }}, "material": "m"})
    };
    let way =
        json!({"table": [[0, 0], [0.25, -0.01], [0.5, 0], [0.75, -0.01], [0.875, 0], [1, 0.01]]});
    let small = scene(
        0.0,
        json!({
            "bodies": {"lower": block(-0.5, 0.0, 7), "upper": block(0.0, 0.5, 9)},
            "contacts": {"press": {
                "slave": "upper.bottom", "master": "lower.top", "points": {"gauss": 2}
            }},
            "supports": {
                "ground": {"on": "lower.bottom", "displacement": {"z": 0}},
                "lower_x": {"on": "lower.x_min", "symmetry": "x"},
                "lower_y": {"on": "lower.y_min", "symmetry": "y"},
                "upper_x": {"on": "upper.x_min", "symmetry": "x"},
                "upper_y": {"on": "upper.y_min", "symmetry": "y"},
                "push": {"on": "upper.top", "displacement": {"z": way}}
            }
        }),
        8,
    );
    let outcome = solve(&small);
    let active = outcome.column("points.active");
    println!(
        "{active:?}: {} iterations, {:?}",
        outcome.summary.newton_iterations, outcome.summary.warnings
    );
    assert_eq!(outcome.summary.steps, 8);
    assert_eq!(outcome.summary.cuts, 0);
    // At most two sets a step, each with a check.
    assert!(outcome.summary.newton_iterations <= 4 * 8);
    assert_eq!(active.last(), Some(&0.0));
    assert!(active[2] > 300.0, "{active:?}");
    // Strains of 1 %, and at rest no word of what is rounding.
    assert!(
        !outcome
            .summary
            .warnings
            .iter()
            .any(|w| w.contains("gaps of"))
    );
}

/// Iterations that are too few fail the step, which is cut until it ends the run; nothing else is made of it.
#[test]
fn steps_that_fail_are_told() {
    let mut small = sandwich(1.0, 1);
    small["solution"]["newton"] = json!({"max_iterations": 1});
    small["solution"]["step"]["min"] = json!(0.2);
    let outcome = solve(&small);
    assert_eq!(outcome.summary.status, RunStatus::NotConverged);
    let reason = outcome.summary.reason.unwrap_or_default();
    println!("{reason}");
    assert!(reason.contains("iterations"), "{reason}");
}
