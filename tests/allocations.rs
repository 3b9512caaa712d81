//! Evaluating contact allocates no more for many slave points than for few: a counting allocator, one thread.
use covact::assembly::Assembler;
use covact::model::build::build;
use covact::model::state::State;
use covact::scene;
use serde_json::{Value, json};
use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::Cell;

/// Counts what the calling thread allocates.
struct Counting;

thread_local! {
    static ALLOCATIONS: Cell<usize> = const { Cell::new(0) };
}

fn note() {
    // A thread that is ending has no counter any more, and is not of interest.
    let _ = ALLOCATIONS.try_with(|n| n.set(n.get() + 1));
}

// SAFETY: all is left to the system's allocator; the counter has no destructor and does not allocate.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        note();
        unsafe { System.alloc(layout) }
    }
    unsafe fn dealloc(&self, at: *mut u8, layout: Layout) {
        unsafe { System.dealloc(at, layout) }
    }
    unsafe fn alloc_zeroed(&self, layout: Layout) -> *mut u8 {
        note();
        unsafe { System.alloc_zeroed(layout) }
    }
    unsafe fn realloc(&self, at: *mut u8, layout: Layout, size: usize) -> *mut u8 {
        note();
        unsafe { System.realloc(at, layout, size) }
    }
}

#[global_allocator]
static COUNTING: Counting = Counting;

/// Allocations of one evaluation of contact with its tangent, of one without, and points in contact: a plate with
/// `elements` along each side, pressed into a ball that turns, after evaluations that have filled all buffers.
fn allocations(elements: usize, contact: &Value) -> [usize; 3] {
    let mut scene = json!({
        "covact": 1,
        "title": "Plate in a ball",
        "materials": { "plate": { "st_venant_kirchhoff": { "E": 12000, "nu": 0.3 } } },
        "bodies": { "plate": {
            "mesh": { "plate": { "size": [8, 8], "thickness": 1, "elements": [elements, elements] } },
            "material": "plate"
        } },
        "surfaces": { "ball": {
            "sphere": { "radius": 25, "center": [0, 0, 30] },
            "motion": {
                "translation": [0, 0, "-5*t"],
                "rotation": { "center": [0, 0, 30], "axis": [1, 2, 3], "angle": "20*t" }
            }
        } },
        "contacts": { "press": {
            "slave": "plate.top",
            "master": "ball",
            "penalty": { "value": 60000 },
            "points": { "gauss": 2 }
        } },
        // Some of the slave's own nodes are prescribed, too.
        "supports": {
            "held": { "on": "plate.bottom", "fixed": true },
            "side": { "on": "plate.x_min", "fixed": true }
        },
        "solution": { "step": { "initial": 0.5 } }
    });
    for (key, value) in contact.as_object().unwrap() {
        scene["contacts"]["press"][key] = value.clone();
    }
    let text = serde_json::to_string_pretty(&scene).unwrap();
    let model = build(&scene::parse(&text, "allocations.json").unwrap()).unwrap();
    let mut assembler = Assembler::new(&model, &model.dofs).unwrap();
    let mut state = State::new(&model);
    let n = state.u.len();
    let (mut residual, mut rhs, zero) = (vec![0.0; n], vec![0.0; n], vec![0.0; n]);
    let mut counts = [0; 3];
    // From the second on nothing is new.
    for _ in 0..3 {
        let before = ALLOCATIONS.get();
        let totals =
            (assembler.linearize_contact(&mut state, 1.0, Some(&zero), &mut residual, &mut rhs))
                .unwrap();
        counts[0] = ALLOCATIONS.get() - before;
        counts[2] = totals.active;
        drop(totals);
        let before = ALLOCATIONS.get();
        drop(assembler.contact(&mut state, 1.0, &mut residual).unwrap());
        counts[1] = ALLOCATIONS.get() - before;
    }
    counts
}

#[test]
fn an_evaluation_of_contact_allocates_no_more_for_many_points() {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build();
    let pool = pool.unwrap();
    let count = |elements: usize, contact: &Value| pool.install(|| allocations(elements, contact));
    for (name, contact) in [
        ("frictionless", json!({})),
        ("offset", json!({ "offset": 0.01 })),
        ("augmentation", json!({ "augmentation": {} })),
        (
            "friction",
            json!({ "friction": { "coulomb": { "mu": 0.3 } } }),
        ),
        (
            "friction and augmentation",
            json!({ "friction": { "coulomb": { "mu": 0.3 } }, "augmentation": {} }),
        ),
        ("averaged", json!({ "gap": "averaged" })),
        (
            "averaged friction",
            json!({ "gap": "averaged", "friction": { "coulomb": { "mu": 0.3 } } }),
        ),
    ] {
        let [few, many] = [4, 16].map(|elements| count(elements, &contact));
        println!("{name}: {few:?} {many:?}");
        assert!(
            few[2] >= 8 && many[2] >= 8 * few[2],
            "{name}: {few:?} {many:?}"
        );
        assert_eq!(few[..2], many[..2], "{name}");
        // Totals per surface and per pair, and what the motion of the surface takes to evaluate.
        assert!(many[..2].iter().all(|n| *n <= 8), "{name}: {many:?}");
    }
}

/// Rows and fields are brought to the disk together, from time to time, and not one by one.
#[test]
fn files_are_not_waited_for_one_by_one() {
    use covact::output::atomic::waits;
    use covact::run::{RunOptions, run};
    let mut scene = json!({
        "covact": 1,
        "materials": { "m": { "st_venant_kirchhoff": { "E": 100, "nu": 0.3 } } },
        "bodies": { "strip": {
            "mesh": { "plate": { "size": [4, 1], "thickness": 0.5, "elements": [4, 1] } }, "material": "m"
        } },
        "supports": {
            "wall": { "on": "strip.x_min", "fixed": true },
            "pull": { "on": "strip.x_max", "displacement": { "x": "0.1*t", "y": 0 } }
        },
        "solution": { "step": { "initial": 0.02, "max": 0.02 }, "threads": 1 }
    });
    for every in [0, 1] {
        scene["output"] = json!({ "every": every });
        let loaded = scene::parse(&scene.to_string(), "scene.json").unwrap();
        let folder = tempfile::tempdir().unwrap();
        let before = waits();
        let flag = std::sync::atomic::AtomicBool::new(false);
        let mut silent = covact::solve::event::Silent;
        let summary = run(
            &loaded,
            folder.path(),
            &RunOptions::default(),
            &mut silent,
            &flag,
        )
        .unwrap();
        assert_eq!(summary.steps, 50);
        // At the end; in the course of it after two seconds at the earliest, which this run does not take.
        let waited = waits() - before;
        println!("every {every}: {waited} waits");
        assert!(waited <= 25, "every {every}: {waited} waits");
    }
}
