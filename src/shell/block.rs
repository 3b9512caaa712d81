//! The elements of a body, whatever their shape: one trait for the loops, one enum for the body.
use super::error::{ElementFault, ShellError};
use super::h8::{Formulation, H8Block, H8System};
use super::history::{PlasticWork, Remembered};
use super::material::{DashpotState, Law, LawState, Memory};
use super::nurbs::{self, NurbsBlock, NurbsSystem};
use super::q18::{DOFS, Q18Block, Q18System};
use super::stress::{extrapolate, extrapolate_quadratic};
use crate::mesh::Mesh;
use crate::scene::Element;
use covact_geometry::Vec3;

/// States of a run that are held at the same time: committed, trial, the one before, and those of Newton's method and of
/// the attempts at a step.
pub const STATES: usize = 5;

/// Bytes that an element of this kind takes: what is worked out once about its shape, and its states in a run.
pub const fn bytes_per_element(element: Element, memory: Memory) -> [usize; 2] {
    let (shape, state) = match Formulation::of(element, memory.flows()) {
        None if matches!(element, Element::Nurbs) => return [NurbsBlock::BYTES, 0],
        Some(formulation) => (H8Block::BYTES, formulation.numbers(memory)),
        None => (Q18Block::BYTES, Q18Block::STATE_LEN + 18 * memory.numbers),
    };
    [shape, STATES * 8 * state]
}

/// What a loop over the elements of a body needs: elements of `N` nodes, 3 dofs each, numbered `3 node + axis`. Loops are
/// generic over it, so that the shape is chosen once per body.
pub trait ElementBlock<const N: usize>: Sync {
    /// Forces and tangent of one element.
    type System: ElementSystem;
    /// Forces alone.
    type Forces: AsRef<[f64]> + Copy;
    /// Forces to begin with.
    const NO_FORCES: Self::Forces;

    /// Number of elements.
    fn elements(&self) -> usize;
    /// Nodes of element `e` in the body's mesh.
    fn nodes_of(&self, e: usize) -> [u32; N];
    /// Numbers of state per element.
    fn state_len(&self) -> usize;
    /// Numbers of enhanced strains per element, at the start of its state.
    fn alpha_len(&self) -> usize;
    /// Numbers that an element remembers of accepted steps, at the end of its state.
    fn history_len(&self) -> usize;
    /// Sets the states of the law to those of an element that nothing has happened to; see [`H8Block::start`].
    fn start(&self, _e: usize, _state: &mut [f64]) {}
    /// Takes an accepted step into what elements remember; see [`H8Block::remember`].
    fn remember(
        &self,
        e: usize,
        u: &[Vec3; N],
        state: &mut [f64],
    ) -> Result<Remembered, ElementFault>;
    /// Equivalent plastic strain, and equivalent stress over yield stress, at the nodes.
    fn flow_measures(&self, e: usize, state: &[f64]) -> [[f64; 2]; N];
    /// What flow has taken of the work on element `e`.
    fn plastic_work(&self, e: usize, state: &[f64]) -> PlasticWork;
    /// Undeformed volume of element `e`.
    fn volume(&self, e: usize) -> f64;
    /// Condensed forces and tangent; see [`H8Block::evaluate`].
    fn evaluate(
        &self,
        e: usize,
        u: &[Vec3; N],
        state: &mut [f64],
        out: &mut Self::System,
    ) -> Result<(), ElementFault>;
    /// [`Self::evaluate`] at an iterate that a correction led to; see [`H8Block::evaluate_mixed`].
    fn evaluate_mixed(
        &self,
        e: usize,
        u: &[Vec3; N],
        correction: Option<&[Vec3; N]>,
        state: &mut [f64],
        out: &mut Self::System,
    ) -> Result<(), ElementFault>;
    /// Forces without tangent, with the condensation cached by the last evaluation; returns the energy. See
    /// [`H8Block::residual`].
    fn residual(
        &self,
        e: usize,
        u: &[Vec3; N],
        state: &[f64],
        f: &mut Self::Forces,
    ) -> Result<f64, ElementFault>;
    /// `alpha = alpha_from - scale D^-1 (h + L du)`; see [`H8Block::update_alpha`].
    fn update_alpha(&self, state: &mut [f64], du: &[Vec3; N], scale: f64, alpha_from: &[f64]);
    /// Cauchy stress (xx, yy, zz, xy, yz, xz) at the nodes, extended from the Gauss points of the element.
    fn nodal_stresses(
        &self,
        e: usize,
        u: &[Vec3; N],
        state: &[f64],
        out: &mut [[f64; 6]; N],
    ) -> Result<(), ElementFault>;
    /// The same of the linear element, whose enhanced strains at `u` are the first of `state`.
    fn linear_nodal_stresses(
        &self,
        e: usize,
        u: &[Vec3; N],
        state: &[f64],
        out: &mut [[f64; 6]; N],
    ) -> Result<(), ElementFault>;
}

/// Forces and tangent of one element.
pub trait ElementSystem: Clone + Default + Send {
    /// Forces, tangent by columns, strain energy.
    fn parts(&mut self) -> (&[f64], &mut [f64], f64);
}

impl ElementSystem for H8System {
    #[inline]
    fn parts(&mut self) -> (&[f64], &mut [f64], f64) {
        (&self.f, &mut self.k, self.energy)
    }
}

impl ElementSystem for Q18System {
    #[inline]
    fn parts(&mut self) -> (&[f64], &mut [f64], f64) {
        (&self.f, &mut self.k[..], self.energy)
    }
}

impl ElementSystem for NurbsSystem {
    #[inline]
    fn parts(&mut self) -> (&[f64], &mut [f64], f64) {
        (&self.f, &mut self.k[..], self.energy)
    }
}

/// Methods that the blocks have under the same names.
macro_rules! delegate {
    ($n:literal) => {
        #[inline]
        fn elements(&self) -> usize {
            self.elements()
        }
        #[inline]
        fn nodes_of(&self, e: usize) -> [u32; $n] {
            self.nodes_of(e)
        }
        fn volume(&self, e: usize) -> f64 {
            self.volume(e)
        }
        #[inline]
        fn state_len(&self) -> usize {
            self.state_len()
        }
        fn history_len(&self) -> usize {
            self.history_len()
        }
        fn start(&self, e: usize, state: &mut [f64]) {
            self.start(e, state);
        }
        fn remember(
            &self,
            e: usize,
            u: &[Vec3; $n],
            state: &mut [f64],
        ) -> Result<Remembered, ElementFault> {
            self.remember(e, u, state)
        }
        fn flow_measures(&self, e: usize, state: &[f64]) -> [[f64; 2]; $n] {
            self.flow_measures(e, state)
        }
        fn plastic_work(&self, e: usize, state: &[f64]) -> PlasticWork {
            self.plastic_work(e, state)
        }
        #[inline]
        fn evaluate(
            &self,
            e: usize,
            u: &[Vec3; $n],
            state: &mut [f64],
            out: &mut Self::System,
        ) -> Result<(), ElementFault> {
            self.evaluate(e, u, state, out)
        }
        #[inline]
        fn evaluate_mixed(
            &self,
            e: usize,
            u: &[Vec3; $n],
            correction: Option<&[Vec3; $n]>,
            state: &mut [f64],
            out: &mut Self::System,
        ) -> Result<(), ElementFault> {
            self.evaluate_mixed(e, u, correction, state, out)
        }
        #[inline]
        fn residual(
            &self,
            e: usize,
            u: &[Vec3; $n],
            state: &[f64],
            f: &mut Self::Forces,
        ) -> Result<f64, ElementFault> {
            self.residual(e, u, state, f)
        }
        #[inline]
        fn update_alpha(&self, state: &mut [f64], du: &[Vec3; $n], scale: f64, from: &[f64]) {
            self.update_alpha(state, du, scale, from)
        }
    };
}

impl ElementBlock<8> for H8Block {
    type System = H8System;
    type Forces = [f64; 24];
    const NO_FORCES: [f64; 24] = [0.0; 24];
    delegate!(8);

    #[inline]
    fn alpha_len(&self) -> usize {
        self.alpha_len()
    }
    fn nodal_stresses(
        &self,
        e: usize,
        u: &[Vec3; 8],
        state: &[f64],
        out: &mut [[f64; 6]; 8],
    ) -> Result<(), ElementFault> {
        *out = H8Block::nodal_stresses(self, e, u, state)?;
        Ok(())
    }
    fn linear_nodal_stresses(
        &self,
        e: usize,
        u: &[Vec3; 8],
        state: &[f64],
        out: &mut [[f64; 6]; 8],
    ) -> Result<(), ElementFault> {
        let mut points = [[0.0; 6]; 8];
        self.linear_stresses(e, u, state, &mut points)?;
        *out = extrapolate(&points);
        Ok(())
    }
}

impl ElementBlock<18> for Q18Block {
    type System = Q18System;
    type Forces = [f64; DOFS];
    const NO_FORCES: [f64; DOFS] = [0.0; DOFS];
    delegate!(18);

    #[inline]
    fn alpha_len(&self) -> usize {
        Q18Block::ALPHA_LEN
    }
    fn nodal_stresses(
        &self,
        e: usize,
        u: &[Vec3; 18],
        state: &[f64],
        out: &mut [[f64; 6]; 18],
    ) -> Result<(), ElementFault> {
        let mut points = [[0.0; 6]; 18];
        self.stresses(e, u, state, &mut points)?;
        *out = extrapolate_quadratic(&points);
        Ok(())
    }
    fn linear_nodal_stresses(
        &self,
        e: usize,
        u: &[Vec3; 18],
        state: &[f64],
        out: &mut [[f64; 6]; 18],
    ) -> Result<(), ElementFault> {
        let mut points = [[0.0; 6]; 18];
        self.linear_stresses(e, u, state, &mut points)?;
        *out = extrapolate_quadratic(&points);
        Ok(())
    }
}

/// No enhanced strains and no memory: such elements have no state.
impl ElementBlock<{ nurbs::NODES }> for NurbsBlock {
    type System = NurbsSystem;
    type Forces = [f64; nurbs::DOFS];
    const NO_FORCES: [f64; nurbs::DOFS] = [0.0; nurbs::DOFS];

    #[inline]
    fn elements(&self) -> usize {
        self.elements()
    }
    #[inline]
    fn nodes_of(&self, e: usize) -> [u32; nurbs::NODES] {
        self.nodes_of(e)
    }
    #[inline]
    fn state_len(&self) -> usize {
        0
    }
    #[inline]
    fn alpha_len(&self) -> usize {
        0
    }
    fn history_len(&self) -> usize {
        0
    }
    fn remember(
        &self,
        _: usize,
        _: &[Vec3; nurbs::NODES],
        _: &mut [f64],
    ) -> Result<Remembered, ElementFault> {
        Ok(Remembered::default())
    }
    fn flow_measures(&self, _: usize, _: &[f64]) -> [[f64; 2]; nurbs::NODES] {
        [[0.0; 2]; nurbs::NODES]
    }
    fn plastic_work(&self, _: usize, _: &[f64]) -> PlasticWork {
        PlasticWork::default()
    }
    fn volume(&self, e: usize) -> f64 {
        self.volume(e)
    }
    #[inline]
    fn evaluate(
        &self,
        e: usize,
        u: &[Vec3; nurbs::NODES],
        _: &mut [f64],
        out: &mut NurbsSystem,
    ) -> Result<(), ElementFault> {
        self.evaluate(e, u, None, out)
    }
    #[inline]
    fn evaluate_mixed(
        &self,
        e: usize,
        u: &[Vec3; nurbs::NODES],
        correction: Option<&[Vec3; nurbs::NODES]>,
        _: &mut [f64],
        out: &mut NurbsSystem,
    ) -> Result<(), ElementFault> {
        self.evaluate(e, u, correction, out)
    }
    #[inline]
    fn residual(
        &self,
        e: usize,
        u: &[Vec3; nurbs::NODES],
        _: &[f64],
        f: &mut [f64; nurbs::DOFS],
    ) -> Result<f64, ElementFault> {
        self.residual(e, u, f)
    }
    #[inline]
    fn update_alpha(&self, _: &mut [f64], _: &[Vec3; nurbs::NODES], _: f64, _: &[f64]) {}
    /// Of the mid-surface; nodes of the net do not lie on it, and take the mean over the points of the element.
    fn nodal_stresses(
        &self,
        e: usize,
        u: &[Vec3; nurbs::NODES],
        _: &[f64],
        out: &mut [[f64; 6]; nurbs::NODES],
    ) -> Result<(), ElementFault> {
        *out = [self.mean_stress(e, u)?; nurbs::NODES];
        Ok(())
    }
    fn linear_nodal_stresses(
        &self,
        e: usize,
        u: &[Vec3; nurbs::NODES],
        state: &[f64],
        out: &mut [[f64; 6]; nurbs::NODES],
    ) -> Result<(), ElementFault> {
        ElementBlock::nodal_stresses(self, e, u, state, out)
    }
}

/// The elements of one body.
#[derive(Debug, Clone)]
pub enum Block {
    /// Elements of 8 nodes, of any formulation.
    H8(H8Block),
    /// Quadratic elements of 18 nodes.
    Q18(Q18Block),
    /// Knot spans of a NURBS patch.
    Nurbs(Box<NurbsBlock>),
}

/// Runs a block of code with `$block` bound to the concrete elements of a [`Block`].
macro_rules! with_block {
    ($enum:expr, $block:ident => $body:expr) => {
        match $enum {
            $crate::shell::Block::H8($block) => $body,
            $crate::shell::Block::Q18($block) => $body,
            $crate::shell::Block::Nurbs($block) => {
                let $block: &$crate::shell::NurbsBlock = $block;
                $body
            }
        }
    };
}
pub(crate) use with_block;

impl Block {
    /// Sets up the elements that a scene asks for.
    ///
    /// # Errors
    /// Those of [`H8Block::new`] and [`Q18Block::new`]; [`ShellError::Sheet`] for elements of a NURBS patch.
    pub fn new(mesh: &Mesh, element: Element, law: Law) -> Result<Block, ShellError> {
        Ok(match Formulation::of(element, law.flows()) {
            None if matches!(element, Element::Nurbs) => return Err(ShellError::Sheet),
            Some(formulation) => Block::H8(H8Block::new(mesh, formulation, law)?),
            None => Block::Q18(Q18Block::new(mesh, law)?),
        })
    }

    /// Dashpots beside these elements, of the same shape, on the same mesh.
    ///
    /// # Errors
    /// Those of [`Block::new`].
    pub fn dashpots(&self, mesh: &Mesh) -> Result<Block, ShellError> {
        let law = self.law().dashpot();
        Ok(match self {
            Block::H8(b) => Block::H8(H8Block::new(mesh, b.formulation().elastic(), law)?),
            Block::Q18(_) => Block::Q18(Q18Block::new(mesh, law)?),
            Block::Nurbs(_) => return Err(ShellError::Sheet),
        })
    }

    /// Bytes of what is worked out once about the shape of an element.
    pub const fn shape_bytes(&self) -> usize {
        match self {
            Block::H8(_) => H8Block::BYTES,
            Block::Q18(_) => Q18Block::BYTES,
            Block::Nurbs(_) => NurbsBlock::BYTES,
        }
    }

    /// Numbers of state of an element of [`Self::dashpots`].
    pub fn dashpot_state_len(&self) -> usize {
        match self {
            Block::H8(b) => {
                let elastic = b.formulation().elastic();
                elastic.state_len(true) + elastic.points() * DashpotState::LEN
            }
            Block::Q18(_) => Q18Block::STATE_LEN + 18 * DashpotState::LEN,
            Block::Nurbs(_) => 0,
        }
    }

    /// Number of elements.
    pub fn elements(&self) -> usize {
        with_block!(self, b => b.elements())
    }

    /// Numbers of state per element.
    pub fn state_len(&self) -> usize {
        with_block!(self, b => ElementBlock::state_len(b))
    }

    /// Numbers of enhanced strains per element, at the start of its state.
    pub fn alpha_len(&self) -> usize {
        with_block!(self, b => ElementBlock::alpha_len(b))
    }

    /// Numbers that an element remembers of accepted steps, at the end of its state.
    pub fn history_len(&self) -> usize {
        with_block!(self, b => b.history_len())
    }

    /// The law of all elements.
    pub fn law(&self) -> Law {
        with_block!(self, b => b.law())
    }

    /// Where patches of a CAD surface are joined; none of other bodies.
    pub fn seams(&self) -> &[super::nurbs::SeamSpan] {
        match self {
            Block::Nurbs(block) => block.seams(),
            Block::H8(_) | Block::Q18(_) => &[],
        }
    }

    /// Springs at points of trims that supports hold.
    pub fn anchors(&self) -> &[super::nurbs::AnchorSpring] {
        match self {
            Block::Nurbs(block) => block.anchors(),
            Block::H8(_) | Block::Q18(_) => &[],
        }
    }

    /// The CAD surface that the elements are knot spans of.
    pub fn sheet(&self) -> Option<&crate::mesh::NurbsSheet> {
        match self {
            Block::Nurbs(block) => Some(block.sheet()),
            Block::H8(_) | Block::Q18(_) => None,
        }
    }
}
