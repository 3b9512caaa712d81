//! A block that hardly deforms bounces on a soft penalty under its weight. What of its height is left at the fifth apex, by the
//! steps in a contact time `pi sqrt(m / k)`, against a point mass in an independent program (a prototype in Python of the same
//! integration, written before this one): contact that acts at the end of a step is a damper, weighted contact is not.
use crate::support::{fixed, run};
use serde_json::{Value, json};

/// The height of apex `number`, counted from one, in a run of `end` times the fall and rise of a bounce without loss, and the
/// warnings.
fn apex(contact: &str, steps: f64, number: usize, end: f64) -> (f64, Vec<String>) {
    let (g, k) = (10.0, 1e4f64);
    let dt = std::f64::consts::PI / k.sqrt() / steps;
    let mut solution = fixed(dt, end * 2.0 * 0.2f64.sqrt());
    solution["dynamics"]["contact"] = json!(contact);
    let scene: Value = json!({
        "covact": 1,
        "materials": { "m": { "st_venant_kirchhoff": { "E": 1e8, "nu": 0.0, "density": 1.0 } } },
        "bodies": { "b": {
            "mesh": { "block": { "min": [0, 0, 1], "max": [1, 1, 2], "elements": [1, 1, 1] } },
            "material": "m", "element": "h8_displacement"
        } },
        "surfaces": { "floor": { "plane": { "center": [0.5, 0.5, 0], "size": [4, 4] }, "side": { "point": [0, 0, 1] }, "depth": 2 } },
        "contacts": { "c": { "slave": "b.bottom", "master": "floor", "penalty": { "value": k } } },
        "loads": { "weight": { "on": "b", "gravity": [0, 0, -g] } },
        "solution": solution,
        "output": { "every": 0 }
    });
    let (mut before, mut apexes) = (0.0, Vec::new());
    let simulation = run(&scene, |s| {
        let [p, _] = s.momentum().expect("inertia");
        if before > 0.0 && p.z <= 0.0 {
            let u = s.displacements("b").expect("the body");
            let height = 1.0 + u.iter().map(|u| u.z).sum::<f64>() / u.len() as f64;
            apexes.push(height + p.z * p.z / (2.0 * g));
        }
        before = p.z;
    });
    (apexes[number - 1], simulation.warnings().to_vec())
}

#[test]
fn a_stiff_block_on_a_soft_penalty() {
    // With ten steps in a contact it matters where these fall.
    for (contact, steps, height, tolerance) in [
        ("weighted", 10.0, 1.0064, 0.012),
        ("implicit", 40.0, 0.5678, 2e-3),
    ] {
        let (found, warnings) = apex(contact, steps, 5, 8.0);
        println!("{contact}, {steps} steps: {found:.4} ({height}), {warnings:?}");
        assert!(
            (found - height).abs() < tolerance,
            "{contact}: {found} {height}"
        );
        // Its lightest nodes stand for a quarter of the area and an eighth of the mass: 141 of circular frequency.
        let told = warnings
            .iter()
            .any(|w| w.contains("is weighted between the ends of the step"));
        assert_eq!(told, contact == "weighted", "{warnings:?}");
        // Weighted contact gains some of it, here 1 % in the bounces after the fifth.
        let gained = warnings.iter().any(|w| w.contains("had gained"));
        assert!(contact == "weighted" || !gained, "{warnings:?}");
    }
}

/// Of the energy `m g h` a bounce loses the more the longer its steps are. What is more than 4 % of it, 2 % of the speed, is told.
#[test]
fn what_a_bounce_loses_is_told() {
    for (steps, told) in [(80.0, true), (160.0, false)] {
        let (height, warnings) = apex("implicit", steps, 1, 1.2);
        println!("{steps} steps: {height:.4}, {warnings:?}");
        assert!((1.0 - height > 0.04) == told && height > 0.92, "{height}");
        let taken = |w: &String| w.contains("the time integration has taken");
        assert_eq!(warnings.iter().any(taken), told, "{warnings:?}");
    }
}
