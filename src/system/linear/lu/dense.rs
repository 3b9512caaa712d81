//! Dense LU of a diagonal block, with exchanges of rows and replacement of pivots that are too small.
use faer::linalg::matmul::matmul;
use faer::linalg::triangular_solve::solve_unit_lower_triangular_in_place;
use faer::reborrow::IntoConst;
use faer::{Accum, MatMut, Par};

/// Columns up to which the plain loops are used.
const PLAIN: usize = 12;
/// What replaces a pivot that is too small: the square root of the machine epsilon, so that as many digits of the
/// matrix survive the large updates that it makes as the replacement itself changes (X. S. Li and J. W. Demmel,
/// "SuperLU_DIST: a scalable distributed-memory sparse direct solver for unsymmetric linear systems", ACM Trans. Math.
/// Softw. 29 (2003)); refinement restores the rest.
const REPLACEMENT: f64 = 1.0 / (1u64 << 26) as f64;

/// What the pivots of a factorization were like.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Pivots {
    /// Smaller pivots are replaced by [`REPLACEMENT`], with their sign.
    pub threshold: f64,
    pub replaced: usize,
    /// Smallest magnitude before replacement, and its column.
    pub smallest: f64,
    pub smallest_at: usize,
    /// The determinant is negative.
    pub negative: bool,
}

impl Pivots {
    pub fn new(threshold: f64) -> Self {
        Pivots {
            threshold,
            replaced: 0,
            smallest: f64::INFINITY,
            smallest_at: 0,
            negative: false,
        }
    }

    /// The pivot to divide by.
    fn see(&mut self, pivot: f64, column: usize) -> f64 {
        let size = pivot.abs();
        // A pivot that is no number counts as zero: what overflowed has no digit left.
        let size = if size.is_finite() { size } else { 0.0 };
        if size < self.smallest {
            (self.smallest, self.smallest_at) = (size, column);
        }
        let mut pivot = pivot;
        if size < self.threshold || size == 0.0 {
            self.replaced += 1;
            pivot = REPLACEMENT.copysign(if pivot < 0.0 { -1.0 } else { 1.0 });
        }
        self.negative ^= pivot < 0.0;
        pivot
    }
}

/// Factorizes the first `swaps.len()` rows and columns of the column-major `data` with `height` rows a column in place:
/// `P A = L U`, `L` with a unit diagonal. Row `j` was exchanged with row `swaps[j]`. `first` numbers the columns.
pub(super) fn factorize(
    data: &mut [f64],
    height: usize,
    swaps: &mut [u32],
    first: usize,
    pivots: &mut Pivots,
    par: Par,
) {
    let rows = swaps.len();
    recurse(data, height, 0..rows, swaps, first, pivots, par);
}

/// Columns of `data` with rows `range` are factorized; `swaps` count from the first of these rows.
fn recurse(
    data: &mut [f64],
    height: usize,
    range: std::ops::Range<usize>,
    swaps: &mut [u32],
    first: usize,
    pivots: &mut Pivots,
    par: Par,
) {
    let n = swaps.len();
    if n <= PLAIN {
        plain(data, height, range, swaps, first, pivots);
        return;
    }
    let half = n / 2;
    let (left, right) = data.split_at_mut(half * height);
    let (swaps_left, swaps_right) = swaps.split_at_mut(half);
    recurse(left, height, range.clone(), swaps_left, first, pivots, par);
    for column in right.chunks_mut(height).take(n - half) {
        exchange(&mut column[range.clone()], swaps_left);
    }
    let rows = range.len();
    {
        let l = view(left, height, range.start, rows, half);
        let a = view(right, height, range.start, rows, n - half);
        let (top, bottom) = l.into_const().split_at_row(half);
        let (mut upper, rest) = a.split_at_row_mut(half);
        solve_unit_lower_triangular_in_place(top, upper.as_mut(), par);
        matmul(rest, Accum::Add, bottom, upper.as_ref(), -1.0, par);
    }
    let lower = range.start + half..range.end;
    let middle = first + half;
    recurse(
        right,
        height,
        lower.clone(),
        swaps_right,
        middle,
        pivots,
        par,
    );
    for column in left.chunks_mut(height).take(half) {
        exchange(&mut column[lower.clone()], swaps_right);
    }
    for swap in swaps_right {
        *swap += half as u32;
    }
}

fn view(
    data: &mut [f64],
    height: usize,
    row: usize,
    rows: usize,
    columns: usize,
) -> MatMut<'_, f64> {
    MatMut::from_column_major_slice_with_stride_mut(&mut data[row..], rows, columns, height)
}

fn exchange(column: &mut [f64], swaps: &[u32]) {
    for (j, &swap) in swaps.iter().enumerate() {
        column.swap(j, swap as usize);
    }
}

fn plain(
    data: &mut [f64],
    height: usize,
    range: std::ops::Range<usize>,
    swaps: &mut [u32],
    first: usize,
    pivots: &mut Pivots,
) {
    let n = swaps.len();
    for j in 0..n {
        let column = &data[j * height..][range.clone()];
        let (mut at, mut largest) = (j, column[j].abs());
        for (i, v) in column.iter().enumerate().skip(j + 1) {
            if v.abs() > largest {
                (at, largest) = (i, v.abs());
            }
        }
        swaps[j] = at as u32;
        if at != j {
            pivots.negative = !pivots.negative;
            for column in data.chunks_mut(height).take(n) {
                column[range.clone()].swap(j, at);
            }
        }
        let (left, right) = data.split_at_mut((j + 1) * height);
        let column = &mut left[j * height..][range.clone()];
        let pivot = pivots.see(column[j], first + j);
        column[j] = pivot;
        let factor = 1.0 / pivot;
        let (_, below) = column.split_at_mut(j + 1);
        for v in below.iter_mut() {
            *v *= factor;
        }
        for other in right.chunks_mut(height).take(n - j - 1) {
            let (upper, rest) = other[range.clone()].split_at_mut(j + 1);
            let scale = upper[j];
            for (r, l) in rest.iter_mut().zip(below.iter()) {
                *r -= scale * l;
            }
        }
    }
}
