//! Memory that an effect takes, from the sizes of the types that hold it.
use crate::shell::STATES;
use serde::Serialize;

/// Memory of one kind that an effect takes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
pub struct Held {
    /// Name of the part, as whoever holds it reports it.
    pub part: &'static str,
    /// Who holds it.
    pub holder: Holder,
    /// Bytes for one of what it is for.
    pub each: usize,
    /// What it is held for.
    pub per: Per,
    /// Number of those.
    pub count: usize,
    /// Times that a run holds it at once.
    pub copies: usize,
    /// This is what there is at the start, or the least of it; it may grow in the course of a run.
    pub grows: bool,
}

/// Who holds it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Holder {
    /// The model, once.
    Model,
    /// Every state of a run ([`crate::model::state::State::parts`]).
    State,
    /// The assembler, once ([`crate::assembly::Assembler::parts`]).
    Assembler,
    /// What is gathered for watching and for the output, once.
    Run,
}

/// What it is for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Per {
    /// A slave point.
    Point,
    /// An element.
    Element,
    /// A node.
    Node,
    /// The pair, the surface or the scene.
    Whole,
}

impl Held {
    fn new(holder: Holder, part: &'static str, per: Per, each: usize, count: usize) -> Held {
        Held {
            part,
            holder,
            each,
            per,
            count,
            copies: 1,
            grows: false,
        }
    }

    /// In every state of a run.
    pub(super) fn state(part: &'static str, per: Per, each: usize, count: usize) -> Held {
        Held {
            copies: STATES,
            ..Held::new(Holder::State, part, per, each, count)
        }
    }

    pub(super) fn model(part: &'static str, per: Per, each: usize, count: usize) -> Held {
        Held::new(Holder::Model, part, per, each, count)
    }

    pub(super) fn assembler(part: &'static str, per: Per, each: usize, count: usize) -> Held {
        Held::new(Holder::Assembler, part, per, each, count)
    }

    pub(super) fn run(part: &'static str, per: Per, each: usize, count: usize) -> Held {
        Held::new(Holder::Run, part, per, each, count)
    }

    /// It grows in the course of a run.
    pub(super) fn growing(self) -> Held {
        Held {
            grows: true,
            ..self
        }
    }

    /// What is held of every point: its number is another one with every step where slave faces are cut anew.
    pub(super) fn of_points(self, cut: bool) -> Held {
        if cut { self.growing() } else { self }
    }

    /// Bytes of all copies.
    pub fn bytes(&self) -> usize {
        self.each * self.count * self.copies
    }
}
