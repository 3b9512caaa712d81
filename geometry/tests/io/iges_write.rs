//! Patches written as IGES and read again: the same faces with the same areas.

use crate::step_builder::{Step, box_faces, near, set, volume};
use crate::support::assets;
use covact_geometry::io::{
    CadFile, FaceBorder, IgesWriteError, LengthUnit, read_iges, read_path, write_iges,
};
use covact_geometry::{NurbsCurve, NurbsPatch, Trim, Vec3};
use std::path::Path;

/// The file as IGES and back; every record has 80 columns.
#[track_caller]
fn again(file: &CadFile) -> CadFile {
    let text = write_iges(file).unwrap();
    assert!(text.is_ascii() && text.lines().all(|l| l.len() == 80));
    let read = read_iges(text.as_bytes(), "again.igs").unwrap();
    assert!(
        read.skipped.is_empty() && read.notes.is_empty(),
        "{:?} {:?}",
        read.skipped,
        read.notes
    );
    assert_eq!(read.unit, file.unit);
    read
}

#[test]
fn files_come_back_with_the_same_areas() {
    let steps = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/step");
    let paths = [
        steps.join("box.step"),
        steps.join("cone.step"),
        steps.join("cylinder.step"),
        steps.join("extrusion.step"),
        steps.join("torus.step"),
        steps.join("sphere_nurbs.step"),
        steps.join("trimmed_patch.step"),
        assets().join("cad/bead.igs"),
        assets().join("cad/groove.igs"),
    ];
    for path in paths {
        let file = read_path(&path).unwrap();
        let other = again(&file);
        assert_eq!(file.patches.len(), other.patches.len(), "{path:?}");
        let (one, two) = (set(&file, None), set(&other, None));
        for (a, b) in one.areas().into_iter().zip(two.areas()) {
            assert!((a / b - 1.).abs() < 1e-9, "{path:?}: {a} {b}");
        }
        let closed = |set: &covact_geometry::PatchSet| set.volumes().iter().flatten().count();
        assert_eq!(closed(&one), closed(&two), "{path:?}");
    }
}

/// A hole through two faces, and an island within a hole: loops of depth two are faces of their own.
#[test]
fn holes_and_islands() {
    let mut step = Step::default();
    let ring = |step: &mut Step, radius: f64, z: f64| {
        let place = step.placement([1., 1., z], [0., 0., 1.], [1., 0., 0.]);
        let circle = step.placed("CIRCLE", &place, &format!("{radius:?}"));
        let vertex = step.vertex([1. + radius, 1., z]);
        let edge = step.edge([&vertex, &vertex], &circle);
        step.bound(&[&edge])
    };
    let hole = ring(&mut step, 0.5, 2.);
    let faces = box_faces(&mut step, [[0.; 3], [2.; 3]], [None, Some(&hole)]);
    let refs: Vec<&str> = faces.iter().map(String::as_str).collect();
    let sheet = step.sheet(&refs);
    let file = step.whole(&[&sheet]);
    let back = again(&file);
    let area = |file: &CadFile| -> f64 { set(file, None).areas().iter().sum() };
    near(area(&file), 24. - std::f64::consts::PI / 4., 1e-9);
    near(area(&back), area(&file), 1e-10);
    assert_eq!(back.patches.len(), 6);

    // The same face with a disc in its hole.
    let mut step = Step::default();
    let bounds = [ring(&mut step, 0.9, 0.), ring(&mut step, 0.5, 0.)];
    let disc = ring(&mut step, 0.25, 0.);
    let place = step.placement([0.; 3], [0., 0., 1.], [1., 0., 0.]);
    let plane = step.placed("PLANE", &place, "");
    let face = step.face(&[&bounds[0], &bounds[1], &disc], &plane, true);
    let sheet = step.sheet(&[&face]);
    let file = step.whole(&[&sheet]);
    let known = std::f64::consts::PI * (0.81 - 0.25 + 0.0625);
    near(area(&file), known, 1e-8);
    let back = again(&file);
    assert_eq!((file.patches.len(), back.patches.len()), (1, 2));
    near(area(&back), known, 1e-8);
}

#[test]
fn narrowed_domains_are_cut_and_names_are_labels() {
    // A quarter of a cylinder of which a half of the angle and the lower two thirds are left.
    let points = [
        [2., 0., 0.],
        [2., 2., 0.],
        [0., 2., 0.],
        [2., 0., 3.],
        [2., 2., 3.],
        [0., 2., 3.],
    ]
    .map(Vec3::from);
    let (w, knots) = (
        0.5f64.sqrt(),
        [vec![0., 0., 0., 1., 1., 1.], vec![0., 0., 1., 1.]],
    );
    let weights = [1., w, 1., 1., w, 1.];
    let patch = NurbsPatch::new([2, 1], knots, [3, 2], &points, Some(&weights)).unwrap();
    let patch = patch.with_domain([[0., 0.5], [0., 2. / 3.]]).unwrap();
    let mut file = CadFile::of(vec![patch], LengthUnit::from_name("in").unwrap());
    file.patches[0].name = Some("punch face, upper".to_owned());
    let back = again(&file);
    assert_eq!(back.patches[0].border, FaceBorder::Natural);
    assert_eq!(back.patches[0].name.as_deref(), Some("punchfac"));
    let area: f64 = set(&back, None).areas().iter().sum();
    near(area, 2. * std::f64::consts::FRAC_PI_4 * 2., 1e-9);
}

#[test]
fn closed_bodies_stay_closed() {
    let mut step = Step::default();
    let faces = box_faces(&mut step, [[0.; 3], [1., 2., 3.]], [None, None]);
    let refs: Vec<&str> = faces.iter().map(String::as_str).collect();
    let solid = step.solid(&refs);
    let back = again(&step.whole(&[&solid]));
    near(volume(&set(&back, None)), 6., 1e-12);
}

#[test]
fn files_without_a_unit_are_refused() {
    let mut file = CadFile::of(Vec::new(), LengthUnit::unspecified());
    let told = write_iges(&file).unwrap_err();
    assert!(matches!(told, IgesWriteError::Unit { .. }), "{told}");
    file.unit = LengthUnit::from_metres(0.2, Some("hand"));
    let told = write_iges(&file).unwrap_err();
    assert!(matches!(told, IgesWriteError::UnknownUnit { .. }), "{told}");
}

/// Curves in space are written as they are, unless one of a boundary ends beside the surface: then none of that boundary is.
#[test]
fn curves_in_space_that_part_from_their_border_are_left_out() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/step/trimmed_patch.step");
    let file = read_path(&path).unwrap();
    let in_space = |file: &CadFile| -> usize {
        let trim = file.patches[0].patch.trim().unwrap();
        let curves = trim.loops().iter().flat_map(|l| &l.curves);
        curves.filter(|c| c.space.is_some()).count()
    };
    let all = in_space(&file);
    assert!(all > 1 && in_space(&again(&file)) == all, "{all}");
    let patch = &file.patches[0].patch;
    let [low, high] = patch.bounds();
    for (share, expected) in [(1e-7, all), (1e-4, 0)] {
        let mut loops = patch.trim().unwrap().loops().to_vec();
        let shift = Vec3::new(0., 0., share * (high - low).norm());
        let curves = loops.iter_mut().flat_map(|l| &mut l.curves);
        let spaces: Vec<_> = curves.filter_map(|c| c.space.as_mut()).collect();
        let space = spaces.into_iter().next().unwrap();
        let [a, b] = space.ends();
        *space = NurbsCurve::line(a + shift, b).unwrap();
        let trim = Trim::new(loops, patch.domain(), 1e-6).unwrap();
        let mut moved = file.clone();
        moved.patches[0].patch = patch.clone().with_trim(Some(trim));
        let text = write_iges(&moved).unwrap();
        let back = read_iges(text.as_bytes(), "again.igs").unwrap();
        assert_eq!(in_space(&back), expected, "{share:e}");
        let area = |file: &CadFile| -> f64 { set(file, None).areas().iter().sum() };
        near(area(&back), area(&file), 1e-8);
    }
}
