//! Where every item of every representation stands: from the roots of the assemblies down.

use super::assembly::Assembly;
use super::exchange::Exchange;
use super::place::Placement;
use std::collections::{HashMap, HashSet};
use std::rc::Rc;

/// Assemblies may be nested, but nobody does so this deep.
const DEPTH: usize = 64;
/// Copies of items for each instance of the file: occurrences of occurrences could multiply without end.
const COPIES: usize = 16;
/// Copies in any file.
const FREE: usize = 1024;

/// One item where it stands.
#[derive(Debug, Clone)]
pub struct Copy {
    pub item: u32,
    /// Index of the representation that holds it.
    pub representation: usize,
    /// From the item's own coordinates to those of the file.
    pub map: Placement,
    /// The outermost occurrence or mapped item that places it.
    pub instance: Option<u32>,
    /// Names of the products from the root down to the one that the item belongs to.
    pub path: Rc<Vec<Rc<str>>>,
}

impl Assembly {
    /// Every item of every representation where it stands, from the roots down.
    pub fn copies(&self, exchange: &Exchange, notes: &mut Vec<String>) -> Vec<Copy> {
        let mut children: HashMap<usize, Vec<usize>> = HashMap::new();
        let mut placed = HashSet::new();
        for (k, link) in self.links.iter().enumerate() {
            children.entry(link.parent).or_default().push(k);
            placed.insert(link.child);
        }
        let mut members: HashMap<usize, Vec<usize>> = HashMap::new();
        for (k, &group) in self.group.iter().enumerate() {
            members.entry(group).or_default().push(k);
        }
        let mut walk = Walk {
            assembly: self,
            children,
            members,
            left: FREE + COPIES * exchange.len(),
            chain: Vec::new(),
            visited: HashSet::new(),
            out: Vec::new(),
            faults: Vec::new(),
        };
        let roots = (0..self.group.len()).filter(|&k| self.group[k] == k);
        let roots: Vec<usize> = roots.collect();
        // Representations of no product that list items of one, for properties, are no copies of them.
        let part = |k: usize| self.names[k].is_some() || placed.contains(&k);
        let of_parts: HashSet<u32> = (roots.iter().filter(|&&r| part(r)))
            .flat_map(|r| &walk.members[r])
            .flat_map(|&k| &self.representations[k].bodies)
            .copied()
            .collect();
        let repeated = |root: usize| {
            let members = walk.members[&root].iter();
            let mut bodies = members.flat_map(|&k| &self.representations[k].bodies);
            !part(root)
                && !walk.children.contains_key(&root)
                && bodies.all(|item| of_parts.contains(item))
        };
        let tops: Vec<usize> = (roots.iter().copied())
            .filter(|&r| !placed.contains(&r) && !repeated(r))
            .collect();
        for root in tops {
            walk.group(root, Placement::identity(), None, &mut Vec::new());
        }
        // Only those are left that hang in a circle.
        for &root in &roots {
            if placed.contains(&root) && !walk.visited.contains(&root) {
                let name = self.names[root].as_deref().unwrap_or_default();
                walk.faults.push(format!(
                    "the product \"{name}\" is part of itself; it is read once, where it is defined"
                ));
                walk.group(root, Placement::identity(), None, &mut Vec::new());
            }
        }
        notes.append(&mut walk.faults);
        walk.out
    }
}

struct Walk<'w> {
    assembly: &'w Assembly,
    children: HashMap<usize, Vec<usize>>,
    members: HashMap<usize, Vec<usize>>,
    left: usize,
    chain: Vec<usize>,
    visited: HashSet<usize>,
    out: Vec<Copy>,
    faults: Vec<String>,
}

impl Walk<'_> {
    fn group(
        &mut self,
        group: usize,
        map: Placement,
        instance: Option<u32>,
        path: &mut Vec<Rc<str>>,
    ) {
        if self.chain.contains(&group) || self.chain.len() >= DEPTH {
            let text = "an assembly is part of itself or nested too deep; that copy is left out";
            if self.faults.last().is_none_or(|last| last != text) {
                self.faults.push(text.to_owned());
            }
            return;
        }
        self.visited.insert(group);
        self.chain.push(group);
        let named = self.assembly.names[group].clone();
        path.extend(named.clone());
        let shared = Rc::new(path.clone());
        for &number in self.members.get(&group).into_iter().flatten() {
            let representation = &self.assembly.representations[number];
            let own = map.after(&Placement::scaling(self.assembly.factor(number)));
            for &item in &representation.bodies {
                let Some(left) = self.left.checked_sub(1) else {
                    break;
                };
                self.left = left;
                self.out.push(Copy {
                    item,
                    representation: number,
                    map: own,
                    instance,
                    path: Rc::clone(&shared),
                });
            }
        }
        let links = self.children.get(&group).cloned().unwrap_or_default();
        for k in links {
            let link = &self.assembly.links[k];
            let Some(left) = self.left.checked_sub(1) else {
                let text =
                    format!("more than {COPIES} copies for each instance; the rest is left out");
                if !self.faults.contains(&text) {
                    self.faults.push(text);
                }
                break;
            };
            self.left = left;
            let outermost = instance.or(Some(link.instance));
            let depth = path.len();
            self.group(link.child, map.after(&link.map), outermost, path);
            path.truncate(depth);
        }
        if named.is_some() {
            path.pop();
        }
        self.chain.pop();
    }
}
