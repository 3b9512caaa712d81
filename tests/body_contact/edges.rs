//! Sharp edges of a master between slave points: slaves as well (`"passes": "edges"`), by themselves where a run stops on one.
use crate::blocks::done;
use covact::{model, scene};
use serde_json::{Value, json};

/// A cantilever of length 40, width 4 and thickness 1 (E 1000, nu 0), and above it a stiff block whose lower edge at `x = at` is
/// pressed onto it.
fn under_an_edge(at: f64, passes: &str) -> Value {
    json!({
        "covact": 1,
        "materials": {
            "soft": {"st_venant_kirchhoff": {"E": 1000, "nu": 0}},
            "stiff": {"st_venant_kirchhoff": {"E": 1e6, "nu": 0}}
        },
        "bodies": {
            "beam": {"mesh": {"plate": {"size": [40, 4], "thickness": 1, "elements": [16, 1], "origin": [0, 0, -0.5]}}, "material": "soft"},
            "block": {"mesh": {"block": {"min": [at, 0, 0], "max": [60, 4, 5], "elements": [4, 1, 1]}}, "material": "stiff"}
        },
        "contacts": {"c": {"slave": "beam.top", "master": "block.bottom", "passes": passes}},
        "supports": {
            "wall": {"on": "beam.x_min", "fixed": true},
            "plane": {"on": ["beam.y_min", "beam.y_max", "block.y_min", "block.y_max"], "symmetry": "y"},
            "press": {"on": "block.top", "displacement": {"x": 0, "z": "-0.3*t"}}
        },
        "solution": {"step": {"initial": 0.25, "max": 0.25}}
    })
}

/// A cantilever that is pushed down by `d` at a distance `a` from its wall: `F = 3 E I d / a^3`, with the moment `F a` at the
/// wall. The edge lies in the middle between two nodes, 1.25 from either, each of which would have the force wrong by 15 %. On
/// this mesh a linear element bends too little by `1/(4 n^2)` for `n` elements up to the edge.
#[test]
fn an_edge_between_two_nodes_bears_where_it_is() {
    for a in [26.25, 28.75] {
        let outcome = done(&under_an_edge(a, "edges"));
        let last = |name: &str| *outcome.column(name).last().expect("steps");
        let (e, inertia, d) = (1000.0, 4.0 / 12.0, 0.3);
        let exact = 3.0 * e * inertia * d / f64::powi(a, 3);
        let force = last("force.wall.z");
        let arm = (last("moment.wall.y") / force).abs();
        println!("at {a}: force {force} of {exact}, arm {arm}");
        assert!((force / exact - 1.0).abs() < 0.01, "{force} {exact}");
        assert!((arm / a - 1.0).abs() < 2e-3, "{arm} {a}");
        // What the edge carries is told on both sides of its contact.
        let [slave, master] = ["slave", "master"].map(|s| last(&format!("{s}.force.c.z")));
        assert!((slave + master).abs() < 1e-9 * force, "{slave} {master}");
        assert!((force + slave).abs() < 1e-6 * force, "{force} {slave}");
    }
}

/// Two cantilevers across each other: the one above has an edge that leaves the last node on which it rests, or lies between nodes, `at` 44
/// and elsewhere.
fn crossed(exchanged: bool, at: f64) -> Value {
    let (slave, master) = match exchanged {
        false => ("lower.top", "upper.bottom"),
        true => ("upper.bottom", "lower.top"),
    };
    let plate = json!({"plate": {"size": [50, 8], "thickness": 2, "elements": [25, 2]}});
    let turned = json!({"axis": [0, 0, 1], "angle": 90, "translation": [at, -25, 2.2]});
    json!({
        "covact": 1,
        "materials": {"m": {"neo_hooke": {"E": 2000, "nu": 0.35}}},
        "bodies": {
            "lower": {"mesh": plate, "material": "m"},
            "upper": {"mesh": plate, "material": "m", "placement": turned}
        },
        "contacts": {"c": {"slave": slave, "master": master}},
        "supports": {
            "wall": {"on": "lower.x_min", "fixed": true},
            "press": {"on": ["upper.x_min", "upper.x_max"], "displacement": {"x": 0, "y": 0, "z": "-4*t"}}
        }
    })
}

/// With the edge on the master's side, between two nodes, the run is repeated with the edges as slaves: the same force as with the sides
/// exchanged, where the edge is the slave's from the start. Exactly under a row of nodes these slide off it over its rounding, by up
/// to a quarter of their distance, which moves it by some hundredths of the lever arm.
#[test]
fn an_edge_on_the_slave_bears_as_with_the_sides_exchanged() {
    for (at, repeated, off) in [(43.5, true, 0.01), (44.0, false, 0.02)] {
        let [own, exchanged] = [false, true].map(|exchanged| {
            let outcome = done(&crossed(exchanged, at));
            let again = outcome.summary.given_up.runs > 0;
            assert_eq!(
                again,
                repeated && !exchanged,
                "{:?}",
                outcome.summary.warnings
            );
            assert!(outcome.summary.newton_iterations < 100);
            *outcome.column("force.wall.z").last().expect("steps")
        });
        println!("{at}: {own} {exchanged}");
        assert!(exchanged > 1.0, "{exchanged}");
        assert!((own / exchanged - 1.0).abs() < off, "{own} {exchanged}");
    }
}

/// Edges that are flush with the border of the slave are none: `block` on `beam` in plane strain has one edge, two nodes.
#[test]
fn edges_along_the_border_of_the_slave_are_left_out() {
    let points = |passes: &str| {
        let mut scene = under_an_edge(26.25, passes);
        scene["contacts"]["c"]["points"] = json!("nodes");
        let text = scene.to_string();
        let loaded = scene::parse(&text, "scene.json").expect("well formed");
        let model = model::build::build(&loaded).expect("a model");
        let points = |p: &model::PairModel| (p.edges_of, p.points.len());
        model.pairs.iter().map(points).collect::<Vec<_>>()
    };
    assert_eq!(points("one"), [(None, 34)]);
    // The edge above the beam, and what of the block is beyond its tip: three nodes on either side.
    assert_eq!(points("edges"), [(None, 34), (Some(0), 2 + 2 * 3)]);
}

#[test]
fn edges_need_two_bodies() {
    let mut own = under_an_edge(26.25, "edges");
    own["contacts"]["c"]["master"] = json!("beam.bottom");
    own["bodies"]
        .as_object_mut()
        .expect("bodies")
        .remove("block");
    own["supports"]["plane"]["on"] = json!(["beam.y_min", "beam.y_max"]);
    own["supports"]
        .as_object_mut()
        .expect("supports")
        .remove("press");
    own["materials"]
        .as_object_mut()
        .expect("materials")
        .remove("stiff");
    let loaded = scene::parse(&own.to_string(), "scene.json").expect("well formed");
    let error = model::build::build(&loaded).expect_err("self contact");
    assert_eq!(error.pointer, "/contacts/c/passes");
}
