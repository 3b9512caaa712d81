//! The evolving state in a checkpoint. Structures are taken apart field by field, so that whoever adds a field decides here
//! whether it is kept; what has another length than the model's is refused before it is read.
use super::bytes::{Malformed, Reader, Writer};
use crate::contact::friction::history::{PointHistory, PointStatus};
use crate::contact::points::SlavePoint;
use crate::model::Model;
use crate::model::state::{PointState, State};
use covact_geometry::{Hint, Vec3};
use std::sync::Arc;

/// An accepted state.
pub fn put(model: &Model, state: &State, out: &mut Writer) {
    let State {
        u,
        elements,
        points,
        nodes,
        histories,
        cuts,
        stabilized,
    } = state;
    for cut in cuts {
        out.option(cut.as_ref(), |out, cut| {
            out.count(cut.len());
            cut.iter().for_each(|p| put_slave(p, out));
        });
    }
    out.count(u.len());
    out.f64s(u);
    put_elements(model, elements, out);
    out.count(points.len());
    for PointState { hint, closed } in points {
        put_hint(*hint, out);
        out.bool(*closed);
    }
    out.count(nodes.len());
    nodes.iter().for_each(|n| out.bool(*n));
    out.count(histories.len());
    histories.iter().for_each(|h| put_history(h, out));
    out.f64(*stabilized);
}

/// [`put`], read back.
pub fn take(model: &Model, from: &mut Reader) -> Result<State, Malformed> {
    let mut state = State::new(model);
    for (pair, cut) in model.pairs.iter().zip(&mut state.cuts) {
        *cut = from.option(|from| {
            let count = from.count(17)?;
            (0..count)
                .map(|_| take_slave(model, from))
                .collect::<Result<Arc<[SlavePoint]>, _>>()
        })?;
        if cut.is_some() && pair.segments().is_none() {
            return Err(from.malformed("segments where the scene has none"));
        }
    }
    from.exactly(state.u.len(), "displacements")?;
    from.f64s(&mut state.u)?;
    take_elements(model, &mut state.elements, from)?;
    let points = (0..model.pairs.len()).map(|i| state.slaves(model, i).len());
    let points: usize = points.sum();
    from.exactly(points, "slave points")?;
    state.points.resize(points, PointState::default());
    for point in &mut state.points {
        *point = PointState {
            hint: take_hint(from)?,
            closed: from.bool()?,
        };
    }
    from.exactly(state.nodes.len(), "slave nodes")?;
    for node in &mut state.nodes {
        *node = from.bool()?;
    }
    state.forget_histories(model);
    from.exactly(state.histories.len(), "histories")?;
    for history in &mut state.histories {
        *history = take_history(from)?;
    }
    state.stabilized = from.f64()?;
    for (index, pair) in model.pairs.iter().enumerate() {
        let facets = pair.body_master().map_or(0, |m| m.facets.len());
        let places =
            (state.history(model, index).into_iter()).flat_map(|range| &state.histories[range]);
        for place in places.filter_map(|h| h.place) {
            if place.patch as usize >= facets || place.xi.iter().any(|x| !x.is_finite()) {
                return Err(from.malformed("an attraction point on no facet"));
            }
        }
    }
    Ok(state)
}

/// What [`State::extrapolate`] reads of the state before the last accepted one.
pub fn put_before(model: &Model, state: &State, out: &mut Writer) {
    let State {
        u,
        elements,
        points: _,
        nodes: _,
        histories,
        cuts: _,
        stabilized: _,
    } = state;
    out.count(u.len());
    out.f64s(u);
    put_elements(model, elements, out);
    out.count(histories.len());
    histories.iter().for_each(|h| out.f64(h.lambda_n));
}

/// [`put_before`], read back; all else is that of `committed`, the last accepted state.
pub fn take_before(
    model: &Model,
    committed: &State,
    from: &mut Reader,
) -> Result<State, Malformed> {
    let mut state = committed.clone();
    from.exactly(state.u.len(), "displacements")?;
    from.f64s(&mut state.u)?;
    take_elements(model, &mut state.elements, from)?;
    from.exactly(state.histories.len(), "histories")?;
    for history in &mut state.histories {
        history.lambda_n = from.f64()?;
    }
    Ok(state)
}

/// The enhanced strains and what laws remember: what else the states of elements hold is written by every linearisation before it is read.
fn put_elements(model: &Model, elements: &[f64], out: &mut Writer) {
    out.count(elements.len());
    let mut first = 0;
    for body in &model.bodies {
        let len = model.state_len(body);
        let kept = body.block.alpha_len().min(len);
        let history = body.block.history_len().min(len);
        for _ in 0..body.block.elements() {
            out.f64s(&elements[first..first + kept]);
            first += len;
            out.f64s(&elements[first - history..first]);
        }
    }
}

fn take_elements(model: &Model, elements: &mut [f64], from: &mut Reader) -> Result<(), Malformed> {
    from.exactly(elements.len(), "numbers of elements")?;
    elements.fill(0.0);
    let mut first = 0;
    for body in &model.bodies {
        let len = model.state_len(body);
        let kept = body.block.alpha_len().min(len);
        let history = body.block.history_len().min(len);
        for _ in 0..body.block.elements() {
            from.f64s(&mut elements[first..first + kept])?;
            first += len;
            from.f64s(&mut elements[first - history..first])?;
        }
    }
    Ok(())
}

fn put_hint(hint: Option<Hint>, out: &mut Writer) {
    out.option(hint, |out, Hint { patch, xi }| {
        out.u32(patch);
        out.f64s(&xi);
    });
}

fn take_hint(from: &mut Reader) -> Result<Option<Hint>, Malformed> {
    from.option(|from| {
        let (patch, mut xi) = (from.u32()?, [0.0; 2]);
        from.f64s(&mut xi)?;
        Ok(Hint { patch, xi })
    })
}

fn put_history(history: &PointHistory, out: &mut Writer) {
    let PointHistory {
        place,
        base,
        lambda,
        lambda_n,
        approach,
        way,
        ahead: _,
        status,
        n,
        t,
        slip,
        dissipated,
        sudden: _,
    } = history;
    put_hint(*place, out);
    for v in [base, lambda, way, t] {
        out.f64s(v.as_slice());
    }
    out.f64s(&[*lambda_n, *approach, *n, *slip, *dissipated]);
    out.u8(match status {
        PointStatus::Open => 0,
        PointStatus::Stick => 1,
        PointStatus::Slip => 2,
    });
}

fn take_history(from: &mut Reader) -> Result<PointHistory, Malformed> {
    let place = take_hint(from)?;
    let [mut base, mut lambda, mut way, mut t] = [Vec3::zeros(); 4];
    for v in [&mut base, &mut lambda, &mut way, &mut t] {
        from.f64s(v.as_mut_slice())?;
    }
    let mut rest = [0.0; 5];
    from.f64s(&mut rest)?;
    let [lambda_n, approach, n, slip, dissipated] = rest;
    let status = match from.u8()? {
        0 => PointStatus::Open,
        1 => PointStatus::Stick,
        2 => PointStatus::Slip,
        _ => return Err(from.malformed("an unknown status of a point")),
    };
    Ok(PointHistory {
        place,
        base,
        lambda,
        lambda_n,
        approach,
        way,
        // Of a step that is yet to be taken.
        ahead: Vec3::zeros(),
        status,
        n,
        t,
        slip,
        dissipated,
        // Of a step that has been accounted for.
        sudden: 0.0,
    })
}

fn put_slave(point: &SlavePoint, out: &mut Writer) {
    let SlavePoint {
        nodes,
        shape,
        count,
        area,
        rounding,
    } = point;
    let used = usize::from(*count).min(nodes.len());
    out.u8(*count);
    nodes[..used].iter().for_each(|n| out.u32(*n));
    out.f64s(&shape[..used]);
    out.f64(*area);
    out.f64(*rounding);
}

fn take_slave(model: &Model, from: &mut Reader) -> Result<SlavePoint, Malformed> {
    let mut point = SlavePoint::at_node(0, 0.0);
    point.count = from.u8()?;
    let used = usize::from(point.count);
    if used > point.nodes.len() {
        return Err(from.malformed("a slave point with too many nodes"));
    }
    for node in &mut point.nodes[..used] {
        *node = from.u32()?;
        if *node as usize >= model.nodes.len() {
            return Err(from.malformed("a slave point on no node"));
        }
    }
    from.f64s(&mut point.shape[..used])?;
    point.area = from.f64()?;
    point.rounding = from.f64()?;
    Ok(point)
}
