//! Newton steps of a closest point in the directions that no border holds.

/// First and second derivatives of half the squared distance at a point of a surface, and which parameters are held at a
/// border.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Downhill<'a> {
    /// `-rho_i . d`.
    pub gradient: &'a [f64; 2],
    /// Metric 11, 12, 22: the scale of what counts as nothing.
    pub metric: &'a [f64; 3],
    /// Parameters that are held.
    pub active: [bool; 2],
}

impl Downhill<'_> {
    /// Solves `F_ij step_j = -g_i` in the free directions if `f` (11, 12, 22) is safely positive definite there.
    #[inline]
    pub fn solve(&self, f: &[f64; 3]) -> Option<[f64; 2]> {
        let g = self.gradient;
        let scale = [1e-12 * self.metric[0], 1e-12 * self.metric[2]];
        match self.active {
            [true, true] => Some([0.0; 2]),
            [false, true] => (f[0] > scale[0]).then(|| [-g[0] / f[0], 0.0]),
            [true, false] => (f[2] > scale[1]).then(|| [0.0, -g[1] / f[2]]),
            [false, false] => {
                let det = f[0] * f[2] - f[1] * f[1];
                (f[0] > scale[0] && f[2] > scale[1] && det > 1e-12 * f[0] * f[2]).then(|| {
                    [
                        (f[1] * g[1] - f[2] * g[0]) / det,
                        (f[1] * g[0] - f[0] * g[1]) / det,
                    ]
                })
            }
        }
    }

    /// Each free direction by itself, with the metric alone; a direction of no length stays.
    pub fn diagonal_step(&self) -> [f64; 2] {
        let one = |k: usize| {
            let a = self.metric[2 * k];
            if self.active[k] || a <= f64::MIN_POSITIVE {
                0.0
            } else {
                -0.5 * self.gradient[k] / a
            }
        };
        [one(0), one(1)]
    }
}
