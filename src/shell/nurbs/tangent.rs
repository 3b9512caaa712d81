//! Forces and tangent of an element.
//!
//! `K = sum w B^T D B + K_geo`. With `beta_a = N_a,k rho^k` and `c_a = m^ij W_ij,a` the second variations of the strains give the
//! block of nodes a and b
//! `K_geo = (n^ij N_a,i N_b,j) I + c_a beta_b x n + c_b n x beta_a + (m^ij h_ij) (beta_a . beta_b) n x n`.
use super::super::error::FaultCause;
use super::super::kinematics::dot;
use super::frame::{Components, DOFS, NODES};
use super::plane_stress::PlaneStress;
use super::point::{ASSUMED, PLAIN, membrane_rows};
use super::strain::{Mix, Strains};
use super::{NurbsBlock, NurbsSystem, borders};

/// Room for an element.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Work {
    /// Rows of strains at the Gauss points.
    rows: [[[f64; DOFS]; 6]; PLAIN],
    /// Turned membrane rows of the tying points.
    tied: [[[f64; DOFS]; 3]; ASSUMED],
    /// Mean of the turned rows of the Gauss points.
    mean: [[f64; DOFS]; 3],
}

impl Work {
    pub fn new() -> Work {
        Work {
            rows: [[[0.0; DOFS]; 6]; PLAIN],
            tied: [[[0.0; DOFS]; 3]; ASSUMED],
            mean: [[0.0; DOFS]; 3],
        }
    }
}

/// `T` applied to three rows.
#[inline(always)]
fn turn(m: &[[f64; 3]; 3], rows: &[[f64; DOFS]; 3], out: &mut [[f64; DOFS]; 3]) {
    for (out, m) in out.iter_mut().zip(m) {
        for d in 0..DOFS {
            out[d] = m[0] * rows[0][d] + m[1] * rows[1][d] + m[2] * rows[2][d];
        }
    }
}

/// Adds what a group of points gives.
///
/// With `bent`, the part of the strains that is quadratic in the last correction, points are mixed: the membrane forces of the geometric
/// part are continued along the correction with the tangent of the law instead of taken where it led to (D. Magisano, L. Leonetti and
/// G. Garcea, CMAME 313 (2017)), which is what they are there less `D : bent`. Forces and energy are the same.
pub(super) fn linearize<L: PlaneStress>(
    at: &Strains<f64>,
    block: &NurbsBlock,
    group: usize,
    law: &L,
    bent: Option<&[Components<f64>; PLAIN]>,
    out: &mut NurbsSystem,
) -> Result<(), FaultCause> {
    let NurbsSystem { f, k, energy, work } = out;
    let points = block.gauss(group);
    rows(at, block, group, work);
    let (mut resultants, mut continued) = ([[0.0; 6]; PLAIN], [[0.0; 6]; PLAIN]);
    let mut pushed = [[0.0; DOFS]; 6];
    for (g, p) in points.iter().enumerate() {
        let answer = law.answer(g, &p.place, &at.strains[g])?;
        resultants[g] = answer.resultants;
        continued[g] = answer.resultants;
        if let Some(bent) = bent {
            for (n, moduli) in continued[g][..3].iter_mut().zip(&answer.tangent) {
                *n -= moduli[0] * bent[g][0] + moduli[1] * bent[g][1] + moduli[2] * bent[g][2];
            }
        }
        *energy += p.weight * answer.energy;
        let b = &work.rows[g];
        for (v, pushed) in pushed.iter_mut().enumerate() {
            let force = p.weight * answer.resultants[v];
            let moduli = answer.tangent[v].map(|c| c * p.weight);
            for d in 0..DOFS {
                f[d] += force * b[v][d];
                let mut sum = moduli[0] * b[0][d];
                for u in 1..6 {
                    sum += moduli[u] * b[u][d];
                }
                pushed[d] = sum;
            }
        }
        for (column, k) in k.chunks_exact_mut(DOFS).enumerate() {
            for (b, pushed) in b.iter().zip(&pushed) {
                let by = pushed[column];
                for (k, b) in k[..=column].iter_mut().zip(b) {
                    *k += by * b;
                }
            }
        }
    }
    let (own, tied) = Strains::spread(block, group, &continued);
    let mut scalars = [0.0; NODES * NODES];
    for (p, n) in points.iter().zip(&own) {
        stretch([&p.n[0], &p.n[1]], n, &mut scalars);
    }
    for (tie, n) in block.tying(group).iter().zip(&tied) {
        stretch([&tie.n[0], &tie.n[1]], n, &mut scalars);
    }
    for b in 0..NODES {
        for a in 0..=b {
            (0..3).for_each(|c| k[(3 * b + c) * DOFS + 3 * a + c] += scalars[b * NODES + a]);
        }
    }
    for (g, p) in points.iter().enumerate() {
        let frame = &at.frames[g];
        let [_, _, _, m1, m2, m3] = resultants[g].map(|r| r * p.weight);
        let m3 = 2.0 * m3;
        let bent = m1 * frame.h[0] + m2 * frame.h[1] + m3 * frame.h[2];
        let n = &frame.at.n;
        let mut beta = [[0.0; 3]; NODES];
        let mut c = [0.0; NODES];
        for a in 0..NODES {
            let w = frame.covariant(&p.n, a);
            c[a] = m1 * w[0] + m2 * w[1] + m3 * w[2];
            beta[a] = frame.at.beta(p.n[0][a], p.n[1][a]);
        }
        for b in 0..NODES {
            for a in 0..=b {
                let both = bent * dot(&beta[a], &beta[b]);
                for j in 0..3 {
                    // Column j of c_a beta_b x n + c_b n x beta_a + both n x n.
                    let along_n = c[b] * beta[a][j] + both * n[j];
                    let along_b = c[a] * n[j];
                    let column = &mut k[(3 * b + j) * DOFS + 3 * a..][..3];
                    for i in 0..3 {
                        column[i] += along_b * beta[b][i] + along_n * n[i];
                    }
                }
            }
        }
    }
    for held in block.held_in(group) {
        let x = at.positions(block, group);
        *energy += borders::linearize(held, &x, f, &mut k[..]);
    }
    for tether in block.tethers_in(group) {
        *energy += tether.linearize(&at.u, f, &mut k[..]);
    }
    // Blocks on the diagonal are symmetric; what is above it is complete.
    for column in 0..DOFS {
        for row in column + 1..DOFS {
            k[column * DOFS + row] = k[row * DOFS + column];
        }
    }
    Ok(())
}

/// Adds `n^ij N_a,i N_b,j` for a <= b.
#[inline(always)]
fn stretch(d: [&[f64; NODES]; 2], n: &Components<f64>, out: &mut [f64; NODES * NODES]) {
    for b in 0..NODES {
        let (along1, along2) = (
            n[0] * d[0][b] + n[2] * d[1][b],
            n[2] * d[0][b] + n[1] * d[1][b],
        );
        for a in 0..=b {
            out[b * NODES + a] += d[0][a] * along1 + d[1][a] * along2;
        }
    }
}

/// Rows of all strains at the Gauss points.
fn rows(at: &Strains<f64>, block: &NurbsBlock, group: usize, work: &mut Work) {
    let points = block.gauss(group);
    let mut plain = [[0.0; DOFS]; 3];
    for (g, p) in points.iter().enumerate() {
        let frame = &at.frames[g];
        let (membrane, bending) = work.rows[g].split_at_mut(3);
        for a in 0..NODES {
            let w = frame.covariant(&p.n, a);
            for c in 0..3 {
                bending[0][3 * a + c] = -w[0] * frame.at.n[c];
                bending[1][3 * a + c] = -w[1] * frame.at.n[c];
                bending[2][3 * a + c] = -2.0 * w[2] * frame.at.n[c];
            }
        }
        membrane_rows([&p.n[0], &p.n[1]], &frame.at.r, &mut plain);
        membrane.copy_from_slice(&plain);
    }
    let ties = block.tying(group);
    if ties.is_empty() {
        return;
    }
    let mix = Mix::new(block, group);
    for (c, tie) in ties.iter().enumerate() {
        membrane_rows([&tie.n[0], &tie.n[1]], &at.tangents[c], &mut plain);
        turn(&tie.turn, &plain, &mut work.tied[c]);
    }
    work.mean = [[0.0; DOFS]; 3];
    let mut turned = [[0.0; DOFS]; 3];
    for (g, p) in points.iter().enumerate() {
        plain.copy_from_slice(&work.rows[g][..3]);
        turn(&p.turn, &plain, &mut turned);
        for (mean, turned) in work.mean.iter_mut().zip(&turned) {
            for (mean, turned) in mean.iter_mut().zip(turned) {
                *mean += mix.part[g] * turned;
            }
        }
    }
    for (g, p) in points.iter().enumerate() {
        plain = work.mean;
        for (c, tied) in work.tied.iter().enumerate() {
            let by = mix.functions[g][c];
            for (plain, tied) in plain.iter_mut().zip(tied) {
                for (plain, tied) in plain.iter_mut().zip(tied) {
                    *plain += by * tied;
                }
            }
        }
        turn(&p.back, &plain, &mut turned);
        work.rows[g][..3].copy_from_slice(&turned);
    }
}
