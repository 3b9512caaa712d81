//! Control points of trimmed faces that next to nothing resists.
//!
//! Where a trim just reaches into an element, the shape functions of some control points are tiny over all that is kept: where the
//! parts `d1` and `d2` of its sides are left at a corner, a bending stiffness of the order `d1^4 d2^8`. The strains of the kept part
//! then move such a point by many elements, though the surface hardly sees it. A tether holds it to where the
//! neighbours that are well resisted, continued as a polynomial, would put it (as extended B-splines do: K. Höllig, U. Reif, J. Wipper,
//! SIAM J. Numer. Anal. 39, 2001), by the energy `k/2 |x_c - sum_a e_a x_a|^2` with `k = STIFF D / A`.
//!
//! The bound is the error that this makes. A smooth deflection of curvature `kappa` leaves the continuation by less than `kappa A`,
//! so that the energy is below `STIFF D kappa^2 A / 2`: the part `STIFF` of what one element stores in bending. In return the mismatch
//! of strains in a kept part `phi` of an element moves the point by `kappa A sqrt(phi / STIFF) / 2` at most.
use super::super::kinematics::V;
use super::NurbsBlock;
use super::frame::{DOFS, NODES, combine};
use crate::mesh::NurbsSheet;
use crate::mesh::nurbs::Kept;
use covact_geometry::{PatchShape, Vec3};
use nalgebra::{DMatrix, DVector, SymmetricEigen};
use num_dual::DualNum;

/// Stiffness of a tether in bending stiffnesses of a whole element: the largest part of its energy that a tether changes.
const STIFF: f64 = 1e-6;

/// Points with less than this part of a bending stiffness have a tether: it adds a thousandth to that of any other.
const LOOSE: f64 = 1e3 * STIFF;

/// Weights of a continuation above this carry what is continued too far.
const LARGEST: f64 = 30.0;

/// A tether in an element.
#[derive(Debug, Clone)]
pub(super) struct Tether {
    pub element: u32,
    /// One at the point, `-e_a` at its neighbours.
    c: [f64; NODES],
    stiffness: f64,
}

/// Second derivatives of every control point's shape function, squared and integrated over what is kept, with elements of
/// side one. Points of whole elements have no number.
fn resistances(sheet: &NurbsSheet) -> Vec<Option<f64>> {
    let mut out = vec![Some(0.0); sheet.nodes()];
    let mut room = PatchShape::default();
    for e in 0..sheet.elements() {
        let (part, span) = sheet.place(e);
        let range = sheet.range(e);
        let [l1, l2] = range.map(|[a, b]| b - a);
        let node = |k: u32| (part.first_node + k) as usize;
        match sheet.kept(e) {
            Kept::Nothing => {}
            Kept::Whole => {
                let middle = range.map(|[a, b]| 0.5 * (a + b));
                part.patch.shape_in_span(span, middle, &mut room);
                (room.indices.iter()).for_each(|k| out[node(*k)] = None);
            }
            Kept::Part(points) => {
                for p in points {
                    part.patch.shape_in_span(span, p.xi, &mut room);
                    let share = p.weight / (l1 * l2);
                    for (k, [n11, n12, n22]) in room.indices.iter().zip(&room.n_ij) {
                        let [n11, n12, n22] = [n11 * l1 * l1, n12 * l1 * l2, n22 * l2 * l2];
                        if let Some(sum) = &mut out[node(*k)] {
                            *sum += share * (n11 * n11 + 2.0 * n12 * n12 + n22 * n22);
                        }
                    }
                }
            }
        }
    }
    out
}

/// Weights by which the points `from` continue to point `to` of the net of an element: exact for rigid motions, for polynomials of
/// degree 2 where there are points enough.
fn continuation(to: usize, from: &[usize], x: &[Vec3; NODES]) -> Option<[f64; NODES]> {
    let size = from
        .iter()
        .map(|a| (x[*a] - x[to]).norm())
        .fold(0.0, f64::max);
    let off = |a: usize| {
        let line = |a: usize, to: usize| a as f64 - to as f64;
        [line(a % 4, to % 4), line(a / 4, to / 4)]
    };
    let of_degree = |degree: usize, round: f64| -> Option<[f64; NODES]> {
        let rows = |a: usize| -> Vec<f64> {
            let ([s, t], y) = (off(a), (x[a] - x[to]) / size);
            let mut all = vec![1.0, y.x, y.y, y.z];
            if degree == 2 {
                all.extend([s / 3.0, t / 3.0, s * s / 9.0, s * t / 9.0, t * t / 9.0]);
            }
            all
        };
        // The weights of least size, those of points further away counted more.
        let near = |a: usize| {
            let [s, t] = off(a);
            1.0 / (s * s + t * t).powi(2)
        };
        let count = rows(to).len();
        let all = DMatrix::from_fn(count, from.len(), |r, k| rows(from[k])[r]);
        let weights = DVector::from_iterator(from.len(), from.iter().map(|a| near(*a)));
        let scaled = DMatrix::from_fn(from.len(), count, |k, r| weights[k] * all[(r, k)]);
        let eigen = SymmetricEigen::new(&all * &scaled);
        let limit = round * eigen.eigenvalues.max();
        let asked = DVector::from_vec(rows(to));
        let mut y = DVector::zeros(count);
        for (l, v) in (eigen.eigenvalues.iter()).zip(eigen.eigenvectors.column_iter()) {
            if *l > limit {
                y += v * (v.dot(&asked) / l);
            }
        }
        let found = scaled * y;
        let off = (&all * &found - asked).amax();
        let fits = off < 1e-6 && found.amax() < LARGEST;
        let mut out = [0.0; NODES];
        for (a, e) in from.iter().zip(found.iter()) {
            out[*a] = *e;
        }
        fits.then_some(out)
    };
    of_degree(2, 1e-12).or_else(|| of_degree(1, 1e-8))
}

impl Tether {
    /// Those of a sheet, by elements.
    pub fn all(sheet: &NurbsSheet, bending: f64) -> Vec<Tether> {
        if !sheet.is_trimmed() {
            return Vec::new();
        }
        let resistances = resistances(sheet);
        let loose = |n: u32| resistances[n as usize].is_some_and(|r| r < LOOSE);
        // The element of a loose point with most points that are not.
        let mut best: Vec<Option<(usize, usize)>> = vec![None; sheet.nodes()];
        let mut room = PatchShape::default();
        let mut nodes_of = |e: usize| -> [u32; NODES] {
            let (part, span) = sheet.place(e);
            let middle = sheet.range(e).map(|[a, b]| 0.5 * (a + b));
            part.patch.shape_in_span(span, middle, &mut room);
            std::array::from_fn(|a| room.indices[a] + part.first_node)
        };
        let kept = (0..sheet.elements()).filter(|e| matches!(sheet.kept(*e), Kept::Part(_)));
        for e in kept {
            let nodes = nodes_of(e);
            let firm = nodes.iter().filter(|n| !loose(**n)).count();
            for n in nodes.into_iter().filter(|n| loose(*n)) {
                let best = &mut best[n as usize];
                if best.is_none_or(|(_, most)| firm > most) {
                    *best = Some((e, firm));
                }
            }
        }
        let positions = sheet.positions();
        let mut out = Vec::new();
        for (n, best) in best.iter().enumerate() {
            let Some((e, _)) = *best else { continue };
            let nodes = nodes_of(e);
            let Some(to) = nodes.iter().position(|m| *m as usize == n) else {
                continue;
            };
            let x = nodes.map(|m| positions[m as usize]);
            let firm: Vec<usize> = (0..NODES).filter(|a| !loose(nodes[*a])).collect();
            let others: Vec<usize> = (0..NODES).filter(|a| *a != to).collect();
            let found = [firm, others].into_iter().filter(|from| !from.is_empty());
            let Some(weights) = found
                .into_iter()
                .find_map(|from| continuation(to, &from, &x))
            else {
                continue;
            };
            let mut c = weights.map(|e| -e);
            c[to] = 1.0;
            let (part, span) = sheet.place(e);
            let jet = part.patch.jet(sheet.range(e).map(|[a, b]| 0.5 * (a + b)));
            let [l1, l2] = [0, 1].map(|dir| {
                let [a, b] = part.patch.basis(dir).span_range(span[dir]);
                b - a
            });
            let area = jet.rho_i[0].cross(&jet.rho_i[1]).norm() * l1 * l2;
            out.push(Tether {
                element: e as u32,
                c,
                stiffness: STIFF * bending / area,
            });
        }
        out.sort_by_key(|t| t.element);
        out
    }

    /// How far the point is from where its neighbours put it.
    fn jump<D: DualNum<f64> + Copy>(&self, u: &[V<D>; NODES]) -> V<D> {
        combine(&self.c, u)
    }

    /// Adds its forces; returns its energy.
    pub fn forces<D: DualNum<f64> + Copy>(&self, u: &[V<D>; NODES], f: &mut [V<D>; NODES]) -> D {
        let jump = self.jump(u);
        for (f, c) in f.iter_mut().zip(self.c) {
            (0..3).for_each(|i| f[i] += jump[i] * (c * self.stiffness));
        }
        (jump[0] * jump[0] + jump[1] * jump[1] + jump[2] * jump[2]) * (0.5 * self.stiffness)
    }

    /// Adds its forces and the upper half of its tangent, by columns; returns its energy.
    pub fn linearize(&self, u: &[V<f64>; NODES], f: &mut [f64; DOFS], k: &mut [f64]) -> f64 {
        let jump: V<f64> = self.jump(u);
        for a in 0..NODES {
            (0..3).for_each(|i| f[3 * a + i] += jump[i] * (self.c[a] * self.stiffness));
        }
        for b in 0..NODES {
            for a in 0..=b {
                let by = self.stiffness * (self.c[a] * self.c[b]);
                (0..3).for_each(|i| k[(3 * b + i) * DOFS + 3 * a + i] += by);
            }
        }
        0.5 * self.stiffness * jump.iter().map(|j| j * j).sum::<f64>()
    }
}

impl NurbsBlock {
    /// Tethers of an element, with the first of its groups.
    pub(super) fn tethers_in(&self, group: usize) -> &[Tether] {
        // A sheet with tethers is trimmed, so it has groups.
        let Some(own) = self.groups.get(group).filter(|_| !self.tethers.is_empty()) else {
            return &[];
        };
        match self.groups_of(own.element as usize).start == group {
            true => {
                let end = self.tethers.partition_point(|t| t.element <= own.element);
                let start = self.tethers.partition_point(|t| t.element < own.element);
                &self.tethers[start..end]
            }
            false => &[],
        }
    }
}
