//! Spline curves of IGES files against their own definitions (IGES 5.3, ANS US PRO/IPO-100-1996, section 4): each point of
//! the NURBS form at the mapped parameter is the point that the entity's formula gives.

use crate::builder::{Builder, values};
use crate::read::{one, polynomial, read, reason, spline_112, worst_on_curve};
use covact_geometry::Vec3;

/// Control points that lie in no plane.
const POINTS: [[f64; 3]; 6] = [
    [0.0, 0.0, 0.0],
    [1.0, 2.0, 0.5],
    [2.0, -1.0, 1.0],
    [4.0, 0.0, 0.0],
    [5.0, 3.0, -1.0],
    [6.0, 0.0, 2.0],
];

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
        let off = worst_on_curve(&curve, |u| polynomial(&breaks, &pieces, u));
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
    assert!(worst_on_curve(&curve, |u| polynomial(&[0.0, 2.0], &[parabola], u)) < 1e-14);
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
    let points = POINTS;
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
    let points = POINTS;
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
