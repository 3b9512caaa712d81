//! Condensed forces and tangent of Q18.
//!
//! `K = sum_g B^T C B + geometric - L^T D^-1 L`, with the rows B of the assumed strain made by the same rule as the strain
//! itself. Rows are over mid-surface points and half directors; nodes come in at the end.
use super::super::error::FaultCause;
use super::super::kinematics::V;
use super::super::material::{MaterialLaw, state_of};
use super::reference::{MODES, Reference, split};
use super::strain::{Compatible, along, assumed, compatible, strains, transposed};
use super::tables::{POINTS, SAMPLES, TABLES};
use super::{DOFS, Q18System};

/// A row over 18 vectors, axis by axis.
type Row = [f64; DOFS];

/// Size of the condensation cache and the parameters of an element: alpha, h, L (by rows, dofs `3 node + axis`), packed
/// factors of D.
pub(super) const STATE: usize = 2 * MODES + DOFS * MODES + MODES * (MODES + 1) / 2;
/// Start of L in the state.
pub(super) const ROWS: usize = 2 * MODES;
/// Start of the factors of D in the state.
pub(super) const FACTORS: usize = ROWS + DOFS * MODES;

/// Room that an evaluation needs, kept from element to element.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Work {
    rows: Compatible<Row>,
    /// Upper triangle of the tangent by columns.
    k: [Row; DOFS],
}

impl Work {
    pub fn new() -> Work {
        Work {
            rows: Compatible {
                samples: [[0.0; DOFS]; SAMPLES],
                plane: [[[0.0; DOFS]; 3]; POINTS],
            },
            k: [[0.0; DOFS]; DOFS],
        }
    }
}

/// Rows of the compatible strains at the present positions.
fn rows(now: &[V<f64>; 18], out: &mut Compatible<Row>) {
    let tables = &**TABLES;
    out.samples.as_flattened_mut().fill(0.0);
    out.plane.as_flattened_mut().as_flattened_mut().fill(0.0);
    let one = |n: &[f64; 18], g: &V<f64>, row: &mut Row| {
        for x in 0..3 {
            for b in 0..18 {
                row[18 * x + b] += n[b] * g[x];
            }
        }
    };
    for (row, sample) in out.samples.iter_mut().zip(&tables.samples) {
        let [n0, n1] = &sample.n;
        if sample.directions[0] == sample.directions[1] {
            one(n0, &along(n0, now), row);
        } else {
            one(n0, &along(n1, now), row);
            one(n1, &along(n0, now), row);
        }
    }
    for (row, point) in out.plane.iter_mut().zip(&tables.points) {
        let [n0, n1] = [&point.n[0], &point.n[1]];
        let [g0, g1] = [along(n0, now), along(n1, now)];
        one(n0, &g0, &mut row[0]);
        one(n1, &g1, &mut row[1]);
        one(n0, &g1, &mut row[2]);
        one(n1, &g0, &mut row[2]);
    }
}

/// Second variation of the strains, weighted with the forces on them: the same for every axis.
fn geometric(force: &Compatible<f64>) -> [[f64; 18]; 18] {
    let tables = &**TABLES;
    let mut k = [[0.0; 18]; 18];
    let mut push = |n: [&[f64; 18]; 2], same: bool, q: f64| {
        for (b, row) in k.iter_mut().enumerate() {
            let (f0, f1) = (q * n[0][b], q * n[1][b]);
            for (c, k) in row.iter_mut().enumerate() {
                *k += if same {
                    f0 * n[0][c]
                } else {
                    f0 * n[1][c] + f1 * n[0][c]
                };
            }
        }
    };
    for (sample, q) in tables.samples.iter().zip(force.samples) {
        let same = sample.directions[0] == sample.directions[1];
        push([&sample.n[0], &sample.n[1]], same, q);
    }
    for (point, q) in tables.points.iter().zip(force.plane) {
        push([&point.n[0], &point.n[0]], true, q[0]);
        push([&point.n[1], &point.n[1]], true, q[1]);
        push([&point.n[0], &point.n[1]], false, q[2]);
    }
    k
}

/// The part of the strains that is quadratic in a change of the displacements, at the Gauss points: what mixed integration points
/// leave out of the geometric part, see [`H8Block::evaluate_mixed`](super::super::H8Block::evaluate_mixed).
fn quadratic(re: &Reference, du: &[V<f64>; 18]) -> [[f64; 6]; POINTS] {
    let there = split(du);
    let back = there.map(|v| v.map(|x| -x));
    let [a, b] = [&there, &back].map(|du| assumed(re, &compatible(re, du)));
    std::array::from_fn(|g| std::array::from_fn(|v| 0.5 * (a[g][v] + b[g][v])))
}

/// Evaluates one element at displacements `u` of its nodes: `out` receives condensed forces and tangent, `state` (its
/// alpha and the states of the law being read) the condensation cache. With `correction`, the last change of the displacements,
/// the geometric part of the tangent has the stresses of mixed integration points ([`quadratic`]).
pub(super) fn evaluate<L: MaterialLaw>(
    law: &L,
    re: &Reference,
    u: &[V<f64>; 18],
    correction: Option<&[V<f64>; 18]>,
    state: &mut [f64],
    out: &mut Q18System,
) -> Result<(), FaultCause> {
    let du = split(u);
    let now: [V<f64>; 18] = std::array::from_fn(|b| std::array::from_fn(|x| re.y[b][x] + du[b][x]));
    let mut alpha = [0.0; MODES];
    alpha.copy_from_slice(&state[..MODES]);
    let strain = strains(re, &du, &alpha);
    let Work { rows: from, k } = &mut *out.work;
    rows(&now, from);
    let b = assumed(re, from);

    out.energy = 0.0;
    k.as_flattened_mut().fill(0.0);
    let mut f: Row = [0.0; DOFS];
    let mut l = [[0.0; DOFS]; MODES];
    let mut d = [[0.0; MODES]; MODES];
    let mut h = [0.0; MODES];
    let bent = correction.map(|du| quadratic(re, du));
    let mut stress = [[0.0; 6]; POINTS];
    let mut carried = [[0.0; 6]; POINTS];
    for g in 0..POINTS {
        let response = law
            .response(
                &re.metric[g],
                &strain[g],
                &state_of::<L>(&state[STATE..], g),
            )
            .map_err(|c| FaultCause::Collapsed {
                point: g as u8,
                ratio: c.ratio,
            })?;
        let dv = re.volume[g];
        out.energy += response.energy * dv;
        stress[g] = response.stress.map(|s| s * dv);
        let c = response.tangent.map(|row| row.map(|c| c * dv));
        carried[g] = stress[g];
        if let Some(bent) = &bent {
            for (s, row) in carried[g].iter_mut().zip(&c) {
                for (c, e) in row.iter().zip(&bent[g]) {
                    *s -= c * e;
                }
            }
        }
        let b = &b[g];
        // C B, the upper triangle of B^T (C B), and what couples to the enhanced strains.
        let mut cb = [[0.0; DOFS]; 6];
        for v in 0..6 {
            for w in 0..6 {
                for (sum, b) in cb[v].iter_mut().zip(&b[w]) {
                    *sum += c[v][w] * b;
                }
            }
            for (f, b) in f.iter_mut().zip(&b[v]) {
                *f += stress[g][v] * b;
            }
        }
        for (column, k) in k.iter_mut().enumerate() {
            let w: [f64; 6] = std::array::from_fn(|v| b[v][column]);
            let k = &mut k[..=column];
            for (r, k) in k.iter_mut().enumerate() {
                *k += w[0] * cb[0][r]
                    + w[1] * cb[1][r]
                    + w[2] * cb[2][r]
                    + w[3] * cb[3][r]
                    + w[4] * cb[4][r]
                    + w[5] * cb[5][r];
            }
        }
        for v in 0..6 {
            let row = &re.enhanced[g][v];
            for m in 0..MODES {
                h[m] += row[m] * stress[g][v];
                for (l, cb) in l[m].iter_mut().zip(&cb[v]) {
                    *l += row[m] * cb;
                }
                for w in 0..6 {
                    for n in 0..MODES {
                        d[m][n] += row[m] * c[v][w] * re.enhanced[g][w][n];
                    }
                }
            }
        }
    }
    let geometric = geometric(&transposed(re, carried));
    for x in 0..3 {
        for c in 0..18 {
            for r in 0..=c {
                k[18 * x + c][18 * x + r] += geometric[c][r];
            }
        }
    }

    // Enhanced strains: cache and condensation.
    for m in 0..MODES {
        state[MODES + m] = h[m];
        to_nodes(&l[m], &mut state[ROWS + DOFS * m..][..DOFS]);
    }
    out.negative_pivots = factorise(&mut d)?;
    for m in 0..MODES {
        state[FACTORS + m * (m + 1) / 2..][..=m].copy_from_slice(&d[m][..=m]);
    }
    for m in 0..MODES {
        for n in 0..m {
            h[m] -= d[m][n] * h[n];
            let (head, tail) = l.split_at_mut(m);
            for (a, b) in tail[0].iter_mut().zip(&head[n]) {
                *a -= d[m][n] * b;
            }
        }
        let inverse = d[m][m].recip();
        for (column, k) in k.iter_mut().enumerate() {
            let scaled = l[m][column] * inverse;
            for (k, l) in k[..=column].iter_mut().zip(&l[m]) {
                *k -= scaled * l;
            }
            f[column] -= scaled * h[m];
        }
    }
    to_nodes(&f, &mut out.f);
    tangent_to_nodes(k, &mut out.k);
    Ok(())
}

/// Place of a node's mid-surface point among the 18 vectors, and the sign of its director.
const fn place(node: usize) -> (usize, f64) {
    (node % 9, if node < 9 { -1.0 } else { 1.0 })
}

/// From a row over mid-surface points and half directors to dofs `3 node + axis`.
fn to_nodes(row: &Row, out: &mut [f64]) {
    for node in 0..18 {
        let (a, sign) = place(node);
        for x in 0..3 {
            out[3 * node + x] = 0.5 * (row[18 * x + a] + sign * row[18 * x + 9 + a]);
        }
    }
}

/// The same for both sides of the tangent, whose upper triangle is given by columns.
fn tangent_to_nodes(k: &[Row], out: &mut [f64; DOFS * DOFS]) {
    let at = |r: usize, c: usize| if r <= c { k[c][r] } else { k[r][c] };
    for ca in 0..9 {
        for cx in 0..3 {
            let (cm, cd) = (18 * cx + ca, 18 * cx + 9 + ca);
            for ra in 0..9 {
                for rx in 0..3 {
                    let (rm, rd) = (18 * rx + ra, 18 * rx + 9 + ra);
                    let [mm, md, dm, dd] =
                        [at(rm, cm), at(rm, cd), at(rd, cm), at(rd, cd)].map(|x| 0.25 * x);
                    let mut put = |r: usize, c: usize, value: f64| {
                        out[(3 * c + cx) * DOFS + 3 * r + rx] = value;
                    };
                    put(ra, ca, mm - md - dm + dd);
                    put(ra, ca + 9, mm + md - dm - dd);
                    put(ra + 9, ca, mm - md + dm - dd);
                    put(ra + 9, ca + 9, mm + md + dm + dd);
                }
            }
        }
    }
    // The sums above run in another order on the other side of the diagonal.
    for c in 0..DOFS {
        for r in 0..c {
            out[r * DOFS + c] = out[c * DOFS + r];
        }
    }
}

/// Factors of D = (unit lower) (diagonal) (unit lower)^T in place of its lower triangle; the number of negative pivots.
fn factorise(d: &mut [[f64; MODES]; MODES]) -> Result<u8, FaultCause> {
    let mut negative = 0;
    for m in 0..MODES {
        for n in 0..m {
            let mut sum = d[m][n];
            for k in 0..n {
                sum -= d[m][k] * d[k][k] * d[n][k];
            }
            d[m][n] = sum / d[n][n];
        }
        let mut pivot = d[m][m];
        for k in 0..m {
            pivot -= d[m][k] * d[m][k] * d[k][k];
        }
        if pivot == 0.0 || !pivot.is_finite() {
            return Err(FaultCause::Pivot {
                mode: m as u8,
                pivot,
            });
        }
        negative += u8::from(pivot < 0.0);
        d[m][m] = pivot;
    }
    Ok(negative)
}
