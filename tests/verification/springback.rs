//! Springback: sheets of metal that are bent over tools and released.
//!
//! Closed form: a wide strip (plane strain) of thickness t bent to the curvature k with a moment M springs back elastically by
//! `12 M / (E' t^3)`, `E' = E / (1 - nu^2)`. Perfectly plastic sheets: F. J. Gardiner, "The spring back of metals", Transactions of
//! the ASME 79 (1957); here with linear hardening, whose moment is the integral of the bilinear law of plane strain, of yield stress
//! `s = 2 sigma_y / sqrt(3)` and slope `H' = 4 H / 3` of its plastic part.
use covact::run::{Options, Simulation};
use covact::scene;
use nalgebra::Vector3;
use serde_json::{Value, json};

const E: f64 = 200e3;
const NU: f64 = 0.3;
const YIELD: f64 = 200.0;
const SLOPE: f64 = 2000.0;
const PLANE: f64 = E / (1.0 - NU * NU);

/// Moment per width that bends a sheet of thickness 1 to a curvature.
fn moment(curvature: f64) -> f64 {
    let s = 2.0 * YIELD / 3f64.sqrt();
    let hardening = 4.0 / 3.0 * SLOPE;
    let tangent = PLANE * hardening / (PLANE + hardening);
    let y = (s / (PLANE * curvature)).min(0.5);
    let beyond = curvature * (0.125 - y.powi(3)) / 3.0 - y * curvature * (0.25 - y * y) / 2.0;
    2.0 * (PLANE * curvature * y.powi(3) / 3.0 + s * (0.25 - y * y) / 2.0 + tangent * beyond)
}

/// Half of a strip of thickness 1 and `length` (in units of the radius) over a cylinder: its end is moved down by `way`, then
/// everything is taken away.
fn wrapped(radius: f64, [length, way]: [f64; 2], elements: u32) -> Value {
    let length = length * radius;
    let width = length / f64::from(elements);
    json!({
        "covact": 1,
        "materials": { "m": { "j2": {
            "E": E, "nu": NU, "hardening": { "linear": { "yield_stress": YIELD, "slope": SLOPE } }
        } } },
        "bodies": { "strip": {
            "mesh": { "plate": { "size": [length, width], "thickness": 1, "elements": [elements, 1] } },
            "material": "m"
        } },
        "surfaces": { "cylinder": {
            "cylinder": {
                "center": [0, width / 2.0, -radius], "axis": [0, 1, 0], "radius": radius - 0.5, "length": 3.0 * width
            },
            "side": "outward"
        } },
        "contacts": { "wrap": { "slave": "strip.bottom", "master": "cylinder" } },
        "supports": {
            "middle": { "on": "strip.x_min", "symmetry": "x" },
            "flat": { "on": "strip", "plane_strain": "y" },
            "end": {
                "on": "strip.x_max", "mid_surface": true,
                "displacement": { "z": { "table": [[0, 0], [1, -way * radius]] } }
            }
        },
        "stages": [
            { "name": "wrap", "until": 1 },
            { "name": "release", "release": "forces", "supports": ["middle", "flat", "automatic"] }
        ],
        "solution": { "end_time": 1.3 }
    })
}

fn simulation(scene: &Value) -> Simulation<'static> {
    let text = serde_json::to_string_pretty(scene).expect("serialisable");
    let mut loaded = match scene::parse(&text, "scene.json") {
        Ok(loaded) => loaded,
        Err(e) => panic!("{e}"),
    };
    loaded.dir = "examples/scenes".into();
    Simulation::new(loaded, Options::default()).expect("valid model")
}

/// Steps to a time.
fn to(simulation: &mut Simulation, time: f64) {
    while simulation.time() < time - 1e-9 {
        let step = simulation.step().expect("an equilibrium");
        assert!(step.is_some(), "ended at {}", simulation.time());
    }
}

/// Curvatures of the elements along a strip, from the turn of its fibres from column to column, and the undeformed places of these.
fn curvatures(simulation: &Simulation) -> Vec<[f64; 2]> {
    let u = simulation.displacements("strip").expect("a body");
    let model = simulation.model();
    let body = &model.bodies[0];
    let nodes: Vec<Vector3<f64>> = model.nodes[body.first_node as usize..][..u.len()].to_vec();
    let mut columns: Vec<f64> = nodes.iter().map(|x| x.x).collect();
    columns.sort_by(f64::total_cmp);
    columns.dedup_by(|a, b| (*a - *b).abs() < 1e-6);
    // Mean places of the top and the bottom of a column.
    let face = |x: f64, top: bool| {
        let own: Vec<_> = (nodes.iter().zip(&u))
            .filter(|(p, _)| (p.x - x).abs() < 1e-6 && (p.z > 0.0) == top)
            .map(|(p, u)| p + u)
            .collect();
        assert!(own.len() > 1);
        own.iter().sum::<Vector3<f64>>() / own.len() as f64
    };
    let columns: Vec<_> = (columns.into_iter())
        .map(|x| (x, face(x, true), face(x, false)))
        .collect();
    (columns.windows(2))
        .map(|pair| {
            let [(x1, top1, bottom1), (x2, top2, bottom2)] = [pair[0], pair[1]];
            let (d1, d2) = (top1 - bottom1, top2 - bottom2);
            let turn = d1.cross(&d2).y.atan2(d1.dot(&d2));
            let length = (top1 + bottom1 - top2 - bottom2).norm() / 2.0;
            [0.5 * (x1 + x2), turn / length]
        })
        .collect()
}

/// Every element springs back by what the moment that has bent it explains, over the part that lay on the cylinder.
#[test]
fn a_wrapped_strip_springs_back_as_a_beam() {
    // The limits of the closed form: elastic, and above the fully plastic moment.
    let (elastic, plastic) = (moment(1e-4), moment(1e3));
    assert!((elastic / (PLANE * 1e-4 / 12.0) - 1.0).abs() < 1e-12);
    assert!(plastic > 2.0 * YIELD / 3f64.sqrt() / 4.0);
    for (radius, way) in [(10.0, [3.0, 1.9]), (50.0, [3.0, 1.9]), (200.0, [3.0, 2.4])] {
        let mut run = simulation(&wrapped(radius, way, 90));
        to(&mut run, 1.0);
        let bent = curvatures(&run);
        to(&mut run, 1.3);
        let released = curvatures(&run);
        let (mut found, mut expected, mut count) = (0.0, 0.0, 0);
        for ([x, k], [_, after]) in bent.iter().zip(&released) {
            if *x > 0.05 * radius && (k * radius - 1.0).abs() < 0.03 {
                found += k - after;
                expected += 12.0 * moment(*k) / PLANE;
                count += 1;
            }
        }
        let summary = run.summary();
        println!(
            "R/t {radius}: {count} elements, springback {:.5} of the curvature, expected {:.5} ({:+.2} %); {} iterations, {} of them \
             failed",
            found * radius / f64::from(count),
            expected * radius / f64::from(count),
            100.0 * (found / expected - 1.0),
            summary.newton_iterations,
            summary.failed_iterations
        );
        assert!(count >= 5, "{count}");
        assert!((found / expected - 1.0).abs() < 0.015);
        // Supports that are found bear nothing, and tools are gone.
        let stages = &summary.stages;
        assert_eq!(stages.len(), 2);
        assert!(stages[1].found_supports == 1 && stages[1].bearing.is_empty());
        assert!(stages[1].force > 0.1 && stages[1].reaction < 1e-6 * stages[1].force);
    }
}

/// What the shipped scene leaves, and the way of its tip at the end of either stage.
fn bent_and_released(release: &str) -> (Simulation<'static>, [f64; 2]) {
    let text =
        std::fs::read_to_string("examples/scenes/bend_and_release.json").expect("shipped scene");
    let mut scene: Value = serde_json::from_str(&text).expect("valid JSON");
    scene["stages"][1]["release"] = json!(release);
    let mut run = simulation(&scene);
    let end = scene["solution"]["end_time"].as_f64().expect("a time");
    let tip = |run: &Simulation| run.value("probe.tip.x").expect("a column");
    to(&mut run, 1.0);
    let bent = tip(&run);
    to(&mut run, end);
    let released = tip(&run);
    (run, [bent, released])
}

/// Whether forces are let down or tools go back, a sheet that does not yield again takes the same shape.
#[test]
fn both_ways_of_release_leave_the_same_shape() {
    let (forces, [bent, released]) = bent_and_released("forces");
    let (tools, [bent_too, released_too]) = bent_and_released("tools");
    println!("tip x: bent {bent}, released {released} by forces, {released_too} by tools");
    assert_eq!(bent, bent_too);
    let springback = released - bent;
    assert!(springback > 0.1);
    assert!((released_too - released).abs() < 1e-3 * springback);
    let work = |run: &Simulation| run.value("energy.plastic").expect("a column");
    assert!(work(&forces) > 0.0 && (work(&tools) / work(&forces) - 1.0).abs() < 1e-3);
    // Stresses that bending leaves store energy, and nothing holds the strip from outside.
    let stored = [&forces, &tools].map(|run| run.value("energy.internal").expect("a column"));
    assert!(stored[0] > 0.0 && (stored[1] / stored[0] - 1.0).abs() < 1e-3);
    for run in [&forces, &tools] {
        for surface in ["punch", "roller"] {
            let force = run.force(surface).expect("a surface").force;
            assert_eq!(force.norm(), 0.0, "{surface}");
        }
    }
}

/// Two sheets of different lengths that are bent together and stay in contact when their tools are let go: what holds one must not hold
/// the other by another place, or both would clamp each other in the shape that they have. They come back as they do where the tools go back, which
/// needs no supports to be found.
#[test]
fn sheets_that_stay_in_contact_spring_back_together() {
    let cylinder = |r: f64, x: f64, z: f64| json!({ "cylinder": { "radius": r, "length": 20, "center": [x, 1.5, z], "axis": [0, 1, 0] } });
    let sheet = |t: f64, z: f64, (length, elements): (f64, u32)| {
        json!({
            "mesh": { "plate": { "size": [length, 3], "thickness": t, "elements": [elements, 2], "origin": [0, 0, z] } },
            "material": "steel"
        })
    };
    let springback = |free: Value| {
        let scene = json!({
            "covact": 1,
            "materials": { "steel": { "j2": {
                "E": 206000, "nu": 0.3, "hardening": { "swift": { "strength": 565, "offset": 0.0071, "exponent": 0.26 } }
            } } },
            "bodies": { "up": sheet(0.8, 0.4, (32.0, 20)), "low": sheet(1.2, -0.6, (40.0, 24)) },
            "surfaces": { "punch": cylinder(8.0, 0.0, 8.8), "roller": cylinder(5.0, 25.0, -6.2) },
            "contacts": {
                "above": { "slave": "up.top", "master": "punch" },
                "between": { "slave": "up.bottom", "master": "low.top" },
                "below": { "slave": "low.bottom", "master": "roller" }
            },
            "supports": {
                "middle": { "on": ["up.x_min", "low.x_min"], "symmetry": "x" }, "sides": { "on": ["up", "low"], "symmetry": "y" }
            },
            "probes": {
                "tip": { "near": [40, 1.5, -0.6], "body": "low" }, "middle": { "near": [0, 1.5, -0.6], "body": "low" }
            },
            "stages": [{ "name": "bend", "until": 1, "tools": { "punch": [0, 0, -6] } }, free],
            "solution": { "end_time": 1.5 },
            "output": { "every": 0 }
        });
        let mut run = simulation(&scene);
        let bow = |run: &Simulation| {
            let [tip, middle] = ["tip", "middle"].map(|p| run.value(&format!("probe.{p}.z")));
            tip.expect("a column") - middle.expect("a column")
        };
        to(&mut run, 1.0);
        let bent = bow(&run);
        to(&mut run, 1.5);
        let stages = run.summary().stages;
        (bent - bow(&run), stages[1].reaction / stages[1].force)
    };
    let (kept, reaction) =
        springback(json!({ "name": "free", "contacts": ["between"], "release": "forces" }));
    let (expected, _) =
        springback(json!({ "name": "free", "contacts": ["between"], "release": "tools" }));
    println!("springback {kept} with the contact kept, {expected} by tools; supports {reaction}");
    assert!(expected > 0.5);
    assert!((kept / expected - 1.0).abs() < 1e-3);
}

/// A strip that is bent between a punch and a roller, with friction, and let go by taking the punch back the way it came. The punch has
/// left after the first step, so that nothing is left to carry: neither at the roller nor anywhere else. The automatic penalty of the
/// punch is lowered at the end of the first stage; what that changes is no force that acts in the second.
#[test]
fn a_punch_that_goes_back_leaves_no_force() {
    let cylinder = |x: f64, z: f64| json!({ "cylinder": { "radius": 3, "length": 20, "center": [x, 2, z], "axis": [0, 1, 0] } });
    let scene = json!({
        "covact": 1,
        "materials": { "steel": { "j2": {
            "E": 206000, "nu": 0.3, "hardening": { "swift": { "strength": 560, "offset": 0.008, "exponent": 0.2 } }
        } } },
        "bodies": { "strip": {
            "mesh": { "plate": {
                "size": [28, 4], "thickness": 1.5, "elements": [56, 1], "origin": [0, 0, 0.75], "layers": 2
            } },
            "material": "steel"
        } },
        "surfaces": { "roller": cylinder(20.0, -3.0), "punch": cylinder(0.0, 4.5) },
        "contacts": {
            "below": { "slave": "strip.bottom", "master": "roller", "friction": 0.1, "points": { "gauss": 3 } },
            "above": { "slave": "strip.top", "master": "punch", "friction": 0.1, "points": "nodes" }
        },
        "supports": {
            "middle": { "on": "strip.x_min", "symmetry": "x" }, "sides": { "on": ["strip"], "symmetry": "y" }
        },
        "solution": { "end_time": 1.3 },
        "stages": [
            { "name": "bend", "until": 1, "tools": { "punch": [0, 0, -9] } },
            { "name": "back", "release": "tools" }
        ],
        "output": { "every": 0 }
    });
    let loaded = scene::parse(&scene.to_string(), "springback.json").expect("a scene");
    let mut run = Simulation::new(loaded, Options::default()).expect("a run");
    let mut bent = 0.0;
    while let Some(step) = run.step().expect("a step") {
        let [punch, roller] = ["punch", "roller"].map(|name| run.force(name).unwrap().force.z);
        println!("{}: {punch}, {roller}", step.time);
        if step.time < 1.0 + 1e-9 {
            bent = roller;
        } else {
            assert!(
                bent > 30.0 && punch == 0.0 && roller.abs() < 1e-3 * bent,
                "{roller} of {bent}"
            );
        }
    }
    assert!(run.done());
}

/// A strip that a soft pad has pressed on a drum, held along itself at the middle of one edge and across at one side. Once it is bent,
/// that edge is not quite straight and would hold the strip's turn about it by a lever of nothing: two supports have to be found, for
/// the way up and for that turn, and they carry nothing.
#[test]
fn a_strip_held_by_one_edge_is_found_its_supports() {
    let scene = json!({
        "covact": 1,
        "materials": {
            "al": { "j2": {
                "E": 70000, "nu": 0.33, "hardening": { "table": [[0, 120], [0.02, 160], [0.1, 210]] }
            } },
            "pu": { "neo_hooke": { "E": 20, "nu": 0.45 } }
        },
        "bodies": {
            "strip": {
                "mesh": { "plate": { "size": [40, 6], "thickness": 0.8, "elements": [20, 2], "origin": [0, 0, 0.41] } },
                "material": "al"
            },
            "pad": {
                "mesh": { "block": { "min": [10, 0, 0.83], "max": [30, 6, 6], "elements": [8, 2, 3] } },
                "material": "pu"
            }
        },
        "surfaces": { "drum": {
            "cylinder": { "radius": 10, "length": 20, "center": [20, 3, -10], "axis": [0, 1, 0] }
        } },
        "contacts": {
            "below": { "slave": "strip.bottom", "master": "drum", "friction": 0.1 },
            "above": { "slave": "strip.top", "master": "pad.bottom", "friction": 0.1 }
        },
        "supports": {
            "side": { "on": "strip.y_min", "symmetry": "y" },
            "edge": { "on": "strip.x_min", "mid_surface": true, "displacement": { "x": 0 } },
            "ram": { "on": "pad.top", "displacement": {
                "x": 0, "y": 0, "z": { "table": [[0, 0], [1, -0.5], [2, -0.5]] }
            } }
        },
        "solution": { "end_time": 2 },
        "stages": [{ "name": "press", "until": 1 }, { "name": "release", "release": "forces" }],
        "output": { "every": 0 }
    });
    let loaded = scene::parse(&scene.to_string(), "pad.json").expect("a scene");
    let mut run = Simulation::new(loaded, Options::default()).expect("a run");
    while run.step().expect("a step").is_some() {}
    assert!(run.done());
    let release = &run.summary().stages[1];
    assert_eq!(release.found_supports, 2);
    assert!(release.force > 1.0, "{release:?}");
    assert!(release.reaction < 1e-4 * release.force, "{release:?}");
}
