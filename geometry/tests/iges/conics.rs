//! Arcs and conics of IGES files against their own definitions (IGES 5.3, ANS US PRO/IPO-100-1996, section 4): each point of
//! the NURBS form at the mapped parameter is the point that the entity's formula gives.

use crate::builder::{Builder, values};
use crate::read::{one, read, reason, worst_on_curve};
use covact_geometry::Vec3;
use covact_geometry::io::IgesCurve;
use std::f64::consts::{FRAC_PI_2, PI, TAU};

#[test]
fn arcs_of_any_angle() {
    for (from, sweep) in [
        (0.0, FRAC_PI_2),
        (0.3, 1e-3),
        (1.0, 3.0),
        (4.0, 6.0),
        (6.2, 0.5),
        (2.0, TAU),
        (0.0, TAU),
    ] {
        let at = |t: f64| [3.0 + 2.5 * f64::cos(t), -1.0 + 2.5 * f64::sin(t)];
        let [s, e] = [at(from), at(from + if sweep == TAU { 0.0 } else { sweep })];
        let text = values(&[0.75, 3.0, -1.0, s[0], s[1], e[0], e[1]]);
        let curve = one(100, 0, &text);
        let [a, b] = curve.parameters.file_range();
        assert!(
            (a - from).abs() < 1e-12 && (b - a - sweep).abs() < 1e-12,
            "{a} {b}"
        );
        let off = worst_on_curve(&curve, |t| Vec3::new(at(t)[0], at(t)[1], 0.75));
        assert!(off < 2e-15 * 10.0, "{from} {sweep}: {off:.1e}");
        assert_eq!((curve.deviation, curve.gap), (0.0, 0.0));
    }
    assert!(reason(100, 0, "0.,1.,1.,1.,1.,2.,1.").contains("without a radius"));
}

/// Ends of a circle that misses itself by the ninth digit, and an end off the circle.
#[test]
fn arcs_of_rounded_numbers() {
    let full = one(100, 0, "0.,0.,0.,1.,0.,0.9999999999,-0.000000001");
    let [a, b] = full.parameters.file_range();
    assert!((b - a - TAU).abs() < 1e-15);
    let mut file = Builder::new();
    file.add(100, "0.,0.,0.,1.,0.,0.,1.1");
    let found = read(&file);
    assert_eq!(found.notes.len(), 1);
    assert!(
        found.notes[0].contains("off the circle"),
        "{}",
        found.notes[0]
    );
}

/// Coefficients of the conic p^2 a + q^2 b = 1 with p, q along axes turned by `angle` about (x0, y0), times a factor.
fn turned_conic(a: f64, b: f64, angle: f64, [x0, y0]: [f64; 2], factor: f64) -> [f64; 6] {
    let (s, c) = angle.sin_cos();
    let (qa, qb, qc) = (
        a * c * c + b * s * s,
        2.0 * (a - b) * s * c,
        a * s * s + b * c * c,
    );
    let (d, e) = (-2.0 * qa * x0 - qb * y0, -2.0 * qc * y0 - qb * x0);
    let f = qa * x0 * x0 + qb * x0 * y0 + qc * y0 * y0 - 1.0;
    [qa, qb, qc, d, e, f].map(|x| x * factor)
}

fn terms(k: &[f64; 6], [x, y]: [f64; 2]) -> [f64; 6] {
    [
        k[0] * x * x,
        k[1] * x * y,
        k[2] * y * y,
        k[3] * x,
        k[4] * y,
        k[5],
    ]
}

/// Points of the arc satisfy the equation to 1e-13 of its terms there or at the ends, the ends are those of the file.
fn check_conic(k: &[f64; 6], form: i32, z: f64, ends: [[f64; 2]; 2]) -> IgesCurve {
    let [s, e] = ends;
    let numbers = [&k[..], &[z, s[0], s[1], e[0], e[1]]].concat();
    let curve = one(104, form, &values(&numbers));
    let [a, b] = curve.curve.domain();
    for i in 0..=100 {
        let x = curve.curve.point(a + (b - a) * f64::from(i) / 100.0);
        let size = |x: [f64; 2]| terms(k, x).iter().map(|t| t.abs()).sum::<f64>();
        let value = terms(k, [x.x, x.y]).iter().sum::<f64>().abs();
        let off = value / size([x.x, x.y]).max(size(s)).max(size(e));
        assert!(off < 1e-13, "{off:.1e}");
        assert_eq!(x.z, z);
    }
    for (end, x) in ends.iter().zip(curve.curve.ends()) {
        let off = (Vec3::new(end[0], end[1], z) - x).norm();
        assert!(off < 1e-12, "{off:.1e}");
    }
    curve
}

#[test]
fn ellipses() {
    // Standard position: x^2 / 9 + y^2 / 4 = 1, parameter t of (3 cos t, 2 sin t).
    let at = |t: f64| [3.0 * t.cos(), 2.0 * t.sin()];
    let k = turned_conic(1.0 / 9.0, 0.25, 0.0, [0.0, 0.0], -36.0);
    for (from, to) in [(0.2, 1.0), (0.0, 4.0), (5.0, 9.0)] {
        let curve = check_conic(&k, 1, 0.5, [at(from), at(to)]);
        let off = worst_on_curve(&curve, |t| Vec3::new(at(t)[0], at(t)[1], 0.5));
        assert!(off < 1e-14, "{off:.1e}");
        assert!((curve.parameters.file_range()[0] - from).abs() < 1e-14);
    }
    let whole = check_conic(&k, 1, 0.5, [at(0.0), at(0.0)]);
    assert!((whole.parameters.file_range()[1] - TAU).abs() < 1e-14);
    // Turned, thin, off the origin.
    for angle in [0.3, 1.2, 2.5, -0.7] {
        let (s, c) = f64::sin_cos(angle);
        let at = |t: f64| {
            let (p, q) = (3.0 * t.cos(), 0.2 * t.sin());
            [1.0 + c * p - s * q, -2.0 + s * p + c * q]
        };
        let k = turned_conic(1.0 / 9.0, 25.0, angle, [1.0, -2.0], 7.0);
        check_conic(&k, 1, 0.0, [at(0.5), at(3.5)]);
        check_conic(&k, 0, 0.0, [at(-0.5), at(0.5)]);
    }
}

#[test]
fn hyperbolas() {
    // x^2 / 4 - y^2 = 1: (2 sec t, tan t); the other branch has t between pi / 2 and 3 pi / 2.
    let k = turned_conic(0.25, -1.0, 0.0, [0.0, 0.0], 4.0);
    let at = |t: f64| [2.0 / t.cos(), t.tan()];
    for (from, to) in [(-1.2, 1.0), (0.1, 1.5), (PI - 0.4, PI + 1.1)] {
        let curve = check_conic(&k, 2, -1.0, [at(from), at(to)]);
        let [a, b] = curve.parameters.file_range();
        assert!(
            (a - from).abs() < 1e-13 && (b - to).abs() < 1e-13,
            "{a} {b}"
        );
        let off = worst_on_curve(&curve, |t| Vec3::new(at(t)[0], at(t)[1], -1.0));
        assert!(off < 1e-13 * 30.0, "{off:.1e}");
    }
    // Run through backwards, turned, opening along the second axis.
    let back = check_conic(&k, 2, 0.0, [at(1.0), at(-1.2)]);
    assert!((back.curve.ends()[0].y - 1.0f64.tan()).abs() < 1e-13);
    for angle in [0.4, 1.9] {
        let (s, c) = f64::sin_cos(angle);
        let at = |t: f64| {
            let (q, p) = (1.5 / t.cos(), 0.5 * t.tan());
            [2.0 + c * p - s * q, 1.0 + s * p + c * q]
        };
        let k = turned_conic(-4.0, 1.0 / 2.25, angle, [2.0, 1.0], 0.1);
        check_conic(&k, 2, 0.0, [at(-1.0), at(1.3)]);
    }
    // The ends on different branches.
    let text = values(&[&k[..], &[0.0, 2.0, 0.0, -2.0, 0.0]].concat());
    assert!(reason(104, 2, &text).contains("different branches"));
}

#[test]
fn parabolas() {
    // y = x^2 / 2, parameter x.
    let k = [1.0, 0.0, 0.0, 0.0, -2.0, 0.0];
    let at = |t: f64| [t, 0.5 * t * t];
    let curve = check_conic(&k, 3, 2.0, [at(-1.0), at(3.0)]);
    assert_eq!(curve.parameters.file_range(), [-1.0, 3.0]);
    assert!(worst_on_curve(&curve, |t| Vec3::new(t, 0.5 * t * t, 2.0)) < 1e-15 * 8.0);
    check_conic(&k, 3, 0.0, [at(3.0), at(-1.0)]);
    // Along y, and turned: (c x + s y)^2 = 4 (c y - s x) + 1.
    check_conic(
        &[0.0, 0.0, -2.0, 1.0, 0.0, 0.0],
        3,
        0.0,
        [[2.0, 1.0], [8.0, -2.0]],
    );
    let (s, c) = f64::sin_cos(0.6);
    let k = [c * c, 2.0 * s * c, s * s, 4.0 * s, -4.0 * c, -1.0];
    let at = |t: f64| {
        let q = (t * t - 1.0) / 4.0;
        [c * t - s * q, s * t + c * q]
    };
    for form in [0, 3] {
        check_conic(&k, form, 0.0, [at(-2.0), at(1.5)]);
    }
}

#[test]
fn conics_that_are_none() {
    // (x - y)(x + y) = 0: both ends on the same line, then on different ones.
    let line = one(104, 0, "1.,0.,-1.,0.,0.,0.,3.,1.,1.,2.,2.");
    assert_eq!(line.curve.degree(), 1);
    assert!((line.curve.point(0.5) - Vec3::new(1.5, 1.5, 3.0)).norm() < 1e-15);
    assert!(reason(104, 0, "1.,0.,-1.,0.,0.,0.,0.,1.,1.,2.,-2.").contains("two lines"));
    // x^2 = 1, and x + y = 3 with no square at all.
    assert_eq!(
        one(104, 0, "1.,0.,0.,0.,0.,-1.,0.,1.,0.,1.,5.")
            .curve
            .degree(),
        1
    );
    assert_eq!(
        one(104, 0, "0.,0.,0.,1.,1.,-3.,0.,1.,2.,2.,1.")
            .curve
            .degree(),
        1
    );
    assert!(reason(104, 1, "1.,0.,1.,0.,0.,1.,0.,1.,0.,0.,1.").contains("without real points"));
    assert!(reason(104, 1, "1.,0.,1.,0.,0.,0.,0.,0.,0.,0.,0.").contains("single point"));
}
