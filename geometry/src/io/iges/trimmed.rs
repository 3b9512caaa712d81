//! Faces with boundary curves as the file describes them: trimmed surfaces (144 over 142) and bounded surfaces (143 over
//! 141). B-rep faces are in `brep`. What becomes of the curves is in `io::brep`.

use super::super::error::Fail;
use super::curve::{self, Stop};
use super::directory::Entry;
use super::groups::{members, pointer};
use super::params::Params;
use super::transform::{Affine, matrix_of};
use super::{Model, entity_name};
use crate::io::brep::{Boundary, Face, Part, Preference, Stretch, reversed};

pub fn describe(entry: &Entry) -> String {
    let name = entity_name(entry.type_number, entry.form);
    format!("entity {} ({} {name})", entry.number, entry.type_number)
}

/// Reads a 144. `outer` maps the space of its curves (before their own matrices) to model space.
pub fn read_144(
    model: &Model,
    entry: &Entry,
    outer: &Affine,
    notes: &mut Vec<String>,
) -> Result<Face, Fail> {
    let params = model.params(entry)?;
    let base = pointer(model, &params, 1, "the surface of a trimmed surface (144)")?;
    let flag = params.integer(2, "the flag N1 of the outer boundary")?;
    if !(0..=1).contains(&flag) {
        return Err(params.fail(2, "0 or 1 for the flag N1 of the outer boundary"));
    }
    let holes = match params.len() {
        3 => 0,
        _ => params.count(3, "the number N2 of inner boundaries")?,
    };
    if holes > params.len().saturating_sub(4) {
        let expected = format!("{holes} pointers to inner boundaries");
        return Err(params.fail(params.len(), expected));
    }
    let mut face = Face {
        base,
        boundaries: Vec::new(),
        outer: flag == 1,
        // The pointer to the outer boundary is there even if N1 = 0, unless it ends the record.
        values: 5 + holes,
        fault: None,
    };
    let wanted = if flag == 1 {
        4..5 + holes
    } else {
        5..5 + holes
    };
    for i in wanted {
        let what = if i == 4 { "outer" } else { "inner" };
        let index = pointer(model, &params, i, &format!("the {what} boundary curve"))?;
        let boundary = read_boundary(model, index, base, outer, notes);
        match curve::settle(boundary)? {
            Ok(boundary) => face.boundaries.push(boundary),
            Err(reason) => {
                face.fault.get_or_insert(reason);
            }
        }
    }
    Ok(face)
}

/// Reads what bounds a face. The standard gives a trimmed surface (144) curves on a surface (142) and a bounded surface (143)
/// boundaries (141); some writers exchange them.
fn read_boundary(
    model: &Model,
    index: usize,
    base: usize,
    outer: &Affine,
    notes: &mut Vec<String>,
) -> Result<Boundary, Stop> {
    let entry = &model.entries[index];
    match entry.type_number {
        142 => read_142(model, index, base, outer, notes),
        141 => read_141(model, index, outer, notes),
        _ => {
            let reason = format!(
                "{} bounds it, which is neither a curve on a surface (142) nor a boundary (141)",
                describe(entry)
            );
            Err(Stop::Reason(reason))
        }
    }
}

/// Reads a 142: a curve in the parameter plane (BPTR), in space (CPTR), or in both.
fn read_142(
    model: &Model,
    index: usize,
    base: usize,
    outer: &Affine,
    notes: &mut Vec<String>,
) -> Result<Boundary, Stop> {
    let entry = &model.entries[index];
    let name = describe(entry);
    let params = model.params(entry)?;
    let surface = params.integer(2, "the surface of a curve on a surface (142)")?;
    if surface != 0 && surface != i64::from(model.entries[base].number) {
        notes.push(format!(
            "{name}: lies on entity {surface} by its own account, but bounds a part of entity {}",
            model.entries[base].number
        ));
    }
    let mut stretch = Stretch::default();
    if params.len() > 5 {
        // 1: the parameter plane, 2: space, 3: both alike, 0: it does not say.
        stretch.preference =
            match params.integer(5, "the preference PREF of a curve on a surface")? {
                1 => Preference::Parameter,
                2 => Preference::Space,
                _ => Preference::None,
            };
    }
    let bptr = params.integer(3, "the curve BPTR in the parameter plane")?;
    if bptr != 0 {
        let b = pointer(model, &params, 3, "the curve BPTR in the parameter plane")?;
        match curve::settle(parameter_parts(model, &model.entries[b], notes))? {
            Ok(parts) => stretch.parameter = parts,
            Err(reason) => notes.push(format!("{name}: BPTR not used: {reason}")),
        }
    }
    let cptr = match params.len() {
        4 => 0,
        _ => params.integer(4, "the curve CPTR in space")?,
    };
    if cptr != 0 {
        let c = pointer(model, &params, 4, "the curve CPTR in space")?;
        let map = outer.after(&matrix_of(model, entry, notes)?);
        match curve::settle(space_parts(model, &model.entries[c], &map, notes))? {
            Ok(parts) => stretch.space = parts,
            Err(reason) => notes.push(format!("{name}: CPTR not used: {reason}")),
        }
    }
    if stretch.parameter.is_empty() && stretch.space.is_empty() {
        let reason = format!("{name} has neither a curve in the parameter plane nor one in space");
        return Err(Stop::Reason(reason));
    }
    Ok(Boundary {
        name,
        stretches: vec![stretch],
    })
}

/// The parts of a curve in the parameter plane, as the file means its parameters.
pub fn parameter_parts(
    model: &Model,
    entry: &Entry,
    notes: &mut Vec<String>,
) -> Result<Vec<Part<2>>, Stop> {
    let chain = curve::read_parameters(model, entry, notes)?;
    let parts = chain.parts.into_iter().map(|p| Part {
        entity: p.entity,
        curve: p.curve.in_plane(),
    });
    Ok(parts.collect())
}

/// The parts of a curve in space.
pub fn space_parts(
    model: &Model,
    entry: &Entry,
    outer: &Affine,
    notes: &mut Vec<String>,
) -> Result<Vec<Part<3>>, Stop> {
    let chain = curve::read(model, entry, outer, notes)?;
    let parts = chain.parts.into_iter().map(|p| Part {
        entity: p.entity,
        curve: p.curve,
    });
    Ok(parts.collect())
}

/// Reads a 143: a surface with boundaries (141).
pub fn read_143(
    model: &Model,
    entry: &Entry,
    outer: &Affine,
    notes: &mut Vec<String>,
) -> Result<Face, Fail> {
    let params = model.params(entry)?;
    let base = pointer(model, &params, 2, "the surface of a bounded surface (143)")?;
    let list = members(
        model,
        &params,
        3,
        "a boundary (141) of a bounded surface (143)",
    )?;
    let mut face = Face {
        base,
        boundaries: Vec::new(),
        outer: true,
        values: 4 + params.count(3, "a number of boundaries")?,
        fault: None,
    };
    for index in list {
        match curve::settle(read_boundary(model, index, base, outer, notes))? {
            Ok(boundary) => face.boundaries.push(boundary),
            Err(reason) => {
                face.fault.get_or_insert(reason);
            }
        }
    }
    Ok(face)
}

/// Reads a 141: TYPE, PREF, surface, N, then for each curve CRVPT, SENSE, K and K curves in the parameter plane.
fn read_141(
    model: &Model,
    index: usize,
    outer: &Affine,
    notes: &mut Vec<String>,
) -> Result<Boundary, Stop> {
    let entry = &model.entries[index];
    let name = describe(entry);
    let params = model.params(entry)?;
    let map = outer.after(&matrix_of(model, entry, notes)?);
    // 1: space, 2: the parameter plane, 3: both alike, 0: it does not say.
    let preference = match params.integer(2, "the preference PREF of a boundary (141)")? {
        1 => Preference::Space,
        2 => Preference::Parameter,
        _ => Preference::None,
    };
    let count = params.count(4, "the number of curves of a boundary (141)")?;
    // Boundaries of curves in space alone (type 0) are also written without the counts K, which are all 0.
    let without_counts = params.len() == 5 + 2 * count && params.integer(1, "the type")? == 0;
    if count > params.len().saturating_sub(5) / 3 && !without_counts {
        let expected = format!("{count} curves with sense and parameter curves");
        return Err(params.fail(params.len(), expected).into());
    }
    let mut stretches = Vec::with_capacity(count);
    let mut at = 5;
    for _ in 0..count {
        let curve = pointer(model, &params, at, "a curve of a boundary (141)")?;
        let sense = params.integer(at + 1, "the sense of a curve of a boundary (141)")?;
        // Sense 1 or 2 by the standard. Stretches that do not follow each other are turned when the chain is made.
        if !(-1..=2).contains(&sense) {
            return Err(params.fail(at + 1, "sense 1 or 2").into());
        }
        if sense < 1 {
            notes.push(format!(
                "{name}: the sense {sense} of entity {} is neither 1 nor 2; read as {}",
                model.entries[curve].number,
                if sense == 0 { "1" } else { "2" }
            ));
        }
        let mut space = space_parts(model, &model.entries[curve], &map, notes)?;
        if sense == 2 || sense == -1 {
            space = reversed(space)?;
        }
        let (parameter, next) = match without_counts {
            true => (Vec::new(), at + 2),
            false => parameter_list(model, &params, at + 2, false, notes)?,
        };
        at = next;
        stretches.push(Stretch {
            parameter,
            space,
            preference,
            edge: model.entries[curve].number,
        });
    }
    Ok(Boundary { name, stretches })
}

/// A list of curves in the parameter plane behind its length at value `at`, each after an isoparametric flag where
/// `flags` says so; also where the list ends.
pub fn parameter_list(
    model: &Model,
    params: &Params,
    at: usize,
    flags: bool,
    notes: &mut Vec<String>,
) -> Result<(Vec<Part<2>>, usize), Stop> {
    let step = 1 + usize::from(flags);
    let count = params.count(at, "a number of curves in the parameter plane")?;
    if count > params.len().saturating_sub(at + 1) / step {
        let expected = format!("{count} pointers to curves in the parameter plane");
        return Err(params.fail(params.len(), expected).into());
    }
    let mut parts = Vec::new();
    for k in 0..count {
        let i = at + 1 + step * k + step - 1;
        // Left out: the curve in space alone counts.
        if params.integer(i, "a curve in the parameter plane")? == 0 {
            continue;
        }
        let index = pointer(model, params, i, "a curve in the parameter plane")?;
        let entry = &model.entries[index];
        match curve::settle(parameter_parts(model, entry, notes))? {
            Ok(read) => parts.extend(read),
            Err(reason) => {
                notes.push(format!("{}: not used: {reason}", describe(entry)));
                parts.clear();
                return Ok((parts, at + 1 + step * count));
            }
        }
    }
    Ok((parts, at + 1 + step * count))
}
