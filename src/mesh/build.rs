//! From the scene's description to a mesh.
use super::raw::{ThicknessRule, report};
use super::{
    ElementKind, Mesh, MeshError, MeshReport, block, cylinder_panel, plate, read_gmsh, read_inp,
    sphere_panel,
};
use crate::scene::{MeshFile, MeshSource};
use std::path::Path;

/// Makes or reads the mesh of a body and checks it. Files are looked for relative to `scene_dir`.
///
/// Fails with the error of the generator, of the reader, or of [`Mesh::check`], and with
/// [`MeshError::OtherElements`] where a file holds elements of another shape than `kind`.
pub fn build(
    source: &MeshSource,
    kind: ElementKind,
    scene_dir: &Path,
) -> Result<(Mesh, MeshReport), MeshError> {
    let mesh = match source {
        MeshSource::Plate(p) => plate(p, kind)?,
        MeshSource::CylinderPanel(p) => cylinder_panel(p, kind)?,
        MeshSource::SpherePanel(p) => sphere_panel(p, kind)?,
        MeshSource::Block(p) => block(p, kind)?,
        MeshSource::File(file) => return read_file(file, kind, scene_dir),
    };
    mesh.check()?;
    let report = report(&mesh, Vec::new(), ThicknessRule::Generated)?;
    Ok((mesh, report))
}

/// Reads a mesh file by its extension.
fn read_file(
    file: &MeshFile,
    kind: ElementKind,
    scene_dir: &Path,
) -> Result<(Mesh, MeshReport), MeshError> {
    if !(file.scale.is_finite() && file.scale > 0.0) {
        return Err(MeshError::Invalid {
            what: "file",
            field: "scale".to_string(),
            value: file.scale.to_string(),
            expected: "a positive number".to_string(),
        });
    }
    let path = scene_dir.join(&file.path);
    let extension = path.extension().map(|e| e.to_string_lossy().to_lowercase());
    let read = match extension.as_deref() {
        Some("msh") => read_gmsh,
        Some("inp") => read_inp,
        _ => return Err(MeshError::UnknownFormat { path }),
    };
    let bytes = match covact_geometry::io::read_whole(&path) {
        Ok(bytes) => bytes,
        Err(source) => return Err(MeshError::Io { path, source }),
    };
    let (mesh, report) = read(&bytes, &path, file.scale)?;
    if mesh.kind == kind {
        return Ok((mesh, report));
    }
    let (found, wanted, help) = match kind {
        ElementKind::H8 => (
            "hexahedra of 27 nodes",
            "8-node elements are asked for",
            "say `\"element\": \"q18\"`, or mesh with elements of first order (gmsh: `Mesh.ElementOrder = 1`)",
        ),
        ElementKind::Q18 => (
            "hexahedra of 8 nodes",
            "`q18` needs 27 nodes an element",
            "mesh with full second-order elements (gmsh: `Mesh.ElementOrder = 2`, `Mesh.SecondOrderIncomplete = 0`), or \
             say `\"element\": \"h8\"`",
        ),
    };
    Err(MeshError::OtherElements {
        path,
        found,
        wanted,
        help,
    })
}
