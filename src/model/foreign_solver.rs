//! Solvers of other libraries, which a scene may ask for.
use super::Model;
use super::error::{ModelError, text};
use crate::scene::{LinearSolver, Scene};

/// Refuses a library that the program was built without, and tells what is not known of one that it has.
pub(super) fn check(scene: &Scene, model: &mut Model) -> Result<(), ModelError> {
    let (name, built) = match scene.solution.linear_solver {
        LinearSolver::Cudss => ("cudss", cfg!(feature = "cudss")),
        LinearSolver::Mumps(_) => ("mumps", cfg!(feature = "mumps")),
        _ => return Ok(()),
    };
    if !built {
        let message = format!("this program was built without `{name}`");
        let help =
            format!("build it with `cargo install covact --features {name}`, or take `auto`");
        return Err(text("/solution/linear_solver", message).help(help));
    }
    model.notes.push(format!(
        "`{name}` solves the systems: what it takes of memory is not known before, estimates are those of `auto`"
    ));
    Ok(())
}
