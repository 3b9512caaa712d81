//! The values of a system on a pattern, symmetric or not.
mod scattering;

use super::constraints::DofMap;
use super::pattern::{Pattern, PatternError};
use nalgebra::Matrix3;
use rayon::prelude::*;
use scattering::{
    add_multiples, element_nodes, scatter_both_into, scatter_into, scatter_into_range,
};
use std::sync::Arc;

/// A matrix on a [`Pattern`], symmetric or with a symmetric structure only.
///
/// Blocks are stored one after the other in the pattern's order, nine values each, column-major. Diagonal blocks hold
/// both of their triangles, zeros are kept: which entries exist depends on the pattern alone.
///
/// An unsymmetric matrix holds the blocks above the diagonal in a second array of the same order, each as its
/// transpose: the first array is the lower triangle of the matrix, the second that of its transpose. A symmetric
/// matrix has no second array and costs nothing more.
#[derive(Debug, Clone)]
pub struct SystemMatrix {
    pattern: Arc<Pattern>,
    values: Vec<f64>,
    /// Lower triangle of the transpose; its diagonal blocks are zeros that nobody reads.
    transposed: Option<Vec<f64>>,
}

/// Buffers of [`SystemMatrix::scatter_constrained`], kept by the caller so that no element allocates.
#[derive(Debug, Clone, Default)]
pub struct ConstrainedScatter {
    nodes: Vec<u32>,
    map: Vec<u32>,
    ke: Vec<f64>,
}

impl ConstrainedScatter {
    /// Bytes of heap that it holds.
    pub fn bytes(&self) -> usize {
        let indices = self.nodes.capacity() + self.map.capacity();
        indices * size_of::<u32>() + self.ke.capacity() * size_of::<f64>()
    }
}

impl SystemMatrix {
    /// A symmetric matrix of zeros.
    pub fn new(pattern: Arc<Pattern>) -> Self {
        let values = vec![0.0; 9 * pattern.blocks()];
        Self {
            pattern,
            values,
            transposed: None,
        }
    }

    /// An unsymmetric matrix of zeros: twice the memory of a symmetric one.
    pub fn unsymmetric(pattern: Arc<Pattern>) -> Self {
        let mut matrix = Self::new(pattern);
        matrix.transposed = Some(vec![0.0; matrix.values.len()]);
        matrix
    }

    /// Bytes of heap that the values hold: those of the lower triangle, and those of the transpose's.
    pub fn bytes(&self) -> [usize; 2] {
        let size = |values: &Vec<f64>| values.capacity() * size_of::<f64>();
        [size(&self.values), self.transposed.as_ref().map_or(0, size)]
    }

    /// Whether the blocks below the diagonal stand for those above it, too.
    pub fn is_symmetric(&self) -> bool {
        self.transposed.is_none()
    }

    /// The pattern, shared.
    pub fn pattern(&self) -> &Arc<Pattern> {
        &self.pattern
    }

    /// The values of the lower triangle: nine a block (column-major), in the order of the pattern's blocks.
    pub fn values(&self) -> &[f64] {
        &self.values
    }

    /// The values of the lower triangle, to write to. The diagonal blocks of a symmetric matrix must stay symmetric.
    pub fn values_mut(&mut self) -> &mut [f64] {
        &mut self.values
    }

    /// The lower triangle of the transpose, laid out as [`values`](Self::values): the blocks above the diagonal, each
    /// transposed (row-major). Its diagonal blocks mean nothing; those of `values` are complete. `None` for a
    /// symmetric matrix, for which `values` is that triangle.
    pub fn transposed_values(&self) -> Option<&[f64]> {
        self.transposed.as_deref()
    }

    /// [`transposed_values`](Self::transposed_values), to write to.
    pub fn transposed_values_mut(&mut self) -> Option<&mut [f64]> {
        self.transposed.as_deref_mut()
    }

    /// Sets every value to zero.
    pub fn clear(&mut self) {
        self.values.fill(0.0);
        if let Some(transposed) = &mut self.transposed {
            transposed.fill(0.0);
        }
    }

    /// Adds the element matrix `ke` (column-major, `3n` x `3n`, dof `3 * local node + component`) where `map` of
    /// [`Pattern::element_map`] says. If this matrix is symmetric, so must be `ke`: only the blocks below its
    /// diagonal are read then.
    ///
    /// # Panics
    /// If `map` is not of an element of the size of `ke`, or of another, larger pattern.
    pub fn scatter(&mut self, map: &[u32], ke: &[f64]) {
        let n = element_nodes(map.len(), ke.len());
        match &mut self.transposed {
            None => scatter_into(&mut self.values, map, ke, n),
            Some(transposed) => scatter_both_into(&mut self.values, transposed, 0, map, ke, n),
        }
    }

    /// Adds `w_a w_b k` to the block of every pair of nodes `a`, `b` with weights `w`: what a point with tangent `k` adds, where
    /// `places` of [`Pattern::point_places`] says. Each pair's block is a multiple of the same `k`, so that it does not matter
    /// which of the two nodes has its row stored; if this matrix is symmetric, so must be `k`.
    ///
    /// # Panics
    /// If there are fewer places than pairs, or they are of another, larger pattern.
    #[inline(always)]
    pub fn scatter_point(&mut self, places: &[u32], weights: &[f64], k: &Matrix3<f64>) {
        add_multiples(&mut self.values, places, weights, k);
        if let Some(transposed) = &mut self.transposed {
            add_multiples(transposed, places, weights, &k.transpose());
        }
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
            match &mut self.transposed {
                None => elements.for_each(|(map, ke)| scatter_into(&mut self.values, map, ke, n)),
                Some(transposed) => elements.for_each(|(map, ke)| {
                    scatter_both_into(&mut self.values, transposed, 0, map, ke, n);
                }),
            }
            return;
        }
        let blocks = self.pattern.blocks().div_ceil(threads).max(1);
        let chunks = self.values.par_chunks_mut(9 * blocks).enumerate();
        match &mut self.transposed {
            None => chunks.for_each(|(chunk, values)| {
                let first = (chunk * blocks) as u32;
                for (map, ke) in elements.clone() {
                    scatter_into_range(values, first, map, ke, n);
                }
            }),
            Some(transposed) => chunks.zip(transposed.par_chunks_mut(9 * blocks)).for_each(
                |((chunk, values), transposed)| {
                    let first = (chunk * blocks) as u32;
                    for (map, ke) in elements.clone() {
                        scatter_both_into(values, transposed, first, map, ke, n);
                    }
                },
            ),
        }
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

    /// Adds to an entry of the diagonal.
    ///
    /// # Panics
    /// If the dof does not exist.
    #[inline]
    pub fn add_diagonal(&mut self, dof: usize, value: f64) {
        let at = self.diagonal_index(dof);
        self.values[at] += value;
    }

    /// Entry at (row, column) dof, zero where the pattern has no block. For tests and messages; it searches.
    pub fn get(&self, row: usize, column: usize) -> f64 {
        let Some(block) = self.pattern.block((row / 3) as u32, (column / 3) as u32) else {
            return 0.0;
        };
        let first = 9 * block as usize;
        if row / 3 >= column / 3 {
            return self.values[first + 3 * (column % 3) + row % 3];
        }
        let transposed = self.transposed.as_deref().unwrap_or(&self.values);
        transposed[first + 3 * (row % 3) + column % 3]
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

    /// `out_i = sum_j |a_ij|`.
    ///
    /// # Panics
    /// As [`multiply`](Self::multiply).
    pub fn abs_row_sums(&self, out: &mut [f64]) {
        // Any vector of the right length does, as every entry counts as one.
        let any = &self.values[..self.pattern.dofs()];
        self.product(any, out, f64::abs, |_| 1.0);
    }

    /// Whether a block holds a value that is infinite or NaN: (row, column) of the first. A block above the diagonal
    /// goes by the name of its mirror image.
    pub fn first_not_finite(&self) -> Option<(u32, u32)> {
        // A product with zero is zero, and NaN if the value is infinite or NaN.
        let broken = |b: &[f64]| b.iter().map(|v| v * 0.0).sum::<f64>() != 0.0;
        let find = |values: &[f64]| values.chunks_exact(9).position(broken);
        let block = find(&self.values).or_else(|| self.transposed.as_deref().and_then(find))?;
        let starts = self.pattern.column_starts();
        let column = starts.partition_point(|&s| s as usize <= block) - 1;
        Some((self.pattern.rows()[block], column as u32))
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
        match &self.transposed {
            None => self.product_of::<false>(&[], x, y, value, entry),
            Some(transposed) => self.product_of::<true>(transposed, x, y, value, entry),
        }
    }

    /// The product with the lower triangle and what mirrors it: the triangle itself, or `transposed` if that is told.
    #[inline(always)]
    fn product_of<const UNSYMMETRIC: bool>(
        &self,
        transposed: &[f64],
        x: &[f64],
        y: &mut [f64],
        value: impl Fn(f64) -> f64,
        entry: impl Fn(f64) -> f64,
    ) {
        let n = self.pattern.dofs();
        assert!(x.len() == n && y.len() == n, "vector of another length");
        y.fill(0.0);
        let mut blocks = self.values.chunks_exact(9);
        let mut mirrored = transposed.chunks_exact(9);
        for column in 0..self.pattern.nodes() {
            let xc: [f64; 3] = std::array::from_fn(|b| entry(x[3 * column + b]));
            let mut yc = [0.0; 3];
            for (k, &row) in self.pattern.column(column).iter().enumerate() {
                let Some(block) = blocks.next() else { return };
                let a: [f64; 9] = std::array::from_fn(|i| value(block[i]));
                let m = if UNSYMMETRIC {
                    let Some(block) = mirrored.next() else { return };
                    std::array::from_fn(|i| value(block[i]))
                } else {
                    a
                };
                let r = 3 * row as usize;
                let yr = &mut y[r..r + 3];
                for i in 0..3 {
                    yr[i] += a[i] * xc[0] + a[3 + i] * xc[1] + a[6 + i] * xc[2];
                }
                if k > 0 {
                    let xr = &x[r..r + 3];
                    for b in 0..3 {
                        yc[b] += m[3 * b] * entry(xr[0])
                            + m[3 * b + 1] * entry(xr[1])
                            + m[3 * b + 2] * entry(xr[2]);
                    }
                }
            }
            for b in 0..3 {
                y[3 * column + b] += yc[b];
            }
        }
    }
}
