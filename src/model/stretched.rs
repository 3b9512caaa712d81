//! Fibres at the border of a shell whose two ends a support moves alike along them: where they tilt they are stretched, and resist.
//!
//! A fibre of thickness `t` that tilts by `phi` becomes longer by `phi^2 / 2` of it. With elements of width `h` across the border its
//! couple is `E (h / 2) t phi^3 / 2` per length of the border, that of a strip of length `L` which is bent by turning its end
//! `E t^3 phi / (4 L)`: the border is held by `h L phi^2 / t^2` as a clamp would begin to.
use super::{BodyModel, Model};
use covact_geometry::Vec3;

/// Fibres of one body that a support holds along them.
#[derive(Debug, Clone, PartialEq)]
pub struct Stretched {
    /// Name of the support.
    pub support: String,
    /// Number of the body.
    pub body: usize,
    fibres: Vec<Fibre>,
}

#[derive(Debug, Clone, Copy, PartialEq)]
struct Fibre {
    nodes: [u32; 2],
    /// `h L / t^2`.
    resists: f64,
}

impl Stretched {
    /// Of fibres by their nodes, lengths and the widths of their elements; none where there are none.
    pub(super) fn new(
        support: &str,
        (number, body): (usize, &BodyModel),
        fibres: impl Iterator<Item = ([u32; 2], f64, f64)>,
    ) -> Option<Stretched> {
        let [low, high] = body.mesh.bounds();
        // A strip that is pressed in its middle.
        let span = 0.5 * (high - low).norm();
        let fibres: Vec<Fibre> = fibres
            .map(|(nodes, thickness, width)| Fibre {
                nodes,
                resists: width * span / (thickness * thickness),
            })
            .collect();
        (!fibres.is_empty()).then(|| Stretched {
            support: support.to_owned(),
            body: number,
            fibres,
        })
    }

    /// The largest tilt of a fibre at displacements `u` (radians), and how much it holds its border beside what bends the shell.
    pub fn worst(&self, model: &Model, u: &[f64]) -> [f64; 2] {
        let at = |node: u32| model.position(node as usize, u);
        let mut worst = [0.0; 2];
        for fibre in &self.fibres {
            let [a, b] = fibre.nodes;
            let before: Vec3 = model.nodes[b as usize] - model.nodes[a as usize];
            let now = at(b) - at(a);
            let tilt = before.cross(&now).norm().atan2(before.dot(&now));
            let holds = fibre.resists * tilt * tilt;
            if holds > worst[1] {
                worst = [tilt, holds];
            }
        }
        worst
    }
}
