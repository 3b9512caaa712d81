//! Tangents of the trilinear element and the strains made of them, generic over the scalar.
use super::material::{Collapsed, MaterialLaw, state_of};
use super::pressed;
use super::reference::{BASE, GP, LINE, PARAMETERS, Reference, TYING, WEIGHT, sign};
use num_dual::DualNum;

/// A vector as a plain array, which any scalar can be put into.
pub(super) type V<D> = [D; 3];

#[inline(always)]
pub(super) fn dot<D: DualNum<f64> + Copy>(a: &V<D>, b: &V<D>) -> D {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// Product of a plain vector with one of scalar D.
#[inline(always)]
fn dot_plain<D: DualNum<f64> + Copy>(a: &V<D>, b: &V<f64>) -> D {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

#[inline(always)]
fn mean<D: DualNum<f64> + Copy>(a: &V<D>, b: &V<D>) -> V<D> {
    [
        (a[0] + b[0]) * 0.5,
        (a[1] + b[1]) * 0.5,
        (a[2] + b[2]) * 0.5,
    ]
}

#[inline(always)]
fn half_difference<D: DualNum<f64> + Copy>(a: &V<D>, b: &V<D>) -> V<D> {
    [
        (b[0] - a[0]) * 0.5,
        (b[1] - a[1]) * 0.5,
        (b[2] - a[2]) * 0.5,
    ]
}

/// Derivatives along r, s, t of a trilinear field at the places where strains are taken.
#[derive(Debug, Clone, Copy)]
pub(super) struct Fields<D> {
    /// Along r, `[k][j]` at t, s = -+GP (constant in r).
    pub r: [[V<D>; 2]; 2],
    /// Along s, `[k][i]` at t, r = -+GP (constant in s).
    pub s: [[V<D>; 2]; 2],
    /// Along t at the four corners (constant in t).
    pub t: [V<D>; 4],
    /// Along s and t at the tying points of 23: r = -1 and r = +1, s = t = 0.
    pub tie23: [[V<D>; 2]; 2],
    /// Along r and t at the tying points of 13: s = -1 and s = +1, r = t = 0.
    pub tie13: [[V<D>; 2]; 2],
}

impl<D: DualNum<f64> + Copy> Fields<D> {
    #[inline(always)]
    pub fn new(z: &[V<D>; 8]) -> Fields<D> {
        // Edges: along r at [k][j], along s at [k][i].
        let er = [0, 4].map(|k| [0, 2].map(|j| half_difference(&z[k + j], &z[k + j + 1])));
        let es = [0, 4].map(|k| [0, 1].map(|i| half_difference(&z[k + i], &z[k + i + 2])));
        let t = [0, 1, 2, 3].map(|c| half_difference(&z[c], &z[c + 4]));
        let middle_s = [0, 1].map(|i| mean(&es[0][i], &es[1][i]));
        let middle_r = [0, 1].map(|j| mean(&er[0][j], &er[1][j]));
        Fields {
            r: bilinear(&er),
            s: bilinear(&es),
            t,
            tie23: [
                [middle_s[0], mean(&t[0], &t[2])],
                [middle_s[1], mean(&t[1], &t[3])],
            ],
            tie13: [
                [middle_r[0], mean(&t[0], &t[1])],
                [middle_r[1], mean(&t[2], &t[3])],
            ],
        }
    }

    /// The three derivatives at Gauss point `g`.
    #[inline(always)]
    pub fn at(&self, g: usize) -> [V<D>; 3] {
        let (i, j, k) = (g & 1, (g >> 1) & 1, g >> 2);
        let w = &WEIGHT[g & 3];
        let mut t = [D::zero(); 3];
        for c in 0..4 {
            for x in 0..3 {
                t[x] += self.t[c][x] * w[c];
            }
        }
        [self.r[k][j], self.s[k][i], t]
    }

    /// The three derivatives at in-plane Gauss point `q` and any t.
    #[inline(always)]
    pub fn over(&self, q: usize, t: f64) -> [V<D>; 3] {
        let (low, high) = (0.5 - 0.5 / GP * t, 0.5 + 0.5 / GP * t);
        let at =
            |e: &[[V<D>; 2]; 2], n: usize| [0, 1, 2].map(|x| e[0][n][x] * low + e[1][n][x] * high);
        [at(&self.r, q >> 1), at(&self.s, q & 1), self.at(q)[2]]
    }

    /// The three derivatives at the element centre.
    pub fn centre(&self) -> [V<D>; 3] {
        [
            mean(&self.tie13[0][0], &self.tie13[1][0]),
            mean(&self.tie23[0][0], &self.tie23[1][0]),
            mean(&self.tie13[0][1], &self.tie13[1][1]),
        ]
    }
}

/// Values at (t, other) = -+GP from values at -+1.
#[inline(always)]
fn bilinear<D: DualNum<f64> + Copy>(e: &[[V<D>; 2]; 2]) -> [[V<D>; 2]; 2] {
    [0, 1].map(|k| {
        [0, 1].map(|j| {
            let (a, b) = (LINE[k], LINE[j]);
            [0, 1, 2].map(|x| {
                (e[0][0][x] * b[0] + e[0][1][x] * b[1]) * a[0]
                    + (e[1][0][x] * b[0] + e[1][1][x] * b[1]) * a[1]
            })
        })
    })
}

/// `(g.g - G.G)/2` from `G` and the displacement's derivative, without the cancellation of that difference.
#[inline(always)]
pub(super) fn stretch<D: DualNum<f64> + Copy>(big: &V<f64>, u: &V<D>) -> D {
    let f = |x: usize| u[x] * (u[x] * 0.5 + big[x]);
    f(0) + f(1) + f(2)
}

/// `g_a.g_b - G_a.G_b`, likewise.
#[inline(always)]
pub(super) fn shear<D: DualNum<f64> + Copy>(big: [&V<f64>; 2], u: [&V<D>; 2]) -> D {
    dot_plain(u[0], big[1]) + dot_plain(u[1], big[0]) + dot(u[0], u[1])
}

/// Assumed strains at the eight tying points, less what the edges of a pressed element lean ([`pressed`]).
#[inline(always)]
pub(super) fn tying<D: DualNum<f64> + Copy>(
    big: &Fields<f64>,
    u: &Fields<D>,
    shares: [f64; 2],
) -> [D; TYING] {
    let mut e = [D::zero(); TYING];
    for c in 0..4 {
        e[c] = stretch(&big.t[c], &u.t[c]);
    }
    if pressed::any(shares) {
        let shared = pressed::shared(shares, [e[0], e[1], e[2], e[3]], &big.t, &u.t);
        e[..4].copy_from_slice(&shared);
    }
    for p in 0..2 {
        let (b, d) = (&big.tie23[p], &u.tie23[p]);
        e[4 + p] = shear([&b[0], &b[1]], [&d[0], &d[1]]);
        let (b, d) = (&big.tie13[p], &u.tie13[p]);
        e[6 + p] = shear([&b[0], &b[1]], [&d[0], &d[1]]);
    }
    e
}

/// Covariant strain at all Gauss points: membrane parts where they are, transverse parts from the tying points
/// (shear: E. N. Dvorkin and K.-J. Bathe, Eng. Comput. 1 (1984); thickness: P. Betsch and E. Stein, Commun. Numer.
/// Meth. Eng. 11 (1995)), and the enhanced strains `alpha` (modes of L. Vu-Quoc and X. G. Tan, CMAME 192 (2003)).
#[inline(always)]
pub(super) fn strains<D: DualNum<f64> + Copy, const NE: usize>(
    re: &Reference,
    big: &Fields<f64>,
    u: &Fields<D>,
    alpha: &[D; NE],
    shares: [f64; 2],
) -> [[D; 6]; 8] {
    let tied = tying(big, u, shares);
    let mut strains = [[D::zero(); 6]; 8];
    for (g, e) in strains.iter_mut().enumerate() {
        let (i, j, k) = (g & 1, (g >> 1) & 1, g >> 2);
        let w = &WEIGHT[g & 3];
        e[0] = stretch(&big.r[k][j], &u.r[k][j]);
        e[1] = stretch(&big.s[k][i], &u.s[k][i]);
        e[2] = tied[0] * w[0] + tied[1] * w[1] + tied[2] * w[2] + tied[3] * w[3];
        e[3] = shear([&big.r[k][j], &big.s[k][i]], [&u.r[k][j], &u.s[k][i]]);
        e[4] = tied[4] * w[4] + tied[5] * w[5];
        e[5] = tied[6] * w[6] + tied[7] * w[7];
        if NE > 0 {
            let t = GP * sign(g, 2);
            let mut base = [D::zero(); 4];
            for (m, a) in alpha.iter().enumerate() {
                let p = TYING + m;
                base[BASE[p] - 3] += *a * if BASE[p] == 3 { w[p] * t } else { w[p] };
            }
            let used = if NE > 3 { 4 } else { 1 };
            for (v, e) in e.iter_mut().enumerate() {
                for (m, b) in base.iter().take(used).enumerate() {
                    *e += *b * re.enhanced[g][v][m];
                }
            }
        }
    }
    strains
}

/// Energy, nodal forces `f` (numbered `3 node + axis`) and enhanced-strain forces `h` of the solid-shell element. `states` are those
/// of the law at the Gauss points, `shares` what it takes off its thickness strain.
#[allow(clippy::type_complexity)]
pub(super) fn forces<D: DualNum<f64> + Copy, L: MaterialLaw, const NE: usize>(
    law: &L,
    re: &Reference,
    u: &[V<D>; 8],
    alpha: &[D; NE],
    (states, shares): (&[f64], [f64; 2]),
) -> Result<(D, [D; 24], [D; NE]), (u8, Collapsed)> {
    let big = Fields::new(&re.nodes);
    let du = Fields::new(u);
    let now = add(&big, &du);
    let strain = strains(re, &big, &du, alpha, shares);
    let mut energy = D::zero();
    let mut f = [D::zero(); 24];
    // Forces on the parameters of the strain interpolation.
    let mut force = [D::zero(); PARAMETERS];
    for g in 0..8 {
        let (i, j, k) = (g & 1, (g >> 1) & 1, g >> 2);
        let w = &WEIGHT[g & 3];
        let (psi, s) = law
            .stress(&re.metric[g], &strain[g], &state_of::<L>(states, g))
            .map_err(|c| (g as u8, c))?;
        energy += psi * re.volume[g];
        let s = s.map(|s| s * re.volume[g]);
        for c in 0..4 {
            force[c] += s[2] * w[c];
        }
        for p in 0..2 {
            force[4 + p] += s[4] * w[4 + p];
            force[6 + p] += s[5] * w[6 + p];
        }
        if NE > 0 {
            let t = GP * sign(g, 2);
            for m in 0..NE {
                let p = TYING + m;
                let base = BASE[p] - 3;
                let mut sum = D::zero();
                for v in 0..6 {
                    sum += s[v] * re.enhanced[g][v][base];
                }
                force[p] += sum * if base == 0 { w[p] * t } else { w[p] };
            }
        }
        let (g1, g2) = (&now.r[k][j], &now.s[k][i]);
        for a in 0..8 {
            let along_t = LINE[k][a >> 2];
            let n1 = 0.5 * sign(a, 0) * LINE[j][(a >> 1) & 1] * along_t;
            let n2 = 0.5 * sign(a, 1) * LINE[i][a & 1] * along_t;
            for x in 0..3 {
                f[3 * a + x] +=
                    (s[0] * g1[x] + s[3] * g2[x]) * n1 + (s[3] * g1[x] + s[1] * g2[x]) * n2;
            }
        }
    }
    let mut along_t = [0, 1, 2, 3].map(|c| now.t[c].map(|t| t * force[c]));
    if pressed::any(shares) {
        let rows = pressed::rows(shares, &now.t);
        along_t = [0, 1, 2, 3].map(|a| {
            [0, 1, 2].map(|x| (0..4).fold(D::zero(), |sum, c| sum + rows[c][a][x] * force[c]))
        });
    }
    for a in 0..8 {
        let (i, j, c) = (a & 1, (a >> 1) & 1, a & 3);
        let (r, s, t) = (sign(a, 0), sign(a, 1), sign(a, 2));
        for x in 0..3 {
            f[3 * a + x] += along_t[c][x] * (0.5 * t)
                + (now.tie23[i][1][x] * s + now.tie23[i][0][x] * t) * force[4 + i] * 0.25
                + (now.tie13[j][1][x] * r + now.tie13[j][0][x] * t) * force[6 + j] * 0.25;
        }
    }
    let mut h = [D::zero(); NE];
    h.copy_from_slice(&force[TYING..TYING + NE]);
    Ok((energy, f, h))
}

/// `G + u`, place by place.
#[inline(always)]
pub(super) fn add<D: DualNum<f64> + Copy>(big: &Fields<f64>, u: &Fields<D>) -> Fields<D> {
    let sum = |a: &V<f64>, b: &V<D>| [b[0] + a[0], b[1] + a[1], b[2] + a[2]];
    let pair = |a: &[V<f64>; 2], b: &[V<D>; 2]| [sum(&a[0], &b[0]), sum(&a[1], &b[1])];
    let four = |a: &[[V<f64>; 2]; 2], b: &[[V<D>; 2]; 2]| [pair(&a[0], &b[0]), pair(&a[1], &b[1])];
    Fields {
        r: four(&big.r, &u.r),
        s: four(&big.s, &u.s),
        t: [0, 1, 2, 3].map(|c| sum(&big.t[c], &u.t[c])),
        tie23: four(&big.tie23, &u.tie23),
        tie13: four(&big.tie13, &u.tie13),
    }
}
