//! What a study found: all runs, measured.
use super::expand::Expansion;
use super::folder::Folder;
use super::gather::gather;
use super::load::LoadedStudy;
use super::measure::measure;
use super::record::{Machine, RECORD_FORMAT, Record, RunRecord};
use crate::output::OutputError;
use crate::output::atomic::write_whole;
use std::path::Path;

/// Takes what is in the folder of a study, measures it, and makes a record of it.
pub fn conclude(loaded: &LoadedStudy, expansion: &Expansion, folder: &Folder) -> Record {
    let study = &loaded.study;
    let (mut runs, mut warnings, results) = gather(folder, expansion, &study.timing);
    let of = |run: &RunRecord| {
        let known = results.get(&run.id).cloned();
        known.unwrap_or_else(|| folder.results(&run.id, 1))
    };
    let (quantities, told) = measure(study, &loaded.dir, &mut runs, &of, &expansion.references);
    warnings.extend(told);
    Record {
        format: RECORD_FORMAT,
        covact: env!("CARGO_PKG_VERSION").to_owned(),
        title: study.title.clone(),
        question: study.question.clone(),
        scene: study.scene_name(),
        machine: machine(),
        timing: study.timing,
        choices: expansion.choices.clone(),
        quantities,
        targets: study.targets.clone(),
        runs,
        warnings,
    }
}

impl Record {
    /// Writes the record as `study.json` into the folder of the study, whole or not at all.
    ///
    /// # Errors
    /// The file cannot be written.
    pub fn write(&self, out: &Path) -> Result<(), OutputError> {
        let mut text = serde_json::to_string_pretty(self).map_err(|e| OutputError::Serialise {
            part: "the record of the study".to_owned(),
            reason: e.to_string(),
        })?;
        text.push('\n');
        write_whole(&out.join("study.json"), text.as_bytes())
    }
}

/// The machine that this program runs on.
pub fn machine() -> Machine {
    Machine {
        processor: processor().unwrap_or_default(),
        cores: std::thread::available_parallelism().map_or(1, usize::from),
        system: format!("{} {}", std::env::consts::OS, std::env::consts::ARCH),
    }
}

/// Linux tells.
fn processor() -> Option<String> {
    let text = std::fs::read_to_string("/proc/cpuinfo").ok()?;
    let line = text.lines().find(|l| l.starts_with("model name"))?;
    Some(line.split_once(':')?.1.trim().to_owned())
}
