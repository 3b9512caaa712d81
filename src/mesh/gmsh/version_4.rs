//! Nodes and elements of version 4.1: in blocks, one for each geometric entity.
use super::{Block, Reader};
use crate::mesh::MeshError;
use crate::mesh::error::MAX_NODES;
use covact_geometry::Vec3;

impl Reader<'_> {
    pub(super) fn nodes_4(&mut self, section: usize) -> Result<(), MeshError> {
        let c = &mut self.cursor;
        if self.numbers.is_some() {
            return Err(c.syntax(section, "one section $Nodes", "a second one"));
        }
        let blocks = c.count("a number of node blocks", 4, 20)?;
        let total = c.count("a number of nodes", 4, 32)?;
        if total as u64 > MAX_NODES {
            return Err(MeshError::TooManyNodes {
                what: "gmsh file",
                nodes: total as u128,
            });
        }
        c.size("the smallest node number")?;
        c.size("the largest node number")?;
        let mut positions = Vec::with_capacity(total);
        for _ in 0..blocks {
            let start = c.mark();
            let dim = c.int("the dimension of a node block's entity")?;
            if !(0..=3).contains(&dim) {
                return Err(c.syntax(start, "a dimension from 0 to 3", dim.to_string()));
            }
            c.int("the number of a node block's entity")?;
            let start = c.mark();
            let parameters = match c.int("0 or 1 (parametric nodes)")? {
                0 => 0,
                1 => dim,
                other => {
                    return Err(c.syntax(start, "0 or 1 (parametric nodes)", other.to_string()));
                }
            };
            let each = 4 + parameters as u64;
            let start = c.mark();
            let count = c.count("a number of nodes in the block", each, 8 * each)?;
            if self.raw.node_tags.len() + count > total {
                let expected = format!("{total} nodes in all, as the section announces");
                return Err(c.syntax(start, &expected, "more"));
            }
            for _ in 0..count {
                positions.push(c.mark());
                self.raw.node_tags.push(c.size("a node number")?);
            }
            for _ in 0..count {
                let x = c.real("a node's x")?;
                let y = c.real("a node's y")?;
                let z = c.real("a node's z")?;
                for _ in 0..parameters {
                    c.real("a node's parameter")?;
                }
                self.raw.nodes.push(Vec3::new(x, y, z));
            }
        }
        if self.raw.nodes.len() != total {
            let expected = format!("{total} nodes in all, as the section announces");
            return Err(c.syntax(section, &expected, self.raw.nodes.len().to_string()));
        }
        self.number(&positions)
    }

    pub(super) fn elements_4(&mut self, section: usize) -> Result<(), MeshError> {
        let Some(numbers) = self.numbers.take() else {
            let expected = "a section $Nodes before $Elements";
            return Err(self.cursor.syntax(section, expected, "$Elements"));
        };
        let c = &mut self.cursor;
        let blocks = c.count("a number of element blocks", 4, 20)?;
        let total = c.count("a number of elements", 2, 16)?;
        c.size("the smallest element number")?;
        c.size("the largest element number")?;
        let mut seen = 0;
        for _ in 0..blocks {
            let c = &mut self.cursor;
            let start = c.mark();
            let dim = c.int("the dimension of an element block's entity")?;
            let entity = c.int("the number of an element block's entity")?;
            let at = c.mark();
            let number = c.int("an element type")?;
            let kind = self.kind(at, number)?;
            let c = &mut self.cursor;
            if kind.dim != dim {
                let expected = format!("dimension {} of {}", kind.dim, kind.name);
                return Err(c.syntax(start, &expected, dim.to_string()));
            }
            if kind.dim == 3 {
                self.solid(at, kind);
            }
            let c = &mut self.cursor;
            let each = 1 + kind.nodes as u64;
            let count = c.count("a number of elements in the block", each, 8 * each)?;
            seen += count;
            *self.counts.entry(kind.name).or_default() += count;
            let mut block = Block::new(kind, entity);
            block.count = count;
            if kind.used {
                block.tags.reserve(count);
                block.nodes.reserve(count * kind.nodes);
            }
            for _ in 0..count {
                let tag = c.size("an element number")?;
                for _ in 0..kind.nodes {
                    let at = c.mark();
                    let node = c.size("a node number")?;
                    match numbers.get(node) {
                        Some(index) if kind.used => block.nodes.push(index),
                        Some(_) => {}
                        None => {
                            let found = format!("{node} in element {tag}");
                            return Err(c.syntax(at, "the number of a node in $Nodes", found));
                        }
                    }
                }
                if kind.used {
                    block.tags.push(tag);
                }
            }
            self.blocks.push(block);
        }
        if seen != total {
            let expected = format!("{total} elements in all, as the section announces");
            return Err(self.cursor.syntax(section, &expected, seen.to_string()));
        }
        self.numbers = Some(numbers);
        Ok(())
    }
}
