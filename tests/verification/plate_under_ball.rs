//! Plate under a ball: clamped plate 100 x 100 x 2, E = 12000, nu = .3, St. Venant-Kirchhoff, rigid frictionless ball of
//! radius 25 pushed in by 10.
//!
//! ```text
//!            ( ball )
//!   |-----------v-----------|     quarter model, symmetry at x = 0 and y = 0
//! ```
use crate::support::{scene_json, set, solve};

fn forces(n: u32) -> [f64; 4] {
    let mut scene = scene_json("ball_on_plate.json");
    set(&mut scene, "/bodies/plate/mesh/plate/elements", vec![n, n]);
    set(&mut scene, "/output/every", 0);
    let outcome = solve(&scene);
    println!("{:?}", outcome.summary);
    println!("{:?}", outcome.column("iterations"));
    [0.25, 0.5, 0.75, 1.0].map(|t| -4.0 * outcome.at("force.ball.z", t))
}

#[test]
fn force_on_25_by_25() {
    let f = forces(25);
    println!("{f:?}");
    for (f, reference) in f.iter().zip([629.0, 2571.0, 7275.0, 16638.0]) {
        assert!(
            (f / reference - 1.0).abs() < 2e-3,
            "{f} instead of {reference}"
        );
    }
}
