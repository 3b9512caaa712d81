//! A sheet that meets itself.
use super::trims::line;
use super::{knots, off, solve_sheet_file};
use crate::support::Outcome;
use serde_json::{Value, json};

/// Radius and thickness of a tube.
const R: f64 = 10.0;
const T: f64 = 0.5;

/// What of the ring is there.
#[derive(Clone, Copy, PartialEq)]
enum Part {
    /// Half of it as one face.
    Half,
    /// The same as two faces, which meet at the side.
    TwoFaces,
    /// Its upper quarter.
    Quarter,
}

/// Half of a ring of width 1 about y, or its upper quarter: xi1 runs from the top down on the side of positive x.
fn ring(part: Part) -> Value {
    // The rational cubic of a half turn, and its first half by de Casteljau's rule.
    let half = [
        [0.0, R, 1.0],
        [2.0 * R / 3.0, R / 3.0, 1.0 / 3.0],
        [2.0 * R / 3.0, -R / 3.0, 1.0 / 3.0],
        [0.0, -R, 1.0],
    ];
    let mean = |a: [f64; 3], b: [f64; 3]| [0, 1, 2].map(|c| 0.5 * (a[c] + b[c]));
    let line = match part {
        Part::Half => half,
        Part::Quarter | Part::TwoFaces => {
            let one = [0, 1, 2].map(|k| mean(half[k], half[k + 1]));
            let two = [0, 1].map(|k| mean(one[k], one[k + 1]));
            [half[0], one[0], two[0], mean(two[0], two[1])]
        }
    };
    let mut faces = vec![extruded(1, 3, &line, None)];
    if part == Part::TwoFaces {
        // The lower quarter, from the side down.
        let mut below = line.map(|[x, z, w]| [x, -z, w]);
        below.reverse();
        faces.push(extruded(2, 3, &below, None));
    }
    json!({"covact_geometry": 1, "unit": "mm", "resolution": null, "patches": faces})
}

/// The tube between its planes of symmetry, pressed down at its top by `way` in the end.
fn pressed(of: Part, way: f64, penalty: f64) -> Outcome {
    let quarter = of == Part::Quarter;
    let part = if quarter { 0.5 } else { 1.0 };
    let [top, bottom, sides] = match of {
        Part::Half | Part::Quarter => [
            json!("tube.edge.1"),
            json!("tube.edge.2"),
            json!(["tube.edge.3", "tube.edge.4"]),
        ],
        Part::TwoFaces => [
            json!("tube.1.edge.1"),
            json!("tube.2.edge.2"),
            json!([
                "tube.1.edge.3",
                "tube.1.edge.4",
                "tube.2.edge.3",
                "tube.2.edge.4"
            ]),
        ],
    };
    let elements = if of == Part::Half { 32 } else { 16 };
    let mut scene = json!({
        "covact": 1,
        "materials": {"m": {"st_venant_kirchhoff": {"E": 1000, "nu": 0}}},
        "bodies": {"tube": {
            "nurbs": {"file": "face.json", "thickness": T, "elements": [elements, 1]}, "material": "m"
        }},
        "contacts": {"walls": {
            "slave": "tube.bottom", "master": "tube.bottom", "penalty": {"value": penalty}
        }},
        "supports": {
            "top": {"on": top, "symmetry": "x"},
            "sides": {"on": sides, "displacement": {"y": 0}},
            "push": {"on": top, "displacement": {
                "z": {"table": [[0, 0], [0.9, -19.3 * part], [1, -way * part]]}
            }}
        },
        "solution": {"step": {"initial": 0.05, "max": 0.05}, "newton": {"tolerance": 1e-9}},
        "output": {"every": 0}
    });
    if quarter {
        // The other half is the mirror image: a plane half-way, with twice the penalty as points sink in half as far.
        scene["surfaces"] = json!({"mirror": {"plane": {"normal": [0, 0, 1], "size": [60, 10]}}});
        scene["contacts"]["walls"]["master"] = json!("mirror");
        scene["contacts"]["walls"]["penalty"]["value"] = json!(2.0 * penalty);
        scene["supports"]["middle"] = json!({"on": bottom, "symmetry": "z"});
    } else {
        scene["supports"]["bottom"] = json!({"on": bottom, "symmetry": "x"});
        scene["supports"]["ground"] = json!({"on": bottom, "displacement": {"z": 0}});
    }
    let outcome = solve_sheet_file(&ring(of), &scene);
    let summary = &outcome.summary;
    assert_eq!(summary.status.name(), "done", "{:?}", summary.reason);
    outcome
}

/// Half of a tube is pinched until its walls meet, half of the thickness inside of each: as its upper half meets a rigid plane in the
/// middle. Forces and moments of the walls balance, and nothing is in contact before.
#[test]
fn the_walls_of_a_tube_meet() {
    // Where walls are inclined, the gap along a normal differs from that along z by a part of the overlap: a small one.
    let (way, penalty) = (2.0 * R - T + 0.01, 400.0);
    let half = pressed(Part::Quarter, way, penalty);
    // With a seam, control points meet that no net connects.
    for part in [Part::Half, Part::TwoFaces] {
        let whole = pressed(part, way, penalty);
        for (time, active) in (whole.column("time").iter()).zip(whole.column("points.active")) {
            // The walls meet where the way is 2 R - T, at time .995.
            assert_eq!(active > 0.0, *time > 0.99, "{time}: {active}");
        }
        let push = [&whole, &half].map(|o| o.at("force.push.z", 1.0));
        let before = [&whole, &half].map(|o| o.at("force.push.z", 0.9));
        println!("{push:?}, before {before:?}");
        assert!(push[0] < 2.0 * before[0], "{push:?} {before:?}");
        // A seam turns by a thousandth of the moment times the width of an element over D: by as much as an element bends in 1e-3 of its
        // length, of which 32 are bent, those at the side most of all.
        let limit = if part == Part::Half { 1e-5 } else { 2e-4 };
        assert!(off(before[0], before[1]) < limit, "{before:?}");
        assert!(off(push[0], push[1]) < 1e-3, "{push:?}");
        for name in ["imbalance.force.walls", "imbalance.moment.walls"] {
            let left = whole.at(name, 1.0);
            println!("{name}: {left:e}");
            assert!(left < 1e-12 * push[0].abs(), "{name}: {left}");
        }
    }
}

/// Distance of the legs of a bent strip from the middle, their length, thickness.
const BEND: f64 = 2.0;
const LEG: f64 = 10.0;
const STRIP: f64 = 0.4;

/// A face extruded by 1 along y from homogeneous control points (x, z, w) along xi1.
fn extruded(entity: u32, degree: usize, line: &[[f64; 3]], trim: Option<Value>) -> Value {
    let points: Vec<[f64; 4]> = [0.0, 1.0]
        .into_iter()
        .flat_map(|y| line.iter().map(move |[x, z, w]| [*x, w * y, *z, *w]))
        .collect();
    let mut face = json!({
        "entity": entity, "degree": [degree, 1], "knots": [knots(degree), knots(1)], "points": points
    });
    if let Some(trim) = trim {
        face["trim"] = trim;
    }
    face
}

/// A strip bent to a U that lies on its side, of four faces: a leg (1), two quarters of a circle (2, 3), and the other leg (4). Its inner
/// faces are at the bottom. The end of the first leg may be cut out of a longer one.
fn bent_strip(cut: bool) -> Value {
    let (r, l, w) = (BEND, LEG, 0.5f64.sqrt());
    let longer = if cut { 1.3 } else { 0.0 };
    // What is cut away, in the parameter of the first leg.
    let gone = longer / (l + longer);
    let corners = [[gone, 0.0], [1.0, 0.0], [1.0, 1.0], [gone, 1.0]];
    let trim = cut.then(|| {
        let lines = (0..4).map(|k| line(corners[k], corners[(k + 1) % 4]));
        json!([Value::from_iter(lines)])
    });
    json!({"covact_geometry": 1, "unit": "mm", "resolution": null, "patches": [
        extruded(1, 1, &[[-l - longer, r, 1.0], [0.0, r, 1.0]], trim),
        extruded(2, 2, &[[0.0, r, 1.0], [w * r, w * r, w], [r, 0.0, 1.0]], None),
        extruded(3, 2, &[[r, 0.0, 1.0], [w * r, -w * r, w], [0.0, -r, 1.0]], None),
        extruded(4, 1, &[[0.0, -r, 1.0], [-l, -r, 1.0]], None),
    ]})
}

/// The end of the free leg is pressed by a force on the other one, which is held as a whole, or on a plane where that has its face, and
/// drawn along it.
fn drawn(master: &str, cut: bool) -> Outcome {
    let end = if cut {
        "strip.1.trim.1.4"
    } else {
        "strip.1.edge.1"
    };
    let edges = |face: u32| [3, 4].map(|k| format!("strip.{face}.edge.{k}"));
    let sides: Vec<String> = (1..=4).flat_map(edges).collect();
    let mut scene = json!({
        "covact": 1,
        "materials": {"m": {"st_venant_kirchhoff": {"E": 1000, "nu": 0}}},
        "bodies": {"strip": {
            "nurbs": {"file": "face.json", "thickness": STRIP, "size": 0.5}, "material": "m"
        }},
        "contacts": {"legs": {
            "slave": "strip.1.bottom", "master": master,
            "penalty": {"value": 200}, "tangential_penalty": {"value": 200}, "friction": {"coulomb": {"mu": 0.3}}
        }},
        "supports": {
            "sides": {"on": sides, "displacement": {"y": 0}},
            "held": {"on": "strip.4.top", "fixed": true},
            "end": {"on": end, "displacement": {"x": {"table": [[0, 0], [1, 0], [2, 5]]}}}
        },
        "loads": {"press": {"on": end, "force": [0, 0, {"table": [[0, 0], [1, -0.1]]}]}},
        "solution": {"end_time": 2, "step": {"initial": 0.05, "max": 0.05}},
        "output": {"every": 0}
    });
    if master == "floor" {
        scene["surfaces"] = json!({"floor": {
            "plane": {"center": [-5, 0.5, -BEND], "normal": [0, 0, 1], "size": [40, 10]}
        }});
        scene["contacts"]["legs"]["offset"] = json!(0.5 * STRIP);
    }
    let outcome = solve_sheet_file(&bent_strip(cut), &scene);
    let summary = &outcome.summary;
    assert_eq!(summary.status.name(), "done", "{:?}", summary.reason);
    outcome
}

/// Parts of one body meet with friction: the same forces as on a rigid plane half of the thickness before the leg that is held, forces
/// and moments of both sides balance, and while the end slides Coulomb's law holds. The end of the leg may be a curve of a trim, whose
/// elements are cut.
#[test]
fn legs_of_a_strip_rub() {
    let rigid = drawn("floor", false);
    let own = drawn("strip.4.bottom", false);
    let cut = drawn("strip.4.bottom", true);
    // Pressed, and while it slides.
    for time in [1.0, 1.5, 2.0] {
        let at = |of: &Outcome| of.at("force.end.x", time);
        println!("{time}: {} {} {}", at(&rigid), at(&own), at(&cut));
        // In the step of their first touch points that meet their own body are tied by another law.
        let same = if time > 1.0 { 1e-6 } else { 2e-2 };
        assert!((at(&own) - at(&rigid)).abs() < same * at(&rigid).abs());
        if time > 1.0 {
            assert!(at(&rigid) > 0.3 && off(at(&cut), at(&rigid)) < 3e-3);
        }
        for of in [&own, &cut] {
            let [x, z] = ["x", "z"].map(|c| of.at(&format!("slave.force.legs.{c}"), time));
            assert!(z > 0.05, "{z}");
            if time > 1.0 {
                assert!(off(-x / z, 0.3) < 1e-6, "{x} {z}");
            }
            // Lengths are up to 12.
            for (name, length) in [("force", 1.0), ("moment", 12.0)] {
                let left = of.at(&format!("imbalance.{name}.legs"), time);
                assert!(left < 1e-12 * length * z, "{name}: {left}");
            }
        }
    }
}
