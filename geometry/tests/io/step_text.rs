//! How files of STEP are written down by various systems: white space, comments, strings, numbers, units.

use crate::step_builder::{Step, area, box_faces, cube_in_millimetres, near, set, volume};
use covact_geometry::io::{CadFile, LengthUnit, read_step};
use std::f64::consts::PI;

fn read(text: &str) -> CadFile {
    let file = read_step(text.as_bytes(), "part.step").unwrap_or_else(|e| panic!("{e}\n{text}"));
    assert!(file.skipped.is_empty(), "{:?}", file.skipped);
    file
}

fn is_a_cube(file: &CadFile, side: f64) {
    assert_eq!(file.patches.len(), 6);
    let set = set(file, None);
    near(area(&set), 6. * side * side, 1e-12);
    near(volume(&set), side * side * side, 1e-12);
}

/// Text between the tokens of the exchange structure; strings and the keywords of sections stay whole.
fn between(text: &str, filler: &str) -> String {
    let mut out = String::new();
    let mut string = false;
    for c in text.chars() {
        string ^= c == '\'';
        if !string && "(),=;".contains(c) {
            out.push_str(filler);
            out.push(c);
            out.push_str(filler);
        } else {
            out.push(c);
        }
    }
    out
}

/// What is missing costs no instance: each is told once.
#[test]
fn ends_that_are_left_out() {
    let text = cube_in_millimetres().0.text();
    for (from, to, told) in [
        (
            "ENDSEC;\nEND-ISO",
            "END-ISO",
            "ENDSEC at the end of the data is missing",
        ),
        ("END-ISO-10303-21;\n", "", "END-ISO-10303-21 is missing"),
        ("END-ISO-10303-21;\n", "END-ISO-10303-21", ""),
        ("ENDSEC;\nDATA;", "DATA;", ""),
    ] {
        assert!(text.contains(from));
        let file = read(&text.replace(from, to));
        is_a_cube(&file, 2.);
        let expected: Vec<&str> = Some(told).filter(|t| !t.is_empty()).into_iter().collect();
        assert_eq!(file.notes, expected);
    }
    // Between two instances nobody knows what else there was.
    let end = text.rfind("#").unwrap();
    let error = read_step(&text.as_bytes()[..end], "part.step").unwrap_err();
    assert!(error.to_string().contains("the end of the file"), "{error}");
}

#[test]
fn types_in_small_letters() {
    let text = cube_in_millimetres().0.text().to_lowercase();
    let text = text.replace(",.t.)", ",.T.)").replace("'part'", "'Part'");
    let file = read(&text);
    is_a_cube(&file, 2.);
    let told = "types of instances in small letters were read as if in capitals";
    assert_eq!(file.notes, [told]);
}

#[test]
fn white_space_and_comments_between_all_tokens() {
    let text = cube_in_millimetres().0.text();
    let data = text.find("DATA;").unwrap();
    let (head, data) = text.split_at(data);
    for filler in [
        " ",
        "\t\r\n",
        "\n\n  \n",
        "/* a comment */",
        " /* with ; ) ( ' #1=X(); in it */ ",
        "/**/",
        "/* over\nlines *//***/\n",
    ] {
        is_a_cube(&read(&format!("{head}{}", between(data, filler))), 2.);
    }
    // All on one line, and with carriage returns alone.
    is_a_cube(&read(&text.replace('\n', "")), 2.);
    is_a_cube(&read(&text.replace('\n', "\r")), 2.);
    // In the header too, and in front of it.
    is_a_cube(
        &read(&format!("{}{data}", head.replace(";\n", "; /* x */\n"))),
        2.,
    );
    // A comment of a million characters.
    let long = format!("/*{}*/", "x".repeat(1_000_000));
    is_a_cube(&read(&text.replace("DATA;", &format!("DATA;{long}"))), 2.);
}

#[test]
fn strings_with_quotes_and_other_alphabets() {
    let text = cube_in_millimetres().0.text();
    for (written, name) in [
        (r"\X2\00DF00E4\X0\ and ''quotes''", "ßä and 'quotes'"),
        (r"\X\E4 \S\d", "ä ä"),
        (r"\X4\0001F600\X0\", "\u{1F600}"),
        (r"a\\b", r"a\b"),
        ("MANIFOLD_SOLID_BREP(''", "MANIFOLD_SOLID_BREP('"),
    ] {
        let named = text.replace(
            "MANIFOLD_SOLID_BREP(''",
            &format!("MANIFOLD_SOLID_BREP('{written}'"),
        );
        let file = read(&named);
        is_a_cube(&file, 2.);
        assert_eq!(file.bodies[0].name.as_deref(), Some(name), "{written}");
    }
}

#[test]
fn numbers_in_all_their_forms() {
    let text = cube_in_millimetres().0.text();
    for (two, zero) in [
        ("2", "0"),
        ("2.", "-0."),
        ("+2.", "-0.0"),
        ("2.E0", "0.E0"),
        ("2E0", "0E0"),
        ("2.0E+00", "-0.E-00"),
        ("20.0E-0001", "0.000E+0000"),
        ("0.2e1", "0.e5"),
        ("002.000", "00.0"),
    ] {
        let number = |c: &str| match c {
            "2.0" => two.to_owned(),
            "0.0" | "-0.0" => zero.to_owned(),
            other => other.to_owned(),
        };
        let lines = text
            .lines()
            .map(|line| match line.contains("CARTESIAN_POINT") {
                true => {
                    let (front, rest) = line.split_once(",(").unwrap();
                    let (numbers, back) = rest.split_once("))").unwrap();
                    let numbers: Vec<String> = numbers.split(',').map(number).collect();
                    format!("{front},({})){back}", numbers.join(","))
                }
                false => line.to_owned(),
            });
        let changed = lines.collect::<Vec<_>>().join("\n");
        assert!(changed.contains(&format!("({two},")), "{changed}");
        is_a_cube(&read(&changed), 2.);
    }
}

#[test]
fn prefixes_of_the_metre() {
    let text = cube_in_millimetres().0.text();
    for (prefix, metres) in [
        ("$", 1.),
        (".KILO.", 1e3),
        (".DECI.", 1e-1),
        (".CENTI.", 1e-2),
        (".MILLI.", 1e-3),
        (".MICRO.", 1e-6),
        (".NANO.", 1e-9),
    ] {
        let unit = format!("SI_UNIT({prefix},.METRE.)");
        let mut file = read(&text.replace("SI_UNIT(.MILLI.,.METRE.)", &unit));
        near(file.unit.to_metre.unwrap(), metres, 1e-15);
        file.convert_to(&LengthUnit::from_name("mm").unwrap())
            .unwrap();
        is_a_cube(&file, 2e3 * metres);
    }
}

/// Two solids in contexts of millimetres and of metres: each as large as its own context says.
#[test]
fn contexts_of_different_units() {
    let mut step = Step::default();
    let mut solid = |at: f64| {
        let faces = box_faces(&mut step, [[at, 0., 0.], [at + 2., 2., 2.]], [None, None]);
        let refs: Vec<&str> = faces.iter().map(String::as_str).collect();
        step.solid(&refs)
    };
    let (small, large) = (solid(0.), solid(10.));
    let context = step.millimetres();
    step.shape(&[&small], &context);
    let metre = step.add("(LENGTH_UNIT()NAMED_UNIT(*)SI_UNIT($,.METRE.))");
    let angle = step.add("(NAMED_UNIT(*)PLANE_ANGLE_UNIT()SI_UNIT($,.RADIAN.))");
    let context = step.context(&metre, &angle);
    step.shape(&[&large], &context);
    let mut file = step.read();
    assert!(file.skipped.is_empty(), "{:?}", file.skipped);
    file.convert_to(&LengthUnit::from_name("mm").unwrap())
        .unwrap();
    let volumes: Vec<f64> = (0..2).map(|body| volume(&set(&file, Some(body)))).collect();
    near(volumes[0], 8., 1e-9);
    near(volumes[1], 8e9, 1e-9);
}

/// Faces without a bound are the whole of a closed surface, and nothing of an open one.
#[test]
fn faces_without_bounds() {
    let (origin, z, x) = ([1., 2., 3.], [0., 0., 1.], [1., 0., 0.]);
    for (kind, numbers, whole) in [
        ("SPHERICAL_SURFACE", "2.", 16. * PI),
        ("TOROIDAL_SURFACE", "3.,1.", 12. * PI * PI),
    ] {
        for same in [true, false] {
            let mut step = Step::default();
            let place = step.placement(origin, z, x);
            let surface = step.placed(kind, &place, numbers);
            let face = step.face(&[], &surface, same);
            let solid = step.solid(&[&face]);
            let file = step.whole(&[&solid]);
            near(area(&set(&file, None)), whole, 1e-7);
        }
    }
    let mut step = Step::default();
    let place = step.placement(origin, z, x);
    let plane = step.placed("PLANE", &place, "");
    let face = step.face(&[], &plane, true);
    let sheet = step.sheet(&[&face]);
    let context = step.millimetres();
    step.shape(&[&sheet], &context);
    let file = step.read();
    assert_eq!((file.patches.len(), file.skipped.len()), (0, 1));
    assert!(!file.skipped[0].reason.is_empty());
}

/// A cone whose tip is written as an edge of no length between the two sides of its seam.
#[test]
fn edges_of_no_length_at_a_tip() {
    let (z, x) = ([0., 0., 1.], [1., 0., 0.]);
    for degenerate in [true, false] {
        let mut step = Step::default();
        let place = step.placement([0.; 3], z, x);
        // Radius 1 at z = 0, growing with z: the tip is at z = -1.
        let cone = step.placed("CONICAL_SURFACE", &place, &format!("1.,{:?}", PI / 4.));
        let tip = step.vertex([0., 0., -1.]);
        let rim = step.vertex([1., 0., 0.]);
        let seam = step.line([&tip, &rim], [[0., 0., -1.], [1., 0., 0.]]);
        let circle = step.placed("CIRCLE", &place, "1.");
        let circle = step.edge([&rim, &rim], &circle);
        let mut edges = vec![format!("-{circle}"), format!("-{seam}")];
        if degenerate {
            let at = step.point([0., 0., -1.]);
            let along = step.direction(x);
            let along = step.add(format!("VECTOR('',{along},1.)"));
            let line = step.add(format!("LINE('',{at},{along})"));
            edges.push(step.edge([&tip, &tip], &line));
        }
        edges.push(seam);
        let refs: Vec<&str> = edges.iter().map(String::as_str).collect();
        let bound = step.bound(&refs);
        let side = step.face(&[&bound], &cone, true);
        let plane = step.placed("PLANE", &place, "");
        let bound = step.bound(&[&circle]);
        let lid = step.face(&[&bound], &plane, true);
        let solid = step.solid(&[&side, &lid]);
        let file = step.whole(&[&solid]);
        let set = set(&file, None);
        near(area(&set), PI + PI * 2f64.sqrt(), 1e-7);
        near(volume(&set), PI / 3., 1e-7);
    }
}
