//! From scopes and their instances to one mesh with all its sets.
use super::Reader;
use super::assembly::Instance;
use super::names::{Elements, Names, Nodes, Placed};
use super::resolve::{Budget, Members, resolve, unknown};
use super::scope::{Element, Scope, Side};
use super::types::Shape;
use crate::mesh::quadratic::{PLACES, tensor_27};
use crate::mesh::raw::{NONE, RawMesh};
use crate::mesh::{Face, MeshError};

/// Nodes are numbered around the faces; tensor node `a` is file node `TENSOR[a]`.
const TENSOR: [usize; 8] = [0, 1, 3, 2, 4, 5, 7, 6];

/// An element of the mesh.
#[derive(Clone, Copy)]
enum Item {
    Solid(u32),
    Facet(u32),
    /// Index into the lines.
    Line(u32),
    /// A solid beside solids of another order.
    Nothing,
}

pub(super) struct Builder<'r> {
    reader: &'r Reader<'r>,
    raw: RawMesh,
    /// What every element became, scope by scope.
    items: Vec<Item>,
    lines: Vec<[u32; 2]>,
    placed: Vec<Placed>,
    budget: Budget,
}

impl<'r> Builder<'r> {
    pub fn new(reader: &'r Reader, raw: RawMesh, nodes: usize, elements: usize) -> Builder<'r> {
        Builder {
            reader,
            raw,
            items: Vec::new(),
            lines: Vec::new(),
            placed: Vec::new(),
            budget: Budget::new(reader.path, nodes, elements),
        }
    }

    pub fn all(mut self) -> Result<RawMesh, MeshError> {
        let reader = self.reader;
        let flat = &reader.scopes[0];
        self.add(flat, None)?;
        let single = reader.instances.len() == 1;
        for instance in &reader.instances {
            let scope = &reader.scopes[instance.scope];
            let first = [self.raw.nodes.len() as u32, self.items.len() as u32];
            self.add(scope, Some(instance))?;
            let mut sets = self.resolve(scope, &[])?;
            for (members, first) in sets.iter_mut().zip(first) {
                members.values_mut().flatten().for_each(|m| *m += first);
            }
            let name = |set: &str| match single {
                true => set.to_string(),
                false => format!("{}.{set}", instance.name),
            };
            self.take_sets(scope, &sets, &name);
            let placed = Placed::new(&instance.name, scope, first, sets);
            self.surfaces(scope, &[], &placed, &name)?;
            let all: Vec<u32> = (first[1]..self.items.len() as u32).collect();
            self.take_elements(&instance.name, &all);
            self.placed.push(placed);
        }
        let placed = std::mem::take(&mut self.placed);
        let sets = self.resolve(flat, &placed)?;
        let name = |set: &str| set.to_string();
        self.take_sets(flat, &sets, &name);
        let own = Placed::new("", flat, [0, 0], sets);
        self.surfaces(flat, &placed, &own, &name)?;
        let uninstanced = (1..reader.scopes.len())
            .filter(|k| !reader.instances.iter().any(|i| i.scope == *k))
            .filter(|k| !reader.scopes[*k].is_empty());
        for k in uninstanced {
            let part = &reader.scopes[k].name;
            (self.raw.notes).push(format!("part `{part}` has no instance and was left out"));
        }
        Ok(self.raw)
    }

    /// Nodes and elements of a scope.
    fn add(&mut self, scope: &Scope, instance: Option<&Instance>) -> Result<(), MeshError> {
        let first = self.raw.nodes.len() as u32;
        let place = |x| instance.map_or(x, |i| i.place(x));
        (self.raw.nodes).extend(scope.nodes.iter().map(|&x| place(x)));
        self.raw.node_tags.extend(&scope.node_tags);
        for element in &scope.elements {
            let nodes: Vec<u32> = scope.nodes_of(element).iter().map(|n| n + first).collect();
            let item = match element.shape {
                Shape::Solid {
                    nodes: count,
                    given,
                } => self.solid(element, &nodes, count, given)?,
                Shape::Facet(_) => Item::Facet(self.raw.facets.push(&nodes, element.tag)),
                _ => {
                    // The middle node of three stands second.
                    self.lines.push([nodes[0], nodes[nodes.len() - 1]]);
                    Item::Line(self.lines.len() as u32 - 1)
                }
            };
            self.items.push(item);
        }
        Ok(())
    }

    fn solid(
        &mut self,
        element: &Element,
        nodes: &[u32],
        count: usize,
        given: bool,
    ) -> Result<Item, MeshError> {
        let raw = &mut self.raw;
        let quadratic = count > 8;
        if raw.quadratic.len() != raw.hexahedra.len() * usize::from(quadratic) {
            let expected =
                "elements of 8 nodes or of 20 and 27, not both (`only` takes those of one set)";
            let refused = element.at().syntax_found(
                self.reader.path,
                expected,
                &format!("element {} of {count}", element.tag),
            );
            raw.refused.get_or_insert(refused);
            return Ok(Item::Nothing);
        }
        if quadratic {
            let tensor = match <&[u32; 27]>::try_from(nodes) {
                Ok(all) => tensor_27(all, &raw.nodes),
                Err(_) => {
                    let mut tensor = [NONE; 27];
                    PLACES.iter().zip(nodes).for_each(|(&p, &n)| tensor[p] = n);
                    Some(tensor)
                }
            };
            let Some(tensor) = tensor else {
                let tag = element.tag;
                let expected =
                    format!("the nodes of element {tag} within its faces and its middle");
                return Err(element
                    .at()
                    .syntax_found(self.reader.path, &expected, "others"));
            };
            raw.quadratic.push(tensor);
        }
        raw.hexahedra.push(TENSOR.map(|a| nodes[a]));
        raw.element_tags.push(element.tag);
        raw.thickness_is_given.push(given);
        Ok(Item::Solid(raw.hexahedra.len() as u32 - 1))
    }

    /// Node sets and element sets of a scope by their names in capitals; `others` are the instances it can name.
    fn resolve(&mut self, scope: &Scope, others: &[Placed]) -> Result<[Members; 2], MeshError> {
        let path = self.reader.path;
        let names = |nodes: bool| Names {
            index: match nodes {
                true => &scope.node_index,
                false => &scope.element_index,
            },
            lenient: !nodes && !self.reader.types.is_empty(),
            others,
            nodes,
        };
        let (nodes, elements) = (Nodes(names(true)), Elements(names(false)));
        let (budget, notes) = (&mut self.budget, &mut self.raw.notes);
        Ok([
            resolve(path, &scope.node_sets, &nodes, budget, notes)?,
            resolve(path, &scope.element_sets, &elements, budget, notes)?,
        ])
    }

    /// Sets under the names they have in the mesh.
    fn take_sets(&mut self, scope: &Scope, sets: &[Members; 2], name: &dyn Fn(&str) -> String) {
        for (upper, members) in &sets[0] {
            let spelling = &scope.node_sets.by_name[upper].0;
            let set = self.raw.node_sets.entry(name(spelling)).or_default();
            set.extend(members);
        }
        for (upper, members) in &sets[1] {
            let spelling = &scope.element_sets.by_name[upper].0;
            self.take_elements(&name(spelling), members);
        }
    }

    fn take_elements(&mut self, name: &str, members: &[u32]) {
        let raw = &mut self.raw;
        let mut empty = true;
        for &member in members {
            match self.items[member as usize] {
                Item::Solid(e) => raw.solid_sets.entry(name.to_string()).or_default().push(e),
                Item::Facet(f) => raw.facets.sets.entry(name.to_string()).or_default().push(f),
                Item::Line(l) => {
                    let line = self.lines[l as usize];
                    raw.lines.entry(name.to_string()).or_default().push(line);
                    raw.node_sets
                        .entry(name.to_string())
                        .or_default()
                        .extend(line);
                }
                Item::Nothing => continue,
            }
            empty = false;
        }
        if empty {
            raw.notes.push(format!(
                "set `{name}` holds no solid, surface or line elements"
            ));
        }
    }

    /// Faces, edges and surface elements of the surfaces of a scope. `own`: where its numbers and sets are.
    fn surfaces(
        &mut self,
        scope: &Scope,
        others: &[Placed],
        own: &Placed,
        name: &dyn Fn(&str) -> String,
    ) -> Result<(), MeshError> {
        let path = self.reader.path;
        for (spelling, surface) in scope.surfaces.by_name.values() {
            let set = name(spelling);
            for entry in &surface.entries {
                let members: Vec<u32> = match Names::find(own, others, entry) {
                    Some(members) => members,
                    None if !self.reader.types.is_empty() => continue,
                    None => return Err(unknown::<Elements>(path, entry, &entry.text(), None)),
                };
                self.budget.spend(members.len() + 1)?;
                for member in members {
                    let raw = &mut self.raw;
                    match (self.items[member as usize], entry.side) {
                        (Item::Solid(element), Side::Face(face)) => {
                            let faces = raw.face_sets.entry(set.clone()).or_default();
                            faces.push(Face { element, face });
                        }
                        (Item::Solid(_), _) => {
                            let expected = "a face from S1 to S6";
                            let found = entry.text();
                            return Err(entry.at().syntax_found(path, expected, &found));
                        }
                        (Item::Facet(f), Side::Edge(k)) => {
                            let corners = raw.facets.corners[f as usize];
                            let count = if corners[3] == NONE { 3 } else { 4 };
                            let k = usize::from(k) % count;
                            let line = [corners[k], corners[(k + 1) % count]];
                            raw.lines.entry(set.clone()).or_default().push(line);
                        }
                        (Item::Facet(f), _) => {
                            raw.facets.sets.entry(set.clone()).or_default().push(f);
                        }
                        (Item::Line(_) | Item::Nothing, _) => {}
                    }
                }
            }
        }
        Ok(())
    }
}
