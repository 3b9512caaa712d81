//! Borders of a sheet where its normal is held: clamped, or in a plane of symmetry. The condition is an energy per undeformed
//! length, so that it needs no rotation and no particular control net.
//!
//! A clamped normal stays along its own direction `N`: `alpha (1 - N . n)`, which is `2 alpha sin^2` of half the angle between them.
//! In a plane of symmetry with normal `e` it stays in the plane: `alpha (n . e)^2 / 2`.
use super::super::kinematics::{V, dot};
use super::frame::{DOFS, NODES, Normal, combine};
use super::point::BorderPoint;
use super::{NurbsBlock, ShellError};
use crate::mesh::nurbs::Border;
use covact_geometry::Vec3;
use num_dual::DualNum;

/// How stiff a held normal is, in bending stiffnesses over the length of an element: the sheet turns at its edge by one part in
/// so many of what the moment turns an element.
const STIFF: f64 = 1e4;

/// Points along a span.
const POINTS: usize = 4;

/// Points along a piece of a curve of a trim within an element, where full rules would lock.
const TRIMMED: usize = 2;

/// What the normal of an edge is held to.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum HeldNormal {
    /// Its undeformed direction.
    Clamped,
    /// The plane with this unit normal.
    InPlane(Vec3),
}

impl NurbsBlock {
    /// Holds the normal along some borders.
    ///
    /// # Errors
    /// A border where the surface has no normal.
    pub fn hold(&mut self, borders: &[(Border, HeldNormal)]) -> Result<(), ShellError> {
        let mut all: Vec<(usize, BorderPoint)> = Vec::new();
        for (border, to) in borders {
            self.hold_border(*border, *to, &mut all)?;
        }
        all.sort_by_key(|(e, _)| *e);
        self.starts = match all.is_empty() {
            true => Vec::new(),
            false => (0..=self.elements())
                .map(|e| all.partition_point(|(of, _)| *of < e) as u32)
                .collect(),
        };
        self.borders = all.into_iter().map(|(_, point)| point).collect();
        Ok(())
    }

    /// Axes about which held normals keep the sheet from turning.
    pub fn held_turns(&self) -> impl Iterator<Item = Vec3> + '_ {
        let elements = 0..self.elements();
        elements.flat_map(move |e| {
            self.held(e).iter().flat_map(move |held| {
                let x = &self.reference[e];
                let frame = Normal::new(held.n.each_ref().map(|n| combine(n, x)));
                let [r1, r2] = frame.r.map(|r| Vec3::from(r).normalize());
                let across = Vec3::from(frame.n).cross(&Vec3::from(held.toward));
                match held.along {
                    true => [r1, r2],
                    false => [across, Vec3::zeros()],
                }
            })
        })
    }

    fn hold_border(
        &self,
        border: Border,
        to: HeldNormal,
        out: &mut Vec<(usize, BorderPoint)>,
    ) -> Result<(), ShellError> {
        let bending = self.bending();
        let count = match border {
            Border::Edge(_) => POINTS,
            Border::Trim(_) => TRIMMED,
        };
        for p in self.sheet.border_points(border, count).iter().flatten() {
            let e = p.element;
            let x = &self.reference[e];
            let frame = Normal::new(p.at.n_i.each_ref().map(|n| combine(n, x)));
            let stiffness = STIFF * bending / p.width * p.length;
            if !(stiffness > 0.0 && stiffness.is_finite()) {
                return Err(ShellError::NoNormal { element: e as u32 });
            }
            let (toward, along) = match to {
                HeldNormal::Clamped => (frame.n, true),
                HeldNormal::InPlane(e) => (e.into(), false),
            };
            out.push((
                e,
                BorderPoint {
                    n: p.at.n_i,
                    toward,
                    along,
                    rest: dot(&frame.n, &toward),
                    stiffness,
                },
            ));
        }
        Ok(())
    }
}

/// The normal at a point, and `beta_a . toward` of every node.
struct Tilt<D> {
    frame: Normal<D>,
    /// `n . toward`.
    along: D,
    /// Square of the distance between the ends of both.
    apart: D,
    phi: [D; NODES],
}

impl<D: DualNum<f64> + Copy> Tilt<D> {
    #[inline(always)]
    fn new(held: &BorderPoint, x: &[V<D>; NODES]) -> Self {
        let frame = Normal::new(held.n.each_ref().map(|n| combine(n, x)));
        let toward = held.toward.map(D::from);
        // Dual tangents see no normal: without it there is not even round-off at rest, where nothing else has forces either.
        let off = match held.along {
            true => [0, 1, 2].map(|c| toward[c] - frame.n[c]),
            false => toward,
        };
        let up = frame.up.map(|up| dot(&up, &off));
        Tilt {
            along: dot(&frame.n, &toward),
            apart: dot(&off, &off),
            phi: std::array::from_fn(|a| up[0] * held.n[0][a] + up[1] * held.n[1][a]),
            frame,
        }
    }

    /// Energy, and its derivative by `n . toward`.
    #[inline(always)]
    fn energy(&self, held: &BorderPoint) -> (D, D) {
        match held.along {
            // Of unit vectors `1 - N . n` is half of the square of their distance.
            true => (
                self.apart * (0.5 * held.stiffness),
                D::from(-held.stiffness),
            ),
            false => {
                let tilt = self.along - held.rest;
                (tilt * tilt * (0.5 * held.stiffness), tilt * held.stiffness)
            }
        }
    }
}

/// Adds the forces of a point; returns its energy. `d(n . v) = -sum_a phi_a n . dx_a`.
#[inline]
pub(super) fn forces<D: DualNum<f64> + Copy>(
    held: &BorderPoint,
    x: &[V<D>; NODES],
    f: &mut [V<D>; NODES],
) -> D {
    let tilt = Tilt::new(held, x);
    let (energy, by) = tilt.energy(held);
    for (f, phi) in f.iter_mut().zip(tilt.phi) {
        (0..3).for_each(|c| f[c] -= by * phi * tilt.frame.n[c]);
    }
    energy
}

/// Adds forces and the upper half of the tangent, by columns; returns the energy. The second derivative of `n . v` is
/// `phi_b n x beta_a + phi_a beta_b x n - (n . v) (beta_a . beta_b) n x n`.
pub(super) fn linearize(
    held: &BorderPoint,
    x: &[V<f64>; NODES],
    f: &mut [f64; DOFS],
    k: &mut [f64],
) -> f64 {
    let tilt = Tilt::new(held, x);
    let (energy, by) = tilt.energy(held);
    let curved = if held.along { 0.0 } else { held.stiffness };
    let (n, phi) = (&tilt.frame.n, &tilt.phi);
    let beta: [V<f64>; NODES] =
        std::array::from_fn(|a| tilt.frame.beta(held.n[0][a], held.n[1][a]));
    for a in 0..NODES {
        (0..3).for_each(|c| f[3 * a + c] -= by * phi[a] * n[c]);
    }
    for b in 0..NODES {
        for a in 0..=b {
            let both = curved * phi[a] * phi[b] - by * tilt.along * dot(&beta[a], &beta[b]);
            for j in 0..3 {
                let along_n = by * phi[b] * beta[a][j] + both * n[j];
                let along_b = by * phi[a] * n[j];
                let column = &mut k[(3 * b + j) * DOFS + 3 * a..][..3];
                (0..3).for_each(|i| column[i] += along_b * beta[b][i] + along_n * n[i]);
            }
        }
    }
    energy
}
