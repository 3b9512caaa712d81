//! Trims of the parameter plane against insides known otherwise.

use crate::curves::*;
use covact_geometry::trim::{Part, TrimError, TrimNoteKind};
use covact_geometry::{NurbsCurve, NurbsPatch, Trim, Vec3};
use nalgebra::Vector2;
use std::f64::consts::TAU;

const SQUARE: [[f64; 2]; 2] = [[-1.0, 1.0]; 2];

#[test]
fn ellipses_hold_what_their_equation_says() {
    let mut random = Random(1);
    let mut counts = [0; 2];
    for _ in 0..200 {
        let centre = [random.between(-0.3, 0.3), random.between(-0.3, 0.3)];
        let radii = [random.between(0.01, 0.6), random.between(0.01, 0.6)];
        let turn = random.between(0.0, TAU);
        let trim = Trim::new(vec![ellipse(centre, radii, turn)], SQUARE, 1e-9).unwrap();
        for _ in 0..100 {
            // Many close to the border.
            let (angle, f) = (
                random.between(0.0, TAU),
                random.between(-1.0, 1.0).powi(7) + 1.0,
            );
            let (x, y) = (f * radii[0] * angle.cos(), f * radii[1] * angle.sin());
            let (s, c) = turn.sin_cos();
            let xi = [centre[0] + c * x - s * y, centre[1] + s * x + c * y];
            if (f - 1.0).abs() < 1e-12 {
                continue;
            }
            counts[usize::from(f < 1.0)] += 1;
            assert_eq!(
                trim.contains(xi),
                f < 1.0,
                "{centre:?} {radii:?} {turn} {xi:?} {f}"
            );
        }
    }
    assert!(counts[0] > 5000 && counts[1] > 5000, "{counts:?}");
}

#[test]
fn random_loops_of_all_degrees_agree_with_the_winding_number() {
    let mut random = Random(7);
    for degree in [1, 2, 3, 5, 9, 15] {
        for rational in [false, true] {
            let loops = vec![
                one_curve(star(
                    &mut random,
                    [0.0, 0.0],
                    [0.5, 0.9],
                    degree,
                    12,
                    rational,
                )),
                one_curve(star(
                    &mut random,
                    [0.1, 0.0],
                    [0.1, 0.4],
                    degree,
                    5,
                    rational,
                )),
            ];
            let trim = Trim::new(loops, SQUARE, 1e-9).unwrap();
            let lines = dense(&trim, 400);
            let mut counts = [0; 2];
            for _ in 0..150 {
                let xi = [random.between(-1.0, 1.0), random.between(-1.0, 1.0)];
                let (inside, near) = winding(&lines, xi);
                // Weights over six orders of magnitude leave the polygon coarse in places.
                if near > if rational { 2e-2 } else { 1e-3 } {
                    assert_eq!(
                        trim.contains(xi),
                        inside,
                        "degree {degree} {rational} {xi:?}"
                    );
                    counts[usize::from(inside)] += 1;
                }
            }
            assert!(counts[0] > 10 && counts[1] > 10, "{counts:?}");
        }
    }
}

#[test]
fn rays_through_vertices_and_along_sides_count_once() {
    // A comb with vertices and level sides on the lattice of query points.
    let comb = [
        [-0.75, -0.5],
        [-0.5, 0.5],
        [-0.25, 0.0],
        [0.0, 0.0],
        [0.25, 0.5],
        [0.5, 0.5],
        [0.5, 0.0],
        [0.75, 0.0],
        [0.75, -0.5],
        [0.25, -0.5],
        [0.0, -0.25],
        [-0.25, -0.5],
    ];
    let trim = Trim::new(vec![polygon(&comb)], SQUARE, 0.0).unwrap();
    let lines = vec![comb.iter().map(|&p| Vector2::from(p)).collect::<Vec<_>>()];
    let mut inside = 0;
    for k in 0..33 * 33 {
        let xi = [k % 33, k / 33].map(|k| -1.0 + f64::from(k) / 16.0);
        let (truth, near) = winding(&lines, xi);
        if near > 1e-12 {
            assert_eq!(trim.contains(xi), truth, "{xi:?}");
            inside += usize::from(truth);
        }
    }
    assert!(inside > 100, "{inside}");
}

#[test]
fn loops_may_share_a_point_touch_the_border_and_be_tiny() {
    let eight = polygon(&[[-0.5, -0.5], [0.5, 0.5], [0.5, -0.5], [-0.5, 0.5]]);
    let mut loops = vec![
        rectangle([[-1.0 - 1e-13, 1.0], [-1.0, 1.0 + 1e-13]]),
        polygon(&[[0.0, 0.5], [0.25, 0.75], [-0.25, 0.75]]),
        polygon(&[[0.0, 0.5], [0.25, 0.25], [-0.25, 0.25]]),
        ellipse([0.7, 0.7], [1e-9, 1e-9], 0.3),
    ];
    let trim = Trim::new(loops.clone(), SQUARE, 1e-9).unwrap();
    for (xi, inside) in [
        ([0.0, 0.6], false),
        ([0.0, 0.4], false),
        ([0.1, 0.5], true),
        ([-0.1, 0.5], true),
        ([0.7, 0.7], false),
        ([0.7 + 2e-9, 0.7], true),
        ([-1.0 + 1e-15, 0.0], true),
        ([0.999_999, 0.999_999], true),
    ] {
        assert_eq!(trim.contains(xi), inside, "{xi:?}");
    }
    // A loop that crosses itself keeps its lobes.
    loops.truncate(1);
    loops.push(eight);
    let trim = Trim::new(loops, SQUARE, 1e-9).unwrap();
    assert!(!trim.contains([0.3, 0.0]) && !trim.contains([-0.3, 0.0]));
    assert!(trim.contains([0.0, 0.3]) && trim.contains([0.0, -0.3]));
}

#[test]
fn a_cusp_is_cut_where_it_turns() {
    // Cubic with a cusp at (0, 0.25), closed by a line below: x = (1 - 2t)^3, y = t (1 - t).
    let points = [[1.0, 0.0], [-1.0, 1.0 / 3.0], [1.0, 1.0 / 3.0], [-1.0, 0.0]].map(Vector2::from);
    let cusp = NurbsCurve::new(
        3,
        vec![0.0, 0.0, 0.0, 0.0, 1.0, 1.0, 1.0, 1.0],
        &points,
        None,
    )
    .unwrap();
    let line = NurbsCurve::line(Vector2::new(-1.0, 0.0), Vector2::new(1.0, 0.0)).unwrap();
    let a_loop = covact_geometry::TrimLoop {
        curves: vec![curve(cusp), curve(line)],
    };
    let trim = Trim::new(vec![a_loop], SQUARE, 1e-9).unwrap();
    // On the curve y = (1 - |x|^(2/3)) / 4.
    let mut random = Random(3);
    for _ in 0..2000 {
        let x = random.between(-1.0, 1.0).powi(3);
        let top = 0.25 * (1.0 - x.abs().powf(2.0 / 3.0));
        let off = random.between(-1.0, 1.0).powi(9) * 0.2;
        if off.abs() > 1e-13 && top + off > 1e-13 {
            assert_eq!(trim.contains([x, top + off]), off < 0.0, "{x} {off}");
        }
    }
}

#[test]
fn rectangles_are_cut_where_a_border_meets_them() {
    let mut random = Random(11);
    let loops = vec![
        rectangle(SQUARE),
        one_curve(star(&mut random, [0.0, 0.0], [0.3, 0.8], 3, 12, false)),
    ];
    let trim = Trim::new(loops, SQUARE, 1e-9).unwrap();
    let lines = dense(&trim, 2000);
    let mut counts = [0; 3];
    for _ in 0..3000 {
        let middle = [random.between(-0.95, 0.95), random.between(-0.95, 0.95)];
        let half = [random.between(0.0, 0.04), random.between(0.0, 0.04)];
        let part = trim.part([0, 1].map(|k| [middle[k] - half[k], middle[k] + half[k]]));
        // Deepest point of the border within the rectangle, as a share of its half widths.
        let deep = lines
            .iter()
            .flatten()
            .map(|p| {
                (0..2)
                    .map(|k| (p[k] - middle[k]).abs() / half[k])
                    .fold(0.0, f64::max)
            })
            .fold(f64::INFINITY, f64::min);
        match part {
            Part::Cut => assert!(deep < 1.3, "{middle:?} {half:?} {deep}"),
            Part::Inside => assert!(deep > 1.0 && trim.contains(middle)),
            Part::Outside => assert!(deep > 1.0 && !trim.contains(middle)),
        }
        counts[part as usize] += 1;
    }
    assert!(counts.iter().all(|&n| n > 100), "{counts:?}");
}

#[test]
fn the_nearest_border_point_is_the_nearest_of_many() {
    let mut random = Random(5);
    let loops = vec![
        rectangle(SQUARE),
        one_curve(star(&mut random, [0.0, 0.0], [0.3, 0.8], 4, 9, false)),
    ];
    let trim = Trim::new(loops, SQUARE, 1e-9).unwrap();
    let lines = dense(&trim, 3000);
    for _ in 0..200 {
        let xi = [random.between(-0.9, 0.9), random.between(-0.9, 0.9)];
        let found = trim.nearest_border(xi, [1.0; 2], f64::INFINITY).unwrap();
        // The polygon is off the curve by 1e-7 at most (chords of 1e-3, radii of curvature above 1).
        let (_, near) = winding(&lines, xi);
        assert!(
            (found.distance - near).abs() < 1e-5 + 1e-3 * near
                && found.distance < near * 1.001 + 1e-7,
            "{found:?} {near}"
        );
        let on = trim
            .curve(found.curve as usize)
            .unwrap()
            .parameter
            .point(found.t);
        assert!((on - Vector2::from(found.xi)).norm() < 1e-12);
    }
}

#[test]
fn the_cost_grows_like_the_logarithm_of_the_number_of_curves() {
    let mut most = Vec::new();
    for n in [10, 100, 1000, 10_000] {
        let points: Vec<[f64; 2]> = (0..n)
            .map(|k| {
                let angle = TAU * k as f64 / n as f64;
                let r = if k % 2 == 0 { 0.6 } else { 0.7 };
                [r * angle.cos(), r * angle.sin()]
            })
            .collect();
        let trim = Trim::new(vec![polygon(&points)], SQUARE, 0.0).unwrap();
        let mut random = Random(9);
        let sum: usize = (0..500)
            .map(|_| trim.cost([random.between(-1.0, 1.0), random.between(-1.0, 1.0)]))
            .sum();
        most.push(sum as f64 / 500.0);
    }
    eprintln!("nodes per test: {most:?}");
    // A tree of depth log2(n) that opens few nodes besides one path.
    for (mean, n) in most.iter().zip([10.0f64, 100.0, 1000.0, 10_000.0]) {
        assert!(*mean < 3.0 * n.log2(), "{most:?}");
    }
}

#[test]
fn gaps_are_closed_and_told() {
    let points = [[-0.5, -0.5], [0.5, -0.5], [0.5, 0.5], [-0.5, 0.5]];
    let mut a_loop = polygon(&points);
    a_loop.curves[1] =
        curve(NurbsCurve::line(Vector2::new(0.5, -0.4998), Vector2::new(0.5, 0.5)).unwrap());
    let trim = Trim::new(vec![a_loop.clone()], SQUARE, 1e-3).unwrap();
    assert_eq!(trim.gaps().len(), 1);
    assert!((trim.gaps()[0].width - 1e-4).abs() < 1e-12);
    let ends = [0, 1].map(|k| trim.curve(k).unwrap().parameter.ends()[1 - k]);
    assert_eq!(ends[0], ends[1]);
    assert_eq!(ends[0], Vector2::new(0.5, -0.4999));
    let open = Trim::new(vec![a_loop], SQUARE, 1e-5);
    assert!(matches!(open, Err(TrimError::Open(0, 0, gap)) if (gap - 1e-4).abs() < 1e-12));
}

#[test]
fn an_outer_rectangle_becomes_a_narrower_domain() {
    let plate = plate();
    let inner = [[-0.5, 0.25], [-1.0 + 1e-9, 0.75]];
    let out = plate
        .trimmed_by(vec![rectangle(inner)], true, 1e-6)
        .unwrap();
    assert!(out.patch.trim().is_none());
    assert_eq!(out.patch.domain(), [[-0.5, 0.25], [-1.0, 0.75]]);
    assert!(matches!(out.notes[0].kind, TrimNoteKind::Rectangle(_)));
    // With a hole the border of the narrower domain is the first loop.
    let loops = vec![
        rectangle(inner),
        ellipse([-0.2, 0.0], [0.1, 0.2], 0.0),
        ellipse([0.8, 0.8], [0.1, 0.1], 0.0),
    ];
    let out = plate.trimmed_by(loops, true, 1e-6).unwrap();
    let trim = out.patch.trim().unwrap();
    assert_eq!((trim.loops().len(), trim.curve_count()), (2, 5));
    assert!(
        out.notes
            .iter()
            .any(|n| n.loop_number == 2 && n.kind == TrimNoteKind::Outside)
    );
    assert!(
        trim.contains([-0.4, 0.0]) && !trim.contains([-0.2, 0.0]) && !trim.contains([0.5, 0.0])
    );
    // No loops but the border: untrimmed.
    assert!(
        plate
            .trimmed_by(vec![], false, 1e-6)
            .unwrap()
            .patch
            .trim()
            .is_none()
    );
}

#[test]
fn bad_loops_are_named() {
    let plate = plate();
    let flat = polygon(&[[-0.5, 0.0], [0.5, 0.1], [-0.5, 0.0]]);
    assert_eq!(
        plate
            .trimmed_by(vec![flat.clone()], true, 1e-6)
            .unwrap_err(),
        TrimError::ZeroArea(0)
    );
    let out = plate.trimmed_by(vec![flat], false, 1e-6).unwrap();
    assert_eq!(out.notes[0].kind, TrimNoteKind::ZeroArea);
    let eight = polygon(&[[-0.5, -0.5], [0.5, 0.5], [0.5, -0.5], [-0.5, 0.5]]);
    let out = plate.trimmed_by(vec![eight], false, 1e-6).unwrap();
    assert_eq!(out.notes[0].kind, TrimNoteKind::SelfIntersecting);
    let wide = plate.trimmed_by(vec![ellipse([0.0, 0.0], [1.5, 0.5], 0.0)], true, 1e-6);
    assert!(matches!(wide, Err(TrimError::Beyond(0, beyond)) if (beyond - 0.25).abs() < 1e-3));
}

/// Full cylinder about z of radius 1, xi1 the turning direction.
fn cylinder() -> NurbsPatch {
    let h = std::f64::consts::FRAC_1_SQRT_2;
    let square = [
        [1.0, 0.0],
        [1.0, 1.0],
        [0.0, 1.0],
        [-1.0, 1.0],
        [-1.0, 0.0],
        [-1.0, -1.0],
        [0.0, -1.0],
        [1.0, -1.0],
        [1.0, 0.0],
    ];
    let points: Vec<Vec3> = (0..18)
        .map(|k| Vec3::new(square[k % 9][0], square[k % 9][1], (k / 9) as f64))
        .collect();
    let weights: Vec<f64> = (0..18)
        .map(|k| if k % 2 == usize::from(k < 9) { h } else { 1.0 })
        .collect();
    let q = TAU / 4.0;
    let knots = vec![
        0.0,
        0.0,
        0.0,
        q,
        q,
        2.0 * q,
        2.0 * q,
        3.0 * q,
        3.0 * q,
        TAU,
        TAU,
        TAU,
    ];
    NurbsPatch::new(
        [2, 1],
        [knots, vec![0.0, 0.0, 1.0, 1.0]],
        [9, 2],
        &points,
        Some(&weights),
    )
    .unwrap()
}

#[test]
fn loops_beyond_the_seam_of_a_closed_surface_move_it() {
    let cylinder = cylinder();
    // From u = 5 to 8 on [0, 2 pi]: a rectangle across the seam.
    let out = cylinder
        .trimmed_by(vec![rectangle([[5.0, 8.0], [0.2, 0.6]])], true, 1e-6)
        .unwrap();
    assert!(out.patch.trim().is_none());
    assert_eq!(out.patch.domain(), [[5.0, 8.0], [0.2, 0.6]]);
    for k in 0..=300 {
        let u = 5.0 + 0.01 * f64::from(k);
        let there = out.patch.point([u, 0.3]);
        let here = cylinder.point([u.rem_euclid(TAU), 0.3]);
        assert!((there - here).norm() < 1e-13, "{u}");
    }
    // One period away, and a hole across the seam where the border of the domain is the outer loop.
    let away = ellipse([2.0 + TAU, 0.5], [0.5, 0.3], 0.0);
    let across = ellipse([0.0, 0.5], [0.5, 0.3], 0.0);
    let out = cylinder
        .trimmed_by(vec![away, across], false, 1e-6)
        .unwrap();
    let [start, end] = out.patch.domain()[0];
    assert!((end - start - TAU).abs() < 1e-12);
    let trim = out.patch.trim().unwrap();
    for (u, inside) in [
        (2.0, false),
        (1.0, true),
        (0.4, false),
        (-0.4, false),
        (-0.6, true),
        (2.6, true),
        (4.0, true),
    ] {
        let u: f64 = u;
        assert_eq!(
            trim.contains([start + (u - start).rem_euclid(TAU), 0.5]),
            inside,
            "{u} {start}"
        );
    }
}
