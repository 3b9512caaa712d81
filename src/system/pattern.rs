//! The sparsity pattern: which pairs of nodes have a 3 x 3 block.
use crate::machine::memory::{self, Shortage};

/// Why a pattern could not be built or does not fit.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum PatternError {
    /// A group names a node that does not exist.
    #[error("group {group} names node {node}, but there are only {nodes} nodes")]
    NodeOutOfRange {
        /// Number of the group.
        group: usize,
        /// The node that it names.
        node: u32,
        /// Number of nodes.
        nodes: usize,
    },
    /// More blocks or nodes than 32-bit indices can count.
    #[error("{nodes} nodes with {blocks} coupled pairs are more than 32-bit indices can count")]
    TooLarge {
        /// Number of nodes.
        nodes: usize,
        /// Number of pairs of nodes that are coupled.
        blocks: usize,
    },
    /// The matrix on it does not fit in memory.
    #[error("the matrix of {nodes} nodes with {blocks} coupled pairs: {shortage}")]
    Memory {
        /// Number of nodes.
        nodes: usize,
        /// Number of pairs of nodes that are coupled.
        blocks: usize,
        /// How much there is and how much is needed.
        shortage: Shortage,
    },
    /// Two nodes of an element are not coupled in the pattern.
    #[error("nodes {row} and {column} are not coupled in the pattern")]
    NotCoupled {
        /// Node of the row.
        row: u32,
        /// Node of the column.
        column: u32,
    },
}

/// The largest number of blocks: a map entry is a block number and two flag bits, and dof entries (nine a block) are
/// counted with signed 32 bits.
const MAX_BLOCKS: usize = (i32::MAX / 9) as usize;

/// Map flag: the block is stored as the transpose of the pair's block.
pub(super) const TRANSPOSED: u32 = 1;
/// Map flag: both positions of the pair are the same node, so that both triangles go to its diagonal block.
pub(super) const SAME_NODE: u32 = 2;
/// Bits of a map entry that are flags.
pub(super) const FLAG_BITS: u32 = 2;

/// A symmetric pattern of 3 x 3 blocks: the lower triangle by columns of nodes, rows ascending, so that every column
/// starts with its diagonal block. Immutable; matrices and solvers share it behind an `Arc`.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Pattern {
    column_starts: Vec<u32>,
    rows: Vec<u32>,
    /// Nodes at the end that couple with so many others that they are to be eliminated last.
    border: u32,
    id: u64,
}

impl Pattern {
    /// Bytes of heap that it holds.
    pub fn bytes(&self) -> usize {
        (self.column_starts.capacity() + self.rows.capacity()) * size_of::<u32>()
    }

    /// The pattern of `nodes` nodes in which all nodes of each group are coupled with each other (an element's nodes;
    /// the nodes of a contact point and of the surface it may touch). Every node has its diagonal block, coupled or
    /// not. Groups may overlap, repeat and name a node twice. The iterator is walked three times.
    ///
    /// # Errors
    /// [`PatternError::NodeOutOfRange`] with the number of the group, [`PatternError::TooLarge`].
    pub fn new<'a, G>(nodes: usize, groups: G) -> Result<Self, PatternError>
    where
        G: Iterator<Item = &'a [u32]> + Clone,
    {
        if nodes > (i32::MAX / 3) as usize {
            return Err(PatternError::TooLarge { nodes, blocks: 0 });
        }
        let starts = group_starts(nodes, groups.clone())?;
        let mut groups_of = vec![0u32; starts[nodes]];
        let mut next = starts.clone();
        for (g, group) in groups.clone().enumerate() {
            for &node in group {
                let at = &mut next[node as usize];
                groups_of[*at] = g as u32;
                *at += 1;
            }
        }
        drop(next);
        // Random access to the groups, which the iterator does not give.
        let mut members = Vec::new();
        let mut member_starts = vec![0usize];
        for group in groups {
            members.extend_from_slice(group);
            member_starts.push(members.len());
        }
        let mut column_starts = Vec::with_capacity(nodes + 1);
        column_starts.push(0u32);
        let mut rows: Vec<u32> = Vec::new();
        let mut seen = vec![u32::MAX; nodes];
        for column in 0..nodes as u32 {
            let first = rows.len();
            rows.push(column);
            seen[column as usize] = column;
            for &g in &groups_of[starts[column as usize]..starts[column as usize + 1]] {
                let range = member_starts[g as usize]..member_starts[g as usize + 1];
                for &row in &members[range] {
                    if row > column && seen[row as usize] != column {
                        seen[row as usize] = column;
                        rows.push(row);
                    }
                }
            }
            rows[first..].sort_unstable();
            if rows.len() > MAX_BLOCKS {
                let blocks = rows.len();
                return Err(PatternError::TooLarge { nodes, blocks });
            }
            column_starts.push(rows.len() as u32);
        }
        let id = hash(&column_starts, &rows);
        Ok(Self {
            column_starts,
            rows,
            border: 0,
            id,
        })
    }

    /// Says that the last `nodes` nodes couple with very many others (a rigid body's with all that it may touch):
    /// solvers eliminate them after all others.
    pub fn with_border(mut self, nodes: u32) -> Self {
        self.border = nodes.min(self.nodes() as u32);
        self.id ^= u64::from(self.border).wrapping_mul(0x9e37_79b9_7f4a_7c15);
        self
    }

    /// Whether there is memory for a matrix on this pattern.
    ///
    /// # Errors
    /// [`PatternError::Memory`].
    pub fn fits(&self, symmetric: bool) -> Result<(), PatternError> {
        let each = if symmetric { 72 } else { 144 };
        let bytes = memory::times(self.blocks() as u64, each);
        memory::ask(bytes).map_err(|shortage| PatternError::Memory {
            nodes: self.nodes(),
            blocks: self.blocks(),
            shortage,
        })
    }

    /// Number of nodes at the end that are to be eliminated last.
    pub fn border(&self) -> usize {
        self.border as usize
    }

    /// Number of nodes.
    pub fn nodes(&self) -> usize {
        self.column_starts.len() - 1
    }

    /// Number of degrees of freedom, `3 * nodes`.
    pub fn dofs(&self) -> usize {
        3 * self.nodes()
    }

    /// Number of stored 3 x 3 blocks (lower triangle with diagonal).
    pub fn blocks(&self) -> usize {
        self.rows.len()
    }

    /// A hash of the structure: equal for equal patterns, and different for different ones but for a chance of about
    /// one in 2^64. Solvers compare it before they trust their symbolic factorization.
    pub fn id(&self) -> u64 {
        self.id
    }

    /// Starts of the node columns in [`rows`](Self::rows): `nodes + 1` numbers.
    pub fn column_starts(&self) -> &[u32] {
        &self.column_starts
    }

    /// Row nodes of all blocks, column after column, ascending within a column.
    pub fn rows(&self) -> &[u32] {
        &self.rows
    }

    /// Row nodes of one column, the diagonal first. `column` must be below [`nodes`](Self::nodes).
    pub fn column(&self, column: usize) -> &[u32] {
        &self.rows[self.column_starts[column] as usize..self.column_starts[column + 1] as usize]
    }

    /// Number of the stored block of nodes `a` and `b` in either order, if they are coupled.
    pub fn block(&self, a: u32, b: u32) -> Option<u32> {
        let (row, column) = (a.max(b), a.min(b) as usize);
        if row as usize >= self.nodes() {
            return None;
        }
        let k = self.column(column).binary_search(&row).ok()?;
        Some(self.column_starts[column] + k as u32)
    }

    /// Appends to `out` where an element's matrix goes: one number for each pair of its `n` nodes, `n (n + 1) / 2` in
    /// all, in the order of the lower triangle by columns, (0,0), (1,0), ..., (n-1,0), (1,1), ... Made once for each
    /// element and given to [`SystemMatrix::scatter`](super::SystemMatrix::scatter). A node may occur twice in a
    /// degenerate element.
    ///
    /// # Errors
    /// [`PatternError::NotCoupled`]; `out` is then as it was.
    pub fn element_map(&self, nodes: &[u32], out: &mut Vec<u32>) -> Result<(), PatternError> {
        let before = out.len();
        for (q, &column) in nodes.iter().enumerate() {
            for (p, &row) in nodes.iter().enumerate().skip(q) {
                let Some(block) = self.block(row, column) else {
                    out.truncate(before);
                    return Err(PatternError::NotCoupled { row, column });
                };
                let flags = match row.cmp(&column) {
                    std::cmp::Ordering::Less => TRANSPOSED,
                    std::cmp::Ordering::Equal if p != q => SAME_NODE,
                    _ => 0,
                };
                out.push(block << FLAG_BITS | flags);
            }
        }
        Ok(())
    }

    /// Appends to `out` the number of the first value of the blocks of all pairs of `nodes`, for
    /// [`SystemMatrix::scatter_point`](super::SystemMatrix::scatter_point), in the order of [`Self::element_map`]. No node may
    /// occur twice.
    ///
    /// # Errors
    /// [`PatternError::NotCoupled`].
    pub fn point_places(&self, nodes: &[u32], out: &mut Vec<u32>) -> Result<(), PatternError> {
        let before = out.len();
        self.element_map(nodes, out)?;
        for code in &mut out[before..] {
            // Fits: see MAX_BLOCKS.
            *code = 9 * (*code >> FLAG_BITS);
        }
        Ok(())
    }
}

/// How many groups each node is in, summed up to starts; checks all node numbers.
fn group_starts<'a>(
    nodes: usize,
    groups: impl Iterator<Item = &'a [u32]>,
) -> Result<Vec<usize>, PatternError> {
    let mut starts = vec![0usize; nodes + 1];
    for (group, members) in groups.enumerate() {
        if group > u32::MAX as usize {
            return Err(PatternError::TooLarge { nodes, blocks: 0 });
        }
        for &node in members {
            if node as usize >= nodes {
                return Err(PatternError::NodeOutOfRange { group, node, nodes });
            }
            starts[node as usize + 1] += 1;
        }
    }
    for i in 0..nodes {
        starts[i + 1] += starts[i];
    }
    Ok(starts)
}

/// A 64-bit hash of the structure: every word is mixed in with the multiply-and-xorshift step of splitmix64 (Steele,
/// Lea, Flood 2014), which spreads each bit over all others.
fn hash(column_starts: &[u32], rows: &[u32]) -> u64 {
    let mut h = column_starts.len() as u64;
    for &word in column_starts.iter().chain(rows) {
        h = (h ^ u64::from(word)).wrapping_add(0x9e37_79b9_7f4a_7c15);
        h = (h ^ (h >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        h = (h ^ (h >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        h ^= h >> 31;
    }
    h
}
