//! Rows and tangent of surfaces driven by force, in the assembled system.
//!
//! The terms of a single point are proved with dual numbers beside them (`contact::carried`); here the whole system with
//! the border of a driven surface is held against central differences of its residual.
use covact::assembly::Assembler;
use covact::model::state::State;
use covact::model::{Model, build::build};
use covact::scene;
use serde_json::{Value, json};

fn model(scene: &Value) -> Model {
    let text = serde_json::to_string_pretty(scene).unwrap();
    let mut loaded = scene::parse(&text, "scene.json").unwrap();
    loaded.dir = concat!(env!("CARGO_MANIFEST_DIR"), "/examples/scenes").into();
    build(&loaded).unwrap_or_else(|e| panic!("{e} at {}", e.pointer))
}

/// A CAD punch with fillets and doubly curved corners, which resists all six motions.
fn punch(force: Value, moment: Value) -> Value {
    let text = include_str!("../../examples/scenes/punch_sheet.json");
    let mut scene: Value = serde_json::from_str(text).unwrap();
    scene["bodies"]["sheet"]["mesh"]["plate"]["elements"] = json!([8, 6]);
    let surface = scene["surfaces"].as_object_mut().unwrap();
    let tool = surface.values_mut().next().unwrap();
    tool["motion"] = json!({ "free": {
        "center": [3, -2, 10],
        "force": force,
        "moment": moment,
    } });
    scene
}

/// A number in (-1, 1) that looks random.
fn noise(i: usize) -> f64 {
    let x = (i as f64 * 12.9898 + 4.1414).sin() * 43758.5453;
    2.0 * (x - x.floor()) - 1.0
}

/// Largest difference between matrix and central differences over the columns of the driven surface and some of the
/// slave's, relative to the largest entry of the surface's rows; the smallest norm of the surface's columns by the same.
/// `None` where the contact leaves a motion loose, for which the matrix has a stand-in.
fn compare(model: &Model, state: &State) -> Option<(f64, f64)> {
    let mut assembler = Assembler::new(model, &model.dofs).unwrap();
    let n = state.u.len();
    let (mut residual, mut rhs) = (vec![0.0; n], vec![0.0; n]);
    let mut at = state.clone();
    let totals = (assembler.linearize(&mut at, 1.0, None, &mut residual, &mut rhs)).unwrap();
    if totals.active < 4 || !totals.loose.is_empty() {
        return None;
    }
    let matrix = assembler.matrix().clone();
    let (_, _, driven) = model.driven().next().unwrap();
    let own = driven.dof(0)..driven.dof(6);
    let free = |d: usize| !model.dofs.removed().any(|r| r as usize == d);
    let columns: Vec<usize> = own
        .clone()
        .chain((0..own.start).step_by(7))
        .filter(|&d| free(d))
        .collect();
    let rows: Vec<usize> = (0..n).filter(|&d| free(d)).collect();
    let h = 1e-6;
    let (mut worst, mut scale, mut smallest) = (0.0f64, 0.0f64, f64::INFINITY);
    for &c in &columns {
        let mut side = |sign: f64| {
            let mut moved = state.clone();
            moved.u[c] += sign * h;
            let mut r = vec![0.0; n];
            // The whole evaluation: the residual alone would lack the condensed parameters.
            let mut rhs = vec![0.0; n];
            (assembler.linearize(&mut moved, 1.0, None, &mut r, &mut rhs)).unwrap();
            r
        };
        let (plus, minus) = (side(1.0), side(-1.0));
        let mut norm = 0.0;
        for &r in &rows {
            // Elements condense parameters that are not in balance at a made-up state: their own block is not compared.
            if !own.contains(&r) && !own.contains(&c) {
                continue;
            }
            let slope = (plus[r] - minus[r]) / (2.0 * h);
            worst = worst.max((slope - matrix.get(r, c)).abs());
            scale = scale.max(slope.abs());
            norm += slope * slope;
        }
        if own.contains(&c) {
            smallest = smallest.min(norm.sqrt());
        }
    }
    Some((worst / scale, smallest / scale))
}

/// The border with friction, of gaps of points or of nodes.
fn rubs(averaged: bool) {
    let all = json!({ "x": 0.4, "y": -0.3, "z": -50 });
    for (name, force, moment, turned, mu) in [
        ("one axis", &all, json!({ "y": 3 }), [0.0, 0.007, 0.0], 0.3),
        (
            "two axes",
            &json!({ "z": -50 }),
            json!({ "x": 0.5, "y": 0 }),
            [0.02, -0.03, 0.0],
            0.3,
        ),
        (
            "all that sticks",
            &all,
            json!({ "x": 0, "y": 0, "z": 1 }),
            [0.02, 0.01, 0.3],
            1e3,
        ),
    ] {
        let mut scene = punch(force.clone(), moment);
        for contact in scene["contacts"].as_object_mut().unwrap().values_mut() {
            contact["friction"] = json!({ "coulomb": { "mu": mu } });
            if averaged {
                contact["gap"] = json!("averaged");
                contact["points"] = json!({ "gauss": 2 });
            }
        }
        let model = model(&scene);
        let mut state = State::new(&model);
        let (_, surface, driven) = model.driven().next().unwrap();
        let at = driven.dof(0);
        for (i, u) in state.u[..at].iter_mut().enumerate() {
            *u += 0.05 * noise(i);
        }
        let removed: Vec<u32> = model.dofs.removed().collect();
        removed.iter().for_each(|d| state.u[*d as usize] = 0.0);
        for (c, turned) in turned.into_iter().enumerate() {
            state.u[at + 3 + c] = turned * driven.lever;
        }
        state.u[at + 2] -= 1.4;
        // Attraction points beside the points, so that some stick and some slide.
        let pose = surface.pose(1.0, &state.u).unwrap();
        for (index, pair) in model.pairs.iter().enumerate() {
            let range = state.history(&model, index).unwrap();
            for (i, (p, h)) in (pair.points.iter().zip(&mut state.histories[range])).enumerate() {
                let x = model.point_position(p, &state.u);
                let beside = covact_geometry::Vec3::from_fn(|c, _| 0.3 * noise(7 * i + c));
                h.base = pose.inverse_transform_point(&(x + beside).into()).coords;
                h.lambda = covact_geometry::Vec3::from_fn(|c, _| 0.1 * noise(5 * i + c + 3));
            }
        }
        let (error, smallest) = compare(&model, &state).expect("nothing is loose");
        println!("{name}, averaged {averaged}: {error:.1e}, smallest column {smallest:.1e}");
        assert!(error < 1e-6, "{name}: {error:e}");
        assert!(smallest > 1e-6, "{name}: a column is as good as zero");
    }
}

#[test]
fn border_with_friction_is_the_derivative_of_the_residual() {
    rubs(false);
}

/// The traction of every node moves the surface by friction as well.
#[test]
fn border_with_averaged_gaps_that_rub_is_the_derivative_of_the_residual() {
    rubs(true);
}

#[test]
fn border_of_a_driven_surface_is_the_derivative_of_the_residual() {
    let (all, down) = (
        json!({ "x": 0.4, "y": -0.3, "z": -50 }),
        json!({ "z": -50 }),
    );
    let mut averaged = 0;
    for (name, force, moment, turned) in [
        ("held against turning", &all, json!({}), [0.0, 0.0, 0.0]),
        ("one axis", &all, json!({ "y": 3 }), [0.0, 0.007, 0.0]),
        (
            "two axes",
            &down,
            json!({ "x": 0, "y": 0 }),
            [0.02, -0.03, 0.0],
        ),
        (
            "another two",
            &down,
            json!({ "x": 0, "z": 0 }),
            [0.02, 0.0, 0.3],
        ),
    ] {
        for gap in ["pointwise", "averaged"] {
            let mut scene = punch(force.clone(), moment.clone());
            for contact in scene["contacts"].as_object_mut().unwrap().values_mut() {
                contact["gap"] = json!(gap);
                if gap == "averaged" {
                    contact["points"] = json!({"gauss": 3});
                }
            }
            let name = format!("{name}, {gap}");
            let model = model(&scene);
            let mut state = State::new(&model);
            let (_, _, driven) = model.driven().next().unwrap();
            let at = driven.dof(0);
            for (i, u) in state.u[..at].iter_mut().enumerate() {
                *u += 0.05 * noise(i);
            }
            let removed: Vec<u32> = model.dofs.removed().collect();
            removed.iter().for_each(|d| state.u[*d as usize] = 0.0);
            for (c, turned) in turned.into_iter().enumerate() {
                state.u[at + 3 + c] = turned * driven.lever;
            }
            // As deep as it takes for the fillets to hold the punch sideways.
            let held = [0.2, 0.4, 0.6, 0.8, 1.0, 1.2, 1.4, 1.8, 2.2, 2.6, 3.0]
                .into_iter()
                .find_map(|depth| {
                    let mut deeper = state.clone();
                    deeper.u[at + 2] -= depth;
                    compare(&model, &deeper).map(|compared| (depth, compared))
                });
            // In the mean the fillets of the coarse sheet hold the punch in some of the cases only.
            let Some((depth, (error, smallest))) = held else {
                assert!(
                    gap == "averaged",
                    "{name}: no depth at which nothing is loose"
                );
                continue;
            };
            averaged += usize::from(gap == "averaged");
            println!("{name}, {depth} deep: {error:.1e}, smallest column {smallest:.1e}");
            assert!(error < 1e-7, "{name}: {error:e}");
            assert!(smallest > 1e-6, "{name}: a column is as good as zero");
        }
    }
    assert!(averaged >= 3, "{averaged} cases with averaged gaps");
}
