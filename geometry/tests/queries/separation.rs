//! Distances between sets.

use super::{Random, cad};
use covact_geometry::primitives::{cylinder, plane, sphere, torus};
use covact_geometry::project::SeparationError;
use covact_geometry::{PatchSet, Vec3};
use nalgebra::{Isometry3, Translation3, UnitQuaternion};

fn ball(radius: f64, center: Vec3) -> PatchSet {
    PatchSet::new(vec![sphere(radius, center, Vec3::z()).unwrap()], None).unwrap()
}

fn moved(by: Vec3) -> Isometry3<f64> {
    Isometry3::from_parts(Translation3::from(by), UnitQuaternion::identity())
}

/// Spheres: the distance of the centres less the radii.
#[test]
fn spheres_are_apart_by_the_distance_of_their_centres_less_their_radii() {
    let (one, other) = (ball(2.0, Vec3::zeros()), ball(0.7, Vec3::zeros()));
    for at in [
        Vec3::new(5.0, 1.0, 2.0),
        Vec3::new(0.0, 0.0, 2.701),
        Vec3::new(-3.0, 0.2, 0.1),
    ] {
        let found = one.separation(&other, &moved(at), 1e-6).unwrap();
        let expected = at.norm() - 2.7;
        assert!(
            (found.distance - expected).abs() < 1e-9,
            "{found:?} {expected}"
        );
        assert!(
            found.at_least <= expected && found.at_least > expected - 2e-6,
            "{found:?}"
        );
        let [a, b] = found.feet.map(|f| f.jet.rho);
        assert!(((a - b).norm() - found.distance).abs() < 1e-12);
        assert!((a - at * (2.0 / at.norm())).norm() < 1e-4);
    }
    // One within the other: that of their skins.
    let found = one
        .separation(&other, &moved(Vec3::new(0.3, 0.0, 0.0)), 1e-6)
        .unwrap();
    assert!((found.distance - 1.0).abs() < 1e-9, "{found:?}");
    // They cross.
    let found = one
        .separation(&other, &moved(Vec3::new(2.1, 0.0, 0.0)), 1e-6)
        .unwrap();
    assert!(found.distance < 1e-6 && found.at_least == 0.0, "{found:?}");
}

/// Parallel faces, all of which are nearest, and a torus around a rod: a whole circle is nearest.
#[test]
fn many_nearest_pairs_do_not_make_it_slow() {
    let sheet = |z: f64| {
        PatchSet::new(
            vec![plane(Vec3::new(0.0, 0.0, z), Vec3::z(), [4.0, 3.0]).unwrap()],
            None,
        )
        .unwrap()
    };
    let found = sheet(0.0)
        .separation(&sheet(0.25), &Isometry3::identity(), 1e-9)
        .unwrap();
    assert!((found.distance - 0.25).abs() < 1e-12, "{found:?}");
    let rod = PatchSet::new(
        vec![cylinder(1.0, 10.0, Vec3::zeros(), Vec3::z()).unwrap()],
        None,
    )
    .unwrap();
    let ring = PatchSet::new(
        vec![torus(3.0, 0.5, Vec3::zeros(), Vec3::z()).unwrap()],
        None,
    )
    .unwrap();
    let found = rod.separation(&ring, &Isometry3::identity(), 1e-3).unwrap();
    assert!(
        (found.distance - 1.5).abs() < 1e-9 && found.at_least > 1.499 - 1e-9,
        "{found:?}"
    );
}

/// No point of one set, of many, is nearer to the other set than the distance; and the order of the sets does not matter.
#[test]
fn bodies_of_files_at_random_poses() {
    let bodies = [
        "round/torus_cut.step",
        "step/cone.step",
        "step/trimmed_patch.step",
    ]
    .map(cad);
    let mut random = Random(5);
    for (i, j) in [(0, 1), (1, 2), (0, 2)] {
        let (one, other) = (&bodies[i], &bodies[j]);
        let size = one.size().max(other.size());
        let turn = UnitQuaternion::from_scaled_axis(random.direction() * 2.0);
        let pose = Isometry3::from_parts(
            Translation3::from(random.direction().normalize() * 1.3 * size),
            turn,
        );
        let found = one.separation(other, &pose, 1e-4 * size).unwrap();
        let back = other.separation(one, &pose.inverse(), 1e-4 * size).unwrap();
        assert!(
            (found.distance - back.distance).abs() < 1e-4 * size,
            "{found:?} {back:?}"
        );
        assert!(
            found.distance > 0.0 && found.at_least > found.distance - 1.01e-4 * size,
            "{found:?} {size}"
        );
        let [low, high] = one.bounds();
        for _ in 0..500 {
            let q = random.within([low, high], 1.0);
            let x = one.closest(&q).unwrap().jet.rho;
            let d = other.closest_at(&pose, &x, f64::INFINITY).unwrap().distance;
            assert!(d >= found.at_least, "{d} {found:?}");
        }
    }
}

#[test]
fn a_tolerance_of_nothing_is_refused() {
    let one = ball(1.0, Vec3::zeros());
    for tolerance in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        let found = one.separation(&one, &moved(Vec3::new(3.0, 0.0, 0.0)), tolerance);
        assert!(
            matches!(found, Err(SeparationError::Tolerance(_))),
            "{found:?}"
        );
    }
    let lost = one.separation(&one, &moved(Vec3::new(f64::NAN, 0.0, 0.0)), 1e-3);
    assert!(matches!(lost, Err(SeparationError::Query(_))), "{lost:?}");
}
