//! What the readers of curves and surfaces look at, and how much they may read.

use super::entity::{Entity, Told};
use super::exchange::Exchange;
use crate::io::brep::Grant;
use std::cell::Cell;
use std::rc::Rc;

/// Instances that may be read for each one in the file: honest files read each a few times, but references to references
/// could multiply without end.
const READS: u64 = 64;
const FREE: u64 = 10_000;
/// Curves of curves and surfaces of surfaces may be nested this deep.
pub const DEPTH: usize = 16;

/// What may still be read of a file, and computed.
pub struct Budget {
    reads: Cell<u64>,
    /// Work and memory.
    pub grant: Rc<Grant>,
}

impl Budget {
    pub fn of(exchange: &Exchange) -> Self {
        Self {
            reads: Cell::new(FREE + READS * exchange.len() as u64),
            grant: Rc::new(Grant::of_length(exchange.bytes())),
        }
    }

    pub fn take(&self, count: usize) -> Told<()> {
        match self.reads.get().checked_sub(count as u64 + 1) {
            Some(left) => {
                self.reads.set(left);
                Ok(())
            }
            None => Err(format!(
                "not read, for what the file refers to was read {READS} times over already"
            )),
        }
    }
}

/// A file with the units of one of its representations.
#[derive(Clone, Copy)]
pub struct Scope<'s, 'a> {
    pub exchange: &'s Exchange<'a>,
    pub budget: &'s Budget,
    /// Radians in a unit of plane angles.
    pub angle: f64,
    /// Points nearer than this are one, in the unit of lengths; 0 where the file does not say.
    pub near: f64,
}

impl<'s, 'a> Scope<'s, 'a> {
    /// An instance at a depth of nested definitions.
    pub fn entity(&self, index: u32, depth: usize) -> Told<Entity<'s, 'a>> {
        let entity = Entity::read(self.exchange, index)?;
        if depth > DEPTH {
            return Err(format!(
                "{} is nested more than {DEPTH} deep, or refers to itself",
                entity.describe()
            ));
        }
        self.budget.take(0)?;
        Ok(entity)
    }
}
