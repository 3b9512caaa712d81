//! Exact NURBS forms of simple surfaces, all with `rho_1 x rho_2` pointing outward.
//!
//! Circles are four rational quadratic arcs (Piegl and Tiller 1997, section 7.5) whose knots are the angles 0, pi/2, ...,
//! 2 pi in radians; between them the angle is `m + 2 atan(tan(pi/8) (t - m) / (pi/4))` with `m` the middle of the arc. The arcs
//! meet with the same tangent, but at the inner knots, which are double, second derivatives jump.

use std::f64::consts::{FRAC_1_SQRT_2, FRAC_PI_2, SQRT_2};

use crate::patch::{NurbsPatch, PatchError};
use crate::surface::Vec3;

/// Why a primitive surface could not be made.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum PrimitiveError {
    /// A length that must be positive and finite is not.
    #[error("{name} = {value} is not a positive length")]
    Length {
        /// Which one.
        name: &'static str,
        /// Its value.
        value: f64,
    },
    /// The direction is zero or not finite.
    #[error("{name} is not a direction")]
    Direction {
        /// Which one.
        name: &'static str,
    },
    /// A torus whose tube is thicker than the hole allows.
    #[error("the minor radius {minor} of a torus must be below its major radius {major}")]
    Torus {
        /// Radius of the circle around the axis.
        major: f64,
        /// Radius of the tube.
        minor: f64,
    },
    /// The control points are not finite.
    #[error(transparent)]
    Patch(#[from] PatchError),
}

/// Control points (x, y, w) of the unit circle, unweighted coordinates, counterclockwise from (1, 0).
const CIRCLE: [[f64; 3]; 9] = [
    [1.0, 0.0, 1.0],
    [1.0, 1.0, FRAC_1_SQRT_2],
    [0.0, 1.0, 1.0],
    [-1.0, 1.0, FRAC_1_SQRT_2],
    [-1.0, 0.0, 1.0],
    [-1.0, -1.0, FRAC_1_SQRT_2],
    [0.0, -1.0, 1.0],
    [1.0, -1.0, FRAC_1_SQRT_2],
    [1.0, 0.0, 1.0],
];

/// Quadratic knots with an inner double knot every pi/2.
fn arc_knots(start: f64, arcs: usize) -> Vec<f64> {
    let mut knots = vec![start; 3];
    for arc in 1..=arcs {
        let t = start + arc as f64 * FRAC_PI_2;
        knots.extend([t, t]);
    }
    knots.push(start + arcs as f64 * FRAC_PI_2);
    knots
}

fn length(name: &'static str, value: f64) -> Result<(), PrimitiveError> {
    if value.is_finite() && value > 0.0 {
        Ok(())
    } else {
        Err(PrimitiveError::Length { name, value })
    }
}

/// Right-handed orthonormal basis whose third vector is along `axis`; the first is the projection of the coordinate
/// direction that is farthest from the axis (the lower one of equals).
fn triad(name: &'static str, axis: Vec3) -> Result<[Vec3; 3], PrimitiveError> {
    let largest = axis.amax();
    if !(largest > 0.0 && axis.iter().all(|x| x.is_finite())) {
        return Err(PrimitiveError::Direction { name });
    }
    // Scaled first, so that the square of a tiny or huge vector does not under- or overflow.
    let e3 = (axis / largest).normalize();
    let mut farthest = 0;
    for k in 1..3 {
        if e3[k].abs() < e3[farthest].abs() {
            farthest = k;
        }
    }
    let mut e1 = Vec3::zeros();
    e1[farthest] = 1.0;
    let e1 = (e1 - e3 * e3[farthest]).normalize();
    Ok([e1, e3.cross(&e1), e3])
}

/// Revolves a profile of points (distance from the axis, height, weight) about the axis; xi1 is the angle.
fn revolved(
    profile: &[[f64; 3]],
    degree: usize,
    knots: Vec<f64>,
    center: Vec3,
    [e1, e2, e3]: [Vec3; 3],
) -> Result<NurbsPatch, PrimitiveError> {
    let mut points = Vec::with_capacity(9 * profile.len());
    let mut weights = Vec::with_capacity(9 * profile.len());
    for &[r, z, weight] in profile {
        for &[x, y, w] in &CIRCLE {
            points.push(center + e1 * (r * x) + e2 * (r * y) + e3 * z);
            weights.push(w * weight);
        }
    }
    let counts = [9, profile.len()];
    let knots = [arc_knots(0.0, 4), knots];
    Ok(NurbsPatch::new(
        [2, degree],
        knots,
        counts,
        &points,
        Some(&weights),
    )?)
}

/// Rectangle of `size[0]` by `size[1]` about `center`, bilinear; the parameters are lengths from one corner. `rho_1`
/// is the projection of the coordinate direction farthest from the normal (x for a normal along z).
pub fn plane(center: Vec3, normal: Vec3, size: [f64; 2]) -> Result<NurbsPatch, PrimitiveError> {
    length("size[0]", size[0])?;
    length("size[1]", size[1])?;
    let [e1, e2, _] = triad("normal", normal)?;
    let knots = size.map(|s| vec![0.0, 0.0, s, s]);
    let corner = |x: f64, y: f64| center + e1 * (x * size[0]) + e2 * (y * size[1]);
    let points = [
        corner(-0.5, -0.5),
        corner(0.5, -0.5),
        corner(-0.5, 0.5),
        corner(0.5, 0.5),
    ];
    Ok(NurbsPatch::new([1, 1], knots, [2, 2], &points, None)?)
}

/// Full cylinder of `length` with its middle at `center`: xi1 is the angle about the axis (seam at 0 = 2 pi), xi2 the
/// length along the axis from the lower end. Degrees 2 and 1; open at both ends.
pub fn cylinder(
    radius: f64,
    length: f64,
    center: Vec3,
    axis: Vec3,
) -> Result<NurbsPatch, PrimitiveError> {
    self::length("radius", radius)?;
    self::length("length", length)?;
    let profile = [[radius, -0.5 * length, 1.0], [radius, 0.5 * length, 1.0]];
    revolved(
        &profile,
        1,
        vec![0.0, 0.0, length, length],
        center,
        triad("axis", axis)?,
    )
}

/// Full sphere in one biquadratic patch: xi1 is the angle about the axis (seam at 0 = 2 pi), xi2 the latitude from -pi/2
/// to pi/2. The edges xi2 = -pi/2 and pi/2 are poles, where no frame exists; where contact may reach them take
/// [`sphere_without_poles`].
pub fn sphere(radius: f64, center: Vec3, axis: Vec3) -> Result<NurbsPatch, PrimitiveError> {
    length("radius", radius)?;
    // Half of the circle, from (0, -1) over (1, 0) to (0, 1).
    let profile = [6, 7, 8, 1, 2].map(|k: usize| {
        let [x, y, w] = CIRCLE[k];
        [radius * x, radius * y, w]
    });
    revolved(
        &profile,
        2,
        arc_knots(-FRAC_PI_2, 2),
        center,
        triad("axis", axis)?,
    )
}

/// Full torus in one biquadratic patch: xi1 is the angle about the axis, xi2 the angle about the circle of radius
/// `major`, zero on the outside and growing towards the axis's upper side. Seams at 0 = 2 pi in both.
pub fn torus(
    major: f64,
    minor: f64,
    center: Vec3,
    axis: Vec3,
) -> Result<NurbsPatch, PrimitiveError> {
    length("major", major)?;
    length("minor", minor)?;
    if minor >= major {
        return Err(PrimitiveError::Torus { major, minor });
    }
    let profile = CIRCLE.map(|[x, y, w]| [major + minor * x, minor * y, w]);
    revolved(&profile, 2, arc_knots(0.0, 4), center, triad("axis", axis)?)
}

/// Full sphere in six equal biquartic patches, one per face of a cube whose third direction is `axis` (in the order +3,
/// -3, +1, -1, +2, -2): no poles, every patch smooth inside. Each is the inverse stereographic image of a planar
/// rational biquadratic patch whose borders are the circles into which the planes through opposite cube edges are
/// projected (J. E. Cobb, "Tiling the sphere with rational Bezier patches", 1988). The parameters run from 0 to pi/2
/// and are near to the angles.
pub fn sphere_without_poles(
    radius: f64,
    center: Vec3,
    axis: Vec3,
) -> Result<[NurbsPatch; 6], PrimitiveError> {
    length("radius", radius)?;
    let [e1, e2, e3] = triad("axis", axis)?;
    let net = cube_face();
    let face = |a: Vec3, b: Vec3, c: Vec3| {
        let place = |&[x, y, z, _]: &[f64; 4]| center + (a * x + b * y + c * z) * radius;
        let points: Vec<Vec3> = net.iter().map(place).collect();
        let weights: Vec<f64> = net.iter().map(|p| p[3]).collect();
        let knots = || [vec![0.0; 5], vec![FRAC_PI_2; 5]].concat();
        NurbsPatch::new([4, 4], [knots(), knots()], [5, 5], &points, Some(&weights))
    };
    Ok([
        face(e1, e2, e3)?,
        face(e2, e1, -e3)?,
        face(e2, e3, e1)?,
        face(e3, e2, -e1)?,
        face(e3, e1, e2)?,
        face(e1, e3, -e2)?,
    ])
}

/// Bezier points (x, y, z unweighted, w) of the top face of the cube on the unit sphere.
fn cube_face() -> [[f64; 4]; 25] {
    // In the plane of projection the border x = z of the face is the circle about (-1, 0) of radius sqrt 2. Between the
    // corners (c, -c) and (c, c) it is a rational quadratic arc of half angle asin(c / sqrt 2).
    let c = 0.5 * (3.0_f64.sqrt() - 1.0);
    let half = (c / SQRT_2).asin();
    let (middle, w) = (SQRT_2 / half.cos() - 1.0, half.cos());
    // Homogeneous (X, Y, W), first index xi1. The weight in the middle is free; the product keeps the lines even.
    let coordinate = [-1.0, 0.0, 1.0];
    let mut plane = [[[0.0; 3]; 3]; 3];
    for (i, column) in plane.iter_mut().enumerate() {
        for (j, point) in column.iter_mut().enumerate() {
            let (x, y) = (coordinate[i], coordinate[j]);
            *point = match (i == 1, j == 1) {
                (false, false) => [c * x, c * y, 1.0],
                (true, true) => [0.0, 0.0, w * w],
                _ => [w * middle * x, w * middle * y, w],
            };
        }
    }
    // (2 X W, 2 Y W, W^2 - X^2 - Y^2, W^2 + X^2 + Y^2): products of Bernstein polynomials,
    // B_i^2 B_k^2 = C(2,i) C(2,k) / C(4,i+k) B_(i+k)^4.
    let binomial2 = [1.0, 2.0, 1.0];
    let binomial4 = [1.0, 4.0, 6.0, 4.0, 1.0];
    let mut net = [[0.0; 4]; 25];
    for index in 0..81 {
        let [i, j, k, l] = [index % 3, index / 3 % 3, index / 9 % 3, index / 27];
        let f = binomial2[i] * binomial2[k] / binomial4[i + k] * binomial2[j] * binomial2[l]
            / binomial4[j + l];
        let ([x, y, w], [x2, y2, w2]) = (plane[i][j], plane[k][l]);
        let product = [
            2.0 * x * w2,
            2.0 * y * w2,
            w * w2 - x * x2 - y * y2,
            w * w2 + x * x2 + y * y2,
        ];
        for (sum, term) in net[i + k + 5 * (j + l)].iter_mut().zip(product) {
            *sum += f * term;
        }
    }
    net.map(|[x, y, z, w]| [x / w, y / w, z / w, w])
}
