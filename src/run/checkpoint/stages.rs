//! The stage of a run in a checkpoint, and what is known of those before.
use super::bytes::{Malformed, Reader, Writer};
use crate::model::Model;
use crate::model::stages::StageStart;
use crate::output::StageSummary;

/// What the present stage began with, and the stages that have ended.
pub fn put(model: &Model, ended: &[StageSummary], out: &mut Writer) {
    let start = model.stage.as_ref().map(|stage| &stage.start);
    out.option(start, |out, start| {
        let StageStart {
            index,
            stabilized,
            dissipated,
            force,
            released,
            held,
        } = start;
        out.count(*index);
        out.bool(*stabilized);
        out.f64(*dissipated);
        out.f64(*force);
        for values in [released, held] {
            out.count(values.len());
            for (dof, value) in values {
                out.u32(*dof);
                out.f64(*value);
            }
        }
    });
    out.count(ended.len());
    for stage in ended {
        let StageSummary {
            name,
            until,
            step,
            force,
            found_supports,
            reaction,
            bearing,
        } = stage;
        out.text(name);
        out.f64(*until);
        out.u32(*step);
        out.f64(*force);
        out.count(*found_supports);
        out.f64(*reaction);
        out.count(bearing.len());
        bearing.iter().for_each(|name| out.text(name));
    }
}

/// [`put`], read back.
pub fn take(from: &mut Reader) -> Result<(StageStart, Vec<StageSummary>), Malformed> {
    let start = from.option(|from| {
        let index = from.count(0)?;
        let (stabilized, dissipated, force) = (from.bool()?, from.f64()?, from.f64()?);
        let mut values = || -> Result<Vec<(u32, f64)>, Malformed> {
            let count = from.count(12)?;
            (0..count).map(|_| Ok((from.u32()?, from.f64()?))).collect()
        };
        let (released, held) = (values()?, values()?);
        Ok(StageStart {
            index,
            stabilized,
            dissipated,
            force,
            released,
            held,
        })
    })?;
    let count = from.count(16)?;
    let ended: Result<_, _> = (0..count)
        .map(|_| {
            Ok(StageSummary {
                name: from.text()?.to_owned(),
                until: from.f64()?,
                step: from.u32()?,
                force: from.f64()?,
                found_supports: from.count(0)?,
                reaction: from.f64()?,
                bearing: {
                    let count = from.count(8)?;
                    let names = (0..count).map(|_| from.text().map(str::to_owned));
                    names.collect::<Result<_, _>>()?
                },
            })
        })
        .collect();
    Ok((start.unwrap_or_default(), ended?))
}
