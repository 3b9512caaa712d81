//! What runs are compared with.
use super::super::file::{Measure, Quantity, Reference, Refinement, Study, Take};
use super::super::record::{ReferenceRecord, RunRecord};
use super::richardson;
use super::sample::{self, Sample, Source};
use super::told::Told;
use super::{column, undone};
use crate::output::read_csv;
use crate::scene::nearest;
use std::collections::BTreeMap;
use std::path::Path;

/// A reference that runs can be compared with.
pub(super) struct Known {
    pub record: ReferenceRecord,
    pub sample: Sample,
    /// The run that it is.
    pub finest: Option<usize>,
}

/// A reference that is not there.
pub(super) struct Lost {
    source: String,
    pub why: String,
}

impl Lost {
    fn new(source: impl Into<String>, why: impl Into<String>) -> Lost {
        Lost {
            source: source.into(),
            why: why.into(),
        }
    }

    pub fn into_record(self) -> ReferenceRecord {
        bare(self.source)
    }
}

/// The reference of a quantity; none where the study names none. What is wrong with it is told.
pub(super) fn find(
    study: &Study,
    quantity: &Quantity,
    dir: &Path,
    runs: &[RunRecord],
    source: &Source,
    references: &BTreeMap<String, Vec<usize>>,
    told: &mut Told,
) -> Option<Result<Known, Lost>> {
    let found = match quantity.reference.as_ref()? {
        Reference::Value { value, source } => number(&quantity.of, *value, source),
        Reference::Curve { file, x, y, source } => {
            stored(&quantity.of, &dir.join(file), [x, y], source)
        }
        Reference::Finest(name) => {
            let sequence = references.get(name).map_or(&[][..], Vec::as_slice);
            match study.references.get(name) {
                Some(refinement) => Sequence {
                    name,
                    refinement,
                    quantity,
                    runs,
                    source,
                }
                .finest(sequence, told),
                None => {
                    let names = study.references.keys().map(String::as_str);
                    let near = nearest(name, names);
                    let near = near.map_or(String::new(), |n| format!("; did you mean `{n}`?"));
                    let why = format!("the study has no reference `{name}`{near}");
                    Err(Lost::new(format!("`{name}`"), why))
                }
            }
        }
    };
    if let Err(lost) = &found {
        told.all(&format!("no errors, since {}", lost.why));
    }
    Some(found)
}

/// A record with nothing but its source.
fn bare(source: String) -> ReferenceRecord {
    ReferenceRecord {
        source,
        value: None,
        curve: None,
        error: None,
        order: None,
        observed: false,
    }
}

fn is_curve(of: &Measure) -> bool {
    matches!(
        of,
        Measure::Column {
            take: Take::Curve,
            ..
        }
    )
}

fn number(of: &Measure, value: f64, source: &str) -> Result<Known, Lost> {
    let refuse = |why: &str| Err(Lost::new(source, why));
    match of {
        Measure::Field { .. } => {
            return refuse("a field is compared with a run, not with a number");
        }
        of if is_curve(of) => return refuse("a curve is compared with a curve, not with a number"),
        _ if !value.is_finite() => return refuse("the reference is no number"),
        _ => {}
    }
    Ok(Known {
        record: ReferenceRecord {
            value: Some(value),
            error: Some(0.0),
            ..bare(source.to_string())
        },
        sample: Sample::Value(value),
        finest: None,
    })
}

fn stored(of: &Measure, file: &Path, [x, y]: [&str; 2], source: &str) -> Result<Known, Lost> {
    let refuse = |why: String| Lost::new(source, why);
    if !is_curve(of) {
        let what = "a stored curve is there to compare curves with (`take`: `curve`)";
        return Err(refuse(what.into()));
    }
    let table = read_csv(file).map_err(|e| refuse(e.to_string()))?;
    let named = |name: &str| {
        column::column(&table, name).map_err(|why| refuse(format!("in `{}` {why}", file.display())))
    };
    let curve: Vec<[f64; 2]> = (named(x)?.into_iter().zip(named(y)?))
        .map(|(x, y)| [x, y])
        .collect();
    if curve.len() < 2 || curve.iter().flatten().any(|v| !v.is_finite()) {
        let what = "has to hold two points or more, all of them numbers";
        return Err(refuse(format!("`{}` {what}", file.display())));
    }
    Ok(Known {
        record: ReferenceRecord {
            curve: Some(curve.clone()),
            ..bare(source.to_string())
        },
        sample: Sample::Curve(curve),
        finest: None,
    })
}

/// The runs of a refinement.
struct Sequence<'a> {
    name: &'a str,
    refinement: &'a Refinement,
    quantity: &'a Quantity,
    runs: &'a [RunRecord],
    source: &'a Source,
}

impl Sequence<'_> {
    /// The last run as the reference, with an estimate of its own error.
    fn finest(&self, sequence: &[usize], told: &mut Told) -> Result<Known, Lost> {
        let name = self.name;
        let source = |id: &str| format!("run `{id}`, the finest of `{name}`");
        let Some((&last, before)) = sequence.split_last() else {
            let why = format!("reference `{name}` has no runs");
            return Err(Lost::new(format!("`{name}`"), why));
        };
        let Some(run) = self.runs.get(last) else {
            let why = format!("the runs of reference `{name}` are not there");
            return Err(Lost::new(format!("`{name}`"), why));
        };
        let source = source(&run.id);
        let sample = match self.sample(last) {
            Ok(sample) => sample,
            Err(why) => {
                let why = format!("the reference is missing ({source}): {why}");
                return Err(Lost::new(source, why));
            }
        };
        let mut record = bare(source);
        match &sample {
            Sample::Value(value) => record.value = Some(*value),
            Sample::Curve(curve) => record.curve = Some(curve.clone()),
            Sample::Field(_) => {}
        }
        match self.estimate(&sample, before, told) {
            Ok((estimate, scale)) => {
                if let Some(doubt) = &estimate.doubt {
                    told.all(&format!("reference `{name}`: {doubt}"));
                }
                record.error = Some(estimate.error / scale);
                record.order = estimate.order;
                record.observed = estimate.observed;
            }
            Err(why) => told.all(&format!(
                "no estimate of the error of reference `{name}`: {why}"
            )),
        }
        Ok(Known {
            record,
            sample,
            finest: Some(last),
        })
    }

    fn sample(&self, run: usize) -> Result<Sample, String> {
        let record = (self.runs.get(run)).ok_or("there is no such run")?;
        if let Some(why) = undone(record) {
            return Err(why);
        }
        let sampled = self.source.sample(run, &self.quantity.of)?;
        Ok(sampled.sample)
    }

    /// Error of the finest run, in the unit of the quantity, and what to divide it by.
    fn estimate(
        &self,
        finest: &Sample,
        before: &[usize],
        told: &mut Told,
    ) -> Result<(richardson::Estimate, f64), String> {
        let of = |run: usize| {
            self.sample(run).map_err(|why| {
                let id = self.runs.get(run).map_or("", |r| r.id.as_str());
                format!("a coarser run is missing (`{id}`): {why}")
            })
        };
        let Some((&middle, coarser)) = before.split_last() else {
            return Err("it has one run only".into());
        };
        let middle = of(middle)?;
        // Without the coarsest run a declared order does.
        let coarse = match (coarser.last(), self.refinement.order) {
            (Some(&run), None) => Some((run, of(run)?)),
            (Some(&run), Some(_)) => of(run).ok().map(|sample| (run, sample)),
            (None, _) => None,
        };
        let last = middle.difference(finest)?;
        let scale = sample::scale(self.quantity.scale, last.size)?;
        let last = signed(&middle, finest, last.distance);
        let before = match &coarse {
            Some((run, coarse)) => {
                let difference = coarse.difference(&middle)?;
                for note in &difference.notes {
                    let id = &self.runs[*run].id;
                    told.run(&note.text, id, note.detail.as_deref());
                }
                Some(signed(coarse, &middle, difference.distance))
            }
            None => None,
        };
        let Refinement { ratio, order, .. } = *self.refinement;
        Ok((richardson::estimate(before, last, ratio, order)?, scale))
    }
}

/// The difference of values with its sign; other distances have none.
fn signed(coarse: &Sample, fine: &Sample, distance: f64) -> f64 {
    match (coarse, fine) {
        (Sample::Value(a), Sample::Value(b)) => b - a,
        _ => distance,
    }
}
