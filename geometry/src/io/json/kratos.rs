//! `*.cad.json` of Kratos Multiphysics: `breps[].faces[].surface`, control points with the first direction fastest, not
//! multiplied by their weights.

use super::super::error::Fail;
use super::super::report::{CadPatch, CadTags, FaceBorder, SkipKind, Skipped};
use super::trims::{Side as Border, trimmed};
use super::{Content, counts, parse};
use crate::curve::NurbsCurve;
use crate::io::brep::Grant;
use crate::{NurbsPatch, Vec3};
use nalgebra::SVector;
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
    #[serde(rename = "3d_curve")]
    space: Option<SpaceCurve>,
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
#[serde(try_from = "RawCurve")]
struct SpaceCurve(NurbsCurve<3>);

#[derive(Deserialize)]
struct RawCurve {
    is_rational: Option<bool>,
    degree: usize,
    knot_vector: Vec<f64>,
    active_range: Option<[f64; 2]>,
    control_points: Vec<(IgnoredAny, Vec<f64>)>,
}

impl RawCurve {
    /// The curve in `D` dimensions, which are the first numbers of its control points.
    fn curve<const D: usize>(self) -> Result<NurbsCurve<D>, String> {
        let mut points = Vec::with_capacity(self.control_points.len());
        let mut weights = Vec::with_capacity(self.control_points.len());
        for (i, (_, x)) in self.control_points.iter().enumerate() {
            let weight = match x[..] {
                [_, _] if D == 2 => 1.0,
                [_, _, _] => 1.0,
                [_, _, _, w] if self.is_rational != Some(false) || w == 1.0 => w,
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
            points.push(SVector::from_fn(|k, _| x[k]));
            weights.push(weight);
        }
        let expected = |e| format!("{e}, expected a NURBS curve");
        let curve = NurbsCurve::new(self.degree, self.knot_vector, &points, Some(&weights))
            .map_err(expected)?;
        match self.active_range {
            None => Ok(curve),
            Some([a, b]) => curve.with_domain([a.min(b), a.max(b)]).map_err(expected),
        }
    }
}

impl TryFrom<RawCurve> for ParameterCurve {
    type Error = String;

    fn try_from(raw: RawCurve) -> Result<Self, String> {
        raw.curve().map(Self)
    }
}

impl TryFrom<RawCurve> for SpaceCurve {
    type Error = String;

    fn try_from(raw: RawCurve) -> Result<Self, String> {
        raw.curve().map(Self)
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
                let space = edge.space.as_ref().map(|c| c.0.clone());
                edges.insert((side.brep_id, trim), (id, space));
            }
        }
    }
    let grant = Grant::of_length(bytes.len());
    let mut position = 0;
    for face in file.breps.into_iter().flat_map(|b| b.faces) {
        position += 1;
        let entity = face.brep_id.unwrap_or(position);
        // Untrimmed faces carry a loop along their own border.
        let read = match face.surface.is_trimmed {
            Some(false) => Ok((face.surface.patch, FaceBorder::Natural)),
            Some(true) if face.boundary_loops.is_empty() => {
                Err("is_trimmed is true, but there are no boundary loops".to_owned())
            }
            _ => sorted(face.boundary_loops, |index| {
                edges.get(&(entity, index)).cloned().unwrap_or_default()
            })
            .and_then(|(sides, outer)| {
                let name = format!("face {entity}");
                trimmed(
                    &mut content,
                    &grant,
                    &name,
                    face.surface.patch,
                    sides,
                    outer,
                )
            }),
        };
        let read = read.and_then(|(patch, border)| match face.swapped_surface_normal {
            true => Ok((patch.reversed(0).map_err(|e| e.to_string())?, border)),
            false => Ok((patch, border)),
        });
        let (patch, border) = match read {
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

/// The boundary loops of a face, the outer ones first, and whether there are any of these; `edge` gives the number of the edge
/// of a trim curve and the curve of the edge in space.
fn sorted(
    loops: Vec<Loop>,
    edge: impl Fn(u32) -> (u32, Option<NurbsCurve<3>>),
) -> Result<(Vec<Vec<Border>>, bool), String> {
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
        let sides = a_loop.trimming_curves.into_iter().map(|c| {
            let (entity, space) = c.trim_index.map_or((0, None), &edge);
            Border {
                curve: c.parameter_curve.0,
                space,
                backwards: c.curve_direction == Some(false),
                entity,
            }
        });
        sorted[inner].push(sides.collect::<Vec<_>>());
    }
    let [mut outer, inner] = sorted;
    let has_outer = !outer.is_empty();
    outer.extend(inner);
    Ok((outer, has_outer))
}
