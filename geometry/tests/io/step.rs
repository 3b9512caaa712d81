//! STEP files as a whole: structure and its damage, units, assemblies, names, what is not read.

use crate::step_builder::{Step, area, box_faces, cube, extent, near, set, volume};
use crate::support::assets;
use covact_geometry::io::{CadFormat, SkipKind, read_path, read_step};
use std::path::PathBuf;

fn data(name: &str) -> PathBuf {
    PathBuf::from(concat!(env!("CARGO_MANIFEST_DIR"), "/tests/data/step")).join(name)
}

fn refs(list: &[String]) -> Vec<&str> {
    list.iter().map(String::as_str).collect()
}

#[test]
fn cube_of_six_faces() {
    let (step, solid, _) = cube();
    let file = step.whole(&[&solid]);
    assert_eq!(file.format, CadFormat::Step);
    assert_eq!(file.unit.name, "mm");
    near(file.resolution.unwrap(), 1e-7, 1e-12);
    assert_eq!(file.patches.len(), 6);
    // The edges of planes are projected without loss, so every face is a rectangle.
    assert!(file.patches.iter().all(|p| !p.trimmed()));
    let faces = file
        .entities
        .iter()
        .find(|e| e.name == "ADVANCED_FACE")
        .unwrap();
    assert_eq!(faces.count, 6);
    let set = set(&file, None);
    assert!(
        set.sides().iter().all(|&s| s == 1.0),
        "normals of the file point out"
    );
    near(area(&set), 24., 1e-12);
    near(volume(&set), 8., 1e-12);
}

fn failure(text: &str) -> String {
    read_step(text.as_bytes(), "part.step")
        .unwrap_err()
        .to_string()
}

#[test]
fn damage_is_told_with_line_and_column() {
    let (mut step, solid, _) = cube();
    let context = step.millimetres();
    step.shape(&[&solid], &context);
    let text = step.text();
    let line_of = |part: &str| text.lines().position(|l| l.contains(part)).unwrap() + 1;
    let at = line_of("CLOSED_SHELL");
    let column = |part: &str| text.lines().nth(at - 1).unwrap().find(part).unwrap() + 1;
    assert_eq!(
        failure(&text.replace("CLOSED_SHELL('',(", "CLOSED_SHELL('',((")),
        format!(
            "part.step:{at}:{}: expected a comma or a closing parenthesis, found \";\"",
            text.lines().nth(at - 1).unwrap().len() + 1
        )
    );
    assert_eq!(
        failure("ISO-10303-21;\nDATA;\n#1=A('x);\n"),
        "part.step:3:6: expected a string that ends ('), found \"'x);\""
    );
    assert_eq!(
        failure(&text.replace("CLOSED_SHELL(", "CLOSED_SHELL(1.2.3,")),
        format!(
            "part.step:{at}:{}: expected a number, found \"{}\"",
            column("('") + 1,
            &format!(
                "1.2.3,{}",
                &text.lines().nth(at - 1).unwrap()[column("('")..]
            )[..24]
        )
    );
    let double = text.replace("#2=", "#1=");
    assert_eq!(
        failure(&double),
        "part.step:9:1: expected the name of another instance, found #1, which stands in line 8 already"
    );
    assert_eq!(
        failure("ISO-10303-21;\nHEADER;\nENDSEC;\nDATA;\n#1=A();\n"),
        "part.step:6:1: expected an instance (#12 = ...) or ENDSEC, found the end of the file"
    );
    assert_eq!(
        failure("ISO-10303-21;\n/* a comment\n"),
        "part.step:2:1: expected a comment that ends (*/), found \"/* a comment\""
    );
    let deep = format!(
        "ISO-10303-21;\nDATA;\n#1=A{}{};\n",
        "(".repeat(100),
        ")".repeat(100)
    );
    assert!(
        failure(&deep).contains("lists nested at most 64 deep"),
        "{}",
        failure(&deep)
    );
}

#[test]
fn wrong_values_cost_the_faces_that_need_them() {
    let (mut step, solid, _) = cube();
    let context = step.millimetres();
    step.shape(&[&solid], &context);
    let text = step.text();
    let change = |from: &str, to: &str| {
        assert!(text.contains(from), "{from}");
        let file = read_step(text.replacen(from, to, 1).as_bytes(), "part.step").unwrap();
        let reasons: Vec<String> = file.skipped.iter().map(|s| s.reason.clone()).collect();
        (file.patches.len(), reasons)
    };
    // An edge of two faces.
    let (read, reasons) = change("EDGE_CURVE('',", "EDGE_CURVE('',#99999,");
    assert_eq!((read, reasons.len()), (4, 2), "{reasons:?}");
    assert!(
        reasons[0].contains("#99999, which is not in the file (line "),
        "{reasons:?}"
    );
    let (read, reasons) = change("PLANE('',", "QUADRIC('',");
    assert_eq!(read, 5);
    assert!(
        reasons[0].ends_with("(QUADRIC) is a surface of a type that is not read"),
        "{reasons:?}"
    );
    let (_, reasons) = change("VERTEX_POINT('',#", "VERTEX_POINT('',.T.,#");
    assert!(
        reasons[0].contains("expected the point of a vertex (an instance), found .T. (line "),
        "{reasons:?}"
    );
    let (_, reasons) = change(
        "CARTESIAN_POINT('',(0.0,0.0,0.0))",
        "CARTESIAN_POINT('',(0.0,0.0))",
    );
    assert!(
        reasons[0].contains("expected 3 coordinates, found a list of 2 values"),
        "{reasons:?}"
    );
}

#[test]
fn references_in_circles_end() {
    for text in [
        "#1=TRIMMED_CURVE('',#1,(0.),(1.),.T.,.PARAMETER.);\n#2=SURFACE_OF_LINEAR_EXTRUSION('',#1,#4);",
        "#1=OFFSET_SURFACE('',#2,1.,.F.);\n#2=OFFSET_SURFACE('',#1,1.,.F.);",
        "#1=COMPOSITE_CURVE('',(#3,#3,#3,#3),.F.);\n#3=COMPOSITE_CURVE_SEGMENT(.CONTINUOUS.,.T.,#1);\n\
         #2=SURFACE_OF_LINEAR_EXTRUSION('',#1,#4);",
        "#1=ORIENTED_CLOSED_SHELL('',*,#1,.T.);\n#2=MANIFOLD_SOLID_BREP('',#1);",
        "#1=CLOSED_SHELL('',(#3));\n#3=ORIENTED_FACE('',*,#3,.T.);\n#2=MANIFOLD_SOLID_BREP('',#1);",
    ] {
        let file = format!(
            "ISO-10303-21;\nDATA;\n{text}\n#4=VECTOR('',#5,1.);\n#5=DIRECTION('',(0.,0.,1.));\n\
             #9=SHAPE_REPRESENTATION('',(#2),#8);\n\
             #8=(REPRESENTATION_CONTEXT('','')GEOMETRIC_REPRESENTATION_CONTEXT(3));\nENDSEC;\nEND-ISO-10303-21;\n"
        );
        let file = read_step(file.as_bytes(), "part.step").unwrap();
        assert_eq!(file.skipped.len(), 1, "{text}: {:?}", file.skipped);
        assert!(
            file.skipped[0]
                .reason
                .contains("16 deep, or refers to itself"),
            "{:?}",
            file.skipped
        );
    }
}

/// Products with names, a part placed twice in an assembly in inches, one copy turned by a quarter about z.
#[test]
fn assembly_of_two_placements_in_inches() {
    let mut step = Step::default();
    let millimetre = step.add("(LENGTH_UNIT()NAMED_UNIT(*)SI_UNIT(.MILLI.,.METRE.))");
    let factor = step.add(format!(
        "LENGTH_MEASURE_WITH_UNIT(LENGTH_MEASURE(25.4),{millimetre})"
    ));
    let exponents = step.add("DIMENSIONAL_EXPONENTS(1.,0.,0.,0.,0.,0.,0.)");
    let inch = step.add(format!(
        "(CONVERSION_BASED_UNIT('INCH',{factor})LENGTH_UNIT()NAMED_UNIT({exponents}))"
    ));
    let radian = step.add("(NAMED_UNIT(*)PLANE_ANGLE_UNIT()SI_UNIT($,.RADIAN.))");
    let inches = step.context(&inch, &radian);
    // The part is in millimetres, the assembly in inches.
    let millimetres = step.context(&millimetre, &radian);
    let product = |step: &mut Step, name: &str| {
        let product = step.add(format!("PRODUCT('','{name}','',())"));
        let formation = step.add(format!("PRODUCT_DEFINITION_FORMATION('','',{product})"));
        step.add(format!("PRODUCT_DEFINITION('','',{formation},$)"))
    };
    let (whole, part) = (
        product(&mut step, "press"),
        product(&mut step, "St\\X\\F6\\S\\_el"),
    );
    let faces = box_faces(&mut step, [[0.; 3], [25.4, 50.8, 76.2]], [None, None]);
    let solid = step.solid(&refs(&faces));
    let own = step.placement([0.; 3], [0., 0., 1.], [1., 0., 0.]);
    let shape = step.shape(&[&own, &solid], &millimetres);
    let at = [
        step.placement([10., 0., 0.], [0., 0., 1.], [1., 0., 0.]),
        step.placement([0., 20., 0.], [0., 0., 1.], [0., 1., 0.]),
    ];
    let items = format!("{},{}", at[0], at[1]);
    let all = step.add(format!("SHAPE_REPRESENTATION('',({items}),{inches})"));
    let define = |step: &mut Step, definition: &str, shape: &str| {
        let property = step.add(format!("PRODUCT_DEFINITION_SHAPE('','',{definition})"));
        step.add(format!(
            "SHAPE_DEFINITION_REPRESENTATION({property},{shape})"
        ));
    };
    define(&mut step, &whole, &all);
    define(&mut step, &part, &shape);
    for target in &at {
        let map = step.add(format!("ITEM_DEFINED_TRANSFORMATION('','',{own},{target})"));
        let relation = step.add(format!(
            "(REPRESENTATION_RELATIONSHIP('','',{shape},{all})\
             REPRESENTATION_RELATIONSHIP_WITH_TRANSFORMATION({map})SHAPE_REPRESENTATION_RELATIONSHIP())"
        ));
        let usage = step.add(format!(
            "NEXT_ASSEMBLY_USAGE_OCCURRENCE('','','',{whole},{part},$)"
        ));
        let property = step.add(format!("PRODUCT_DEFINITION_SHAPE('','',{usage})"));
        step.add(format!(
            "CONTEXT_DEPENDENT_SHAPE_REPRESENTATION({relation},{property})"
        ));
    }
    step.add(format!(
        "PRESENTATION_LAYER_ASSIGNMENT('tools','',({solid}))"
    ));
    let red = step.add("COLOUR_RGB('',1.,0.5,0.)");
    let fill = step.add(format!("FILL_AREA_STYLE_COLOUR('',{red})"));
    let fill = step.add(format!("FILL_AREA_STYLE('',({fill}))"));
    let fill = step.add(format!("SURFACE_STYLE_FILL_AREA({fill})"));
    let side = step.add(format!("SURFACE_SIDE_STYLE('',({fill}))"));
    let usage = step.add(format!("SURFACE_STYLE_USAGE(.BOTH.,{side})"));
    let style = step.add(format!("PRESENTATION_STYLE_ASSIGNMENT(({usage}))"));
    step.add(format!("STYLED_ITEM('',({style}),{})", faces[2]));

    let mut file = step.read();
    assert!(
        file.skipped.is_empty() && file.notes.is_empty(),
        "{:?} {:?}",
        file.skipped,
        file.notes
    );
    assert_eq!((file.patches.len(), file.bodies.len()), (12, 2));
    let body = &file.bodies[1];
    assert_eq!(body.path, ["press", "St\u{f6}\u{df}el"]);
    assert_eq!(
        (body.name.as_deref(), body.faces, body.solid),
        (Some("St\u{f6}\u{df}el"), 6, true)
    );
    assert_ne!(file.bodies[0].instance, body.instance);
    assert!(
        file.patches
            .iter()
            .all(|p| p.tags.layer.as_deref() == Some("tools"))
    );
    let colours: Vec<_> = file
        .patches
        .iter()
        .map(|p| p.tags.colour.as_deref())
        .collect();
    assert_eq!(colours[2], Some("#ff8000"));
    assert_eq!(colours.iter().flatten().count(), 2);
    file.convert_to(&covact_geometry::io::LengthUnit::from_name("in").unwrap())
        .unwrap();
    for body in 0..2 {
        let set = set(&file, Some(body));
        near(volume(&set), 6., 1e-12);
    }
    let [low, high] = extent(&file);
    // The second is turned by a right angle: x from -2 to 0, y from 20 to 21.
    assert!(
        (low - covact_geometry::Vec3::new(-2., 0., 0.)).norm() < 1e-12,
        "{low}"
    );
    assert!(
        (high - covact_geometry::Vec3::new(11., 21., 3.)).norm() < 1e-12,
        "{high}"
    );
}

#[test]
fn mapped_items_scale_and_mirror() {
    let (mut step, solid, _) = cube();
    let context = step.millimetres();
    let place = step.placement([0.; 3], [0., 0., 1.], [1., 0., 0.]);
    let part = step.shape(&[&solid], &context);
    let map = step.add(format!("REPRESENTATION_MAP({place},{part})"));
    // Mirrored in x and three times as large.
    let (at, x) = (step.point([-1., 0., 0.]), step.direction([-1., 0., 0.]));
    let (y, z) = (step.direction([0., 1., 0.]), step.direction([0., 0., 1.]));
    let operator = step.add(format!(
        "CARTESIAN_TRANSFORMATION_OPERATOR_3D('','',$,{x},{y},{at},3.,{z})"
    ));
    let item = step.add(format!("MAPPED_ITEM('',{map},{operator})"));
    step.add(format!("SHAPE_REPRESENTATION('',({item}),{context})"));
    let file = step.read();
    assert!(
        file.skipped.is_empty() && file.notes.is_empty(),
        "{:?} {:?}",
        file.skipped,
        file.notes
    );
    // The part itself stands nowhere else.
    assert_eq!(file.bodies.len(), 1);
    near(volume(&set(&file, None)), 27. * 8., 1e-12);
    let [low, high] = extent(&file);
    assert!(
        (low - covact_geometry::Vec3::new(-7., 0., 0.)).norm() < 1e-12,
        "{low}"
    );
    assert!(
        (high - covact_geometry::Vec3::new(-1., 6., 6.)).norm() < 1e-12,
        "{high}"
    );
}

/// Properties refer to a solid by a representation of their own: that is no second copy of a part that stands elsewhere.
#[test]
fn solids_listed_for_properties_stand_once() {
    let (mut step, solid, _) = cube();
    let context = step.millimetres();
    let place = step.placement([0.; 3], [0., 0., 1.], [1., 0., 0.]);
    let part = step.shape(&[&solid], &context);
    step.add(format!("SHAPE_REPRESENTATION('',({solid}),{context})"));
    let map = step.add(format!("REPRESENTATION_MAP({place},{part})"));
    let target = step.placement([10., 0., 0.], [0., 0., 1.], [1., 0., 0.]);
    let item = step.add(format!("MAPPED_ITEM('',{map},{target})"));
    step.add(format!("SHAPE_REPRESENTATION('',({item}),{context})"));
    let file = step.read();
    assert!(file.skipped.is_empty() && file.notes.is_empty());
    assert_eq!((file.bodies.len(), file.patches.len()), (1, 6));
    let [low, _] = extent(&file);
    assert!((low - covact_geometry::Vec3::new(10., 0., 0.)).norm() < 1e-12);
}

#[test]
fn what_is_not_read_is_named() {
    let (mut step, solid, _) = cube();
    let block = step.add("BLOCK('cut',$,1.,1.,1.)");
    let context = step.millimetres();
    step.shape(&[&solid, &block], &context);
    // A face of no body.
    let mut text = step.text();
    let face = text
        .lines()
        .find(|l| l.contains("ADVANCED_FACE"))
        .unwrap()
        .to_owned();
    let copy = format!(
        "#9000={}\nENDSEC;\nEND-ISO",
        face.split_once('=').unwrap().1
    );
    text = text.replace("ENDSEC;\nEND-ISO", &copy);
    let file = read_step(text.as_bytes(), "part.step").unwrap();
    assert_eq!(file.patches.len(), 6);
    let told: Vec<_> = file
        .skipped
        .iter()
        .map(|s| (s.kind, s.name.as_str(), s.entity))
        .collect();
    assert_eq!(told[0].0, SkipKind::Unsupported);
    assert_eq!(told[0].1, "cut");
    assert_eq!(told[1], (SkipKind::Dependent, "ADVANCED_FACE", 9000));
}

/// The same parts written as STEP and as IGES by one kernel: areas agree.
#[test]
fn same_areas_as_in_iges() {
    let table = [
        ("box", "box_brep", 1e-9),
        ("cone", "cone_brep", 1e-9),
        ("cylinder", "cylinder_brep", 1e-9),
        ("extrusion", "extrusion_brep", 1e-9),
        ("revolution", "revolution_brep", 1e-9),
        ("sphere", "sphere_brep", 1e-9),
        ("sphere_nurbs", "sphere_nurbs_brep", 1e-9),
        ("torus", "torus_brep", 1e-9),
        ("bicubic_patch", "bicubic_patch_faces", 1e-9),
        ("trimmed_patch", "trimmed_patch_faces", 1e-6),
    ];
    for (name, other, tolerance) in table {
        let step = read_path(&data(&format!("{name}.step"))).unwrap();
        let iges = read_path(&assets().join(format!("cad/{other}.igs"))).unwrap();
        assert!(
            step.skipped.is_empty() && step.notes.is_empty(),
            "{name}: {:?} {:?}",
            step.skipped,
            step.notes
        );
        assert_eq!(step.patches.len(), iges.patches.len(), "{name}");
        let (step, iges) = (set(&step, None), set(&iges, None));
        let (mut a, mut b) = (step.areas(), iges.areas());
        a.sort_by(f64::total_cmp);
        b.sort_by(f64::total_cmp);
        for (a, b) in a.into_iter().zip(b) {
            assert!(
                (a / b - 1.).abs() < tolerance,
                "{name}: {a} in STEP, {b} in IGES"
            );
        }
        let closed = iges.volumes().iter().flatten().sum::<f64>();
        if closed > 0. {
            near(volume(&step), closed, tolerance);
        }
    }
}
