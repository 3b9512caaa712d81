//! Triangles to a tolerance.

use super::cad;
use covact_geometry::PatchSet;
use covact_geometry::Vec3;
use covact_geometry::primitives::{sphere, torus};
use covact_geometry::tessellate::TessellateError;

/// Closed bodies give closed triangles within the tolerance whose volume converges to that of the body at the rate of chords:
/// a tenth of the tolerance leaves about a tenth of the error.
#[test]
fn closed_bodies_stay_closed_and_converge() {
    for name in [
        "step/box.step",
        "step/cone.step",
        "step/cylinder.step",
        "step/torus.step",
        "step/sphere.step",
        "step/revolution.step",
        "round/torus_cut.step",
    ] {
        let body = cad(name);
        let Some(volume) = body.volumes()[0] else {
            continue;
        };
        let area: f64 = body.areas().iter().sum();
        let mut before = f64::INFINITY;
        for share in [1e-2, 1e-3] {
            let tolerance = share * body.size();
            let found = body.tessellate(tolerance).unwrap();
            assert_eq!(found.open_sides(), 0, "{name} at {share}");
            assert_eq!(found.crossed(), [0u32; 0], "{name}");
            assert!(
                found.deviation() <= tolerance * 1.001,
                "{name} {} {tolerance}",
                found.deviation()
            );
            // The middle of every triangle lies within the tolerance of the surface.
            for [a, b, c] in found.corners().step_by(1 + found.triangles().len() / 200) {
                let middle = (a + b + c) / 3.0;
                let off = body.closest(&middle).unwrap().distance;
                assert!(off <= 1.5 * tolerance, "{name} {off} {tolerance}");
            }
            let off = (found.volume() / volume - 1.0).abs();
            assert!(
                off <= 3.0 * tolerance * area / volume + 1e-9,
                "{name} {share} {off}"
            );
            assert!(
                off < 0.5 * before || off < 1e-9,
                "{name} {share} {off} {before}"
            );
            assert!(
                (found.area() / area - 1.0).abs() < 20.0 * share,
                "{name} {} {area}",
                found.area()
            );
            before = off;
        }
    }
}

/// A sphere of radius 1: the deficit of the volume of inscribed triangles lies between nothing and the tolerance times the
/// area.
#[test]
fn numbers_of_triangles_follow_the_tolerance() {
    let ball = PatchSet::new(vec![sphere(1.0, Vec3::zeros(), Vec3::z()).unwrap()], None).unwrap();
    let counts = [1e-2, 1e-3].map(|t| ball.tessellate(t).unwrap().triangles().len());
    // Chords over h leave the sphere by h^2 / 8: ten times as many triangles for a tenth of the tolerance.
    for pair in counts.windows(2) {
        let rate = pair[1] as f64 / pair[0] as f64;
        assert!((5.0..16.0).contains(&rate), "{counts:?}");
    }
    assert!(counts[1] < 12_000, "{counts:?}");
    let ring = PatchSet::new(
        vec![torus(3.0, 1.0, Vec3::zeros(), Vec3::z()).unwrap()],
        None,
    )
    .unwrap();
    let found = ring.tessellate(1e-3).unwrap();
    assert_eq!(found.open_sides(), 0);
    let volume = 2.0 * std::f64::consts::PI.powi(2) * 3.0;
    assert!(
        (found.volume() / volume - 1.0).abs() < 3e-3,
        "{}",
        found.volume()
    );
}

/// Trims are followed: a face with holes has the area that it has, and only its border is open.
#[test]
fn trimmed_faces_have_their_area_and_border() {
    let sheet = cad("step/trimmed_patch.step");
    let area: f64 = sheet.areas().iter().sum();
    let found = sheet.tessellate(1e-4 * sheet.size()).unwrap();
    assert!(
        (found.area() / area - 1.0).abs() < 1e-4,
        "{} {area}",
        found.area()
    );
    assert!(found.open_sides() > 0);
    assert!(found.patches().windows(2).all(|p| p[0] <= p[1]));
    assert_eq!(found.patches().len(), found.triangles().len());
}

#[test]
fn a_tolerance_of_nothing_is_refused() {
    let body = cad("step/box.step");
    for tolerance in [0.0, -1.0, f64::NAN] {
        assert!(matches!(
            body.tessellate(tolerance),
            Err(TessellateError::Tolerance(_))
        ));
    }
    // Flat faces need no more than their corners.
    assert_eq!(body.tessellate(1.0).unwrap().triangles().len(), 12);
}
