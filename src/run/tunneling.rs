//! Points that a step takes through their master without ever being in contact.
use super::watch::Span;
use crate::assembly::Fault;
use crate::model::master::{Master, MasterNow, Masters};
use crate::model::state::State;
use crate::model::{Model, SurfaceModel};
use crate::solve::newton::StepFailure;
use covact_geometry::Vec3;
use nalgebra::{Isometry3, Point3};

/// Part of a path that it goes on by at least where the surface is looked for along it.
const STRIDE: f64 = 1.0 / 256.0;
/// Sine of the angle between a path and a surface from which on it does not graze it: a straight line between two places of a point
/// that a turning tool passes cuts the corner, by half the angle that the tool has turned.
const STEEP: f64 = 0.7;

/// Angle by which a tool turns in a step from which on a straight line says nothing of what its surface does to a point near it.
const TURNED: f64 = 0.1;

/// Fails where a point that touched its master at the start of the step, or was open in front of it, has passed through it: it lies below the
/// master at the end, deeper than the depth, or its way has led through a rigid surface. Only points that have moved farther
/// than the depth or than an element, relative to the master, are looked at. A point beyond a free border may go anywhere. Leaves the
/// masters at the end of the step.
pub(super) fn none_passed(
    model: &Model,
    masters: &mut Masters,
    span: &Span,
) -> Result<(), StepFailure> {
    let ((from, start), (to, end)) = (span.from, span.to);
    let mut first = 0;
    for (index, pair) in model.pairs.iter().enumerate() {
        let slaves = to.slaves(model, index);
        let offset = first;
        first += slaves.len();
        // Of a surface whose rims are slaves the slave's own points tell.
        if model.of_rims(pair) {
            continue;
        }
        let depth = pair.master.depth(model);
        let (way, poses) = match &pair.master {
            Master::Rigid(surface) => {
                let surface = &model.surfaces[*surface];
                let poses = [surface.pose(start, &from.u), surface.pose(end, &to.u)];
                let [a, b] = poses;
                let (a, b) = (a.map_err(Fault::from)?, b.map_err(Fault::from)?);
                (farthest(surface, &a, &b), Some((a, b)))
            }
            Master::Body(body) => {
                let facets = 0..body.facets.len() as u32;
                let nodes = facets.flat_map(|f| body.facets.nodes(f));
                let moved = nodes.map(|&n| moved(model, n as usize, from, to).norm());
                (moved.fold(0.0, f64::max), None)
            }
        };
        let far = depth.min(pair.element_size);
        let touched = |i: usize| from.points[offset + i].closed;
        let suspects: Vec<(usize, f64)> = (slaves.iter().enumerate())
            .filter(|(i, _)| !to.points[offset + i].closed)
            .map(|(i, p)| {
                let moved = |n| moved(model, n, from, to);
                let own = (model.terms(p)).fold(Vec3::zeros(), |v, (n, w)| v + moved(n) * w);
                (i, own.norm() + way)
            })
            .filter(|(_, moved)| *moved > far)
            .collect();
        if suspects.is_empty() {
            continue;
        }
        masters.update(model, &from.u);
        let master = masters
            .at(model, index, &from.u, start)
            .map_err(Fault::from)?;
        // The distance of a surface changes by no more than a point moves.
        let front: Vec<usize> = (suspects.into_iter())
            .filter(|&(i, moved)| {
                let x = model.point_position(&slaves[i], &from.u);
                let seen = master.see(i, &x, from.points[offset + i].hint);
                let touches = poses.is_some() && touched(i);
                seen.is_some_and(|s| {
                    !s.free && (touches || s.signed_distance >= 0.0) && s.signed_distance < moved
                })
            })
            .map(|(i, _)| i)
            .collect();
        masters.update(model, &to.u);
        let master = masters.at(model, index, &to.u, end).map_err(Fault::from)?;
        let (mut points, mut at) = (0, Vec3::zeros());
        for i in front {
            let ends = [from, to].map(|s| model.point_position(&slaves[i], &s.u));
            let hint = to.points[offset + i].hint;
            let deep = |x: &Vec3, hint| master.see(i, x, hint).is_some_and(|s| s.behind);
            // One that touched may have slid over a border, and down beside it.
            let behind = !touched(i) && deep(&ends[1], hint);
            if behind || on_the_way(&master, (i, touched(i)), ends, poses.as_ref()) {
                points += 1;
                at = ends[1];
            }
        }
        if points > 0 {
            return Err(StepFailure::PassedThrough {
                pair: pair.name.clone(),
                master: pair.master_words(model),
                points,
                at: at.into(),
                depth,
            });
        }
    }
    Ok(())
}

/// Displacement of a node over the step.
fn moved(model: &Model, node: usize, from: &State, to: &State) -> Vec3 {
    model.position(node, &to.u) - model.position(node, &from.u)
}

/// How far a point of the surface's box moves at most.
fn farthest(surface: &SurfaceModel, a: &Isometry3<f64>, b: &Isometry3<f64>) -> f64 {
    if a == b {
        return 0.0;
    }
    let bounds = surface.set.bounds();
    let corners = (0..8).map(|k| Point3::from(Vec3::from_fn(|c, _| bounds[k >> c & 1][c])));
    corners.map(|p| (b * p - a * p).norm()).fold(0.0, f64::max)
}

/// Whether the straight path of a point, as a rigid surface sees it, leads through the surface. It is followed by the distance from
/// the surface, which nothing on the way falls short of. Of a tool that turns only what lies deep below it is told.
fn on_the_way(
    master: &MasterNow,
    (point, touched): (usize, bool),
    ends: [Vec3; 2],
    poses: Option<&(Isometry3<f64>, Isometry3<f64>)>,
) -> bool {
    let Some((a, b)) = poses else { return false };
    let start = (b * a.inverse_transform_point(&Point3::from(ends[0]))).coords;
    let path = ends[1] - start;
    let length = path.norm();
    let turned = a.rotation.angle_to(&b.rotation) > TURNED;
    let (mut way, mut outside) = (0.0, !turned);
    while way < length {
        let x = start + path * (way / length);
        let Some(seen) = master.see(point, &x, None) else {
            return false;
        };
        // Past a free border it comes to the other side without touching. What was grazed may be left again, or lead deep below.
        let entered = !seen.free && seen.signed_distance < 0.0 && outside;
        if seen.behind && !touched || entered && seen.normal.dot(&path) < -STEEP * length {
            return true;
        }
        outside = !turned && seen.signed_distance >= 0.0;
        way += seen.distance.max(STRIDE * length);
    }
    false
}
