//! Readers of VTK's files: legacy (`.vtk`, text and binary, versions up to 5.1) and XML (`.vtu`, text, base64 and appended
//! data, plain or zlib) (formats: "VTK file formats", VTK user's guide).
//!
//! Arrays of whole numbers on cells or points, such as the groups that meshers write, become sets `array_value`.
mod grid;
mod legacy;
mod values;
mod xml;

pub(super) use grid::from_cells;
pub(super) use legacy::parse as parse_legacy;
pub(super) use xml::parse as parse_xml;
