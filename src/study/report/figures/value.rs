//! Quantities without errors: force noise, and values that are compared with nothing.
use super::super::axis::{Axis, Form};
use super::super::bars::{Bars, Row, Shape};
use super::super::legend;
use super::super::plot::{Path, Plot};
use super::super::view::View;
use super::error::levels;
use super::{Figure, joined, point, series_of, title, without};
use crate::page::markup::slug;
use crate::page::number::{digits, percent};

/// Bars beyond these many are left out.
pub(super) const ROWS: usize = 48;

pub(super) fn figures(view: &View, q: usize, out: &mut Vec<Figure>) {
    let done = view.done();
    let with: Vec<usize> = (done.iter().copied())
        .filter(|&i| view.value(i, q).is_some())
        .collect();
    if with.is_empty() {
        return;
    }
    let missing = done.len() - with.len();
    let before = out.len();
    for c in view.sized() {
        out.extend(against_size(view, q, c, &with, missing));
    }
    if out.len() == before {
        out.push(bars(view, q, &with, missing));
    }
}

fn said(view: &View, q: usize, value: f64) -> String {
    let quantity = &view.record.quantities[q];
    if quantity.swing {
        percent(value)
    } else {
        format!("{} {}", digits(value, 4), quantity.unit)
            .trim_end()
            .to_string()
    }
}

fn label(view: &View, q: usize) -> String {
    let quantity = &view.record.quantities[q];
    match (quantity.swing, quantity.unit.as_str()) {
        (true, _) => format!("{}: peak to peak, relative to the mean", quantity.name),
        (_, "") => quantity.name.clone(),
        (_, unit) => format!("{} ({unit})", quantity.name),
    }
}

fn against_size(
    view: &View,
    q: usize,
    choice: usize,
    with: &[usize],
    missing: usize,
) -> Option<Figure> {
    let quantity = &view.record.quantities[q];
    let value = |i: usize| view.value(i, q);
    let runs: Vec<usize> = (with.iter().copied())
        .filter(|&i| view.size(i, choice).is_some())
        .collect();
    if runs.len() < 2 {
        return None;
    }
    let over = view.size_meaning(choice);
    let values = || {
        let shown = with.iter().filter(|&&i| view.label(i, choice).is_some());
        shown.filter_map(|&i| value(i))
    };
    let form = if quantity.swing {
        Form::Percent
    } else {
        Form::Plain
    };
    let log = quantity.swing && values().any(|v| v > 0.0);
    let mut plot = Plot {
        title: format!(
            "{} against {over}: {}",
            if quantity.swing { "Noise" } else { "Value" },
            quantity.name
        ),
        x: Axis::log(
            runs.iter().filter_map(|&i| view.size(i, choice)),
            Form::Plain,
        ),
        x_label: over,
        y: if log {
            Axis::log(values(), form)
        } else {
            Axis::linear(values(), false, form)
        },
        y_label: label(view, q),
        points: Vec::new(),
        paths: Vec::new(),
        band: None,
        front: Vec::new(),
        legend: Vec::new(),
    };
    let levels = levels(view, choice, with, value, &mut plot);
    for line in view.lines(choice) {
        let points = (line.runs.iter())
            .filter_map(|&i| Some([view.size(i, choice)?, value(i)?]))
            .collect();
        plot.paths.push(Path {
            points,
            colour: view.series[line.series].style.colour,
            kind: joined(&line),
            title: view.series[line.series].name.clone(),
            run: None,
        });
    }
    for &i in &runs {
        let (Some(x), Some(y)) = (view.size(i, choice), value(i)) else {
            continue;
        };
        let mut point = point(view, i, [x, y], title(view, i, &said(view, q, y)));
        point.open = log && y <= 0.0;
        plot.points.push(point);
    }
    plot.legend = legend::series(view, &series_of(view, runs.iter().copied()), |_| None);
    plot.legend.extend(levels);
    let noise = if quantity.swing {
        " Less is smoother."
    } else {
        ""
    };
    Some(Figure {
        file: slug(&view.record.choices[choice]),
        caption: format!("Finer to the left.{noise}{}", without(missing, "value")),
        svg: plot.draw(),
        quantity: None,
    })
}

fn bars(view: &View, q: usize, with: &[usize], missing: usize) -> Figure {
    let quantity = &view.record.quantities[q];
    let (shown, cut) = some_of(with, |i| view.value(i, q).unwrap_or(0.0));
    let values = || shown.iter().filter_map(|&i| view.value(i, q));
    let form = if quantity.swing {
        Form::Percent
    } else {
        Form::Plain
    };
    let rows = (shown.iter())
        .map(|&run| {
            let value = view.value(run, q).unwrap_or(0.0);
            let words = said(view, q, value);
            Row {
                run,
                name: view.name(run),
                style: view.style(run),
                title: title(view, run, &words),
                shape: Shape::Most(value, None),
                value: words,
            }
        })
        .collect();
    let bars = Bars {
        title: quantity.name.clone(),
        axis: Axis::linear(values(), true, form),
        axis_label: label(view, q),
        rows,
        legend: Vec::new(),
    };
    Figure {
        file: "runs".into(),
        caption: format!(
            "{}{}{}",
            if quantity.swing {
                "Less is smoother."
            } else {
                "It is compared with nothing."
            },
            without(missing, "value"),
            cut
        ),
        svg: bars.draw(),
        quantity: None,
    }
}

/// As many runs as bars have room for, evenly from the least to the most, and how that is said.
pub(super) fn some_of(runs: &[usize], of: impl Fn(usize) -> f64) -> (Vec<usize>, String) {
    if runs.len() <= ROWS {
        return (runs.to_vec(), String::new());
    }
    let mut sorted = runs.to_vec();
    sorted.sort_by(|&a, &b| of(a).total_cmp(&of(b)));
    let shown = (0..ROWS)
        .map(|k| sorted[k * (sorted.len() - 1) / (ROWS - 1)])
        .collect();
    let said = format!(
        " {ROWS} of {} runs, evenly from the least to the most; the table has all.",
        runs.len()
    );
    (shown, said)
}
