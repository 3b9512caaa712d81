//! Quantities that are curves, over one another.
use super::super::axis::{Axis, Form};
use super::super::legend::{Entry, Sign};
use super::super::plot::{Kind, Path, Plot};
use super::super::view::{STYLES, View};
use super::{Figure, title};
use crate::page::number::{listed, percent};
use crate::study::record::Record;

/// Points that a curve is drawn with.
const POINTS: usize = 400;
/// Curves that are closer than this part of the plot's size hide one another: about two pixels.
const COINCIDE: f64 = 0.005;

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
    // In parts of the plot's size, where curves that lie on one another are found.
    let placed: Vec<Vec<[f64; 2]>> = (curves.iter().map(|c| thinned(c)))
        .map(|c| {
            c.iter()
                .map(|p| [plot.x.place(p[0]), plot.y.place(p[1])])
                .collect()
        })
        .collect();
    for (k, (&i, curve)) in shown.iter().zip(&curves).enumerate() {
        let below: Vec<usize> = (0..k)
            .filter(|&j| lies_on(&placed[k], &placed[j]))
            .collect();
        let error = view.error(i, q).map(percent);
        let said = error.map_or("no error known".to_string(), |e| format!("error {e}"));
        let colour = view.style(i).colour;
        // The curves below show through the gaps of the dashes.
        let dashes = below.len().max(of_colour[colour]);
        of_colour[colour] = dashes + 1;
        let said = match below.is_empty() {
            true => said,
            false => {
                let names: Vec<String> = below.iter().map(|&j| view.name(shown[j])).collect();
                format!("{said}; lies on {}", listed(&names))
            }
        };
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

/// Whether every point of a curve lies as good as on another, in parts of the plot's size.
fn lies_on(points: &[[f64; 2]], curve: &[[f64; 2]]) -> bool {
    let off = |p: &[f64; 2], a: &[f64; 2], b: &[f64; 2]| {
        let [along, to] = [[b[0] - a[0], b[1] - a[1]], [p[0] - a[0], p[1] - a[1]]];
        let length = along[0].powi(2) + along[1].powi(2);
        let part = match length > 0.0 {
            true => ((to[0] * along[0] + to[1] * along[1]) / length).clamp(0.0, 1.0),
            false => 0.0,
        };
        (to[0] - part * along[0]).hypot(to[1] - part * along[1])
    };
    points
        .iter()
        .all(|p| curve.windows(2).any(|s| off(p, &s[0], &s[1]) < COINCIDE))
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn curves_that_hide_one_another() {
        let curve = |n: usize, off: f64| -> Vec<[f64; 2]> {
            let at = |k: usize| k as f64 / n as f64;
            (0..=n).map(|k| [at(k), at(k).powi(2) + off]).collect()
        };
        // However many points each has.
        assert!(lies_on(&curve(7, 0.001), &curve(50, 0.0)));
        assert!(lies_on(&curve(50, 0.001), &curve(30, 0.0)));
        assert!(!lies_on(&curve(7, 0.02), &curve(50, 0.0)));
        // A part of another lies on it, not the other way round.
        let part = curve(50, 0.0)[..20].to_vec();
        assert!(lies_on(&part, &curve(50, 0.0)) && !lies_on(&curve(50, 0.0), &part));
    }
}
