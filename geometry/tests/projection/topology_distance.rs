//! Signed distances of closed sets of patches against exact ones, inside and outside.

use std::f64::consts::FRAC_PI_2;

use crate::common::{Random, check_foot, queries};
use crate::faces::{
    box_distance, cylinder_distance, disc, face, polygon, ring, trimmed, trimmed_box,
};
use covact_geometry::primitives::{cylinder, sphere};
use covact_geometry::{NurbsPatch, PatchSet, Vec3};
use nalgebra::Isometry3;

/// Compares `set` with the exact distance at random points of a box `reach` about the middle, half of them near the
/// surface (moved from a foot along a random direction). The sign must never be wrong.
fn compare(name: &str, set: &PatchSet, reach: f64, truth: impl Fn(&Vec3) -> f64) {
    let mut random = Random(41);
    let (mut wrong, mut sign, mut inside) = (0, 0, 0);
    let count = queries(1200);
    for k in 0..count {
        let mut q = Vec3::from_fn(|_, _| random.between(-reach, reach));
        if k % 2 == 1 {
            let foot = set.project(&q, None, f64::INFINITY).unwrap();
            q = foot.jet.rho + random.direction() * random.between(0.0, 0.1 * reach);
        }
        let truth = truth(&q);
        let foot = set.project(&q, None, f64::INFINITY).unwrap();
        check_foot(set, &q, &foot);
        inside += usize::from(truth < 0.0);
        let limit = 1e-11 * set.size();
        if (foot.distance - truth.abs()).abs() > limit {
            eprintln!("{name}: {q:?} truth {truth:e} {foot:?}");
            wrong += 1;
        }
        if truth.abs() > limit && foot.signed_distance * truth < 0.0 {
            eprintln!("{name}: sign at {q:?} truth {truth:e} {foot:?}");
            sign += 1;
        }
    }
    eprintln!("{name}: {wrong} distances and {sign} signs wrong of {count}, {inside} inside");
    assert!(inside > count / 20);
    assert_eq!((wrong, sign), (0, 0));
}

/// Rectangle from `low` to `high`, which differ in two coordinates.
fn rectangle(low: [f64; 3], high: [f64; 3], turn: bool) -> NurbsPatch {
    let flat = (0..3).find(|&k| low[k] == high[k]).unwrap();
    let corner = |ends: [bool; 2]| {
        let mut p = low;
        for (k, end) in [(flat + 1) % 3, (flat + 2) % 3].into_iter().zip(ends) {
            p[k] = if end { high[k] } else { low[k] };
        }
        Vec3::from(p)
    };
    let points = [[false, false], [true, false], [false, true], [true, true]].map(corner);
    let knots = vec![0.0, 0.0, 1.0, 1.0];
    let patch = NurbsPatch::new([1; 2], [knots.clone(), knots], [2; 2], &points, None).unwrap();
    if turn {
        patch.swapped().unwrap()
    } else {
        patch
    }
}

#[test]
fn stairs_with_t_joints() {
    // A lower block and one on its left half; the sides at x = 0 and z = 0 are one rectangle each, the fronts two.
    let faces = [
        ([0.0, 0.0, 0.0], [2.0, 2.0, 0.0]),
        ([0.0, 0.0, 0.0], [0.0, 2.0, 2.0]),
        ([2.0, 0.0, 0.0], [2.0, 2.0, 1.0]),
        ([0.0, 0.0, 0.0], [2.0, 0.0, 1.0]),
        ([0.0, 0.0, 1.0], [1.0, 0.0, 2.0]),
        ([0.0, 2.0, 0.0], [2.0, 2.0, 1.0]),
        ([0.0, 2.0, 1.0], [1.0, 2.0, 2.0]),
        ([0.0, 0.0, 2.0], [1.0, 2.0, 2.0]),
        ([1.0, 0.0, 1.0], [2.0, 2.0, 1.0]),
        ([1.0, 0.0, 1.0], [1.0, 2.0, 2.0]),
    ];
    let patches = faces
        .iter()
        .enumerate()
        .map(|(k, f)| rectangle(f.0, f.1, k % 3 == 0));
    let set = PatchSet::new(patches.collect(), None).unwrap();
    assert!(set.edges().free.is_empty(), "{:?}", set.edges().free);
    assert!((set.volumes()[0].unwrap() - 6.0).abs() < 1e-12);
    let truth = |q: &Vec3| {
        let near = |(low, high): &([f64; 3], [f64; 3])| {
            Vec3::from_fn(|k, _| q[k] - q[k].clamp(low[k], high[k])).norm()
        };
        let distance = faces.iter().map(near).fold(f64::INFINITY, f64::min);
        let within = |high: [f64; 3]| (0..3).all(|k| q[k] > 0.0 && q[k] < high[k]);
        let inside = within([2.0, 2.0, 1.0]) || within([1.0, 2.0, 2.0]);
        if inside { -distance } else { distance }
    };
    compare("stairs", &set, 2.5, truth);
}

/// Box of half extents `core` rounded by `r`: planes, quarter cylinders, eighths of spheres with a pole each.
fn rounded_box(core: [f64; 3], r: f64) -> Vec<NurbsPatch> {
    let mut patches = Vec::new();
    for axis in 0..3 {
        let (i, j) = ((axis + 1) % 3, (axis + 2) % 3);
        for end in [-1.0, 1.0] {
            let (mut low, mut high) = ([0.0; 3], [0.0; 3]);
            for k in [i, j] {
                (low[k], high[k]) = (-core[k], core[k]);
            }
            low[axis] = end * (core[axis] + r);
            high[axis] = low[axis];
            patches.push(rectangle(low, high, end > 0.0));
        }
        // Around the axis; the angles of the cylinder begin at another axis, so its quarters are told by where they are.
        let mut unit = Vec3::zeros();
        unit[axis] = 1.0;
        let whole = cylinder(r, 2.0 * core[axis], Vec3::zeros(), unit).unwrap();
        for quarter in 0..4 {
            let start = f64::from(quarter) * FRAC_PI_2;
            let domain = [[start, start + FRAC_PI_2], whole.domain()[1]];
            let part = whole.with_domain(domain).unwrap();
            let middle = part.point([start + 0.5 * FRAC_PI_2, core[axis]]);
            let mut shift = Vec3::zeros();
            for k in [i, j] {
                shift[k] = core[k] * middle[k].signum();
            }
            let motion = Isometry3::translation(shift.x, shift.y, shift.z);
            patches.push(part.moved(&motion, 1.0).unwrap());
        }
    }
    let ball = sphere(r, Vec3::zeros(), Vec3::z()).unwrap();
    for eighth in 0..8 {
        let start = f64::from(eighth % 4) * FRAC_PI_2;
        let height = if eighth < 4 {
            [0.0, FRAC_PI_2]
        } else {
            [-FRAC_PI_2, 0.0]
        };
        let part = ball
            .with_domain([[start, start + FRAC_PI_2], height])
            .unwrap();
        let middle = part.point([start + 0.5 * FRAC_PI_2, 0.5 * (height[0] + height[1])]);
        let shift = Vec3::from_fn(|k, _| core[k] * middle[k].signum());
        let motion = Isometry3::translation(shift.x, shift.y, shift.z);
        patches.push(part.moved(&motion, 1.0).unwrap());
    }
    patches
}

#[test]
fn rounded_box_of_26_patches() {
    let (core, r) = ([1.0, 0.6, 0.8], 0.3);
    let set = PatchSet::new(rounded_box(core, r), None).unwrap();
    let report = set.edges();
    assert_eq!((report.smooth, report.sharp, report.free.len()), (48, 0, 0));
    assert_eq!(report.poles.len(), 8);
    assert_eq!(set.components().len(), 1);
    compare("rounded box", &set, 2.0, |q| box_distance(core, q) - r);
}

#[test]
fn untrimmed_box() {
    let half = [1.0, 2.0, 0.5];
    let mut patches = Vec::new();
    for axis in 0..3 {
        for end in [-1.0, 1.0] {
            let (mut low, mut high) = (half.map(|x| -x), half);
            low[axis] = end * half[axis];
            high[axis] = low[axis];
            patches.push(rectangle(low, high, axis == 1));
        }
    }
    let set = PatchSet::new(patches, None).unwrap();
    compare("box", &set, 2.5, |q| box_distance(half, q));
}

#[test]
fn box_of_trimmed_planes() {
    let half = [1.0, 2.0, 0.5];
    let set = PatchSet::new(trimmed_box(half), None).unwrap();
    compare("trimmed box", &set, 2.5, |q| box_distance(half, q));
}

#[test]
fn cylinder_with_trimmed_caps() {
    let (radius, half) = (1.5, 1.0);
    let tube = cylinder(radius, 2.0 * half, Vec3::zeros(), Vec3::z()).unwrap();
    // One rim is a single curve, the other three.
    let caps = [
        disc(radius, half, &[0.7]),
        disc(radius, -half, &[0.1, 0.15, 3.0]),
    ];
    for patches in [
        vec![caps[0].clone(), tube.clone(), caps[1].clone()],
        vec![tube.swapped().unwrap(), caps[1].clone(), caps[0].clone()],
    ] {
        let set = PatchSet::new(patches, None).unwrap();
        compare("cylinder", &set, 2.5, |q| {
            cylinder_distance(radius, half, q)
        });
    }
}

#[test]
fn sphere_of_two_half_shells() {
    let ball = sphere(2.0, Vec3::zeros(), Vec3::z()).unwrap();
    let half = |from: f64| {
        let (a, b, h) = (from, from + 2.0 * FRAC_PI_2, FRAC_PI_2);
        trimmed(
            ball.clone(),
            vec![polygon(&[[a, -h], [b, -h], [b, h], [a, h]])],
        )
    };
    let set = PatchSet::new(vec![half(0.0), half(2.0 * FRAC_PI_2)], None).unwrap();
    compare("half-shells", &set, 2.5, |q| q.norm() - 2.0);
}

/// Square prism of half width 2 and half height 1 with a round hole of radius 1 along z: two plates with holes, four
/// rectangles, the wall of the hole.
#[test]
fn block_with_a_hole() {
    let e = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
    let square = || polygon(&[[-2.0, -2.0], [2.0, -2.0], [2.0, 2.0], [-2.0, 2.0]]);
    let plate =
        |z: f64, cuts: &[f64]| face([0.0, 0.0, z], e[0], e[1], 3.0, &[square(), ring(1.0, cuts)]);
    let mut patches = vec![
        plate(1.0, &[0.4]),
        plate(-1.0, &[1.0, 2.0, 5.0]),
        cylinder(1.0, 2.0, Vec3::zeros(), Vec3::z()).unwrap(),
    ];
    for axis in 0..2 {
        for end in [-2.0, 2.0] {
            let (mut low, mut high) = ([-2.0, -2.0, -1.0], [2.0, 2.0, 1.0]);
            low[axis] = end;
            high[axis] = end;
            patches.push(rectangle(low, high, end > 0.0));
        }
    }
    let set = PatchSet::new(patches, None).unwrap();
    assert!(set.edges().free.is_empty(), "{:?}", set.edges().free);
    let volume = 2.0 * (16.0 - 2.0 * FRAC_PI_2);
    assert!((set.volumes()[0].unwrap() / volume - 1.0).abs() < 1e-6);
    compare("block with a hole", &set, 2.6, |q| {
        let outer = box_distance([2.0, 2.0, 1.0], q);
        let hole = q.x.hypot(q.y) - 1.0;
        let beyond = (q.z.abs() - 1.0).max(0.0);
        if outer <= 0.0 && hole >= 0.0 {
            // In the material: the nearest wall.
            outer.max(-hole)
        } else if hole < 0.0 {
            // In or above the hole: its wall or rim.
            (-hole).hypot(beyond)
        } else {
            outer
        }
    });
}
