//! The gauntlet as a table.
use super::{Case, Verdict};

/// The verdicts of one group.
pub type Rows<'a> = Vec<(&'a Case, Verdict)>;

fn iterations(verdict: &Verdict) -> String {
    match verdict.allowed {
        u64::MAX => verdict.iterations.to_string(),
        allowed => format!("{} of {allowed}", verdict.iterations),
    }
}

fn measured(verdict: &Verdict) -> String {
    match verdict.tightest() {
        // A statement holds or not.
        Some(check) if check.limit == 0.0 && check.passed() => "holds".to_owned(),
        Some(check) => format!("{:.0e} of {:.0e}", check.value, check.limit),
        None => String::new(),
    }
}

/// A row as plain text for a terminal, then the failures, indented.
pub fn plain(group: &str, case: &Case, verdict: &Verdict) -> String {
    let name = format!("{group}/{}", case.name);
    let mut text = format!(
        "{} {name:<44} {:>16} {:>14} {:>7.2} s\n",
        if verdict.passed() { "ok  " } else { "FAIL" },
        measured(verdict),
        iterations(verdict),
        verdict.seconds,
    );
    for failure in verdict.failures() {
        text += &format!("       {failure}\n");
    }
    text
}

/// A Markdown table: a row per case; `measured` is the check that comes nearest to its limit.
pub fn markdown(groups: &[(&str, Rows)]) -> String {
    let mut text = String::from(
        "| case | what is done | what is right | measured of allowed | iterations |\n|---|---|---|---|---|\n",
    );
    for (group, rows) in groups {
        for (case, verdict) in rows {
            text += &format!(
                "| {group}: {} | {} | {} | {}{} | {} |\n",
                case.name.replace('_', " "),
                case.what,
                case.right,
                measured(verdict),
                if verdict.passed() { "" } else { " **failed**" },
                iterations(verdict),
            );
        }
    }
    text
}
