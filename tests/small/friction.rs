//! Friction at small displacements beside what is known in closed form.
use crate::support::{Outcome, solve};
use crate::{factorizations, scene};
use serde_json::{Value, json};

const EPS_N: f64 = 400.0;
const EPS_T: f64 = 150.0;
const MU: f64 = 0.25;
/// Height and area of the column, its shear modulus at nu = .25, and how deep it is pressed.
const HEIGHT: f64 = 0.5;
const AREA: f64 = 2.0;
const G: f64 = 40.0;
const DEEP: f64 = 1e-3;

/// A column on a plane, which moves under it: its upper end is held, its nodes move along the plane only, so that it is a spring of
/// stiffness `G / HEIGHT` per area. `down` and `tool` are prescribed over time.
fn column(down: Value, tool: Value, friction: Value, steps: u32) -> Value {
    scene(
        0.25,
        json!({
            "bodies": {"b": {
                "mesh": {"block": {"min": [0, 0, 0], "max": [2, 1, HEIGHT], "elements": [2, 1, 1]}},
                "material": "m", "element": "h8_displacement"
            }},
            "surfaces": {"tool": {
                "plane": {"center": [1, 0.5, 0], "size": [20, 20]}, "motion": {"translation": tool}, "depth": 1
            }},
            "contacts": {"c": {
                "slave": "b.bottom", "master": "tool", "points": {"gauss": 2}, "friction": friction,
                "penalty": {"value": EPS_N}, "tangential_penalty": {"value": EPS_T}
            }},
            "supports": {
                "top": {"on": "b.top", "displacement": {"x": 0, "y": 0, "z": down}},
                "bottom": {"on": "b.bottom", "displacement": {"z": down}}
            }
        }),
        steps,
    )
}

fn coulomb() -> Value {
    json!({"coulomb": {"mu": MU}})
}

fn stiffness() -> f64 {
    1.0 / (1.0 / EPS_T + HEIGHT / G)
}

fn near(what: &str, found: f64, exact: f64) {
    println!("{what}: {found} {exact}");
    assert!(exact != 0.0, "{what}");
    assert!(
        (found / exact - 1.0).abs() < 1e-10,
        "{what}: {found}, not {exact}"
    );
}

/// Stick is the spring and the penalty in series, slip Coulomb's force; a step that keeps its state takes one iteration.
#[test]
fn a_column_sticks_as_a_spring_and_slides_under_coulombs_force() {
    let limit = MU * EPS_N * DEEP;
    let slides_at = limit / stiffness();
    let tool = json!([
        json!({"table": [[0, 0], [0.5, 0], [1, 2.0 * slides_at]]}),
        0,
        0
    ]);
    let down = json!({"table": [[0, 0], [0.5, -DEEP], [1, -DEEP]]});
    let outcome = solve(&column(down, tool, coulomb(), 8));
    near(
        "normal force",
        outcome.at("force.tool.z", 1.0),
        EPS_N * DEEP * AREA,
    );
    for (time, share) in [(0.625, 0.5), (0.75, 1.0)] {
        let exact = share * slides_at * stiffness() * AREA;
        near("stick", outcome.at("force.tool.x", time), exact);
    }
    assert_eq!(outcome.at("points.stick", 0.625), 8.0);
    assert_eq!(outcome.at("points.slip", 1.0), 8.0);
    near("slip", outcome.at("force.tool.x", 1.0), limit * AREA);
    let dissipated = limit * slides_at * AREA;
    near(
        "dissipated",
        outcome.at("energy.dissipated", 1.0),
        dissipated,
    );
    let stored = 0.5 * limit * limit / EPS_T * AREA;
    near("stored", outcome.at("energy.friction", 1.0), stored);
    let left = outcome.at("energy.imbalance", 1.0);
    assert!(left.abs() < 1e-12 * dissipated, "{left:e}");
    let iterations = outcome.column("iterations");
    println!(
        "{iterations:?}, {} factorizations",
        factorizations(&outcome)
    );
    assert!(iterations.iter().all(|n| *n <= 3.0), "{iterations:?}");
    assert!(
        outcome
            .summary
            .effects
            .iter()
            .any(|e| e == "system.unsymmetric")
    );
}

/// A spring behind friction that is moved to and fro by `U` takes `4 mu N (U - mu N / k)` in a cycle.
#[test]
fn cycles_dissipate_what_a_spring_behind_friction_does() {
    let limit = MU * EPS_N * DEEP;
    let far = 2.5 * limit / stiffness();
    let table =
        json!({"table": [[0, 0], [0.2, 0], [0.4, far], [0.6, -far], [0.8, far], [1, -far]]});
    let down = json!({"table": [[0, 0], [0.2, -DEEP], [1, -DEEP]]});
    let outcome = solve(&column(down, json!([table, 0, 0]), coulomb(), 20));
    let cycle = 4.0 * limit * (far - limit / stiffness()) * AREA;
    let at = |t| outcome.at("energy.dissipated", t);
    near(
        "first half",
        at(0.4),
        limit * (far - limit / stiffness()) * AREA,
    );
    near("cycle", at(0.8) - at(0.4), cycle);
    near("half a cycle more", at(1.0) - at(0.8), 0.5 * cycle);
    for (t, sign) in [(0.4, 1.0), (0.6, -1.0), (0.8, 1.0), (1.0, -1.0)] {
        near("force", outcome.at("force.tool.x", t), sign * limit * AREA);
    }
    let (left, work) = (
        outcome.at("energy.imbalance", 1.0),
        outcome.at("energy.external", 1.0),
    );
    println!("imbalance {left:e} of {work:e}");
    // Sticking and sliding meet within some steps, over which the work of the tool is a trapezoid.
    assert!(left.abs() < 0.1 * work);
}

/// What the tool moves before a point closes is no slip: in the step of contact only the part after it counts, and nothing of what
/// came before the point had opened.
#[test]
fn a_point_that_closes_again_starts_where_it_closes() {
    let moved = 1e-4;
    let tool = json!([
        json!({"table": [[0, 0], [0.25, 0], [0.5, moved], [0.75, 2.0 * moved], [1, 3.0 * moved]]}),
        0,
        0
    ]);
    // Down, up into the air, down by another depth.
    let (up, deep) = (5e-4, 2e-3);
    let down = json!({"table": [[0, 0], [0.25, -DEEP], [0.5, -DEEP], [0.75, up], [1, -deep]]});
    let outcome = solve(&column(down, tool, json!({"coulomb": {"mu": 10}}), 4));
    near(
        "first contact",
        outcome.at("force.tool.x", 0.5),
        moved * stiffness() * AREA,
    );
    assert_eq!(outcome.at("force.tool.x", 0.75), 0.0);
    assert_eq!(outcome.column("points.active"), [8.0, 8.0, 0.0, 8.0]);
    let part = deep / (deep + up);
    let series = 1.0 / (1.0 / (part * EPS_T) + HEIGHT / G);
    near(
        "second contact",
        outcome.at("force.tool.x", 1.0),
        moved * series * AREA,
    );
}

/// Two coefficients, along a direction of the master, which is placed turned by 90 degrees about z: its x lies along y.
#[test]
fn directions_turn_with_the_placement_of_the_master() {
    let friction = json!({"orthotropic": {"mu": [0.1, 0.3], "direction": [1, 0, 0]}});
    let down = json!({"table": [[0, 0], [0.5, -DEEP], [1, -DEEP]]});
    for (turned, axis, mu) in [
        (false, "x", 0.1),
        (false, "y", 0.3),
        (true, "x", 0.3),
        (true, "y", 0.1),
    ] {
        let way = json!({"table": [[0, 0], [0.5, 0], [1, 0.1]]});
        let tool = if axis == "x" {
            json!([way, 0, 0])
        } else {
            json!([0, way, 0])
        };
        let mut scene = column(down.clone(), tool, friction.clone(), 4);
        if turned {
            scene["surfaces"]["tool"]["placement"] = json!({"axis": [0, 0, 1], "angle": 90});
        }
        let outcome = solve(&scene);
        let exact = mu * EPS_N * DEEP * AREA;
        let what = format!("{axis}, turned {turned}");
        near(&what, outcome.at(&format!("force.tool.{axis}"), 1.0), exact);
        assert_eq!(outcome.at("points.slip", 1.0), 8.0);
    }
    let limited = json!({"shear_limited": {"mu": MU, "limit": 0.06}});
    let tool = json!([{"table": [[0, 0], [0.5, 0], [1, 0.1]]}, 0, 0]);
    let outcome = solve(&column(down, tool, limited, 4));
    near("limited", outcome.at("force.tool.x", 1.0), 0.06 * AREA);
}

/// A block that rocks as it is pushed along a plane: points slide under their own pressures, which turn up in front of it, and all
/// of them together under `mu` times the weight.
fn pushed(steps: u32) -> Outcome {
    solve(&scene(
        0.0,
        json!({
            "bodies": {"b": {
                "mesh": {"block": {"min": [0, 0, 0], "max": [2, 1, 1], "elements": [6, 2, 3]}},
                "material": "m", "element": "h8_displacement"
            }},
            "surfaces": {"tool": {"plane": {"center": [1, 0.5, 0], "size": [20, 20]}, "depth": 1}},
            "contacts": {"c": {"slave": "b.bottom", "master": "tool", "friction": coulomb()}},
            "supports": {"top": {"on": "b.top", "displacement": {
                "x": {"table": [[0, 0], [0.25, 0], [1, 0.02]]}, "y": 0,
                "z": {"table": [[0, 0], [0.25, -0.01], [1, -0.01]]}
            }}}
        }),
        steps,
    ))
}

#[test]
fn a_block_slides_under_coulombs_force() {
    let outcome = pushed(16);
    let force = |axis: &str| outcome.at(&format!("force.tool.{axis}"), 1.0);
    let (sticks, slides) = (
        outcome.column("points.stick"),
        outcome.column("points.slip"),
    );
    println!("{sticks:?} {slides:?} {:?}", outcome.column("iterations"));
    assert!(
        sticks
            .iter()
            .zip(&slides)
            .any(|(a, b)| *a > 0.0 && *b > 0.0)
    );
    assert_eq!((sticks[15], slides[15]), (0.0, 21.0));
    near("pushed", -force("x"), MU * force("z"));
    let [work, left] = ["energy.external", "energy.imbalance"].map(|c| outcome.at(c, 1.0));
    println!("imbalance {left:e} of {work:e}");
    assert!(left.abs() < 0.01 * work);
}
