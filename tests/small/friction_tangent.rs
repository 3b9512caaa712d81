//! The tangent of friction at small displacements against differences of the residual.
use crate::scene;
use covact::assembly::{Assembler, Linearization};
use covact::contact::friction::law::Slide;
use covact::model::Model;
use covact::model::build::build;
use covact::model::state::State;
use covact::scene::parse;
use covact_geometry::Vec3;
use serde_json::{Value, json};

const EPS_N: f64 = 60.0;
const EPS_T: f64 = 25.0;

fn model(on_body: bool, friction: &Value) -> Model {
    let mut parts = json!({
        "bodies": {"upper": {
            "mesh": {"block": {"min": [0.3, 0.2, 0.1], "max": [2.5, 1.7, 1], "elements": [5, 4, 1]}}, "material": "m"
        }},
        "surfaces": {"tool": {
            "plane": {"center": [1.4, 1, 0], "normal": [0, 0, 1], "size": [20, 20]}, "depth": 1,
            "motion": {"translation": ["0.0004*t", 0, 0]}
        }},
        "contacts": {"c": {
            "slave": "upper.bottom", "master": "tool", "points": {"gauss": 2}, "offset": 0.1, "friction": friction,
            "penalty": {"value": EPS_N}, "tangential_penalty": {"value": EPS_T}
        }},
        "supports": {"hold": {"on": "upper.top", "fixed": true}}
    });
    if on_body {
        parts["bodies"]["lower"] = json!({
            "mesh": {"block": {"min": [0, 0, -1], "max": [3, 2, 0], "elements": [3, 2, 1]}}, "material": "m"
        });
        parts["contacts"]["c"]["master"] = json!("lower.top");
        parts["supports"]["ground"] = json!({"on": "lower.bottom", "fixed": true});
        parts.as_object_mut().unwrap().remove("surfaces");
    }
    let text = scene(0.3, parts, 1).to_string();
    let loaded = parse(&text, "scene.json").unwrap_or_else(|e| panic!("{e}"));
    build(&loaded).unwrap_or_else(|e| panic!("{e}"))
}

/// Numbers in (-1, 1) that look like no pattern.
fn noise(k: usize) -> f64 {
    2.0 * (12.9898 * (k as f64 + 1.0))
        .sin()
        .mul_add(43758.547, 0.0)
        .rem_euclid(1.0)
        - 1.0
}

/// A state with open points, points that stick, and points that slide, some of which have a history or were open before; and the
/// number of each kind.
fn state(model: &Model, mu: f64) -> (State, [usize; 3]) {
    let mut state = State::new(model);
    for (k, u) in state.u.iter_mut().enumerate() {
        *u = 1e-3 * noise(k);
    }
    let small = model.small.as_ref().unwrap();
    let (pair, own) = (&model.pairs[0], &small.pairs[0]);
    let motion = model.small_motion(pair, 1.0).unwrap();
    let mut kinds = [0; 3];
    for (i, (p, history)) in pair.points.iter().zip(&mut state.histories).enumerate() {
        let at = own.points[i].expect("a foot");
        let w = own.slip(i, &at, p, motion.as_ref(), &state.u);
        history.base = w + Vec3::new(noise(3 * i), noise(3 * i + 1), noise(3 * i + 2)) * 4e-4;
        history.lambda = Vec3::new(noise(5 * i), noise(5 * i + 1), noise(5 * i + 2)) * 2e-3;
        history.approach = if i % 5 == 0 { 2e-4 } else { 0.0 };
        let gap = at.gap - 0.1 + w.dot(&at.normal);
        let phi = if history.approach > 0.0 {
            gap / (gap - history.approach)
        } else {
            1.0
        };
        let v = history.lambda + (w - history.base) * (EPS_T * phi);
        let trial = v - at.normal * v.dot(&at.normal);
        state.points[i].closed = gap < 0.0;
        kinds[match (gap < 0.0, trial.norm() < -mu * EPS_N * gap) {
            (false, _) => 0,
            (true, true) => 1,
            (true, false) => 2,
        }] += 1;
    }
    (state, kinds)
}

/// Differences of the residual along directions, of `h`; and the products of the tangent with them. Nothing of prescribed ones.
fn compare(model: &Model, slide: Slide, state: &State) -> (f64, f64, f64) {
    let mut assembler = Assembler::new(model, &model.dofs).expect("a pattern");
    assembler.linearization = Linearization {
        slide,
        ..Linearization::default()
    };
    let n = state.u.len();
    let residual = |state: &State, assembler: &mut Assembler| {
        let mut out = vec![0.0; n];
        (assembler.small_residual(state, 1.0, &mut out)).unwrap_or_else(|e| panic!("{e}"));
        model.dofs.fold(&mut out);
        out
    };
    residual(state, &mut assembler);
    (assembler.small_matrix(state)).unwrap_or_else(|e| panic!("{e}"));
    let product = |v: &[f64]| {
        let mut out = vec![0.0; n];
        assembler.matrix().multiply(v, &mut out);
        out
    };
    let directions: Vec<Vec<f64>> = (0..12)
        .map(|d| {
            let mut v: Vec<f64> = (0..n).map(|k| noise(n * (d + 1) + k)).collect();
            model.dofs.fold(&mut v);
            v
        })
        .collect();
    let products: Vec<Vec<f64>> = directions.iter().map(|v| product(v)).collect();
    let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    let (mut largest, mut worst, mut skew) = (0.0f64, 0.0f64, 0.0f64);
    let h = 1e-8;
    for (v, kv) in directions.iter().zip(&products) {
        let at = |s: f64, assembler: &mut Assembler| {
            let mut other = state.clone();
            for (u, v) in other.u.iter_mut().zip(v) {
                *u += s * h * v;
            }
            residual(&other, assembler)
        };
        let mut assembler = Assembler::new(model, &model.dofs).expect("a pattern");
        let (plus, minus) = (at(1.0, &mut assembler), at(-1.0, &mut assembler));
        for (k, (p, m)) in plus.iter().zip(&minus).enumerate() {
            largest = largest.max(kv[k].abs());
            worst = worst.max(((p - m) / (2.0 * h) - kv[k]).abs());
        }
    }
    for (a, ka) in directions.iter().zip(&products) {
        for (b, kb) in directions.iter().zip(&products) {
            skew = skew.max((dot(a, kb) - dot(b, ka)).abs());
        }
    }
    (largest, worst, skew)
}

#[test]
fn points_that_stick_slide_and_are_open() {
    for on_body in [false, true] {
        for (friction, mu) in [
            (json!({"coulomb": {"mu": 0.4}}), 0.4),
            (json!({"shear_limited": {"mu": 0.4, "limit": 0.01}}), 0.4),
            (
                json!({"orthotropic": {"mu": [0.3, 0.5], "direction": [1, 2, 0]}}),
                0.4,
            ),
        ] {
            let model = model(on_body, &friction);
            assert!(!model.symmetric);
            let (state, kinds) = state(&model, mu);
            let (largest, worst, skew) = compare(&model, Slide::Tangent, &state);
            println!(
                "{on_body} {friction}: {kinds:?}, {largest:e}, off by {worst:e}, skew {skew:e}"
            );
            assert!(kinds.iter().all(|n| *n >= 4), "{kinds:?}");
            assert!(largest > 1.0 && skew > 0.1);
            assert!(worst < 1e-6 * largest, "{worst:e} of {largest:e}");
            // The comparison sees what a secant leaves out of a tangent.
            let (_, worst, _) = compare(&model, Slide::Secant, &state);
            assert!(worst > 1e-3 * largest, "{worst:e} of {largest:e}");
        }
    }
}
