//! The element of six points over the thickness with laws whose tangents are not symmetric.
//!
//! All of `B^T C B` is summed, enhanced strains beside the displacements, and condensed as `K - F D^-1 L` with `F = df/dalpha` and
//! `L = dh/du`, which are not each other's transposes any more. The cache holds alpha, then `D^-1 h`, `D^-1 L` and `(F D^-1)^T`.
use super::super::error::FaultCause;
use super::super::h8::H8System;
use super::super::kinematics::{Fields, V, add, tying};
use super::super::material::{MaterialLaw, state_of};
use super::super::reference::{TYING, WEIGHT};
use super::super::tangent::transverse_geometric;
use super::{BASES, Geometry, MODES, POINTS, TyingRows, mode, rows, shape, strain};
use covact_geometry::Vec3;

/// Displacements and enhanced strains.
const ALL: usize = 24 + MODES;
/// Start of `D^-1 L` and of `(F D^-1)^T` in the cache.
const DOWN: usize = 2 * MODES;
const ACROSS: usize = DOWN + 24 * MODES;

/// Size of the condensation cache and the parameters of an element with `ne` enhanced strains.
pub(in crate::shell) const fn state_len(ne: usize) -> usize {
    50 * ne
}

/// Sums over the points: forces and tangent of displacements and enhanced strains.
struct Sums {
    energy: f64,
    force: [f64; ALL],
    /// Row by row.
    tangent: [[f64; ALL]; ALL],
    /// Initial-stress stiffness, a scalar per pair of nodes.
    geometric: [[f64; 8]; 8],
}

/// As [`super::evaluate`].
pub(in crate::shell) fn evaluate<L: MaterialLaw>(
    law: &L,
    nodes: &[V<f64>; 8],
    u: &[V<f64>; 8],
    state: &mut [f64],
    out: &mut H8System,
) -> Result<(), FaultCause> {
    let mut alpha = [0.0; MODES];
    alpha.copy_from_slice(&state[..MODES]);
    let sums = gather(law, nodes, u, &alpha, &state[state_len(MODES)..])?;
    condense(&sums, state, out)
}

fn gather<L: MaterialLaw>(
    law: &L,
    nodes: &[V<f64>; 8],
    u: &[V<f64>; 8],
    alpha: &[f64; MODES],
    states: &[f64],
) -> Result<Sums, FaultCause> {
    let geometry = Geometry::new(nodes);
    let du = Fields::new(u);
    let now = add(&geometry.big, &du);
    let (tied, tied_rows) = (tying(&geometry.big, &du, [0.0; 2]), TyingRows::new(&now));
    let mut sums = Sums {
        energy: 0.0,
        force: [0.0; ALL],
        tangent: [[0.0; ALL]; ALL],
        geometric: [[0.0; 8]; 8],
    };
    let mut pressed = [0.0; TYING];
    for g in 0..POINTS {
        let place = geometry.at(g);
        let e = strain((&place, g), &du, &tied, alpha);
        let response = law
            .response(&place.metric, &e, &state_of::<L>(states, g))
            .map_err(|c| FaultCause::Collapsed {
                point: g as u8,
                ratio: c.ratio,
            })?;
        sums.energy += response.energy * place.volume;
        let s = response.stress.map(|s| s * place.volume);
        let n = shape(g);
        let b = with_enhanced(&rows(&now, &tied_rows, g, &n), &place.enhanced, g);
        add_point(&mut sums, &b, &s, &response.tangent, place.volume);
        for (p, pressed) in pressed.iter_mut().enumerate() {
            let component = [2, 2, 2, 2, 4, 4, 5, 5][p];
            *pressed += WEIGHT[g & 3][p] * s[component];
        }
        for (b, row) in sums.geometric.iter_mut().enumerate() {
            let (along1, along2) = (
                s[0] * n[0][b] + s[3] * n[1][b],
                s[3] * n[0][b] + s[1] * n[1][b],
            );
            for (a, k) in row.iter_mut().enumerate() {
                *k += n[0][a] * along1 + n[1][a] * along2;
            }
        }
    }
    let half = transverse_geometric(&pressed, [0.0; 2]);
    for (b, row) in sums.geometric.iter_mut().enumerate() {
        for (a, k) in row.iter_mut().enumerate() {
            *k += half[a][b] + half[b][a];
        }
    }
    Ok(sums)
}

/// Derivatives of the strain by displacements and enhanced strains.
fn with_enhanced(b: &[[f64; 24]; 6], enhanced: &[[f64; BASES]; 6], g: usize) -> [[f64; ALL]; 6] {
    let mut all = [[0.0; ALL]; 6];
    for ((all, b), enhanced) in all.iter_mut().zip(b).zip(enhanced) {
        all[..24].copy_from_slice(b);
        for (m, entry) in all[24..].iter_mut().enumerate() {
            let (base, w) = mode(m, g & 3);
            *entry = w * enhanced[base];
        }
    }
    all
}

fn add_point(
    sums: &mut Sums,
    b: &[[f64; ALL]; 6],
    s: &[f64; 6],
    moduli: &[[f64; 6]; 6],
    volume: f64,
) {
    let mut pushed = [[0.0; ALL]; 6];
    for (v, pushed) in pushed.iter_mut().enumerate() {
        for (w, b) in b.iter().enumerate() {
            let c = moduli[v][w] * volume;
            for (sum, b) in pushed.iter_mut().zip(b) {
                *sum += c * b;
            }
        }
    }
    for (v, b) in b.iter().enumerate() {
        for ((force, row), b) in sums.force.iter_mut().zip(&mut sums.tangent).zip(b) {
            *force += s[v] * b;
            for (k, pushed) in row.iter_mut().zip(&pushed[v]) {
                *k += b * pushed;
            }
        }
    }
}

fn condense(sums: &Sums, state: &mut [f64], out: &mut H8System) -> Result<(), FaultCause> {
    let mut d = [[0.0; MODES]; MODES];
    for (d, row) in d.iter_mut().zip(&sums.tangent[24..]) {
        d.copy_from_slice(&row[24..]);
    }
    out.negative_pivots = factorise(&mut d)?;
    let mut h = [0.0; MODES];
    h.copy_from_slice(&sums.force[24..]);
    solve(&d, &mut h);
    state[MODES..2 * MODES].copy_from_slice(&h);
    for r in 0..24 {
        let mut down: [f64; MODES] = std::array::from_fn(|m| sums.tangent[24 + m][r]);
        solve(&d, &mut down);
        let mut across: [f64; MODES] = std::array::from_fn(|m| sums.tangent[r][24 + m]);
        solve_transposed(&d, &mut across);
        for m in 0..MODES {
            state[DOWN + 24 * m + r] = down[m];
            state[ACROSS + 24 * m + r] = across[m];
        }
    }
    out.energy = sums.energy;
    for r in 0..24 {
        let row = &sums.tangent[r];
        out.f[r] = sums.force[r];
        for m in 0..MODES {
            out.f[r] -= row[24 + m] * h[m];
        }
        for c in 0..24 {
            let mut k = row[c];
            if r % 3 == c % 3 {
                k += sums.geometric[c / 3][r / 3];
            }
            for m in 0..MODES {
                k -= row[24 + m] * state[DOWN + 24 * m + c];
            }
            out.k[24 * c + r] = k;
        }
    }
    Ok(())
}

/// Condenses forces `f` and `h` with what the last evaluation left in the state.
pub(in crate::shell) fn condensed(mut f: [f64; 24], h: &[f64; MODES], state: &[f64]) -> [f64; 24] {
    for (m, h) in h.iter().enumerate() {
        for (f, across) in f.iter_mut().zip(&state[ACROSS + 24 * m..]) {
            *f -= across * h;
        }
    }
    f
}

/// As [`H8Block::update_alpha`](super::super::H8Block::update_alpha).
pub(in crate::shell) fn update_alpha(
    state: &mut [f64],
    du: &[Vec3; 8],
    scale: f64,
    alpha_from: &[f64],
) {
    for m in 0..MODES {
        let mut step = state[MODES + m];
        for (row, d) in state[DOWN + 24 * m..][..24].chunks_exact(3).zip(du) {
            step += row[0] * d.x + row[1] * d.y + row[2] * d.z;
        }
        state[m] = alpha_from[m] - scale * step;
    }
}

/// Factors (unit lower) (upper) in place; the number of negative pivots.
fn factorise(d: &mut [[f64; MODES]; MODES]) -> Result<u8, FaultCause> {
    let mut negative = 0;
    for j in 0..MODES {
        let pivot = d[j][j];
        if pivot == 0.0 || !pivot.is_finite() {
            return Err(FaultCause::Pivot {
                mode: j as u8,
                pivot,
            });
        }
        negative += u8::from(pivot < 0.0);
        let (head, tail) = d.split_at_mut(j + 1);
        for row in tail {
            row[j] /= pivot;
            for c in j + 1..MODES {
                row[c] -= row[j] * head[j][c];
            }
        }
    }
    Ok(negative)
}

/// Solves with the factors.
fn solve(d: &[[f64; MODES]; MODES], x: &mut [f64; MODES]) {
    for m in 0..MODES {
        for k in 0..m {
            x[m] -= d[m][k] * x[k];
        }
    }
    for m in (0..MODES).rev() {
        for k in m + 1..MODES {
            x[m] -= d[m][k] * x[k];
        }
        x[m] /= d[m][m];
    }
}

/// Solves with the transposed factors.
fn solve_transposed(d: &[[f64; MODES]; MODES], x: &mut [f64; MODES]) {
    for m in 0..MODES {
        for k in 0..m {
            x[m] -= d[k][m] * x[k];
        }
        x[m] /= d[m][m];
    }
    for m in (0..MODES).rev() {
        for k in m + 1..MODES {
            x[m] -= d[k][m] * x[k];
        }
    }
}
