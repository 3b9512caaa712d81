//! Faces of a body that contact may act on.
use super::Builder;
use super::supports::components;
use crate::mesh::Face;
use crate::model::error::ModelError;
use crate::scene::SetNames;
use std::collections::HashSet;

/// Spread of a face's nodes across a plane of symmetry up to which it lies in it, as a part of the face's size.
const FLAT: f64 = 1e-6;

impl Builder<'_> {
    /// Faces of a set without those that lie in a plane of symmetry, which a selection by a box takes along: there the mirror image
    /// goes on, and a body that comes along the plane would find its own distance from such a face to be nothing. A set that
    /// consists of such faces is taken as it is.
    ///
    /// # Errors
    /// A set that there is not.
    pub(super) fn contact_faces(
        &mut self,
        contact: &str,
        side: &SetNames,
        pointer: &str,
    ) -> Result<(usize, Vec<Face>), ModelError> {
        let (body, faces) = self.side(side, pointer)?;
        let mut cut: HashSet<Face> = HashSet::new();
        for (name, support) in &self.scene.supports {
            let plane = support.symmetry.or(support.plane_strain);
            let held = plane.map(|_| components(support));
            let Some(&[(axis, _)]) = held.as_deref() else {
                continue;
            };
            for (at, set) in support.on.places(&format!("/supports/{name}/on")) {
                // What is wrong with a support is told where it is built.
                let Ok((of, nodes)) = self.set_nodes(set, &at) else {
                    continue;
                };
                if of == body {
                    let first = self.bodies[body].first_node;
                    let held: HashSet<u32> = nodes.iter().map(|n| n - first).collect();
                    let flat = faces
                        .iter()
                        .filter(|f| self.in_plane(body, **f, axis as usize, &held));
                    cut.extend(flat);
                }
            }
        }
        if cut.is_empty() || cut.len() == faces.len() {
            return Ok((body, faces));
        }
        let note = format!(
            "contact `{contact}`: {} of the {} faces of `{side}` lie in a plane of symmetry and are left out: the mirror image \
             goes on there",
            cut.len(),
            faces.len()
        );
        // Both passes of a contact ask.
        if !self.notes.contains(&note) {
            self.notes.push(note);
        }
        let kept = faces.into_iter().filter(|f| !cut.contains(f)).collect();
        Ok((body, kept))
    }

    /// Whether all nodes of a face are held at one coordinate along an axis.
    fn in_plane(&self, body: usize, face: Face, axis: usize, held: &HashSet<u32>) -> bool {
        let model = &self.bodies[body];
        let nodes = model.mesh.face_corners(face);
        if !nodes.iter().all(|n| held.contains(n)) {
            return false;
        }
        let at = nodes.map(|n| self.nodes[(n + model.first_node) as usize]);
        let size = (at[2] - at[0]).norm();
        at.iter()
            .all(|x| (x[axis] - at[0][axis]).abs() <= FLAT * size)
    }
}
