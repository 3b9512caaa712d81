//! Quantities that are curves, over one another.
use super::super::axis::{Axis, Form};
use super::super::legend::{Entry, Sign};
use super::super::plot::{Kind, Path, Plot};
use super::super::view::{STYLES, View};
use super::{Figure, title};
use crate::page::number::percent;
use crate::study::record::Record;

/// Points that a curve is drawn with.
const POINTS: usize = 400;

pub(super) fn figures(view: &View, q: usize, out: &mut Vec<Figure>) {
    let quantity = &view.record.quantities[q];
    let curve = |i: usize| {
        let curve = view.measured(i, q)?.curve.as_ref()?;
        let finite: Vec<[f64; 2]> = (curve.iter().copied())
            .filter(|p| p[0].is_finite() && p[1].is_finite())
            .collect();
        (finite.len() > 1).then_some(finite)
    };
    let with: Vec<usize> = (view.done().into_iter())
        .filter(|&i| curve(i).is_some())
        .collect();
    let reference = (quantity.reference.as_ref()).and_then(|r| r.curve.clone());
    if with.is_empty() {
        return;
    }
    let (shown, some) = if with.len() <= STYLES {
        (with.clone(), String::new())
    } else {
        choose(view, q, &with)
    };
    let curves: Vec<Vec<[f64; 2]>> = shown.iter().filter_map(|&i| curve(i)).collect();
    let all = || curves.iter().chain(&reference).flatten();
    let unit = if quantity.unit.is_empty() {
        String::new()
    } else {
        format!(" ({})", quantity.unit)
    };
    let mut plot = Plot {
        title: format!("Curves: {}", quantity.name),
        x: Axis::linear(all().map(|p| p[0]), false, Form::Plain),
        x_label: variable(view.record, q),
        y: Axis::linear(all().map(|p| p[1]), false, Form::Plain),
        y_label: format!("{}{unit}", quantity.name),
        points: Vec::new(),
        paths: Vec::new(),
        band: None,
        front: Vec::new(),
        legend: Vec::new(),
    };
    let mut of_colour = [0; STYLES];
    for (&i, curve) in shown.iter().zip(&curves) {
        let error = view.error(i, q).map(percent);
        let said = error.map_or("no error known".to_string(), |e| format!("error {e}"));
        let colour = view.style(i).colour;
        let dashes = of_colour[colour];
        of_colour[colour] += 1;
        plot.paths.push(Path {
            points: thinned(curve),
            colour,
            kind: Kind::Curve(dashes),
            title: title(view, i, &said),
            run: Some(i),
        });
        plot.legend.push(Entry::new(
            Sign::Curve(colour, dashes),
            format!("{} ({said})", view.name(i)),
        ));
    }
    if let Some(curve) = reference.filter(|c| c.len() > 1) {
        plot.paths.push(Path {
            points: thinned(&curve),
            colour: 0,
            kind: Kind::Reference,
            title: "reference".into(),
            run: None,
        });
        plot.legend.push(Entry::new(Sign::Reference, "reference"));
    }
    out.push(Figure {
        file: "curves".into(),
        caption: some,
        svg: plot.draw(),
        quantity: None,
    });
}

/// The best and the worst run of as many series as there are colours for.
fn choose(view: &View, q: usize, with: &[usize]) -> (Vec<usize>, String) {
    let error = |i: usize| view.error(i, q).unwrap_or(f64::INFINITY);
    let mut chosen: Vec<usize> = Vec::new();
    for worst in [false, true] {
        for s in 0..view.series.len() {
            let mut runs: Vec<usize> = (with.iter().copied())
                .filter(|&i| view.of_run[i] == Some(s) && !chosen.contains(&i))
                .collect();
            runs.sort_by(|&a, &b| error(a).total_cmp(&error(b)));
            let one = if worst { runs.last() } else { runs.first() };
            if let Some(&i) = one
                && chosen.len() < STYLES
            {
                chosen.push(i);
            }
        }
    }
    chosen.sort_unstable();
    let said = format!(
        "{} of {} runs: the best of every series, then the worst, as long as they can be told apart.",
        chosen.len(),
        with.len()
    );
    (chosen, said)
}

/// The independent variable, from the measure in words.
fn variable(record: &Record, q: usize) -> String {
    let words = &record.quantities[q].measure;
    match words.split_once("over `").and_then(|w| w.1.split_once('`')) {
        Some((name, _)) => name.to_string(),
        None => "time".to_string(),
    }
}

/// Fewer points; of every stretch the least and the greatest stay, so that peaks do.
fn thinned(curve: &[[f64; 2]]) -> Vec<[f64; 2]> {
    if curve.len() <= POINTS {
        return curve.to_vec();
    }
    let mut out = Vec::with_capacity(POINTS + 2);
    out.push(curve[0]);
    for stretch in curve.chunks(curve.len().div_ceil(POINTS / 2)) {
        let by = |k: &usize, j: &usize| stretch[*k][1].total_cmp(&stretch[*j][1]);
        let least = (0..stretch.len()).min_by(by).unwrap_or(0);
        let most = (0..stretch.len()).max_by(by).unwrap_or(0);
        out.push(stretch[least.min(most)]);
        out.push(stretch[least.max(most)]);
    }
    out.push(curve[curve.len() - 1]);
    out.dedup();
    out
}
