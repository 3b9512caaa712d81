//! Nodes and elements of version 2.2: one list each, the physical group in front of an element's nodes.
use super::{Block, Reader};
use crate::mesh::MeshError;
use crate::mesh::cursor::Encoding;
use crate::mesh::error::MAX_NODES;
use covact_geometry::Vec3;

/// Most numbers (physical group, entity, partitions) in front of the nodes of an element.
const MOST_TAGS: i32 = 10_000;

impl Reader<'_> {
    /// A count, which is text in binary files too; more than the rest of the file can hold is refused.
    fn count_2(&mut self, what: &str, words: u64, bytes: u64) -> Result<usize, MeshError> {
        let c = &mut self.cursor;
        let encoding = std::mem::replace(&mut c.encoding, Encoding::Text);
        let each = match encoding {
            Encoding::Text => (words, 1),
            // A word of text takes two bytes.
            Encoding::Binary { .. } => (bytes.div_ceil(2), 1),
        };
        let count = c.count(what, each.0, each.1);
        if encoding != Encoding::Text && count.is_ok() {
            c.rest_of_line();
        }
        c.encoding = encoding;
        count
    }

    pub(super) fn nodes_2(&mut self, section: usize) -> Result<(), MeshError> {
        if self.numbers.is_some() {
            let expected = "one section $Nodes";
            return Err(self.cursor.syntax(section, expected, "a second one"));
        }
        let total = self.count_2("a number of nodes", 4, 28)?;
        if total as u64 > MAX_NODES {
            return Err(MeshError::TooManyNodes {
                what: "gmsh file",
                nodes: total as u128,
            });
        }
        let c = &mut self.cursor;
        let mut positions = Vec::with_capacity(total);
        for _ in 0..total {
            let at = c.mark();
            positions.push(at);
            let tag = c.int("a node number")?;
            let Ok(tag) = u64::try_from(tag) else {
                return Err(c.syntax(at, "a node number", tag.to_string()));
            };
            self.raw.node_tags.push(tag);
            let x = c.real("a node's x")?;
            let y = c.real("a node's y")?;
            let z = c.real("a node's z")?;
            self.raw.nodes.push(Vec3::new(x, y, z));
        }
        self.number(&positions)
    }

    pub(super) fn elements_2(&mut self, section: usize) -> Result<(), MeshError> {
        if self.numbers.is_none() {
            let expected = "a section $Nodes before $Elements";
            return Err(self.cursor.syntax(section, expected, "$Elements"));
        }
        let total = self.count_2("a number of elements", 3, 12)?;
        let binary = self.cursor.encoding != Encoding::Text;
        let mut seen = 0;
        while seen < total {
            let c = &mut self.cursor;
            // Binary files say once for many elements what text says for each.
            let tag = match binary {
                true => None,
                false => Some(c.int("an element number")?),
            };
            let at = c.mark();
            let number = c.int("an element type")?;
            let start = c.mark();
            let count = match binary {
                true => c.int("a number of elements")?,
                false => 1,
            };
            if count < 1 || count as usize > total - seen {
                let expected = format!("at most {} elements, as announced", total - seen);
                return Err(c.syntax(start, &expected, count.to_string()));
            }
            let start = c.mark();
            let tags = c.int("a number of tags")?;
            if !(0..=MOST_TAGS).contains(&tags) {
                return Err(c.syntax(start, "a number of tags", tags.to_string()));
            }
            let kind = self.kind(at, number)?;
            if kind.dim == 3 {
                self.solid(at, kind);
            }
            for _ in 0..count {
                self.element_2(kind, tag, tags)?;
            }
            seen += count as usize;
            *self.counts.entry(kind.name).or_default() += count as usize;
        }
        Ok(())
    }

    /// One element from its number (binary) or its tags (text) on.
    fn element_2(
        &mut self,
        kind: &'static super::ElementType,
        tag: Option<i32>,
        tags: i32,
    ) -> Result<(), MeshError> {
        let c = &mut self.cursor;
        let tag = match tag {
            Some(tag) => tag,
            None => c.int("an element number")?,
        };
        let mut group = 0;
        for k in 0..tags {
            let number = c.int("a physical group or an entity")?;
            if k == 0 {
                group = number;
            }
        }
        let same = |b: &&mut Block| b.kind.number == kind.number && b.entity == group;
        if self.blocks.last_mut().filter(same).is_none() {
            self.blocks.push(Block::new(kind, group));
            if group != 0 {
                self.groups.add(kind.dim, group);
            }
        }
        let (Some(block), Some(numbers)) = (self.blocks.last_mut(), &self.numbers) else {
            return Ok(());
        };
        block.count += 1;
        for _ in 0..kind.nodes {
            let at = c.mark();
            let node = c.int("a node number")?;
            match u64::try_from(node).ok().and_then(|n| numbers.get(n)) {
                Some(index) if kind.used => block.nodes.push(index),
                Some(_) => {}
                None => {
                    let found = format!("{node} in element {tag}");
                    return Err(c.syntax(at, "the number of a node in $Nodes", found));
                }
            }
        }
        if kind.used {
            block.tags.push(u64::try_from(tag).unwrap_or(0));
        }
        Ok(())
    }
}
