//! Slave faces cut by the facets of the master.
use crate::blocks::{done, exact, patch, pressures};
use crate::shells::arch_on_plate;
use covact::fem::FaceNodes;
use covact::model::segments::segments;
use covact_geometry::{MovingFacets, Vec3};
use serde_json::{Value, json};

/// The patch test on meshes of which no inner edges coincide: no kink lies within a piece, so that the pressure is
/// uniform to rounding, where the Gauss points of whole faces are off by percents.
#[test]
fn segments_pass_the_patch_test_on_meshes_that_do_not_match() {
    let p = exact();
    let off = |upper: &str, lower: &str, points: Value| {
        let mut scene = patch(3, 2, points.clone());
        scene["bodies"]["upper"]["element"] = json!(upper);
        scene["bodies"]["lower"]["element"] = json!(lower);
        scene["solution"]["newton"]["tolerance"] = json!(1e-12);
        let outcome = done(&scene);
        let [low, high] = pressures(&outcome, "upper");
        let force = outcome.column("force.ground.z")[0];
        let error = (high - p).max(p - low) / p;
        println!(
            "{upper} on {lower}, {points}: pressure off by {error:.1e}, force by {:.1e}",
            force / p - 1.0
        );
        (error, (force / p - 1.0).abs())
    };
    // Products of the shape functions of bilinear faces with a constant need degree 2, biquadratic ones 4.
    for (upper, lower, degree) in [("h8", "h8", 2), ("h8", "q18", 4), ("q18", "h8", 4)] {
        let (error, force) = off(upper, lower, json!({"segments": degree}));
        assert!(error < 1e-10 && force < 1e-10, "{error} {force}");
        let (gauss, _) = off(upper, lower, json!({"gauss": 3}));
        assert!(gauss > 1e-4, "{gauss}");
    }
}

/// A face of 3 x 3 or 2 x 2 nodes on the cylinder about y, and the area of many of them.
fn arch(
    radius: f64,
    cells: u32,
    rows: u32,
    nodes: u32,
    outward: bool,
) -> (Vec<FaceNodes>, Vec<Vec3>) {
    let m = nodes - 1;
    let (across, along) = (cells * m, rows * m);
    let mut at = Vec::new();
    for j in 0..=along {
        for i in 0..=across {
            let phi = 0.3 + 1.1 * f64::from(i) / f64::from(across);
            // Slanted, so that the faces are no rectangles.
            let y =
                f64::from(j) / f64::from(along) + 0.1 * phi.sin() * f64::from(j) / f64::from(along);
            at.push(Vec3::new(radius * phi.cos(), y, radius * phi.sin()));
        }
    }
    let mut faces = Vec::new();
    for j in 0..rows {
        for i in 0..cells {
            let mut f = FaceNodes {
                nodes: [0; 9],
                count: [nodes as u8; 2],
            };
            for b in 0..nodes {
                for a in 0..nodes {
                    let (u, v) = if outward { (b, a) } else { (a, b) };
                    f.nodes[(a + nodes * b) as usize] = (i * m + u) + (across + 1) * (j * m + v);
                }
            }
            faces.push(f);
        }
    }
    (faces, at)
}

/// Coaxial arches, the outer one's inner faces cut by the outer faces of the inner one.
#[test]
fn segments_of_coaxial_arches_sum_to_the_slave_area() {
    for (slave_nodes, master_nodes) in [(2, 2), (2, 3), (3, 2), (3, 3)] {
        let (slave, x) = arch(1.0, 5, 3, slave_nodes, false);
        let (master, y) = arch(0.99, 4, 2, master_nodes, true);
        let outlines: Vec<_> = master.iter().map(|f| (f.nodes(), f.count)).collect();
        let mut facets = MovingFacets::new(&outlines).expect("facets");
        facets.update(|n| y[n as usize]);
        let at = |n: u32| x[n as usize];
        let area: f64 = slave
            .iter()
            .map(|f| covact::fem::Quad::new(f, at).area())
            .sum();
        // An arch far inside cuts nothing.
        let (inner, z) = arch(0.1, 1, 1, 2, true);
        let inner: Vec<_> = inner.iter().map(|f| (f.nodes(), f.count)).collect();
        let mut far = MovingFacets::new(&inner).expect("facets");
        far.update(|n| z[n as usize]);
        let whole = segments(&slave, &far, at, at, 4, 0.0).len();
        assert_eq!(whole, 15 * 2 * 6, "two triangles of six points a face");
        let points = segments(&slave, &facets, at, at, 4, 0.2);
        let sum: f64 = points.iter().map(|p| p.area).sum();
        println!(
            "{slave_nodes} {master_nodes}: {} points, {whole} uncut, area off by {:.1e}",
            points.len(),
            sum / area - 1.0
        );
        assert!((sum - area).abs() < 1e-10 * area);
        assert!(points.iter().all(|p| p.area > 0.0));
        assert!(points.len() > whole, "nothing was cut");
    }
}

/// Cut anew at every step of a run in which faces bend and slide on each other: the force is that of many Gauss points,
/// both sides feel the same, and the steps converge.
#[test]
fn segments_follow_faces_that_bend_and_slide() {
    for surface in ["faces", "smooth"] {
        let run = |points: Value| {
            let mut scene = arch_on_plate(1.5, 5, points);
            scene["contacts"]["press"]["master_surface"] = json!(surface);
            let outcome = done(&scene);
            let last = |name: &str| *outcome.column(name).last().expect("steps");
            let force = last("slave.force.press.z").abs();
            assert!(force > 0.1 && last("imbalance.force.press") < 1e-12 * force);
            force
        };
        let (cut, gauss) = (run(json!({"segments": 2})), run(json!({"gauss": 10})));
        println!("{surface}: segments {cut}, 10 x 10 Gauss points {gauss}");
        assert!((cut / gauss - 1.0).abs() < 0.01, "{surface}: {cut} {gauss}");
    }
}
