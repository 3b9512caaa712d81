//! Rates of convergence: straight lines through logarithms.

/// A power law fitted to points.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Rate {
    /// Exponent p of y = C x^p.
    pub exponent: f64,
    /// Coefficient of determination of the straight line through the logarithms.
    pub r_squared: f64,
    /// Points that the fit is made of.
    pub points: usize,
}

/// No method here converges faster: a steeper slope is that of an error which is about to change its sign.
const STEEPEST: f64 = 6.0;

impl Rate {
    /// The points lie so near a line that the exponent means something.
    pub fn is_clear(&self) -> bool {
        self.r_squared >= 0.98 && self.exponent.abs() <= STEEPEST
    }
}

/// Fits y = C x^p by least squares of the logarithms. None with fewer than three different x; points that have no
/// logarithm are left out.
pub fn rate(points: &[(f64, f64)]) -> Option<Rate> {
    let usable = |v: f64| v.is_finite() && v > 0.0;
    let logs: Vec<(f64, f64)> = points
        .iter()
        .filter(|p| usable(p.0) && usable(p.1))
        .map(|p| (p.0.ln(), p.1.ln()))
        .collect();
    let mut different: Vec<f64> = logs.iter().map(|p| p.0).collect();
    different.sort_by(f64::total_cmp);
    different.dedup_by(|a, b| (*a - *b).abs() < 1e-6);
    if different.len() < 3 {
        return None;
    }
    let n = logs.len() as f64;
    let (mx, my) = (
        logs.iter().map(|p| p.0).sum::<f64>() / n,
        logs.iter().map(|p| p.1).sum::<f64>() / n,
    );
    let sxx: f64 = logs.iter().map(|p| (p.0 - mx).powi(2)).sum();
    let sxy: f64 = logs.iter().map(|p| (p.0 - mx) * (p.1 - my)).sum();
    let syy: f64 = logs.iter().map(|p| (p.1 - my).powi(2)).sum();
    // A level line is fitted perfectly by the exponent zero.
    let r_squared = if syy > 1e-20 {
        sxy * sxy / (sxx * syy)
    } else {
        1.0
    };
    Some(Rate {
        exponent: sxy / sxx,
        r_squared,
        points: logs.len(),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_power_law_is_found() {
        let points: Vec<(f64, f64)> = [1.0, 0.5, 0.25, 0.125]
            .iter()
            .map(|&h: &f64| (h, 0.3 * h.powf(1.9)))
            .collect();
        let fit = rate(&points).unwrap();
        assert!((fit.exponent - 1.9).abs() < 1e-12);
        assert!((fit.r_squared - 1.0).abs() < 1e-12);
        assert_eq!(fit.points, 4);
    }

    #[test]
    fn least_squares_of_known_scatter() {
        // Logarithms (0, 0), (1, 1), (2, 0): level, and nothing of the scatter explained.
        let e = std::f64::consts::E;
        let fit = rate(&[(1.0, 1.0), (e, e), (e * e, 1.0)]).unwrap();
        assert!(fit.exponent.abs() < 1e-12 && fit.r_squared < 1e-12);
        assert!(!fit.is_clear());
        // An error that changes its sign beyond the last point.
        let crossing = rate(&[(4.0, 1.0), (2.0, 1e-3), (1.0, 1e-6)]).unwrap();
        assert!(crossing.r_squared > 0.99 && !crossing.is_clear());
    }

    #[test]
    fn too_few_points_have_no_rate() {
        assert!(rate(&[(1.0, 1.0), (0.5, 0.25)]).is_none());
        assert!(rate(&[(1.0, 1.0), (0.5, 0.25), (0.5, 0.2)]).is_none());
        assert!(rate(&[(1.0, 1.0), (0.5, 0.25), (0.25, 0.0), (0.1, f64::NAN)]).is_none());
    }
}
