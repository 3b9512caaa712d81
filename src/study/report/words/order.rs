//! How fast errors fall.
use super::super::rates::error_rate;
use super::super::view::View;
use crate::page::number::{digits, listed};

/// Series that a sentence names at most.
const NAMED: usize = 6;

pub(super) fn sentences(view: &View, q: usize) -> Vec<String> {
    let name = &view.record.quantities[q].name;
    let mut out = Vec::new();
    for c in view.sized() {
        let word = view.size_word(c);
        let letter = word.as_deref().filter(|w| !w.contains(' ')).unwrap_or("h");
        let base = match letter.contains('/') {
            true => format!("({letter})"),
            false => letter.to_owned(),
        };
        let mut parts = Vec::new();
        for line in view.lines(c).iter().filter(|l| l.finest) {
            let rate = error_rate(view, line, q, |i| view.size(i, c));
            let Some(rate) = rate.filter(|r| r.is_clear() && r.exponent > 0.1) else {
                continue;
            };
            let power = digits(rate.exponent, 2);
            let with = match view.series.len() {
                1 => String::new(),
                _ => format!(" with {}", view.series[line.series].name),
            };
            parts.push(format!("as {base}^{power}{with}"));
        }
        if parts.is_empty() {
            continue;
        }
        let more = match parts.len().saturating_sub(NAMED) {
            0 => String::new(),
            n => format!("; the plots have {n} more"),
        };
        parts.truncate(NAMED);
        let meaning = match letter {
            "h" => format!(" (h: {})", view.size_meaning(c)),
            _ => String::new(),
        };
        out.push(format!(
            "The error of {name} falls {}{more}{meaning}.",
            if view.series.iter().any(|s| s.name.contains(", ")) {
                parts.join("; ")
            } else {
                listed(&parts)
            }
        ));
    }
    out
}
