//! How files of IGES are written down by various systems: line ends, columns, numbers, flags and records that are wrong or
//! missing where nothing depends on them.

use super::support::{Entity, GLOBAL, child, entity, flat, iges, line};
use covact_geometry::PatchSet;
use covact_geometry::io::{CadFile, LengthUnit, SkipKind, read_iges};
use std::f64::consts::PI;

fn read(text: &str) -> CadFile {
    read_iges(text.as_bytes(), "hand.igs").unwrap_or_else(|e| panic!("{e}\n{text}"))
}

fn areas(file: &CadFile) -> Vec<f64> {
    assert_eq!(file.skipped, [], "{:?}", file.notes);
    let patches = file.patches.iter().map(|p| p.patch.clone()).collect();
    PatchSet::new(patches, None).unwrap().areas()
}

/// A triangle on a plane, and its text.
fn triangle() -> String {
    let mut entities = vec![
        entity(144, "3,1,0,5"),
        child(128, &flat(2.0, 2.0)),
        child(142, "0,3,7,0,1"),
        child(102, "3,9,11,13"),
    ];
    let sides = [[0.2, 0.2], [1.8, 0.2], [0.2, 1.8]];
    entities.extend((0..3).map(|k| line(sides[k], sides[(k + 1) % 3])));
    iges(GLOBAL, &entities)
}

fn is_the_triangle(file: &CadFile) {
    let found = areas(file);
    assert!(
        found.len() == 1 && (found[0] - 1.28).abs() < 1e-12,
        "{found:?}"
    );
}

#[test]
fn line_ends_and_what_follows_column_80() {
    let text = triangle();
    for end in [
        "\n",
        "\r\n",
        "\r",
        "   \n",
        "  \r\n",
        " ignored text\n",
        "\t\n",
        "\n\n",
    ] {
        let file = read(&text.replace('\n', end));
        is_the_triangle(&file);
        assert_eq!(file.notes, [""; 0], "{end:?}");
    }
    // Records back to back, and a last line without an end.
    is_the_triangle(&read(&text.replace('\n', "")));
    is_the_triangle(&read(text.trim_end()));
    // The end mark of CP/M and DOS behind the last record, blank lines in front of the first.
    let file = read(&format!("\n\n{text}\u{1a}"));
    is_the_triangle(&file);
    assert_eq!(file.notes.len(), 1, "{:?}", file.notes);
}

#[test]
fn a_missing_terminate_record_is_told() {
    let text = triangle();
    let end = text.trim_end().rfind('\n').unwrap() + 1;
    let file = read(&text[..end]);
    is_the_triangle(&file);
    assert_eq!(
        file.notes,
        ["the terminate record T is missing; every entity is complete"]
    );
    // One more record missing, or a part of one, and the file is cut off.
    let cut = text[..end - 1].rfind('\n').unwrap() + 1;
    for end in [cut, end - 2, end - 40] {
        let error = read_iges(&text.as_bytes()[..end], "hand.igs").unwrap_err();
        assert!(error.place().is_some(), "{error}");
    }
    let directory = text.lines().take_while(|l| l.as_bytes()[72] != b'P');
    let directory: Vec<&str> = directory.collect();
    let error = read_iges(directory.join("\n").as_bytes(), "hand.igs").unwrap_err();
    assert!(error.to_string().contains("the file is cut off"), "{error}");
}

#[test]
fn units_flag_three_without_a_name_is_unspecified() {
    for unit in ["3,", "3,2H  "] {
        let global = GLOBAL.replace("2,2HMM", unit);
        let file = read(&iges(&global, &[entity(128, &flat(4.0, 2.0))]));
        assert_eq!(file.unit, LengthUnit::unspecified());
        assert!(
            file.notes[0].contains("units flag is 3"),
            "{:?}",
            file.notes
        );
        assert!((areas(&file)[0] - 8.0).abs() < 1e-12);
        let mut file = file;
        let millimetre = LengthUnit::from_name("mm").unwrap();
        assert!(file.convert_to(&millimetre).is_err());
    }
}

/// A quarter of a cylinder of radius 2 and height 3 as a rational 128, with the flags PROP1 to PROP5 given.
fn quarter(flags: &str) -> String {
    let w = 0.5f64.sqrt();
    format!(
        "2,1,2,1,{flags},0.,0.,0.,1.,1.,1.,0.,0.,1.,1.,1.,{w:?},1.,1.,{w:?},1.,\
         2.,0.,0.,2.,2.,0.,0.,2.,0.,2.,0.,3.,2.,2.,3.,0.,2.,3.,0.,1.,0.,1."
    )
}

/// PROP1 and PROP2 (closed), PROP3 (polynomial), PROP4 and PROP5 (periodic) say what the numbers say anyway.
#[test]
fn flags_of_splines_do_not_count() {
    for flags in [
        "0,0,0,0,0",
        "1,1,0,0,0",
        "0,0,1,0,0",
        "0,0,0,1,1",
        "1,1,1,1,1",
        ",,,,",
    ] {
        let file = read(&iges(GLOBAL, &[entity(128, &quarter(flags))]));
        let found = areas(&file);
        assert!(
            (found[0] / (3.0 * PI) - 1.0).abs() < 1e-6,
            "{flags}: {found:?}"
        );
        let middle = file.patches[0].patch.point([0.5, 0.5]);
        assert!((middle.x.hypot(middle.y) - 2.0).abs() < 1e-14, "{flags}");
        // That the numbers contradict a flag is told.
        let set: Vec<bool> = flags.split(',').map(|f| f == "1").collect();
        let closed = set[..2].iter().filter(|&&f| f).count();
        let told = file.notes.iter().filter(|n| n.contains("flagged closed"));
        assert_eq!(told.count(), closed, "{flags}: {:?}", file.notes);
        let polynomial = file.notes.iter().filter(|n| n.contains("the flag PROP3"));
        assert_eq!(polynomial.count(), usize::from(set[2]), "{flags}");
        let all = closed + usize::from(set[2]);
        assert_eq!(file.notes.len(), all, "{flags}: {:?}", file.notes);
    }
    // The same of curves: a circle of four quarters as the border of a plane.
    let w = 0.5f64.sqrt();
    for flags in ["0,0,0,0", "1,1,0,0", "1,0,1,1", "0,0,1,0"] {
        let weights = [1.0, w, 1.0, w, 1.0, w, 1.0, w, 1.0].map(|w| format!("{w:?}"));
        let corners = [
            [1, 0],
            [1, 1],
            [0, 1],
            [-1, 1],
            [-1, 0],
            [-1, -1],
            [0, -1],
            [1, -1],
            [1, 0],
        ];
        let points = corners.map(|[x, y]| {
            format!(
                "{:?},{:?},0.",
                1.0 + 0.5 * f64::from(x),
                1.0 + 0.5 * f64::from(y)
            )
        });
        let circle = format!(
            "8,2,{flags},0.,0.,0.,1.,1.,2.,2.,3.,3.,4.,4.,4.,{},{},0.,4.,0.,0.,1.",
            weights.join(","),
            points.join(",")
        );
        let file = read(&iges(
            GLOBAL,
            &[
                entity(144, "3,1,0,5"),
                child(128, &flat(2.0, 2.0)),
                child(142, "0,3,7,0,1"),
                child(126, &circle),
            ],
        ));
        let found = areas(&file);
        assert!(
            (found[0] / (0.25 * PI) - 1.0).abs() < 1e-7,
            "{flags}: {found:?}"
        );
    }
}

/// Border curves of which a part counts only (V(0) to V(1) within their knots), as CATIA writes them, on a quarter of a
/// cylinder given as a tabulated cylinder: between z = 0.5 and z = 2.
#[test]
fn parts_of_curves_bound_a_tabulated_cylinder() {
    let w = 0.5f64.sqrt();
    let arc = |z: f64, back: bool| {
        let mut points = [[2., 0., z], [2., 2., z], [0., 2., z]];
        if back {
            points.reverse();
        }
        let points: Vec<String> = points.iter().flatten().map(|x| format!("{x:?}")).collect();
        let values = format!(
            "2,2,0,0,0,0,0.,0.,0.,1.,1.,1.,1.,{w:?},1.,{},0.,1.,0.,0.,1.",
            points.join(",")
        );
        child(126, &values)
    };
    // Twenty long, of which from z = 0.5 to 2 or back counts.
    let part = |x: f64, y: f64, from: f64, range: [f64; 2]| {
        let [a, b] = range;
        let values = format!(
            "1,1,1,0,1,0,0.,0.,1.,1.,1.,1.,{x:?},{y:?},{from:?},{x:?},{y:?},{:?},{a:?},{b:?},0.,0.,1.",
            -from
        );
        child(126, &values)
    };
    let file = read(&iges(
        GLOBAL,
        &[
            entity(144, "3,1,0,5"),
            child(122, "7,2.,0.,3."),
            child(142, "0,3,0,9,2"),
            arc(0.0, false),
            child(102, "4,11,13,15,17"),
            arc(0.5, false),
            part(0.0, 2.0, -10.0, [0.525, 0.6]),
            arc(2.0, true),
            part(2.0, 0.0, 10.0, [0.4, 0.475]),
        ],
    ));
    let found = areas(&file);
    assert!((found[0] / (1.5 * PI) - 1.0).abs() < 1e-6, "{found:?}");
    assert_eq!(file.notes, [""; 0]);
}

/// External references (416) where a surface, a subfigure or a member of a group should be: what needs them is named.
#[test]
fn external_references_are_named() {
    let reference = || Entity {
        form: 1,
        ..child(416, "9Hother.igs,4Hpart")
    };
    let mut entities = vec![
        entity(144, "3,1,0,5"),
        reference(),
        child(142, "0,3,7,0,1"),
        child(102, "3,9,11,13"),
    ];
    let sides = [[0.2, 0.2], [1.8, 0.2], [0.2, 1.8]];
    entities.extend((0..3).map(|k| line(sides[k], sides[(k + 1) % 3])));
    entities.push(entity(128, &flat(2.0, 2.0)));
    let file = read(&iges(GLOBAL, &entities));
    assert_eq!(file.patches.len(), 1);
    let [skipped] = &file.skipped[..] else {
        panic!("{:?}", file.skipped);
    };
    assert_eq!((skipped.entity, skipped.kind), (1, SkipKind::Unsupported));
    assert!(
        skipped.reason.contains("External Reference"),
        "{}",
        skipped.reason
    );
    // A group that holds one beside a surface.
    let file = read(&iges(
        GLOBAL,
        &[
            Entity {
                form: 7,
                ..entity(402, "2,3,5")
            },
            child(128, &flat(2.0, 2.0)),
            reference(),
        ],
    ));
    assert_eq!(areas(&file).len(), 1);
    // An instance of a subfigure that stands in another file.
    let text = iges(
        GLOBAL,
        &[
            entity(408, "3,0.,0.,0.,1."),
            reference(),
            entity(128, &flat(2.0, 2.0)),
        ],
    );
    let file = read(&text);
    assert_eq!(areas(&file).len(), 1);
    assert_eq!(
        file.notes,
        [
            "1 external reference(s) (416), the first of them entity 3: what stands in other files is not read"
        ]
    );
}

/// Levels by number and by property, colours by number and by definition.
#[test]
fn levels_and_colours_are_layers_and_colours() {
    let text = iges(
        GLOBAL,
        &[
            entity(128, &flat(2.0, 2.0)),
            entity(128, &flat(2.0, 3.0)),
            entity(128, &flat(2.0, 4.0)),
            entity(128, &flat(2.0, 5.0)),
            child(314, "100.,50.2,0."),
            child(314, "10.,20.,30.,5Hsteel"),
            Entity {
                form: 1,
                ..child(406, "2,4,7")
            },
        ],
    );
    // Level in columns 33 to 40 of the first record, colour in 17 to 24 of the second.
    let mut number = 0;
    let lines = text.lines().map(|l| {
        if l.as_bytes()[72] != b'D' {
            return l.to_owned();
        }
        number += 1;
        let (field, value) = match number {
            1 => (32..40, "       3"),
            2 => (16..24, "       2"),
            3 => (32..40, "     -13"),
            4 => (16..24, "      -9"),
            6 => (16..24, "     -11"),
            7 => (32..40, "      -9"),
            8 => (16..24, "      99"),
            _ => return l.to_owned(),
        };
        format!("{}{value}{}", &l[..field.start], &l[field.end..])
    });
    let file = read(&(lines.collect::<Vec<_>>().join("\n") + "\n"));
    assert_eq!(file.skipped, []);
    let found: Vec<_> = (file.patches.iter())
        .map(|p| (p.tags.layer.as_deref(), p.tags.colour.as_deref()))
        .collect();
    assert_eq!(
        found,
        [
            (Some("3"), Some("red")),
            (Some("4,7"), Some("#ff8000")),
            (None, Some("steel")),
            // A pointer to what is no list of levels, and a number that is no colour.
            (None, None),
        ]
    );
}
