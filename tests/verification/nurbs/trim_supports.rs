//! Supports and loads on curves of trims, which lie across elements.
//!
//! Plates: S. Timoshenko, S. Woinowsky-Krieger, Theory of Plates and Shells, 2nd ed. (1959), articles 15 and 16.
use super::trims::{circle, curve, face, file, line};
use super::{arc, off, solve_sheet_file};
use crate::support::Outcome;
use serde_json::{Value, json};
use std::f64::consts::{FRAC_PI_2, PI};

const E: f64 = 1e6;
const NU: f64 = 0.3;
const THICKNESS: f64 = 0.01;

fn stiffness() -> f64 {
    E * THICKNESS.powi(3) / (12.0 * (1.0 - NU * NU))
}

/// A quarter of a circle about the origin of the parameters, counter-clockwise.
pub fn quarter(radius: f64) -> Value {
    curve(&arc(0.0, FRAC_PI_2).map(|[x, y, w]| [w * radius * x, w * radius * y, w]))
}

/// A square from the origin with this side, trimmed.
pub fn corner(entity: u32, side: f64, trim: Value) -> Value {
    let points = [[0.0, 0.0], [side, 0.0], [0.0, side], [side, side]];
    face(entity, [1, 1], &points.map(|[x, y]| [x, y, 0.0, 1.0]), trim)
}

/// A quarter of a disc of radius 1 cut out of a square of this side.
fn disc(side: f64) -> Value {
    let r = 1.0 / side;
    let trim = json!([[
        line([0.0, 0.0], [r, 0.0]),
        quarter(r),
        line([0.0, r], [0.0, 0.0])
    ]]);
    file(vec![corner(1, side, trim)])
}

/// The deflection of the middle, and the vertical force on the rim.
fn deflection(
    side: f64,
    elements: u32,
    thickness: f64,
    rim: &Value,
    load: Value,
    [step, newton]: [f64; 2],
) -> [f64; 2] {
    let mut rim = rim.clone();
    rim["on"] = json!("plate.trim.1.2");
    let scene = json!({
        "covact": 1,
        "materials": {"m": {"st_venant_kirchhoff": {"E": E, "nu": NU}}},
        "bodies": {"plate": {
            "nurbs": {"file": "face.json", "thickness": thickness, "elements": [elements, elements]}, "material": "m"
        }},
        "supports": {
            "x": {"on": "plate.edge.1", "symmetry": "x"},
            "y": {"on": "plate.edge.3", "symmetry": "y"},
            "rim": rim
        },
        "loads": {"load": load},
        "probes": {"w": {"on": "plate.corner.1", "quantity": "displacement"}},
        "solution": {"step": {"initial": step, "max": 1.0}, "newton": {"tolerance": newton}},
        "output": {"every": 0}
    });
    let outcome = solve_sheet_file(&disc(side), &scene);
    ["probe.w.z", "force.rim.z"].map(|name| outcome.at(name, 1.0))
}

/// Pressure on a disc that is clamped or hinged along a trim, eight elements along its radius of 1 on a square of side 1.2: within .1 %,
/// and the rim bears the load. With knots just inside of the rim, so that the curve leaves thin parts of elements (six elements).
#[test]
fn discs_are_clamped_and_hinged_at_their_trim() {
    // Small beside the thickness.
    let q = 1e-5;
    let load = json!({"on": "plate.top", "traction": [0, 0, -q]});
    let clamped = q / (64.0 * stiffness());
    let hinged = clamped * (5.0 + NU) / (1.0 + NU);
    for (rim, exact, limits) in [
        (json!({"clamped": true}), clamped, [1e-3, 3e-3]),
        (json!({"displacement": {"z": 0}}), hinged, [2e-5, 2e-4]),
    ] {
        for (side, elements, limit) in [
            (1.2, 8, limits[0]),
            (1.2 * 0.99, 6, limits[1]),
            (1.2 * 0.9999, 6, limits[1]),
        ] {
            let [w, force] = deflection(side, elements, THICKNESS, &rim, load.clone(), [1.0, 1e-6]);
            println!(
                "{rim} {side}: {}, force {}",
                -w / exact,
                force / (0.25 * PI * q)
            );
            assert!(off(-w, exact) < limit, "{side}: {w} {exact}");
            // Newton's tolerance is 1e-6 here; thin parts of elements round all of it away.
            let bears = if elements == 8 { 1e-8 } else { 1e-5 };
            assert!(off(force, 0.25 * PI * q) < bears, "{force}");
        }
    }
}

/// Rims that just reach into elements: of seven elements along a side of 1.2 three corners are inside by 4e-4 of the radius, so
/// that shape functions of the points beyond are 1e-15 at most over what is kept. One step at default tolerances;
/// and with a tenth of the thickness the relative deflection is the same within the error of the mesh.
#[test]
fn discs_whose_rims_just_reach_into_elements() {
    for (side, elements, limits) in [
        (1.2, 7, [2.5e-3, 2e-4]),
        (1.2, 10, [5e-4, 5e-5]),
        (1.163, 8, [2e-3, 1e-4]),
        (1.117, 9, [1e-3, 1e-4]),
    ] {
        for (rim, factor, limit) in [
            (json!({"clamped": true}), 1.0, limits[0]),
            (
                json!({"displacement": {"z": 0}}),
                (5.0 + NU) / (1.0 + NU),
                limits[1],
            ),
        ] {
            let [thick, thin] = [0.02, 0.002].map(|t: f64| {
                let stiffness = E * t.powi(3) / (12.0 * (1.0 - NU * NU));
                let q = 64.0 * stiffness * 1e-3 * t;
                let load = json!({"on": "plate.top", "traction": [0, 0, -q]});
                let [w, _] = deflection(side, elements, t, &rim, load, [1.0, 1e-8]);
                -w / (1e-3 * t * factor)
            });
            println!("{side} {elements} {rim}: {thick} {thin}");
            assert!(off(thick, 1.0) < limit, "{side} {elements}: {thick}");
            assert!(
                off(thin, thick) < limit,
                "{side} {elements}: {thin} {thick}"
            );
        }
    }
}

/// The energy of a clamped disc under a pressure, of which few elements are left whole, is that of a thick disc with a tenth of the
/// thickness: within 3 % with 7 elements along 2.4 radii and .6 % with 11. With all of the clamp's stiffness at its points the thin one was
/// 21 and 6.6 % too stiff.
#[test]
fn clamps_do_not_lock_thin_discs() {
    let points = [[-1.2, -1.2], [1.2, -1.2], [-1.2, 1.2], [1.2, 1.2]];
    let points = points.map(|[x, y]| [x, y, 0.0, 1.0]);
    let disc = file(vec![face(1, [1, 1], &points, json!([circle(1.0 / 2.4)]))]);
    for (elements, limit) in [(7, 0.03), (11, 0.006)] {
        let [thick, thin] = [0.02, 0.002].map(|t: f64| {
            let stiffness = E * t.powi(3) / (12.0 * (1.0 - NU * NU));
            let q = 64.0 * stiffness * 1e-3 * t;
            let scene = json!({
                "covact": 1,
                "materials": {"m": {"st_venant_kirchhoff": {"E": E, "nu": NU}}},
                "bodies": {"plate": {
                    "nurbs": {"file": "face.json", "thickness": t, "elements": [elements, elements]}, "material": "m"
                }},
                "supports": {"rim": {"on": "plate.trim.1", "clamped": true}},
                "loads": {"load": {"on": "plate.top", "traction": [0, 0, -q]}},
                "solution": {"step": {"initial": 1.0, "max": 1.0}, "newton": {"tolerance": 1e-8}},
                "output": {"every": 0}
            });
            let energy = solve_sheet_file(&disc, &scene).at("energy.internal", 1.0);
            energy / (PI * q * q / (384.0 * stiffness))
        });
        println!("{elements}: {thick} {thin}");
        assert!(
            off(thick, 1.0) < limit && off(thin, thick) < 1e-3,
            "{thick} {thin}"
        );
    }
}

/// A couple along the rim of a hinged disc bends it to a paraboloid, which cubics have.
#[test]
fn a_couple_along_a_trim() {
    let couple = 1e-6;
    let load = json!({"on": "plate.trim.1", "couple": couple});
    let rim = json!({"displacement": {"z": 0}});
    let [w, force] = deflection(1.2, 6, THICKNESS, &rim, load, [1.0, 1e-5]);
    let exact = couple / (2.0 * stiffness() * (1.0 + NU));
    println!("{} {force}", -w / exact);
    assert!(
        off(-w, exact) < 1e-4 && force.abs() < 1e-4 * couple,
        "{w} {exact}"
    );
}

/// A very thin disc that is stretched by its own deflection: the clamp at the trim holds it against the slope of the sheet, and two
/// fineness agree.
#[test]
fn a_thin_disc_stretches_within_its_clamp() {
    let load = json!({"on": "plate.top", "traction": [0, 0, "-40*t"]});
    let rim = json!({"clamped": true});
    let [coarse, fine] =
        [8, 12].map(|n| deflection(1.2, n, 0.002, &rim, load.clone(), [0.1, 1e-6])[0]);
    println!("{coarse} {fine}");
    assert!(
        fine.abs() > 0.1 && off(coarse, fine) < 1e-2,
        "{coarse} {fine}"
    );
}

/// A strip of length 4 and width 1 along x, cut off at x = `length` between elements.
fn strip(length: f64) -> Value {
    let u = length / 4.0;
    let points = [[0.0, 0.0], [4.0, 0.0], [0.0, 1.0], [4.0, 1.0]];
    let corners = [[0.0, 0.0], [u, 0.0], [u, 1.0], [0.0, 1.0]];
    let trim = Value::from_iter((0..4).map(|k| line(corners[k], corners[(k + 1) % 4])));
    let points = points.map(|[x, y]| [x, y, 0.0, 1.0]);
    file(vec![face(1, [1, 1], &points, json!([trim]))])
}

fn on_strip(length: f64, supports: Value, loads: Value) -> Outcome {
    let scene = json!({
        "covact": 1,
        "materials": {"m": {"st_venant_kirchhoff": {"E": 1000, "nu": 0}}},
        "bodies": {"strip": {"nurbs": {"file": "face.json", "thickness": 0.1, "elements": [7, 2]}, "material": "m"}},
        "supports": supports,
        "loads": loads,
                "solution": {"step": {"initial": 1.0, "max": 1.0}, "newton": {"tolerance": 1e-6}},
        "output": {"every": 0}
    });
    solve_sheet_file(&strip(length), &scene)
}

/// A cantilever under a force at its cut end, in closed form, by the work of the load; the same force by a prescribed displacement; half
/// of a beam between hinges with a plane of symmetry at the cut; and uniform tension.
#[test]
fn a_strip_is_loaded_moved_and_mirrored_at_its_cut() {
    let length = 2.9f64;
    let (stretch, bending) = (100.0, 1000.0 * 0.001 / 12.0);
    let root = json!({"on": "strip.edge.1", "clamped": true});
    let force = 1e-5;
    let loads = json!({"f": {"on": "strip.trim.1", "force": [0, 0, force]}});
    let outcome = on_strip(length, json!({"root": root}), loads);
    let w = 2.0 * outcome.at("energy.internal", 1.0) / force;
    let exact = force * length.powi(3) / (3.0 * bending);
    println!("force: {}", w / exact);
    assert!(off(w, exact) < 1e-5, "{w} {exact}");
    assert!(off(outcome.at("force.root.z", 1.0), -force) < 1e-6);

    let end = json!({"on": "strip.trim.1", "displacement": {"z": exact}});
    let outcome = on_strip(length, json!({"root": root, "end": end}), json!({}));
    let found = outcome.at("force.end.z", 1.0);
    println!("moved: {}", found / force);
    // By the compliance of the springs, 1e-4 of that of an element.
    assert!(off(found, force) < 1e-5, "{found} {force}");

    let q = 1e-6;
    let supports = json!({
        "hinge": {"on": "strip.edge.1", "displacement": {"y": 0, "z": 0}},
        "middle": {"on": "strip.trim.1", "symmetry": "x"}
    });
    let loads = json!({"q": {"on": "strip.top", "traction": [0, 0, q]}});
    let outcome = on_strip(length, supports, loads);
    // The work of the load along half of the beam: q^2 l^5 / 240 B with l of the whole.
    let whole = 2.0 * length;
    let exact = 0.5 * q * q * whole.powi(5) / (240.0 * bending);
    let found = outcome.at("energy.internal", 1.0);
    println!("mirrored: {}", found / exact);
    assert!(off(found, exact) < 1e-4, "{found} {exact}");

    let supports = json!({
        "flat": {"on": "strip.top", "displacement": {"z": 0}},
        "root": {"on": "strip.edge.1", "displacement": {"x": 0, "y": 0}},
        "end": {"on": "strip.trim.1", "displacement": {"x": 1e-6 * length}}
    });
    let outcome = on_strip(length, supports, json!({}));
    let found = outcome.at("force.end.x", 1.0);
    println!("stretched: {}", found / (1e-6 * stretch));
    assert!(off(found, 1e-6 * stretch) < 1e-4, "{found}");
}

/// A clamp at the cut that moves without turning, and the same at an edge: a beam clamped at both ends, one of which is displaced, in
/// closed form `12 E I w / l^3`.
#[test]
fn a_clamp_that_moves_bends_a_beam_to_an_s() {
    let (moved, bending) = (1e-3, 1000.0 * 0.001 / 12.0);
    let length = 2.9f64;
    for (still, moves) in [
        ("strip.edge.1", "strip.trim.1"),
        ("strip.trim.1", "strip.edge.1"),
    ] {
        let supports = json!({
            "still": {"on": still, "clamped": true},
            "moves": {"on": moves, "clamped": true, "displacement": {"z": moved}}
        });
        let outcome = on_strip(length, supports, json!({}));
        let [found, other] =
            ["moves", "still"].map(|name| outcome.at(&format!("force.{name}.z"), 1.0));
        let exact = 12.0 * bending * moved / length.powi(3);
        println!("{moves}: {} {}", found / exact, other / exact);
        assert!(
            off(found, exact) < 1e-3 && off(other, -exact) < 1e-3,
            "{found} {exact}"
        );
    }
}
