//! From choices to scenes and labels.
use crate::support::*;
use serde_json::{Value, json};

/// Runs of a grid of one choice: their labels and the values at pointers of their scenes.
fn runs_of(choice: Value, pointers: &[&str]) -> Vec<(String, String, Option<f64>, Vec<Value>)> {
    let folder = tempfile::tempdir().unwrap();
    let all = expanded(folder.path(), &study(json!([{ "choices": [choice] }])));
    assert_eq!(all.choices.len(), 1);
    let one = |run: &covact::study::Planned| {
        let label = run.choices.values().next().unwrap();
        let values = pointers.iter().map(|p| at(run, p).clone()).collect();
        (label.text.clone(), label.series.clone(), label.size, values)
    };
    all.runs.iter().map(one).collect()
}

fn row(
    text: &str,
    series: &str,
    size: Option<f64>,
    values: &[Value],
) -> (String, String, Option<f64>, Vec<Value>) {
    (text.to_owned(), series.to_owned(), size, values.to_vec())
}

#[test]
fn masters() {
    let values = json!(["exact", { "bilinear": { "chord": 0.5 } }, { "biquadratic": { "size": 4 } },
        { "smooth": { "count": [2, 8] } }]);
    let found = runs_of(
        json!({ "master": { "values": values } }),
        &["/surfaces/ball/facets"],
    );
    let facets = |v: Value| [v];
    assert_eq!(
        found,
        [
            row("NURBS", "NURBS", None, &facets(Value::Null)),
            row(
                "bilinear, chord 0.5",
                "bilinear",
                Some(0.5),
                &facets(json!({ "kind": "bilinear", "chord": 0.5 }))
            ),
            row(
                "biquadratic, size 4",
                "biquadratic by size",
                Some(4.0),
                &facets(json!({ "kind": "biquadratic", "size": 4 }))
            ),
            row(
                "smooth, 2 x 8",
                "smooth by count",
                Some(0.25),
                &facets(json!({ "kind": "smooth", "count": [2, 8] }))
            ),
        ]
    );
}

#[test]
fn stl_in_place_of_the_surface() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("tool.stl"), b"solid\nendsolid\n").unwrap();
    let values = json!([{ "stl": { "count": [3, 3] } }, { "stl": { "file": "tool.stl" } }]);
    let mut study = study(json!([{ "choices": [{ "master": { "values": values } }] }]));
    study["set"] =
        json!({ "/surfaces/ball/placement": { "scale": 2, "translation": [0, 0, -26] } });
    let all = expanded(folder.path(), &study);
    let [made, given] = &all.runs[..] else {
        panic!("{} runs", all.runs.len());
    };
    for run in [made, given] {
        assert_eq!(at(run, "/surfaces/ball/sphere"), &Value::Null);
        assert_eq!(
            at(run, "/surfaces/ball/motion"),
            &scene()["surfaces"]["ball"]["motion"]
        );
    }
    // Triangles that are made have the size of the surface as placed; those of a file stand for what the scene gives.
    assert_eq!(
        at(made, "/surfaces/ball/placement"),
        &json!({ "translation": [0, 0, -26] })
    );
    assert_eq!(at(given, "/surfaces/ball/placement/scale"), &json!(2));
    let file = at(made, "/surfaces/ball/cad/file").as_str().unwrap();
    let stl = covact_geometry::io::read_stl_path(file.as_ref(), None).unwrap();
    // Six patches of 3 x 3 facets.
    assert_eq!(stl.triangles.len(), 108);
    assert_eq!((stl.report.free, stl.report.flipped), (0, 0));
    let radii = stl
        .nodes
        .iter()
        .map(|x| (x - covact_geometry::Vec3::new(0.0, 0.0, 52.0)).norm());
    radii.for_each(|r| assert!((r - 50.0).abs() < 1e-5, "{r}"));
    assert_eq!(made.choices["master"].text, "STL, 3 x 3");
    assert_eq!(given.choices["master"].text, "tool.stl");
}

#[test]
fn shells_points_tangents() {
    let found = runs_of(
        json!({ "shell": { "values": [{ "h8": [4, 9] }, { "q18": [2, 2] }, { "h8_displacement": [1, 1] }] } }),
        &["/bodies/plate/element", "/bodies/plate/mesh/plate/elements"],
    );
    assert_eq!(
        found,
        [
            row(
                "H8 4 x 9",
                "H8",
                Some(1.0 / 6.0),
                &[json!("h8"), json!([4, 9])]
            ),
            row(
                "Q18 2 x 2",
                "Q18",
                Some(0.5),
                &[json!("q18"), json!([2, 2])]
            ),
            row(
                "H8 displacement 1 x 1",
                "H8 displacement",
                Some(1.0),
                &[json!("h8_displacement"), json!([1, 1])]
            ),
        ]
    );
    let found = runs_of(
        json!({ "points": { "values": ["nodes", { "gauss": 4 }, { "lobatto": 2 }, { "averaged": { "gauss": 2 } }] } }),
        &["/contacts/press/points", "/contacts/press/gap"],
    );
    let averaged = [json!({ "gauss": 2 }), json!("averaged")];
    assert_eq!(
        found,
        [
            row("nodes", "nodes", None, &[json!("nodes"), Value::Null]),
            row(
                "Gauss 4",
                "Gauss",
                Some(0.25),
                &[json!({ "gauss": 4 }), Value::Null]
            ),
            row(
                "Lobatto 2",
                "Lobatto",
                Some(0.5),
                &[json!({ "lobatto": 2 }), Value::Null]
            ),
            row("Gauss 2, averaged", "Gauss, averaged", Some(0.5), &averaged),
        ]
    );
    let found = runs_of(
        json!({ "tangent": { "values": ["exact", "published", "without_rotational", "without_curvature", "main"] } }),
        &["/contacts/press/tangent"],
    );
    let parts = |r: bool, c: bool| json!({ "published": { "rotational": r, "curvature": c } });
    let tangents: Vec<Value> = found.iter().map(|row| row.3[0].clone()).collect();
    let expected = [
        json!("exact"),
        parts(true, true),
        parts(false, true),
        parts(true, false),
        parts(false, false),
    ];
    assert_eq!(tangents, expected);
}

#[test]
fn sizes_are_those_of_the_axes_that_are_refined() {
    // A strip refined along itself, and a plate refined along both axes: half as large every time.
    for (values, sizes) in [
        (
            json!([{ "h8": [4, 1] }, { "h8": [8, 1] }, { "q18": [2, 1] }]),
            [0.25, 0.125, 2f64.powf(-0.5)],
        ),
        (
            json!([{ "h8": [4, 2] }, { "h8": [8, 4] }, { "h8": [16, 8] }]),
            [8f64.powf(-0.5), 32f64.powf(-0.5), 128f64.powf(-0.5)],
        ),
    ] {
        let found = runs_of(
            json!({ "shell": { "values": values } }),
            &["/bodies/plate/element"],
        );
        for (row, size) in found.iter().zip(sizes) {
            let own = row.2.unwrap();
            assert!((own / size - 1.0).abs() < 1e-12, "{own} {size}");
        }
    }
    let counts = json!(["exact", { "bilinear": { "count": [12, 1] } }, { "bilinear": { "count": [24, 1] } }]);
    let found = runs_of(
        json!({ "master": { "values": counts } }),
        &["/surfaces/ball/facets"],
    );
    assert_eq!(
        (found[1].2, found[2].2),
        (Some(1.0 / 12.0), Some(1.0 / 24.0))
    );
}

#[test]
fn penalties_steps_and_any_keys() {
    let found = runs_of(
        json!({ "penalty": { "values": ["auto", { "value": 200 }, { "scaled": 4 }] } }),
        &["/contacts/press/penalty"],
    );
    let penalties: Vec<Value> = found.iter().map(|row| row.3[0].clone()).collect();
    assert_eq!(
        penalties,
        [
            json!("auto"),
            json!({ "value": 200 }),
            json!({ "scaled": 4 })
        ]
    );
    let sizes: Vec<Option<f64>> = found.iter().map(|row| row.2).collect();
    assert_eq!(sizes, [Some(1.0), Some(1.0 / 200.0), Some(0.25)]);

    let found = runs_of(
        json!({ "augmentation": { "values": ["none", {}, { "gap": 1e-6, "max": 9 }] } }),
        &["/contacts/press/augmentation"],
    );
    let texts: Vec<&str> = found.iter().map(|row| row.0.as_str()).collect();
    assert_eq!(
        texts,
        ["not augmented", "augmented", "augmented, gap 1e-6, max 9"]
    );
    assert_eq!(found[0].3, [Value::Null]);
    assert_eq!(found[2].3, [json!({ "gap": 1e-6, "max": 9 })]);

    let found = runs_of(
        json!({ "step": { "values": [0.25, 1] } }),
        &["/solution/step"],
    );
    let step = |h: Value| [json!({ "initial": h, "max": h, "adaptive": false })];
    assert_eq!(
        found[0],
        row("step 0.25", "step", Some(0.25), &step(json!(0.25)))
    );
    assert_eq!(found[1].3, step(json!(1)));

    let found = runs_of(
        json!({ "tolerance": { "values": [1e-6] } }),
        &["/solution/newton/tolerance"],
    );
    assert_eq!(
        found,
        [row(
            "tolerance 1e-6",
            "tolerance",
            Some(1e-6),
            &[json!(1e-6)]
        )]
    );

    let key = json!({ "key": { "name": "radius", "at": ["/surfaces/ball/sphere/radius", "/surfaces/ball/depth"],
        "values": [25, 20.5] } });
    let found = runs_of(
        key,
        &["/surfaces/ball/sphere/radius", "/surfaces/ball/depth"],
    );
    assert_eq!(
        found[1],
        row(
            "radius 20.5",
            "radius 20.5",
            None,
            &[json!(20.5), json!(20.5)]
        )
    );
    assert_eq!(found[0].3, [json!(25), json!(25)]);

    let variants = json!({ "variants": { "name": "what", "values": [
        { "label": "as it is" },
        { "label": "thin", "set": { "/bodies/plate/mesh/plate/thickness": 1 }, "series": "thickness", "size": 0.5 },
    ] } });
    let found = runs_of(variants, &["/bodies/plate/mesh/plate/thickness"]);
    assert_eq!(found[0], row("as it is", "as it is", None, &[json!(2)]));
    assert_eq!(found[1], row("thin", "thickness", Some(0.5), &[json!(1)]));
}

/// The last choice varies fastest, changes of the study and the grid come first, and choices of one kind are told apart by
/// what they are about.
#[test]
fn grids_are_all_combinations() {
    let folder = tempfile::tempdir().unwrap();
    let mut study = study(json!([{
        "set": { "/solution/newton/max_iterations": 30 },
        "choices": [
            { "shell": { "body": "plate", "values": [{ "h8": [2, 2] }, { "h8": [3, 3] }] } },
            { "step": { "values": [1, 0.5] } },
            { "key": { "name": "material", "at": ["/materials/steel/st_venant_kirchhoff/nu"], "values": [0, 0.25] } }
        ]
    }]));
    study["set"] = json!({ "/solution/end_time": 1, "/solution/newton": { "max_iterations": 7, "line_search": false } });
    let all = expanded(folder.path(), &study);
    assert_eq!(all.choices, ["shell", "step", "material"]);
    let ids: Vec<&str> = all.runs.iter().map(|r| r.id.as_str()).collect();
    assert_eq!(ids.len(), 8);
    assert_eq!(
        ids[..4],
        [
            "001_H8_2_x_2_step_1_material_0",
            "002_H8_2_x_2_step_1_material_0_25",
            "003_H8_2_x_2_step_0_5_material_0",
            "004_H8_2_x_2_step_0_5_material_0_25",
        ]
    );
    for run in &all.runs {
        assert_eq!(
            at(run, "/solution/newton"),
            &json!({ "max_iterations": 30, "line_search": false })
        );
    }
}

/// A run that two grids ask for is done once; more grids at the end change no name.
#[test]
fn equal_runs_are_one_and_names_stay() {
    let folder = tempfile::tempdir().unwrap();
    let shells = |values: Value| json!({ "choices": [{ "shell": { "values": values } }] });
    let first = shells(json!([{ "h8": [2, 2] }, { "h8": [4, 4] }]));
    let mut study = study(json!([first]));
    study["references"] = json!({ "fine": { "runs": [
        { "/bodies/plate/mesh/plate/elements": [4, 4] },
        { "/bodies/plate/mesh/plate/elements": [8, 8] },
    ] } });
    let before = expanded(folder.path(), &study);
    let names = |e: &covact::study::Expansion| -> Vec<String> {
        e.runs.iter().map(|r| r.id.clone()).collect()
    };
    // The element is `h8` by default, so that the coarser run of the reference is one of the grid.
    assert_eq!(
        names(&before),
        ["001_H8_2_x_2", "reference_fine_1", "reference_fine_2"]
    );
    assert_eq!(before.references["fine"], [1, 2]);
    assert_eq!(before.runs[1].choices["shell"].text, "H8 4 x 4");
    assert_eq!(before.runs[1].reference.as_deref(), Some("fine"));

    let second =
        shells(json!([{ "h8": [4, 4] }, { "q18": [2, 2] }, { "h8": [2, 2] }, { "h8": [8, 8] }]));
    study["grids"] = json!([first, second]);
    let after = expanded(folder.path(), &study);
    assert_eq!(
        names(&after),
        [
            "001_H8_2_x_2",
            "reference_fine_1",
            "002_Q18_2_x_2",
            "reference_fine_2"
        ]
    );
    assert_eq!(after.references["fine"], [1, 3]);
}

/// The studies that ship are right, with all of their scenes.
#[test]
fn shipped_studies_are_right() {
    let folder = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("examples/studies");
    let mut seen = 0;
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.extension().is_none_or(|e| e != "json") || path.ends_with("schema.json") {
            continue;
        }
        let study = covact::study::load(&path).unwrap_or_else(|e| panic!("{e}"));
        let expansion = covact::study::expand(&study).unwrap_or_else(|e| panic!("{e}"));
        assert!(expansion.runs.len() >= 2, "{}", path.display());
        seen += 1;
    }
    assert!(seen >= 5, "{seen} studies");
}
