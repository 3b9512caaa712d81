//! Shapes that break closest points: the same geometry described in another way gives the same answer.
mod borders;
mod curved;
mod described;
mod edges;
mod focal;

use super::{Case, CaseError, Group, Outcome, Trial};
use covact_geometry::primitives::PrimitiveError;
use covact_geometry::trim::TrimError;
use covact_geometry::{NurbsPatch, PatchError};
use serde_json::{Value, json};

pub const GROUP: Group = Group {
    name: "geometry",
    cases: &[
        described::POLE,
        described::SEAM,
        described::WEIGHTS,
        described::SHORT_SPAN,
        described::SLIVER,
        described::REVERSED_PATCH,
        curved::FLAT_CYLINDER,
        curved::SMALL_RADIUS,
        focal::FOCAL,
        focal::BEYOND_FOCAL,
        edges::CREASE,
        edges::CONVEX_EDGE,
        edges::CONCAVE_EDGE,
        edges::CORNER,
        edges::THIN_TOOL,
        borders::GAPS,
        borders::TRIM,
        borders::FREE_EDGE,
    ],
};

impl From<PrimitiveError> for CaseError {
    fn from(error: PrimitiveError) -> Self {
        CaseError::new(error.to_string())
    }
}

impl From<PatchError> for CaseError {
    fn from(error: PatchError) -> Self {
        CaseError::new(error.to_string())
    }
}

impl From<TrimError> for CaseError {
    fn from(error: TrimError) -> Self {
        CaseError::new(error.to_string())
    }
}

/// A tool of patches with its motion.
fn tool(
    trial: &Trial,
    name: &str,
    patches: Vec<NurbsPatch>,
    motion: [&str; 3],
) -> Result<Value, CaseError> {
    let file = trial.cad(name, patches)?;
    Ok(json!({ "cad": { "file": file }, "motion": { "translation": motion } }))
}

/// Quantities of a run that are compared: columns whose largest value is the measure of all of them. Moments of a block of
/// size 1 are measured by its forces.
const COMPARED: [&[&str]; 6] = [
    &[
        "force.tool.x",
        "force.tool.y",
        "force.tool.z",
        "moment.tool.x",
        "moment.tool.y",
        "moment.tool.z",
    ],
    &["energy.internal"],
    &["energy.contact"],
    &["penetration.max"],
    &["pressure.max"],
    &["area.contact"],
];

/// Largest difference of two runs that press with `tool`, at the end, relative to the largest number of the same kind.
fn difference(a: &Outcome, b: &Outcome) -> Result<f64, CaseError> {
    let mut largest = 0.0f64;
    for columns in COMPARED {
        let mut pairs = Vec::new();
        for name in columns {
            pairs.push([a.last(name)?, b.last(name)?]);
        }
        let scale = pairs.iter().fold(0.0f64, |s, p| s.max(p[0].abs()));
        if scale == 0.0 {
            return Err(CaseError(format!("{columns:?} is nothing")));
        }
        for [a, b] in pairs {
            // A difference that is no number must not pass for a small one.
            let d = (a - b).abs() / scale;
            largest = if d <= largest { largest } else { d };
        }
    }
    Ok(largest)
}
