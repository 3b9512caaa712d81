//! Sharp tips: where they are, what meets there, and what is none.
use covact_geometry::primitives::{cylinder, sphere};
use covact_geometry::{NurbsPatch, PatchSet, Vec3};
use std::f64::consts::{FRAC_1_SQRT_2, PI, TAU};

/// Angle above which edges are sharp; the normals around a tip are more than twice that apart.
const ANGLE: f64 = 0.5;

fn set(patches: Vec<NurbsPatch>) -> PatchSet {
    PatchSet::new(patches, None).unwrap()
}

/// The side of a cone about the z axis with its tip at the origin, in so many quarters from the angle `start` on: its `radius` at
/// the height `height`. The first direction turns about the axis, the second one leads away from the tip.
fn cone(start: f64, quarters: usize, radius: f64, height: f64) -> NurbsPatch {
    let mut points = Vec::new();
    let mut weights = Vec::new();
    for part in [0.0, 1.0] {
        for k in 0..=2 * quarters {
            let (sin, cos) = (start + k as f64 * PI / 4.0).sin_cos();
            let corner = if k % 2 == 1 { FRAC_1_SQRT_2 } else { 1.0 };
            let r = part * radius / corner;
            points.push(Vec3::new(r * cos, r * sin, part * height));
            weights.push(corner);
        }
    }
    let mut knots = vec![0.0; 3];
    for k in 1..quarters {
        knots.extend([k as f64; 2]);
    }
    knots.extend([quarters as f64; 3]);
    let along = vec![0.0, 0.0, 1.0, 1.0];
    let counts = [2 * quarters + 1, 2];
    NurbsPatch::new([2, 1], [knots, along], counts, &points, Some(&weights)).unwrap()
}

/// `set` with its normals outward where `out`, inward otherwise.
fn turned(mut set: PatchSet<NurbsPatch>, out: bool) -> PatchSet<NurbsPatch> {
    set.set_sides_outward(!out).unwrap();
    set
}

#[test]
fn a_cone_has_a_tip_outside_and_none_inside() {
    // Normals on opposite sides of a cone whose sides lean by the angle a from its axis are 180 degrees - 2 a apart.
    let (radius, height) = (1.0, 2.0);
    let leans = f64::atan2(radius, height);
    for patches in [
        vec![cone(0.0, 4, radius, height)],
        vec![cone(0.0, 2, radius, height), cone(PI, 2, radius, height)],
    ] {
        let count = patches.len();
        let [tips, hollow] = [true, false].map(|out| turned(set(patches.clone()), out).tips(ANGLE));
        let [tip] = &tips[..] else { panic!("{tips:?}") };
        assert!(hollow.is_empty(), "{hollow:?}");
        assert!(tip.x.norm() < 1e-12);
        assert_eq!(tip.patches.len(), count);
        assert!((tip.angle() - (PI - 2.0 * leans)).abs() < 1e-6, "{tip:?}");
        for n in tip.normals {
            assert!((n.z + leans.sin()).abs() < 1e-6, "{tip:?}");
        }
    }
}

#[test]
fn many_flat_facets_have_a_tip_and_few_have_edges() {
    let fan = |count: usize, height: f64| {
        let at = |k: usize| {
            let (sin, cos) = (TAU * k as f64 / count as f64).sin_cos();
            Vec3::new(cos, sin, height)
        };
        let knots = || vec![0.0, 0.0, 1.0, 1.0];
        let facet = |k: usize| {
            let corners = [Vec3::zeros(), Vec3::zeros(), at(k), at(k + 1)];
            NurbsPatch::new([1, 1], [knots(), knots()], [2, 2], &corners, None).unwrap()
        };
        set((0..count).map(facet).collect())
    };
    let tips =
        |count, height| [true, false].map(|out| turned(fan(count, height), out).tips(ANGLE).len());
    assert_eq!(tips(24, 1.0), [1, 0]);
    // Those of six facets meet in sharp edges, which end there.
    assert_eq!(tips(6, 1.0), [0, 0]);
    // Nearly flat.
    assert_eq!(tips(24, 0.1), [0, 0]);
}

#[test]
fn smooth_poles_corners_and_borders_are_no_tips() {
    let ball = set(vec![sphere(1.0, Vec3::zeros(), Vec3::z()).unwrap()]);
    assert!(ball.tips(ANGLE).is_empty());
    let tube = set(vec![cylinder(1.0, 3.0, Vec3::zeros(), Vec3::z()).unwrap()]);
    assert!(tube.tips(ANGLE).is_empty());
    // Half a cone ends at its tip.
    let half = set(vec![cone(0.0, 2, 1.0, 2.0)]);
    assert!(half.tips(ANGLE).is_empty());
}

#[test]
fn a_tip_is_a_rim_of_one_point() {
    let rims = turned(set(vec![cone(0.0, 4, 1.0, 2.0)]), true).rims(ANGLE, 0.25);
    let mut tips = rims.iter().filter(|rim| !rim.free);
    let tip = tips.next().expect("a tip");
    assert!(tips.next().is_none());
    assert_eq!((tip.points.len(), tip.piece), (1, 0.25));
    assert!(tip.points[0].x.norm() < 1e-12 && tip.points[0].along == Vec3::zeros());
    // The circle at its other end is a free border.
    assert_eq!(rims.iter().filter(|rim| rim.free).count(), 1);
}
