//! Physical groups: which geometric entities belong to which named group.
use super::Block;
use crate::mesh::MeshError;
use crate::mesh::cursor::{Cursor, quoted};
use crate::mesh::error::{MOST_IN_NAME, most_members};
use crate::mesh::raw::RawMesh;
use std::collections::BTreeMap;
use std::path::Path;
use std::rc::Rc;

const DIMENSIONS: [&str; 4] = ["point", "curve", "surface", "volume"];

/// Physical groups by dimension and number.
#[derive(Debug, Default)]
pub(super) struct Groups {
    /// Names of the groups.
    names: BTreeMap<(i32, i32), String>,
    /// Groups of every entity (dimension, number).
    members: BTreeMap<(i32, i32), Rc<[i32]>>,
}

impl Groups {
    /// `$PhysicalNames`, text also in binary files.
    pub fn names(&mut self, c: &mut Cursor) -> Result<(), MeshError> {
        let count: u64 = c.text_number("a number of physical names")?;
        for _ in 0..count {
            let at = c.mark();
            let dim: i32 = c.text_number("the dimension of a physical group")?;
            if !(0..=3).contains(&dim) {
                return Err(c.syntax(at, "a dimension from 0 to 3", dim.to_string()));
            }
            let tag: i32 = c.text_number("the number of a physical group")?;
            let at = c.mark();
            let line = c.rest_of_line().trim_ascii();
            let name = line.strip_prefix(b"\"").and_then(|l| l.strip_suffix(b"\""));
            match name {
                // Sets repeat their names.
                Some(name) if name.len() > MOST_IN_NAME => {
                    let expected = format!("a name of at most {MOST_IN_NAME} bytes");
                    return Err(c.syntax(at, &expected, quoted(name)));
                }
                Some(name) if !name.is_empty() => {
                    let name = String::from_utf8_lossy(name).into_owned();
                    self.names.insert((dim, tag), name);
                }
                _ => return Err(c.syntax(at, "a name in double quotes", quoted(line))),
            }
        }
        Ok(())
    }

    /// A group of its own entity, as version 2 has them.
    pub fn add(&mut self, dim: i32, group: i32) {
        let groups = self.members.entry((dim, group));
        groups.or_insert_with(|| Rc::from([group]));
    }

    /// `$Entities`.
    pub fn entities(&mut self, c: &mut Cursor) -> Result<(), MeshError> {
        let counts = entity_counts(c)?;
        for (dim, count) in (0..).zip(counts) {
            for _ in 0..count {
                let tag = c.int("the number of an entity")?;
                let groups = groups_of_entity(c, dim)?;
                self.members.insert((dim, tag), groups);
            }
        }
        Ok(())
    }

    /// `$PartitionedEntities`: the parts of entities in a partitioned mesh, which take their place.
    pub fn partitioned(&mut self, c: &mut Cursor) -> Result<(), MeshError> {
        c.size("a number of partitions")?;
        let ghosts = c.count("a number of ghost entities", 2, 8)?;
        for _ in 0..ghosts {
            c.int("the number of a ghost entity")?;
            c.int("a partition")?;
        }
        let counts = entity_counts(c)?;
        for (dim, count) in (0..).zip(counts) {
            for _ in 0..count {
                let tag = c.int("the number of an entity")?;
                let parent_dim = c.int("the dimension of a parent entity")?;
                let parent = c.int("the number of a parent entity")?;
                let partitions = c.count("a number of partitions", 1, 4)?;
                for _ in 0..partitions {
                    c.int("a partition")?;
                }
                let mut groups = groups_of_entity(c, dim)?;
                // Many parts may have one parent with many groups, so they share them.
                if let (true, Some(of_parent)) = (
                    groups.is_empty() && parent_dim == dim,
                    self.members.get(&(dim, parent)),
                ) {
                    groups = of_parent.clone();
                }
                self.members.insert((dim, tag), groups);
            }
        }
        Ok(())
    }

    /// Node sets and surfaces of all groups.
    ///
    /// # Errors
    /// [`MeshError::LongSets`] where entities are in so many groups that the sets would be far longer than the file.
    pub fn sets(&self, blocks: &[Block], raw: &mut RawMesh, path: &Path) -> Result<(), MeshError> {
        let mut filled = std::collections::BTreeSet::new();
        let elements = blocks.iter().map(|b| b.count).sum();
        let most = most_members(raw.nodes.len(), elements);
        let mut members = 0;
        for block in blocks.iter().filter(|b| b.count > 0) {
            let groups = self.members.get(&(block.dim, block.entity));
            for &group in groups.into_iter().flat_map(|g| g.iter()) {
                // A negative number says that the entity is reversed in the group.
                let key = (block.dim, group.checked_abs().unwrap_or(0));
                let kind = DIMENSIONS[block.dim as usize];
                let name = match self.names.get(&key) {
                    Some(name) => name.clone(),
                    None => format!("{kind}_{}", key.1),
                };
                if filled.insert(key) && !self.names.contains_key(&key) {
                    raw.notes.push(format!(
                        "physical {kind} {} has no name; its set is `{name}`",
                        key.1
                    ));
                }
                members += (block.kind.nodes * block.tags.len()) as u64 + 1;
                if members > most {
                    let path = path.to_path_buf();
                    return Err(MeshError::LongSets { path, most });
                }
                let elements = block.first..block.first + block.tags.len() as u32;
                match block.dim {
                    2 => raw.facets.sets.entry(name).or_default().extend(elements),
                    3 if raw.refused.is_none() => {
                        raw.solid_sets.entry(name).or_default().extend(elements);
                    }
                    3 => {}
                    dim => {
                        let nodes = raw.node_sets.entry(name.clone()).or_default();
                        nodes.extend(&block.nodes);
                        if dim == 1 {
                            // Ends come first.
                            let lines = block.nodes.chunks_exact(block.kind.nodes);
                            let lines = lines.map(|line| [line[0], line[1]]);
                            raw.lines.entry(name).or_default().extend(lines);
                        }
                    }
                }
            }
        }
        for (key, name) in &self.names {
            if !filled.contains(key) {
                let kind = DIMENSIONS[key.0 as usize];
                raw.notes
                    .push(format!("physical {kind} `{name}` holds no elements"));
            }
        }
        if filled.is_empty() {
            raw.notes.push(
                "the file has no physical groups, so the mesh has no named sets; select by geometry or name \
                 physical groups in gmsh"
                    .to_string(),
            );
        }
        Ok(())
    }
}

/// Numbers of points, curves, surfaces, volumes.
fn entity_counts(c: &mut Cursor) -> Result<[usize; 4], MeshError> {
    Ok([
        c.count("a number of points", 5, 36)?,
        c.count("a number of curves", 9, 68)?,
        c.count("a number of surfaces", 9, 68)?,
        c.count("a number of volumes", 9, 68)?,
    ])
}

/// Rest of an entity after its number: its position or box, its groups, its borders.
fn groups_of_entity(c: &mut Cursor, dim: i32) -> Result<Rc<[i32]>, MeshError> {
    for _ in 0..if dim == 0 { 3 } else { 6 } {
        c.real("a coordinate of an entity")?;
    }
    let count = c.count("a number of physical groups", 1, 4)?;
    let mut groups = Vec::with_capacity(count);
    for _ in 0..count {
        groups.push(c.int("the number of a physical group")?);
    }
    if dim > 0 {
        let borders = c.count("a number of bounding entities", 1, 4)?;
        for _ in 0..borders {
            c.int("the number of a bounding entity")?;
        }
    }
    Ok(groups.into())
}
