//! Offset surfaces (140).

use super::super::curve::{Stop, describe};
use super::{BasePatch, BaseSurface, Found, SurfaceReader, is_base};
use crate::io::brep::{normal, offset};
use crate::{NurbsPatch, Vec3};

/// A 140: the offset indicator N (a vector that says on which side), the distance D and the surface. Its parameters are
/// those of the surface.
pub fn read(reader: SurfaceReader) -> Found {
    let base = reader.pointer(5, "the surface of an offset surface (140)")?;
    let on = |reason: String| {
        let base = format!("entity {} ({})", base.number, describe(base));
        Stop::Reason(format!("offset of {base}: {reason}"))
    };
    if base.type_number == 140 || !is_base(base.type_number) {
        let reason = match base.type_number {
            140 => "offsets of offset surfaces are not read",
            _ => "it is no surface that is read",
        };
        return Err(on(reason.to_owned()));
    }
    let indicator = reader.params.reals(1, 3, "the offset indicator N")?;
    let distance = reader.params.real(4, "the offset distance D")?;
    let linear = reader.map.linear;
    let indicator = linear * Vec3::new(indicator[0], indicator[1], indicator[2]);
    let scale = linear.determinant().abs().cbrt() / reader.model.global.scale;
    let distance = distance * scale;
    if !(distance.is_finite() && indicator.iter().all(|x| x.is_finite())) {
        return Err(on("distance and indicator are no numbers".to_owned()));
    }
    let (surface, _) = super::read(reader.model, base, &reader.map, reader.notes)?;
    let surface = match surface {
        BaseSurface::Patches(patches) => {
            let moved = patches.into_iter().map(|base| {
                let distance = distance * side(&base.patch, &indicator)?;
                let (patch, deviation) = offset(&base.patch, distance, &reader.model.grant)?;
                Ok(BasePatch {
                    patch,
                    deviation: base.deviation + deviation,
                    ..base
                })
            });
            BaseSurface::Patches(moved.collect::<Result<_, String>>().map_err(on)?)
        }
        BaseSurface::Unbounded(unbounded) => {
            let moved = unbounded.offset(distance / scale, &indicator).map_err(on)?;
            BaseSurface::Unbounded(Box::new(moved))
        }
    };
    Ok((surface, 6))
}

/// +1 where the indicator is on the side of `rho_1 x rho_2`, else -1. It is the normal at one point of the surface, and
/// writers do not agree at which: of the middle and the corners, the point at which the two agree best decides.
fn side(patch: &NurbsPatch, indicator: &Vec3) -> Result<f64, String> {
    let [[a, b], [c, d]] = patch.domain();
    let middle = [0.5 * (a + b), 0.5 * (c + d)];
    let places = [middle, [a, c], [b, c], [a, d], [b, d]];
    let cosines = places.into_iter().filter_map(|xi| {
        let cosine = normal(patch, xi)?.dot(indicator) / indicator.norm();
        cosine.is_finite().then_some(cosine)
    });
    let best = cosines.max_by(|a, b| a.abs().total_cmp(&b.abs()));
    match best {
        Some(cosine) if cosine.abs() > 0.1 => Ok(cosine.signum()),
        _ => Err("the offset indicator does not say on which side it lies".to_owned()),
    }
}
