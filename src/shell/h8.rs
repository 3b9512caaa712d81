//! The elements of one body: what assembly calls.
mod felt;
mod flow;
mod linear;
mod pressed;
mod stresses;

use super::error::{ElementFault, FaultCause, ShellError};
use super::kinematics::{self, Fields, V};
use super::layered::unsymmetric;
use super::material::{Collapsed, Law, MaterialLaw, with_law};
use super::reference::Reference;
use super::{brick, layered, mean_dilatation, tangent};
use crate::mesh::{ElementKind, Mesh};
use crate::scene::Element;
use covact_geometry::Vec3;
use num_dual::Dual64;

/// Variants of the 8-node element, with 2 x 2 x 2 Gauss points unless said otherwise.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum Formulation {
    /// Solid-shell with assumed transverse shear and thickness strains and seven enhanced strains (33: t, rt, st;
    /// 11: r; 22: s; 12: r, s), after L. Vu-Quoc and X. G. Tan, CMAME 192 (2003).
    #[default]
    Eas7,
    /// Three enhanced strains, those of the thickness (33: t, rt, st): no in-plane enhancement, so stiff in in-plane
    /// bending and locking above nu = 0.45, but free of its instability in strong compression.
    Eas3,
    /// Assumed strains only; Poisson thickness locking makes it 1.22 times too stiff in bending at nu = 0.3.
    Eas0,
    /// [`Formulation::Eas7`] with a further enhanced strain, 33: t^2 - 1/3, and six points over the thickness, three in each
    /// half: what bending asks of laws with plastic flow.
    Layered,
    /// Displacement brick without assumed or enhanced strains.
    Displacement,
    /// [`Formulation::Displacement`] whose points share the mean change of volume of their element: no locking in rubber and in
    /// plastic flow.
    MeanDilatation,
}

impl Formulation {
    /// Number of enhanced strains.
    pub const fn modes(self) -> usize {
        match self {
            Formulation::Eas7 => 7,
            Formulation::Layered => layered::MODES,
            Formulation::Eas3 => 3,
            Formulation::Eas0 | Formulation::Displacement | Formulation::MeanDilatation => 0,
        }
    }

    /// Points at which the law is evaluated.
    pub const fn points(self) -> usize {
        match self {
            Formulation::Layered => layered::POINTS,
            _ => 8,
        }
    }

    /// The formulation of the same element with a law that does not flow.
    pub(super) const fn elastic(self) -> Formulation {
        match self {
            Formulation::Layered => Formulation::Eas7,
            other => other,
        }
    }

    /// Enhanced strains and the condensation cache of an element, whose law may have symmetric tangents.
    pub(super) const fn state_len(self, symmetric: bool) -> usize {
        match symmetric {
            true => tangent::state_len(self.modes()),
            false => unsymmetric::state_len(self.modes()),
        }
    }
}

impl Formulation {
    /// The formulation of a scene's element, whose law may have plastic flow; `None` for elements that do not have 8 nodes.
    pub const fn of(element: Element, flows: bool) -> Option<Formulation> {
        match element {
            Element::H8 if flows => Some(Formulation::Layered),
            Element::H8 => Some(Formulation::Eas7),
            Element::H8Eas3 => Some(Formulation::Eas3),
            Element::H8Displacement => Some(Formulation::Displacement),
            Element::H8MeanDilatation => Some(Formulation::MeanDilatation),
            Element::Q18 | Element::Nurbs => None,
        }
    }
}

/// Forces and tangent of one element, dofs numbered `3 node + axis`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct H8System {
    /// Internal forces, condensed: `f - L^T D^-1 h`.
    pub f: [f64; 24],
    /// Tangent `K - L^T D^-1 L`, full, by columns; exactly symmetric if the law is.
    pub k: [f64; 576],
    /// Strain energy.
    pub energy: f64,
    /// Negative pivots in the stiffness D of the enhanced strains: above zero the element is unstable by itself
    /// (P. Wriggers and S. Reese, CMAME 135 (1996)).
    pub negative_pivots: u8,
}

impl Default for H8System {
    fn default() -> H8System {
        H8System {
            f: [0.0; 24],
            k: [0.0; 576],
            energy: 0.0,
            negative_pivots: 0,
        }
    }
}

/// All elements of a body, with one formulation and one law.
///
/// Displacements are passed rather than current positions, because strains taken from them keep their digits where
/// displacements are small. The caller owns the state, [`H8Block::state_len`] numbers per element (zeros at first):
/// the enhanced strains `alpha` come first, then the condensation cache h, L and the factors of D. Only alpha belongs
/// to the history of a load step; copying the whole slice is right too.
#[derive(Debug, Clone)]
pub struct H8Block {
    formulation: Formulation,
    law: Law,
    nodes: Vec<[u32; 8]>,
    reference: Vec<Reference>,
    /// Whether no node lies inside the thickness, and something may press on both faces.
    pressed: bool,
}

impl H8Block {
    /// Bytes of an element here.
    pub(super) const BYTES: usize = size_of::<Reference>() + size_of::<[u32; 8]>();

    /// Sets up the elements of a mesh.
    ///
    /// # Errors
    /// Elements that refer to missing nodes, inverted elements (Jacobian not positive at a Gauss point or the centre),
    /// three enhanced strains with nu above 0.45, and assumed strains at two points over the thickness with laws whose tangent is
    /// not symmetric.
    pub fn new(mesh: &Mesh, formulation: Formulation, law: Law) -> Result<H8Block, ShellError> {
        if mesh.kind != ElementKind::H8 {
            return Err(ShellError::Kind {
                wanted: "H8",
                found: format!("{:?}", mesh.kind),
            });
        }
        if formulation == Formulation::Eas3 && law.nu() > 0.45 {
            return Err(ShellError::TooFewEnhanced { nu: law.nu() });
        }
        let halved = matches!(
            formulation,
            Formulation::Eas7 | Formulation::Eas3 | Formulation::Eas0
        );
        if halved && !law.symmetric() {
            return Err(ShellError::Unsymmetric);
        }
        let (chunks, rest) = mesh.connectivity.as_chunks::<8>();
        if !rest.is_empty() {
            return Err(ShellError::Connectivity {
                entries: mesh.connectivity.len(),
                nodes: 8,
            });
        }
        let mut reference = Vec::with_capacity(chunks.len());
        let mut inverted = None;
        let mut count = 0;
        for (element, nodes) in chunks.iter().enumerate() {
            let mut x = [[0.0; 3]; 8];
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
            let (re, jacobian) = Reference::new(x);
            // Written so that NaN counts as inverted.
            if jacobian > 0.0 {
                reference.push(re);
            } else {
                count += 1;
                inverted.get_or_insert((element as u32, jacobian));
            }
        }
        if let (Law::Hill48(sheet), None) = (&law, inverted) {
            let across = |re: &Reference| !sheet.lies_in(&Fields::new(&re.nodes).centre());
            if let Some(element) = reference.iter().position(across) {
                let element = element as u32;
                return Err(ShellError::Rolling { element });
            }
        }
        match inverted {
            Some((element, jacobian)) => Err(ShellError::Inverted {
                element,
                jacobian,
                count,
            }),
            None => Ok(H8Block {
                formulation,
                law,
                nodes: chunks.to_vec(),
                reference,
                pressed: !mesh.opposite_nodes().contains(&None),
            }),
        }
    }

    /// Number of elements.
    pub fn elements(&self) -> usize {
        self.nodes.len()
    }

    /// Nodes of element `e`.
    pub fn nodes_of(&self, e: usize) -> [u32; 8] {
        self.nodes[e]
    }

    /// The formulation.
    pub fn formulation(&self) -> Formulation {
        self.formulation
    }

    /// The law.
    pub fn law(&self) -> Law {
        self.law
    }

    /// Numbers of state per element: 210 for seven enhanced strains and none without, then those of [`Self::history_len`].
    pub fn state_len(&self) -> usize {
        self.condensation_len() + self.history_len()
    }

    /// Enhanced strains and the condensation cache.
    fn condensation_len(&self) -> usize {
        self.formulation.state_len(self.law.symmetric())
    }

    /// Numbers of enhanced strains per element, at the start of its state.
    pub const fn alpha_len(&self) -> usize {
        self.formulation.modes()
    }

    /// Undeformed volume of element `e`.
    pub fn volume(&self, e: usize) -> f64 {
        self.reference[e].volume.iter().sum()
    }

    /// Elements whose edges along t are longer than those along r or s (in the mean): a mesh of a thin shell with such
    /// elements has its thickness along the wrong direction.
    pub fn longest_along_t(&self) -> Vec<u32> {
        let length = |v: &V<f64>| kinematics::dot(v, v);
        let long = |re: &Reference| {
            let [r, s, t] = Fields::new(&re.nodes).centre();
            length(&t) > length(&r).min(length(&s))
        };
        (0..self.elements())
            .filter(|&e| long(&self.reference[e]))
            .map(|e| e as u32)
            .collect()
    }

    /// Condensed forces and tangent of element `e` at nodal displacements `u`. Reads alpha in `state` and writes the
    /// condensation cache there.
    ///
    /// # Errors
    /// [`ElementFault`] where the strain is impossible or D cannot be factorised; `out` and the cache are then
    /// meaningless, alpha is untouched.
    pub fn evaluate(
        &self,
        e: usize,
        u: &[Vec3; 8],
        state: &mut [f64],
        out: &mut H8System,
    ) -> Result<(), ElementFault> {
        self.evaluate_mixed(e, u, None, state, out)
    }

    /// [`H8Block::evaluate`] at an iterate that `correction` led to, for mixed integration points: the stresses of the geometric
    /// part of the tangent are continued along it (D. Magisano, L. Leonetti and G. Garcea, CMAME 313 (2017)), so that one which
    /// rotates a thin shell does not spoil the next. Forces, and the tangent where the correction has become small, are the
    /// same. Plain bricks and elements whose laws flow have the true tangent.
    ///
    /// # Errors
    /// As [`H8Block::evaluate`].
    pub fn evaluate_mixed(
        &self,
        e: usize,
        u: &[Vec3; 8],
        correction: Option<&[Vec3; 8]>,
        state: &mut [f64],
        out: &mut H8System,
    ) -> Result<(), ElementFault> {
        let u = arrays(u);
        let du = correction.map(arrays);
        let (du, shares) = (du.as_ref(), self.shares(state));
        let re = &self.reference[e];
        with_law!(&self.law, law => match self.formulation {
            Formulation::Eas7 => tangent::evaluate::<_, 7>(law, re, &u, (du, shares), state, out),
            Formulation::Layered if !law.symmetric() => {
                unsymmetric::evaluate(law, &re.nodes, &u, state, out)
            }
            Formulation::Layered => layered::evaluate(law, &re.nodes, &u, state, out),
            Formulation::Eas3 => tangent::evaluate::<_, 3>(law, re, &u, (du, shares), state, out),
            Formulation::Eas0 => tangent::evaluate::<_, 0>(law, re, &u, (du, shares), state, out),
            Formulation::Displacement => brick::evaluate(law, re, &u, state, out),
            Formulation::MeanDilatation => mean_dilatation::evaluate(law, re, &u, state, out),
        })
        .map_err(|cause| ElementFault {
            element: e as u32,
            cause,
        })
    }

    /// Forces and tangent of the plain brick in the place of element `e`.
    ///
    /// # Errors
    /// [`ElementFault`] where the strain is impossible.
    pub(super) fn evaluate_plain(
        &self,
        e: usize,
        u: &[Vec3; 8],
        state: &[f64],
        out: &mut H8System,
    ) -> Result<(), ElementFault> {
        let (u, re) = (arrays(u), &self.reference[e]);
        let states = &state[self.condensation_len()..];
        with_law!(&self.law, law => brick::evaluate(law, re, &u, states, out)).map_err(|cause| {
            ElementFault {
                element: e as u32,
                cause,
            }
        })
    }

    /// Corners of element `e` at nodal displacements `u`.
    pub(super) fn corners(&self, e: usize, u: &[Vec3; 8]) -> [Vec3; 8] {
        let nodes = &self.reference[e].nodes;
        std::array::from_fn(|a| Vec3::from(nodes[a]) + u[a])
    }

    /// Forces without tangent, for line searches: `f - L^T D^-1 h` with f and h at `u` and the alpha in `state`, but L
    /// and D of the last [`H8Block::evaluate`]. At those displacements it repeats that call's forces; elsewhere it is
    /// the residual that the same Newton matrix would act on. Returns the strain energy at (u, alpha).
    ///
    /// # Errors
    /// [`ElementFault`] where the strain is impossible.
    pub fn residual(
        &self,
        e: usize,
        u: &[Vec3; 8],
        state: &[f64],
        f: &mut [f64; 24],
    ) -> Result<f64, ElementFault> {
        let u = arrays(u);
        let (re, shares) = (&self.reference[e], self.shares(state));
        with_law!(&self.law, law => match self.formulation {
            Formulation::Eas7 => residual::<_, 7>(law, re, &u, (state, shares), f),
            Formulation::Layered => {
                let states = &state[self.condensation_len()..];
                layered::forces(law, &re.nodes, &u, &head(state), states)
                    .map(|(energy, forces, h)| match law.symmetric() {
                        true => condensed(energy, (forces, h), state, f),
                        false => {
                            *f = unsymmetric::condensed(forces, &h, state);
                            energy
                        }
                    })
            }
            Formulation::Eas3 => residual::<_, 3>(law, re, &u, (state, shares), f),
            Formulation::Eas0 => residual::<_, 0>(law, re, &u, (state, shares), f),
            Formulation::Displacement => brick::forces(law, re, &u, state).map(|all| kept(all, f)),
            Formulation::MeanDilatation => {
                mean_dilatation::forces(law, re, &u, state).map(|all| kept(all, f))
            }
        })
        .map_err(|(point, c)| fault(e, point, c))
    }

    /// `alpha = alpha_from - scale D^-1 (h + L du)`, with D, h, L of the evaluation that produced `du`.
    pub fn update_alpha(&self, state: &mut [f64], du: &[Vec3; 8], scale: f64, alpha_from: &[f64]) {
        if self.formulation == Formulation::Layered && !self.law.symmetric() {
            return unsymmetric::update_alpha(state, du, scale, alpha_from);
        }
        let ne = self.formulation.modes();
        let mut step = [0.0; layered::MODES];
        for m in 0..ne {
            let row = &state[2 * ne + 24 * m..][..24];
            step[m] = state[ne + m];
            for (l, d) in row.chunks_exact(3).zip(du) {
                step[m] += l[0] * d.x + l[1] * d.y + l[2] * d.z;
            }
        }
        solve(&state[tangent::factors(ne)..], &mut step[..ne]);
        for m in 0..ne {
            state[m] = alpha_from[m] - scale * step[m];
        }
    }
}

/// Keeps forces, and returns the energy.
fn kept((energy, forces): (f64, [f64; 24]), f: &mut [f64; 24]) -> f64 {
    *f = forces;
    energy
}

/// The fault of a Gauss point.
fn fault(e: usize, point: u8, c: Collapsed) -> ElementFault {
    ElementFault {
        element: e as u32,
        cause: FaultCause::Collapsed {
            point,
            ratio: c.ratio,
        },
    }
}

fn arrays(u: &[Vec3; 8]) -> [V<f64>; 8] {
    u.map(|u| u.data.0[0])
}

fn head<const NE: usize>(state: &[f64]) -> [f64; NE] {
    let mut alpha = [0.0; NE];
    alpha.copy_from_slice(&state[..NE]);
    alpha
}

fn dual_head<const NE: usize>(state: &[f64]) -> [Dual64; NE] {
    head::<NE>(state).map(|a| Dual64::new(0.0, a))
}

fn residual<L: MaterialLaw, const NE: usize>(
    law: &L,
    re: &Reference,
    u: &[V<f64>; 8],
    (state, shares): (&[f64], [f64; 2]),
    f: &mut [f64; 24],
) -> Result<f64, (u8, Collapsed)> {
    let (energy, forces, h) = kinematics::forces(
        law,
        re,
        u,
        &head::<NE>(state),
        (&state[tangent::state_len(NE)..], shares),
    )?;
    Ok(condensed(energy, (forces, h), state, f))
}

/// Condenses forces on enhanced strains with what the last evaluation left in the state; passes the energy on.
fn condensed<const NE: usize>(
    energy: f64,
    (forces, mut h): ([f64; 24], [f64; NE]),
    state: &[f64],
    f: &mut [f64; 24],
) -> f64 {
    *f = forces;
    if NE > 0 {
        solve(&state[tangent::factors(NE)..], &mut h);
        for (m, h) in h.iter().enumerate() {
            for (f, l) in f.iter_mut().zip(&state[2 * NE + 24 * m..]) {
                *f -= l * h;
            }
        }
    }
    energy
}

/// Solves with packed factors unit lower, diagonal.
pub(super) fn solve(packed: &[f64], x: &mut [f64]) {
    let n = x.len();
    let row = |m: usize| &packed[m * (m + 1) / 2..][..=m];
    for m in 0..n {
        for k in 0..m {
            x[m] -= row(m)[k] * x[k];
        }
    }
    for m in 0..n {
        x[m] /= row(m)[m];
    }
    for m in (0..n).rev() {
        for k in m + 1..n {
            x[m] -= row(k)[m] * x[k];
        }
    }
}
