//! Faces of a B-rep: 510 over loops (508), whose edges stand in edge lists (504) and vertex lists (502).
//!
//! Shells (514) and solids (186) only collect faces; see `groups`.

use super::super::error::Fail;
use super::Model;
use super::curve::{self, Stop};
use super::directory::Entry;
use super::groups::pointer;
use super::params::Params;
use super::transform::Affine;
use super::trimmed::{describe, parameter_list, space_parts};
use crate::io::brep::{Boundary, Face, Preference, Stretch, reversed};
use std::collections::HashMap;
use std::collections::hash_map::Entry as Slot;

/// Edges that were read, by list, number in the list, and place of the copy: neighbours share them.
#[derive(Default)]
pub struct Edges {
    /// Index of each list in the directory.
    lists: HashMap<usize, Vec<Edge>>,
}

/// One edge of a 504: its curve. (The vertices say nothing that the ends of the curve do not say.)
#[derive(Clone, Copy)]
struct Edge {
    /// Index of the curve in the directory.
    curve: usize,
}

/// Reads a 510. `outer` maps the space of the edges' curves (before their own matrices) to model space.
pub fn read_510(
    model: &Model,
    entry: &Entry,
    outer: &Affine,
    edges: &mut Edges,
    notes: &mut Vec<String>,
) -> Result<Face, Fail> {
    let params = model.params(entry)?;
    let base = pointer(model, &params, 1, "the surface of a face (510)")?;
    let count = params.count(2, "the number of loops of a face (510)")?;
    if count > params.len().saturating_sub(4) {
        let expected = format!("a flag and {count} pointers to loops (508)");
        return Err(params.fail(params.len(), expected));
    }
    let flag = params.integer(3, "the outer loop flag of a face (510)")?;
    if !(0..=1).contains(&flag) {
        return Err(params.fail(3, "0 or 1 for the outer loop flag"));
    }
    let mut face = Face {
        base,
        boundaries: Vec::new(),
        // A B-rep face has no natural border: without the flag all that is not said is which loop is the outer one.
        outer: true,
        values: 4 + count,
        fault: None,
    };
    for i in 4..4 + count {
        let index = pointer(model, &params, i, "a loop (508)")?;
        match curve::settle(read_508(model, index, outer, edges, notes))? {
            Ok(Some(boundary)) => face.boundaries.push(boundary),
            Ok(None) => {}
            Err(reason) => {
                face.fault.get_or_insert(reason);
            }
        }
    }
    Ok(face)
}

/// Reads a 508: N, then for each use TYPE (0 edge, 1 vertex), list, index in it, orientation flag, K, and K times a flag
/// and a curve in the parameter plane. A loop that is one vertex only (a pole) bounds nothing.
fn read_508(
    model: &Model,
    index: usize,
    outer: &Affine,
    edges: &mut Edges,
    notes: &mut Vec<String>,
) -> Result<Option<Boundary>, Stop> {
    let entry = &model.entries[index];
    let name = describe(entry);
    if entry.type_number != 508 {
        let reason = format!("{name} bounds it, which is no loop (508)");
        return Err(Stop::Reason(reason));
    }
    let params = model.params(entry)?;
    let count = params.count(1, "the number of edges of a loop (508)")?;
    if count > params.len().saturating_sub(2) / 5 {
        let expected = format!("{count} edges of a loop");
        return Err(params.fail(params.len(), expected).into());
    }
    let mut stretches = Vec::with_capacity(count);
    let mut at = 2;
    for _ in 0..count {
        let kind = params.integer(at, "the type of an edge of a loop (508)")?;
        let (parameter, next) = parameter_list(model, &params, at + 4, true, notes)?;
        match kind {
            0 => {
                let number = params.count(at + 2, "the number of an edge in its list")?;
                let list = pointer(model, &params, at + 1, "an edge list (504)")?;
                let edge = edges.find(model, &params, at + 1, list, number)?;
                let forward = params.integer(at + 3, "the orientation flag of an edge")? != 0;
                let curve = &model.entries[edge.curve];
                let mut space = space_parts(model, curve, outer, notes).map_err(|stop| {
                    in_edge(
                        stop,
                        &format!("edge {number} of {}", describe(&model.entries[list])),
                    )
                })?;
                if !forward {
                    space = reversed(space)?;
                }
                stretches.push(Stretch {
                    parameter,
                    space,
                    preference: Preference::None,
                    edge: curve.number,
                });
            }
            // A pole: the line in the parameter plane is given here, or closed when the chain is made.
            1 if parameter.is_empty() => {}
            1 => stretches.push(Stretch {
                parameter,
                ..Stretch::default()
            }),
            _ => {
                let expected = "0 for an edge or 1 for a vertex";
                return Err(params.fail(at, expected).into());
            }
        }
        at = next;
    }
    Ok((!stretches.is_empty()).then_some(Boundary { name, stretches }))
}

fn in_edge(stop: Stop, what: &str) -> Stop {
    match stop {
        Stop::Reason(reason) => Stop::Reason(format!("{what}: {reason}")),
        damage => damage,
    }
}

impl Edges {
    /// Edge `number` (from 1) of a list, which is read when it is first asked for.
    fn find(
        &mut self,
        model: &Model,
        params: &Params,
        at: usize,
        list: usize,
        number: usize,
    ) -> Result<Edge, Stop> {
        let edges = match self.lists.entry(list) {
            Slot::Occupied(slot) => slot.into_mut(),
            Slot::Vacant(slot) => {
                let entry = &model.entries[list];
                if entry.type_number != 504 {
                    return Err(params.fail(at, "a pointer to an edge list (504)").into());
                }
                slot.insert(read_504(model, entry)?)
            }
        };
        let edge = number.checked_sub(1).and_then(|k| edges.get(k)).copied();
        edge.ok_or_else(|| {
            let expected = format!("the number of an edge, 1 to {}", edges.len());
            params.fail(at + 1, expected).into()
        })
    }
}

/// Reads a 504: N, then for each edge CURV, and the start and the end vertex, each as list (502) and number in it.
fn read_504(model: &Model, entry: &Entry) -> Result<Vec<Edge>, Fail> {
    let params = model.params(entry)?;
    let count = params.count(1, "the number of edges of an edge list (504)")?;
    if count > params.len().saturating_sub(2) / 5 {
        let expected = format!("{count} edges of five values");
        return Err(params.fail(params.len(), expected));
    }
    let edges = (0..count).map(|k| {
        let curve = pointer(model, &params, 2 + 5 * k, "the curve of an edge (504)")?;
        for (vertex, what) in [(3, "start"), (5, "end")] {
            let what = format!("the vertex list (502) of the {what} of an edge");
            let at = vertex + 5 * k;
            if model.entries[pointer(model, &params, at, &what)?].type_number != 502 {
                return Err(params.fail(at, what));
            }
        }
        Ok(Edge { curve })
    });
    edges.collect()
}
