//! Writes patches as IGES 5.3: rational B-spline surfaces (128), trimmed ones as faces (144) with boundaries (142) of
//! B-spline curves (126) in the parameter plane and, where they are known, in space.

use super::super::report::{CadFile, CadPatch};
use crate::{NurbsCurve, NurbsPatch, TrimCurve, Vec3};
use std::fmt::Write;

/// Why a file cannot be written as IGES.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum IgesWriteError {
    /// IGES knows the unit of every file.
    #[error("{path}: the file states no length unit, and IGES must name one")]
    Unit {
        /// Path or name of the file.
        path: String,
    },
    /// The unit is none that IGES has a flag for.
    #[error("{path}: IGES has no flag for the length unit {unit}")]
    UnknownUnit {
        /// Path or name of the file.
        path: String,
        /// Name of the unit.
        unit: String,
    },
    /// A patch that cannot be cut to its domain, or a trim that cannot be turned.
    #[error("{path}: entity {entity}: {reason}")]
    Patch {
        /// Path or name of the file.
        path: String,
        /// Number of the face.
        entity: u32,
        /// Why not.
        reason: String,
    },
}

/// Unit flags of IGES (global parameter 14) and their names (parameter 15).
const UNITS: [(&str, u32, &str); 10] = [
    ("in", 1, "IN"),
    ("mm", 2, "MM"),
    ("ft", 4, "FT"),
    ("mi", 5, "MI"),
    ("m", 6, "M"),
    ("km", 7, "KM"),
    ("mil", 8, "MIL"),
    ("um", 9, "UM"),
    ("cm", 10, "CM"),
    ("uin", 11, "UIN"),
];
/// Independent of others; physically dependent; physically dependent curve of the parameter plane.
const FREE: &str = "00000000";
const PART: &str = "00010000";
const PLANE: &str = "00010500";
/// Curves in space are written for boundaries whose ends all lie where the curves in the parameter plane end, within this
/// share of the size of the surface: a reader that is given both and finds them apart may mend the wrong one.
const AGREE: f64 = 1e-5;
/// Columns of data in a record of parameters.
const WIDTH: usize = 64;

/// The patches of a file as text of IGES 5.3, in the unit of the file and with all their digits. What belongs to one surface
/// in several pieces becomes one face for each. Names are cut to the eight characters of a label.
///
/// # Errors
/// A unit that IGES does not know, and none; patches that cannot be cut to their domain.
pub fn write_iges(file: &CadFile) -> Result<String, IgesWriteError> {
    let path = || file.path.clone();
    let known = UNITS.iter().find(|u| u.0 == file.unit.name);
    let Some(&(_, flag, unit)) = known else {
        return Err(match file.unit.to_metre {
            None => IgesWriteError::Unit { path: path() },
            Some(_) => IgesWriteError::UnknownUnit {
                path: path(),
                unit: file.unit.name.clone(),
            },
        });
    };
    let mut writer = Writer::default();
    let mut most = 0.0f64;
    for patch in &file.patches {
        let whole = writer.patch(patch);
        whole.map_err(|reason| IgesWriteError::Patch {
            path: path(),
            entity: patch.entity,
            reason,
        })?;
        let points = patch.patch.points().into_iter();
        most = points.fold(most, |most, x| most.max(x.amax()));
    }
    let resolution = file.resolution.unwrap_or(1e-9 * most);
    let system = concat!("covact-geometry ", env!("CARGO_PKG_VERSION"));
    let global = [
        "1H,".to_owned(),
        "1H;".to_owned(),
        text(system),
        text(""),
        text(system),
        text(system),
        "32,308,15,308,15".to_owned(),
        text(""),
        "1.".to_owned(),
        flag.to_string(),
        text(unit),
        "1,0.".to_owned(),
        text(""),
        real(resolution),
        real(most),
        text(""),
        text(""),
        "11,0".to_owned(),
    ];
    Ok(writer.text(&format!("{};", global.join(","))))
}

/// A string as IGES writes it; one of no characters is left out.
fn text(value: &str) -> String {
    match value.len() {
        0 => String::new(),
        n => format!("{n}H{value}"),
    }
}

/// A number with all its digits.
fn real(x: f64) -> String {
    // -0.0 and 0.0 are one.
    let short = format!("{:?}", x + 0.0);
    match short.split_once('e') {
        None => short
            .strip_suffix(".0")
            .map_or(short.clone(), |s| format!("{s}.")),
        Some((digits, power)) if digits.contains('.') => format!("{digits}E{power}"),
        Some((digits, power)) => format!("{digits}.E{power}"),
    }
}

/// Directory and parameter sections in the making.
#[derive(Default)]
struct Writer {
    directory: String,
    parameters: String,
    entities: usize,
    lines: usize,
}

impl Writer {
    /// Adds an entity and gives its number in the directory.
    fn entity(&mut self, kind: u32, status: &str, label: &str, values: &[String]) -> usize {
        let number = 2 * self.entities + 1;
        self.entities += 1;
        let first = self.lines + 1;
        let mut line = format!("{kind}");
        let last = values.len();
        for (k, value) in values.iter().enumerate() {
            line.push(',');
            // Values are not parted, so a line ends where the next one does not fit, its separator included.
            let needed = value.len() + 1;
            if line.len() + needed > WIDTH {
                self.record(&line, number);
                line.clear();
            }
            line.push_str(value);
            if k + 1 == last {
                line.push(';');
            }
        }
        self.record(&line, number);
        let count = self.lines + 1 - first;
        // Writing into a string cannot fail.
        let _ = writeln!(
            self.directory,
            "{kind:>8}{first:>8}{z:>8}{z:>8}{z:>8}{z:>8}{z:>8}{z:>8}{status:>8}D{number:>7}",
            z = 0
        );
        let _ = writeln!(
            self.directory,
            "{kind:>8}{z:>8}{z:>8}{count:>8}{z:>8}{b:>8}{b:>8}{label:>8}{z:>8}D{next:>7}",
            z = 0,
            b = "",
            next = number + 1
        );
        number
    }

    fn record(&mut self, line: &str, number: usize) {
        self.lines += 1;
        let _ = writeln!(
            self.parameters,
            "{line:<WIDTH$}{number:>8}P{:>7}",
            self.lines
        );
    }

    fn text(&self, global: &str) -> String {
        let mut out = format!("{:<72}S{:>7}\n", "Faces as rational B-spline surfaces", 1);
        let rows: Vec<&[u8]> = global.as_bytes().chunks(72).collect();
        for (k, row) in rows.iter().enumerate() {
            let row = String::from_utf8_lossy(row);
            let _ = writeln!(out, "{row:<72}G{:>7}", k + 1);
        }
        out.push_str(&self.directory);
        out.push_str(&self.parameters);
        let ends = format!(
            "S{:>7}G{:>7}D{:>7}P{:>7}",
            1,
            rows.len(),
            2 * self.entities,
            self.lines
        );
        let _ = writeln!(out, "{ends:<72}T{:>7}", 1);
        out
    }

    fn patch(&mut self, face: &CadPatch) -> Result<(), String> {
        let name = face.name.as_deref().unwrap_or_default();
        let plain = name.chars().filter(|c| c.is_ascii_graphic());
        let label: String = plain.take(8).collect();
        let patch = face.patch.cut_to_domain().map_err(|e| e.to_string())?;
        let Some(trim) = patch.trim() else {
            self.surface(&patch, FREE, &label);
            return Ok(());
        };
        let loops: Vec<Ring> = trim.loops().iter().map(|l| Ring::of(&l.curves)).collect();
        let depth: Vec<usize> = (0..loops.len())
            .map(|k| {
                (0..loops.len())
                    .filter(|&o| loops[o].holds(&loops[k]))
                    .count()
            })
            .collect();
        let surface = self.surface(&patch, PART, "");
        for (outer, ring) in loops
            .iter()
            .enumerate()
            .filter(|(k, _)| depth[*k].is_multiple_of(2))
        {
            let inside = |&k: &usize| depth[k] == depth[outer] + 1 && ring.holds(&loops[k]);
            let holes: Vec<usize> = (0..loops.len()).filter(inside).collect();
            let mut values = vec![
                surface.to_string(),
                "1".to_owned(),
                holes.len().to_string(),
                self.boundary(surface, &patch, ring, true)?.to_string(),
            ];
            for hole in holes {
                let inner = self.boundary(surface, &patch, &loops[hole], false)?;
                values.push(inner.to_string());
            }
            self.entity(144, FREE, &label, &values);
        }
        Ok(())
    }

    /// A rational B-spline surface.
    fn surface(&mut self, patch: &NurbsPatch, status: &str, label: &str) -> usize {
        let counts = patch.counts();
        let points = patch.points();
        let flag = |yes: bool| String::from(if yes { "1" } else { "0" });
        let size = |edge: &[Vec3; 2]| (edge[0] - edge[1]).amax();
        let largest = points.iter().fold(0.0f64, |most, x| most.max(x.amax()));
        let closed = |dir: usize| {
            let ends = |k: usize| match dir {
                0 => [points[counts[0] * k], points[counts[0] * (k + 1) - 1]],
                _ => [points[k], points[k + counts[0] * (counts[1] - 1)]],
            };
            (0..counts[1 - dir]).all(|k| size(&ends(k)) <= 1e-12 * largest)
        };
        let mut values: Vec<String> = Vec::new();
        values.extend(counts.map(|n| (n - 1).to_string()));
        values.extend(patch.degree().map(|p| p.to_string()));
        values.extend([0, 1].map(|dir| flag(closed(dir))));
        values.push(flag(!patch.is_rational()));
        values.extend(["0".to_owned(), "0".to_owned()]);
        for dir in 0..2 {
            values.extend(patch.knots(dir).iter().map(|&x| real(x)));
        }
        values.extend(patch.weights().into_iter().map(real));
        values.extend(points.iter().flat_map(|x| [x.x, x.y, x.z]).map(real));
        values.extend(patch.domain().concat().into_iter().map(real));
        self.entity(128, status, label, &values)
    }

    /// A boundary on a surface, counterclockwise or clockwise.
    fn boundary(
        &mut self,
        surface: usize,
        patch: &NurbsPatch,
        ring: &Ring,
        left: bool,
    ) -> Result<usize, String> {
        let turned = (ring.area > 0.0) != left;
        let curves = match turned {
            false => ring.curves.to_vec(),
            true => ring
                .curves
                .iter()
                .rev()
                .map(reversed)
                .collect::<Result<_, _>>()?,
        };
        let plane: Vec<String> = (curves.iter())
            .map(|c| self.curve(&c.parameter, PLANE).to_string())
            .collect();
        let [low, high] = patch.bounds();
        let near = AGREE * (high - low).norm();
        let agreeing = |c: &'_ &TrimCurve| ends_agree(patch, c, near);
        let space: Option<Vec<&NurbsCurve<3>>> = (curves.iter())
            .map(|c| Some(c).filter(agreeing)?.space.as_ref())
            .collect();
        let space: Vec<String> = (space.into_iter().flatten())
            .map(|c| self.curve(c, PART).to_string())
            .collect();
        let mut chain = |members: Vec<String>, status: &str| match members.len() {
            0 => "0".to_owned(),
            1 => members.concat(),
            n => {
                let values: Vec<String> = std::iter::once(n.to_string()).chain(members).collect();
                self.entity(102, status, "", &values).to_string()
            }
        };
        let plane = chain(plane, PLANE);
        let space = chain(space, PART);
        let (made, preferred) = ("0".to_owned(), "1".to_owned());
        let values = [made, surface.to_string(), plane, space, preferred];
        Ok(self.entity(142, PART, "", &values))
    }

    /// A rational B-spline curve, of space or of the parameter plane.
    fn curve<const D: usize>(&mut self, curve: &NurbsCurve<D>, status: &str) -> usize {
        let points = curve.homogeneous();
        let flat = |yes: bool| String::from(if yes { "1" } else { "0" });
        let rational = points.iter().any(|p| p[3] != points[0][3]);
        let [a, b] = curve.ends();
        let mut values = vec![
            (points.len() - 1).to_string(),
            curve.degree().to_string(),
            flat(D == 2),
            flat(a == b),
            flat(!rational),
            "0".to_owned(),
        ];
        values.extend(curve.basis().knots().iter().map(|&x| real(x)));
        values.extend(points.iter().map(|p| real(p[3])));
        let place = points
            .iter()
            .flat_map(|p| [p[0] / p[3], p[1] / p[3], p[2] / p[3]]);
        values.extend(place.map(real));
        values.extend(curve.domain().map(real));
        // The normal of the plane that the curve lies in.
        let up = if D == 2 { 1.0 } else { 0.0 };
        values.extend([0.0, 0.0, up].map(real));
        self.entity(126, status, "", &values)
    }
}

/// Whether the curve in space ends where that in the parameter plane does, within a distance.
fn ends_agree(patch: &NurbsPatch, curve: &TrimCurve, near: f64) -> bool {
    let Some(space) = &curve.space else {
        return false;
    };
    let ends = curve.parameter.ends().map(|xi| patch.point([xi.x, xi.y]));
    let pairs = ends.iter().zip(space.ends());
    pairs.fold(0.0, |d: f64, (a, b)| d.max((a - b).norm())) <= near
}

fn reversed(curve: &TrimCurve) -> Result<TrimCurve, String> {
    let fault = |e: crate::curve::CurveError| e.to_string();
    let space = curve.space.as_ref().map(NurbsCurve::reversed);
    Ok(TrimCurve {
        parameter: curve.parameter.reversed().map_err(fault)?,
        space: space.transpose().map_err(fault)?,
        entity: curve.entity,
    })
}

/// A loop with its polygon.
struct Ring<'t> {
    curves: &'t [TrimCurve],
    corners: Vec<[f64; 2]>,
    /// Of the polygon, negative where it runs clockwise.
    area: f64,
}

impl<'t> Ring<'t> {
    fn of(curves: &'t [TrimCurve]) -> Self {
        let mut corners = Vec::new();
        for curve in curves {
            let basis = curve.parameter.basis();
            let steps = 4 * basis.degree();
            for span in 0..basis.span_count() {
                let [a, b] = basis.span_range(span);
                let at = |k: usize| curve.parameter.point(a + (b - a) * k as f64 / steps as f64);
                corners.extend((0..steps).map(|k| <[f64; 2]>::from(at(k))));
            }
        }
        let first = corners.first().copied().unwrap_or_default();
        let next = corners.iter().skip(1).chain(corners.first());
        let twice = corners.iter().zip(next).map(|(p, q)| {
            (p[0] - first[0]) * (q[1] - first[1]) - (q[0] - first[0]) * (p[1] - first[1])
        });
        let area = 0.5 * twice.sum::<f64>();
        Self {
            curves,
            corners,
            area,
        }
    }

    /// Whether another loop lies inside of this one. Loops may touch, so the corners vote.
    fn holds(&self, other: &Ring) -> bool {
        let inside = |x: &&[f64; 2]| {
            let next = self.corners.iter().skip(1).chain(self.corners.first());
            let crossed = self.corners.iter().zip(next).filter(|(p, q)| {
                (p[1] > x[1]) != (q[1] > x[1])
                    && x[0] < p[0] + (x[1] - p[1]) * (q[0] - p[0]) / (q[1] - p[1])
            });
            crossed.count() % 2 == 1
        };
        let count = other.corners.iter().filter(inside).count();
        self.area.abs() > other.area.abs() && 2 * count > other.corners.len()
    }
}
