//! Block pushed up an incline by a horizontal force F while its weight G presses it down: NAFEMS CGS-4 (A. Becker,
//! "Benchmark tests for finite element modelling of stress, contact, gap and friction", wedge problem).
//!
//! ```text
//!            G
//!            v  ____
//!        F -> |    |
//!             |____|    .     tan a = 1/10
//!          .       '
//!     '________________
//! ```
//!
//! Equilibrium along and across the incline: `F / G = (tan a + mu) / (1 - mu tan a)`, once every point slides. The plane
//! has one normal, so penetration, deformation and the place of the pressure do not matter: what is left is the error of
//! Newton's method and of the limit.
use crate::support::{Outcome, solve};
use serde_json::{Value, json};

const TAN: f64 = 0.1;

/// A block whose top is pushed over the incline by .2 of its height from time 1 to 2. The weight is that of the
/// block as seen from the incline, which is free to rise and lifted with the force 1, reached at time 1.
fn wedge(mu: f64, step: f64) -> Value {
    let angle = TAN.atan();
    let mut scene = json!({
        "covact": 1,
        "materials": {"elastic": {"st_venant_kirchhoff": {"E": 1000, "nu": 0.3}}},
        "bodies": {"block": {
            "mesh": {"block": {"min": [-1, 0, 0], "max": [1, 1, 1], "elements": [4, 2, 2]}},
            "element": "h8_displacement",
            "material": "elastic",
            "placement": {"axis": [0, 1, 0], "angle": -angle.to_degrees()}
        }},
        "surfaces": {"incline": {
            "plane": {"center": [0, 0.5, 0], "normal": [-angle.sin(), 0, angle.cos()], "size": [10, 4]},
            "motion": {"free": {"force": {"z": {"table": [[0, 0.05], [1, 1], [2, 1]]}}}}
        }},
        "contacts": {"slide": {"slave": "block.bottom", "master": "incline"}},
        "supports": {"push": {"on": "block.top", "displacement": {
            "x": {"table": [[0, 0], [1, 0], [2, 0.2]]}, "y": 0, "z": 0
        }}},
        "solution": {"end_time": 2, "step": {"initial": step, "max": step}},
        "output": {"every": 0}
    });
    if mu > 0.0 {
        scene["contacts"]["slide"]["friction"] = json!({"coulomb": {"mu": mu}});
    }
    scene
}

/// The same, laid down by a displacement and lifted along the incline: the weight is what the top carries.
fn guided(mu: f64, step: f64) -> Value {
    let mut scene = wedge(mu, step);
    (scene["surfaces"]["incline"]
        .as_object_mut()
        .expect("object"))
    .remove("motion");
    scene["supports"]["push"]["displacement"]["z"] =
        json!({"table": [[0, 0], [1, -0.001], [2, 0.019]]});
    scene
}

fn ratio(outcome: &Outcome, time: f64) -> f64 {
    outcome.at("force.push.x", time) / outcome.at("force.incline.z", time)
}

#[test]
fn nafems_wedge() {
    // The closed form to six digits, as published.
    let published = [
        (0.0, 0.1),
        (0.1, 0.202020),
        (0.2, 0.306122),
        (0.3, 0.412371),
    ];
    for ((mu, reference), driven) in published.iter().flat_map(|p| [(*p, false), (*p, true)]) {
        let outcome = solve(&if driven {
            wedge(mu, 0.5)
        } else {
            guided(mu, 0.5)
        });
        let exact = (TAN + mu) / (1.0 - mu * TAN);
        assert!((exact - reference).abs() < 1e-6);
        let measured = ratio(&outcome, 2.0);
        let s = &outcome.summary;
        println!(
            "mu {mu}: F / G {measured:.9}, exact {exact:.9}, {} iterations in {} steps, driven: {driven}",
            s.newton_iterations, s.steps
        );
        if driven {
            let weight = outcome.at("force.incline.z", 2.0);
            assert!((weight - 1.0).abs() < 1e-7, "{weight}");
        }
        // Measured: 1e-8, what Newton's method leaves.
        assert!((measured / exact - 1.0).abs() < 1e-7, "{measured}");
        if mu > 0.0 {
            assert_eq!(outcome.at("points.stick", 2.0), 0.0);
            assert!(outcome.at("points.slip", 2.0) > 0.0);
        }
        let average = s.newton_iterations as f64 / f64::from(s.steps);
        assert!(average <= 8.0, "{average} iterations a step");
    }
}

/// The same by augmentation, with a penalty a thousand times softer than the automatic one.
#[test]
fn nafems_wedge_augmented() {
    for mu in [0.1, 0.2, 0.3] {
        let mut scene = guided(mu, 0.5);
        scene["contacts"]["slide"]["penalty"] = json!({"scaled": 1e-3});
        scene["contacts"]["slide"]["augmentation"] = json!({"gap": 1e-5, "slip": 1e-5});
        let outcome = solve(&scene);
        let exact = (TAN + mu) / (1.0 - mu * TAN);
        let measured = ratio(&outcome, 2.0);
        let deepest = outcome.at("penetration.max", 2.0);
        println!("mu {mu}: F / G {measured:.9}, exact {exact:.9}, penetration {deepest:.1e}");
        assert!((measured / exact - 1.0).abs() < 1e-6, "{measured}");
        // Of elements of .5: the augmentation did its work.
        assert!(deepest < 0.5e-5);
        assert!(outcome.at("augmentations", 2.0) > 0.0);
        assert_eq!(outcome.at("points.stick", 2.0), 0.0);
    }
}

/// Pulled back after the push, the block sticks at first and then slides down: `F / G = (tan a - mu) / (1 + mu tan a)`.
#[test]
fn the_wedge_pulled_back() {
    let mu = 0.3;
    let mut scene = guided(mu, 0.25);
    let table = |at: [f64; 4]| json!({"table": [[0, at[0]], [1, at[1]], [2, at[2]], [3, at[3]]]});
    scene["supports"]["push"]["displacement"] =
        json!({"x": table([0.0, 0.0, 0.2, 0.0]), "y": 0, "z": table([0.0, -0.001, 0.019, -0.001])});
    scene["solution"]["end_time"] = json!(3);
    let outcome = solve(&scene);
    let [up, down] = [2.0, 3.0].map(|time| ratio(&outcome, time));
    println!("up {up:.9}, down {down:.9}");
    assert!((up / ((TAN + mu) / (1.0 - mu * TAN)) - 1.0).abs() < 1e-7);
    assert!((down / ((TAN - mu) / (1.0 + mu * TAN)) - 1.0).abs() < 1e-7);
}
