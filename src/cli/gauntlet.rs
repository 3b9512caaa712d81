//! `covact gauntlet`.
use super::text::folded;
use super::{GauntletArgs, exit, print, print_json, report};
use crate::gauntlet::{Case, GROUPS, Verdict, markdown, plain};
use rayon::prelude::*;
use serde::Serialize;

/// A case and its verdict, as JSON.
#[derive(Serialize)]
struct Found<'a> {
    group: &'a str,
    name: &'a str,
    what: &'a str,
    right: &'a str,
    passed: bool,
    #[serde(flatten)]
    verdict: &'a Verdict,
}

pub(super) fn gauntlet(args: &GauntletArgs) -> u8 {
    let wanted = |group: &str, case: &Case| {
        let full = format!("{group}/{}", case.name);
        args.cases.is_empty() || (args.cases.iter()).any(|c| c == group || *c == full)
    };
    let all = GROUPS
        .iter()
        .flat_map(|g| g.cases.iter().map(move |c| (g.name, c)));
    let cases: Vec<(&str, &Case)> = all.filter(|(group, case)| wanted(group, case)).collect();
    let known = |name: &str| GROUPS.iter().any(|g| g.name == name || find(g.name, name));
    if let Some(unknown) = args.cases.iter().find(|c| !known(c)) {
        let names = GROUPS.map(|g| g.name).join(", ");
        report::error(&format!(
            "there is no case or group `{unknown}`: groups are {names}; `covact gauntlet --list` shows all cases"
        ));
        return exit::USAGE;
    }
    if args.list {
        let lines = cases
            .iter()
            .map(|(group, c)| format!("{group}/{}: {}; right: {}\n", c.name, c.what, c.right));
        return print(&folded(&lines.collect::<String>()));
    }
    let quiet = args.json || args.markdown;
    let run = |(group, case): &(&'static str, &'static Case)| {
        let verdict = case.run_on(args.threads);
        if !quiet {
            print(&folded(&plain(group, case, &verdict)));
        }
        verdict
    };
    // As a rule a case runs on one thread, so that as many run at once as there are cores.
    let verdicts: Vec<Verdict> = cases.par_iter().with_max_len(1).map(run).collect();
    let failed = verdicts.iter().filter(|v| !v.passed()).count();
    if args.json {
        let found: Vec<Found> = (cases.iter().zip(&verdicts))
            .map(|((group, case), verdict)| Found {
                group,
                name: case.name,
                what: case.what,
                right: case.right,
                passed: verdict.passed(),
                verdict,
            })
            .collect();
        print_json(&found);
    } else if args.markdown {
        let mut groups: Vec<(&str, Vec<(&Case, Verdict)>)> = Vec::new();
        for ((group, case), verdict) in cases.iter().zip(verdicts.iter().cloned()) {
            if groups.last().is_none_or(|g| g.0 != *group) {
                groups.push((group, Vec::new()));
            }
            if let Some(last) = groups.last_mut() {
                last.1.push((case, verdict));
            }
        }
        print(&markdown(&groups));
    }
    let text = format!("{} of {} cases passed\n", cases.len() - failed, cases.len());
    report::stderr(&text);
    if failed > 0 { exit::NOT_CONVERGED } else { 0 }
}

fn find(group: &str, name: &str) -> bool {
    (name.split_once('/')).is_some_and(|(g, n)| g == group && crate::gauntlet::find(g, n).is_some())
}
