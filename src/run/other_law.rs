//! Contact under a second law of normal contact, `p = c g^2`: whatever is told of pressures and energies, and whatever acts,
//! follows the law and not the linear penalty.
use super::commit;
use super::fields::Fields;
use super::watch::{Span, Watch};
use crate::assembly::{Assembler, Totals};
use crate::contact::kernel::Normal;
use crate::contact::law::{NormalLaw, PairLaw};
use crate::model::driven::press::Presser;
use crate::model::state::State;
use crate::model::{Model, build::build};
use crate::scene;
use serde_json::{Value, json};

/// The coefficient `c` of the scenes.
const C: f64 = 7e3;
/// Penetration at time 1.
const DEPTH: f64 = 0.02;

/// `N = c g |g|`.
#[derive(Debug, Clone, Copy)]
struct Quadratic {
    c: f64,
}

impl NormalLaw for Quadratic {
    fn response(&self, xi3: f64) -> Normal {
        Normal {
            n: self.c * xi3 * xi3.abs(),
            dn: 2.0 * self.c * xi3.abs(),
        }
    }
    fn energy(&self, xi3: f64) -> f64 {
        self.c * xi3.abs().powi(3) / 3.0
    }
}

impl PairLaw for Quadratic {
    fn of(penalty: f64) -> Self {
        Quadratic { c: penalty }
    }
    fn gap_under(&self, n: f64) -> f64 {
        n.signum() * (n.abs() / self.c).sqrt()
    }
}

fn block(min: f64, max: f64) -> Value {
    json!({"mesh": {"block": {"min": [0, 0, min], "max": [1, 1, max], "elements": [2, 1, 1]}}, "material": "m"})
}

/// A block of unit area, its top held, that a rigid plane enters from below by `DEPTH t`.
fn on_plane(contact: Value) -> Value {
    let mut scene = json!({
        "covact": 1,
        "materials": {"m": {"st_venant_kirchhoff": {"E": 1e4, "nu": 0.3}}},
        "bodies": {"block": block(0.0, 1.0)},
        "surfaces": {"plane": {
            "plane": {"center": [0.5, 0.5, 0], "size": [4, 4]},
            "motion": {"translation": [0, 0, format!("{DEPTH}*t")]}
        }},
        "contacts": {"press": {
            "slave": "block.bottom", "master": "plane", "penalty": {"value": C}
        }},
        "supports": {"held": {"on": "block.top", "fixed": true}}
    });
    add(&mut scene["contacts"]["press"], contact);
    scene
}

/// Two blocks one on the other, the upper of which is to be moved down.
fn on_block(contact: Value) -> Value {
    let mut scene = on_plane(contact);
    scene["bodies"]["ground"] = block(-1.0, 0.0);
    scene["contacts"]["press"]["master"] = json!("ground.top");
    scene["supports"]["ground"] = json!({"on": "ground.bottom", "fixed": true});
    scene.as_object_mut().expect("a scene").remove("surfaces");
    scene
}

fn add(to: &mut Value, more: Value) {
    for (key, value) in more.as_object().expect("an object") {
        to[key] = value.clone();
    }
}

fn model(scene: &Value) -> Model {
    let loaded = scene::parse(&scene.to_string(), "scene.json").unwrap_or_else(|e| panic!("{e}"));
    build(&loaded).unwrap_or_else(|e| panic!("{e}"))
}

/// What contacts are evaluated by: every loop over slave points that there is.
fn scenes() -> Vec<(&'static str, Value)> {
    let friction = json!({"friction": {"coulomb": {"mu": 0.3}}});
    let averaged = json!({"gap": "averaged", "points": {"gauss": 2}});
    let mut half = json!({"passes": "two_half", "points": {"gauss": 2}});
    let mut sliding_half = half.clone();
    add(&mut sliding_half, friction.clone());
    half["points"] = json!({"gauss": 3});
    let mut rubbing = averaged.clone();
    add(&mut rubbing, friction.clone());
    vec![
        ("rigid", on_plane(json!({}))),
        (
            "rigid, offset",
            on_plane(json!({"offset": 0.001, "points": {"gauss": 2}})),
        ),
        ("rigid, friction", on_plane(friction.clone())),
        ("rigid, averaged", on_plane(averaged.clone())),
        ("rigid, averaged, friction", on_plane(rubbing.clone())),
        ("rigid, multipliers", on_plane(json!({"augmentation": {}}))),
        ("body", on_block(json!({}))),
        ("body, friction", on_block(friction)),
        ("body, averaged", on_block(averaged)),
        ("body, averaged, friction", on_block(rubbing)),
        ("body, half passes", on_block(half)),
        ("body, half passes, friction", on_block(sliding_half)),
    ]
}

/// The state at a time: only the upper of two blocks moves.
fn state_at(model: &Model, committed: &State, time: f64) -> State {
    let mut state = committed.clone();
    if model.surfaces.is_empty() {
        let block = model
            .bodies
            .iter()
            .find(|b| b.name == "block")
            .expect("a block");
        let first = block.first_node as usize;
        for node in first..first + block.mesh.nodes.len() {
            state.u[3 * node + 2] = -DEPTH * time;
        }
    }
    state
}

struct Evaluated {
    totals: Totals,
    forces: Vec<f64>,
}

/// The state of a model before anything has moved, with all contacts begun.
fn started(model: &Model, assembler: &mut Assembler<Quadratic>) -> State {
    let mut state = State::new(model);
    let masters = &mut assembler.masters;
    commit::start(model, masters, &mut state, (0.0, &|_| true)).expect("a start");
    state
}

fn evaluate(assembler: &mut Assembler<Quadratic>, state: &mut State, time: f64) -> Evaluated {
    let mut forces = vec![0.0; state.u.len()];
    let totals = (assembler.contact(state, time, &mut forces)).unwrap_or_else(|e| panic!("{e}"));
    Evaluated { totals, forces }
}

/// Energy, force and pressure of a block that is pressed evenly are those of the law, in every loop over points.
#[test]
fn energy_force_and_pressure_follow_the_law() {
    for (name, scene) in scenes() {
        let model = model(&scene);
        let mut assembler =
            Assembler::<Quadratic>::with_law(&model, &model.dofs).expect("an assembler");
        let committed = started(&model, &mut assembler);
        let mut state = state_at(&model, &committed, 1.0);
        let found = evaluate(&mut assembler, &mut state, 1.0);
        let gap = DEPTH + model.pairs[0].offset;
        let (pressure, energy) = (C * gap * gap, C * gap.powi(3) / 3.0);
        let close = |what: &str, found: f64, right: f64| {
            assert!(
                (found - right).abs() < 1e-10 * right,
                "{name}: {what} {found}, not {right}"
            );
        };
        close("energy", found.totals.contact_energy, energy);
        // The residual on the bottom of the block: it is pushed up by its negative.
        let block = model
            .bodies
            .iter()
            .find(|b| b.name == "block")
            .expect("a block");
        let nodes =
            3 * block.first_node as usize..3 * (block.first_node as usize + block.mesh.nodes.len());
        let force: f64 = found.forces[nodes].iter().skip(2).step_by(3).sum();
        close("force", -force, pressure);
        // What rounding leaves of the forces goes with the slope.
        assert!(found.totals.contact_rounding > 0.0, "{name}");
        commit::commit(&model, &mut assembler, &mut state, (&committed.u, 0.0), 1.0)
            .unwrap_or_else(|e| panic!("{name}: {e}"));
        let mut fields = Fields::new(&model, &scene::Output::default()).expect("fields");
        let penalties = assembler.penalties.clone();
        (fields.gather::<Quadratic>(&model, &penalties, &mut assembler.masters, &state, 1.0))
            .unwrap_or_else(|e| panic!("{name}: {e}"));
        close("pressure", fields.largest_pressure, pressure);
    }
}

/// The tangent is the derivative of the forces, and the forces are that of the energy, where the block is bent and tilted.
#[test]
fn forces_and_tangent_are_derivatives_of_the_energy_of_the_law() {
    for (name, scene) in scenes() {
        let model = model(&scene);
        let mut assembler =
            Assembler::<Quadratic>::with_law(&model, &model.dofs).expect("an assembler");
        let committed = started(&model, &mut assembler);
        let wave = |i: usize, k: f64| 1e-3 * (k * i as f64).sin();
        let at = |s: f64| {
            let mut state = state_at(&model, &committed, 1.0);
            for (i, u) in state.u.iter_mut().enumerate() {
                *u += wave(i, 1.3) + s * wave(i, 2.1);
            }
            state
        };
        let along = |forces: &[f64]| -> f64 {
            forces
                .iter()
                .enumerate()
                .map(|(i, f)| f * wave(i, 2.1))
                .sum()
        };
        let h = 1e-4;
        let [a, b] = [-h, h].map(|s| evaluate(&mut assembler, &mut at(s), 1.0));
        let middle = evaluate(&mut assembler, &mut at(0.0), 1.0);
        // Friction does work, and half passes have no potential.
        if model
            .pairs
            .iter()
            .all(|p| p.friction.is_none() && p.half.is_none())
        {
            let slope = (b.totals.contact_energy - a.totals.contact_energy) / (2.0 * h);
            let work = along(&middle.forces);
            assert!(
                (slope - work).abs() < 1e-6 * work.abs(),
                "{name}: {slope}, not {work}"
            );
        }
        let n = middle.forces.len();
        let (mut forces, mut rhs) = (vec![0.0; n], vec![0.0; n]);
        assembler.clear_matrix();
        let mut state = at(0.0);
        (assembler.linearize_contact(&mut state, 1.0, None, &mut forces, &mut rhs))
            .unwrap_or_else(|e| panic!("{name}: {e}"));
        let direction: Vec<f64> = (0..n)
            .map(|i| match model.dofs.removed().any(|d| d as usize == i) {
                true => 0.0,
                false => wave(i, 2.1),
            })
            .collect();
        let [a, b] = [-h, h].map(|s| {
            let mut state = at(0.0);
            for (u, d) in state.u.iter_mut().zip(&direction) {
                *u += s * d;
            }
            evaluate(&mut assembler, &mut state, 1.0).forces
        });
        let mut product = vec![0.0; n];
        assembler.matrix().multiply(&direction, &mut product);
        let largest = product.iter().fold(0.0f64, |m, x| m.max(x.abs()));
        assert!(largest > 0.0, "{name}");
        for (i, k) in product
            .iter()
            .enumerate()
            .filter(|(i, _)| direction[*i] != 0.0)
        {
            let right = (b[i] - a[i]) / (2.0 * h);
            assert!(
                (k - right).abs() < 1e-5 * largest,
                "{name}, {i}: {k}, not {right}"
            );
        }
    }
}

/// What the energy book leaves out of balance over `steps` even steps to time 1, and the energy at the end. In the middle
/// the penalty is raised by a factor.
fn imbalance(scene: &Value, steps: u32, raise: f64) -> [f64; 2] {
    let model = model(scene);
    let mut assembler =
        Assembler::<Quadratic>::with_law(&model, &model.dofs).expect("an assembler");
    let mut watch = Watch::new(&model);
    let mut from = started(&model, &mut assembler);
    let (mut start, mut energy) = (0.0, 0.0);
    for step in 1..=steps {
        let end = f64::from(step) / f64::from(steps);
        if 2 * step == steps {
            assembler.penalties.iter_mut().for_each(|c| *c *= raise);
        }
        let mut to = state_at(&model, &from, end);
        let found = evaluate(&mut assembler, &mut to, end);
        energy = found.totals.contact_energy;
        // Only what the plane does on the block: its reactions do no work.
        let span = Span {
            from: (&from, start),
            to: (&to, end),
        };
        let reactions = vec![0.0; from.u.len()];
        let work = watch.work(&model, &assembler, &reactions, &found.totals, &span);
        let work = work.unwrap_or_else(|e| panic!("{e}"));
        watch.accept(&assembler, &reactions, &found.totals, &span);
        watch.close(
            &model,
            (step, [start, end]),
            work,
            &[0.0],
            [energy, energy],
            false,
        );
        commit::commit(&model, &mut assembler, &mut to, (&from.u, start), end)
            .unwrap_or_else(|e| panic!("{e}"));
        (from, start) = (to, end);
    }
    [watch.imbalance, energy]
}

/// The energy book closes to the second order of the step, also where a penalty is raised; with multipliers it closes to
/// rounding, because what the penalty does not store is booked.
#[test]
fn the_energy_book_closes() {
    for raise in [1.0, 3.0] {
        let [few, many] = [8, 16].map(|steps| {
            let [left, energy] = imbalance(&on_plane(json!({})), steps, raise);
            left / energy
        });
        assert!(many.abs() < 0.01, "{raise}: {few} {many}");
        assert!((few / many - 4.0).abs() < 0.4, "{raise}: {few} {many}");
    }
    let [left, energy] = imbalance(&on_plane(json!({"augmentation": {}})), 3, 1.0);
    assert!(left.abs() < 1e-12 * energy, "{left} of {energy}");
}

/// A surface that force drives is placed by the energy of the law, whose derivative is the force; with a multiplier too.
#[test]
fn driven_surfaces_are_placed_by_the_energy_of_the_law() {
    const BELOW: f64 = 0.1;
    let mut scene = on_plane(json!({"augmentation": {}}));
    scene["surfaces"]["plane"]["motion"] = json!({
        "translation": [0, 0, -BELOW], "free": {"force": {"z": 1.0}}
    });
    let model = model(&scene);
    let entry = model.driven().next().expect("a driven surface");
    for lambda in [0.0, -1.3] {
        let mut state = State::new(&model);
        state.histories.iter_mut().for_each(|h| h.lambda_n = lambda);
        let mut presser =
            Presser::<Quadratic>::new(&model, entry, &[C], &state.histories, &state.u);
        let mut press = |depth: f64| {
            let q = nalgebra::Vector6::new(0.0, 0.0, BELOW + depth, 0.0, 0.0, 0.0);
            presser.press(0.0, &q).unwrap_or_else(|e| panic!("{e}"))
        };
        let (h, gap) = (1e-5, 0.025);
        let (here, [a, b]) = (press(gap), [press(gap - h), press(gap + h)]);
        let force = C * gap * gap - lambda;
        assert!(
            (here.residual[2] - force).abs() < 1e-9 * force,
            "{} {force}",
            here.residual[2]
        );
        let slope = (b.energy - a.energy) / (2.0 * h);
        assert!((slope - force).abs() < 1e-6 * force, "{slope} {force}");
        // Nothing is stored where nothing acts.
        let free = (-lambda / C).sqrt();
        let none = press(1e-9 - free);
        assert!(none.energy.abs() < 1e-12, "{}", none.energy);
    }
}
