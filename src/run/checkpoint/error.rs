//! Why a run cannot be continued.
use std::path::{Path, PathBuf};

/// Why a run cannot be continued; nothing in its folder has been changed.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum CheckpointError {
    #[error(
        "nothing to continue: `{}` is missing; run without `--resume` to start",
        path.display()
    )]
    Missing { path: PathBuf },
    #[error(
        "`{}` is no checkpoint of covact: move it, or choose another folder",
        path.display()
    )]
    Foreign { path: PathBuf },
    #[error(
        "`{}` is damaged: {reason}; run with `--force` in place of `--resume` to start anew",
        path.display()
    )]
    Damaged { path: PathBuf, reason: String },
    #[error(
        "`{}` is of covact {found}, this is covact {}: continue it with that version, or run with `--force` in place of `--resume` to start anew",
        path.display(),
        env!("CARGO_PKG_VERSION")
    )]
    Version {
        path: PathBuf,
        /// The other version.
        found: String,
    },
    #[error(
        "the run in `{}` is of another scene: {difference}; take the scene as it was, or run with `--force` in place of `--resume` to start anew",
        folder.display()
    )]
    Scene {
        folder: PathBuf,
        /// What is not as it was, in words.
        difference: String,
    },
    #[error(
        "`{}` is not as the run left it: put it back, or run with `--force` in place of `--resume` to start anew",
        path.display()
    )]
    History { path: PathBuf },
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
