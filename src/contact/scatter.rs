//! From the nine slots of a contact point to the element matrix of its nodes.
use super::kernel::SlotMatrix;
use covact_geometry::ShapeRows;
use nalgebra::Matrix3;

/// Element matrix of a contact point between two bodies, column-major with dof `3 * node + component`, the slave's nodes
/// first: `k` is the point's tangent per unit area, `slave` holds the shape functions `N_s` of the slave point, `master`
/// those of the facet at the foot. Rows of the slots are `{N_s, 0, 0}` and `{-N_k, N_k,1, N_k,2}`; products with those
/// zeros are not formed. `k` need not be symmetric.
///
/// # Panics
/// If `ke` does not have `(3 (slave + master))^2` values.
pub fn assemble_point(
    k: &SlotMatrix,
    slave: &[f64],
    master: &ShapeRows,
    area: f64,
    ke: &mut [f64],
) {
    let (s, m) = (slave.len(), master.count);
    let size = 3 * (s + m);
    assert_eq!(ke.len(), size * size, "matrix of another size");
    let block = |a: usize, b: usize| -> Matrix3<f64> {
        k.fixed_view::<3, 3>(3 * a, 3 * b).into_owned() * area
    };
    let blocks: [[Matrix3<f64>; 3]; 3] =
        std::array::from_fn(|a| std::array::from_fn(|b| block(a, b)));
    let row = |j: usize| [-master.n[j], master.n_1[j], master.n_2[j]];
    // One column of blocks at a time; `column[a]` is what slot a feels of the column's node.
    let mut put = |at: usize, column: &[Matrix3<f64>; 3]| {
        for c in 0..3 {
            let [c0, c1, c2] = [0, 1, 2].map(|a: usize| column[a].column(c));
            let out = &mut ke[(3 * at + c) * size..][..size];
            let (top, bottom) = out.split_at_mut(3 * s);
            for (rows, n) in top.chunks_exact_mut(3).zip(slave) {
                for r in 0..3 {
                    rows[r] = n * c0[r];
                }
            }
            for (j, rows) in bottom.chunks_exact_mut(3).enumerate() {
                let w = row(j);
                for r in 0..3 {
                    rows[r] = w[0] * c0[r] + w[1] * c1[r] + w[2] * c2[r];
                }
            }
        }
    };
    for (at, n) in slave.iter().enumerate() {
        put(at, &[0, 1, 2].map(|a: usize| blocks[a][0] * *n));
    }
    for j in 0..m {
        let w = row(j);
        put(
            s + j,
            &[0, 1, 2]
                .map(|a: usize| blocks[a][0] * w[0] + blocks[a][1] * w[1] + blocks[a][2] * w[2]),
        );
    }
}

/// What is left of a point's matrix in a half pass, whose traction acts on the slave alone: the slave's rows. `ke` as of
/// [`assemble_point`], for so many nodes of each side.
pub fn keep_slave_rows(slave: usize, master: usize, ke: &mut [f64]) {
    for column in ke.chunks_exact_mut(3 * (slave + master)) {
        column[3 * slave..].fill(0.0);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::contact::kernel::assemble_block;

    /// Against the blocks formed one by one, with a tangent that has no symmetry.
    #[test]
    fn the_matrix_of_a_point_is_made_of_its_blocks() {
        let k = SlotMatrix::from_fn(|i, j| ((7 * i + 3 * j) as f64).sin());
        let slave = [0.3, 0.5, 0.2];
        let mut master = ShapeRows {
            count: 4,
            ..ShapeRows::default()
        };
        for j in 0..4 {
            let x = j as f64;
            (master.n[j], master.n_1[j], master.n_2[j]) = (0.1 * x, (x + 1.0).cos(), x - 0.7);
        }
        let (n, area) = (7, 1.7);
        let mut ke = vec![f64::NAN; 9 * n * n];
        assemble_point(&k, &slave, &master, area, &mut ke);
        let row = |i: usize| match i {
            0..3 => [slave[i], 0.0, 0.0],
            _ => [-master.n[i - 3], master.n_1[i - 3], master.n_2[i - 3]],
        };
        let mut largest = 0.0f64;
        for i in 0..n {
            for j in 0..n {
                let block = assemble_block(&k, &row(i), &row(j)) * area;
                for r in 0..3 {
                    for c in 0..3 {
                        let found = ke[(3 * j + c) * 3 * n + 3 * i + r];
                        assert!((found - block[(r, c)]).abs() < 1e-14, "{i} {j} {r} {c}");
                        largest = largest.max(found.abs());
                    }
                }
            }
        }
        assert!(largest > 1.0);
    }
}
