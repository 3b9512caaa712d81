//! Why a study could not be done.
use crate::output::OutputError;
use crate::scene::SceneError;
use std::path::PathBuf;

/// Why a study could not be done. A run that fails is no such reason, but a result.
#[derive(Debug, thiserror::Error)]
pub enum StudyError {
    /// The study or its scene is wrong.
    #[error(transparent)]
    Scene(#[from] SceneError),
    /// A file cannot be written or read.
    #[error(transparent)]
    Output(#[from] OutputError),
    /// The folder for results holds a file that is not this study's own.
    #[error("`{}` {what}: it is left alone, and nothing is written; choose another folder with `-o`", path.display())]
    Occupied {
        /// The file.
        path: PathBuf,
        /// What is wrong with it, in words.
        what: String,
    },
    /// The list of runs in the folder of a study does not do.
    #[error("`{}` {reason}", path.display())]
    Jobs {
        /// The list.
        path: PathBuf,
        /// What is wrong with it, in words.
        reason: String,
    },
    /// The program that does the runs cannot be started.
    #[error("cannot start `{}`: {reason}", program.display())]
    Start {
        /// The program.
        program: PathBuf,
        /// What the operating system says.
        reason: String,
    },
}
