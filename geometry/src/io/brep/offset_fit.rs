//! The surface at a constant distance from a patch.
//!
//! Where the patch is a plane, cylinder, cone, sphere or torus, the offset lies in the same space of rational splines, and
//! interpolation in that space is exact. Of any other patch the space is refined until interpolation keeps a tolerance.

use super::grant::Grant;
use crate::basis::{Basis, WIDTH};
use crate::frame::Frame;
use crate::{NurbsPatch, Vec3};
use nalgebra::{DMatrix, Dyn, LU};

/// Offsets keep to this share of the size of the patch where they are not exact.
const TOLERANCE: f64 = 1e-6;
/// Deviations up to this share of the size are rounding: the offset is exact.
const EXACT: f64 = 1e-12;
/// Degree that is refined, at least.
const DEGREE: usize = 3;
/// Refinements, and most control points of one direction.
const ROUNDS: usize = 7;
const COUNT: usize = 160;
/// Shares of a span at which the offset is checked.
const CHECKED: [f64; 3] = [0.2, 0.5, 0.8];
/// A crease that turns the normal by more than this (radians) tears the offset.
const CREASE: f64 = 1e-4;

/// The patch at `distance` along `rho_1 x rho_2`, with the same parameters, and its largest deviation found. Takes what it
/// evaluates from the grant.
pub fn offset(
    base: &NurbsPatch,
    distance: f64,
    grant: &Grant,
) -> Result<(NurbsPatch, f64), String> {
    let domain = base.domain();
    let torn = |e: crate::PatchError| e.to_string();
    if (0..2).any(|d| !base.sharp_knots(d, CREASE).is_empty()) {
        return Err("it has a crease, at which its offset is torn".to_owned());
    }
    let own = [0, 1].map(|d| base.basis(d).own_domain());
    let mut space = base
        .clone()
        .with_trim(None)
        .with_domain(own)
        .map_err(torn)?;
    for d in 0..2 {
        space = space.clamped(d).map_err(torn)?;
    }
    let [low, high] = base.bounds();
    let size = (high - low).norm() + distance.abs();
    let mut deviation = f64::INFINITY;
    for round in 0..=ROUNDS {
        if round == 1 {
            for d in 0..2 {
                let more = DEGREE.saturating_sub(space.degree()[d]);
                space = space.elevated(d, more).map_err(torn)?;
            }
        }
        let fit = Fit::new(&space, distance, grant)?;
        deviation = fit.total;
        let tolerance = if round == 0 { EXACT } else { TOLERANCE } * size;
        if deviation <= tolerance || (round == 0 && deviation <= TOLERANCE * size) {
            let patch = fit.patch.with_domain(domain).map_err(torn)?;
            return Ok((patch, deviation));
        }
        if round == 0 {
            continue;
        }
        let largest = fit.along[0].max(fit.along[1]);
        for d in 0..2 {
            if fit.along[d] < 0.5 * tolerance.min(largest) {
                continue;
            }
            let middles: Vec<f64> = (space.spans(d).iter())
                .map(|[a, b]| 0.5 * (a + b))
                .collect();
            if space.counts()[d] + middles.len() > COUNT {
                return Err(format!(
                    "an approximation of {COUNT} control points a side is still {deviation:.1e} off"
                ));
            }
            let mut counts = space.counts();
            counts[d] += middles.len();
            if bytes(counts) > grant.passing_bytes() {
                return Err("it takes more memory than a file of this length is granted".to_owned());
            }
            space = space.insert_knots(d, &middles).map_err(torn)?;
        }
    }
    Err(format!("its approximation is still {deviation:.1e} off"))
}

/// Bytes in use while an offset with so many control points is fitted: five nets or so, and two collocation matrices.
fn bytes(counts: [usize; 2]) -> u64 {
    let [m, n] = counts.map(|n| n as u64);
    150 * m * n + 16 * (m * m + n * n)
}

/// The unit normal `rho_1 x rho_2`, at a pole that of the surface around it.
pub fn normal(patch: &NurbsPatch, xi: [f64; 2]) -> Option<Vec3> {
    let domain = patch.domain();
    let jet = patch.jet(xi);
    let [r1, r2] = jet.rho_i;
    let extent = domain.map(|[a, b]| b - a);
    let (e1, e2) = (r1 * extent[0], r2 * extent[1]);
    let small = 1e-9 * (e1.norm() + e2.norm());
    let cross = if e2.norm() <= small {
        e1.cross(&jet.rho_ij[1])
    } else if e1.norm() <= small {
        jet.rho_ij[1].cross(&e2)
    } else {
        return e1.cross(&e2).try_normalize(0.0);
    };
    let normal = cross.try_normalize(0.0)?;
    // The derivative changes its sign from one end to the other: a point a little inside tells.
    let inside = [0, 1].map(|d| xi[d] + 1e-3 * (0.5 * (domain[d][0] + domain[d][1]) - xi[d]));
    let [r1, r2] = patch.jet(inside).rho_i;
    let sense = r1.cross(&r2).dot(&normal);
    (sense != 0.0).then(|| normal * sense.signum())
}

/// An interpolation of the offset, and how far it is off.
struct Fit {
    patch: NurbsPatch,
    /// Largest deviation between the interpolated points of the other direction.
    along: [f64; 2],
    /// Largest of all found.
    total: f64,
}

impl Fit {
    /// Interpolates the offset of `space` by a surface with its knots and weights.
    fn new(space: &NurbsPatch, distance: f64, grant: &Grant) -> Result<Self, String> {
        let bases = [0, 1].map(|d| space.basis(d));
        let sites = bases.map(sites);
        let checks = [0, 1].map(|d| -> Vec<f64> {
            let spans = space.spans(d).into_iter();
            spans
                .flat_map(|[a, b]| CHECKED.map(|s| a + (b - a) * s))
                .collect()
        });
        let evaluations = (0..2).fold(1u64, |n, d| n * (sites[d].len() + checks[d].len()) as u64);
        let cost = 2 * evaluations * Grant::evaluation(space.degree());
        let granted = grant.work(cost);
        granted.map_err(|_| "it takes more work than a file of this length is granted")?;
        let at = |xi: [f64; 2]| {
            let n = normal(space, xi).ok_or("it has no normal in some place")?;
            Ok::<_, String>(space.point(xi) + n * distance)
        };
        let [m, n] = space.counts();
        // Columns x w, y w, z w of the values, rows first along xi1.
        let mut values = [(); 3].map(|()| DMatrix::<f64>::zeros(m, n));
        for (j, &v) in sites[1].iter().enumerate() {
            for (i, &u) in sites[0].iter().enumerate() {
                let x = at([u, v])?;
                let w = weight(space, [u, v]);
                for (k, values) in values.iter_mut().enumerate() {
                    values[(i, j)] = x[k] * w;
                }
            }
        }
        let solve = |d: usize| {
            let matrix = collocation(bases[d], &sites[d]);
            LU::<f64, Dyn, Dyn>::new(matrix)
        };
        let lu = [solve(0), solve(1)];
        let mut points: Vec<[f64; 4]> = (space.homogeneous().iter())
            .map(|p| [0.0, 0.0, 0.0, p[3]])
            .collect();
        for (k, values) in values.into_iter().enumerate() {
            let singular = || "its knots allow no interpolation".to_owned();
            let half = lu[0].solve(&values).ok_or_else(singular)?;
            let net = lu[1].solve(&half.transpose()).ok_or_else(singular)?;
            for j in 0..n {
                for i in 0..m {
                    points[i + m * j][k] = net[(j, i)];
                }
            }
        }
        let patch = NurbsPatch::from_homogeneous(bases.map(Basis::clone), points)
            .map_err(|e| e.to_string())?;
        let mut along = [0.0f64; 2];
        let mut total = 0.0f64;
        let mut check = |xi: [f64; 2]| {
            let off = (patch.point(xi) - at(xi)?).norm();
            // Beyond a radius of curvature the surface turns back.
            let curved = Frame::new(&space.jet(xi), 1.0).map(|f| f.principal_curvatures());
            if curved.is_some_and(|k| k.iter().any(|k| distance * k >= 1.0)) {
                let reason = "the distance is larger than its radius of curvature";
                return Err(reason.to_owned());
            }
            total = if off.is_nan() {
                f64::INFINITY
            } else {
                total.max(off)
            };
            Ok::<_, String>(off)
        };
        for &u in &checks[0] {
            for &v in &sites[1] {
                along[0] = along[0].max(check([u, v])?);
            }
            for &v in &checks[1] {
                check([u, v])?;
            }
        }
        for &v in &checks[1] {
            for &u in &sites[0] {
                along[1] = along[1].max(check([u, v])?);
            }
        }
        Ok(Self {
            patch,
            along,
            total,
        })
    }
}

/// Greville abscissae: where a spline space is interpolated well.
fn sites(basis: &Basis) -> Vec<f64> {
    let p = basis.degree();
    let [a, b] = basis.domain();
    (0..basis.count())
        .map(|i| {
            let knots = &basis.knots()[i + 1..=i + p];
            (knots.iter().sum::<f64>() / p as f64).clamp(a, b)
        })
        .collect()
}

/// Values of all functions (columns) at all sites (rows).
fn collocation(basis: &Basis, sites: &[f64]) -> DMatrix<f64> {
    let mut matrix = DMatrix::zeros(sites.len(), basis.count());
    for (row, &t) in sites.iter().enumerate() {
        let (first, values) = functions(basis, t);
        for (r, value) in values[..=basis.degree()].iter().enumerate() {
            matrix[(row, first + r)] = *value;
        }
    }
    matrix
}

/// The functions that are not zero at `t`: number of the first, and their values.
fn functions(basis: &Basis, t: f64) -> (usize, [f64; WIDTH]) {
    let span = basis.find_span(t);
    let mut out = [[0.0; WIDTH]; 1];
    basis.evaluate(span, t, &mut out);
    (basis.first_function(span), out[0])
}

fn weight(patch: &NurbsPatch, xi: [f64; 2]) -> f64 {
    let [(i, a), (j, b)] = [0, 1].map(|d| functions(patch.basis(d), xi[d]));
    let [m, _] = patch.counts();
    let [p, q] = patch.degree();
    let mut sum = 0.0;
    for (s, b) in b[..=q].iter().enumerate() {
        for (r, a) in a[..=p].iter().enumerate() {
            sum += a * b * patch.homogeneous()[i + r + m * (j + s)][3];
        }
    }
    sum
}
