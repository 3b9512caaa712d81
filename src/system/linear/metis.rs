//! Nested dissection by METIS (G. Karypis and V. Kumar, "A fast and high quality multilevel scheme for partitioning
//! irregular graphs", SIAM J. Sci. Comput. 20 (1998)). The only foreign calls of the crate are here.
use std::ptr;
use std::sync::{Mutex, PoisonError};

/// METIS draws from the C library's random numbers and traps signals while it works, both of the whole process: one
/// call at a time, which also makes its result the same every time.
static ONE_AT_A_TIME: Mutex<()> = Mutex::new(());

/// Code of METIS for an ordering that was found.
const OK: i32 = 1;

/// A fill-reducing order of an undirected graph: `order[new] = old`. `starts` (`n + 1` numbers) and `neighbours` are
/// the adjacency, both directions of every edge and no loops; METIS may reorder the neighbours of a vertex.
///
/// # Errors
/// METIS's own code (-2 input, -3 memory, -4 other); -2 also for an adjacency that is not one.
pub(super) fn nested_dissection(
    starts: &mut [i32],
    neighbours: &mut [i32],
) -> Result<Vec<u32>, i32> {
    let n = starts.len().saturating_sub(1);
    let valid = i32::try_from(n).is_ok()
        && starts.first() == Some(&0)
        && starts.windows(2).all(|w| w[0] <= w[1])
        && starts[n] as usize == neighbours.len()
        && neighbours.iter().all(|&v| v >= 0 && (v as usize) < n);
    if !valid {
        return Err(-2);
    }
    if neighbours.is_empty() {
        // Nothing is coupled: every order is as good, and METIS need not be asked about a graph without edges.
        return Ok((0..n as u32).collect());
    }
    let mut vertices = n as i32;
    let mut new_to_old = vec![0i32; n];
    let mut old_to_new = vec![0i32; n];
    let code = {
        let _guard = ONE_AT_A_TIME.lock().unwrap_or_else(PoisonError::into_inner);
        // SAFETY: `xadj` has n + 1 ascending entries from 0 to the length of `adjncy`, all of whose entries are vertex
        // numbers (checked above); `perm` and `iperm` have room for n entries each. Null vertex weights and null
        // options are documented to mean unit weights and defaults (numbering from 0). METIS keeps no pointer after it
        // returns, and the lock keeps other threads of this library out of its process-wide state.
        unsafe {
            metis_sys::METIS_NodeND(
                &mut vertices,
                starts.as_mut_ptr(),
                neighbours.as_mut_ptr(),
                ptr::null_mut(),
                ptr::null_mut(),
                new_to_old.as_mut_ptr(),
                old_to_new.as_mut_ptr(),
            )
        }
    };
    if code != OK {
        return Err(code);
    }
    Ok(new_to_old.into_iter().map(|v| v as u32).collect())
}
