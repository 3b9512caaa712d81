//! Studies: a scene over a grid of choices, and the program itself, whose processes the runs of a study are.
use crate::error;
use crate::work::work;
use covact::study::{Folder, Settings, StudyError, conclude, expand, load, play, report};
use pyo3::prelude::*;
use std::ffi::OsString;
use std::path::PathBuf;
use std::sync::atomic::AtomicBool;

fn failed(py: Python<'_>, e: StudyError) -> PyErr {
    match e {
        StudyError::Scene(e) => error::of_scene(py, &e),
        other => error::plain(other),
    }
}

/// Does the runs of a study that have not been done, in processes of `program`, and writes the report; `study.json` as text.
#[pyfunction]
pub fn study(py: Python<'_>, path: PathBuf, out: PathBuf, program: PathBuf) -> PyResult<String> {
    let interrupt = AtomicBool::new(false);
    let record = work(py, &interrupt, None, || {
        let loaded = load(&path)?;
        let expansion = expand(&loaded)?;
        let folder = Folder::write(&out, &loaded.study, &expansion)?;
        let settings = Settings::of(&loaded.study.timing, program);
        play(&folder, &settings, &interrupt, &|_| {})?;
        let record = conclude(&loaded, &expansion, &folder);
        record.write(&out)?;
        report::write(&record, &out)?;
        Ok(record)
    })?;
    let record = record.map_err(|e| failed(py, e))?;
    serde_json::to_string(&record).map_err(error::plain)
}

/// The command line: `arguments` begin with the name of the program; its exit code.
#[pyfunction]
pub fn main(py: Python<'_>, arguments: Vec<OsString>, program: Option<PathBuf>) -> u8 {
    py.detach(|| covact::cli::main_of(arguments.into_iter(), program))
}
