//! Seams: where two patches of a sheet are joined. Their control points stay their own; an energy per undeformed length holds
//! displacements together and the angle between both sides,
//! `alpha_d/2 |u_A - u_B|^2 + alpha_r (1 - m . n_B)` with `m = c0 n_A + s0 nu_A + t0 tau_A`,
//! where `tau` is the unit tangent of the seam on side A, `nu_A = tau x n_A`, and the constants `c0 = N_A . N_B`,
//! `s0 = Nu_A . N_B` and `t0 = Tau_A . N_B` are those of the undeformed shell, the last no more than a gap makes of it. `1 - m . n_B` is twice the square of the sine of half the change of the
//! angle, whatever the angle is: flat seams, folds and normals that are turned over are one expression. Displacements, not
//! positions, are compared, so that a gap within the tolerance of a CAD file strains nothing.
//!
//! The penalties are those of A. J. Herrema, E. L. Johnson, D. Proserpio, M. C. H. Wu, J. Kiendl and M.-C. Hsu, CMAME 346 (2019),
//! a thousand stretching and bending stiffnesses over the width of an element. Splines of two sides that do not match share
//! polynomials alone, so that more points than it takes to hold these would lock: there are two on every span of the side with
//! fewer of them, or as many as spans of the other side lie along it.
use super::super::kinematics::{V, dot};
use super::frame::{NODES, Normal, combine, cross};
use super::point::{Shapes, shapes};
use super::{Law, ShellError};
use crate::fem::gauss;
use crate::mesh::NurbsSheet;
use crate::mesh::nurbs::{Border, DEGREE, Seam, width_across};
use covact_geometry::{PatchShape, Vec3};
use num_dual::DualNum;

/// Nodes of the spans on both sides.
pub const SEAM_NODES: usize = 2 * NODES;

/// Their degrees of freedom.
pub const SEAM_DOFS: usize = 3 * SEAM_NODES;

/// How stiff a seam is, in stiffnesses of the sheet over the width of an element.
const STIFF: f64 = 1e3;

/// Most points of one rule.
const RULE: usize = 8;

/// Vectors at the control points of both sides.
type Sides<D> = [[V<D>; NODES]; 2];

/// Two spans, one on each side of a seam.
#[derive(Debug, Clone)]
pub struct SeamSpan {
    /// Control points, numbered in the sheet: those of side A, then those of side B.
    pub nodes: [u32; SEAM_NODES],
    /// Their undeformed positions.
    reference: [[V<f64>; NODES]; 2],
    points: Vec<SeamPoint>,
}

#[derive(Debug, Clone)]
struct SeamPoint {
    /// Shape functions of both sides.
    n: [[f64; NODES]; 2],
    n_i: [[[f64; NODES]; 2]; 2],
    /// Derivatives of those of side A along the seam.
    n_t: [f64; NODES],
    /// `c0, s0, t0`.
    angle: [f64; 3],
    /// `alpha_d` and `alpha_r` times the undeformed length.
    stiffness: [f64; 2],
}

/// Where a point of a seam is on one side.
struct Place {
    element: usize,
    shapes: Shapes,
    frame: Normal<f64>,
    /// Width of the element across the edge (length).
    width: f64,
    /// Derivative of the parameters along it.
    direction: [f64; 2],
}

fn place(sheet: &NurbsSheet, border: Border, s: f64, room: &mut PatchShape) -> Place {
    let part = &sheet.patches[border.patch()];
    let line = part.line(border);
    let span = line.span(s);
    let sides = [0, 1].map(|dir| {
        let [a, b] = part.patch.basis(dir).span_range(span[dir]);
        b - a
    });
    let mut shapes = shapes(&part.patch, span, line.xi(s), room);
    let positions = part.patch.homogeneous();
    let x = shapes.nodes.map(|n| {
        let [x, y, z, w] = positions[n as usize];
        [x / w, y / w, z / w]
    });
    let frame = Normal::new([
        combine(&shapes.second[0], &x),
        combine(&shapes.second[1], &x),
    ]);
    for node in &mut shapes.nodes {
        *node += part.first_node;
    }
    let width = width_across(border, frame.r.map(Vec3::from), line.outward(s), sides);
    Place {
        element: part.first_element as usize + span[0] + part.patch.basis(0).span_count() * span[1],
        width,
        direction: line.direction(s),
        shapes,
        frame,
    }
}

impl SeamSpan {
    /// All of a sheet of this law.
    ///
    /// # Errors
    /// A seam along which a side has no normal.
    pub fn all(sheet: &NurbsSheet, law: &Law) -> Result<Vec<SeamSpan>, ShellError> {
        let positions: Vec<V<f64>> = sheet.positions().into_iter().map(Into::into).collect();
        let mut out = Vec::new();
        for seam in &sheet.joints.seams {
            Self::along(sheet, law, seam, &positions, &mut out)?;
        }
        Ok(out)
    }

    fn along(
        sheet: &NurbsSheet,
        law: &Law,
        seam: &Seam,
        positions: &[V<f64>],
        out: &mut Vec<SeamSpan>,
    ) -> Result<(), ShellError> {
        let curves = seam.edges.map(|border| sheet.curve(border));
        let spans = [0, 1].map(|k| curves[k].line.pieces(seam.ranges[k]));
        // Points are taken on the side with fewer spans.
        let a = usize::from(spans[1].len() < spans[0].len());
        let b = 1 - a;
        let nu = law.nu();
        let stretch = law.young() * sheet.thickness / (1.0 - nu * nu);
        let bending = stretch * sheet.thickness * sheet.thickness / 12.0;
        let mut room = PatchShape::default();
        for [from, to] in &spans[a] {
            let feet = [*from, *to].map(|s| curves[b].foot(&curves[a].point(s)).0);
            let other = [feet[0].min(feet[1]), feet[0].max(feet[1])];
            let count = curves[b].line.pieces(other).len().max(DEGREE - 1);
            let parts = count.div_ceil(RULE);
            let rule = gauss(count.div_ceil(parts)).expect("rules have up to eight points");
            for part in 0..parts {
                let size = (to - from) / parts as f64;
                let start = from + size * part as f64;
                for (g, w) in rule.iter() {
                    let s = start + 0.5 * (1.0 + g) * size;
                    let x = curves[a].point(s);
                    let places = [
                        place(sheet, seam.edges[a], s, &mut room),
                        place(sheet, seam.edges[b], curves[b].foot(&x).0, &mut room),
                    ];
                    let Some(mut point) = SeamPoint::new(&places, 0.5 * w * size, stretch, bending)
                    else {
                        let element = places[0].element as u32;
                        return Err(ShellError::NoNormal { element });
                    };
                    let reference = places
                        .each_ref()
                        .map(|p| p.shapes.nodes.map(|n| positions[n as usize]));
                    // The numbers that it is compared with later, to the last bit.
                    point.angle = Joint::new(&point, &reference).off;
                    let nodes = std::array::from_fn(|k| places[k / NODES].shapes.nodes[k % NODES]);
                    match out.last_mut() {
                        Some(last) if last.nodes == nodes => last.points.push(point),
                        _ => out.push(SeamSpan {
                            nodes,
                            reference,
                            points: vec![point],
                        }),
                    }
                }
            }
        }
        Ok(())
    }

    /// Leaves only what holds the angle.
    #[cfg(test)]
    pub fn without_shift(&mut self) {
        self.points.iter_mut().for_each(|p| p.stiffness[0] = 0.0);
    }

    /// Another normal of side B at rest, in the axes of side A.
    #[cfg(test)]
    pub fn with_angle(&mut self, angle: [f64; 3]) {
        self.points.iter_mut().for_each(|p| p.angle = angle);
    }

    /// Sum of the stiffnesses that hold displacements together.
    #[cfg(test)]
    pub fn stretching(&self) -> f64 {
        self.points.iter().map(|p| p.stiffness[0]).sum()
    }

    /// Bytes of heap that its points take.
    pub fn bytes(&self) -> usize {
        size_of_val(&self.points[..])
    }

    /// Energy and forces at displacements `u`, for any scalar.
    pub fn forces<D: DualNum<f64> + Copy>(
        &self,
        u: &[V<D>; SEAM_NODES],
    ) -> (D, [V<D>; SEAM_NODES]) {
        let (mut energy, mut f) = (D::zero(), [[D::zero(); 3]; SEAM_NODES]);
        let [own, x] = self.sides(u);
        for p in &self.points {
            let at = Joint::new(p, &x);
            let jump = p.jump(&own);
            energy += dot(&jump, &jump) * (0.5 * p.stiffness[0]);
            energy += at.energy(p);
            for side in 0..2 {
                let sign = if side == 0 { 1.0 } else { -1.0 };
                for a in 0..NODES {
                    let turn = at.gradient(p, side, a);
                    let shift = sign * p.stiffness[0] * p.n[side][a];
                    for c in 0..3 {
                        f[NODES * side + a][c] += jump[c] * shift - turn[c] * p.stiffness[1];
                    }
                }
            }
        }
        (energy, f)
    }

    /// Displacements and positions of both sides.
    fn sides<D: DualNum<f64> + Copy>(&self, u: &[V<D>; SEAM_NODES]) -> [Sides<D>; 2] {
        let own = [0, 1].map(|s| std::array::from_fn(|a| u[NODES * s + a]));
        let x = [0, 1].map(|s: usize| {
            std::array::from_fn(|a| {
                [0, 1, 2].map(|c| u[NODES * s + a][c] + self.reference[s][a][c])
            })
        });
        [own, x]
    }

    /// Energy at displacements `u`; forces, and with a room for it (columns of [`SEAM_DOFS`]) the tangent, exactly symmetric.
    pub fn evaluate(
        &self,
        u: &[Vec3; SEAM_NODES],
        f: &mut [f64; SEAM_DOFS],
        k: Option<&mut [f64]>,
    ) -> f64 {
        let u = u.map(Into::into);
        let (energy, forces) = self.forces::<f64>(&u);
        f.copy_from_slice(forces.as_flattened());
        let Some(k) = k else {
            return energy;
        };
        k.fill(0.0);
        let [_, x] = self.sides(&u);
        for p in &self.points {
            Joint::new(p, &x).add_tangent(p, k);
        }
        // What is above the diagonal is complete.
        for column in 0..SEAM_DOFS {
            for row in column + 1..SEAM_DOFS {
                k[column * SEAM_DOFS + row] = k[row * SEAM_DOFS + column];
            }
        }
        energy
    }
}

impl SeamPoint {
    fn new([a, b]: &[Place; 2], weight: f64, stretch: f64, bending: f64) -> Option<SeamPoint> {
        let [d1, d2] = a.direction;
        let [r1, r2] = &a.frame.r;
        let t: V<f64> = [0, 1, 2].map(|c| r1[c] * d1 + r2[c] * d2);
        let length = dot(&t, &t).sqrt();
        let tau = t.map(|t| t / length);
        // Two normals of one edge are both across it.
        let slant = dot(&tau, &b.frame.n);
        let scale = STIFF / (0.5 * (a.width + b.width)) * weight * length;
        let stiffness = [stretch * scale, bending * scale];
        let sound = slant.abs() < 0.5 && stiffness.iter().all(|s| *s > 0.0 && s.is_finite());
        sound.then(|| SeamPoint {
            n: [a.shapes.n, b.shapes.n],
            n_i: [a, b].map(|p| [p.shapes.second[0], p.shapes.second[1]]),
            n_t: std::array::from_fn(|k| a.shapes.second[0][k] * d1 + a.shapes.second[1][k] * d2),
            // Set by what is compared with it.
            angle: [0.0; 3],
            stiffness,
        })
    }

    /// `u_A - u_B`.
    fn jump<D: DualNum<f64> + Copy>(&self, u: &Sides<D>) -> V<D> {
        let [a, b] = [0, 1].map(|s: usize| combine(&self.n[s], &u[s]));
        [0, 1, 2].map(|c| a[c] - b[c])
    }
}

/// The deformed shape of both sides at a point.
struct Joint<D> {
    frames: [Normal<D>; 2],
    tau: V<D>,
    nu: V<D>,
    m: V<D>,
    /// `n_B - m` along `n_A`, `nu` and `tau`: nothing at all at rest, not even round-off, where nothing else has forces either.
    /// Products with it are those with `n_B` or `-m` alone, because a unit vector turns across itself.
    off: [D; 3],
    /// Length of `rho_t`.
    length: D,
}

impl<D: DualNum<f64> + Copy> Joint<D> {
    fn new(p: &SeamPoint, x: &Sides<D>) -> Self {
        let frames = [0, 1].map(|s: usize| {
            Normal::new([combine(&p.n_i[s][0], &x[s]), combine(&p.n_i[s][1], &x[s])])
        });
        let t = combine(&p.n_t, &x[0]);
        let length = dot(&t, &t).sqrt();
        let tau = t.map(|t| t / length);
        let nu = cross(&tau, &frames[0].n);
        let [c0, s0, t0] = p.angle;
        let m = [0, 1, 2].map(|c| frames[0].n[c] * c0 + nu[c] * s0 + tau[c] * t0);
        Joint {
            off: [
                dot(&frames[1].n, &frames[0].n) - c0,
                dot(&frames[1].n, &nu) - s0,
                dot(&frames[1].n, &tau) - t0,
            ],
            frames,
            tau,
            nu,
            m,
            length,
        }
    }

    /// Of unit vectors `1 - m . n` is half of the square of their distance.
    fn energy(&self, p: &SeamPoint) -> D {
        dot(&self.off, &self.off) * (0.5 * p.stiffness[1])
    }

    fn beta(&self, p: &SeamPoint, side: usize, a: usize) -> V<D> {
        self.frames[side].beta(p.n_i[side][0][a], p.n_i[side][1][a])
    }

    /// Derivative of `m . n_B` by node `a` of a side.
    fn gradient(&self, p: &SeamPoint, side: usize, a: usize) -> V<D> {
        let beta = self.beta(p, side, a);
        let n = &self.frames[side].n;
        let [off_n, off_nu, off_tau] = self.off;
        let [psi, theta] = [dot(&self.nu, &beta), dot(&self.tau, &beta)];
        if side == 1 {
            // m . dn_B, and n_B . dn_B = 0.
            let by = off_n * dot(&self.frames[0].n, &beta) + off_nu * psi + off_tau * theta;
            return n.map(|n| n * by);
        }
        let [c0, s0, t0] = p.angle;
        // dtau = T (nu x nu + n x n) dx
        let along = self.length.recip() * p.n_t[a];
        let turned = (off_nu * t0 - off_tau * s0) * along;
        let lifted = -(off_nu * psi + off_tau * theta) * c0 + off_n * psi * s0 + off_n * along * t0;
        [0, 1, 2].map(|c| self.nu[c] * turned + n[c] * lifted)
    }
}

impl Joint<f64> {
    /// Adds the upper half of the tangent. With `phi = v . beta`, `psi = nu . beta`, `theta = tau . beta` and `T` the derivative of
    /// the shape function along the edge over its length, second variations are
    /// `v . D(dn) = phi_b n x beta_a + phi_a beta_b x n - (v . n) (beta_a . beta_b) n x n` and
    /// `v . D(dnu) = (v . tau) T_a [T_b (tau x nu + nu x tau) - psi_b n x n] - T_a T_b [(v . nu) nu x nu + (v . n) nu x n]
    /// - (v . n) [theta_a T_b n x nu + psi_b n x beta_a + psi_a beta_b x n] - psi_a phi_b n x n` and
    /// `v . D(dtau) = -T_a T_b [(v . nu) (tau x nu + nu x tau) + (v . n) (tau x n + n x tau) + (v . tau) (nu x nu + n x n)]`.
    fn add_tangent(&self, p: &SeamPoint, k: &mut [f64]) {
        let [shift, turn] = p.stiffness;
        let [c0, s0, t0] = p.angle;
        let [na, nb] = [Vec3::from(self.frames[0].n), Vec3::from(self.frames[1].n)];
        let (tau, nu, m) = (
            Vec3::from(self.tau),
            Vec3::from(self.nu),
            Vec3::from(self.m),
        );
        let beta: [[Vec3; NODES]; 2] =
            [0, 1].map(|side| std::array::from_fn(|a| Vec3::from(self.beta(p, side, a))));
        let t: [f64; NODES] = std::array::from_fn(|a| p.n_t[a] / self.length);
        let psi = beta[0].map(|b| nu.dot(&b));
        let theta = beta[0].map(|b| tau.dot(&b));
        let phi = beta[0].map(|b| nb.dot(&b));
        let phi_b = beta[1].map(|b| m.dot(&b));
        let [v_tau, v_nu, v_n] = [nb.dot(&tau), nb.dot(&nu), nb.dot(&na)];
        let [n_n, nu_nu, nu_n, n_nu] =
            [(na, na), (nu, nu), (nu, na), (na, nu)].map(|(u, v)| u * v.transpose());
        let turning = tau * nu.transpose() + nu * tau.transpose();
        let lifting = tau * na.transpose() + na * tau.transpose();
        let across = nu_nu + n_n;
        let mut put = |[row, column]: [usize; 2], block: nalgebra::Matrix3<f64>| {
            for c in 0..3 {
                let to = &mut k[(3 * column + c) * SEAM_DOFS + 3 * row..][..3];
                (0..3).for_each(|r| to[r] += block[(r, c)]);
            }
        };
        let plain = |row: [usize; 2], column: [usize; 2]| {
            let sign = if row[0] == column[0] { shift } else { -shift };
            nalgebra::Matrix3::identity() * (sign * p.n[row[0]][row[1]] * p.n[column[0]][column[1]])
        };
        for b in 0..NODES {
            for a in 0..=b {
                let (ba, bb) = (beta[0][a], beta[0][b]);
                let bent = na * ba.transpose() * phi[b] + bb * na.transpose() * phi[a]
                    - n_n * (v_n * ba.dot(&bb));
                let both = t[a] * t[b];
                let crossed = turning * (v_tau * both)
                    - n_n * (v_tau * t[a] * psi[b])
                    - nu_nu * (both * v_nu)
                    - nu_n * (both * v_n)
                    - n_nu * (v_n * theta[a] * t[b])
                    - (na * ba.transpose() * psi[b] + bb * na.transpose() * psi[a]) * v_n
                    - n_n * (psi[a] * phi[b]);
                let stretched = (turning * v_nu + lifting * v_n + across * v_tau) * both;
                put(
                    [a, b],
                    plain([0, a], [0, b]) - (bent * c0 + crossed * s0 - stretched * t0) * turn,
                );
                let (ba, bb) = (beta[1][a], beta[1][b]);
                let bent = nb * ba.transpose() * phi_b[b] + bb * nb.transpose() * phi_b[a]
                    - nb * nb.transpose() * (m.dot(&nb) * ba.dot(&bb));
                put([NODES + a, NODES + b], plain([1, a], [1, b]) - bent * turn);
            }
            let bb = beta[1][b];
            for a in 0..NODES {
                // -dm . Dn_B
                let mixed = na * (s0 * psi[a] * na.dot(&bb) - c0 * beta[0][a].dot(&bb))
                    - nu * (s0 * t[a] * tau.dot(&bb))
                    + across * bb * (t0 * t[a]);
                put(
                    [a, NODES + b],
                    plain([0, a], [1, b]) + mixed * nb.transpose() * turn,
                );
            }
        }
    }
}
