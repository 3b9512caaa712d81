//! Tabulated cylinders (122).

use super::super::curve::Stop;
use super::{BasePatch, BaseSurface, Found, SurfaceReader};
use crate::basis::Basis;
use crate::io::brep::{ParameterMap, Reparametrise};
use crate::{NurbsPatch, Vec3};

/// A 122: the directrix C moved along a line, S(u, v) = C(t) + v (L - C(a)) with t = a + u (b - a) on the directrix's range
/// [a, b] and the end point L of the generatrix, u and v from 0 to 1.
pub fn read(mut reader: SurfaceReader) -> Found {
    let what = "the directrix of a tabulated cylinder (122)";
    let directrix = reader.curve(1, what)?;
    let x = reader
        .params
        .reals(2, 3, "a coordinate of the generatrix's end")?;
    let curve = directrix.curve.refined(0, &[])?;
    let shift = Vec3::new(x[0], x[1], x[2]) - curve.ends()[0];
    if shift.norm() <= 0.0 {
        return Err(Stop::Reason("the generatrix has no length".to_owned()));
    }
    let net = curve.homogeneous();
    let moved = net.iter().map(|h| {
        let [x, y, z, w] = *h;
        [x + shift.x * w, y + shift.y * w, z + shift.z * w, w]
    });
    let points = net.iter().copied().chain(moved).collect();
    let across = Basis::new(1, vec![0.0, 0.0, 1.0, 1.0], 2).map_err(|e| e.to_string())?;
    let patch = NurbsPatch::from_homogeneous([curve.basis().clone(), across], points)?;
    let base = BasePatch {
        patch: patch.transformed(&|x| reader.place(x))?,
        parameters: Reparametrise {
            directions: [
                directrix.map.with_file_range([0.0, 1.0], false),
                ParameterMap::identity([0.0, 1.0]),
            ],
        },
        deviation: directrix.deviation / reader.model.global.scale,
    };
    Ok((BaseSurface::Patches(vec![base]), 5))
}
