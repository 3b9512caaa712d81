//! What an assembler carries from one evaluation to the next: what a run that is continued has to set up again.
use super::couplings::Couplings;
use super::{Assembler, Factored, PatternError};
use crate::contact::law::PairLaw;
use crate::effects::inertia::Motion;

/// What the next evaluation depends on, beside the state.
#[derive(Debug, Clone, PartialEq)]
pub struct AssemblerMemory {
    /// Penalty per pair.
    pub penalties: Vec<f64>,
    /// Tangential penalty over the normal one per pair, zero without friction.
    pub ratios: Vec<f64>,
    /// Per pair whose master is a body, what the pattern couples. It decides about the order of elimination, and with it
    /// about the last bits.
    pub couplings: Vec<Option<CouplingMemory>>,
    /// Times the pattern was built anew.
    pub rebuilds: u32,
    /// What was factorized last, where displacements are small.
    pub factored: Option<Factored>,
    /// Largest displacement of all equilibria so far, where displacements are small (length); else 0.
    pub farthest: f64,
    /// Where the motion is, in dynamics.
    pub motion: Option<Motion>,
    /// The solver has not taken the pattern yet.
    pub new_pattern: bool,
}

/// What a pair couples in the pattern.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct CouplingMemory {
    /// Number of facets per cell, and the facets, cell by cell, ascending.
    pub counts: Vec<u32>,
    /// The facets of all cells, one cell after the other.
    pub facets: Vec<u32>,
    /// Pairs of facets that are coupled with each other, ascending.
    pub links: Vec<[u32; 2]>,
}

/// Why a memory is none of this model.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum MemoryError {
    /// A part does not fit the model, which the text names.
    #[error("{0}")]
    Misfit(&'static str),
    /// The pattern that it asks for could not be built.
    #[error(transparent)]
    Pattern(#[from] PatternError),
}

impl<L: PairLaw> Assembler<'_, L> {
    /// What a run that is continued gives to [`Assembler::restore`].
    pub fn memory(&self) -> AssemblerMemory {
        // Whoever adds a field decides here whether it outlives an accepted step. All that is left out is given by the model,
        // made with the pattern, or written by every evaluation before it is read.
        let Assembler {
            model: _,
            dofs: _,
            matrix: _,
            element_maps: _,
            kinds: _,
            point_maps: _,
            follower_maps: _,
            systems: _,
            seams: _,
            touches: _,
            clearances: _,
            held: _,
            answers: _,
            slips: _,
            masters: _,
            couplings,
            meetings: _,
            sliding: _,
            averaged: _,
            ran: _,
            new_pattern,
            rebuilds,
            work: _,
            external: _,
            contact: _,
            borders: _,
            penalties,
            ratios,
            linearization: _,
            // All else of them is written by the first evaluation of a step.
            effects,
            // All else of it is given by the model.
            linear,
            // A type, no value.
            law: _,
        } = self;
        AssemblerMemory {
            penalties: penalties.clone(),
            ratios: ratios.clone(),
            couplings: (0..self.model.pairs.len())
                .map(|pair| couplings.get(pair).map(Couplings::memory))
                .collect(),
            rebuilds: *rebuilds,
            factored: linear.as_ref().and_then(|l| l.factored().cloned()),
            farthest: linear.as_ref().map_or(0.0, |l| l.farthest()),
            motion: (effects.inertia.as_ref()).map(|i| i.motion().clone()),
            new_pattern: new_pattern.is_some(),
        }
    }

    /// Makes a new assembler of the same model one that has this memory.
    ///
    /// # Errors
    /// [`MemoryError::Misfit`] where it is of another model.
    pub fn restore(&mut self, memory: &AssemblerMemory) -> Result<(), MemoryError> {
        let AssemblerMemory {
            penalties,
            ratios,
            couplings,
            rebuilds,
            factored,
            farthest,
            // With the displacements that it is of: [`Assembler::go_on`].
            motion: _,
            new_pattern: _,
        } = memory;
        if penalties.len() != self.penalties.len() || couplings.len() != self.model.pairs.len() {
            return Err(MemoryError::Misfit("another number of contact pairs"));
        }
        let mut other = false;
        for ((index, pair), memory) in self.model.pairs.iter().enumerate().zip(couplings) {
            match (self.couplings.get_mut(index), memory, pair.body_master()) {
                (Some(own), Some(memory), Some(master)) => {
                    if own.memory() != *memory {
                        own.restore(memory, master.facets.len())?;
                        other = true;
                    }
                }
                (None, None, _) => {}
                _ => return Err(MemoryError::Misfit("another master of a contact pair")),
            }
        }
        if other {
            self.build_pattern()?;
        }
        self.penalties.copy_from_slice(penalties);
        self.ratios.copy_from_slice(ratios);
        self.rebuilds = *rebuilds;
        if let Some(linear) = &mut self.linear {
            linear.restore(factored.clone(), *farthest);
        }
        Ok(())
    }
}
