//! Node numbers of a file.
use super::Reader;
use crate::mesh::MeshError;
use std::collections::HashMap;

/// Index of a node by its number in the file.
pub(super) enum Numbers {
    Dense(Vec<u32>),
    Sparse(HashMap<u64, u32>),
}

impl Numbers {
    pub fn get(&self, tag: u64) -> Option<u32> {
        match self {
            Numbers::Dense(list) => {
                let index = *list.get(usize::try_from(tag).ok()?)?;
                (index != u32::MAX).then_some(index)
            }
            Numbers::Sparse(map) => map.get(&tag).copied(),
        }
    }
}

impl Reader<'_> {
    /// Takes the numbers of all nodes that were read; `positions` is where each stands.
    pub(super) fn number(&mut self, positions: &[usize]) -> Result<(), MeshError> {
        let twice = |at: usize, tag: u64| {
            self.cursor.syntax(
                positions[at],
                "a node number used once",
                format!("{tag} again"),
            )
        };
        let tags = &self.raw.node_tags;
        let total = tags.len();
        let largest = tags.iter().copied().max().unwrap_or(0);
        self.numbers = Some(if largest < 4 * total as u64 + 1024 {
            let mut list = vec![u32::MAX; largest as usize + 1];
            for (i, &tag) in tags.iter().enumerate() {
                if list[tag as usize] != u32::MAX {
                    return Err(twice(i, tag));
                }
                list[tag as usize] = i as u32;
            }
            Numbers::Dense(list)
        } else {
            let mut map = HashMap::with_capacity(total);
            for (i, &tag) in tags.iter().enumerate() {
                if map.insert(tag, i as u32).is_some() {
                    return Err(twice(i, tag));
                }
            }
            Numbers::Sparse(map)
        });
        Ok(())
    }
}
