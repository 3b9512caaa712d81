//! Small IGES files written by hand: delimiters, strings, units, matrices, faces.

use crate::support::{Entity, GLOBAL, bilinear, entity, iges, iges_with};
use covact_geometry::Vec3;
use covact_geometry::io::{CadFile, read_iges};

fn read(text: &str) -> CadFile {
    read_iges(text.as_bytes(), "hand.igs").unwrap_or_else(|e| panic!("{e}\n{text}"))
}

fn message(text: &str) -> String {
    read_iges(text.as_bytes(), "hand.igs")
        .unwrap_err()
        .to_string()
}

/// The point opposite to the origin, (2, 1, 1) in the patch's own space.
fn far_corner(file: &CadFile) -> Vec3 {
    file.patches[0].patch.point([1.0, 1.0])
}

#[test]
fn first_index_runs_fastest() {
    let patch = &read(&iges(GLOBAL, &[entity(128, &bilinear())])).patches[0].patch;
    for (xi, x) in [([1.0, 0.0], [2.0, 0.0, 0.0]), ([0.0, 1.0], [0.0, 1.0, 0.0])] {
        assert_eq!(patch.point(xi), Vec3::from(x));
    }
    assert!((patch.point([0.5, 0.25]) - Vec3::new(1.0, 0.25, 0.125)).norm() < 1e-15);
}

#[test]
fn delimiters_of_the_file() {
    let global = "1H/,1H#,".replace(',', "/") + "3Ha/#///////////2/2HMM#";
    let values = bilinear().replace(',', "/");
    let file = read(&iges_with(&global, &[entity(128, &values)], '/', '#'));
    assert_eq!(file.unit.name, "mm");
    assert_eq!(far_corner(&file), Vec3::new(2.0, 1.0, 1.0));
    for (global, what) in [
        (
            "1H1,1H;,;",
            "a character that can be a delimiter, found \"1\"",
        ),
        ("1H,,1H,,;", "two different delimiters, found \",\""),
        ("abc,;", "the parameter delimiter \",\", found \"a\""),
    ] {
        let text = message(&iges(global, &[]));
        assert!(
            text.starts_with("hand.igs:2:") && text.contains(what),
            "{text}"
        );
    }
}

#[test]
fn strings_hold_delimiters_and_cross_lines() {
    let long = "x;,".repeat(40);
    let global = format!(",,{}H{long},5Ha,b;c,,,,,,,,,,2,2HMM;", long.len());
    assert_eq!(
        read(&iges(&global, &[entity(128, &bilinear())])).unit.name,
        "mm"
    );
    // A length beyond the end of the section.
    let text = message(&iges(",,999Habc;", &[]));
    assert!(
        text.starts_with("hand.igs:2:3: expected a string of at most"),
        "{text}"
    );
}

#[test]
fn latin1_and_line_ends() {
    let text = iges(GLOBAL, &[entity(128, &bilinear())]);
    let mut bytes = text.replace('\n', "\r\n").into_bytes();
    bytes[3] = 0xe9;
    assert_eq!(read_iges(&bytes, "latin1").unwrap().patches.len(), 1);
    let old_mac = text.replace('\n', "\r");
    assert_eq!(read(&old_mac).patches.len(), 1);
    let back_to_back = text.replace('\n', "");
    assert_eq!(read(&back_to_back).patches.len(), 1);
    // UTF-8 in the comment, counted as characters.
    let utf8 = text.replacen("by hand", "by händ", 1);
    assert_eq!(read(&utf8).patches.len(), 1);
}

#[test]
fn units_and_model_scale() {
    let unit = |fields: &str| {
        let global = format!(",,,,,,,,,,,,{fields};");
        read_iges(iges(&global, &[entity(128, &bilinear())]).as_bytes(), "f")
    };
    for (fields, name, metres) in [
        ("", "in", 0.0254),
        ("1.,1,2HIN", "in", 0.0254),
        ("1.,2,2HMM", "mm", 1e-3),
        ("1.,3,2HCM", "cm", 1e-2),
        ("1.,4", "ft", 0.3048),
        ("1.,6,1HM", "m", 1.0),
        ("1.,9,2HUM", "um", 1e-6),
    ] {
        let file = unit(fields).unwrap();
        assert_eq!(
            (file.unit.name.as_str(), file.unit.to_metre),
            (name, Some(metres)),
            "{fields}"
        );
        assert!(file.notes.is_empty(), "{:?}", file.notes);
    }
    // The flag counts, and the contradiction is told.
    let file = unit("1.,2,2HIN").unwrap();
    assert_eq!(file.unit.name, "mm");
    assert_eq!(file.notes.len(), 1);
    for wrong in [
        "1.,12,2HMM",
        "1.,3,7HFURLONG",
        "1.,,2HMM",
        "0.,2,2HMM",
        "-1.,2,2HMM",
    ] {
        assert!(unit(wrong).is_err(), "{wrong}");
    }
    let mut file = unit("0.5,1,2HIN").unwrap();
    assert_eq!(far_corner(&file), Vec3::new(4.0, 2.0, 2.0));
    file.convert_to(&covact_geometry::io::LengthUnit::from_name("mm").unwrap())
        .unwrap();
    assert!((far_corner(&file) - Vec3::new(101.6, 50.8, 50.8)).norm() < 1e-12);
    assert_eq!(file.unit.name, "mm");
}

#[test]
fn numbers_as_fortran_writes_them_and_defaults() {
    // D exponents, a missing exponent letter, coordinates left out (zero).
    let values = "1,1,1,1,,,1,,,0.D0,,1.,1.E0,,,1.,1.D+0,1.,1.,1.,1.,\
                  ,,,2.D0,,,,10.-1,,200.D-2,.1E1,+1.,,1.,,1.";
    let file = read(&iges(GLOBAL, &[entity(128, values)]));
    assert_eq!(far_corner(&file), Vec3::new(2.0, 1.0, 1.0));
    assert_eq!(
        file.patches[0].patch.point([0.0, 1.0]),
        Vec3::new(0.0, 1.0, 0.0)
    );
}

/// First the matrix of the entity (a quarter turn about z and 10 along x), then the matrix of that matrix.
#[test]
fn matrices_in_a_chain() {
    let turn = "0.,-1.,0.,10.,1.,0.,0.,0.,0.,0.,1.,0.";
    let lift = "1.,0.,0.,0.,0.,1.,0.,0.,0.,0.,1.,5.";
    let with = |type_number, matrix, values: &str| Entity {
        matrix,
        ..entity(type_number, values)
    };
    let entities = [
        with(128, 3, &bilinear()),
        with(124, 5, turn),
        with(124, 0, lift),
    ];
    let file = read(&iges(GLOBAL, &entities));
    assert_eq!(far_corner(&file), Vec3::new(-1.0 + 10.0, 2.0, 1.0 + 5.0));
    // On a 144 the matrix of the face comes after that of the surface.
    let entities = [
        with(144, 5, "3,0,0,0"),
        Entity {
            status: "00010000",
            ..with(128, 7, &bilinear())
        },
        with(124, 0, turn),
        with(124, 0, "1.,0.,0.,100.,0.,1.,0.,0.,0.,0.,1.,0."),
    ];
    let file = read(&iges(GLOBAL, &entities));
    assert_eq!(far_corner(&file), Vec3::new(10.0 - 1.0, 102.0, 1.0));
    // A cycle, a pointer to something else, a singular matrix.
    let text = message(&iges(
        GLOBAL,
        &[with(128, 3, &bilinear()), with(124, 3, turn)],
    ));
    assert!(
        text.contains("a chain of transformation matrices that ends"),
        "{text}"
    );
    let text = message(&iges(GLOBAL, &[with(128, 1, &bilinear())]));
    assert!(
        text.starts_with("hand.igs:3:49: expected a transformation matrix (124)"),
        "{text}"
    );
    let flat = "1.,0.,0.,0.,1.,0.,0.,0.,0.,0.,1.,5.";
    let text = message(&iges(
        GLOBAL,
        &[with(128, 3, &bilinear()), with(124, 0, flat)],
    ));
    assert!(text.contains("not singular"), "{text}");
    // No rotation: applied, and told.
    let twice = "2.,0.,0.,0.,0.,2.,0.,0.,0.,0.,2.,0.";
    let file = read(&iges(
        GLOBAL,
        &[with(128, 3, &bilinear()), with(124, 0, twice)],
    ));
    assert_eq!(
        (far_corner(&file), file.notes.len()),
        (Vec3::new(4.0, 2.0, 2.0), 1)
    );
}

#[test]
fn faces_trimmed_and_untrimmed() {
    let child = || Entity {
        status: "00010000",
        ..entity(128, &bilinear())
    };
    let file = read(&iges(GLOBAL, &[entity(144, "3,0,0,0"), child()]));
    assert_eq!((file.patches.len(), file.skipped.len()), (1, 0));
    assert_eq!(
        (file.patches[0].entity, file.patches[0].type_number),
        (1, 144)
    );
    // Some writers leave out the pointer to an outer boundary that is not there.
    assert_eq!(
        read(&iges(GLOBAL, &[entity(144, "3,0,0"), child()]))
            .patches
            .len(),
        1
    );
    // With a boundary curve, and with a hole in the natural border.
    for values in ["3,1,0,5", "3,0,1,0,5"] {
        let file = read(&iges(
            GLOBAL,
            &[entity(144, values), child(), entity(142, "0,3,0,0,0")],
        ));
        assert_eq!((file.patches.len(), file.skipped.len()), (0, 1));
        let skipped = &file.skipped[0];
        assert_eq!((skipped.entity, skipped.type_number), (1, 144));
        assert!(
            skipped
                .reason
                .contains("neither a curve in the parameter plane nor one in space"),
            "{}",
            skipped.reason
        );
    }
    // A face that is its own surface; two faces that carry each other.
    for entities in [
        vec![entity(144, "1,0,0,0")],
        vec![entity(144, "3,0,0,0"), entity(144, "1,0,0,0")],
    ] {
        assert!(read_iges(iges(GLOBAL, &entities).as_bytes(), "f").is_err());
    }
}

#[test]
fn status_and_parents_decide() {
    let with = |status| {
        vec![Entity {
            status,
            ..entity(128, &bilinear())
        }]
    };
    for (status, reason) in [
        (
            "00010000",
            "physically dependent on an entity that is not read",
        ),
        ("01000000", "blanked"),
        ("00000500", "parameter space"),
        ("00000600", "construction geometry"),
    ] {
        let file = read(&iges(GLOBAL, &with(status)));
        assert_eq!(file.patches.len(), 0, "{status}");
        assert!(
            file.skipped[0].reason.contains(reason),
            "{}",
            file.skipped[0].reason
        );
    }
    for status in ["00000000", "00020000", "        ", "       0"] {
        assert_eq!(
            read(&iges(GLOBAL, &with(status))).patches.len(),
            1,
            "{status}"
        );
    }
    // A group only collects; a subfigure definition is a template.
    let member = || Entity {
        status: "00010000",
        ..entity(128, &bilinear())
    };
    let group = Entity {
        form: 7,
        ..entity(402, "1,1")
    };
    assert_eq!(read(&iges(GLOBAL, &[member(), group])).patches.len(), 1);
    let file = read(&iges(GLOBAL, &[member(), entity(308, "0,4Hpart,1,1")]));
    assert_eq!(file.patches.len(), 0);
    assert!(file.skipped[0].reason.contains("subfigure definition 3"));
    // B-rep face and bounded surface without loops over a 128: one patch each, of the parent.
    for parent in [entity(510, "1,0,1"), entity(143, "0,1,0")] {
        let number = parent.type_number;
        let file = read(&iges(GLOBAL, &[member(), parent]));
        assert_eq!((file.patches.len(), file.skipped.len()), (1, 0), "{number}");
        let patch = &file.patches[0];
        assert_eq!((patch.entity, patch.type_number), (3, number));
        assert_eq!(patch.base, 1);
    }
    // Every other surface is named.
    let file = read(&iges(
        GLOBAL,
        &[entity(120, "1,1,0.,1."), entity(158, "5.,0.,0.,0.")],
    ));
    let names: Vec<_> = file.skipped.iter().map(|s| s.name.as_str()).collect();
    assert_eq!(names, ["Surface of Revolution", "Sphere"]);
}

#[test]
fn names_from_labels_and_properties() {
    let labelled = Entity {
        label: "tool",
        ..entity(128, &bilinear())
    };
    assert_eq!(
        read(&iges(GLOBAL, &[labelled])).patches[0].name.as_deref(),
        Some("tool")
    );
    let named = entity(128, &(bilinear() + ",0,1,3"));
    let name = Entity {
        form: 15,
        ..entity(406, "1,11Hupper; tool")
    };
    let file = read(&iges(GLOBAL, &[named, name]));
    assert_eq!(file.patches[0].name.as_deref(), Some("upper; tool"));
}

#[test]
fn parameter_ranges_and_knots() {
    let read_128 = |from: &str, to: &str| {
        let values = bilinear().replacen(from, to, 1);
        assert_ne!(values, bilinear());
        read(&iges(GLOBAL, &[entity(128, &values)]))
    };
    let end = "0.,1.,0.,1.";
    // The range cuts the patch.
    let values = bilinear().strip_suffix(end).unwrap().to_owned();
    let ranged = |range: &str| read(&iges(GLOBAL, &[entity(128, &format!("{values}{range}"))]));
    let file = ranged("0.,.5,.25,1.");
    assert_eq!(file.patches[0].patch.domain(), [[0.0, 0.5], [0.25, 1.0]]);
    assert_eq!(file.notes.len(), 2);
    // Rounding is no cut, and a range beyond the knots ends with them.
    let file = ranged("1.E-10,.9999999999,0.,1.");
    assert_eq!(file.patches[0].patch.domain(), [[0.0, 1.0]; 2]);
    assert!(file.notes.is_empty(), "{:?}", file.notes);
    let file = ranged("0.,2.,0.,0.");
    assert_eq!(file.patches[0].patch.domain(), [[0.0, 1.0]; 2]);
    assert_eq!(file.notes.len(), 2);
    let file = ranged("1.,0.,0.,1.");
    assert!(file.skipped[0].reason.contains("runs backwards"));
    assert!(
        ranged("3.,4.,0.,1.").skipped[0]
            .reason
            .contains("outside of the knots' range")
    );
    // Unclamped ends, as some writers leave the last knot off.
    let file = read_128("0.,0.,1.,1.,0.", "0.,0.,1.,1.1,0.");
    assert_eq!(file.patches[0].patch.domain(), [[0.0, 1.0]; 2]);
    // A negative weight, a decreasing knot: sound data, no surface.
    let file = read_128("1.,1.,1.,1.,1.,1.,", "1.,1.,1.,-1.,1.,1.,");
    assert!(
        file.skipped[0].reason.contains("weight -1"),
        "{}",
        file.skipped[0].reason
    );
    let file = read_128("0.,0.,1.,1.,0.", "0.,2.,1.,1.,0.");
    assert!(
        file.skipped[0]
            .reason
            .contains("smaller than the knot before")
    );
    // Flags that the data contradicts are told.
    let file = read_128("0,0,1,0,0", "1,0,1,0,0");
    assert!(
        file.notes[0].contains("flagged closed in direction 1"),
        "{:?}",
        file.notes
    );
}
