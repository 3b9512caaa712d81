//! Limits on what a scene may ask for: memory is estimated before it is taken, and what the machine does not have is
//! refused with the estimate, what there is, and what to change.
//!
//! What is available comes from [`covact_geometry::memory`]. Estimates are of what the next stage takes, and are compared
//! with what is there at that moment, so what earlier stages hold is counted once. A scene that fits is never refused for
//! being large.
mod estimate;
mod grid;
mod packing;

use covact_geometry::memory::address_space_left;
pub use covact_geometry::memory::{Available, Limit, Size, available};
pub use estimate::{Estimate, facet_bytes, mesh, slave_points, tessellation};
pub use grid::Grid;
pub use packing::packing;

use std::fmt;

/// Less than this is not worth asking for: the machine has it, or cannot run the program at all.
const SMALL: u64 = 32 << 20;

/// More memory is needed than there is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Shortage {
    /// Bytes needed, estimated.
    pub needed: u64,
    /// What there is.
    pub available: Available,
}

impl fmt::Display for Shortage {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let needed = Size(self.needed);
        write!(
            f,
            "about {needed} of memory are needed, but {}",
            self.available
        )
    }
}
impl std::error::Error for Shortage {}

/// Whether so many bytes more can be had.
///
/// # Errors
/// [`Shortage`] where they are more than is available.
pub fn ask(bytes: u64) -> Result<(), Shortage> {
    if bytes < SMALL {
        return Ok(());
    }
    let available = available();
    match bytes > available.bytes {
        true => Err(Shortage {
            needed: bytes,
            available,
        }),
        false => Ok(()),
    }
}

/// Whether so many bytes of the address space can be had, which may never be touched.
///
/// # Errors
/// [`Shortage`] where the process's limit leaves less.
pub fn ask_address_space(bytes: u64) -> Result<(), Shortage> {
    match address_space_left() {
        Some(left) if bytes > left => Err(Shortage {
            needed: bytes,
            available: Available {
                bytes: left,
                limit: Limit::AddressSpace,
            },
        }),
        _ => Ok(()),
    }
}

/// Threads that run at once on what this process has of the machine.
pub fn processors() -> usize {
    std::thread::available_parallelism().map_or(1, usize::from)
}

/// `asked` threads, or as many as there are processors where those are fewer, with what is to be told then. 0 stays, and
/// stands for all of them.
pub fn threads(asked: usize) -> (usize, Option<String>) {
    let there = processors();
    match asked > there {
        true => {
            let told = format!(
                "{asked} threads are asked for, and {there} can run at once here: {there} are used"
            );
            (there, Some(told))
        }
        false => (asked, None),
    }
}

/// Bytes of `count` things of `each`, the largest number where that overflows.
pub fn times(count: u64, each: u64) -> u64 {
    count.saturating_mul(each)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_more_threads_than_processors() {
        let there = processors();
        assert_eq!(threads(0), (0, None));
        assert_eq!(threads(there), (there, None));
        let (used, told) = threads(there + 5);
        assert_eq!(used, there);
        assert!(
            told.is_some_and(|t| t.starts_with(&format!("{} threads are asked for", there + 5)))
        );
    }

    #[test]
    fn what_no_machine_has_is_refused() {
        assert_eq!(ask(1000), Ok(()));
        let shortage = ask(u64::MAX).unwrap_err();
        assert_eq!(shortage.needed, u64::MAX);
        let text = shortage.to_string();
        assert!(
            text.starts_with("about 18.4 EB of memory are needed, but "),
            "{text}"
        );
        assert_eq!(times(u64::MAX, 2), u64::MAX);
    }
}
