//! What was measured of a run, before it is compared with anything.
use super::super::file::Measure;
use super::field::Field;
use super::{column, curve, summary};
use crate::output::{Table, read_csv};
use serde_json::Value as Json;
use std::cell::OnceCell;
use std::path::PathBuf;

/// A number, a curve or a field.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Sample {
    Value(f64),
    /// Independent variable and value.
    Curve(Vec<[f64; 2]>),
    Field(Box<Field>),
}

/// Something to tell the user about.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Note {
    /// The same for all runs that it holds for.
    pub text: String,
    /// What differs between them.
    pub detail: Option<String>,
}

/// A sample with what the user should know about it.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Sampled {
    pub sample: Sample,
    pub notes: Vec<Note>,
}

/// How far a sample is from another.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Difference {
    /// Of values the size of their difference, of curves and fields the root of its mean square.
    pub distance: f64,
    /// Of the other sample, measured as the distance is.
    pub size: f64,
    pub notes: Vec<Note>,
}

impl Sample {
    /// How far it is from the reference.
    pub fn difference(&self, reference: &Sample) -> Result<Difference, String> {
        match (self, reference) {
            (Sample::Value(a), Sample::Value(b)) => Ok(Difference {
                distance: (a - b).abs(),
                size: b.abs(),
                notes: Vec::new(),
            }),
            (Sample::Curve(a), Sample::Curve(b)) => curve::difference(a, b),
            (Sample::Field(a), Sample::Field(b)) => a.difference(b),
            _ => Err(format!(
                "{} cannot be compared with {}",
                self.kind(),
                reference.kind()
            )),
        }
    }

    fn kind(&self) -> &'static str {
        match self {
            Sample::Value(_) => "a number",
            Sample::Curve(_) => "a curve",
            Sample::Field(_) => "a field",
        }
    }
}

/// What errors are divided by: `given`, or the size of the reference.
pub(super) fn scale(given: Option<f64>, size: f64) -> Result<f64, String> {
    match given {
        Some(scale) if scale > 0.0 && scale.is_finite() => Ok(scale),
        Some(scale) => Err(format!("errors cannot be divided by a scale of {scale}")),
        None if size > 0.0 && size.is_finite() => Ok(size),
        None => Err(
            "the reference is zero and no `scale` is given, so there are no relative errors".into(),
        ),
    }
}

/// The results of all runs. Tables and summaries are read once and kept, fields are read when asked for.
pub(super) struct Source {
    runs: Vec<Files>,
}

struct Files {
    folder: PathBuf,
    history: OnceCell<Result<Table, String>>,
    summary: OnceCell<Result<Json, String>>,
}

impl Source {
    pub fn new(folders: Vec<PathBuf>) -> Source {
        let files = |folder| Files {
            folder,
            history: OnceCell::new(),
            summary: OnceCell::new(),
        };
        Source {
            runs: folders.into_iter().map(files).collect(),
        }
    }

    /// Measures a run.
    ///
    /// # Errors
    /// In words, what is not there.
    pub fn sample(&self, run: usize, of: &Measure) -> Result<Sampled, String> {
        let files = (self.runs.get(run)).ok_or("there is no such run")?;
        match of {
            Measure::Column {
                name,
                take,
                between,
                over,
            } => column::take(files.history()?, name, *take, *between, over.as_deref()),
            Measure::Summary { name } => Ok(Sampled {
                sample: Sample::Value(summary::number(files.summary()?, name)?),
                notes: Vec::new(),
            }),
            Measure::Field { body, name } => Ok(Sampled {
                sample: Sample::Field(Box::new(Field::read(&files.folder, body, name)?)),
                notes: Vec::new(),
            }),
        }
    }
}

impl Files {
    fn history(&self) -> Result<&Table, String> {
        let read = || read_csv(&self.folder.join("history.csv")).map_err(|e| e.to_string());
        self.history
            .get_or_init(read)
            .as_ref()
            .map_err(String::clone)
    }

    fn summary(&self) -> Result<&Json, String> {
        let path = self.folder.join("summary.json");
        let read = || {
            let text = std::fs::read_to_string(&path);
            let text = text.map_err(|e| format!("cannot read `{}`: {e}", path.display()))?;
            serde_json::from_str(&text).map_err(|e| format!("`{}`: {e}", path.display()))
        };
        self.summary
            .get_or_init(read)
            .as_ref()
            .map_err(String::clone)
    }
}
