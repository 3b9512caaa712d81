//! From the scene's description to a mesh.
use super::extrude::Extrusion;
use super::raw::{RawMesh, ThicknessRule, report};
use super::{
    ElementKind, Face, Mesh, MeshError, MeshReport, block, cylinder_panel, plate, sphere_panel,
};
use crate::scene::{MeshArrays, MeshFile, MeshSource};
use covact_geometry::Vec3;
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
        MeshSource::Cells(cells) => {
            let raw = super::vtk::from_cells(cells)?;
            return finish(raw, &cells.file.path, &cells.file, kind);
        }
        MeshSource::Arrays(arrays) => Mesh::of(arrays, kind)?,
        MeshSource::Nurbs(_) => {
            return Err(MeshError::Invalid {
                what: "mesh",
                field: "nurbs".to_owned(),
                value: "a CAD surface".to_owned(),
                expected: "a mesh of elements".to_owned(),
            });
        }
    };
    mesh.check()?;
    let report = report(&mesh, Vec::new(), ThicknessRule::Generated)?;
    Ok((mesh, report))
}

impl Mesh {
    /// The mesh of arrays that a program gives.
    fn of(arrays: &MeshArrays, kind: ElementKind) -> Result<Self, MeshError> {
        let invalid = |field: &str, value: usize, expected| MeshError::Invalid {
            what: "mesh",
            field: field.to_owned(),
            value: value.to_string(),
            expected,
        };
        let (each, numbers) = (arrays.nodes_per_element, arrays.elements.len());
        if each != kind.nodes() {
            let expected = format!("{}, which the element of the body has", kind.nodes());
            return Err(invalid("nodes_per_element", each, expected));
        }
        if !numbers.is_multiple_of(each) {
            let expected = format!("a multiple of {each} node numbers");
            return Err(invalid("elements", numbers, expected));
        }
        let mut mesh = Mesh {
            kind,
            nodes: arrays.nodes.iter().map(|x| Vec3::from(*x)).collect(),
            connectivity: arrays.elements.clone(),
            node_sets: arrays.node_sets.clone(),
            face_sets: (arrays.face_sets.iter())
                .map(|(name, set)| {
                    let face = |&(element, face)| Face { element, face };
                    (name.clone(), set.iter().map(face).collect())
                })
                .collect(),
        };
        mesh.node_sets.values_mut().for_each(sort);
        mesh.face_sets.values_mut().for_each(sort);
        Ok(mesh)
    }
}

/// Sorted, and each member once.
fn sort<T: Ord>(set: &mut Vec<T>) {
    set.sort_unstable();
    set.dedup();
}

impl From<Mesh> for MeshSource {
    /// A body of such a mesh of [`ElementKind::Q18`] has to name its element.
    fn from(mesh: Mesh) -> Self {
        let faces = |set: Vec<Face>| set.into_iter().map(|f| (f.element, f.face)).collect();
        let face_sets = mesh.face_sets.into_iter();
        MeshSource::from(MeshArrays {
            nodes: mesh.nodes.iter().map(|x| (*x).into()).collect(),
            nodes_per_element: mesh.kind.nodes(),
            elements: mesh.connectivity,
            node_sets: mesh.node_sets,
            face_sets: face_sets.map(|(name, set)| (name, faces(set))).collect(),
        })
    }
}

/// Reads a mesh file.
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
    let Some(format) = Format::of(&path) else {
        return Err(MeshError::UnknownFormat { path });
    };
    let bytes = match covact_geometry::io::read_whole(&path) {
        Ok(bytes) => bytes,
        Err(source) => return Err(MeshError::Io { path, source }),
    };
    read(&bytes, &path, format, file, kind)
}

/// Format of a mesh file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Format {
    /// gmsh, versions 2.2 and 4.1.
    Gmsh,
    /// Abaqus and CalculiX.
    Inp,
    /// Nastran bulk data.
    Nastran,
    /// Legacy files of VTK.
    Vtk,
    /// XML files of VTK with an unstructured grid.
    Vtu,
    /// Triangles, in text or binary form.
    Stl,
}

impl Format {
    /// The format that the name of a file tells.
    pub fn of(path: &Path) -> Option<Format> {
        let extension = path.extension()?.to_string_lossy().to_lowercase();
        Some(match extension.as_str() {
            "msh" => Format::Gmsh,
            "inp" => Format::Inp,
            "bdf" | "nas" => Format::Nastran,
            "vtk" => Format::Vtk,
            "vtu" => Format::Vtu,
            "stl" => Format::Stl,
            _ => return None,
        })
    }
}

/// Makes the mesh that `file` asks for from the bytes of a file; `path` is for messages.
pub fn read(
    bytes: &[u8],
    path: &Path,
    format: Format,
    file: &MeshFile,
    kind: ElementKind,
) -> Result<(Mesh, MeshReport), MeshError> {
    let raw = match format {
        Format::Gmsh => super::gmsh::parse(bytes, path)?,
        Format::Inp => super::inp::parse(bytes, path)?,
        Format::Nastran => super::nastran::parse(bytes, path)?,
        Format::Vtk => super::vtk::parse_legacy(bytes, path)?,
        Format::Vtu => super::vtk::parse_xml(bytes, path)?,
        Format::Stl => super::stl::parse(bytes, path)?,
    };
    finish(raw, path, file, kind)
}

/// Makes the mesh that `file` asks for of what was read.
fn finish(
    mut raw: RawMesh,
    path: &Path,
    file: &MeshFile,
    kind: ElementKind,
) -> Result<(Mesh, MeshReport), MeshError> {
    if let Some(set) = &file.only {
        raw.select(set)?;
    }
    if let Some(thickness) = &file.thickness {
        let how = Extrusion {
            thickness,
            offset: file.offset.unwrap_or_default(),
            layers: file.layers.unwrap_or(1).max(1),
            kind,
            scale: file.scale,
            slits: file.slits,
        };
        return raw.into_shell(path, &how);
    }
    let (mesh, report) = raw.into_mesh(path, file.scale, file.slits)?;
    if mesh.kind == kind {
        return Ok((mesh, report));
    }
    let (found, wanted, help) = match kind {
        ElementKind::H8 => (
            "hexahedra of 27 nodes (or of 20)",
            "8-node elements are asked for",
            "say `\"element\": \"q18\"`, or mesh with elements of first order (gmsh: `Mesh.ElementOrder = 1`)",
        ),
        ElementKind::Q18 => (
            "hexahedra of 8 nodes",
            "`q18` needs 27 nodes an element (or 20)",
            "mesh with full second-order elements (gmsh: `Mesh.ElementOrder = 2`, `Mesh.SecondOrderIncomplete = 0`), or \
             say `\"element\": \"h8\"`",
        ),
        ElementKind::Nurbs => (
            "a mesh",
            "a CAD surface is asked for",
            "leave `element` out",
        ),
    };
    Err(MeshError::OtherElements {
        path: path.to_path_buf(),
        found,
        wanted,
        help,
    })
}
