//! What decoding has found so far, over its rounds.
use super::Decoded;
use super::stop::Stop;
use crate::scene::json::{Fault, MORE, Node};
use crate::scene::problem::MOST_PROBLEMS;
use std::cell::RefCell;
use std::collections::{HashMap, HashSet};

/// What the decoding of a tree knows from the rounds before, and what this round found.
#[derive(Default)]
pub(super) struct State {
    /// Unknown keys, of this round.
    pub faults: RefCell<Vec<Fault>>,
    /// Starts of the objects that have some which are like no known key.
    pub odd: RefCell<HashSet<usize>>,
    /// Starts of the objects that have some which were read as the known key that they are like.
    pub misspelt: RefCell<HashSet<usize>>,
    /// Starts of the values that a placeholder stands for.
    pub replaced: HashSet<usize>,
    /// Keys that objects lack, by their starts: placeholders are read there.
    pub lacking: HashMap<usize, Vec<&'static str>>,
}

impl State {
    /// Puts a placeholder where decoding stopped; false where there is one already.
    pub fn replace(&mut self, stop: &Stop) -> bool {
        let Some(node) = stop.node else { return false };
        match stop.missing {
            Some(key) => {
                let keys = self.lacking.entry(node).or_default();
                let new = !keys.contains(&key);
                keys.push(key);
                new
            }
            None => self.replaced.insert(node),
        }
    }

    /// Puts a placeholder around the value that starts at `inner`; false where there is nothing around it.
    pub fn replace_around(&mut self, root: &Node, inner: Option<usize>) -> bool {
        let Some(inner) = inner else { return false };
        let mut around = vec![root.span.start];
        let mut node = root;
        while let Some(child) = node.child_at(inner) {
            around.push(child.span.start);
            node = child;
        }
        // The root itself has to be read.
        let outer = around.iter().skip(1).rev().filter(|start| **start != inner);
        let free = outer.copied().find(|start| !self.replaced.contains(start));
        free.is_some_and(|start| self.replaced.insert(start))
    }

    pub fn finish<T>(self, stops: Vec<Fault>, value: Option<T>) -> Decoded<T> {
        let mut incomplete = self.odd.into_inner();
        // Nothing depends on the version.
        let lacks = |keys: &[&str]| keys.iter().any(|k| !k.starts_with("covact"));
        let lacking = self.lacking.iter().filter(|(_, keys)| lacks(keys));
        incomplete.extend(lacking.map(|(start, _)| *start));
        let mut faults = self.faults.into_inner();
        // The end of the list is said once.
        faults.extend(stops.into_iter().filter(|f| f.message != MORE));
        if faults.len() > MOST_PROBLEMS {
            faults.sort_by_key(|f| f.span.start);
            faults.truncate(MOST_PROBLEMS);
            let span = faults.last().map_or(0..0, |f| f.span.clone());
            faults.push(Fault {
                message: MORE.to_owned(),
                help: None,
                span,
            });
        }
        Decoded {
            value,
            faults,
            replaced: self.replaced,
            incomplete,
            misspelt: self.misspelt.into_inner(),
        }
    }
}
