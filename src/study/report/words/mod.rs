//! What a study found, in sentences: computed from the record, and only what its data justify.
mod cost;
mod failure;
mod gain;
mod noise;
mod order;

use super::view::View;
use crate::study::record::{Record, Spread};

/// Sentences about one thing. A power stands after `^`; names of columns stand between backquotes.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Section {
    /// What they are about.
    pub title: String,
    /// The sentences, in their order.
    pub sentences: Vec<String>,
}

/// All that the record lets one say; sections without a sentence are left out.
pub fn sections(record: &Record) -> Vec<Section> {
    of_view(&View::new(record))
}

pub(crate) fn of_view(view: &View) -> Vec<Section> {
    let section = |title: String, sentences| Section { title, sentences };
    let mut out = Vec::new();
    let quantities = &view.record.quantities;
    let first = quantities.iter().position(|q| q.reference.is_some());
    if let Some(q) = first {
        out.push(section(
            format!("What accuracy costs: {}", quantities[q].name),
            cost::sentences(view, q),
        ));
    }
    out.push(section("What gains".into(), gain::sentences(view)));
    let orders = (0..quantities.len())
        .filter(|&q| quantities[q].reference.is_some())
        .take(3)
        .flat_map(|q| order::sentences(view, q))
        .collect();
    out.push(section("Rates".into(), orders));
    let noise = (0..quantities.len())
        .filter(|&q| quantities[q].swing)
        .flat_map(|q| noise::sentences(view, q))
        .collect();
    out.push(section("Noise".into(), noise));
    out.push(section(
        "What did not get through".into(),
        failure::sentences(view),
    ));
    out.retain(|s| !s.sentences.is_empty());
    out
}

/// Of fewer repeats nobody can tell a time from chance.
const REPEATS: u32 = 3;

/// The times were repeated often enough, and every one of the first is less than every one of the second.
fn surely_less(a: &Spread, b: &Spread) -> bool {
    a.repeats.min(b.repeats) >= REPEATS && a.most < b.least
}

/// Repeats of both are known and overlap.
fn overlap(a: &Spread, b: &Spread) -> bool {
    a.repeats > 1 && b.repeats > 1 && a.least <= b.most && b.least <= a.most
}

/// Runs by the series of one choice, in the order of the study; series without a name are left out.
fn by_series<'a>(view: &View<'a>, choice: usize, runs: &[usize]) -> Vec<(&'a str, Vec<usize>)> {
    let mut out: Vec<(&str, Vec<usize>)> = Vec::new();
    for &i in runs {
        let Some(label) = view.label(i, choice) else {
            continue;
        };
        match out.iter_mut().find(|s| s.0 == label.series) {
            Some(s) => s.1.push(i),
            None => out.push((&label.series, vec![i])),
        }
    }
    out
}
