//! The quadratic solid-shell Q18: biquadratic in the plane, linear through the thickness, 3 x 3 x 2 Gauss points.
//!
//! In the spirit of R. Hauptmann, S. Doll, M. Harnau, K. Schweizerhof, Computers & Structures 79 (2001): assumed membrane,
//! shear and thickness strains, four enhanced thickness strains; in addition the mean and first moment of the in-plane
//! strain are kept (so that patch tests are passed on any straight-sided mesh) and the volume strain is projected (so that
//! nearly incompressible material does not lock); see `strain`.
mod reference;
mod strain;
mod tables;
mod tangent;
#[cfg(test)]
mod tests;

use super::error::{ElementFault, FaultCause, ShellError};
use super::history::{PlasticWork, Remembered, advance, cauchy, measures, plastic_work, start};
use super::kinematics::V;
use super::material::{Collapsed, Law, with_law};
use super::stress;
use crate::mesh::{ElementKind, Mesh};
use covact_geometry::Vec3;
use num_dual::Dual64;
use reference::{MODES, Reference, split};
use tables::{POINTS, TABLES};

/// Unknowns of an element.
pub const DOFS: usize = 54;

/// Forces and tangent of one element, dofs numbered `3 node + axis`, nodes `i + 3 j + 9 k`.
#[derive(Debug, Clone, PartialEq)]
pub struct Q18System {
    /// Internal forces, condensed: `f - L^T D^-1 h`.
    pub f: [f64; DOFS],
    /// Tangent `K - L^T D^-1 L`, full and exactly symmetric, by columns.
    pub k: Box<[f64; DOFS * DOFS]>,
    /// Strain energy.
    pub energy: f64,
    /// Negative pivots in the stiffness D of the enhanced strains.
    pub negative_pivots: u8,
    work: Box<tangent::Work>,
}

impl Default for Q18System {
    fn default() -> Q18System {
        Q18System {
            f: [0.0; DOFS],
            k: Box::new([0.0; DOFS * DOFS]),
            energy: 0.0,
            negative_pivots: 0,
            work: Box::new(tangent::Work::new()),
        }
    }
}

/// All elements of a body, with one law. Used as [`H8Block`](super::H8Block) is; the state of an element holds
/// [`Q18Block::STATE_LEN`] numbers, the enhanced strains first.
#[derive(Debug, Clone)]
pub struct Q18Block {
    law: Law,
    nodes: Vec<[u32; 18]>,
    reference: Vec<Reference>,
}

impl Q18Block {
    /// Bytes of an element here.
    pub(super) const BYTES: usize = size_of::<Reference>() + size_of::<[u32; 18]>();
    /// Numbers of state per element of an elastic law.
    pub const STATE_LEN: usize = tangent::STATE;
    /// Numbers of enhanced strains per element, at the start of its state.
    pub const ALPHA_LEN: usize = MODES;

    /// Sets up the elements of a mesh.
    ///
    /// # Errors
    /// Elements that refer to missing nodes, inverted elements (Jacobian not positive at a Gauss point or the centre), and laws whose
    /// tangent is not symmetric.
    pub fn new(mesh: &Mesh, law: Law) -> Result<Q18Block, ShellError> {
        if mesh.kind != ElementKind::Q18 {
            return Err(ShellError::Kind {
                wanted: "Q18",
                found: format!("{:?}", mesh.kind),
            });
        }
        if !law.symmetric() {
            return Err(ShellError::Unsymmetric);
        }
        let (chunks, rest) = mesh.connectivity.as_chunks::<18>();
        if !rest.is_empty() {
            return Err(ShellError::Connectivity {
                entries: mesh.connectivity.len(),
                nodes: 18,
            });
        }
        let mut reference = Vec::with_capacity(chunks.len());
        let mut inverted = None;
        let mut count = 0;
        for (element, nodes) in chunks.iter().enumerate() {
            let mut x = [[0.0; 3]; 18];
            for (x, &node) in x.iter_mut().zip(nodes) {
                *x = mesh
                    .nodes
                    .get(node as usize)
                    .ok_or(ShellError::Node {
                        element: element as u32,
                        node,
                        nodes: mesh.nodes.len(),
                    })?
                    .data
                    .0[0];
            }
            let (re, jacobian) = Reference::new(&x);
            // Written so that NaN counts as inverted.
            if jacobian > 0.0 {
                reference.push(re);
            } else {
                count += 1;
                inverted.get_or_insert((element as u32, jacobian));
            }
        }
        match inverted {
            Some((element, jacobian)) => Err(ShellError::Inverted {
                element,
                jacobian,
                count,
            }),
            None => Ok(Q18Block {
                law,
                nodes: chunks.to_vec(),
                reference,
            }),
        }
    }

    /// Number of elements.
    pub fn elements(&self) -> usize {
        self.nodes.len()
    }

    /// Nodes of element `e`.
    pub fn nodes_of(&self, e: usize) -> [u32; 18] {
        self.nodes[e]
    }

    /// The law.
    pub fn law(&self) -> Law {
        self.law
    }

    /// Numbers of state per element: [`Q18Block::STATE_LEN`], then those of the law.
    pub fn state_len(&self) -> usize {
        Self::STATE_LEN + self.history_len()
    }

    /// Numbers that the law remembers per element, at the end of its state.
    pub fn history_len(&self) -> usize {
        POINTS * self.law.state_len()
    }

    /// Undeformed volume of element `e`.
    pub fn volume(&self, e: usize) -> f64 {
        self.reference[e].volume.iter().sum()
    }

    /// Condensed forces and tangent of element `e` at nodal displacements `u`; see
    /// [`H8Block::evaluate`](super::H8Block::evaluate).
    ///
    /// # Errors
    /// [`ElementFault`] where the strain is impossible or D cannot be factorised; `out` and the cache are then
    /// meaningless, alpha is untouched.
    pub fn evaluate(
        &self,
        e: usize,
        u: &[Vec3; 18],
        state: &mut [f64],
        out: &mut Q18System,
    ) -> Result<(), ElementFault> {
        self.evaluate_mixed(e, u, None, state, out)
    }

    /// [`Q18Block::evaluate`] for mixed integration points; see [`H8Block::evaluate_mixed`](super::H8Block::evaluate_mixed).
    ///
    /// # Errors
    /// As [`Q18Block::evaluate`].
    pub fn evaluate_mixed(
        &self,
        e: usize,
        u: &[Vec3; 18],
        correction: Option<&[Vec3; 18]>,
        state: &mut [f64],
        out: &mut Q18System,
    ) -> Result<(), ElementFault> {
        let (u, re) = (arrays(u), &self.reference[e]);
        let du = correction.map(arrays);
        with_law!(&self.law, law => tangent::evaluate(law, re, &u, du.as_ref(), state, out))
            .map_err(|cause| ElementFault {
                element: e as u32,
                cause,
            })
    }

    /// Forces without tangent, with L and D of the last [`Q18Block::evaluate`]; returns the strain energy. See
    /// [`H8Block::residual`](super::H8Block::residual).
    ///
    /// # Errors
    /// [`ElementFault`] where the strain is impossible.
    pub fn residual(
        &self,
        e: usize,
        u: &[Vec3; 18],
        state: &[f64],
        f: &mut [f64; DOFS],
    ) -> Result<f64, ElementFault> {
        let (u, re) = (arrays(u), &self.reference[e]);
        let (energy, forces, mut h) = with_law!(&self.law, law =>
            strain::forces(law, re, &split(&u), &head(state), &state[tangent::STATE..]))
        .map_err(|(point, c)| fault(e, point, c))?;
        for node in 0..18 {
            let sign = if node < 9 { -1.0 } else { 1.0 };
            for x in 0..3 {
                f[3 * node + x] = 0.5 * (forces[node % 9][x] + sign * forces[node % 9 + 9][x]);
            }
        }
        super::h8::solve(&state[tangent::FACTORS..], &mut h);
        for (m, h) in h.iter().enumerate() {
            for (f, l) in f.iter_mut().zip(&state[tangent::ROWS + DOFS * m..]) {
                *f -= l * h;
            }
        }
        Ok(energy)
    }

    /// `alpha = alpha_from - scale D^-1 (h + L du)`, with D, h, L of the evaluation that produced `du`.
    pub fn update_alpha(&self, state: &mut [f64], du: &[Vec3; 18], scale: f64, alpha_from: &[f64]) {
        let mut step = [0.0; MODES];
        for m in 0..MODES {
            let row = &state[tangent::ROWS + DOFS * m..][..DOFS];
            step[m] = state[MODES + m];
            for (l, d) in row.chunks_exact(3).zip(du) {
                step[m] += l[0] * d.x + l[1] * d.y + l[2] * d.z;
            }
        }
        super::h8::solve(&state[tangent::FACTORS..], &mut step);
        for m in 0..MODES {
            state[m] = alpha_from[m] - scale * step[m];
        }
    }

    /// Cauchy stress (xx, yy, zz, xy, yz, xz) at the Gauss points `i + 3 j + 9 k`, consistent with the assumed and
    /// enhanced strain; see [`H8Block::stresses`](super::H8Block::stresses).
    ///
    /// # Errors
    /// [`ElementFault`] where the strain is impossible.
    pub fn stresses(
        &self,
        e: usize,
        u: &[Vec3; 18],
        state: &[f64],
        out: &mut [[f64; 6]; POINTS],
    ) -> Result<(), ElementFault> {
        let (u, re) = (arrays(u), &self.reference[e]);
        let du = split(&u);
        let strain = strain::strains(re, &du, &head(state));
        for (g, point) in TABLES.points.iter().enumerate() {
            let big = point.n.map(|n| strain::along(&n, &re.y));
            let moved = point.n.map(|n| strain::along(&n, &du));
            out[g] = with_law!(&self.law, law =>
                cauchy(law, (&re.metric[g], g), &big, &moved, &strain[g], &state[tangent::STATE..]))
            .map_err(|c| fault(e, g as u8, c))?;
        }
        Ok(())
    }

    /// Sets the states of the law to those of an element that nothing has happened to.
    pub fn start(&self, e: usize, state: &mut [f64]) {
        let y = &self.reference[e].y;
        let states = &mut state[tangent::STATE..];
        let frame = |g: usize| TABLES.points[g].n.map(|n| strain::along(&n, y));
        with_law!(&self.law, law => start(law, states, frame));
    }

    /// Takes an accepted step into the states of the law; see [`H8Block::remember`](super::H8Block::remember).
    ///
    /// # Errors
    /// [`ElementFault`] where the strain is impossible.
    pub fn remember(
        &self,
        e: usize,
        u: &[Vec3; 18],
        state: &mut [f64],
    ) -> Result<Remembered, ElementFault> {
        let (u, re) = (arrays(u), &self.reference[e]);
        let strain = strain::strains(re, &split(&u), &head(state));
        let states = &mut state[tangent::STATE..];
        let at = |g: usize| (re.metric[g], strain[g]);
        let flow = with_law!(&self.law, law => advance(law, at, re.volume.into_iter(), states))
            .map_err(|(point, c)| fault(e, point, c))?;
        Ok(Remembered { flow, energy: 0.0 })
    }

    /// Equivalent plastic strain, and equivalent stress over yield stress, at the nodes.
    pub fn flow_measures(&self, e: usize, state: &[f64]) -> [[f64; 2]; 18] {
        let (re, states) = (&self.reference[e], &state[tangent::STATE..]);
        with_law!(&self.law, law => stress::extrapolate_quadratic(
            &std::array::from_fn(|g| measures(law, &re.metric[g], g, states))
        ))
    }

    /// What the law has done with the work on the points of an element, times their volumes.
    pub fn plastic_work(&self, e: usize, state: &[f64]) -> PlasticWork {
        let (volumes, states) = (self.reference[e].volume, &state[tangent::STATE..]);
        with_law!(&self.law, law => plastic_work(law, volumes.into_iter(), states))
    }

    /// Stress of the linear element (xx, yy, zz, xy, yz, xz) at the Gauss points `i + 3 j + 9 k`; see
    /// [`H8Block::linear_stresses`](super::H8Block::linear_stresses).
    ///
    /// # Errors
    /// [`ElementFault`] where the law has no stiffness.
    pub fn linear_stresses(
        &self,
        e: usize,
        u: &[Vec3; 18],
        alpha: &[f64],
        out: &mut [[f64; 6]; POINTS],
    ) -> Result<(), ElementFault> {
        let re = &self.reference[e];
        let alpha = head(alpha).map(|a| Dual64::new(0.0, a));
        let strain = strain::strains(re, &stress::from_zero(&split(&arrays(u))), &alpha);
        for (g, point) in TABLES.points.iter().enumerate() {
            let big = point.n.map(|n| strain::along(&n, &re.y));
            out[g] =
                with_law!(&self.law, law => stress::linear(law, &re.metric[g], &big, &strain[g]))
                    .map_err(|c| fault(e, g as u8, c))?;
        }
        Ok(())
    }
}

fn fault(e: usize, point: u8, c: Collapsed) -> ElementFault {
    ElementFault {
        element: e as u32,
        cause: FaultCause::Collapsed {
            point,
            ratio: c.ratio,
        },
    }
}

fn arrays(u: &[Vec3; 18]) -> [V<f64>; 18] {
    u.map(|u| u.data.0[0])
}

fn head(state: &[f64]) -> [f64; MODES] {
    let mut alpha = [0.0; MODES];
    alpha.copy_from_slice(&state[..MODES]);
    alpha
}
