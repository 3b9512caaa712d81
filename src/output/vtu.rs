//! Unstructured grids in VTK's XML format.
//!
//! The serialiser is vtkio's. What its data model lacks is added to the tags it wrote: names of tensor components, the
//! attributes that make ParaView use rational weights. The ranges it writes are dropped: they would be those of single
//! components where VTK means magnitudes, and NaN where a field has one. Its arrays, inline in base64, are compressed and moved
//! behind the tree (`appended.rs`).
use super::OutputError;
use super::appended::Appended;
use super::packed::COMPRESSOR;
use std::fmt::Write;
use vtkio::model::{
    Attribute, Attributes, ByteOrder, CellType, Cells, DataArray, DataSet, ElementType, IOBuffer,
    UnstructuredGridPiece, Version, VertexNumbers, Vtk,
};

/// Where a field's values sit.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Place {
    /// One value per node.
    Point,
    /// One value per element.
    Cell,
}

/// A named field: `data` holds `components` numbers per node or element, the components of one node together. NaN means
/// "no value here", which ParaView shows in its NaN colour.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Field<'a> {
    /// Name of the array.
    pub name: &'a str,
    /// Numbers per node or element.
    pub components: usize,
    /// Names of the components; empty where numbers will do.
    pub component_names: &'a [&'a str],
    /// The numbers, `components` for each node or element.
    pub data: &'a [f64],
    /// On nodes or on elements.
    pub place: Place,
}

impl<'a> Field<'a> {
    /// A scalar field on the nodes.
    pub fn point(name: &'a str, data: &'a [f64]) -> Self {
        Field {
            name,
            components: 1,
            component_names: &[],
            data,
            place: Place::Point,
        }
    }
}

/// How exactly the fields of a body are written.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Precision {
    /// Displacements to within 1.2e-10 of each number, all else, in single precision, to within 1.5e-5: more than the results of a
    /// mesh are worth, and half the room, since the last digits are what compression cannot shorten.
    #[default]
    Rounded,
    /// All digits, in double precision.
    Full,
}

/// Bits of the fraction that are kept of displacements (error 2^-33 = 1.2e-10) and of other fields (2^-16 = 1.5e-5).
const DISPLACEMENT_BITS: u32 = 32;
const FIELD_BITS: u32 = 15;

impl Precision {
    /// Full where that is asked for.
    pub fn new(full: bool) -> Self {
        match full {
            true => Precision::Full,
            false => Precision::Rounded,
        }
    }

    /// Displacements: strains computed from them lose nothing that Newton's tolerance has not left open, even of bodies that move far.
    pub(crate) fn displacement(self, data: Vec<f64>) -> IOBuffer {
        match self {
            Precision::Rounded => rounded(&data, DISPLACEMENT_BITS).into(),
            Precision::Full => data.into(),
        }
    }

    /// Any other field.
    pub(crate) fn field(self, data: &[f64]) -> IOBuffer {
        match self {
            Precision::Rounded => single(&rounded(data, FIELD_BITS)),
            Precision::Full => data.to_vec().into(),
        }
    }
}

/// One array of a grid. Built with its component names, which vtkio cannot hold.
pub(crate) struct Array {
    pub name: String,
    pub components: u32,
    pub component_names: Vec<String>,
    pub data: IOBuffer,
}

impl Array {
    pub fn new(name: &str, components: u32, data: impl Into<IOBuffer>) -> Self {
        Array {
            name: name.to_string(),
            components,
            component_names: Vec::new(),
            data: data.into(),
        }
    }
}

/// Numbers with `bits` binary digits behind the leading one, each the nearest of them, the even one of two.
fn rounded(data: &[f64], bits: u32) -> Vec<f64> {
    let dropped = f64::MANTISSA_DIGITS - 1 - bits;
    let round = |v: &f64| {
        let digits = v.to_bits();
        let half = (1 << (dropped - 1)) - 1 + (digits >> dropped & 1);
        match v.is_finite() {
            // What is rounded up beyond the last digit goes on in the exponent, which stands in front of it.
            true => f64::from_bits((digits + half) >> dropped << dropped),
            false => *v,
        }
    };
    data.iter().map(round).collect()
}

/// Numbers in single precision, whose digits suffice to look at them and take half the room; in double precision where one
/// is too large.
pub(crate) fn single(data: &[f64]) -> IOBuffer {
    let single: Vec<f32> = data.iter().map(|v| *v as f32).collect();
    let fits = |(v, s): (&f64, &f32)| s.is_finite() || !v.is_finite();
    match data.iter().zip(&single).all(fits) {
        true => single.into(),
        false => data.to_vec().into(),
    }
}

/// An unstructured grid about to be written.
pub(crate) struct Grid {
    /// What the grid is, for error messages.
    pub part: String,
    /// Coordinates, three per point.
    pub points: Vec<f64>,
    pub connectivity: Vec<u64>,
    /// End of each cell in `connectivity`.
    pub offsets: Vec<u64>,
    pub types: Vec<CellType>,
    pub point_data: Vec<Array>,
    pub cell_data: Vec<Array>,
    /// Name of the point data that ParaView warps by.
    pub vectors: Option<&'static str>,
    /// Name of the point data that shading uses.
    pub normals: Option<&'static str>,
    /// The grid has rational Bezier cells, with point data [`WEIGHTS`] beside the cell data [`DEGREES`].
    pub rational: bool,
}

/// Point data with the weights of rational cells.
pub(crate) const WEIGHTS: &str = "RationalWeights";
/// Cell data with the degrees of higher-order cells.
pub(crate) const DEGREES: &str = "HigherOrderDegrees";

impl Grid {
    /// The grid as the bytes of a `.vtu` file, little endian, compressed by zlib, appended. Version 1.0 of the format, which
    /// every reader knows, unless there are Bezier cells, which need 2.2. (Up to 2.0 VTK permutes nodes in the middle of upright edges
    /// of Lagrange bricks; those written here are straight in that direction and have none.)
    pub fn into_bytes(self) -> Result<Vec<u8>, OutputError> {
        self.into_parts().map(|parts| parts.file())
    }

    /// The same in parts, the array that ParaView warps by as the last of the appended ones.
    pub fn into_parts(self) -> Result<Appended, OutputError> {
        let patch = TagPatch::of(&self);
        let last = self.vectors;
        let plain = |cell: &CellType| {
            matches!(
                cell,
                CellType::Hexahedron
                    | CellType::LagrangeHexahedron
                    | CellType::Quad
                    | CellType::Vertex
            )
        };
        let (major, minor) = match self.types.iter().all(plain) {
            true => (1, 0),
            false => (2, 2),
        };
        let part = self.part;
        let attribute = |array: Array| {
            let elem = if self.vectors == Some(array.name.as_str()) {
                ElementType::Vectors
            } else if self.normals == Some(array.name.as_str()) {
                ElementType::Normals
            } else {
                ElementType::Generic(array.components)
            };
            Attribute::DataArray(DataArray {
                name: array.name,
                elem,
                data: array.data,
            })
        };
        let data = Attributes {
            point: self.point_data.into_iter().map(attribute).collect(),
            cell: self.cell_data.into_iter().map(attribute).collect(),
        };
        let vtk = Vtk {
            version: Version::XML { major, minor },
            title: String::new(),
            byte_order: ByteOrder::LittleEndian,
            file_path: None,
            data: DataSet::inline(UnstructuredGridPiece {
                points: self.points.into(),
                cells: Cells {
                    cell_verts: VertexNumbers::XML {
                        connectivity: self.connectivity,
                        offsets: self.offsets,
                    },
                    types: self.types,
                },
                data,
            }),
        };
        // Into memory, not into the file: the serialiser ignores short writes.
        let mut bytes = Vec::new();
        vtk.write_xml(&mut bytes)
            .map_err(|e| OutputError::Serialise {
                part,
                reason: e.to_string(),
            })?;
        Ok(Appended::new(&bytes, last, |tag| patch.tag(tag)))
    }
}

/// Additions to the tags of a serialised grid.
struct TagPatch {
    /// Attribute `Name="..."` as it stands in the tag, and the attributes to add after it.
    arrays: Vec<(String, String)>,
    rational: bool,
    /// The cells state their degrees.
    degrees: bool,
}

impl TagPatch {
    fn of(grid: &Grid) -> Self {
        let mut arrays = Vec::new();
        for array in grid.point_data.iter().chain(&grid.cell_data) {
            if array.component_names.is_empty() {
                continue;
            }
            let mut extra = String::new();
            for (i, name) in array.component_names.iter().enumerate() {
                // Writing to a String does not fail.
                let _ = write!(extra, " ComponentName{i}=\"{}\"", escaped(name));
            }
            arrays.push((format!(" Name=\"{}\"", escaped(&array.name)), extra));
        }
        TagPatch {
            arrays,
            rational: grid.rational,
            degrees: grid.cell_data.iter().any(|a| a.name == DEGREES),
        }
    }

    fn tag(&self, tag: &str) -> String {
        let mut tag = tag.to_string();
        if tag.starts_with("<VTKFile ") {
            tag.insert_str(tag.len() - 1, COMPRESSOR);
        } else if tag.starts_with("<DataArray ") {
            remove_attribute(&mut tag, " RangeMin=\"");
            remove_attribute(&mut tag, " RangeMax=\"");
            // Numbers of nodes, far below the limit. As signed ones meshio reads cells of any number of nodes, too.
            tag = tag.replace("type=\"UInt64\"", "type=\"Int64\"");
            for (name, extra) in &self.arrays {
                if let Some(at) = tag.find(name.as_str()) {
                    tag.insert_str(at + name.len(), extra);
                }
            }
        } else if self.rational && tag.starts_with("<PointData") {
            tag.insert_str("<PointData".len(), &format!(" {WEIGHTS}=\"{WEIGHTS}\""));
        } else if self.degrees && tag.starts_with("<CellData") {
            tag.insert_str("<CellData".len(), &format!(" {DEGREES}=\"{DEGREES}\""));
        }
        tag
    }
}

/// Removes `start...end-quote` from a tag.
fn remove_attribute(tag: &mut String, start: &str) {
    if let Some(at) = tag.find(start) {
        let value = at + start.len();
        if let Some(len) = tag[value..].find('"') {
            tag.replace_range(at..value + len + 1, "");
        }
    }
}

/// Text as XML and HTML hold it, in an attribute too. Control characters, which XML 1.0 cannot hold, become spaces.
pub(crate) fn escaped(text: &str) -> String {
    let forbidden = |c: char| c.is_control() || c == '\u{fffe}' || c == '\u{ffff}';
    quick_xml::escape::escape(&text.replace(forbidden, " ")).into_owned()
}
