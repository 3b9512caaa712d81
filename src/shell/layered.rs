//! The 8-node solid-shell element for laws with plastic flow: an eighth enhanced strain, and six points over the thickness.
//!
//! Where a bent sheet flows, its stresses jump at the mid-surface and the thickness strain is quadratic in t. Two Gauss
//! points make the fully plastic moment 15 % too large; three in each half of the thickness make it exact. The enhanced
//! strain 33: t^2 - 1/3 lets the thickness strain follow; without it the springback of a strip bent to ten times its
//! thickness is 7 % wrong. It vanishes at two Gauss points, so that it needs the finer rule.
//!
//! The tangent is put together as that of the element with two points over the thickness ([`super::tangent`]): what a point adds
//! is a few products along t, and shape functions along r and s are applied once per in-plane point.
pub(super) mod unsymmetric;

use super::error::FaultCause;
use super::h8::H8System;
use super::kinematics::{Fields, V, add, shear, stretch, tying};
use super::material::{Collapsed, MaterialLaw, Metric, state_of};
use super::reference::{
    BASE, GP, LINE, PARAMETERS, TYING, WEIGHT, contravariant, det, enhanced, metric_of, sign,
};
use super::sums::{Column, Sums, add_membrane, add_parameters};
use super::tangent::{condense, state_len};
use crate::fem::quadrature::GAUSS_3;
use num_dual::DualNum;

/// Enhanced strains: those of [`Formulation::Eas7`](super::Formulation::Eas7) and 33: t^2 - 1/3.
pub(super) const MODES: usize = 8;
/// Points over the thickness.
pub(super) const LAYERS: usize = 6;
/// Points, numbered `i + 2 j + 4 k`.
pub(super) const POINTS: usize = 4 * LAYERS;

/// Coordinate t and weight of the points over the thickness: Gauss's rule of three points in each half.
pub(super) const RULE: [(f64, f64); LAYERS] = {
    let (points, weights) = (GAUSS_3.all_points(), GAUSS_3.all_weights());
    let mut rule = [(0.0, 0.0); LAYERS];
    let mut i = 0;
    while i < 3 {
        let (x, w) = (0.5 * points[i], 0.5 * weights[i]);
        rule[i] = (x - 0.5, w);
        rule[3 + i] = (x + 0.5, w);
        i += 1;
    }
    rule
};

/// Enhanced strains that are different in their base: 33 times t, 11, 22, 12, 33 times t^2 - 1/3.
const BASES: usize = 5;
/// Base strains, those of the tying points included, and forces.
const B: usize = 3 + BASES + 1;
/// Parameters, and forces.
const P: usize = PARAMETERS + 1;

/// Base and in-plane weight of an enhanced strain at in-plane point `q`.
#[inline(always)]
const fn mode(m: usize, q: usize) -> (usize, f64) {
    if m < MODES - 1 {
        (BASE[TYING + m] - BASE[TYING], WEIGHT[q][TYING + m])
    } else {
        (BASES - 1, 1.0)
    }
}

/// Undeformed geometry: cheap beside the law, so that it is worked out where it is needed.
struct Geometry {
    big: Fields<f64>,
    det: f64,
    dual: [V<f64>; 3],
}

/// Undeformed geometry at one point.
pub(super) struct Place {
    pub frame: [V<f64>; 3],
    pub metric: Metric,
    pub volume: f64,
    /// Covariant strains of unit enhanced strains of every base.
    enhanced: [[f64; BASES]; 6],
}

impl Geometry {
    fn new(nodes: &[V<f64>; 8]) -> Geometry {
        let big = Fields::new(nodes);
        let centre = big.centre();
        let det = det(&centre);
        Geometry {
            det,
            dual: contravariant(&centre, det),
            big,
        }
    }

    fn at(&self, g: usize) -> Place {
        let (t, weight) = RULE[g >> 2];
        let frame = self.big.over(g & 3, t);
        let jacobian = det(&frame);
        let four = enhanced(&frame, &self.dual, self.det / jacobian);
        let enhanced = four.map(|[a, b, c, d]| [a * t, b, c, d, a * (t * t - 1.0 / 3.0)]);
        Place {
            metric: metric_of(&frame),
            volume: jacobian * weight,
            frame,
            enhanced,
        }
    }
}

/// Covariant strain at point `g`: assumed strains from their tying points, enhanced strains.
#[inline(always)]
fn strain<D: DualNum<f64> + Copy>(
    (place, g): (&Place, usize),
    u: &Fields<D>,
    tied: &[D; TYING],
    alpha: &[D; MODES],
) -> [D; 6] {
    let (q, w) = (g & 3, &WEIGHT[g & 3]);
    let [u1, u2, _] = u.over(q, RULE[g >> 2].0);
    let [b1, b2, _] = &place.frame;
    let mut e = [
        stretch(b1, &u1),
        stretch(b2, &u2),
        tied[0] * w[0] + tied[1] * w[1] + tied[2] * w[2] + tied[3] * w[3],
        shear([b1, b2], [&u1, &u2]),
        tied[4] * w[4] + tied[5] * w[5],
        tied[6] * w[6] + tied[7] * w[7],
    ];
    let mut base = [D::zero(); BASES];
    for (m, a) in alpha.iter().enumerate() {
        let (b, w) = mode(m, q);
        base[b] += *a * w;
    }
    for (e, row) in e.iter_mut().zip(&place.enhanced) {
        for (b, f) in base.iter().zip(row) {
            *e += *b * *f;
        }
    }
    e
}

/// What strains are made of at the points of one element.
pub(super) struct Strains<D> {
    geometry: Geometry,
    u: Fields<D>,
    tied: [D; TYING],
    alpha: [D; MODES],
}

impl<D: DualNum<f64> + Copy> Strains<D> {
    pub fn new(nodes: &[V<f64>; 8], u: &[V<D>; 8], alpha: &[D; MODES]) -> Self {
        let (geometry, u) = (Geometry::new(nodes), Fields::new(u));
        Strains {
            tied: tying(&geometry.big, &u, [0.0; 2]),
            geometry,
            u,
            alpha: *alpha,
        }
    }

    /// Undeformed geometry, the displacement's derivatives and the strain at point `g`.
    pub fn at(&self, g: usize) -> (Place, [V<D>; 3], [D; 6]) {
        let place = self.geometry.at(g);
        let strain = strain((&place, g), &self.u, &self.tied, &self.alpha);
        (place, self.u.over(g & 3, RULE[g >> 2].0), strain)
    }
}

/// Undeformed frame at a point.
pub(super) fn frame(nodes: &[V<f64>; 8], g: usize) -> [V<f64>; 3] {
    Fields::new(nodes).over(g & 3, RULE[g >> 2].0)
}

/// Metric at a point.
pub(super) fn metric(nodes: &[V<f64>; 8], g: usize) -> Metric {
    metric_of(&frame(nodes, g))
}

/// Volumes of the points.
pub(super) fn volumes(nodes: &[V<f64>; 8]) -> impl Iterator<Item = f64> {
    let geometry = Geometry::new(nodes);
    (0..POINTS).map(move |g| geometry.at(g).volume)
}

/// Point of the lowest or highest layer that is numbered `g` among the eight of both, and the next one inwards.
pub(super) const fn outer(g: usize) -> [usize; 2] {
    let q = g & 3;
    match g >> 2 {
        0 => [q, q + 4],
        _ => [q + 4 * (LAYERS - 1), q + 4 * (LAYERS - 2)],
    }
}

/// The points below and above the middle of the thickness at in-plane point `q`.
pub(super) const fn inner(q: usize) -> [usize; 2] {
    [q + 4 * (LAYERS / 2 - 1), q + 4 * (LAYERS / 2)]
}

/// Values at the nodes, from those at the lowest and highest points and the ones next to them: along the straight line
/// through both to the face, because stresses have a kink where flow begins, and bilinearly in the plane.
pub(super) fn to_nodes<const K: usize>(outer: &[[[f64; K]; 2]; 8]) -> [[f64; K]; 8] {
    let (last, next) = (RULE[LAYERS - 1].0, RULE[LAYERS - 2].0);
    let beyond = (1.0 - last) / (last - next);
    let face = outer.map(|[at, inwards]| {
        std::array::from_fn::<f64, K, _>(|v| at[v] + beyond * (at[v] - inwards[v]))
    });
    let (bottom, top) = face.split_at(4);
    std::array::from_fn(|a| in_plane(a, if a < 4 { bottom } else { top }))
}

/// The value at node `a` of those at the four points of its layer, bilinearly.
pub(super) fn in_plane<const K: usize>(a: usize, points: &[[f64; K]]) -> [f64; K] {
    let mut node = [0.0; K];
    for (q, point) in points.iter().enumerate() {
        let w = (0..2).fold(0.25, |w, bit| w * (1.0 + sign(a, bit) * sign(q, bit) / GP));
        for (n, p) in node.iter_mut().zip(point) {
            *n += w * p;
        }
    }
    node
}

/// Rows of the assumed strains' derivatives by the dofs (`3 node + axis`) that do not depend on the point.
struct TyingRows<D>([[D; 24]; 3]);

impl<D: DualNum<f64> + Copy> TyingRows<D> {
    fn new(now: &Fields<D>) -> Self {
        let mut b = [[D::zero(); 24]; 3];
        for a in 0..8 {
            let (r, s, t) = (sign(a, 0), sign(a, 1), sign(a, 2));
            let (side23, side13) = (&now.tie23[a & 1], &now.tie13[(a >> 1) & 1]);
            for x in 0..3 {
                b[0][3 * a + x] = now.t[a & 3][x] * (0.5 * t);
                b[1][3 * a + x] = (side23[1][x] * s + side23[0][x] * t) * 0.25;
                b[2][3 * a + x] = (side13[1][x] * r + side13[0][x] * t) * 0.25;
            }
        }
        TyingRows(b)
    }
}

/// Derivatives of the shape functions along r and s at point `g`.
#[inline(always)]
fn shape(g: usize) -> [[f64; 8]; 2] {
    let (i, j, t) = (g & 1, (g >> 1) & 1, RULE[g >> 2].0);
    let mut n = [[0.0; 8]; 2];
    for a in 0..8 {
        let along_t = 0.5 * (1.0 + sign(a, 2) * t);
        n[0][a] = 0.5 * sign(a, 0) * LINE[j][(a >> 1) & 1] * along_t;
        n[1][a] = 0.5 * sign(a, 1) * LINE[i][a & 1] * along_t;
    }
    n
}

/// Derivatives of the strain at point `g` by the dofs.
#[inline(always)]
fn rows<D: DualNum<f64> + Copy>(
    now: &Fields<D>,
    tied: &TyingRows<D>,
    g: usize,
    n: &[[f64; 8]; 2],
) -> [[D; 24]; 6] {
    let w = &WEIGHT[g & 3];
    let [g1, g2, _] = now.over(g & 3, RULE[g >> 2].0);
    let mut b = [[D::zero(); 24]; 6];
    for a in 0..8 {
        let sides = [w[a & 3], w[4 + (a & 1)], w[6 + ((a >> 1) & 1)]];
        for x in 0..3 {
            let dof = 3 * a + x;
            b[0][dof] = g1[x] * n[0][a];
            b[1][dof] = g2[x] * n[1][a];
            b[2][dof] = tied.0[0][dof] * sides[0];
            b[3][dof] = g2[x] * n[0][a] + g1[x] * n[1][a];
            b[4][dof] = tied.0[1][dof] * sides[1];
            b[5][dof] = tied.0[2][dof] * sides[2];
        }
    }
    b
}

/// Energy, nodal forces (`3 node + axis`) and forces on the enhanced strains.
#[allow(clippy::type_complexity)]
pub(super) fn forces<D: DualNum<f64> + Copy, L: MaterialLaw>(
    law: &L,
    nodes: &[V<f64>; 8],
    u: &[V<D>; 8],
    alpha: &[D; MODES],
    states: &[f64],
) -> Result<(D, [D; 24], [D; MODES]), (u8, Collapsed)> {
    let geometry = Geometry::new(nodes);
    let du = Fields::new(u);
    let now = add(&geometry.big, &du);
    let (tied, tied_rows) = (tying(&geometry.big, &du, [0.0; 2]), TyingRows::new(&now));
    let (mut energy, mut f, mut h) = (D::zero(), [D::zero(); 24], [D::zero(); MODES]);
    for g in 0..POINTS {
        let place = geometry.at(g);
        let e = strain((&place, g), &du, &tied, alpha);
        let (psi, s) = law
            .stress(&place.metric, &e, &state_of::<L>(states, g))
            .map_err(|c| (g as u8, c))?;
        energy += psi * place.volume;
        let s = s.map(|s| s * place.volume);
        let b = rows(&now, &tied_rows, g, &shape(g));
        for (row, s) in b.iter().zip(s) {
            for (f, b) in f.iter_mut().zip(row) {
                *f += *b * s;
            }
        }
        for (m, h) in h.iter_mut().enumerate() {
            let (base, w) = mode(m, g & 3);
            for (row, s) in place.enhanced.iter().zip(s) {
                *h += s * (w * row[base]);
            }
        }
    }
    Ok((energy, f, h))
}

/// Evaluates one element at displacements `u`: `out` receives condensed forces and tangent, `state` (its alpha and
/// the states of the law being read) the condensation cache.
pub(super) fn evaluate<L: MaterialLaw>(
    law: &L,
    nodes: &[V<f64>; 8],
    u: &[V<f64>; 8],
    state: &mut [f64],
    out: &mut H8System,
) -> Result<(), FaultCause> {
    let geometry = Geometry::new(nodes);
    let du = Fields::new(u);
    let now = add(&geometry.big, &du);
    let tied = tying(&geometry.big, &du, [0.0; 2]);
    let mut alpha = [0.0; MODES];
    alpha.copy_from_slice(&state[..MODES]);
    let states = &state[state_len(MODES)..];
    let mut sums = Sums::<P>::new();
    for q in 0..4 {
        let mut column = Column::<B>::new();
        for (layer, (t, _)) in RULE.into_iter().enumerate() {
            let g = q + 4 * layer;
            let place = geometry.at(g);
            let e = strain((&place, g), &du, &tied, &alpha);
            let response = law
                .response(&place.metric, &e, &state_of::<L>(states, g))
                .map_err(|c| FaultCause::Collapsed {
                    point: g as u8,
                    ratio: c.ratio,
                })?;
            sums.energy += response.energy * place.volume;
            let s = response.stress.map(|s| s * place.volume);
            let c = response.tangent.map(|row| row.map(|c| c * place.volume));
            let [g1, g2, _] = now.over(q, t);
            let along_t = [0.5 * (1.0 - t), 0.5 * (1.0 + t)];
            add_membrane(&mut sums.membrane[q], &c, &s, &g1, &g2, &along_t);
            add_bases(&mut column, (&c, &s), &place.enhanced, (&g1, &g2), &along_t);
        }
        add_parameters::<MODES, B, P>(&mut sums, q, &column);
    }
    condense::<MODES, P>(&sums, &now, (false, [0.0; 2]), state, out)
}

/// Stresses of unit base strains at one point: 33, 23, 13 at the tying points, then the enhanced ones.
#[inline(always)]
fn add_bases(
    column: &mut Column<B>,
    (c, s): (&[[f64; 6]; 6], &[f64; 6]),
    enhanced: &[[f64; BASES]; 6],
    g: (&V<f64>, &V<f64>),
    along_t: &[f64; 2],
) {
    // C A, then A^T C A and A^T s of the bases A.
    let mut ca = [[0.0; BASES]; 6];
    for v in 0..6 {
        for w in 0..6 {
            for (ca, a) in ca[v].iter_mut().zip(&enhanced[w]) {
                *ca += c[v][w] * a;
            }
        }
    }
    let mut aca = [[0.0; BASES]; BASES];
    let mut force = [0.0; BASES];
    for v in 0..6 {
        for m in 0..BASES {
            for n in 0..BASES {
                aca[m][n] += enhanced[v][m] * ca[v][n];
            }
            force[m] += enhanced[v][m] * s[v];
        }
    }
    let row = |v: usize| {
        let x = &ca[v];
        let tied = [c[v][2], c[v][4], c[v][5]];
        [
            tied[0], tied[1], tied[2], x[0], x[1], x[2], x[3], x[4], s[v],
        ]
    };
    column.add_line([&row(0), &row(1), &row(3)], g, along_t);
    for (base, v) in column.base.iter_mut().zip([2, 4, 5]) {
        for (base, r) in base.iter_mut().zip(row(v)) {
            *base += r;
        }
    }
    for (m, base) in column.base[3..3 + BASES].iter_mut().enumerate() {
        let tied = [ca[2][m], ca[4][m], ca[5][m]];
        for (base, r) in base
            .iter_mut()
            .zip(tied.into_iter().chain(aca[m]).chain([force[m]]))
        {
            *base += r;
        }
    }
}
