//! The folder of a run: collections, history, summary.
use covact::mesh::{ElementKind, Mesh};
use covact::output::{
    Accuracy, BodyFields, COLUMNS, GivenUp, History, OutputError, PartNames, Precision, Results,
    RunStatus, Summary, SurfaceOutput, SurfacePiece, SurfaceState, Versions, column_table,
    documented, file_stem, inlined, read_csv,
};
use covact_geometry::Vec3;
use nalgebra::Isometry3;
use std::collections::BTreeMap;
use std::fs;
use std::path::Path;
use vtkio::Vtk;

fn cube() -> Mesh {
    Mesh {
        kind: ElementKind::H8,
        nodes: (0..8)
            .map(|c| Vec3::new((c & 1) as f64, (c >> 1 & 1) as f64, (c >> 2) as f64))
            .collect(),
        connectivity: (0..8).collect(),
        node_sets: BTreeMap::new(),
        face_sets: BTreeMap::new(),
    }
}

fn square(name: &str) -> SurfaceOutput {
    let piece = SurfacePiece {
        degree: [1, 1],
        points: vec![
            [0.0, 0.0, 0.0, 1.0],
            [1.0, 0.0, 0.0, 1.0],
            [0.0, 1.0, 0.0, 1.0],
            [1.0, 1.0, 0.0, 1.0],
        ],
        patch: 0,
        entity: 0,
        reversed: false,
        divisions: None,
    };
    SurfaceOutput::new(name, vec![piece], 2).unwrap()
}

fn body<'a>(name: &'a str, mesh: &'a Mesh, u: &'a [Vec3]) -> BodyFields<'a> {
    BodyFields {
        name,
        mesh,
        displacement: u,
        stress: None,
        contact: None,
        fields: Vec::new(),
        precision: Precision::Rounded,
    }
}

/// `key="value"` of every `DataSet` tag, in order.
fn attributes(pvd: &Path, key: &str) -> Vec<String> {
    let text = fs::read_to_string(pvd).unwrap();
    assert!(
        text.starts_with("<?xml") && text.ends_with("</VTKFile>\n"),
        "{text}"
    );
    text.lines()
        .filter(|line| line.trim_start().starts_with("<DataSet "))
        .map(|line| {
            let at = line.find(&format!(" {key}=\"")).unwrap() + key.len() + 3;
            line[at..at + line[at..].find('"').unwrap()].to_string()
        })
        .collect()
}

#[test]
fn collections_list_every_part_at_every_time() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("deep").join("out");
    let pvd = out.join("results.pvd");
    let mut results = Results::create(&out).unwrap();
    assert!(attributes(&pvd, "file").is_empty());

    let mesh = cube();
    let u = vec![Vec3::zeros(); 8];
    // A body and a surface of one name, names that differ in case only, names no file can have.
    let surface = square("tool");
    let names = ["tool", "Tool", "a/b <&\"> ü", "tool_tessellated"];
    for (step, time) in [(1, 0.1), (2, 0.25)] {
        let bodies: Vec<BodyFields> = names.iter().map(|n| body(n, &mesh, &u)).collect();
        let at = Isometry3::translation(0.0, 0.0, time);
        let state = SurfaceState {
            surface: &surface,
            start: &at,
            at: &at,
            still: false,
        };
        results.write(step, time, &bodies, &[state], &[]).unwrap();
    }
    let files = attributes(&pvd, "file");
    assert_eq!(
        files[..5],
        [
            "tool_0001.vtu",
            "Tool_2_0001.vtu",
            "a_b________0001.vtu",
            "tool_tessellated_0001.vtu",
            "tool_3_0001.vtu"
        ]
    );
    assert_eq!(files.len(), 10);
    assert_eq!(attributes(&pvd, "timestep")[4..6], ["0.1", "0.25"]);
    assert_eq!(attributes(&pvd, "part")[5..], ["0", "1", "2", "3", "4"]);
    assert_eq!(attributes(&pvd, "name")[2], "a/b &lt;&amp;&quot;&gt; ü");
    let flat = attributes(&out.join("results_tessellated.pvd"), "file");
    assert_eq!(flat[4], "tool_3_tessellated_0001.vtu");
    for file in files.iter().chain(&flat) {
        let bytes = fs::read(out.join(file)).unwrap();
        Vtk::parse_xml(&inlined(&bytes).unwrap()[..]).unwrap();
    }
    // 2 steps x (4 bodies + 2 copies of the surface) + 2 collections, and no leftovers.
    assert_eq!(fs::read_dir(&out).unwrap().count(), 14);
}

#[test]
fn a_step_that_cannot_be_written_is_not_listed() {
    let folder = tempfile::tempdir().unwrap();
    let mesh = cube();
    let u = vec![Vec3::zeros(); 8];
    let mut results = Results::create(folder.path()).unwrap();
    let good = body("good", &mesh, &u);
    let bad = body("bad", &mesh, &u[..7]);
    results
        .write(1, 0.5, std::slice::from_ref(&good), &[], &[])
        .unwrap();
    let error = results
        .write(2, 1.0, &[good.clone(), bad], &[], &[])
        .unwrap_err();
    assert!(matches!(error, OutputError::FieldLength { .. }));
    let pvd = folder.path().join("results.pvd");
    assert_eq!(attributes(&pvd, "timestep"), ["0.5"]);
    results.write(2, 0.75, &[good], &[], &[]).unwrap();
    assert_eq!(attributes(&pvd, "timestep"), ["0.5", "0.75"]);
}

#[test]
fn names_become_file_names() {
    assert_eq!(file_stem("punch-2_left"), "punch-2_left");
    assert_eq!(file_stem("../../etc/passwd"), "______etc_passwd");
    assert_eq!(file_stem(""), "part");
    assert_eq!(file_stem("-rf"), "_rf");
    assert_eq!(file_stem(&"x".repeat(300)).len(), 60);
}

fn columns(names: &[&str]) -> Vec<String> {
    names.iter().map(|s| s.to_string()).collect()
}

#[test]
fn a_history_reads_back_bit_for_bit() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("history.csv");
    fs::write(&path, "an earlier run").unwrap();
    let names = ["step", "time", "force.a, \"b\".c.z", "energy.internal"];
    let mut history = History::create(&path, columns(&names)).unwrap();
    assert_eq!(history.column("energy.internal"), Some(3));
    assert_eq!(history.column("energy"), None);
    let rows = [
        [1.0, 0.1, -1.0 / 3.0, 1e-300],
        [2.0, 0.1 + 0.2, f64::NAN, 6.02214076e23],
    ];
    for (k, row) in rows.iter().enumerate() {
        history.push(row).unwrap();
        // Whole lines are there after every row.
        let text = fs::read_to_string(&path).unwrap();
        assert_eq!(text.lines().count(), k + 2);
        assert!(text.ends_with('\n'));
    }
    let table = read_csv(&path).unwrap();
    assert_eq!(table.columns, names);
    for (row, back) in rows.iter().zip(&table.rows) {
        for (a, b) in row.iter().zip(back) {
            assert!(
                a.to_bits() == b.to_bits() || (a.is_nan() && b.is_nan()),
                "{a} {b}"
            );
        }
    }
    assert_eq!(table.column("time").unwrap(), [0.1, 0.1 + 0.2]);
    let text = fs::read_to_string(&path).unwrap();
    assert!(text.starts_with("step,time,\"force.a, \"\"b\"\".c.z\",energy.internal\n1,0.1,"));
    assert!(matches!(
        history.push(&[1.0]),
        Err(OutputError::RowLength {
            expected: 4,
            found: 1,
            ..
        })
    ));
}

#[test]
fn columns_are_documented() {
    for column in [
        "step",
        "force.punch.x",
        "moment.left edge.z",
        "force.body.set.y",
        "gap.min",
        "penetration.max",
        "points.active",
    ] {
        assert!(documented(column), "{column}");
    }
    for column in [
        "steps",
        "force.punch",
        "force.punch.w",
        "force..x",
        "force.x",
        "",
    ] {
        assert!(!documented(column), "{column}");
    }
    let table = column_table();
    assert_eq!(table.lines().count(), COLUMNS.len() + 2);
    let mut patterns: Vec<&str> = COLUMNS.iter().map(|c| c.pattern).collect();
    patterns.sort_unstable();
    patterns.dedup();
    assert_eq!(patterns.len(), COLUMNS.len());

    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("history.csv");
    let error = History::create(&path, columns(&["step", "colour"])).unwrap_err();
    assert_eq!(
        error.to_string(),
        "history column `colour` is not documented"
    );
    let error = History::create(&path, columns(&["force.a.x", "force.a.x"])).unwrap_err();
    assert!(matches!(error, OutputError::DuplicateColumn(_)));
    assert!(!path.exists());
}

#[test]
fn a_broken_table_is_named_with_its_line() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("t.csv");
    for (text, line, word) in [
        ("a,b\n1,2\n3\n", 3, "1 cells under 2 columns"),
        ("a,b\n1,2\n3,x\n", 3, "`x` is not a number"),
        ("", 1, "no line of column names"),
        ("\"a\n1\n", 1, "quote"),
    ] {
        fs::write(&path, text).unwrap();
        let error = read_csv(&path).unwrap_err().to_string();
        assert!(
            error.contains(&format!("line {line}: ")) && error.contains(word),
            "{error}"
        );
    }
}

#[test]
fn a_summary_reads_back() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("summary.json");
    let summary = Summary {
        title: "a tray".into(),
        status: RunStatus::NotConverged,
        reason: Some("step 4 would have to be smaller than 1e-5".into()),
        time: 0.3,
        wall_s: 1.25,
        cpu_s: Some(2.5),
        phases: BTreeMap::from([("assembly".to_string(), 0.1 + 0.2)]),
        peak_memory_mb: None,
        threads: 2,
        dofs: 37_800,
        contact_points: 676,
        newton_iterations: 41,
        failed_iterations: 5,
        given_up: GivenUp {
            runs: 1,
            newton_iterations: 3,
        },
        factorizations: BTreeMap::from([("llt".to_string(), 40), ("ldlt".to_string(), 1)]),
        steps: 3,
        cuts: 1,
        ping_pongs: 0,
        pattern_rebuilds: 0,
        stages: vec![],
        effects: vec!["normal contact".into()],
        probes: BTreeMap::new(),
        plan: Default::default(),
        warnings: vec!["slave points are coarse".into()],
        accuracy: Accuracy {
            force_error: 0.003,
            contact: Some("press".into()),
            ..Accuracy::default()
        },
        resumed: 0,
        scene: String::new(),
        versions: Versions::default(),
    };
    summary.write(&path).unwrap();
    assert_eq!(Summary::read(&path).unwrap(), summary);
    assert_eq!(
        summary.in_vain(),
        " (2 in attempts that failed, 3 in a run that was given up)"
    );
    let json: serde_json::Value =
        serde_json::from_str(&fs::read_to_string(&path).unwrap()).unwrap();
    assert_eq!(json["status"], "not_converged");
    assert_eq!(json["versions"]["covact"], env!("CARGO_PKG_VERSION"));
    for key in [
        "wall_s",
        "cpu_s",
        "phases",
        "peak_memory_mb",
        "dofs",
        "contact_points",
    ] {
        assert!(json.get(key).is_some(), "{key}");
    }
}

/// A surface that never moves has one file, which the collections list at every time, when the run is gone on with too.
#[test]
fn a_surface_that_never_moves_is_written_once() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path();
    let pvd = out.join("results.pvd");
    let surfaces = [square("floor"), square("punch")];
    let start = Isometry3::identity();
    let write = |results: &mut Results, step: u32| {
        let time = f64::from(step);
        let at = Isometry3::translation(0.0, 0.0, time);
        let states = [(&start, true), (&at, false)];
        let states: Vec<SurfaceState> = (surfaces.iter().zip(states))
            .map(|(surface, (at, still))| SurfaceState {
                surface,
                start: &start,
                at,
                still,
            })
            .collect();
        results.write(step, time, &[], &states, &[]).unwrap();
    };
    let mut results = Results::create(out).unwrap();
    write(&mut results, 0);
    write(&mut results, 1);
    let parts = PartNames {
        surfaces: vec!["floor".into(), "punch".into()],
        still: vec!["floor".into()],
        ..PartNames::default()
    };
    let mut results = Results::resume(out, results.written().to_vec(), &parts).unwrap();
    // Files of a step that was cut short.
    std::fs::write(out.join("punch_0002.vtu"), "half").unwrap();
    results.remove(2, &parts).unwrap();
    assert!(!out.join("punch_0002.vtu").exists());
    write(&mut results, 2);
    let expected = |kind: &str| {
        let of = |step: u32| {
            [
                format!("floor{kind}_0000.vtu"),
                format!("punch{kind}_000{step}.vtu"),
            ]
        };
        (0..3).flat_map(of).collect::<Vec<_>>()
    };
    assert_eq!(attributes(&pvd, "file"), expected(""));
    let flat = attributes(&out.join("results_tessellated.pvd"), "file");
    assert_eq!(flat, expected("_tessellated"));
    assert_eq!(
        attributes(&pvd, "timestep"),
        ["0.0", "0.0", "1.0", "1.0", "2.0", "2.0"]
    );
    for file in attributes(&pvd, "file").iter().chain(&flat) {
        let bytes = fs::read(out.join(file)).unwrap();
        Vtk::parse_xml(&inlined(&bytes).unwrap()[..]).unwrap();
    }
    let files = std::fs::read_dir(out).unwrap().count();
    // Two collections, twice the floor and three times the punch, each exact and flat.
    assert_eq!(files, 2 + 2 + 6);
}
