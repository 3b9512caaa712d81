//! Fill-reducing orders of the nodes. The graph has one vertex for each node, not for each dof: nine times fewer
//! entries, and the three dofs of a node stay together in the factor.
use super::{LinearError, Ordering, OrderingChoice, metis};
use crate::system::Pattern;
use faer::dyn_stack::{MemBuffer, MemStack, StackReq};
use faer::sparse::SymbolicSparseColMatRef;
use faer::sparse::linalg::{amd, cholesky::simplicial};
use std::borrow::Cow;

/// Below this many nodes minimum degree alone is tried: nested dissection takes longer than all that it could save.
const METIS_MIN_NODES: usize = 1000;

/// An order of the nodes and what a factorization costs in it.
pub(super) struct NodeOrder {
    pub ordering: Ordering,
    /// `new_to_old[new] = old` and the reverse.
    pub new_to_old: Vec<u32>,
    pub old_to_new: Vec<u32>,
    /// Operations and nonzeros of the factor, in dofs.
    pub flops: f64,
    pub fill: u64,
    pub flops_amd: Option<f64>,
    pub flops_metis: Option<f64>,
    pub metis_failed: Option<i32>,
}

/// The order that `choice` asks for.
pub(super) fn order(pattern: &Pattern, choice: OrderingChoice) -> Result<NodeOrder, LinearError> {
    let n = pattern.nodes();
    let inner = Inner::new(pattern);
    let try_amd = choice != OrderingChoice::Metis;
    let try_metis = match choice {
        OrderingChoice::Amd => false,
        OrderingChoice::Metis => true,
        OrderingChoice::Best => n >= METIS_MIN_NODES,
    };
    let mut best: Option<NodeOrder> = None;
    if try_amd {
        let mut order = evaluate(
            pattern,
            Ordering::Amd,
            inner.complete(minimum_degree(&inner)?),
        )?;
        order.flops_amd = Some(order.flops);
        best = Some(order);
    }
    if try_metis {
        let (mut starts, mut neighbours) = adjacency(&inner);
        match (
            metis::nested_dissection(&mut starts, &mut neighbours),
            best.as_mut(),
        ) {
            (Ok(new_to_old), _) => {
                let mut order = evaluate(pattern, Ordering::Metis, inner.complete(new_to_old))?;
                let flops = order.flops;
                order.flops_amd = best.as_ref().map(|b| b.flops);
                let mut kept = match best {
                    Some(amd) if amd.flops <= flops => amd,
                    _ => order,
                };
                kept.flops_metis = Some(flops);
                best = Some(kept);
            }
            (Err(code), Some(amd)) => amd.metis_failed = Some(code),
            (Err(code), None) => return Err(LinearError::Metis { code }),
        }
    }
    // One of the two was tried, and every failure has returned.
    best.ok_or(LinearError::Metis { code: 0 })
}

/// The graph of all nodes but those of the pattern's border, which are eliminated last: a node that couples with half of
/// the others would only blind an ordering to the rest. Lower triangle with diagonal.
struct Inner<'a> {
    starts: Cow<'a, [u32]>,
    rows: Cow<'a, [u32]>,
    /// All nodes.
    nodes: u32,
}

impl<'a> Inner<'a> {
    fn new(pattern: &'a Pattern) -> Self {
        let nodes = pattern.nodes() as u32;
        if pattern.border() == 0 {
            return Inner {
                starts: Cow::Borrowed(pattern.column_starts()),
                rows: Cow::Borrowed(pattern.rows()),
                nodes,
            };
        }
        let n = pattern.nodes() - pattern.border();
        let (mut starts, mut rows) = (vec![0u32], Vec::new());
        for column in 0..n {
            rows.extend((pattern.column(column).iter()).filter(|row| (**row as usize) < n));
            starts.push(rows.len() as u32);
        }
        Inner {
            starts: Cow::Owned(starts),
            rows: Cow::Owned(rows),
            nodes,
        }
    }

    fn nodes(&self) -> usize {
        self.starts.len() - 1
    }

    fn column(&self, column: usize) -> &[u32] {
        &self.rows[self.starts[column] as usize..self.starts[column + 1] as usize]
    }

    /// An order of the inner nodes with those of the border appended.
    fn complete(&self, mut new_to_old: Vec<u32>) -> Vec<u32> {
        new_to_old.extend(self.nodes() as u32..self.nodes);
        new_to_old
    }

    /// As faer sees it.
    fn symbolic(&self) -> SymbolicSparseColMatRef<'_, u32> {
        let n = self.nodes();
        SymbolicSparseColMatRef::new_checked(n, n, &self.starts, None, &self.rows)
    }
}

fn minimum_degree(graph: &Inner) -> Result<Vec<u32>, LinearError> {
    let n = graph.nodes();
    let mut memory = buffer(amd::order_scratch::<u32>(n, graph.rows.len()))?;
    let (mut new_to_old, mut old_to_new) = (vec![0u32; n], vec![0u32; n]);
    amd::order(
        &mut new_to_old,
        &mut old_to_new,
        graph.symbolic(),
        amd::Control::default(),
        MemStack::new(&mut memory),
    )
    .map_err(|_| LinearError::TooLarge)?;
    Ok(new_to_old)
}

/// Neighbours of every node, both directions, without the node itself. METIS counts with signed 32 bits, which the
/// limit on blocks keeps.
fn adjacency(pattern: &Inner) -> (Vec<i32>, Vec<i32>) {
    let n = pattern.nodes();
    let mut starts = vec![0i32; n + 1];
    for column in 0..n {
        for &row in &pattern.column(column)[1..] {
            starts[column + 1] += 1;
            starts[row as usize + 1] += 1;
        }
    }
    for i in 0..n {
        starts[i + 1] += starts[i];
    }
    let mut next = starts.clone();
    let mut neighbours = vec![0i32; starts[n] as usize];
    let mut add = |a: usize, b: usize| {
        neighbours[next[a] as usize] = b as i32;
        next[a] += 1;
    };
    for column in 0..n {
        for &row in &pattern.column(column)[1..] {
            add(column, row as usize);
            add(row as usize, column);
        }
    }
    (starts, neighbours)
}

/// Counts operations, and renumbers so that every subtree of the elimination tree is contiguous (a postorder): the
/// fill is the same, and the columns of a supernode become neighbours.
fn evaluate(
    pattern: &Pattern,
    ordering: Ordering,
    new_to_old: Vec<u32>,
) -> Result<NodeOrder, LinearError> {
    let n = pattern.nodes();
    let mut old_to_new = inverse(&new_to_old);
    let (starts, rows) = upper(pattern, &old_to_new);
    let graph = SymbolicSparseColMatRef::new_unsorted_checked(n, n, &starts, None, &rows);
    let scratch = simplicial::prefactorize_symbolic_cholesky_scratch::<u32>(n, rows.len());
    let mut memory = buffer(scratch)?;
    let (mut parents, mut counts) = (vec![0i32; n], vec![0u32; n]);
    simplicial::prefactorize_symbolic_cholesky(
        &mut parents,
        &mut counts,
        graph,
        MemStack::new(&mut memory),
    );
    let (mut flops, mut fill) = (0.0, 0u64);
    for &count in &counts {
        for c in 0..3 {
            let rows = 3 * u64::from(count) - c;
            fill += rows;
            flops += rows as f64 * (rows as f64 + 3.0) / 2.0;
        }
    }
    let new_to_old: Vec<u32> = postorder(&parents)
        .into_iter()
        .map(|v| new_to_old[v as usize])
        .collect();
    old_to_new = inverse(&new_to_old);
    Ok(NodeOrder {
        ordering,
        new_to_old,
        old_to_new,
        flops,
        fill,
        flops_amd: None,
        flops_metis: None,
        metis_failed: None,
    })
}

/// Upper triangle with diagonal of the permuted node graph, by columns, rows in no order.
pub(super) fn upper(pattern: &Pattern, old_to_new: &[u32]) -> (Vec<u32>, Vec<u32>) {
    let n = pattern.nodes();
    let ends = |column: usize, row: u32| {
        let (a, b) = (old_to_new[column], old_to_new[row as usize]);
        (a.min(b), a.max(b))
    };
    let mut starts = vec![0u32; n + 1];
    for column in 0..n {
        for &row in pattern.column(column) {
            starts[ends(column, row).1 as usize + 1] += 1;
        }
    }
    for i in 0..n {
        starts[i + 1] += starts[i];
    }
    let mut next = starts.clone();
    let mut rows = vec![0u32; pattern.blocks()];
    for column in 0..n {
        for &row in pattern.column(column) {
            let (low, high) = ends(column, row);
            let at = &mut next[high as usize];
            rows[*at as usize] = low;
            *at += 1;
        }
    }
    (starts, rows)
}

/// Vertices of a forest (`parents`, -1 for roots; a parent has a larger number than its children), children before
/// their parents and each subtree together.
fn postorder(parents: &[i32]) -> Vec<u32> {
    let n = parents.len();
    // Heads and links of the lists of children; filled backwards, so that they run upwards.
    let (mut first_child, mut next_sibling) = (vec![-1i32; n], vec![-1i32; n]);
    for (v, &parent) in parents.iter().enumerate().rev() {
        if parent >= 0 {
            next_sibling[v] = first_child[parent as usize];
            first_child[parent as usize] = v as i32;
        }
    }
    let mut out = Vec::with_capacity(n);
    let mut stack = Vec::new();
    for (root, _) in parents.iter().enumerate().filter(|(_, p)| **p < 0) {
        stack.push(root);
        while let Some(&v) = stack.last() {
            let child = first_child[v];
            if child >= 0 {
                first_child[v] = next_sibling[child as usize];
                stack.push(child as usize);
            } else {
                stack.pop();
                out.push(v as u32);
            }
        }
    }
    out
}

fn inverse(permutation: &[u32]) -> Vec<u32> {
    let mut out = vec![0u32; permutation.len()];
    for (new, &old) in permutation.iter().enumerate() {
        out[old as usize] = new as u32;
    }
    out
}

/// Workspace, or a typed error where the allocator would abort.
pub(super) fn buffer(size: StackReq) -> Result<MemBuffer, LinearError> {
    let bytes = size.size_bytes();
    MemBuffer::try_new(size).map_err(|_| LinearError::OutOfMemory { bytes })
}
