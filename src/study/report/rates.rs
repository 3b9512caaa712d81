//! Rates of convergence of the lines of a study.
use super::fit::{Rate, rate};
use super::view::{Line, View};

/// The estimate of the reference's own error, where there is one.
pub(crate) fn own_error(view: &View, quantity: usize) -> Option<f64> {
    let own = view.record.quantities[quantity].reference.as_ref()?.error?;
    (own.is_finite() && own >= 0.0).then_some(own)
}

/// Fits the error of a line's runs over `x`. Errors within three times the reference's own are left out: they tell how
/// far the run is from the reference, not from the truth.
pub(crate) fn error_rate(
    view: &View,
    line: &Line,
    quantity: usize,
    x: impl Fn(usize) -> Option<f64>,
) -> Option<Rate> {
    let floor = 3.0 * own_error(view, quantity).unwrap_or(0.0);
    let points: Vec<(f64, f64)> = line
        .runs
        .iter()
        .filter_map(|&i| Some((x(i)?, view.error(i, quantity)?)))
        .filter(|p| p.1 > floor)
        .collect();
    rate(&points)
}
