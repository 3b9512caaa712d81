//! Entries of elements, added to the values of a matrix.
use crate::system::pattern::{FLAG_BITS, SAME_NODE, TRANSPOSED};
use nalgebra::Matrix3;

pub(super) fn element_nodes(map: usize, ke: usize) -> usize {
    let n = ke.isqrt() / 3;
    assert!(
        9 * n * n == ke && n * (n + 1) / 2 == map,
        "the map is not of an element of this size"
    );
    n
}

pub(super) fn scatter_into(values: &mut [f64], map: &[u32], ke: &[f64], n: usize) {
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

/// Adds `w_a w_b k` to the block of every pair of nodes.
#[inline(always)]
pub(super) fn add_multiples(values: &mut [f64], places: &[u32], weights: &[f64], k: &Matrix3<f64>) {
    let k: [f64; 9] = std::array::from_fn(|i| k.as_slice()[i]);
    let mut places = places.iter();
    for (q, wq) in weights.iter().enumerate() {
        for (wp, first) in weights[q..].iter().zip(&mut places) {
            let (w, first) = (wp * wq, *first as usize);
            for (out, k) in values[first..first + 9].iter_mut().zip(&k) {
                *out += w * k;
            }
        }
    }
}

/// Adds only the blocks that `values`, which starts at block `first`, holds.
pub(super) fn scatter_into_range(
    values: &mut [f64],
    first: u32,
    map: &[u32],
    ke: &[f64],
    n: usize,
) {
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

/// Adds an unsymmetric element matrix, as far as `values` and `transposed`, which start at block `first`, hold its
/// blocks.
pub(super) fn scatter_both_into(
    values: &mut [f64],
    transposed: &mut [f64],
    first: u32,
    map: &[u32],
    ke: &[f64],
    n: usize,
) {
    let count = (values.len() / 9) as u32;
    let size = 3 * n;
    let mut at = 0;
    for q in 0..n {
        for p in q..n {
            let code = map[at];
            at += 1;
            let block = (code >> FLAG_BITS).wrapping_sub(first);
            if block >= count {
                continue;
            }
            let start = 9 * block as usize;
            let lower = &mut values[start..start + 9];
            let flags = code & (TRANSPOSED | SAME_NODE);
            let (row, column) = if flags == TRANSPOSED { (q, p) } else { (p, q) };
            add_plain(lower, ke, size, row, column);
            if flags == SAME_NODE {
                add_plain(lower, ke, size, column, row);
            } else if p != q {
                let upper = &mut transposed[start..start + 9];
                add_turned(upper, ke, size, column, row);
            }
        }
    }
}

/// Adds the block of local nodes (row, column) of `ke`.
#[inline(always)]
pub(super) fn add_plain(block: &mut [f64], ke: &[f64], size: usize, row: usize, column: usize) {
    for b in 0..3 {
        let from = &ke[(3 * column + b) * size + 3 * row..][..3];
        for a in 0..3 {
            block[3 * b + a] += from[a];
        }
    }
}

/// Adds the transpose of the block of local nodes (row, column) of `ke`.
#[inline(always)]
pub(super) fn add_turned(block: &mut [f64], ke: &[f64], size: usize, row: usize, column: usize) {
    for b in 0..3 {
        let from = &ke[(3 * column + b) * size + 3 * row..][..3];
        for a in 0..3 {
            block[3 * a + b] += from[a];
        }
    }
}

/// Adds the 3 x 3 block of `ke` at (row, column) to a stored block, as the flags of its map entry say.
#[inline(always)]
pub(super) fn add_block(
    block: &mut [f64],
    code: u32,
    ke: &[f64],
    size: usize,
    row: usize,
    column: usize,
) {
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
