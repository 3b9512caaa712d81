//! The surface of a file as users ask for it: faces by name, reasons where there is no answer.

use crate::step_builder::{Step, cube_in_millimetres};
use covact_geometry::Vec3;
use covact_geometry::io::{CadFile, ReadOptions, SurfaceError, read_step, read_step_with};
use covact_geometry::nalgebra::{Isometry3, Vector3};
use covact_geometry::project::QueryError;

#[test]
fn feet_know_their_faces() {
    let (step, _, faces) = cube_in_millimetres();
    let surface = step.read().surface().unwrap();
    // The second face is the one at z = 2.
    let foot = surface.closest(&Vec3::new(1., 1., 5.)).unwrap();
    assert_eq!(format!("#{}", surface.entity(foot.patch)), faces[1]);
    assert!((foot.signed_distance - 3.).abs() < 1e-12);
    assert_eq!(surface.face(foot.patch).unwrap().tags.body, Some(0));
    assert_eq!((surface.faces().len(), surface.face(6)), (6, None));
    assert_eq!(surface.set().volumes().len(), 1);
}

#[test]
fn queries_without_an_answer_say_why() {
    let surface = cube_in_millimetres().0.read().surface().unwrap();
    let q = Vec3::new(1., 1., 5.);
    let reach = QueryError::BeyondReach { reach: 2.9 };
    assert_eq!(surface.closest_within(&q, 2.9), Err(reach));
    assert!(surface.closest_within(&q, 3.1).is_ok());
    let bad = [
        Vec3::new(f64::NAN, 0., 0.),
        Vec3::new(0., f64::INFINITY, 0.),
    ];
    for q in bad {
        assert_eq!(surface.closest(&q), Err(QueryError::NotFinite));
    }
    assert_eq!(
        surface.closest_within(&q, f64::NAN),
        Err(QueryError::NotFinite)
    );
}

#[test]
fn poses_are_arguments() {
    let surface = cube_in_millimetres().0.read().surface().unwrap();
    let pose = Isometry3::new(Vector3::new(10., -3., 2.), Vector3::new(0.3, -0.7, 0.4));
    let q = Vec3::new(8.5, 1.5, 7.);
    let foot = surface.set().closest_at(&pose, &q, f64::INFINITY).unwrap();
    let moved = |x: Vec3| pose.rotation * x + pose.translation.vector;
    // The same surface, moved by its control points.
    let patches = surface.set().patches().iter();
    let patches = patches.map(|p| p.transformed(&moved).unwrap()).collect();
    let other = covact_geometry::PatchSet::new(patches, None).unwrap();
    let known = other.closest(&q).unwrap();
    assert!((foot.jet.rho - known.jet.rho).norm() < 1e-12);
    assert!((foot.normal - known.normal).norm() < 1e-12);
    assert!((foot.jet.rho_i[0] - known.jet.rho_i[0]).norm() < 1e-12);
    assert!((foot.signed_distance - known.signed_distance).abs() < 1e-12);
    assert!(foot.distance > 1.);
}

#[test]
fn files_without_a_surface_say_why() {
    let read = |step: &Step| -> CadFile { step.read() };
    let (mut step, solid, _) = cube_in_millimetres();
    let style = step.add("PRESENTATION_STYLE_ASSIGNMENT((NULL_STYLE(.NULL.)))");
    let item = step.add(format!("STYLED_ITEM('',({style}),{solid})"));
    step.add(format!("INVISIBILITY(({item}))"));
    let hidden = read(&step).surface().unwrap_err();
    let path = || "part.step".to_owned();
    assert_eq!(
        hidden,
        SurfaceError::Hidden {
            path: path(),
            count: 6
        }
    );
    let text = step.text();
    let options = ReadOptions { hidden: true };
    let shown = read_step_with(text.as_bytes(), "part.step", &options).unwrap();
    assert_eq!(shown.surface().unwrap().faces().len(), 6);

    let (step, _, _) = cube_in_millimetres();
    let text = step.text().replace("PLANE(", "QUADRIC(");
    let unread = read_step(text.as_bytes(), "part.step").unwrap();
    let told = unread.surface().unwrap_err().to_string();
    assert!(
        told.starts_with("part.step: none of 6 faces could be read; the first: entity "),
        "{told}"
    );

    let mut step = Step::default();
    step.millimetres();
    let empty = read(&step).surface().unwrap_err();
    assert_eq!(empty, SurfaceError::Empty { path: path() });
}
