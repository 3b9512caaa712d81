//! What a choice gains or costs in iterations and time, with everything else equal.
use super::super::view::View;
use super::surely_less;
use crate::page::number::{digits, listed, several};

/// Two runs that differ in one choice only.
type Pair = (usize, usize);

/// Ratios of a series to the series with the least.
struct Ratio {
    name: String,
    /// Geometric mean, least, most.
    mean: f64,
    least: f64,
    most: f64,
    pairs: usize,
}

pub(super) fn sentences(view: &View) -> Vec<String> {
    let mut out = Vec::new();
    for &c in &view.varying {
        let iterations = |i: usize| Some(view.run(i).newton_iterations as f64);
        let any = |_: usize, _: usize| true;
        out.extend(equal(view, c, iterations));
        if let Some((base, ratios)) = compare(view, c, iterations, any) {
            out.extend(sentence(
                &base,
                &ratios,
                "needs",
                "the Newton iterations",
                "many",
            ));
        }
        let time = |i: usize| view.wall(i).map(|w| w.median);
        let clear = |less: usize, more: usize| match (view.wall(less), view.wall(more)) {
            (Some(a), Some(b)) => surely_less(&a, &b),
            _ => false,
        };
        if let Some((base, ratios)) = compare(view, c, time, clear) {
            out.extend(sentence(&base, &ratios, "takes", "the time", "long"));
        }
    }
    out
}

/// Ratios of all series of a choice to the least of them, where every pair of runs says the same.
fn compare(
    view: &View,
    choice: usize,
    of: impl Fn(usize) -> Option<f64>,
    clear: impl Fn(usize, usize) -> bool,
) -> Option<(String, Vec<Ratio>)> {
    let series = super::by_series(view, choice, &view.done());
    let positive = |i: usize| of(i).filter(|v| v.is_finite() && *v > 0.0);
    let pairs: Vec<Vec<Vec<Pair>>> = series
        .iter()
        .map(|a| {
            series
                .iter()
                .map(|b| paired(view, choice, &a.1, &b.1))
                .collect()
        })
        .collect();
    let mean = |pairs: &[Pair]| {
        let logs: Vec<f64> = (pairs.iter())
            .filter_map(|&(a, b)| Some((positive(b)? / positive(a)?).ln()))
            .collect();
        (!logs.is_empty()).then(|| logs.iter().sum::<f64>() / logs.len() as f64)
    };
    // The least is the one than which none is less, as far as there are pairs.
    let worst = |a: usize| {
        let others = (0..series.len()).filter(|&b| b != a);
        others.filter_map(|b| mean(&pairs[a][b])).reduce(f64::min)
    };
    let base = (0..series.len())
        .filter_map(|a| Some((a, worst(a)?)))
        .max_by(|a, b| a.1.total_cmp(&b.1).then(b.0.cmp(&a.0)))
        .map(|a| a.0)?;
    let mut ratios = Vec::new();
    for (b, of_b) in series.iter().enumerate().filter(|b| b.0 != base) {
        let pairs = &pairs[base][b];
        let all: Vec<f64> = (pairs.iter())
            .filter_map(|&(x, y)| Some(positive(y)? / positive(x)?))
            .collect();
        let Some(mean) = mean(pairs) else { continue };
        let sure = all.iter().all(|r| *r >= 1.0) && pairs.iter().all(|&(x, y)| clear(x, y));
        if !sure || mean.exp() < 1.05 {
            continue;
        }
        ratios.push(Ratio {
            name: view.say(choice, of_b.0),
            mean: mean.exp(),
            least: all.iter().copied().fold(f64::INFINITY, f64::min),
            most: all.iter().copied().fold(0.0, f64::max),
            pairs: all.len(),
        });
    }
    ratios.sort_by(|a, b| b.mean.total_cmp(&a.mean));
    Some((view.say(choice, series[base].0), ratios))
}

/// Runs of two series that agree in all other choices, and in size where both have one.
fn paired(view: &View, choice: usize, a: &[usize], b: &[usize]) -> Vec<Pair> {
    let text = |i: usize, c: usize| view.label(i, c).map(|l| l.text.as_str());
    let alike = |i: usize, j: usize| {
        let others = (0..view.record.choices.len()).filter(|&c| c != choice);
        let sizes = match (view.size(i, choice), view.size(j, choice)) {
            (Some(x), Some(y)) => (x / y - 1.0).abs() < 1e-9,
            _ => true,
        };
        sizes && others.into_iter().all(|c| text(i, c) == text(j, c))
    };
    let mut out = Vec::new();
    for &i in a {
        out.extend(
            b.iter()
                .filter(|&&j| i != j && alike(i, j))
                .map(|&j| (i, j)),
        );
    }
    out
}

/// `what` is what the series has more of, `as_much` how that is said the second time.
fn sentence(base: &str, ratios: &[Ratio], verb: &str, what: &str, as_much: &str) -> Option<String> {
    // Near one a digit more tells something from nothing.
    let figures = |ratio: f64| if ratio < 2.0 { 3 } else { 2 };
    if ratios.is_empty() || base.is_empty() {
        return None;
    }
    let parts: Vec<String> = (ratios.iter().take(4).enumerate())
        .map(|(k, r)| {
            let pairs = several(r.pairs, "pair");
            // As many for all three, so that the mean lies in the range as printed, too.
            let figures = figures(r.least);
            let [mean, least, most] = [r.mean, r.least, r.most].map(|x| digits(x, figures));
            let range = match r.pairs {
                1 => String::new(),
                _ if least == most => format!(" ({pairs})"),
                _ => format!(" ({least} to {most} in {pairs})"),
            };
            let compared = match k {
                0 => format!("{what} of {base}"),
                _ => format!("as {as_much}"),
            };
            format!("{} {verb} {mean} times {compared}{range}", r.name)
        })
        .collect();
    let more = match ratios.len().saturating_sub(4) {
        0 => String::new(),
        n => format!("; {n} more have smaller ratios"),
    };
    Some(format!(
        "With everything else equal, {}{more}.",
        parts.join("; ")
    ))
}

/// Series that take as many iterations as the first of them in every one of at least two pairs.
fn equal(view: &View, choice: usize, of: impl Fn(usize) -> Option<f64>) -> Option<String> {
    let series = super::by_series(view, choice, &view.done());
    let same = |a: &[usize], b: &[usize]| {
        let pairs = paired(view, choice, a, b);
        let all = pairs.iter().all(|&(i, j)| of(i) == of(j));
        (all && pairs.len() > 1).then_some(pairs.len())
    };
    let mut groups: Vec<String> = Vec::new();
    let mut named = vec![false; series.len()];
    for (k, (name, runs)) in series.iter().enumerate() {
        if named[k] {
            continue;
        }
        let mut names = vec![view.say(choice, name)];
        let mut pairs = usize::MAX;
        for (m, (other, of_other)) in series.iter().enumerate().skip(k + 1) {
            if let Some(n) = same(runs, of_other) {
                names.push(view.say(choice, other));
                pairs = pairs.min(n);
                named[m] = true;
            }
        }
        if names.len() > 1 {
            let each = if names.len() > 2 { " each" } else { "" };
            groups.push(format!("{} ({pairs} pairs{each})", listed(&names)));
        }
    }
    if groups.is_empty() {
        return None;
    }
    Some(format!(
        "With everything else equal, the same Newton iterations are needed by {}.",
        groups.join("; and by ")
    ))
}
