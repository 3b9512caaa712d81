//! What dynamics does to a system: all of it weighted, and masses, which are a number for every pair of nodes, added.
use super::SystemMatrix;
use super::pattern::{FLAG_BITS, SAME_NODE};

impl SystemMatrix {
    /// Multiplies every value by a factor.
    pub fn scale(&mut self, factor: f64) {
        self.values_mut().iter_mut().for_each(|v| *v *= factor);
        let transposed = self.transposed_values_mut().into_iter().flatten();
        transposed.for_each(|v| *v *= factor);
    }

    /// Adds `factor s` to the diagonals of the blocks of all pairs of an element's nodes: `map` is that of the element
    /// ([`Pattern::element_map`](super::Pattern::element_map)), `scalars` has a number `s` for each of its pairs.
    ///
    /// # Panics
    /// If `map` is of another, larger pattern.
    pub fn scatter_scalars(&mut self, map: &[u32], scalars: &[f64], factor: f64) {
        let add = |values: &mut [f64]| {
            for (code, s) in map.iter().zip(scalars) {
                // Both of its positions are the same node: the pair stands for two entries of one block.
                let times = if code & SAME_NODE != 0 { 2.0 } else { 1.0 };
                let first = 9 * (code >> FLAG_BITS) as usize;
                let block = &mut values[first..first + 9];
                for c in 0..3 {
                    block[4 * c] += times * factor * s;
                }
            }
        };
        add(self.values_mut());
        // Of blocks on the diagonal the second triangle means nothing.
        self.transposed_values_mut().into_iter().for_each(add);
    }
}

#[cfg(test)]
mod tests {
    use super::super::{Pattern, SystemMatrix};
    use std::sync::Arc;

    /// As the whole element matrix, with a node that occurs twice and one pair that is stored transposed.
    #[test]
    fn scalars_are_blocks_with_equal_diagonals() {
        for unsymmetric in [false, true] {
            let nodes = [2, 0, 1, 0];
            let group: &[u32] = &nodes;
            let pattern = Arc::new(Pattern::new(3, [group].into_iter()).expect("a pattern"));
            let mut map = Vec::new();
            pattern.element_map(&nodes, &mut map).expect("all coupled");
            let scalars: Vec<f64> = (0..map.len())
                .map(|i| 1.0 + (1.7 * i as f64).sin())
                .collect();
            let mut dense = vec![0.0; 144];
            let mut at = scalars.iter();
            for b in 0..4 {
                for (a, s) in (b..4).zip(&mut at) {
                    for c in 0..3 {
                        dense[(3 * b + c) * 12 + 3 * a + c] = 0.5 * s;
                        dense[(3 * a + c) * 12 + 3 * b + c] = 0.5 * s;
                    }
                }
            }
            let new = || match unsymmetric {
                true => SystemMatrix::unsymmetric(pattern.clone()),
                false => SystemMatrix::new(pattern.clone()),
            };
            let (mut found, mut expected) = (new(), new());
            found.scatter_scalars(&map, &scalars, 0.25);
            found.scale(2.0);
            expected.scatter(&map, &dense);
            assert!(expected.get(0, 6) != 0.0 && expected.get(0, 7) == 0.0);
            for i in 0..9 {
                for j in 0..9 {
                    let (a, b) = (found.get(i, j), expected.get(i, j));
                    assert!((a - b).abs() < 1e-15, "({i}, {j}): {a} {b}");
                }
            }
        }
    }
}
