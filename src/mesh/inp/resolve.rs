//! Sets from what is written: numbers, ranges, and other sets wherever they are defined.
use super::scope::{Entry, Reference, Set, Sets};
use crate::mesh::MeshError;
use crate::mesh::error::{most_members, shorten};
use crate::mesh::raw::NONE;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// Members by the names of the sets in capitals.
pub(super) type Members = BTreeMap<String, Vec<u32>>;

/// Counts members of sets and numbers looked at to find them: short files must not grow without bound by sets of sets.
pub(super) struct Budget {
    path: PathBuf,
    members: u64,
    most: u64,
}

impl Budget {
    pub fn new(path: &Path, nodes: usize, elements: usize) -> Budget {
        Budget {
            path: path.to_path_buf(),
            members: 0,
            most: most_members(nodes, elements),
        }
    }

    pub fn spend(&mut self, members: usize) -> Result<(), MeshError> {
        self.members += members as u64;
        match self.members > self.most {
            true => Err(MeshError::LongSets {
                path: self.path.clone(),
                most: self.most,
            }),
            false => Ok(()),
        }
    }
}

/// What numbers and names mean where the sets are.
pub(super) trait Meaning {
    /// `node` or `element`.
    const KIND: &'static str;
    /// Index of a number, of an instance where one is named.
    fn number(&self, instance: Option<&str>, number: u64) -> Option<u32>;
    /// Members of a set of another scope.
    fn named(&self, instance: Option<&str>, name: &str) -> Option<&[u32]>;
    /// Numbers may be missing because elements were passed over.
    fn lenient(&self) -> bool;
    /// Number of things, and an upper bound of how many there may be in a range.
    fn count(&self) -> usize;
    /// All numbers from `first` to `last`, sorted, where counting through them takes too long.
    fn within(&self, instance: Option<&str>, first: u64, last: u64) -> Vec<u64>;
}

/// Members of all sets; `notes` gets what is missing in ranges.
pub(super) fn resolve<M: Meaning>(
    path: &Path,
    sets: &Sets,
    meaning: &M,
    budget: &mut Budget,
    notes: &mut Vec<String>,
) -> Result<Members, MeshError> {
    let names: Vec<&String> = sets.by_name.keys().collect();
    let place = |name: &str| {
        let name = name.to_uppercase();
        names
            .binary_search_by(|known| known.as_str().cmp(&name))
            .ok()
    };
    let mut done: Vec<Option<Vec<u32>>> = names.iter().map(|_| None).collect();
    let mut open = vec![false; names.len()];
    for first in 0..names.len() {
        let mut stack = vec![first];
        while let Some(&at) = stack.last() {
            if done[at].is_some() {
                stack.pop();
                continue;
            }
            let (spelling, set) = &sets.by_name[names[at]];
            let before = stack.len();
            open[at] = true;
            for entry in &set.entries {
                let Some(other) = entry.name().and_then(place) else {
                    continue;
                };
                if open[other] && done[other].is_none() {
                    let expected = "sets that do not hold themselves";
                    let found = shorten(entry.name().unwrap_or_default());
                    return Err(entry.at().syntax_found(path, expected, &found));
                }
                if done[other].is_none() {
                    stack.push(other);
                }
            }
            if stack.len() > before {
                continue;
            }
            let mut missing = 0usize;
            let mut found = Vec::new();
            for entry in &set.entries {
                let known = (entry.instance == NONE)
                    .then(|| entry.name().and_then(place))
                    .flatten();
                match known.and_then(|other| done[other].as_ref()) {
                    Some(other) => found.extend(other),
                    None => {
                        let found = &mut found;
                        let more = entry_members(path, set, entry, meaning, &names, budget, found)?;
                        missing = missing.saturating_add(more);
                    }
                }
                budget.spend(1)?;
            }
            budget.spend(found.len())?;
            if missing > 0 {
                notes.push(format!(
                    "set `{}`: {missing} number(s) within its ranges are no {}s",
                    shorten(spelling),
                    M::KIND
                ));
            }
            if M::KIND == "element" {
                found.sort_unstable();
                found.dedup();
            }
            done[at] = Some(found);
            stack.pop();
        }
    }
    let members = done.into_iter().map(Option::unwrap_or_default);
    Ok(names.into_iter().cloned().zip(members).collect())
}

/// Adds the members that an entry names; returns how many numbers of its range there are not.
fn entry_members<M: Meaning>(
    path: &Path,
    set: &Set,
    entry: &Entry,
    meaning: &M,
    names: &[&String],
    budget: &mut Budget,
    found: &mut Vec<u32>,
) -> Result<usize, MeshError> {
    let instance = set
        .instances
        .get(entry.instance as usize)
        .map(String::as_str);
    match &entry.what {
        Reference::Number(number) => match meaning.number(instance, *number) {
            Some(index) => found.push(index),
            None if meaning.lenient() => {}
            None => {
                return Err(unknown::<M>(
                    path,
                    entry,
                    &format!("{} {number}", M::KIND),
                    None,
                ));
            }
        },
        Reference::Name(name) => match meaning.named(instance, name) {
            Some(other) => found.extend(other),
            None => {
                let upper = name.to_uppercase();
                let near = names
                    .iter()
                    .map(|known| (strsim::jaro_winkler(known, &upper), known))
                    .filter(|(likeness, _)| *likeness > 0.75)
                    .max_by(|a, b| a.0.total_cmp(&b.0));
                let near = near.map(|(_, known)| known.as_str());
                return Err(unknown::<M>(path, entry, &shorten(name), near));
            }
        },
        Reference::Range(range) => {
            let [first, last, step] = **range;
            let most = meaning.count() as u64;
            if step == 0 || last < first {
                let expected = "first <= last and a step of at least 1";
                let found = format!("{first}, {last}, {step}");
                return Err(entry.at().syntax_found(path, expected, &found));
            }
            let count = (last - first) / step;
            // Looking a number up costs less than keeping it.
            budget.spend((count.min(most) / 8) as usize)?;
            let before = found.len();
            if count > most {
                let all = meaning.within(instance, first, last).into_iter();
                let within = all.filter(|number| (number - first) % step == 0);
                found.extend(within.filter_map(|number| meaning.number(instance, number)));
            } else {
                let all = (0..=count).map(|k| first + k * step);
                found.extend(all.filter_map(|number| meaning.number(instance, number)));
            }
            let new = found.len() - before;
            if new == 0 && !meaning.lenient() {
                let numbers = format!("{} {first} to {last}", M::KIND);
                return Err(unknown::<M>(path, entry, &numbers, None));
            }
            if !meaning.lenient() {
                return Ok((count as usize).saturating_add(1) - new);
            }
        }
    }
    Ok(0)
}

/// An entry names nothing that there is.
pub(super) fn unknown<M: Meaning>(
    path: &Path,
    entry: &Entry,
    found: &str,
    near: Option<&str>,
) -> MeshError {
    let mut expected = format!("the number or set of {}s of this file", M::KIND);
    if let Some(near) = near {
        expected += &format!(" (did you mean `{}`?)", shorten(near));
    }
    entry.at().syntax_found(path, &expected, found)
}

impl Entry {
    /// The number or name, for messages.
    pub fn text(&self) -> String {
        match &self.what {
            Reference::Name(name) => shorten(name),
            Reference::Number(number) => format!("element {number}"),
            Reference::Range(range) => format!("{range:?}"),
        }
    }

    /// The set that the entry names.
    pub fn name(&self) -> Option<&str> {
        match &self.what {
            Reference::Name(name) => Some(name),
            _ => None,
        }
    }
}
