//! A history as it is committed, and how two of them are compared.
use covact::output::{Summary, Table};
use std::collections::BTreeMap;
use std::fmt::Write;

/// Largest difference, relative to the largest number of the same kind in the run. Other processors round otherwise: the
/// linear algebra takes the widest fused operations that it finds, so the last digits differ from one to the next. A
/// change of what is computed is rarely below 1e-9.
const TOLERANCE: f64 = 1e-9;

/// Digits behind the point that are committed, three more than are compared.
const DIGITS: usize = 11;

/// How a run ended, and its history.
#[derive(Debug, Clone, PartialEq)]
pub struct Record {
    /// Counts of the whole run, those of failed attempts included.
    ending: String,
    columns: Vec<String>,
    rows: Vec<Vec<f64>>,
}

impl Record {
    pub fn new(summary: &Summary, history: &Table) -> Self {
        Record {
            ending: format!(
                "{} with {} iterations, {} cuts, {} rounds broken",
                summary.status.name(),
                summary.newton_iterations,
                summary.cuts,
                summary.ping_pongs
            ),
            columns: history.columns.clone(),
            rows: history.rows.clone(),
        }
    }

    /// The file of a scene.
    pub fn text(&self, name: &str) -> String {
        let scales = self.scales();
        let mut text = format!(
            "# History of the shipped scene `{name}`, as tests/hard_cases/histories/scenes.rs changes it; written by\n\
             # {}\n\
             # Counts are compared exactly, everything else to {TOLERANCE:e} of the largest number of its kind: processors differ in\n\
             # how they round (fused operations), which moves the last digits.\n\
             # ended: {}\n{}\n",
            super::COMMAND,
            self.ending,
            self.columns.join(",")
        );
        for row in &self.rows {
            for (i, x) in row.iter().enumerate() {
                let comma = if i > 0 { "," } else { "" };
                // Writing to a String does not fail.
                let _ = write!(text, "{comma}{}", short(*x, scales[i]));
            }
            text.push('\n');
        }
        text
    }

    /// Reads what [`Record::text`] wrote.
    pub fn read(text: &str) -> Result<Self, String> {
        let ending = text.lines().find_map(|line| line.strip_prefix("# ended: "));
        let mut lines = text.lines().filter(|line| !line.starts_with('#'));
        let columns: Vec<String> = (lines.next().ok_or("it is empty")?.split(','))
            .map(str::to_owned)
            .collect();
        let row = |line: &str| -> Result<Vec<f64>, String> {
            let cells = line.split(',').map(|cell| {
                let number = cell.parse::<f64>();
                number.map_err(|_| format!("`{cell}` is not a number"))
            });
            let cells: Vec<f64> = cells.collect::<Result<_, _>>()?;
            match cells.len() == columns.len() {
                true => Ok(cells),
                false => Err(format!(
                    "{} cells under {} columns",
                    cells.len(),
                    columns.len()
                )),
            }
        };
        Ok(Record {
            ending: ending
                .ok_or("it does not say how the run ended")?
                .to_owned(),
            rows: lines.map(row).collect::<Result<_, _>>()?,
            columns,
        })
    }

    /// Everything in which this record is not the committed one, in words: a line for the ending, for missing and for new
    /// columns and rows, and for every column that moved.
    pub fn moved_from(&self, committed: &Record) -> Vec<String> {
        let mut moved = Vec::new();
        if self.ending != committed.ending {
            moved.push(format!("ended {}, was {}", self.ending, committed.ending));
        }
        if self.rows.len() != committed.rows.len() {
            let (rows, were) = (self.rows.len(), committed.rows.len());
            moved.push(format!("{rows} rows, were {were}"));
        }
        for column in &committed.columns {
            if !self.columns.contains(column) {
                moved.push(format!("{column}: the column is missing"));
            }
        }
        let scales = committed.scales();
        for (i, column) in self.columns.iter().enumerate() {
            let Some(j) = committed.columns.iter().position(|c| c == column) else {
                moved.push(format!("{column}: the column is new"));
                continue;
            };
            let rows = self
                .rows
                .iter()
                .zip(&committed.rows)
                .map(|(a, b)| (a[i], b[j]));
            moved.extend(difference(column, rows, scales[j]));
        }
        if moved.is_empty() && self.columns != committed.columns {
            moved.push("the columns are in another order".to_owned());
        }
        moved
    }

    /// What differences of each column are relative to; none: they are counts.
    fn scales(&self) -> Vec<Option<f64>> {
        let mut largest: BTreeMap<&str, f64> = BTreeMap::new();
        for (i, column) in self.columns.iter().enumerate() {
            let sizes = self.rows.iter().map(|row| row[i].abs());
            let largest = largest.entry(kind(column)).or_default();
            *largest = sizes.filter(|x| x.is_finite()).fold(*largest, f64::max);
        }
        (self.columns.iter())
            .map(|column| match kind(column) {
                "count" => None,
                // Relative to the forces already.
                "residual" => Some(1.0),
                kind => Some(largest[kind]),
            })
            .collect()
    }
}

/// Columns of one kind are compared with the largest number of all of them: a force that is zero by symmetry is as exact as
/// the forces that it is the sum of.
fn kind(column: &str) -> &str {
    const COUNTS: [&str; 4] = ["step", "iterations", "cuts", "augmentations"];
    if COUNTS.contains(&column) || column.starts_with("points.") {
        return "count";
    }
    let column = (["slave.", "master.", "imbalance."].iter())
        .find_map(|prefix| column.strip_prefix(prefix))
        .unwrap_or(column);
    match column.split('.').next().unwrap_or(column) {
        "force_balance" => "force",
        "moment_balance" => "moment",
        kind => kind,
    }
}

/// How a column moved, if it did: its first row that did, and the largest difference.
fn difference(
    column: &str,
    rows: impl Iterator<Item = (f64, f64)>,
    scale: Option<f64>,
) -> Option<String> {
    let limit = scale.map_or(0.0, |scale| TOLERANCE * scale);
    let moved: Vec<(usize, f64, f64)> = (rows.enumerate())
        .filter(|(_, (now, was))| {
            let same = now == was || now.is_nan() && was.is_nan();
            !same && ((now - was).abs() > limit || (now - was).is_nan())
        })
        .map(|(row, (now, was))| (row + 1, now, was))
        .collect();
    let &(row, now, was) = moved.first()?;
    let largest = moved.iter().map(|m| (m.1 - m.2).abs()).fold(0.0, f64::max);
    let largest = match scale {
        Some(scale) => format!("{:.1e} of the largest", largest / scale),
        None => format!("{largest}"),
    };
    let count = moved.len();
    Some(format!(
        "{column}: {now:?} in row {row}, was {was:?}; {count} rows differ, by at most {largest}"
    ))
}

/// A number with the digits that are committed; zero where it is rounding beside its scale.
fn short(x: f64, scale: Option<f64>) -> String {
    let Some(scale) = scale else {
        return format!("{x}");
    };
    if x.abs() < 1e-3 * TOLERANCE * scale {
        return "0".to_owned();
    }
    let rounded: f64 = format!("{x:.DIGITS$e}").parse().unwrap_or(x);
    let [plain, power] = [format!("{rounded}"), format!("{rounded:e}")];
    if plain.len() <= power.len() {
        plain
    } else {
        power
    }
}

/// A history of three steps to be changed.
fn sample() -> Record {
    let columns = [
        "step",
        "time",
        "iterations",
        "force.a.x",
        "force.a.z",
        "gap.min",
    ];
    Record {
        ending: "done with 12 iterations, 0 cuts, 0 rounds broken".to_owned(),
        columns: columns.map(str::to_owned).to_vec(),
        rows: vec![
            vec![1.0, 0.1 + 0.2, 4.0, 3e-17, -1.0 / 3.0, f64::NAN],
            vec![2.0, 0.5, 4.0, 1e-5, -20.0 / 3.0, -0.125],
            vec![3.0, 1.0, 4.0, 0.25, -1e5 / 3.0, -1e-9 / 3.0],
        ],
    }
}

#[test]
fn a_record_reads_back_within_the_tolerance() {
    let record = sample();
    let back = Record::read(&record.text("sample")).expect("readable");
    assert_eq!(record.moved_from(&back), Vec::<String>::new());
    assert_eq!(back.moved_from(&record), Vec::<String>::new());
    // The force that is rounding beside the others is written as nothing.
    assert_eq!(back.rows[0][3], 0.0);
}

#[test]
fn every_change_is_found_and_named() {
    let was = sample();
    let one = |change: &dyn Fn(&mut Record)| {
        let mut now = sample();
        change(&mut now);
        let moved = now.moved_from(&was);
        assert_eq!(moved.len(), 1, "{moved:?}");
        moved.into_iter().next().expect("a line")
    };
    let nothing = |change: &dyn Fn(&mut Record)| {
        let mut now = sample();
        change(&mut now);
        assert_eq!(now.moved_from(&was), Vec::<String>::new());
    };
    // 1e-9 of the largest force is 3.3e-5, for both of its components.
    nothing(&|r| r.rows[1][3] += 3e-5);
    let text = one(&|r| r.rows[1][3] += 4e-5);
    assert!(
        text.starts_with("force.a.x: ") && text.contains("in row 2, was 1e-5"),
        "{text}"
    );
    assert!(text.contains("1 rows differ, by at most 1.2e-9"), "{text}");
    // Counts are exact, and what is no number stays so.
    let text = one(&|r| r.rows[2][2] = 5.0);
    assert!(
        text.starts_with("iterations: 5.0 in row 3, was 4.0"),
        "{text}"
    );
    let text = one(&|r| r.rows[0][5] = 0.0);
    assert!(text.starts_with("gap.min: 0.0 in row 1, was NaN"), "{text}");
    let text = one(&|r| r.rows[1][5] = f64::NAN);
    assert!(text.starts_with("gap.min: NaN in row 2"), "{text}");
    let text = one(&|r| r.ending = r.ending.replace("0 cuts", "1 cuts"));
    assert!(
        text.contains("1 cuts") && text.contains("was done with 12"),
        "{text}"
    );
    let text = one(&|r| r.rows.truncate(2));
    assert_eq!(text, "2 rows, were 3");
    let text = one(&|r| {
        r.columns.pop();
        r.rows.iter_mut().for_each(|row| row.truncate(5));
    });
    assert_eq!(text, "gap.min: the column is missing");
    let text = one(&|r| {
        r.columns.push("area.contact".to_owned());
        r.rows.iter_mut().for_each(|row| row.push(1.0));
    });
    assert_eq!(text, "area.contact: the column is new");
    let text = one(&|r| {
        r.columns.swap(0, 1);
        r.rows.iter_mut().for_each(|row| row.swap(0, 1));
    });
    assert_eq!(text, "the columns are in another order");
}
