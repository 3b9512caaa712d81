//! Where in the model something went wrong, in words.
use crate::assembly::Assembler;
use crate::model::Model;
use crate::model::sheet_pressure::FollowingSpan;
use crate::model::state::State;
use crate::scene::ValueError;
use crate::system::linear::LinearError;
use covact_geometry::Vec3;

fn near(x: &Vec3) -> String {
    format!("near ({:.6e}, {:.6e}, {:.6e})", x.x, x.y, x.z)
}

/// A node: its body and its number there, or the surface that it drives.
fn node(model: &Model, node: usize) -> String {
    for (_, surface, driven) in model.driven() {
        if driven.nodes().contains(&(node as u32)) {
            return format!("surface `{}`, which forces drive", surface.name);
        }
    }
    let body = (model.bodies.iter()).rfind(|b| b.first_node as usize <= node);
    match body {
        Some(body) => format!(
            "node {} of body `{}` {}",
            node - body.first_node as usize,
            body.name,
            near(&model.nodes[node])
        ),
        None => format!("node {node}"),
    }
}

/// The node that an error of the linear solver names, in the terms of the scene; empty where it names none.
pub(super) fn of_linear(model: &Model, error: &LinearError) -> String {
    let at = match error {
        LinearError::NonPositivePivot { dof }
        | LinearError::ZeroPivot { dof }
        | LinearError::TinyPivot { dof, .. }
        | LinearError::ZeroRow { dof }
        | LinearError::NonFiniteRightHandSide { dof }
        | LinearError::NonFiniteSolution { dof } => dof.node,
        LinearError::NonFiniteMatrix { row, .. } => *row,
        _ => return String::new(),
    };
    match (at as usize) < model.nodes.len() {
        true => format!(", at {}", node(model, at as usize)),
        false => String::new(),
    }
}

/// What made a residual that is not finite: displacements, loads, contact or an element, by name and place.
pub(super) fn not_finite(
    model: &Model,
    assembler: &Assembler,
    state: &State,
    residual: &[f64],
) -> String {
    if let Some(dof) = state.u.iter().position(|u| !u.is_finite()) {
        return format!("the displacement of {}", node(model, dof / 3));
    }
    let Some(dof) = residual.iter().position(|r| !r.is_finite()) else {
        return "the sum of the squares of all forces".to_owned();
    };
    let at = dof / 3;
    let wrong = |forces: &[f64]| forces.get(dof).is_some_and(|f| !f.is_finite());
    if wrong(assembler.external()) {
        return format!("the load at {}", node(model, at));
    }
    if wrong(assembler.contact_forces()) {
        for (index, pair) in model.pairs.iter().enumerate() {
            let mut points = state.slaves(model, index).iter().enumerate();
            if let Some((point, p)) = points.find(|(_, p)| model.terms(p).any(|(n, _)| n == at)) {
                let x = model.point_position(p, &state.u);
                return format!(
                    "the contact force of contact `{}`, slave point {point} {}",
                    pair.name,
                    near(&x)
                );
            }
        }
        return format!("the contact force at {}", node(model, at));
    }
    for body in &model.bodies {
        let elements = 0..body.block.elements();
        let mut holding = elements.filter(|&e| body.element_nodes(e).any(|n| n as usize == at));
        if let Some(element) = holding.next() {
            return format!(
                "the forces of element {element} of body `{}`, at {}",
                body.name,
                node(model, at)
            );
        }
    }
    format!("the force at {}", node(model, at))
}

/// What in the scene has no value at `time`, as a JSON pointer, where `error` came from evaluating it.
pub fn without_value(
    model: &Model,
    state: &State,
    time: f64,
    error: &ValueError,
) -> Option<String> {
    // Values that are no numbers differ from themselves.
    let told = error.to_string();
    let is = |e: &ValueError| e.to_string() == told;
    let mut forces = vec![0.0; 3 * model.nodes.len()];
    for (name, load) in &model.dead_loads {
        if load.add(time, &mut forces).is_err_and(|e| is(&e)) {
            return Some(format!("/loads/{name}"));
        }
    }
    for (name, load) in &model.follower_loads {
        if load.value.eval(time).is_err_and(|e| is(&e)) {
            let couple = matches!(load.spans.first(), Some(FollowingSpan::Couple(_)));
            let key = if couple { "couple" } else { "pressure" };
            return Some(format!("/loads/{name}/{key}"));
        }
    }
    for surface in &model.surfaces {
        if surface.motion.pose(time).is_err_and(|e| is(&e)) {
            return Some(format!("/surfaces/{}/motion", surface.name));
        }
        let driven = surface.driven.as_ref();
        if driven.is_some_and(|d| d.driving(time, &state.u).is_err_and(|e| is(&e))) {
            return Some(format!("/surfaces/{}/motion/free", surface.name));
        }
    }
    for pair in &model.pairs {
        let friction = pair.friction.as_ref();
        if friction.is_some_and(|f| f.law.at(time).is_err_and(|e| is(&e))) {
            return Some(format!("/contacts/{}/friction", pair.name));
        }
    }
    let place = |dof: u32| model.nodes[dof as usize / 3];
    let value = |f: &Option<crate::scene::TimeFunction>, x: Vec3| {
        f.as_ref()
            .is_some_and(|f| f.eval_at(&x, time).is_err_and(|e| is(&e)))
    };
    let held = (model.prescribed.iter())
        .find(|p| value(&p.value, place(p.dof)))
        .map(|p| p.support);
    let middle = (model.means.iter())
        .find(|m| value(&m.mean, (place(m.free) + place(m.tied)) * 0.5))
        .map(|m| m.support);
    (held.or(middle)).map(|s| format!("/supports/{}", model.supports[s as usize]))
}
