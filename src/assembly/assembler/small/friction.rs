//! Friction at small displacements: normals and feet stay, so that the traction of a point is a function of its displacement
//! relative to its master alone.
use super::super::{Assembler, Fault};
use crate::contact::friction::law::Slide;
use crate::contact::friction::rigid::Friction;
use crate::contact::friction::steady::Directed;
use crate::contact::kernel::Normal;
use crate::contact::law::{NormalLaw, PairLaw, Penalty};
use crate::model::Model;
use crate::model::friction::with_law;
use crate::model::state::State;
use covact_geometry::Vec3;
use nalgebra::Matrix3;

/// Tangential traction of a slave point.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct Rubbing {
    /// The point is in contact.
    touches: bool,
    slides: bool,
    /// Pressure that limits friction (force / length^2).
    pressure: f64,
    /// Traction on the slave, as it stands in the residual (force / length^2).
    pub t: Vec3,
    /// Its derivative with respect to the displacement of the point relative to its master (force / length^3).
    pub tangent: Matrix3<f64>,
}

impl Rubbing {
    /// Itself where the point is in contact.
    #[inline]
    pub fn of(&self) -> Option<&Rubbing> {
        self.touches.then_some(self)
    }
}

/// Room for all points with history where any pair has friction.
pub(super) fn rubbing(model: &Model) -> Vec<Rubbing> {
    match model.pairs.iter().any(|p| p.friction.is_some()) {
        true => vec![Rubbing::default(); model.histories()],
        false => Vec::new(),
    }
}

/// Those of a pair; none of one without friction.
pub(super) fn of_pair<'a>(
    all: &'a [Rubbing],
    model: &Model,
    state: &State,
    index: usize,
) -> Option<&'a [Rubbing]> {
    model.pairs[index].friction.as_ref()?;
    all.get(state.history(model, index)?)
}

/// The matrix of a point, column-major, where `k` is the derivative of the force on the slave with respect to the displacement
/// relative to the master. Of that a node has `weights I`, and those of the master, the last ones, `arms x n` more.
pub(super) fn assemble(
    k: &Matrix3<f64>,
    n: &Vec3,
    weights: &[f64],
    arms: &[Vec3],
    ke: &mut Vec<f64>,
) {
    let slaves = weights.len() - arms.len();
    let arm = |node: usize| node.checked_sub(slaves).map(|m| &arms[m]);
    for (b, weight) in weights.iter().enumerate() {
        for c in 0..3 {
            let mut column = k.column(c) * *weight;
            if let Some(arm) = arm(b) {
                column += k * arm * n[c];
            }
            for (a, weight) in weights.iter().enumerate() {
                let turned = arm(a).map_or(0.0, |arm| arm.dot(&column));
                ke.extend((0..3).map(|r| weight * column[r] + n[r] * turned));
            }
        }
    }
}

impl<L: PairLaw> Assembler<'_, L> {
    /// Evaluates friction at the gaps of the last evaluation. A point that the first linearisation keeps in contact above its
    /// master has the limit of the last step, and those of a search along an increment have that of the last linearisation.
    pub(super) fn rub(&mut self, state: &State, time: f64) -> Result<(), Fault> {
        let model = self.model;
        let (Some(linear), Some(small)) = (self.linear.as_deref_mut(), &model.small) else {
            return Ok(());
        };
        if linear.rubbing.is_empty() {
            return Ok(());
        }
        let slide = self.linearization.slide;
        let mut first = 0;
        for (index, (pair, own)) in model.pairs.iter().zip(&small.pairs).enumerate() {
            let range = first..first + pair.points.len();
            first = range.end;
            let (Some(friction), Some(at)) = (&pair.friction, state.history(model, index)) else {
                continue;
            };
            let eps_n = self.penalties[index];
            let (law_n, eps_t) = (Penalty { eps_n }, self.ratios[index] * eps_n);
            let motion = model.small_motion(pair, time)?;
            let pose = model.small_pose(pair)?;
            let known = (state.histories[at.clone()].iter()).zip(&self.slips[at.clone()]);
            let out = &mut linear.rubbing[at];
            with_law!(friction.law.at(time)?, law => {
                let law = Directed::new(law, |e| pose * e);
                let friction = Friction { law, eps_t };
                for (i, (out, (history, turning))) in out.iter_mut().zip(known).enumerate() {
                    let before = std::mem::take(out);
                    let gap = linear.gaps[range.start + i];
                    let closed = state.points[range.start + i].closed;
                    let Some(at) = &own.points[i] else { continue };
                    let normal = match (gap < 0.0, self.linearization.keep_active) {
                        _ if linear.searches => {
                            out.pressure = before.pressure;
                            Normal { n: -before.pressure, dn: 0.0 }
                        }
                        _ if !closed => continue,
                        (true, _) => law_n.response(gap),
                        (false, true) => Normal { n: history.n, dn: 0.0 },
                        (false, false) => continue,
                    };
                    if normal.n >= 0.0 {
                        continue;
                    }
                    let w = own.slip(i, at, &pair.points[i], motion.as_ref(), &state.u);
                    let secant = friction.sliding(slide, turning);
                    let found = secant.steady(history, &w, &at.normal, gap, &normal);
                    *out = Rubbing {
                        touches: true,
                        slides: found.slip.slides,
                        pressure: -normal.n,
                        t: found.slip.t,
                        tangent: found.tangent,
                    };
                }
            });
        }
        Ok(())
    }

    /// The residual at another state near the last linearisation, with the limits of friction that its points had there: what acts then
    /// has a potential, and a convex one.
    ///
    /// # Errors
    /// As [`Self::small_residual`].
    pub fn small_search(
        &mut self,
        state: &State,
        time: f64,
        residual: &mut [f64],
    ) -> Result<(), Fault> {
        self.limits_stay(true);
        let found = self.small_residual(state, time, residual);
        self.limits_stay(false);
        found.map(drop)
    }

    fn limits_stay(&mut self, on: bool) {
        if let Some(linear) = self.linear.as_deref_mut() {
            linear.searches = on;
        }
    }

    /// Takes the tractions of the last evaluation as those that the next linearisation compares with.
    pub fn small_note(&mut self) {
        let Some(linear) = self.linear.as_deref() else {
            return;
        };
        if self.linearization.slide == Slide::Stick {
            return;
        }
        for (slip, rubs) in self.slips.iter_mut().zip(&linear.rubbing) {
            slip.take(rubs.of().map(|rubs| (&rubs.t, rubs.slides)));
        }
    }
}
