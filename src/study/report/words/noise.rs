//! How much a quantity that should be smooth swings.
use super::super::view::View;
use crate::page::number::{listed, percent};

/// Labels that a sentence names one by one.
const NAMED: usize = 6;

pub(super) fn sentences(view: &View, q: usize) -> Vec<String> {
    let name = &view.record.quantities[q].name;
    let subject = match name.chars().next() {
        Some(c) if c.is_lowercase() => format!("The {name}"),
        _ => name.clone(),
    };
    let runs: Vec<usize> = (view.done().into_iter())
        .filter(|&i| view.value(i, q).is_some_and(|v| v >= 0.0))
        .collect();
    if runs.is_empty() {
        return Vec::new();
    }
    let Some(c) = separating(view, q, &runs) else {
        return vec![format!("{subject} is {}.", range(view, q, &runs))];
    };
    let mut groups = by_text(view, c, &runs);
    if groups.len() > NAMED {
        groups = (super::by_series(view, c, &runs).into_iter())
            .map(|(series, runs)| (view.say(c, series), runs))
            .collect();
    }
    let median = |runs: &Vec<usize>| {
        let mut values: Vec<f64> = runs.iter().filter_map(|&i| view.value(i, q)).collect();
        values.sort_by(f64::total_cmp);
        values[values.len() / 2]
    };
    groups.sort_by(|a, b| median(&a.1).total_cmp(&median(&b.1)));
    let more = groups.len().saturating_sub(2 * NAMED);
    groups.truncate(2 * NAMED);
    let mut parts: Vec<String> = (groups.iter())
        .map(|(text, runs)| format!("{} with {text}", range(view, q, runs)))
        .collect();
    if more > 0 {
        parts.push(format!("more with {more} others"));
    }
    vec![format!("{subject} is {}.", listed(&parts))]
}

fn range(view: &View, q: usize, runs: &[usize]) -> String {
    let values = || runs.iter().filter_map(|&i| view.value(i, q));
    let low = percent(values().fold(f64::INFINITY, f64::min));
    let high = percent(values().fold(0.0, f64::max));
    if low == high {
        low
    } else {
        format!("{} to {high}", low.trim_end_matches(" %"))
    }
}

/// Runs by what they say of a choice, commas left out.
fn by_text(view: &View, choice: usize, runs: &[usize]) -> Vec<(String, Vec<usize>)> {
    let mut out: Vec<(String, Vec<usize>)> = Vec::new();
    for &i in runs {
        let Some(label) = view.label(i, choice) else {
            continue;
        };
        let text = view.say(choice, &label.text).replace(", ", " ");
        match out.iter_mut().find(|g| g.0 == text) {
            Some(g) => g.1.push(i),
            None => out.push((text, vec![i])),
        }
    }
    out
}

/// The choice whose values explain most of the scatter of logarithms.
fn separating(view: &View, q: usize, runs: &[usize]) -> Option<usize> {
    let log = |i: usize| view.value(i, q).map_or(0.0, |v| v.max(1e-12).ln());
    let scatter = |runs: &[usize]| {
        let mean = runs.iter().map(|&i| log(i)).sum::<f64>() / runs.len() as f64;
        runs.iter().map(|&i| (log(i) - mean).powi(2)).sum::<f64>()
    };
    let mut best: Option<(f64, usize)> = None;
    for &c in &view.varying {
        let groups = by_text(view, c, runs);
        if groups.len() < 2 {
            continue;
        }
        let within: f64 = groups.iter().map(|g| scatter(&g.1)).sum();
        if best.is_none_or(|b| within < b.0 * (1.0 - 1e-9)) {
            best = Some((within, c));
        }
    }
    best.map(|b| b.1)
}
