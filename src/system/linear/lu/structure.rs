//! Supernodes of nodes, and where the blocks of the matrix and the updates of a supernode go.
use super::super::permuted::PermutedBlocks;
use faer::sparse::linalg::cholesky::supernodal::SymbolicSupernodalCholesky;

/// Values of an update's product held at once, so that it stays in the cache between being made and being added.
const PRODUCT: usize = 1 << 16;

/// Structure of the factors. A supernode owns the nodes `begins[s]..begins[s + 1]`; its panel is the columns of `L`
/// (with `U` of the diagonal block in the upper triangle) and then the transposed rows of `U` right of that block, both
/// column-major.
pub(super) struct Structure {
    pub begins: Vec<u32>,
    row_starts: Vec<u32>,
    /// Nodes below the diagonal block, ascending.
    rows: Vec<u32>,
    panel_starts: Vec<usize>,
    /// Supernode of each node.
    pub owner: Vec<u32>,
    /// Row of each block of the permuted matrix in its supernode's panel, counted in nodes.
    pub targets: Vec<u32>,
    /// Room for the largest product.
    pub product: usize,
    /// Largest number of dofs below a diagonal block.
    pub below: usize,
}

/// Sizes of one supernode in dofs.
#[derive(Debug, Clone, Copy)]
pub(super) struct Shape {
    /// First dof.
    pub begin: usize,
    /// Columns of `L`.
    pub columns: usize,
    /// Rows below the diagonal block.
    pub below: usize,
}

impl Shape {
    /// Rows of `L`.
    pub fn height(self) -> usize {
        self.columns + self.below
    }

    /// Values of `L`, with the diagonal block.
    pub fn lower(self) -> usize {
        self.height() * self.columns
    }

    /// Values of the panel.
    pub fn values(self) -> usize {
        self.lower() + self.below * self.columns
    }
}

impl Structure {
    pub fn new(symbolic: &SymbolicSupernodalCholesky<u32>, blocks: &PermutedBlocks) -> Self {
        let count = symbolic.n_supernodes();
        let nodes = symbolic.nrows();
        let mut begins = symbolic.supernode_begin().to_vec();
        begins.push(nodes as u32);
        let (mut row_starts, mut rows) = (vec![0u32], Vec::new());
        let mut owner = vec![0u32; nodes];
        for s in 0..count {
            rows.extend_from_slice(symbolic.supernode(s).pattern());
            row_starts.push(rows.len() as u32);
            owner[begins[s] as usize..begins[s + 1] as usize].fill(s as u32);
        }
        let mut structure = Structure {
            begins,
            row_starts,
            rows,
            panel_starts: vec![0],
            owner,
            targets: Vec::new(),
            product: 0,
            below: 0,
        };
        let mut values = 0;
        for s in 0..count {
            let shape = structure.shape(s);
            values += shape.values();
            structure.panel_starts.push(values);
            structure.below = structure.below.max(shape.below);
        }
        structure.product = (0..count)
            .map(|s| structure.largest_product(s))
            .max()
            .unwrap_or(0);
        structure.targets = structure.targets(blocks);
        structure
    }

    /// Number of supernodes.
    pub fn count(&self) -> usize {
        self.begins.len() - 1
    }

    /// Values of all panels.
    pub fn values(&self) -> usize {
        self.panel_starts[self.count()]
    }

    /// Bytes of the index arrays.
    pub fn bytes(&self) -> usize {
        4 * (self.begins.len() + self.row_starts.len() + self.rows.len() + self.owner.len())
            + 4 * self.targets.len()
            + 8 * self.panel_starts.len()
    }

    /// Nodes below the diagonal block of a supernode.
    pub fn rows(&self, s: usize) -> &[u32] {
        &self.rows[self.row_starts[s] as usize..self.row_starts[s + 1] as usize]
    }

    pub fn shape(&self, s: usize) -> Shape {
        let (begin, end) = (self.begins[s] as usize, self.begins[s + 1] as usize);
        Shape {
            begin: 3 * begin,
            columns: 3 * (end - begin),
            below: 3 * (self.row_starts[s + 1] - self.row_starts[s]) as usize,
        }
    }

    /// Where the panel of a supernode begins.
    pub fn panel_start(&self, s: usize) -> usize {
        self.panel_starts[s]
    }

    /// `L` (with the diagonal block) and the transpose of `U` of a supernode.
    pub fn panel<'a>(&self, s: usize, values: &'a [f64]) -> (&'a [f64], &'a [f64]) {
        values[self.panel_starts[s]..self.panel_starts[s + 1]].split_at(self.shape(s).lower())
    }

    /// Number of columns (of nodes) in which an update with `rows` dofs of rows is made at once.
    pub fn columns_at_once(rows: usize) -> usize {
        (PRODUCT / (3 * rows.max(1))).max(8)
    }

    /// Values of the largest product among the updates that a supernode makes.
    fn largest_product(&self, s: usize) -> usize {
        let rows = self.rows(s);
        let (mut from, mut largest) = (0, 0);
        while from < rows.len() {
            let end = self.begins[self.owner[rows[from] as usize] as usize + 1];
            let columns = rows[from..].partition_point(|&r| r < end);
            // With the rows of the columns themselves, and with those behind them: fewer rows may be taken with so many more
            // columns at once that their product is the larger one.
            let height = rows.len() - from;
            for height in [3 * height, 3 * (height - columns)] {
                largest = largest.max(product_values(height, columns));
            }
            from += columns;
        }
        largest
    }

    fn targets(&self, blocks: &PermutedBlocks) -> Vec<u32> {
        let mut targets = vec![0u32; blocks.rows.len()];
        let mut local = vec![0u32; self.owner.len()];
        for s in 0..self.count() {
            let (begin, end) = (self.begins[s], self.begins[s + 1]);
            for (i, row) in (begin..end).chain(self.rows(s).iter().copied()).enumerate() {
                local[row as usize] = i as u32;
            }
            let range = blocks.starts[begin as usize]..blocks.starts[end as usize];
            for block in range.start as usize..range.end as usize {
                targets[block] = local[blocks.rows[block] as usize];
            }
        }
        targets
    }
}

/// Values of the largest product of `height` rows with some of `columns` nodes' columns.
fn product_values(height: usize, columns: usize) -> usize {
    height * 3 * columns.min(Structure::columns_at_once(height))
}

#[cfg(test)]
mod tests {
    use super::product_values;

    #[test]
    fn fewer_rows_may_need_more_room() {
        let (all, behind) = (product_values(3 * 227, 40), product_values(3 * 208, 40));
        assert!(behind > all, "{behind} {all}");
    }
}
