//! Scaling of rows and columns, so that pivots of different units can be compared.
use super::super::{DofName, LinearError};
use crate::system::SystemMatrix;

/// Factors of rows and columns, powers of two, so that scaling rounds nothing.
#[derive(Debug, Clone, Default)]
pub(super) struct Scaling {
    pub rows: Vec<f64>,
    pub columns: Vec<f64>,
    row_maxima: Vec<f64>,
    column_maxima: Vec<f64>,
}

impl Scaling {
    pub fn new(dofs: usize) -> Self {
        let vector = || vec![1.0; dofs];
        Scaling {
            rows: vector(),
            columns: vector(),
            row_maxima: vector(),
            column_maxima: vector(),
        }
    }

    /// Scales the diagonal to one first, which undoes any change of units, then the largest entry of each row to one and
    /// that of each column.
    ///
    /// # Errors
    /// [`LinearError::ZeroRow`], also for a column.
    pub fn compute(&mut self, matrix: &SystemMatrix) -> Result<(), LinearError> {
        self.rows.fill(1.0);
        self.columns.fill(1.0);
        self.maxima(matrix);
        let zero = |m: &[f64]| m.iter().position(|m| *m == 0.0);
        if let Some(dof) = zero(&self.row_maxima).or(zero(&self.column_maxima)) {
            let dof = DofName::new(dof);
            return Err(LinearError::ZeroRow { dof });
        }
        matrix.diagonal(&mut self.rows);
        for (i, r) in self.rows.iter_mut().enumerate() {
            let d = r.abs();
            let size = if d > 0.0 {
                d
            } else {
                self.row_maxima[i].sqrt() * self.column_maxima[i].sqrt()
            };
            *r = power_of_two(1.0 / size.sqrt());
        }
        self.columns.copy_from_slice(&self.rows);
        self.maxima(matrix);
        for (r, m) in self.rows.iter_mut().zip(&self.row_maxima) {
            *r = power_of_two(*r / m);
        }
        self.maxima(matrix);
        for (c, m) in self.columns.iter_mut().zip(&self.column_maxima) {
            *c = power_of_two(*c / m);
        }
        Ok(())
    }

    /// Largest magnitudes of the scaled rows and columns.
    fn maxima(&mut self, matrix: &SystemMatrix) {
        let pattern = matrix.pattern();
        self.row_maxima.fill(0.0);
        self.column_maxima.fill(0.0);
        let (rows, columns) = (&mut self.row_maxima, &mut self.column_maxima);
        let mut see = |row: usize, column: usize, block: &[f64], turned: bool| {
            for b in 0..3 {
                for a in 0..3 {
                    let value = block[if turned { 3 * a + b } else { 3 * b + a }].abs();
                    let value = value * self.rows[row + a] * self.columns[column + b];
                    rows[row + a] = rows[row + a].max(value);
                    columns[column + b] = columns[column + b].max(value);
                }
            }
        };
        let lower = matrix.values();
        let upper = matrix.transposed_values().unwrap_or(lower);
        let mut block = 0;
        for column in 0..pattern.nodes() {
            for &row in pattern.column(column) {
                let (r, c) = (3 * row as usize, 3 * column);
                see(r, c, &lower[block..block + 9], false);
                if r != c {
                    see(c, r, &upper[block..block + 9], true);
                }
                block += 9;
            }
        }
    }
}

/// The power of two next to a positive number.
fn power_of_two(x: f64) -> f64 {
    x.log2().round().clamp(-1000.0, 1000.0).exp2()
}
