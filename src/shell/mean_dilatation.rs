//! The brick whose points share the mean change of volume of their element: `F` is scaled to `(theta / J)^(1/3) F` with
//! `theta = v / V`, the element's present volume over its undeformed one, and the law sees the strain of that.
//!
//! Eight separate changes of volume are more than the displacements of eight nodes can hold at nearly zero, so that plain bricks
//! lock in rubber and in plastic flow; one change an element leaves them free. Shears and stretches remain those of the
//! displacements, so the brick holds in strong compression; it is as stiff in bending as the plain one's shears make it.
//!
//! Sources: J. C. Nagtegaal, D. M. Parks and J. R. Rice, CMAME 4 (1974); J. C. Simo, R. L. Taylor and K. S. Pister, CMAME 51
//! (1985), whose pressure and change of volume, constant in an element, are eliminated here; B. Moran, M. Ortiz and
//! C. F. Shih, IJNME 29 (1990), for any law.
use super::brick::{self, Pointwise};
use super::error::FaultCause;
use super::h8::H8System;
use super::kinematics::{Fields, V, add};
use super::material::{
    Collapsed, MaterialLaw, Metric, cauchy_green, invariants, inverse, isotropic, mixed, state_of,
};
use super::reference::Reference;
use num_dual::DualNum;

/// What the scaling takes from the deformation of one Gauss point.
#[derive(Clone, Copy)]
struct Point<D> {
    /// Compatible Green-Lagrange strain, shears doubled.
    strain: [D; 6],
    /// C, shears once.
    c: [D; 6],
    /// Inverse of C.
    ci: [D; 6],
    /// Logarithm of the point's own change of volume J.
    ln_j: D,
}

impl<D: DualNum<f64> + Copy> Point<D> {
    fn new(metric: &Metric, strain: [D; 6]) -> Result<Point<D>, Collapsed> {
        let (c, change) = cauchy_green(metric, &strain, invariants(&mixed(metric, &strain)))?;
        Ok(Point {
            strain,
            c,
            ci: inverse(&c).0,
            ln_j: change.ln_1p() * 0.5,
        })
    }

    /// The strain of the scaled deformation, and its factor of C, `a = (theta / J)^(2/3)`.
    fn scaled(&self, metric: &Metric, ln_theta: D) -> ([D; 6], D) {
        // a - 1, which keeps its digits at small strain.
        let more = ((ln_theta - self.ln_j) * (2.0 / 3.0)).exp_m1();
        let a = more + 1.0;
        let mut scaled = self.strain;
        for (v, e) in scaled.iter_mut().enumerate() {
            let once = if v < 3 { 0.5 } else { 1.0 };
            *e = *e * a + more * (once * metric.lower[v]);
        }
        (scaled, a)
    }
}

/// The points, and the logarithm of the mean change of volume.
#[allow(clippy::type_complexity)]
fn points<D: DualNum<f64> + Copy>(
    re: &Reference,
    big: &Fields<f64>,
    du: &Fields<D>,
) -> Result<([Point<D>; 8], D), (u8, Collapsed)> {
    let at = |g: usize| {
        Point::new(&re.metric[g], brick::strain(&big.at(g), &du.at(g))).map_err(|c| (g as u8, c))
    };
    let first = at(0)?;
    let mut points = [first; 8];
    for g in 1..8 {
        points[g] = at(g)?;
    }
    let (mut change, mut volume) = (D::zero(), 0.0);
    for (point, dv) in points.iter().zip(re.volume) {
        change += point.ln_j.exp_m1() * dv;
        volume += dv;
    }
    Ok((points, (change / volume).ln_1p()))
}

/// The strains that the law sees.
///
/// # Errors
/// The point that has no volume left.
pub(super) fn strains<D: DualNum<f64> + Copy>(
    re: &Reference,
    big: &Fields<f64>,
    du: &Fields<D>,
) -> Result<[[D; 6]; 8], (u8, Collapsed)> {
    let (points, ln_theta) = points(re, big, du)?;
    Ok(std::array::from_fn(|g| {
        points[g].scaled(&re.metric[g], ln_theta).0
    }))
}

/// `S : C`, of contravariant and covariant components.
#[inline(always)]
fn with_c<D: DualNum<f64> + Copy>(s: &[D; 6], c: &[D; 6]) -> D {
    s[0] * c[0] + s[1] * c[1] + s[2] * c[2] + (s[3] * c[3] + s[4] * c[4] + s[5] * c[5]) * 2.0
}

/// Energy and nodal forces (`3 node + axis`).
///
/// `p = a S : C / 3` being the mean stress of a point, its stress works as `a S - p C^-1` on its own strain and as p on the change of
/// volume of the element, whose variation is the mean of those of the points: `theta'/theta = sum w J C^-1 : E' / v`.
pub(super) fn forces<D: DualNum<f64> + Copy, L: MaterialLaw>(
    law: &L,
    re: &Reference,
    u: &[V<D>; 8],
    states: &[f64],
) -> Result<(D, [D; 24]), (u8, Collapsed)> {
    let big = Fields::new(&re.nodes);
    let du = Fields::new(u);
    let now = add(&big, &du);
    let (points, ln_theta) = points(re, &big, &du)?;
    let (mut energy, mut pressure, mut volume) = (D::zero(), D::zero(), D::zero());
    let mut stress = [[D::zero(); 6]; 8];
    let mut p = [D::zero(); 8];
    for (g, point) in points.iter().enumerate() {
        let (strain, a) = point.scaled(&re.metric[g], ln_theta);
        let (psi, s) = law
            .stress(&re.metric[g], &strain, &state_of::<L>(states, g))
            .map_err(|c| (g as u8, c))?;
        energy += psi * re.volume[g];
        p[g] = with_c(&s, &point.c) * a / 3.0;
        pressure += p[g] * re.volume[g];
        volume += point.ln_j.exp() * re.volume[g];
        stress[g] = s.map(|s| s * a);
    }
    let mean = pressure / volume;
    let mut f = [D::zero(); 24];
    for (g, point) in points.iter().enumerate() {
        let more = mean * point.ln_j.exp() - p[g];
        let s: [D; 6] = std::array::from_fn(|v| stress[g][v] + point.ci[v] * more);
        brick::add_forces(g, &now.at(g), &s, re.volume[g], &mut f);
    }
    Ok((energy, f))
}

/// What the law answers at a point, D being its moduli and S its stress.
#[derive(Clone, Copy, Default)]
struct Answer {
    /// `a S`.
    stress: [f64; 6],
    /// `a^2 D`.
    moduli: [[f64; 6]; 6],
    /// `a^2/3 D C + 2a/3 S`.
    h: [f64; 6],
    /// `a^2/3 C D + 2a/3 S`, the same where D is symmetric.
    across: [f64; 6],
    /// `a^2/9 C D C + 2/3 p`.
    k: f64,
    /// Mean stress.
    p: f64,
}

/// Forces and tangent.
///
/// With `t' = theta'/theta - J'/J`, the strain that the law sees varies by `a E' + a/3 C t'`. The terms in `theta'/theta = b u'`
/// are one vector an element, so the tangent is that of a plain brick with other stresses and moduli, and an
/// update `y b^T + b y^T + k b b^T`.
pub(super) fn evaluate<L: MaterialLaw>(
    law: &L,
    re: &Reference,
    u: &[V<f64>; 8],
    states: &[f64],
    out: &mut H8System,
) -> Result<(), FaultCause> {
    let big = Fields::new(&re.nodes);
    let du = Fields::new(u);
    let now = add(&big, &du);
    let fault = |(point, c): (u8, Collapsed)| FaultCause::Collapsed {
        point,
        ratio: c.ratio,
    };
    *out = H8System::default();
    let (points, ln_theta) = points(re, &big, &du).map_err(fault)?;
    let mut own = [Answer::default(); 8];
    let (mut pressure, mut volume, mut bb) = (0.0, 0.0, 0.0);
    for (g, point) in points.iter().enumerate() {
        let (strain, a) = point.scaled(&re.metric[g], ln_theta);
        let response = law
            .response(&re.metric[g], &strain, &state_of::<L>(states, g))
            .map_err(|c| fault((g as u8, c)))?;
        let dv = re.volume[g];
        out.energy += response.energy * dv;
        let stress = response.stress.map(|s| a * s);
        let moduli = response.tangent.map(|row| row.map(|d| a * a * d));
        let dc = moduli.map(|row| with_c(&row, &point.c));
        let p = with_c(&stress, &point.c) / 3.0;
        let h: [f64; 6] = std::array::from_fn(|v| dc[v] / 3.0 + stress[v] * (2.0 / 3.0));
        let across = match law.symmetric() {
            true => h,
            false => std::array::from_fn(|w| {
                with_c(&moduli.map(|row| row[w]), &point.c) / 3.0 + stress[w] * (2.0 / 3.0)
            }),
        };
        let k = with_c(&dc, &point.c) / 9.0 + p * (2.0 / 3.0);
        pressure += p * dv;
        volume += point.ln_j.exp() * dv;
        bb += k * dv;
        own[g] = Answer {
            stress,
            moduli,
            h,
            across,
            k,
            p,
        };
    }
    let mean = pressure / volume;
    let (mut y, mut b, mut z) = ([0.0; 24], [0.0; 24], [0.0; 24]);
    for (g, (point, own)) in points.iter().zip(own).enumerate() {
        let Answer {
            stress,
            moduli,
            h,
            across,
            k,
            p,
        } = own;
        let (frame, dv, ci) = (now.at(g), re.volume[g], &point.ci);
        let j = point.ln_j.exp();
        let more = mean * j - p;
        let s: [f64; 6] = std::array::from_fn(|v| stress[v] + ci[v] * more);
        let mut tangent = isotropic(ci, k + mean * j, -more);
        for v in 0..6 {
            for w in 0..6 {
                tangent[v][w] += moduli[v][w] - h[v] * ci[w] - ci[v] * across[w];
            }
        }
        brick::add_forces(g, &frame, &s, dv, &mut out.f);
        Pointwise::new(&frame, &s, &tangent, dv).add_to(g, &mut out.k, law.symmetric());
        let coupled: [f64; 6] = std::array::from_fn(|v| h[v] - k * ci[v]);
        brick::add_forces(g, &frame, &coupled, dv, &mut y);
        if !law.symmetric() {
            let coupled: [f64; 6] = std::array::from_fn(|v| across[v] - k * ci[v]);
            brick::add_forces(g, &frame, &coupled, dv, &mut z);
        }
        brick::add_forces(g, &frame, ci, dv * j / volume, &mut b);
    }
    bb -= pressure;
    if !law.symmetric() {
        for column in 0..24 {
            for row in 0..24 {
                out.k[24 * column + row] +=
                    y[row] * b[column] + b[row] * z[column] + bb * b[row] * b[column];
            }
        }
        return Ok(());
    }
    for column in 0..24 {
        for row in 0..=column {
            out.k[24 * column + row] +=
                y[row] * b[column] + b[row] * y[column] + bb * b[row] * b[column];
        }
    }
    brick::mirror(&mut out.k);
    Ok(())
}

#[cfg(test)]
mod tests;
