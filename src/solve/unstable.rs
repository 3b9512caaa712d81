//! What to say of a step that has no equilibrium near it: where the structure gives way, and what helps.
use crate::model::error::number;
use crate::model::free_motion::free_motions;
use crate::model::{BodyModel, Model};
use crate::system::linear::{Factorization, LinearError, Method};
use covact_geometry::Vec3;

/// A tangent with negative pivots, and where the structure gives way most.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Unstable {
    method: Method,
    negative: usize,
    /// Node that the increment moves most, and its part of the increment.
    node: usize,
    increment: Vec3,
}

impl Unstable {
    /// Of an increment that was solved for with this factorization; nothing where the tangent is stable.
    pub fn of(model: &Model, factorization: &Factorization, du: &[f64]) -> Option<Unstable> {
        if factorization.negative_pivots == 0 {
            return None;
        }
        let at = |n: usize| Vec3::new(du[3 * n], du[3 * n + 1], du[3 * n + 2]);
        let node = (0..model.body_nodes())
            .max_by(|a, b| at(*a).norm_squared().total_cmp(&at(*b).norm_squared()))?;
        Some(Unstable {
            method: factorization.method,
            negative: factorization.negative_pivots,
            node,
            increment: at(node),
        })
    }

    /// The body that gives way most.
    pub fn body<'m>(&self, model: &'m Model) -> Option<&'m BodyModel> {
        (model.bodies.iter()).rfind(|b| b.first_node as usize <= self.node)
    }

    /// What it means and what helps; `stabilized` says whether the step is stabilised already.
    pub fn words(&self, model: &Model, stabilized: bool) -> String {
        let pivots = match self.method {
            Method::Lu => "the determinant of a tangent was negative".to_owned(),
            _ => format!("a tangent had {} negative pivot(s)", self.negative),
        };
        let axis = ["x", "y", "z"][self.increment.iamax()];
        format!(
            "{pivots}: {} gives way along {axis}, where it may buckle or snap through: {}",
            place(model, self.node),
            remedy(model, stabilized)
        )
    }
}

/// What a matrix that cannot be factorized says of a body: none where the error names no degree of freedom of one.
pub fn singular(model: &Model, error: &LinearError, stabilized: bool) -> Option<String> {
    let (LinearError::NonPositivePivot { dof }
    | LinearError::ZeroPivot { dof }
    | LinearError::TinyPivot { dof, .. }
    | LinearError::ZeroRow { dof }) = error
    else {
        return None;
    };
    let node = dof.node as usize;
    if node >= model.body_nodes() {
        return None;
    }
    let axis = ["x", "y", "z"][usize::from(dof.component.min(2))];
    let free = free_motions(model);
    let loose = (free.iter().find(|f| f.nodes.contains(&dof.node))).map_or_else(String::new, |f| {
        format!(", and no support hinders its motion {}", f.motion)
    });
    Some(format!(
        "nothing resists {} along {axis}{loose}: {}",
        place(model, node),
        remedy(model, stabilized)
    ))
}

/// Body and undeformed position of a node.
fn place(model: &Model, node: usize) -> String {
    let body = (model.bodies.iter()).rfind(|b| b.first_node as usize <= node);
    let x = model.nodes[node];
    format!(
        "body `{}` near ({}, {}, {})",
        body.map_or("", |b| &b.name),
        number(x.x),
        number(x.y),
        number(x.z)
    )
}

fn remedy(model: &Model, stabilized: bool) -> &'static str {
    match (stabilized, &model.stabilization) {
        (true, _) => "take a larger `factor` of `solution.stabilization`, or a smaller `step.min`",
        (false, Some(_)) => {
            "let `solution.stabilization` act for longer (`until`), or hold it with a support"
        }
        (false, None) if model.loaded() => {
            "ask for `solution.stabilization`, hold it with a support, or prescribe its displacement instead of a force"
        }
        (false, None) => "ask for `solution.stabilization`, or hold it with a support",
    }
}
