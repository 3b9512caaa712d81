//! Runs that failed or have not been done.
use super::super::view::View;
use crate::page::number::{count, several};
use crate::study::record::Ending;

/// Runs that are named at most.
const NAMED: usize = 5;

pub(super) fn sentences(view: &View) -> Vec<String> {
    let runs = &view.record.runs;
    let mut out = Vec::new();
    let failed: Vec<(usize, &str)> = (runs.iter().enumerate())
        .filter_map(|(i, run)| match &run.ending {
            Ending::Failed(reason) => Some((i, reason.as_str())),
            _ => None,
        })
        .collect();
    if !failed.is_empty() {
        let whole = several(runs.len(), "run");
        let how_many = match (failed.len(), runs.len()) {
            (1, 1) => "The only run failed".to_string(),
            (n, all) if n == all => format!("All {whole} failed"),
            (n, _) => format!("{} of {whole} failed", count(n as u64)),
        };
        let named: Vec<String> = (failed.iter().take(NAMED))
            .map(|(i, reason)| format!("{} ({})", view.name(*i), short(reason)))
            .collect();
        let more = match failed.len().saturating_sub(NAMED) {
            0 => String::new(),
            n => format!("; {} more, which the table has", count(n as u64)),
        };
        out.push(format!("{how_many}: {}{more}.", named.join("; ")));
    }
    let missing = runs.iter().filter(|r| r.ending == Ending::Missing).count();
    if missing > 0 {
        let (verb, whole) = (if missing == 1 { "has" } else { "have" }, runs.len());
        out.push(format!(
            "{} of {} {verb} not been done, or the results are not here.",
            count(missing as u64),
            several(whole, "run")
        ));
    }
    out
}

/// A reason on one line, without its full stop, cut where it is a whole story.
fn short(reason: &str) -> String {
    let words: Vec<&str> = reason.split_whitespace().collect();
    let line = words.join(" ");
    let line = line.trim_end_matches('.');
    match line.char_indices().nth(160) {
        Some((at, _)) => format!("{}…", line[..at].trim_end()),
        None => line.to_string(),
    }
}
