//! From folders of results to values, errors and what the references themselves are worth.
//!
//! A number, a curve or a field of a run is a `Sample`; samples of one kind have a distance, and errors are distances to a
//! reference, relative to its size or to the scale that the study gives. A reference that is the finest run of a refinement
//! has an error of its own, which `richardson` estimates from the distances between the runs of the refinement.
mod column;
mod curve;
mod field;
mod reference;
mod richardson;
mod sample;
mod summary;
mod told;
mod words;

use super::file::{Measure, Quantity, Study, Take};
use super::record::{Ending, Measured, QuantityRecord, RunRecord};
use reference::Known;
use sample::{Sample, Source};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use told::Told;

/// Runs whose error is below this many times that of the reference itself cannot be told apart.
const TELLABLE: f64 = 3.0;

/// Fills `measured` of every run, one entry per quantity of the study, and returns the quantities with their references and
/// what the user should know, in words. A run that was not done has entries that say so, and nothing is read of it.
///
/// `dir` is the folder of the study file, `folder` the results of the first repeat of a run (`history.csv`, `summary.json`,
/// `results.pvd`), and `references` the places in `runs` of the runs of every refinement, coarse to fine.
///
/// What cannot be measured or compared is no error of this function: the entry says why, and so does a warning.
pub fn measure(
    study: &Study,
    dir: &Path,
    runs: &mut [RunRecord],
    folder: &dyn Fn(&RunRecord) -> PathBuf,
    references: &BTreeMap<String, Vec<usize>>,
) -> (Vec<QuantityRecord>, Vec<String>) {
    let folders = runs.iter().map(folder).collect();
    let source = Source::new(folders);
    let mut warnings = Vec::new();
    let mut records = Vec::with_capacity(study.quantities.len());
    runs.iter_mut().for_each(|run| run.measured.clear());
    for quantity in &study.quantities {
        let mut told = Told::new(&quantity.name);
        let known = reference::find(study, quantity, dir, runs, &source, references, &mut told);
        let measured = runs
            .iter()
            .enumerate()
            .map(|(i, run)| one(quantity, i, run, &source, known.as_ref(), &mut told))
            .collect::<Vec<_>>();
        for (run, measured) in runs.iter_mut().zip(measured) {
            run.measured.push(measured);
        }
        let reference = known.map(|known| match known {
            Ok(known) => known.record,
            Err(lost) => lost.into_record(),
        });
        if let Some(own) = reference.as_ref().and_then(|r| r.error) {
            near(runs, own, &mut told);
        }
        records.push(QuantityRecord {
            name: quantity.name.clone(),
            unit: quantity.unit.clone(),
            measure: words::measure(&quantity.of),
            curve: takes(quantity, Take::Curve),
            swing: takes(quantity, Take::Swing),
            reference,
        });
        warnings.extend(told.into_words());
    }
    (records, warnings)
}

fn takes(quantity: &Quantity, this: Take) -> bool {
    matches!(&quantity.of, Measure::Column { take, .. } if *take == this)
}

/// A quantity of a run.
fn one(
    quantity: &Quantity,
    index: usize,
    run: &RunRecord,
    source: &Source,
    known: Option<&Result<Known, reference::Lost>>,
    told: &mut Told,
) -> Measured {
    let mut out = Measured::default();
    if let Some(why) = undone(run) {
        out.missing = Some(why);
        return out;
    }
    let sampled = match source.sample(index, &quantity.of) {
        Ok(sampled) => sampled,
        Err(why) => {
            told.run(&why, &run.id, None);
            out.missing = Some(why);
            return out;
        }
    };
    for note in &sampled.notes {
        told.run(&note.text, &run.id, note.detail.as_deref());
    }
    match &sampled.sample {
        Sample::Value(value) => out.value = Some(*value),
        Sample::Curve(curve) => out.curve = Some(curve.clone()),
        Sample::Field(_) => {}
    }
    let known = match known {
        None => return out,
        Some(Err(lost)) => {
            out.missing = Some(format!("no error without a reference: {}", lost.why));
            return out;
        }
        Some(Ok(known)) => known,
    };
    if known.finest == Some(index) {
        out.missing = Some("it is the reference itself".into());
        return out;
    }
    match sampled.sample.difference(&known.sample) {
        Ok(difference) => {
            for note in &difference.notes {
                told.run(&note.text, &run.id, note.detail.as_deref());
            }
            match sample::scale(quantity.scale, difference.size) {
                Ok(scale) => out.error = Some(difference.distance / scale),
                Err(why) => {
                    told.all(&why);
                    out.missing = Some(why);
                }
            }
        }
        Err(why) => {
            told.run(&why, &run.id, None);
            out.missing = Some(why);
        }
    }
    out
}

/// Why a run has no results.
fn undone(run: &RunRecord) -> Option<String> {
    match &run.ending {
        Ending::Done => None,
        Ending::Failed(why) => Some(format!("the run failed: {why}")),
        Ending::Missing => Some("the run has not been done".into()),
    }
}

/// Names the runs whose last measured error does not stand out from that of the reference.
fn near(runs: &[RunRecord], own: f64, told: &mut Told) {
    let text = format!(
        "errors below {TELLABLE} times that of the reference itself ({own:.1e}) cannot be told apart"
    );
    for run in runs {
        let error = run.measured.last().and_then(|m| m.error);
        if let Some(error) = error.filter(|e| *e < TELLABLE * own) {
            told.run(&text, &run.id, Some(&format!("{error:.1e}")));
        }
    }
}

#[cfg(test)]
mod tests;
