//! Reader of gmsh's mesh format 4.1, text and binary (format: gmsh reference manual, "MSH file format").
//!
//! Hexahedra of 8 or of 27 nodes become elements; quadrilaterals of physical surfaces become face sets; the nodes of every
//! physical group become a node set of its name.
mod cursor;
mod groups;

use super::error::{MAX_NODES, shorten};
use super::raw::RawMesh;
use super::{MeshError, MeshReport};
use crate::mesh::Mesh;
use covact_geometry::Vec3;
use cursor::{Cursor, Encoding, quoted};
use groups::Groups;
use std::collections::{BTreeMap, HashMap};
use std::path::Path;

/// gmsh numbers the nodes of a face around it; tensor node `a` is gmsh node `TENSOR[a]`.
const TENSOR: [usize; 8] = [0, 1, 3, 2, 4, 5, 7, 6];

/// Node of gmsh's 27-node hexahedron at tensor place `i + 3 j + 9 k`.
const TENSOR_27: [usize; 27] = [
    0, 8, 1, 9, 20, 11, 3, 13, 2, // bottom
    10, 21, 12, 22, 26, 23, 15, 24, 14, // middle
    4, 16, 5, 17, 25, 18, 7, 19, 6, // top
];

const EXPORT: &str = "write the mesh with `gmsh model.geo -3 -format msh41`";
const HEXAHEDRA: &str = "elements are hexahedra of 8 nodes (`Mesh.ElementOrder = 1`) or 27 (`Mesh.ElementOrder = 2`); use \
                         transfinite or extruded layers with `Recombine`, and `Mesh.SubdivisionAlgorithm = 2` where \
                         needed";
const SERENDIPITY: &str = "they have no nodes in the middle of their faces; write full second-order elements of 27 nodes \
                           (`Mesh.SecondOrderIncomplete = 0`, element `q18`) or linear ones (`Mesh.ElementOrder = 1`, \
                           element `h8`)";

/// Reads the mesh from the bytes of a file; `path` is for messages, `scale` multiplies every coordinate.
pub fn read_gmsh(bytes: &[u8], path: &Path, scale: f64) -> Result<(Mesh, MeshReport), MeshError> {
    let mut reader = Reader {
        cursor: Cursor {
            path,
            bytes,
            pos: 0,
            encoding: Encoding::Text,
        },
        groups: Groups::default(),
        numbers: None,
        raw: RawMesh::default(),
        blocks: Vec::new(),
        counts: BTreeMap::new(),
        skipped: Vec::new(),
    };
    reader.sections()?;
    reader.finish()?.into_mesh(scale)
}

/// Elements of one type on one geometric entity.
pub(super) struct Block {
    pub dim: i32,
    pub entity: i32,
    pub kind: &'static ElementType,
    /// Node indices of the elements, one after the other (empty for types that are left out).
    pub nodes: Vec<u32>,
    pub count: usize,
}

/// An element type of gmsh.
#[derive(Debug)]
pub(super) struct ElementType {
    number: i32,
    pub name: &'static str,
    pub nodes: usize,
    dim: i32,
    /// Of use here: points, lines, quadrilaterals and hexahedra with all nodes of their order.
    used: bool,
}

const fn element_type(
    number: i32,
    name: &'static str,
    nodes: usize,
    dim: i32,
    used: bool,
) -> ElementType {
    ElementType {
        number,
        name,
        nodes,
        dim,
        used,
    }
}

const TYPES: [ElementType; 19] = [
    element_type(15, "points", 1, 0, true),
    element_type(1, "lines", 2, 1, true),
    element_type(8, "quadratic lines", 3, 1, true),
    element_type(2, "triangles", 3, 2, false),
    element_type(3, "quadrilaterals", 4, 2, true),
    element_type(9, "quadratic triangles", 6, 2, false),
    element_type(10, "quadratic quadrilaterals (9 nodes)", 9, 2, true),
    element_type(16, "quadratic quadrilaterals (8 nodes)", 8, 2, false),
    element_type(4, "tetrahedra", 4, 3, false),
    element_type(5, "hexahedra", 8, 3, true),
    element_type(6, "prisms", 6, 3, false),
    element_type(7, "pyramids", 5, 3, false),
    element_type(11, "quadratic tetrahedra", 10, 3, false),
    element_type(12, "quadratic hexahedra (27 nodes)", 27, 3, true),
    element_type(13, "quadratic prisms (18 nodes)", 18, 3, false),
    element_type(14, "quadratic pyramids (14 nodes)", 14, 3, false),
    element_type(17, "quadratic hexahedra (20 nodes)", 20, 3, false),
    element_type(18, "quadratic prisms (15 nodes)", 15, 3, false),
    element_type(19, "quadratic pyramids (13 nodes)", 13, 3, false),
];

/// Index of a node by its number in the file.
enum Numbers {
    Dense(Vec<u32>),
    Sparse(HashMap<u64, u32>),
}

impl Numbers {
    fn get(&self, tag: u64) -> Option<u32> {
        match self {
            Numbers::Dense(list) => {
                let index = *list.get(usize::try_from(tag).ok()?)?;
                (index != u32::MAX).then_some(index)
            }
            Numbers::Sparse(map) => map.get(&tag).copied(),
        }
    }
}

struct Reader<'a> {
    cursor: Cursor<'a>,
    groups: Groups,
    /// Filled by the section of nodes.
    numbers: Option<Numbers>,
    raw: RawMesh,
    blocks: Vec<Block>,
    /// Elements of the file by type name.
    counts: BTreeMap<&'static str, usize>,
    /// Sections that were passed over.
    skipped: Vec<String>,
}

impl Reader<'_> {
    fn sections(&mut self) -> Result<(), MeshError> {
        self.format()?;
        let mut elements = false;
        while !self.cursor.at_end() {
            let (word, start) = self.cursor.word("a section such as $Nodes")?;
            let Some(name) = word.strip_prefix(b"$") else {
                let expected = "a section such as $Nodes";
                return Err(self.cursor.syntax(start, expected, quoted(word)));
            };
            // The data start on the next line; in binary files right after the line's end.
            self.cursor.rest_of_line();
            match name {
                b"PhysicalNames" => self.groups.names(&mut self.cursor)?,
                b"Entities" => self.groups.entities(&mut self.cursor)?,
                b"PartitionedEntities" => self.groups.partitioned(&mut self.cursor)?,
                b"Nodes" => self.nodes(start)?,
                b"Elements" => {
                    elements = true;
                    self.elements(start)?;
                }
                other => {
                    self.skip(other, start)?;
                    continue;
                }
            }
            self.end(name)?;
        }
        let missing = match (&self.numbers, elements) {
            (None, _) => "$Nodes",
            (_, false) => "$Elements",
            _ => return Ok(()),
        };
        let end = self.cursor.bytes.len();
        let expected = format!("a section {missing}");
        Err(self.cursor.syntax(end, &expected, "the end of the file"))
    }

    /// `$MeshFormat`: version, text or binary, byte order.
    fn format(&mut self) -> Result<(), MeshError> {
        loop {
            let (word, start) = self.cursor.word("$MeshFormat")?;
            match word {
                b"$MeshFormat" => break,
                b"$Comments" => self.skip(b"Comments", start)?,
                b"$NOD" | b"$NOE" => {
                    let what = "gmsh format 1".to_string();
                    return Err(self.cursor.unsupported(start, what, EXPORT));
                }
                _ => return Err(self.cursor.syntax(start, "$MeshFormat", quoted(word))),
            }
        }
        let c = &mut self.cursor;
        let (version, start) = c.word("the format's version, 4.1")?;
        if version != b"4.1" {
            let number = std::str::from_utf8(version)
                .ok()
                .and_then(|v| v.parse::<f64>().ok());
            if number.is_none() {
                return Err(c.syntax(start, "the format's version, 4.1", quoted(version)));
            }
            let what = format!(
                "gmsh format version {}",
                shorten(&String::from_utf8_lossy(version))
            );
            return Err(c.unsupported(start, what, EXPORT));
        }
        let (kind, start) = c.word("0 (text) or 1 (binary)")?;
        let binary = match kind {
            b"0" => false,
            b"1" => true,
            _ => return Err(c.syntax(start, "0 (text) or 1 (binary)", quoted(kind))),
        };
        let (size, start) = c.word("the data size, 8")?;
        if size != b"8" {
            let what = format!("data size {}", quoted(size));
            return Err(c.unsupported(start, what, EXPORT));
        }
        if binary {
            c.rest_of_line();
            c.encoding = Encoding::Binary { swap: false };
            let start = c.mark();
            let one = c.int("the number 1 in 4 bytes")?;
            if one == 1i32.swap_bytes() {
                c.encoding = Encoding::Binary { swap: true };
            } else if one != 1 {
                return Err(c.syntax(start, "the number 1 in 4 bytes", one.to_string()));
            }
        }
        self.end(b"MeshFormat")
    }

    fn end(&mut self, name: &[u8]) -> Result<(), MeshError> {
        let expected = format!("$End{}", String::from_utf8_lossy(name));
        let (word, start) = self.cursor.word(&expected)?;
        if word == expected.as_bytes() {
            Ok(())
        } else {
            Err(self.cursor.syntax(start, &expected, quoted(word)))
        }
    }

    /// Passes over a section that is of no use here.
    fn skip(&mut self, name: &[u8], start: usize) -> Result<(), MeshError> {
        let c = &mut self.cursor;
        let end = [b"$End", name].concat();
        let found = c.bytes[c.pos.min(c.bytes.len())..]
            .windows(end.len())
            .position(|window| window == end);
        let Some(found) = found else {
            let expected = format!("{} to end the section", quoted(&end));
            return Err(c.syntax(start, &expected, "the end of the file"));
        };
        c.pos += found + end.len();
        if name != b"Comments" {
            self.skipped
                .push(format!("${}", String::from_utf8_lossy(name)));
        }
        Ok(())
    }

    fn nodes(&mut self, section: usize) -> Result<(), MeshError> {
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
        let twice = |at: usize, tag: u64| {
            self.cursor.syntax(
                positions[at],
                "a node number used once",
                format!("{tag} again"),
            )
        };
        let tags = &self.raw.node_tags;
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

    fn elements(&mut self, section: usize) -> Result<(), MeshError> {
        let c = &mut self.cursor;
        let Some(numbers) = &self.numbers else {
            return Err(c.syntax(section, "a section $Nodes before $Elements", "$Elements"));
        };
        let blocks = c.count("a number of element blocks", 4, 20)?;
        let total = c.count("a number of elements", 2, 16)?;
        c.size("the smallest element number")?;
        c.size("the largest element number")?;
        let mut seen = 0;
        for _ in 0..blocks {
            let start = c.mark();
            let dim = c.int("the dimension of an element block's entity")?;
            let entity = c.int("the number of an element block's entity")?;
            let at = c.mark();
            let number = c.int("an element type")?;
            let Some(kind) = TYPES.iter().find(|t| t.number == number) else {
                return Err(c.unsupported(at, format!("gmsh element type {number}"), HEXAHEDRA));
            };
            if kind.dim != dim {
                let expected = format!("dimension {} of {}", kind.dim, kind.name);
                return Err(c.syntax(start, &expected, dim.to_string()));
            }
            if kind.dim == 3 && !kind.used {
                let what = format!("a mesh of {} (gmsh type {number})", kind.name);
                let help = if number == 17 { SERENDIPITY } else { HEXAHEDRA };
                return Err(c.unsupported(at, what, help));
            }
            let other = (self.blocks.iter()).find(|b| b.dim == 3 && b.kind.number != number);
            if let Some(other) = other.filter(|_| dim == 3) {
                let what = format!("a mesh of both {} and {}", other.kind.name, kind.name);
                let help = "give all volumes the same `Mesh.ElementOrder`";
                return Err(c.unsupported(at, what, help));
            }
            let each = 1 + kind.nodes as u64;
            let count = c.count("a number of elements in the block", each, 8 * each)?;
            seen += count;
            *self.counts.entry(kind.name).or_default() += count;
            let mut nodes = Vec::with_capacity(if kind.used { count * kind.nodes } else { 0 });
            for _ in 0..count {
                let tag = c.size("an element number")?;
                for _ in 0..kind.nodes {
                    let at = c.mark();
                    let node = c.size("a node number")?;
                    match numbers.get(node) {
                        Some(index) if kind.used => nodes.push(index),
                        Some(_) => {}
                        None => {
                            let found = format!("{node} in element {tag}");
                            return Err(c.syntax(at, "the number of a node in $Nodes", found));
                        }
                    }
                }
                if dim == 3 {
                    self.raw.element_tags.push(tag);
                }
            }
            self.blocks.push(Block {
                dim,
                entity,
                kind,
                nodes,
                count,
            });
        }
        if seen != total {
            let expected = format!("{total} elements in all, as the section announces");
            return Err(c.syntax(section, &expected, seen.to_string()));
        }
        Ok(())
    }

    /// Elements and sets from what was read.
    fn finish(mut self) -> Result<RawMesh, MeshError> {
        if self.raw.element_tags.is_empty() {
            let found: Vec<String> = self
                .counts
                .iter()
                .map(|(name, n)| format!("{n} {name}"))
                .collect();
            return Err(MeshError::NoElements {
                path: self.cursor.path.to_path_buf(),
                found: if found.is_empty() {
                    "none".to_string()
                } else {
                    found.join(", ")
                },
                help: format!(
                    "give the shell its thickness by extruding its surface in layers; {HEXAHEDRA}; if physical \
                     groups are defined, one must hold the volume"
                ),
            });
        }
        for block in self.blocks.iter().filter(|b| b.dim == 3) {
            for e in block.nodes.chunks_exact(block.kind.nodes) {
                self.raw.hexahedra.push(TENSOR.map(|a| e[a]));
                if e.len() == 27 {
                    self.raw.quadratic.push(TENSOR_27.map(|a| e[a]));
                }
            }
        }
        if !self.skipped.is_empty() {
            let list = self.skipped.join(", ");
            self.raw.notes.push(format!("sections left out: {list}"));
        }
        for kind in TYPES.iter().filter(|t| !t.used) {
            if let Some(n) = self.counts.get(kind.name).filter(|n| **n > 0) {
                self.raw
                    .notes
                    .push(format!("{n} {} were left out", kind.name));
            }
        }
        self.groups
            .sets(&self.blocks, &mut self.raw, self.cursor.path)?;
        Ok(self.raw)
    }
}
