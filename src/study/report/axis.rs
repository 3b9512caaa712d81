//! Scales of plots and their ticks.
use crate::page::number::{digits, superscript};

/// How ticks are written.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Form {
    Plain,
    /// The number is relative, the tick in percent.
    Percent,
}

/// A scale: values from `low` to `high` go to 0 to 1.
#[derive(Debug, Clone)]
pub(crate) struct Axis {
    pub log: bool,
    pub low: f64,
    pub high: f64,
    /// Values with their labels; grid lines without are thinner.
    pub ticks: Vec<(f64, Option<String>)>,
}

impl Axis {
    /// A logarithmic scale around all positive finite values; from 0.1 to 1 where there are none.
    pub fn log(values: impl Iterator<Item = f64>, form: Form) -> Axis {
        // Far beyond what a run gives, and far enough from overflow for the arithmetic of ticks.
        let usable = |v: &f64| v.is_finite() && *v > 1e-280 && *v < 1e280;
        let (mut low, mut high) = bounds(values.filter(usable)).unwrap_or((0.1, 1.0));
        let pad = (high / low).powf(0.06).max(1.15);
        (low, high) = (low / pad, high * pad);
        if high / low < 4.0 {
            let widen = (4.0 * low / high).sqrt();
            (low, high) = (low / widen, high * widen);
        }
        let mut axis = Axis {
            log: true,
            low,
            high,
            ticks: Vec::new(),
        };
        axis.log_ticks(form);
        axis
    }

    /// A linear scale around all finite values; `zero` is on it when asked for.
    pub fn linear(values: impl Iterator<Item = f64>, zero: bool, form: Form) -> Axis {
        let usable = |v: &f64| v.is_finite() && v.abs() < 1e280;
        let (mut low, mut high) = bounds(values.filter(usable)).unwrap_or((0.0, 1.0));
        if zero {
            (low, high) = (low.min(0.0), high.max(0.0));
        }
        let mut span = high - low;
        if span <= 1e-9 * high.abs().max(low.abs()) || span < 1e-290 {
            span = if high == 0.0 { 1.0 } else { 0.2 * high.abs() };
            high += 0.5 * span;
            if !(zero && low == 0.0) {
                low -= 0.5 * span;
            }
        }
        let pad = 0.04 * (high - low);
        if !(zero && high == 0.0) {
            high += pad;
        }
        if !(zero && low == 0.0) {
            low -= pad;
        }
        let mut axis = Axis {
            log: false,
            low,
            high,
            ticks: Vec::new(),
        };
        axis.linear_ticks(form);
        axis
    }

    /// Where a value lies, 0 at the low end and 1 at the high one; what is outside or has no place goes to the nearer end.
    pub fn place(&self, value: f64) -> f64 {
        let at = if self.log {
            let value = value.max(f64::MIN_POSITIVE);
            (value / self.low).ln() / (self.high / self.low).ln()
        } else {
            (value - self.low) / (self.high - self.low)
        };
        if at.is_nan() { 0.0 } else { at.clamp(0.0, 1.0) }
    }

    fn log_ticks(&mut self, form: Form) {
        let decades = (self.high / self.low).log10();
        let (first, last) = (
            self.low.log10().floor() as i32,
            self.high.log10().ceil() as i32,
        );
        let every = (decades / 7.0).ceil().max(1.0) as i32;
        let labelled: &[f64] = match decades {
            d if d <= 0.8 => &[1.0, 1.5, 2.0, 3.0, 4.0, 5.0, 6.0, 8.0],
            d if d <= 2.6 => &[1.0, 2.0, 5.0],
            _ => &[1.0],
        };
        let minor: &[f64] = if decades <= 5.0 {
            &[1.0, 1.5, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0, 9.0]
        } else {
            &[1.0]
        };
        for power in first..=last {
            for &m in minor {
                let value = m * 10f64.powi(power);
                let named = labelled.contains(&m) && power.rem_euclid(every) == 0;
                let hidden = m == 1.5 && !named;
                if hidden || value < self.low * 0.9999 || value > self.high * 1.0001 {
                    continue;
                }
                self.ticks
                    .push((value, named.then(|| power_label(m, power, form))));
            }
        }
    }

    fn linear_ticks(&mut self, form: Form) {
        let span = self.high - self.low;
        let raw = span / 5.0;
        let unit = 10f64.powf(raw.log10().floor());
        let step = [1.0, 2.0, 2.5, 5.0, 10.0]
            .into_iter()
            .map(|m| m * unit)
            .find(|s| *s >= raw * 0.999)
            .unwrap_or(10.0 * unit);
        let first = (self.low / step - 1e-9).ceil();
        for i in 0..20 {
            let value = (first + f64::from(i)) * step;
            if value > self.high + 1e-9 * step {
                break;
            }
            // As many digits as tell neighbours apart.
            let size = (self.low.abs().max(self.high.abs()) / step).log10();
            let figures = (size.ceil().max(0.0) as usize + 2).min(12);
            let value = if value.abs() < 1e-9 * step {
                0.0
            } else {
                value
            };
            let label = match form {
                Form::Plain => digits(value, figures),
                Form::Percent => format!("{} %", digits(100.0 * value, figures)),
            };
            self.ticks.push((value, Some(label)));
        }
    }
}

/// Least and greatest.
fn bounds(values: impl Iterator<Item = f64>) -> Option<(f64, f64)> {
    values.fold(None, |b, v| match b {
        None => Some((v, v)),
        Some((low, high)) => Some((low.min(v), high.max(v))),
    })
}

/// A number of one digit times a power of ten.
fn power_label(m: f64, power: i32, form: Form) -> String {
    let (power, unit) = match form {
        Form::Plain => (power, ""),
        Form::Percent => (power + 2, " %"),
    };
    let number = if (-4..=4).contains(&power) {
        digits(m * 10f64.powi(power), 2)
    } else if m == 1.0 {
        format!("10{}", superscript(power))
    } else {
        format!("{m}·10{}", superscript(power))
    };
    number + unit
}

#[cfg(test)]
mod tests {
    use super::*;

    fn labels(axis: &Axis) -> Vec<&str> {
        axis.ticks.iter().filter_map(|t| t.1.as_deref()).collect()
    }

    #[test]
    fn decades_are_labelled() {
        let axis = Axis::log([3e-4, 0.2].into_iter(), Form::Percent);
        assert_eq!(labels(&axis), ["0.1 %", "1 %", "10 %"]);
        assert!(axis.place(0.001) > 0.0 && axis.place(0.2) < 1.0);
        let axis = Axis::log([0.5, 30.0].into_iter(), Form::Plain);
        assert_eq!(labels(&axis), ["0.5", "1", "2", "5", "10", "20"]);
    }

    #[test]
    fn what_has_no_logarithm_breaks_nothing() {
        for values in [
            &[][..],
            &[0.0],
            &[f64::NAN, -1.0, f64::INFINITY],
            &[1e-300, 1e300],
            &[1.0],
            &[1e-30, 1e30],
        ] {
            for axis in [
                Axis::log(values.iter().copied(), Form::Percent),
                Axis::linear(values.iter().copied(), true, Form::Plain),
                Axis::linear(values.iter().copied(), false, Form::Percent),
            ] {
                assert!(axis.low < axis.high && axis.ticks.len() < 100);
                assert!(axis.ticks.iter().all(|t| t.0.is_finite()));
                for v in [0.0, -1.0, f64::NAN, f64::INFINITY, 1e-300, 1.0] {
                    assert!((0.0..=1.0).contains(&axis.place(v)));
                }
            }
        }
    }

    #[test]
    fn linear_ticks_are_round() {
        let axis = Axis::linear([2.0, 9.7].into_iter(), true, Form::Plain);
        assert_eq!(labels(&axis), ["0", "2.5", "5", "7.5", "10"]);
        let axis = Axis::linear([100.01, 100.03].into_iter(), false, Form::Plain);
        assert_eq!(
            labels(&axis),
            ["100.01", "100.015", "100.02", "100.025", "100.03"]
        );
    }
}
