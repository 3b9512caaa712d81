//! Memory is asked for before it is taken: what the machine does not have is refused with the estimate, what there is, and
//! what to change.
//!
//! What is available comes from [`covact_geometry::memory`]. Estimates belong to those who take the memory, are of what
//! the next stage takes, and are compared with what is there at that moment, so what earlier stages hold is counted once.
//! A scene that fits is never refused for being large.
use covact_geometry::memory::address_space_left;
pub use covact_geometry::memory::{Available, Limit, Size, available};

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

/// Bytes of `count` things of `each`, the largest number where that overflows.
pub fn times(count: u64, each: u64) -> u64 {
    count.saturating_mul(each)
}

/// Largest resident memory of this process so far, in MB (10^6 bytes). Linux only.
pub fn peak_memory_mb() -> Option<f64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    high_water_kib(&status).map(|kib| kib as f64 * 1024.0 / 1e6)
}

/// `VmHWM:   1234 kB` of `/proc/self/status`.
fn high_water_kib(status: &str) -> Option<u64> {
    let line = status.lines().find_map(|l| l.strip_prefix("VmHWM:"))?;
    line.split_ascii_whitespace().next()?.parse().ok()
}

#[cfg(test)]
mod tests {
    use super::*;

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

    #[test]
    fn the_high_water_mark_is_read() {
        let status = "VmPeak:\t  99 kB\nVmHWM:\t  2048 kB\nVmRSS:\t 1 kB\n";
        assert_eq!(high_water_kib(status), Some(2048));
        assert_eq!(high_water_kib("VmPeak: 1 kB\n"), None);
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn memory_is_plausible() {
        let memory = peak_memory_mb().unwrap();
        assert!((1.0..1e6).contains(&memory), "{memory}");
    }
}
