//! JSON with trims, and our own lossless format. The small files under `data/json` were made for these tests: faces whose
//! trims are known, `trimmed.geomdl.json` written by geomdl 5.3.1 itself.

use covact_geometry::io::{
    CadFile, CadFormat, FaceBorder, LengthUnit, read_json, read_path, write_json,
};
use covact_geometry::{NurbsCurve, NurbsPatch, Trim, TrimCurve, TrimLoop};
use nalgebra::{Vector2, Vector3};
use std::path::{Path, PathBuf};

fn data(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("tests/data/json")
        .join(name)
}

fn contains(patch: &NurbsPatch, xi: [f64; 2]) -> bool {
    patch.trim().expect("a trim").contains(xi)
}

/// Face 2: the whole square (as four active parts of longer lines, listed after the hole) with a round hole of radius .25
/// in the middle; face 3: the triangle below the diagonal, the diagonal drawn against the loop.
#[test]
fn kratos_loops_directions_active_ranges_and_edges() {
    let file = read_path(&data("two_faces.cad.json")).unwrap();
    assert_eq!(
        (file.patches.len(), file.skipped.len()),
        (2, 0),
        "{:?}",
        file.skipped
    );
    assert!(file.notes.is_empty(), "{:?}", file.notes);
    let [hole, triangle] = [0, 1].map(|k| &file.patches[k]);
    assert_eq!([hole.entity, triangle.entity], [2, 3]);
    assert_eq!([hole.border, triangle.border], [FaceBorder::Trimmed; 2]);
    for (xi, inside) in [
        ([0.5, 0.5], false),
        ([0.5, 0.74], false),
        ([0.5, 0.76], true),
        // Outside of the circle, inside of the square around it.
        ([0.7, 0.7], true),
        ([0.67, 0.67], false),
        ([0.01, 0.99], true),
    ] {
        assert_eq!(contains(&hole.patch, xi), inside, "{xi:?}");
    }
    for (xi, inside) in [([0.4, 0.5], true), ([0.5, 0.6], false), ([0.9, 0.05], true)] {
        assert_eq!(contains(&triangle.patch, xi), inside, "{xi:?}");
    }
    // Edge 7 couples trim 2 of face 2 (which the domain replaced) with trim 3 of face 3: the line xi1 = 0.
    let curves = &triangle.patch.trim().unwrap().loops()[0].curves;
    let entities: Vec<u32> = curves.iter().map(|c| c.entity).collect();
    assert_eq!(entities, [0, 0, 7]);
    assert_eq!(
        curves[2].parameter.ends().map(|x| [x.x, x.y]),
        [[0.0, 1.0], [0.0, 0.0]]
    );
}

/// The first surface: cut by a quadrangle from outside, a round hole, a triangular hole; the second: no trims.
#[test]
fn geomdl_splines_polygons_and_containers() {
    let file = read_path(&data("trimmed.geomdl.json")).unwrap();
    assert_eq!(
        (file.patches.len(), file.skipped.len()),
        (2, 0),
        "{:?}",
        file.skipped
    );
    assert_eq!(file.patches[1].border, FaceBorder::Natural);
    let patch = &file.patches[0].patch;
    assert_eq!(file.patches[0].border, FaceBorder::Trimmed);
    for (xi, inside) in [
        ([0.5, 0.5], false),
        ([0.7, 0.7], true),
        ([0.07, 0.07], false),
        ([0.11, 0.11], true),
        // Above and below the side from (1, .9) to (0, 1).
        ([0.9, 0.92], false),
        ([0.9, 0.9], true),
    ] {
        assert_eq!(contains(patch, xi), inside, "{xi:?}");
    }
}

fn change(name: &str, from: &str, to: &str) -> Result<CadFile, String> {
    let text = std::fs::read_to_string(data(name)).unwrap();
    assert!(text.contains(from), "{from}");
    read_json(text.replacen(from, to, 1).as_bytes(), "f.json").map_err(|e| e.to_string())
}

#[test]
fn boundaries_that_give_no_trim_are_named() {
    let kratos = "two_faces.cad.json";
    // The triangle's diagonal starts elsewhere: its loop is open, and outside of the surface.
    let file = change(
        kratos,
        "[0, [2.0, -1.0, 0.0, 1.0]]",
        "[0, [2.0, -1.5, 0.0, 1.0]]",
    )
    .unwrap();
    assert_eq!(file.patches.len(), 1);
    let skipped = &file.skipped[0];
    assert_eq!(skipped.entity, 3);
    assert!(
        skipped
            .reason
            .starts_with("its boundary gives no trim: trim loop 0: they leave the domain"),
        "{}",
        skipped.reason
    );
    let file = change(kratos, "\"inner\"", "\"inside\"").unwrap();
    assert!(
        file.skipped[0]
            .reason
            .ends_with("loop_type \"inside\", expected \"outer\" or \"inner\""),
        "{}",
        file.skipped[0].reason
    );
    // All directions stated wrongly: told, and the face is whole.
    let text = std::fs::read_to_string(data(kratos)).unwrap();
    let text = text.replacen("\"curve_direction\": true", "\"curve_direction\": false", 2);
    let file = read_json(text.as_bytes(), "f.json").unwrap();
    assert_eq!(file.patches.len(), 2, "{:?}", file.skipped);
    assert!(
        file.notes
            .iter()
            .any(|n| n.contains("not in the directions stated")),
        "{:?}",
        file.notes
    );
    // What is no curve at all has a place.
    let message = change(kratos, "\"degree\": 1,", "\"degree\": 0,").unwrap_err();
    assert!(
        message.starts_with("f.json:") && message.contains("degree 0 is not supported"),
        "{message}"
    );
    let message = change("trimmed.geomdl.json", "\"freeform\"", "\"free\"").unwrap_err();
    assert!(
        message.contains("expected \"spline\", \"freeform\" or \"container\""),
        "{message}"
    );
}

/// Numbers that a careless writer or reader changes: minus zero, subnormals, the neighbours of round numbers, 17 digits.
fn awkward() -> CadFile {
    let tiny = f64::from_bits(1);
    let numbers = [
        -0.0,
        tiny,
        // The largest subnormal number.
        -f64::from_bits(0x000f_ffff_ffff_ffff),
        0.1 + 0.2,
        1.0 / 3.0,
        f64::MIN_POSITIVE,
        1e22,
        9007199254740993.0,
        1.797_693_134_862_315_7e308 / 4.0,
        5e-324,
        f64::from_bits(0x3ff0_0000_0000_0001),
        123_456_789.123_456_79,
    ];
    let points: Vec<[f64; 4]> = (0..6)
        .map(|k| {
            [
                numbers[2 * k],
                numbers[2 * k + 1],
                numbers[11 - k],
                1.0 / (1.0 + k as f64),
            ]
        })
        .collect();
    let basis = |degree, knots: &[f64], domain| {
        let count = knots.len() - degree - 1;
        let basis = covact_geometry::basis::Basis::new(degree, knots.to_vec(), count).unwrap();
        basis.with_domain(domain).unwrap()
    };
    let bases = [
        basis(
            2,
            &[-0.0, -0.0, -0.0, 0.3, 0.3, 0.3],
            [0.1 * 0.3, 0.299_999_999_999_999_93],
        ),
        basis(1, &[0.0, 0.0, 1.0, 1.0], [-0.0, 1.0]),
    ];
    let patch = NurbsPatch::from_homogeneous(bases, points).unwrap();
    let at = |x: f64, y: f64| Vector2::new(x, y);
    let corners = [at(0.05, 0.1), at(0.2, 1.0 / 3.0), at(0.1, 0.7)];
    let side = |k: usize| {
        let (a, b) = (corners[k], corners[(k + 1) % 3]);
        let arc = NurbsCurve::new(
            2,
            vec![-0.0, -0.0, -0.0, 1.0, 1.0, 1.0],
            &[a, (a + b) / 2.0, b],
            Some(&[1.0, 0.1 + 0.2, 1.0]),
        );
        TrimCurve {
            parameter: arc.unwrap(),
            space: (k == 1).then(|| {
                NurbsCurve::line(Vector3::new(-0.0, tiny, 0.1), Vector3::new(1.0, 2.0, 3.0))
                    .unwrap()
            }),
            entity: k as u32 * 7,
        }
    };
    let curves = (0..3).map(side).collect();
    let trim = Trim::new(vec![TrimLoop { curves }], patch.domain(), 1e-12).unwrap();
    let plain = patch.clone();
    let inch = LengthUnit::from_name("in").unwrap();
    let mut file = CadFile::of(vec![patch.with_trim(Some(trim)), plain], inch);
    file.path = "awkward".into();
    file.resolution = Some(1e-7 / 3.0);
    for (part, (entity, name)) in file
        .patches
        .iter_mut()
        .zip([(5, Some("na\"me\n\u{e9}")), (9, None)])
    {
        part.entity = entity;
        part.type_number = 144;
        part.base = entity + 2;
        part.instance = 3;
        part.name = name.map(str::to_owned);
    }
    file.patches[1].border = FaceBorder::Rectangle;
    file
}

/// Every number of a file by its bits; equality of floats would take -0.0 for 0.0.
fn bits(file: &CadFile) -> Vec<Vec<u64>> {
    let mut all = Vec::new();
    let mut push = |numbers: &[f64]| all.push(numbers.iter().map(|x| x.to_bits()).collect());
    for p in &file.patches {
        for k in 0..2 {
            push(p.patch.knots(k));
            push(&p.patch.domain()[k]);
        }
        push(p.patch.homogeneous().as_flattened());
        for curve in p
            .patch
            .trim()
            .iter()
            .flat_map(|t| t.loops())
            .flat_map(|l| &l.curves)
        {
            push(curve.parameter.basis().knots());
            push(&curve.parameter.domain());
            push(curve.parameter.homogeneous().as_flattened());
            if let Some(space) = &curve.space {
                push(space.basis().knots());
                push(space.homogeneous().as_flattened());
            }
        }
    }
    all
}

fn assert_lossless(file: &CadFile) {
    let text = write_json(file).unwrap();
    let back = read_json(text.as_bytes(), "back.json").unwrap_or_else(|e| panic!("{e}"));
    assert_eq!(back.format, CadFormat::Covact);
    assert_eq!((&back.unit, back.resolution), (&file.unit, file.resolution));
    assert_eq!(back.patches.len(), file.patches.len());
    for (a, b) in back.patches.iter().zip(&file.patches) {
        assert_eq!(a.patch, b.patch, "patch {}", b.entity);
        assert_eq!(
            (
                a.entity,
                a.type_number,
                a.base,
                a.instance,
                a.border,
                &a.name
            ),
            (
                b.entity,
                b.type_number,
                b.base,
                b.instance,
                b.border,
                &b.name
            )
        );
    }
    assert!(bits(&back) == bits(file));
    assert_eq!(write_json(&back).unwrap(), text);
}

#[test]
fn own_format_keeps_every_bit() {
    let file = awkward();
    assert!(
        bits(&file)
            .iter()
            .flatten()
            .any(|b| *b == (-0.0f64).to_bits())
    );
    assert!(bits(&file).iter().flatten().any(|b| *b == 1));
    assert_lossless(&file);
}

#[test]
fn own_format_keeps_the_files_of_others() {
    let assets = Path::new(env!("CARGO_MANIFEST_DIR")).join("../assets");
    let mut patches = 0;
    for name in [
        "punch.igs",
        "sphere.igs",
        "cad/torus_faces.igs",
        "cad/trimmed_patch_faces.igs",
    ] {
        let file = read_path(&assets.join(name)).unwrap();
        patches += file.patches.len();
        assert_lossless(&file);
    }
    for name in ["two_faces.cad.json", "trimmed.geomdl.json"] {
        let file = read_path(&data(name)).unwrap();
        patches += file.patches.len();
        assert_lossless(&file);
    }
    assert!(patches >= 50, "{patches}");
}

/// Random bit patterns, all exponents: the parser rounds correctly or this fails within a few hundred numbers.
#[test]
fn random_numbers_keep_every_bit() {
    let mut state = 1u64;
    let mut random = || {
        loop {
            state = state
                .wrapping_mul(6364136223846793005)
                .wrapping_add(1442695040888963407);
            let x = f64::from_bits(state ^ (state >> 29));
            if x.is_finite() {
                return x;
            }
        }
    };
    let knots = [vec![0.0, 0.0, 1.0, 1.0], vec![0.0, 0.0, 1.0, 1.0]];
    let [k1, k2] = knots.map(|k| covact_geometry::basis::Basis::new(1, k, 2).unwrap());
    let patches = (0..500).map(|_| {
        let points = (0..4)
            .map(|_| [random(), random(), random(), 1.0])
            .collect();
        NurbsPatch::from_homogeneous([k1.clone(), k2.clone()], points).unwrap()
    });
    let unit = LengthUnit::from_name("in").unwrap();
    assert_lossless(&CadFile::of(patches.collect(), unit));
}

#[test]
fn own_format_is_explained_where_it_is_wrong() {
    let text = write_json(&awkward()).unwrap();
    let told = |from: &str, to: &str| {
        assert!(text.contains(from), "{from}");
        read_json(text.replacen(from, to, 1).as_bytes(), "f.json")
            .unwrap_err()
            .to_string()
    };
    for (from, to, place, part) in [
        (
            "\"degree\":[2,1]",
            "\"degrees\":[2,1]",
            "f.json:2:",
            "; did you mean `degree`?",
        ),
        (
            "\"degree\":[2,1]",
            "\"degree\":[3,1]",
            "f.json:3:1:",
            "direction 1: 2 control points",
        ),
        (
            "\"unit\"",
            "\"units\"",
            "f.json:1:",
            "; did you mean `unit`?",
        ),
        (
            "\"in\"",
            "\"inn\"",
            "f.json:1:1",
            "expected a unit of nm, in, mm",
        ),
        (
            "\"covact_geometry\"",
            "\"covact_geometri\"",
            "f.json:1:1",
            "did you mean `covact_geometry`",
        ),
        (
            "\"covact_geometry\": 1",
            "\"covact_geometry\": 2",
            "f.json:1:1",
            "found version 2",
        ),
        (
            "\"points\":[[-0.0,",
            "\"points\":[[null,",
            "f.json:2:",
            "expected f64",
        ),
    ] {
        let message = told(from, to);
        assert!(
            message.starts_with(place) && message.contains(part),
            "{message}"
        );
    }
}

/// A cylinder of radius 1 over [0, 4] x [0, 2] as Kratos writes it, with one loop; the lines of its edges in space with it.
fn cylinder(curves: &str, edges: &str, swapped: bool) -> String {
    let h = 0.5f64.sqrt();
    let circle = [
        [1.0, 0.0, 1.0],
        [1.0, 1.0, h],
        [0.0, 1.0, 1.0],
        [-1.0, 1.0, h],
        [-1.0, 0.0, 1.0],
        [-1.0, -1.0, h],
        [0.0, -1.0, 1.0],
        [1.0, -1.0, h],
        [1.0, 0.0, 1.0],
    ];
    let points: Vec<String> = [0.0, 2.0]
        .iter()
        .flat_map(|z| circle.map(|[x, y, w]| format!("[0, [{x:?}, {y:?}, {z:?}, {w:?}]]")))
        .collect();
    format!(
        r#"{{"breps": [{{"faces": [{{"brep_id": 1, "swapped_surface_normal": {swapped}, "surface": {{
        "is_trimmed": true, "is_rational": true, "degrees": [2, 1],
        "knot_vectors": [[0, 0, 0, 1, 1, 2, 2, 3, 3, 4, 4, 4], [0, 0, 2, 2]], "control_points": [{}]}},
        "boundary_loops": [{{"loop_type": "outer", "trimming_curves": [{curves}]}}]}}], "edges": [{edges}]}}]}}"#,
        points.join(", ")
    )
}

fn line(index: u32, from: [f64; 2], to: [f64; 2]) -> String {
    let point = |x: [f64; 2]| format!("[0, [{:?}, {:?}, 0.0, 1.0]]", x[0], x[1]);
    format!(
        r#"{{"trim_index": {index}, "curve_direction": true, "parameter_curve": {{"is_rational": false, "degree": 1,
        "knot_vector": [0, 0, 1, 1], "active_range": [0, 1], "control_points": [{}, {}]}}}}"#,
        point(from),
        point(to)
    )
}

/// A window from 3.5 to 4.5: it lies across the seam at 4 = 0, as STEP and IGES have such faces. Its edge in space, which
/// runs the other way, comes with it.
#[test]
fn boundaries_pass_the_seam_and_bring_their_edges_in_space() {
    let corners = [[3.5, 0.5], [4.5, 0.5], [4.5, 1.5], [3.5, 1.5]];
    let sides = (0..4).map(|k| line(k as u32 + 1, corners[k], corners[(k + 1) % 4]));
    let curves = sides.collect::<Vec<_>>().join(", ");
    // At 4.5 = .5 the circle is at (h, h).
    let h = 0.5f64.sqrt();
    let edge = format!(
        r#"{{"brep_id": 9, "3d_curve": {{"is_rational": false, "degree": 1, "knot_vector": [0, 0, 1, 1],
        "control_points": [[0, [{h:?}, {h:?}, 1.5, 1.0]], [0, [{h:?}, {h:?}, 0.5, 1.0]]]}},
        "topology": [{{"brep_id": 1, "trim_index": 2}}]}}"#
    );
    let read = |swapped| {
        let text = cylinder(&curves, &edge, swapped);
        let file = read_json(text.as_bytes(), "c.json").unwrap_or_else(|e| panic!("{e}"));
        assert_eq!(file.skipped, []);
        file
    };
    let file = read(false);
    let set = covact_geometry::PatchSet::new(vec![file.patches[0].patch.clone()], None).unwrap();
    // A quarter of the turn, one high.
    let area: f64 = set.areas().iter().sum();
    assert!((area - std::f64::consts::FRAC_PI_2).abs() < 1e-4, "{area}");
    assert_eq!(file.trims.curves, 4);
    let normal = |file: &CadFile| {
        let patch = &file.patches[0].patch;
        let [u, v] = patch.domain().map(|[a, b]| 0.5 * (a + b));
        let jet = patch.jet([u, v]);
        (jet.rho_i[0].cross(&jet.rho_i[1]))
            .dot(&Vector3::new(jet.rho.x, jet.rho.y, 0.0))
            .signum()
    };
    assert_eq!([normal(&file), normal(&read(true))], [1.0, -1.0]);
    // A loop of three sides of a rectangle is open, and what is said names it.
    let three = (0..3).map(|k| line(k as u32 + 1, corners[k], corners[k + 1]));
    let text = cylinder(&three.collect::<Vec<_>>().join(", "), "", false);
    let file = read_json(text.as_bytes(), "c.json").unwrap();
    assert!(
        file.skipped[0].reason.contains("trim loop 0: is open"),
        "{}",
        file.skipped[0].reason
    );
}

/// Bodies, layers and colours of a STEP file come back from our own format.
#[test]
fn own_format_keeps_bodies_and_names() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/round");
    let mut file = read_path(&folder.join("cavity.step")).unwrap();
    assert_eq!(file.bodies.len(), 1);
    file.patches[0].tags.layer = Some("tool".to_owned());
    file.patches[1].tags.colour = Some("#ff0000".to_owned());
    let back = read_json(write_json(&file).unwrap().as_bytes(), "back.json").unwrap();
    assert_eq!(back.bodies, file.bodies);
    for (a, b) in back.patches.iter().zip(&file.patches) {
        assert_eq!(a.tags, b.tags);
    }
    let text = write_json(&file)
        .unwrap()
        .replace("\"body\":0", "\"body\":7");
    let message = read_json(text.as_bytes(), "back.json")
        .unwrap_err()
        .to_string();
    assert!(message.contains("a patch of body 7"), "{message}");
}
