//! Runs scenes in memory.
use covact::output::RunStatus;
use covact::run::{Options, Simulation};
use covact::scene::{self, LoadedScene};
use serde_json::{Value, json};

/// A scene that is valid.
pub fn loaded(scene: &Value) -> LoadedScene {
    let text = serde_json::to_string_pretty(scene).expect("serialisable");
    let loaded = scene::parse(&text, "scene.json").unwrap_or_else(|e| panic!("{e}"));
    let problems: Vec<String> = (scene::check(&loaded).iter())
        .map(|p| p.to_string())
        .collect();
    assert_eq!(problems, Vec::<String>::new());
    loaded
}

/// A run of a scene on one thread, at its start.
pub fn simulation(scene: &Value) -> Simulation<'static> {
    let options = Options {
        threads: 1,
        ..Options::default()
    };
    Simulation::new(loaded(scene), options).unwrap_or_else(|e| panic!("{e}"))
}

/// Runs a scene to its end; calls `step` after every step.
pub fn run(scene: &Value, mut step: impl FnMut(&Simulation)) -> Simulation<'static> {
    let mut simulation = simulation(scene);
    loop {
        match simulation.step() {
            Ok(Some(_)) => step(&simulation),
            Ok(None) => break,
            Err(e) => panic!("{e}"),
        }
    }
    let status = simulation.status();
    assert!(
        matches!(status, Some(RunStatus::Done | RunStatus::NoContact)),
        "{status:?}"
    );
    simulation
}

/// Steps of one size, and small tolerances.
pub fn fixed(dt: f64, end: f64) -> Value {
    json!({
        "dynamics": {},
        "end_time": end,
        "step": { "initial": dt, "max": dt, "min": 1e-3 * dt, "adaptive": false },
        "newton": { "tolerance": 1e-10 }
    })
}

/// A column of the history.
pub fn column(simulation: &Simulation, name: &str) -> Vec<f64> {
    let table = simulation.history();
    table
        .column(name)
        .unwrap_or_else(|| panic!("no column {name} in {:?}", table.columns))
}

/// Kinetic, strain and contact energy of every step, with the energy of the start in front.
pub fn energies(simulation: &Simulation, start: f64) -> Vec<f64> {
    let parts = ["energy.kinetic", "energy.internal", "energy.contact"];
    let [kinetic, internal, contact] = parts.map(|name| column(simulation, name));
    let steps = (0..kinetic.len()).map(|i| kinetic[i] + internal[i] + contact[i]);
    std::iter::once(start).chain(steps).collect()
}

pub fn largest(values: &[f64]) -> f64 {
    values.iter().copied().fold(f64::NEG_INFINITY, f64::max)
}
