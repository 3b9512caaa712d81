//! Records made up for reports: numbers from plain laws, with scatter that is always the same.
use covact::study::file::Timing;
use covact::study::record::{
    Ending, Label, Machine, Measured, QuantityRecord, RECORD_FORMAT, Record, ReferenceRecord,
    RunRecord, Spread,
};
use std::collections::BTreeMap;

/// A record without runs.
pub fn empty(choices: &[&str], quantities: Vec<QuantityRecord>) -> Record {
    Record {
        format: RECORD_FORMAT,
        covact: "0.1.0".into(),
        title: "NURBS against facets".into(),
        question: "How fine must facets be, and what does that cost?".into(),
        scene: "punch_sheet.json".into(),
        machine: Machine {
            processor: "Imaginary 9000".into(),
            cores: 2,
            system: "linux x86_64".into(),
        },
        timing: Timing {
            repeats: 3,
            one_at_a_time: true,
            threads: 1,
            limit: 600.0,
        },
        choices: choices.iter().map(|c| c.to_string()).collect(),
        quantities,
        targets: vec![0.1, 0.03, 0.01, 0.003, 0.001],
        runs: Vec::new(),
        warnings: Vec::new(),
    }
}

pub fn quantity(name: &str, unit: &str, measure: &str) -> QuantityRecord {
    QuantityRecord {
        name: name.into(),
        unit: unit.into(),
        measure: measure.into(),
        curve: false,
        swing: false,
        reference: None,
    }
}

/// "punch force", compared with the finest run; its own error is relative.
pub fn force(own: Option<f64>) -> QuantityRecord {
    QuantityRecord {
        reference: Some(ReferenceRecord {
            source: "the finest run of `fine`".into(),
            value: Some(1234.5),
            curve: None,
            error: own,
            order: Some(1.9),
            observed: true,
        }),
        ..quantity("punch force", "N", "`surface.punch.force.z` at the end")
    }
}

pub fn noise() -> QuantityRecord {
    QuantityRecord {
        swing: true,
        ..quantity(
            "force noise",
            "",
            "swing of `surface.punch.force.z` between 0.2 and 1",
        )
    }
}

pub fn curve() -> QuantityRecord {
    QuantityRecord {
        curve: true,
        reference: Some(ReferenceRecord {
            source: "Hertz (1882)".into(),
            value: None,
            curve: Some(
                (0..=50)
                    .map(|k| [f64::from(k) / 50.0, law(f64::from(k) / 50.0)])
                    .collect(),
            ),
            error: Some(0.0),
            order: None,
            observed: false,
        }),
        ..quantity(
            "force over travel",
            "N",
            "`surface.punch.force.z` over `surface.punch.travel.z`",
        )
    }
}

fn law(x: f64) -> f64 {
    1200.0 * x.powf(1.5)
}

pub fn label(text: &str, series: &str, size: Option<f64>) -> Label {
    Label {
        text: text.into(),
        series: series.into(),
        size,
    }
}

pub fn spread(median: f64) -> Spread {
    Spread {
        median,
        least: 0.96 * median,
        most: 1.05 * median,
        repeats: 3,
    }
}

/// A run that got through in so many seconds.
pub fn run(id: &str, choices: &[(&str, Label)], wall: f64) -> RunRecord {
    RunRecord {
        id: id.into(),
        choices: choices
            .iter()
            .map(|(name, label)| (name.to_string(), label.clone()))
            .collect(),
        reference: None,
        ending: Ending::Done,
        wall: Some(spread(wall)),
        cpu: Some(spread(0.95 * wall)),
        phases: BTreeMap::from([
            ("contact".into(), 0.4 * wall),
            ("assembly".into(), 0.25 * wall),
            ("linear_solve".into(), 0.2 * wall),
            ("output".into(), 0.05 * wall),
        ]),
        peak_memory_mb: Some(40.0 + wall),
        dofs: 300,
        contact_points: 100,
        newton_iterations: 40,
        steps: 10,
        cuts: 0,
        steps_taken: (1..=10).map(|k| (0.1 * f64::from(k), 4)).collect(),
        factorizations: BTreeMap::from([("lu".into(), 40)]),
        warnings: Vec::new(),
        measured: Vec::new(),
    }
}

pub fn value(value: f64) -> Measured {
    Measured {
        value: Some(value),
        ..Measured::default()
    }
}

pub fn error(value: f64, error: f64) -> Measured {
    Measured {
        value: Some(value),
        error: Some(error),
        ..Measured::default()
    }
}

/// A number between -1 and 1 that looks random.
fn scatter(k: usize) -> f64 {
    let x = (k as f64 * 12.9898 + 4.1).sin() * 43758.547;
    2.0 * (x - x.floor()) - 1.0
}

/// Masters times shells: exact, and facets of several chords; sheets of several fineness.
pub fn facets(chords: &[f64], sheets: &[(&str, &[u32])]) -> Record {
    let mut record = empty(
        &["master", "shell"],
        vec![force(Some(0.0004)), noise(), curve()],
    );
    let mut masters = vec![label("NURBS", "NURBS", None)];
    for series in ["bilinear", "smooth"] {
        for &chord in chords {
            masters.push(label(
                &format!("{series}, chord {chord}"),
                series,
                Some(chord),
            ));
        }
    }
    for master in &masters {
        for (element, counts) in sheets {
            for &n in *counts {
                let shell = label(
                    &format!("{element} {n} x {n}"),
                    element,
                    Some(1.0 / f64::from(n)),
                );
                let k = record.runs.len();
                record.runs.push(one(k, master, &shell, n));
            }
        }
    }
    record
}

fn one(k: usize, master: &Label, shell: &Label, n: u32) -> RunRecord {
    let h = shell.size.unwrap_or(1.0);
    let quadratic = shell.series == "Q18";
    let nodes = if quadratic {
        (2 * n + 1).pow(2)
    } else {
        2 * (n + 1).pow(2)
    };
    let dofs = 3 * nodes as usize;
    let of_shell = if quadratic {
        0.9 * h.powi(3)
    } else {
        1.5 * h.powf(1.9)
    };
    let (of_master, noise, iterations) = match (master.series.as_str(), master.size) {
        ("bilinear", Some(c)) => (0.5 * c, 0.28 * c, 12),
        ("smooth", Some(c)) => (0.3 * c * c, 0.04 * c, 5),
        _ => (0.0, 0.002, 4),
    };
    let error_of = (of_shell + of_master) * (1.0 + 0.05 * scatter(k)) + 0.0001;
    let wall = 0.08
        + 2e-5 * (dofs as f64).powf(1.25) * f64::from(iterations) * (1.0 + 0.1 * scatter(k + 7));
    let mut run = run(
        &format!("run-{k:03}"),
        &[("master", master.clone()), ("shell", shell.clone())],
        wall,
    );
    run.dofs = dofs;
    run.contact_points = 4 * (n * n) as usize;
    run.steps_taken = (1..=10)
        .map(|s| (0.1 * f64::from(s), iterations + (s * 7 + k as u32) % 4))
        .collect();
    run.newton_iterations = run.steps_taken.iter().map(|s| u64::from(s.1)).sum();
    let force = 1234.5 * (1.0 + error_of);
    let points = (0..=200).map(|j| {
        let x = f64::from(j) / 200.0;
        [
            x,
            law(x) * (1.0 + error_of) + 300.0 * noise * (60.0 * x).sin(),
        ]
    });
    run.measured = vec![
        error(force, error_of),
        value(noise * (1.0 + 0.2 * scatter(k + 3))),
        Measured {
            curve: Some(points.collect()),
            error: Some(error_of * 0.8),
            ..Measured::default()
        },
    ];
    run
}

/// 40 runs of three series, two of them failed, one missing, and two runs of the reference.
pub fn forty() -> Record {
    let mut record = facets(&[0.4, 0.2, 0.1, 0.05], &[("H8", &[4, 8, 16, 32])]);
    record
        .runs
        .extend(facets(&[0.4], &[("H8", &[64])]).runs.into_iter().take(2));
    record.runs.truncate(38);
    fail(
        &mut record.runs[5],
        "step 7 does not converge: the residual grows <100 & \"worse\">",
    );
    fail(&mut record.runs[16], "stopped after 600 s");
    record.runs[30].ending = Ending::Missing;
    record.runs[30].wall = None;
    record.runs[30].measured = vec![Measured::default(); 3];
    for (k, n) in [(0, 64), (1, 128)] {
        let mut fine = run(&format!("reference-fine-{n}"), &[], 40.0 * f64::from(k + 1));
        fine.reference = Some("fine".into());
        fine.measured = vec![
            error(1234.5, 0.0003 * f64::from(1 - k)),
            value(0.002),
            Measured::default(),
        ];
        record.runs.push(fine);
    }
    record.warnings = vec!["The machine was busy with other work during 3 runs.".into()];
    record
}

pub fn fail(run: &mut RunRecord, reason: &str) {
    run.ending = Ending::Failed(reason.into());
    run.measured = vec![Measured::default(); run.measured.len()];
}

/// 200 runs of twelve series with six quantities.
pub fn two_hundred() -> Record {
    let mut record = facets(
        &[0.4, 0.3, 0.2, 0.15, 0.1, 0.07, 0.05, 0.035, 0.025],
        &[("H8", &[4, 8, 16, 32, 64]), ("Q18", &[4, 8, 16, 24, 32])],
    );
    record.runs.extend(record.runs.clone().into_iter().take(10));
    for run in &mut record.runs[190..] {
        run.id.push('b');
        run.choices
            .insert("shell".into(), label("S4 of another kind", "S4", None));
    }
    for k in 2..5 {
        let mut more = force(Some(0.0));
        more.name = format!("force of part {k}");
        record.quantities.push(more);
        for run in &mut record.runs {
            let first = run.measured[0].clone();
            run.measured.push(first);
        }
    }
    record
}

/// Twelve series: more than there are colours.
pub fn many_series() -> Record {
    let plain = facets(&[0.4, 0.1], &[("H8", &[4, 8, 16]), ("Q18", &[4, 8])]);
    let mut record = empty(&["master", "shell", "points"], vec![force(Some(0.0004))]);
    for (p, points) in ["nodes", "Gauss 2", "Gauss 3, averaged"]
        .into_iter()
        .enumerate()
    {
        for run in &plain.runs {
            let mut run = run.clone();
            run.id = format!("{}-{p}", run.id);
            run.choices
                .insert("points".into(), label(points, points, None));
            run.measured.truncate(1);
            run.measured[0].error = run.measured[0].error.map(|e| e * (1.0 + 0.3 * p as f64));
            record.runs.push(run);
        }
    }
    record
}

/// Names that would break a page or a picture that does not escape them.
pub fn nasty() -> Record {
    let mut record = facets(&[0.4, 0.2, 0.1], &[("H8", &[4, 8])]);
    record.title = "A <b>title</b> & \"more\" </script><script>alert('x')</script>".into();
    record.question = "Is `a<b` & c>d, \"really\"?".into();
    record.scene = "a very long name of a scene that goes on and on ".repeat(4) + "<&>.json";
    record.quantities[0].name =
        "force \"<&>\" of the very first punch that was ever pressed into a \
                                 sheet of metal, measured at its end"
            .into();
    record.choices[1] = "shell <&> with a rather long name of a choice".into();
    for run in &mut record.runs {
        let shell = run.choices.remove("shell").unwrap();
        let text = format!(
            "<i>{}</i> & \"quoted\", of a name that is much longer than there is room for in any legend",
            shell.text
        );
        let series = format!("<i>{}</i> & \"quoted\", of a long name", shell.series);
        run.choices
            .insert(record.choices[1].clone(), label(&text, &series, shell.size));
        run.warnings
            .push("a warning with, commas \"and quotes\"\nand lines".into());
    }
    fail(&mut record.runs[3], "x < y && \"z\" > w, and\nso on");
    record.warnings.push("<script>".into());
    record
}

/// Quantities without a reference.
pub fn no_reference() -> Record {
    let mut record = facets(&[0.4, 0.2, 0.1, 0.05], &[("H8", &[16])]);
    record.quantities.truncate(2);
    record.quantities[0].reference = None;
    for run in &mut record.runs {
        run.measured.truncate(2);
        run.measured[0].error = None;
    }
    record
}

/// Force noise alone, by a choice without sizes.
pub fn swing_only() -> Record {
    let mut record = empty(&["points"], vec![noise()]);
    for (k, (text, swing)) in [
        ("nodes", 0.21),
        ("Gauss 2", 0.12),
        ("Gauss 5", 0.03),
        ("averaged Gauss 3", 0.004),
    ]
    .into_iter()
    .enumerate()
    {
        let mut run = run(
            &format!("run-{k}"),
            &[("points", label(text, text, None))],
            1.0 + k as f64,
        );
        run.measured = vec![value(swing)];
        record.runs.push(run);
    }
    record
}

/// One run, and nothing varies.
pub fn single() -> Record {
    let mut record = facets(&[], &[("H8", &[8])]);
    record.runs.truncate(1);
    record
}

/// Not one run got through.
pub fn all_failed() -> Record {
    let mut record = facets(&[0.2], &[("H8", &[8])]);
    for run in &mut record.runs {
        fail(run, "the scene has no contact");
    }
    record
}

/// Errors that have no logarithm.
pub fn no_logarithm() -> Record {
    let mut record = facets(&[0.4, 0.2, 0.1], &[("H8", &[4, 8])]);
    let bad = [0.0, f64::NAN, f64::INFINITY, -1.0, 1e-300, 1e300];
    for (run, bad) in record.runs.iter_mut().zip(bad) {
        run.measured[0].error = Some(bad);
        run.measured[0].value = Some(bad);
        run.measured[1].value = Some(bad);
        run.measured[2].curve = Some(vec![[0.0, bad], [bad, 1.0], [1.0, 2.0]]);
        run.wall = Some(spread(bad));
        run.choices.get_mut("shell").unwrap().size = Some(bad);
        run.phases.insert("contact".into(), bad);
    }
    record
}
