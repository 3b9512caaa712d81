//! Meshes of bodies: where they lie, whether there is room for them, and what is told of those that fail.
use super::FEWER;
use crate::machine::memory;
use crate::mesh::{self, Mesh};
use crate::model::error::{number, text};
use crate::model::motion::pose;
use crate::model::{ModelError, grid};
use crate::scene::{self, MeshSource};
use crate::shell::Memory;
use nalgebra::Point3;

/// An error of a body's mesh, told with the name of its file where it has one.
pub(super) fn mesh_error(body: &str, source: &MeshSource, error: mesh::MeshError) -> ModelError {
    let pointer = format!("/bodies/{body}/mesh");
    let extruded = matches!(source, MeshSource::File(file) if file.thickness.is_some());
    let help = matches!(error, mesh::MeshError::Inverted { .. }).then_some(match extruded {
        true => {
            "the thickness is too large for the elements beside a fold or a tight bend there (mesh them coarser, or give a smaller \
             thickness), or a face of the mesh itself has a corner of 180 degrees or more"
        }
        false => {
            "look at these elements in the mesher: a node may have moved through a face, or the surface is too curved for \
             the elements"
        }
    });
    let message = error.to_string();
    let mut error = match source {
        MeshSource::File(file) => {
            let path = file.path.display().to_string();
            let field = match &error {
                mesh::MeshError::UnknownSet { name, .. } if file.only.as_ref() == Some(name) => {
                    "only"
                }
                mesh::MeshError::UnknownSet { .. }
                | mesh::MeshError::Surface {
                    source:
                        mesh::SurfaceError::NoThickness { .. }
                        | mesh::SurfaceError::TwoThicknesses { .. }
                        | mesh::SurfaceError::Field(_)
                        | mesh::SurfaceError::NotPositive { .. },
                    ..
                } => "thickness",
                _ => "path",
            };
            let pointer = format!("{pointer}/file/{field}");
            match message.contains(&path) {
                true => text(pointer, message),
                false => text(pointer, format!("{path}: {message}")),
            }
        }
        _ => match error {
            mesh::MeshError::Memory { .. } | mesh::MeshError::TooManyNodes { .. } => {
                return text(elements_key(body, source), message).help(FEWER);
            }
            _ => text(pointer, message),
        },
    };
    error.help = help.map(str::to_owned);
    error
}

/// Whether a run on the mesh of a body, whose material remembers this, fits in memory, as far as its counts of elements tell before it is made.
pub(super) fn room(name: &str, body: &scene::Body, memory: Memory) -> Result<(), ModelError> {
    let counts = match &body.mesh {
        MeshSource::Plate(p) => [p.elements[0], p.elements[1], p.layers],
        MeshSource::CylinderPanel(p) => [p.elements[0], p.elements[1], p.layers],
        MeshSource::SpherePanel(p) => [p.elements[0], p.elements[1], p.layers],
        MeshSource::Block(b) => b.elements,
        MeshSource::File(_)
        | MeshSource::Arrays(_)
        | MeshSource::Cells(_)
        | MeshSource::Nurbs(_) => return Ok(()),
    };
    let element = body.element;
    let grid = grid::Grid {
        element,
        counts,
        memory,
    };
    // Half of the estimate, which may be wrong by so much: the rest is checked when the system is known.
    memory::ask(grid.bytes(true) / 2).map_err(|mut shortage| {
        shortage.needed = grid.bytes(true);
        let [r, s, t] = counts;
        let message = format!("body `{name}` with {r} x {s} x {t} elements: {shortage}");
        text(elements_key(name, &body.mesh), message).help(FEWER)
    })
}

/// The field that says how many elements a body has.
pub(crate) fn elements_key(body: &str, source: &MeshSource) -> String {
    let field = match source {
        MeshSource::Plate(_) => "plate/elements",
        MeshSource::CylinderPanel(_) => "cylinder_panel/elements",
        MeshSource::SpherePanel(_) => "sphere_panel/elements",
        MeshSource::Block(_) => "block/elements",
        MeshSource::File(_) => "file/path",
        MeshSource::Arrays(_) => "arrays",
        MeshSource::Cells(_) => "cells",
        MeshSource::Nurbs(nurbs) => {
            let field = if nurbs.size.is_some() {
                "size"
            } else {
                "elements"
            };
            return format!("/bodies/{body}/nurbs/{field}");
        }
    };
    format!("/bodies/{body}/mesh/{field}")
}

/// Puts a mesh where the scene wants it.
pub(super) fn place(mesh: &mut Mesh, placement: &scene::Placement) {
    if *placement == scene::Placement::default() {
        return;
    }
    let pose = pose(placement);
    for x in &mut mesh.nodes {
        *x = (pose * Point3::from(*x * placement.scale)).coords;
    }
}

/// Where a body lies, for selections that miss it.
pub(super) fn extent(body: &str, mesh: &Mesh) -> String {
    let [low, high] = mesh.bounds();
    let axis = |i: usize| {
        let name = ["x", "y", "z"][i];
        format!("{name} {} to {}", number(low[i]), number(high[i]))
    };
    format!("body `{body}` lies in {}", [0, 1, 2].map(axis).join(", "))
}
