//! Where every item of every representation stands: from the roots of the assemblies down.

use super::assembly::Assembly;
use super::exchange::Exchange;
use super::hidden::Hidden;
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
    /// The INVISIBILITY that hides this copy.
    pub hidden_by: Option<u32>,
}

impl Assembly {
    /// Every item of every representation where it stands, from the roots down.
    pub fn copies(
        &self,
        exchange: &Exchange,
        hidden: &Hidden,
        notes: &mut Vec<String>,
    ) -> Vec<Copy> {
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
            hidden,
            children,
            members,
            left: FREE + COPIES * exchange.len(),
            chain: Vec::new(),
            instances: Vec::new(),
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
            walk.group(root, Placement::identity(), None, &mut Vec::new(), None);
        }
        // Only those are left that hang in a circle.
        for &root in &roots {
            if placed.contains(&root) && !walk.visited.contains(&root) {
                let name = self.names[root].as_deref().unwrap_or_default();
                walk.faults.push(format!(
                    "the product \"{name}\" is part of itself; it is read once, where it is defined"
                ));
                walk.group(root, Placement::identity(), None, &mut Vec::new(), None);
            }
        }
        notes.append(&mut walk.faults);
        walk.out
    }
}

struct Walk<'w> {
    assembly: &'w Assembly,
    hidden: &'w Hidden,
    children: HashMap<usize, Vec<usize>>,
    members: HashMap<usize, Vec<usize>>,
    left: usize,
    chain: Vec<usize>,
    /// Occurrences and mapped items on the way down.
    instances: Vec<u32>,
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
        hidden_by: Option<u32>,
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
        let hidden_by = hidden_by.or_else(|| self.hides(group));
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
                    hidden_by: hidden_by
                        .or_else(|| self.hidden.item(item))
                        .or_else(|| self.hidden.within(&self.instances, item)),
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
            self.instances.push(link.instance);
            let by = hidden_by
                .or_else(|| self.hidden.item(link.instance))
                .or_else(|| self.hidden.within(&self.instances, link.instance));
            self.group(link.child, map.after(&link.map), outermost, path, by);
            self.instances.pop();
            path.truncate(depth);
        }
        if named.is_some() {
            path.pop();
        }
        self.chain.pop();
    }

    /// What hides all of a product: one of its representations is hidden, or what stands for the whole in it.
    fn hides(&self, group: usize) -> Option<u32> {
        let members = self.members.get(&group).into_iter().flatten();
        let mut own = members.map(|&k| &self.assembly.representations[k]);
        own.find_map(|representation| {
            let index = representation.index;
            let whole = self.hidden.item(index);
            let here = || self.hidden.within(&self.instances, index);
            let frames = || {
                let items = representation.items.iter();
                let placed = |item| self.assembly.links.iter().any(|l| l.instance == item);
                let frames = items.filter(|item| !representation.bodies.contains(item));
                let mut by = frames.filter_map(|&item| {
                    let by = self.hidden.within(&self.instances, item)?;
                    (!placed(item)).then_some(by)
                });
                by.next()
            };
            whole.or_else(here).or_else(frames)
        })
    }
}
