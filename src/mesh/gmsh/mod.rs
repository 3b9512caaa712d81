//! Reader of gmsh's mesh formats 4.1 and 2.2, text and binary (format: gmsh reference manual, "MSH file format").
//!
//! Hexahedra of 8, 20 or 27 nodes are the elements of a solid; quadrilaterals of physical surfaces are its face sets.
//! Quadrilaterals and triangles are the elements of a surface. Every physical group is a set of its name.
mod groups;
mod numbers;
mod types;
mod version_2;
mod version_4;

use super::cursor::{Cursor, Encoding, quoted};
use super::error::shorten;
use super::raw::{NONE, RawMesh};
use super::{Mesh, MeshError, MeshReport};
use groups::Groups;
use numbers::Numbers;
use std::collections::BTreeMap;
use std::path::Path;
use types::{ElementType, TENSOR, TENSOR_27, TYPES};

const EXPORT: &str = "write the mesh with `gmsh model.geo -3 -format msh41` (or msh22)";
const HEXAHEDRA: &str = "elements are hexahedra of 8 nodes (`Mesh.ElementOrder = 1`) or 27 (`Mesh.ElementOrder = 2`); use \
                         transfinite or extruded layers with `Recombine`, and `Mesh.SubdivisionAlgorithm = 2` where \
                         needed";
const EXTRUDE: &str = "give the shell its thickness by extruding its surface in layers; elements are hexahedra of 8 nodes \
                       (`Mesh.ElementOrder = 1`) or 27 (`Mesh.ElementOrder = 2`); if physical groups are defined, one must \
                       hold the volume";

/// Reads the mesh of hexahedra from the bytes of a file; `path` is for messages, `scale` multiplies every coordinate.
pub fn read_gmsh(bytes: &[u8], path: &Path, scale: f64) -> Result<(Mesh, MeshReport), MeshError> {
    parse(bytes, path)?.into_mesh(path, scale, false)
}

/// Everything of use in a file.
pub(super) fn parse(bytes: &[u8], path: &Path) -> Result<RawMesh, MeshError> {
    let mut reader = Reader {
        cursor: Cursor {
            path,
            bytes,
            pos: 0,
            encoding: Encoding::Text,
        },
        version: Version::Four,
        groups: Groups::default(),
        numbers: None,
        raw: RawMesh::default(),
        blocks: Vec::new(),
        counts: BTreeMap::new(),
        solids: None,
        skipped: Vec::new(),
    };
    reader.sections()?;
    reader.finish()
}

/// The layout of nodes and elements.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Version {
    Two,
    Four,
}

/// Elements of one type on one geometric entity (version 2: of one physical group).
struct Block {
    dim: i32,
    entity: i32,
    kind: &'static ElementType,
    /// Numbers of the elements, and node indices one element after the other (none for types that are left out).
    tags: Vec<u64>,
    nodes: Vec<u32>,
    count: usize,
    /// Place of the first element among the hexahedra or facets.
    first: u32,
}

impl Block {
    fn new(kind: &'static ElementType, entity: i32) -> Block {
        Block {
            dim: kind.dim,
            entity,
            kind,
            tags: Vec::new(),
            nodes: Vec::new(),
            count: 0,
            first: 0,
        }
    }
}

struct Reader<'a> {
    cursor: Cursor<'a>,
    version: Version,
    groups: Groups,
    /// Filled by the section of nodes.
    numbers: Option<Numbers>,
    raw: RawMesh,
    blocks: Vec<Block>,
    /// Elements of the file by type name.
    counts: BTreeMap<&'static str, usize>,
    /// The first type of solid elements.
    solids: Option<&'static ElementType>,
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
                b"Nodes" => match self.version {
                    Version::Two => self.nodes_2(start)?,
                    Version::Four => self.nodes_4(start)?,
                },
                b"Elements" => {
                    elements = true;
                    match self.version {
                        Version::Two => self.elements_2(start)?,
                        Version::Four => self.elements_4(start)?,
                    }
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
                // meshio writes it where nobody asks for gmsh.
                _ if word.starts_with(b"(") => {
                    let what = "a mesh of ANSYS Fluent".to_string();
                    let help = "write a mesh of gmsh (meshio: `file_format=\"gmsh\"`)";
                    return Err(self.cursor.unsupported(start, what, help));
                }
                _ => return Err(self.cursor.syntax(start, "$MeshFormat", quoted(word))),
            }
        }
        let c = &mut self.cursor;
        let (version, start) = c.word("the format's version, 4.1 or 2.2")?;
        self.version = match version {
            b"4.1" => Version::Four,
            b"2" | b"2.0" | b"2.1" | b"2.2" => Version::Two,
            _ => {
                let number = std::str::from_utf8(version).ok();
                if number.and_then(|v| v.parse::<f64>().ok()).is_none() {
                    let expected = "the format's version, 4.1 or 2.2";
                    return Err(c.syntax(start, expected, quoted(version)));
                }
                let version = shorten(&String::from_utf8_lossy(version));
                return Err(c.unsupported(start, format!("gmsh format version {version}"), EXPORT));
            }
        };
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

    /// The type with a number.
    fn kind(&self, at: usize, number: i32) -> Result<&'static ElementType, MeshError> {
        let kind = TYPES.iter().find(|t| t.number == number);
        kind.ok_or_else(|| {
            let what = format!("gmsh element type {number}");
            self.cursor.unsupported(at, what, HEXAHEDRA)
        })
    }

    /// Whether a solid can be made of these elements beside those before; if not, that is kept for whoever wants a solid.
    fn solid(&mut self, at: usize, kind: &'static ElementType) {
        let c = &self.cursor;
        let order = |kind: &ElementType| kind.nodes > 8;
        let first = *self.solids.get_or_insert(kind);
        let refused = if !kind.used {
            let what = format!("a mesh of {} (gmsh type {})", kind.name, kind.number);
            c.unsupported(at, what, HEXAHEDRA)
        } else if order(first) != order(kind) {
            let what = format!("a mesh of both {} and {}", first.name, kind.name);
            let help = "give all volumes the same `Mesh.ElementOrder`";
            c.unsupported(at, what, help)
        } else {
            return;
        };
        self.raw.refused.get_or_insert(refused);
    }

    /// Elements and sets from what was read.
    fn finish(mut self) -> Result<RawMesh, MeshError> {
        self.raw.found = (self.counts.iter())
            .map(|(name, n)| format!("{n} {name}"))
            .collect();
        self.raw.help = EXTRUDE;
        let raw = &mut self.raw;
        for block in &mut self.blocks {
            let elements = block.nodes.chunks_exact(block.kind.nodes).zip(&block.tags);
            match block.dim {
                2 => {
                    block.first = raw.facets.len() as u32;
                    for (e, &tag) in elements {
                        raw.facets.push(e, tag);
                    }
                }
                3 if raw.refused.is_none() => {
                    block.first = raw.hexahedra.len() as u32;
                    for (e, &tag) in elements {
                        raw.hexahedra.push(TENSOR.map(|a| e[a]));
                        if e.len() > 8 {
                            let node = |a: usize| e.get(a).copied().unwrap_or(NONE);
                            raw.quadratic.push(TENSOR_27.map(node));
                        }
                        raw.element_tags.push(tag);
                    }
                }
                _ => {}
            }
        }
        if !self.skipped.is_empty() {
            let list = self.skipped.join(", ");
            self.raw.notes.push(format!("sections left out: {list}"));
        }
        self.groups
            .sets(&self.blocks, &mut self.raw, self.cursor.path)?;
        Ok(self.raw)
    }
}
