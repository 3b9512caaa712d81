//! What is refused before a run for want of memory, and what a run is expected to take.
use super::RunError;
use super::estimate::{Estimate, tessellation};
use crate::assembly::Assembler;
use crate::machine::{self, memory};
use crate::model::Model;
use crate::model::build::{FEWER, elements_key};
use crate::scene::{self, LoadedScene};
use crate::system::PatternError;
use crate::system::linear::{DirectSolver, LinearError, LuSolver, SolverOptions};

/// Bytes that a run takes beside what has been asked for when factorizations begin: rows, fields and files.
const WORK: u64 = 16 << 20;

/// The flat copies of surfaces for the output fit in memory.
///
/// # Errors
/// [`RunError::Scene`] at the tessellation.
pub(super) fn flat_copies(loaded: &LoadedScene, model: &Model) -> Result<(), RunError> {
    let n = loaded.scene.output.tessellation;
    if loaded.scene.output.every == 0 {
        return Ok(());
    }
    let Err(shortage) = memory::ask(tessellation(model, n)) else {
        return Ok(());
    };
    let pieces: usize = model.surfaces.iter().map(|s| s.pieces()).sum();
    let message =
        format!("{n} x {n} quadrilaterals for each of {pieces} pieces of surfaces: {shortage}");
    Err(at(
        loaded,
        "/output/tessellation",
        message,
        "take a smaller number",
    ))
}

/// An error of the pattern as that of the scene, where memory is short.
pub(super) fn pattern(loaded: &LoadedScene, error: &PatternError) -> RunError {
    match error {
        PatternError::Memory { .. } | PatternError::TooLarge { .. } => {
            at(loaded, &largest(loaded), error.to_string(), FEWER)
        }
        other => RunError::internal(other),
    }
}

/// An error of the symbolic analysis as that of the scene, where memory is short.
pub(super) fn analysis(loaded: &LoadedScene, error: &LinearError) -> RunError {
    match error {
        LinearError::Memory(_) | LinearError::OutOfMemory { .. } | LinearError::TooLarge => {
            at(loaded, &largest(loaded), error.to_string(), FEWER)
        }
        LinearError::Device(_) | LinearError::Mumps(_) => {
            let help = "take `auto`, which needs no other library";
            at(loaded, "/solution/linear_solver", error.to_string(), help)
        }
        other => RunError::internal(other),
    }
}

/// The dense kernels of factorizations on so many threads have room for their buffers, for want of which they would end the
/// process.
///
/// # Errors
/// [`RunError::Scene`] with what is needed.
pub(super) fn packing(loaded: &LoadedScene, threads: usize) -> Result<(), RunError> {
    let needed = machine::packing(threads).saturating_add(WORK);
    let Err(shortage) = memory::ask_address_space(needed) else {
        return Ok(());
    };
    let threads_ = match threads {
        1 => "a thread".to_owned(),
        n => format!("{n} threads"),
    };
    let message = format!("factorizations on {threads_}: {shortage}");
    let help = match threads {
        1 => "raise the limit on the address space (`ulimit -v`)",
        _ => "raise the limit on the address space (`ulimit -v`), or take fewer threads",
    };
    Err(at(loaded, "/solution", message, help))
}

/// What a run of this model takes, from its pattern and the symbolic analysis of its system.
///
/// # Errors
/// [`RunError::Scene`] where it does not fit.
pub(super) fn estimate(loaded: &LoadedScene, model: &Model) -> Result<Estimate, RunError> {
    flat_copies(loaded, model)?;
    let pattern_ = Assembler::pattern_of(model, &model.dofs).map_err(|e| pattern(loaded, &e))?;
    let options = SolverOptions::default();
    let lu = !model.symmetric || loaded.scene.solution.linear_solver == scene::LinearSolver::Lu;
    let found = match lu {
        true => LuSolver::plan(&pattern_, &options),
        false => DirectSolver::plan(&pattern_, &options),
    };
    let found = found.map_err(|e| analysis(loaded, &e))?;
    let elements: Vec<_> = (model.bodies.iter())
        .filter_map(|b| Some(loaded.scene.bodies.get(&b.name)?.element))
        .collect();
    let output = &loaded.scene.output;
    let divisions = if output.every == 0 {
        0
    } else {
        output.tessellation
    };
    let estimate = Estimate::new(model, &elements, &pattern_, &found, divisions);
    // Factors that another library keeps, on a device or on the disk, are not known.
    use scene::LinearSolver::{Cudss, Mumps};
    let rest = match loaded.scene.solution.linear_solver {
        Cudss | Mumps(_) => estimate.matrix,
        _ => estimate.matrix.saturating_add(estimate.factor),
    };
    match memory::ask(rest) {
        Ok(()) => Ok(estimate),
        Err(shortage) => analysis_short(loaded, shortage),
    }
}

fn analysis_short(loaded: &LoadedScene, shortage: memory::Shortage) -> Result<Estimate, RunError> {
    Err(analysis(loaded, &LinearError::Memory(shortage)))
}

/// The field of the body with most elements that says how many they are; of a file where there is one.
fn largest(loaded: &LoadedScene) -> String {
    use scene::MeshSource::{Arrays, Block, Cells, CylinderPanel, File, Nurbs, Plate, SpherePanel};
    let count = |body: &scene::Body| match &body.mesh {
        Plate(p) => p.elements.iter().map(|n| f64::from(*n)).product::<f64>() * f64::from(p.layers),
        CylinderPanel(p) => p.elements.iter().map(|n| f64::from(*n)).product(),
        SpherePanel(p) => p.elements.iter().map(|n| f64::from(*n)).product(),
        Block(b) => b.elements.iter().map(|n| f64::from(*n)).product(),
        File(_) | Arrays(_) | Cells(_) | Nurbs(_) => f64::INFINITY,
    };
    (loaded.scene.bodies.iter())
        .max_by(|a, b| count(a.1).total_cmp(&count(b.1)))
        .map_or_else(
            || "/bodies".to_owned(),
            |(name, body)| elements_key(name, &body.mesh),
        )
}

fn at(loaded: &LoadedScene, pointer: &str, message: String, help: &str) -> RunError {
    RunError::Scene {
        others: Vec::new(),
        message,
        place: Some(loaded.place_of(pointer)),
        pointer: pointer.to_owned(),
        help: Some(help.to_owned()),
    }
}
