//! What solves the systems.
use super::checker::Checker;
use crate::scene::types::{LinearSolver, OutOfCore};

pub(super) fn check(c: &mut Checker, solver: &LinearSolver) {
    if let LinearSolver::Mumps(mumps) = solver
        && let OutOfCore::Folder(folder) = &mumps.out_of_core
    {
        c.folder("/solution/linear_solver/mumps/out_of_core", folder);
    }
}
