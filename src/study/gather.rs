//! From folders of results to records.
use super::expand::{Expansion, Planned};
use super::file::Timing;
use super::folder::Folder;
use super::play::Account;
use super::record::{Ending, RunRecord, Spread};
use crate::output::{RunStatus, Summary, read_csv};
use crate::run::Exit;
use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

/// Characters of a reason that is taken from what a run said.
const REASON: usize = 300;

/// What is known of a repeat of a run.
#[derive(Debug, Clone)]
pub(super) struct State {
    pub ending: Ending,
    /// Of this scene, program and number of threads.
    pub summary: Option<Summary>,
    pub account: Option<Account>,
    /// Why results that are there are not taken.
    pub stale: Option<String>,
}

impl State {
    /// Elapsed seconds: of the process where it was done here, else as the run tells.
    pub fn wall(&self) -> Option<f64> {
        let own = self.account.as_ref().map(|a| a.wall_s);
        own.or(self.summary.as_ref().map(|s| s.wall_s))
    }

    /// Whether it has to be done: it has not been, or it might come out otherwise now.
    pub fn again(&self, limit: f64) -> bool {
        let by_chance = |a: &Account| {
            a.exit_code == Some(Exit::Io.code().into())
                || (a.stopped_after.is_none() && a.signal.is_some())
        };
        let too_soon = |a: &Account| a.stopped_after.is_some_and(|after| after < limit);
        self.ending == Ending::Missing
            || (self.account.as_ref()).is_some_and(|a| by_chance(a) || too_soon(a))
    }
}

/// Looks at a repeat of a run.
pub(super) fn state(folder: &Folder, run: usize, repeat: u32) -> State {
    let ready = &folder.runs[run];
    let results = folder.results(&ready.id, repeat);
    let version = env!("CARGO_PKG_VERSION");
    let path = results.join("summary.json");
    // One that is there and cannot be read tells nothing: the run is done anew.
    let (found, unreadable) = match (Summary::read(&path), path.exists()) {
        (Ok(summary), _) => (Some(summary), None),
        (Err(e), true) => (None, Some(e.to_string())),
        (Err(_), false) => (None, None),
    };
    let account = Account::read(&results);
    let mut stale = None;
    let mut fits = |scene: &str, covact: &str, threads: usize| {
        let why = if covact != version {
            format!("they are of covact {covact}, and this is {version}")
        } else if scene != ready.checksum {
            "the scene or a file that it names has changed since".to_owned()
        } else if threads != folder.threads as usize {
            format!(
                "they took {threads} thread(s), and the study asks for {}",
                folder.threads
            )
        } else {
            return true;
        };
        stale = Some(why);
        false
    };
    let summary = found.filter(|s| fits(&s.scene, &s.versions.covact, s.threads));
    let account = account.filter(|a| fits(&a.scene, &a.covact, a.threads));
    // A run that was stopped or failed has been done again elsewhere, where its summary says that it is done.
    let is_done = (summary.as_ref()).is_some_and(|s| s.status == RunStatus::Done);
    let account = account.filter(|a| !is_done || a.exit_code == Some(0));
    let lost = match (&summary, &account, unreadable) {
        (None, _, Some(why)) => Some(why),
        (None, Some(a), None) if a.exit_code == Some(0) && a.stopped_after.is_none() => {
            Some("the run ended well, but there is no `summary.json` of it".to_owned())
        }
        _ => None,
    };
    let ending = match (&summary, &account) {
        (None, _) if lost.is_some() => Ending::Missing,
        (_, Some(account)) if account.stopped_after.is_some() => {
            let after = account.stopped_after.unwrap_or_default();
            Ending::Failed(format!("stopped at its limit of {after} s"))
        }
        (Some(summary), _) => of_summary(summary),
        (None, Some(account)) => Ending::Failed(without_summary(account, &results)),
        (None, None) => Ending::Missing,
    };
    State {
        ending,
        summary,
        account,
        stale: stale.or(lost),
    }
}

fn of_summary(summary: &Summary) -> Ending {
    let what = match summary.status {
        RunStatus::Done => return Ending::Done,
        RunStatus::Interrupted => return Ending::Missing,
        RunStatus::NotConverged => "not converged",
        RunStatus::NoContact => "no contact",
        RunStatus::Failed => "failed",
    };
    let reason = summary
        .reason
        .as_ref()
        .map_or(String::new(), |r| format!(": {r}"));
    Ending::Failed(format!("{what}{reason}"))
}

/// Why a run ended that left no account of its own.
fn without_summary(account: &Account, results: &Path) -> String {
    if let Some(signal) = account.signal {
        return format!("ended by signal {signal}");
    }
    let said = std::fs::read(results.join("stderr.txt")).unwrap_or_default();
    let said = String::from_utf8_lossy(&said);
    let first = said
        .lines()
        .find(|l| !l.trim().is_empty())
        .unwrap_or_default();
    let first = first.strip_prefix("error: ").unwrap_or(first);
    match (first.is_empty(), account.exit_code) {
        (false, _) => first.chars().take(REASON).collect(),
        (true, Some(code)) => format!("exit code {code} without a word"),
        (true, None) => "it ended without a word".to_owned(),
    }
}

/// What all runs came to, and what the user should know.
pub(super) fn gather(
    folder: &Folder,
    expansion: &Expansion,
    timing: &Timing,
) -> (Vec<RunRecord>, Vec<String>, BTreeMap<String, PathBuf>) {
    let (mut records, mut warnings) = (Vec::new(), Vec::new());
    let mut results = BTreeMap::new();
    let mut elsewhere = 0;
    for (k, planned) in expansion.runs.iter().enumerate() {
        let states: Vec<State> = (1..=timing.repeats).map(|r| state(folder, k, r)).collect();
        for (repeat, state) in (1..).zip(&states) {
            if let Some(why) = &state.stale {
                warnings.push(format!(
                    "results in runs/{}/{repeat} are not taken: {why}",
                    planned.id
                ));
            }
        }
        elsewhere += (states.iter())
            .filter(|s| {
                s.ending != Ending::Missing && s.account.as_ref().is_none_or(|a| a.elsewhere)
            })
            .count();
        // One that fails now and then has failed.
        let failed = states.iter().position(|s| is_failed(&s.ending));
        let done = || states.iter().position(|s| s.ending == Ending::Done);
        let first = failed.or_else(done).unwrap_or(0);
        let path = folder.results(&planned.id, first as u32 + 1);
        let missing = states
            .iter()
            .filter(|s| s.ending == Ending::Missing)
            .count();
        if missing > 0 && missing < states.len() {
            warnings.push(format!(
                "run {}: {missing} of {} repeats are missing",
                planned.id,
                states.len()
            ));
        }
        records.push(record(planned, &states, first, &path, &mut warnings));
        results.insert(planned.id.clone(), path);
    }
    if elsewhere > 0 {
        warnings.push(format!(
            "{elsewhere} of the runs were not done by this command: their times are those that they tell, perhaps of \
             another machine"
        ));
    }
    if let Some(others) = others(folder) {
        warnings.push(others);
    }
    (records, warnings, results)
}

/// Folders that no run of the study has, in words.
fn others(folder: &Folder) -> Option<String> {
    let known: BTreeSet<&str> = folder.runs.iter().map(|r| r.id.as_str()).collect();
    let entries = std::fs::read_dir(folder.path.join("runs")).ok()?;
    let names = entries.filter_map(|e| e.ok()?.file_name().into_string().ok());
    let mut names: Vec<String> = names.filter(|n| !known.contains(n.as_str())).collect();
    names.sort();
    let first = names.first()?;
    Some(format!(
        "{} folder(s) in runs belong to no run of the study as it is now and are left alone, the first is {first}",
        names.len()
    ))
}

fn is_failed(ending: &Ending) -> bool {
    matches!(ending, Ending::Failed(_))
}

/// The record of a run; `first` is the first repeat that ended as the run did.
fn record(
    planned: &Planned,
    states: &[State],
    first: usize,
    results: &Path,
    warnings: &mut Vec<String>,
) -> RunRecord {
    let there = states.get(first);
    let ending = there.map_or(Ending::Missing, |s| s.ending.clone());
    // Times of a run that is done are those of repeats that are done, and a failed one's those of repeats that failed: what
    // an interrupted repeat took is no time of either.
    let alike = || {
        states.iter().filter(|s| match ending {
            Ending::Done => s.ending == Ending::Done,
            Ending::Failed(_) => is_failed(&s.ending),
            Ending::Missing => false,
        })
    };
    let count = states.iter().filter(|s| is_failed(&s.ending)).count();
    if count > 0 && states.iter().any(|s| s.ending == Ending::Done) {
        warnings.push(format!(
            "run {}: {count} of {} repeats failed, the others did not",
            planned.id,
            states.len()
        ));
    }
    let summary = alike().next().and_then(|s| s.summary.as_ref());
    let summaries = || alike().filter_map(|s| s.summary.as_ref());
    let mut phases = BTreeMap::new();
    for name in summaries().flat_map(|s| s.phases.keys()) {
        if !phases.contains_key(name) {
            let spread = spread(summaries().filter_map(|s| s.phases.get(name).copied()));
            phases.insert(name.clone(), spread.map_or(0.0, |s| s.median));
        }
    }
    let peak = summaries()
        .filter_map(|s| s.peak_memory_mb)
        .reduce(f64::max);
    let of = |take: &dyn Fn(&Summary) -> u64| summary.map_or(0, take);
    let wall = spread(alike().filter_map(State::wall));
    let cpu = spread(summaries().filter_map(|s| s.cpu_s));
    RunRecord {
        id: planned.id.clone(),
        choices: planned.choices.clone(),
        reference: planned.reference.clone(),
        ending,
        wall,
        cpu,
        phases,
        peak_memory_mb: peak,
        dofs: summary.map_or(0, |s| s.dofs),
        contact_points: summary.map_or(0, |s| s.contact_points),
        newton_iterations: of(&|s| s.newton_iterations),
        steps: summary.map_or(0, |s| s.steps),
        cuts: summary.map_or(0, |s| s.cuts),
        steps_taken: summary.map_or(Vec::new(), |_| steps(results)),
        factorizations: summary.map_or(BTreeMap::new(), |s| s.factorizations.clone()),
        warnings: summary.map_or(Vec::new(), |s| s.warnings.clone()),
        measured: Vec::new(),
    }
}

/// End time and iterations of every accepted step.
fn steps(results: &Path) -> Vec<(f64, u32)> {
    let Ok(table) = read_csv(&results.join("history.csv")) else {
        return Vec::new();
    };
    let column = |name: &str| table.columns.iter().position(|c| c == name);
    let (Some(time), Some(iterations)) = (column("time"), column("iterations")) else {
        return Vec::new();
    };
    (table.rows.iter())
        .filter_map(|row| Some((*row.get(time)?, *row.get(iterations)? as u32)))
        .collect()
}

/// None without values.
fn spread(values: impl Iterator<Item = f64>) -> Option<Spread> {
    let mut all: Vec<f64> = values.collect();
    all.sort_by(f64::total_cmp);
    let middle = all.len() / 2;
    let median = match all.len() % 2 {
        0 => 0.5 * (all.get(middle.wrapping_sub(1))? + all.get(middle)?),
        _ => *all.get(middle)?,
    };
    Some(Spread {
        median,
        least: *all.first()?,
        most: *all.last()?,
        repeats: all.len() as u32,
    })
}

#[cfg(test)]
mod tests {
    use super::spread;

    /// One slow repeat moves the most, and the median by no more than its rank does.
    #[test]
    fn the_median_does_not_follow_an_outlier() {
        let odd = spread([2.0, 90.0, 1.0].into_iter()).unwrap();
        assert_eq!((odd.median, odd.least, odd.most), (2.0, 1.0, 90.0));
        assert_eq!(odd.repeats, 3);
        let even = spread([3.0, 90.0, 1.0, 2.0].into_iter()).unwrap();
        assert_eq!((even.median, even.least, even.most), (2.5, 1.0, 90.0));
        assert_eq!(even.repeats, 4);
        assert_eq!(spread([7.0].into_iter()).unwrap().median, 7.0);
        assert!(spread(std::iter::empty()).is_none());
    }
}
