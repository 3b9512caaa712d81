//! Slave points of a pair between bodies at the state evaluated last: those in contact.
use super::{Fault, PairForce, Totals};
use crate::contact::rigid::PointFault;
use crate::model::state::{PointState, heap};
use crate::model::{HalfPass, Model, PairModel};
use covact_geometry::Vec3;

/// What every point of a pair met, and which of them touch.
#[derive(Debug, Clone)]
pub(super) struct Touched<T> {
    pub all: Vec<Result<Option<T>, PointFault>>,
    /// Points in contact, ascending.
    pub active: Vec<u32>,
}

impl<T> Default for Touched<T> {
    fn default() -> Self {
        Touched {
            all: Vec::new(),
            active: Vec::new(),
        }
    }
}

impl<T: Clone> Touched<T> {
    /// Bytes of heap that it holds.
    pub fn bytes(&self) -> usize {
        heap(&self.all) + heap(&self.active)
    }

    /// Room for a number of points, all of them open.
    pub fn resize(&mut self, points: usize) {
        self.all.clear();
        self.all.reserve_exact(points);
        self.all.resize(points, Ok(None));
        self.active.clear();
        self.active.reserve_exact(points);
    }

    /// What a point touches.
    #[inline]
    pub fn get(&self, point: u32) -> Option<&T> {
        of(&self.all[point as usize])
    }

    /// Finds the points in contact, once all are evaluated; `position` is where a point is.
    ///
    /// # Errors
    /// The fault of the first point that has one.
    pub fn settle(
        &mut self,
        pair: &PairModel,
        position: impl Fn(usize) -> Vec3,
    ) -> Result<(), Fault> {
        self.active.clear();
        for (i, touch) in self.all.iter().enumerate() {
            match touch {
                Err(fault) => return Err(Fault::contact(pair, i, &position(i), *fault)),
                Ok(None) => {}
                Ok(Some(_)) => self.active.push(i as u32),
            }
        }
        Ok(())
    }

    /// Takes the status of every point into its state, and counts.
    pub fn note(&self, states: &mut [PointState], totals: &mut Totals) {
        for (state, touch) in states.iter_mut().zip(&self.all) {
            let closed = of(touch).is_some();
            totals.changed += usize::from(closed != state.closed);
            totals.opened_on_bodies += usize::from(state.closed && !closed);
            state.closed = closed;
        }
        totals.active += self.active.len();
    }
}

/// What a point touches.
pub(super) fn of<T>(touch: &Result<Option<T>, PointFault>) -> Option<&T> {
    touch.as_ref().ok().and_then(Option::as_ref)
}

impl Totals {
    /// Ends pair `index`: what acts between its bodies, its deepest penetration, and whether it touches. Of two half passes
    /// each tells the force on its own slave; what acts at the edges of a master acts on the sides of its contact.
    pub(super) fn end_pair(
        &mut self,
        model: &Model,
        index: usize,
        force: PairForce,
        deepest: f64,
        touching: bool,
    ) {
        self.penetration.push(deepest);
        self.touching.push(touching);
        let pair = &model.pairs[index];
        if let Some(of) = pair.edges_of {
            self.pairs[of].slave.join(&force.master);
            match model.pairs[of].rigid_master() {
                Some(surface) => self.surfaces[surface].join(&force.master),
                None => self.pairs[of].master.join(&force.slave),
            }
            return;
        }
        match pair.half {
            Some(HalfPass { other, back: true }) => self.pairs[other].master = force.slave,
            Some(_) => self.pairs[index].slave = force.slave,
            None => self.pairs[index] = force,
        }
    }
}
