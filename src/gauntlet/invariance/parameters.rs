//! The same surface in other parameters.
use super::{SAME, difference, run, some, still};
use crate::gauntlet::{CaseError, Trial};
use crate::soak::{Frame, Tool};
use covact_geometry::{NurbsPatch, PatchError};

type Change = fn(&NurbsPatch) -> Result<NurbsPatch, PatchError>;

fn changed(trial: &mut Trial, changes: &[(&str, Change)]) -> Result<(), CaseError> {
    for mut scene in some(3, true) {
        let Tool::Patch(patch) = scene.tool.clone() else {
            return Err(CaseError::new("no patch"));
        };
        let given = run(trial, &scene, &Frame::default())?;
        for (name, change) in changes {
            let other = change(&patch).map_err(|e| CaseError::new(e.to_string()))?;
            scene.tool = Tool::Patch(Box::new(other));
            let off = difference(&given, &run(trial, &scene, &Frame::default())?, still)?;
            trial.within(
                format!("seed {}, {name}: difference", scene.seed),
                off,
                SAME,
            );
        }
    }
    Ok(())
}

pub fn turned(trial: &mut Trial) -> Result<(), CaseError> {
    trial.iterations(1900);
    changed(
        trial,
        &[
            ("swapped", |p| p.swapped()),
            ("reversed", |p| p.reversed(0)),
            ("swapped and reversed", |p| p.swapped()?.reversed(1)),
        ],
    )
}

pub fn refined(trial: &mut Trial) -> Result<(), CaseError> {
    trial.iterations(1900);
    changed(
        trial,
        &[
            ("elevated", |p| p.elevated(0, 1)?.elevated(1, 2)),
            ("knots inserted", |p| {
                p.insert_knots(0, &[0.3, 1.7, 1.7])?
                    .insert_knots(1, &[2.1, 3.9])
            }),
            ("both", |p| p.insert_knots(1, &[0.5])?.elevated(0, 1)),
        ],
    )
}
