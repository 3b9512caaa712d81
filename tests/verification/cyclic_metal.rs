//! Metals whose yield surface moves with their flow (P. J. Armstrong and C. O. Frederick 1966), in scenes: loops of a strip that is drawn
//! and pressed.
//!
//! Along one direction of flow `s` the back stress is `X = s C/gamma + (X_0 - s C/gamma) exp(-gamma dp)`, so that every half cycle has a
//! closed form: its plastic strain is the root of `ln l_1 - tau / E = ep_0 + s dp` with `tau = s sigma_y(p_0 + dp) + X`.
use crate::support::solve;
use serde_json::{Value, json};

const E: f64 = 200e3;
const C: f64 = 20e3;
const GAMMA: f64 = 100.0;

/// A strip 10 x 4 x 1 free sideways between +-1 %, three times.
fn strip(element: &str, material: &Value) -> Value {
    json!({
        "covact": 1,
        "materials": { "m": material },
        "bodies": { "strip": {
            "element": element,
            "mesh": { "plate": { "size": [10, 4], "thickness": 1, "elements": [3, 2] } },
            "material": "m"
        } },
        "supports": {
            "x": { "on": "strip.x_min", "symmetry": "x" },
            "y": { "on": "strip.y_min", "symmetry": "y" },
            "z": { "on": "strip.bottom", "symmetry": "z" },
            "pull": { "on": "strip.x_max", "displacement": { "x": {
                "table": [[0, 0], [1, 0.1], [3, -0.1], [5, 0.1], [7, -0.1], [9, 0.1]]
            } } }
        },
        "solution": { "step": { "initial": 0.05, "max": 0.05 }, "end_time": 9 }
    })
}

fn material(modulus: f64) -> Value {
    json!({ "armstrong_frederick": {
        "E": E, "nu": 0.3,
        "hardening": { "voce": { "yield_stress": 300, "rise": 50, "rate": 10 } },
        "back_stress": { "modulus": modulus, "recovery": GAMMA }
    } })
}

fn yield_stress(p: f64) -> f64 {
    350.0 - 50.0 * (-10.0 * p).exp()
}

/// Plastic strain, accumulated plastic strain and back stress of a bar.
#[derive(Clone, Copy, Default)]
struct Bar {
    strain: f64,
    p: f64,
    back: f64,
}

impl Bar {
    /// To a logarithmic strain, along `sign`; returns the Kirchhoff stress there.
    fn go(&mut self, log: f64, sign: f64) -> f64 {
        let at = |dp: f64| {
            let end = sign * C / GAMMA;
            let back = end + (self.back - end) * (-GAMMA * dp).exp();
            (sign * yield_stress(self.p + dp) + back, back)
        };
        let (mut low, mut high) = (0.0, 0.1);
        for _ in 0..200 {
            let middle = 0.5 * (low + high);
            let strain = self.strain + sign * middle + at(middle).0 / E;
            match sign * (log - strain) > 0.0 {
                true => low = middle,
                false => high = middle,
            }
        }
        let (tau, back) = at(low);
        self.strain += sign * low;
        self.p += low;
        self.back = back;
        tau
    }
}

#[test]
fn loops_follow_their_closed_form() {
    for element in ["h8", "h8_displacement", "h8_mean_dilatation"] {
        let outcome = solve(&strip(element, &material(C)));
        assert_eq!(outcome.summary.status.name(), "done");
        let effects = &outcome.summary.effects;
        for effect in ["material.armstrong_frederick", "system.unsymmetric"] {
            assert!(effects.iter().any(|e| e == effect), "{effects:?}");
        }
        let mut bar = Bar::default();
        for (half, time) in [1.0, 3.0, 5.0, 7.0, 9.0].into_iter().enumerate() {
            let sign = if half % 2 == 0 { 1.0 } else { -1.0 };
            let stretch = 1.0 + 0.01 * sign;
            let tau = bar.go(f64::ln(stretch), sign);
            let exact = 4.0 * tau / stretch;
            let found = outcome.at("force.pull.x", time);
            let off = (found / exact - 1.0).abs();
            println!("{element} {time}: {found} {exact} {off:.1e}");
            assert!(off < 1e-6, "{element} {time}: {found} {exact}");
        }
        // The loops are those of a back stress.
        assert!(bar.back > 100.0, "{}", bar.back);
        let work = outcome.at("energy.external", 9.0);
        let left = outcome.at("energy.imbalance", 9.0) / work;
        println!("{element}: imbalance {left:.1e} of the work {work}");
        assert!(work > 400.0 && left.abs() < 1e-4, "{element}: {left:e}");
        let warnings = &outcome.summary.warnings;
        assert!(
            !warnings
                .iter()
                .any(|w| w.contains("energ") || w.contains("steps")),
            "{warnings:?}"
        );
        // Unsymmetric tangents are true ones: Newton's method needs as few iterations as with any other law.
        let each = outcome.summary.newton_iterations as f64 / f64::from(outcome.summary.steps);
        assert!(each < 2.5, "{each} iterations a step");
    }
}

/// Without a back stress the histories are those of `j2`, which takes another path through elements and solver.
#[test]
fn without_a_back_stress_it_is_von_mises() {
    let scene = strip("h8", &material(0.0));
    let mut plain = scene.clone();
    let hardening = scene["materials"]["m"]["armstrong_frederick"]["hardening"].clone();
    plain["materials"]["m"] = json!({ "j2": { "E": E, "nu": 0.3, "hardening": hardening } });
    let [own, j2] = [scene, plain].map(|scene| solve(&scene));
    assert_eq!(own.summary.steps, j2.summary.steps);
    for column in ["force.pull.x", "energy.internal", "energy.plastic"] {
        let [a, b] = [&own, &j2].map(|o| o.column(column));
        let most = b.iter().fold(0.0f64, |m, x| m.max(x.abs()));
        assert!(most > 0.1);
        for (a, b) in a.iter().zip(b) {
            assert!((a - b).abs() < 1e-10 * most, "{column}: {a} {b}");
        }
    }
}
