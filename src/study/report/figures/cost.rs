//! What runs cost: time by phase, Newton iterations.
use super::super::axis::{Axis, Form};
use super::super::bars::{Bars, Row, Shape};
use super::super::legend::{self, Entry, Sign};
use super::super::plot::{Path, Plot};
use super::super::view::View;
use super::value::{ROWS, some_of};
use super::{Figure, joined, point, series_of, title};
use crate::page::markup::slug;
use crate::page::number::{count, digits, percent, seconds};
use crate::study::record::Ending;

/// Phases with a colour of their own; the rest has the last one.
const PHASES: usize = 8;

pub(super) fn figures(view: &View, out: &mut Vec<Figure>) {
    out.extend(phases(view));
    out.extend(iterations(view));
    for c in view.sized() {
        out.extend(iterations_against_size(view, c));
    }
}

/// Phases by the share they have in all runs, greatest first; those that nowhere reach 2 % are left to the rest.
fn great_phases(view: &View, runs: &[usize]) -> Vec<String> {
    let mut shares: Vec<(String, f64, f64)> = Vec::new();
    for &i in runs {
        let Some(wall) = view.wall(i) else { continue };
        for (name, &seconds) in &view.run(i).phases {
            let share = seconds / wall.median;
            if !share.is_finite() {
                continue;
            }
            match shares.iter_mut().find(|s| s.0 == *name) {
                Some(s) => (s.1, s.2) = (s.1 + share, s.2.max(share)),
                None => shares.push((name.clone(), share, share)),
            }
        }
    }
    shares.retain(|s| s.2 >= 0.02);
    shares.sort_by(|a, b| b.1.total_cmp(&a.1).then_with(|| a.0.cmp(&b.0)));
    shares.truncate(PHASES);
    shares.into_iter().map(|s| s.0).collect()
}

fn phases(view: &View) -> Option<Figure> {
    let timed: Vec<usize> = (view.done().into_iter())
        .filter(|&i| view.wall(i).is_some() && !view.run(i).phases.is_empty())
        .collect();
    if timed.is_empty() {
        return None;
    }
    let wall = |i: usize| view.wall(i).map_or(0.0, |w| w.median);
    let names = great_phases(view, &timed);
    let (shown, cut) = some_of(&timed, wall);
    let longest = shown.iter().map(|&i| wall(i)).fold(0.0, f64::max);
    let shortest = shown.iter().map(|&i| wall(i)).fold(f64::INFINITY, f64::min);
    // Where the bars of the fast runs could not be seen, shares are shown.
    let shares = longest > 12.0 * shortest;
    let mut rest_shown = false;
    let rows: Vec<Row> = rows_with_failed(view, shown, &cut)
        .into_iter()
        .map(|run| {
            if view.run(run).ending != Ending::Done {
                return failed(view, run);
            }
            let whole = wall(run);
            let unit = if shares { whole } else { 1.0 };
            let of = |name: &String| {
                let seconds = view.run(run).phases.get(name).copied().unwrap_or(0.0);
                if seconds.is_finite() {
                    seconds.max(0.0)
                } else {
                    0.0
                }
            };
            let mut parts: Vec<(usize, f64)> = (names.iter().enumerate())
                .map(|(p, name)| (p, of(name) / unit))
                .collect();
            let named: f64 = names.iter().map(of).sum();
            // Medians by phase may add up to a little more than the median of the whole.
            let rest = whole - named;
            if rest > 0.0 {
                parts.push((PHASES, rest / unit));
                rest_shown |= rest > 0.005 * whole;
            } else if shares {
                parts.iter_mut().for_each(|p| p.1 *= whole / named);
            }
            let told: Vec<String> = (view.run(run).phases.iter())
                .map(|(name, s)| format!("{name} {}", seconds(*s)))
                .collect();
            Row {
                run,
                name: view.name(run),
                style: view.style(run),
                shape: Shape::Stack(parts),
                value: seconds(whole),
                title: title(view, run, &told.join(", ")),
            }
        })
        .collect();
    let mut legend: Vec<Entry> = (names.iter().enumerate())
        .map(|(p, name)| Entry::new(Sign::Phase(p), name.replace('_', " ")))
        .collect();
    if rest_shown {
        legend.push(Entry::new(Sign::Phase(PHASES), "the rest"));
    }
    let (axis, axis_label, how) = if shares {
        let axis = Axis::linear([1.0].into_iter(), true, Form::Percent);
        let axis = Axis { high: 1.0, ..axis };
        (
            axis,
            "share of the elapsed time",
            "Shares, for the times are too different; the times stand behind the bars.",
        )
    } else {
        let axis = Axis::linear([longest].into_iter(), true, Form::Plain);
        (axis, "elapsed time (s)", "Medians.")
    };
    let bars = Bars {
        title: "Time by phase".into(),
        axis: Axis {
            ticks: axis
                .ticks
                .iter()
                .filter(|t| t.0 <= axis.high)
                .cloned()
                .collect(),
            ..axis
        },
        axis_label: axis_label.into(),
        rows,
        legend,
    };
    Some(Figure {
        file: "time-phases".into(),
        caption: format!("{how}{cut}"),
        svg: bars.draw(),
        quantity: None,
    })
}

/// Runs in the order of the study, with those that failed or are missing, where there is room for them.
fn rows_with_failed(view: &View, shown: Vec<usize>, cut: &str) -> Vec<usize> {
    let not_done: Vec<usize> = (0..view.record.runs.len())
        .filter(|&i| view.of_run[i].is_some() && view.run(i).ending != Ending::Done)
        .collect();
    let mut all = shown;
    if cut.is_empty() && all.len() + not_done.len() <= ROWS {
        all.extend(not_done);
        all.sort_unstable();
    }
    all
}

fn failed(view: &View, run: usize) -> Row {
    let words = match &view.run(run).ending {
        Ending::Failed(reason) => format!("failed: {reason}"),
        _ => "missing".to_string(),
    };
    Row {
        run,
        name: view.name(run),
        style: view.style(run),
        title: words.clone(),
        shape: Shape::Words(words),
        value: String::new(),
    }
}

/// Mean and most of Newton's iterations in a step.
pub(crate) fn per_step(view: &View, run: usize) -> Option<(f64, u32)> {
    let steps = &view.run(run).steps_taken;
    let sum: u64 = steps.iter().map(|s| u64::from(s.1)).sum();
    let most = steps.iter().map(|s| s.1).max()?;
    Some((sum as f64 / steps.len() as f64, most))
}

fn said(mean: f64, most: u32) -> String {
    format!("{} iterations per step, at most {most}", digits(mean, 2))
}

fn iterations(view: &View) -> Option<Figure> {
    let known: Vec<usize> = (view.done().into_iter())
        .filter(|&i| per_step(view, i).is_some())
        .collect();
    if known.is_empty() {
        return None;
    }
    let of = |i: usize| per_step(view, i).unwrap_or((0.0, 0));
    let (shown, cut) = some_of(&known, |i| of(i).0);
    let rows = (rows_with_failed(view, shown.clone(), &cut).into_iter())
        .map(|run| {
            if view.run(run).ending != Ending::Done {
                return failed(view, run);
            }
            let (mean, most) = of(run);
            Row {
                run,
                name: view.name(run),
                style: view.style(run),
                shape: Shape::Most(mean, Some(f64::from(most))),
                value: format!("{} ({most})", digits(mean, 2)),
                title: title(view, run, &said(mean, most)),
            }
        })
        .collect();
    let bars = Bars {
        title: "Newton iterations per step".into(),
        axis: Axis::linear(shown.iter().map(|&i| f64::from(of(i).1)), true, Form::Plain),
        axis_label: "iterations per accepted step".into(),
        rows,
        legend: vec![Entry::new(
            Sign::None,
            "Bars: mean of all steps. Marks: the most.",
        )],
    };
    Some(Figure {
        file: "iterations".into(),
        caption: format!("In brackets the most.{cut}"),
        svg: bars.draw(),
        quantity: None,
    })
}

fn iterations_against_size(view: &View, choice: usize) -> Option<Figure> {
    let of = |i: usize| per_step(view, i).map(|p| p.0);
    let runs: Vec<usize> = (view.done().into_iter())
        .filter(|&i| of(i).is_some() && view.label(i, choice).is_some())
        .collect();
    let sized: Vec<usize> = (runs.iter().copied())
        .filter(|&i| view.size(i, choice).is_some())
        .collect();
    if sized.len() < 2 {
        return None;
    }
    let over = view.size_meaning(choice);
    let mut plot = Plot {
        title: format!("Newton iterations per step against {over}"),
        x: Axis::log(
            sized.iter().filter_map(|&i| view.size(i, choice)),
            Form::Plain,
        ),
        x_label: over,
        y: Axis::linear(runs.iter().filter_map(|&i| of(i)), true, Form::Plain),
        y_label: "mean Newton iterations per accepted step".into(),
        points: Vec::new(),
        paths: Vec::new(),
        band: None,
        front: Vec::new(),
        legend: Vec::new(),
    };
    let levels = super::error::levels(view, choice, &runs, of, &mut plot);
    for line in view.lines(choice) {
        plot.paths.push(Path {
            points: (line.runs.iter())
                .filter_map(|&i| Some([view.size(i, choice)?, of(i)?]))
                .collect(),
            colour: view.series[line.series].style.colour,
            kind: joined(&line),
            title: view.series[line.series].name.clone(),
            run: None,
        });
    }
    for &i in &sized {
        let (Some(x), Some((mean, most))) = (view.size(i, choice), per_step(view, i)) else {
            continue;
        };
        let said = title(view, i, &said(mean, most));
        plot.points.push(point(view, i, [x, mean], said));
    }
    plot.legend = legend::series(view, &series_of(view, sized.iter().copied()), |_| None);
    plot.legend.extend(levels);
    Some(Figure {
        file: format!("iterations-{}", slug(&view.record.choices[choice])),
        caption: "Finer to the left.".into(),
        svg: plot.draw(),
        quantity: None,
    })
}

/// Phases of a run in words, for tables.
pub(crate) fn phases_in_words(view: &View, run: usize) -> String {
    let whole = view.wall(run).map_or(f64::NAN, |w| w.median);
    let mut phases: Vec<(&String, f64)> = (view.run(run).phases.iter())
        .map(|(name, &s)| (name, s))
        .collect();
    phases.sort_by(|a, b| b.1.total_cmp(&a.1));
    let said: Vec<String> = phases
        .iter()
        .take(6)
        .map(|(name, s)| {
            let share = s / whole;
            let share = if share.is_finite() {
                format!(" ({})", percent((share * 100.0).round() / 100.0))
            } else {
                String::new()
            };
            format!("{name} {}{share}", seconds(*s))
        })
        .collect();
    let more = phases.len().saturating_sub(6);
    match more {
        0 => said.join(", "),
        n => format!("{}, {} more", said.join(", "), count(n as u64)),
    }
}
