//! NURBS patches.

/// Why a patch could not be made.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum PatchError {
    #[error("placeholder")]
    Placeholder,
}

/// A NURBS surface patch.
#[derive(Debug, Clone, PartialEq)]
pub struct NurbsPatch {}
