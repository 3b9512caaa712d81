//! What is wrong with a scene of the right form is found, all of it at once, and its place.
use covact::scene::{check, parse};

const SCENE: &str = r#"{
  "covact": 1,
  "materials": {"steel": {"neo_hooke": {"E": 210000, "nu": 0.3}}},
  "bodies": {
    "sheet": {
      "mesh": {"plate": {"size": [10, 10], "thickness": 0.8, "elements": [4, 4]}},
      "material": "steel",
      "sets": {"mid": {"nodes_near_point": {"point": [5, 5, 0], "tolerance": 0.1}}}
    }
  },
  "surfaces": {
    "ball": {"sphere": {"radius": 5}, "motion": {"translation": [0, 0, "-t"]}}
  },
  "contacts": {"c1": {"slave": "sheet.top", "master": "ball", "points": {"gauss": 2}}},
  "supports": {"edge": {"on": "sheet.x_min", "displacement": {"z": "0.1*x*t"}}},
  "loads": {"p": {"on": "sheet.bottom", "pressure": "t", "follower": true}},
  "solution": {"step": {"initial": 0.1}}
}
"#;

fn problems(text: &str) -> Vec<String> {
    let loaded = parse(text, "scene.json").unwrap_or_else(|e| panic!("{e}"));
    check(&loaded).iter().map(|p| p.to_string()).collect()
}

/// Every case is (replaced, by, start of the only problem).
fn check_all(cases: &[(&str, &str, &str)]) {
    let mut wrong = String::new();
    for (from, to, expected) in cases {
        assert!(SCENE.contains(from), "{from}");
        let found = problems(&SCENE.replacen(from, to, 1));
        if found.len() != 1 || !found[0].starts_with(expected) {
            wrong += &format!("{from} -> {to}\nfound    {found:?}\nexpected {expected}\n");
        }
    }
    assert!(wrong.is_empty(), "{wrong}");
}

#[test]
fn the_scene_itself_is_right() {
    assert_eq!(problems(SCENE), Vec::<String>::new());
}

#[test]
fn stabilization() {
    let given = "\"step\": {\"initial\": 0.1}";
    check_all(&[
        (
            given,
            "\"stabilization\": {\"viscous\": {\"factor\": 0}}",
            "17:56: the factor is 0",
        ),
        (
            given,
            "\"stabilization\": {\"viscous\": {\"until\": -1}}",
            "17:55: the time is -1",
        ),
    ]);
    let free = SCENE.replacen(given, "\"stabilization\": \"none\"", 1);
    assert_eq!(problems(&free), Vec::<String>::new());
}

#[test]
fn augmentation_and_offset() {
    check_all(&[
        (
            "\"points\": {\"gauss\": 2}",
            "\"augmentation\": {\"gap\": 0}",
            "14:87: the tolerance",
        ),
        (
            "\"points\": {\"gauss\": 2}",
            "\"augmentation\": {\"slip\": -1}",
            "14:88: the tolerance",
        ),
        (
            "\"points\": {\"gauss\": 2}",
            "\"augmentation\": {\"max\": 0}",
            "14:87: ",
        ),
        (
            "\"points\": {\"gauss\": 2}",
            "\"tangent\": {\"published\": {}}, \"offset\": 0.5",
            "14:63: the published tangent, which is right on the surface, does not go with an offset",
        ),
        (
            "\"points\": {\"gauss\": 2}",
            "\"offset\": -0.5",
            "14:73: the offset",
        ),
    ]);
}

#[test]
fn names_that_do_not_exist() {
    check_all(&[
        (
            "\"material\": \"steel\"",
            "\"material\": \"stell\"",
            "7:19: there is no material `stell` (did you mean `steel`? materials: `steel`)",
        ),
        (
            "\"master\": \"ball\"",
            "\"master\": \"bal\"",
            "14:55: there is no surface `bal` (did you mean `ball`?",
        ),
        (
            "sheet.top",
            "shet.top",
            "14:32: there is no body `shet` (did you mean `sheet.top`? bodies: `sheet`)",
        ),
        (
            "sheet.top",
            "sheet.tops",
            "14:32: the body `sheet` has no set `tops` (did you mean `top`? sets of `sheet`: `bottom`, `mid`, `top`,",
        ),
        (
            "sheet.bottom",
            "sheet",
            "16:25: `sheet` does not name a set (write body and set, as in `sheet.bottom`)",
        ),
        (
            "sheet.top",
            "sheet.mid",
            "14:32: `sheet.mid` is a set of nodes, but contact needs faces (face sets of",
        ),
        (
            "sheet.bottom",
            "sheet.mid",
            "16:25: `sheet.mid` is a set of nodes, but a pressure needs faces",
        ),
    ]);
    // Supports take nodes, and a force takes them, too.
    assert!(problems(&SCENE.replace("sheet.x_min", "sheet.mid")).is_empty());
    let force = SCENE.replace("sheet.bottom", "sheet.mid").replace(
        "\"pressure\": \"t\", \"follower\": true",
        "\"force\": [0, 0, \"t\"]",
    );
    assert!(problems(&force).is_empty());
}

#[test]
fn one_and_only_one() {
    check_all(&[
        (
            "\"sphere\": {\"radius\": 5}, ",
            "",
            "12:5: the surface does not say what it is (exactly one of `cad`,",
        ),
        (
            "\"sphere\": {\"radius\": 5}",
            "\"sphere\": {\"radius\": 5}, \"plane\": {\"size\": [1, 1]}",
            "12:5: the surface has `sphere` and `plane` at once (exactly one of",
        ),
        (
            "\"displacement\": {\"z\": \"0.1*x*t\"}",
            "\"mid_surface\": true",
            "15:16: the support does not say what",
        ),
        (
            "\"displacement\":",
            "\"fixed\": true, \"displacement\":",
            "15:16: the support has `fixed` and `displacement`",
        ),
        (
            "{\"z\": \"0.1*x*t\"}",
            "{}",
            "15:46: no component is prescribed (give one of `x`, `y`, `z`)",
        ),
        (
            "\"pressure\": \"t\", \"follower\": true",
            "\"follower\": false",
            "16:13: the load does not say what it is",
        ),
        (
            "\"pressure\": \"t\"",
            "\"traction\": [0, 0, \"x\"]",
            "16:78: only a pressure can follow the faces",
        ),
    ]);
}

#[test]
fn numbers_out_of_range() {
    check_all(&[
        (
            "210000",
            "-1",
            "3:46: Young's modulus `E` is -1 (it must be positive)",
        ),
        (
            "0.3}",
            "0.5}",
            "3:60: Poisson's ratio `nu` is 0.5 (-1 < nu < 0.5;",
        ),
        (
            "[10, 10]",
            "[10, 0]",
            "6:39: a length of the plate is 0 (it must be positive)",
        ),
        (
            "[4, 4]",
            "[0, 4]",
            "6:75: `elements` is 0 (a whole number from 1 to 50000000)",
        ),
        (
            "[4, 4]",
            "[40000, 40000]",
            "6:62: 1.600e9 elements in all (at most 5e7)",
        ),
        (
            "\"tolerance\": 0.1",
            "\"tolerance\": -1",
            "8:78: the tolerance is -1",
        ),
        ("\"radius\": 5", "\"radius\": 0", "12:35: the radius is 0"),
        (
            "\"radius\": 5",
            "\"radius\": 5, \"axis\": [0, 0, 0]",
            "12:38: the axis has no direction",
        ),
        (
            "{\"gauss\": 2}",
            "{\"gauss\": 11}",
            "14:83: `gauss` is 11 (a whole number from 1 to 10)",
        ),
        (
            "{\"gauss\": 2}",
            "{\"lobatto\": 1}",
            "14:85: `lobatto` is 1 (a whole number from 2 to 10)",
        ),
        (
            "\"points\"",
            "\"penalty\": {\"value\": 0}, \"points\"",
            "14:84: the penalty is 0",
        ),
        (
            "\"initial\": 0.1",
            "\"initial\": 0.2, \"max\": 0.1",
            "17:36: the first step 0.2 is larger than the largest step 0.1",
        ),
        (
            "\"initial\": 0.1",
            "\"initial\": 0.1, \"min\": 0.2, \"max\": 1",
            "17:48: the smallest step 0.2 is larger than the first step",
        ),
        (
            "\"step\":",
            "\"newton\": {\"tolerance\": 1}, \"step\":",
            "17:40: the tolerance is 1 (a part of",
        ),
        (
            "\"step\":",
            "\"end_time\": 0, \"step\":",
            "17:28: the end time is 0",
        ),
        (
            "\"elements\": [4, 4]",
            "\"elements\": [4, 4], \"spacing\": [\"uniform\", {\"fine\": {\"length\": 10, \"fine\": 2}}]",
            "6:125: the fine part 10 is not shorter than the axis 10",
        ),
    ]);
}

#[test]
fn friction_with_two_coefficients() {
    let points = "\"points\": {\"gauss\": 2}";
    let with = |friction: &str| {
        let text = format!("{points}, \"friction\": {{\"orthotropic\": {friction}}}");
        problems(&SCENE.replacen(points, &text, 1))
    };
    let right = r#"{"mu": [0.1, {"table": [[0, 0.2], [1, 0.3]]}], "direction": [1, 0, 0]}"#;
    assert_eq!(with(right), Vec::<String>::new());
    for (friction, expected) in [
        (
            r#"{"mu": [0.1, -0.3], "direction": [1, 0, 0]}"#,
            "the coefficient of friction is -0.3",
        ),
        (
            r#"{"mu": [0.1, 0.3], "direction": [0, 0, 0]}"#,
            "the direction has no length",
        ),
    ] {
        let found = with(friction);
        assert!(
            found.len() == 1 && found[0].contains(expected) && found[0].starts_with("14:"),
            "{found:?}"
        );
    }
}

#[test]
fn values() {
    check_all(&[
        (
            "\"-t\"",
            "\"-x\"",
            "12:74: unknown variable `x` (possible here: `t`, `pi`, `e`)",
        ),
        (
            "0.1*x*t",
            "0.1*x*s",
            "15:75: unknown variable `s` (possible here: `x`, `y`, `z`, `t`",
        ),
        (
            "0.1*x*t",
            "0.1*sim(x)",
            "15:73: unknown function `sim` (did you mean `sin`?",
        ),
        (
            "\"-t\"",
            "{\"table\": [[0, 0], [1, 1], [1, 2]]}",
            "12:100: times of a table must increase: row 3 has t = 1",
        ),
        ("\"-t\"", "{\"table\": []}", "12:73: the table has no rows"),
        ("\"-t\"", "\"1/0\"", "12:72: the expression `1/0` is inf"),
        (
            "\"pressure\": \"t\", \"follower\": true",
            "\"force\": [0, 0, \"x\"]",
            "16:58: unknown variable `x` (possible here: `t`, `pi`, `e`)",
        ),
    ]);
}

#[test]
fn names_that_cannot_be_used() {
    check_all(&[
        (
            "\"mid\"",
            "\"top\"",
            "8:16: the plate has a set `top` of its own (choose another name)",
        ),
        (
            "\"p\":",
            "\"edge\":",
            "16:13: the name `edge` is also used in `supports`",
        ),
        (
            "\"p\":",
            "\"p,q\":",
            "16:13: the name `p,q` holds the character ','",
        ),
    ]);
    let dotted = SCENE.replace("\"sheet\"", "\"she.et\"");
    assert!(
        problems(&dotted)
            .iter()
            .any(|p| p.starts_with("5:5: the name `she.et` holds the character '.'"))
    );
}

#[test]
fn files_that_are_not_there() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("punch.igs"), "x").unwrap();
    let path = folder.path().join("scene.json");
    let with = |file: &str| {
        SCENE.replace(
            "\"sphere\": {\"radius\": 5}",
            &format!("\"cad\": {{\"file\": {file:?}}}"),
        )
    };
    let found = |file: &str| {
        std::fs::write(&path, with(file)).unwrap();
        let loaded = covact::scene::load(&path).unwrap();
        check(&loaded)
            .iter()
            .map(|p| p.to_string())
            .collect::<Vec<_>>()
    };
    assert_eq!(found("punch.igs"), Vec::<String>::new());
    let one = found("punhc.igs");
    assert_eq!(one.len(), 1, "{one:?}");
    assert!(
        one[0].starts_with("12:30: there is no file `"),
        "{}",
        one[0]
    );
    assert!(
        one[0].ends_with("(did you mean `punch.igs`?)"),
        "{}",
        one[0]
    );
    assert!(found("../")[0].contains("is a folder, not a file"));
}

#[test]
fn all_problems_are_listed_in_the_order_of_the_file() {
    let text = SCENE
        .replace("210000", "0")
        .replace("\"thickness\": 0.8", "\"thickness\": -1")
        .replace("\"master\": \"ball\"", "\"master\": \"bowl\"")
        .replace("\"-t\"", "\"-\"")
        .replace("0.1*x*t", "(x");
    let found = problems(&text);
    let lines: Vec<&str> = found
        .iter()
        .map(|p| p.split(':').next().unwrap_or_default())
        .collect();
    assert_eq!(lines, ["3", "6", "12", "14", "15"], "{found:?}");
}

#[test]
fn facets_say_how_fine_they_are() {
    let sphere = "\"sphere\": {\"radius\": 5}";
    let with = |facets: &str| {
        let text = SCENE.replacen(sphere, &format!("{sphere}, \"facets\": {facets}"), 1);
        assert!(text.contains(facets));
        problems(&text)
    };
    for good in ["\"chord\": 0.1", "\"size\": 2", "\"count\": [3, 4]"] {
        let facets = format!("{{\"kind\": \"smooth\", {good}}}");
        assert_eq!(with(&facets), Vec::<String>::new());
    }
    for (facets, expected) in [
        (
            "{\"kind\": \"bilinear\"}",
            "the fineness of the facets does not say what it is (exactly one of `chord`, `size`, `count`)",
        ),
        (
            "{\"kind\": \"bilinear\", \"chord\": 0.1, \"size\": 1}",
            "the fineness of the facets has `chord` and `size` at once",
        ),
        (
            "{\"kind\": \"bilinear\", \"chord\": 0}",
            "the chord error is 0 (it must be positive)",
        ),
        (
            "{\"kind\": \"biquadratic\", \"size\": -1}",
            "the size of the facets is -1 (it must be positive)",
        ),
        (
            "{\"kind\": \"biquadratic\", \"count\": [4, 0]}",
            "`count` is 0 (a whole number from 1 to 100000)",
        ),
    ] {
        let found = with(facets);
        assert_eq!(found.len(), 1, "{found:?}");
        assert!(
            found[0].starts_with("12:") && found[0].contains(expected),
            "{found:?}"
        );
    }
}

/// Constants of metals, and what does not go with them.
#[test]
fn metals() {
    let steel = "\"steel\": {\"neo_hooke\": {\"E\": 210000, \"nu\": 0.3}}";
    let metal = |nu: &str, hardening: &str| {
        format!(
            "\"steel\": {{\"j2\": {{\"E\": 210000, \"nu\": {nu}, \"hardening\": {hardening}}}}}"
        )
    };
    let of = |hardening: &str| metal("0.3", hardening);
    assert_eq!(
        problems(&SCENE.replace(steel, &of("{\"table\": [[0, 200], [0.1, 250]]}"))),
        Vec::<String>::new()
    );
    let cases = [
        (
            metal("0.495", "{\"linear\": {\"yield_stress\": 200}}"),
            "Poisson's ratio `nu` is 0.495, above 0.49",
        ),
        (
            of("{\"linear\": {\"yield_stress\": 0}}"),
            "the `yield_stress` is 0",
        ),
        (
            of("{\"linear\": {\"yield_stress\": 200, \"slope\": -1}}"),
            "the `slope` is -1",
        ),
        (
            of("{\"swift\": {\"strength\": 500, \"offset\": 0, \"exponent\": 0.2}}"),
            "the `offset` is 0",
        ),
        (
            of("{\"swift\": {\"strength\": 500, \"offset\": 0.01, \"exponent\": 2}}"),
            "the `exponent` is 2",
        ),
        (
            of("{\"voce\": {\"yield_stress\": 200, \"rise\": -1, \"rate\": 5}}"),
            "the `rise` is -1",
        ),
        (
            of("{\"table\": []}"),
            "a table of yield stresses without rows",
        ),
        (
            of("{\"table\": [[0.1, 200]]}"),
            "the first row has a plastic strain of 0.1",
        ),
        (
            of("{\"table\": [[0, 200], [0, 250]]}"),
            "a plastic strain of 0 follows 0",
        ),
        (
            of("{\"table\": [[0, 200], [0.1, 150]]}"),
            "a yield stress of 150 follows 200",
        ),
    ];
    for (text, expected) in cases {
        let found = problems(&SCENE.replace(steel, &text));
        // With its place.
        assert!(
            found.len() == 1 && found[0].starts_with("3:") && found[0].contains(expected),
            "{text}: {found:?}"
        );
    }
    let scene = SCENE.replace(steel, &of("{\"linear\": {\"yield_stress\": 200}}"));
    let quadratic = scene.replace(
        "\"material\": \"steel\"",
        "\"element\": \"q18\", \"material\": \"steel\"",
    );
    let found = problems(&quadratic);
    assert!(
        found.len() == 1 && found[0].contains("the material `steel` flows, which `q18`"),
        "{found:?}"
    );
    let small = scene.replace(
        "\"solution\": {",
        "\"solution\": {\"kinematics\": \"small\", ",
    );
    let found = problems(&small);
    assert!(
        found
            .iter()
            .any(|p| p.contains("is linear, but the material `steel` of body `sheet` flows")),
        "{found:?}"
    );
}

#[test]
fn sides_of_contacts() {
    let slave = "\"sheet.top\"";
    for right in [
        "\"sheet\"",
        "[\"sheet.top\"]",
        "[\"sheet.top\", \"sheet.x_max\"]",
    ] {
        assert_eq!(
            problems(&SCENE.replacen(slave, right, 1)),
            Vec::<String>::new(),
            "{right}"
        );
    }
    check_all(&[
        (slave, "[]", "14:23: the list of sets is empty"),
        (
            slave,
            "[\"sheet.top\", \"sheet.tip\"]",
            "14:46: the body `sheet` has no set `tip` (did you mean `top`?",
        ),
        (
            slave,
            "[\"sheet.top\", \"sheet.mid\"]",
            "14:46: `sheet.mid` is a set of nodes, but contact needs faces",
        ),
        (
            slave,
            "\"sheets\"",
            "14:32: `sheets` does not name a set (write `body.set`; bodies: `sheet`)",
        ),
        (
            "\"master\": \"ball\"",
            "\"master\": [\"ball\", \"sheet.bottom\"]",
            "14:45: a rigid surface is one of several masters (give every rigid surface a contact of its own",
        ),
        (
            "\"master\": \"ball\"",
            "\"master\": \"bal\"",
            "14:55: there is no surface `bal` (did you mean `ball`?",
        ),
        // Both sides on one body.
        (
            "\"master\": \"ball\", \"points\": {\"gauss\": 2}",
            "\"master\": [\"sheet.bottom\"], \"points\": {\"segments\": 2}",
            "14:96: slave and master belong to one body",
        ),
    ]);
    let two = SCENE.replacen(
        "\"bodies\": {",
        "\"bodies\": {\"lid\": {\"mesh\": {\"plate\": {\"size\": [1, 1], \"thickness\": 1, \"elements\": [1, 1]}}, \"material\": \"steel\"},",
        1,
    );
    let found = problems(&two.replacen(slave, "[\"sheet.top\", \"lid.bottom\"]", 1));
    assert_eq!(
        found,
        [
            "14:46: `sheet.top` and `lid.bottom` belong to two bodies (write a contact for each body: a list is for face sets of one body)"
        ]
    );
    let sheet = "{\"plate\": {\"size\": [10, 10], \"thickness\": 0.8, \"elements\": [4, 4]}}";
    let nurbs = SCENE
        .replacen(
            &format!("\"mesh\": {sheet}"),
            "\"nurbs\": {\"file\": \"assets/panel.igs\", \"thickness\": 1}",
            1,
        )
        .replacen(slave, "\"sheet\"", 1);
    let found = problems(&nurbs).join("; ");
    assert!(
        found.contains("`sheet` is a body of kind `nurbs`, of which contact needs one side (name one: `bottom`, `top`)"),
        "{found}"
    );
}
