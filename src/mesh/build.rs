//! From the scene's description to a mesh.
use super::raw::{ThicknessRule, report};
use super::{
    Mesh, MeshError, MeshReport, block, cylinder_panel, plate, read_gmsh, read_inp, sphere_panel,
};
use crate::scene::{MeshFile, MeshSource};
use std::path::Path;

/// Makes or reads the mesh of a body and checks it. Files are looked for relative to `scene_dir`.
///
/// Fails with the error of the generator, of the reader, or of [`Mesh::check`].
pub fn build(source: &MeshSource, scene_dir: &Path) -> Result<(Mesh, MeshReport), MeshError> {
    let mesh = match source {
        MeshSource::Plate(p) => plate(p)?,
        MeshSource::CylinderPanel(p) => cylinder_panel(p)?,
        MeshSource::SpherePanel(p) => sphere_panel(p)?,
        MeshSource::Block(p) => block(p)?,
        MeshSource::File(file) => return read_file(file, scene_dir),
    };
    mesh.check()?;
    let report = report(&mesh, Vec::new(), ThicknessRule::Generated)?;
    Ok((mesh, report))
}

/// Reads a mesh file by its extension.
fn read_file(file: &MeshFile, scene_dir: &Path) -> Result<(Mesh, MeshReport), MeshError> {
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
    match std::fs::read(&path) {
        Ok(bytes) => read(&bytes, &path, file.scale),
        Err(source) => Err(MeshError::Io { path, source }),
    }
}
