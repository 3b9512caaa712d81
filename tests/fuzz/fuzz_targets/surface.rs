//! Any bytes as a surface mesh in one of the formats, which the first byte chooses.
#![no_main]
use covact::mesh::{ElementKind, Format, Mesh, MeshError, MeshReport, read};
use covact::scene::{MeshFile, Thickness};
use std::path::Path;

const FORMATS: [Format; 6] = [
    Format::Gmsh,
    Format::Inp,
    Format::Nastran,
    Format::Vtk,
    Format::Vtu,
    Format::Stl,
];

/// The first byte chooses the format and the element.
fn extruded(bytes: &[u8], path: &Path, scale: f64) -> Result<(Mesh, MeshReport), MeshError> {
    let (first, rest) = bytes.split_first().unwrap_or((&0, &[]));
    let file = MeshFile {
        scale,
        thickness: Some(Thickness::Uniform(0.1)),
        ..MeshFile::new(path)
    };
    let kind = match first & 0x80 {
        0 => ElementKind::H8,
        _ => ElementKind::Q18,
    };
    read(rest, path, FORMATS[usize::from(first % 6)], &file, kind)
}

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    covact_fuzz::mesh(bytes, "fuzz", extruded);
});
