//! Two runs side by side: what their histories end with and reach, and what they cost.
use super::history::{Table, read_csv};
use super::{OutputError, RunStatus, Summary};
use serde::Serialize;
use std::collections::BTreeMap;
use std::path::Path;

/// A part of the largest value of its kind below which a number is rounding.
const NOTHING: f64 = 1e-9;

/// A run beside another one of the same scene.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Comparison {
    /// Columns of the histories, of both or of one only.
    pub columns: Vec<Compared>,
    /// What both runs cost, the full one first.
    pub cost: [Cost; 2],
}

/// A column of the history.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Compared {
    /// Name of the column.
    pub name: String,
    /// Value of the last step in both runs; none where the run has no such column, or no steps.
    pub end: [Option<f64>; 2],
    /// Value of largest magnitude in both runs.
    pub peak: [Option<f64>; 2],
    /// Magnitude up to which a value of its kind is rounding: differences are not told relative to such a one.
    #[serde(skip)]
    pub least: f64,
}

/// What a run took.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Cost {
    /// How the run ended.
    pub status: RunStatus,
    /// Time that was reached, of the scene's clock.
    pub time: f64,
    /// Elapsed time (s).
    pub wall_s: f64,
    /// Processor time of all threads (s); none where it was not measured.
    pub cpu_s: Option<f64>,
    /// Accepted steps.
    pub steps: u32,
    /// Newton iterations of all attempts.
    pub iterations: u64,
    /// Number of factorizations, by method.
    pub factorizations: BTreeMap<String, u64>,
    /// Largest resident memory (10^6 bytes); none where it was not measured.
    pub peak_memory_mb: Option<f64>,
    /// Unknowns.
    pub dofs: usize,
}

impl Cost {
    fn new(summary: &Summary) -> Cost {
        Cost {
            status: summary.status,
            time: summary.time,
            wall_s: summary.wall_s,
            cpu_s: summary.cpu_s,
            steps: summary.steps,
            iterations: summary.newton_iterations,
            factorizations: summary.factorizations.clone(),
            peak_memory_mb: summary.peak_memory_mb,
            dofs: summary.dofs,
        }
    }
}

impl Compared {
    /// How much the second run differs at the end, relative to the first: negative where its magnitude is smaller. None
    /// where the first is zero or rounding, or there is none.
    pub fn change(&self) -> Option<f64> {
        change(self.end, self.least)
    }

    /// The same of the peaks.
    pub fn peak_change(&self) -> Option<f64> {
        change(self.peak, self.least)
    }
}

fn change([full, other]: [Option<f64>; 2], least: f64) -> Option<f64> {
    let (full, other) = full.zip(other)?;
    let change = (other - full) / full;
    (full.abs() > least && change.is_finite()).then_some(change)
}

/// Reads the results of two runs from their folders. `surfaces` are names whose forces are told, besides those of contacts
/// between bodies.
///
/// # Errors
/// A folder without the results of a run.
pub fn compare(folders: [&Path; 2], surfaces: &[&str]) -> Result<Comparison, OutputError> {
    let [full, other] = folders.map(|folder| {
        let table = read_csv(&folder.join("history.csv"))?;
        let summary = Summary::read(&folder.join("summary.json"))?;
        Ok::<_, OutputError>((table, summary))
    });
    let (full, other) = (full?, other?);
    let tables = [&full.0, &other.0];
    let mut names: Vec<&String> = Vec::new();
    for name in tables.iter().flat_map(|t| &t.columns) {
        if wanted(name, surfaces) && !names.contains(&name) {
            names.push(name);
        }
    }
    let mut columns: Vec<Compared> = (names.into_iter())
        .map(|name| Compared {
            name: name.clone(),
            end: tables.map(|t| end(t, name)),
            peak: tables.map(|t| peak(t, name)),
            least: 0.0,
        })
        .collect();
    let size = |c: &Compared| c.peak.iter().flatten().fold(0.0f64, |a, p| a.max(p.abs()));
    let mut largest: BTreeMap<String, f64> = BTreeMap::new();
    for column in &columns {
        let largest = largest.entry(kind(&column.name).to_owned()).or_default();
        *largest = largest.max(size(column));
    }
    for column in &mut columns {
        column.least = NOTHING * largest.get(kind(&column.name)).copied().unwrap_or(0.0);
    }
    columns.retain(|c| !["force", "moment"].contains(&kind(&c.name)) || size(c) > c.least);
    Ok(Comparison {
        columns,
        cost: [Cost::new(&full.1), Cost::new(&other.1)],
    })
}

/// What a column tells of: "force", "energy" and so on.
fn kind(name: &str) -> &str {
    let name = name.strip_prefix("slave.").unwrap_or(name);
    name.split_once('.').map_or(name, |(kind, _)| kind)
}

/// Columns that say how a run went as a whole.
fn wanted(name: &str, surfaces: &[&str]) -> bool {
    const ALWAYS: [&str; 5] = [
        "penetration.max",
        "pressure.max",
        "area.contact",
        "points.active",
        "stabilization.share",
    ];
    let of_surface = |kind: &str| {
        let rest = name.strip_prefix(kind).and_then(|r| r.rsplit_once('.'));
        rest.is_some_and(|(surface, _)| surfaces.contains(&surface))
    };
    ALWAYS.contains(&name)
        || name.starts_with("energy.")
        || name.starts_with("displacement.")
        || name.starts_with("slave.force.")
        || of_surface("force.")
        || of_surface("moment.")
}

fn end(table: &Table, name: &str) -> Option<f64> {
    table.column(name)?.last().copied()
}

fn peak(table: &Table, name: &str) -> Option<f64> {
    let all = table.column(name)?.into_iter().filter(|v| !v.is_nan());
    all.reduce(|a, b| if b.abs() > a.abs() { b } else { a })
}
