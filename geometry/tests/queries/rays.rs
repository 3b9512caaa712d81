//! Where rays meet surfaces.

use super::{Random, cad};
use covact_geometry::primitives::{plane, sphere, torus};
use covact_geometry::project::RayError;
use covact_geometry::{NurbsCurve, NurbsPatch, PatchSet, TrimCurve, TrimLoop, Vec3};
use nalgebra::Vector2;

fn set(patch: NurbsPatch) -> PatchSet {
    PatchSet::new(vec![patch], None).unwrap()
}

/// |o + t d - c| = r, in closed form.
#[test]
fn a_sphere_is_met_where_the_quadratic_equation_says() {
    let center = Vec3::new(1.0, -2.0, 0.5);
    let ball = set(sphere(3.0, center, Vec3::new(0.3, 0.1, 1.0)).unwrap());
    let mut random = Random(1);
    let (mut met, mut missed) = (0, 0);
    for _ in 0..1000 {
        let origin = center + Vec3::from_fn(|_, _| 12.0 * (random.next() - 0.5));
        let direction = random.direction();
        let along = direction.normalize();
        let d = origin - center;
        let (half, rest) = (d.dot(&along), d.norm_squared() - 9.0);
        let square = half * half - rest;
        if square.abs() < 1e-6 {
            continue;
        }
        let mut expected = Vec::new();
        if square > 0.0 {
            expected.extend([-half - square.sqrt(), -half + square.sqrt()]);
            expected.retain(|&t| t > 1e-6);
        }
        let hits = ball.hits(&origin, &direction, f64::INFINITY).unwrap();
        assert_eq!(
            hits.len(),
            expected.len(),
            "{origin:?} {direction:?} {hits:?}"
        );
        for (hit, t) in hits.iter().zip(&expected) {
            assert!(
                (hit.distance - t).abs() < 1e-10 / square.sqrt().min(1.0),
                "{hit:?} {t}"
            );
            assert!((hit.point - origin - along * hit.distance).norm() < 1e-9);
            let outward = (hit.point - center).normalize();
            assert!((hit.normal - outward).norm() < 1e-8, "{hit:?}");
            met += 1;
        }
        let first = ball.first_hit(&origin, &direction, f64::INFINITY).unwrap();
        assert_eq!(first.map(|h| h.distance), hits.first().map(|h| h.distance));
        missed += usize::from(hits.is_empty());
    }
    assert!(met > 150 && missed > 150, "{met} {missed}");
}

/// Every ray from outside crosses a closed surface an even number of times, in and out by turns; a ray from a point ends
/// inside exactly where the sign of the closest point says so.
#[test]
fn crossings_of_closed_bodies_agree_with_closest_points() {
    let (mut odd, mut even, mut most) = (0, 0, 0);
    for name in [
        "step/torus.step",
        "step/box.step",
        "step/cone.step",
        "round/torus_cut.step",
    ] {
        let body = cad(name);
        let mut random = Random(7);
        for _ in 0..300 {
            let origin = random.within(body.bounds(), 1.4);
            let direction = random.direction();
            let foot = body.closest(&origin).unwrap();
            if foot.distance < 1e-4 * body.size() {
                continue;
            }
            let hits = body.hits(&origin, &direction, f64::INFINITY).unwrap();
            if hits.iter().any(|h| h.grazing) {
                continue;
            }
            let inside = foot.signed_distance < 0.0;
            assert_eq!(
                hits.len() % 2 == 1,
                inside,
                "{name} {origin:?} {direction:?} {hits:?}"
            );
            for (k, hit) in hits.iter().enumerate() {
                let leaves = hit.normal.dot(&direction) > 0.0;
                assert_eq!(leaves, (k % 2 == 0) == inside, "{name} {k} {hits:?}");
                // Nothing of the body is nearer than the first hit says, and every hit lies on the body.
                assert!(body.closest(&hit.point).unwrap().distance < 1e-9 * body.size());
                assert!(hit.distance >= foot.distance * (1.0 - 1e-9));
            }
            most = most.max(hits.len());
            if inside { odd += 1 } else { even += 1 }
        }
    }
    assert!(odd > 100 && even > 500 && most >= 4, "{odd} {even} {most}");
}

/// A unit square with a round hole of radius .25.
#[test]
fn trims_are_heeded() {
    let corner = |k: usize| {
        let (x, y) = [
            (1.0, 0.0),
            (1.0, 1.0),
            (0.0, 1.0),
            (-1.0, 1.0),
            (-1.0, 0.0),
            (-1.0, -1.0),
            (0.0, -1.0),
            (1.0, -1.0),
            (1.0, 0.0),
        ][k];
        Vector2::new(0.5 + 0.25 * x, 0.5 + 0.25 * y)
    };
    let points: Vec<_> = (0..9).map(corner).collect();
    let weights: Vec<f64> = (0..9)
        .map(|k| if k % 2 == 0 { 1.0 } else { 0.5f64.sqrt() })
        .collect();
    let knots = vec![0.0, 0.0, 0.0, 1.0, 1.0, 2.0, 2.0, 3.0, 3.0, 4.0, 4.0, 4.0];
    let circle = NurbsCurve::new(2, knots, &points, Some(&weights)).unwrap();
    let curves = vec![TrimCurve {
        parameter: circle,
        space: None,
        entity: 0,
    }];
    let square = plane(Vec3::new(0.5, 0.5, 0.0), Vec3::z(), [1.0, 1.0]).unwrap();
    let sheet = set(square
        .trimmed_by(vec![TrimLoop { curves }], false, 1e-9)
        .unwrap()
        .patch);
    let down = |x: f64, y: f64| {
        sheet
            .hits(&Vec3::new(x, y, 2.0), &-Vec3::z(), 10.0)
            .unwrap()
            .len()
    };
    assert_eq!(
        [
            down(0.5, 0.5),
            down(0.74, 0.5),
            down(0.76, 0.5),
            down(0.9, 0.9),
            down(1.01, 0.5)
        ],
        [0, 0, 1, 1, 0]
    );
    // Out of reach.
    assert!(
        sheet
            .first_hit(&Vec3::new(0.9, 0.9, 2.0), &-Vec3::z(), 1.9)
            .unwrap()
            .is_none()
    );
}

#[test]
fn edges_of_neighbours_let_no_ray_through_and_count_once() {
    let body = cad("step/box.step");
    let [low, high] = body.bounds();
    let middle = (low + high) / 2.0;
    // Down the edge between two faces, and through a corner.
    for target in [
        Vec3::new(high.x, middle.y, high.z),
        high,
        Vec3::new(low.x, low.y, high.z),
    ] {
        let origin = target
            + Vec3::new(0.3, 0.2, 1.0).normalize()
                * 3.0
                * (target - middle).dot(&Vec3::z()).signum();
        let hit = body
            .first_hit(&origin, &(middle - origin), f64::INFINITY)
            .unwrap();
        assert!(hit.is_some());
        let hits = body
            .hits(&middle, &(target - middle), f64::INFINITY)
            .unwrap();
        assert_eq!(hits.len(), 1, "{hits:?}");
        assert!((hits[0].point - target).norm() < 1e-9 * body.size());
    }
}

#[test]
fn rays_that_run_within_a_face_and_bad_numbers_are_told() {
    let body = cad("step/box.step");
    let [low, high] = body.bounds();
    let origin = Vec3::new(low.x - 1.0, (low.y + high.y) / 2.0 + 0.01, high.z);
    let error = body.hits(&origin, &Vec3::x(), f64::INFINITY);
    assert!(matches!(error, Err(RayError::Along(_))), "{error:?}");
    for (origin, direction, reach) in [
        (Vec3::new(f64::NAN, 0.0, 0.0), Vec3::x(), 1.0),
        (Vec3::zeros(), Vec3::zeros(), 1.0),
        (Vec3::zeros(), Vec3::x(), f64::NAN),
    ] {
        assert_eq!(
            body.hits(&origin, &direction, reach),
            Err(RayError::NotFinite)
        );
    }
    // A tangent touches once, at the point known: on the outside of a torus of radii 3 and 1.
    let ring = set(torus(3.0, 1.0, Vec3::zeros(), Vec3::z()).unwrap());
    let hits = ring
        .hits(&Vec3::new(4.0, -5.0, 0.0), &Vec3::y(), 20.0)
        .unwrap();
    assert!(
        !hits.is_empty() && hits.iter().all(|h| h.grazing),
        "{hits:?}"
    );
    assert!(
        (hits[0].point - Vec3::new(4.0, 0.0, 0.0)).norm() < 1e-4,
        "{hits:?}"
    );
}
