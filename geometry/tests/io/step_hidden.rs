//! What a STEP file hides: by itself, by its layer, by a copy, by a representation.

use crate::step_builder::{Step, box_faces};
use covact_geometry::io::{CadFile, ReadOptions, SkipKind, read_step_with};

fn cube(step: &mut Step, at: f64) -> (String, Vec<String>) {
    let extent = [[at, 0., 0.], [at + 1., 1., 1.]];
    let faces = box_faces(step, extent, [None, None]);
    let refs: Vec<&str> = faces.iter().map(String::as_str).collect();
    (step.solid(&refs), faces)
}

fn read(step: &Step, hidden: bool) -> CadFile {
    let options = ReadOptions { hidden };
    read_step_with(step.text().as_bytes(), "part.step", &options).unwrap()
}

/// Faces read and hidden of every body; all of them are read where hidden ones are asked for.
#[track_caller]
fn shown(step: &Step) -> Vec<(usize, usize)> {
    let all = read(step, true);
    assert!(all.skipped.is_empty(), "{:?}", all.skipped);
    let file = read(step, false);
    assert_eq!(file.bodies.len(), all.bodies.len());
    for s in &file.skipped {
        assert_eq!(s.kind, SkipKind::Blanked, "{s:?}");
        assert!(s.reason.starts_with("hidden in the file by #"), "{s:?}");
    }
    let bodies = file.bodies.iter();
    bodies.map(|b| (b.faces, b.skipped)).collect()
}

fn styled(step: &mut Step, item: &str) -> String {
    let style = step.add("PRESENTATION_STYLE_ASSIGNMENT((NULL_STYLE(.NULL.)))");
    step.add(format!("STYLED_ITEM('',({style}),{item})"))
}

fn hide(step: &mut Step, items: &[&str]) {
    step.add(format!("INVISIBILITY(({}))", items.join(",")));
}

#[test]
fn a_solid_and_a_face_of_another() {
    let mut step = Step::default();
    let (one, _) = cube(&mut step, 0.);
    let (two, faces) = cube(&mut step, 3.);
    let context = step.millimetres();
    step.shape(&[&one, &two], &context);
    let items = [styled(&mut step, &one), styled(&mut step, &faces[2])];
    // A null style alone hides nothing.
    styled(&mut step, &faces[3]);
    assert_eq!(shown(&step), [(6, 0), (6, 0)]);
    hide(&mut step, &[&items[0], &items[1]]);
    assert_eq!(shown(&step), [(0, 6), (5, 1)]);
    let face = &read(&step, false).skipped[6];
    assert_eq!(format!("#{}", face.entity), faces[2]);
}

#[test]
fn layers_that_are_off() {
    let mut step = Step::default();
    let (one, _) = cube(&mut step, 0.);
    let (two, faces) = cube(&mut step, 3.);
    let context = step.millimetres();
    step.shape(&[&one, &two], &context);
    let item = styled(&mut step, &faces[0]);
    let off = step.add(format!(
        "PRESENTATION_LAYER_ASSIGNMENT('off','',({one},{item}))"
    ));
    step.add(format!("PRESENTATION_LAYER_ASSIGNMENT('on','',({two}))"));
    hide(&mut step, &[&off]);
    assert_eq!(shown(&step), [(0, 6), (5, 1)]);
    let all = read(&step, true);
    let layers = all.patches.iter().map(|p| p.tags.layer.as_deref());
    assert_eq!(layers.filter(|l| *l == Some("off")).count(), 7);
}

/// Two copies of a part by mapped items: one of them, or the part, is hidden.
#[test]
fn copies_and_representations() {
    let parts = || {
        let mut step = Step::default();
        let (solid, _) = cube(&mut step, 0.);
        let context = step.millimetres();
        let place = step.placement([0.; 3], [0., 0., 1.], [1., 0., 0.]);
        let part = step.shape(&[&place, &solid], &context);
        let map = step.add(format!("REPRESENTATION_MAP({place},{part})"));
        let copies = [5., 10.].map(|x| {
            let target = step.placement([x, 0., 0.], [0., 0., 1.], [1., 0., 0.]);
            step.add(format!("MAPPED_ITEM('',{map},{target})"))
        });
        let items = copies.join(",");
        step.add(format!("SHAPE_REPRESENTATION('',({items}),{context})"));
        (step, solid, part, copies)
    };
    let (mut step, _, _, copies) = parts();
    assert_eq!(shown(&step), [(6, 0), (6, 0)]);
    let item = styled(&mut step, &copies[0]);
    hide(&mut step, &[&item]);
    assert_eq!(shown(&step), [(0, 6), (6, 0)]);

    let (mut step, _, part, _) = parts();
    hide(&mut step, &[&part]);
    assert_eq!(shown(&step), [(0, 6), (0, 6)]);

    // The solid is hidden in the second copy only.
    let (mut step, solid, _, copies) = parts();
    let style = step.add(format!(
        "PRESENTATION_STYLE_BY_CONTEXT((NULL_STYLE(.NULL.)),{})",
        copies[1]
    ));
    let item = step.add(format!("STYLED_ITEM('',({style}),{solid})"));
    hide(&mut step, &[&item]);
    assert_eq!(shown(&step), [(6, 0), (0, 6)]);

    // Hidden in one view only.
    let (mut step, solid, _, copies) = parts();
    let item = styled(&mut step, &solid);
    step.add(format!(
        "CONTEXT_DEPENDENT_INVISIBILITY(({item}),{})",
        copies[0]
    ));
    assert_eq!(shown(&step), [(6, 0), (6, 0)]);
}
