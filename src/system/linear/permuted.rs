//! The blocks of a matrix in the order of elimination.
use super::DofName;
use super::ordering::NodeOrder;
use crate::system::Pattern;

/// The lower triangle of the permuted pattern, by columns of nodes.
#[derive(Debug)]
pub(super) struct PermutedBlocks {
    pub new_to_old: Vec<u32>,
    /// Starts of the node columns in `rows` and `sources`.
    pub starts: Vec<u32>,
    /// Permuted row node of each block; the diagonal is the first of its column, the others are in no order.
    pub rows: Vec<u32>,
    /// Where each block comes from: twice its number in the pattern, plus one if it is transposed.
    pub sources: Vec<u32>,
}

impl PermutedBlocks {
    pub fn new(pattern: &Pattern, order: NodeOrder) -> Self {
        let n = pattern.nodes();
        let old_to_new = &order.old_to_new;
        let mut starts = vec![0u32; n + 1];
        for column in 0..n {
            for &row in pattern.column(column) {
                let new = old_to_new[column].min(old_to_new[row as usize]);
                starts[new as usize + 1] += 1;
            }
        }
        for i in 0..n {
            starts[i + 1] += starts[i];
        }
        let mut rows = vec![0u32; pattern.blocks()];
        let mut sources = vec![0u32; pattern.blocks()];
        let mut next = starts.clone();
        let mut add = |column: u32, row: u32, source: u32| {
            let at = &mut next[column as usize];
            rows[*at as usize] = row;
            sources[*at as usize] = source;
            *at += 1;
        };
        for (old, &new) in old_to_new.iter().enumerate() {
            add(new, new, 2 * pattern.column_starts()[old]);
        }
        for column in 0..n {
            let first = pattern.column_starts()[column];
            for (k, &row) in pattern.column(column).iter().enumerate().skip(1) {
                let (c, r) = (old_to_new[column], old_to_new[row as usize]);
                let transposed = u32::from(c > r);
                add(c.min(r), c.max(r), 2 * (first + k as u32) + transposed);
            }
        }
        Self {
            new_to_old: order.new_to_old,
            starts,
            rows,
            sources,
        }
    }

    /// The dof of a permuted number.
    pub fn dof_name(&self, permuted: usize) -> DofName {
        DofName {
            node: self.new_to_old.get(permuted / 3).copied().unwrap_or(0),
            component: (permuted % 3) as u8,
        }
    }

    /// Entries of `from` in the order of elimination.
    pub fn permute(&self, from: &[f64], to: &mut [f64]) {
        for (to, &old) in to.chunks_exact_mut(3).zip(&self.new_to_old) {
            to.copy_from_slice(&from[3 * old as usize..][..3]);
        }
    }

    /// The reverse of [`permute`](Self::permute).
    pub fn restore(&self, from: &[f64], to: &mut [f64]) {
        for (from, &old) in from.chunks_exact(3).zip(&self.new_to_old) {
            to[3 * old as usize..][..3].copy_from_slice(from);
        }
    }
}

/// Columns and rows of dofs for columns and rows of nodes, every block full.
pub(super) fn expand(starts: &[u32], rows: &[u32]) -> (Vec<u32>, Vec<u32>) {
    let mut dof_starts = Vec::with_capacity(3 * starts.len());
    let mut dof_rows = Vec::with_capacity(9 * rows.len());
    dof_starts.push(0);
    for column in starts.windows(2) {
        for _ in 0..3 {
            for &row in &rows[column[0] as usize..column[1] as usize] {
                dof_rows.extend([3 * row, 3 * row + 1, 3 * row + 2]);
            }
            dof_starts.push(dof_rows.len() as u32);
        }
    }
    (dof_starts, dof_rows)
}
