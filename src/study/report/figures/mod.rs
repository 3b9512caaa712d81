//! Which pictures a study calls for.
mod cost;
mod curves;
mod error;
mod value;

pub(crate) use cost::{per_step, phases_in_words};

use super::plot::{Kind, Point};
use super::svg::Svg;
use super::view::{Line, View};
use crate::page::markup::slug;
use crate::page::number::{count, percent, seconds};

/// A picture with its words.
pub(crate) struct Figure {
    /// Without extension.
    pub file: String,
    pub caption: String,
    pub svg: Svg,
    /// The quantity it is about; none for what all runs cost.
    pub quantity: Option<usize>,
}

/// All pictures of a study, the most important of every quantity first.
pub(crate) fn all(view: &View) -> Vec<Figure> {
    let mut out = Vec::new();
    for (q, quantity) in view.record.quantities.iter().enumerate() {
        let before = out.len();
        if quantity.reference.is_some() {
            error::figures(view, q, &mut out);
        }
        if quantity.curve {
            curves::figures(view, q, &mut out);
        } else if quantity.swing || quantity.reference.is_none() {
            value::figures(view, q, &mut out);
        }
        let name = slug(&quantity.name);
        for figure in &mut out[before..] {
            figure.file = format!("{name}-{}", figure.file);
            figure.quantity = Some(q);
        }
    }
    cost::figures(view, &mut out);
    tell_apart(&mut out);
    out
}

/// Files of the same name get numbers.
fn tell_apart(figures: &mut [Figure]) {
    for i in 1..figures.len() {
        let base = figures[i].file.clone();
        let mut number = 2;
        while figures[..i].iter().any(|f| f.file == figures[i].file) {
            figures[i].file = format!("{base}-{number}");
            number += 1;
        }
    }
}

/// What pointing at a run says.
fn title(view: &View, run: usize, more: &str) -> String {
    let wall = view
        .wall(run)
        .map_or(String::new(), |w| format!(", {}", seconds(w.median)));
    let dofs = count(view.run(run).dofs as u64);
    format!("{}: {more}{wall}, {dofs} dofs", view.name(run))
}

/// A run in a plot, without a bar.
fn point(view: &View, run: usize, at: [f64; 2], title: String) -> Point {
    Point {
        run,
        at,
        spread: None,
        style: view.style(run),
        open: false,
        title,
    }
}

/// The line that is finest in everything else stands out.
fn joined(line: &Line) -> Kind {
    if line.finest { Kind::Join } else { Kind::Thin }
}

/// Series that have a run among these, in their order.
fn series_of(view: &View, runs: impl Iterator<Item = usize>) -> Vec<usize> {
    let mut out: Vec<usize> = runs.filter_map(|i| view.of_run[i]).collect();
    out.sort_unstable();
    out.dedup();
    out
}

/// "2 runs that are done have no error."
fn without(n: usize, what: &str) -> String {
    match n {
        0 => String::new(),
        1 => format!(" 1 run that got through has no {what} and is not shown."),
        n => format!(" {n} runs that got through have no {what} and are not shown."),
    }
}

/// The shaded band in words.
fn band_text(own: f64) -> String {
    format!("the reference's own error, {}", percent(own))
}
