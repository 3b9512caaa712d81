//! Forward and backward substitution with the supernodal factors.
use super::factor::Factor;
use super::structure::Structure;

impl Factor {
    /// Solves with the scaled, permuted matrix in place. `below` has room for [`Structure::below`] values.
    pub fn solve(&self, structure: &Structure, x: &mut [f64], below: &mut [f64]) {
        for s in 0..structure.count() {
            let shape = structure.shape(s);
            let (lower, _) = structure.panel(s, &self.values);
            let own = &mut x[shape.begin..shape.begin + shape.columns];
            for (j, &swap) in self.swaps[shape.begin..][..shape.columns]
                .iter()
                .enumerate()
            {
                own.swap(j, swap as usize);
            }
            let sums = &mut below[..shape.below];
            sums.fill(0.0);
            for (j, column) in lower.chunks_exact(shape.height()).enumerate() {
                let value = own[j];
                subtract(&mut own[j + 1..], &column[j + 1..shape.columns], value);
                subtract(sums, &column[shape.columns..], value);
            }
            for (&row, sum) in structure.rows(s).iter().zip(sums.chunks_exact(3)) {
                let to = &mut x[3 * row as usize..][..3];
                (0..3).for_each(|c| to[c] += sum[c]);
            }
        }
        for s in (0..structure.count()).rev() {
            let shape = structure.shape(s);
            let (lower, upper) = structure.panel(s, &self.values);
            let known = &mut below[..shape.below];
            for (&row, known) in structure.rows(s).iter().zip(known.chunks_exact_mut(3)) {
                known.copy_from_slice(&x[3 * row as usize..][..3]);
            }
            let own = &mut x[shape.begin..shape.begin + shape.columns];
            if shape.below > 0 {
                for (x, row) in own.iter_mut().zip(upper.chunks_exact(shape.below)) {
                    *x -= dot(row, known);
                }
            }
            for (j, column) in lower.chunks_exact(shape.height()).enumerate().rev() {
                own[j] /= column[j];
                let value = own[j];
                subtract(&mut own[..j], &column[..j], value);
            }
        }
    }
}

/// `to -= factor * column`
fn subtract(to: &mut [f64], column: &[f64], factor: f64) {
    for (to, c) in to.iter_mut().zip(column) {
        *to -= factor * c;
    }
}

/// A sum in eight parts, which the processor can add side by side.
fn dot(a: &[f64], b: &[f64]) -> f64 {
    let mut sums = [0.0; 8];
    let (left, right) = (a.chunks_exact(8), b.chunks_exact(8));
    let rest: f64 = (left.remainder().iter().zip(right.remainder()))
        .map(|(a, b)| a * b)
        .sum();
    for (a, b) in left.zip(right) {
        for i in 0..8 {
            sums[i] += a[i] * b[i];
        }
    }
    sums.iter().sum::<f64>() + rest
}
