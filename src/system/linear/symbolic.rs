//! Structure of a factor: elimination tree, counts and supernodes, by faer.
use super::LinearError;
use super::ordering::{self, NodeOrder, buffer};
use super::permuted::expand;
use crate::system::Pattern;
use faer::dyn_stack::MemStack;
use faer::sparse::SymbolicSparseColMatRef;
use faer::sparse::linalg::SymbolicSupernodalParams;
use faer::sparse::linalg::cholesky::{simplicial, supernodal};

/// Neighbouring supernodes of up to so many nodes are merged if their share of zeros stays below; faer's own limits
/// for columns, a third of them, as a node is three.
const RELAX_NODES: [(usize, f64); 3] = [(5, 0.8), (16, 0.1), (usize::MAX, 0.05)];

/// Supernodes of dofs.
pub(super) fn of_dofs(
    pattern: &Pattern,
    order: &NodeOrder,
) -> Result<supernodal::SymbolicSupernodalCholesky<u32>, LinearError> {
    let (starts, rows) = ordering::upper(pattern, &order.old_to_new);
    let (starts, rows) = expand(&starts, &rows);
    supernodes(&starts, &rows, Default::default())
}

/// Supernodes of nodes: no supernode ends inside a node.
pub(super) fn of_nodes(
    pattern: &Pattern,
    order: &NodeOrder,
) -> Result<supernodal::SymbolicSupernodalCholesky<u32>, LinearError> {
    let (starts, rows) = ordering::upper(pattern, &order.old_to_new);
    let relax = Some(&RELAX_NODES[..]);
    supernodes(&starts, &rows, SymbolicSupernodalParams { relax })
}

/// Supernodes of a graph whose upper triangle is given by columns.
fn supernodes(
    starts: &[u32],
    rows: &[u32],
    params: SymbolicSupernodalParams<'_>,
) -> Result<supernodal::SymbolicSupernodalCholesky<u32>, LinearError> {
    let n = starts.len() - 1;
    let graph = SymbolicSparseColMatRef::new_unsorted_checked(n, n, starts, None, rows);
    let scratch = simplicial::prefactorize_symbolic_cholesky_scratch::<u32>(n, rows.len())
        .or(supernodal::factorize_supernodal_symbolic_cholesky_scratch::<u32>(n));
    let mut memory = buffer(scratch)?;
    let stack = MemStack::new(&mut memory);
    let (mut parents, mut counts) = (vec![0i32; n], vec![0u32; n]);
    let tree = simplicial::prefactorize_symbolic_cholesky(&mut parents, &mut counts, graph, stack);
    supernodal::factorize_supernodal_symbolic_cholesky(graph, tree, &counts, stack, params)
        .map_err(|_| LinearError::TooLarge)
}
