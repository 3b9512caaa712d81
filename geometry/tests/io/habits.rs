//! Habits of the systems that write IGES, in small files with areas known in closed form.

use super::support::{Entity, GLOBAL, child, entity, flat, iges, line};
use covact_geometry::PatchSet;
use covact_geometry::io::{
    CadFile, FaceBorder, LengthUnit, ReadOptions, SkipKind, read_iges, read_iges_with, read_path,
};

fn read(entities: &[Entity]) -> CadFile {
    let text = iges(GLOBAL, entities);
    read_iges(text.as_bytes(), "hand.igs").unwrap_or_else(|e| panic!("{e}\n{text}"))
}

/// The areas of all patches.
fn areas(file: &CadFile) -> Vec<f64> {
    assert_eq!(file.skipped, [], "{:?}", file.notes);
    let patches = file.patches.iter().map(|p| p.patch.clone()).collect();
    PatchSet::new(patches, None).unwrap().areas()
}

fn near(found: f64, expected: f64, tolerance: f64) {
    assert!(
        (found / expected - 1.0).abs() < tolerance,
        "{found}, not {expected}"
    );
}

fn noted(file: &CadFile, parts: &[&str]) {
    let found = |note: &String| parts.iter().all(|p| note.contains(p));
    assert!(
        file.notes.iter().any(found),
        "no {parts:?} in {:?}",
        file.notes
    );
}

/// A triangle of curves of which two miss each other by 0.003 on a surface of 2 x 2 (entity 1).
fn gaping() -> Vec<Entity<'static>> {
    vec![
        entity(144, "3,1,0,5"),
        child(128, &flat(2.0, 2.0)),
        child(142, "0,3,7,0,1"),
        child(102, "3,9,11,13"),
        line([0.2, 0.2], [1.8, 0.2]),
        line([1.8, 0.203], [0.2, 1.8]),
        line([0.2, 1.8], [0.2, 0.2]),
    ]
}

#[test]
fn gaps_small_beside_the_part_are_closed_and_told() {
    // By itself the face is as large as the part, and the gap is one.
    let alone = read(&gaping());
    let [skipped] = &alone.skipped[..] else {
        panic!("{:?}", alone.skipped);
    };
    assert_eq!(skipped.kind, SkipKind::Boundary);
    assert!(
        skipped.reason.contains("a gap of 3.0e-3"),
        "{}",
        skipped.reason
    );
    // Beside a plate of 100 x 60 it is 3e-5 of the part.
    let mut part = gaping();
    part.push(entity(128, &flat(100.0, 60.0)));
    part.push(child(110, "0.,0.,0.,1.,0.,0."));
    let file = read(&part);
    let found = areas(&file);
    assert_eq!(found.len(), 2);
    near(found[0], 1.28, 3e-3);
    near(found[1], 6000.0, 1e-12);
    assert_eq!(file.patches[0].entity, 1);
    assert_eq!((file.trims.bridged, file.trims.curves), (1, 3));
    assert!((file.trims.largest_bridge - 3e-3).abs() < 1e-9);
    noted(
        &file,
        &["entity 1 ", "1 gap(s) of up to 3.0e-3", "were closed"],
    );
    // The border has the three edges that neighbours have, and none across the gap.
    let trim = file.patches[0].patch.trim().unwrap();
    assert_eq!(trim.loops()[0].curves.len(), 3);
    // A tenth of the face is no gap to be closed, however large the part.
    let mut torn = gaping();
    torn[5] = line([1.8, 0.4], [0.2, 1.8]);
    torn.push(entity(128, &flat(10_000.0, 6000.0)));
    let file = read(&torn);
    assert_eq!((file.patches.len(), file.skipped.len()), (1, 1));
}

/// A bicubic-by-linear 128 of two Bezier pieces along x, all knots four times, whose pieces meet in points `step` apart.
fn row_of_beziers(step: f64) -> String {
    let x = [0.0, 1.0, 2.0, 3.0, 3.0, 4.0, 5.0, 6.0];
    let row = |y: f64| {
        let at = |(k, x): (usize, &f64)| {
            let z = if k == 4 { step } else { 0.0 };
            format!("{x:?},{y:?},{z:?}")
        };
        x.iter().enumerate().map(at).collect::<Vec<_>>().join(",")
    };
    let ones = vec!["1."; 16].join(",");
    format!(
        "7,1,3,1,0,0,1,0,0,0.,0.,0.,0.,1.,1.,1.,1.,2.,2.,2.,2.,0.,0.,1.,1.,{ones},{},{},0.,2.,0.,1.",
        row(0.0),
        row(2.0)
    )
}

#[test]
fn rows_of_bezier_pieces_are_one_surface() {
    let face = |step: f64| {
        read(&[
            entity(144, "3,1,0,5"),
            child(128, &row_of_beziers(step)),
            child(142, "0,3,7,0,1"),
            child(102, "3,9,11,13"),
            // A triangle across the joint at parameter 1, which is x = 3.
            line([0.5, 0.25], [1.5, 0.25]),
            line([1.5, 0.25], [0.5, 0.75]),
            line([0.5, 0.75], [0.5, 0.25]),
        ])
    };
    let file = face(0.0);
    // x is three times the parameter and y twice: the triangle has half of 3 times 1.
    near(areas(&file)[0], 1.5, 1e-9);
    assert_eq!(file.patches[0].patch.counts(), [7, 2]);
    noted(&file, &["entity 3 (128)", "1 knot(s)", "equal points"]);
    // A tear stays one.
    let torn = face(0.1);
    assert_eq!(torn.skipped.len(), 1);
    assert!(torn.skipped[0].reason.contains("falls into 2 patches"));
}

#[test]
fn units_flag_zero_is_unspecified() {
    let with = |unit: &str| {
        let global = GLOBAL.replace("2,2HMM", unit);
        let text = iges(&global, &[entity(128, &flat(4.0, 2.0))]);
        read_iges(text.as_bytes(), "hand.igs").unwrap()
    };
    let file = with("0,");
    assert_eq!(file.unit, LengthUnit::unspecified());
    near(areas(&file)[0], 8.0, 1e-12);
    noted(&file, &["units flag is 0", "unspecified"]);
    let file = with("0,2HCM");
    assert_eq!(file.unit.name, "cm");
    noted(&file, &["units flag is 0", "cm"]);
}

#[test]
fn counts_of_parameter_records_may_be_too_large() {
    let entities = [entity(128, &flat(4.0, 2.0)), entity(128, &flat(3.0, 1.0))];
    let text = iges(GLOBAL, &entities);
    let lines: Vec<String> = text
        .lines()
        .map(|l| match l.get(72..80) {
            // The second record of both entities: field 4 holds the count.
            Some("D      2" | "D      4") => format!("{}      20{}", &l[..24], &l[32..]),
            _ => l.to_owned(),
        })
        .collect();
    let file = read_iges((lines.join("\n") + "\n").as_bytes(), "hand.igs").unwrap();
    let found = areas(&file);
    near(found[0], 8.0, 1e-12);
    near(found[1], 3.0, 1e-12);
    noted(&file, &["2 entities state more parameter records"]);
}

#[test]
fn hidden_faces_are_read_when_asked_for() {
    let hidden = Entity {
        status: "01000000",
        ..entity(128, &flat(4.0, 2.0))
    };
    let text = iges(GLOBAL, &[hidden, entity(128, &flat(3.0, 1.0))]);
    let file = read_iges(text.as_bytes(), "hand.igs").unwrap();
    assert_eq!((file.patches.len(), file.skipped.len()), (1, 1));
    assert_eq!(file.skipped[0].kind, SkipKind::Blanked);
    let options = ReadOptions { hidden: true };
    let file = read_iges_with(text.as_bytes(), "hand.igs", &options).unwrap();
    near(areas(&file).iter().sum(), 11.0, 1e-12);
    noted(&file, &["1 hidden (blanked) surface(s)"]);
    // A group that is hidden hides its members.
    let text = iges(
        GLOBAL,
        &[
            Entity {
                form: 7,
                status: "01000000",
                ..entity(402, "1,3")
            },
            child(128, &flat(4.0, 2.0)),
        ],
    );
    let file = read_iges(text.as_bytes(), "hand.igs").unwrap();
    assert_eq!(file.skipped[0].kind, SkipKind::Blanked);
    let file = read_iges_with(text.as_bytes(), "hand.igs", &options).unwrap();
    near(areas(&file)[0], 8.0, 1e-12);
}

/// A square of space curves on a plane in the ways in which 141, 142, 143 and 144 are written.
#[test]
fn boundaries_in_the_ways_they_are_written() {
    let square = |senses: [i32; 4]| -> Vec<Entity<'static>> {
        let at = [[0.5, 0.5], [1.5, 0.5], [1.5, 1.5], [0.5, 1.5]];
        (0..4)
            .map(|k| match senses[k] {
                2 | -1 => line(at[(k + 1) % 4], at[k]),
                _ => line(at[k], at[(k + 1) % 4]),
            })
            .collect()
    };
    let face = |kind: u32, values: &str, bound: (u32, &str), senses: [i32; 4]| {
        let mut entities = vec![
            entity(kind, values),
            child(128, &flat(4.0, 2.0)),
            child(bound.0, bound.1),
        ];
        entities.extend(square(senses));
        entities.push(child(102, "4,7,9,11,13"));
        read(&entities)
    };
    let bounded = (143, "0,3,1,5");
    for (what, (kind, values), bound, senses) in [
        (
            "standard",
            bounded,
            "0,2,3,4,7,1,0,9,2,0,11,1,0,13,2,0",
            [1, 2, 1, 2],
        ),
        (
            "no counts",
            bounded,
            "0,2,3,4,7,1,9,2,11,1,13,2",
            [1, 2, 1, 2],
        ),
        (
            "sense 0",
            bounded,
            "0,2,3,4,7,0,0,9,0,0,11,0,0,13,0,0",
            [0, 0, 0, 0],
        ),
        (
            "sense -1",
            bounded,
            "0,2,3,4,7,1,0,9,-1,0,11,1,0,13,-1,0",
            [1, -1, 1, -1],
        ),
        (
            "wrong senses",
            bounded,
            "0,2,3,4,7,1,0,9,1,0,11,1,0,13,1,0",
            [1, 2, 1, 2],
        ),
        (
            "144 over 141",
            (144, "3,1,0,5"),
            "0,2,3,4,7,1,0,9,2,0,11,1,0,13,2,0",
            [1, 2, 1, 2],
        ),
    ] {
        let file = face(kind, values, (141, bound), senses);
        assert_eq!(file.skipped, [], "{what}");
        assert_eq!(file.patches[0].border, FaceBorder::Rectangle, "{what}");
        near(areas(&file)[0], 1.0, 1e-12);
        let told = what.starts_with("sense");
        assert_eq!(
            file.notes.iter().any(|n| n.contains("neither 1 nor 2")),
            told
        );
    }
    let file = face(143, "0,3,1,5", (142, "0,3,0,15,2"), [1; 4]);
    near(areas(&file)[0], 1.0, 1e-12);
    // What is neither is refused by its name.
    let file = face(
        143,
        "0,3,1,7",
        (141, "0,2,3,4,7,1,0,9,1,0,11,1,0,13,1,0"),
        [1; 4],
    );
    assert!(
        file.skipped[0].reason.contains("entity 7 (110 Line)"),
        "{:?}",
        file.skipped
    );
}

/// A spline of degree 5 with a span from each whole x to the next, from `from` to `to`, on the parabola z = x^2 / 10 at a
/// height y. Every knot inside is fivefold.
fn parabola(from: i32, to: i32, y: f64) -> Entity<'static> {
    let spans = (to - from).abs();
    let step = f64::from((to - from).signum());
    let mut points = vec![];
    for k in 0..=5 * spans {
        // Bezier points of the square of x: values of its polar form.
        let (span, i) = if k == 5 * spans {
            (spans - 1, 5)
        } else {
            (k / 5, k % 5)
        };
        let (a, i) = (f64::from(from) + step * f64::from(span), f64::from(i));
        let z = a * a + 2.0 * a * step * i / 5.0 + i * (i - 1.0) / 20.0;
        points.push(format!("{:.1},{y:.1},{:.3}", a + step * i / 5.0, z / 10.0));
    }
    let mut knots = vec!["0.".to_owned()];
    knots.extend((0..=spans).flat_map(|k| vec![format!("{k}."); 5]));
    knots.push(format!("{spans}."));
    child(
        126,
        &format!(
            "{},5,0,0,1,0,{},{},{},0.,{spans}.,0.,0.,0.",
            5 * spans,
            knots.join(","),
            vec!["1."; points.len()].join(","),
            points.join(",")
        ),
    )
}

#[test]
fn long_space_curves_on_few_lines_are_followed() {
    let at = |x: f64, y: f64| format!("{x:.1},{y:.1},{:.1}", x * x / 10.0);
    let across = |x: f64, y: [f64; 2]| child(110, &format!("{},{}", at(x, y[0]), at(x, y[1])));
    let text = iges(
        GLOBAL,
        &[
            entity(144, "3,1,1,7,9"),
            child(122, "5,0.,5.,0."),
            parabola(0, 16, 0.0),
            child(142, "0,3,0,11,2"),
            child(142, "0,3,0,13,2"),
            child(102, "4,15,17,19,21"),
            child(102, "4,23,25,27,29"),
            parabola(0, 16, 1.0),
            across(16.0, [1.0, 4.0]),
            parabola(16, 0, 4.0),
            across(0.0, [4.0, 1.0]),
            parabola(1, 15, 2.0),
            across(15.0, [2.0, 3.0]),
            parabola(15, 1, 3.0),
            across(1.0, [3.0, 2.0]),
        ],
    );
    assert!(text.len() < 15_000, "{}", text.len());
    let file = read_iges(text.as_bytes(), "hand.igs").unwrap();
    let length = |x: f64| 0.5 * x * (1.0 + x * x / 25.0).sqrt() + 2.5 * (x / 5.0).asinh();
    let expected = 3.0 * length(16.0) - (length(15.0) - length(1.0));
    near(areas(&file)[0], expected, 1e-5);
    assert_eq!(
        (file.trims.projected, file.patches[0].border),
        (8, FaceBorder::Trimmed)
    );
}

#[test]
fn drawings_are_called_drawings() {
    let drawing = [
        entity(110, "0.,0.,0.,1.,0.,0."),
        entity(404, "1,5,0.,0.,0"),
        entity(410, "1,1.,0,0,0,0,0,0"),
        entity(212, "1,3,1.,1.,1,1.57,0.,0,0,0.,0.,0.,3Habc"),
    ];
    let text = iges(GLOBAL, &drawing);
    let file = read_iges(text.as_bytes(), "hand.igs").unwrap();
    assert!(file.patches.is_empty() && file.skipped.is_empty());
    noted(
        &file,
        &["the file is a drawing", "1 curve(s)", "no surfaces"],
    );
    let wires = iges(GLOBAL, &drawing[..1]);
    let file = read_iges(wires.as_bytes(), "hand.igs").unwrap();
    noted(&file, &["wireframe: 1 curve(s)"]);
    // Without its end it is still a drawing.
    let cut: Vec<&str> = text.lines().collect();
    let cut = cut[..cut.len() - 2].join("\n");
    let error = read_iges(cut.as_bytes(), "hand.igs")
        .unwrap_err()
        .to_string();
    assert!(error.contains("it is a drawing"), "{error}");
    let folder = std::env::temp_dir().join(format!("covact-drawing-{}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    for (name, content, found) in [
        (
            "part.dxf",
            "  0\r\nSECTION\r\n  2\r\nHEADER\r\n",
            "a DXF file, which holds a drawing",
        ),
        (
            "part.dwg",
            "AC1032\0\0\0\0\0",
            "a DWG file, which holds a drawing",
        ),
    ] {
        let path = folder.join(name);
        std::fs::write(&path, content).unwrap();
        let error = read_path(&path).unwrap_err().to_string();
        assert!(error.ends_with(&format!("found {found}")), "{error}");
    }
    std::fs::remove_dir_all(&folder).unwrap();
}
