//! Fields of a body on its mesh, and how far fields on different meshes are apart.
//!
//! Everything happens in the reference configuration, which is where the points of a body are written. Fields of the volume
//! are integrated over the cells of the reference mesh; fields that exist on slave faces only, over these. The field of the
//! other mesh is found at every point of integration by a tree of boxes and the inverse of the isoparametric mapping.
mod cell;
mod faces;
mod norm;
#[cfg(test)]
mod tests;
mod tree;

use super::sample::Difference;
use crate::output::read;
use cell::Cell;
use covact_geometry::Vec3;
use std::path::Path;

/// Most components of a field.
const MOST: usize = 9;

/// Fields that exist on slave faces only; elsewhere they are written as zero or NaN.
const ON_SLAVE_FACES: [&str; 7] = [
    "contact_pressure",
    "contact_gap",
    "contact_status",
    "contact_traction",
    "friction_traction",
    "slip",
    "dissipated",
];

/// A field of a body in its last results.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Field {
    /// Time of the results.
    time: f64,
    /// Numbers per point or cell, at most [`MOST`].
    components: usize,
    /// One value per cell, not per point.
    by_cell: bool,
    points: Vec<Vec3>,
    /// What is integrated over: hexahedra or slave faces.
    cells: Vec<Cell>,
    /// `components` numbers for each point or cell.
    data: Vec<f64>,
}

impl Field {
    /// Reads the field `name` of a body from the last results in `folder`.
    ///
    /// # Errors
    /// In words: no results of such a body, no such field (with the nearest name), a file that does not hold what it says.
    pub fn read(folder: &Path, body: &str, name: &str) -> Result<Field, String> {
        let (time, path) = read::last(folder, body)?;
        let file = read::body(&path)?;
        let mesh = file.mesh;
        let found = file.fields.iter().find(|f| f.name == name);
        let Some(array) = found else {
            let names = file.fields.iter().map(|f| f.name.as_str());
            return Err(match crate::scene::nearest(name, names) {
                Some(near) => {
                    format!("body `{body}` has no field `{name}`; did you mean `{near}`?")
                }
                None => format!("body `{body}` has no field `{name}`"),
            });
        };
        if array.components > MOST {
            return Err(format!(
                "field `{name}` has {} components, and at most {MOST} are compared",
                array.components
            ));
        }
        let faces = ON_SLAVE_FACES.contains(&name) && !array.by_cell;
        let cells = if faces {
            let status = (file.fields.iter())
                .find(|f| f.name == "contact_status" && !f.by_cell)
                .ok_or("there is no `contact_status` to tell which faces are slaves")?;
            let faces = faces::of_slaves(&mesh, &status.data);
            if faces.is_empty() {
                return Err(format!("body `{body}` has no slave faces"));
            }
            faces
        } else {
            (0..mesh.elements())
                .map(|e| Cell::brick(mesh.kind, mesh.element(e)))
                .collect()
        };
        let (components, by_cell, data) = (array.components, array.by_cell, array.data.clone());
        Ok(Field {
            time,
            components,
            by_cell,
            points: mesh.nodes,
            cells,
            data,
        })
    }

    /// Roots of the mean squares, over the mesh of `reference`, of the difference and of the reference.
    ///
    /// # Errors
    /// In words: fields of different times, of different kinds, or whose meshes fill different regions; nothing but NaN.
    pub fn difference(&self, reference: &Field) -> Result<Difference, String> {
        norm::difference(self, reference)
    }

    /// True for a field that is integrated over slave faces.
    pub fn lives_on_slave_faces(name: &str) -> bool {
        ON_SLAVE_FACES.contains(&name)
    }

    /// Numbers of a node of a cell.
    fn value(&self, cell: usize, node: usize) -> &[f64] {
        let at = match self.by_cell {
            true => cell,
            false => self.cells[cell].nodes()[node] as usize,
        };
        &self.data[at * self.components..(at + 1) * self.components]
    }
}
