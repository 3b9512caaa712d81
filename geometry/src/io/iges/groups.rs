//! Who uses an entity, and where its copies stand: faces over their surfaces, shells and solids, groups, subfigures and
//! their instances.

use super::super::error::Fail;
use super::super::report::SkipKind;
use super::Model;
use super::directory::Entry;
use super::faces::is_face;
use super::params::Params;
use super::transform::{Affine, matrix_of};
use crate::Vec3;
use nalgebra::Matrix3;
use std::collections::BTreeMap;

/// Who uses an entity, by index in the directory.
#[derive(Default, Clone)]
pub struct Usage {
    /// The face (143, 144, 510) or offset surface (140) that it carries; that entity is reported in its place.
    pub face: Option<usize>,
    /// What it is a member of: a group (402), a subfigure definition (308), a shell (514), a solid (186).
    pub parent: Option<usize>,
    /// Whether its parent, a shell (514) or a solid (186), says that it uses it with the opposite normal.
    turned: bool,
}

/// One copy of an entity in model space.
#[derive(Debug, Clone, Copy)]
pub struct Placement {
    /// Maps the space of the entity (before its own matrix) to model space, in the units of the parameter data.
    pub map: Affine,
    /// Number of the outermost instance (408, 430) that places it, 0 for none.
    pub instance: u32,
    /// Number of a hidden entity that holds it, 0 for none.
    pub hidden_in: u32,
    /// Whether the shells and solids that hold it use it with the opposite normal.
    pub turned: bool,
}

/// Groups, subfigures and solids may be nested, but nobody does so this deep.
const DEPTH: usize = 64;

/// Steps up to what holds an entity, for each entity of the file: instances of instances could multiply without end.
const STEPS: usize = 64;

/// Uses and instances of all entities.
pub struct Groups {
    pub usage: Vec<Usage>,
    /// Instances (408, 430) of a subfigure definition or solid, by its index: their own indices and maps.
    instances: BTreeMap<usize, Vec<(usize, Affine)>>,
    /// Steps that may still be taken.
    budget: usize,
}

impl Groups {
    /// Reads the pointers of faces, shells, solids, subfigures and groups.
    pub fn read(model: &Model, notes: &mut Vec<String>) -> Result<Self, Fail> {
        let mut groups = Self {
            usage: vec![Usage::default(); model.entries.len()],
            instances: BTreeMap::new(),
            budget: STEPS * model.entries.len() + 4096,
        };
        for (index, entry) in model.entries.iter().enumerate() {
            groups.uses_of(model, index, entry, notes)?;
        }
        no_cycles(
            model,
            &groups.usage,
            |u| u.face,
            "surfaces that carry each other",
        )?;
        no_cycles(model, &groups.usage, |u| u.parent, "groups in one another")?;
        Ok(groups)
    }

    fn uses_of(
        &mut self,
        model: &Model,
        parent: usize,
        entry: &Entry,
        notes: &mut Vec<String>,
    ) -> Result<(), Fail> {
        let params = || model.params(entry);
        let same = |list: Vec<usize>| list.into_iter().map(|child| (child, true)).collect();
        let list: Vec<(usize, bool)> = match entry.type_number {
            308 => same(members(
                model,
                &params()?,
                3,
                "a member of a subfigure (308)",
            )?),
            402 if matches!(entry.form, 1 | 7 | 14 | 15) => {
                same(members(model, &params()?, 1, "a member of a group (402)")?)
            }
            514 => pairs(model, &params()?, 1, "a face of a shell (514)")?,
            186 => solid(model, &params()?)?,
            408 => {
                let params = params()?;
                let what = "the definition (308) of a subfigure instance (408)";
                let target = pointer(model, &params, 1, what)?;
                let shift = params.reals(2, 3, "the place of a subfigure instance (408)")?;
                let scale = match params.is_default(5) {
                    true => 1.0,
                    false => params.real(5, "the scale of a subfigure instance (408)")?,
                };
                if !(scale > 0.0 && scale.is_finite()) {
                    return Err(params.fail(5, "a positive scale"));
                }
                let own = Affine {
                    linear: Matrix3::identity() * scale,
                    shift: Vec3::new(shift[0], shift[1], shift[2]),
                };
                let map = matrix_of(model, entry, notes)?.after(&own);
                self.instances
                    .entry(target)
                    .or_default()
                    .push((parent, map));
                return Ok(());
            }
            430 => {
                let target = pointer(model, &params()?, 1, "the solid of a solid instance (430)")?;
                let map = matrix_of(model, entry, notes)?;
                self.instances
                    .entry(target)
                    .or_default()
                    .push((parent, map));
                return Ok(());
            }
            _ => {
                let Some((at, what)) = carrier(entry.type_number) else {
                    return Ok(());
                };
                let params = params()?;
                let child = pointer(model, &params, at, what)?;
                // The base of an offset surface may be a surface of its own.
                if entry.type_number != 140 || model.entries[child].status.physically_dependent() {
                    self.usage[child].face.get_or_insert(parent);
                }
                if child == parent {
                    let found = format!("entity {} itself", entry.number);
                    return Err(Fail::new(params.place_of(at), what, found));
                }
                return Ok(());
            }
        };
        for (child, agrees) in list {
            let usage = &mut self.usage[child];
            if usage.parent.is_none() {
                usage.parent = Some(parent);
                usage.turned = !agrees;
            }
        }
        Ok(())
    }

    /// Whether an entity is a member of something.
    pub fn is_member(&self, index: usize) -> bool {
        self.usage[index].parent.is_some()
    }

    /// The subfigure definition (308) that an entity belongs to at any depth.
    pub fn template(&self, model: &Model, index: usize) -> Option<u32> {
        // `no_cycles` has made sure that this ends.
        std::iter::successors(self.usage[index].parent, |&i| self.usage[i].parent)
            .find(|&i| model.entries[i].type_number == 308)
            .map(|i| model.entries[i].number)
    }

    /// Where the copies of an entity stand.
    pub fn placements(
        &mut self,
        model: &Model,
        index: usize,
        notes: &mut Vec<String>,
    ) -> Result<Vec<Placement>, Fail> {
        let mut out = Vec::new();
        let mut chain = Vec::new();
        let start = Placement {
            map: Affine::identity(),
            instance: 0,
            hidden_in: 0,
            turned: false,
        };
        self.place(model, index, start, &mut chain, &mut out, notes)?;
        Ok(out)
    }

    /// Goes from an entity up through all that holds or places it.
    fn place(
        &mut self,
        model: &Model,
        index: usize,
        mut copy: Placement,
        chain: &mut Vec<usize>,
        out: &mut Vec<Placement>,
        notes: &mut Vec<String>,
    ) -> Result<(), Fail> {
        let entry = &model.entries[index];
        if chain.len() > DEPTH || chain.contains(&index) {
            let found = format!("entity {} at depth {}", entry.number, chain.len());
            let expected = format!("instances nested at most {DEPTH} deep and not in themselves");
            return Err(Fail::new((entry.line, 1), expected, found));
        }
        self.budget = self.budget.checked_sub(1).ok_or_else(|| {
            let found = format!("more at entity {}", entry.number);
            let expected = "fewer copies of surfaces than 64 for each entity";
            Fail::new((entry.line, 1), expected, found)
        })?;
        chain.push(index);
        if let Some(instances) = self.instances.get(&index).cloned() {
            for (instance, map) in instances {
                let placed = &model.entries[instance];
                let copy = Placement {
                    map: map.after(&copy.map),
                    instance: placed.number,
                    hidden_in: hidden(placed, copy.hidden_in),
                    turned: copy.turned,
                };
                self.place(model, instance, copy, chain, out, notes)?;
            }
        }
        if let Some(parent) = self.usage[index].parent {
            let holder = &model.entries[parent];
            copy.turned ^= self.usage[index].turned;
            // A group that only refers to an entity neither moves nor hides it.
            if holder.type_number != 402 || entry.status.physically_dependent() {
                if holder.type_number != 308 {
                    copy.hidden_in = hidden(holder, copy.hidden_in);
                }
                copy.map = matrix_of(model, holder, notes)?.after(&copy.map);
            }
            self.place(model, parent, copy, chain, out, notes)?;
        } else if entry.type_number != 308 {
            // A solid that instances place does not stand by itself if its status says so.
            let only_placed = self.instances.contains_key(&index)
                && (entry.status.subordinate != 0 || entry.status.purpose == 2);
            if !only_placed {
                out.push(copy);
            }
        }
        chain.pop();
        Ok(())
    }
}

fn hidden(holder: &Entry, before: u32) -> u32 {
    match holder.status.blanked && before == 0 {
        true => holder.number,
        false => before,
    }
}

/// Where an entity that lies on a surface says which one.
pub fn carrier(type_number: u32) -> Option<(usize, &'static str)> {
    match type_number {
        144 => Some((1, "the surface of a trimmed surface (144)")),
        510 => Some((1, "the surface of a face (510)")),
        143 => Some((2, "the surface of a bounded surface (143)")),
        140 => Some((5, "the surface of an offset surface (140)")),
        _ => None,
    }
}

/// The entity that value `i` points to.
pub fn pointer(model: &Model, params: &Params, i: usize, what: &str) -> Result<usize, Fail> {
    model.index(params.integer(i, what)?, params.place_of(i), what)
}

/// The entities in a list `count, pointer, pointer, ...` whose count is value `at`.
pub fn members(model: &Model, params: &Params, at: usize, what: &str) -> Result<Vec<usize>, Fail> {
    let count = params.count(at, "a number of members")?;
    if count > params.len().saturating_sub(at + 1) {
        return Err(params.fail(params.len(), format!("{count} pointers: {what}")));
    }
    let mut list = Vec::with_capacity(count);
    for i in at + 1..=at + count {
        let pointer = params.integer(i, what)?;
        // A member that was deleted leaves a zero.
        if pointer != 0 {
            list.push(model.index(pointer, params.place_of(i), what)?);
        }
    }
    Ok(list)
}

/// The entities in a list `count, pointer, flag, pointer, flag, ...` whose count is value `at`, each with whether its
/// normal is used as it is.
fn pairs(
    model: &Model,
    params: &Params,
    at: usize,
    what: &str,
) -> Result<Vec<(usize, bool)>, Fail> {
    let count = params.count(at, "a number of members")?;
    if count > params.len().saturating_sub(at + 1).div_ceil(2) {
        return Err(params.fail(params.len(), format!("{count} pointers with flags: {what}")));
    }
    (0..count)
        .map(|k| oriented(model, params, at + 1 + 2 * k, what))
        .collect()
}

/// The entity that value `i` points to, and whether the orientation flag that follows (true by default) says that it is used
/// with its own normal.
fn oriented(model: &Model, params: &Params, i: usize, what: &str) -> Result<(usize, bool), Fail> {
    let target = pointer(model, params, i, what)?;
    let agrees = params.is_default(i + 1)
        || params.integer(i + 1, "the orientation flag that follows a pointer")? != 0;
    Ok((target, agrees))
}

/// A 186: the outer shell with its flag, then the voids.
fn solid(model: &Model, params: &Params) -> Result<Vec<(usize, bool)>, Fail> {
    let what = "a shell of a solid (186)";
    let mut list = vec![oriented(model, params, 1, what)?];
    if params.len() > 3 {
        list.extend(pairs(model, params, 3, what)?);
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
pub fn refusal(
    model: &Model,
    groups: &Groups,
    index: usize,
    placed: &[Placement],
) -> Option<(SkipKind, String)> {
    let entry = &model.entries[index];
    if entry.status.blanked && !model.hidden {
        let reason = "blanked (hidden) in the file".to_owned();
        return Some((SkipKind::Blanked, reason));
    }
    let purpose = match entry.status.purpose {
        1 => Some("annotation"),
        2 if groups.template(model, index).is_none() => Some("part of a definition"),
        4 => Some("a logical reference"),
        5 => Some("in parameter space"),
        6 => Some("construction geometry"),
        _ => None,
    };
    if let Some(purpose) = purpose {
        let reason = format!("marked as {purpose}, not as geometry");
        return Some((SkipKind::Purpose, reason));
    }
    // The faces of a shell, and all members of a group, belong to what is not a surface itself.
    let alone = !groups.is_member(index) && !is_face(entry.type_number);
    if alone && entry.status.physically_dependent() {
        let reason = "physically dependent on an entity that is not read as a surface".to_owned();
        return Some((SkipKind::Dependent, reason));
    }
    if placed.is_empty() {
        let reason = match groups.template(model, index) {
            Some(number) => format!(
                "belongs to subfigure definition {number} (308), which no instance (408) places"
            ),
            None => "belongs to a solid that no instance (430) places".to_owned(),
        };
        return Some((SkipKind::Template, reason));
    }
    if let Some(copy) = placed.iter().find(|p| p.hidden_in != 0)
        && !model.hidden
        && placed.iter().all(|p| p.hidden_in != 0)
    {
        let reason = format!(
            "belongs to entity {}, which is blanked (hidden)",
            copy.hidden_in
        );
        return Some((SkipKind::Blanked, reason));
    }
    None
}
