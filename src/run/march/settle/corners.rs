//! Penalties under which faces of both sides press on each other with their corners, because they do not fit each other where they bend.
use super::{March, Tried};
use crate::assembly::Totals;
use crate::model::error::number;
use crate::model::{Model, PairModel};
use crate::run::bearing::Bearings;
use crate::solve::newton::RigidLimit;

/// Error of a step from which on it says nothing of what stiffer contact makes of a force, times of what it says that are far beyond it,
/// part of the largest force of a contact below which no change counts, and penetration relative to the size of an element above which
/// it is not the folds of faces that press: they stand out from the chord by an eighth of the angle between faces, 0.1 at most.
const KNOWN: f64 = 0.5;
const BEYOND: f64 = 5.0;
const COUNTS: f64 = 0.2;
const STANDS_OUT: f64 = 0.1 / 8.0;

/// Whether the master of a pair is made of a body's faces as they are: where these bend, their folds are corners.
pub(super) fn has_folds(pair: &PairModel) -> bool {
    pair.body_master().is_some_and(|master| !master.smooth)
}

/// How the warning begins that the force of a pair follows its penalty.
pub(super) fn outrun(model: &Model, index: usize) -> String {
    let name = &model.pairs[index].name;
    format!("contact `{name}`: its force follows its penalty")
}

impl March<'_, '_> {
    /// The contact whose penalty was raised and whose force, now of `totals`, has changed by far more than rigid contact would have
    /// changed it.
    pub(super) fn outruns(&self, tried: &Tried, totals: &Totals) -> Option<usize> {
        let limit = tried.limit.as_ref()?;
        let index = limit.outrun(self.model, [&tried.totals, totals], tried.outran.is_some())?;
        (self.assembler.penalties[index] > tried.penalties[index]).then_some(index)
    }

    /// A contact of which points have let go under its raised penalty while its force rose far beyond what the error before allows for,
    /// and whose faces have folds. A path that is about to touch has more points in contact after a raise.
    pub(super) fn parted(
        &self,
        tried: &Tried,
        totals: &Totals,
        bearings: &Bearings,
    ) -> Option<usize> {
        let part = tried.errors.sum();
        let mut pairs = 0..self.model.pairs.len();
        let of = |index: usize, t: &Totals| RigidLimit::of_pair(self.model, index, t);
        let largest = (pairs.clone()).fold(0.0, |most: f64, i| most.max(of(i, &tried.totals)));
        pairs.find(|&index| {
            let [before, after] = [&tried.totals, totals].map(|t| of(index, t));
            let allowed = (BEYOND * part / (1.0 - part)).max(1.0) * before;
            let pair = &self.model.pairs[index];
            let (active, deepest) = tried.points[index];
            has_folds(pair)
                && self.assembler.penalties[index] > tried.penalties[index]
                && bearings.pairs[index].active < active
                && deepest < STANDS_OUT * pair.element_size
                && part < KNOWN
                && before > COUNTS * largest
                && after - before > allowed
        })
    }

    /// Tells once of a contact whose force followed its penalty, raise after raise from the first one.
    pub(super) fn tell_outrun(
        &mut self,
        index: usize,
        time: f64,
        (first, totals): (&Tried, &Totals),
    ) {
        let head = outrun(self.model, index);
        if self.progress.warnings.iter().any(|w| w.starts_with(&head)) {
            return;
        }
        let [soft, stiff] =
            [&first.totals, totals].map(|t| RigidLimit::of_pair(self.model, index, t));
        self.warn(format!(
            "{head}: at time {} it is {}, and under one {} times stiffer {}, far more than the first one gives way. Faces of both sides \
             that do not fit each other where they bend press on each other with their corners. The softer one is kept; meshes that \
             match there, or finer ones, bring both forces together",
            number(time),
            number(soft),
            number(self.assembler.penalties[index] / first.penalties[index]),
            number(stiff)
        ));
    }
}
