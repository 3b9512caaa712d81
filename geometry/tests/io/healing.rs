//! Faces that are left out: slivers and duplicates, counted and measured.

use crate::step_builder::{Step, box_faces, near, set, volume};
use covact_geometry::io::{CadFile, LeftOutKind, LengthUnit};

fn refs(list: &[String]) -> Vec<&str> {
    list.iter().map(String::as_str).collect()
}

/// A rectangle in the plane z = 0; `from` is the corner at which its bound starts.
fn rectangle(step: &mut Step, [low, high]: [[f64; 2]; 2], from: usize) -> String {
    let [a, b, c, d] = [low[0], low[1], high[0], high[1]];
    let mut corners = [[a, b, 0.], [c, b, 0.], [c, d, 0.], [a, d, 0.]];
    corners.rotate_left(from);
    let vertices = corners.map(|x| step.vertex(x));
    let edges: Vec<String> = (0..4)
        .map(|k| {
            let next = (k + 1) % 4;
            step.line([&vertices[k], &vertices[next]], [corners[k], corners[next]])
        })
        .collect();
    let bound = step.bound(&refs(&edges));
    // Another origin and other axes of the plane for every corner.
    let x = [[1., 0., 0.], [0., 1., 0.], [-1., 0., 0.], [0., -1., 0.]][from];
    let place = step.placement(corners[0], [0., 0., 1.], x);
    let plane = step.placed("PLANE", &place, "");
    step.face(&[&bound], &plane, true)
}

fn sheet(mut step: Step, faces: &[String]) -> CadFile {
    let sheet = step.sheet(&refs(faces));
    step.whole(&[&sheet])
}

#[test]
fn slivers_are_left_out_with_their_width() {
    let mut step = Step::default();
    let faces = [
        rectangle(&mut step, [[0., 0.], [1., 1.]], 0),
        // The file tells 1e-7 apart.
        rectangle(&mut step, [[1., 0.], [1. + 2e-8, 1.]], 0),
        rectangle(&mut step, [[1. + 2e-8, 0.], [2., 1.]], 0),
        rectangle(&mut step, [[2., 0.], [2. + 1e-5, 1.]], 0),
    ];
    let number = faces[1][1..].parse::<u32>().unwrap();
    let mut file = sheet(step, &faces);
    assert_eq!(file.patches.len(), 3);
    assert_eq!((file.bodies[0].faces, file.bodies[0].skipped), (3, 0));
    let healing = &file.healing;
    assert_eq!((healing.slivers, healing.duplicates), (1, 0));
    near(healing.widest_sliver, 2e-8, 1e-6);
    assert_eq!(healing.left_out[0].entity, number);
    // What is left is one sheet: the gap counts as none.
    let joined = set(&file, None);
    assert_eq!(joined.components().len(), 1);
    file.convert_to(&LengthUnit::from_name("m").unwrap())
        .unwrap();
    near(file.healing.widest_sliver, 2e-11, 1e-6);
    let LeftOutKind::Sliver { width } = file.healing.left_out[0].why else {
        panic!("{:?}", file.healing)
    };
    near(width, 2e-11, 1e-6);
}

#[test]
fn faces_that_are_there_twice_are_left_out_once() {
    let mut step = Step::default();
    let faces = [
        rectangle(&mut step, [[0., 0.], [2., 1.]], 0),
        rectangle(&mut step, [[2., 0.], [3., 1.]], 0),
        // The first again, from another corner; a part of it; one beside it.
        rectangle(&mut step, [[0., 0.], [2., 1. + 3e-8]], 1),
        rectangle(&mut step, [[0., 0.], [2., 0.99]], 0),
        rectangle(&mut step, [[0., 1.], [2., 2.]], 0),
    ];
    let numbers = [0, 2].map(|k: usize| faces[k][1..].parse::<u32>().unwrap());
    let file = sheet(step, &faces);
    assert_eq!(file.patches.len(), 4);
    let healing = &file.healing;
    assert_eq!((healing.slivers, healing.duplicates), (0, 1));
    near(healing.farthest_duplicate, 3e-8, 1e-6);
    assert_eq!(healing.left_out[0].entity, numbers[1]);
    let LeftOutKind::Duplicate { of, .. } = healing.left_out[0].why else {
        panic!("{healing:?}")
    };
    assert_eq!(of, numbers[0]);
}

/// A face listed twice keeps its solid from being closed; the common face of two solids that touch belongs to both.
#[test]
fn duplicates_within_one_body_only() {
    let mut step = Step::default();
    let mut faces = box_faces(&mut step, [[0.; 3], [1.; 3]], [None, None]);
    let again = box_faces(&mut step, [[0.; 3], [1.; 3]], [None, None]);
    faces.push(again[3].clone());
    let one = step.solid(&refs(&faces));
    let faces = box_faces(&mut step, [[1., 0., 0.], [2., 1., 1.]], [None, None]);
    let other = step.solid(&refs(&faces));
    let context = step.millimetres();
    step.shape(&[&one, &other], &context);
    let file = step.read();
    assert_eq!((file.patches.len(), file.healing.duplicates), (12, 1));
    for body in 0..2 {
        near(volume(&set(&file, Some(body))), 1., 1e-12);
    }
}
