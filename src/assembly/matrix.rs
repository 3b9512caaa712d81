//! The values of a symmetric system on a pattern.
use super::constraints::DofMap;
use super::pattern::{FLAG_BITS, Pattern, PatternError, SAME_NODE, TRANSPOSED};
use rayon::prelude::*;
use std::sync::Arc;

/// A symmetric matrix on a [`Pattern`].
///
/// Blocks are stored one after the other in the pattern's order, nine values each, column-major. Diagonal blocks hold
/// both of their triangles, zeros are kept: which entries exist depends on the pattern alone.
#[derive(Debug, Clone)]
pub struct SystemMatrix {
    pattern: Arc<Pattern>,
    values: Vec<f64>,
}

/// Buffers of [`SystemMatrix::scatter_constrained`], kept by the caller so that no element allocates.
#[derive(Debug, Clone, Default)]
pub struct ConstrainedScatter {
    nodes: Vec<u32>,
    map: Vec<u32>,
    ke: Vec<f64>,
}

impl SystemMatrix {
    /// A zero matrix.
    pub fn new(pattern: Arc<Pattern>) -> Self {
        let values = vec![0.0; 9 * pattern.blocks()];
        Self { pattern, values }
    }

    /// The pattern, shared.
    pub fn pattern(&self) -> &Arc<Pattern> {
        &self.pattern
    }

    /// All values: nine a block (column-major), in the order of the pattern's blocks.
    pub fn values(&self) -> &[f64] {
        &self.values
    }

    /// All values, to write to. The diagonal blocks must stay symmetric.
    pub fn values_mut(&mut self) -> &mut [f64] {
        &mut self.values
    }

    /// Sets every value to zero.
    pub fn clear(&mut self) {
        self.values.fill(0.0);
    }

    /// Adds the symmetric element matrix `ke` (column-major, `3n` x `3n`, dof `3 * local node + component`) where
    /// `map` of [`Pattern::element_map`] says.
    ///
    /// # Panics
    /// If `map` is not of an element of the size of `ke`, or of another, larger pattern.
    pub fn scatter(&mut self, map: &[u32], ke: &[f64]) {
        let n = element_nodes(map.len(), ke.len());
        scatter_into(&mut self.values, map, ke, n);
    }

    /// Adds many element matrices of `n` nodes each, `n (n + 1) / 2` numbers of `maps` and `9 n^2` of `kes` for each
    /// element, on at most `threads` threads. Each thread owns a range of blocks and walks all elements in order, so
    /// every sum has the order of the serial one: the result is the same to the last bit for any number of threads.
    ///
    /// # Panics
    /// As [`scatter`](Self::scatter).
    pub fn scatter_many(&mut self, n: usize, maps: &[u32], kes: &[f64], threads: usize) {
        let (pairs, size) = (n * (n + 1) / 2, 9 * n * n);
        if n == 0 {
            return;
        }
        assert_eq!(
            maps.len() / pairs,
            kes.len() / size,
            "maps and matrices differ"
        );
        let elements = maps.chunks_exact(pairs).zip(kes.chunks_exact(size));
        let threads = threads.clamp(1, rayon::current_num_threads().max(1));
        if threads == 1 {
            for (map, ke) in elements {
                scatter_into(&mut self.values, map, ke, n);
            }
            return;
        }
        let blocks = self.pattern.blocks().div_ceil(threads).max(1);
        self.values
            .par_chunks_mut(9 * blocks)
            .enumerate()
            .for_each(|(chunk, values)| {
                let first = (chunk * blocks) as u32;
                for (map, ke) in elements.clone() {
                    scatter_into_range(values, first, map, ke, n);
                }
            });
    }

    /// Adds the matrix of an element some of whose dofs may be prescribed or tied, without a precomputed map (a
    /// contact element, say): drops what is prescribed, moves what is tied to its targets and adds the rest.
    ///
    /// # Errors
    /// [`PatternError::NotCoupled`] if the pattern lacks a pair of the element's nodes or of the nodes that they are
    /// tied to ([`DofMap::extend_nodes`] tells which groups the pattern needs); nothing is added then.
    ///
    /// # Panics
    /// If `ke` does not have `9 * nodes.len()^2` values.
    pub fn scatter_constrained(
        &mut self,
        nodes: &[u32],
        ke: &[f64],
        dofs: &DofMap,
        work: &mut ConstrainedScatter,
    ) -> Result<(), PatternError> {
        work.nodes.clear();
        work.map.clear();
        dofs.extend_nodes(nodes, &mut work.nodes);
        self.pattern.element_map(&work.nodes, &mut work.map)?;
        if !dofs.constrains(nodes) {
            self.scatter(&work.map, ke);
            return Ok(());
        }
        let (rows, extended) = (3 * nodes.len(), 3 * work.nodes.len());
        work.ke.clear();
        work.ke.resize(extended * extended, 0.0);
        for (to, from) in work
            .ke
            .chunks_exact_mut(extended)
            .zip(ke.chunks_exact(rows))
        {
            to[..rows].copy_from_slice(from);
        }
        // The list is extended, so that every target is in it.
        let complete = dofs.condense_matrix(&work.nodes, &mut work.ke);
        debug_assert_eq!(complete, Ok(()));
        self.scatter(&work.map, &work.ke);
        Ok(())
    }

    /// Puts `scale` on the diagonal of a dof that a constraint removed. Its row and column must be zero, as they are
    /// when every element was condensed ([`DofMap::condense_matrix`]).
    ///
    /// # Panics
    /// If the dof does not exist.
    pub fn set_identity(&mut self, dof: usize, scale: f64) {
        let at = self.diagonal_index(dof);
        self.values[at] = scale;
    }

    /// [`set_identity`](Self::set_identity) for all dofs that `dofs` removed, with the mean absolute diagonal of the
    /// others as scale (1 if that is zero), which is also returned.
    ///
    /// # Panics
    /// If `dofs` has more nodes than the pattern.
    pub fn set_identities(&mut self, dofs: &DofMap) -> f64 {
        let total: f64 = (0..self.pattern.dofs())
            .map(|d| self.values[self.diagonal_index(d)].abs())
            .sum();
        let free = self.pattern.dofs() - dofs.removed().count();
        let mean = total / free.max(1) as f64;
        let scale = if mean > 0.0 && mean.is_finite() {
            mean
        } else {
            1.0
        };
        for dof in dofs.removed() {
            self.set_identity(dof as usize, scale);
        }
        scale
    }

    /// Entry at (row, column) dof, zero where the pattern has no block. For tests and messages; it searches.
    pub fn get(&self, row: usize, column: usize) -> f64 {
        let (row, column) = (row.max(column), row.min(column));
        match self.pattern.block((row / 3) as u32, (column / 3) as u32) {
            Some(block) => self.values[9 * block as usize + 3 * (column % 3) + row % 3],
            None => 0.0,
        }
    }

    /// Writes the diagonal, one value a dof.
    ///
    /// # Panics
    /// If `out` is shorter than [`Pattern::dofs`].
    pub fn diagonal(&self, out: &mut [f64]) {
        for (dof, d) in out[..self.pattern.dofs()].iter_mut().enumerate() {
            *d = self.values[self.diagonal_index(dof)];
        }
    }

    /// `y = A x`.
    ///
    /// # Panics
    /// If `x` or `y` does not have [`Pattern::dofs`] values.
    pub fn multiply(&self, x: &[f64], y: &mut [f64]) {
        self.product(x, y, |a| a, |x| x);
    }

    /// `y = |A| |x|`. Times the machine epsilon (and a small number for the length of the sums) it bounds the round-off
    /// in a residual that has `A x` in it: no solver can bring the residual below.
    ///
    /// # Panics
    /// As [`multiply`](Self::multiply).
    pub fn abs_multiply(&self, x: &[f64], y: &mut [f64]) {
        self.product(x, y, f64::abs, f64::abs);
    }

    /// `out = sum_j |a_ij|`.
    ///
    /// # Panics
    /// As [`multiply`](Self::multiply).
    pub fn abs_row_sums(&self, out: &mut [f64]) {
        // Any vector of the right length does, as every entry counts as one.
        let any = &self.values[..self.pattern.dofs()];
        self.product(any, out, f64::abs, |_| 1.0);
    }

    fn diagonal_index(&self, dof: usize) -> usize {
        9 * self.pattern.column_starts()[dof / 3] as usize + 4 * (dof % 3)
    }

    #[inline(always)]
    fn product(
        &self,
        x: &[f64],
        y: &mut [f64],
        value: impl Fn(f64) -> f64,
        entry: impl Fn(f64) -> f64,
    ) {
        let n = self.pattern.dofs();
        assert!(x.len() == n && y.len() == n, "vector of another length");
        y.fill(0.0);
        let mut blocks = self.values.chunks_exact(9);
        for column in 0..self.pattern.nodes() {
            let xc: [f64; 3] = std::array::from_fn(|b| entry(x[3 * column + b]));
            let mut yc = [0.0; 3];
            for (k, &row) in self.pattern.column(column).iter().enumerate() {
                let Some(block) = blocks.next() else { return };
                let a: [f64; 9] = std::array::from_fn(|i| value(block[i]));
                let r = 3 * row as usize;
                let yr = &mut y[r..r + 3];
                for i in 0..3 {
                    yr[i] += a[i] * xc[0] + a[3 + i] * xc[1] + a[6 + i] * xc[2];
                }
                if k > 0 {
                    let xr = &x[r..r + 3];
                    for b in 0..3 {
                        yc[b] += a[3 * b] * entry(xr[0])
                            + a[3 * b + 1] * entry(xr[1])
                            + a[3 * b + 2] * entry(xr[2]);
                    }
                }
            }
            for b in 0..3 {
                y[3 * column + b] += yc[b];
            }
        }
    }
}

fn element_nodes(map: usize, ke: usize) -> usize {
    let n = ke.isqrt() / 3;
    assert!(
        9 * n * n == ke && n * (n + 1) / 2 == map,
        "the map is not of an element of this size"
    );
    n
}

fn scatter_into(values: &mut [f64], map: &[u32], ke: &[f64], n: usize) {
    let mut at = 0;
    for q in 0..n {
        for p in q..n {
            let code = map[at];
            at += 1;
            let first = 9 * (code >> FLAG_BITS) as usize;
            add_block(&mut values[first..first + 9], code, ke, 3 * n, 3 * p, 3 * q);
        }
    }
}

/// Adds only the blocks that `values`, which starts at block `first`, holds.
fn scatter_into_range(values: &mut [f64], first: u32, map: &[u32], ke: &[f64], n: usize) {
    let count = (values.len() / 9) as u32;
    let mut at = 0;
    for q in 0..n {
        for p in q..n {
            let code = map[at];
            at += 1;
            let block = (code >> FLAG_BITS).wrapping_sub(first);
            if block < count {
                let start = 9 * block as usize;
                add_block(&mut values[start..start + 9], code, ke, 3 * n, 3 * p, 3 * q);
            }
        }
    }
}

/// Adds the 3 x 3 block of `ke` at (row, column) to a stored block, as the flags of its map entry say.
#[inline(always)]
fn add_block(block: &mut [f64], code: u32, ke: &[f64], size: usize, row: usize, column: usize) {
    let flags = code & (TRANSPOSED | SAME_NODE);
    if flags == 0 {
        for b in 0..3 {
            let from = &ke[(column + b) * size + row..][..3];
            for a in 0..3 {
                block[3 * b + a] += from[a];
            }
        }
        return;
    }
    // Stored transposed; a pair of the same node gives its diagonal block both the block and its transpose.
    for b in 0..3 {
        let from = &ke[(column + b) * size + row..][..3];
        for a in 0..3 {
            block[3 * a + b] += from[a];
            if flags == SAME_NODE {
                block[3 * b + a] += from[a];
            }
        }
    }
}
