//! Every curve and surface entity of a file by itself, without trims and without what uses it.

use super::super::error::Fail;
use super::super::report::{SkipKind, Skipped};
use super::super::{CadError, LengthUnit};
use super::curve::{self, JoinedCurve};
use super::surfaces::{self, BaseSurface};
use super::transform::Affine;
use super::{Model, describe_entity, model_of};
use crate::NurbsCurve;
use crate::io::brep::ParameterMap;

/// A curve entity (100, 102, 104, 106, 110, 112, 126, 130) as NURBS.
#[derive(Debug, Clone)]
pub struct IgesCurve {
    /// Directory number of the entity.
    pub entity: u32,
    /// Its type.
    pub type_number: u32,
    /// The whole of it in one curve.
    pub curve: NurbsCurve<3>,
    /// Its members, or the pieces of a spline that falls apart; one curve for most entities.
    pub parts: Vec<NurbsCurve<3>>,
    /// From the parameter that IGES gives the entity to that of `curve`.
    pub parameters: ParameterMap,
    /// Largest distance of `curve` from the entity; 0 where the form is exact.
    pub deviation: f64,
    /// Largest gap between parts, closed in `curve`.
    pub gap: f64,
}

/// A surface entity (108, 114, 118, 120, 122, 128, 140, 190 to 198) as NURBS.
#[derive(Debug, Clone)]
pub struct IgesSurface {
    /// Directory number of the entity.
    pub entity: u32,
    /// Its type.
    pub type_number: u32,
    /// What it gives.
    pub surface: BaseSurface,
}

/// The curves and surfaces of an IGES file, in its unit, each placed by its own matrices only.
#[derive(Debug, Clone)]
pub struct IgesGeometry {
    /// Length unit of the file.
    pub unit: LengthUnit,
    /// Curves, in the order of the directory; those marked as lying in a parameter plane have parameters as x and y.
    pub curves: Vec<IgesCurve>,
    /// Surfaces, in the order of the directory.
    pub surfaces: Vec<IgesSurface>,
    /// Curve and surface entities that gave none, and why.
    pub skipped: Vec<Skipped>,
    /// What was tolerated or changed on reading.
    pub notes: Vec<String>,
}

/// Reads every curve and surface entity of an IGES file as NURBS, whoever uses it.
///
/// # Errors
/// [`CadError::Content`] with the place of the damage.
pub fn read_iges_geometry(bytes: &[u8], name: &str) -> Result<IgesGeometry, CadError> {
    let mut notes = Vec::new();
    let read = model_of(bytes, &mut notes).and_then(|model| all(&model, notes));
    read.map_err(|fail| fail.in_file(name))
}

fn all(model: &Model, notes: Vec<String>) -> Result<IgesGeometry, Fail> {
    let mut found = IgesGeometry {
        unit: model.global.unit.clone(),
        curves: Vec::new(),
        surfaces: Vec::new(),
        skipped: Vec::new(),
        notes,
    };
    let outer = Affine::identity();
    let grant = &model.grant;
    for entry in &model.entries {
        let notes = &mut found.notes;
        let skipped = if let Err(reason) = grant.open() {
            let wanted = curve::is_curve(entry.type_number) || surfaces::is_base(entry.type_number);
            wanted.then_some(reason)
        } else if curve::is_curve(entry.type_number) {
            let chain = match entry.status.purpose {
                5 => curve::read_parameters(model, entry, notes),
                _ => curve::read(model, entry, &outer, notes),
            };
            let joined = curve::settle(chain)?.and_then(|chain| {
                let joined = chain.joined().map_err(|e| e.to_string())?;
                grant.curve(&joined.curve)?;
                Ok((joined, chain))
            });
            match joined {
                Ok((joined, chain)) => {
                    let JoinedCurve {
                        curve,
                        map,
                        deviation,
                        gap,
                    } = joined;
                    found.curves.push(IgesCurve {
                        entity: entry.number,
                        type_number: entry.type_number,
                        curve,
                        parts: chain.parts.into_iter().map(|p| p.curve).collect(),
                        parameters: map,
                        deviation,
                        gap,
                    });
                    None
                }
                Err(reason) => Some(reason),
            }
        } else if surfaces::is_base(entry.type_number) {
            let surface = curve::settle(surfaces::read(model, entry, &outer, notes))?;
            let granted = surface.and_then(|(surface, _)| {
                if let BaseSurface::Patches(patches) = &surface {
                    patches.iter().try_for_each(|p| grant.patch(&p.patch))?;
                }
                Ok(surface)
            });
            match granted {
                Ok(surface) => {
                    found.surfaces.push(IgesSurface {
                        entity: entry.number,
                        type_number: entry.type_number,
                        surface,
                    });
                    None
                }
                Err(reason) => Some(reason),
            }
        } else {
            None
        };
        found.skipped.extend(skipped.map(|reason| Skipped {
            entity: entry.number,
            type_number: entry.type_number,
            name: describe_entity(entry),
            kind: SkipKind::Surface,
            reason,
        }));
    }
    Ok(found)
}
