//! Slave faces cut anew between steps, and what their points remember.
//!
//! A history belongs to a place of the slave. The points of a face that is cut anew take those of the points that were
//! nearest to them on the undeformed face, with the attraction point as far from them as it was, so that their elastic slip
//! and their tractions stay. Where the cut is as before, nothing changes; where points stick, the faces slide by less than the
//! elastic slip, and cuts hardly move; where they slide, the next step gives the traction anew. What a face has dissipated
//! stays what it was.
use super::master::Masters;
use super::segments::{reach, segments};
use super::state::{PointState, State};
use super::{BodyModel, Model, PairModel};
use crate::contact::friction::history::{PointHistory, PointStatus};
use crate::contact::moving::MovingMaster;
use crate::contact::points::SlavePoint;
use crate::fem::FaceNodes;
use crate::scene::ValueError;
use covact_geometry::Vec3;
use std::sync::Arc;

/// Cuts the slave faces of every pair with segments anew, by the masters where a state puts them, and starts the points
/// there: to be called on an accepted state before a step from it is tried. Nothing is done where no pair has segments.
///
/// Returns, for every history of the new points, the number of the one that it was made of; nothing where histories stay.
///
/// # Errors
/// A motion without a value at `time`.
pub fn recut(
    model: &Model,
    masters: &mut Masters,
    state: &mut State,
    time: f64,
) -> Result<Option<Vec<usize>>, ValueError> {
    if model.pairs.iter().all(|p| p.segments().is_none()) {
        return Ok(None);
    }
    masters.update(model, &state.u);
    let mut points = Vec::with_capacity(state.points.len());
    let mut cuts = state.cuts.clone();
    let mut changes = Vec::new();
    let mut first = 0;
    for (index, pair) in model.pairs.iter().enumerate() {
        let before = state.slaves(model, index);
        let range = first..first + before.len();
        first = range.end;
        let (Some(degree), Some(body), Some(surface)) =
            (pair.segments(), pair.body_master(), masters.surface(index))
        else {
            points.extend_from_slice(&state.points[range]);
            continue;
        };
        let made = segments(
            &faces(&model.bodies[pair.body], pair),
            &surface.facets,
            |n| model.nodes[n as usize],
            |n| model.position(n as usize, &state.u),
            degree,
            reach(body.depth, pair.element_size) + pair.offset,
        );
        let master = masters.at(model, index, &state.u, time)?;
        let mut hint = None;
        for (i, p) in made.iter().enumerate() {
            let seen = master.see(i, &model.point_position(p, &state.u), hint);
            hint = seen.map(|s| s.hint).or(hint);
            points.push(PointState {
                hint: seen.map(|s| s.hint),
                closed: seen.is_some_and(|s| s.closed(pair.offset)),
            });
        }
        let same = before == &made[..];
        let histories = state.history(model, index);
        if let Some(histories) = histories.filter(|_| !same) {
            let sources = nearest(model, before, &made);
            let from = state.histories[histories.clone()].iter().zip(before);
            let known: Vec<_> = from.map(|(h, p)| (*h, *p)).collect();
            let states = &points[points.len() - made.len()..];
            let master = MovingMaster {
                facets: &surface.facets,
                undeformed: &body.facets,
                depth: body.depth,
                keep: true,
            };
            let position = |p: &SlavePoint| model.point_position(p, &state.u);
            let gap = |i: usize, x: &Vec3| {
                let seen = masters.at(model, index, &state.u, time).ok()?;
                Some(seen.see(i, x, states[i].hint)?.gap(pair.offset))
            };
            let mut new: Vec<PointHistory> = (sources.iter().zip(&made).enumerate())
                .map(|(i, (&source, p))| {
                    let (mut history, old) = known[source];
                    if pair.friction.is_none() {
                        return history;
                    }
                    let (x, was) = (position(p), position(&old));
                    if history.status == PointStatus::Open {
                        history.release(&x, gap(i, &x));
                    } else {
                        master.detach(&mut history, &was);
                        history.base += x - was;
                    }
                    master.attach(&mut history, states[i].hint);
                    history
                })
                .collect();
            keep_dissipated(&known, &mut new, &made);
            changes.push((index, histories.start, sources, new));
        }
        if let Some(cut) = cuts.get_mut(index).filter(|cut| cut.is_none() || !same) {
            *cut = Some(Arc::from(made));
        }
    }
    state.points = points;
    let sources = replace(model, state, &cuts, changes);
    Ok(sources)
}

type Change = (usize, usize, Vec<usize>, Vec<PointHistory>);

/// Takes over cuts, and the histories of pairs that were cut otherwise than before.
fn replace(
    model: &Model,
    state: &mut State,
    cuts: &[Option<Arc<[SlavePoint]>>],
    changes: Vec<Change>,
) -> Option<Vec<usize>> {
    if changes.is_empty() {
        state.cuts.clone_from_slice(cuts);
        return None;
    }
    let pairs = 0..model.pairs.len();
    let before: Vec<_> = pairs.map(|index| state.history(model, index)).collect();
    let known = std::mem::take(&mut state.histories);
    state.cuts.clone_from_slice(cuts);
    state.forget_histories(model);
    let mut sources = vec![0; state.histories.len()];
    for (index, before) in before.into_iter().enumerate() {
        let (Some(before), Some(now)) = (before, state.history(model, index)) else {
            continue;
        };
        if let Some((_, first, own, new)) = changes.iter().find(|c| c.0 == index) {
            state.histories[now.clone()].copy_from_slice(new);
            for (to, from) in sources[now].iter_mut().zip(own) {
                *to = first + from;
            }
            continue;
        }
        state.histories[now.clone()].copy_from_slice(&known[before.clone()]);
        for (to, from) in sources[now].iter_mut().zip(before) {
            *to = from;
        }
    }
    Some(sources)
}

/// Slave faces of a pair, with node numbers of the model.
fn faces(slave: &BodyModel, pair: &PairModel) -> Vec<FaceNodes> {
    let faces = pair.faces.iter();
    faces
        .map(|&f| slave.mesh.face_nodes(f).shifted(slave.first_node))
        .collect()
}

/// For every new point the number of the old point that is nearest to it on the undeformed face. Points of both come face by
/// face, and every face has some.
fn nearest(model: &Model, old: &[SlavePoint], new: &[SlavePoint]) -> Vec<usize> {
    let place = |p: &SlavePoint| -> Vec3 { p.terms().map(|(n, w)| model.nodes[n] * w).sum() };
    let mut out = Vec::with_capacity(new.len());
    let mut first = 0;
    let same_face = |a: &SlavePoint, b: &SlavePoint| a.nodes == b.nodes;
    for face in new.chunk_by(same_face) {
        first += (old[first..].iter())
            .take_while(|p| !same_face(p, &face[0]))
            .count();
        let count = (old[first..].iter())
            .take_while(|p| same_face(p, &face[0]))
            .count();
        let known: Vec<Vec3> = old[first..first + count].iter().map(place).collect();
        for point in face {
            let x = place(point);
            let distances = known.iter().map(|k| (k - x).norm_squared());
            let closest = (distances.enumerate()).min_by(|a, b| a.1.total_cmp(&b.1));
            out.push(first + closest.map_or(0, |(k, _)| k));
        }
        first += count;
    }
    out
}

/// Spreads what every face has dissipated over its new points, so that its sum stays.
fn keep_dissipated(
    known: &[(PointHistory, SlavePoint)],
    new: &mut [PointHistory],
    points: &[SlavePoint],
) {
    let mut olds = known.chunk_by(|a, b| a.1.nodes == b.1.nodes);
    let mut first = 0;
    for face in points.chunk_by(|a, b| a.nodes == b.nodes) {
        let new = &mut new[first..first + face.len()];
        first += face.len();
        let Some(old) = olds.find(|old| old[0].1.nodes == face[0].nodes) else {
            continue;
        };
        let was: f64 = old.iter().map(|(h, p)| h.dissipated * p.area).sum();
        let now: f64 = (new.iter().zip(face))
            .map(|(h, p)| h.dissipated * p.area)
            .sum();
        let area: f64 = face.iter().map(|p| p.area).sum();
        for history in new {
            history.dissipated = match now > 0.0 {
                true => history.dissipated * (was / now),
                false => was / area,
            };
        }
    }
}
