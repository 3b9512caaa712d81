//! The largest memory that a run took.

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
