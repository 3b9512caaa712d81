//! What a target error costs, with what, and what it costs with everything else.
use super::super::rates::own_error;
use super::super::view::{View, finer};
use super::{by_series, overlap};
use crate::page::number::{listed, percent, seconds};

/// What a set of runs says about a target.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Reach {
    /// The cheapest run that reaches it, whatever the reference's own error is, and does not lose it by being refined.
    At(usize),
    /// All runs are farther off than the reference's own error can explain.
    Never,
    /// Some run may reach it: the reference is not good enough to tell.
    Unknown,
}

pub(super) fn sentences(view: &View, q: usize) -> Vec<String> {
    let name = &view.record.quantities[q].name;
    let runs: Vec<usize> = (view.done().into_iter())
        .filter(|&i| view.error(i, q).is_some() && view.wall(i).is_some())
        .collect();
    if runs.is_empty() {
        return vec![format!("No run has both a time and an error of {name}.")];
    }
    let mut targets: Vec<f64> = (view.record.targets.iter().copied())
        .filter(|t| t.is_finite() && *t > 0.0)
        .collect();
    targets.sort_by(|a, b| b.total_cmp(a));
    targets.dedup();
    let own = own_error(view, q).unwrap_or(0.0);
    let (untold, told): (Vec<f64>, Vec<f64>) = targets.into_iter().partition(|t| *t <= own);
    let mut out = reached(view, q, &runs, &told);
    out.extend(cancelling(view, q, &runs, &told));
    if !untold.is_empty() {
        out.push(format!(
            "{} cannot be told: the reference's own error is {}.",
            all(&untold),
            percent(own)
        ));
    }
    let reference = view.record.quantities[q].reference.as_ref();
    if reference.is_some_and(|r| r.error.is_none()) {
        out.push("The reference's own error is not known; errors are distances from it.".into());
    }
    if runs
        .iter()
        .all(|&i| view.wall(i).is_some_and(|w| w.repeats < 2))
    {
        out.push(
            "Every run was timed once, so that small differences of time mean nothing.".into(),
        );
    }
    out
}

fn reached(view: &View, q: usize, runs: &[usize], targets: &[f64]) -> Vec<String> {
    let choice = separating(view, q, runs, targets);
    let series = choice.map_or(Vec::new(), |c| by_series(view, c, runs));
    // Targets with the same answer make one sentence.
    let mut groups: Vec<(Vec<f64>, Reach, Vec<Reach>)> = Vec::new();
    for &target in targets {
        let best = reach(view, q, runs, target);
        let each: Vec<Reach> = (series.iter())
            .map(|s| reach(view, q, &s.1, target))
            .collect();
        match groups.last_mut() {
            Some(last) if last.1 == best && last.2 == each => last.0.push(target),
            _ => groups.push((vec![target], best, each)),
        }
    }
    let mut out = Vec::new();
    for (targets, best, each) in &groups {
        let said = all(targets);
        match *best {
            Reach::At(i) => {
                let (verb, it) = if targets.len() > 1 {
                    ("cost", "them")
                } else {
                    ("costs", "it")
                };
                let others = others(view, choice, &series, each, i, it);
                out.push(format!(
                    "{said} {verb} {}{}{others}.",
                    time(view, i),
                    view.with(i)
                ));
            }
            Reach::Unknown => out.push(format!(
                "Whether a run reaches {said} cannot be told: the reference's own error is {}.",
                percent(own_error(view, q).unwrap_or(0.0))
            )),
            Reach::Never => {
                let error = |i: usize| view.error(i, q).unwrap_or(f64::INFINITY);
                let closest = (runs.iter().copied()).min_by(|&a, &b| error(a).total_cmp(&error(b)));
                let closest = closest.map_or(String::new(), |i| {
                    let kept = lost(view, q, i, error(i)).is_none();
                    format!(
                        "; the closest{} comes to {} in {}{}",
                        if kept { "" } else { ", by errors that cancel," },
                        percent(error(i)),
                        time(view, i),
                        view.with(i)
                    )
                });
                let said = said.replace(" and ", " or ");
                out.push(format!("No run reaches {said}{closest}."));
            }
        }
    }
    out
}

/// What the other series of the choice need, cheapest first.
fn others(
    view: &View,
    choice: Option<usize>,
    series: &[(&str, Vec<usize>)],
    each: &[Reach],
    best: usize,
    it: &str,
) -> String {
    let Some(c) = choice else {
        return String::new();
    };
    let own = view.label(best, c).map_or("", |l| l.series.as_str());
    let wall = |i: usize| view.wall(i).map_or(f64::INFINITY, |w| w.median);
    let mut need: Vec<(String, usize)> = Vec::new();
    let (mut never, mut unknown) = (Vec::new(), Vec::new());
    for ((name, _), reach) in series.iter().zip(each).filter(|s| s.0.0 != own) {
        let name = view.say(c, name);
        match *reach {
            Reach::At(i) => need.push((name, i)),
            Reach::Never => never.push(name),
            Reach::Unknown => unknown.push(name),
        }
    }
    need.sort_by(|a, b| wall(a.1).total_cmp(&wall(b.1)));
    let mut parts: Vec<String> = Vec::new();
    for (name, i) in need.iter().take(5) {
        let same = match (view.wall(best), view.wall(*i)) {
            (Some(a), Some(b)) => overlap(&a, &b),
            _ => false,
        };
        let verb = if same {
            "takes about as much,"
        } else {
            "needs"
        };
        let rest = rest(view, c, *i);
        parts.push(format!("; {name} {verb} {}{rest}", time(view, *i)));
    }
    let more = need.len().saturating_sub(5);
    if more > 0 {
        let most = need.last().map_or(String::new(), |n| time(view, n.1));
        parts.push(format!("; {more} more need up to {most}"));
    }
    let mut out = parts.concat();
    if !never.is_empty() {
        let verb = if never.len() > 1 {
            "never reach"
        } else {
            "never reaches"
        };
        out.push_str(&format!(
            "; {} {verb} {it} in the runs made",
            listed(&never)
        ));
    }
    if !unknown.is_empty() {
        let verb = if unknown.len() > 1 {
            "reach"
        } else {
            "reaches"
        };
        out.push_str(&format!(
            "; whether {} {verb} {it} cannot be told, for the reference's own error",
            listed(&unknown)
        ));
    }
    out
}

/// What the run is besides the series just named, in brackets.
fn rest(view: &View, choice: usize, run: usize) -> String {
    let mut parts: Vec<String> = Vec::new();
    for &c in &view.varying {
        let Some(label) = view.label(run, c) else {
            continue;
        };
        let part = if c == choice {
            // A number alone says nothing.
            let rest = finer(label);
            if rest.parse::<f64>().is_ok() {
                &label.text
            } else {
                rest
            }
        } else {
            &view.say(c, &label.text)
        };
        if !part.is_empty() {
            parts.push(part.replace(", ", " "));
        }
    }
    if parts.is_empty() {
        String::new()
    } else {
        format!(" ({})", parts.join("; "))
    }
}

fn reach(view: &View, q: usize, runs: &[usize], target: f64) -> Reach {
    let own = own_error(view, q).unwrap_or(0.0);
    let wall = |i: usize| view.wall(i).map_or(f64::INFINITY, |w| w.median);
    let error = |i: usize| view.error(i, q).unwrap_or(f64::INFINITY);
    let surely = (runs.iter().copied())
        .filter(|&i| error(i) + own <= target)
        .filter(|&i| lost(view, q, i, target).is_none());
    let perhaps = |i: usize| error(i) - own <= target && lost(view, q, i, target).is_none();
    match surely.min_by(|&a, &b| wall(a).total_cmp(&wall(b))) {
        Some(i) => Reach::At(i),
        None if runs.iter().any(|&i| perhaps(i)) => Reach::Unknown,
        None => Reach::Never,
    }
}

/// A refinement of a run that is farther off than the target: what the run reached, it reached by errors that cancel.
fn lost(view: &View, q: usize, run: usize, target: f64) -> Option<usize> {
    let own = own_error(view, q).unwrap_or(0.0);
    let error = |i: usize| view.error(i, q).unwrap_or(0.0);
    let mut finer = view.refinements(run).into_iter();
    finer.find(|&i| error(i) - own > target)
}

/// How many runs reach a target by errors that cancel, in words.
fn cancelling(view: &View, q: usize, runs: &[usize], targets: &[f64]) -> Option<String> {
    let own = own_error(view, q).unwrap_or(0.0);
    let error = |i: usize| view.error(i, q).unwrap_or(f64::INFINITY);
    let by_chance =
        |i: usize| (targets.iter()).any(|&t| error(i) + own <= t && lost(view, q, i, t).is_some());
    match runs.iter().filter(|&&i| by_chance(i)).count() {
        0 => None,
        1 => Some(
            "One run that reaches a target is not counted for it: refined, it is farther off, so that its errors \
             cancel by chance."
                .to_owned(),
        ),
        n => Some(format!(
            "{n} runs that reach a target are not counted for it: refined, they are farther off, so that their errors \
             cancel by chance."
        )),
    }
}

/// The choice whose series differ most in what the targets cost. A series that never reaches a target counts as twice its
/// most costly run: that much has been tried.
fn separating(view: &View, q: usize, runs: &[usize], targets: &[f64]) -> Option<usize> {
    let wall = |i: usize| view.wall(i).map_or(0.0, |w| w.median);
    let mut best: Option<(f64, usize)> = None;
    for &c in &view.varying {
        let series = by_series(view, c, runs);
        if series.len() < 2 {
            continue;
        }
        let mut sum = 0.0;
        for &target in targets {
            let Reach::At(cheapest) = reach(view, q, runs, target) else {
                continue;
            };
            let cost = |runs: &[usize]| match reach(view, q, runs, target) {
                Reach::At(i) => wall(i),
                _ => 2.0 * runs.iter().map(|&i| wall(i)).fold(0.0, f64::max),
            };
            let most = series.iter().map(|s| cost(&s.1)).fold(0.0, f64::max);
            sum += (most / wall(cheapest)).max(1.0).ln();
        }
        // The first of equals stays.
        if best.is_none_or(|b| sum > b.0 * (1.0 + 1e-9)) {
            best = Some((sum, c));
        }
    }
    best.map(|b| b.1)
}

fn time(view: &View, run: usize) -> String {
    view.wall(run).map_or(String::new(), |w| seconds(w.median))
}

fn all(targets: &[f64]) -> String {
    listed(&targets.iter().map(|t| percent(*t)).collect::<Vec<_>>())
}
