//! Trimmed faces as shells: elements that a trim cuts are integrated along it.
use super::{arc, knots, off, solve_sheet_file};
use crate::support::Outcome;
use serde_json::{Value, json};
use std::f64::consts::PI;

/// A curve in the plane of parameters: homogeneous points (w x, w y, w) on clamped knots of one span.
pub fn curve(points: &[[f64; 3]]) -> Value {
    let degree = points.len() - 1;
    json!({"degree": degree, "knots": knots(degree), "domain": [0.0, 1.0], "points": points})
}

pub fn line(a: [f64; 2], b: [f64; 2]) -> Value {
    curve(&[[a[0], a[1], 1.0], [b[0], b[1], 1.0]])
}

/// The border of the whole domain.
pub fn border() -> Value {
    let corners = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
    Value::from_iter((0..4).map(|k| line(corners[k], corners[(k + 1) % 4])))
}

/// A circle about the middle, of four quarters.
pub fn circle(radius: f64) -> Value {
    Value::from_iter((0..4).map(|k| {
        let [a, b] = [k, k + 1].map(|k| 0.5 * PI * f64::from(k));
        let points = arc(a, b).map(|[x, y, w]| {
            // End points of `arc` are on the circle, the one between is not; all are about the origin.
            let place = |v: f64| w * (0.5 + radius * v);
            [place(x), place(y), w]
        });
        curve(&points)
    }))
}

pub fn face(entity: u32, degree: [usize; 2], points: &[[f64; 4]], trim: Value) -> Value {
    let knots = degree.map(knots);
    let mut out = json!({"entity": entity, "degree": degree, "knots": knots, "points": points});
    if !trim.is_null() {
        out["trim"] = trim;
    }
    out
}

pub fn file(faces: Vec<Value>) -> Value {
    json!({"covact_geometry": 1, "unit": "mm", "resolution": null, "patches": faces})
}

/// A square plate of side 4 about the origin, with a hole of this radius (or none) cut out.
pub fn square(radius: f64) -> Value {
    let points = [[-2.0, -2.0], [2.0, -2.0], [-2.0, 2.0], [2.0, 2.0]];
    let points = points.map(|[x, y]| [x, y, 0.0, 1.0]);
    let trim = json!([border(), circle(radius / 4.0)]);
    file(vec![face(1, [1, 1], &points, trim)])
}

/// The same plate of four faces between the hole and a side each, without a trim: xi1 runs round, xi2 outwards.
pub fn four_faces(radius: f64) -> Value {
    let faces = (0..4).map(|k| {
        let middle = 0.5 * PI * f64::from(k);
        let inner = arc(middle - 0.25 * PI, middle + 0.25 * PI);
        let mut points: Vec<[f64; 4]> = (inner.iter())
            .map(|[x, y, w]| [w * radius * x, w * radius * y, 0.0, *w])
            .collect();
        let (s, c) = middle.sin_cos();
        points.extend((0..3).map(|i| {
            let along = 2.0 * f64::from(i) - 2.0;
            let w = inner[i as usize][2];
            [w * (2.0 * c - along * s), w * (2.0 * s + along * c), 0.0, w]
        }));
        // Outwards and then round: the normal is up.
        face(k as u32 + 1, [2, 1], &points, Value::Null)
    });
    file(faces.collect())
}

fn scene(nurbs: Value, edges: [&str; 2], moved: Value) -> Value {
    let mut body = json!({"nurbs": nurbs, "material": "m"});
    body["nurbs"]["file"] = json!("face.json");
    json!({
        "covact": 1,
        "materials": {"m": {"st_venant_kirchhoff": {"E": 1000, "nu": 0.3}}},
        "bodies": {"plate": body},
        "supports": {
            "held": {"on": edges[0], "fixed": true, "clamped": true},
            "moved": {"on": edges[1], "displacement": moved}
        },
        "solution": {"step": {"initial": 1.0, "max": 1.0}, "newton": {"tolerance": 1e-9}},
        "output": {"every": 0}
    })
}

/// A plate with a hole of half of its width, clamped at one edge, stretched and bent by the other: as four faces without a trim it takes the same
/// forces. (The hole takes a third of them: a plate without one is compared.)
#[test]
fn a_plate_with_a_hole() {
    for (component, moved) in [
        ("x", json!({"x": 0.004, "y": 0, "z": 0})),
        ("z", json!({"x": 0, "y": 0, "z": 0.01})),
    ] {
        let run = |file: Value, elements: [u32; 2], edges: [&str; 2]| -> Outcome {
            let nurbs = json!({"thickness": 0.1, "elements": elements});
            solve_sheet_file(&file, &scene(nurbs, edges, moved.clone()))
        };
        let force = |outcome: &Outcome| outcome.at(&format!("force.moved.{component}"), 1.0);
        let edges = ["plate.edge.1", "plate.edge.2"];
        let trimmed = run(square(1.0), [17, 17], edges);
        let whole = run(square(1e-3), [17, 17], edges);
        let faces = run(
            four_faces(1.0),
            [12, 8],
            ["plate.3.edge.4", "plate.1.edge.4"],
        );
        let [trimmed, whole, faces] = [trimmed, whole, faces].map(|o| force(&o));
        println!("{component}: {trimmed} trimmed, {faces} of faces, {whole} without a hole");
        assert!(faces.abs() < 0.8 * whole.abs(), "{faces} {whole}");
        assert!(off(trimmed, faces) < 5e-4, "{component}: {trimmed} {faces}");
    }
}

/// A trapezoid whose slanted sides are cut away, so that a strip of constant width is left: in the parameters the curves are
/// hyperbolas. Under tension (without Poisson's effect, as its end is held) its stress is uniform, to the last digits.
#[test]
fn a_strip_is_under_uniform_tension() {
    // y = (2 v - 1) (1 + u), x = 4 u.
    let points = [[0.0, -1.0], [4.0, -2.0], [0.0, 1.0], [4.0, 2.0]];
    let points = points.map(|[x, y]| [x, y, 0.0, 1.0]);
    // v = (1 + c / (1 + u)) / 2, as (w u, w v, w) with w = 1 + u: a rational quadratic.
    let [low, high] = [-0.83, 0.61];
    let side = |c: f64| {
        [
            [0.0, 0.5 * (1.0 + c), 1.0],
            [0.5, 0.5 * (1.5 + c), 1.5],
            [2.0, 0.5 * (2.0 + c), 2.0],
        ]
    };
    let [bottom, mut top] = [low, high].map(side);
    let ends = |p: [[f64; 3]; 3]| [p[0], p[2]].map(|[x, y, w]| [x / w, y / w]);
    let (b, t) = (ends(bottom), ends(top));
    top.reverse();
    let trim = json!([[
        curve(&bottom),
        line(b[1], t[1]),
        curve(&top),
        line(t[0], b[0])
    ]]);
    let face = face(1, [1, 1], &points, trim);
    for assumed in [true, false] {
        let scene = json!({
            "covact": 1,
            "materials": {"m": {"st_venant_kirchhoff": {"E": 1000, "nu": 0}}},
            "bodies": {"plate": {
                "nurbs": {
                    "file": "face.json", "thickness": 0.1, "elements": [7, 9], "assumed_membrane": assumed
                },
                "material": "m"
            }},
            "supports": {
                "flat": {"on": "plate.top", "displacement": {"z": 0}},
                "left": {"on": "plate.edge.1", "displacement": {"x": 0, "y": 0}},
                "right": {"on": "plate.edge.2", "displacement": {"x": 0.4}}
            },
            "solution": {"step": {"initial": 1.0, "max": 1.0}, "newton": {"tolerance": 1e-12}},
            "output": {"every": 0}
        });
        let outcome = solve_sheet_file(&file(vec![face.clone()]), &scene);
        // Green's strain of a stretch of 1.1, and the first Piola-Kirchhoff stress with it.
        let strain = 0.5 * (1.1f64 * 1.1 - 1.0);
        let exact = 1.1 * 1000.0 * strain * 0.1 * (high - low);
        let found = outcome.at("force.right.x", 1.0);
        println!("{found} {exact}");
        assert!(off(found, exact) < 1e-9, "{found} {exact}");
    }
}

/// The weight of a plate with a hole, or of a disc that is held in its middle, is that of its exact area.
#[test]
fn the_area_is_exact() {
    let small = 1e-9;
    let plate = |trim: Value| {
        let points = [[-2.0, -2.0], [2.0, -2.0], [-2.0, 2.0], [2.0, 2.0]];
        let points = points.map(|[x, y]| [x, y, 0.0, 1.0]);
        file(vec![face(1, [1, 1], &points, trim)])
    };
    let r = 1.37f64;
    for (trim, on, area) in [
        (
            json!([border(), circle(r / 4.0)]),
            "plate.edge.3",
            16.0 - PI * r * r,
        ),
        (json!([circle(r / 4.0)]), "plate.middle", PI * r * r),
    ] {
        let mut scene = json!({
            "covact": 1,
            "materials": {"m": {"st_venant_kirchhoff": {"E": 1000, "nu": 0.3}}},
            "bodies": {"plate": {
                "nurbs": {"file": "face.json", "thickness": 0.1, "elements": [9, 9]}, "material": "m"
            }},
            "supports": {"held": {"on": on, "fixed": true, "clamped": on == "plate.edge.3"}},
            "loads": {"weight": {"on": "plate.top", "traction": [0, 0, -small]}},
            "solution": {"step": {"initial": 1.0, "max": 1.0}, "newton": {"tolerance": 1e-6}},
            "output": {"every": 0}
        });
        if on == "plate.middle" {
            let middle = json!({"min": [-0.3, -0.3, -1], "max": [0.3, 0.3, 1]});
            scene["bodies"]["plate"]["sets"] = json!({"middle": {"faces_in_box": middle}});
        }
        let outcome = solve_sheet_file(&plate(trim), &scene);
        let found = outcome.at("force.held.z", 1.0);
        println!("{found} {}", small * area);
        assert!(off(found, small * area) < 1e-9, "{found} {}", small * area);
    }
}
