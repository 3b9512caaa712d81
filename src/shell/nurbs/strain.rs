//! Strains of an element, assumed or compatible, and the forces of their resultants. Points come in groups: one for a whole element,
//! one for each part of one that a trim cuts.
use super::super::error::FaultCause;
use super::super::kinematics::V;
use super::frame::{Components, Frame, NODES, Normal, combine, membrane, moved};
use super::plane_stress::{PlaneStress, Resultants};
use super::point::{ASSUMED, PLAIN, Turn};
use super::{NurbsBlock, borders};
use num_dual::DualNum;

/// What the displacements of an element give at the points of a group. Only the first points of each array are used.
pub(super) struct Strains<D> {
    /// At the Gauss points.
    pub frames: [Frame<D>; PLAIN],
    /// Tangents at the tying points.
    pub tangents: [[V<D>; 2]; ASSUMED],
    /// Membrane strains, assumed where they are, and curvatures at the Gauss points.
    pub strains: [[D; 6]; PLAIN],
    /// Displacements of the control points.
    pub u: [V<D>; NODES],
}

/// How an assumed strain mixes those of the points: `back_g (sum_c (L_c(g) - mean L_c) T_c eps_c + sum_h part_h T_h eps_h)`.
pub(super) struct Mix {
    /// Share of each Gauss point in the area.
    pub part: [f64; ASSUMED],
    /// `L_c(g)` less its mean, `[g][c]`.
    pub functions: [[f64; ASSUMED]; ASSUMED],
}

impl Mix {
    #[inline(always)]
    pub fn new(block: &NurbsBlock, group: usize) -> Mix {
        let points = block.gauss(group);
        let area: f64 = points.iter().map(|p| p.weight).sum();
        let mut part = [0.0; ASSUMED];
        let mut mean = [0.0; ASSUMED];
        for (g, p) in points.iter().enumerate() {
            part[g] = p.weight / area;
            for c in 0..ASSUMED {
                mean[c] += part[g] * block.functions[g][c];
            }
        }
        let functions = block
            .functions
            .map(|l| std::array::from_fn(|c| l[c] - mean[c]));
        Mix { part, functions }
    }
}

#[inline(always)]
pub(super) fn apply<D: DualNum<f64> + Copy>(m: &Turn, e: &Components<D>) -> Components<D> {
    m.map(|row| e[0] * row[0] + e[1] * row[1] + e[2] * row[2])
}

#[inline(always)]
fn transposed<D: DualNum<f64> + Copy>(m: &Turn, e: &Components<D>) -> Components<D> {
    [0, 1, 2].map(|j| e[0] * m[0][j] + e[1] * m[1][j] + e[2] * m[2][j])
}

/// Puts assumed membrane strains in the place of the compatible ones at the Gauss points, with those of the tying points, turned.
#[inline(always)]
fn blend<D: DualNum<f64> + Copy>(
    block: &NurbsBlock,
    group: usize,
    tied: &[Components<D>; ASSUMED],
    strains: &mut [Components<D>; PLAIN],
) {
    let mix = Mix::new(block, group);
    let points = block.gauss(group);
    let mut mean = [D::zero(); 3];
    for (g, p) in points.iter().enumerate() {
        let turned = apply(&p.turn, &strains[g]);
        (0..3).for_each(|i| mean[i] += turned[i] * mix.part[g]);
    }
    for (g, p) in points.iter().enumerate() {
        let mut sum = mean;
        for c in 0..ASSUMED {
            (0..3).for_each(|i| sum[i] += tied[c][i] * mix.functions[g][c]);
        }
        strains[g] = apply(&p.back, &sum);
    }
}

/// The part of membrane strains that is quadratic in a change of the displacements, `du_i . du_j / 2`, assumed where strains are.
pub(super) fn quadratic(
    block: &NurbsBlock,
    group: usize,
    du: &[V<f64>; NODES],
) -> [Components<f64>; PLAIN] {
    let rest = [0.0; 3];
    let of = |n: [&[f64; NODES]; 2]| membrane([&rest, &rest], &n.map(|n| combine(n, du)));
    let mut out = [[0.0; 3]; PLAIN];
    for (out, p) in out.iter_mut().zip(block.gauss(group)) {
        *out = of([&p.n[0], &p.n[1]]);
    }
    let ties = block.tying(group);
    if !ties.is_empty() {
        let mut tied = [[0.0; 3]; ASSUMED];
        for (tied, tie) in tied.iter_mut().zip(ties) {
            *tied = apply(&tie.turn, &of([&tie.n[0], &tie.n[1]]));
        }
        blend(block, group, &tied, &mut out);
    }
    out
}

impl<D: DualNum<f64> + Copy> Strains<D> {
    #[inline(always)]
    pub fn new(block: &NurbsBlock, group: usize, u: &[V<D>; NODES]) -> Self {
        let zero = [D::zero(); 3];
        let still = Frame {
            at: Normal {
                r: [zero; 2],
                n: zero,
                up: [zero; 2],
                area: D::zero(),
            },
            h: zero,
            gamma: [zero; 2],
        };
        let mut out = Strains {
            frames: [still; PLAIN],
            tangents: [[zero; 2]; ASSUMED],
            strains: [[D::zero(); 6]; PLAIN],
            u: *u,
        };
        for (g, p) in block.gauss(group).iter().enumerate() {
            let own = p.n.each_ref().map(|n| combine(n, u));
            let frame = Frame::new(std::array::from_fn(|k| moved(&p.rest.p[k], &own[k])));
            let eps = membrane([&p.rest.p[0], &p.rest.p[1]], &[own[0], own[1]]);
            out.strains[g][..3].copy_from_slice(&eps);
            out.strains[g][3..].copy_from_slice(&p.rest.bending(&frame, &own));
            out.frames[g] = frame;
        }
        out.assume(block, group);
        out
    }

    /// Puts the assumed membrane strains in the place of the compatible ones.
    fn assume(&mut self, block: &NurbsBlock, group: usize) {
        let ties = block.tying(group);
        if ties.is_empty() {
            return;
        }
        let mut tied = [[D::zero(); 3]; ASSUMED];
        for (c, tie) in ties.iter().enumerate() {
            let own = tie.n.each_ref().map(|n| combine(n, &self.u));
            self.tangents[c] = [0, 1].map(|i| moved(&tie.rest[i], &own[i]));
            tied[c] = apply(&tie.turn, &membrane([&tie.rest[0], &tie.rest[1]], &own));
        }
        let mut plain = self.strains.map(|e| [e[0], e[1], e[2]]);
        blend(block, group, &tied, &mut plain);
        for (strains, eps) in self.strains.iter_mut().zip(plain) {
            strains[..3].copy_from_slice(&eps);
        }
    }

    /// Membrane forces that work on the compatible strains of the Gauss points and of the tying points, with weights, in
    /// place of those on the assumed ones.
    #[inline(always)]
    #[allow(clippy::type_complexity)]
    pub fn spread(
        block: &NurbsBlock,
        group: usize,
        resultants: &[Resultants<D>; PLAIN],
    ) -> ([Components<D>; PLAIN], [Components<D>; ASSUMED]) {
        let points = block.gauss(group);
        let (mut own, mut tied) = ([[D::zero(); 3]; PLAIN], [[D::zero(); 3]; ASSUMED]);
        for (g, p) in points.iter().enumerate() {
            (0..3).for_each(|i| own[g][i] = resultants[g][i] * p.weight);
        }
        let ties = block.tying(group);
        if ties.is_empty() {
            return (own, tied);
        }
        let mix = Mix::new(block, group);
        let mut total = [D::zero(); 3];
        for (g, p) in points.iter().enumerate() {
            let s = transposed(&p.back, &own[g]);
            for i in 0..3 {
                total[i] += s[i];
                for c in 0..ASSUMED {
                    tied[c][i] += s[i] * mix.functions[g][c];
                }
            }
        }
        for (g, p) in points.iter().enumerate() {
            own[g] = transposed(&p.turn, &total.map(|t| t * mix.part[g]));
        }
        for (tied, tie) in tied.iter_mut().zip(ties) {
            *tied = transposed(&tie.turn, tied);
        }
        (own, tied)
    }

    /// Deformed control points.
    pub fn positions(&self, block: &NurbsBlock, group: usize) -> [V<D>; NODES] {
        let reference = &block.reference[block.element_of(group)];
        std::array::from_fn(|a| moved(&reference[a], &self.u[a]))
    }

    /// Energy and forces.
    pub fn forces<L: PlaneStress>(
        &self,
        block: &NurbsBlock,
        group: usize,
        law: &L,
    ) -> Result<(D, [V<D>; NODES]), FaultCause> {
        let points = block.gauss(group);
        let mut energy = D::zero();
        let mut f = [[D::zero(); 3]; NODES];
        let mut resultants = [[D::zero(); 6]; PLAIN];
        for (g, p) in points.iter().enumerate() {
            let (w, r) = law.resultants(g, &p.place, &self.strains[g])?;
            energy += w * p.weight;
            resultants[g] = r;
            let frame = &self.frames[g];
            for (a, f) in f.iter_mut().enumerate() {
                let w = frame.covariant(&p.n, a);
                // dkap_ij = -n . W_ij, the shear twice.
                let moment = r[3] * w[0] + r[4] * w[1] + r[5] * w[2] * 2.0;
                (0..3).for_each(|c| f[c] -= frame.at.n[c] * moment * p.weight);
            }
        }
        let (own, tied) = Self::spread(block, group, &resultants);
        let mut press = |n: [&[f64; NODES]; 2], r: &[V<D>; 2], s: &Components<D>| {
            let along = |i: usize, c: usize| match i {
                0 => s[0] * r[0][c] + s[2] * r[1][c],
                _ => s[1] * r[1][c] + s[2] * r[0][c],
            };
            let t = [0, 1].map(|i| [0, 1, 2].map(|c| along(i, c)));
            for (a, f) in f.iter_mut().enumerate() {
                (0..3).for_each(|c| f[c] += t[0][c] * n[0][a] + t[1][c] * n[1][a]);
            }
        };
        for (g, p) in points.iter().enumerate() {
            press([&p.n[0], &p.n[1]], &self.frames[g].at.r, &own[g]);
        }
        for (c, tie) in block.tying(group).iter().enumerate() {
            press([&tie.n[0], &tie.n[1]], &self.tangents[c], &tied[c]);
        }
        for held in block.held_in(group) {
            energy += borders::forces(held, &self.positions(block, group), &mut f);
        }
        for tether in block.tethers_in(group) {
            energy += tether.forces(&self.u, &mut f);
        }
        Ok((energy, f))
    }
}
