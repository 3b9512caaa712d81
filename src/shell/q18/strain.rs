//! The strain of Q18: compatible samples, and the linear rule that makes the strain at Gauss points of them.
//!
//! The rule is the same for strains and for their derivatives, so it is written once over [`Linear`]; its transpose takes
//! stresses back to forces on samples. Three steps:
//!
//! 1. Every component is interpolated from tying points (MITC9: M. L. Bucalem and K.-J. Bathe, IJNME 36 (1993); thickness:
//!    P. Betsch and E. Stein, Commun. Numer. Meth. Eng. 11 (1995)).
//! 2. The difference that this makes to the mean and to the first moment over the thickness of the in-plane strain, in
//!    Cartesian axes of the element, is taken back. Without that step stretching and bending of constant strain are not
//!    represented on distorted elements (1 % in MacNeal's patch test); the tying points being Gauss points, it changes
//!    next to nothing on parallelograms.
//! 3. The volume strain `G^ij E_ij` is projected on 1, r, s, rs, t, rt, st, rst (after J. C. Nagtegaal, D. M. Parks and
//!    J. R. Rice, CMAME 4 (1974)): 18 conditions of constant volume become 8, of which enhanced strains meet four.
use super::super::kinematics::V;
use super::super::material::{Collapsed, MaterialLaw, state_of};
use super::reference::{MODES, Reference, VOLUMES, as_strain, volume_functions};
use super::tables::{POINTS, SAMPLES, TABLES, TIED};
use num_dual::DualNum;

/// Voigt places of the in-plane components 11, 22, 12.
pub(super) const PLANE: [usize; 3] = [0, 1, 3];

/// What the strain rule can be applied to: a strain, or the row of its derivatives.
pub(super) trait Linear: Copy {
    /// No strain.
    fn nil() -> Self;
    /// `self += f x`.
    fn add(&mut self, f: f64, x: &Self);
}

impl Linear for f64 {
    #[inline(always)]
    fn nil() -> f64 {
        0.0
    }
    #[inline(always)]
    fn add(&mut self, f: f64, x: &f64) {
        *self += f * x;
    }
}

impl Linear for num_dual::Dual64 {
    fn nil() -> Self {
        Self::from(0.0)
    }
    #[inline(always)]
    fn add(&mut self, f: f64, x: &Self) {
        *self += *x * f;
    }
}

impl<const N: usize> Linear for [f64; N] {
    #[inline(always)]
    fn nil() -> Self {
        [0.0; N]
    }
    #[inline(always)]
    fn add(&mut self, f: f64, x: &Self) {
        for (sum, x) in self.iter_mut().zip(x) {
            *sum += f * x;
        }
    }
}

/// Compatible strains: at the tying points, and in the plane at the Gauss points.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Compatible<T> {
    pub samples: [T; SAMPLES],
    pub plane: [[T; 3]; POINTS],
}

/// `sum_b n_b y_b`.
#[inline(always)]
pub(super) fn along<D: DualNum<f64> + Copy>(n: &[f64; 18], y: &[V<D>; 18]) -> V<D> {
    let mut sum = [D::zero(); 3];
    for (n, y) in n.iter().zip(y) {
        for (sum, y) in sum.iter_mut().zip(y) {
            *sum += *y * *n;
        }
    }
    sum
}

/// `g_i.g_j - G_i.G_j` (half of it for i = j) from the undeformed derivatives and those of the displacement.
#[inline(always)]
fn component<D: DualNum<f64> + Copy>(same: bool, big: [&V<f64>; 2], u: [&V<D>; 2]) -> D {
    let mut sum = D::zero();
    for x in 0..3 {
        sum += if same {
            u[0][x] * (u[0][x] * 0.5 + big[0][x])
        } else {
            u[0][x] * big[1][x] + u[1][x] * big[0][x] + u[0][x] * u[1][x]
        };
    }
    sum
}

/// Compatible strains of a displacement.
pub(super) fn compatible<D: DualNum<f64> + Copy + Linear>(
    re: &Reference,
    u: &[V<D>; 18],
) -> Compatible<D> {
    let tables = &**TABLES;
    let mut out = Compatible {
        samples: [D::nil(); SAMPLES],
        plane: [[D::nil(); 3]; POINTS],
    };
    for (e, sample) in out.samples.iter_mut().zip(&tables.samples) {
        let same = sample.directions[0] == sample.directions[1];
        let [n0, n1] = &sample.n;
        let (b0, u0) = (along(n0, &re.y), along(n0, u));
        *e = if same {
            component(true, [&b0, &b0], [&u0, &u0])
        } else {
            let (b1, u1) = (along(n1, &re.y), along(n1, u));
            component(false, [&b0, &b1], [&u0, &u1])
        };
    }
    for (e, point) in out.plane.iter_mut().zip(&tables.points) {
        let b = [0, 1].map(|k| along(&point.n[k], &re.y));
        let d = [0, 1].map(|k| along(&point.n[k], u));
        *e = [
            component(true, [&b[0], &b[0]], [&d[0], &d[0]]),
            component(true, [&b[1], &b[1]], [&d[1], &d[1]]),
            component(false, [&b[0], &b[1]], [&d[0], &d[1]]),
        ];
    }
    out
}

/// Strains at the Gauss points, without enhanced strains.
pub(super) fn assumed<T: Linear>(re: &Reference, from: &Compatible<T>) -> [[T; 6]; POINTS] {
    let tables = &**TABLES;
    let mut strain = [[T::nil(); 6]; POINTS];
    let mut moment = [[T::nil(); 3]; 2];
    for (g, point) in tables.points.iter().enumerate() {
        let e = &mut strain[g];
        for (v, (first, weights)) in point.tied.iter().enumerate() {
            for (w, sample) in weights[..TIED[v]].iter().zip(&from.samples[*first..]) {
                e[v].add(*w, sample);
            }
        }
        let mut lost = from.plane[g];
        for (lost, v) in lost.iter_mut().zip(PLANE) {
            lost.add(-1.0, &e[v]);
        }
        for (c, row) in re.to_local[g].iter().enumerate() {
            for (f, lost) in row.iter().zip(&lost) {
                let f = f * re.volume[g];
                moment[0][c].add(f, lost);
                moment[1][c].add(f * point.xi[2], lost);
            }
        }
    }
    let mut back = [[T::nil(); 3]; 2];
    for (k, back) in back.iter_mut().enumerate() {
        for (l, moment) in moment.iter().enumerate() {
            for (back, moment) in back.iter_mut().zip(moment) {
                back.add(re.moments[k][l], moment);
            }
        }
    }
    for (g, point) in tables.points.iter().enumerate() {
        let mut local = back[0];
        for (local, slope) in local.iter_mut().zip(&back[1]) {
            local.add(point.xi[2], slope);
        }
        for (row, v) in re.from_local[g].iter().zip(PLANE) {
            for (f, local) in row.iter().zip(&local) {
                strain[g][v].add(*f, local);
            }
        }
    }
    project_volume(re, &mut strain);
    strain
}

/// Step 3 of the rule.
pub(super) fn project_volume<T: Linear>(re: &Reference, strain: &mut [[T; 6]; POINTS]) {
    let tables = &**TABLES;
    let mut trace = [T::nil(); POINTS];
    let mut product = [T::nil(); VOLUMES];
    for (g, point) in tables.points.iter().enumerate() {
        for (upper, e) in re.metric[g].upper.iter().zip(&strain[g]) {
            trace[g].add(*upper, e);
        }
        for (sum, p) in product.iter_mut().zip(volume_functions(point.xi)) {
            sum.add(p * re.volume[g], &trace[g]);
        }
    }
    let mut coefficient = [T::nil(); VOLUMES];
    for (c, row) in coefficient.iter_mut().zip(&re.volumes) {
        for (f, product) in row.iter().zip(&product) {
            c.add(*f, product);
        }
    }
    for (g, point) in tables.points.iter().enumerate() {
        let mut change = T::nil();
        for (c, p) in coefficient.iter().zip(volume_functions(point.xi)) {
            change.add(p, c);
        }
        change.add(-1.0, &trace[g]);
        for (e, lower) in strain[g].iter_mut().zip(as_strain(&re.metric[g].lower)) {
            e.add(lower / 3.0, &change);
        }
    }
}

/// The transpose of [`assumed`]: forces on the compatible strains from stresses times volume.
pub(super) fn transposed<T: Linear>(re: &Reference, mut s: [[T; 6]; POINTS]) -> Compatible<T> {
    let tables = &**TABLES;
    // Step 3.
    let mut pressure = [T::nil(); POINTS];
    let mut product = [T::nil(); VOLUMES];
    for (g, point) in tables.points.iter().enumerate() {
        for (s, lower) in s[g].iter().zip(as_strain(&re.metric[g].lower)) {
            pressure[g].add(lower / 3.0, s);
        }
        for (sum, p) in product.iter_mut().zip(volume_functions(point.xi)) {
            sum.add(p, &pressure[g]);
        }
    }
    let mut coefficient = [T::nil(); VOLUMES];
    for (product, row) in product.iter().zip(&re.volumes) {
        for (c, f) in coefficient.iter_mut().zip(row) {
            c.add(*f, product);
        }
    }
    for (g, point) in tables.points.iter().enumerate() {
        let mut change = T::nil();
        for (c, p) in coefficient.iter().zip(volume_functions(point.xi)) {
            change.add(p * re.volume[g], c);
        }
        change.add(-1.0, &pressure[g]);
        for (s, upper) in s[g].iter_mut().zip(re.metric[g].upper) {
            s.add(upper, &change);
        }
    }
    // Step 2.
    let mut back = [[T::nil(); 3]; 2];
    for (g, point) in tables.points.iter().enumerate() {
        for (row, v) in re.from_local[g].iter().zip(PLANE) {
            for (c, f) in row.iter().enumerate() {
                back[0][c].add(*f, &s[g][v]);
                back[1][c].add(f * point.xi[2], &s[g][v]);
            }
        }
    }
    let mut moment = [[T::nil(); 3]; 2];
    for (l, moment) in moment.iter_mut().enumerate() {
        for (k, back) in back.iter().enumerate() {
            for (moment, back) in moment.iter_mut().zip(back) {
                moment.add(re.moments[k][l], back);
            }
        }
    }
    let mut out = Compatible {
        samples: [T::nil(); SAMPLES],
        plane: [[T::nil(); 3]; POINTS],
    };
    for (g, point) in tables.points.iter().enumerate() {
        for (c, row) in re.to_local[g].iter().enumerate() {
            for (b, f) in row.iter().enumerate() {
                let f = f * re.volume[g];
                out.plane[g][b].add(f, &moment[0][c]);
                out.plane[g][b].add(f * point.xi[2], &moment[1][c]);
            }
        }
        for (plane, v) in out.plane[g].iter().zip(PLANE) {
            s[g][v].add(-1.0, plane);
        }
        // Step 1.
        for (v, (first, weights)) in point.tied.iter().enumerate() {
            for (w, sample) in weights[..TIED[v]].iter().zip(&mut out.samples[*first..]) {
                sample.add(*w, &s[g][v]);
            }
        }
    }
    out
}

/// Strains with the enhanced ones.
pub(super) fn strains<D: DualNum<f64> + Copy + Linear>(
    re: &Reference,
    u: &[V<D>; 18],
    alpha: &[D; MODES],
) -> [[D; 6]; POINTS] {
    let mut strain = assumed(re, &compatible(re, u));
    for (strain, enhanced) in strain.iter_mut().zip(&re.enhanced) {
        for (e, row) in strain.iter_mut().zip(enhanced) {
            for (f, alpha) in row.iter().zip(alpha) {
                e.add(*f, alpha);
            }
        }
    }
    strain
}

/// Energy, forces on mid-surface points and half directors, and forces on the enhanced strains.
#[allow(clippy::type_complexity)]
pub(super) fn forces<D: DualNum<f64> + Copy + Linear, L: MaterialLaw>(
    law: &L,
    re: &Reference,
    u: &[V<D>; 18],
    alpha: &[D; MODES],
    states: &[f64],
) -> Result<(D, [V<D>; 18], [D; MODES]), (u8, Collapsed)> {
    let strain = strains(re, u, alpha);
    let (mut energy, mut h) = (D::zero(), [D::zero(); MODES]);
    let mut stress = [[D::nil(); 6]; POINTS];
    for g in 0..POINTS {
        let (psi, s) = law
            .stress(&re.metric[g], &strain[g], &state_of::<L>(states, g))
            .map_err(|c| (g as u8, c))?;
        energy += psi * re.volume[g];
        stress[g] = s.map(|s| s * re.volume[g]);
        for (row, s) in re.enhanced[g].iter().zip(&stress[g]) {
            for (h, f) in h.iter_mut().zip(row) {
                h.add(*f, s);
            }
        }
    }
    let force = transposed(re, stress);
    let mut now = *u;
    for (now, y) in now.iter_mut().zip(&re.y) {
        for (now, y) in now.iter_mut().zip(y) {
            *now += *y;
        }
    }
    let mut f = [[D::zero(); 3]; 18];
    let mut push = |n: [&[f64; 18]; 2], q: D| {
        let [g0, g1] = n.map(|n| along(n, &now));
        let same = std::ptr::eq(n[0], n[1]);
        for b in 0..18 {
            for x in 0..3 {
                f[b][x] += if same {
                    g0[x] * q * n[0][b]
                } else {
                    (g1[x] * n[0][b] + g0[x] * n[1][b]) * q
                };
            }
        }
    };
    let tables = &**TABLES;
    for (sample, q) in tables.samples.iter().zip(force.samples) {
        if sample.directions[0] == sample.directions[1] {
            push([&sample.n[0], &sample.n[0]], q);
        } else {
            push([&sample.n[0], &sample.n[1]], q);
        }
    }
    for (point, q) in tables.points.iter().zip(force.plane) {
        push([&point.n[0], &point.n[0]], q[0]);
        push([&point.n[1], &point.n[1]], q[1]);
        push([&point.n[0], &point.n[1]], q[2]);
    }
    Ok((energy, f, h))
}
