//! `study.csv`: a row per run.
use super::figures::per_step;
use super::view::View;
use crate::study::record::{Ending, Spread};
use std::collections::BTreeSet;

/// The table, with a line of names. Times in seconds, memory in megabytes; what is not known is empty.
pub(crate) fn table(view: &View) -> String {
    let record = view.record;
    let union = |of: fn(&crate::study::record::RunRecord) -> Vec<&String>| -> Vec<&String> {
        let all: BTreeSet<&String> = record.runs.iter().flat_map(of).collect();
        all.into_iter().collect()
    };
    let phases = union(|r| r.phases.keys().collect());
    let factorizations = union(|r| r.factorizations.keys().collect());
    let mut out = String::new();
    row(&mut out, &header(view, &phases, &factorizations));
    for (i, run) in record.runs.iter().enumerate() {
        let (status, reason) = match &run.ending {
            Ending::Done => ("done", ""),
            Ending::Failed(reason) => ("failed", reason.as_str()),
            Ending::Missing => ("missing", ""),
        };
        let mut cells = vec![run.id.clone()];
        for choice in &record.choices {
            let label = run.choices.get(choice);
            cells.push(label.map_or(String::new(), |l| l.text.clone()));
            cells.push(number(label.and_then(|l| l.size)));
        }
        cells.push(status.into());
        cells.push(reason.into());
        cells.push(run.reference.clone().unwrap_or_default());
        cells.extend(spread(run.wall));
        cells.extend(spread(run.cpu).into_iter().take(3));
        cells.push(run.wall.map_or(String::new(), |w| w.repeats.to_string()));
        cells.push(number(run.peak_memory_mb));
        for count in [run.dofs, run.contact_points] {
            cells.push(count.to_string());
        }
        cells.push(run.newton_iterations.to_string());
        cells.push(run.steps.to_string());
        cells.push(run.cuts.to_string());
        let per_step = per_step(view, i);
        cells.push(number(per_step.map(|p| p.0)));
        cells.push(per_step.map_or(String::new(), |p| p.1.to_string()));
        for name in &phases {
            cells.push(number(run.phases.get(*name).copied()));
        }
        for name in &factorizations {
            let n = run.factorizations.get(*name);
            cells.push(n.map_or(String::new(), u64::to_string));
        }
        for q in 0..record.quantities.len() {
            let measured = run.measured.get(q);
            cells.push(number(measured.and_then(|m| m.value)));
            cells.push(number(measured.and_then(|m| m.error)));
            cells.push(measured.and_then(|m| m.missing.clone()).unwrap_or_default());
        }
        cells.push(run.warnings.join("; "));
        row(&mut out, &cells);
    }
    out
}

fn header(view: &View, phases: &[&String], factorizations: &[&String]) -> Vec<String> {
    let mut names = vec!["id".to_string()];
    for choice in &view.record.choices {
        names.push(choice.clone());
        names.push(format!("{choice}.size"));
    }
    let fixed = "status reason reference wall_s wall_least_s wall_most_s cpu_s cpu_least_s cpu_most_s repeats \
                 peak_memory_mb dofs contact_points newton_iterations steps cuts iterations_per_step_mean \
                 iterations_per_step_most";
    names.extend(fixed.split_whitespace().map(str::to_string));
    names.extend(phases.iter().map(|p| format!("phase.{p}_s")));
    names.extend(factorizations.iter().map(|f| format!("factorizations.{f}")));
    for quantity in &view.record.quantities {
        for what in ["", ".error", ".missing"] {
            names.push(format!("{}{what}", quantity.name));
        }
    }
    names.push("warnings".to_string());
    names
}

fn spread(spread: Option<Spread>) -> [String; 3] {
    let of = |value: fn(Spread) -> f64| number(spread.map(value));
    [of(|s| s.median), of(|s| s.least), of(|s| s.most)]
}

/// The shortest that reads back as the same number.
fn number(value: Option<f64>) -> String {
    value
        .filter(|v| v.is_finite())
        .map_or(String::new(), |v| format!("{v:?}"))
}

fn row(out: &mut String, cells: &[String]) {
    for (i, cell) in cells.iter().enumerate() {
        if i > 0 {
            out.push(',');
        }
        if cell.contains([',', '"', '\n', '\r']) || cell.starts_with(' ') || cell.ends_with(' ') {
            out.push('"');
            out.push_str(&cell.replace('"', "\"\""));
            out.push('"');
        } else {
            out.push_str(cell);
        }
    }
    out.push('\n');
}
