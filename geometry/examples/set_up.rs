//! What it takes to set up the search on the surfaces of CAD files: `cargo run --release -p covact-geometry --example set_up
//! FILE...`. A row for each file: patches, milliseconds of the set-up (the best of five, on as many threads as there are),
//! bytes that the set holds and that the set-up needed at most, and microseconds of the first query.

use covact_geometry::{PatchSet, Vec3, io};
use std::alloc::{GlobalAlloc, Layout, System};
use std::error::Error;
use std::sync::atomic::{AtomicUsize, Ordering::Relaxed};
use std::time::Instant;

/// The system's allocator with an account.
struct Counting;
static IN_USE: AtomicUsize = AtomicUsize::new(0);
static PEAK: AtomicUsize = AtomicUsize::new(0);

// SAFETY: every call is passed on unchanged to the system's allocator.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        let used = IN_USE.fetch_add(layout.size(), Relaxed) + layout.size();
        PEAK.fetch_max(used, Relaxed);
        // SAFETY: the caller keeps the conditions of `alloc`.
        unsafe { System.alloc(layout) }
    }

    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        IN_USE.fetch_sub(layout.size(), Relaxed);
        // SAFETY: the caller keeps the conditions of `dealloc`.
        unsafe { System.dealloc(pointer, layout) }
    }
}

#[global_allocator]
static ALLOCATOR: Counting = Counting;

fn main() -> Result<(), Box<dyn Error>> {
    println!(
        "{:>7} {:>10} {:>9} {:>9} {:>9}  file",
        "patches", "set-up ms", "held MB", "peak MB", "first us"
    );
    for path in std::env::args().skip(1) {
        let file = io::read_path(path.as_ref())?;
        let patches: Vec<_> = file.patches.iter().map(|p| p.patch.clone()).collect();
        let mut best = f64::INFINITY;
        let [mut held, mut peak, mut first] = [0.0; 3];
        for _ in 0..5 {
            let own = patches.clone();
            let before = IN_USE.load(Relaxed);
            PEAK.store(before, Relaxed);
            let start = Instant::now();
            let set = PatchSet::join(own, file.joining())?;
            let time = start.elapsed().as_secs_f64();
            let megabytes = |bytes: usize| 1e-6 * bytes.saturating_sub(before) as f64;
            let (in_use, most) = (
                megabytes(IN_USE.load(Relaxed)),
                megabytes(PEAK.load(Relaxed)),
            );
            let [low, high] = set.bounds();
            let q = high + (high - low).component_mul(&Vec3::new(0.3, 0.2, 0.1));
            let start = Instant::now();
            // The check: the point lies outside of the box, so its foot is no nearer than that.
            let distance = set.closest(&q)?.distance;
            if distance < (q - high).norm() * (1.0 - 1e-12) {
                return Err("a foot that is nearer than the box".into());
            }
            if time < best {
                (best, held, peak) = (time, in_use, most);
                first = start.elapsed().as_secs_f64();
            }
        }
        println!(
            "{:>7} {:>10.2} {held:>9.2} {peak:>9.2} {:>9.1}  {path}",
            patches.len(),
            1e3 * best,
            1e6 * first
        );
    }
    Ok(())
}
