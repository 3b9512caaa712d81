//! Residual and tangent of the whole model.
//!
//! Elements and slave points are evaluated in parallel, a chunk at a time, and summed in order by one thread, so that
//! the result is the same to the last bit for every number of threads.
mod answer;
mod averaged;
mod bytes;
mod couplings;
mod drag;
mod driven;
mod effects;
mod elements;
mod fault;
mod links;
mod loads;
mod maps;
mod memory;
mod moving;
mod per_pair;
mod pressed;
mod pressing;
mod remembering;
mod rigid;
mod seams;
mod sliding;
mod small;
mod totals;
mod touched;

use crate::system::{ConstrainedScatter, DofMap, Pattern, PatternError, SystemMatrix};

use crate::contact::clearance::Clearance;
use crate::contact::friction::law::Slide;
use crate::contact::friction::turning::Turning;
use crate::contact::law::{PairLaw, Penalty};
use crate::contact::rigid::{PointFault, Touch};
use crate::effects::Effects;
use crate::model::Model;
use crate::model::kernel::Kernel;
use crate::model::master::Masters;
use crate::model::state::State;
use averaged::Averaged;
use couplings::Couplings;
pub use fault::Fault;
use fault::element_fault;
use maps::{Maps, PointMaps};
use moving::Meetings;
use per_pair::PerPair;
use seams::Seams;
use sliding::Sliding;
use small::Linear;
pub use totals::{PairForce, SurfaceForce, Totals};

use driven::DrivenBlock;
use elements::Systems;
use std::marker::PhantomData;
use std::sync::Arc;

pub use answer::PointAnswer;
pub use averaged::RubbedPoints;
pub(crate) use bytes::sizes;
pub use drag::Drag;
pub use effects::StartError;
pub use elements::Quadratic;
pub use memory::{AssemblerMemory, CouplingMemory, MemoryError};
pub use small::{Factored, Line, Needed};

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Kind {
    Free,
    Prescribed,
    Tied,
}

/// How contact is linearised where the state is far from equilibrium: the first iterates of a step.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Linearization {
    /// Points that are closed in the state stay so wherever they are. The residual is then not that of the state.
    pub keep_active: bool,
    /// How points slide. Where some are taken to stick, the residual is not that of the state.
    pub slide: Slide,
    /// Points keep the facet that they were on across folds of nearly flat facets ([`MovingMaster::keep`]).
    ///
    /// [`MovingMaster::keep`]: crate::contact::moving::MovingMaster::keep
    pub keep_facets: bool,
}

/// Evaluates the model into a sparse system. The law of normal contact is a type, chosen where the assembler is made: every
/// traction, energy and stiffness of contact is asked of it.
pub struct Assembler<'m, L = Penalty> {
    model: &'m Model,
    dofs: &'m DofMap,
    matrix: SystemMatrix,
    element_maps: Vec<u32>,
    kinds: Vec<Kind>,
    /// Per pair with a rigid master: where the blocks of its points go.
    point_maps: PerPair<PointMaps>,
    follower_maps: Vec<Vec<u32>>,
    systems: Systems,
    /// Where patches of bodies are joined; empty where none are.
    seams: Seams,
    /// Room for the points of a pair with a rigid master.
    touches: Vec<Result<Option<Touch>, PointFault>>,
    /// Per point of pairs with rigid masters: what the last search has proved since [`Assembler::begin_solution`].
    clearances: Vec<Clearance>,
    /// Points of a pair that [`Linearization::keep_active`] keeps closed.
    held: Vec<bool>,
    /// Per point with history, of pairs with friction or augmentation; nothing where it is open. Empty without augmentation.
    answers: Vec<Option<PointAnswer>>,
    /// How every point with history slid at the linearisations since [`Assembler::begin_solution`].
    slips: Vec<Turning>,
    /// The surfaces of masters that are bodies, at the last state evaluated.
    pub masters: Masters,
    /// Per pair whose master is a body: the nodes that the pattern couples, and the points at the last state.
    couplings: PerPair<Couplings>,
    /// Per pair without friction whose master is a body: the points at the last state.
    meetings: PerPair<Meetings>,
    /// Per pair with friction whose master is a body: the points at the last state.
    sliding: PerPair<Sliding>,
    /// Per pair with averaged gaps: its points and nodes at the last state.
    averaged: PerPair<Averaged>,
    /// Per pair: the kernel that its points were evaluated by last, told by what it was compiled for.
    ran: Vec<Option<Kernel>>,
    /// The pattern, until the solver has taken it.
    new_pattern: Option<Arc<Pattern>>,
    rebuilds: u32,
    work: ConstrainedScatter,
    /// Dead loads at the present time; empty where the scene has no loads.
    external: Vec<f64>,
    /// Empty where the scene has no contacts.
    contact: Vec<f64>,
    borders: Vec<DrivenBlock>,
    /// What acts beside elements, loads and contact.
    pub effects: Effects,
    /// Where displacements are small.
    linear: Option<Box<Linear>>,
    /// Penalty per pair; an automatic one may be raised in the course of a run.
    pub penalties: Vec<f64>,
    /// Tangential penalty over the normal one per pair, zero without friction.
    pub ratios: Vec<f64>,
    /// How contact is linearised.
    pub linearization: Linearization,
    law: PhantomData<fn() -> L>,
}

impl<'m> Assembler<'m> {
    /// Builds the pattern of the model under its constraints. Contact has the linear penalty.
    ///
    /// # Errors
    /// A system that is too large.
    pub fn new(model: &'m Model, dofs: &'m DofMap) -> Result<Self, PatternError> {
        Self::with_law(model, dofs)
    }

    /// The pattern of a model under its constraints at the start, and nothing else of an assembler.
    ///
    /// # Errors
    /// As [`Self::new`].
    pub fn pattern_of(model: &Model, dofs: &DofMap) -> Result<Pattern, PatternError> {
        let couplings = moving::first_couplings(model, &Masters::new(model));
        let pattern = maps::pattern(model, dofs, &couplings)?;
        pattern.fits(model.symmetric)?;
        Ok(pattern)
    }
}

impl<'m, L: PairLaw> Assembler<'m, L> {
    /// [`Assembler::new`] with another law of normal contact. At small displacements it is the linear penalty throughout,
    /// because one stiffness has to hold for the whole run.
    ///
    /// # Errors
    /// As there.
    pub fn with_law(model: &'m Model, dofs: &'m DofMap) -> Result<Self, PatternError> {
        let masters = Masters::new(model);
        let couplings = moving::first_couplings(model, &masters);
        let pattern = Arc::new(maps::pattern(model, dofs, &couplings)?);
        pattern.fits(model.symmetric)?;
        let maps = Maps::new(model, dofs, &pattern)?;
        let n = 3 * model.nodes.len();
        // At small displacements points and elements have loops of their own.
        let large = model.small.is_none();
        let pairs = || model.pairs.iter().filter(|_| large);
        let vector = |needed: bool| vec![0.0; if needed { n } else { 0 }];
        let borders = DrivenBlock::all(model, &pattern)?;
        let linear = Linear::new(model, dofs, &pattern)?;
        Ok(Assembler {
            model,
            dofs,
            matrix: system(model, pattern.clone()),
            element_maps: maps.elements,
            kinds: maps.kinds,
            point_maps: maps.points,
            follower_maps: maps.followers,
            systems: match large {
                true => Systems::new(model),
                false => Systems::default(),
            },
            seams: Seams::new(model, maps.seams),
            touches: vec![Ok(None); rigid::most(model)],
            clearances: vec![Clearance::default(); rigid::cleared(model)],
            held: Vec::new(),
            answers: remembering::answers(model),
            slips: remembering::slips(model),
            masters,
            couplings,
            meetings: PerPair::new(pairs().map(Meetings::new)),
            sliding: PerPair::new(pairs().map(Sliding::new)),
            averaged: PerPair::new(pairs().map(Averaged::new)),
            ran: vec![None; model.pairs.len()],
            new_pattern: Some(pattern),
            rebuilds: 0,
            work: ConstrainedScatter::default(),
            external: vector(model.loaded()),
            contact: vector(!model.pairs.is_empty()),
            borders,
            effects: Effects::new(model),
            linear,
            penalties: model.pairs.iter().map(|p| p.eps_n).collect(),
            ratios: (model.pairs.iter())
                .map(|p| p.friction.as_ref().map_or(0.0, |f| f.ratio))
                .collect(),
            linearization: Linearization::default(),
            law: PhantomData,
        })
    }

    /// The pattern, if it is another than when it was last taken: the solver has to analyse it.
    pub fn take_new_pattern(&mut self) -> Option<Arc<Pattern>> {
        self.new_pattern.take()
    }

    /// Whether the pattern is another than when it was last taken.
    pub fn has_new_pattern(&self) -> bool {
        self.new_pattern.is_some()
    }

    /// Times the pattern was built anew because points touched facets that it did not couple them with.
    pub fn rebuilds(&self) -> u32 {
        self.rebuilds
    }

    /// What points with history do at the state evaluated last, in the order of [`State::histories`]; nothing where they are
    /// open. Empty where no pair has augmentation.
    pub fn answers(&self) -> &[Option<PointAnswer>] {
        &self.answers
    }

    /// Per pair: the kernel that its points were evaluated by last; none where they were not, or only by a first
    /// linearisation that held them, whose law is its own. It is told by what the loop over the points was compiled for, not
    /// by the plan.
    pub fn ran(&self) -> &[Option<Kernel>] {
        &self.ran
    }

    /// The tangent of the last [`Self::linearize`].
    pub fn matrix(&self) -> &SystemMatrix {
        &self.matrix
    }

    /// Dead loads of the last evaluation; empty where the scene has no loads.
    pub fn external(&self) -> &[f64] {
        &self.external
    }

    /// Contact forces at all degrees of freedom of the last evaluation, as they stand in the residual; empty where the scene
    /// has no contacts.
    pub fn contact_forces(&self) -> &[f64] {
        &self.contact
    }

    /// Residual `f_int + f_contact - f_ext` (and what stabilises) at all degrees of freedom (reactions included) and the tangent; the element
    /// states receive what their condensation needs, the point states where their search ended. `increments` are
    /// prescribed displacements still to come: the returned right-hand side is `-residual - K increments`.
    ///
    /// # Errors
    /// What cannot be evaluated; [`Fault::Small`] for models with small displacements.
    pub fn linearize(
        &mut self,
        state: &mut State,
        time: f64,
        increments: Option<&[f64]>,
        residual: &mut [f64],
        rhs: &mut [f64],
    ) -> Result<Totals, Fault> {
        self.linearize_mixed(state, time, (increments, None), residual, rhs)
    }

    /// [`Self::linearize`] with mixed integration points where there are displacements that the last correction started `from`: the
    /// tangent of the elements is then the one that [`H8Block::evaluate_mixed`] tells of.
    ///
    /// # Errors
    /// As [`Self::linearize`].
    ///
    /// [`H8Block::evaluate_mixed`]: crate::shell::H8Block::evaluate_mixed
    pub fn linearize_mixed(
        &mut self,
        state: &mut State,
        time: f64,
        (increments, from): (Option<&[f64]>, Option<&[f64]>),
        residual: &mut [f64],
        rhs: &mut [f64],
    ) -> Result<Totals, Fault> {
        self.large()?;
        // First, because it may change the pattern.
        self.meet::<true>(state, time)?;
        self.matrix.clear();
        residual.fill(0.0);
        rhs.fill(0.0);
        let mut totals = Totals::default();
        self.elements(state, (increments, from), residual, rhs, &mut totals)?;
        self.seams::<true>(&state.u, increments, residual, rhs, &mut totals);
        self.acting::<true>(state, time, increments, residual, rhs, &mut totals)?;
        self.own_blocks(&state.u, time, residual, &mut totals)?;
        for (b, r) in rhs.iter_mut().zip(residual.iter()) {
            *b -= r;
        }
        self.dofs.fold(rhs);
        self.matrix.set_identities(self.dofs);
        Ok(totals)
    }

    /// The residual alone, for a line search; uses the condensation cached by the last [`Self::linearize`].
    ///
    /// # Errors
    /// As [`Self::linearize`].
    pub fn residual(
        &mut self,
        state: &mut State,
        time: f64,
        residual: &mut [f64],
    ) -> Result<Totals, Fault> {
        self.large()?;
        self.meet::<false>(state, time)?;
        residual.fill(0.0);
        let mut totals = Totals::default();
        self.element_forces(state, residual, &mut totals)?;
        self.seams::<false>(&state.u, None, residual, &mut [], &mut totals);
        self.acting::<false>(state, time, None, residual, &mut [], &mut totals)?;
        Ok(totals)
    }

    /// What contact alone adds to the residual, and its totals.
    ///
    /// # Errors
    /// A point that cannot be evaluated, or a motion without a value at `time`.
    pub fn contact(
        &mut self,
        state: &mut State,
        time: f64,
        residual: &mut [f64],
    ) -> Result<Totals, Fault> {
        let mut totals = Totals::default();
        if self.linear.is_some() {
            residual.fill(0.0);
            self.small_contact(state, time, residual, &mut totals)?;
            return Ok(totals);
        }
        self.meet::<false>(state, time)?;
        residual.fill(0.0);
        self.contacts::<false>(state, time, None, residual, &mut [], &mut totals)?;
        Ok(totals)
    }

    /// Only for displacements of any size.
    fn large(&self) -> Result<(), Fault> {
        match self.linear {
            Some(_) => Err(Fault::Small),
            None => Ok(()),
        }
    }

    /// Sets the tangent to zero, before [`Self::linearize_contact`].
    pub fn clear_matrix(&mut self) {
        self.matrix.clear();
    }

    /// [`Self::contact`], with what contact adds to the tangent on top of what is there ([`Self::clear_matrix`]), and to
    /// `rhs` where there are `increments` ([`Self::linearize`]): what a measurement of contact alone evaluates.
    ///
    /// # Errors
    /// As [`Self::contact`], a pattern that has grown too large, and [`Fault::Small`].
    pub fn linearize_contact(
        &mut self,
        state: &mut State,
        time: f64,
        increments: Option<&[f64]>,
        residual: &mut [f64],
        rhs: &mut [f64],
    ) -> Result<Totals, Fault> {
        self.large()?;
        self.meet::<true>(state, time)?;
        residual.fill(0.0);
        let mut totals = Totals::default();
        self.contacts::<true>(state, time, increments, residual, rhs, &mut totals)?;
        Ok(totals)
    }
}

/// A zero system, symmetric where the model is.
fn system(model: &Model, pattern: Arc<Pattern>) -> SystemMatrix {
    match model.symmetric {
        true => SystemMatrix::new(pattern),
        false => SystemMatrix::unsymmetric(pattern),
    }
}

/// Scatters a small matrix under the constraints, with what prescribed increments contribute to the right-hand side.
#[allow(clippy::too_many_arguments)]
fn put(
    matrix: &mut SystemMatrix,
    dofs: &DofMap,
    work: &mut ConstrainedScatter,
    nodes: &[u32],
    map: &[u32],
    ke: &mut [f64],
    increments: Option<&[f64]>,
    rhs: &mut [f64],
) {
    if !dofs.constrains(nodes) {
        matrix.scatter(map, ke);
        return;
    }
    if let Some(g) = increments {
        dofs.subtract_prescribed(nodes, ke, g, rhs);
    }
    matrix
        .scatter_constrained(nodes, ke, dofs, work)
        .expect("the pattern holds faces, which lie in elements, and what contact couples");
}
