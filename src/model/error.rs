//! What is wrong with a scene once its meshes and CAD files are read.
use crate::assembly::{ConstraintError, PatternError};
use crate::mesh::MeshError;
use crate::scene::ValueError;
use crate::shell::ShellError;
use crate::shell::quadrature::QuadratureError;
use covact_geometry::io::CadError;
use covact_geometry::project::{PatchSetError, SideError};

/// Why a model could not be built, with the JSON pointer of the field at fault.
#[derive(Debug, thiserror::Error)]
#[error("{cause}")]
pub struct ModelError {
    /// Field of the scene, e.g. `/contacts/punch/slave`.
    pub pointer: String,
    #[source]
    pub cause: Cause,
}

#[derive(Debug, thiserror::Error)]
pub enum Cause {
    #[error(transparent)]
    Mesh(#[from] MeshError),
    #[error(transparent)]
    Shell(#[from] ShellError),
    #[error(transparent)]
    Cad(#[from] CadError),
    #[error(transparent)]
    Patches(#[from] PatchSetError),
    #[error(transparent)]
    Side(#[from] SideError),
    #[error(transparent)]
    Value(#[from] ValueError),
    #[error(transparent)]
    Quadrature(#[from] QuadratureError),
    #[error(transparent)]
    Constraint(#[from] ConstraintError),
    #[error(transparent)]
    Pattern(#[from] PatternError),
    #[error("{0}")]
    Text(String),
}

/// Attaches the place in the scene to an error.
pub trait At<T> {
    fn at(self, pointer: impl FnOnce() -> String) -> Result<T, ModelError>;
}

impl<T, E: Into<Cause>> At<T> for Result<T, E> {
    fn at(self, pointer: impl FnOnce() -> String) -> Result<T, ModelError> {
        self.map_err(|e| ModelError {
            pointer: pointer(),
            cause: e.into(),
        })
    }
}

/// An error told in words.
pub fn text(pointer: impl Into<String>, message: impl Into<String>) -> ModelError {
    ModelError {
        pointer: pointer.into(),
        cause: Cause::Text(message.into()),
    }
}
