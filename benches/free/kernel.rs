//! The kernel written for one case alone: penalty contact without friction of faces of four nodes with a rigid surface
//! that moves and turns, whose patches join smoothly or which is convex.
//!
//! Nothing is generic but the kind of patches, nothing is chosen but what the case itself calls for:
//!
//! - a position that is not finite, a search that did not converge, tangents that span no plane, a point beyond the
//!   focal surface: without these checks the kernel would give wrong numbers in silence;
//! - deeper than the depth of the surface, or the foot on a free border: not in contact;
//! - a foot on a smooth edge or corner (where the patches of a ball meet) is one of a face; on a sharp one, on a crease
//!   or a pole the kernel refuses: a convex or smooth surface has no closed points there.
//!
//! It leaves out what the case does not call for: no offset, no multiplier, no friction, no held points, no choice of
//! tangent, no prescribed displacements of slave nodes, no sharp edges, vertices and poles, no symmetry but a symmetric
//! matrix. The tangent is formed in six entries and every block of the matrix takes it as it is, because a symmetric
//! block is its own transpose.
//!
//! It delivers all that the solver reads from an evaluation: the residual, the contact forces alone, the tangent,
//! resultant force and moment, energy, deepest penetration, numbers of points, and the rounding estimate.
use covact::contact::points::SlavePoint;
use covact::model::state::PointState;
use covact::model::{Model, PairModel};
use covact::system::{Pattern, SystemMatrix};
use covact_geometry::{EdgeKind, Foot, Location, PatchSet, Status, Surface, Vec3};
use nalgebra::{Isometry3, Rotation3};
use std::sync::Arc;

/// Nodes of a face, and pairs of them.
const N: usize = 4;
const PAIRS: usize = N * (N + 1) / 2;

/// What the kernel sums up.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Sums {
    pub force: Vec3,
    pub moment: Vec3,
    pub energy: f64,
    pub deepest: f64,
    pub active: usize,
    pub changed: usize,
    pub opened: usize,
    pub rounding: f64,
    pub norm: f64,
}

/// A point that the kernel cannot evaluate.
#[derive(Debug)]
pub struct Refused;

/// A point in contact.
#[derive(Debug, Clone, Copy)]
struct Point {
    x: Vec3,
    force: Vec3,
    /// 11, 21, 31, 22, 32, 33.
    tangent: [f64; 6],
    gap: f64,
}

/// The kernel with its matrix and vectors.
pub struct Kernel<'m, S: Surface> {
    model: &'m Model,
    pair: &'m PairModel,
    set: &'m PatchSet<S>,
    depth: f64,
    /// First value of every block of a point, lower triangle by columns.
    maps: Vec<[u32; PAIRS]>,
    points: Vec<Option<Point>>,
    pub matrix: SystemMatrix,
    pub contact: Vec<f64>,
}

impl<'m, S: Surface> Kernel<'m, S> {
    pub fn new(model: &'m Model, set: &'m PatchSet<S>, pattern: Arc<Pattern>) -> Self {
        let pair = &model.pairs[0];
        let map = |p: &SlavePoint| {
            assert_eq!(p.count as usize, N);
            let mut map = [0; PAIRS];
            let mut at = 0;
            for q in 0..N {
                for r in q..N {
                    let block = pattern.block(p.nodes[r], p.nodes[q]);
                    map[at] = 9 * block.expect("nodes of a face are coupled");
                    at += 1;
                }
            }
            map
        };
        Kernel {
            model,
            pair,
            set,
            depth: model.surfaces[0].depth,
            maps: pair.points.iter().map(map).collect(),
            points: vec![None; pair.points.len()],
            contact: vec![0.0; 3 * model.nodes.len()],
            matrix: SystemMatrix::new(pattern),
        }
    }

    /// One loop: every point is evaluated and summed at once.
    pub fn one_loop(
        &mut self,
        pose: &Isometry3<f64>,
        u: &[f64],
        states: &mut [PointState],
        residual: &mut [f64],
    ) -> Result<Sums, Refused> {
        let mut sums = Sums::default();
        self.contact.fill(0.0);
        residual.fill(0.0);
        let turn = Turn::new(pose);
        let values = self.matrix.values_mut();
        for ((p, map), state) in self.pair.points.iter().zip(&self.maps).zip(states) {
            let point = evaluate(
                self.set,
                self.depth,
                self.pair.eps_n,
                &turn,
                self.model,
                u,
                p,
                state,
            )?;
            sums.note(state, point.is_some());
            if let Some(point) = &point {
                let eps = self.pair.eps_n;
                sum(
                    point,
                    p,
                    map,
                    eps,
                    &mut sums,
                    residual,
                    &mut self.contact,
                    values,
                );
            }
        }
        sums.end(&self.contact);
        Ok(sums)
    }

    /// Two loops, as a program has to that evaluates points in parallel and sums them in order: the first keeps what every
    /// point gives, the second sums.
    pub fn two_loops(
        &mut self,
        pose: &Isometry3<f64>,
        u: &[f64],
        states: &mut [PointState],
        residual: &mut [f64],
    ) -> Result<Sums, Refused> {
        let mut sums = Sums::default();
        self.contact.fill(0.0);
        residual.fill(0.0);
        let turn = Turn::new(pose);
        let eps = self.pair.eps_n;
        let points = self.pair.points.iter();
        for ((p, state), out) in points.zip(&mut *states).zip(&mut self.points) {
            *out = evaluate(self.set, self.depth, eps, &turn, self.model, u, p, state)?;
        }
        let values = self.matrix.values_mut();
        let points = self.pair.points.iter().zip(&self.points);
        for (((p, point), map), state) in points.zip(&self.maps).zip(states) {
            sums.note(state, point.is_some());
            if let Some(point) = point {
                sum(
                    point,
                    p,
                    map,
                    eps,
                    &mut sums,
                    residual,
                    &mut self.contact,
                    values,
                );
            }
        }
        sums.end(&self.contact);
        Ok(sums)
    }
}

/// From space to the surface's own coordinates and back.
pub struct Turn {
    columns: [Vec3; 3],
    shift: Vec3,
}

impl Turn {
    pub fn new(pose: &Isometry3<f64>) -> Self {
        let r = Rotation3::from(pose.rotation).into_inner();
        Turn {
            columns: [0, 1, 2].map(|c| r.column(c).into_owned()),
            shift: pose.translation.vector,
        }
    }

    #[inline(always)]
    pub fn local(&self, x: &Vec3) -> Vec3 {
        let d = x - self.shift;
        Vec3::new(
            self.columns[0].dot(&d),
            self.columns[1].dot(&d),
            self.columns[2].dot(&d),
        )
    }

    #[inline(always)]
    fn space(&self, v: &Vec3) -> Vec3 {
        self.columns[0] * v.x + self.columns[1] * v.y + self.columns[2] * v.z
    }
}

/// Position of a slave point.
#[inline(always)]
pub fn position(model: &Model, u: &[f64], p: &SlavePoint) -> Vec3 {
    let term = |a: usize| {
        let node = p.nodes[a] as usize;
        let u = &u[3 * node..3 * node + 3];
        (model.nodes[node] + Vec3::new(u[0], u[1], u[2])) * p.shape[a]
    };
    term(0) + term(1) + term(2) + term(3)
}

#[inline(always)]
#[expect(clippy::too_many_arguments)]
fn evaluate<S: Surface>(
    set: &PatchSet<S>,
    depth: f64,
    eps: f64,
    turn: &Turn,
    model: &Model,
    u: &[f64],
    p: &SlavePoint,
    state: &mut PointState,
) -> Result<Option<Point>, Refused> {
    let x = position(model, u, p);
    if !(x.x.is_finite() && x.y.is_finite() && x.z.is_finite()) {
        return Err(Refused);
    }
    let Some(foot) = set.project(&turn.local(&x), state.hint, depth) else {
        state.hint = None;
        return Ok(None);
    };
    state.hint = Some(foot.hint());
    if foot.status == Status::NotConverged {
        return Err(Refused);
    }
    let gap = foot.signed_distance;
    if gap >= 0.0 || gap < -depth {
        return Ok(None);
    }
    match foot.location {
        Location::Face
        | Location::Edge {
            kind: EdgeKind::Smooth,
            ..
        }
        | Location::Corner {
            kind: EdgeKind::Smooth,
            ..
        } => {}
        Location::Edge {
            kind: EdgeKind::Free,
            ..
        }
        | Location::Corner {
            kind: EdgeKind::Free,
            ..
        } => return Ok(None),
        _ => return Err(Refused),
    }
    face(&foot, gap, eps, turn, p.area, x).map(Some)
}

/// Frame, traction and tangent of a foot on a face.
#[inline(always)]
fn face(
    foot: &Foot,
    gap: f64,
    eps: f64,
    turn: &Turn,
    area: f64,
    x: Vec3,
) -> Result<Point, Refused> {
    let [r1, r2] = &foot.jet.rho_i;
    let [a11, a12, a22] = [r1.dot(r1), r1.dot(r2), r2.dot(r2)];
    let cross = r1.cross(r2);
    let det = cross.dot(&cross);
    let root = det.sqrt();
    if !(root > 1e-12 * a11.max(a22) && root.is_finite()) {
        return Err(Refused);
    }
    let n = cross * (foot.side / root);
    let [h11, h12, h22] = [0, 1, 2].map(|i| foot.jet.rho_ij[i].dot(&n));
    // A = a - gap h at the point.
    let [m11, m12, m22] = [a11 - gap * h11, a12 - gap * h12, a22 - gap * h22];
    let m_det = m11 * m22 - m12 * m12;
    if !(m11 > 0.0 && m_det > 0.0) {
        return Err(Refused);
    }
    // S = N area A^-1 h a^-1, with both inverses as adjugates over their determinants.
    let traction = eps * gap * area;
    let scale = traction / (m_det * det);
    let l11 = m22 * h11 - m12 * h12;
    let l12 = m22 * h12 - m12 * h22;
    let l21 = m11 * h12 - m12 * h11;
    let l22 = m11 * h22 - m12 * h12;
    let s11 = scale * (l11 * a22 - l12 * a12);
    let s12 = scale * (l12 * a11 - l11 * a12);
    let s22 = scale * (l22 * a11 - l21 * a12);
    let (n, r1, r2) = (turn.space(&n), turn.space(r1), turn.space(r2));
    let (t0, t1, t2) = (n * (eps * area), r1 * s11 + r2 * s12, r1 * s12 + r2 * s22);
    let entry = |i: usize, j: usize| t0[i] * n[j] - t1[i] * r1[j] - t2[i] * r2[j];
    Ok(Point {
        x,
        force: n * traction,
        tangent: [
            entry(0, 0),
            entry(1, 0),
            entry(2, 0),
            entry(1, 1),
            entry(2, 1),
            entry(2, 2),
        ],
        gap,
    })
}

impl Sums {
    /// All of them, as [`crate::program::Program::numbers`].
    pub fn numbers(&self) -> [f64; 13] {
        crate::program::numbers(
            [self.force, self.moment],
            [self.energy, self.deepest, self.norm],
            [self.active, self.changed, self.opened],
            self.rounding,
        )
    }

    #[inline(always)]
    fn note(&mut self, state: &mut PointState, closed: bool) {
        self.changed += usize::from(closed != state.closed);
        self.opened += usize::from(state.closed && !closed);
        state.closed = closed;
    }

    fn end(&mut self, contact: &[f64]) {
        self.rounding = self.rounding.sqrt();
        self.norm = contact.iter().map(|f| f * f).sum::<f64>().sqrt();
    }
}

#[inline(always)]
#[expect(clippy::too_many_arguments)]
fn sum(
    point: &Point,
    p: &SlavePoint,
    map: &[u32; PAIRS],
    eps: f64,
    sums: &mut Sums,
    residual: &mut [f64],
    contact: &mut [f64],
    values: &mut [f64],
) {
    let Point {
        x,
        force,
        tangent,
        gap,
    } = point;
    sums.active += 1;
    sums.deepest = sums.deepest.max(-gap);
    sums.energy += 0.5 * eps * gap * gap * p.area;
    sums.force -= force;
    sums.moment -= x.cross(force);
    sums.rounding += (eps * p.area * f64::EPSILON).powi(2) * x.norm_squared();
    for a in 0..N {
        let at = 3 * p.nodes[a] as usize;
        let f = force * p.shape[a];
        for (out, f) in residual[at..at + 3].iter_mut().zip(f.iter()) {
            *out += f;
        }
        for (out, f) in contact[at..at + 3].iter_mut().zip(f.iter()) {
            *out += f;
        }
    }
    let [k11, k21, k31, k22, k32, k33] = *tangent;
    let k = [k11, k21, k31, k21, k22, k32, k31, k32, k33];
    let mut at = 0;
    for q in 0..N {
        for r in q..N {
            let first = map[at] as usize;
            at += 1;
            let w = p.shape[q] * p.shape[r];
            for (out, k) in values[first..first + 9].iter_mut().zip(&k) {
                *out += w * k;
            }
        }
    }
}
