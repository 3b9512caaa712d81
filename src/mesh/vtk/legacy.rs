//! Legacy files: keywords and arrays one after the other, numbers as text or big-endian.
use super::grid::Grid;
use super::values::{Type, Values};
use crate::mesh::MeshError;
use crate::mesh::cursor::{Cursor, Encoding, quoted};
use crate::mesh::raw::RawMesh;
use covact_geometry::Vec3;
use std::path::Path;

/// Everything of use in a legacy file.
pub(in crate::mesh) fn parse(bytes: &[u8], path: &Path) -> Result<RawMesh, MeshError> {
    let mut c = Cursor {
        path,
        bytes,
        pos: 0,
        encoding: Encoding::Text,
    };
    let first = c.rest_of_line();
    if !first.starts_with(b"# vtk DataFile Version") {
        return Err(c.syntax(0, "`# vtk DataFile Version`", quoted(first)));
    }
    // The title.
    c.rest_of_line();
    let (word, start) = c.word("ASCII or BINARY")?;
    let numbers = match word.to_ascii_uppercase().as_slice() {
        b"ASCII" => Encoding::Text,
        b"BINARY" => Encoding::Binary { swap: true },
        _ => return Err(c.syntax(start, "ASCII or BINARY", quoted(word))),
    };
    let mut reader = Reader {
        c,
        numbers,
        grid: Grid::default(),
        polygons: false,
        on: None,
        cells: 0,
    };
    reader.dataset()?;
    while !reader.c.at_end() {
        reader.section()?;
    }
    let at = reader.c.position(reader.cells);
    let Reader {
        mut grid, polygons, ..
    } = reader;
    if polygons {
        grid.types = vec![7; grid.ends.len()];
    }
    grid.into_raw(path, at)
}

struct Reader<'a> {
    c: Cursor<'a>,
    /// How numbers of arrays are written.
    numbers: Encoding,
    grid: Grid,
    /// The cells are the polygons of a surface.
    polygons: bool,
    /// What arrays belong to: points or cells, and how many there are.
    on: Option<(bool, usize)>,
    /// Where the cells begin.
    cells: usize,
}

impl Reader<'_> {
    fn dataset(&mut self) -> Result<(), MeshError> {
        let (word, start) = self.c.word("DATASET")?;
        if !word.eq_ignore_ascii_case(b"DATASET") {
            return Err(self.c.syntax(start, "DATASET", quoted(word)));
        }
        let (word, start) = self.c.word("UNSTRUCTURED_GRID or POLYDATA")?;
        match word.to_ascii_uppercase().as_slice() {
            b"UNSTRUCTURED_GRID" => {}
            b"POLYDATA" => self.polygons = true,
            _ => {
                let what = format!("the dataset {}", quoted(word));
                let help = "meshes are UNSTRUCTURED_GRID or POLYDATA";
                return Err(self.c.unsupported(start, what, help));
            }
        }
        Ok(())
    }

    fn section(&mut self) -> Result<(), MeshError> {
        const EXPECTED: &str = "POINTS, CELLS, CELL_TYPES, POLYGONS, CELL_DATA or POINT_DATA";
        let (word, start) = self.c.word(EXPECTED)?;
        let word = word.to_ascii_uppercase();
        match word.as_slice() {
            b"POINTS" => {
                let count = self.c.text_number("a number of points")?;
                let kind = self.kind()?;
                let count = 3usize.saturating_mul(count);
                let values = self.values(kind, count, "a coordinate")?.real();
                let points = values.chunks_exact(3).map(|x| Vec3::new(x[0], x[1], x[2]));
                self.grid.points = points.collect();
            }
            b"CELLS" | b"POLYGONS" => self.cells(start)?,
            b"VERTICES" | b"LINES" | b"TRIANGLE_STRIPS" if self.polygons => {
                let grid = std::mem::take(&mut self.grid);
                self.cells(start)?;
                self.grid = grid;
            }
            b"CELL_TYPES" => {
                let count = self.c.text_number("a number of cell types")?;
                let int = Type::Whole {
                    bytes: 4,
                    signed: true,
                };
                let values = self.values(int, count, "a cell type")?;
                self.grid.types = values.whole().unwrap_or_default();
            }
            b"CELL_DATA" => self.on = Some((false, self.c.text_number("a number of cells")?)),
            b"POINT_DATA" => self.on = Some((true, self.c.text_number("a number of points")?)),
            b"METADATA" => self.metadata(),
            b"FIELD" => self.field()?,
            _ => return self.attribute(&word, start),
        }
        Ok(())
    }

    fn kind(&mut self) -> Result<Type, MeshError> {
        let (word, start) = self.c.word("the type of numbers")?;
        let kind = std::str::from_utf8(word).ok().and_then(Type::of);
        kind.ok_or_else(|| {
            self.c
                .syntax(start, "a type such as double or int", quoted(word))
        })
    }

    /// An array that begins in the next line.
    fn values(&mut self, kind: Type, count: usize, what: &str) -> Result<Values, MeshError> {
        if self.numbers != Encoding::Text {
            self.c.rest_of_line();
        }
        self.c.encoding = self.numbers;
        let values = Values::read(&mut self.c, kind, count, what);
        self.c.encoding = Encoding::Text;
        values
    }

    /// Cells: each with its number of points in front, or, since version 5, ends and points apart.
    fn cells(&mut self, start: usize) -> Result<(), MeshError> {
        self.cells = start;
        let count: usize = self.c.text_number("a number of cells")?;
        let size: usize = self.c.text_number("a number of points")?;
        let before = self.c.pos;
        let (word, _) = match size {
            0 => (&b""[..], 0),
            _ => self.c.word("OFFSETS or points")?,
        };
        if word.eq_ignore_ascii_case(b"OFFSETS") {
            let kind = self.kind()?;
            let offsets = self.values(kind, count, "an offset")?;
            let mut ends = offsets.whole().unwrap_or_default();
            let (word, start) = self.c.word("CONNECTIVITY")?;
            if !word.eq_ignore_ascii_case(b"CONNECTIVITY") {
                return Err(self.c.syntax(start, "CONNECTIVITY", quoted(word)));
            }
            let kind = self.kind()?;
            let points = self.values(kind, size, "a point")?;
            self.grid.connectivity = points.whole().unwrap_or_default();
            // The first offset is the start of the first cell.
            if !ends.is_empty() {
                ends.remove(0);
            }
            self.grid.ends = ends;
            return Ok(());
        }
        self.c.pos = before;
        let int = Type::Whole {
            bytes: 4,
            signed: true,
        };
        let all = self.values(int, size, "a point of a cell")?;
        let all = all.whole().unwrap_or_default();
        let mut rest = all.as_slice();
        for cell in 0..count {
            let points = rest.split_first().and_then(|(&n, after)| {
                let n = usize::try_from(n).ok()?;
                (n <= after.len()).then(|| after.split_at(n))
            });
            let Some((points, after)) = points else {
                let expected = format!("{count} cells in {size} numbers");
                return Err(self.c.syntax(start, &expected, format!("{cell} cells")));
            };
            self.grid.connectivity.extend(points);
            self.grid.ends.push(self.grid.connectivity.len() as i64);
            rest = after;
        }
        Ok(())
    }

    /// Lines up to an empty one.
    fn metadata(&mut self) {
        self.c.rest_of_line();
        while self.c.pos < self.c.bytes.len() && !self.c.rest_of_line().trim_ascii().is_empty() {}
    }

    /// An array of points or cells: whole numbers, one for each, are kept.
    fn array(
        &mut self,
        name: String,
        kind: Type,
        count: usize,
        components: usize,
    ) -> Result<(), MeshError> {
        const WHAT: &str = "a value of an array";
        let count = count.saturating_mul(components);
        if components == 1 && matches!(kind, Type::Whole { .. }) {
            let values = self.values(kind, count, WHAT)?.whole().unwrap_or_default();
            match self.on {
                Some((true, _)) => self.grid.point_arrays.push((name, values)),
                Some((false, _)) => self.grid.cell_arrays.push((name, values)),
                None => {}
            }
            return Ok(());
        }
        if self.numbers != Encoding::Text {
            self.c.rest_of_line();
        }
        self.c.encoding = self.numbers;
        let skipped = Values::skip(&mut self.c, kind, count, WHAT);
        self.c.encoding = Encoding::Text;
        skipped
    }

    fn name(&mut self) -> Result<String, MeshError> {
        let (name, start) = self.c.word("the name of an array")?;
        if name.len() > crate::mesh::error::MOST_IN_NAME {
            return Err(self.c.syntax(start, "a shorter name", quoted(name)));
        }
        Ok(String::from_utf8_lossy(name).into_owned())
    }

    /// `FIELD name n`, then n arrays.
    fn field(&mut self) -> Result<(), MeshError> {
        self.name()?;
        let count: usize = self.c.text_number("a number of arrays")?;
        for _ in 0..count {
            let mut name = self.name()?;
            if name == "METADATA" {
                self.metadata();
                name = self.name()?;
            }
            let components: usize = self.c.text_number("a number of components")?;
            let tuples: usize = self.c.text_number("a number of tuples")?;
            let kind = self.kind()?;
            self.array(name, kind, tuples, components)?;
        }
        Ok(())
    }

    /// SCALARS, VECTORS and the like.
    fn attribute(&mut self, word: &[u8], start: usize) -> Result<(), MeshError> {
        let Some((_, count)) = self.on else {
            let expected = "POINTS, CELLS, CELL_TYPES, POLYGONS, CELL_DATA or POINT_DATA";
            return Err(self.c.syntax(start, expected, quoted(word)));
        };
        let mut components = match word {
            b"SCALARS" => 1,
            b"VECTORS" | b"NORMALS" => 3,
            b"TENSORS" => 9,
            _ => {
                let what = format!("the attribute {}", quoted(word));
                let help = "write SCALARS, VECTORS, NORMALS, TENSORS or FIELD";
                return Err(self.c.unsupported(start, what, help));
            }
        };
        let name = self.name()?;
        let kind = self.kind()?;
        if word == b"SCALARS" {
            // A number of components may follow, then the name of a table of colours.
            let line = std::str::from_utf8(self.c.rest_of_line()).unwrap_or_default();
            components = line.trim().parse().unwrap_or(components);
            let (table, start) = self.c.word("LOOKUP_TABLE")?;
            if !table.eq_ignore_ascii_case(b"LOOKUP_TABLE") {
                return Err(self.c.syntax(start, "LOOKUP_TABLE", quoted(table)));
            }
            self.name()?;
        }
        self.array(name, kind, count, components)
    }
}
