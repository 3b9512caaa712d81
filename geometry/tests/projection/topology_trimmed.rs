//! Edges, joints, areas, volumes and sides of trimmed faces.

use std::f64::consts::{PI, TAU};

use crate::faces::{disc, face, polygon, ring, trimmed, trimmed_box};
use covact_geometry::primitives::{cylinder, sphere};
use covact_geometry::{EdgeKind, NurbsPatch, PatchSet, Vec3};

fn set(patches: Vec<NurbsPatch>) -> PatchSet {
    PatchSet::new(patches, None).unwrap()
}

/// Every side takes the outward direction `out(point)` at a point of the patch that lies on its border.
fn outward(set: &PatchSet, out: impl Fn(&Vec3) -> Vec3) {
    for (patch, side) in set.patches().iter().zip(set.sides()) {
        let trim = patch.trim();
        let xi = trim.map_or([0.3, 0.4], |t| {
            t.loops()[0]
                .curves
                .last()
                .unwrap()
                .parameter
                .point(0.3)
                .into()
        });
        let jet = patch.jet(xi);
        let n = jet.rho_i[0].cross(&jet.rho_i[1]) * *side;
        assert!(n.dot(&out(&jet.rho)) > 0.0, "{jet:?}");
    }
}

#[test]
fn box_of_trimmed_planes() {
    let half = [1.0, 2.0, 0.5];
    let set = set(trimmed_box(half));
    let report = set.edges();
    assert_eq!(
        (report.sharp, report.smooth, report.joints.len()),
        (12, 0, 12)
    );
    assert!(report.free.is_empty() && report.partial.is_empty() && report.overlaps.is_empty());
    assert!(report.branching.is_empty() && report.open_gaps.is_empty());
    assert!(report.largest_gap < 1e-14);
    assert_eq!(set.components().len(), 1);
    for joint in &report.joints {
        assert!((joint.angle - 0.5 * PI).abs() < 1e-12, "{joint:?}");
    }
    assert!((set.volumes()[0].unwrap() - 8.0).abs() < 1e-12);
    let areas = [4.0, 4.0, 2.0, 2.0, 8.0, 8.0];
    for (area, truth) in set.areas().iter().zip(areas) {
        assert!((area - truth).abs() < 1e-12, "{area} {truth}");
    }
    outward(&set, |x| *x);
}

#[test]
fn cylinder_with_trimmed_caps() {
    let (radius, length) = (1.5, 4.0);
    let tube = || cylinder(radius, length, Vec3::zeros(), Vec3::z()).unwrap();
    for cuts in [&[0.0][..], &[0.7], &[0.3, 0.3 + PI], &[0.1, 0.15, 3.0]] {
        let patches = vec![disc(radius, 2.0, cuts), tube(), disc(radius, -2.0, &[2.0])];
        let set = set(patches);
        let report = set.edges();
        assert!(report.free.is_empty(), "{cuts:?}: {:?}", report.free);
        assert_eq!(set.components().len(), 1);
        assert!(report.largest_gap < 1e-13);
        // The seam, the rim of the lower cap, and that of the upper one if it is a single curve.
        let whole = if cuts.len() == 1 { 2 } else { 1 };
        assert_eq!((report.smooth, report.sharp), (1, whole), "{cuts:?}");
        for partial in &report.partial {
            assert_eq!(partial.share, 1.0, "{partial:?}");
        }
        let volume = PI * radius * radius * length;
        assert!((set.volumes()[0].unwrap() / volume - 1.0).abs() < 1e-6);
        let areas = set.areas();
        assert!((areas[0] / (PI * radius * radius) - 1.0).abs() < 1e-6);
        assert!((areas[1] / (TAU * radius * length) - 1.0).abs() < 1e-6);
        outward(&set, |x| Vec3::new(x.x, x.y, x.z));
    }
}

#[test]
fn plate_with_hole_and_tube() {
    let square = polygon(&[[-2.0, -2.0], [2.0, -2.0], [2.0, 2.0], [-2.0, 2.0]]);
    let e = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
    let plate = face([0.0; 3], e[0], e[1], 3.0, &[square, ring(1.0, &[1.0, 4.0])]);
    let tube = cylinder(1.0, 3.0, Vec3::new(0.0, 0.0, 1.5), Vec3::z()).unwrap();
    let set = set(vec![plate, tube]);
    let report = set.edges();
    // Four sides of the plate and the upper rim of the tube.
    assert_eq!(report.free, [(0, 4), (0, 5), (0, 6), (0, 7), (1, 3)]);
    assert_eq!(set.components().len(), 1);
    let mut rims: Vec<_> = report
        .borders
        .iter()
        .map(|b| (b.edges.len(), b.closed, b.length))
        .collect();
    rims.sort_by_key(|r| r.0);
    assert_eq!(
        (rims[0].0, rims[0].1, rims[1].0, rims[1].1),
        (1, true, 4, true)
    );
    // Polylines are a little short.
    assert!((rims[0].2 / TAU - 1.0).abs() < 5e-3 && (rims[1].2 - 16.0).abs() < 1e-12);
    assert!(set.volumes()[0].is_none());
    assert!((set.areas()[0] - (16.0 - PI)).abs() < 1e-6);
    // The side of the plate on which the tube stands goes over into the outside of the tube.
    let plate_up = set.patches()[0].jet([0.5, 0.5]);
    let up = plate_up.rho_i[0].cross(&plate_up.rho_i[1]).z * set.sides()[0] > 0.0;
    let wall = set.patches()[1].jet([1.0, 1.0]);
    let n = wall.rho_i[0].cross(&wall.rho_i[1]) * set.sides()[1];
    assert_eq!(up, n.dot(&Vec3::new(wall.rho.x, wall.rho.y, 0.0)) > 0.0);
}

#[test]
fn sphere_of_two_half_shells() {
    let ball = sphere(2.0, Vec3::zeros(), Vec3::z()).unwrap();
    let half = |from: f64| {
        let (a, b, h) = (from, from + PI, 0.5 * PI);
        trimmed(
            ball.clone(),
            vec![polygon(&[[a, -h], [b, -h], [b, h], [a, h]])],
        )
    };
    let set = set(vec![half(0.0), half(PI)]);
    let report = set.edges();
    assert_eq!(report.poles, [(0, 4), (0, 6), (1, 4), (1, 6)]);
    assert_eq!((report.smooth, report.sharp, report.free.len()), (2, 0, 0));
    assert_eq!(report.joints[0].kind, EdgeKind::Smooth);
    let truth = 32.0 / 3.0 * PI;
    let volume = set.volumes()[0].unwrap();
    assert!((volume / truth - 1.0).abs() < 1e-5, "{volume} {truth}");
    outward(&set, |x| *x);
}

#[test]
fn contacts_shorter_than_any_sample_are_found() {
    // A strip of width 0.002 against the side of a plate of length 100, in the middle of nowhere.
    let e = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    let plate = polygon(&[[0.0, 0.0], [50.0, 0.0], [50.0, 100.0], [0.0, 100.0]]);
    let plate = face([0.0; 3], e[0], e[1], 120.0, &[plate]);
    let strip = polygon(&[[13.337, 0.0], [13.339, 0.0], [13.339, 1.0], [13.337, 1.0]]);
    let strip = face([0.0; 3], e[1], e[2], 120.0, &[strip]);
    let set = set(vec![plate, strip]);
    assert_eq!(set.components().len(), 1);
    let partial = |edge| set.edges().partial.iter().find(|p| p.edge == edge).unwrap();
    assert_eq!(
        (partial((1, 4)).share, &partial((1, 4)).others[..]),
        (1.0, &[(0, 7)][..])
    );
    assert!((partial((0, 7)).share - 2e-5).abs() < 1e-8);
    // The foot of the strip is a T-joint in a free side.
    assert!(set.edges().free.contains(&(0, 7)) && !set.edges().free.contains(&(1, 4)));
}

#[test]
fn gaps_and_overlaps_are_reported_where_they_are() {
    let e = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
    let rectangle = |x: [f64; 2], y: [f64; 2]| {
        let points = [[x[0], y[0]], [x[1], y[0]], [x[1], y[1]], [x[0], y[1]]];
        face([0.0; 3], e[0], e[1], 10.0, &[polygon(&points)])
    };
    // A wedge of a gap, 1e-4 wide at (0, 0) and 4e-4 at (0, 3).
    let left = face(
        [0.0; 3],
        e[0],
        e[1],
        10.0,
        &[polygon(&[
            [-4.0, 0.0],
            [-1e-4, 0.0],
            [-4e-4, 3.0],
            [-4.0, 3.0],
        ])],
    );
    let right = || rectangle([0.0, 4.0], [0.0, 3.0]);
    let apart = PatchSet::new(vec![left.clone(), right()], Some(1e-5)).unwrap();
    assert_eq!(apart.components().len(), 2);
    let [gap] = &apart.edges().open_gaps[..] else {
        panic!("{:?}", apart.edges().open_gaps);
    };
    assert_eq!(gap.edges, [(0, 5), (1, 7)]);
    assert!((gap.gap - 4e-4).abs() < 1e-9 && (gap.at - Vec3::new(-2e-4, 3.0, 0.0)).norm() < 1e-9);
    let joined = PatchSet::new(vec![left, right()], Some(1e-3)).unwrap();
    assert_eq!(joined.components().len(), 1);
    let gap = joined.edges().largest_gap_at.as_ref().unwrap();
    assert_eq!(gap.edges, [(0, 5), (1, 7)]);
    assert!((gap.gap - 4e-4).abs() < 1e-9 && (gap.at - Vec3::new(-2e-4, 3.0, 0.0)).norm() < 1e-9);
    assert!(joined.edges().open_gaps.is_empty() && joined.edges().overlaps.is_empty());

    // Without a stated tolerance whole edges are joined over 1e-4 of the size.
    let near = |gap: f64| set(vec![rectangle([-4.0, -gap], [0.0, 3.0]), right()]);
    assert_eq!(near(4e-4).components().len(), 1);
    assert!((near(4e-4).edges().largest_gap - 4e-4).abs() < 1e-12);
    assert_eq!(near(4e-3).components().len(), 2);
    assert_eq!(near(4e-3).edges().open_gaps.len(), 1);

    // Two plates that run over each other by 0.25.
    let over = set(vec![rectangle([-4.0, 0.25], [0.5, 2.5]), right()]);
    let overlaps = &over.edges().overlaps;
    let inside = overlaps.iter().find(|o| o.edge == (0, 5)).unwrap();
    assert_eq!((inside.patch, inside.share), (1, 1.0));
    assert!((inside.depth - 0.25).abs() < 1e-12, "{inside:?}");
    assert!((inside.at.x - 0.25).abs() < 1e-12);
    let other = overlaps.iter().find(|o| o.edge == (1, 7)).unwrap();
    assert!(other.patch == 0 && (other.share - 2.0 / 3.0).abs() < 0.3 && other.depth <= 0.25);
}

#[test]
fn numbers_of_the_file_bridge_wider_gaps() {
    use covact_geometry::trim::{Trim, TrimLoop};
    let e = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
    let make = |x: [f64; 2], number: usize| {
        let points = [[x[0], 0.0], [x[1], 0.0], [x[1], 3.0], [x[0], 3.0]];
        let patch = face([0.0; 3], e[0], e[1], 10.0, &[polygon(&points)]);
        let mut curves = patch.trim().unwrap().loops()[0].curves.clone();
        for (k, curve) in curves.iter_mut().enumerate() {
            curve.entity = if k == number {
                17
            } else {
                100 + (10 * x[1] as i32 + k as i32) as u32
            };
        }
        let domain = patch.domain();
        let trim = Trim::new(vec![TrimLoop { curves }], domain, 1e-9).unwrap();
        patch.with_trim(Some(trim))
    };
    let gap = 5e-4;
    let named =
        PatchSet::new(vec![make([-4.0, -gap], 1), make([0.0, 4.0], 3)], Some(1e-5)).unwrap();
    assert_eq!(named.components().len(), 1);
    assert!(named.edges().joints[0].same_entity);
    assert!((named.edges().largest_gap - gap).abs() < 1e-12);
    let unnamed =
        PatchSet::new(vec![make([-4.0, -gap], 0), make([0.0, 4.0], 2)], Some(1e-5)).unwrap();
    assert_eq!(unnamed.components().len(), 2);
}

#[test]
fn order_direction_and_exchange_of_parameters_change_nothing() {
    let six =
        covact_geometry::primitives::sphere_without_poles(2.0, Vec3::zeros(), Vec3::z()).unwrap();
    let reference = set(six.to_vec());
    let mut turned: Vec<NurbsPatch> = six.to_vec();
    turned[1] = turned[1].swapped().unwrap();
    turned[3] = turned[3].reversed(0).unwrap();
    turned[4] = turned[4].reversed(1).unwrap().swapped().unwrap();
    turned.rotate_left(2);
    let turned = set(turned);
    for set in [&reference, &turned] {
        assert_eq!((set.edges().smooth, set.edges().free.len()), (12, 0));
        assert!((set.volumes()[0].unwrap() / (32.0 / 3.0 * PI) - 1.0).abs() < 1e-6);
        for (patch, side) in set.patches().iter().zip(set.sides()) {
            let jet = patch.jet([0.8, 0.8]);
            assert!(jet.rho_i[0].cross(&jet.rho_i[1]).dot(&jet.rho) * side > 0.0);
        }
    }
    let q = Vec3::new(1.0, 2.0, -0.7);
    let [a, b] = [&reference, &turned].map(|s| s.project(&q, None, f64::INFINITY).unwrap());
    assert!((a.signed_distance - b.signed_distance).abs() < 1e-13);
    assert!((a.normal - b.normal).norm() < 1e-12);
}

#[test]
fn a_punch_of_45_patches() {
    let path = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../assets/punch.igs");
    let file = covact_geometry::io::read_path(&path).unwrap();
    let set = set(file.patches.into_iter().map(|p| p.patch).collect());
    let report = set.edges();
    // 45 patches have 180 edges: two of each of the 84 joints, and the rim.
    assert_eq!(
        (report.smooth, report.sharp, report.free.len()),
        (84, 0, 12)
    );
    assert_eq!((report.borders.len(), report.borders[0].closed), (1, true));
    assert_eq!((set.components().len(), report.open_gaps.len()), (1, 0));
    assert!(report.largest_gap < 1e-12 * set.size());
}
