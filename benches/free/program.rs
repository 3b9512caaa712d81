//! The contact evaluation as the program does it.
use crate::scene::{self, Distance, TIME};
use covact::assembly::{Assembler, Totals};
use covact::model::Model;
use covact::model::state::State;

/// An assembler with all that an evaluation needs.
pub struct Program<'m> {
    pub model: &'m Model,
    pub assembler: Assembler<'m>,
    /// Where an evaluation starts, and where it ends.
    pub start: State,
    pub state: State,
    pub residual: Vec<f64>,
    rhs: Vec<f64>,
    pub totals: Totals,
}

impl<'m> Program<'m> {
    pub fn new(model: &'m Model) -> Self {
        let n = 3 * model.nodes.len();
        Program {
            model,
            assembler: Assembler::new(model, &model.dofs).expect("a pattern"),
            start: State::new(model),
            state: State::new(model),
            residual: vec![0.0; n],
            rhs: vec![0.0; n],
            totals: Totals::default(),
        }
    }

    /// Brings the plate to a distance from the ball, with searches that start where they ended a little before.
    pub fn bring(&mut self, distance: Distance) {
        self.state = scene::state(self.model, distance, -0.01);
        self.evaluate();
        self.start = scene::state(self.model, distance, 0.0);
        self.start.points.clone_from(&self.state.points);
    }

    /// Takes back an evaluation.
    pub fn reset(&mut self) {
        self.state.copy_from(&self.start);
        self.assembler.clear_matrix();
    }

    /// Residual and tangent of contact.
    pub fn evaluate(&mut self) {
        let Program {
            assembler,
            state,
            residual,
            rhs,
            ..
        } = self;
        let totals = assembler.linearize_contact(state, TIME, None, residual, rhs);
        self.totals = totals.expect("every point can be evaluated");
    }

    /// The numbers of [`crate::kernel::Sums::numbers`], each times a scale that makes them comparable.
    pub fn numbers(&self) -> [f64; 13] {
        let t = &self.totals;
        let on = &t.surfaces[0];
        numbers(
            [on.force, on.moment],
            [t.contact_energy, t.penetration[0], t.contact_norm],
            [t.active, t.changed, t.opened],
            t.contact_rounding,
        )
    }
}

/// All of them of the same order, for a comparison relative to the largest.
pub fn numbers(
    [force, moment]: [covact_geometry::Vec3; 2],
    [energy, deepest, norm]: [f64; 3],
    counts: [usize; 3],
    rounding: f64,
) -> [f64; 13] {
    let [active, changed, opened] = counts.map(|n| n as f64);
    let r = 1.0 / scene::RADIUS;
    [
        force.x,
        force.y,
        force.z,
        moment.x * r,
        moment.y * r,
        moment.z * r,
        energy,
        deepest,
        norm,
        active,
        changed,
        opened,
        rounding,
    ]
}
