//! Slave faces cut by the facets of the master.
use crate::blocks::{done, exact, patch, pressures};
use covact::mesh::FaceNodes;
use covact::model::segments::segments;
use covact_geometry::{MovingFacets, Vec3};
use serde_json::json;

/// The patch test on meshes of which no inner edges coincide: no kink lies within a piece, so that the pressure is
/// uniform to rounding, where the Gauss points of whole faces are off by percents.
#[test]
fn segments_pass_the_patch_test_on_meshes_that_do_not_match() {
    let p = exact();
    let off = |upper: &str, lower: &str, points: serde_json::Value| {
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
            .map(|f| covact::shell::Quad::new(f, at).area())
            .sum();
        let whole = segments(&slave, &facets, at, at, 4, 0.0).len();
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
