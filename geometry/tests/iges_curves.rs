//! Curve entities of IGES files against their own definitions (IGES 5.3, ANS US PRO/IPO-100-1996, section 4): each point
//! of the NURBS form at the mapped parameter is the point that the entity's formula gives.

mod iges_builder;

use covact_geometry::Vec3;
use covact_geometry::io::{IgesCurve, IgesGeometry, read_iges_geometry};
use iges_builder::{Builder, Entity, values};
use std::f64::consts::{FRAC_PI_2, PI, TAU};

fn read(file: &Builder) -> IgesGeometry {
    let text = file.text();
    read_iges_geometry(text.as_bytes(), "hand.igs").unwrap_or_else(|e| panic!("{e}\n{text}"))
}

/// The only curve of a file of one entity.
fn one(type_number: u32, form: i32, values: &str) -> IgesCurve {
    let mut file = Builder::new();
    file.form(type_number, form, values);
    let found = read(&file);
    assert!(found.skipped.is_empty(), "{:?}", found.skipped);
    assert!(found.notes.is_empty(), "{:?}", found.notes);
    found.curves[0].clone()
}

fn reason(type_number: u32, form: i32, values: &str) -> String {
    let mut file = Builder::new();
    file.form(type_number, form, values);
    let found = read(&file);
    assert!(found.curves.is_empty());
    found.skipped[0].reason.clone()
}

/// Largest distance between the curve and `truth` at parameters of the file, ends included.
fn worst(curve: &IgesCurve, truth: impl Fn(f64) -> Vec3) -> f64 {
    let [a, b] = curve.parameters.file_range();
    let samples = (0..=200).map(|k| a + (b - a) * f64::from(k) / 200.0);
    samples
        .map(|t| {
            let own = curve.parameters.to_own(t);
            let back = curve.parameters.to_file(own);
            assert!((back - t).abs() < 1e-12 * (b - a), "{t} {back}");
            (curve.curve.point(own) - truth(t)).norm()
        })
        .fold(0.0, f64::max)
}

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
        let off = worst(&curve, |t| Vec3::new(at(t)[0], at(t)[1], 0.75));
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

fn on_conic(k: &[f64; 6], x: Vec3) -> f64 {
    let terms = [
        k[0] * x.x * x.x,
        k[1] * x.x * x.y,
        k[2] * x.y * x.y,
        k[3] * x.x,
        k[4] * x.y,
        k[5],
    ];
    let size = terms.iter().map(|t| t.abs()).sum::<f64>();
    terms.iter().sum::<f64>().abs() / size.max(f64::MIN_POSITIVE)
}

/// Points of the arc satisfy the equation to 1e-13 of its terms, the ends are those of the file.
fn check_conic(k: &[f64; 6], form: i32, z: f64, ends: [[f64; 2]; 2]) -> IgesCurve {
    let [s, e] = ends;
    let numbers = [&k[..], &[z, s[0], s[1], e[0], e[1]]].concat();
    let curve = one(104, form, &values(&numbers));
    let [a, b] = curve.curve.domain();
    for i in 0..=100 {
        let x = curve.curve.point(a + (b - a) * f64::from(i) / 100.0);
        assert!(on_conic(k, x) < 1e-13, "{:.1e}", on_conic(k, x));
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
        let off = worst(&curve, |t| Vec3::new(at(t)[0], at(t)[1], 0.5));
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
        let off = worst(&curve, |t| Vec3::new(at(t)[0], at(t)[1], -1.0));
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
    assert!(worst(&curve, |t| Vec3::new(t, 0.5 * t * t, 2.0)) < 1e-15 * 8.0);
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

#[test]
fn lines_and_polylines() {
    let line = one(110, 0, "1.,2.,3.,4.,6.,3.");
    assert!(worst(&line, |t| Vec3::new(1.0 + 3.0 * t, 2.0 + 4.0 * t, 3.0)) < 1e-15 * 8.0);
    assert!(reason(110, 1, "0.,0.,0.,1.,0.,0.").contains("half line"));
    assert!(reason(110, 2, "0.,0.,0.,1.,0.,0.").contains("without ends"));
    let flat = one(106, 11, "1,3,7.,0.,0.,2.,0.,2.,5.");
    let corner = [[0.0, 0.0], [2.0, 0.0], [2.0, 5.0]];
    let along = |t: f64| {
        let k = (t.floor() as usize).min(1);
        let s = t - k as f64;
        let [p, q] = [corner[k], corner[k + 1]];
        Vec3::new(p[0] + (q[0] - p[0]) * s, p[1] + (q[1] - p[1]) * s, 7.0)
    };
    assert!(worst(&flat, along) < 1e-15);
    for (form, text) in [
        (12, "2,3,0.,0.,1.,2.,0.,1.,2.,5.,1."),
        (2, "2,3,0.,0.,1.,2.,0.,1.,2.,5.,1."),
        (
            13,
            "3,3,0.,0.,1.,9.,9.,9.,2.,0.,1.,9.,9.,9.,2.,5.,1.,9.,9.,9.",
        ),
    ] {
        let curve = one(106, form, text);
        assert!(
            worst(&curve, |t| along(t) - Vec3::z() * 6.0) < 1e-15,
            "{form}"
        );
    }
    let closed = one(106, 63, "1,4,0.,0.,0.,1.,0.,1.,1.,0.,0.");
    let [start, end] = closed.curve.ends();
    assert_eq!(start, end);
    assert!(reason(106, 20, "1,2,0.,0.,0.,1.,1.").contains("no curve"));
    assert!(reason(106, 11, "1,2,0.,1.,1.,1.,1.").contains("two different points"));
}

/// Coefficients (a, b, c, d by coordinate) of a 112 of several pieces.
fn spline_112(kind: u32, breaks: &[f64], pieces: &[[[f64; 4]; 3]]) -> String {
    let mut numbers: Vec<f64> = breaks.to_vec();
    numbers.extend(pieces.iter().flatten().flatten());
    // Values and derivatives at the end; not needed.
    numbers.extend([0.0; 12]);
    format!("{kind},2,3,{},{}", pieces.len(), values(&numbers))
}

fn polynomial(breaks: &[f64], pieces: &[[[f64; 4]; 3]], u: f64) -> Vec3 {
    let last = pieces.len() - 1;
    let k = breaks[1..=last].iter().take_while(|&&b| u >= b).count();
    let s = u - breaks[k];
    Vec3::from(pieces[k].map(|[a, b, c, d]| a + (b + (c + d * s) * s) * s))
}

/// The Taylor coefficients of a piece moved on by `h`, so that the next piece is as smooth as asked for.
fn next_piece([a, b, c, d]: [f64; 4], h: f64, smooth: usize, kick: f64) -> [f64; 4] {
    let mut t = [
        a + (b + (c + d * h) * h) * h,
        b + (2.0 * c + 3.0 * d * h) * h,
        c + 3.0 * d * h,
        d,
    ];
    for x in &mut t[smooth + 1..] {
        *x += kick;
    }
    t
}

#[test]
fn parametric_splines() {
    let first = [
        [1.0, 2.0, -0.5, 0.25],
        [0.0, 1.0, 0.75, -0.3],
        [2.0, -1.0, 0.1, 0.2],
    ];
    let breaks = [0.5, 1.5, 1.75, 4.0];
    // Continuity of position, slope, curvature: knots inside three, two and one times.
    for (smooth, points) in [(0, 10), (1, 8), (2, 6)] {
        let mut pieces = vec![first];
        for k in 0..2 {
            let h = breaks[k + 1] - breaks[k];
            let before = pieces[k];
            pieces.push(before.map(|c| next_piece(c, h, smooth, 0.4)));
        }
        let curve = one(112, 0, &spline_112(3, &breaks, &pieces));
        assert_eq!(curve.curve.homogeneous().len(), points);
        assert_eq!(curve.parts.len(), 1);
        assert!(curve.parameters.is_identity());
        let off = worst(&curve, |u| polynomial(&breaks, &pieces, u));
        assert!(off < 1e-13, "{smooth}: {off:.1e}");
    }
    // Lines and parabolas keep their degree.
    let line = [
        [1.0, 2.0, 0.0, 0.0],
        [0.0, 1.0, 0.0, 0.0],
        [2.0, 0.0, 0.0, 0.0],
    ];
    let curve = one(112, 0, &spline_112(1, &[0.0, 2.0], &[line]));
    assert_eq!(curve.curve.degree(), 1);
    let parabola = [
        [1.0, 2.0, 1.0, 0.0],
        [0.0, 1.0, -1.0, 0.0],
        [2.0, 0.0, 0.0, 0.0],
    ];
    let curve = one(112, 0, &spline_112(2, &[0.0, 2.0], &[parabola]));
    assert_eq!(curve.curve.degree(), 2);
    assert!(worst(&curve, |u| polynomial(&[0.0, 2.0], &[parabola], u)) < 1e-14);
    // Pieces that do not meet: two curves, and a note.
    let mut file = Builder::new();
    let mut apart = first;
    apart[0][0] += 50.0;
    file.add(112, &spline_112(3, &[0.0, 1.0, 2.0], &[first, apart]));
    let found = read(&file);
    assert_eq!(found.curves[0].parts.len(), 2);
    assert!(found.notes[0].contains("apart"), "{:?}", found.notes);
    for (k, part) in found.curves[0].parts.iter().enumerate() {
        assert_eq!(part.domain(), [k as f64, k as f64 + 1.0]);
        for i in 1..10 {
            let u = k as f64 + f64::from(i) / 10.0;
            let truth = polynomial(&[0.0, 1.0, 2.0], &[first, apart], u);
            assert!((part.point(u) - truth).norm() < 1e-14);
        }
    }
}

fn spline_126(
    degree: usize,
    knots: &[f64],
    weights: &[f64],
    points: &[[f64; 3]],
    range: [f64; 2],
) -> String {
    let mut numbers = knots.to_vec();
    numbers.extend(weights);
    numbers.extend(points.iter().flatten());
    numbers.extend(range);
    numbers.extend([0.0, 0.0, 1.0]);
    format!("{},{degree},0,0,0,0,{}", points.len() - 1, values(&numbers))
}

/// Cox-de Boor by its definition.
fn basis(i: usize, p: usize, knots: &[f64], t: f64) -> f64 {
    if p == 0 {
        return f64::from(u8::from(knots[i] <= t && t < knots[i + 1]));
    }
    let share = |a: f64, b: f64, c: f64| if b > a { c / (b - a) } else { 0.0 };
    share(knots[i], knots[i + p], t - knots[i]) * basis(i, p - 1, knots, t)
        + share(knots[i + 1], knots[i + p + 1], knots[i + p + 1] - t)
            * basis(i + 1, p - 1, knots, t)
}

fn rational(p: usize, knots: &[f64], weights: &[f64], points: &[[f64; 3]], t: f64) -> Vec3 {
    let mut sum = Vec3::zeros();
    let mut total = 0.0;
    for (i, (x, w)) in points.iter().zip(weights).enumerate() {
        let n = basis(i, p, knots, t) * w;
        sum += Vec3::from(*x) * n;
        total += n;
    }
    sum / total
}

#[test]
fn rational_splines() {
    let points = [
        [0.0, 0.0, 0.0],
        [1.0, 2.0, 0.5],
        [2.0, -1.0, 1.0],
        [4.0, 0.0, 0.0],
        [5.0, 3.0, -1.0],
        [6.0, 0.0, 2.0],
    ];
    let weights = [1.0, 0.5, 2.0, 1.0, 3.0, 1.0];
    let clamped = [0.0, 0.0, 0.0, 0.0, 0.4, 0.7, 1.0, 1.0, 1.0, 1.0];
    let floating = [-3.0, -2.0, -1.0, 0.0, 0.5, 0.7, 1.0, 2.0, 3.0, 4.5];
    for knots in [clamped, floating] {
        for range in [[0.0, 1.0], [0.1, 0.9], [0.45, 0.6]] {
            let curve = one(126, 0, &spline_126(3, &knots, &weights, &points, range));
            assert_eq!(curve.parameters.file_range(), range);
            let [a, b] = range;
            for k in 0..40 {
                let t = a + (b - a) * f64::from(k) / 40.0;
                let off = (curve.curve.point(t) - rational(3, &knots, &weights, &points, t)).norm();
                assert!(off < 1e-13, "{off:.1e}");
            }
        }
    }
    // Equal weights that are not one, an inner knot as often as the degree.
    let corner = [0.0, 0.0, 0.0, 0.5, 0.5, 0.75, 1.0, 1.0, 1.0];
    let same = one(
        126,
        0,
        &spline_126(2, &corner, &[7.0; 6], &points, [0.0, 1.0]),
    );
    assert!(same.curve.homogeneous().iter().all(|h| h[3] == 1.0));
    for (knots, weights, what) in [
        (clamped, [1.0, 1.0, -1.0, 1.0, 1.0, 1.0], "not positive"),
        (clamped, [1.0, 1.0, 0.0, 1.0, 1.0, 1.0], "not positive"),
        (
            [0.0, 0.0, 0.0, 0.0, 0.7, 0.4, 1.0, 1.0, 1.0, 1.0],
            [1.0; 6],
            "smaller than the knot before it",
        ),
    ] {
        let text = reason(
            126,
            0,
            &spline_126(3, &knots, &weights, &points, [0.0, 1.0]),
        );
        assert!(text.contains(what), "{text}");
    }
}

/// A knot inside repeated degree + 1 times: two curves, each on its own part of the range; the range runs backwards.
#[test]
fn splines_in_pieces_and_backwards() {
    let points = [
        [0.0, 0.0, 0.0],
        [1.0, 2.0, 0.5],
        [2.0, -1.0, 1.0],
        [4.0, 0.0, 0.0],
        [5.0, 3.0, -1.0],
        [6.0, 0.0, 2.0],
    ];
    let broken = [0.0, 0.0, 0.0, 0.5, 0.5, 0.5, 1.0, 1.0, 1.0];
    let mut file = Builder::new();
    file.add(
        126,
        &spline_126(2, &broken, &[1.0; 6], &points, [0.25, 1.0]),
    );
    let found = read(&file);
    let parts = &found.curves[0].parts;
    assert_eq!(parts.len(), 2);
    assert_eq!(
        (parts[0].domain(), parts[1].domain()),
        ([0.25, 0.5], [0.5, 1.0])
    );
    assert!(found.notes.iter().any(|n| n.contains("read as 2 curves")));
    assert_eq!(parts[0].ends()[1], Vec3::from(points[2]));
    assert_eq!(parts[1].ends()[0], Vec3::from(points[3]));
    assert!((found.curves[0].gap - 5.0f64.sqrt().max(6.0f64.sqrt())).abs() < 1e-12);

    let knots = [0.0, 0.0, 0.0, 0.0, 0.4, 0.7, 1.0, 1.0, 1.0, 1.0];
    let mut file = Builder::new();
    file.add(126, &spline_126(3, &knots, &[1.0; 6], &points, [1.0, 0.0]));
    let found = read(&file);
    assert!(
        found.notes[0].contains("runs backwards"),
        "{:?}",
        found.notes
    );
    let curve = &found.curves[0].curve;
    for k in 1..20 {
        let t = f64::from(k) / 20.0;
        let truth = rational(3, &knots, &[1.0; 6], &points, 1.0 - t);
        assert!((curve.point(t) - truth).norm() < 1e-14);
    }
}

/// A line, an arc, a cubic: the parameter starts at 0 and counts on by each member's own range (IGES 5.3, entity 102).
#[test]
fn composites() {
    let mut file = Builder::new();
    let line = file.add(110, "0.,0.,0.,2.,0.,0.");
    let arc = file.add(100, "0.,2.,1.,2.,0.,3.,1.");
    let piece = [
        [3.0, 1.0, 0.5, 0.2],
        [1.0, 2.0, 0.0, -0.1],
        [0.0, 0.0, 1.0, 0.0],
    ];
    let spline = file.add(112, &spline_112(3, &[5.0, 7.0], &[piece]));
    let whole = file.add(102, &format!("3,{line},{arc},{spline}"));
    // Once more inside another composite.
    let outer = file.add(102, &format!("1,{whole}"));
    let found = read(&file);
    assert!(found.notes.is_empty() && found.skipped.is_empty());
    for number in [whole, outer] {
        let curve = found.curves.iter().find(|c| c.entity == number).unwrap();
        assert_eq!(curve.parts.len(), 3);
        assert!(curve.gap < 1e-15);
        let end = 1.0 + FRAC_PI_2 + 2.0;
        assert!((curve.parameters.file_range()[1] - end).abs() < 1e-14);
        let off = worst(curve, |t| {
            if t < 1.0 {
                Vec3::new(2.0 * t, 0.0, 0.0)
            } else if t < 1.0 + FRAC_PI_2 {
                let angle = t - 1.0 + 1.5 * PI;
                Vec3::new(2.0 + angle.cos(), 1.0 + angle.sin(), 0.0)
            } else {
                polynomial(&[5.0, 7.0], &[piece], t - 1.0 - FRAC_PI_2 + 5.0)
            }
        });
        assert!(off < 1e-14 * 4.0, "{off:.1e}");
    }
    // Members that do not meet: the gap is told, the joined curve is closed over it.
    let mut file = Builder::new();
    let a = file.add(110, "0.,0.,0.,1.,0.,0.");
    let b = file.add(110, "1.,0.001,0.,1.,1.,0.");
    file.add(102, &format!("2,{a},{b}"));
    let found = read(&file);
    assert!((found.curves[2].gap - 1e-3).abs() < 1e-15);
    assert_eq!(found.curves[2].curve.point(1.0), Vec3::new(1.0, 0.0, 0.0));
    // A composite of itself, and one that multiplies its members.
    let mut file = Builder::new();
    file.add(102, "1,1");
    assert!(read(&file).skipped[0].reason.contains("over and over"));
    let mut file = Builder::new();
    let mut inner = file.add(110, "0.,0.,0.,1.,0.,0.");
    for _ in 0..40 {
        inner = file.add(102, &format!("4,{inner},{inner},{inner},{inner}"));
    }
    assert!(!read(&file).skipped.is_empty());
}

/// Matrices of members and of the composite, right- and left-handed (forms 0 and 1), in chains, and the model space scale.
#[test]
fn matrices_and_scale() {
    let mut file = Builder::new();
    file.global = file.global.replace(",,1.,2,2HMM", ",,2.,2,2HMM");
    let shift = file.add(124, "1.,0.,0.,0.,0.,1.,0.,0.,0.,0.,1.,5.");
    let turn = file.placed(124, shift, "0.,-1.,0.,10.,1.,0.,0.,0.,0.,0.,1.,0.");
    let mirror = file.form(124, 1, "1.,0.,0.,0.,0.,1.,0.,0.,0.,0.,-1.,0.");
    let arc = file.placed(100, turn, "1.,0.,0.,2.,0.,0.,2.");
    let whole = file.entity(Entity {
        matrix: mirror,
        ..Entity::new(102, &format!("1,{arc}"))
    });
    let found = read(&file);
    // (x, y, z) -> (10 - y, x, z + 5), halved; then z -> -z.
    for (number, sign) in [(arc, 1.0), (whole, -1.0)] {
        let curve = found.curves.iter().find(|c| c.entity == number).unwrap();
        let [from, _] = curve.parameters.file_range();
        let off = worst(curve, |t| {
            let t = t - from;
            Vec3::new(10.0 - 2.0 * t.sin(), 2.0 * t.cos(), sign * 6.0) / 2.0
        });
        assert!(off < 1e-15 * 8.0, "{off:.1e}");
    }
    // In a parameter plane no scale counts.
    let mut file = Builder::new();
    file.global = file.global.replace(",,1.,2,2HMM", ",,2.,2,2HMM");
    file.entity(Entity {
        status: "00010500".to_owned(),
        ..Entity::new(110, "1.,2.,0.,3.,4.,0.")
    });
    assert_eq!(
        read(&file).curves[0].curve.ends()[1],
        Vec3::new(3.0, 4.0, 0.0)
    );
}

/// Other delimiters, D exponents, values left out, and a string where a number should be.
#[test]
fn free_format() {
    let mut file = Builder::new();
    file.delimiters = ['/', '#'];
    file.global = file
        .global
        .replace("1H,,1H;,", "1H/,1H#,")
        .replace(',', "/")
        .replace(';', "#");
    file.add(110, ",,1.D0,2.5D+1,+3.-1,");
    let curve = &read(&file).curves[0];
    assert_eq!(
        curve.curve.ends(),
        [Vec3::new(0.0, 0.0, 1.0), Vec3::new(25.0, 0.3, 0.0)]
    );
    let mut file = Builder::new();
    file.add(110, "0.,0.,0.,1.,3Habc,0.");
    let error = read_iges_geometry(file.text().as_bytes(), "f").unwrap_err();
    assert!(
        error.to_string().contains("a coordinate of an end point"),
        "{error}"
    );
    let mut file = Builder::new();
    file.add(126, "99999999,3,0,0,0,0,0.,1.");
    assert!(read_iges_geometry(file.text().as_bytes(), "f").is_err());
}
