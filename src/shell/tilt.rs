//! What keeps assumed strains stable under thickness compression.
//!
//! The thickness strain is tied at the corners of the mid-surface, the transverse shears in the middle of its edges. Where
//! directors tilt by different amounts at the corners, as in bending, a compressive `S^33` therefore gains the whole work
//! of their second-order shortening at the corners, while the shears (and the thickness strains at the Gauss points) that
//! hold them up in a continuum are left out: a sheet of elements `h` long and `t` thick loses its bending stiffness at a
//! pressure of about `E/3 (t/h)^2`, far below what any continuum does, and a block squeezed to 70 % gets negative pivots
//! of no physical meaning. With the strains of the mid-surface written as `1, r, s, rs` modes, what the tying leaves out of
//! the squares of shears and thickness strains is added with the stress as its weight:
//!
//! `W = V/2 k(C) (c^ab [gamma_a gamma_b] + [E_33 E_33] / C_33)`, `k = (s - s0)^2 / s` for `s = -S^33 > s0`, else 0,
//!
//! where brackets are the mean over the corners less the mean of what the tying keeps, `c^ab` is the inverse metric of the
//! mid-surface, and `s0` a seventh of the pressure above (at most a twentieth of E). It vanishes in every state whose strains are the same at all
//! corners, and takes no part where a shell is not squeezed.
use super::kinematics::{Fields, V, dot, shear, stretch};
use super::material::{Law, MaterialLaw, Metric};
use super::reference::{Reference, sign};
use num_dual::{Dual2SVec64, DualNum};

/// `s0` over `E min(1 / max(G_11, G_22), G^33)`. Smaller values change shells that are in no danger, and Newton's method then
/// meets a stiffness that sets in at once.
const ONSET: f64 = 0.05;
/// Part of a mode's square that one linear direction of the tying leaves out: 1 - 1/3.
const LINEAR: f64 = 2.0 / 3.0;
/// The same of the mode rs of the thickness strain: 1 - 1/9.
const BILINEAR: f64 = 8.0 / 9.0;
/// Modes r, s, rs of shear 13, of shear 23, of the thickness strain.
const MODES: usize = 9;
/// Strains that `k` depends on: 11, 22, 33, 12 of the centre.
const CENTRE: usize = 4;
const INPUTS: usize = MODES + CENTRE;

/// Vectors that all strains here are made of: mid-surface edges along r (s = -+1) and s (r = -+1), directors.
type Frame<D> = ([V<D>; 2], [V<D>; 2], [V<D>; 4]);

fn frame<D: DualNum<f64> + Copy>(f: &Fields<D>) -> Frame<D> {
    (
        [f.tie13[0][0], f.tie13[1][0]],
        [f.tie23[0][0], f.tie23[1][0]],
        f.t,
    )
}

fn middle<D: DualNum<f64> + Copy>(a: &[V<D>; 2]) -> V<D> {
    [0, 1, 2].map(|x| (a[0][x] + a[1][x]) * 0.5)
}

/// Values of the modes r, s, rs at corner `c`, a quarter of them: what turns corner values into amplitudes.
fn modes(c: usize) -> [f64; 3] {
    let (r, s) = (sign(c, 0), sign(c, 1));
    [0.25 * r, 0.25 * s, 0.25 * r * s]
}

/// The strains that the energy depends on: amplitudes of the modes, then those of the centre.
fn inputs<D: DualNum<f64> + Copy>(big: &Frame<f64>, u: &Frame<D>) -> [D; INPUTS] {
    let mut z = [D::zero(); INPUTS];
    for c in 0..4 {
        let (i, j) = (c & 1, c >> 1);
        let corner = [
            shear([&big.0[j], &big.2[c]], [&u.0[j], &u.2[c]]),
            shear([&big.1[i], &big.2[c]], [&u.1[i], &u.2[c]]),
            stretch(&big.2[c], &u.2[c]),
        ];
        for (m, weight) in modes(c).into_iter().enumerate() {
            for kind in 0..3 {
                z[3 * kind + m] += corner[kind] * weight;
            }
        }
        z[MODES + 2] += corner[2] * 0.25;
    }
    let (r, s) = (middle(&big.0), middle(&big.1));
    let (ur, us) = (middle(&u.0), middle(&u.1));
    z[MODES] = stretch(&r, &ur);
    z[MODES + 1] = stretch(&s, &us);
    z[MODES + 3] = shear([&r, &s], [&ur, &us]);
    z
}

/// Metric of the centre, volume and onset of an element.
struct Element {
    metric: Metric,
    volume: f64,
    onset: f64,
}

impl Element {
    fn new(re: &Reference, big: &Fields<f64>, young: f64) -> Element {
        let [a, b, c] = big.centre();
        let lower = [
            dot(&a, &a),
            dot(&b, &b),
            dot(&c, &c),
            dot(&a, &b),
            dot(&b, &c),
            dot(&a, &c),
        ];
        let metric = Metric::new(lower);
        Element {
            metric,
            volume: re.volume.iter().sum(),
            onset: ONSET * young * (1.0 / lower[0].max(lower[1])).min(metric.upper[2]),
        }
    }

    /// `-S^33` at the centre, without transverse shear; `None` where the strain is impossible (which the Gauss points
    /// tell).
    fn squeeze<D: DualNum<f64> + Copy, L: MaterialLaw>(
        &self,
        law: &L,
        q: &[D; CENTRE],
    ) -> Option<D> {
        let strain = [q[0], q[1], q[2], q[3], D::zero(), D::zero()];
        let (_, stress) = law.stress(&self.metric, &strain).ok()?;
        Some(-stress[2])
    }

    /// `V k c^11`, `V k c^22`, `V k c^12`, `V k / C_33`.
    fn weights<D: DualNum<f64> + Copy>(&self, squeeze: D, q: &[D; CENTRE]) -> [D; 4] {
        let g = &self.metric.lower;
        let (c11, c22, c33, c12) = (
            q[0] * 2.0 + g[0],
            q[1] * 2.0 + g[1],
            q[2] * 2.0 + g[2],
            q[3] + g[3],
        );
        let above = squeeze - self.onset;
        let k = above * above / squeeze * self.volume;
        let f = k / (c11 * c22 - c12 * c12);
        [f * c22, f * c11, -f * c12, k / c33]
    }
}

/// The quadratic forms of the modes that the four weights go with, and half of their gradients.
fn forms<D: DualNum<f64> + Copy>(a: &[D]) -> ([D; 4], [[D; MODES]; 4]) {
    let mut half = [[D::zero(); MODES]; 4];
    // r and rs of 13, s and rs of 23 are left out by the tying; the other direction is kept, but for a third.
    half[0][0] = a[0];
    half[0][1] = a[1] * LINEAR;
    half[0][2] = a[2];
    half[1][3] = a[3] * LINEAR;
    half[1][4] = a[4];
    half[1][5] = a[5];
    // The smaller of both parts, so that the form stays positive on skew elements.
    for (m, part) in [LINEAR, LINEAR, 1.0].into_iter().enumerate() {
        half[2][m] = a[3 + m] * part;
        half[2][3 + m] = a[m] * part;
    }
    for (m, part) in [LINEAR, LINEAR, BILINEAR].into_iter().enumerate() {
        half[3][6 + m] = a[6 + m] * part;
    }
    let value = |h: &[D; MODES]| (0..MODES).fold(D::zero(), |sum, m| sum + h[m] * a[m]);
    ([0, 1, 2, 3].map(|f| value(&half[f])), half)
}

/// Energy; `None` where the element is not squeezed.
#[cfg(test)]
pub(super) fn energy<D: DualNum<f64> + Copy, L: MaterialLaw>(
    law: &L,
    young: f64,
    re: &Reference,
    u: &[V<D>; 8],
) -> Option<D> {
    let big = Fields::new(&re.nodes);
    let element = Element::new(re, &big, young);
    let z = inputs(&frame(&big), &frame(&Fields::new(u)));
    let q = [z[9], z[10], z[11], z[12]];
    let squeeze = element.squeeze(law, &q)?;
    if squeeze.re() <= element.onset {
        return None;
    }
    let (forms, _) = forms(&z[..MODES]);
    let weights = element.weights(squeeze, &q);
    Some((0..4).fold(D::zero(), |sum, f| sum + weights[f] * forms[f] * 0.5))
}

/// Adds the forces at nodal displacements `u` and, where wanted, their tangent (both `3 node + axis`); returns the energy.
pub(super) fn add(
    law: &Law,
    re: &Reference,
    u: &[V<f64>; 8],
    f: &mut [f64; 24],
    k: Option<&mut [f64; 576]>,
) -> f64 {
    let young = law.young();
    match law {
        Law::StVenantKirchhoff(law) => add_with(law, young, re, u, f, k),
        Law::NeoHooke(law) => add_with(law, young, re, u, f, k),
    }
}

fn add_with<L: MaterialLaw>(
    law: &L,
    young: f64,
    re: &Reference,
    u: &[V<f64>; 8],
    f: &mut [f64; 24],
    k: Option<&mut [f64; 576]>,
) -> f64 {
    let fields = Fields::new(&re.nodes);
    let element = Element::new(re, &fields, young);
    let (big, du) = (frame(&fields), frame(&Fields::new(u)));
    let z = inputs(&big, &du);
    let q = [z[9], z[10], z[11], z[12]];
    match element.squeeze(law, &q) {
        Some(squeeze) if squeeze > element.onset => {}
        _ => return 0.0,
    }
    type Dual = Dual2SVec64<CENTRE>;
    let dual: [Dual; CENTRE] = std::array::from_fn(|m| Dual::from_re(q[m]).derivative(m));
    let Some(squeeze) = element.squeeze(law, &dual) else {
        return 0.0;
    };
    let weights = element.weights(squeeze, &dual);
    let (forms, half) = forms(&z[..MODES]);

    // First and second derivatives of the energy along its inputs.
    let mut first = [0.0; INPUTS];
    let mut second = [[0.0; INPUTS]; INPUTS];
    let mut energy = 0.0;
    for (form, weight) in weights.iter().enumerate() {
        let gradient = weight.v1.unwrap_generic(nalgebra::U1, nalgebra::Const);
        let hessian = (weight.v2).unwrap_generic(nalgebra::Const::<CENTRE>, nalgebra::Const);
        energy += 0.5 * weight.re * forms[form];
        for m in 0..MODES {
            first[m] += weight.re * half[form][m];
        }
        for i in 0..CENTRE {
            first[MODES + i] += 0.5 * gradient[i] * forms[form];
            for j in 0..CENTRE {
                second[MODES + i][MODES + j] += 0.5 * hessian[(i, j)] * forms[form];
            }
            for m in 0..MODES {
                let mixed = gradient[i] * half[form][m];
                second[m][MODES + i] += mixed;
                second[MODES + i][m] += mixed;
            }
        }
        // The forms are quadratic: unit vectors give their rows.
        for m in 0..MODES {
            let mut unit = [0.0; MODES];
            unit[m] = 1.0;
            let row = self::forms(&unit).1[form];
            for n in 0..MODES {
                second[m][n] += weight.re * row[n];
            }
        }
    }

    let now = add_frames(&big, &du);
    let rows = rows(&now);
    for (row, w) in rows.iter().zip(first) {
        for (f, r) in f.iter_mut().zip(row) {
            *f += w * r;
        }
    }
    if let Some(k) = k {
        let mut left = [[0.0; 24]; INPUTS];
        for m in 0..INPUTS {
            for n in 0..INPUTS {
                for c in 0..24 {
                    left[m][c] += second[m][n] * rows[n][c];
                }
            }
        }
        let geometric = geometric(&first);
        for column in 0..24 {
            for row in 0..=column {
                let mut sum = if row % 3 == column % 3 {
                    geometric[row / 3][column / 3]
                } else {
                    0.0
                };
                for m in 0..INPUTS {
                    sum += rows[m][row] * left[m][column];
                }
                k[24 * column + row] += sum;
                if row != column {
                    k[24 * row + column] += sum;
                }
            }
        }
    }
    energy
}

fn add_frames(big: &Frame<f64>, u: &Frame<f64>) -> Frame<f64> {
    let sum = |a: &V<f64>, b: &V<f64>| [a[0] + b[0], a[1] + b[1], a[2] + b[2]];
    (
        [0, 1].map(|p| sum(&big.0[p], &u.0[p])),
        [0, 1].map(|p| sum(&big.1[p], &u.1[p])),
        [0, 1, 2, 3].map(|c| sum(&big.2[c], &u.2[c])),
    )
}

/// Coefficient of node `a` in the mid-surface edge along r at s = -+1 (`j`), along s at r = -+1 (`i`), in director `c`.
fn along_r(a: usize, j: usize) -> f64 {
    if (a >> 1) & 1 == j {
        0.25 * sign(a, 0)
    } else {
        0.0
    }
}
fn along_s(a: usize, i: usize) -> f64 {
    if a & 1 == i { 0.25 * sign(a, 1) } else { 0.0 }
}
fn along_t(a: usize, c: usize) -> f64 {
    if a & 3 == c { 0.5 * sign(a, 2) } else { 0.0 }
}
/// In the edges through the centre.
fn centre(a: usize) -> [f64; 2] {
    [0.125 * sign(a, 0), 0.125 * sign(a, 1)]
}

/// Derivatives of the inputs along the nodal displacements.
fn rows(now: &Frame<f64>) -> [[f64; 24]; INPUTS] {
    let (mr, ms) = (middle(&now.0), middle(&now.1));
    let mut rows = [[0.0; 24]; INPUTS];
    for a in 0..8 {
        let [nr, ns] = centre(a);
        for x in 0..3 {
            let d = 3 * a + x;
            for c in 0..4 {
                let (i, j) = (c & 1, c >> 1);
                let t = along_t(a, c);
                let corner = [
                    along_r(a, j) * now.2[c][x] + t * now.0[j][x],
                    along_s(a, i) * now.2[c][x] + t * now.1[i][x],
                    t * now.2[c][x],
                ];
                for (m, weight) in modes(c).into_iter().enumerate() {
                    for kind in 0..3 {
                        rows[3 * kind + m][d] += weight * corner[kind];
                    }
                }
                rows[MODES + 2][d] += 0.25 * corner[2];
            }
            rows[MODES][d] = nr * mr[x];
            rows[MODES + 1][d] = ns * ms[x];
            rows[MODES + 3][d] = nr * ms[x] + ns * mr[x];
        }
    }
    rows
}

/// Second derivatives of the inputs, weighted: a scalar per pair of nodes.
fn geometric(first: &[f64; INPUTS]) -> [[f64; 8]; 8] {
    let mut k = [[0.0; 8]; 8];
    for a in 0..8 {
        for b in 0..8 {
            let mut sum = 0.0;
            for c in 0..4 {
                let (i, j) = (c & 1, c >> 1);
                let (ta, tb) = (along_t(a, c), along_t(b, c));
                let weights = modes(c);
                let force = |kind: usize| (0..3).map(|m| weights[m] * first[3 * kind + m]).sum();
                let force: [f64; 3] = [force(0), force(1), force(2)];
                sum += force[0] * (along_r(a, j) * tb + ta * along_r(b, j))
                    + force[1] * (along_s(a, i) * tb + ta * along_s(b, i))
                    + (force[2] + 0.25 * first[MODES + 2]) * ta * tb;
            }
            let ([ra, sa], [rb, sb]) = (centre(a), centre(b));
            sum += first[MODES] * ra * rb
                + first[MODES + 1] * sa * sb
                + first[MODES + 3] * (ra * sb + sa * rb);
            k[a][b] = sum;
        }
    }
    k
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{Elastic, Material};

    fn laws() -> [Law; 2] {
        let elastic = Elastic { e: 100.0, nu: 0.3 };
        [
            Material::StVenantKirchhoff(elastic),
            Material::NeoHooke(elastic),
        ]
        .map(|m| Law::new(&m).unwrap())
    }

    /// A skew, warped element.
    fn nodes() -> [V<f64>; 8] {
        std::array::from_fn(|a| {
            let (i, j, k) = ((a & 1) as f64, ((a >> 1) & 1) as f64, (a >> 2) as f64);
            [
                2.0 * i + 0.3 * i * j,
                1.5 * j + 0.2 * i + 0.1 * k,
                0.8 * k + 0.15 * i + 0.1 * i * j,
            ]
        })
    }

    /// Squeezed by 30 %, with some bending.
    fn squeezed(wave: f64) -> [V<f64>; 8] {
        nodes().map(|x| {
            [
                0.1 * x[0] + wave * (7.0 * x[2] + 3.0 * x[1]).sin(),
                0.05 * x[1] + wave * (5.0 * x[0] + 2.0 * x[2]).cos(),
                -0.3 * x[2] + wave * (4.0 * x[1] + 3.0 * x[0]).sin(),
            ]
        })
    }

    #[test]
    fn forces_and_tangent_are_derivatives_of_the_energy() {
        let (re, _) = Reference::new(nodes());
        let u = squeezed(0.05);
        for law in laws() {
            let mut v = [[Dual2SVec64::<24>::from_re(0.0); 3]; 8];
            for (d, v) in v.as_flattened_mut().iter_mut().enumerate() {
                *v = Dual2SVec64::from_re(u[d / 3][d % 3]).derivative(d);
            }
            let exact = match &law {
                Law::StVenantKirchhoff(l) => energy(l, law.young(), &re, &v),
                Law::NeoHooke(l) => energy(l, law.young(), &re, &v),
            }
            .unwrap();
            let (mut f, mut k) = ([0.0; 24], [0.0; 576]);
            let found = add(&law, &re, &u, &mut f, Some(&mut k));
            let gradient = exact.v1.unwrap_generic(nalgebra::U1, nalgebra::Const::<24>);
            let hessian = (exact.v2).unwrap_generic(nalgebra::Const::<24>, nalgebra::Const::<24>);
            let [scale_f, scale_k] = [gradient.amax(), hessian.amax()];
            assert!(found > 1e-4 && scale_f > 1e-3 && scale_k > 1e-2);
            assert!((found / exact.re - 1.0).abs() < 1e-13);
            for c in 0..24 {
                assert!((f[c] - gradient[c]).abs() < 1e-13 * scale_f);
                for r in 0..24 {
                    assert!((k[24 * c + r] - hessian[(r, c)]).abs() < 1e-13 * scale_k);
                }
            }
        }
    }

    #[test]
    fn nothing_where_strains_are_even_or_nothing_squeezes() {
        // A block with parallel directors, so that homogeneous strains are the same at all corners.
        let block: [V<f64>; 8] = std::array::from_fn(|a| {
            let (i, j, k) = ((a & 1) as f64, ((a >> 1) & 1) as f64, (a >> 2) as f64);
            [2.0 * i + 0.3 * j, 1.5 * j, 0.8 * k]
        });
        let (re, _) = Reference::new(block);
        let even = block.map(|x| [0.1 * x[0], 0.05 * x[1], -0.3 * x[2]]);
        let (plain, _) = Reference::new(nodes());
        let bent = squeezed(0.05).map(|u| [u[0], u[1], 0.0]);
        for law in laws() {
            let mut f = [0.0; 24];
            add(&law, &re, &even, &mut f, None);
            assert!(f.iter().all(|f| f.abs() < 1e-13), "{f:?}");
            assert_eq!(add(&law, &plain, &bent, &mut f, None), 0.0);
        }
    }
}
