//! `*.cad.json` of Kratos Multiphysics: `breps[].faces[].surface`, control points with the first direction fastest, not
//! multiplied by their weights.

use super::super::error::Fail;
use super::super::report::{CadPatch, CadTags, FaceBorder, SkipKind, Skipped};
use super::trims::{Part, trimmed};
use super::{Content, counts, parse};
use crate::curve::NurbsCurve;
use crate::{NurbsPatch, Vec3};
use nalgebra::Vector2;
use serde::Deserialize;
use serde::de::IgnoredAny;
use std::collections::BTreeMap;

#[derive(Deserialize)]
struct File {
    breps: Vec<Brep>,
    tolerances: Option<Tolerances>,
}

#[derive(Deserialize)]
struct Tolerances {
    model_tolerance: Option<f64>,
}

#[derive(Deserialize)]
struct Brep {
    #[serde(default)]
    faces: Vec<Face>,
    #[serde(default)]
    edges: Vec<Edge>,
    #[serde(default)]
    vertices: Vec<IgnoredAny>,
}

#[derive(Deserialize)]
struct Face {
    brep_id: Option<u32>,
    name: Option<String>,
    #[serde(default)]
    swapped_surface_normal: bool,
    surface: Surface,
    #[serde(default)]
    boundary_loops: Vec<Loop>,
}

/// An edge couples the trim curves of the faces that meet at it.
#[derive(Deserialize)]
struct Edge {
    brep_id: Option<u32>,
    #[serde(default)]
    topology: Vec<Side>,
}

#[derive(Deserialize)]
struct Side {
    /// The face.
    brep_id: u32,
    trim_index: Option<u32>,
}

#[derive(Deserialize)]
struct Loop {
    loop_type: Option<String>,
    #[serde(default)]
    trimming_curves: Vec<TrimmingCurve>,
}

#[derive(Deserialize)]
struct TrimmingCurve {
    trim_index: Option<u32>,
    curve_direction: Option<bool>,
    parameter_curve: ParameterCurve,
}

#[derive(Deserialize)]
#[serde(try_from = "RawCurve")]
struct ParameterCurve(NurbsCurve<2>);

#[derive(Deserialize)]
struct RawCurve {
    is_rational: Option<bool>,
    degree: usize,
    knot_vector: Vec<f64>,
    active_range: Option<[f64; 2]>,
    control_points: Vec<(IgnoredAny, Vec<f64>)>,
}

impl TryFrom<RawCurve> for ParameterCurve {
    type Error = String;

    fn try_from(raw: RawCurve) -> Result<Self, String> {
        let mut points = Vec::with_capacity(raw.control_points.len());
        let mut weights = Vec::with_capacity(raw.control_points.len());
        for (i, (_, x)) in raw.control_points.iter().enumerate() {
            let weight = match x[..] {
                [_, _] | [_, _, _] => 1.0,
                [_, _, _, w] if raw.is_rational != Some(false) || w == 1.0 => w,
                [_, _, _, w] => {
                    return Err(format!(
                        "control point {} with weight {w}, expected 1 as is_rational is false",
                        i + 1
                    ));
                }
                _ => {
                    return Err(format!(
                        "control point {} with {} numbers, expected [x, y, z, w]",
                        i + 1,
                        x.len()
                    ));
                }
            };
            points.push(Vector2::new(x[0], x[1]));
            weights.push(weight);
        }
        let expected = |e| format!("{e}, expected a NURBS curve");
        let curve = NurbsCurve::new(raw.degree, raw.knot_vector, &points, Some(&weights))
            .map_err(expected)?;
        match raw.active_range {
            None => Ok(Self(curve)),
            Some([a, b]) => curve
                .with_domain([a.min(b), a.max(b)])
                .map(Self)
                .map_err(expected),
        }
    }
}

#[derive(Deserialize)]
#[serde(try_from = "RawSurface")]
struct Surface {
    is_trimmed: Option<bool>,
    patch: NurbsPatch,
}

#[derive(Deserialize)]
struct RawSurface {
    is_trimmed: Option<bool>,
    is_rational: Option<bool>,
    degrees: [usize; 2],
    knot_vectors: [Vec<f64>; 2],
    control_points: Vec<(IgnoredAny, Vec<f64>)>,
}

impl TryFrom<RawSurface> for Surface {
    type Error = String;

    fn try_from(raw: RawSurface) -> Result<Self, String> {
        let mut counts = [0; 2];
        for (d, count) in counts.iter_mut().enumerate() {
            let (knots, degree) = (raw.knot_vectors[d].len(), raw.degrees[d]);
            let needed = degree.saturating_mul(2).saturating_add(2);
            if knots < needed {
                return Err(format!(
                    "{knots} knots in direction {}, expected at least {needed} for degree {degree}",
                    d + 1
                ));
            }
            *count = knots - degree - 1;
        }
        let mut points = Vec::with_capacity(raw.control_points.len());
        let mut weights = Vec::with_capacity(raw.control_points.len());
        for (i, (_, x)) in raw.control_points.iter().enumerate() {
            let weight = match x[..] {
                [_, _, _] => 1.0,
                [_, _, _, w] if raw.is_rational != Some(false) => w,
                [_, _, _, w] if w == 1.0 => w,
                [_, _, _, w] => {
                    return Err(format!(
                        "control point {} with weight {w}, expected 1 as is_rational is false",
                        i + 1
                    ));
                }
                _ => {
                    return Err(format!(
                        "control point {} with {} numbers, expected [x, y, z, w]",
                        i + 1,
                        x.len()
                    ));
                }
            };
            points.push(Vec3::new(x[0], x[1], x[2]));
            weights.push(weight);
        }
        let patch = NurbsPatch::new(
            raw.degrees,
            raw.knot_vectors,
            counts,
            &points,
            Some(&weights),
        )
        .map_err(|e| format!("{e}, expected a NURBS surface"))?;
        Ok(Self {
            is_trimmed: raw.is_trimmed,
            patch,
        })
    }
}

pub fn read(bytes: &[u8]) -> Result<Content, Fail> {
    let file: File = parse(bytes, "Kratos CAD JSON")?;
    let mut content = Content {
        resolution: file
            .tolerances
            .and_then(|t| t.model_tolerance)
            .filter(|t| *t > 0.0),
        entities: counts(&[
            ("face", file.breps.iter().map(|b| b.faces.len()).sum()),
            ("edge", file.breps.iter().map(|b| b.edges.len()).sum()),
            ("vertex", file.breps.iter().map(|b| b.vertices.len()).sum()),
        ]),
        ..Content::default()
    };
    // Which edge a trim curve belongs to, by face and number of the curve.
    let mut edges = BTreeMap::new();
    for edge in file.breps.iter().flat_map(|b| &b.edges) {
        for side in &edge.topology {
            if let (Some(id), Some(trim)) = (edge.brep_id, side.trim_index) {
                edges.insert((side.brep_id, trim), id);
            }
        }
    }
    let mut position = 0;
    for face in file.breps.into_iter().flat_map(|b| b.faces) {
        position += 1;
        let entity = face.brep_id.unwrap_or(position);
        // Untrimmed faces carry a loop along their own border.
        let read = match face.surface.is_trimmed {
            Some(false) => Ok((face.surface.patch, FaceBorder::Natural, Vec::new())),
            Some(true) if face.boundary_loops.is_empty() => {
                Err("is_trimmed is true, but there are no boundary loops".to_owned())
            }
            _ => trim(&face.surface.patch, face.boundary_loops, |index| {
                edges.get(&(entity, index)).copied().unwrap_or(0)
            }),
        };
        let (patch, border, notes) = match read {
            Ok(read) => read,
            Err(reason) => {
                content.skipped.push(Skipped {
                    entity,
                    type_number: 0,
                    name: face.name.unwrap_or_else(|| "face".to_owned()),
                    kind: SkipKind::Boundary,
                    reason: format!("its boundary gives no trim: {reason}"),
                });
                continue;
            }
        };
        let notes = notes.into_iter().map(|n| format!("face {entity}: {n}"));
        content.notes.extend(notes);
        if face.swapped_surface_normal {
            content.notes.push(format!(
                "face {entity}: swapped_surface_normal is true; the patch has the normal of its parameters"
            ));
        }
        content.patches.push(CadPatch {
            patch,
            entity,
            type_number: 0,
            base: entity,
            instance: 0,
            border,
            name: face.name,
            tags: CadTags::default(),
        });
    }
    Ok(content)
}

/// The patch with its boundary loops, the outer ones first; `edge` gives the edge of a trim curve.
fn trim(
    patch: &NurbsPatch,
    loops: Vec<Loop>,
    edge: impl Fn(u32) -> u32,
) -> Result<(NurbsPatch, FaceBorder, Vec<String>), String> {
    let mut sorted = [Vec::new(), Vec::new()];
    for (number, a_loop) in loops.into_iter().enumerate() {
        let inner = match a_loop.loop_type.as_deref() {
            Some("outer") => 0,
            Some("inner") => 1,
            // Without a word the first bounds the surface.
            None => usize::from(number > 0),
            Some(other) => {
                return Err(format!(
                    "loop_type \"{other}\", expected \"outer\" or \"inner\""
                ));
            }
        };
        let parts = a_loop.trimming_curves.into_iter().map(|c| Part {
            curve: c.parameter_curve.0,
            backwards: c.curve_direction == Some(false),
            entity: c.trim_index.map_or(0, &edge),
        });
        sorted[inner].push(parts.collect::<Vec<_>>());
    }
    let [mut outer, inner] = sorted;
    let has_outer = !outer.is_empty();
    outer.extend(inner);
    trimmed(patch, outer, has_outer)
}
