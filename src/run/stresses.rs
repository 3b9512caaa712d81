//! Stresses at nodes, and which bodies they are followed of.
use crate::model::probe::ProbeModel;
use crate::model::state::State;
use crate::model::{BodyModel, Model};
use crate::scene::ProbeQuantity;
use crate::shell::{Block, ElementBlock, ElementFault, Formulation, with_block};
use covact_geometry::Vec3;

/// Whether the stress of a body is asked for in every step: by a probe, or because it is a metal of known strength.
pub fn follows_stress(model: &Model, body: usize) -> bool {
    let body = &model.bodies[body];
    let own = body.first_node..body.first_node + body.mesh.nodes.len() as u32;
    let probed = |p: &ProbeModel| {
        p.quantity == ProbeQuantity::VonMises && p.nodes.iter().any(|n| own.contains(n))
    };
    // Control points of a sheet have none.
    body.block.sheet().is_none() && (body.metal.is_some() || model.probes.iter().any(probed))
}

/// Cauchy stress at the nodes of each body that is `wanted`, else nothing: extrapolated within the elements, averaged
/// between them by volume.
pub fn nodal_stresses(
    model: &Model,
    state: &State,
    wanted: impl Fn(usize) -> bool,
) -> Vec<Vec<[f64; 6]>> {
    let mut first = 0;
    let mut out = Vec::new();
    for (index, body) in model.bodies.iter().enumerate() {
        let len = model.state_len(body) * body.block.elements();
        let states = &state.elements[first..first + len];
        first += len;
        if !wanted(index) {
            out.push(Vec::new());
            continue;
        }
        out.push(with_block!(&body.block, block => match model.small {
            None => body_stresses(body, block, states, &state.u),
            Some(_) => linear_stresses(body, block, &state.u),
        }));
    }
    out
}

/// Cauchy stress in the middle of the layer of elements above each node, of a body whose elements have points over the
/// thickness of their own; none of another, whose stress is linear between both faces of a layer.
pub fn middle_stresses(model: &Model, state: &State) -> Vec<Option<Vec<[f64; 6]>>> {
    let mut first = 0;
    let bodies = model.bodies.iter().map(|body| {
        let len = model.state_len(body);
        let own = first..first + len * body.block.elements();
        first = own.end;
        let Block::H8(block) = &body.block else {
            return None;
        };
        if block.formulation() != Formulation::Layered {
            return None;
        }
        let states = &state.elements[own];
        let nodes = body.mesh.nodes.len();
        Some(averaged_over(4, block, nodes, |e, nodal| {
            let u = body.displacements(block, e, &state.u);
            *nodal = block.middle_stresses(e, &u, &states[e * len..(e + 1) * len])?;
            Ok(())
        }))
    });
    bodies.collect()
}

/// Equivalent plastic strain and equivalent stress over yield stress at the nodes of each body that flows, else nothing;
/// averaged as [`nodal_stresses`] are.
pub fn flow_measures(model: &Model, state: &State) -> Vec<Vec<[f64; 2]>> {
    let mut first = 0;
    let bodies = model.bodies.iter().map(|body| {
        let len = model.state_len(body);
        let own = first..first + len * body.block.elements();
        first = own.end;
        if !body.material.flows() {
            return Vec::new();
        }
        let states = &state.elements[own];
        with_block!(&body.block, block => averaged(block, body.mesh.nodes.len(), |e, nodal| {
            *nodal = ElementBlock::flow_measures(block, e, &states[e * len..(e + 1) * len]);
            Ok(())
        }))
    });
    bodies.collect()
}

/// Stress of the linear elements of a body, whose enhanced strains are worked out anew.
fn linear_stresses<const N: usize, B: ElementBlock<N>>(
    body: &BodyModel,
    block: &B,
    u: &[f64],
) -> Vec<[f64; 6]> {
    let (len, alphas) = (block.state_len(), block.alpha_len());
    let none = vec![0.0; alphas];
    let (mut state, mut system) = (vec![0.0; len], B::System::default());
    averaged(block, body.mesh.nodes.len(), |e, nodal| {
        state.fill(0.0);
        if len > 0 {
            block.evaluate(e, &[Vec3::zeros(); N], &mut state, &mut system)?;
        }
        let u = body.displacements(block, e, u);
        block.update_alpha(&mut state, &u, 1.0, &none);
        block.linear_nodal_stresses(e, &u, &state, nodal)
    })
}

fn body_stresses<const N: usize>(
    body: &BodyModel,
    block: &impl ElementBlock<N>,
    states: &[f64],
    u: &[f64],
) -> Vec<[f64; 6]> {
    let len = block.state_len();
    averaged(block, body.mesh.nodes.len(), |e, nodal| {
        let u = body.displacements(block, e, u);
        block.nodal_stresses(e, &u, &states[e * len..(e + 1) * len], nodal)
    })
}

/// Averages what `of` says of the nodes of every element between the elements, by volume; what fails is left out.
fn averaged<const N: usize, const K: usize>(
    block: &impl ElementBlock<N>,
    nodes: usize,
    of: impl FnMut(usize, &mut [[f64; K]; N]) -> Result<(), ElementFault>,
) -> Vec<[f64; K]> {
    averaged_over(N, block, nodes, of)
}

/// The same over the first nodes of every element only.
fn averaged_over<const N: usize, const K: usize>(
    count: usize,
    block: &impl ElementBlock<N>,
    nodes: usize,
    mut of: impl FnMut(usize, &mut [[f64; K]; N]) -> Result<(), ElementFault>,
) -> Vec<[f64; K]> {
    let mut sum = vec![[0.0; K]; nodes];
    let mut weight = vec![0.0; nodes];
    for e in 0..block.elements() {
        let mut nodal = [[0.0; K]; N];
        if of(e, &mut nodal).is_err() {
            continue;
        }
        let volume = block.volume(e);
        for (n, nodal) in block.nodes_of(e).into_iter().zip(&nodal).take(count) {
            weight[n as usize] += volume;
            for (s, v) in sum[n as usize].iter_mut().zip(nodal) {
                *s += volume * v;
            }
        }
    }
    for (s, w) in sum.iter_mut().zip(&weight) {
        if *w > 0.0 {
            s.iter_mut().for_each(|v| *v /= w);
        }
    }
    sum
}
