//! How much memory a process may still take.
//!
//! On Linux: what the machine has available (`MemAvailable` and free swap of `/proc/meminfo`), what the control groups
//! around the process leave (version 2 and 1; what the kernel can drop from its cache counts as free), and what its limit
//! on the address space leaves; the least of these. Elsewhere the system is not asked, and [`ASSUMED`] takes its place:
//! requests that no machine can serve are still found out.

use std::fmt;
use std::path::{Path, PathBuf};

/// Bytes taken to be there where the system does not say: 64 GB.
pub const ASSUMED: u64 = 64 << 30;

/// Who sets the limit.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Limit {
    /// The machine's free memory.
    Machine,
    /// A control group: a container's or a job's share.
    ControlGroup,
    /// The limit on the process's address space (`ulimit -v`).
    AddressSpace,
    /// Not known: [`ASSUMED`].
    Unknown,
}

/// Memory that a process may still take.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Available {
    /// Bytes.
    pub bytes: u64,
    /// Who sets the limit.
    pub limit: Limit,
}

impl fmt::Display for Available {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let size = Size(self.bytes);
        match self.limit {
            Limit::Machine => write!(f, "{size} are available"),
            Limit::ControlGroup => write!(f, "{size} are left of this container or job"),
            Limit::AddressSpace => write!(f, "{size} are left of the process's limit"),
            Limit::Unknown => write!(f, "{size} are assumed to be there"),
        }
    }
}

/// Bytes as people read them: `940 MB`, `12.3 GB`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Size(pub u64);

impl fmt::Display for Size {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (mut value, mut unit) = (self.0 as f64 / 1e3, 0);
        const UNITS: [&str; 6] = ["kB", "MB", "GB", "TB", "PB", "EB"];
        while value >= 999.5 && unit + 1 < UNITS.len() {
            value /= 1e3;
            unit += 1;
        }
        let digits = usize::from(value < 99.95) * usize::from(unit >= 2);
        write!(f, "{value:.digits$} {}", UNITS[unit])
    }
}

/// What the process may still take, asked anew each time (some 50 microseconds).
pub fn available() -> Available {
    let mut least = Available {
        bytes: ASSUMED,
        limit: Limit::Unknown,
    };
    let read = |path: &str| std::fs::read_to_string(path).ok();
    let mut known = false;
    let mut see = |bytes: Option<u64>, limit| {
        if let Some(bytes) = bytes
            && (!known || bytes < least.bytes)
        {
            known = true;
            least = Available { bytes, limit };
        }
    };
    see(
        read("/proc/meminfo").and_then(|t| machine(&t)),
        Limit::Machine,
    );
    let groups = read("/proc/self/cgroup").unwrap_or_default();
    let (memberships, root) = (memberships(&groups), Path::new("/sys/fs/cgroup"));
    see(control_groups(&memberships, root), Limit::ControlGroup);
    see(address_space_left(), Limit::AddressSpace);
    least
}

/// What the limit on the process's address space (`ulimit -v`) leaves; none where there is no limit, or the system does not
/// tell. Memory that is asked for and never touched counts here, and here alone.
pub fn address_space_left() -> Option<u64> {
    let read = |path: &str| std::fs::read_to_string(path).ok();
    let (limits, status) = (read("/proc/self/limits")?, read("/proc/self/status")?);
    address_space(&limits, &status)
}

/// Bytes of a line such as `MemAvailable:  123 kB`.
fn kilobytes(text: &str, key: &str) -> Option<u64> {
    let line = text.lines().find_map(|l| l.strip_prefix(key))?;
    let number: u64 = line
        .trim_start_matches(':')
        .split_whitespace()
        .next()?
        .parse()
        .ok()?;
    number.checked_mul(1024)
}

/// From `/proc/meminfo`.
fn machine(text: &str) -> Option<u64> {
    let free = kilobytes(text, "MemAvailable")?;
    Some(free.saturating_add(kilobytes(text, "SwapFree").unwrap_or(0)))
}

/// Groups that the process is in, from `/proc/self/cgroup`: whether of version 2, and the path.
fn memberships(text: &str) -> Vec<(bool, PathBuf)> {
    let of = |line: &str| {
        let mut parts = line.splitn(3, ':').skip(1);
        let (controllers, path) = (parts.next()?, parts.next()?);
        let path = PathBuf::from(path.trim_start_matches('/'));
        match controllers {
            "" => Some((true, path)),
            list => (list.split(',').any(|c| c == "memory")).then_some((false, path)),
        }
    };
    text.lines().filter_map(of).collect()
}

/// What the tightest of the groups, and of the groups around them, leaves.
fn control_groups(memberships: &[(bool, PathBuf)], root: &Path) -> Option<u64> {
    let left = |second: bool, folder: &Path| {
        let (limit, usage, cache) = match second {
            true => ("memory.max", "memory.current", "inactive_file"),
            false => (
                "memory.limit_in_bytes",
                "memory.usage_in_bytes",
                "total_inactive_file",
            ),
        };
        let read = |name: &str| std::fs::read_to_string(folder.join(name)).ok();
        // "max" is no number; version 1 writes a number near 2^63 instead.
        let limit: u64 = read(limit)?.trim().parse().ok()?;
        let used: u64 = read(usage)?.trim().parse().ok()?;
        let cached = read("memory.stat").unwrap_or_default();
        let cached = (cached.lines())
            .find_map(|l| l.strip_prefix(cache)?.trim().parse().ok())
            .unwrap_or(0u64);
        (limit < 1 << 60).then(|| limit.saturating_sub(used.saturating_sub(cached)))
    };
    let all = memberships.iter().flat_map(|(second, path)| {
        let top = if *second {
            root.to_owned()
        } else {
            root.join("memory")
        };
        // Inside a container the path may be that of the host; then the top alone is there.
        (path.ancestors().map(|p| top.join(p)))
            .filter_map(|folder| left(*second, &folder))
            .collect::<Vec<_>>()
    });
    all.min()
}

/// From `/proc/self/limits` and `/proc/self/status`.
fn address_space(limits: &str, status: &str) -> Option<u64> {
    let line = (limits.lines()).find_map(|l| l.strip_prefix("Max address space"))?;
    let limit: u64 = line.split_whitespace().next()?.parse().ok()?;
    Some(limit.saturating_sub(kilobytes(status, "VmSize")?))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn memory_of_the_machine() {
        let text = "MemTotal:  1000 kB\nMemFree: 7 kB\nMemAvailable:     600 kB\nSwapFree: 24 kB\n";
        assert_eq!(machine(text), Some(624 * 1024));
        assert_eq!(machine("MemTotal: 5 kB\n"), None);
    }

    #[test]
    fn the_tightest_group_counts() {
        let root = std::env::temp_dir().join(format!("covact_groups_{}", std::process::id()));
        let write = |path: &str, text: &str| {
            let path = root.join(path);
            std::fs::create_dir_all(path.parent().unwrap()).unwrap();
            std::fs::write(path, text).unwrap();
        };
        write("job/memory.max", "1000000\n");
        write("job/memory.current", "700000\n");
        write("job/memory.stat", "anon 5\ninactive_file 100000\n");
        write("job/step/memory.max", "max\n");
        write("job/step/memory.current", "600000\n");
        let groups = memberships("0::/job/step\n");
        assert_eq!(groups, [(true, PathBuf::from("job/step"))]);
        assert_eq!(control_groups(&groups, &root), Some(400_000));
        write("memory/a/memory.limit_in_bytes", "500000\n");
        write("memory/a/memory.usage_in_bytes", "450000\n");
        write("memory/a/memory.stat", "total_inactive_file 10000\n");
        write("memory/memory.limit_in_bytes", "9223372036854771712\n");
        write("memory/memory.usage_in_bytes", "450000\n");
        let groups = memberships("5:cpu,memory:/a\n2:cpuset:/\n0::/job/step\n");
        assert_eq!(groups.len(), 2);
        assert_eq!(control_groups(&groups, &root), Some(60_000));
        // A container that sees the host's path.
        let groups = memberships("0::/not/here\n");
        assert_eq!(control_groups(&groups, &root.join("job")), Some(400_000));
        assert_eq!(control_groups(&[], &root), None);
        std::fs::remove_dir_all(&root).unwrap();
    }

    #[test]
    fn the_limit_of_the_process() {
        let limits = "Limit                     Soft Limit           Hard Limit           Units\n\
                      Max address space         4096000              unlimited            bytes\n";
        assert_eq!(
            address_space(limits, "VmSize:\t    1000 kB\n"),
            Some(4096000 - 1024000)
        );
        let none = limits.replace("4096000", "unlimited");
        assert_eq!(address_space(&none, "VmSize: 1 kB\n"), None);
    }

    #[test]
    fn sizes_for_people() {
        for (bytes, text) in [
            (1_500, "2 kB"),
            (940_000_000, "940 MB"),
            (12_345_000_000, "12.3 GB"),
            (250_000_000_000, "250 GB"),
            (u64::MAX, "18.4 EB"),
        ] {
            assert_eq!(Size(bytes).to_string(), text);
        }
        assert!(available().bytes > 0);
    }
}
