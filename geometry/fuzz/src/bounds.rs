//! Time and memory that a piece of work may take.
//!
//! Memory is what the allocator has handed out and not got back; it refuses more than the budget, so that the process
//! ends where too much is asked for. Time is that of the processor, so that a busy machine finds nothing.

use std::alloc::{GlobalAlloc, Layout, System};
use std::sync::atomic::{AtomicI64, Ordering::Relaxed};

/// Bounds of one piece of work.
#[derive(Clone, Copy)]
pub struct Budget {
    /// Bytes in use at the same time, beyond those in use before.
    pub bytes: usize,
    /// Seconds of the processor, in this build (instrumented, with checks of overflow).
    pub seconds: f64,
}

impl Budget {
    /// A reader's: 100 times the file and 1 MB; 1 s for 100 kB in a release build, which is 3 s here (coverage counters and
    /// checks of overflow cost nearly threefold), and at least 0.5 s.
    pub fn reader(length: usize) -> Self {
        Self {
            bytes: 100 * length + 1_000_000,
            seconds: (3e-5 * length as f64).max(0.5),
        }
    }

    /// That of a set of a few patches and a projection onto it.
    pub fn projection() -> Self {
        Self {
            bytes: 256_000_000,
            seconds: 5.0,
        }
    }
}

/// Does the work and panics when it took too long; an allocation beyond the budget ends the process.
pub fn bounded<T>(budget: Budget, work: impl FnOnce() -> T) -> T {
    LIMIT.store(IN_USE.load(Relaxed) + budget.bytes as i64, Relaxed);
    let start = seconds();
    let result = work();
    let taken = seconds() - start;
    LIMIT.store(i64::MAX, Relaxed);
    if std::env::var_os("FUZZ_TIMES").is_some() {
        eprintln!("{taken:.4} s of {:.3} s", budget.seconds);
    }
    assert!(
        taken <= budget.seconds,
        "{taken:.3} s of {:.3} s",
        budget.seconds
    );
    result
}

/// Seconds of the processor that this process has used.
fn seconds() -> f64 {
    let mut time = libc::timespec {
        tv_sec: 0,
        tv_nsec: 0,
    };
    // SAFETY: the pointer is that of a `timespec`.
    let status = unsafe { libc::clock_gettime(libc::CLOCK_PROCESS_CPUTIME_ID, &mut time) };
    assert_eq!(status, 0, "no clock");
    time.tv_sec as f64 + 1e-9 * time.tv_nsec as f64
}

static IN_USE: AtomicI64 = AtomicI64::new(0);
static LIMIT: AtomicI64 = AtomicI64::new(i64::MAX);

/// The system's allocator with an account.
struct Counting;

/// Whether `size` more bytes are within the limit; they are in the account then.
fn take(size: usize) -> bool {
    let size = size as i64;
    let within = IN_USE.fetch_add(size, Relaxed) + size <= LIMIT.load(Relaxed);
    if !within {
        IN_USE.fetch_sub(size, Relaxed);
    }
    within
}

// SAFETY: every call is passed on unchanged to the system's allocator, or fails as an allocation may.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        if !take(layout.size()) {
            return std::ptr::null_mut();
        }
        // SAFETY: the caller keeps the conditions of `alloc`.
        unsafe { System.alloc(layout) }
    }

    unsafe fn alloc_zeroed(&self, layout: Layout) -> *mut u8 {
        if !take(layout.size()) {
            return std::ptr::null_mut();
        }
        // SAFETY: the caller keeps the conditions of `alloc_zeroed`.
        unsafe { System.alloc_zeroed(layout) }
    }

    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        IN_USE.fetch_sub(layout.size() as i64, Relaxed);
        // SAFETY: the caller keeps the conditions of `dealloc`.
        unsafe { System.dealloc(pointer, layout) }
    }

    unsafe fn realloc(&self, pointer: *mut u8, layout: Layout, size: usize) -> *mut u8 {
        if size > layout.size() && !take(size - layout.size()) {
            return std::ptr::null_mut();
        }
        if size < layout.size() {
            IN_USE.fetch_sub((layout.size() - size) as i64, Relaxed);
        }
        // SAFETY: the caller keeps the conditions of `realloc`.
        unsafe { System.realloc(pointer, layout, size) }
    }
}

#[global_allocator]
static ALLOCATOR: Counting = Counting;
