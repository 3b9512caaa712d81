//! Why a run cannot be continued.
use std::path::{Path, PathBuf};

/// Why a run cannot be continued; nothing in its folder has been changed.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum CheckpointError {
    /// The folder holds no checkpoint.
    #[error(
        "nothing to continue: `{}` is missing; run without `--resume` to start",
        path.display()
    )]
    Missing {
        /// The file.
        path: PathBuf,
    },
    /// The file is something else.
    #[error(
        "`{}` is no checkpoint of covact: move it, or choose another folder",
        path.display()
    )]
    Foreign {
        /// The file.
        path: PathBuf,
    },
    /// The file was cut off or changed.
    #[error(
        "`{}` is damaged: {reason}; run with `--force` in place of `--resume` to start anew",
        path.display()
    )]
    Damaged {
        /// The file.
        path: PathBuf,
        /// What is wrong with it.
        reason: String,
    },
    /// Another version of the program wrote it.
    #[error(
        "`{}` is of covact {found}, this is covact {}: continue it with that version, or run with `--force` in place of `--resume` to start anew",
        path.display(),
        env!("CARGO_PKG_VERSION")
    )]
    Version {
        /// The file.
        path: PathBuf,
        /// The other version.
        found: String,
    },
    /// The scene, or a file that it names, has changed.
    #[error(
        "the run in `{}` is of another scene: {difference}; take the scene as it was, or run with `--force` in place of `--resume` to start anew",
        folder.display()
    )]
    Scene {
        /// The folder of the run.
        folder: PathBuf,
        /// What is not as it was, in words.
        difference: String,
    },
    /// A file of the results is not as the checkpoint knows it.
    #[error(
        "`{}` is not as the run left it: put it back, or run with `--force` in place of `--resume` to start anew",
        path.display()
    )]
    History {
        /// The file.
        path: PathBuf,
    },
}

impl CheckpointError {
    /// A checkpoint in `folder` that does not fit the model of its scene.
    pub(crate) fn misfit(folder: &Path, reason: &str) -> Self {
        CheckpointError::Damaged {
            path: super::slots::current(folder),
            reason: reason.to_owned(),
        }
    }

    /// Whether the scene, or a file it names, is what is at fault.
    pub fn is_scene(&self) -> bool {
        matches!(self, CheckpointError::Scene { .. })
    }
}
