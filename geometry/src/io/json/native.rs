//! Our own JSON format: whatever a [`CadFile`] holds of its patches, bit for bit.
//!
//! ```json
//! {"covact_geometry": 1, "unit": "mm", "resolution": null, "bodies": [], "patches": [
//! {"entity": 1, "degree": [1, 1], "knots": [[0.0, 0.0, 1.0, 1.0], [0.0, 0.0, 1.0, 1.0]],
//!  "domain": [[0.0, 1.0], [0.0, 1.0]], "points": [[0.0, 0.0, 0.0, 1.0], ...],
//!  "trim": [[{"degree": 1, "knots": [...], "domain": [0.0, 1.0], "points": [[0.0, 0.0, 1.0], ...]}, ...]]}
//! ]}
//! ```
//!
//! Points are homogeneous, (w x, w y, w z, w) with the first direction fastest, those of curves in the parameter plane
//! (w x, w y, w): so nothing is divided, and reading gives back every bit. Knot vectors are full, `domain` may be a part of
//! what they allow.

use super::super::error::Fail;
use super::super::report::{CadBody, CadFile, CadPatch, CadTags, FaceBorder};
use super::{Content, LengthUnit, counts, parse};
use crate::basis::Basis;
use crate::curve::{CurveError, NurbsCurve};
use crate::trim::{Trim, TrimCurve, TrimLoop};
use crate::{NurbsPatch, Surface};
use serde::de::IgnoredAny;
use serde::{Deserialize, Serialize};

/// Names the format; its value is the version.
pub const KEY: &str = "covact_geometry";
const VERSION: u32 = 1;
/// Gaps of a loop, as shares of the domain, that may be in a trim that was valid when it was written.
const GAP: f64 = 1e-5;

/// Only the version, so that a later format is named as such, not by its unknown fields.
#[derive(Deserialize)]
struct Version {
    covact_geometry: u32,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct File {
    #[serde(rename = "covact_geometry")]
    _version: IgnoredAny,
    unit: Option<String>,
    resolution: Option<f64>,
    #[serde(default)]
    bodies: Vec<RawBody>,
    patches: Vec<Patch>,
}

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct RawBody {
    name: Option<String>,
    #[serde(default)]
    path: Vec<String>,
    entity: u32,
    #[serde(default)]
    instance: u32,
    solid: bool,
    #[serde(default)]
    skipped: usize,
}

#[derive(Deserialize)]
#[serde(try_from = "RawPatch")]
struct Patch(CadPatch);

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct RawPatch {
    entity: u32,
    #[serde(default)]
    type_number: u32,
    base: Option<u32>,
    #[serde(default)]
    instance: u32,
    name: Option<String>,
    /// Index in the list of bodies.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    body: Option<usize>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    layer: Option<String>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    colour: Option<String>,
    /// The border was a rectangle of parameters in the file that the patch came from.
    #[serde(default)]
    rectangle: bool,
    degree: [usize; 2],
    knots: [Vec<f64>; 2],
    domain: Option<[[f64; 2]; 2]>,
    points: Vec<[f64; 4]>,
    #[serde(default)]
    trim: Vec<Vec<RawTrimCurve>>,
}

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct RawTrimCurve {
    degree: usize,
    knots: Vec<f64>,
    domain: Option<[f64; 2]>,
    points: Vec<[f64; 3]>,
    space: Option<RawSpaceCurve>,
    #[serde(default)]
    entity: u32,
}

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct RawSpaceCurve {
    degree: usize,
    knots: Vec<f64>,
    domain: Option<[f64; 2]>,
    points: Vec<[f64; 4]>,
}

/// The basis of some knots, cut to a domain where one is given.
fn basis(
    degree: usize,
    knots: Vec<f64>,
    domain: Option<[f64; 2]>,
) -> Result<Basis, crate::basis::KnotError> {
    let count = knots.len().saturating_sub(degree.saturating_add(1));
    let basis = Basis::new(degree, knots, count)?;
    match domain {
        Some(domain) => basis.with_domain(domain),
        None => Ok(basis),
    }
}

fn curve<const D: usize>(
    degree: usize,
    knots: Vec<f64>,
    domain: Option<[f64; 2]>,
    points: Vec<[f64; 4]>,
) -> Result<NurbsCurve<D>, CurveError> {
    NurbsCurve::from_homogeneous(basis(degree, knots, domain)?, points)
}

impl TryFrom<RawTrimCurve> for TrimCurve {
    type Error = CurveError;

    fn try_from(raw: RawTrimCurve) -> Result<Self, CurveError> {
        let points = raw.points.iter().map(|&[x, y, w]| [x, y, 0.0, w]).collect();
        let space = raw
            .space
            .map(|c| curve(c.degree, c.knots, c.domain, c.points));
        Ok(TrimCurve {
            parameter: curve(raw.degree, raw.knots, raw.domain, points)?,
            space: space.transpose()?,
            entity: raw.entity,
        })
    }
}

impl TryFrom<RawPatch> for Patch {
    type Error = String;

    fn try_from(raw: RawPatch) -> Result<Self, String> {
        let [knots1, knots2] = raw.knots;
        let domain = |k: usize| raw.domain.map(|d| d[k]);
        let one = |k: usize, knots| {
            basis(raw.degree[k], knots, domain(k))
                .map_err(|e| format!("direction {}: {e}, expected a NURBS surface", k + 1))
        };
        let patch = NurbsPatch::from_homogeneous([one(0, knots1)?, one(1, knots2)?], raw.points)
            .map_err(|e| format!("{e}, expected a NURBS surface"))?;
        let mut loops = Vec::with_capacity(raw.trim.len());
        for (number, curves) in raw.trim.into_iter().enumerate() {
            let mut list = Vec::with_capacity(curves.len());
            for (k, curve) in curves.into_iter().enumerate() {
                list.push(TrimCurve::try_from(curve).map_err(|e| {
                    format!("curve {k} of trim loop {number}: {e}, expected a NURBS curve")
                })?);
            }
            loops.push(TrimLoop { curves: list });
        }
        let trim = match loops.is_empty() {
            true => None,
            false => Some(
                Trim::new(loops, patch.domain(), GAP)
                    .map_err(|e| format!("{e}, expected closed trim loops"))?,
            ),
        };
        Ok(Patch(CadPatch {
            entity: raw.entity,
            type_number: raw.type_number,
            base: raw.base.unwrap_or(raw.entity),
            instance: raw.instance,
            border: match (&trim, raw.rectangle) {
                (Some(_), _) => FaceBorder::Trimmed,
                (None, true) => FaceBorder::Rectangle,
                (None, false) => FaceBorder::Natural,
            },
            name: raw.name,
            tags: CadTags {
                body: raw.body,
                layer: raw.layer,
                colour: raw.colour,
            },
            patch: patch.with_trim(trim),
        }))
    }
}

pub fn read(bytes: &[u8]) -> Result<Content, Fail> {
    let version = parse::<Version>(bytes, "covact JSON")?.covact_geometry;
    if version != VERSION {
        return Err(Fail::new(
            (1, 1),
            format!("version {VERSION} of the format \"{KEY}\""),
            format!("version {version}"),
        ));
    }
    let file: File = parse(bytes, "covact JSON")?;
    let unit = match file.unit {
        None => None,
        Some(name) => Some(LengthUnit::from_name(&name).ok_or_else(|| {
            let known = LengthUnit::names();
            Fail::new(
                (1, 1),
                format!("a unit of {}", known.join(", ")),
                format!("`{name}`"),
            )
        })?),
    };
    let patches: Vec<CadPatch> = file.patches.into_iter().map(|p| p.0).collect();
    let count = file.bodies.len();
    if let Some(k) = patches
        .iter()
        .filter_map(|p| p.tags.body)
        .find(|&k| k >= count)
    {
        return Err(Fail::new(
            (1, 1),
            format!("the number of one of {count} bodies"),
            format!("a patch of body {k}"),
        ));
    }
    let bodies = file.bodies.into_iter().enumerate().map(|(k, b)| CadBody {
        name: b.name,
        path: b.path,
        entity: b.entity,
        instance: b.instance,
        solid: b.solid,
        faces: patches.iter().filter(|p| p.tags.body == Some(k)).count(),
        skipped: b.skipped,
    });
    Ok(Content {
        entities: counts(&[("patch", patches.len())]),
        bodies: bodies.collect(),
        patches,
        resolution: file.resolution.filter(|r| *r > 0.0),
        unit,
        ..Content::default()
    })
}

fn raw(patch: &CadPatch) -> RawPatch {
    let p = &patch.patch;
    let space = |c: &NurbsCurve<3>| RawSpaceCurve {
        degree: c.degree(),
        knots: c.basis().knots().to_vec(),
        domain: Some(c.domain()),
        points: c.homogeneous().to_vec(),
    };
    let curve = |c: &TrimCurve| RawTrimCurve {
        degree: c.parameter.degree(),
        knots: c.parameter.basis().knots().to_vec(),
        domain: Some(c.parameter.domain()),
        points: c
            .parameter
            .homogeneous()
            .iter()
            .map(|p| [p[0], p[1], p[3]])
            .collect(),
        space: c.space.as_ref().map(space),
        entity: c.entity,
    };
    RawPatch {
        entity: patch.entity,
        type_number: patch.type_number,
        base: Some(patch.base),
        instance: patch.instance,
        name: patch.name.clone(),
        body: patch.tags.body,
        layer: patch.tags.layer.clone(),
        colour: patch.tags.colour.clone(),
        rectangle: patch.border == FaceBorder::Rectangle,
        degree: p.degree(),
        knots: [p.knots(0).to_vec(), p.knots(1).to_vec()],
        domain: Some(Surface::domain(p)),
        points: p.homogeneous().to_vec(),
        trim: p.trim().map_or(Vec::new(), |t| {
            t.loops()
                .iter()
                .map(|l| l.curves.iter().map(curve).collect())
                .collect()
        }),
    }
}

/// The patches of a file as JSON in our own format, one line per patch: [`read_json`](super::read_json) gives back the same
/// patches, trims, bodies, names, layers, colours, unit and resolution, every number bit for bit. The account of what the file held besides (entities,
/// skipped surfaces, notes) is not written.
///
/// # Errors
/// Those of the JSON library; none is known to occur.
pub fn write_json(file: &CadFile) -> Result<String, serde_json::Error> {
    let unit = file.unit.to_metre.map(|_| file.unit.name.as_str());
    let bodies = file.bodies.iter().map(|b| RawBody {
        name: b.name.clone(),
        path: b.path.clone(),
        entity: b.entity,
        instance: b.instance,
        solid: b.solid,
        skipped: b.skipped,
    });
    let bodies: Vec<RawBody> = bodies.collect();
    let mut out = format!(
        "{{\"{KEY}\": {VERSION}, \"unit\": {}, \"resolution\": {}, \"bodies\": {}, \"patches\": [",
        serde_json::to_string(&unit)?,
        serde_json::to_string(&file.resolution)?,
        serde_json::to_string(&bodies)?
    );
    for (k, patch) in file.patches.iter().enumerate() {
        out += if k == 0 { "\n" } else { ",\n" };
        out += &serde_json::to_string(&raw(patch))?;
    }
    out += "\n]}\n";
    Ok(out)
}
