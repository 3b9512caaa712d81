//! What a run of a model takes, from the model itself and the symbolic analysis of its system.
use super::times;
use crate::assembly::Pattern;
use crate::contact::points::SlavePoint;
use crate::mesh::ElementKind;
use crate::model::Model;
use crate::model::state::{PointState, State};
use crate::model::surface::SurfaceModel;
use crate::scene::{Element, FacetKind};
use crate::shell::{STATES, bytes_per_element};
use crate::solve::linear::Analysis;
use serde::Serialize;

/// Bytes of the program before it has read anything: code, tables, threads; more without optimisation.
const PROGRAM: u64 = if cfg!(debug_assertions) {
    16 << 20
} else {
    8 << 20
};
/// Bytes of a slave point beside its own and those of its states: its place in the system, its last touch, what is written.
const POINT: u64 = 600;
/// Bytes of the faces of an element in the table that finds shared ones.
pub(super) const FACES: u64 = 6 * 28;
/// Bytes of a quadrilateral of the flat copy of a surface: four indices, patch, entity, and a corner with its normal.
const FLAT: u64 = 4 * 8 + 2 * 4 + 2 * 24;
/// The flat copy is held once, and moved and as the bytes of a file while it is written.
const COPIES: u64 = 3;

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
            let [shape, mut states] = bytes_per_element(element).map(|b| b as u64);
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

/// Bytes of a mesh while it is made and checked: positions and marks of nodes, connectivity, and the table of all faces.
pub fn mesh(nodes: u64, elements: u64, kind: ElementKind) -> u64 {
    let each = 4 * kind.nodes() as u64 + FACES;
    times(nodes, 24 + 8).saturating_add(times(elements, each))
}

/// Bytes of so many slave points, with what a run remembers of each.
pub fn slave_points(count: u64) -> u64 {
    let states = STATES * size_of::<PointState>();
    times(count, (size_of::<SlavePoint>() + states) as u64 + POINT)
}

/// Bytes of a facet with its place in the search; of a patch of a CAD file where there are no facets.
pub fn facet_bytes(kind: Option<FacetKind>) -> u64 {
    match kind {
        Some(FacetKind::Bilinear) => 1_000,
        Some(FacetKind::Biquadratic) => 2_000,
        Some(FacetKind::Smooth) => 6_000,
        None => 20_000,
    }
}

/// Bytes of the flat copies of all surfaces: `n` x `n` quadrilaterals for every polynomial piece of an exact surface.
pub fn tessellation(model: &Model, n: u32) -> u64 {
    let of = |surface: &SurfaceModel| {
        let pieces = surface.pieces() as u64;
        let each = match &surface.facets {
            // Facets choose their own number.
            Some(_) => 1,
            None => times(u64::from(n), u64::from(n)),
        };
        times(times(pieces, each), COPIES * FLAT)
    };
    model.surfaces.iter().map(of).fold(0, u64::saturating_add)
}
