//! `study.csv`.
use crate::records;
use covact::study::record::Record;
use covact::study::report::write;

fn table(record: &Record) -> (tempfile::TempDir, Vec<Vec<String>>) {
    let folder = tempfile::tempdir().unwrap();
    write(record, folder.path()).unwrap();
    let text = std::fs::read_to_string(folder.path().join("study.csv")).unwrap();
    (folder, cells(&text))
}

/// RFC 4180.
fn cells(text: &str) -> Vec<Vec<String>> {
    let (mut rows, mut row, mut cell, mut quoted) = (Vec::new(), Vec::new(), String::new(), false);
    let mut chars = text.chars().peekable();
    while let Some(c) = chars.next() {
        match (c, quoted) {
            ('"', true) if chars.peek() == Some(&'"') => cell.push(chars.next().unwrap()),
            ('"', _) => quoted = !quoted,
            (',', false) => row.push(std::mem::take(&mut cell)),
            ('\n', false) => {
                row.push(std::mem::take(&mut cell));
                rows.push(std::mem::take(&mut row));
            }
            (c, _) => cell.push(c),
        }
    }
    assert!(!quoted && cell.is_empty() && row.is_empty());
    rows
}

#[test]
fn everything_comes_back() {
    for record in [records::forty(), records::nasty(), records::no_logarithm()] {
        let (_folder, rows) = table(&record);
        let place = |name: &str| rows[0].iter().position(|c| c == name).unwrap();
        assert_eq!(rows.len(), record.runs.len() + 1);
        for (run, row) in record.runs.iter().zip(&rows[1..]) {
            assert_eq!(row.len(), rows[0].len());
            assert_eq!(row[place("id")], run.id);
            assert_eq!(row[place("warnings")], run.warnings.join("; "));
            for choice in &record.choices {
                let text = run.choices.get(choice).map_or("", |l| &l.text);
                assert_eq!(row[place(choice)], text);
            }
            let same = |name: &str, value: Option<f64>| {
                let value = value.filter(|v| v.is_finite());
                assert_eq!(row[place(name)].parse().ok(), value, "{name}");
            };
            same("wall_s", run.wall.map(|w| w.median));
            same("wall_most_s", run.wall.map(|w| w.most));
            same("phase.contact_s", run.phases.get("contact").copied());
            same("newton_iterations", Some(run.newton_iterations as f64));
            for (quantity, measured) in record.quantities.iter().zip(&run.measured) {
                same(&quantity.name, measured.value);
                same(&format!("{}.error", quantity.name), measured.error);
            }
        }
    }
}

#[test]
fn failures_have_their_reason() {
    let (_folder, rows) = table(&records::forty());
    let place = |name: &str| rows[0].iter().position(|c| c == name).unwrap();
    assert_eq!(rows[6][place("status")], "failed");
    assert_eq!(
        rows[6][place("reason")],
        "step 7 does not converge: the residual grows <100 & \"worse\">"
    );
    assert_eq!(rows[31][place("status")], "missing");
    assert_eq!(rows[31][place("wall_s")], "");
    assert_eq!(rows[1][place("iterations_per_step_mean")], "5.7");
}
