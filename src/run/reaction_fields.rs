//! Nodal reactions, worked out for the output only.
use super::motion_fields::MotionFields;
use crate::model::loads::follower_force;
use crate::model::sheet_pressure::DOFS;
use crate::model::state::State;
use crate::model::{BodyModel, Model};
use crate::output::NOT_A_SLAVE;
use crate::scene::ValueError;
use crate::shell::{ElementBlock, ElementSystem, with_block};
use covact_geometry::Vec3;
use rayon::prelude::*;

/// Forces that supports and contacts exert on the nodes, three numbers a node: internal minus external forces of an accepted
/// state, with those of inertia where there is any, at the degrees of freedom that supports hold and at the nodes of slaves (those with a `status`) and of bodies as
/// masters, zero elsewhere. None where a load has no value at `time`.
pub(super) fn reactions(
    model: &Model,
    state: &State,
    (status, motion): (&[u8], Option<&MotionFields>),
    time: f64,
) -> Option<Vec<f64>> {
    let mut forces = vec![0.0; 3 * model.nodes.len()];
    let mut first = 0;
    for body in &model.bodies {
        let len = model.state_len(body) * body.block.elements();
        let states = &state.elements[first..first + len];
        first += len;
        with_block!(&body.block, block => match model.small {
            None => internal(body, block, states, &state.u, &mut forces),
            Some(_) => linear(body, block, &state.u, &mut forces),
        });
    }
    let inertia = motion.into_iter().flat_map(|m| &m.forces);
    for (force, inertia) in forces.iter_mut().zip(inertia) {
        *force += inertia;
    }
    let mut external = vec![0.0; forces.len()];
    add_loads(model, &state.u, time, &mut external).ok()?;
    let exerted = exerted(model, status);
    for ((force, external), exerted) in forces.iter_mut().zip(external).zip(exerted) {
        *force = if exerted { *force - external } else { 0.0 };
    }
    Some(forces)
}

/// Degrees of freedom that a support or a contact may exert a force on.
fn exerted(model: &Model, status: &[u8]) -> Vec<bool> {
    let mut out: Vec<bool> = (status.iter())
        .flat_map(|status| [*status != NOT_A_SLAVE; 3])
        .collect();
    let means = model.means.iter().flat_map(|m| [m.tied, m.free]);
    for dof in model.prescribed.iter().map(|p| p.dof).chain(means) {
        out[dof as usize] = true;
    }
    for master in model.pairs.iter().filter_map(|p| p.body_master()) {
        let body = &model.bodies[master.body];
        for node in body.mesh.nodes_of(&master.faces) {
            let first = 3 * (body.first_node + node) as usize;
            out[first..first + 3].fill(true);
        }
    }
    out
}

/// Adds the forces of elements in their accepted states.
fn internal<const N: usize, B: ElementBlock<N>>(
    body: &BodyModel,
    block: &B,
    states: &[f64],
    u: &[f64],
    forces: &mut [f64],
) where
    B::Forces: Send,
{
    let len = block.state_len();
    let of = |e: usize| -> Option<B::Forces> {
        let now = body.displacements(block, e, u);
        // Before the first step nothing is condensed yet, and there are no forces. An element that is impossible has none
        // to show.
        let moved = now.iter().any(|u| *u != Vec3::zeros());
        let mut f = B::NO_FORCES;
        let own = &states[e * len..(e + 1) * len];
        (moved && block.residual(e, &now, own, &mut f).is_ok()).then_some(f)
    };
    let all: Vec<Option<B::Forces>> = (0..block.elements())
        .into_par_iter()
        .with_min_len(16)
        .map(of)
        .collect();
    for (e, f) in all.iter().enumerate() {
        if let Some(f) = f {
            add(forces, body.nodes_of(block, e), f.as_ref());
        }
    }
}

/// Adds the forces `K u` of linear elements.
fn linear<const N: usize, B: ElementBlock<N>>(
    body: &BodyModel,
    block: &B,
    u: &[f64],
    forces: &mut [f64],
) {
    let (mut own, mut system) = (vec![0.0; block.state_len()], B::System::default());
    let mut f = vec![0.0; 3 * N];
    for e in 0..block.elements() {
        own.fill(0.0);
        let still = [Vec3::zeros(); N];
        if block.evaluate(e, &still, &mut own, &mut system).is_err() {
            continue;
        }
        f.fill(0.0);
        let (_, stiffness, _) = system.parts();
        let now = body.displacements(block, e, u);
        for (column, u) in stiffness.chunks_exact(3 * N).zip(now.iter().flatten()) {
            f.iter_mut().zip(column).for_each(|(f, k)| *f += k * u);
        }
        add(forces, body.nodes_of(block, e), &f);
    }
}

fn add<const N: usize>(forces: &mut [f64], nodes: [u32; N], own: &[f64]) {
    for (node, own) in nodes.into_iter().zip(own.chunks_exact(3)) {
        let at = 3 * node as usize;
        (forces[at..at + 3].iter_mut().zip(own)).for_each(|(f, own)| *f += own);
    }
}

/// Adds all loads; those that follow the body do so unless displacements are small.
fn add_loads(model: &Model, u: &[f64], time: f64, external: &mut [f64]) -> Result<(), ValueError> {
    for (_, load) in &model.dead_loads {
        load.add(time, external)?;
    }
    let (mut x, mut f) = ([Vec3::zeros(); 9], [0.0; 27]);
    for (_, load) in &model.follower_loads {
        let pressure = load.value.eval(time)?;
        for face in &load.faces {
            for (x, &n) in x.iter_mut().zip(face.nodes()) {
                *x = match model.small {
                    None => model.position(n as usize, u),
                    Some(_) => model.nodes[n as usize],
                };
            }
            follower_force(&x, face.count, pressure, &mut f);
            for (&node, own) in face.nodes().iter().zip(f.chunks_exact(3)) {
                add(external, [node], own);
            }
        }
        let mut own = [0.0; DOFS];
        for span in &load.spans {
            let x = span.nodes().map(|n| match model.small {
                None => model.position(n as usize, u),
                Some(_) => model.nodes[n as usize],
            });
            span.force(&x, pressure, &mut own, None);
            add(external, *span.nodes(), &own);
        }
    }
    Ok(())
}
