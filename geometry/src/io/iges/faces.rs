//! What becomes of every surface entity of a file: read, or skipped for a reason.

use super::super::error::Fail;
use super::super::report::{CadPatch, Skipped};
use super::directory::Entry;
use super::transform::{Affine, matrix_of};
use super::{Model, entity_name, surface};

type Outcome = (Vec<CadPatch>, Vec<Skipped>);

/// Who uses an entity, by its index in the directory.
#[derive(Default, Clone)]
struct Usage {
    /// The face (143, 144, 510) or offset surface (140) that it carries; that entity is reported in its place.
    face: Option<usize>,
    /// The subfigure definition (308) that it belongs to.
    subfigure: Option<usize>,
    /// The group (402) that it belongs to. Groups only collect.
    group: Option<usize>,
}

/// Reads all surfaces.
pub fn read(model: &Model, notes: &mut Vec<String>) -> Result<Outcome, Fail> {
    let usage = usage(model)?;
    let mut patches = Vec::new();
    let mut skipped = Vec::new();
    for (index, entry) in model.entries.iter().enumerate() {
        let used = &usage[index];
        let carried = used.face.is_some();
        if !is_surface(entry.type_number) || carried {
            continue;
        }
        let mut reason = refusal(entry, used, model);
        let mut name = None;
        if reason.is_none() {
            let outer = group_matrix(model, &usage, index, notes)?;
            match entry.type_number {
                128 => reason = free(model, entry, &outer, &mut name, &mut patches, notes)?,
                144 => reason = untrimmed(model, entry, &outer, &mut name, &mut patches, notes)?,
                _ => reason = Some(unsupported(model, entry)?),
            }
        }
        if let Some(reason) = reason {
            let name = match name {
                Some(name) => Some(name),
                None => own_name(entry),
            };
            skipped.push(Skipped {
                entity: entry.number,
                type_number: entry.type_number,
                name: name.unwrap_or_else(|| entity_name(entry.type_number, entry.form).to_owned()),
                reason,
            });
        }
    }
    Ok((patches, skipped))
}

/// Entities that are a surface, or a solid whose boundary would be one.
fn is_surface(type_number: u32) -> bool {
    matches!(
        type_number,
        108 | 114 | 118 | 120 | 122 | 128 | 140 | 143 | 144 | 190 | 192 | 194 | 196 | 198 | 510
    ) || is_solid(type_number)
}

/// Solid primitives, and instances of solids.
fn is_solid(type_number: u32) -> bool {
    matches!(
        type_number,
        150 | 152 | 154 | 156 | 158 | 160 | 162 | 164 | 168 | 430
    )
}

/// Who uses whom: the pointers of faces, subfigure definitions and groups.
fn usage(model: &Model) -> Result<Vec<Usage>, Fail> {
    let mut usage = vec![Usage::default(); model.entries.len()];
    for (parent, entry) in model.entries.iter().enumerate() {
        let (at, what) = match entry.type_number {
            144 => (1, "the surface of a trimmed surface (144)"),
            510 => (1, "the surface of a face (510)"),
            143 => (2, "the surface of a bounded surface (143)"),
            140 => (5, "the surface of an offset surface (140)"),
            308 => {
                let params = model.params(entry)?;
                for (child, _) in members(model, &params, 3, "a member of a subfigure (308)")? {
                    usage[child].subfigure.get_or_insert(parent);
                }
                continue;
            }
            402 if matches!(entry.form, 1 | 7 | 14 | 15) => {
                let params = model.params(entry)?;
                for (child, _) in members(model, &params, 1, "a member of a group (402)")? {
                    usage[child].group.get_or_insert(parent);
                }
                continue;
            }
            _ => continue,
        };
        let params = model.params(entry)?;
        let child = model.index(params.integer(at, what)?, params.place_of(at), what)?;
        // The base of an offset surface may be a surface of its own.
        if entry.type_number != 140 || model.entries[child].status.physically_dependent() {
            usage[child].face.get_or_insert(parent);
        }
        if child == parent {
            let found = format!("entity {} itself", entry.number);
            return Err(Fail::new(params.place_of(at), what, found));
        }
    }
    no_cycles(model, &usage, |u| u.face, "surfaces that carry each other")?;
    no_cycles(model, &usage, |u| u.subfigure, "subfigures in one another")?;
    no_cycles(model, &usage, |u| u.group, "groups in one another")?;
    Ok(usage)
}

/// The entities in a list `count, pointer, pointer, ...` whose count is value `at`.
fn members(
    model: &Model,
    params: &super::params::Params,
    at: usize,
    what: &str,
) -> Result<Vec<(usize, usize)>, Fail> {
    let count = params.count(at, "a number of members")?;
    if count > params.len().saturating_sub(at + 1) {
        return Err(params.fail(params.len(), format!("{count} pointers: {what}")));
    }
    let mut list = Vec::with_capacity(count);
    for i in at + 1..=at + count {
        let pointer = params.integer(i, what)?;
        // A member that was deleted leaves a zero.
        if pointer != 0 {
            list.push((model.index(pointer, params.place_of(i), what)?, i));
        }
    }
    Ok(list)
}

/// Every chain of parents must end.
fn no_cycles(
    model: &Model,
    usage: &[Usage],
    parent: impl Fn(&Usage) -> Option<usize>,
    what: &str,
) -> Result<(), Fail> {
    // 0: not seen, 1: on the chain being followed, 2: known to end.
    let mut state = vec![0u8; usage.len()];
    for start in 0..usage.len() {
        let mut chain = Vec::new();
        let mut current = Some(start);
        while let Some(index) = current.filter(|&i| state[i] != 2) {
            if state[index] == 1 {
                let entry = &model.entries[index];
                let found = format!("{what}: entity {} leads back to itself", entry.number);
                return Err(Fail::new(
                    (entry.line, 1),
                    "pointers without a cycle",
                    found,
                ));
            }
            state[index] = 1;
            chain.push(index);
            current = parent(&usage[index]);
        }
        for index in chain {
            state[index] = 2;
        }
    }
    Ok(())
}

/// Reasons in status and membership not to read a surface.
fn refusal(entry: &Entry, used: &Usage, model: &Model) -> Option<String> {
    if let Some(parent) = used.subfigure {
        return Some(format!(
            "belongs to subfigure definition {} (308); instances of subfigures are not read",
            model.entries[parent].number
        ));
    }
    if entry.status.blanked {
        return Some("blanked (hidden) in the file".to_owned());
    }
    let purpose = match entry.status.purpose {
        1 => "annotation",
        2 => "part of a definition",
        4 => "a logical reference",
        5 => "in parameter space",
        6 => "construction geometry",
        _ => {
            // The faces of a shell, and all members of a group, belong to what is not a surface itself.
            let alone = used.group.is_none() && !matches!(entry.type_number, 143 | 144 | 510);
            return (alone && entry.status.physically_dependent()).then(|| {
                "physically dependent on an entity that is not read as a surface".to_owned()
            });
        }
    };
    Some(format!("marked as {purpose}, not as geometry"))
}

/// Matrices of the groups that an entity depends on physically. (A group that only refers to it does not move it.)
fn group_matrix(
    model: &Model,
    usage: &[Usage],
    index: usize,
    notes: &mut Vec<String>,
) -> Result<Affine, Fail> {
    let mut total = Affine::identity();
    let mut current = index;
    // `no_cycles` has made sure that this ends.
    while let Some(group) = usage[current].group {
        if !model.entries[current].status.physically_dependent() {
            break;
        }
        total = matrix_of(model, &model.entries[group], notes)?.after(&total);
        current = group;
    }
    Ok(total)
}

/// A 128 that stands alone.
fn free(
    model: &Model,
    entry: &Entry,
    outer: &Affine,
    name: &mut Option<String>,
    patches: &mut Vec<CadPatch>,
    notes: &mut Vec<String>,
) -> Result<Option<String>, Fail> {
    let map = outer.after(&matrix_of(model, entry, notes)?);
    let read = surface::read(model, entry, &map, notes)?;
    *name = name_of(model, entry, read.values)?;
    Ok(match read.patches {
        Ok(found) => {
            patches.extend(found.into_iter().map(|patch| CadPatch {
                patch,
                entity: entry.number,
                type_number: 128,
                name: name.clone(),
            }));
            None
        }
        Err(reason) => Some(reason),
    })
}

/// A 144: read if it has no boundary curves and lies on a 128.
fn untrimmed(
    model: &Model,
    entry: &Entry,
    outer: &Affine,
    name: &mut Option<String>,
    patches: &mut Vec<CadPatch>,
    notes: &mut Vec<String>,
) -> Result<Option<String>, Fail> {
    let params = model.params(entry)?;
    let what = "the surface of a trimmed surface (144)";
    let base = model.entry(params.integer(1, what)?, params.place_of(1), what)?;
    let flag = params.integer(2, "the flag N1 of the outer boundary")?;
    if !(0..=1).contains(&flag) {
        return Err(params.fail(2, "0 or 1 for the flag N1 of the outer boundary"));
    }
    let holes = params.count(3, "the number N2 of inner boundaries")?;
    if holes > params.len().saturating_sub(4) {
        return Err(params.fail(
            params.len(),
            format!("{holes} pointers to inner boundaries"),
        ));
    }
    // The pointer to the outer boundary is there even if N1 = 0, unless it ends the record.
    *name = match name_of(model, entry, 5 + holes)? {
        Some(name) => Some(name),
        None => own_name(base),
    };
    for (i, what) in (4..5 + holes).zip(std::iter::once("outer").chain(std::iter::repeat("inner")))
    {
        let pointer = if i < params.len() {
            params.integer(i, "a boundary curve")?
        } else {
            0
        };
        if pointer != 0 || what == "inner" || flag == 1 {
            model.index(
                pointer,
                params.place_of(i),
                &format!("the {what} boundary curve"),
            )?;
        }
    }
    if flag == 1 || holes > 0 {
        return Ok(Some(format!(
            "trimmed (N1 = {flag}, {holes} inner boundaries) on entity {} ({}); trimmed surfaces are not read",
            base.number,
            describe(base)
        )));
    }
    if base.type_number != 128 {
        return Ok(Some(format!(
            "lies on entity {} ({}), which is not read",
            base.number,
            describe(base)
        )));
    }
    let map = outer
        .after(&matrix_of(model, entry, notes)?)
        .after(&matrix_of(model, base, notes)?);
    let read = surface::read(model, base, &map, notes)?;
    if name.is_none() {
        *name = name_of(model, base, read.values)?;
    }
    Ok(match read.patches {
        Ok(found) => {
            patches.extend(found.into_iter().map(|patch| CadPatch {
                patch,
                entity: entry.number,
                type_number: 144,
                name: name.clone(),
            }));
            None
        }
        Err(reason) => Some(format!(
            "entity {} ({}): {reason}",
            base.number,
            describe(base)
        )),
    })
}

/// Why a surface of another type is not read.
fn unsupported(model: &Model, entry: &Entry) -> Result<String, Fail> {
    let at = match entry.type_number {
        143 => 2,
        140 => 5,
        510 => 1,
        other if is_solid(other) => {
            return Ok("solids given by primitives are not read".to_owned());
        }
        _ => return Ok("surfaces of this type are not read".to_owned()),
    };
    let params = model.params(entry)?;
    let base = model.entry(
        params.integer(at, "a surface")?,
        params.place_of(at),
        "a surface",
    )?;
    let (number, kind) = (base.number, describe(base));
    Ok(match entry.type_number {
        510 => {
            let loops = params.count(2, "the number of loops of a face (510)")?;
            format!(
                "face of a B-rep with {loops} loops on entity {number} ({kind}); trimmed faces are not read"
            )
        }
        143 => {
            format!("bounded surface on entity {number} ({kind}); trimmed surfaces are not read")
        }
        _ => format!("offset of entity {number} ({kind}); offset surfaces are not read"),
    })
}

fn describe(entry: &Entry) -> String {
    format!(
        "{} {}",
        entry.type_number,
        entity_name(entry.type_number, entry.form)
    )
}

fn own_name(entry: &Entry) -> Option<String> {
    (!entry.label.is_empty()).then(|| entry.label.clone())
}

/// Name of an entity: its property 406 form 15 if there is one, or else its label. After an entity's own `values`
/// values stand two lists of pointers, each with its length in front: associativities, then properties.
fn name_of(model: &Model, entry: &Entry, values: usize) -> Result<Option<String>, Fail> {
    let params = model.params(entry)?;
    if params.len() > values {
        let skip = params.count(values, "a number of associativity pointers")?;
        let at = values.saturating_add(skip).saturating_add(1);
        if params.len() > at {
            for (index, _) in members(model, &params, at, "a property")? {
                let property = &model.entries[index];
                if property.type_number == 406 && property.form == 15 {
                    let params = model.params(property)?;
                    if let Some(name) = params.string(2, "a name")? {
                        return Ok(Some(name.trim().to_owned()));
                    }
                }
            }
        }
    }
    Ok(own_name(entry))
}
