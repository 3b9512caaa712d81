//! Surfaces that are closed by themselves (spheres, tori), cones with their tip, and conics that are turned, in files whose
//! boundaries are curves in space. Written by Open CASCADE 8.0.1 (`tests/data/cad_parts.py`).

use covact_geometry::io::{CadFile, LengthUnit, read_path};
use covact_geometry::project::Joining;
use covact_geometry::{NurbsPatch, PatchSet, Vec3};
use std::f64::consts::PI;
use std::path::Path;

fn read(name: &str) -> CadFile {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/round");
    let mut file = read_path(&folder.join(name)).unwrap();
    file.convert_to(&LengthUnit::from_name("mm").unwrap())
        .unwrap();
    assert_eq!(file.skipped, [], "{name}");
    file
}

/// The faces with more knots in curved directions, over which integrals are more accurate.
fn set(file: &CadFile) -> PatchSet {
    let fine = |patch: &NurbsPatch| {
        let mut out = patch.clone();
        for dir in (0..2).filter(|&d| patch.degree()[d] > 1) {
            let spans = patch.spans(dir).into_iter();
            let cut = |[a, b]: [f64; 2]| (1..8).map(move |k| a + (b - a) * f64::from(k) / 8.0);
            out = out
                .insert_knots(dir, &spans.flat_map(cut).collect::<Vec<_>>())
                .unwrap();
        }
        out
    };
    let patches = file.patches.iter().map(|p| fine(&p.patch)).collect();
    let joining = Joining {
        tolerance: Some(1e-2),
        ..file.joining()
    };
    PatchSet::join(patches, joining).unwrap()
}

fn near(found: f64, expected: f64, tolerance: f64) {
    assert!(
        (found / expected - 1.0).abs() < tolerance,
        "{found}, not {expected}"
    );
}

/// A ball of radius 10 without one octant: seven eighths of the sphere and three quarters of discs.
#[test]
fn a_ball_without_an_octant_is_not_the_octant() {
    let expected = 4.0 * PI * 100.0 * 7.0 / 8.0 + 3.0 * PI * 100.0 / 4.0;
    for (name, tolerance) in [
        ("sphere_notched_faces.igs", 1e-9),
        ("sphere_notched_brep.igs", 1e-8),
    ] {
        let set = set(&read(name));
        near(set.areas().iter().sum(), expected, tolerance);
        let volume = set.volumes()[0].expect("closed");
        near(volume, 4.0 / 3.0 * PI * 1000.0 * 7.0 / 8.0, 1e-6);
    }
}

/// A torus less a box, with both seams in the boundary. The area is that of the same part in STEP, where seams are told
/// apart.
#[test]
fn both_seams_of_a_torus_may_bound_a_face() {
    let areas = ["torus_cut.step", "torus_cut_faces.igs"].map(|name| {
        let set = set(&read(name));
        assert!(set.volumes()[0].is_some(), "{name}");
        set.areas().iter().sum::<f64>()
    });
    near(areas[1], areas[0], 1e-6);
    // Open CASCADE: 1158.524562.
    near(areas[0], 1158.524562, 1e-8);
}

/// A cone with its tip that a cylinder goes through, its circle run through backwards. Open CASCADE, of the same part in STEP:
/// 406.425666.
#[test]
fn a_tip_is_passed_either_way() {
    let set = set(&read("cone_drilled_brep.igs"));
    near(set.areas().iter().sum(), 406.425666, 1e-7);
    assert!(set.volumes()[0].is_some());
}

/// Radius 5 at z = 0, half angle .4, lengths 0 to 6, angles .1 to 3, at a distance of .7.
#[test]
fn a_cone_without_an_end_is_offset() {
    let set = set(&read("cone_offset_brep.igs"));
    let expected = 2.9 * (6.0 * (5.0 + 0.7 * 0.4f64.cos()) + 18.0 * 0.4f64.sin());
    near(set.areas()[0], expected, 1e-7);
}

/// y^2 = 4 z up to z = 4, turned about z: a closed form of the area.
#[test]
fn a_parabola_without_ends_is_turned() {
    let set = set(&read("paraboloid.step"));
    let (r, h) = (4.0f64, 4.0f64);
    let expected = PI * r / (6.0 * h * h) * ((r * r + 4.0 * h * h).powf(1.5) - r.powi(3));
    near(set.areas()[0], expected, 1e-9);
}

/// Beyond the tip of half a cone, and in the cavity of a block, points are outside: the tip's normal is that of all that meets
/// there, and a cavity's points into it.
#[test]
fn points_beyond_a_tip_and_in_a_cavity_are_outside() {
    let half = read("cone_halved.step").into_surface().unwrap();
    // Half angle atan(1/2), axis z, tip at z = 12, y > 0.
    for (q, inside) in [
        (Vec3::new(-1.35032, -1.11474, 12.7601), false),
        (Vec3::new(0.0, -0.01, 12.001), false),
        (Vec3::new(0.3, 0.2, 12.5), false),
        (Vec3::new(0.0, 0.1, 11.0), true),
        (Vec3::new(0.0, -0.1, 11.0), false),
    ] {
        let foot = half.closest(&q).unwrap();
        assert_eq!(foot.signed_distance < 0.0, inside, "{q:?} {foot:?}");
    }
    // A block 40 x 30 x 20 with a cavity of radius 6 in its middle.
    let block = read("cavity.step").into_surface().unwrap();
    for (q, distance) in [
        (Vec3::new(20.0, 15.0, 10.0), 6.0),
        (Vec3::new(21.0, 15.0, 10.0), 5.0),
        (Vec3::new(20.0, 15.0, 18.0), -2.0),
        (Vec3::new(20.0, 15.0, 23.0), 3.0),
        (Vec3::new(2.0, 15.0, 10.0), -2.0),
    ] {
        let foot = block.closest(&q).unwrap();
        assert!(
            (foot.signed_distance - distance).abs() < 1e-9,
            "{q:?} {foot:?}"
        );
    }
}
