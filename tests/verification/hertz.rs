//! Hertz: rigid sphere R = 100 pressed by .01 into an elastic half space, E = 200, nu = .3; the far faces of the quarter
//! block carry the displacement of a point load on a half space (Boussinesq 1885, as in K. L. Johnson, Contact Mechanics,
//! 1985, section 3.2), so that every target is Hertz's closed form: a = 1, F = 2.93040, p0 = 1.39916.
//!
//! ```text
//!        \  sphere  /
//!   z=0 --\___.____/------+
//!         |               |   12 cells on [0, 1.5] along each axis, growing beyond
//!         |     block     |
//! ```
use crate::support::{Outcome, scene_json, set, solve};
use covact::fem::gauss;

const FORCE: f64 = 2.93040;
const P0: f64 = 1.39916;

/// Relative L2 error of the nodal pressure field, bilinear between nodes, by 8 x 8 points on every slave face.
fn pressure_error(outcome: &Outcome) -> f64 {
    let body = outcome.body("block", 1);
    let pressure = body.field("contact_pressure");
    let rule = gauss(8).unwrap();
    let exact = |r2: f64| P0 * (1.0 - r2).max(0.0).sqrt();
    let (mut error, mut total) = (0.0, 0.0);
    for face in body.top_faces(2.5) {
        let x: Vec<[f64; 3]> = face.iter().map(|&n| body.points[n]).collect();
        let (dx, dy) = (x[1][0] - x[0][0], x[2][1] - x[0][1]);
        for (v, wv) in rule.iter() {
            for (u, wu) in rule.iter() {
                let n = covact::fem::face::shape([2, 2], u, v);
                let at = |c: usize| (0..4).map(|k| n[k] * x[k][c]).sum::<f64>();
                let p: f64 = (0..4).map(|k| n[k] * pressure[face[k]]).sum();
                let w = wu * wv * 0.25 * dx * dy;
                let e = exact(at(0).powi(2) + at(1).powi(2));
                error += w * (p - e).powi(2);
                total += w * e * e;
            }
        }
    }
    // int p^2 over a quarter of the circle: pi p0^2 a^2 / 8.
    assert!((total / (std::f64::consts::PI * P0 * P0 / 8.0) - 1.0).abs() < 1e-2);
    (error / total).sqrt()
}

#[test]
fn force_pressure_and_field_by_penalty_alone() {
    let outcome = solve(&scene_json("hertz_block.json"));
    let summary = &outcome.summary;
    assert_eq!(summary.status.name(), "done");
    assert!(summary.dofs <= 38_000, "{} dofs", summary.dofs);
    assert!(
        summary.newton_iterations <= 10,
        "{}",
        summary.newton_iterations
    );
    let force = -4.0 * outcome.at("force.sphere.z", 1.0) / FORCE - 1.0;
    let peak = outcome.at("pressure.max", 1.0) / P0 - 1.0;
    let field = pressure_error(&outcome);
    println!(
        "F {:.3} %, p0 {:.3} %, L2 {:.2} %",
        100.0 * force,
        100.0 * peak,
        100.0 * field
    );
    assert!(force.abs() < 6e-3, "force off by {force}");
    assert!(peak.abs() < 2e-2, "peak pressure off by {peak}");
    // The bilinear interpolant of the exact pressure is itself 5.1 % off: its border is steep.
    assert!(field < 6.5e-2, "pressure off by {field}");
}

#[test]
fn force_pressure_and_field_with_multipliers() {
    // The same with augmentation under ten times the stiffness of an element, 14 cells under the contact radius: what the
    // penalty alone does not give at any value, all three at once, is here whatever the penalty. Measured on the shipped mesh
    // for .1, 1, 10 and 100 times the stiffness of an element: F .07, .05, .04, -.03 %, p0 -.97, -.97, -.98, -1.07 %, L2 5.6,
    // 5.4, 5.4, 5.5 %.
    let mut scene = scene_json("hertz_block.json");
    set(
        &mut scene,
        "/bodies/block/mesh/block/elements",
        vec![22, 22, 21],
    );
    for axis in 0..3 {
        let fine = format!("/bodies/block/mesh/block/spacing/{axis}/fine/fine");
        set(&mut scene, &fine, 14);
    }
    scene["contacts"]["press"]["augmentation"] = serde_json::json!({});
    scene["contacts"]["press"]["penalty"] = serde_json::json!({ "scaled": 0.5 });
    let outcome = solve(&scene);
    assert!(
        outcome.summary.dofs <= 38_000,
        "{} dofs",
        outcome.summary.dofs
    );
    let force = -4.0 * outcome.at("force.sphere.z", 1.0) / FORCE - 1.0;
    let peak = outcome.at("pressure.max", 1.0) / P0 - 1.0;
    let field = pressure_error(&outcome);
    println!(
        "{} dofs: F {:.3} %, p0 {:.3} %, L2 {:.2} %",
        outcome.summary.dofs,
        100.0 * force,
        100.0 * peak,
        100.0 * field
    );
    assert!(force.abs() < 4e-3, "force off by {force}");
    assert!(peak.abs() < 1e-2, "peak pressure off by {peak}");
    assert!(field < 6e-2, "pressure off by {field}");
}

#[test]
fn pressure_is_right_on_the_symmetry_planes() {
    let mut scene = scene_json("hertz_block.json");
    set(
        &mut scene,
        "/bodies/block/mesh/block/elements",
        vec![14, 14, 12],
    );
    for axis in 0..3 {
        let fine = format!("/bodies/block/mesh/block/spacing/{axis}/fine/fine");
        set(&mut scene, &fine, 6);
    }
    for points in [
        serde_json::json!("nodes"),
        serde_json::json!({ "gauss": 2 }),
    ] {
        scene["contacts"]["press"]["points"] = points.clone();
        let outcome = solve(&scene);
        let body = outcome.body("block", 1);
        let pressure = body.field("contact_pressure");
        // Along the x axis (on the plane y = 0) and along the diagonal the field is a function of the radius alone:
        // at the radius of a node on the axis the diagonal, interpolated, has the same pressure within the mesh error.
        let on_axis: Vec<(f64, f64)> = body
            .top_nodes(|x| x[1].abs() < 1e-9 && x[0] < 0.8)
            .into_iter()
            .map(|n| (body.points[n][0], pressure[n]))
            .collect();
        assert!(on_axis.len() >= 3);
        for (r, p) in on_axis {
            let exact = P0 * (1.0 - r * r).sqrt();
            assert!(
                (p / exact - 1.0).abs() < 0.06,
                "{points}: p({r}) = {p} instead of {exact}"
            );
        }
    }
}
