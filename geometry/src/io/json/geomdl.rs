//! JSON export of geomdl (NURBS-Python): `shape.data[]`, control points with the *second* direction fastest, not
//! multiplied by their weights.

use super::super::error::Fail;
use super::super::report::{Border, CadPatch, SkipKind, Skipped};
use super::{Content, counts, parse};
use crate::{NurbsPatch, Vec3};
use serde::Deserialize;
use serde::de::IgnoredAny;

#[derive(Deserialize)]
struct File {
    shape: Shape,
}

#[derive(Deserialize)]
struct Kind {
    shape: KindOfShape,
}

#[derive(Deserialize)]
struct KindOfShape {
    #[serde(rename = "type")]
    kind: String,
    data: Vec<IgnoredAny>,
}

#[derive(Deserialize)]
struct Shape {
    data: Vec<Surface>,
}

#[derive(Deserialize)]
#[serde(try_from = "RawSurface")]
struct Surface {
    name: Option<String>,
    trims: usize,
    patch: NurbsPatch,
}

#[derive(Deserialize)]
struct RawSurface {
    name: Option<String>,
    rational: Option<bool>,
    degree_u: usize,
    degree_v: usize,
    knotvector_u: Vec<f64>,
    knotvector_v: Vec<f64>,
    size_u: usize,
    size_v: usize,
    control_points: ControlPoints,
    trims: Option<Trims>,
}

#[derive(Deserialize)]
struct ControlPoints {
    points: Vec<Vec<f64>>,
    weights: Option<Vec<f64>>,
}

#[derive(Deserialize)]
struct Trims {
    #[serde(default)]
    data: Vec<IgnoredAny>,
}

impl TryFrom<RawSurface> for Surface {
    type Error = String;

    fn try_from(raw: RawSurface) -> Result<Self, String> {
        let ControlPoints { points, weights } = raw.control_points;
        let count = points.len();
        if raw.size_u.checked_mul(raw.size_v) != Some(count) {
            return Err(format!(
                "{count} control points, expected size_u * size_v = {} * {}",
                raw.size_u, raw.size_v
            ));
        }
        if let Some(weights) = weights.as_ref().filter(|w| w.len() != count) {
            return Err(format!(
                "{} weights, expected {count}, one for each point",
                weights.len()
            ));
        }
        if let Some((i, x)) = points.iter().enumerate().find(|(_, x)| x.len() != 3) {
            return Err(format!(
                "control point {} with {} numbers, expected [x, y, z]",
                i + 1,
                x.len()
            ));
        }
        let weights = weights.filter(|_| raw.rational != Some(false));
        // Ours run with the first direction fastest.
        let order =
            || (0..raw.size_v).flat_map(|j| (0..raw.size_u).map(move |i| i * raw.size_v + j));
        let net: Vec<Vec3> = order()
            .map(|k| Vec3::new(points[k][0], points[k][1], points[k][2]))
            .collect();
        let weights: Option<Vec<f64>> = weights.map(|w| order().map(|k| w[k]).collect());
        let patch = NurbsPatch::new(
            [raw.degree_u, raw.degree_v],
            [raw.knotvector_u, raw.knotvector_v],
            [raw.size_u, raw.size_v],
            &net,
            weights.as_deref(),
        )
        .map_err(|e| format!("{e}, expected a NURBS surface"))?;
        Ok(Self {
            name: raw.name,
            trims: raw.trims.map_or(0, |t| t.data.len()),
            patch,
        })
    }
}

pub fn read(bytes: &[u8]) -> Result<Content, Fail> {
    let kind = parse::<Kind>(bytes, "geomdl JSON")?.shape;
    if kind.kind != "surface" {
        // Curves and volumes: sound, but nothing to read.
        let skipped = (1..=kind.data.len()).map(|i| Skipped {
            entity: u32::try_from(i).unwrap_or(u32::MAX),
            type_number: 0,
            name: kind.kind.clone(),
            kind: SkipKind::Unsupported,
            reason: format!("a {}, only surfaces are read", kind.kind),
        });
        return Ok(Content {
            skipped: skipped.collect(),
            entities: counts(&[(kind.kind.as_str(), kind.data.len())]),
            ..Content::default()
        });
    }
    let file: File = parse(bytes, "geomdl JSON")?;
    let mut content = Content {
        entities: counts(&[("surface", file.shape.data.len())]),
        ..Content::default()
    };
    for (i, surface) in file.shape.data.into_iter().enumerate() {
        let entity = u32::try_from(i + 1).unwrap_or(u32::MAX);
        if surface.trims > 0 {
            content.skipped.push(Skipped {
                entity,
                type_number: 0,
                name: surface.name.unwrap_or_else(|| "surface".to_owned()),
                kind: SkipKind::Unsupported,
                reason: format!(
                    "trimmed ({} trim curves); trimmed surfaces are not read",
                    surface.trims
                ),
            });
            continue;
        }
        content.patches.push(CadPatch {
            patch: surface.patch,
            entity,
            type_number: 0,
            base: entity,
            instance: 0,
            border: Border::Natural,
            name: surface.name,
        });
    }
    Ok(content)
}
