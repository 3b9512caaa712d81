//! XML files with an unstructured grid: arrays as text, in base64, or appended behind the tree.
use super::grid::Grid;
use super::values::{Type, Values};
use crate::machine::memory;
use crate::mesh::cursor::{Cursor, Encoding};
use crate::mesh::error::{MAX_NODES, MOST_IN_NAME, shorten};
use crate::mesh::raw::RawMesh;
use crate::mesh::{MeshError, Position};
use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use covact_geometry::Vec3;
use flate2::bufread::ZlibDecoder;
use quick_xml::Reader;
use quick_xml::events::{BytesStart, Event};
use std::io::Read;
use std::path::Path;

/// Everything of use in an XML file.
pub(in crate::mesh) fn parse(bytes: &[u8], path: &Path) -> Result<RawMesh, MeshError> {
    let mut file = File {
        path,
        bytes,
        header: 4,
        swap: false,
        zlib: false,
        arrays: Vec::new(),
        appended: None,
        pieces: Vec::new(),
    };
    file.tree()?;
    let mut grid = Grid::default();
    for piece in 0..file.pieces.len() {
        file.piece(piece, &mut grid)?;
    }
    grid.into_raw(path, Position::Text { line: 1, column: 1 })
}

/// Where an array belongs.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Section {
    Points,
    Cells,
    PointData,
    CellData,
}

/// An array as it stands in the file.
struct Array<'a> {
    section: Section,
    piece: usize,
    name: String,
    kind: Type,
    components: usize,
    /// Text, base64, or the offset of appended data.
    data: Data<'a>,
    /// Where it begins.
    at: usize,
}

enum Data<'a> {
    Text(&'a [u8]),
    Base64(&'a [u8]),
    Appended(usize),
}

struct File<'a> {
    path: &'a Path,
    bytes: &'a [u8],
    /// Bytes of the numbers in front of binary data.
    header: usize,
    /// Binary data are big-endian.
    swap: bool,
    zlib: bool,
    arrays: Vec<Array<'a>>,
    /// Appended data after their underscore, and whether they are raw.
    appended: Option<(&'a [u8], bool)>,
    /// Points and cells of every piece, and where it begins.
    pieces: Vec<([usize; 2], usize)>,
}

impl<'a> File<'a> {
    fn syntax(&self, at: usize, expected: &str, found: impl Into<String>) -> MeshError {
        self.cursor(at).syntax(at, expected, found)
    }

    /// For positions in the text.
    fn cursor(&self, pos: usize) -> Cursor<'a> {
        Cursor {
            path: self.path,
            bytes: self.bytes,
            pos,
            encoding: Encoding::Text,
        }
    }

    fn unsupported(&self, at: usize, what: String, help: &str) -> MeshError {
        self.cursor(at).unsupported(at, what, help)
    }

    /// Reads the tree; the arrays stay as they are.
    fn tree(&mut self) -> Result<(), MeshError> {
        let mut reader = Reader::from_reader(self.bytes);
        let mut section = None;
        let mut known = false;
        loop {
            let at = reader.buffer_position() as usize;
            let event = match reader.read_event() {
                Ok(event) => event,
                Err(e) => {
                    let at = reader.error_position() as usize;
                    return Err(self.syntax(at, "XML", shorten(&e.to_string())));
                }
            };
            match event {
                Event::Eof => break,
                Event::Start(tag) | Event::Empty(tag) => match tag.name().as_ref() {
                    b"VTKFile" => {
                        self.root(&tag, at)?;
                        known = true;
                    }
                    b"Piece" => {
                        let count = |name| self.number(&tag, name, at);
                        let counts = [count("NumberOfPoints")?, count("NumberOfCells")?];
                        self.pieces.push((counts, at));
                    }
                    b"Points" => section = Some(Section::Points),
                    b"Cells" => section = Some(Section::Cells),
                    b"PointData" => section = Some(Section::PointData),
                    b"CellData" => section = Some(Section::CellData),
                    b"FieldData" => section = None,
                    b"DataArray" => {
                        if let Some(section) = section {
                            let from = reader.buffer_position() as usize;
                            self.array(&tag, section, at, from)?;
                        }
                    }
                    b"AppendedData" => {
                        let raw = attribute(&tag, "encoding").as_deref() == Some("raw");
                        let from = (reader.buffer_position() as usize).min(self.bytes.len());
                        let rest = &self.bytes[from..];
                        let Some(start) = rest.iter().position(|b| *b == b'_') else {
                            return Err(self.syntax(from, "`_` before appended data", "none"));
                        };
                        self.appended = Some((&rest[start + 1..], raw));
                        // What follows may be no text.
                        break;
                    }
                    _ => {}
                },
                _ => {}
            }
        }
        match known && !self.pieces.is_empty() {
            true => Ok(()),
            false => {
                let found = "no such element";
                Err(self.syntax(
                    0,
                    "a <VTKFile> with a <Piece> of an UnstructuredGrid",
                    found,
                ))
            }
        }
    }

    fn root(&mut self, tag: &BytesStart, at: usize) -> Result<(), MeshError> {
        let kind = attribute(tag, "type").unwrap_or_default();
        if kind != "UnstructuredGrid" {
            let what = format!("VTK data of the type `{}`", shorten(&kind));
            return Err(self.unsupported(at, what, "meshes are of the type UnstructuredGrid"));
        }
        self.swap = attribute(tag, "byte_order").as_deref() == Some("BigEndian");
        if attribute(tag, "header_type").as_deref() == Some("UInt64") {
            self.header = 8;
        }
        match attribute(tag, "compressor").as_deref() {
            None | Some("") => {}
            Some("vtkZLibDataCompressor") => self.zlib = true,
            Some(other) => {
                let what = format!("the compressor `{}`", shorten(other));
                return Err(self.unsupported(at, what, "write with zlib or without compression"));
            }
        }
        Ok(())
    }

    fn number(&self, tag: &BytesStart, name: &str, at: usize) -> Result<usize, MeshError> {
        let text = attribute(tag, name).unwrap_or_default();
        match text.trim().parse::<usize>() {
            Ok(n) if (n as u64) < 8 * MAX_NODES => Ok(n),
            _ => Err(self.syntax(at, &format!("a number as {name}"), shorten(&text))),
        }
    }

    fn array(
        &mut self,
        tag: &BytesStart,
        section: Section,
        at: usize,
        from: usize,
    ) -> Result<(), MeshError> {
        let text = |name: &str| attribute(tag, name).unwrap_or_default();
        let name = text("Name");
        let Some(kind) = Type::of(&text("type")).filter(|_| name.len() <= MOST_IN_NAME) else {
            // Texts and bits are of no use here.
            return match section {
                Section::Points | Section::Cells => Err(self.syntax(
                    at,
                    "a type such as Float64 or Int64",
                    shorten(&text("type")),
                )),
                _ => Ok(()),
            };
        };
        let components = match text("NumberOfComponents").as_str() {
            "" => 1,
            _ => self.number(tag, "NumberOfComponents", at)?,
        };
        let rest = self.bytes.get(from..).unwrap_or_default();
        let inside = &rest[..rest.iter().position(|b| *b == b'<').unwrap_or(rest.len())];
        let data = match text("format").as_str() {
            "ascii" => Data::Text(inside),
            "binary" => Data::Base64(inside),
            "appended" => Data::Appended(self.number(tag, "offset", at)?),
            other => {
                return Err(self.syntax(at, "format ascii, binary or appended", shorten(other)));
            }
        };
        self.arrays.push(Array {
            section,
            piece: self.pieces.len().max(1) - 1,
            name,
            kind,
            components,
            at: match data {
                Data::Text(_) => from,
                _ => at,
            },
            data,
        });
        Ok(())
    }

    /// Adds a piece to the grid.
    fn piece(&self, piece: usize, grid: &mut Grid) -> Result<(), MeshError> {
        let ([points, cells], at) = self.pieces[piece];
        let of = |section, name: &str| {
            let found = (self.arrays.iter()).find(|a| {
                a.piece == piece && a.section == section && (name.is_empty() || a.name == name)
            });
            found.ok_or_else(|| self.syntax(at, &format!("an array `{name}`"), "none"))
        };
        let first = grid.points.len() as i64;
        let before = grid.connectivity.len() as i64;
        let coordinates = self
            .values(of(Section::Points, "")?, Some(3 * points))?
            .real();
        let all = coordinates.chunks_exact(3);
        grid.points.extend(all.map(|x| Vec3::new(x[0], x[1], x[2])));
        if let Some(k) = coordinates.iter().position(|x| !x.is_finite()) {
            let at = of(Section::Points, "")?.at;
            return Err(self.syntax(at, "finite coordinates", format!("point {}", k / 3)));
        }
        let whole = |name: &str, count| -> Result<Vec<i64>, MeshError> {
            let array = of(Section::Cells, name)?;
            let values = self.values(array, count)?.whole();
            values.ok_or_else(|| self.syntax(array.at, "whole numbers", "reals"))
        };
        let ends = whole("offsets", Some(cells))?;
        let last = ends.last().copied().unwrap_or(0);
        let count = usize::try_from(last).unwrap_or(0);
        let connectivity = whole("connectivity", Some(count))?;
        grid.types.extend(whole("types", Some(cells))?);
        grid.ends
            .extend(ends.into_iter().map(|e| e.saturating_add(before)));
        (grid.connectivity).extend(connectivity.into_iter().map(|p| p.saturating_add(first)));
        for array in self
            .arrays
            .iter()
            .filter(|a| a.piece == piece && a.components == 1)
        {
            let (count, all, arrays) = match array.section {
                Section::PointData => (points, grid.points.len(), &mut grid.point_arrays),
                Section::CellData => (cells, grid.ends.len(), &mut grid.cell_arrays),
                _ => continue,
            };
            if !matches!(array.kind, Type::Whole { .. }) {
                continue;
            }
            let values = self.values(array, Some(count))?.whole().unwrap_or_default();
            let place = arrays.iter().position(|(name, _)| *name == array.name);
            let place = place.unwrap_or_else(|| {
                arrays.push((array.name.clone(), Vec::new()));
                arrays.len() - 1
            });
            // Pieces without this array have no members.
            let kept = &mut arrays[place].1;
            kept.resize(all - count, -1);
            kept.extend(values);
        }
        Ok(())
    }

    /// The numbers of an array.
    fn values(&self, array: &Array, count: Option<usize>) -> Result<Values, MeshError> {
        let count = count.unwrap_or(0);
        let what = format!("{count} numbers of the array `{}`", shorten(&array.name));
        if let Data::Text(text) = array.data {
            let mut c = self.cursor(array.at);
            c.bytes = &self.bytes[..array.at + text.len()];
            return Values::read(&mut c, array.kind, count, &what);
        }
        let needed = count.saturating_mul(array.kind.bytes());
        let bytes = self.binary(array, needed)?;
        let mut c = Cursor {
            path: self.path,
            bytes: &bytes,
            pos: 0,
            encoding: Encoding::Binary { swap: self.swap },
        };
        let fail = |found: String| self.syntax(array.at, &what, found);
        if bytes.len() < needed {
            return Err(fail(format!("{} bytes", bytes.len())));
        }
        Values::read(&mut c, array.kind, count, &what)
            .map_err(|_| fail("a number out of range".into()))
    }

    /// The bytes of a binary array, at most `needed`.
    fn binary(&self, array: &Array, needed: usize) -> Result<Vec<u8>, MeshError> {
        let fail = |found: &str| self.syntax(array.at, "base64 data with their length", found);
        memory::ask(needed as u64).map_err(|shortage| MeshError::Memory {
            what: "an array of a file",
            nodes: needed as u64,
            shortage,
        })?;
        let (data, raw) = match array.data {
            Data::Base64(text) => (text.trim_ascii(), false),
            Data::Appended(offset) => {
                let Some((data, raw)) = self.appended else {
                    return Err(self.syntax(array.at, "appended data", "none in this file"));
                };
                let data = data
                    .get(offset..)
                    .ok_or_else(|| fail("the end of the file"))?;
                (data, raw)
            }
            Data::Text(_) => return Ok(Vec::new()),
        };
        // The first `n` bytes, and where the next ones begin: base64 ends after each group of them.
        let take = |data: &[u8], n: usize| -> Result<(Vec<u8>, usize), MeshError> {
            if raw {
                let bytes = data.get(..n).ok_or_else(|| fail("the end of the file"))?;
                return Ok((bytes.to_vec(), n));
            }
            let length = n.div_ceil(3) * 4;
            let text = data
                .get(..length)
                .ok_or_else(|| fail("the end of the data"))?;
            let mut bytes = STANDARD.decode(text).map_err(|e| fail(&e.to_string()))?;
            bytes.truncate(n);
            Ok((bytes, length))
        };
        let h = self.header;
        let number = |bytes: &[u8], k: usize| -> usize {
            let field = bytes.get(k * h..(k + 1) * h).unwrap_or_default();
            let order = |i: usize| if self.swap { h - 1 - i } else { i };
            (0..field.len()).fold(0, |n, i| n | usize::from(field[order(i)]) << (8 * i))
        };
        let head = take(data, h)?.0;
        if !self.zlib {
            let length = number(&head, 0);
            let all = h
                .checked_add(length.min(needed))
                .ok_or_else(|| fail("a length too large"))?;
            let mut bytes = take(data, all)?.0;
            bytes.drain(..h);
            return Ok(bytes);
        }
        let blocks = number(&head, 0);
        let most = data.len() / h;
        if blocks > most {
            return Err(fail(&format!("{blocks} blocks")));
        }
        let (head, mut at) = take(data, (3 + blocks) * h)?;
        let mut out = Vec::with_capacity(needed);
        let sizes: Vec<usize> = (0..blocks).map(|k| number(&head, 3 + k)).collect();
        let total = sizes.iter().fold(0usize, |sum, n| sum.saturating_add(*n));
        if total > data.len() {
            return Err(fail(&format!("{total} bytes of blocks")));
        }
        // All blocks are one piece of base64.
        let (packed, _) = take(&data[at..], total)?;
        at = 0;
        for size in sizes {
            let left = needed - out.len();
            let block = ZlibDecoder::new(&packed[at..at + size]);
            let read = block.take(left as u64).read_to_end(&mut out);
            read.map_err(|e| fail(&e.to_string()))?;
            at += size;
        }
        Ok(out)
    }
}

/// An attribute of an element.
fn attribute(tag: &BytesStart, name: &str) -> Option<String> {
    let attribute = tag.try_get_attribute(name).ok()??;
    let value = attribute.unescape_value().ok()?;
    Some(value.into_owned())
}
