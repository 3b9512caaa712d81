//! Energy along an increment.

/// A convex, piecewise quadratic energy along a line: `slope s + curvature s^2 / 2`, and for each point half of its weight
/// times the square of its gap where that is negative.
#[derive(Debug, Clone, Default)]
pub struct Line {
    pub(super) slope: f64,
    pub(super) curvature: f64,
    /// Weight, gap and its derivative.
    pub(super) points: Vec<[f64; 3]>,
}

impl Line {
    /// Change of the energy from the start of the line.
    pub fn change(&self, s: f64) -> f64 {
        let smooth = s * (self.slope + 0.5 * s * self.curvature);
        let of =
            |[w, g, d]: &[f64; 3]| 0.5 * w * ((g + s * d).min(0.0).powi(2) - g.min(0.0).powi(2));
        smooth + self.points.iter().map(of).sum::<f64>()
    }

    /// Derivative of the energy.
    pub fn derivative(&self, s: f64) -> f64 {
        let of = |[w, g, d]: &[f64; 3]| w * d * (g + s * d).min(0.0);
        self.slope + s * self.curvature + self.points.iter().map(of).sum::<f64>()
    }

    /// Where the energy is least, up to 1.
    pub fn least(&self) -> f64 {
        let (mut low, mut high) = (0.0, 1.0);
        if self.derivative(high) <= 0.0 {
            return high;
        }
        // The derivative never falls.
        for _ in 0..60 {
            let middle = 0.5 * (low + high);
            match self.derivative(middle) <= 0.0 {
                true => low = middle,
                false => high = middle,
            }
        }
        0.5 * (low + high)
    }
}
