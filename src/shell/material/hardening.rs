//! Yield stress over equivalent plastic strain.
use crate::scene::{HardeningCurve, YieldTable};
use num_dual::DualNum;

/// Yield stress (Kirchhoff) over equivalent plastic strain; never falls.
#[derive(Debug, Clone, Copy, PartialEq)]
// Few of them, and plain values: a box would make them lose `Copy`.
#[allow(clippy::large_enum_variant)]
pub enum Hardening {
    /// `initial + slope p`.
    Linear {
        /// Yield stress of the virgin material (force / length^2).
        initial: f64,
        /// Rise of the yield stress with the plastic strain (force / length^2).
        slope: f64,
    },
    /// `factor (offset + p)^exponent`.
    Swift {
        /// Yield stress where `offset + p` is 1 (force / length^2).
        factor: f64,
        /// Plastic strain that the curve begins at.
        offset: f64,
        /// Exponent of the power law.
        exponent: f64,
    },
    /// `initial + rise (1 - exp(-rate p))`.
    Voce {
        /// Yield stress of the virgin material (force / length^2).
        initial: f64,
        /// How far the yield stress rises in the end (force / length^2).
        rise: f64,
        /// How fast it does, per plastic strain.
        rate: f64,
    },
    /// Straight lines between rows, the last yield stress beyond.
    Table(YieldTable),
}

impl Hardening {
    /// Yield stress and its integral from 0 to p.
    pub(super) fn at<D: DualNum<f64> + Copy>(&self, p: D) -> (D, D) {
        match *self {
            Hardening::Linear { initial, slope } => {
                let rise = p * slope;
                (rise + initial, p * (rise * 0.5 + initial))
            }
            Hardening::Swift {
                factor,
                offset,
                exponent: n,
            } => {
                let (base, start) = (p + offset, factor * offset.powf(n + 1.0) / (n + 1.0));
                let stress = base.powf(n) * factor;
                (stress, stress * base / (n + 1.0) - start)
            }
            Hardening::Voce {
                initial,
                rise,
                rate,
            } => {
                let reached = -(p * (-rate)).exp_m1();
                let work = p * (initial + rise) - reached * (rise / rate);
                (reached * rise + initial, work)
            }
            Hardening::Table(table) => {
                let (before, [from, stress], slope) = line(&table, p.re());
                let along = p - from;
                let rise = along * slope;
                (rise + stress, along * (rise * 0.5 + stress) + before)
            }
        }
    }

    /// Slope of the yield stress.
    pub(super) fn slope(&self, p: f64) -> f64 {
        match *self {
            Hardening::Linear { slope, .. } => slope,
            Hardening::Swift {
                factor,
                offset,
                exponent: n,
            } => factor * n * (offset + p).powf(n - 1.0),
            Hardening::Voce { rise, rate, .. } => rise * rate * (-rate * p).exp(),
            Hardening::Table(table) => line(&table, p).2,
        }
    }
}

/// The line of a table that p lies on: the integral of the yield stress up to its first row, this row, and its slope.
fn line(table: &YieldTable, p: f64) -> (f64, [f64; 2], f64) {
    let mut work = 0.0;
    for rows in table.rows().windows(2) {
        let ([from, low], [to, high]) = (rows[0], rows[1]);
        if p < to {
            return (work, rows[0], (high - low) / (to - from));
        }
        work += 0.5 * (to - from) * (low + high);
    }
    let last = table.rows().last().copied().unwrap_or_default();
    (work, last, 0.0)
}

impl From<HardeningCurve> for Hardening {
    fn from(curve: HardeningCurve) -> Hardening {
        match curve {
            HardeningCurve::Linear(c) => Hardening::Linear {
                initial: c.yield_stress,
                slope: c.slope,
            },
            HardeningCurve::Swift(c) => Hardening::Swift {
                factor: c.strength,
                offset: c.offset,
                exponent: c.exponent,
            },
            HardeningCurve::Voce(c) => Hardening::Voce {
                initial: c.yield_stress,
                rise: c.rise,
                rate: c.rate,
            },
            HardeningCurve::Table(table) => Hardening::Table(table),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::j2::tests::CASES;
    use super::*;

    /// The work is the integral of the yield stress, and the slope its derivative.
    #[test]
    fn work_and_slope_belong_to_the_yield_stress() {
        use num_dual::Dual64;
        let table = YieldTable::try_from(vec![[0.0, 200.0], [0.01, 240.0], [0.1, 300.0]]).unwrap();
        for hardening in CASES.into_iter().chain([Hardening::Table(table)]) {
            assert!(hardening.at(0.0).1.abs() < 1e-15);
            for p in [0.0, 0.02, 0.7] {
                let (stress, work) = hardening.at(Dual64::from(p).derivative());
                assert!((work.eps / stress.re - 1.0).abs() < 1e-13);
                // Beyond the last row of a table the slope is nothing.
                let slope = hardening.slope(p);
                assert!((stress.eps - slope).abs() <= 1e-13 * slope.abs());
            }
        }
    }
}
