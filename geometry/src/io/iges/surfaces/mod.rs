//! Surface entities as NURBS patches, one family per file: splines (114), ruled (118), revolution (120), tabulated
//! cylinder (122), offset (140), planes (108, 190), quadrics (192 to 198). Entity 128 is in `surface`.

mod offset;
mod offset_fit;
mod parametric;
mod plane;
mod quadric;
mod revolution;
mod ruled;
mod tabulated;

use super::super::error::Fail;
use super::Model;
use super::curve::{self, CurveChain, JoinedCurve, Stop, describe};
use super::directory::Entry;
use super::params::Params;
use super::reparametrise::Reparametrise;
use super::transform::{Affine, matrix_of};
use crate::{NurbsPatch, Vec3};

pub use plane::{Border, Unbounded};

/// A patch with the parameters that the file means.
#[derive(Debug, Clone)]
pub struct BasePatch {
    /// The patch.
    pub patch: NurbsPatch,
    /// From the parameters that IGES gives the entity to the patch's.
    pub parameters: Reparametrise,
    /// Largest distance of the patch from what the entity defines; 0 where the form is exact.
    pub deviation: f64,
}

impl BasePatch {
    /// A patch with the file's own parameters, exact.
    fn exact(patch: NurbsPatch) -> Self {
        Self {
            parameters: Reparametrise::identity(patch.domain()),
            patch,
            deviation: 0.0,
        }
    }
}

/// What a surface entity gives, in model space divided by its scale.
#[derive(Debug, Clone)]
pub enum BaseSurface {
    /// Its patches: one, or several where a spline falls apart at its knots. Never empty.
    Patches(Vec<BasePatch>),
    /// A surface without an end in some direction, to be cut out by what lies on it.
    Unbounded(Box<Unbounded>),
}

/// Whether an entity of this type is a surface that [`read`] knows.
pub fn is_base(type_number: u32) -> bool {
    matches!(
        type_number,
        108 | 114 | 118 | 120 | 122 | 128 | 140 | 190 | 192 | 194 | 196 | 198
    )
}

/// Reads a surface entity without any trim; `outer` comes after its own matrices. Damaged data is an error of the file,
/// data that is whole but gives no surface is a reason to pass it over. The second value is how many values its own data
/// took (pointers to properties follow).
pub fn read(
    model: &Model,
    entry: &Entry,
    outer: &Affine,
    notes: &mut Vec<String>,
) -> Result<(BaseSurface, usize), Stop> {
    if entry.type_number == 128 {
        let map = outer.after(&matrix_of(model, entry, notes)?);
        let read = super::surface::read(model, entry, &map, notes)?;
        let patches = read.patches?.into_iter().map(BasePatch::exact).collect();
        return Ok((BaseSurface::Patches(patches), read.values));
    }
    let reader = SurfaceReader {
        model,
        entry,
        params: model.params(entry)?,
        map: outer.after(&matrix_of(model, entry, notes)?),
        notes,
    };
    match entry.type_number {
        108 => plane::plane_108(reader),
        114 => parametric::read(reader),
        118 => ruled::read(reader),
        120 => revolution::read(reader),
        122 => tabulated::read(reader),
        140 => offset::read(reader),
        190 => plane::plane_190(reader),
        192 => plane::cylinder(reader),
        194 => plane::cone(reader),
        196 => quadric::sphere(reader),
        198 => quadric::torus(reader),
        _ => Err(Stop::Reason(format!(
            "{} is no surface that is read",
            describe(entry)
        ))),
    }
}

/// A reader's result.
type Found = Result<(BaseSurface, usize), Stop>;

/// What the readers of all entities need.
struct SurfaceReader<'a, 'n> {
    model: &'a Model<'a>,
    entry: &'a Entry,
    params: Params<'a>,
    /// From the entity's own coordinates to model space.
    map: Affine,
    notes: &'n mut Vec<String>,
}

impl<'a> SurfaceReader<'a, '_> {
    fn note(&mut self, text: &str) {
        let Entry {
            number,
            type_number,
            ..
        } = self.entry;
        let note = format!("entity {number} ({type_number}): {text}");
        if !self.notes.contains(&note) {
            self.notes.push(note);
        }
    }

    fn pointer(&self, i: usize, what: &str) -> Result<&'a Entry, Fail> {
        let (model, params) = (self.model, &self.params);
        model.entry(params.integer(i, what)?, params.place_of(i), what)
    }

    /// From the entity's coordinates to the patch's: the matrices and the model space scale.
    fn place(&self, x: Vec3) -> Vec3 {
        self.map.apply(x) / self.model.global.scale
    }

    /// A curve in the entity's own coordinates, in one piece. (All curves that define a surface are moved by its matrix,
    /// after their own.)
    fn curve(&mut self, i: usize, what: &str) -> Result<JoinedCurve, Stop> {
        let member = self.pointer(i, what)?;
        let chain = self.chain(member)?;
        let joined = chain
            .joined()
            .map_err(|e| Stop::Reason(format!("{what}: {e}")))?;
        if joined.gap > self.model.global.resolution.unwrap_or(0.0) && joined.gap > 0.0 {
            let text = format!("{what}: gaps of up to {:.1e} were closed", joined.gap);
            self.note(&text);
        }
        Ok(joined)
    }

    fn chain(&mut self, member: &Entry) -> Result<CurveChain, Stop> {
        let read = curve::read_unscaled(self.model, member, self.notes);
        read.map_err(|stop| match stop {
            Stop::Reason(reason) => Stop::Reason(format!(
                "entity {} ({}): {reason}",
                member.number,
                describe(member)
            )),
            damage => damage,
        })
    }

    /// The place that a point (116) gives, in the entity's own coordinates.
    fn location(&mut self, i: usize, what: &str) -> Result<Vec3, Stop> {
        let point = self.pointer(i, what)?;
        let found = self.coordinates(i, point, 116, what)?;
        Ok(matrix_of(self.model, point, self.notes)?.apply(found))
    }

    /// The unit vector that a direction (123) gives.
    fn direction(&mut self, i: usize, what: &str) -> Result<Vec3, Stop> {
        let direction = self.pointer(i, what)?;
        let found = self.coordinates(i, direction, 123, what)?;
        let found = matrix_of(self.model, direction, self.notes)?.linear * found;
        let size = found.amax();
        if size <= 0.0 || !size.is_finite() {
            return Err(Stop::Reason(format!("{what} is zero")));
        }
        Ok((found / size).normalize())
    }

    fn coordinates(&self, i: usize, entry: &Entry, wanted: u32, what: &str) -> Result<Vec3, Fail> {
        if entry.type_number != wanted {
            return Err(self
                .params
                .fail(i, format!("{what}: an entity of type {wanted}")));
        }
        let params = self.model.params(entry)?;
        let x = params.reals(1, 3, "three coordinates")?;
        Ok(Vec3::new(x[0], x[1], x[2]))
    }

    /// Right-handed unit vectors of which the third is `axis` and the first lies in the plane of `axis` and `reference`;
    /// without a reference it is any.
    fn triad(&self, axis: Vec3, reference: Option<Vec3>) -> Result<[Vec3; 3], Stop> {
        let reference = reference.unwrap_or_else(|| {
            let k = axis.iamin();
            Vec3::from_fn(|i, _| f64::from(u8::from(i == k)))
        });
        let across = reference - axis * axis.dot(&reference);
        if across.norm() < 1e-9 {
            let reason = "the reference direction is parallel to the axis";
            return Err(Stop::Reason(reason.to_owned()));
        }
        let e1 = across.normalize();
        Ok([e1, axis.cross(&e1), axis])
    }
}
