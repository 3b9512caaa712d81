//! Files found by fuzzing: each once ended a reader by a panic, or took too much time or memory.
//!
//! A reader may hold 100 times the file and 1 MB on top of that. Time is bounded loosely, because machines differ and are busy.

#[path = "iges/builder.rs"]
mod builder;
mod mutate_common;

use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::Cell;
use std::path::Path;
use std::time::{Duration, Instant};

use builder::Builder;
use covact_geometry::io::{
    CadFile, read_iges, read_iges_geometry, read_json, read_step, read_stl, write_json,
};
use covact_geometry::{PatchSet, Vec3};
use mutate_common::{Random, damaged};

/// The system's allocator, counting for each thread the bytes in use and the most there ever were.
struct Counting;

thread_local! {
    static IN_USE: Cell<i64> = const { Cell::new(0) };
    static PEAK: Cell<i64> = const { Cell::new(0) };
}

fn count(bytes: i64) {
    // A thread that is ending has no counters left.
    let _ = IN_USE.try_with(|used| {
        used.set(used.get() + bytes);
        let _ = PEAK.try_with(|peak| peak.set(peak.get().max(used.get())));
    });
}

// SAFETY: every call is passed on unchanged to the system's allocator.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        count(layout.size() as i64);
        // SAFETY: the caller keeps the conditions of `alloc`.
        unsafe { System.alloc(layout) }
    }

    unsafe fn alloc_zeroed(&self, layout: Layout) -> *mut u8 {
        count(layout.size() as i64);
        // SAFETY: the caller keeps the conditions of `alloc_zeroed`.
        unsafe { System.alloc_zeroed(layout) }
    }

    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        count(-(layout.size() as i64));
        // SAFETY: the caller keeps the conditions of `dealloc`.
        unsafe { System.dealloc(pointer, layout) }
    }

    unsafe fn realloc(&self, pointer: *mut u8, layout: Layout, size: usize) -> *mut u8 {
        count(size as i64 - layout.size() as i64);
        // SAFETY: the caller keeps the conditions of `realloc`.
        unsafe { System.realloc(pointer, layout, size) }
    }
}

#[global_allocator]
static ALLOCATOR: Counting = Counting;

/// The most that one of these tests' readings may take, in any build on any machine.
const TIME: Duration = Duration::from_secs(5);

/// Reads within the bounds.
fn bounded<T>(path: &Path, bytes: &[u8], read: impl FnOnce() -> T) -> T {
    let before = IN_USE.with(Cell::get);
    PEAK.with(|peak| peak.set(before));
    let start = Instant::now();
    let result = read();
    let (time, used) = (start.elapsed(), PEAK.with(Cell::get) - before);
    let most = 100 * bytes.len() as i64 + 1_000_000;
    assert!(used <= most, "{}: {used} bytes of {most}", path.display());
    assert!(time <= TIME, "{}: {time:?}", path.display());
    result
}

/// Makes a set of the patches and projects a point on it, where they are few.
fn use_patches(path: &Path, file: CadFile) {
    let patches: Vec<_> = file.patches.into_iter().map(|p| p.patch).collect();
    let start = Instant::now();
    if patches.len() <= 20
        && let Ok(set) = PatchSet::new(patches, None)
    {
        let [low, high] = set.bounds();
        let q = high + (high - low).component_mul(&Vec3::new(0.3, 0.2, 0.1));
        let foot = set.project(&q, None, f64::INFINITY);
        assert!(foot.is_none_or(|foot| foot.distance >= 0.0 || foot.distance.is_nan()));
    }
    let time = start.elapsed();
    assert!(time <= TIME, "{}: {time:?} in projection", path.display());
}

fn iges(path: &Path, bytes: &[u8]) -> Option<CadFile> {
    let file = bounded(path, bytes, || read_iges(bytes, "found.igs"));
    let _ = bounded(path, bytes, || read_iges_geometry(bytes, "found.igs"));
    file.ok()
}

fn json(path: &Path, bytes: &[u8]) {
    if let Ok(file) = bounded(path, bytes, || read_json(bytes, "found.json")) {
        let text = write_json(&file).unwrap();
        let back = read_json(text.as_bytes(), "back.json").unwrap();
        assert_eq!(back.patches.len(), file.patches.len());
        for (a, b) in back.patches.iter().zip(&file.patches) {
            assert_eq!(a.patch, b.patch, "{}", path.display());
        }
        use_patches(path, file);
    }
}

fn stl(path: &Path, bytes: &[u8]) {
    for merge in [None, Some(0.0), Some(0.125)] {
        if let Ok(stl) = bounded(path, bytes, || read_stl(bytes, "found.stl", merge)) {
            let facets = bounded(path, bytes, || stl.facets());
            assert_eq!(facets.facets.len(), 3 * stl.triangles.len());
        }
    }
}

#[test]
fn found_files_within_bounds() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/found");
    let mut count = 0;
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        let bytes = std::fs::read(&path).unwrap();
        match path.extension().and_then(|e| e.to_str()) {
            Some("igs") => {
                if let Some(file) = iges(&path, &bytes) {
                    use_patches(&path, file);
                }
            }
            Some("json") => json(&path, &bytes),
            Some("stl") => stl(&path, &bytes),
            other => panic!("{other:?}: no reader"),
        }
        count += 1;
    }
    assert!(count > 0, "no files");
}

/// Five files of STEP, five of IGES and two of JSON, damaged 200 times each: whatever is left of them is read, or refused,
/// within the bounds.
#[test]
fn two_thousand_mutants_within_bounds() {
    let own = Path::new(env!("CARGO_MANIFEST_DIR"));
    let folders: [(&str, &[&str], &str); 3] = [
        (
            "tests/data/step",
            &["box", "cone", "cylinder", "revolution", "torus"],
            "step",
        ),
        (
            "../assets/cad",
            &[
                "bead",
                "cone_brep",
                "cylinder_faces",
                "sphere_brep",
                "torus_faces",
            ],
            "igs",
        ),
        (
            "tests/data/json",
            &["two_faces.cad", "trimmed.geomdl"],
            "json",
        ),
    ];
    let mut random = Random(20261123);
    let [mut read, mut refused] = [[0; 3]; 2];
    for (kind, (folder, names, ending)) in folders.into_iter().enumerate() {
        for name in names {
            let path = own.join(folder).join(format!("{name}.{ending}"));
            let bytes = std::fs::read(&path).unwrap();
            for _ in 0..200 {
                let bytes = damaged(&bytes, &mut random);
                let found = bounded(&path, &bytes, || match kind {
                    0 => read_step(&bytes, name),
                    1 => read_iges(&bytes, name),
                    _ => read_json(&bytes, name),
                });
                match found {
                    Ok(_) => read[kind] += 1,
                    Err(_) => refused[kind] += 1,
                }
            }
        }
    }
    // Both happen to all; of JSON there are fewer files, and most damage ends it.
    let least = [100, 100, 40];
    for (kind, least) in least.into_iter().enumerate() {
        let [read, refused] = [read[kind], refused[kind]];
        assert!(read > least && refused > least, "{kind}: {read} {refused}");
    }
}

/// A plane 128 over [0, 4] x [0, 2] with these as parameters.
const FLAT: &str = "1,1,1,1,0,0,1,0,0,0.,0.,4.,4.,0.,0.,2.,2.,1.,1.,1.,1.,\
                    0.,0.,0.,4.,0.,0.,0.,2.,0.,4.,2.,0.,0.,4.,0.,2.";

/// Reads a file in which `users` entities use the same long curve: some of them are read, the others are skipped by name
/// because the file would grow too much.
fn shared(name: &str, file: &Builder, users: usize) {
    let text = file.text();
    let read = iges(Path::new(name), text.as_bytes()).expect("sound");
    let refused = (read.skipped.iter())
        .filter(|s| s.reason.contains("is granted"))
        .count();
    assert!(refused > 0, "{name}: {:?}", read.skipped.first());
    assert!(!read.patches.is_empty(), "{name}");
    assert!(read.patches.len() + refused <= users, "{name}");
}

/// Points of an ellipse within the plane, the last that of the start.
fn ellipse(n: usize) -> String {
    let point = |k: usize| {
        let (sin, cos) = (std::f64::consts::TAU * (k % n) as f64 / n as f64).sin_cos();
        format!("{:.4},{:.4}", 2.0 + 1.5 * cos, 1.0 + 0.8 * sin)
    };
    let points: Vec<String> = (0..=n).map(point).collect();
    format!("1,{},0.,{}", n + 1, points.join(","))
}

/// Two faces that nearly coincide and reach out to 2e9: comparing them takes more work than the file is granted. Both
/// stay, and the file says that they were not compared.
#[test]
fn faces_that_are_not_compared_stay() {
    let name = "duplicates_by_projection.igs";
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/found");
    let file = iges(
        &folder.join(name),
        &std::fs::read(folder.join(name)).unwrap(),
    )
    .expect("sound");
    assert_eq!(file.patches.len(), 2);
    let told = file.notes.iter().any(|n| n.contains("is granted"));
    assert!(told, "{:?}", file.notes);
}

/// 300 faces within the same boundary of 1500 points.
#[test]
fn boundary_of_many_faces() {
    let mut file = Builder::new();
    let plane = file.add(128, FLAT);
    let curve = file.form(106, 11, &ellipse(1500));
    let boundary = file.add(142, &format!("1,{plane},{curve},0,1"));
    for _ in 0..300 {
        file.add(144, &format!("{plane},1,0,{boundary}"));
    }
    shared("boundary", &file, 300);
}

/// A face within a boundary of 1500 points, placed 300 times.
#[test]
fn boundary_in_many_places() {
    let mut file = Builder::new();
    let plane = file.add(128, FLAT);
    let curve = file.form(106, 11, &ellipse(1500));
    let boundary = file.add(142, &format!("1,{plane},{curve},0,1"));
    let face = file.add(144, &format!("{plane},1,0,{boundary}"));
    let figure = file.add(308, &format!("0,1HA,1,{face}"));
    for k in 0..300 {
        file.add(408, &format!("{figure},{k}.,0.,0.,1."));
    }
    shared("places", &file, 300);
}

/// 300 faces with the same loop of 1500 edges, which follow each other and come back to where they began.
#[test]
fn loop_of_many_faces() {
    let mut file = Builder::new();
    let plane = file.add(128, FLAT);
    let ends = file.form(502, 1, "2,.5,.5,0.,1.5,.5,0.");
    let line = file.add(110, ".5,.5,0.,1.5,.5,0.");
    let edges = file.form(504, 1, &format!("1,{line},{ends},1,{ends},2"));
    let uses: Vec<String> = (0..1500)
        .map(|k| format!("0,{edges},1,{},0", (k + 1) % 2))
        .collect();
    let a_loop = file.form(508, 1, &format!("1500,{}", uses.join(",")));
    for _ in 0..300 {
        file.form(510, 1, &format!("{plane},1,1,{a_loop}"));
    }
    let text = file.text();
    let read = iges(Path::new("loop"), text.as_bytes()).expect("sound");
    assert_eq!(read.skipped.len() + read.patches.len(), 300);
    assert!(
        (read.skipped.iter()).any(|s| s.reason.contains("is granted")),
        "{:?}",
        read.skipped.first()
    );
}

/// A loop that runs around the same circle 100 times: 250 points for each of its 400 quarters would take too much memory.
#[test]
fn loop_of_one_circle() {
    let mut file = Builder::new();
    let plane = file.add(128, FLAT);
    let vertex = file.form(502, 1, "1,2.5,1.,0.");
    let circle = file.add(100, "0.,2.,1.,2.5,1.,2.5,1.");
    let edges = file.form(504, 1, &format!("1,{circle},{vertex},1,{vertex},1"));
    let uses: Vec<String> = (0..100).map(|_| format!("0,{edges},1,1,0")).collect();
    let a_loop = file.form(508, 1, &format!("100,{}", uses.join(",")));
    file.form(510, 1, &format!("{plane},1,1,{a_loop}"));
    let text = file.text();
    let read = iges(Path::new("circle"), text.as_bytes()).expect("sound");
    assert_eq!(read.patches.len(), 1, "{:?}", read.skipped);
}

/// Numbers so large that the box of every one has no width: 20 000 triangles, no two vertices alike.
#[test]
fn stl_far_away() {
    let mut bytes = vec![b' '; 80];
    let triangles = 20_000u32;
    bytes.extend(triangles.to_le_bytes());
    for k in 0..triangles {
        bytes.extend([0; 12]);
        for i in 0..3 {
            let x = 1e30 + 1e25 * (3 * k + i) as f32;
            for value in [x, if i == 1 { 2.0 * x } else { x }, 0.0] {
                bytes.extend(value.to_le_bytes());
            }
        }
        bytes.extend([0, 0]);
    }
    let path = Path::new("far.stl");
    stl(path, &bytes);
    let read = read_stl(&bytes, "far.stl", Some(0.125)).unwrap();
    assert_eq!(read.triangles.len(), triangles as usize);
    assert_eq!(read.report.merged, 0);
}
