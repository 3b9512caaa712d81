//! The left-looking factorization: every supernode collects the updates of those before it and is then factorized with
//! dense kernels. Rows are exchanged within diagonal blocks only, so that the structure is known beforehand (static
//! pivoting within supernodes: O. Schenk and K. Gaertner, "Solving unsymmetric sparse systems of linear equations with
//! PARDISO", Future Generation Computer Systems 20 (2004)).
use super::super::permuted::PermutedBlocks;
use super::dense::{self, Pivots};
use super::scaling::Scaling;
use super::structure::{Shape, Structure};
use crate::system::SystemMatrix;
use faer::linalg::matmul::matmul;
use faer::linalg::triangular_solve::{
    solve_lower_triangular_in_place, solve_unit_lower_triangular_in_place,
};
use faer::reborrow::IntoConst;
use faer::{Accum, MatMut, MatRef, Par};

/// No supernode.
const NONE: u32 = u32::MAX;
/// Operations of a dense product below which one thread does it.
const PARALLEL: usize = 1 << 20;

/// Factors `L`, `U` and the exchanges of rows within supernodes.
pub(super) struct Factor {
    pub values: Vec<f64>,
    /// Row with which each dof's row was exchanged, counted from its supernode's first.
    pub swaps: Vec<u32>,
}

/// Buffers of a factorization.
pub(super) struct Work {
    /// Per supernode: first of the list of those whose next update it takes, next in the list that it is in itself, and
    /// its first row that has not been used.
    head: Vec<u32>,
    next: Vec<u32>,
    unused: Vec<u32>,
    /// Row of each node in the present panel.
    local: Vec<u32>,
    product: Vec<f64>,
}

impl Work {
    pub fn new(structure: &Structure, product: Vec<f64>) -> Self {
        let count = structure.count();
        Work {
            head: vec![NONE; count],
            next: vec![NONE; count],
            unused: vec![0; count],
            local: vec![0; structure.owner.len()],
            product,
        }
    }
}

/// Where the values come from.
pub(super) struct Source<'a> {
    pub matrix: &'a SystemMatrix,
    pub scaling: &'a Scaling,
    pub blocks: &'a PermutedBlocks,
}

impl Factor {
    /// Factorizes the scaled matrix.
    pub fn compute(
        &mut self,
        structure: &Structure,
        source: &Source<'_>,
        work: &mut Work,
        threshold: f64,
        par: Par,
    ) -> Pivots {
        let mut pivots = Pivots::new(threshold);
        work.head.fill(NONE);
        for s in 0..structure.count() {
            let shape = structure.shape(s);
            let rows = structure.rows(s);
            let (begin, end) = (structure.begins[s], structure.begins[s + 1]);
            for (i, row) in (begin..end).chain(rows.iter().copied()).enumerate() {
                work.local[row as usize] = i as u32;
            }
            let (done, rest) = self.values.split_at_mut(structure.panel_start(s));
            let panel = &mut rest[..shape.values()];
            panel.fill(0.0);
            let (lower, upper) = panel.split_at_mut(shape.lower());
            source.load(structure, s, lower, upper);
            let mut from = work.head[s];
            while from != NONE {
                let d = from as usize;
                from = work.next[d];
                let first = work.unused[d] as usize;
                let middle = update(structure, done, d, first, (s, end), work, lower, upper, par);
                advance(structure, d, middle, work);
            }
            let swaps = &mut self.swaps[shape.begin..][..shape.columns];
            eliminate(lower, upper, shape, swaps, &mut pivots, par);
            advance(structure, s, 0, work);
        }
        pivots
    }
}

/// Puts a supernode into the list of the next supernode that its rows from `unused` on belong to.
fn advance(structure: &Structure, s: usize, unused: usize, work: &mut Work) {
    if let Some(&row) = structure.rows(s).get(unused) {
        let target = structure.owner[row as usize] as usize;
        work.unused[s] = unused as u32;
        work.next[s] = work.head[target];
        work.head[target] = s as u32;
    }
}

/// Subtracts the update of supernode `d`, whose rows from `first` on are open, from the panel of supernode `s`, whose
/// nodes end at `end`. Returns the first row of `d` behind `s`.
#[allow(clippy::too_many_arguments)]
fn update(
    structure: &Structure,
    done: &[f64],
    d: usize,
    first: usize,
    (s, end): (usize, u32),
    work: &mut Work,
    lower: &mut [f64],
    upper: &mut [f64],
    par: Par,
) -> usize {
    let shape = structure.shape(d);
    let rows = structure.rows(d);
    let middle = first + rows[first..].partition_point(|&r| r < end);
    let (l, u) = structure.panel(d, done);
    let l = MatRef::from_column_major_slice(l, shape.height(), shape.columns)
        .subrows(shape.columns, shape.below);
    let u = MatRef::from_column_major_slice(u, shape.below, shape.columns);
    let target = structure.shape(s);
    let columns = &rows[first..middle];
    let mut to = Target {
        values: lower,
        height: target.height(),
        above: 0,
        begin: structure.begins[s],
    };
    let open = rows.len() - first;
    let taken = middle - first;
    let (ln, un) = (
        l.subrows(3 * first, 3 * open),
        u.subrows(3 * first, 3 * taken),
    );
    to.subtract(ln, un, &rows[first..], columns, work, par);
    if middle < rows.len() {
        let mut to = Target {
            values: upper,
            height: target.below,
            above: (target.columns / 3) as u32,
            begin: structure.begins[s],
        };
        let behind = rows.len() - middle;
        let (un, ln) = (
            u.subrows(3 * middle, 3 * behind),
            l.subrows(3 * first, 3 * taken),
        );
        to.subtract(un, ln, &rows[middle..], columns, work, par);
    }
    middle
}

/// A panel that an update is subtracted from.
struct Target<'a> {
    values: &'a mut [f64],
    height: usize,
    /// Nodes of the panel above the first row of `values`.
    above: u32,
    /// First node of the panel.
    begin: u32,
}

impl Target<'_> {
    /// Subtracts `left right^t`, whose rows and columns belong to nodes `rows` and `columns`.
    fn subtract(
        &mut self,
        left: MatRef<'_, f64>,
        right: MatRef<'_, f64>,
        rows: &[u32],
        columns: &[u32],
        work: &mut Work,
        par: Par,
    ) {
        let m = left.nrows();
        let step = Structure::columns_at_once(m);
        for (chunk, nodes) in columns.chunks(step).enumerate() {
            let n = 3 * nodes.len();
            let product = &mut work.product[..m * n];
            matmul(
                MatMut::from_column_major_slice_mut(product, m, n),
                Accum::Replace,
                left,
                right.subrows(3 * step * chunk, n).transpose(),
                1.0,
                threads(par, m * n * left.ncols()),
            );
            for (node, three) in nodes.iter().zip(product.chunks_exact(3 * m)) {
                let first = 3 * (node - self.begin) as usize * self.height;
                let to = &mut self.values[first..first + 3 * self.height];
                for (to, from) in to.chunks_exact_mut(self.height).zip(three.chunks_exact(m)) {
                    for (row, from) in rows.iter().zip(from.chunks_exact(3)) {
                        let at = 3 * (work.local[*row as usize] - self.above) as usize;
                        let to = &mut to[at..at + 3];
                        to[0] -= from[0];
                        to[1] -= from[1];
                        to[2] -= from[2];
                    }
                }
            }
        }
    }
}

/// Factorizes the diagonal block and finishes what is below it and right of it.
fn eliminate(
    lower: &mut [f64],
    upper: &mut [f64],
    shape: Shape,
    swaps: &mut [u32],
    pivots: &mut Pivots,
    par: Par,
) {
    let (n, below) = (shape.columns, shape.below);
    let block = threads(par, n * n * n);
    dense::factorize(lower, shape.height(), swaps, shape.begin, pivots, block);
    if below == 0 {
        return;
    }
    // Exchanged rows of U are columns of its transpose.
    for (j, &swap) in swaps.iter().enumerate() {
        let swap = swap as usize;
        if swap != j {
            let (left, right) = upper.split_at_mut(swap * below);
            left[j * below..][..below].swap_with_slice(&mut right[..below]);
        }
    }
    let par = threads(par, n * n * below);
    let panel = MatMut::from_column_major_slice_mut(lower, shape.height(), n);
    let (block, bottom) = panel.split_at_row_mut(n);
    let block = block.into_const();
    let right = MatMut::from_column_major_slice_mut(upper, below, n);
    solve_lower_triangular_in_place(block.transpose(), bottom.transpose_mut(), par);
    solve_unit_lower_triangular_in_place(block, right.transpose_mut(), par);
}

fn threads(par: Par, operations: usize) -> Par {
    if operations < PARALLEL { Par::Seq } else { par }
}

impl Source<'_> {
    /// Writes the scaled blocks of a supernode's columns and rows into its panel of zeros.
    fn load(&self, structure: &Structure, s: usize, lower: &mut [f64], upper: &mut [f64]) {
        let shape = structure.shape(s);
        let (height, below, own) = (shape.height(), shape.below, shape.columns / 3);
        let values = self.matrix.values();
        let transposed = self.matrix.transposed_values().unwrap_or(values);
        let starts = &self.blocks.starts;
        for node in structure.begins[s]..structure.begins[s + 1] {
            let column = 3 * (node as usize - structure.begins[s] as usize);
            let range = starts[node as usize] as usize..starts[node as usize + 1] as usize;
            let old_column = 3 * self.blocks.new_to_old[node as usize] as usize;
            for at in range {
                let (source, row) = (self.blocks.sources[at], structure.targets[at] as usize);
                let first = 9 * (source >> 1) as usize;
                let old_row = 3 * self.blocks.new_to_old[self.blocks.rows[at] as usize] as usize;
                let (a, b) = (&values[first..first + 9], &transposed[first..first + 9]);
                // The block stands for (row, column) and (column, row) of the old numbering, or the reverse.
                let (ours, mirrored) = if source & 1 == 0 { (a, b) } else { (b, a) };
                let turned = source & 1 == 1;
                let scale = |row: usize, column: usize| {
                    self.scaling.rows[row] * self.scaling.columns[column]
                };
                for c in 0..3 {
                    for r in 0..3 {
                        let k = if turned { 3 * r + c } else { 3 * c + r };
                        lower[(column + c) * height + 3 * row + r] =
                            ours[k] * scale(old_row + r, old_column + c);
                        if old_row == old_column {
                            continue;
                        }
                        let value = mirrored[k] * scale(old_column + c, old_row + r);
                        if row < own {
                            lower[(3 * row + r) * height + column + c] = value;
                        } else {
                            upper[(column + c) * below + 3 * (row - own) + r] = value;
                        }
                    }
                }
            }
        }
    }
}
