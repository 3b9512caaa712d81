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
    /// Computed from fields that are written, too, and therefore in single precision.
    pub derived: bool,
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
            derived: false,
        }
    }

    /// A scalar field on the nodes that is computed from fields that are written, too.
    pub fn derived(name: &'a str, data: &'a [f64]) -> Self {
        Field {
            derived: true,
            ..Field::point(name, data)
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
    /// every reader knows, where all cells are linear; else 2.2 (up to 2.0 VTK permutes edge nodes of higher-order cells).
    pub fn into_bytes(self) -> Result<Vec<u8>, OutputError> {
        self.into_parts().map(|parts| parts.file())
    }

    /// The same in parts, the array that ParaView warps by as the last of the appended ones.
    pub fn into_parts(self) -> Result<Appended, OutputError> {
        let patch = TagPatch::of(&self);
        let last = self.vectors;
        let linear = |cell: &CellType| {
            matches!(
                cell,
                CellType::Hexahedron | CellType::Quad | CellType::Vertex
            )
        };
        let (major, minor) = match self.types.iter().all(linear) {
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
