//! Constructed results whose measures, errors and orders are known in closed form, and small runs of the program.
mod columns;
mod fields;
mod real;
mod references;
mod slave_fields;

use super::measure;
use crate::study::file::Study;
use crate::study::record::{Ending, Measured, QuantityRecord, RunRecord};
use serde_json::{Value as Json, json};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// Folders of results, and the runs they are of.
struct Bench {
    dir: tempfile::TempDir,
    runs: Vec<RunRecord>,
    references: BTreeMap<String, Vec<usize>>,
}

impl Bench {
    fn new() -> Bench {
        Bench {
            dir: tempfile::tempdir().expect("temporary folder"),
            runs: Vec::new(),
            references: BTreeMap::new(),
        }
    }

    fn folder(&self, id: &str) -> PathBuf {
        self.dir.path().join(id)
    }

    /// A run that ended so; its folder is made.
    fn ended(&mut self, id: &str, ending: Ending) -> PathBuf {
        let folder = self.folder(id);
        std::fs::create_dir_all(&folder).expect("folder");
        self.runs.push(RunRecord {
            id: id.to_string(),
            choices: BTreeMap::new(),
            reference: None,
            ending,
            wall: None,
            cpu: None,
            phases: BTreeMap::new(),
            peak_memory_mb: None,
            dofs: 0,
            contact_points: 0,
            newton_iterations: 0,
            steps: 0,
            cuts: 0,
            steps_taken: Vec::new(),
            factorizations: BTreeMap::new(),
            warnings: Vec::new(),
            measured: Vec::new(),
        });
        folder
    }

    fn done(&mut self, id: &str) -> PathBuf {
        self.ended(id, Ending::Done)
    }

    /// A run with a history of columns `time` and `f`.
    fn history(&mut self, id: &str, rows: &[[f64; 2]]) {
        let rows = rows.iter().map(|[t, f]| format!("{t:?},{f:?}\n"));
        self.csv(id, &format!("time,f\n{}", rows.collect::<String>()));
    }

    fn csv(&mut self, id: &str, text: &str) {
        let folder = self.done(id);
        std::fs::write(folder.join("history.csv"), text).expect("history");
    }

    /// The last runs, as many as are named, are a refinement.
    fn refinement(&mut self, name: &str, count: usize) {
        let end = self.runs.len();
        self.references
            .insert(name.to_string(), (end - count..end).collect());
    }

    /// Measures with quantities and references of a study file.
    fn measure(
        &mut self,
        quantities: Json,
        references: Json,
    ) -> (Vec<QuantityRecord>, Vec<String>) {
        let study = study(quantities, references);
        let path = self.dir.path().to_path_buf();
        let folder = |run: &RunRecord| path.join(&run.id);
        let out = measure(
            &study,
            self.dir.path(),
            &mut self.runs,
            &folder,
            &self.references,
        );
        for run in &self.runs {
            assert_eq!(run.measured.len(), study.quantities.len(), "{}", run.id);
        }
        out
    }

    /// What was measured of a run.
    fn of(&self, id: &str) -> &Measured {
        let run = self.runs.iter().find(|r| r.id == id).expect(id);
        &run.measured[0]
    }

    fn error(&self, id: &str) -> f64 {
        let m = self.of(id);
        m.error.unwrap_or_else(|| panic!("{id}: {m:?}"))
    }

    fn missing(&self, id: &str) -> &str {
        let m = self.of(id);
        assert_eq!(m.error, None);
        m.missing
            .as_deref()
            .unwrap_or_else(|| panic!("{id}: {m:?}"))
    }
}

fn study(quantities: Json, references: Json) -> Study {
    let all = json!({
        "covact_study": 1,
        "scene": "scene.json",
        "grids": [],
        "references": references,
        "quantities": quantities,
    });
    serde_json::from_value(all).expect("a study")
}

/// A single quantity: something taken of column `f`.
fn of_f(take: Json) -> Json {
    json!([{ "name": "q", "of": { "column": { "name": "f", "take": take } } }])
}

/// The same with a reference.
fn of_f_against(take: Json, reference: Json) -> Json {
    json!([{
        "name": "q",
        "of": { "column": { "name": "f", "take": take } },
        "reference": reference
    }])
}

fn finest() -> Json {
    json!({ "finest": "fine" })
}

/// A refinement of three runs; `more` are further keys.
fn refinement(more: Json) -> Json {
    let mut all = json!({ "runs": [{}, {}, {}] });
    for (key, value) in more.as_object().into_iter().flatten() {
        all[key] = value.clone();
    }
    json!({ "fine": all })
}

#[track_caller]
fn near(a: f64, b: f64, tolerance: f64) {
    assert!(
        (a - b).abs() <= tolerance * b.abs().max(1e-300),
        "{a} is not {b}"
    );
}

/// One of the sentences holds all the words.
#[track_caller]
fn says(warnings: &[String], words: &[&str]) {
    let holds = |w: &&String| words.iter().all(|word| w.contains(word));
    assert!(
        warnings.iter().any(|w| holds(&w)),
        "{words:?} in {warnings:?}"
    );
}

fn write(path: &Path, text: &str) {
    std::fs::write(path, text).expect("file");
}
