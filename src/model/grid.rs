//! What a structured mesh takes, from its counts of elements alone.
use crate::machine::memory::times;
use crate::mesh::ElementKind;
use crate::mesh::size::FACES;
use crate::scene::Element;
use crate::shell::{Memory, bytes_per_element};
use std::collections::HashMap;

/// A generated mesh before it is made: `counts` elements along r, s and t.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Grid {
    pub element: Element,
    pub counts: [u32; 3],
    /// What its material remembers.
    pub memory: Memory,
}

/// Bytes of a node in a mesh (position) and in the vectors of a solution (six of three numbers, seven fields).
const NODE: u64 = 24 + 6 * 24 + 100;
/// Bytes of a pair of coupled nodes: nine numbers, their copy in the order of elimination, the indices of both.
const BLOCK: u64 = 72 + 72 + 36 + 12;
/// What orderings of real programs and the zeros of supernodes add to ideal dissection, measured: nothing for narrow strips
/// (.9 times), 1.3 times for shells, 1.8 times for solids. Half is added, so that all are within a factor of two.
const REAL: [u64; 2] = [3, 2];
/// Up to so many nodes are eliminated at once in [`fill`].
const LEAF: u64 = 16;

impl Grid {
    fn kind(&self) -> ElementKind {
        self.element.into()
    }

    /// Nodes along the three directions.
    fn along(&self) -> [u64; 3] {
        let order = match self.kind() {
            ElementKind::H8 => [1, 1, 1],
            ElementKind::Q18 | ElementKind::Nurbs => [2, 2, 1],
        };
        std::array::from_fn(|d| u64::from(self.counts[d]) * order[d] + 1)
    }

    /// Number of elements.
    pub fn elements(&self) -> u64 {
        product(self.counts.map(u64::from))
    }

    /// Number of nodes (a closed turn has a few less).
    pub fn nodes(&self) -> u64 {
        product(self.along())
    }

    /// Pairs of nodes that share an element, each counted once, with a node and itself. Nodes share one where they share
    /// an interval in every direction, so that the ordered pairs are a product: `3 m - 2` of m nodes of linear elements,
    /// `8 n + 1` of n quadratic ones.
    pub fn blocks(&self) -> u64 {
        let pairs = |d: usize| {
            let n = u64::from(self.counts[d]);
            match self.kind() {
                ElementKind::Q18 if d < 2 => 8 * n + 1,
                _ => 3 * n + 1,
            }
        };
        product([pairs(0), pairs(1), pairs(2)]).saturating_add(self.nodes()) / 2
    }

    /// Blocks of 3 x 3 in the Cholesky factor under nested dissection (George 1973): the grid is cut in half across its
    /// longest side again and again, and the nodes of each cut are eliminated after both halves, coupled with each other
    /// and with all earlier cuts around. Half of it is added for what is not ideal.
    pub fn factor_blocks(&self) -> u64 {
        let ideal = fill(self.along(), [[false; 2]; 3], &mut HashMap::new());
        times(ideal, REAL[0]) / REAL[1]
    }

    /// Bytes of a run on this mesh at its largest: mesh, elements with their states, matrix and factor; `symmetric` ones
    /// keep one triangle of both.
    pub fn bytes(&self, symmetric: bool) -> u64 {
        let elements = self.elements();
        let nodes = self.kind().nodes() as u64;
        let maps = 4 * nodes * (nodes + 1) / 2;
        let [block, states] = bytes_per_element(self.element, self.memory).map(|b| b as u64);
        let each = 4 * nodes + FACES + maps + block + states;
        let both = if symmetric { 1 } else { 2 };
        let factor = times(self.factor_blocks(), 72 * both);
        let matrix = times(self.blocks(), BLOCK + 36 * (both - 1));
        [
            times(self.nodes(), NODE),
            times(elements, each),
            matrix,
            factor,
        ]
        .into_iter()
        .fold(0, u64::saturating_add)
    }
}

fn product(of: [u64; 3]) -> u64 {
    of.into_iter().fold(1, u64::saturating_mul)
}

/// Blocks of the factor of a box of nodes, `cut` saying at which ends of each direction cuts lie beside it.
fn fill(size: [u64; 3], cut: [[bool; 2]; 3], known: &mut Known) -> u64 {
    if let Some(&blocks) = known.get(&(size, cut)) {
        return blocks;
    }
    let nodes = product(size);
    let around = (0..3).fold(0u64, |sum, d| {
        let sides = cut[d].iter().filter(|c| **c).count() as u64;
        sum.saturating_add(times(sides, nodes / size[d].max(1)))
    });
    let dense =
        |own: u64| times(own, own.saturating_add(1)) / 2 + times(own, around).min(u64::MAX / 2);
    let longest = (0..3).max_by_key(|&d| size[d]).unwrap_or(0);
    let blocks = if nodes <= LEAF || size[longest] < 3 {
        dense(nodes)
    } else {
        let half = |length: u64, side: usize| {
            let (mut size, mut cut) = (size, cut);
            size[longest] = length;
            cut[longest][side] = true;
            (size, cut)
        };
        let rest = size[longest] - 1;
        let (low, high) = (half(rest / 2, 1), half(rest - rest / 2, 0));
        dense(nodes / size[longest])
            .saturating_add(fill(low.0, low.1, known))
            .saturating_add(fill(high.0, high.1, known))
    };
    known.insert((size, cut), blocks);
    blocks
}

type Known = HashMap<([u64; 3], [[bool; 2]; 3]), u64>;

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::{Mesh, plate};
    use crate::scene::Plate;
    use crate::system::Pattern;
    use crate::system::linear::{DirectSolver, LinearSolver};
    use std::sync::Arc;

    fn mesh(grid: &Grid) -> Mesh {
        let [r, s, layers] = grid.counts;
        let text = format!(
            r#"{{"size": [1, 1], "thickness": 1, "elements": [{r}, {s}], "layers": {layers}}}"#
        );
        let described: Plate = serde_json::from_str(&text).unwrap();
        plate(&described, grid.kind()).unwrap()
    }

    #[test]
    fn counts_and_fill_are_those_of_the_mesh() {
        for (element, counts) in [
            (Element::H8, [40, 30, 1]),
            (Element::H8, [9, 8, 10]),
            (Element::H8, [60, 2, 1]),
            (Element::Q18, [14, 11, 2]),
        ] {
            let grid = Grid {
                element,
                counts,
                memory: Memory::NONE,
            };
            let mesh = mesh(&grid);
            assert_eq!(grid.nodes(), mesh.nodes.len() as u64);
            assert_eq!(grid.elements(), mesh.elements() as u64);
            let groups = (0..mesh.elements()).map(|e| mesh.element(e));
            let pattern = Arc::new(Pattern::new(mesh.nodes.len(), groups).unwrap());
            assert_eq!(grid.blocks(), pattern.blocks() as u64);
            let mut solver = DirectSolver::default();
            let stored = solver.analyze(&pattern).unwrap().stored as f64;
            let ratio = 9.0 * grid.factor_blocks() as f64 / stored;
            println!("{counts:?}: estimated / stored {ratio:.2}");
            assert!((0.5..2.0).contains(&ratio), "{counts:?}: {ratio}");
        }
    }

    #[test]
    fn nothing_overflows() {
        let grid = Grid {
            element: Element::Q18,
            counts: [u32::MAX; 3],
            memory: Memory::NONE,
        };
        assert_eq!(grid.bytes(false), u64::MAX);
        assert!(grid.bytes(true) > 1 << 62);
        let plate = Grid {
            element: Element::H8,
            counts: [u32::MAX, u32::MAX, 1],
            memory: Memory {
                numbers: 14,
                symmetric: true,
            },
        };
        assert!(plate.bytes(true) > 1 << 62);
    }
}
