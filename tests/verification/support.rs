//! Runs the shipped scenes, changed where a test needs it, and reads their results.
use covact::output::{Summary, Table, read_csv};
use covact::run::{RunOptions, run};
use covact::scene;
use covact::solve::event::{Event, Observer};
use serde_json::Value;
use std::path::PathBuf;
use std::sync::atomic::AtomicBool;

/// Results of a run.
pub struct Outcome {
    pub summary: Summary,
    pub history: Table,
    pub events: Vec<Event>,
    /// Holds the results while the test looks at them.
    pub folder: tempfile::TempDir,
}

/// Keeps every event.
#[derive(Default)]
struct Recorder(Vec<Event>);

impl Observer for Recorder {
    fn event(&mut self, event: &Event) {
        if std::env::var_os("COVACT_TRACE").is_some() {
            println!("{event:?}");
        }
        self.0.push(event.clone());
    }
}

fn scenes() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("examples/scenes")
}

/// The JSON of a shipped scene.
pub fn scene_json(name: &str) -> Value {
    let text = std::fs::read_to_string(scenes().join(name)).expect("shipped scene");
    serde_json::from_str(&text).expect("valid JSON")
}

/// Sets the value at a JSON pointer that exists.
pub fn set(scene: &mut Value, pointer: &str, value: impl Into<Value>) {
    *scene.pointer_mut(pointer).expect(pointer) = value.into();
}

/// Runs a scene; paths in it are relative to the shipped scenes.
pub fn solve(scene: &Value) -> Outcome {
    let text = serde_json::to_string_pretty(scene).expect("serialisable");
    let mut loaded = match scene::parse(&text, "scene.json") {
        Ok(loaded) => loaded,
        Err(e) => panic!("{e}"),
    };
    loaded.dir = scenes();
    let folder = tempfile::tempdir().expect("temporary folder");
    let mut recorder = Recorder::default();
    let never = AtomicBool::new(false);
    let options = RunOptions::default();
    let summary = match run(&loaded, folder.path(), &options, &mut recorder, &never) {
        Ok(summary) => summary,
        Err(e) => panic!("{e}"),
    };
    let history = read_csv(&folder.path().join("history.csv")).expect("history");
    Outcome {
        summary,
        history,
        events: recorder.0,
        folder,
    }
}

impl Outcome {
    /// A column of the history.
    pub fn column(&self, name: &str) -> Vec<f64> {
        self.history
            .column(name)
            .unwrap_or_else(|| panic!("no column {name} in {:?}", self.history.columns))
    }

    /// Value of a column at the step that ends at `time`.
    pub fn at(&self, name: &str, time: f64) -> f64 {
        let times = self.column("time");
        let row = (times.iter().position(|t| (t - time).abs() < 1e-9))
            .unwrap_or_else(|| panic!("no step ends at {time}: {times:?}"));
        self.column(name)[row]
    }
}
