//! Named sets and selections by geometry.
use super::{Face, Mesh, MeshError, SetKind};
use crate::scene::{Corners, Selection};
use covact_geometry::Vec3;

/// Borders of selections are widened by this part of the mesh's diagonal, so that round-off excludes nothing.
const SLACK: f64 = 1e-9;

/// What a selection found.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Selected {
    /// Node numbers, sorted.
    Nodes(Vec<u32>),
    /// Outer faces, sorted.
    Faces(Vec<Face>),
}

impl Mesh {
    /// Nodes of the node set `name`.
    ///
    /// Fails with [`MeshError::UnknownSet`], which lists the sets and the nearest name.
    pub fn node_set(&self, name: &str) -> Result<&[u32], MeshError> {
        let set = self.node_sets.get(name).map(Vec::as_slice);
        set.ok_or_else(|| unknown(SetKind::Node, name, self.node_sets.keys()))
    }

    /// Faces of the face set `name`.
    ///
    /// Fails with [`MeshError::UnknownSet`], which lists the sets and the nearest name.
    pub fn face_set(&self, name: &str) -> Result<&[Face], MeshError> {
        let set = self.face_sets.get(name).map(Vec::as_slice);
        set.ok_or_else(|| unknown(SetKind::Face, name, self.face_sets.keys()))
    }

    /// Adds what `selection` finds as a set; a face set is also added as the node set of its nodes.
    pub fn add_set(&mut self, name: &str, selection: &Selection) -> Result<(), MeshError> {
        if self.node_sets.contains_key(name) || self.face_sets.contains_key(name) {
            return Err(MeshError::SetExists {
                name: name.to_string(),
            });
        }
        match self.select(selection)? {
            Selected::Nodes(nodes) => {
                self.node_sets.insert(name.to_string(), nodes);
            }
            Selected::Faces(faces) => {
                self.node_sets
                    .insert(name.to_string(), self.nodes_of(&faces));
                self.face_sets.insert(name.to_string(), faces);
            }
        }
        Ok(())
    }

    /// Finds nodes or outer faces by geometry. Borders are widened by 1e-9 of the mesh's diagonal against round-off.
    ///
    /// Fails with [`MeshError::Invalid`] for selections that make no sense and with [`MeshError::EmptySelection`] when
    /// nothing is found.
    pub fn select(&self, selection: &Selection) -> Result<Selected, MeshError> {
        let slack = slack(&self.nodes);
        match selection {
            Selection::NodesInBox(Corners { min, max }) => {
                let [min, max] = corners("nodes_in_box", *min, *max)?;
                self.nodes_where(
                    slack,
                    0.0,
                    || boxed("nodes_in_box", min, max),
                    |x| outside_box(x, min, max),
                )
            }
            Selection::NodesNearPlane {
                point,
                normal,
                tolerance,
            } => {
                const WHAT: &str = "nodes_near_plane";
                let (point, normal) = (vector(WHAT, "point", *point)?, unit(WHAT, *normal)?);
                let tolerance = not_negative(WHAT, "tolerance", *tolerance)?;
                let words = || {
                    format!(
                        "{WHAT} (point {}, normal {}, tolerance {tolerance})",
                        words(point),
                        words(normal)
                    )
                };
                self.nodes_where(slack, tolerance, words, |x| (x - point).dot(&normal).abs())
            }
            Selection::NodesNearPoint { point, tolerance } => {
                const WHAT: &str = "nodes_near_point";
                let point = vector(WHAT, "point", *point)?;
                let tolerance = not_negative(WHAT, "tolerance", *tolerance)?;
                let words = || format!("{WHAT} (point {}, tolerance {tolerance})", words(point));
                self.nodes_where(slack, tolerance, words, |x| (x - point).norm())
            }
            Selection::FacesInBox(Corners { min, max }) => {
                let [min, max] = corners("faces_in_box", *min, *max)?;
                self.faces_where(
                    slack,
                    "length units",
                    || boxed("faces_in_box", min, max),
                    |f| {
                        let nodes = self.face_nodes(f);
                        (nodes.nodes().iter())
                            .map(|&n| outside_box(&self.nodes[n as usize], min, max))
                            .fold(0.0, f64::max)
                    },
                )
            }
            Selection::FacesFacing { normal, angle } => {
                const WHAT: &str = "faces_facing";
                let normal = unit(WHAT, *normal)?;
                let angle = not_negative(WHAT, "angle", *angle)?;
                let words = || format!("{WHAT} (normal {}, angle {angle})", words(normal));
                // A millionth of a degree: round-off of normals, far below any angle that is meant.
                self.faces_where(1e-6, "degrees", words, |f| {
                    let n = self.face_area_normal(f).1;
                    let turned = n.cross(&normal).norm().atan2(n.dot(&normal)).to_degrees();
                    (turned - angle).max(0.0)
                })
            }
        }
    }

    /// Nodes whose distance is at most `tolerance`.
    fn nodes_where(
        &self,
        slack: f64,
        tolerance: f64,
        selection: impl Fn() -> String,
        distance: impl Fn(&Vec3) -> f64,
    ) -> Result<Selected, MeshError> {
        let mut nearest = f64::INFINITY;
        let mut nodes = Vec::new();
        for (n, x) in self.nodes.iter().enumerate() {
            let beyond = distance(x) - tolerance;
            nearest = nearest.min(beyond);
            if beyond <= slack {
                nodes.push(n as u32);
            }
        }
        if nodes.is_empty() {
            return Err(MeshError::EmptySelection {
                selection: selection(),
                candidate: "node",
                nearest,
                unit: "length units",
            });
        }
        Ok(Selected::Nodes(nodes))
    }

    /// Outer faces that miss by at most `slack`.
    fn faces_where(
        &self,
        slack: f64,
        unit: &'static str,
        selection: impl Fn() -> String,
        miss: impl Fn(Face) -> f64,
    ) -> Result<Selected, MeshError> {
        let mut nearest = f64::INFINITY;
        let mut faces = self.outer_faces();
        faces.retain(|&f| {
            let by = miss(f);
            nearest = nearest.min(by);
            by <= slack
        });
        if faces.is_empty() {
            return Err(MeshError::EmptySelection {
                selection: selection(),
                candidate: "outer face",
                nearest,
                unit,
            });
        }
        Ok(Selected::Faces(faces))
    }
}

/// [`SLACK`] of nodes, as a length.
pub(super) fn slack(nodes: &[Vec3]) -> f64 {
    let Some(first) = nodes.first() else {
        return 0.0;
    };
    let bounds = |[low, high]: [Vec3; 2], x: &Vec3| [low.inf(x), high.sup(x)];
    let [low, high] = nodes.iter().fold([*first; 2], bounds);
    SLACK * (high - low).norm()
}

pub(super) fn unknown<'a>(
    kind: SetKind,
    name: &str,
    available: impl Iterator<Item = &'a String>,
) -> MeshError {
    let available: Vec<String> = available.cloned().collect();
    let suggestion = available
        .iter()
        .map(|s| {
            (
                strsim::jaro_winkler(&name.to_lowercase(), &s.to_lowercase()),
                s,
            )
        })
        .filter(|(likeness, _)| *likeness > 0.75)
        .max_by(|a, b| a.0.total_cmp(&b.0))
        .map(|(_, s)| s.clone());
    MeshError::UnknownSet {
        kind,
        name: name.to_string(),
        suggestion,
        available,
    }
}

/// Distance of a point from a box, 0 inside.
pub(super) fn outside_box(x: &Vec3, min: Vec3, max: Vec3) -> f64 {
    (min - x).sup(&(x - max)).sup(&Vec3::zeros()).norm()
}

pub(super) fn words(v: Vec3) -> String {
    format!("({}, {}, {})", v.x, v.y, v.z)
}

pub(super) fn boxed(what: &str, min: Vec3, max: Vec3) -> String {
    format!("{what} (min {}, max {})", words(min), words(max))
}

fn invalid(what: &'static str, field: &str, value: String, expected: &str) -> MeshError {
    MeshError::Invalid {
        what,
        field: field.to_string(),
        value,
        expected: expected.to_string(),
    }
}

pub(super) fn vector(what: &'static str, field: &str, v: [f64; 3]) -> Result<Vec3, MeshError> {
    let v = Vec3::from(v);
    if v.iter().all(|c| c.is_finite()) {
        Ok(v)
    } else {
        Err(invalid(what, field, words(v), "three finite numbers"))
    }
}

pub(super) fn unit(what: &'static str, v: [f64; 3]) -> Result<Vec3, MeshError> {
    let v = vector(what, "normal", v)?;
    let scaled = v / v.amax();
    match scaled.try_normalize(0.0) {
        Some(n) if n.iter().all(|c| c.is_finite()) => Ok(n),
        _ => Err(invalid(what, "normal", words(v), "a direction (not zero)")),
    }
}

pub(super) fn not_negative(what: &'static str, field: &str, value: f64) -> Result<f64, MeshError> {
    if value.is_finite() && value >= 0.0 {
        Ok(value)
    } else {
        Err(invalid(
            what,
            field,
            value.to_string(),
            "zero or a positive number",
        ))
    }
}

/// Corners of a box; infinite ones are allowed, a minimum above its maximum is not.
pub(super) fn corners(
    what: &'static str,
    min: [f64; 3],
    max: [f64; 3],
) -> Result<[Vec3; 2], MeshError> {
    for a in 0..3 {
        if min[a].is_nan() || max[a].is_nan() || min[a] > max[a] {
            let value = format!("{} > {}", min[a], max[a]);
            return Err(invalid(
                what,
                &format!("min[{a}], max[{a}]"),
                value,
                "min <= max",
            ));
        }
    }
    Ok([Vec3::from(min), Vec3::from(max)])
}
