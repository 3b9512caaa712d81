//! Tangent plane at a node from the nodes around.

use nalgebra::DMatrix;

use super::sectors::Sector;
use super::{Combination, Mesh};
use crate::surface::Vec3;

/// Least ratio of singular values with which a quadratic is fitted, and a plane.
const QUADRATIC: f64 = 1e-3;
const LINEAR: f64 = 1e-6;

/// Two tangents at a node, along unit vectors at right angles, as combinations of nodes.
pub(super) struct Fit {
    pub tangents: [Combination; 2],
    /// Those unit vectors, in space, on the reference positions.
    pub axes: [Vec3; 2],
}

/// Fits a quadratic over the mean tangent plane, through the node and nearest (weighted with the inverse distance) to all
/// nodes of the facets around; a linear function where these do not suffice. `None` where the facets have no plane.
pub(super) fn fit(mesh: &Mesh, node: u32, sector: &Sector) -> Option<Fit> {
    let origin = *mesh.point(node);
    let mut around: Vec<u32> = Vec::new();
    for &(facet, corner) in &sector.corners {
        for other in 1..4 {
            let other = mesh.node(facet, corner as usize ^ other);
            if other != node && !around.contains(&other) {
                around.push(other);
            }
        }
    }
    let normal = mesh.normal_around(node, sector);
    let normal = normal.try_normalize(1e-9)?;
    let first = around.iter().find_map(|&k| {
        let d = mesh.point(k) - origin;
        (d - normal * d.dot(&normal)).try_normalize(1e-9 * d.norm())
    })?;
    let axes = [first, normal.cross(&first)];
    let places: Vec<[f64; 2]> = (around.iter())
        .map(|&k| axes.map(|axis| (mesh.point(k) - origin).dot(&axis)))
        .collect();
    let mean = places.iter().map(|p| p[0].hypot(p[1])).sum::<f64>() / places.len() as f64;
    if mean <= 0.0 {
        return None;
    }
    let inverse = |columns: usize, least: f64| {
        if places.len() < columns {
            return None;
        }
        let weight = |k: usize| {
            let [x, y] = places[k];
            1.0 / (x.hypot(y) / mean).max(1e-3)
        };
        let matrix = DMatrix::from_fn(places.len(), columns, |k, column| {
            let [x, y] = places[k].map(|x| x / mean);
            let term = match column {
                0 => x,
                1 => y,
                2 => 0.5 * x * x,
                3 => x * y,
                _ => 0.5 * y * y,
            };
            term * weight(k)
        });
        let svd = matrix.svd(true, true);
        let values = &svd.singular_values;
        if values.min() <= least * values.max() {
            return None;
        }
        let mut inverse = svd.pseudo_inverse(0.0).ok()?;
        for k in 0..places.len() {
            inverse.column_mut(k).scale_mut(weight(k));
        }
        Some(inverse)
    };
    let inverse = inverse(5, QUADRATIC).or_else(|| inverse(2, LINEAR))?;
    let tangents = [0, 1].map(|row| {
        let mut out = Combination::default();
        for (k, &other) in around.iter().enumerate() {
            let factor = inverse[(row, k)] / mean;
            out.add_node(other, factor);
            out.add_node(node, -factor);
        }
        out
    });
    Some(Fit { tangents, axes })
}

/// The combination of two vectors that is nearest to `wanted` on the reference positions; `None` where they are parallel.
pub(super) fn in_plane(
    points: &[Vec3],
    [a, b]: [&Combination; 2],
    wanted: &Vec3,
) -> Option<Combination> {
    let (u, v) = (a.on(points), b.on(points));
    let (uu, uv, vv) = (u.dot(&u), u.dot(&v), v.dot(&v));
    let det = uu * vv - uv * uv;
    // Angles below about 10 degrees make no plane.
    if det.is_nan() || det <= 0.03 * uu * vv {
        return None;
    }
    let (wu, wv) = (wanted.dot(&u), wanted.dot(&v));
    let mut out = a.scaled((wu * vv - wv * uv) / det);
    out.add(b, (wv * uu - wu * uv) / det);
    Some(out)
}
