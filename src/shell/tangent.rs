//! Condensed forces and tangent of the solid-shell element: the loop that assembly spends its time in.
//!
//! The strains of the element are linear in few quantities: membrane strains at the Gauss points, and fifteen
//! parameters (eight assumed strains at tying points, seven enhanced strains). So the tangent is put together as
//!
//! `K = K_mm + Z b + (Z b)^T + b^T C b - L^T D^-1 L`
//!
//! where `b` (8 x 24) are the strain-displacement rows at the tying points, of which a node touches three, `C` (15 x 15)
//! is the stiffness among parameters (its corner D that of the enhanced strains), `Z` (24 x 15) couples membrane and
//! parameters. `C`, `Z` and `K_mm` are sums over Gauss points of small blocks; shape functions being products along
//! r, s and t, most sums run over 2 values instead of 8. Arrays are laid out for vector units: dofs are numbered
//! `8 axis + node` inside and `3 node + axis` outside.
use super::error::FaultCause;
use super::h8::H8System;
use super::kinematics::{Fields, V, add, strains};
use super::material::{MaterialLaw, state_of};
use super::pressed;
use super::reference::{BASE, GP, LINE, PARAMETERS, Reference, TYING, WEIGHT, sign};
use super::sums::{Column, LANES, Sums, add_membrane, add_parameters};

/// Position of a component pair in [`VOIGT`](super::VOIGT): those with i <= j are computed, the others follow from symmetry.
const PAIR: [[usize; 3]; 3] = [[0, 3, 5], [3, 1, 4], [5, 4, 2]];

/// Size of the condensation cache and the parameters of an element with `ne` enhanced strains: alpha, h, L (ne x 24,
/// by rows, dofs `3 node + axis`), and the packed factors of D = (unit lower) (diagonal) (unit lower)^T.
pub(super) const fn state_len(ne: usize) -> usize {
    2 * ne + 24 * ne + ne * (ne + 1) / 2
}

/// Start of the factors of D in the state.
pub(super) const fn factors(ne: usize) -> usize {
    26 * ne
}

/// Evaluates one element at displacements `u`: `out` receives condensed forces and tangent, `state` (its alpha and
/// the states of the law being read) the condensation cache. With `correction`, the last change of the displacements, the
/// geometric part of the tangent has the stresses of mixed integration points ([`quadratic`]); `shares` are what is
/// taken off the thickness strain ([`pressed`]).
pub(super) fn evaluate<L: MaterialLaw, const NE: usize>(
    law: &L,
    re: &Reference,
    u: &[V<f64>; 8],
    (correction, shares): (Option<&[V<f64>; 8]>, [f64; 2]),
    state: &mut [f64],
    out: &mut H8System,
) -> Result<(), FaultCause> {
    let big = Fields::new(&re.nodes);
    let du = Fields::new(u);
    let now = add(&big, &du);
    let mut alpha = [0.0; NE];
    alpha.copy_from_slice(&state[..NE]);
    let strain = strains(re, &big, &du, &alpha, shares);
    let bent = correction.map(|du| quadratic(re, du, shares));
    let states = &state[state_len(NE)..];
    let sums = gauss_loop::<L, NE>(law, re, &now, (&strain, bent.as_ref()), states)?;
    condense::<NE, PARAMETERS>(&sums, &now, (bent.is_some(), shares), state, out)
}

/// Condensed forces and tangent of an element with `NE` enhanced strains from the sums over its points; `carried` says that the
/// geometric part has stresses of its own, `shares` are what is taken off the thickness strain. The condensation cache goes into `state`.
#[inline(always)]
pub(super) fn condense<const NE: usize, const P: usize>(
    sums: &Sums<P>,
    now: &Fields<f64>,
    (carried, shares): (bool, [f64; 2]),
    state: &mut [f64],
    out: &mut H8System,
) -> Result<(), FaultCause> {
    let membrane = membrane_blocks(&sums.membrane);
    let mut b = tying_rows(now);
    let pressed = pressed::any(shares).then(|| {
        b[0] = [0.0; 24];
        pressed_rows(now, shares)
    });
    let add_pressed = |c: &[f64; P], factor: f64, sum: &mut [f64; 24]| {
        for (rows, c) in pressed.iter().flatten().zip(c) {
            for (sum, row) in sum.iter_mut().zip(rows) {
                *sum += factor * c * row;
            }
        }
    };

    // Displacement part: rows of L and of the coupling, forces.
    let mut l = [[0.0; 24]; NE];
    for m in 0..NE {
        l[m] = times_rows(&sums.z[TYING + m], &sums.c[TYING + m], &b, 1.0);
        add_pressed(&sums.c[TYING + m], 1.0, &mut l[m]);
    }
    let mut y = [[0.0; 24]; TYING];
    for p in 0..TYING {
        y[p] = times_rows(&sums.z[p], &sums.c[p], &b, 0.5);
        add_pressed(&sums.c[p], 0.5, &mut y[p]);
    }
    let mut force = [0.0; P];
    for p in 0..TYING + NE {
        force[p] = sums.c[p][P - 1];
    }
    let mut f = times_rows(&sums.z[P - 1], &force, &b, 1.0);
    add_pressed(&force, 1.0, &mut f);

    // Half of the coupling plus half of the initial-stress part of the transverse strains; its transpose is the rest.
    let tied = match carried {
        true => sums.carried,
        false => std::array::from_fn(|p| force[p]),
    };
    let geometric = transverse_geometric(&tied, shares);
    let mut half = [[0.0; 24]; 24];
    for (column, half) in half.iter_mut().enumerate() {
        let node = column & 7;
        let rows = [&y[node & 3], &y[4 + (node & 1)], &y[6 + ((node >> 1) & 1)]];
        let weights = [b[0][column], b[1][column], b[2][column]];
        for r in 0..24 {
            half[r] = rows[0][r] * weights[0] + rows[1][r] * weights[1] + rows[2][r] * weights[2];
        }
        let axis = column >> 3;
        for a in 0..8 {
            half[8 * axis + a] += geometric[node][a];
        }
        for (rows, y) in pressed.iter().flatten().zip(&y) {
            for (half, y) in half.iter_mut().zip(y) {
                *half += y * rows[column];
            }
        }
    }

    // Static condensation of the enhanced strains.
    out.negative_pivots = 0;
    let mut scaled = [[0.0; 24]; NE];
    if NE > 0 {
        for m in 0..NE {
            state[NE + m] = force[TYING + m];
            let row = &mut state[2 * NE + 24 * m..2 * NE + 24 * (m + 1)];
            for a in 0..8 {
                for x in 0..3 {
                    row[3 * a + x] = l[m][8 * x + a];
                }
            }
        }
        let mut d = [[0.0; NE]; NE];
        for m in 0..NE {
            d[m].copy_from_slice(&sums.c[TYING + m][TYING..TYING + NE]);
        }
        out.negative_pivots = factorise(&mut d)?;
        let packed = &mut state[factors(NE)..];
        let mut h = [0.0; NE];
        for m in 0..NE {
            packed[m * (m + 1) / 2..][..=m].copy_from_slice(&d[m][..=m]);
            let (mut below, mut row) = (force[TYING + m], l[m]);
            for n in 0..m {
                below -= d[m][n] * h[n];
                for r in 0..24 {
                    row[r] -= d[m][n] * l[n][r];
                }
            }
            // Written once: where rows of `l` were updated in place, rustc 1.95 (x86-64, level 2) was seen to take them from before their
            // own updates, of three of them.
            (h[m], l[m]) = (below, row);
            let inverse = d[m][m].recip();
            for r in 0..24 {
                scaled[m][r] = row[r] * inverse;
                f[r] -= scaled[m][r] * below;
            }
        }
    }

    for a in 0..8 {
        for x in 0..3 {
            out.f[3 * a + x] = f[8 * x + a];
        }
    }
    out.energy = sums.energy;
    gather::<NE, 0>(&membrane, &half, &l, &scaled, out);
    gather::<NE, 1>(&membrane, &half, &l, &scaled, out);
    gather::<NE, 2>(&membrane, &half, &l, &scaled, out);
    Ok(())
}

/// The part of the strains that is quadratic in a change of the displacements, at the Gauss points.
///
/// The stress of a mixed integration point is continued along the correction that led to an iterate with the tangent of the law,
/// `s_hat = s_old + D : (linear part of the change of strain)` (D. Magisano, L. Leonetti and G. Garcea, CMAME 313 (2017)). With
/// D taken where the iterate is, that is the stress there less `D : (quadratic part)`. A correction that rotates a thin shell
/// stretches it in second order: these strains are none of the equilibrium that is sought, and their stresses, orders of
/// magnitude above it, would spoil the geometric part of the tangent.
fn quadratic(re: &Reference, du: &[V<f64>; 8], shares: [f64; 2]) -> [[f64; 6]; 8] {
    let none = Fields::new(&[[0.0; 3]; 8]);
    strains(re, &none, &Fields::new(du), &[], shares)
}

#[inline(always)]
fn gauss_loop<L: MaterialLaw, const NE: usize>(
    law: &L,
    re: &Reference,
    now: &Fields<f64>,
    (strain, bent): (&[[f64; 6]; 8], Option<&[[f64; 6]; 8]>),
    states: &[f64],
) -> Result<Sums<PARAMETERS>, FaultCause> {
    let mut sums = Sums::new();
    for q in 0..4 {
        let (i, j) = (q & 1, q >> 1);
        let mut column = Column::<8>::new();
        for k in 0..2 {
            let g = q + 4 * k;
            let response = law
                .response(&re.metric[g], &strain[g], &state_of::<L>(states, g))
                .map_err(|c| FaultCause::Collapsed {
                    point: g as u8,
                    ratio: c.ratio,
                })?;
            let dv = re.volume[g];
            sums.energy += response.energy * dv;
            let s = response.stress.map(|s| s * dv);
            let c = response.tangent.map(|row| row.map(|c| c * dv));
            let (g1, g2) = (&now.r[k][j], &now.s[k][i]);
            let mut carried = s;
            if let Some(bent) = bent {
                for (s, row) in carried.iter_mut().zip(&c) {
                    for (c, e) in row.iter().zip(&bent[g]) {
                        *s -= c * e;
                    }
                }
                let w = &WEIGHT[q];
                for p in 0..TYING {
                    let component = [2, 4, 5][BASE[p]];
                    sums.carried[p] += w[p] * carried[component];
                }
            }
            add_membrane(&mut sums.membrane[q], &c, &carried, g1, g2, &LINE[k]);

            // Stress per base strain: C A, and A^T C A among enhanced strains.
            let mut ca = [[0.0; 4]; 6];
            let mut aca = [[0.0; 5]; 4];
            if NE > 0 {
                let mut a = re.enhanced[g];
                let t = GP * sign(g, 2);
                for row in &mut a {
                    row[0] *= t;
                }
                for v in 0..6 {
                    for w in 0..6 {
                        for m in 0..4 {
                            ca[v][m] += c[v][w] * a[w][m];
                        }
                    }
                }
                for v in 0..6 {
                    for m in 0..4 {
                        for n in 0..4 {
                            aca[m][n] += a[v][m] * ca[v][n];
                        }
                        aca[m][4] += a[v][m] * s[v];
                    }
                }
            }
            let row = |v: usize| {
                let x = &ca[v];
                [c[v][2], c[v][4], c[v][5], x[0], x[1], x[2], x[3], s[v]]
            };
            column.add_line([&row(0), &row(1), &row(3)], (g1, g2), &LINE[k]);
            let base = &mut column.base;
            for (b, v) in [2, 4, 5].into_iter().enumerate() {
                let r = row(v);
                for n in 0..8 {
                    base[b][n] += r[n];
                }
            }
            if NE > 0 {
                for m in 0..4 {
                    let r = &aca[m];
                    let r = [ca[2][m], ca[4][m], ca[5][m], r[0], r[1], r[2], r[3], r[4]];
                    for n in 0..8 {
                        base[3 + m][n] += r[n];
                    }
                }
            }
        }
        add_parameters::<NE, 8, PARAMETERS>(&mut sums, q, &column);
    }
    Ok(sums)
}

/// Membrane blocks of the node columns, `[column node][row node][lane]` over the four nodes of a face: the derivatives
/// along r do not depend on r, so the sum over Gauss points splits into sums along single directions.
#[inline(always)]
fn membrane_blocks(points: &[[[f64; LANES]; 4]; 4]) -> [[[f64; LANES]; 4]; 4] {
    let mut aa = [[[0.0; LANES]; 2]; 2];
    let mut bb = [[[0.0; LANES]; 2]; 2];
    let mut ab = [[[0.0; LANES]; 2]; 2];
    let mut ba = [[[0.0; LANES]; 2]; 2];
    for m in 0..2 {
        for n in 0..2 {
            for point in 0..2 {
                let w = 0.25 * LINE[point][m] * LINE[point][n];
                for lane in 0..LANES {
                    aa[m][n][lane] +=
                        w * (points[2 * point][0][lane] + points[2 * point + 1][0][lane]);
                    bb[m][n][lane] += w * (points[point][1][lane] + points[point + 2][1][lane]);
                }
            }
            for q in 0..4 {
                let (i, j) = (q & 1, q >> 1);
                let (w_ab, w_ba) = (
                    0.25 * LINE[j][m] * LINE[i][n],
                    0.25 * LINE[i][m] * LINE[j][n],
                );
                for lane in 0..LANES {
                    ab[m][n][lane] += w_ab * points[q][2][lane];
                    ba[m][n][lane] += w_ba * points[q][3][lane];
                }
            }
        }
    }
    let mut blocks = [[[0.0; LANES]; 4]; 4];
    for (column, blocks) in blocks.iter_mut().enumerate() {
        let (rb, sb) = (column & 1, column >> 1);
        for (row, block) in blocks.iter_mut().enumerate() {
            let (ra, sa) = (row & 1, row >> 1);
            let (e, f, g, h) = (&aa[sa][sb], &bb[ra][rb], &ab[sa][rb], &ba[ra][sb]);
            let signs = [
                sign(row, 0) * sign(column, 0),
                sign(row, 1) * sign(column, 1),
                sign(row, 0) * sign(column, 1),
                sign(row, 1) * sign(column, 0),
            ];
            for lane in 0..LANES {
                block[lane] = signs[0] * e[lane]
                    + signs[1] * f[lane]
                    + signs[2] * g[lane]
                    + signs[3] * h[lane];
            }
        }
    }
    blocks
}

/// Strain-displacement rows of the tying points that each dof touches: 33 of its corner, 23 of its side r = -+1,
/// 13 of its side s = -+1.
#[inline(always)]
fn tying_rows(now: &Fields<f64>) -> [[f64; 24]; 3] {
    let mut b = [[0.0; 24]; 3];
    for a in 0..8 {
        let (r, s, t) = (sign(a, 0), sign(a, 1), sign(a, 2));
        let (side23, side13) = (&now.tie23[a & 1], &now.tie13[(a >> 1) & 1]);
        for x in 0..3 {
            b[0][8 * x + a] = 0.5 * t * now.t[a & 3][x];
            b[1][8 * x + a] = 0.25 * (s * side23[1][x] + t * side23[0][x]);
            b[2][8 * x + a] = 0.25 * (r * side13[1][x] + t * side13[0][x]);
        }
    }
    b
}

/// Derivatives of the thickness strains at the four corners by all dofs, where something is taken off those of the edges.
#[cold]
fn pressed_rows(now: &Fields<f64>, shares: [f64; 2]) -> [[f64; 24]; 4] {
    let rows = pressed::rows(shares, &now.t);
    std::array::from_fn(|c| {
        std::array::from_fn(|dof| {
            let (axis, a) = (dof >> 3, dof & 7);
            0.5 * sign(a, 2) * rows[c][a & 3][axis]
        })
    })
}

/// `z + factor c^T b` for one parameter with coefficients `c` on the tying points.
#[inline(always)]
fn times_rows<const P: usize>(
    z: &[f64; 24],
    c: &[f64; P],
    b: &[[f64; 24]; 3],
    factor: f64,
) -> [f64; 24] {
    let mut w = [[0.0; 8]; 3];
    for a in 0..8 {
        w[0][a] = factor * c[a & 3];
        w[1][a] = factor * c[4 + (a & 1)];
        w[2][a] = factor * c[6 + ((a >> 1) & 1)];
    }
    let mut sum = *z;
    for x in 0..3 {
        for a in 0..8 {
            let r = 8 * x + a;
            sum[r] += w[0][a] * b[0][r] + w[1][a] * b[1][r] + w[2][a] * b[2][r];
        }
    }
    sum
}

/// Half of the initial-stress stiffness of the transverse strains, a scalar per pair of nodes; its transpose is the rest.
#[inline(always)]
pub(super) fn transverse_geometric(force: &[f64; TYING], shares: [f64; 2]) -> [[f64; 8]; 8] {
    let mut k = [[0.0; 8]; 8];
    let (first, own) = match pressed::any(shares) {
        true => (4, 0),
        false => (0, 4),
    };
    for (a, b) in (0..first).flat_map(|a| (0..4).map(move |b| (a, b))) {
        let value = 0.125 * pressed::second(shares, force, a, b);
        k[a][b] += value;
        k[a + 4][b + 4] += value;
        k[a][b + 4] -= value;
        k[a + 4][b] -= value;
    }
    for c in 0..own {
        let value = 0.125 * force[c];
        k[c][c] += value;
        k[c + 4][c + 4] += value;
        k[c][c + 4] -= value;
        k[c + 4][c] -= value;
    }
    for side in 0..2 {
        let (f23, f13) = (force[4 + side] / 32.0, force[6 + side] / 32.0);
        for m in 0..4 {
            for n in 0..4 {
                // Nodes of the side r = -+1 and of the side s = -+1.
                let (a, b) = (side + 2 * m, side + 2 * n);
                k[a][b] += f23 * (sign(a, 1) * sign(b, 2) + sign(b, 1) * sign(a, 2));
                let (a, b) = (side_s(side, m), side_s(side, n));
                k[a][b] += f13 * (sign(a, 0) * sign(b, 2) + sign(b, 0) * sign(a, 2));
            }
        }
    }
    k
}

/// Node `m` of the side s = -1 (`side` 0) or s = +1.
#[inline(always)]
const fn side_s(side: usize, m: usize) -> usize {
    (m & 1) + 2 * side + 4 * (m >> 1)
}

/// Replaces the lower triangle of `d` by its factors, unit lower and diagonal; returns the number of negative pivots.
#[inline(always)]
fn factorise<const NE: usize>(d: &mut [[f64; NE]; NE]) -> Result<u8, FaultCause> {
    let mut negative = 0;
    for j in 0..NE {
        for i in j..NE {
            let mut sum = d[i][j];
            for k in 0..j {
                sum -= d[i][k] * d[j][k] * d[k][k];
            }
            d[i][j] = sum;
        }
        let pivot = d[j][j];
        if pivot == 0.0 || !pivot.is_finite() {
            return Err(FaultCause::Pivot {
                mode: j as u8,
                pivot,
            });
        }
        negative += u8::from(pivot < 0.0);
        for row in d.iter_mut().skip(j + 1) {
            row[j] /= pivot;
        }
    }
    Ok(negative)
}

/// Adds up the parts for the columns of one axis and writes them, with the transpose, to the node numbering.
#[inline(always)]
fn gather<const NE: usize, const AXIS: usize>(
    membrane: &[[[f64; LANES]; 4]; 4],
    half: &[[f64; 24]; 24],
    l: &[[f64; 24]; NE],
    scaled: &[[f64; 24]; NE],
    out: &mut H8System,
) {
    for b in 0..8 {
        let column = 8 * AXIS + b;
        let mut sum = [0.0; 24];
        sum[..8 * (AXIS + 1)].copy_from_slice(&half[column][..8 * (AXIS + 1)]);
        for m in 0..NE {
            for r in 0..8 * (AXIS + 1) {
                sum[r] -= l[m][r] * scaled[m][column];
            }
        }
        for axis in 0..=AXIS {
            let lane = PAIR[axis][AXIS];
            for a in 0..8 {
                let r = 8 * axis + a;
                let combination = (a >> 2) + (b >> 2);
                let value =
                    sum[r] + half[r][column] + membrane[b & 3][a & 3][6 * combination + lane];
                out.k[(3 * b + AXIS) * 24 + 3 * a + axis] = value;
                out.k[(3 * a + axis) * 24 + 3 * b + AXIS] = value;
            }
        }
    }
}
