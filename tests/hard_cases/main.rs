//! What must not change a result, and what an effect must not cost: invariances on a small plate under a ball.
mod assembly;
mod built;
mod common;
mod convergence;
mod cost;
mod defaults;
mod far;
mod first_iterates;
mod first_touch;
mod folds;
mod friction;
mod friction_driven;
mod friction_energy;
mod friction_history;
mod friction_output;
mod gauntlet;
mod held_by_tools;
mod histories;
mod lost;
mod parametrisation;
mod resume;
mod rollback;
mod seen;
mod simulation;
mod soak;
mod stabilization;
mod substitutes;
#[path = "../verification/support.rs"]
#[allow(dead_code)]
mod support;
mod tangents;
mod threads;
mod trimmed;
mod two_surfaces;
mod units;
mod watchdog_energy;
mod watchdogs;
