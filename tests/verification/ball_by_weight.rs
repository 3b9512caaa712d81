//! `ball_by_weight`: a ball of radius 20 laid on a rubber cushion (E = 1, nu = .4), its weight growing to 100 (25 on the
//! quarter).
//!
//! ```text
//!        ( ball )   5 above at the start, free to move along z
//!   |-------------|
//!   |   cushion   |
//!   |_____________|  on a rigid floor
//! ```
use crate::support::{scene_json, solve};

#[test]
fn weight_is_carried_and_the_ball_sinks_as_hertz_has_it_at_first() {
    let scene = scene_json("ball_by_weight.json");
    let outcome = solve(&scene);
    let summary = &outcome.summary;
    println!("{summary:?}");
    assert_eq!(summary.status.name(), "done", "{:?}", summary.reason);
    let mut before = (0.0, -5.0);
    for t in outcome.column("time") {
        let weight = 25.0 * t;
        assert!(
            (outcome.at("force.ball.z", t) / -weight - 1.0).abs() < 1e-7,
            "at {t}"
        );
        // The floor carries it too.
        assert!(
            (outcome.at("force.floor.z", t) / weight - 1.0).abs() < 1e-6,
            "at {t}"
        );
        let z = outcome.at("displacement.ball.z", t);
        assert!(z < before.1, "at {t}: {z} after {before:?}");
        before = (t, z);
    }
    // Hertz (K. L. Johnson, Contact Mechanics, 1985, section 4.2): F = 4/3 E* sqrt(R) d^1.5, E* = E / (1 - nu^2), on a
    // half space at small strain. The cushion is 20 thick on a rigid floor, with the contact radius up to 10: it must be
    // stiffer, and the less so the smaller the contact is.
    let stiffer = |t: f64| {
        let d = -5.0 - outcome.at("displacement.ball.z", t);
        let hertz = 4.0 / 3.0 / (1.0 - 0.4f64.powi(2)) * 20f64.sqrt() * d.powf(1.5);
        100.0 * t / hertz
    };
    let (first, last) = (stiffer(0.125), stiffer(1.0));
    println!("stiffer than a half space: {first} at first, {last} at last");
    assert!(first > 1.0 && first < 1.6 && last > first && last < 2.5);
}
