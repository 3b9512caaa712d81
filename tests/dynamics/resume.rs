//! A run that is stopped in flight, at an impact and after it, and continued each time from its files, ends with the same bits.
use crate::support::loaded;
use covact::output::RunStatus;
use covact::run::{RunOptions, run};
use covact::solve::event::{Event, Observer};
use serde_json::json;
use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};

/// Stops a run after so many steps.
struct Stopper<'a> {
    left: u32,
    flag: &'a AtomicBool,
}

impl Observer for Stopper<'_> {
    fn event(&mut self, event: &Event) {
        if let Event::StepAccepted { .. } = event {
            self.left = self.left.saturating_sub(1);
            self.flag.fetch_or(self.left == 0, Ordering::Relaxed);
        }
    }
}

fn part(scene: &covact::scene::LoadedScene, out: &Path, resume: bool, steps: u32) -> RunStatus {
    let flag = AtomicBool::new(false);
    let mut observer = Stopper {
        left: steps,
        flag: &flag,
    };
    let options = RunOptions {
        threads: 1,
        resume,
        ..RunOptions::default()
    };
    let summary = run(scene, out, &options, &mut observer, &flag);
    summary.unwrap_or_else(|e| panic!("{e}")).status
}

#[test]
fn a_run_goes_on_with_the_same_bits() {
    let scene = loaded(&json!({
        "covact": 1,
        "materials": { "m": { "st_venant_kirchhoff": { "E": 1e4, "nu": 0.3, "density": 1.0 } } },
        "bodies": { "s": {
            "mesh": { "plate": { "size": [1.5, 0.5], "thickness": 0.1, "elements": [4, 1] } },
            "material": "m", "velocity": [0.5, 0, -2], "spin": { "rate": [0, 1, 0] },
            "placement": { "axis": [0, 1, 0], "angle": -5, "translation": [0, 0, 0.06] }
        } },
        "surfaces": { "floor": { "plane": { "center": [0.7, 0.2, 0], "size": [8, 8] }, "side": { "point": [0, 0, 1] } } },
        "contacts": { "c": { "slave": "s.bottom", "master": "floor", "friction": 0.2 } },
        "loads": { "weight": { "on": "s", "gravity": [0, 0, -9.81] } },
        "solution": { "dynamics": { "damping": { "mass": 0.5, "viscosity": 1e-4 } }, "end_time": 0.05 },
        "output": { "every": 5 }
    }));
    let (whole, pieces) = (tempfile::tempdir().unwrap(), tempfile::tempdir().unwrap());
    assert_eq!(part(&scene, whole.path(), false, u32::MAX), RunStatus::Done);
    let mut parts = 1;
    let mut status = part(&scene, pieces.path(), false, 3);
    while status == RunStatus::Interrupted {
        status = part(&scene, pieces.path(), true, 3 + parts % 4);
        parts += 1;
    }
    assert_eq!(status, RunStatus::Done);
    assert!(parts > 5, "{parts} parts");
    let mut compared = 0;
    for entry in std::fs::read_dir(whole.path()).unwrap() {
        let path = entry.unwrap().path();
        let name = path.file_name().unwrap();
        let other = pieces.path().join(name);
        if name == "history.csv" || path.extension().is_some_and(|e| e == "vtu") {
            assert!(
                std::fs::read(&path).unwrap() == std::fs::read(&other).unwrap(),
                "{name:?} differs"
            );
            compared += 1;
        }
    }
    assert!(compared > 5, "{compared} files");
    let text = std::fs::read_to_string(whole.path().join("history.csv")).unwrap();
    assert!(text.lines().count() > 20 && text.contains("energy.kinetic"));
}
