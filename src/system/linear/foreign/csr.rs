//! The matrix of a system by rows of unknowns, as other libraries take it.
use crate::system::linear::LinearError;
use crate::system::{Pattern, SystemMatrix};

/// Which value of a [`SystemMatrix`] every entry is: the upper triangle of a symmetric matrix, all of an unsymmetric one.
#[derive(Debug)]
pub(in crate::system::linear) struct Csr {
    starts: Vec<i32>,
    columns: Vec<i32>,
    /// Place of every entry among the values of the lower triangle, followed by those of the transpose's.
    places: Vec<u32>,
    symmetric: bool,
}

impl Csr {
    /// # Errors
    /// [`LinearError::TooLarge`]
    pub fn new(pattern: &Pattern, symmetric: bool) -> Result<Self, LinearError> {
        let (nodes, blocks) = (pattern.nodes(), pattern.blocks());
        let entries = match symmetric {
            true => 9 * blocks - 3 * nodes,
            false => 9 * (2 * blocks - nodes),
        };
        if i32::try_from(18 * blocks).is_err() {
            return Err(LinearError::TooLarge);
        }
        // Blocks left of the diagonal, by rows: column and number.
        let mut left: Vec<Vec<(u32, u32)>> = vec![Vec::new(); if symmetric { 0 } else { nodes }];
        if !symmetric {
            for j in 0..nodes {
                let first = pattern.column_starts()[j];
                for (k, &i) in pattern.column(j).iter().enumerate() {
                    if i as usize != j {
                        left[i as usize].push((j as u32, first + k as u32));
                    }
                }
            }
        }
        let mut csr = Csr {
            starts: Vec::with_capacity(3 * nodes + 1),
            columns: Vec::with_capacity(entries),
            places: Vec::with_capacity(entries),
            symmetric,
        };
        csr.starts.push(0);
        for node in 0..nodes {
            let first = pattern.column_starts()[node] as usize;
            for row in 0..3 {
                for &(j, block) in left.get(node).map_or(&[][..], |l| l) {
                    for c in 0..3 {
                        csr.push(3 * j as usize + c, 9 * block as usize + 3 * c + row);
                    }
                }
                for (k, &i) in pattern.column(node).iter().enumerate() {
                    let (i, block) = (i as usize, first + k);
                    for a in 0..3 {
                        // Above the diagonal the transpose has what is asked for; its diagonal blocks mean nothing.
                        let place = match (i == node, symmetric) {
                            (true, true) if a < row => continue,
                            (true, _) => 9 * block + 3 * a + row,
                            (false, true) => 9 * block + 3 * row + a,
                            (false, false) => 9 * (blocks + block) + 3 * row + a,
                        };
                        csr.push(3 * i + a, place);
                    }
                }
                csr.starts.push(csr.columns.len() as i32);
            }
        }
        debug_assert_eq!(csr.columns.len(), entries);
        Ok(csr)
    }

    fn push(&mut self, column: usize, place: usize) {
        self.columns.push(column as i32);
        self.places.push(place as u32);
    }

    pub fn rows(&self) -> usize {
        self.starts.len() - 1
    }

    pub fn entries(&self) -> usize {
        self.columns.len()
    }

    pub fn is_symmetric(&self) -> bool {
        self.symmetric
    }

    pub fn starts(&self) -> &[i32] {
        &self.starts
    }

    pub fn columns(&self) -> &[i32] {
        &self.columns
    }

    /// Takes the structure out as rows and columns of entries, from one on, in the order of [`gather`](Self::gather).
    #[cfg(feature = "mumps")]
    pub fn take_triplets(&mut self) -> (Vec<i32>, Vec<i32>) {
        let (starts, mut columns) = (
            std::mem::take(&mut self.starts),
            std::mem::take(&mut self.columns),
        );
        let mut rows = Vec::with_capacity(columns.len());
        for (row, range) in starts.windows(2).enumerate() {
            rows.resize(range[1] as usize, row as i32 + 1);
        }
        columns.iter_mut().for_each(|column| *column += 1);
        (rows, columns)
    }

    /// Bytes of heap that it holds.
    pub fn bytes(&self) -> usize {
        4 * (self.starts.capacity() + self.columns.capacity() + self.places.capacity())
    }

    /// The values of a matrix on the pattern, in the order of the entries.
    pub fn gather(&self, matrix: &SystemMatrix, values: &mut [f64]) {
        let lower = matrix.values();
        let transposed = matrix.transposed_values().unwrap_or(&[]);
        for (value, &place) in values.iter_mut().zip(&self.places) {
            let place = place as usize;
            *value = match place.checked_sub(lower.len()) {
                None => lower[place],
                Some(above) => transposed[above],
            };
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::Arc;

    /// `y = A x` by rows is that of the matrix itself, symmetric or not, on a pattern with nodes that are not neighbours.
    #[test]
    fn entries_are_those_of_the_matrix() {
        let groups: [&[u32]; 4] = [&[0, 3], &[1, 2, 4], &[4, 0], &[5]];
        let pattern = Arc::new(Pattern::new(6, groups.into_iter()).expect("small"));
        for symmetric in [true, false] {
            let mut matrix = match symmetric {
                true => SystemMatrix::new(pattern.clone()),
                false => SystemMatrix::unsymmetric(pattern.clone()),
            };
            for group in groups {
                let n = 3 * group.len();
                let mut ke = vec![0.0; n * n];
                for (k, v) in ke.iter_mut().enumerate() {
                    let (a, b) = (k % n, k / n);
                    let (a, b) = if symmetric {
                        (a.min(b), a.max(b))
                    } else {
                        (a, b)
                    };
                    *v = (1.0 + a as f64 + 17.0 * b as f64 + group[0] as f64).sin();
                }
                let mut map = Vec::new();
                pattern.element_map(group, &mut map).expect("coupled");
                matrix.scatter(&map, &ke);
            }
            let csr = Csr::new(&pattern, symmetric).expect("small");
            let mut values = vec![0.0; csr.entries()];
            csr.gather(&matrix, &mut values);
            let x: Vec<f64> = (0..csr.rows()).map(|i| 1.0 + (i as f64).cos()).collect();
            let (mut y, mut expected) = (vec![0.0; x.len()], vec![0.0; x.len()]);
            matrix.multiply(&x, &mut expected);
            for row in 0..csr.rows() {
                let range = csr.starts()[row] as usize..csr.starts()[row + 1] as usize;
                assert!(csr.columns()[range.clone()].is_sorted());
                for k in range {
                    let column = csr.columns()[k] as usize;
                    y[row] += values[k] * x[column];
                    if symmetric && column != row {
                        y[column] += values[k] * x[row];
                    }
                }
            }
            for (a, b) in y.iter().zip(&expected) {
                assert!((a - b).abs() < 1e-13 && b.abs() > 1e-3, "{a} {b}");
            }
        }
    }
}
