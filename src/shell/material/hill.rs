//! Metal plasticity of rolled sheets after Hill (1948): three axes of symmetry, isotropic hardening, logarithmic strains.
//!
//! The equivalent stress is `q^2 = F (T22 - T33)^2 + G (T33 - T11)^2 + H (T11 - T22)^2 + 2 L T23^2 + 2 M T13^2 + 2 N T12^2`
//! in the axes of the sheet: along the rolling direction, across it, and along the normal. A strip cut at an angle to the
//! rolling direction and pulled narrows `r` times as much as it thins; with `r0`, `r45`, `r90` along, at 45 degrees and across,
//!
//! ```text
//! H = r0 / (1 + r0),  G = 1 / (1 + r0),  F = H / r90,  N = (F + G) (1 + 2 r45) / 2,  L = M = 3/2
//! ```
//!
//! so that `q` is the stress of a strip along the rolling direction, whose hardening curve the law is given. With `r = 1` for all
//! three it is the law of von Mises.
//!
//! Elasticity is isotropic, so the form of `q` and the elastic energy have the same principal modes: two of the normal
//! stresses and the three shears. Along each, `T = 2 mu e / (1 + 2 mu k h)` with the mode's factor `h` in the form and one
//! unknown `k = dp / q` for all of them: the return mapping is a scalar equation. Its axes are material ones: the frame of the
//! undeformed sheet, which the logarithmic strain leaves in place.
//!
//! Sources: R. Hill, *Proceedings of the Royal Society A* 193 (1948) 281-297; logarithmic strains as in [`J2`](super::J2).
use super::hardening::Hardening;
use super::logarithm::Logarithm;
use super::tensor::raise;
use super::{AT_YIELD, Collapsed, LawState, MaterialLaw, Metric, Response, YIELDS};
use crate::shell::{Flow, PlasticWork, VOIGT};
use nalgebra::{Matrix2, Matrix3, SymmetricEigen, Vector3};
use num_dual::DualNum;
use std::f64::consts::{FRAC_1_SQRT_2, SQRT_2};

/// Modes of a deviator: two of the normal components, then 12, 23, 13.
const MODES: usize = 5;
/// Components of the normal along the frame below which a rolling direction has no direction in the sheet.
const IN_SHEET: f64 = 0.1;

/// Elastic constants, hardening along the rolling direction, and the modes of the equivalent stress.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Hill48 {
    /// First constant of Lamé (force / length^2).
    pub lambda: f64,
    /// Shear modulus (force / length^2).
    pub mu: f64,
    /// Yield stress along the rolling direction over the plastic strain.
    pub hardening: Hardening,
    /// The rolling direction in space, of any length.
    rolling: [f64; 3],
    /// The two modes of the normal components, orthogonal to each other and to (1, 1, 1), of length 1.
    normal: [[f64; 3]; 2],
    /// Factor of every mode in the form of `q`.
    factors: [f64; MODES],
}

/// What a point of a rolled sheet remembers.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Hill48State {
    /// Plastic strain, by modes.
    pub strain: [f64; MODES],
    /// Equivalent plastic strain.
    pub p: f64,
    /// Deviatoric stress at the end of the step, by modes.
    pub stress: [f64; MODES],
    /// Plastic work per undeformed volume.
    pub work: f64,
    /// Cosine and sine of the angle in the sheet from the element's first direction to the rolling direction.
    pub turn: [f64; 2],
}

impl LawState for Hill48State {
    const LEN: usize = 14;
    const UNUSED: Hill48State = Hill48State {
        strain: [0.0; MODES],
        p: 0.0,
        stress: [0.0; MODES],
        work: 0.0,
        turn: [0.0; 2],
    };

    #[inline]
    fn read(from: &[f64]) -> Hill48State {
        let mut state = Hill48State::UNUSED;
        state.strain.copy_from_slice(&from[..5]);
        state.p = from[5];
        state.stress.copy_from_slice(&from[6..11]);
        state.work = from[11];
        state.turn.copy_from_slice(&from[12..14]);
        state
    }

    #[inline]
    fn write(&self, to: &mut [f64]) {
        to[..5].copy_from_slice(&self.strain);
        to[5] = self.p;
        to[6..11].copy_from_slice(&self.stress);
        to[11] = self.work;
        to[12..14].copy_from_slice(&self.turn);
    }
}

/// The axes of the sheet at a point.
struct Axes {
    /// Column `a` has the components of the frame's vectors along axis `a`: `G_i = sum_a M_ia e_a`.
    frame: Matrix3<f64>,
    /// Its inverse: `e_a = sum_i (M^-1)_ai G_i`.
    inverse: Matrix3<f64>,
}

impl Axes {
    /// The first two vectors of the frame lie in the sheet.
    fn new(metric: &Metric, [cos, sin]: [f64; 2]) -> Axes {
        let [g11, g22, g33, g12, g23, g13] = metric.lower;
        // Cholesky's factor: e1 along G_1, e2 in the plane of G_1 and G_2.
        let l11 = g11.sqrt();
        let (l21, l31) = (g12 / l11, g13 / l11);
        let l22 = (g22 - l21 * l21).sqrt();
        let l32 = (g23 - l31 * l21) / l22;
        let l33 = (g33 - l31 * l31 - l32 * l32).sqrt();
        let own = Matrix3::new(l11, 0.0, 0.0, l21, l22, 0.0, l31, l32, l33);
        let at_start = cos == 0.0 && sin == 0.0;
        let cos = if at_start { 1.0 } else { cos };
        let turn = Matrix3::new(cos, -sin, 0.0, sin, cos, 0.0, 0.0, 0.0, 1.0);
        let frame = own * turn;
        // Triangular, hence without a determinant that could fail.
        let (i11, i22, i33) = (1.0 / l11, 1.0 / l22, 1.0 / l33);
        let i21 = -l21 * i11 * i22;
        let i32 = -l32 * i22 * i33;
        let i31 = -(l31 * i11 + l32 * i21) * i33;
        let inverse = Matrix3::new(i11, 0.0, 0.0, i21, i22, 0.0, i31, i32, i33);
        Axes {
            frame,
            inverse: turn.transpose() * inverse,
        }
    }

    /// Components along the axes of contravariant ones.
    fn along<D: DualNum<f64> + Copy>(&self, a: &[D; 6]) -> [D; 6] {
        turned(&self.frame.transpose(), a)
    }

    /// Contravariant components of those along the axes.
    fn contravariant<D: DualNum<f64> + Copy>(&self, a: &[D; 6]) -> [D; 6] {
        turned(&self.inverse.transpose(), a)
    }

    /// Contravariant moduli of those along the axes.
    fn moduli(&self, c: &[[f64; 6]; 6]) -> [[f64; 6]; 6] {
        let m = self.inverse.transpose();
        let mut q = [[0.0; 6]; 6];
        for (row, (i, j)) in q.iter_mut().zip(VOIGT) {
            for (entry, (a, b)) in row.iter_mut().zip(VOIGT) {
                let other = if a == b { 0.0 } else { m[(i, b)] * m[(j, a)] };
                *entry = m[(i, a)] * m[(j, b)] + other;
            }
        }
        let half: [[f64; 6]; 6] = std::array::from_fn(|v| {
            std::array::from_fn(|w| (0..6).map(|b| q[v][b] * c[b][w]).sum())
        });
        std::array::from_fn(|v| std::array::from_fn(|w| (0..6).map(|b| half[v][b] * q[w][b]).sum()))
    }
}

/// `B A B^T` of a symmetric A.
fn turned<D: DualNum<f64> + Copy>(b: &Matrix3<f64>, a: &[D; 6]) -> [D; 6] {
    let [a11, a22, a33, a12, a23, a13] = *a;
    let full = [[a11, a12, a13], [a12, a22, a23], [a13, a23, a33]];
    VOIGT.map(|(i, j)| {
        let mut sum = D::zero();
        for (k, row) in full.iter().enumerate() {
            for (l, entry) in row.iter().enumerate() {
                sum += *entry * (b[(i, k)] * b[(j, l)]);
            }
        }
        sum
    })
}

/// The end of a step.
struct Returned<D> {
    energy: D,
    /// Stress along the axes.
    stress: [D; 6],
    /// Deviatoric stress by modes.
    modes: [D; MODES],
    /// Equivalent plastic strain of the step over the equivalent stress.
    k: D,
    /// Equivalent stress.
    q: D,
}

impl Hill48 {
    /// From r-values along, at 45 degrees to and across the rolling direction, all positive, and this direction in space.
    pub fn new(
        (lambda, mu): (f64, f64),
        hardening: Hardening,
        [r0, r45, r90]: [f64; 3],
        rolling: [f64; 3],
    ) -> Hill48 {
        let (h, g) = (r0 / (1.0 + r0), 1.0 / (1.0 + r0));
        let f = h / r90;
        let n = 0.5 * (f + g) * (1.0 + 2.0 * r45);
        // Nothing of a uniform stress counts: the form of the normal components has two modes in the plane across it.
        let form = Matrix3::new(g + h, -h, -g, -h, f + h, -f, -g, -f, f + g);
        let across = [
            Vector3::new(FRAC_1_SQRT_2, -FRAC_1_SQRT_2, 0.0),
            Vector3::new(1.0, 1.0, -2.0) / 6f64.sqrt(),
        ];
        let plane = Matrix2::from_fn(|a, b| across[a].dot(&(form * across[b])));
        let eigen = SymmetricEigen::new(plane);
        let normal = [0, 1].map(|m| {
            let [a, b] = [eigen.eigenvectors[(0, m)], eigen.eigenvectors[(1, m)]];
            (across[0] * a + across[1] * b).into()
        });
        let [first, second] = [eigen.eigenvalues[0], eigen.eigenvalues[1]];
        Hill48 {
            lambda,
            mu,
            hardening,
            rolling,
            normal,
            factors: [first, second, n, 1.5, 1.5],
        }
    }

    /// Whether the rolling direction lies in a sheet with this frame, nearly at least.
    pub fn lies_in(&self, [g1, g2, _]: &[[f64; 3]; 3]) -> bool {
        let normal = Vector3::from(*g1).cross(&Vector3::from(*g2)).normalize();
        let rolling = Vector3::from(self.rolling).normalize();
        normal.cross(&rolling).norm() > IN_SHEET
    }

    /// Modes of a deviator's components along the axes.
    fn modes<D: DualNum<f64> + Copy>(&self, a: &[D; 6]) -> [D; MODES] {
        let [u, v] = (self.normal).map(|n| a[0] * n[0] + a[1] * n[1] + a[2] * n[2]);
        [u, v, a[3] * SQRT_2, a[4] * SQRT_2, a[5] * SQRT_2]
    }

    /// Components along the axes of modes, and of the mean `m`.
    fn components<D: DualNum<f64> + Copy>(&self, modes: &[D; MODES], m: D) -> [D; 6] {
        let [u, v] = self.normal;
        let normal = |i: usize| modes[0] * u[i] + modes[1] * v[i] + m;
        let shear = |i: usize| modes[i] * FRAC_1_SQRT_2;
        [
            normal(0),
            normal(1),
            normal(2),
            shear(2),
            shear(3),
            shear(4),
        ]
    }

    /// Equivalent stress.
    fn equivalent<D: DualNum<f64> + Copy>(&self, modes: &[D; MODES]) -> D {
        let terms = modes.iter().zip(self.factors);
        let square = terms.fold(D::zero(), |sum, (t, h)| sum + *t * *t * h);
        // Its root has no derivative at no stress, where nothing flows.
        match square.re() > 0.0 {
            true => square.sqrt(),
            false => D::zero(),
        }
    }

    /// Return mapping from the old state at logarithmic strains along the axes.
    fn returned<D: DualNum<f64> + Copy>(&self, h: &[D; 6], old: &Hill48State) -> Returned<D> {
        let mu2 = 2.0 * self.mu;
        let trace = h[0] + h[1] + h[2];
        let mut trial = self.modes(h);
        for (t, strain) in trial.iter_mut().zip(old.strain) {
            *t = (*t - strain) * mu2;
        }
        let k = self.flow(&trial, old.p);
        let modes: [D; MODES] =
            std::array::from_fn(|m| trial[m] / (k * (mu2 * self.factors[m]) + 1.0));
        let q = self.equivalent(&modes);
        let bulk = self.lambda + mu2 / 3.0;
        let (_, work) = self.hardening.at(k * q + old.p);
        let stored = modes.iter().fold(D::zero(), |sum, t| sum + *t * *t);
        Returned {
            energy: trace * trace * (0.5 * bulk) + stored / (2.0 * mu2) + work,
            stress: self.components(&modes, trace * bulk),
            modes,
            k,
            q,
        }
    }

    /// The root `k` of `q(k) - sigma_y(p + k q(k))`, which falls, by Newton's method kept between bounds: under `k` no mode is smaller
    /// than by `1 + 2 mu k` times the least factor.
    fn flow<D: DualNum<f64> + Copy>(&self, trial: &[D; MODES], p: f64) -> D {
        let t: [f64; MODES] = std::array::from_fn(|m| trial[m].re());
        let (yields, _) = self.hardening.at(p);
        let first = self.equivalent(&t);
        if first <= yields * (1.0 + AT_YIELD) {
            return D::zero();
        }
        let mu2 = 2.0 * self.mu;
        let least = self.factors.iter().copied().fold(f64::INFINITY, f64::min);
        // Excess of the equivalent stress over the yield stress, and its slope.
        let excess = |k: f64| {
            let now: [f64; MODES] =
                std::array::from_fn(|m| t[m] / (1.0 + mu2 * k * self.factors[m]));
            let q = self.equivalent(&now);
            let change: f64 = (now.iter().zip(self.factors))
                .map(|(t, h)| -mu2 * h * h * t * t / (1.0 + mu2 * k * h))
                .sum::<f64>()
                / q;
            let slope = self.hardening.slope(p + k * q);
            let over = q - self.hardening.at(p + k * q).0;
            (over, change * (1.0 - slope * k) - slope * q)
        };
        let (mut low, mut high) = (0.0, (first / yields - 1.0) / (mu2 * least));
        let mut k = 0.0;
        for _ in 0..100 {
            let (over, slope) = excess(k);
            if over >= 0.0 {
                low = k;
            } else {
                high = k;
            }
            let step = -over / slope;
            if step.abs() <= 1e-15 * k {
                break;
            }
            let next = k + step;
            k = match (low..=high).contains(&next) {
                true => next,
                false => 0.5 * (low + high),
            };
        }
        // A further step with the scalar's own derivatives.
        let (_, slope) = excess(k);
        let now: [D; MODES] = std::array::from_fn(|m| trial[m] / (1.0 + mu2 * k * self.factors[m]));
        let q = self.equivalent(&now);
        let over = q - self.hardening.at(q * k + p).0;
        D::from(k) - over / slope
    }

    /// Derivative of the stress along the axes by the strain, at the end of a step.
    fn moduli(&self, end: &Returned<f64>, p: f64) -> [[f64; 6]; 6] {
        let mu2 = 2.0 * self.mu;
        let bulk = self.lambda + mu2 / 3.0;
        let along = self.factors.map(|h| mu2 / (1.0 + mu2 * end.k * h));
        let mut modes = [[0.0; MODES]; MODES];
        for (m, a) in along.iter().enumerate() {
            modes[m][m] = *a;
        }
        if end.k > 0.0 {
            let n: [f64; MODES] = std::array::from_fn(|m| self.factors[m] * end.modes[m] / end.q);
            let an: [f64; MODES] = std::array::from_fn(|m| along[m] * n[m]);
            let nan: f64 = n.iter().zip(an).map(|(n, an)| n * an).sum();
            let slope = self.hardening.slope(p + end.k * end.q);
            let kept = 1.0 - slope * end.k;
            let c = kept / (slope + kept * nan);
            for (row, a) in modes.iter_mut().zip(an) {
                for (entry, b) in row.iter_mut().zip(an) {
                    *entry -= c * a * b;
                }
            }
        }
        // Row A of the basis: what a unit of every mode adds to component A.
        let unit = |m: usize| std::array::from_fn(|n| f64::from(u8::from(n == m)));
        let basis: [[f64; 6]; MODES] =
            std::array::from_fn(|m| self.components::<f64>(&unit(m), 0.0));
        let mut c = [[0.0; 6]; 6];
        for (v, row) in c.iter_mut().enumerate() {
            for (w, entry) in row.iter_mut().enumerate() {
                *entry = if v < 3 && w < 3 { bulk } else { 0.0 };
                for m in 0..MODES {
                    for n in 0..MODES {
                        *entry += basis[m][v] * modes[m][n] * basis[n][w];
                    }
                }
            }
        }
        c
    }
}

impl MaterialLaw for Hill48 {
    type State = Hill48State;

    fn start(&self, frame: &[[f64; 3]; 3]) -> Hill48State {
        let [g1, g2, _] = frame.map(Vector3::from);
        let first = g1.normalize();
        let normal = g1.cross(&g2).normalize();
        let rolling = Vector3::from(self.rolling);
        let (cos, sin) = (rolling.dot(&first), rolling.dot(&normal.cross(&first)));
        let length = cos.hypot(sin);
        Hill48State {
            turn: [cos / length, sin / length],
            ..Hill48State::UNUSED
        }
    }

    fn energy<D: DualNum<f64> + Copy>(
        &self,
        metric: &Metric,
        strain: &[D; 6],
        old: &Hill48State,
    ) -> Result<D, Collapsed> {
        let h = Logarithm::new(metric, strain)?;
        let axes = Axes::new(metric, old.turn);
        let h = axes.along(&raise(&h.mixed, &metric.upper.map(D::from)));
        Ok(self.returned(&h, old).energy)
    }

    fn stress<D: DualNum<f64> + Copy>(
        &self,
        metric: &Metric,
        strain: &[D; 6],
        old: &Hill48State,
    ) -> Result<(D, [D; 6]), Collapsed> {
        let log = Logarithm::new(metric, strain)?;
        let axes = Axes::new(metric, old.turn);
        let h = axes.along(&raise(&log.mixed, &metric.upper.map(D::from)));
        let end = self.returned(&h, old);
        let stress = log.stress(metric, &axes.contravariant(&end.stress));
        Ok((end.energy, stress))
    }

    fn response(
        &self,
        metric: &Metric,
        strain: &[f64; 6],
        old: &Hill48State,
    ) -> Result<Response, Collapsed> {
        let log = Logarithm::new(metric, strain)?;
        let axes = Axes::new(metric, old.turn);
        let h = axes.along(&raise(&log.mixed, &metric.upper));
        let end = self.returned(&h, old);
        let stress = axes.contravariant(&end.stress);
        let moduli = axes.moduli(&self.moduli(&end, old.p));
        Ok(Response {
            energy: end.energy,
            stress: log.stress(metric, &stress),
            tangent: log.tangent(metric, &stress, &moduli),
        })
    }

    fn advance(
        &self,
        metric: &Metric,
        strain: &[f64; 6],
        old: &Hill48State,
    ) -> Result<Hill48State, Collapsed> {
        let log = Logarithm::new(metric, strain)?;
        let axes = Axes::new(metric, old.turn);
        let h = axes.along(&raise(&log.mixed, &metric.upper));
        let end = self.returned(&h, old);
        let mut new = *old;
        for m in 0..MODES {
            let flowed = end.k * self.factors[m] * end.modes[m];
            new.strain[m] += flowed;
            new.work += 0.5 * (old.stress[m] + end.modes[m]) * flowed;
        }
        new.p += end.k * end.q;
        new.stress = end.modes;
        Ok(new)
    }

    fn flow(&self, _metric: &Metric, old: &Hill48State, new: &Hill48State) -> Flow {
        let most = new.p - old.p;
        if most <= 0.0 {
            return Flow::default();
        }
        let (yields, done) = self.hardening.at(old.p);
        let work = self.hardening.at(new.p).1 - done;
        let [q, end] = [old, new].map(|s| self.equivalent(&s.stress));
        // From an elastic state flow starts along the direction it is found to have.
        let lag = if q < YIELDS * yields {
            0.0
        } else {
            let terms = old.stress.iter().zip(new.stress).zip(self.factors);
            let both: f64 = terms.map(|((a, b), h)| h * a * b).sum();
            0.5 * (2.0 - 2.0 * both / (q * end)).max(0.0).sqrt() * work
        };
        Flow { most, work, lag }
    }

    fn flow_measures(&self, _metric: &Metric, state: &Hill48State) -> [f64; 2] {
        let yields = self.hardening.at(state.p).0;
        [state.p, self.equivalent(&state.stress) / yields]
    }

    fn plastic_work(&self, state: &Hill48State) -> PlasticWork {
        PlasticWork {
            done: state.work,
            in_energy: self.hardening.at(state.p).1,
        }
    }
}

#[cfg(test)]
mod tests;
