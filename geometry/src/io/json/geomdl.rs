//! JSON export of geomdl (NURBS-Python): `shape.data[]`, control points with the *second* direction fastest, not
//! multiplied by their weights.

use super::super::error::Fail;
use super::super::report::{CadPatch, CadTags, FaceBorder, SkipKind, Skipped};
use super::trims::{Side, trimmed};
use super::{Content, counts, parse};
use crate::curve::NurbsCurve;
use crate::io::brep::Grant;
use crate::{NurbsPatch, Vec3};
use nalgebra::Vector2;
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
    trims: Vec<TrimShape>,
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
    data: Vec<TrimShape>,
}

/// A closed trim curve: one NURBS curve, a polygon, or a chain of both.
#[derive(Deserialize)]
#[serde(try_from = "RawTrim")]
struct TrimShape {
    curves: Vec<NurbsCurve<2>>,
    /// What geomdl calls reversed: all outside of the curve is cut away, else all inside of it.
    outer: bool,
}

#[derive(Deserialize)]
struct RawTrim {
    #[serde(rename = "type")]
    kind: String,
    reversed: Option<Sense>,
    rational: Option<bool>,
    degree: Option<usize>,
    knotvector: Option<Vec<f64>>,
    control_points: Option<ControlPoints>,
    points: Option<Vec<Vec<f64>>>,
    data: Option<Vec<TrimShape>>,
}

/// geomdl writes 0 and 1.
#[derive(Deserialize)]
#[serde(untagged)]
enum Sense {
    Number(i64),
    Truth(bool),
}

impl TryFrom<RawTrim> for TrimShape {
    type Error = String;

    fn try_from(raw: RawTrim) -> Result<Self, String> {
        let plane = |points: Vec<Vec<f64>>| {
            points
                .iter()
                .enumerate()
                .map(|(i, x)| match x[..] {
                    [x, y] | [x, y, _] => Ok(Vector2::new(x, y)),
                    _ => Err(format!(
                        "point {} of a trim curve with {} numbers, expected [u, v]",
                        i + 1,
                        x.len()
                    )),
                })
                .collect::<Result<Vec<_>, _>>()
        };
        let missing = |key: &str| format!("a trim of type {} without `{key}`", raw.kind);
        let expected = |e| format!("{e}, expected a NURBS curve");
        let curves = match raw.kind.as_str() {
            "spline" => {
                let net = raw
                    .control_points
                    .ok_or_else(|| missing("control_points"))?;
                let points = plane(net.points)?;
                let weights = net.weights.filter(|_| raw.rational != Some(false));
                let degree = raw.degree.ok_or_else(|| missing("degree"))?;
                let knots = raw.knotvector.ok_or_else(|| missing("knotvector"))?;
                vec![
                    NurbsCurve::new(degree, knots, &points, weights.as_deref())
                        .map_err(expected)?,
                ]
            }
            "freeform" => {
                let mut points = plane(raw.points.ok_or_else(|| missing("points"))?)?;
                points.dedup();
                // A line through n points: knots 0, 0, 1, 2, ..., n - 1, n - 1.
                let last = points.len().saturating_sub(1) as f64;
                let inner = (0..points.len()).map(|k| k as f64);
                let knots = [0.0].into_iter().chain(inner).chain([last]).collect();
                vec![NurbsCurve::new(1, knots, &points, None).map_err(expected)?]
            }
            "container" => {
                let parts = raw.data.ok_or_else(|| missing("data"))?;
                parts.into_iter().flat_map(|part| part.curves).collect()
            }
            other => {
                return Err(format!(
                    "a trim of type \"{other}\", expected \"spline\", \"freeform\" or \"container\""
                ));
            }
        };
        Ok(Self {
            curves,
            outer: matches!(raw.reversed, Some(Sense::Number(1..) | Sense::Truth(true))),
        })
    }
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
            trims: raw.trims.map_or(Vec::new(), |t| t.data),
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
    let grant = Grant::of_length(bytes.len());
    for (i, surface) in file.shape.data.into_iter().enumerate() {
        let entity = u32::try_from(i + 1).unwrap_or(u32::MAX);
        let loops = |outer: bool| {
            let trims = surface.trims.iter().filter(move |t| t.outer == outer);
            trims.map(|trim| {
                let side = |curve: &NurbsCurve<2>| Side {
                    curve: curve.clone(),
                    space: None,
                    backwards: false,
                    entity: 0,
                };
                trim.curves.iter().map(side).collect::<Vec<_>>()
            })
        };
        let has_outer = surface.trims.iter().any(|t| t.outer);
        let all: Vec<_> = loops(true).chain(loops(false)).collect();
        let name = format!("surface {entity}");
        let read = match all.is_empty() {
            true => Ok((surface.patch, FaceBorder::Natural)),
            false => trimmed(&mut content, &grant, &name, surface.patch, all, has_outer),
        };
        let (patch, border) = match read {
            Ok(read) => read,
            Err(reason) => {
                content.skipped.push(Skipped {
                    entity,
                    type_number: 0,
                    name: surface.name.unwrap_or_else(|| "surface".to_owned()),
                    kind: SkipKind::Boundary,
                    reason: format!("its trim curves give no trim: {reason}"),
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
            name: surface.name,
            tags: CadTags::default(),
        });
    }
    Ok(content)
}
