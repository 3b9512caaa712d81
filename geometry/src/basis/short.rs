//! The recursion for degrees up to 5, written so that every loop has a length known to the compiler and the functions
//! stay in registers between the levels.

/// Values and derivatives of at most six functions.
pub(crate) type Short<const K: usize> = [[f64; 6]; K];

/// What a span brings: `2 P` knots around it and the reciprocals of all levels.
struct Around<'a, const P: usize> {
    knots: &'a [f64],
    inverse: &'a [f64],
    t: f64,
}

/// As [`Basis::evaluate`](super::Basis::evaluate) for degree `P` from 1 to 5.
#[inline(always)]
pub(super) fn evaluate<const P: usize, const K: usize>(
    knots: &[f64],
    inverse: &[f64],
    t: f64,
    out: &mut Short<K>,
) {
    let around = Around::<P> {
        knots: &knots[..2 * P],
        inverse: &inverse[..P * (P + 1) / 2],
        t,
    };
    let mut n = [[0.0; 6]; K];
    n[0][0] = 1.0;
    around.level::<1, K>(&mut n);
    around.level::<2, K>(&mut n);
    around.level::<3, K>(&mut n);
    around.level::<4, K>(&mut n);
    around.level::<5, K>(&mut n);
    *out = n;
}

impl<const P: usize> Around<'_, P> {
    /// From level `Q - 1` to level `Q`; nothing above level `P`.
    #[inline(always)]
    fn level<const Q: usize, const K: usize>(&self, n: &mut Short<K>) {
        if Q > P {
            return;
        }
        let inverse = &self.inverse[Q * (Q - 1) / 2..Q * (Q + 1) / 2];
        for m in (1..K).rev() {
            if m <= Q && m + P < K + Q {
                let mut saved = 0.0;
                for r in 0..Q {
                    let scaled = n[m - 1][r] * (inverse[r] * Q as f64);
                    n[m][r] = saved - scaled;
                    saved = scaled;
                }
                n[m][Q] = saved;
            }
        }
        let mut saved = 0.0;
        for r in 0..Q {
            let scaled = n[0][r] * inverse[r];
            n[0][r] = saved + (self.knots[P + r] - self.t) * scaled;
            saved = (self.t - self.knots[P + r - Q]) * scaled;
        }
        n[0][Q] = saved;
    }
}
