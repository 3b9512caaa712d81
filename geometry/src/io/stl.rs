//! STL files, ASCII and binary: triangles without connections, units or names.
//!
//! Which of the two a file is cannot be told from its first word, because the header of a binary file may begin with
//! "solid" as well. A file whose length is exactly what the triangle count at byte 80 asks for is binary; else one that begins
//! with "solid" is ASCII; else it is taken for a damaged binary file.

mod connect;

use connect::connect;
use std::collections::HashMap;

use super::error::show;
use crate::facet::FacetMesh;
use crate::surface::Vec3;

/// Bytes before the triangles of a binary file: a header of 80 and the count.
const HEADER: usize = 84;
/// Bytes of a triangle: twelve numbers of four bytes and an attribute of two.
const RECORD: usize = 50;

/// Why an STL file could not be read.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum StlError {
    /// The operating system refused.
    #[error("{path}: cannot be read: {source}")]
    Read {
        /// The path.
        path: String,
        /// What it said.
        #[source]
        source: std::io::Error,
    },
    /// An ASCII file is damaged.
    #[error("{path}:{line}: expected {expected}, found {found}")]
    Line {
        /// Name of the file.
        path: String,
        /// Line, from 1.
        line: usize,
        /// What should stand there.
        expected: &'static str,
        /// What stands there.
        found: String,
    },
    /// A binary file is damaged.
    #[error("{path}: at byte {byte}: {reason}")]
    Byte {
        /// Name of the file.
        path: String,
        /// Byte, from 0.
        byte: usize,
        /// What is wrong.
        reason: String,
    },
    /// No triangle, or none that has an area.
    #[error("{path}: no triangle with an area among {triangles}")]
    Empty {
        /// Name of the file.
        path: String,
        /// Triangles in the file.
        triangles: usize,
    },
    /// More than 2^32 / 6 triangles.
    #[error("{path}: too many triangles: {triangles}")]
    TooLarge {
        /// Name of the file.
        path: String,
        /// Triangles in the file.
        triangles: usize,
    },
    /// The distance for merging is negative or not finite.
    #[error("the distance {0} for merging vertices is not a length")]
    Tolerance(f64),
}

/// What an STL file holds and what was made of it.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct StlReport {
    /// Whether the file is a binary one.
    pub binary: bool,
    /// Triangles in the file.
    pub triangles: usize,
    /// Vertices in the file (three per triangle) that became a node which was there before.
    pub merged: usize,
    /// The distance below which vertices became one node.
    pub tolerance: f64,
    /// Triangles left out because they have no area (numbers in the file, from 0): two of the nodes are the same, or the
    /// height is below the tolerance.
    pub degenerate: Vec<usize>,
    /// Edges that two neighbours run through in the same sense: one of the two is turned the wrong way.
    pub flipped: usize,
    /// Edges of one triangle only.
    pub free: usize,
    /// Edges of more than two triangles.
    pub branching: usize,
    /// Triangles whose normal in the file points to the other side than their vertices say (the vertices count).
    pub normals_against: usize,
}

/// Triangles of an STL file. The file states no unit of length.
#[derive(Debug, Clone, PartialEq)]
pub struct Stl {
    /// Merged vertices.
    pub nodes: Vec<Vec3>,
    /// Nodes of the triangles, counter-clockwise seen from outside.
    pub triangles: Vec<[u32; 3]>,
    /// Number in the file (from 0) of every triangle.
    pub numbers: Vec<u32>,
    /// The account.
    pub report: StlReport,
}

/// A triangle of the file: its normal and vertices.
type Record = [Vec3; 4];

/// Reads an STL file.
///
/// Vertices no farther apart than `merge` (a length; zero: equal ones) become one node. `None` takes what single precision
/// leaves of equal points: 2^-21 (four units in the last place) of the largest coordinate.
///
/// # Errors
/// See [`StlError`].
pub fn read_stl_path(path: &std::path::Path, merge: Option<f64>) -> Result<Stl, StlError> {
    let name = path.display().to_string();
    match super::read_whole(path) {
        Ok(bytes) => read_stl(&bytes, &name, merge),
        Err(source) => Err(StlError::Read { path: name, source }),
    }
}

/// Reads the content of an STL file; `name` is for messages. See [`read_stl_path`].
///
/// # Errors
/// See [`StlError`].
pub fn read_stl(bytes: &[u8], name: &str, merge: Option<f64>) -> Result<Stl, StlError> {
    if let Some(merge) = merge
        && !(merge.is_finite() && merge >= 0.0)
    {
        return Err(StlError::Tolerance(merge));
    }
    let binary = is_binary(bytes);
    let records = if binary {
        read_binary(bytes, name)?
    } else {
        read_ascii(bytes, name)?
    };
    connect(&records, binary, name, merge)
}

/// Triangles that the count of a binary file states, and where the triangles end.
fn stated(bytes: &[u8]) -> Option<(usize, usize)> {
    let count = bytes.get(80..HEADER)?;
    let count = u32::from_le_bytes([count[0], count[1], count[2], count[3]]) as usize;
    Some((count, count.checked_mul(RECORD)?.checked_add(HEADER)?))
}

fn is_binary(bytes: &[u8]) -> bool {
    let text = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes);
    let solid = text
        .trim_ascii_start()
        .get(..5)
        .is_some_and(|w| w.eq_ignore_ascii_case(b"solid"));
    match stated(bytes) {
        Some((_, end)) if end == bytes.len() => true,
        // Some writers append a few bytes; no text has a zero byte.
        Some((_, end)) if end < bytes.len() && bytes.contains(&0) => true,
        _ => !solid,
    }
}

fn read_binary(bytes: &[u8], path: &str) -> Result<Vec<Record>, StlError> {
    let fail = |byte, reason| StlError::Byte {
        path: path.to_owned(),
        byte,
        reason,
    };
    let Some((count, end)) = stated(bytes) else {
        let reason = format!("the file ends within the header of {HEADER} bytes");
        return Err(fail(bytes.len(), reason));
    };
    if end > bytes.len() {
        let whole = (bytes.len() - HEADER) / RECORD;
        let reason = format!("the file ends after {whole} of {count} triangles");
        return Err(fail(bytes.len(), reason));
    }
    let mut records = Vec::with_capacity(count);
    for (k, record) in bytes[HEADER..end].chunks_exact(RECORD).enumerate() {
        let number = |i: usize| {
            let b = &record[4 * i..4 * i + 4];
            f64::from(f32::from_le_bytes([b[0], b[1], b[2], b[3]]))
        };
        let vector = |i: usize| Vec3::new(number(3 * i), number(3 * i + 1), number(3 * i + 2));
        let triangle = [vector(0), vector(1), vector(2), vector(3)];
        if let Some(i) = (3..12).find(|&i| !number(i).is_finite()) {
            let byte = HEADER + RECORD * k + 4 * i;
            return Err(fail(
                byte,
                format!("triangle {k}: {} is no coordinate", number(i)),
            ));
        }
        records.push(triangle);
    }
    Ok(records)
}

fn read_ascii(bytes: &[u8], path: &str) -> Result<Vec<Record>, StlError> {
    let mut words = Words {
        lines: bytes.split(|&b| b == b'\n').enumerate(),
        line: 0,
        rest: &[],
        path,
    };
    let mut records = Vec::new();
    words.rest_of_line_after(b"solid")?;
    loop {
        match words.next() {
            // The end is said, so that half a file is not taken for a whole one.
            None => return Err(words.fail("\"facet\" or \"endsolid\"", b"")),
            Some(word) if word.eq_ignore_ascii_case(b"endsolid") => {
                words.skip_line();
                // Several solids may follow each other.
                match words.next() {
                    None => return Ok(records),
                    Some(word) if word.eq_ignore_ascii_case(b"solid") => words.skip_line(),
                    Some(word) => return Err(words.fail("\"solid\" or the end", word)),
                }
            }
            Some(word) if word.eq_ignore_ascii_case(b"facet") => {
                words.take(b"normal", "\"normal\"")?;
                let normal = words.vector(true)?;
                words.take(b"outer", "\"outer loop\"")?;
                words.take(b"loop", "\"outer loop\"")?;
                let mut triangle = [normal; 4];
                for vertex in &mut triangle[1..] {
                    words.take(b"vertex", "\"vertex\" (a facet has three)")?;
                    *vertex = words.vector(false)?;
                }
                words.take(b"endloop", "\"endloop\" (a facet has three vertices)")?;
                words.take(b"endfacet", "\"endfacet\"")?;
                records.push(triangle);
            }
            Some(word) => return Err(words.fail("\"facet\" or \"endsolid\"", word)),
        }
    }
}

/// Words of a text with their lines.
struct Words<'a, I> {
    lines: I,
    line: usize,
    rest: &'a [u8],
    path: &'a str,
}

impl<'a, I: Iterator<Item = (usize, &'a [u8])>> Words<'a, I> {
    fn next(&mut self) -> Option<&'a [u8]> {
        loop {
            let start = self.rest.trim_ascii_start();
            if !start.is_empty() {
                let end = start
                    .iter()
                    .position(|b| b.is_ascii_whitespace())
                    .unwrap_or(start.len());
                let (word, rest) = start.split_at(end);
                self.rest = rest;
                return Some(word);
            }
            let (line, text) = self.lines.next()?;
            self.line = line + 1;
            self.rest = text;
        }
    }

    fn skip_line(&mut self) {
        self.rest = &[];
    }

    fn rest_of_line_after(&mut self, word: &[u8]) -> Result<(), StlError> {
        let found = self.next().unwrap_or(b"");
        let found = found.strip_prefix(b"\xef\xbb\xbf").unwrap_or(found);
        if !found.eq_ignore_ascii_case(word) {
            return Err(self.fail("\"solid\"", found));
        }
        self.skip_line();
        Ok(())
    }

    fn take(&mut self, word: &[u8], expected: &'static str) -> Result<(), StlError> {
        let found = self.next().unwrap_or(b"");
        if found.eq_ignore_ascii_case(word) {
            Ok(())
        } else {
            Err(self.fail(expected, found))
        }
    }

    /// Three numbers; those of a normal need not be finite (writers divide by the area).
    fn vector(&mut self, any: bool) -> Result<Vec3, StlError> {
        let mut out = Vec3::zeros();
        for x in out.iter_mut() {
            let word = self.next().unwrap_or(b"");
            let number = std::str::from_utf8(word).ok().and_then(|w| w.parse().ok());
            match number {
                Some(value) if any || f64::is_finite(value) => *x = value,
                _ => return Err(self.fail("a number", word)),
            }
        }
        Ok(out)
    }

    fn fail(&self, expected: &'static str, found: &[u8]) -> StlError {
        StlError::Line {
            path: self.path.to_owned(),
            line: self.line.max(1),
            expected,
            found: show(found),
        }
    }
}

impl Stl {
    /// The triangles as bilinear facets: each is cut from its centroid to the middles of its edges into three plane
    /// quadrilaterals, so that none has a point without tangents. Facets `3 k` to `3 k + 2` are those of triangle `k`, at its
    /// first, second and third node. Neighbours share the middles of their edges.
    pub fn facets(&self) -> FacetMesh<4> {
        let mut nodes = self.nodes.clone();
        let mut middles: HashMap<[u32; 2], u32> = HashMap::new();
        let mut facets = Vec::with_capacity(3 * self.triangles.len());
        for triangle in &self.triangles {
            let [a, b, c] = triangle.map(|n| self.nodes[n as usize]);
            let mut middle = |i: usize| {
                let (p, q) = (triangle[i], triangle[(i + 1) % 3]);
                *middles.entry([p.min(q), p.max(q)]).or_insert_with(|| {
                    nodes.push((self.nodes[p as usize] + self.nodes[q as usize]) * 0.5);
                    nodes.len() as u32 - 1
                })
            };
            let middle = [middle(0), middle(1), middle(2)];
            let centre = nodes.len() as u32;
            nodes.push((a + b + c) / 3.0);
            for i in 0..3 {
                facets.push([triangle[i], middle[i], middle[(i + 2) % 3], centre]);
            }
        }
        FacetMesh { nodes, facets }
    }

    /// The triangles as a binary STL file, see [`write_stl`].
    pub fn to_binary(&self) -> Vec<u8> {
        write_stl(&self.nodes, &self.triangles)
    }
}

/// Triangles as a binary STL file. Coordinates are rounded to single precision; triangles with a node that there is not are
/// left out.
pub fn write_stl(nodes: &[Vec3], triangles: &[[u32; 3]]) -> Vec<u8> {
    let corners = |triangle: &[u32; 3]| {
        let [a, b, c] = triangle.map(|n| nodes.get(n as usize).copied());
        Some([a?, b?, c?])
    };
    let corners: Vec<[Vec3; 3]> = triangles.iter().filter_map(corners).collect();
    let mut out = vec![b' '; 80];
    out.extend((corners.len() as u32).to_le_bytes());
    for [a, b, c] in corners {
        let normal = (b - a).cross(&(c - a));
        let normal = normal.try_normalize(0.0).unwrap_or(normal);
        for x in [normal, a, b, c].iter().flat_map(|v| v.iter()) {
            out.extend((*x as f32).to_le_bytes());
        }
        out.extend([0, 0]);
    }
    out
}
