//! A particle under its weight on a rigid sphere or cylinder sticks as long as the slope allows: `tan phi <= mu`, with phi
//! from the top. There `N = P cos phi` and `|T| = P sin phi`, whatever the radius.
//!
//! ```text
//!          ___  o  P v         o   the middle of a face, its only slave point: a Gauss point, loaded by P
//!       .'  |  /'.             phi angle between the vertical and the normal under the particle
//!      /   phi/   \
//!     |     |/     |
//! ```
//!
//! The face belongs to an element so soft that it does not carry: it is there to make the particle's way downhill finite
//! once it slides (its stiffness is 10 P / R, the slope takes away P / R), and takes 1e-6 of the weight before. The tangential
//! penalty lets the particle creep by 1e-8 R, which is 1e-6 degree.
use crate::support::{Outcome, solve};
use serde_json::{Value, json};

const R: f64 = 1.0;
const P: f64 = 1.0;
/// Half the edge of the element.
const S: f64 = 0.01;

/// Normal penalty; the tangential one is as large, the soft element having no Poisson's ratio.
const PENALTY: f64 = 2.5e10;

fn particle(mut surface: Value, mu: f64, phi: f64) -> Outcome {
    let place = phi.to_radians();
    // It starts as deep as a quarter of the weight presses it, so that it touches whatever the rounding.
    let at = R - 0.25 * P / (PENALTY * 4.0 * S * S);
    surface["side"] = json!({"point": [0, 0, 5.0 * R]});
    solve(&json!({
        "covact": 1,
        "materials": {"soft": {"st_venant_kirchhoff": {"E": 1250, "nu": 0}}},
        "bodies": {"particle": {
            "mesh": {"block": {"min": [-S, -S, 0], "max": [S, S, 2.0 * S], "elements": [1, 1, 1]}},
            "element": "h8_displacement",
            "material": "soft",
            "placement": {
                "axis": [0, 1, 0], "angle": phi, "translation": [at * place.sin(), 0, at * place.cos()]
            }
        }},
        "surfaces": {"rest": surface},
        "contacts": {"rest": {
            "slave": "particle.bottom",
            "master": "rest",
            "points": {"gauss": 1},
            "penalty": {"value": PENALTY},
            "tangential_penalty": {"scaled": 1},
            "friction": {"coulomb": {"mu": mu}}
        }},
        "supports": {"held": {"on": "particle.top", "fixed": true}},
        "loads": {"weight": {"on": "particle.bottom", "force": [0, 0, {"table": [[0, 0], [1, -P]]}]}},
        "solution": {"step": {"initial": 0.25, "max": 0.25}},
        "output": {"every": 0}
    }))
}

/// Whether the particle sticks, at every step, or slides, at every step; the load grows in proportion.
fn sticks(surface: &Value, mu: f64, phi: f64) -> bool {
    let outcome = particle(surface.clone(), mu, phi);
    let (stick, slip) = (
        outcome.column("points.stick"),
        outcome.column("points.slip"),
    );
    let sticks = *stick.last().expect("steps") == 1.0;
    let all = if sticks { &stick } else { &slip };
    assert!(
        all[1..].iter().all(|n| *n == 1.0),
        "stick {stick:?}, slip {slip:?}"
    );
    if sticks {
        // Equilibrium of the particle alone: the surface carries its weight.
        let [x, z] = ["x", "z"].map(|a| outcome.at(&format!("force.rest.{a}"), 1.0));
        assert!(x.abs() < 2e-6 * P && (z / P - 1.0).abs() < 2e-6, "{x}, {z}");
    }
    sticks
}

fn limits(surface: &Value) {
    // Degrees, to three digits as published for comparison; the test is against atan(mu).
    for (mu, published) in [(0.1, 5.711), (0.2, 11.310), (0.3, 16.699), (0.5, 26.565)] {
        let exact = f64::atan(mu).to_degrees();
        assert!((exact - published).abs() < 5e-4);
        // Bisection of a bracket of two degrees, down to a thousandth of one.
        let (mut stick, mut slip) = (exact - 0.9, exact + 1.1);
        assert!(sticks(surface, mu, stick) && !sticks(surface, mu, slip));
        while slip - stick > 1e-3 {
            let middle = 0.5 * (stick + slip);
            if sticks(surface, mu, middle) {
                stick = middle;
            } else {
                slip = middle;
            }
        }
        let limit = 0.5 * (stick + slip);
        println!("mu {mu}: limit {limit:.4} degrees, exact {exact:.4}");
        assert!((limit - exact).abs() < 2e-3);
    }
}

#[test]
fn on_a_sphere() {
    limits(&json!({"sphere": {"radius": R}}));
}

#[test]
fn on_a_cylinder() {
    limits(&json!({"cylinder": {"radius": R, "length": 2.0 * R, "axis": [0, 1, 0]}}));
}

/// Down the generator of an inclined cylinder: the same slope, another direction on the surface.
#[test]
fn along_an_inclined_cylinder() {
    // The axis lies in the plane y = 0, and the top generator meets the particle, at right angles to its normal.
    let surface = |phi: f64| {
        let (s, c) = phi.to_radians().sin_cos();
        json!({"cylinder": {"radius": R, "length": 2.0 * R, "axis": [c, 0, -s]}})
    };
    for mu in [0.1, 0.5] {
        let exact = f64::atan(mu).to_degrees();
        for (off, expected) in [(-1e-3, true), (1e-3, false)] {
            let phi = exact + off;
            assert_eq!(sticks(&surface(phi), mu, phi), expected, "mu {mu}, {off}");
        }
    }
}
