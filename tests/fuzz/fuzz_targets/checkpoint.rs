//! A checkpoint with some bytes changed, whole by its checksum: it is refused, or the run goes on from what it says. The
//! input is a list of changes, four bytes each: where (two and a half), what (a half and one).
#![no_main]
use covact::run::{Opened, Options, RunOptions, open, resealed, run};
use covact::scene::{self, LoadedScene};
use covact::solve::event::{Event, Observer};
use covact_fuzz::{Budget, bounded};
use std::path::Path;
use std::sync::OnceLock;
use std::sync::atomic::{AtomicBool, Ordering};

/// Two blocks with friction, cut into segments elsewhere: every section has something in it.
const SCENE: &str = r#"{
    "covact": 1,
    "materials": {"m": {"neo_hooke": {"E": 100, "nu": 0.3}}},
    "bodies": {
        "bed": {"mesh": {"block": {"min": [0, 0, -1], "max": [2, 1, 0], "elements": [2, 1, 1]}}, "material": "m"},
        "sledge": {"mesh": {"block": {"min": [0.2, 0, 0], "max": [1.2, 1, 0.5], "elements": [1, 1, 1]}}, "material": "m"}
    },
    "contacts": {
        "rub": {
            "slave": "sledge.bottom", "master": "bed.top", "points": {"gauss": 2}, "friction": {"coulomb": {"mu": 0.2}},
            "augmentation": {"gap": 0.01, "slip": 0.01, "max": 25}
        },
        "cut": {"slave": "bed.top", "master": "sledge.bottom", "points": {"segments": 2}}
    },
    "supports": {
        "ground": {"on": "bed.bottom", "fixed": true},
        "push": {"on": "sledge.top", "displacement": {"x": "0.2*t", "y": 0, "z": "-0.05*t"}}
    },
    "solution": {"step": {"initial": 0.25, "max": 0.25, "min": 0.1}, "threads": 1},
    "output": {"every": 0}
}"#;

/// Ends a run after an event of this number.
struct StopAfter<'a>(u32, &'a AtomicBool);

impl Observer for StopAfter<'_> {
    fn event(&mut self, event: &Event) {
        if matches!(event, Event::StepAccepted { step, .. } if *step >= self.0) {
            self.1.store(true, Ordering::Relaxed);
        }
    }
}

struct Stopped {
    scene: LoadedScene,
    folder: tempfile::TempDir,
    checkpoint: Vec<u8>,
    history: Vec<u8>,
}

fn kept(folder: &Path) -> Vec<u8> {
    let slots =
        (0..3).filter_map(|i| std::fs::read(folder.join(format!("checkpoint.{i}.bin"))).ok());
    // The number of a checkpoint grows by one with each.
    let newest = slots.max_by_key(|bytes| bytes[20..28].iter().rev().copied().collect::<Vec<u8>>());
    newest.expect("a checkpoint")
}

/// A run that was stopped after two steps.
fn stopped() -> &'static Stopped {
    static STOPPED: OnceLock<Stopped> = OnceLock::new();
    STOPPED.get_or_init(|| {
        let scene = scene::parse(SCENE, "scene.json").expect("a scene");
        let folder = tempfile::tempdir().expect("a folder");
        let flag = AtomicBool::new(false);
        let options = RunOptions {
            threads: 1,
            ..RunOptions::default()
        };
        run(
            &scene,
            folder.path(),
            &options,
            &mut StopAfter(2, &flag),
            &flag,
        )
        .expect("two steps");
        let mut checkpoint = kept(folder.path());
        let length = u64::from_le_bytes(checkpoint[12..20].try_into().expect("eight bytes"));
        checkpoint.truncate(length as usize);
        let history = std::fs::read(folder.path().join("history.csv")).expect("a table");
        Stopped {
            scene,
            folder,
            checkpoint,
            history,
        }
    })
}

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    let stopped = stopped();
    let mut changed = stopped.checkpoint.clone();
    for change in bytes.chunks_exact(4).take(8) {
        let [a, b, c, value] = [change[0], change[1], change[2], change[3]];
        let at = usize::from(a) | usize::from(b) << 8 | usize::from(c & 0x0f) << 16;
        let at = at % changed.len();
        match c >> 4 {
            0 => changed.truncate(at.max(40)),
            1 => changed.insert(at, value),
            _ => changed[at] = value,
        }
    }
    let folder = stopped.folder.path();
    for i in 0..3 {
        let _ = std::fs::remove_file(folder.join(format!("checkpoint.{i}.bin")));
    }
    let _ = std::fs::remove_file(folder.join("summary.json"));
    std::fs::write(folder.join("checkpoint.0.bin"), resealed(changed)).expect("written");
    std::fs::write(folder.join("history.csv"), &stopped.history).expect("written");
    bounded(Budget::projection(), || {
        let flag = AtomicBool::new(false);
        let options = RunOptions {
            threads: 1,
            resume: true,
            ..RunOptions::default()
        };
        let caller = Options {
            threads: 1,
            observer: Box::new(StopAfter(3, &flag)),
            interrupt: &flag,
        };
        match open(&stopped.scene, folder, &options, caller) {
            Ok(Opened::Going(mut simulation, mut results)) => {
                if let Err(e) = simulation.run(&mut [&mut *results]) {
                    assert!(!e.to_string().is_empty());
                }
            }
            Ok(Opened::Finished(_)) => {}
            Err(e) => assert!(!e.to_string().is_empty()),
        }
    });
});
