//! Selections by geometry on a sheet: control points do not lie on the surface, so nodes are chosen as whole edges, or corners.
use super::super::sets::{boxed, corners, not_negative, outside_box, slack, unit, vector, words};
use super::super::{Face, Mesh, MeshError};
use super::{Border, Kept, NurbsSheet, SheetPatch, side, sorted};
use crate::scene::{Corners, Selection};
use covact_geometry::Vec3;

/// Points of an edge that have to be in a selection.
const ALONG: usize = 17;

impl NurbsSheet {
    /// Adds what `selection` finds as a set of the mesh: edges and curves of trims that lie in it as a whole, else corners; or faces
    /// of elements.
    ///
    /// # Errors
    /// As [`Mesh::add_set`].
    pub fn add_set(
        &mut self,
        mesh: &mut Mesh,
        name: &str,
        selection: &Selection,
    ) -> Result<(), MeshError> {
        if mesh.node_sets.contains_key(name) || mesh.face_sets.contains_key(name) {
            return Err(MeshError::SetExists {
                name: name.to_owned(),
            });
        }
        let picked = Picked::new(selection, slack(&mesh.nodes))?;
        if let Some(faces) = self.faces_in(mesh, &picked)? {
            let nodes = mesh.nodes_of(&faces);
            mesh.node_sets.insert(name.to_owned(), nodes);
            mesh.face_sets.insert(name.to_owned(), faces);
            return Ok(());
        }
        let miss = |edge: &Border| {
            let all = self.along(*edge);
            all.iter().map(|x| picked.miss(x)).fold(0.0, f64::max)
        };
        let mut nearest = f64::INFINITY;
        let mut within = |miss: f64| {
            nearest = nearest.min(miss);
            miss <= picked.slack
        };
        let edges: Vec<Border> = (self.free_borders().into_iter())
            .filter(|edge| within(miss(edge)))
            .collect();
        let kept = |p: &SheetPatch| {
            let corners = p.corners().into_iter().enumerate();
            let kept: Vec<u32> = corners
                .filter(|(c, _)| p.keeps_corner(*c))
                .map(|(_, node)| node)
                .collect();
            kept
        };
        let corners: Vec<u32> = (self.patches.iter().flat_map(kept))
            .filter(|&n| within(picked.miss(&mesh.nodes[n as usize])))
            .collect();
        let nodes = match edges.is_empty() {
            true => corners,
            false => self.border_nodes(&edges),
        };
        if nodes.is_empty() {
            return Err(picked.nothing("whole edge or corner", nearest, "length units"));
        }
        mesh.node_sets.insert(name.to_owned(), sorted(nodes));
        if !edges.is_empty() {
            self.edge_sets.insert(name.to_owned(), edges);
        }
        Ok(())
    }

    /// Points along a border.
    fn along(&self, border: Border) -> Vec<Vec3> {
        let part = &self.patches[border.patch()];
        let line = part.line(border);
        let points = line.ranges().iter().flat_map(|[a, b]| {
            (0..ALONG).map(move |k| a + (b - a) * k as f64 / (ALONG - 1) as f64)
        });
        points.map(|s| part.patch.point(line.xi(s))).collect()
    }

    /// Faces that a selection of faces finds; none for a selection of nodes.
    fn faces_in(&self, mesh: &Mesh, picked: &Picked) -> Result<Option<Vec<Face>>, MeshError> {
        if !matches!(picked.place, Place::Faces { .. } | Place::Facing { .. }) {
            return Ok(None);
        }
        let mut nearest = f64::INFINITY;
        let mut faces = Vec::new();
        for element in (0..mesh.elements()).filter(|e| *self.kept(*e) != Kept::Nothing) {
            let [u, v] = self.range(element);
            let xi = |s: f64, t: f64| [u[0] + s * (u[1] - u[0]), v[0] + t * (v[1] - v[0])];
            let patch = &self.place(element).0.patch;
            let jet = patch.jet(xi(0.5, 0.5));
            let normal = jet.rho_i[0].cross(&jet.rho_i[1]).normalize();
            let places = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [1.0, 1.0]]
                .map(|[s, t]| patch.point(xi(s, t)));
            for face in [4, 5] {
                let face = Face {
                    element: element as u32,
                    face,
                };
                let miss = picked.miss_face(&places, &(normal * side(face).unwrap_or(1.0)));
                nearest = nearest.min(miss);
                if miss <= picked.slack {
                    faces.push(face);
                }
            }
        }
        let unit = match picked.place {
            Place::Facing { .. } => "degrees",
            _ => "length units",
        };
        match faces.is_empty() {
            true => Err(picked.nothing("face of an element", nearest, unit)),
            false => Ok(Some(faces)),
        }
    }
}

/// A selection whose values make sense.
struct Picked {
    place: Place,
    /// Misses below this count as hits: round-off.
    slack: f64,
    words: String,
}

enum Place {
    Box {
        min: Vec3,
        max: Vec3,
    },
    Plane {
        point: Vec3,
        normal: Vec3,
        tolerance: f64,
    },
    Point {
        point: Vec3,
        tolerance: f64,
    },
    Faces {
        min: Vec3,
        max: Vec3,
    },
    Facing {
        normal: Vec3,
        angle: f64,
    },
}

impl Picked {
    fn new(selection: &Selection, slack: f64) -> Result<Picked, MeshError> {
        let (place, words, slack) = match selection {
            Selection::NodesInBox(Corners { min, max }) => {
                const WHAT: &str = "nodes_in_box";
                let [min, max] = corners(WHAT, *min, *max)?;
                (Place::Box { min, max }, boxed(WHAT, min, max), slack)
            }
            Selection::FacesInBox(Corners { min, max }) => {
                const WHAT: &str = "faces_in_box";
                let [min, max] = corners(WHAT, *min, *max)?;
                (Place::Faces { min, max }, boxed(WHAT, min, max), slack)
            }
            Selection::NodesNearPlane {
                point,
                normal,
                tolerance,
            } => {
                const WHAT: &str = "nodes_near_plane";
                let (point, normal) = (vector(WHAT, "point", *point)?, unit(WHAT, *normal)?);
                let tolerance = not_negative(WHAT, "tolerance", *tolerance)?;
                let text = format!(
                    "{WHAT} (point {}, normal {}, tolerance {tolerance})",
                    words(point),
                    words(normal)
                );
                let place = Place::Plane {
                    point,
                    normal,
                    tolerance,
                };
                (place, text, slack)
            }
            Selection::NodesNearPoint { point, tolerance } => {
                const WHAT: &str = "nodes_near_point";
                let point = vector(WHAT, "point", *point)?;
                let tolerance = not_negative(WHAT, "tolerance", *tolerance)?;
                let text = format!("{WHAT} (point {}, tolerance {tolerance})", words(point));
                (Place::Point { point, tolerance }, text, slack)
            }
            Selection::FacesFacing { normal, angle } => {
                const WHAT: &str = "faces_facing";
                let normal = unit(WHAT, *normal)?;
                let angle = not_negative(WHAT, "angle", *angle)?;
                let text = format!("{WHAT} (normal {}, angle {angle})", words(normal));
                // A millionth of a degree: round-off of normals.
                (Place::Facing { normal, angle }, text, 1e-6)
            }
        };
        Ok(Picked {
            place,
            slack,
            words,
        })
    }

    /// How far a point is from the selection.
    fn miss(&self, x: &Vec3) -> f64 {
        match &self.place {
            Place::Box { min, max } | Place::Faces { min, max } => outside_box(x, *min, *max),
            Place::Plane {
                point,
                normal,
                tolerance,
            } => ((x - point).dot(normal).abs() - tolerance).max(0.0),
            Place::Point { point, tolerance } => ((x - point).norm() - tolerance).max(0.0),
            Place::Facing { .. } => f64::INFINITY,
        }
    }

    /// The same of a face with these corners and this outward normal.
    fn miss_face(&self, corners: &[Vec3; 4], outward: &Vec3) -> f64 {
        match &self.place {
            Place::Facing { normal, angle } => {
                let turned = outward.cross(normal).norm().atan2(outward.dot(normal));
                (turned.to_degrees() - angle).max(0.0)
            }
            _ => corners.iter().map(|x| self.miss(x)).fold(0.0, f64::max),
        }
    }

    fn nothing(&self, candidate: &'static str, nearest: f64, unit: &'static str) -> MeshError {
        MeshError::EmptySelection {
            selection: self.words.clone(),
            candidate,
            nearest,
            unit,
        }
    }
}
