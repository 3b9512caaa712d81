//! How far to go along an increment, by the slope of the energy there.

/// Smallest factor of the line search.
pub(super) const SMALLEST: f64 = 1.0 / 64.0;

/// Factor that brings the slope of the energy along the increment below half of `slope`, its start, by bisection and false
/// position. `at` is the slope at a factor, none where the state is impossible: such a factor is too large.
pub(super) fn factor(slope: f64, mut at: impl FnMut(f64) -> Option<f64>) -> f64 {
    let mut low = (0.0, slope);
    let mut high: Option<(f64, f64)> = None;
    let mut s = 1.0;
    let mut best = (1.0, f64::INFINITY);
    for _ in 0..6 {
        // The slope falls from its start through zero at the minimum, and far beyond it where nothing can be.
        let g = (at(s).filter(|g| g.is_finite())).unwrap_or(f64::NEG_INFINITY * slope.signum());
        if g.abs() < best.1 {
            best = (s, g.abs());
        }
        if g.abs() <= 0.5 * slope.abs() {
            break;
        }
        if g * slope > 0.0 {
            low = (s, g);
        } else {
            high = Some((s, g));
        }
        s = match high {
            None => break,
            Some((b, gb)) if gb.is_finite() => {
                let (a, ga) = low;
                (a - ga * (b - a) / (gb - ga)).clamp(a + 0.1 * (b - a), b - 0.1 * (b - a))
            }
            Some((b, _)) => 0.5 * (low.0 + b),
        };
    }
    best.0.max(SMALLEST)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_minimum_of_an_energy_is_bracketed() {
        for sign in [1.0, -1.0] {
            // Slopes of (s - 1/4)^2, of a steep wall at 0.6, and of an energy that falls all along.
            let quadratic = factor(-0.5 * sign, |s| Some(2.0 * (s - 0.25) * sign));
            assert!((quadratic - 0.25).abs() < 0.13, "{quadratic}");
            let wall = factor(-sign, |s| Some(if s < 0.6 { -sign } else { 1e6 * sign }));
            assert!(wall < 0.6 + 1e-3, "{wall}");
            assert_eq!(factor(-sign, |_| Some(-sign)), 1.0);
        }
    }

    /// States that are impossible lie beyond the minimum, whichever sign the slope has.
    #[test]
    fn impossible_states_are_too_far() {
        for sign in [1.0, -1.0] {
            for limit in [0.9, 0.3, 0.05] {
                let at = |s: f64| (s < limit).then_some((s - 0.9 * limit) * sign);
                let found = factor(-0.9 * limit * sign, at);
                assert!(found > 0.0 && found < limit, "{found} for {limit}");
            }
            // The second is possible, the third is not again.
            let mut calls = 0;
            let found = factor(-sign, |_| {
                calls += 1;
                match calls {
                    2 => Some(3.0 * sign),
                    _ => None,
                }
            });
            assert!(found.is_finite() && found > 0.0 && found < 1.0);
            assert_eq!(factor(-sign, |_| None), 1.0);
        }
    }
}
