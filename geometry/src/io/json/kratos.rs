//! `*.cad.json` of Kratos Multiphysics: `breps[].faces[].surface`, control points with the first direction fastest, not
//! multiplied by their weights.

use super::super::error::Fail;
use super::super::report::{Border, CadPatch, SkipKind, Skipped};
use super::{Content, counts, parse};
use crate::{NurbsPatch, Vec3};
use serde::Deserialize;
use serde::de::IgnoredAny;

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
    edges: Vec<IgnoredAny>,
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
    boundary_loops: Vec<IgnoredAny>,
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
    let mut position = 0;
    for face in file.breps.into_iter().flat_map(|b| b.faces) {
        position += 1;
        let entity = face.brep_id.unwrap_or(position);
        let loops = face.boundary_loops.len();
        // Untrimmed faces carry a loop along their own border; without the flag a loop may be any curve.
        let reason = match face.surface.is_trimmed {
            Some(true) => Some(format!(
                "trimmed ({loops} boundary loops); trimmed faces are not read"
            )),
            None if loops > 0 => Some(format!(
                "{loops} boundary loops and no is_trimmed; trimmed faces are not read"
            )),
            _ => None,
        };
        if let Some(reason) = reason {
            let name = face.name.unwrap_or_else(|| "face".to_owned());
            content.skipped.push(Skipped {
                entity,
                type_number: 0,
                name,
                kind: SkipKind::Unsupported,
                reason,
            });
            continue;
        }
        if face.swapped_surface_normal {
            content.notes.push(format!(
                "face {entity}: swapped_surface_normal is true; the patch has the normal of its parameters"
            ));
        }
        content.patches.push(CadPatch {
            patch: face.surface.patch,
            entity,
            type_number: 0,
            base: entity,
            instance: 0,
            border: Border::Natural,
            name: face.name,
        });
    }
    Ok(content)
}
