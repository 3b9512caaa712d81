//! Why a run could not be done.
use super::checkpoint::CheckpointError;
use super::claim::{ClaimError, FolderError};
use super::exit::Exit;
use crate::model::ModelError;
use crate::output::OutputError;
use crate::scene::{LoadedScene, Place, Problem, ValueError};

/// An error that has an exit code of the process ([`Exit`]).
#[derive(Debug, thiserror::Error)]
pub enum RunError {
    /// The scene, or a file it names, is wrong.
    #[error("{message}")]
    Scene {
        /// What is wrong.
        message: String,
        /// JSON pointer of the field at fault.
        pointer: String,
        /// Where the field stands in the scene file.
        place: Option<Place>,
        /// What to do about it.
        help: Option<String>,
        /// What else is wrong with it.
        others: Vec<RunError>,
    },
    /// A result cannot be written.
    #[error(transparent)]
    Output(#[from] OutputError),
    /// The folder of the results is in use, or holds what nobody asked to replace.
    #[error(transparent)]
    Folder(#[from] FolderError),
    /// A run cannot be continued.
    #[error(transparent)]
    Checkpoint(#[from] CheckpointError),
    /// A sink of the caller's could not go on.
    #[error("{0}")]
    Sink(Box<dyn std::error::Error + Send + Sync>),
    /// A fault of this program.
    #[error("internal error: {0}")]
    Internal(String),
}

impl RunError {
    pub(super) fn scene(loaded: &LoadedScene, pointer: &str, message: String) -> Self {
        RunError::Scene {
            message,
            pointer: pointer.to_owned(),
            place: Some(loaded.place_of(pointer)),
            help: None,
            others: Vec::new(),
        }
    }

    /// What a check of the scene has found.
    pub(super) fn of(problems: Vec<Problem>) -> Result<(), Self> {
        let error = |problem: Problem, others| RunError::Scene {
            message: problem.message,
            pointer: problem.pointer,
            place: Some(problem.place),
            help: problem.help,
            others,
        };
        let mut problems = problems.into_iter();
        match problems.next() {
            None => Ok(()),
            Some(first) => Err(error(
                first,
                problems.map(|p| error(p, Vec::new())).collect(),
            )),
        }
    }

    pub(super) fn model(loaded: &LoadedScene, error: ModelError) -> Self {
        let others = error.others.into_iter().map(|e| RunError::model(loaded, e));
        RunError::Scene {
            others: others.collect(),
            message: error.cause.to_string(),
            place: Some(loaded.place_of(&error.pointer)),
            pointer: error.pointer,
            help: error.help,
        }
    }

    pub(super) fn internal(error: &dyn std::error::Error) -> Self {
        RunError::Internal(error.to_string())
    }

    /// Exit code of the process.
    pub fn exit_code(&self) -> u8 {
        let exit = match self {
            RunError::Scene { .. } => Exit::Scene,
            RunError::Folder(_) => Exit::Usage,
            RunError::Checkpoint(e) if e.is_scene() => Exit::Scene,
            RunError::Output(_) | RunError::Checkpoint(_) | RunError::Sink(_) => Exit::Io,
            RunError::Internal(_) => Exit::Bug,
        };
        exit.code()
    }

    /// Where in the scene file the fault lies.
    pub fn place(&self) -> Option<Place> {
        match self {
            RunError::Scene { place, .. } => *place,
            _ => None,
        }
    }
}

impl From<ClaimError> for RunError {
    fn from(e: ClaimError) -> Self {
        match e {
            ClaimError::Folder(e) => e.into(),
            ClaimError::Output(e) => e.into(),
        }
    }
}

impl From<ValueError> for RunError {
    /// A value that cannot be evaluated in the course of a run.
    fn from(e: ValueError) -> Self {
        RunError::Scene {
            message: e.to_string(),
            pointer: String::new(),
            place: None,
            help: None,
            others: Vec::new(),
        }
    }
}
