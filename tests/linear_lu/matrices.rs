//! Matrices that are solved, and the solution of another solver.
use covact::system::{Pattern, SystemMatrix};
use faer::prelude::Solve;
use faer::sparse::{SparseColMat, Triplet};
use nalgebra::DMatrix;
use std::sync::Arc;

/// A small generator of repeatable numbers in [-0.5, 0.5) (splitmix64).
pub struct Random(pub u64);

impl Random {
    pub fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        (z ^ (z >> 31)) as f64 / 2f64.powi(64) - 0.5
    }

    pub fn vector(&mut self, n: usize) -> Vec<f64> {
        (0..n).map(|_| self.next()).collect()
    }
}

/// Elements of a brick of `n` nodes: eight corners of every cell.
pub fn cells(n: [u32; 3]) -> Vec<[u32; 8]> {
    let node = |i, j, k| i + n[0] * (j + n[1] * k);
    let mut out = Vec::new();
    for k in 1..n[2] {
        for j in 1..n[1] {
            for i in 1..n[0] {
                out.push(std::array::from_fn(|c| {
                    let c = c as u32;
                    node(i - 1 + (c & 1), j - 1 + (c >> 1 & 1), k - 1 + (c >> 2))
                }));
            }
        }
    }
    out
}

pub fn brick(n: [u32; 3]) -> (Arc<Pattern>, Vec<[u32; 8]>) {
    let elements = cells(n);
    let nodes = (n[0] * n[1] * n[2]) as usize;
    let pattern = Pattern::new(nodes, elements.iter().map(|e| &e[..])).unwrap();
    (Arc::new(pattern), elements)
}

/// Adds the 24 x 24 matrices that `make` writes (column-major) to an unsymmetric matrix.
pub fn assembled(
    pattern: &Arc<Pattern>,
    elements: &[[u32; 8]],
    mut make: impl FnMut(&mut [f64]),
) -> SystemMatrix {
    let mut matrix = SystemMatrix::unsymmetric(Arc::clone(pattern));
    let mut map = Vec::new();
    let mut ke = [0.0; 576];
    for element in elements {
        ke.fill(0.0);
        make(&mut ke);
        map.clear();
        pattern.element_map(element, &mut map).unwrap();
        matrix.scatter(&map, &ke);
    }
    matrix
}

/// Springs with random positive definite stiffness between all corners of a cell.
pub fn springs(ke: &mut [f64], random: &mut Random) {
    for p in 0..8 {
        for q in 0..p {
            let v = [random.next(), random.next(), random.next()];
            for a in 0..3 {
                for b in 0..3 {
                    let w = v[a] * v[b] + if a == b { 0.2 } else { 0.0 };
                    ke[24 * (3 * p + a) + 3 * p + b] += w;
                    ke[24 * (3 * q + a) + 3 * q + b] += w;
                    ke[24 * (3 * p + a) + 3 * q + b] -= w;
                    ke[24 * (3 * q + a) + 3 * p + b] -= w;
                }
            }
        }
    }
}

pub fn ground(matrix: &mut SystemMatrix, dof: usize, value: f64) {
    let old = matrix.get(dof, dof);
    matrix.set_identity(dof, old + value);
}

/// Entries without any order, the diagonal no larger than the rest.
pub fn random_matrix(n: [u32; 3], seed: u64) -> SystemMatrix {
    let (pattern, elements) = brick(n);
    let mut random = Random(seed);
    assembled(&pattern, &elements, |ke| {
        ke.iter_mut().for_each(|k| *k = random.next());
    })
}

/// Diffusion with a convection that outweighs it: an antisymmetric part of `peclet` times the symmetric one.
pub fn convection(n: [u32; 3], peclet: f64, seed: u64) -> SystemMatrix {
    let (pattern, elements) = brick(n);
    let mut random = Random(seed);
    let mut matrix = assembled(&pattern, &elements, |ke| {
        springs(ke, &mut random);
        for i in 0..24 {
            for j in 0..i {
                let w = peclet * 0.2 * random.next();
                ke[24 * j + i] += w;
                ke[24 * i + j] -= w;
            }
        }
    });
    (0..3).for_each(|d| ground(&mut matrix, d, 1.0));
    matrix
}

/// A lattice whose bottom nodes slide on a plane under Coulomb friction: a normal penalty, and tangential forces of
/// `mu` times the normal force, which depend on the normal displacement alone.
pub fn friction(n: [u32; 3], mu: f64, penalty: f64, seed: u64) -> SystemMatrix {
    let (pattern, elements) = brick(n);
    let mut random = Random(seed);
    let mut matrix = assembled(&pattern, &elements, |ke| springs(ke, &mut random));
    for node in 0..(n[0] * n[1]) as usize {
        ground(&mut matrix, 3 * node + 2, penalty);
        let first = 9 * matrix.pattern().column_starts()[node] as usize;
        let direction = [random.next(), random.next()];
        for (c, d) in direction.iter().enumerate() {
            matrix.values_mut()[first + 6 + c] += mu * penalty * d;
        }
    }
    (0..3).for_each(|d| ground(&mut matrix, 3 * 7 + d, 1.0));
    matrix
}

/// Rows and columns multiplied by factors over `decades` powers of ten.
pub fn ill_scaled(matrix: &mut SystemMatrix, decades: f64, same: bool, seed: u64) {
    let pattern = Arc::clone(matrix.pattern());
    let n = pattern.dofs();
    let mut random = Random(seed);
    let rows: Vec<f64> = (0..n)
        .map(|_| 10f64.powf(decades * random.next()))
        .collect();
    let columns: Vec<f64> = (0..n)
        .map(|d| {
            if same {
                rows[d]
            } else {
                10f64.powf(decades * random.next())
            }
        })
        .collect();
    let mut at = 0;
    for column in 0..pattern.nodes() {
        for &row in pattern.column(column) {
            for b in 0..3 {
                for a in 0..3 {
                    let (i, j) = (3 * row as usize + a, 3 * column + b);
                    matrix.values_mut()[at + 3 * b + a] *= rows[i] * columns[j];
                    let upper = matrix.transposed_values_mut().unwrap();
                    upper[at + 3 * b + a] *= rows[j] * columns[i];
                }
            }
            at += 9;
        }
    }
}

pub fn dense(matrix: &SystemMatrix) -> DMatrix<f64> {
    let n = matrix.pattern().dofs();
    DMatrix::from_fn(n, n, |i, j| matrix.get(i, j))
}

/// The solution of faer's sparse LU with full pivoting of rows, refined.
pub fn oracle(matrix: &SystemMatrix, rhs: &[f64]) -> Vec<f64> {
    let n = matrix.pattern().dofs();
    let mut triplets = Vec::new();
    for column in 0..matrix.pattern().nodes() as u32 {
        for &row in matrix.pattern().column(column as usize) {
            for i in 0..9 {
                let (r, c) = (3 * row + i % 3, 3 * column + i / 3);
                let entry = |r: u32, c: u32| Triplet::new(r, c, matrix.get(r as usize, c as usize));
                triplets.push(entry(r, c));
                if row != column {
                    triplets.push(entry(c, r));
                }
            }
        }
    }
    let sparse = SparseColMat::<u32, f64>::try_new_from_triplets(n, n, &triplets).unwrap();
    let lu = sparse.sp_lu().unwrap();
    let solve = |b: &[f64]| -> Vec<f64> {
        let x = lu.solve(faer::Col::from_fn(n, |i| b[i]));
        (0..n).map(|i| x[i]).collect()
    };
    let mut x = solve(rhs);
    // Its pivots are not scaled.
    for _ in 0..5 {
        let mut r = vec![0.0; n];
        matrix.multiply(&x, &mut r);
        r.iter_mut().zip(rhs).for_each(|(r, b)| *r = b - *r);
        for (x, c) in x.iter_mut().zip(solve(&r)) {
            *x += c;
        }
    }
    x
}

/// Twelve hubs that are all coupled and a leaf at each of them whose own block is zero: leaves are eliminated first, and
/// no exchange within a leaf's block helps, although the matrix is regular.
pub fn needs_other_supernode() -> SystemMatrix {
    let mut groups: Vec<Vec<u32>> = (0..12).map(|hub| vec![hub, 12 + hub]).collect();
    groups.push((0..12).collect());
    let pattern = Arc::new(Pattern::new(24, groups.iter().map(Vec::as_slice)).unwrap());
    let mut matrix = SystemMatrix::unsymmetric(Arc::clone(&pattern));
    let mut random = Random(12);
    let mut map = Vec::new();
    for group in &groups {
        let size = 3 * group.len();
        let mut ke = random.vector(size * size);
        for i in 0..size {
            // The coupling of a leaf with its hub is far from singular.
            ke[size * i + (i + size / 2) % size] += 2.0;
        }
        map.clear();
        pattern.element_map(group, &mut map).unwrap();
        matrix.scatter(&map, &ke);
    }
    for leaf in 12..24 {
        let block = 9 * pattern.block(leaf, leaf).unwrap() as usize;
        matrix.values_mut()[block..block + 9].fill(0.0);
    }
    matrix
}
