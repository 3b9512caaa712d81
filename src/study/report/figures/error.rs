//! Error against time, dofs and sizes.
use super::super::axis::{Axis, Form};
use super::super::front::pareto;
use super::super::legend::{self, Entry, Sign};
use super::super::plot::{Kind, Path, Plot};
use super::super::rates::{error_rate, own_error};
use super::super::view::{Line, View};
use super::{Figure, band_text, joined, point, series_of, title, without};
use crate::page::markup::slug;
use crate::page::number::{digits, percent, several};

pub(super) fn figures(view: &View, q: usize, out: &mut Vec<Figure>) {
    let done = view.done();
    let with: Vec<usize> = done
        .iter()
        .copied()
        .filter(|&i| view.error(i, q).is_some())
        .collect();
    if with.is_empty() {
        return;
    }
    let missing = done.len() - with.len();
    out.extend(against_time(view, q, &with, missing));
    out.extend(against_dofs(view, q, &with, missing));
    for c in view.sized() {
        out.extend(against_size(view, q, c, &with, missing));
    }
}

/// The plot without what depends on x.
fn plot(view: &View, q: usize, over: &str, x: Axis, x_label: &str, runs: &[usize]) -> Plot {
    let name = &view.record.quantities[q].name;
    let errors = || runs.iter().filter_map(|&i| view.error(i, q));
    let least = errors().filter(|e| *e > 0.0).fold(f64::INFINITY, f64::min);
    let own = own_error(view, q).filter(|own| *own > 0.0 && *own >= least / 5.0);
    Plot {
        title: format!("Error against {over}: {name}"),
        x,
        x_label: x_label.to_string(),
        y: Axis::log(errors().chain(own), Form::Percent),
        y_label: format!("relative error of {name}"),
        points: Vec::new(),
        paths: Vec::new(),
        band: own,
        front: Vec::new(),
        legend: Vec::new(),
    }
}

/// What is said about the reference and about runs that are not where they belong.
fn notes(view: &View, q: usize, plot: &Plot, runs: &[usize], missing: usize) -> String {
    let mut out = match (own_error(view, q), plot.band) {
        (Some(own), None) if own > 0.0 => {
            format!(" The reference's own error, {}, lies below.", percent(own))
        }
        (None, _) => " The reference's own error is not known.".to_string(),
        _ => String::new(),
    };
    let exact = runs.iter().filter(|&&i| view.error(i, q) == Some(0.0));
    match exact.count() {
        0 => {}
        n => out.push_str(&format!(
            " {} of error zero: open, at the lower edge.",
            several(n, "run")
        )),
    }
    out + &without(missing, "error")
}

/// Points, lines that join them, and the entries of the legend.
fn fill(
    view: &View,
    q: usize,
    plot: &mut Plot,
    runs: &[usize],
    lines: &[Line],
    x: impl Fn(usize) -> Option<f64>,
) {
    for line in lines {
        let points: Vec<[f64; 2]> = line
            .runs
            .iter()
            .filter_map(|&i| Some([x(i)?, view.error(i, q)?]))
            .collect();
        plot.paths.push(Path {
            points,
            colour: view.series[line.series].style.colour,
            kind: joined(line),
            title: view.series[line.series].name.clone(),
            run: None,
        });
    }
    for &i in runs {
        let (Some(at), Some(error)) = (x(i), view.error(i, q)) else {
            continue;
        };
        let said = title(view, i, &format!("error {}", percent(error)));
        let mut point = point(view, i, [at, error], said);
        point.open = error == 0.0;
        plot.points.push(point);
    }
}

fn band_entry(plot: &mut Plot) {
    if let Some(own) = plot.band {
        plot.legend.push(Entry::new(Sign::Band, band_text(own)));
    }
}

fn against_time(view: &View, q: usize, with: &[usize], missing: usize) -> Option<Figure> {
    let runs: Vec<usize> = (with.iter().copied())
        .filter(|&i| view.wall(i).is_some())
        .collect();
    let missing = missing + with.len() - runs.len();
    let time = |i: usize| view.wall(i).map(|w| w.median);
    if runs.is_empty() {
        return None;
    }
    let spreads = (runs.iter()).filter_map(|&i| view.wall(i));
    let x = Axis::log(
        spreads.flat_map(|w| [w.median, w.least, w.most]),
        Form::Plain,
    );
    let mut plot = plot(view, q, "time", x, "elapsed time of a run (s)", &runs);
    fill(view, q, &mut plot, &runs, &view.lines_along(time), time);
    let mut repeated = false;
    for point in &mut plot.points {
        point.spread = view
            .wall(point.run)
            .filter(|w| w.repeats > 1)
            .map(|w| [w.least, w.most]);
        repeated |= point.spread.is_some();
    }
    let costs: Vec<(f64, f64)> = runs
        .iter()
        .map(|&i| {
            (
                time(i).unwrap_or(f64::NAN),
                view.error(i, q).unwrap_or(f64::NAN),
            )
        })
        .collect();
    plot.front = pareto(&costs)
        .into_iter()
        .map(|k| [costs[k].0, costs[k].1])
        .collect();
    plot.legend = legend::series(view, &series_of(view, runs.iter().copied()), |_| None);
    plot.legend.push(Entry::new(Sign::Front, "Pareto front"));
    if repeated {
        plot.legend
            .push(Entry::new(Sign::Bar, "least to most of repeats"));
    }
    band_entry(&mut plot);
    let caption = format!(
        "Left is faster, down is more accurate. No run is both faster and more accurate than one of the Pareto front.{}",
        notes(view, q, &plot, &runs, missing)
    );
    Some(Figure {
        file: "error-time".into(),
        caption,
        svg: plot.draw(),
        quantity: None,
    })
}

fn against_dofs(view: &View, q: usize, runs: &[usize], missing: usize) -> Option<Figure> {
    let dofs = |i: usize| Some(view.run(i).dofs as f64).filter(|d| *d > 0.0);
    let mut different: Vec<usize> = runs.iter().map(|&i| view.run(i).dofs).collect();
    different.sort_unstable();
    different.dedup();
    if different.len() < 2 {
        return None;
    }
    let x = Axis::log(runs.iter().filter_map(|&i| dofs(i)), Form::Plain);
    let mut plot = plot(view, q, "dofs", x, "degrees of freedom", runs);
    let lines = view.lines_along(dofs);
    fill(view, q, &mut plot, runs, &lines, dofs);
    let slope = |s: usize| {
        let line = lines.iter().find(|l| l.series == s && l.finest)?;
        let rate = error_rate(view, line, q, dofs).filter(|r| r.is_clear())?;
        Some(format!("slope {}", digits(rate.exponent, 2)))
    };
    plot.legend = legend::series(view, &series_of(view, runs.iter().copied()), slope);
    band_entry(&mut plot);
    let caption = format!(
        "Slopes are fitted where three runs or more lie near a line, without errors within three times the reference's \
         own.{}",
        notes(view, q, &plot, runs, missing)
    );
    Some(Figure {
        file: "error-dofs".into(),
        caption,
        svg: plot.draw(),
        quantity: None,
    })
}

fn against_size(
    view: &View,
    q: usize,
    choice: usize,
    with: &[usize],
    missing: usize,
) -> Option<Figure> {
    let size = |i: usize| view.size(i, choice);
    let lines = view.lines(choice);
    let runs: Vec<usize> = (with.iter().copied())
        .filter(|&i| size(i).is_some())
        .collect();
    if runs.len() < 2 {
        return None;
    }
    let x = Axis::log(runs.iter().filter_map(|&i| size(i)), Form::Plain);
    let over = view.size_meaning(choice);
    let shown: Vec<usize> = (with.iter().copied())
        .filter(|&i| view.label(i, choice).is_some())
        .collect();
    let mut plot = plot(view, q, &over, x, &over, &shown);
    let levels = levels(view, choice, &shown, |i| view.error(i, q), &mut plot);
    fill(view, q, &mut plot, &runs, &lines, size);
    let order = |s: usize| {
        let line = lines.iter().find(|l| l.series == s && l.finest)?;
        let rate = error_rate(view, line, q, size).filter(|r| r.is_clear())?;
        Some(format!("order {}", digits(rate.exponent, 2)))
    };
    plot.legend = legend::series(view, &series_of(view, runs.iter().copied()), order);
    plot.legend.extend(levels);
    band_entry(&mut plot);
    let caption = format!(
        "Finer to the left. Orders are fitted where three runs or more lie near a line{}.{}",
        if lines.iter().all(|l| l.finest) {
            ""
        } else {
            ", along the line that is finest in everything else"
        },
        notes(view, q, &plot, &shown, missing)
    );
    Some(Figure {
        file: format!("error-{}", slug(&view.record.choices[choice])),
        caption,
        svg: plot.draw(),
        quantity: None,
    })
}

/// Runs that have no size in a choice of which others have: a line from side to side. Of a series the run that is finest in
/// everything else.
pub(super) fn levels(
    view: &View,
    choice: usize,
    runs: &[usize],
    y: impl Fn(usize) -> Option<f64>,
    plot: &mut Plot,
) -> Vec<Entry> {
    let mut entries = Vec::new();
    let fineness = |i: usize| -> f64 {
        view.sized()
            .into_iter()
            .filter_map(|c| view.size(i, c))
            .map(f64::ln)
            .sum()
    };
    for (s, series) in view.series.iter().enumerate() {
        let finest = (runs.iter().copied())
            .filter(|&i| view.of_run[i] == Some(s))
            .filter(|&i| view.label(i, choice).is_some_and(|l| l.size.is_none()))
            .filter(|&i| y(i).is_some_and(|v| v > 0.0))
            .min_by(|&a, &b| fineness(a).total_cmp(&fineness(b)));
        let Some(i) = finest else { continue };
        let Some(value) = y(i) else { continue };
        plot.paths.push(Path {
            points: vec![[plot.x.low, value], [plot.x.high, value]],
            colour: series.style.colour,
            kind: Kind::Level,
            title: view.name(i),
            run: Some(i),
        });
        let sign = Sign::Level(series.style);
        let text = match &view.factors {
            None => format!("{}, for comparison", view.name(i)),
            Some(factors) => format!("{}, for comparison", factors.colours[series.style.colour]),
        };
        if !entries.iter().any(|e: &Entry| e.text == text) {
            entries.push(Entry::new(sign, text));
        }
    }
    // As many as can be told apart.
    if entries.len() > 8 {
        let rest = entries.len() - 8;
        entries.truncate(8);
        entries.push(Entry::new(
            Sign::None,
            format!("and {rest} more for comparison"),
        ));
    }
    entries
}
