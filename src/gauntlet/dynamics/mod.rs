//! Motion with inertia: impact, friction, conservation laws.
mod bars;
mod flight;
mod rest;
mod thrown;

use super::{Case, Group};
use serde_json::{Value, json};

pub const GROUP: Group = Group {
    name: "dynamics",
    cases: &[
        Case {
            name: "bar_on_wall",
            what: "an elastic bar hits a rigid wall along its axis",
            right: "the wall bears E A v / c until the wave is back after 2 L / c; the bar leaves as fast as it came",
            run: bars::wall,
        },
        Case {
            name: "cradle",
            what: "a bar hits the first of two that touch each other",
            right: "Newton's cradle: the last one leaves with the velocity, the others rest, to 4 %",
            run: bars::cradle,
        },
        Case {
            name: "short_on_long",
            what: "a bar hits one twice as long",
            right: "St. Venant: the short one rests, the long one leaves with half of the velocity, to 2 %",
            run: bars::lengths,
        },
        Case {
            name: "moving_frame",
            what: "two blocks collide aslant with friction; all of it on a body that moves at a steady speed",
            right: "Galilei: no force and no energy changes, to 1e-9; forces of both sides cancel to 1e-12",
            run: thrown::frame,
        },
        Case {
            name: "own_units",
            what: "that collision in micrometres, microseconds and a mass of its own",
            right: "the same numbers after scaling, to 1e-9",
            run: thrown::units,
        },
        Case {
            name: "askew_wall",
            what: "a spinning block thrown at a rigid wall with friction; the same turned and moved in space",
            right: "forces turn along, all else is the same, to 1e-9",
            run: thrown::askew,
        },
        Case {
            name: "slides_to_rest",
            what: "a block that slides on a floor",
            right: "way v^2 / (2 mu g) to .1 %; friction takes its energy, to .3 %",
            run: rest::slides,
        },
        Case {
            name: "comes_to_rest",
            what: "a clamped strip that falls on a round bar, vibrates and is damped",
            right: "the equilibrium that a run without inertia finds: force, energy and pressure to 1e-4",
            run: rest::settles,
        },
        Case {
            name: "pendulum",
            what: "a bar on a hinge falls from the horizontal, two steps",
            right: "elliptic integral of a rigid pendulum: time to the lowest place to .05 %, its energy to .4 %",
            run: flight::pendulum,
        },
        Case {
            name: "slowed",
            what: "a block that flies against a force of its mass times its velocity, two steps",
            right: "way v (1 - exp(-c t)) / c, of second order in the step",
            run: flight::slowed,
        },
    ],
};

/// Equal steps with inertia.
fn steps(dt: f64, end: f64) -> Value {
    json!({
        "dynamics": {},
        "end_time": end,
        "step": { "initial": dt, "max": dt, "min": 1e-3 * dt, "adaptive": false },
        "newton": { "tolerance": 1e-10 }
    })
}
