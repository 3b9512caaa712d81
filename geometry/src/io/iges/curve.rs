//! Curve entities as NURBS curves: what all of them share. One file each for conics and lines, splines, offsets.

use super::super::error::Fail;
use super::Model;
use super::directory::Entry;
use super::params::Params;
use super::transform::{Affine, matrix_of};
use super::{curve_conic, curve_offset, curve_points, curve_spline, entity_name};
use crate::NurbsCurve;
use crate::curve::CurveError;
use crate::io::brep::ParameterMap;

/// Why reading an entity ended.
pub enum Stop {
    /// The file is damaged.
    Damage(Fail),
    /// The entity is whole but cannot be used.
    Reason(String),
}

impl From<Fail> for Stop {
    fn from(fail: Fail) -> Self {
        Self::Damage(fail)
    }
}

impl From<String> for Stop {
    fn from(reason: String) -> Self {
        Self::Reason(reason)
    }
}

impl From<CurveError> for Stop {
    fn from(e: CurveError) -> Self {
        Self::Reason(e.to_string())
    }
}

impl From<crate::PatchError> for Stop {
    fn from(e: crate::PatchError) -> Self {
        Self::Reason(e.to_string())
    }
}

/// Damage ends reading the file, a reason only passes the entity over.
pub fn settle<T>(read: Result<T, Stop>) -> Result<Result<T, String>, Fail> {
    match read {
        Ok(value) => Ok(Ok(value)),
        Err(Stop::Reason(reason)) => Ok(Err(reason)),
        Err(Stop::Damage(fail)) => Err(fail),
    }
}

/// One smooth-knotted piece of a curve entity: an arc, a line, a spline.
#[derive(Debug, Clone)]
pub struct CurvePart {
    /// The entity that it comes from; a composite curve's parts are its members.
    pub entity: u32,
    pub curve: NurbsCurve<3>,
    /// From the entity's own parameter to that of `curve`.
    pub map: ParameterMap,
    /// Largest distance of `curve` from what the entity defines; 0 where the form is exact.
    pub deviation: f64,
}

/// A curve entity as a chain of NURBS curves.
#[derive(Debug, Clone)]
pub struct CurveChain {
    /// In the direction of the entity, never empty. A composite gives its members, a spline that is in pieces (knots
    /// repeated more often than its degree) the pieces; else there is one.
    pub parts: Vec<CurvePart>,
}

/// The chain in one curve.
#[derive(Debug, Clone)]
pub struct JoinedCurve {
    pub curve: NurbsCurve<3>,
    /// From the entity's parameter to that of `curve`. A composite's parameter begins at 0, and its members' ranges
    /// follow each other (IGES 5.3, entity 102).
    pub map: ParameterMap,
    pub deviation: f64,
    /// Largest gap between two parts, closed by moving the start of the second.
    pub gap: f64,
}

impl CurveChain {
    /// The whole chain as one curve.
    pub fn joined(&self) -> Result<JoinedCurve, CurveError> {
        let deviation = self.parts.iter().fold(0.0, |d: f64, p| d.max(p.deviation));
        if let [part] = &self.parts[..] {
            return Ok(JoinedCurve {
                curve: part.curve.clone(),
                map: part.map.clone(),
                deviation,
                gap: 0.0,
            });
        }
        let curves: Vec<_> = self.parts.iter().map(|p| p.curve.clone()).collect();
        let (curve, gap) = NurbsCurve::joined(&curves)?;
        let own = curve.domain()[0];
        // The pieces of one spline keep its parameter, which runs on from piece to piece.
        let one = self.parts.iter().all(|p| p.entity == self.parts[0].entity);
        let file = if one {
            self.parts[0].map.file_range()[0]
        } else {
            0.0
        };
        let maps = self.parts.iter().map(|p| &p.map);
        let map = ParameterMap::chain(maps, file, own);
        Ok(JoinedCurve {
            map: map.unwrap_or_else(|| ParameterMap::identity(curve.domain())),
            curve,
            deviation,
            gap,
        })
    }
}

/// Whether an entity of this type is a curve that [`read`] knows.
pub fn is_curve(type_number: u32) -> bool {
    matches!(type_number, 100 | 102 | 104 | 106 | 110 | 112 | 126 | 130)
}

/// What a curve's coordinates are.
#[derive(Clone, Copy, PartialEq)]
pub enum Space {
    /// Lengths of model space: divided by the model space scale.
    Model,
    /// The coordinates of the entity that the curve helps to define, which has matrices of its own.
    Entity,
    /// Parameters of a surface: taken as they are.
    Parameters,
}

/// Reads a curve entity in model space; `outer` comes after its own matrices.
///
/// Damaged data is an error of the file; an entity that is whole but gives no curve (unbounded lines, ellipses without
/// points, weights that are not positive) is a reason.
pub fn read(
    model: &Model,
    entry: &Entry,
    outer: &Affine,
    notes: &mut Vec<String>,
) -> Result<CurveChain, Stop> {
    read_in(model, entry, outer, Space::Model, notes)
}

/// Reads a curve entity in the parameter plane of a surface: x and y are the surface's parameters as the file means
/// them, whatever the unit and the scale of model space.
pub fn read_parameters(
    model: &Model,
    entry: &Entry,
    notes: &mut Vec<String>,
) -> Result<CurveChain, Stop> {
    read_in(model, entry, &Affine::identity(), Space::Parameters, notes)
}

/// Reads a curve that another entity is made of, in the coordinates of that entity.
pub fn read_unscaled(
    model: &Model,
    entry: &Entry,
    notes: &mut Vec<String>,
) -> Result<CurveChain, Stop> {
    read_in(model, entry, &Affine::identity(), Space::Entity, notes)
}

fn read_in(
    model: &Model,
    entry: &Entry,
    outer: &Affine,
    space: Space,
    notes: &mut Vec<String>,
) -> Result<CurveChain, Stop> {
    let mut reader = Reader {
        model,
        space,
        notes,
        // A curve that uses its members twice is odd, one that uses them more often is damage that would take for ever.
        budget: 2 * model.sections.parameter.len() + 2,
        depth: 0,
    };
    let parts = reader.read(entry, outer)?;
    if parts.is_empty() {
        return Err(Stop::Reason("a composite curve without curves".to_owned()));
    }
    Ok(CurveChain { parts })
}

/// Composite curves of composite curves and offsets of offsets may be this deep; it bounds the stack.
const MAX_DEPTH: usize = 16;

/// What the readers of all entities need.
pub struct Reader<'a, 'n> {
    pub model: &'a Model<'a>,
    space: Space,
    notes: &'n mut Vec<String>,
    /// Parameter records that may still be read.
    budget: usize,
    /// Curves that the one being read is a member or the base of.
    depth: usize,
}

impl<'a> Reader<'a, '_> {
    pub fn note(&mut self, entry: &Entry, text: &str) {
        let note = format!("entity {} ({}): {text}", entry.number, entry.type_number);
        if !self.notes.contains(&note) {
            self.notes.push(note);
        }
    }

    /// The smallest length that counts, in the entity's own coordinates; lengths below it are gaps to be closed.
    pub fn resolution(&self) -> f64 {
        match self.space {
            Space::Model | Space::Entity => self.model.global.resolution.unwrap_or(0.0),
            Space::Parameters => 0.0,
        }
    }

    fn read(&mut self, entry: &Entry, outer: &Affine) -> Result<Vec<CurvePart>, Stop> {
        let cost = entry.records.len().max(1);
        let Some(left) = self.budget.checked_sub(cost) else {
            let reason = "uses its members over and over".to_owned();
            return Err(Stop::Reason(reason));
        };
        self.budget = left;
        if self.depth == MAX_DEPTH {
            let reason = format!("curves within curves, more than {MAX_DEPTH} deep");
            return Err(Stop::Reason(reason));
        }
        self.depth += 1;
        let read = self.read_one(entry, outer);
        self.depth -= 1;
        read
    }

    fn read_one(&mut self, entry: &Entry, outer: &Affine) -> Result<Vec<CurvePart>, Stop> {
        let map = outer.after(&matrix_of(self.model, entry, self.notes)?);
        if entry.type_number == 102 {
            return self.composite(entry, &map);
        }
        if entry.type_number == 130 {
            return curve_offset::read(self, entry, &map);
        }
        let params = self.model.params(entry)?;
        let shapes = match entry.type_number {
            100 => curve_conic::circle(self, entry, &params)?,
            104 => curve_conic::conic(self, entry, &params)?,
            106 => curve_points::polyline(self, entry, &params)?,
            110 => curve_points::line(entry, &params)?,
            112 => curve_spline::parametric(self, entry, &params)?,
            126 => curve_spline::rational(self, entry, &params)?,
            _ => {
                return Err(Stop::Reason(format!(
                    "{} is no curve that is read",
                    describe(entry)
                )));
            }
        };
        shapes
            .into_iter()
            .map(|shape| self.placed(entry, shape, &map))
            .collect()
    }

    /// A shape in the entity's own coordinates, moved to where it belongs.
    pub fn placed(&self, entry: &Entry, shape: Shape, map: &Affine) -> Result<CurvePart, Stop> {
        let scale = match self.space {
            Space::Model => self.model.global.scale,
            Space::Entity | Space::Parameters => 1.0,
        };
        let stretch = map.linear.norm() / scale;
        Ok(CurvePart {
            entity: entry.number,
            curve: shape.curve.transformed(&|x| map.apply(x) / scale)?,
            map: shape.map,
            deviation: shape.deviation * stretch,
        })
    }

    /// A 102: the number of members, then pointers to them.
    fn composite(&mut self, entry: &Entry, map: &Affine) -> Result<Vec<CurvePart>, Stop> {
        let params = self.model.params(entry)?;
        let count = params.count(1, "the number of members of a composite curve (102)")?;
        if count > params.len().saturating_sub(2) {
            let expected = format!("{count} pointers to members of a composite curve");
            return Err(params.fail(params.len(), expected).into());
        }
        let mut parts = Vec::new();
        for i in 2..2 + count {
            let member = self.pointer(&params, i, "a member of a composite curve (102)")?;
            // Points only name a joint.
            if !matches!(member.type_number, 116 | 132) {
                let read = self.read(member, map);
                parts.extend(read.map_err(|stop| in_member(stop, member))?);
            }
        }
        Ok(parts)
    }

    /// The entity that value `i` points to.
    pub fn pointer(&self, params: &Params, i: usize, what: &str) -> Result<&'a Entry, Fail> {
        let model = self.model;
        model.entry(params.integer(i, what)?, params.place_of(i), what)
    }

    /// Reads a base curve without any placement but its own.
    pub fn base(&mut self, entry: &Entry) -> Result<Vec<CurvePart>, Stop> {
        let space = std::mem::replace(&mut self.space, Space::Entity);
        let read = self.read(entry, &Affine::identity());
        self.space = space;
        read.map_err(|stop| in_member(stop, entry))
    }
}

fn in_member(stop: Stop, member: &Entry) -> Stop {
    match stop {
        Stop::Reason(reason) => Stop::Reason(format!(
            "entity {} ({}): {reason}",
            member.number,
            describe(member)
        )),
        damage => damage,
    }
}

pub fn describe(entry: &Entry) -> String {
    let name = entity_name(entry.type_number, entry.form);
    format!("{} {name}", entry.type_number)
}

/// A curve in the coordinates of its entity.
pub struct Shape {
    pub curve: NurbsCurve<3>,
    pub map: ParameterMap,
    pub deviation: f64,
}

impl Shape {
    /// A curve with the entity's own parameter, exact.
    pub fn exact(curve: NurbsCurve<3>) -> Self {
        let map = ParameterMap::identity(curve.domain());
        Self {
            curve,
            map,
            deviation: 0.0,
        }
    }
}
