//! What a run of a model takes, from the model itself and the symbolic analysis of its system.
use crate::machine::memory::times;
use crate::model::Model;
use crate::model::slave::POINT;
use crate::model::state::State;
use crate::model::surface::{SurfaceModel, facet_bytes};
use crate::output::flat_bytes;
use crate::scene::Element;
use crate::shell::{Memory, STATES, bytes_per_element};
use crate::system::Pattern;
use crate::system::linear::Analysis;
use serde::Serialize;

/// Bytes of the program before it has read anything: code, tables, threads; more without optimisation.
const PROGRAM: u64 = if cfg!(debug_assertions) {
    16 << 20
} else {
    8 << 20
};

/// Memory of a run in bytes, by what it is for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
pub struct Estimate {
    /// Meshes, elements and their states.
    pub elements: u64,
    /// Slave points and what they remember.
    pub contact: u64,
    /// Rigid surfaces and their copies for the output.
    pub surfaces: u64,
    /// The sparse matrix.
    pub matrix: u64,
    /// Its factor, and the work space of factorizations.
    pub factor: u64,
    /// All of it, and the program.
    pub total: u64,
}

impl Estimate {
    /// Of a model whose system has this pattern and analysis; `elements` is the element of each body, `tessellation` that
    /// of the output.
    pub fn new(
        model: &Model,
        elements: &[Element],
        pattern: &Pattern,
        analysis: &Analysis,
        tessellation_: u32,
    ) -> Self {
        let of_bodies = (model.bodies.iter().zip(elements)).map(|(body, &element)| {
            let count = body.block.elements() as u64;
            let nodes = body.mesh.kind.nodes() as u64;
            let [shape, mut states] =
                bytes_per_element(element, Memory::of(&body.material)).map(|b| b as u64);
            if model.small.is_some() {
                // While the stiffness is made.
                states /= STATES as u64;
            }
            let maps = 4 * nodes * (nodes + 1) / 2;
            times(count, shape + states + maps + 4 * nodes)
        });
        let elements = of_bodies.sum::<u64>() + times(model.nodes.len() as u64, 24 + 6 * 24 + 100);
        let state = State::new(model);
        let elements_of_state = size_of_val(&state.elements[..]) + size_of_val(&state.u[..]);
        let contact = (STATES * (state.bytes() - elements_of_state)) as u64
            + times(model.contact_points() as u64, POINT);
        let surfaces = tessellation(model, tessellation_)
            + (model.surfaces.iter())
                .map(|s| {
                    times(
                        s.set.count() as u64,
                        facet_bytes(s.facets.as_ref().map(|f| f.kind)),
                    )
                })
                .sum::<u64>();
        let blocks = pattern.blocks() as u64;
        let mut matrix = blocks * if model.symmetric { 72 + 4 } else { 144 + 4 };
        let mut factor = analysis.memory_bytes as u64;
        if model.small.is_some() {
            // The stiffness beside the system, with its constraints and without.
            matrix *= 3;
        } else if model.pairs.iter().any(|p| p.body_master().is_some()) {
            // Couplings are added as points come to further facets: half as much again, measured.
            matrix += matrix / 2;
            factor += factor / 2;
        }
        Self {
            elements,
            contact,
            surfaces,
            matrix,
            factor,
            total: PROGRAM + elements + contact + surfaces + matrix + factor,
        }
    }
}

/// Bytes of the flat copies of all surfaces: `n` x `n` quadrilaterals for every polynomial piece of an exact surface.
pub fn tessellation(model: &Model, n: u32) -> u64 {
    let of = |surface: &SurfaceModel| {
        let each = match &surface.facets {
            // Facets choose their own number.
            Some(_) => 1,
            None => times(u64::from(n), u64::from(n)),
        };
        flat_bytes(surface.pieces() as u64, each)
    };
    model.surfaces.iter().map(of).fold(0, u64::saturating_add)
}
