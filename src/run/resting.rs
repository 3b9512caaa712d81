//! Points that lie on their master when a run begins.
//!
//! A sheet laid on a die is at a gap of nothing, or of what rounding makes of it, which is open. Where contact alone holds a body
//! (which is then stabilised), its first correction would find it free and let it go. Such points count as closed before the first step, so that its
//! first linearisation may keep them ([`crate::solve::newton::First::hold`]); the residual then decides as ever.
use crate::assembly::Fault;
use crate::model::Model;
use crate::model::master::Masters;
use crate::model::state::State;

/// Gap, over the size of an element, up to which a point lies on its master.
const RESTS: f64 = 1e-9;

/// Closes the points of `state`, the start, that lie on their masters.
///
/// # Errors
/// A motion without a value at time 0.
pub fn close(model: &Model, masters: &Masters, state: &mut State) -> Result<(), Fault> {
    // Inertia holds a body for the first instant.
    if model.stabilization.is_none() || model.small.is_some() || model.dynamics.is_some() {
        return Ok(());
    }
    let mut first = 0;
    for (index, pair) in model.pairs.iter().enumerate() {
        let points = first..first + state.slaves(model, index).len();
        first = points.end;
        let master = masters.at(model, index, &state.u, 0.0)?;
        let reach = RESTS * pair.element_size;
        let offsets = pair.offsets(0.0);
        for (i, (point, now)) in pair
            .points
            .iter()
            .zip(&mut state.points[points])
            .enumerate()
        {
            let x = model.point_position(point, &state.u);
            let z0 = offsets.map_or(0.0, |o| o.at(i));
            let seen = master.see_hanging(
                (i, &x),
                now.hint,
                z0.abs() + reach,
                (z0, point.overhang(false)),
            );
            let rests = seen.filter(|seen| seen.counts() && seen.gap(z0).abs() <= reach);
            if let Some(seen) = rests {
                (now.closed, now.hint) = (true, Some(seen.hint));
            }
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::build::build;
    use crate::scene;
    use serde_json::json;

    /// A block of four upper and four lower nodes above a plane, and under another one that is clear of it.
    fn closed(gap: f64, dynamics: bool) -> Vec<bool> {
        let mut scene = json!({
            "covact": 1,
            "materials": { "m": { "st_venant_kirchhoff": { "E": 1e4, "nu": 0.3, "density": 1 } } },
            "bodies": { "block": {
                "mesh": { "block": { "min": [0, 0, 0], "max": [1, 1, 1], "elements": [1, 1, 1] } }, "material": "m"
            } },
            "surfaces": {
                "floor": { "plane": { "center": [0.5, 0.5, -gap], "size": [4, 4] } },
                "above": { "plane": { "center": [0.5, 0.5, 1.1], "size": [4, 4], "normal": [0, 0, -1] } }
            },
            "contacts": {
                "below": { "slave": "block.bottom", "master": "floor" },
                "top": { "slave": "block.top", "master": "above" }
            },
            "supports": { "side": { "on": "block.x_min", "symmetry": "x" } }
        });
        if dynamics {
            scene["solution"] = json!({ "end_time": 1, "dynamics": {} });
        }
        let loaded =
            scene::parse(&scene.to_string(), "scene.json").unwrap_or_else(|e| panic!("{e}"));
        let model = build(&loaded).unwrap_or_else(|e| panic!("{e}"));
        let mut state = State::new(&model);
        close(&model, &Masters::new(&model), &mut state).unwrap_or_else(|e| panic!("{e}"));
        state.points.iter().map(|p| p.closed).collect()
    }

    #[test]
    fn points_that_lie_on_their_master_are_closed() {
        let below = [[true; 4], [false; 4]].concat();
        for gap in [0.0, 1e-12, -1e-12] {
            assert_eq!(closed(gap, false), below, "{gap}");
        }
        assert_eq!(closed(1e-6, false), [false; 8]);
        assert_eq!(closed(0.0, true), [false; 8]);
    }
}
