//! Where points with friction that are open will touch within a step.
//!
//! A point is tied to where it touches first, which lies between the ends of the step. Before the step is solved it is known how the
//! point moved in the last one, seen from the master. Should it go on like that, it is known where it would be at the middle of the step
//! and at its end, with the gaps there, and so where the gap is zero: right to second order however stiff the surface is, and exact for
//! motions that are even. Seen from the master, what moves with it does not count: a motion of all leaves the answer as it is.
//!
//! Where a run begins or a motion turns no last step tells. There tools move as is prescribed, and bodies stand still or go with
//! supports that carry them rigidly. Other points are left to the law of a gap that closes evenly
//! ([`crate::contact::friction::trial`]): under a stiff penalty that is hardly any friction in their first step. So are those of bodies
//! that roll, and those that meet their own body, whose walls turn on their way to each other.
use super::{March, StepControl};
use crate::contact::friction::anchor::Anchor;
use crate::contact::friction::history::PointHistory;
use crate::model::master::{BodySurface, Master, MasterNow, Masters};
use crate::model::state::State;
use crate::model::{Model, PairModel};
use covact_geometry::Vec3;
use nalgebra::{Isometry3, Point3, UnitQuaternion};
use std::ops::Range;

/// Least slope at which a point comes to its master, the gap that it closes over its way: of one that comes along the surface a small
/// error of the gap is a large one of the place.
const GRAZING: f64 = 0.1;
/// Angle that sides turn relative to each other in a step from which on one rolls on the other: a point then comes to its master on a
/// cycloid, without a way along it, and what creeps is less than a straight way is off. What bends turns as well, and does not roll.
const ROLLS: f64 = 0.02;

/// A side of a pair.
enum Side {
    Tool(usize),
    Body(usize),
}

/// How the points of a pair go in a step, seen from its master where that is now.
enum Goes {
    /// As in the last one; this one is so many times as large.
    On(f64),
    /// By these rigid motions to its middle and to its end.
    Along([Isometry3<f64>; 2]),
}

impl March<'_, '_> {
    /// Ties points of `committed` to where they will touch in a step of size `dt` to `end`. What has no value in it fails the step
    /// that is solved next, and is told there.
    pub(super) fn foresee(
        &mut self,
        committed: &mut State,
        walk: &StepControl,
        (dt, end): (f64, f64),
    ) {
        // Those of a step that was cut were tied for its size.
        for history in &mut committed.histories {
            history.ahead = Vec3::zeros();
        }
        let (model, masters) = (self.model, &mut self.assembler.masters);
        if model.small.is_some() || walk.before.is_none() && model.dynamics.is_some() {
            return;
        }
        let mut placed = false;
        let mut first = 0;
        for (index, pair) in model.pairs.iter().enumerate() {
            let points = first..first + committed.slaves(model, index).len();
            first = points.end;
            // Segments are other points in every step.
            if pair.friction.is_none() || pair.master.is_own() || pair.segments().is_some() {
                continue;
            }
            let Some(histories) = committed.history(model, index) else {
                continue;
            };
            let open = |h: &PointHistory| h.approach > 0.0 && h.approach.is_finite();
            if !committed.histories[histories.clone()].iter().any(open) {
                continue;
            }
            let times = [end - dt, end];
            let goes = match &walk.before {
                Some(before) => Goes::on(model, pair, before, committed, times),
                None => Goes::along(model, pair, &committed.u, times),
            };
            let Some(goes) = goes else {
                continue;
            };
            if !placed && pair.body_master().is_some() {
                masters.update(model, &committed.u);
                placed = true;
            }
            let at = (points, histories.clone(), times);
            for (i, ahead) in touching(model, masters, (index, &goes), at, committed) {
                committed.histories[histories.start + i].ahead = ahead;
            }
        }
    }
}

impl Side {
    /// Slave and master of a pair.
    fn of(model: &Model, pair: &PairModel) -> [Side; 2] {
        let master = match &pair.master {
            Master::Rigid(surface) => Side::Tool(*surface),
            Master::Body(body) => Side::Body(body.body),
        };
        let slave = match pair.edges_of.map(|of| &model.pairs[of].master) {
            Some(Master::Rigid(surface)) => Side::Tool(*surface),
            _ => Side::Body(pair.body),
        };
        [slave, master]
    }

    /// How it turned as a whole from one state to another: a body with the supports that carry it rigidly, or not at all.
    fn turned(
        &self,
        model: &Model,
        (from, start): (&State, f64),
        (to, end): (&State, f64),
    ) -> Option<UnitQuaternion<f64>> {
        match self {
            Side::Tool(surface) => {
                let surface = &model.surfaces[*surface];
                let pose = |state: &State, time| Some(surface.at(time, &state.u).ok()?.pose);
                Some(pose(to, end)?.rotation * pose(from, start)?.rotation.inverse())
            }
            Side::Body(body) => {
                let carried = model.carried(*body, &from.u, end).ok()?;
                Some(carried.unwrap_or_default().rotation)
            }
        }
    }

    /// The rigid motion that is prescribed of it, from the displacements `u` at time `now` on. Nothing where forces take it, or supports move
    /// it and not rigidly.
    fn goes(&self, model: &Model, u: &[f64], [now, time]: [f64; 2]) -> Option<Isometry3<f64>> {
        match self {
            Side::Tool(surface) => {
                let surface = &model.surfaces[*surface];
                let pose = |time| Some(surface.at(time, u).ok()?.pose);
                let known = surface.driven.is_none();
                known.then(|| Some(pose(time)? * pose(now)?.inverse()))?
            }
            Side::Body(body) => model.carried(*body, u, time).ok()?,
        }
    }
}

impl Goes {
    /// On as in the last step, between times; nothing where a side rolls on the other.
    fn on(
        model: &Model,
        pair: &PairModel,
        (before, size): &(State, f64),
        committed: &State,
        [now, end]: [f64; 2],
    ) -> Option<Self> {
        let (from, to) = ((before, now - size), (committed, now));
        let [slave, master] = Side::of(model, pair).map(|side| side.turned(model, from, to));
        let ratio = (end - now) / size;
        (ratio * slave?.angle_to(&master?) < ROLLS).then_some(Goes::On(ratio))
    }

    /// As is prescribed.
    fn along(model: &Model, pair: &PairModel, u: &[f64], [now, end]: [f64; 2]) -> Option<Self> {
        let [slave, master] = Side::of(model, pair);
        let to = |time| {
            let at = [now, time];
            Some(master.goes(model, u, at)?.inverse() * slave.goes(model, u, at)?)
        };
        Some(Goes::Along([to(0.5 * (now + end))?, to(end)?]))
    }

    /// The ways of a point to the middle of the step and to its end.
    fn ways(&self, point: &Open) -> [Vec3; 2] {
        match self {
            Goes::On(ratio) => [0.5 * ratio, *ratio].map(|part| point.went * part),
            Goes::Along(moved) => {
                let x = Point3::from(point.x);
                moved.map(|moved| (moved * x).coords - point.x)
            }
        }
    }
}

/// The points of pair `index` that will touch in a step between two times: their numbers in it, and their ways from their bases to where
/// they do, in the coordinates of these.
fn touching(
    model: &Model,
    masters: &Masters,
    (index, goes): (usize, &Goes),
    (points, histories, [now, end]): (Range<usize>, Range<usize>, [f64; 2]),
    committed: &State,
) -> Vec<(usize, Vec3)> {
    // The master stays where it is now: how it moves is in the ways.
    let Ok(master) = masters.at(model, index, &committed.u, now) else {
        return Vec::new();
    };
    let (pair, surface) = (&model.pairs[index], masters.surface(index));
    let known = committed.histories[histories].iter().enumerate();
    let open: Vec<Open> = known
        .filter_map(|at| Open::new(&master, surface, at))
        .collect();
    let offsets = pair.offsets(end);
    let (slaves, states) = (committed.slaves(model, index), &committed.points[points]);
    let one = |point: &Open| {
        let Open { index: i, x, .. } = *point;
        let ways = goes.ways(point);
        // No distance changes by more than the point moves.
        if ways[1].norm() <= point.approach {
            return None;
        }
        let z0 = offsets.map_or(0.0, |o| o.at(i));
        let hanging = (z0, slaves[i].overhang(false));
        let gap = |way: &Vec3| {
            let seen = master.see_hanging((i, &(x + way)), states[i].hint, f64::INFINITY, hanging);
            Some(seen?.gap(z0))
        };
        let beyond = gap(&ways[1]).filter(|gap| *gap < 0.0)?;
        // One that comes in over a free border passes that at once.
        master
            .see(i, &x, states[i].hint)
            .filter(|seen| seen.counts())?;
        let half = gap(&ways[0]).unwrap_or(0.5 * (point.approach + beyond));
        let part = first_zero([point.approach, half, beyond]);
        let ahead = ways[0] * (4.0 * part * (1.0 - part)) + ways[1] * (part * (2.0 * part - 1.0));
        let slope = point.approach / ahead.norm();
        (slope > GRAZING).then(|| (i, point.own(&master, &ahead)))
    };
    open.iter().filter_map(one).collect()
}

/// A point that is open and may touch, where its master is now.
struct Open {
    /// Number in its pair.
    index: usize,
    /// Where the point is.
    x: Vec3,
    /// Its way in the last step, as the master has carried it on.
    went: Vec3,
    /// Its gap.
    approach: f64,
    /// Of a point on a body, where its base is fixed to.
    anchor: Option<Anchor>,
}

impl Open {
    /// Nothing of a point that is not open, or sees nothing of the master.
    fn new(
        master: &MasterNow<'_>,
        surface: Option<&BodySurface>,
        (index, history): (usize, &PointHistory),
    ) -> Option<Self> {
        if !(history.approach > 0.0 && history.approach.is_finite()) {
            return None;
        }
        let (x, went, anchor) = match master {
            MasterNow::Rigid(tool) => {
                let x = (tool.pose * Point3::from(history.base)).coords;
                (x, tool.pose.rotation * history.way, None)
            }
            MasterNow::Body { .. } => {
                let place = history.place?;
                let anchor = Anchor::new(&surface?.facets.jet(place.patch, place.xi))?;
                let x = anchor.rho + anchor.vector(&history.base);
                (x, anchor.vector(&history.way), Some(anchor))
            }
        };
        Some(Open {
            index,
            x,
            went,
            approach: history.approach,
            anchor,
        })
    }

    /// A vector in the coordinates of the base.
    fn own(&self, master: &MasterNow<'_>, v: &Vec3) -> Vec3 {
        match (master, &self.anchor) {
            (MasterNow::Rigid(tool), _) => tool.pose.rotation.inverse() * v,
            (_, Some(anchor)) => anchor.components(v),
            (_, None) => *v,
        }
    }
}

/// Where a gap that is the first of these at the start of a step, then at half of it and, negative, at its end is zero: the part of the
/// step, by the parabola through the three.
fn first_zero([start, half, end]: [f64; 3]) -> f64 {
    let c = 2.0 * (start + end - 2.0 * half);
    let b = end - start - c;
    // start + b s + c s^2, of two signs at the ends: one zero lies between.
    let root = (b * b - 4.0 * c * start).max(0.0).sqrt();
    let part = match b < 0.0 {
        true => 2.0 * start / (root - b),
        false => (b + root) / (-2.0 * c),
    };
    part.clamp(0.0, 1.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn zeros_of_parabolas_are_found() {
        for [b, c] in [
            [-2.0, 0.0],
            [-3.0, 1.5],
            [0.0, -2.0],
            [1.0, -3.0],
            [-1.5, -1.0],
        ] {
            let gap = |s: f64| 1.0 + s * (b + c * s);
            let part = first_zero([1.0, gap(0.5), gap(1.0)]);
            assert!(
                part > 0.0 && part < 1.0 && gap(part).abs() < 1e-14,
                "{part}"
            );
        }
    }
}
