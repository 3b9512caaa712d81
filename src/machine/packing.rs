//! Memory that the dense kernels of the linear algebra take for themselves.
//!
//! They copy blocks of their operands into two buffers a thread, each as large as the last cache that the machine's
//! processors share, and end the process where they cannot have them. So there has to be room for these before a run.
use super::memory::times;
use std::collections::BTreeSet;
use std::fs;
use std::path::Path;

/// Bytes of the last shared cache where the system does not tell: that of a large server.
const ASSUMED: u64 = 256 << 20;

/// Bytes that the dense kernels take on so many threads.
pub fn packing(threads: usize) -> u64 {
    let cache = shared_caches(Path::new("/sys/devices/system/cpu")).unwrap_or(ASSUMED);
    times(threads as u64, 2 * cache.max(2 << 20))
}

/// Bytes of all caches of the third level, as Linux lists them with the processors that share each.
fn shared_caches(processors: &Path) -> Option<u64> {
    let mut caches = BTreeSet::new();
    for processor in fs::read_dir(processors).ok()?.flatten() {
        let Ok(indices) = fs::read_dir(processor.path().join("cache")) else {
            continue;
        };
        for cache in indices.flatten() {
            let read = |name: &str| fs::read_to_string(cache.path().join(name)).ok();
            let level = read("level");
            if level.as_deref().map(str::trim) != Some("3") {
                continue;
            }
            if let (Some(size), Some(shared)) = (read("size"), read("shared_cpu_list")) {
                caches.insert((shared, bytes(size.trim())?));
            }
        }
    }
    let all: u64 = caches.iter().map(|(_, size)| size).sum();
    (all > 0).then_some(all)
}

/// `32768K`, `32M` or a plain number.
fn bytes(size: &str) -> Option<u64> {
    let (number, unit) = match size.char_indices().last()? {
        (at, 'K') => (&size[..at], 1 << 10),
        (at, 'M') => (&size[..at], 1 << 20),
        (at, 'G') => (&size[..at], 1 << 30),
        _ => (size, 1),
    };
    number.parse::<u64>().ok()?.checked_mul(unit)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn caches_count_once() {
        let root = tempfile::tempdir().unwrap();
        let write = |processor: u32, index: u32, texts: [&str; 3]| {
            let folder = root
                .path()
                .join(format!("cpu{processor}/cache/index{index}"));
            fs::create_dir_all(&folder).unwrap();
            for (name, text) in ["level", "size", "shared_cpu_list"].iter().zip(texts) {
                fs::write(folder.join(name), format!("{text}\n")).unwrap();
            }
        };
        assert_eq!(shared_caches(root.path()), None);
        for processor in 0..4 {
            write(processor, 2, ["2", "1024K", &processor.to_string()]);
            let half = if processor < 2 { "0-1" } else { "2-3" };
            write(processor, 3, ["3", "32768K", half]);
        }
        fs::create_dir(root.path().join("cpufreq")).unwrap();
        assert_eq!(shared_caches(root.path()), Some(64 << 20));
        assert_eq!(bytes("3M"), Some(3 << 20));
        assert_eq!(bytes("17"), Some(17));
        assert_eq!(bytes("x"), None);
        assert!(packing(3) == 3 * packing(1) && packing(1) >= 4 << 20);
    }
}
