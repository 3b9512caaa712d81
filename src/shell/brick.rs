//! The plain displacement brick: compatible strains at all Gauss points. It locks when thin; it is there for solids and
//! for comparison.
use super::error::FaultCause;
use super::h8::H8System;
use super::kinematics::{Fields, V, add};
use super::material::{Collapsed, MaterialLaw, state_of};
use super::reference::{LINE, Reference, sign};
use num_dual::DualNum;

/// Derivatives of the shape functions along r, s, t at Gauss point `g`, `[direction][node]`.
#[inline(always)]
fn derivatives(g: usize) -> [[f64; 8]; 3] {
    let (i, j, k) = (g & 1, (g >> 1) & 1, g >> 2);
    let mut n = [[0.0; 8]; 3];
    for a in 0..8 {
        let (r, s, t) = (LINE[i][a & 1], LINE[j][(a >> 1) & 1], LINE[k][a >> 2]);
        n[0][a] = 0.5 * sign(a, 0) * s * t;
        n[1][a] = 0.5 * sign(a, 1) * r * t;
        n[2][a] = 0.5 * sign(a, 2) * r * s;
    }
    n
}

/// Compatible Green-Lagrange strain from the undeformed frame and the derivatives of the displacement.
#[inline(always)]
pub(super) fn strain<D: DualNum<f64> + Copy>(big: &[V<f64>; 3], u: &[V<D>; 3]) -> [D; 6] {
    super::VOIGT.map(|(i, j)| {
        let mut sum = D::zero();
        for x in 0..3 {
            sum += if i == j {
                u[i][x] * (u[i][x] * 0.5 + big[i][x])
            } else {
                u[i][x] * big[j][x] + u[j][x] * big[i][x] + u[i][x] * u[j][x]
            };
        }
        sum
    })
}

/// Energy and nodal forces (`3 node + axis`).
pub(super) fn forces<D: DualNum<f64> + Copy, L: MaterialLaw>(
    law: &L,
    re: &Reference,
    u: &[V<D>; 8],
    states: &[f64],
) -> Result<(D, [D; 24]), (u8, Collapsed)> {
    let big = Fields::new(&re.nodes);
    let du = Fields::new(u);
    let now = add(&big, &du);
    let (mut energy, mut f) = (D::zero(), [D::zero(); 24]);
    for g in 0..8 {
        let e = strain(&big.at(g), &du.at(g));
        let (psi, s) = law
            .stress(&re.metric[g], &e, &state_of::<L>(states, g))
            .map_err(|c| (g as u8, c))?;
        energy += psi * re.volume[g];
        add_forces(g, &now.at(g), &s, re.volume[g], &mut f);
    }
    Ok((energy, f))
}

/// Forces and tangent.
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
    *out = H8System::default();
    for g in 0..8 {
        let e = strain(&big.at(g), &du.at(g));
        let response = law
            .response(&re.metric[g], &e, &state_of::<L>(states, g))
            .map_err(|c| FaultCause::Collapsed {
                point: g as u8,
                ratio: c.ratio,
            })?;
        let dv = re.volume[g];
        out.energy += response.energy * dv;
        let frame = now.at(g);
        add_forces(g, &frame, &response.stress, dv, &mut out.f);
        Pointwise::new(&frame, &response.stress, &response.tangent, dv).add_to(
            g,
            &mut out.k,
            law.symmetric(),
        );
    }
    if law.symmetric() {
        mirror(&mut out.k);
    }
    Ok(())
}

/// Forces of the stress at Gauss point `g`, whose present tangents are `frame`, on the nodes.
#[inline(always)]
pub(super) fn add_forces<D: DualNum<f64> + Copy>(
    g: usize,
    frame: &[V<D>; 3],
    s: &[D; 6],
    dv: f64,
    f: &mut [D; 24],
) {
    let n = derivatives(g);
    // Force vectors S^ij g_j.
    let full = [[s[0], s[3], s[5]], [s[3], s[1], s[4]], [s[5], s[4], s[2]]];
    for i in 0..3 {
        for x in 0..3 {
            let p = full[i][0] * frame[0][x] + full[i][1] * frame[1][x] + full[i][2] * frame[2][x];
            for a in 0..8 {
                f[3 * a + x] += p * (n[i][a] * dv);
            }
        }
    }
}

/// Tangent of one Gauss point between the derivatives of the displacement along i and j, `[i][j][x][y]`, times its volume.
pub(super) struct Pointwise([[[[f64; 3]; 3]; 3]; 3]);

impl Pointwise {
    /// Of moduli against Voigt strains and of the stress, where the present tangents are `frame`.
    #[inline(always)]
    pub fn new(frame: &[V<f64>; 3], s: &[f64; 6], tangent: &[[f64; 6]; 6], dv: f64) -> Pointwise {
        // Rows of the strain in the derivative along direction i: `rows[i]` holds (Voigt index, vector).
        let [g1, g2, g3] = *frame;
        let rows = [
            [(0, g1), (3, g2), (5, g3)],
            [(1, g2), (3, g1), (4, g3)],
            [(2, g3), (4, g2), (5, g1)],
        ];
        let full = [[s[0], s[3], s[5]], [s[3], s[1], s[4]], [s[5], s[4], s[2]]];
        let mut q = [[[[0.0; 3]; 3]; 3]; 3];
        for i in 0..3 {
            for j in 0..3 {
                for (v, gv) in &rows[i] {
                    for (w, gw) in &rows[j] {
                        let c = tangent[*v][*w] * dv;
                        for x in 0..3 {
                            for y in 0..3 {
                                q[i][j][x][y] += c * gv[x] * gw[y];
                            }
                        }
                    }
                }
                for x in 0..3 {
                    q[i][j][x][x] += full[i][j] * dv;
                }
            }
        }
        Pointwise(q)
    }

    /// Adds it to an element's tangent, by columns; to the upper triangle only where it is symmetric.
    #[inline(always)]
    pub fn add_to(&self, g: usize, k: &mut [f64; 576], symmetric: bool) {
        let (n, Pointwise(q)) = (derivatives(g), self);
        for b in 0..8 {
            let mut column = [[[0.0; 3]; 3]; 3];
            for i in 0..3 {
                for j in 0..3 {
                    for x in 0..3 {
                        for y in 0..3 {
                            column[i][x][y] += q[i][j][x][y] * n[j][b];
                        }
                    }
                }
            }
            let last = if symmetric { b } else { 7 };
            for a in 0..=last {
                for y in 0..3 {
                    for x in 0..3 {
                        k[(3 * b + y) * 24 + 3 * a + x] += n[0][a] * column[0][x][y]
                            + n[1][a] * column[1][x][y]
                            + n[2][a] * column[2][x][y];
                    }
                }
            }
        }
    }
}

/// Makes the lower triangle that of the upper one.
#[inline(always)]
pub(super) fn mirror(k: &mut [f64; 576]) {
    for column in 0..24 {
        for row in 0..column {
            k[row * 24 + column] = k[column * 24 + row];
        }
    }
}
