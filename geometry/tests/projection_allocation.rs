//! Closest point queries allocate nothing, once what proves a part of a surface has been made by the first query that ends in it
//! (subdivision keeps its room from query to query).

mod projection_common;

use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::Cell;
use std::hint::black_box;

use covact_geometry::primitives::{sphere, sphere_without_poles};
use covact_geometry::{PatchSet, Vec3};
use projection_common::*;

/// The system's allocator, counting the calls of each thread.
struct Counting;

thread_local! {
    static CALLS: Cell<usize> = const { Cell::new(0) };
}

fn count() {
    // A thread that is ending has no counter left.
    let _ = CALLS.try_with(|calls| calls.set(calls.get() + 1));
}

// SAFETY: every call is passed on unchanged to the system's allocator.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        count();
        // SAFETY: the caller keeps the conditions of `alloc`.
        unsafe { System.alloc(layout) }
    }

    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        // SAFETY: the caller keeps the conditions of `dealloc`.
        unsafe { System.dealloc(pointer, layout) }
    }

    unsafe fn realloc(&self, pointer: *mut u8, layout: Layout, size: usize) -> *mut u8 {
        count();
        // SAFETY: the caller keeps the conditions of `realloc`.
        unsafe { System.realloc(pointer, layout, size) }
    }
}

#[global_allocator]
static ALLOCATOR: Counting = Counting;

fn calls(f: impl FnOnce()) -> usize {
    let before = CALLS.with(Cell::get);
    f();
    CALLS.with(Cell::get) - before
}

#[test]
fn queries_allocate_nothing() {
    // The counter counts.
    assert!(calls(|| drop(black_box(vec![1.0; 100]))) > 0);
    let sets = [
        vec![bumpy(3, 20, true, 7)],
        vec![sphere(4.0, Vec3::zeros(), Vec3::z()).unwrap()],
        sphere_without_poles(4.0, Vec3::zeros(), Vec3::z())
            .unwrap()
            .to_vec(),
    ];
    for patches in sets {
        let set = PatchSet::new(patches, None).unwrap();
        let mut random = Random(3);
        let points: Vec<(Vec3, Vec3)> = (0..100)
            .map(|_| {
                let patch = &set.patches()[0];
                let xi = random.xi(patch);
                let n = normal(patch, xi).unwrap();
                let q = patch.point(xi) + n * random.between(-0.1, 0.1);
                (q, random.direction() * 1e-3)
            })
            .collect();
        // Subdivision, which the centres of the spheres need, makes its room once.
        let centre = || {
            black_box(set.project(&Vec3::new(1e-6, 2e-6, 0.0), None, f64::INFINITY));
        };
        centre();
        for (q, step) in &points {
            let mut hint = None;
            // Of two points so near to each other the first makes the proofs of both.
            black_box(set.project(q, None, f64::INFINITY));
            black_box(set.project(&(q + step), None, 0.5));
            assert_eq!(
                calls(|| hint = set.project(q, None, f64::INFINITY).map(|f| f.hint())),
                0
            );
            assert!(hint.is_some());
            let warm = || {
                black_box(set.project(&(q + step), hint, 0.5));
            };
            assert_eq!(calls(warm), 0);
        }
        assert_eq!(calls(centre), 0);
    }
}
