//! What is wrong with a scene once its meshes and CAD files are read.
use crate::fem::quadrature::QuadratureError;
use crate::mesh::MeshError;
use crate::scene::ValueError;
use crate::shell::ShellError;
use crate::system::{ConstraintError, PatternError};
use covact_geometry::io::{CadError, StlError};
use covact_geometry::project::{PatchSetError, SideError};
use covact_geometry::{MovingError, PatchError};

/// Why a model could not be built, with the JSON pointer of the field at fault.
#[derive(Debug, thiserror::Error)]
#[error("{cause}")]
pub struct ModelError {
    /// Field of the scene, e.g. `/contacts/punch/slave`.
    pub pointer: String,
    /// What is wrong.
    #[source]
    pub cause: Box<Cause>,
    /// What to do about it, where the cause does not say.
    pub help: Option<String>,
    /// What else is wrong.
    pub others: Vec<ModelError>,
}

impl ModelError {
    /// Adds what to do about it.
    pub fn help(mut self, help: impl Into<String>) -> Self {
        self.help = Some(help.into());
        self
    }

    /// The errors as one: the first with the others behind it.
    ///
    /// # Errors
    /// Where there is one.
    pub fn all(errors: impl IntoIterator<Item = ModelError>) -> Result<(), ModelError> {
        let mut errors = errors.into_iter();
        let Some(mut first) = errors.next() else {
            return Ok(());
        };
        for mut error in errors {
            let more = std::mem::take(&mut error.others);
            first.others.push(error);
            first.others.extend(more);
        }
        Err(first)
    }
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
    Stl(#[from] StlError),
    #[error(transparent)]
    Patches(#[from] PatchSetError),
    #[error(transparent)]
    Patch(#[from] PatchError),
    #[error(transparent)]
    Facets(#[from] MovingError),
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
            cause: Box::new(e.into()),
            help: None,
            others: Vec::new(),
        })
    }
}

/// An error of a known cause.
pub fn cause(pointer: impl Into<String>, cause: impl Into<Cause>) -> ModelError {
    ModelError {
        pointer: pointer.into(),
        cause: Box::new(cause.into()),
        help: None,
        others: Vec::new(),
    }
}

/// An error told in words.
pub fn text(pointer: impl Into<String>, message: impl Into<String>) -> ModelError {
    ModelError {
        pointer: pointer.into(),
        cause: Box::new(Cause::Text(message.into())),
        help: None,
        others: Vec::new(),
    }
}

/// A number with at most six significant digits, as messages show it.
pub fn number(x: f64) -> String {
    let digits = |text: String| match text.contains('.') {
        true => text.trim_end_matches('0').trim_end_matches('.').to_string(),
        false => text,
    };
    if x == 0.0 || !x.is_finite() {
        return if x == 0.0 { "0".into() } else { x.to_string() };
    }
    let magnitude = x.abs().log10().floor();
    if (-4.0..6.0).contains(&magnitude) {
        return digits(format!("{:.*}", (5.0 - magnitude) as usize, x));
    }
    let text = format!("{x:.5e}");
    match text.split_once('e') {
        Some((mantissa, exponent)) => format!("{}e{exponent}", digits(mantissa.to_string())),
        None => text,
    }
}

#[cfg(test)]
mod tests {
    use super::number;

    #[test]
    fn numbers_are_short() {
        for (x, text) in [
            (0.0, "0"),
            (-0.0, "0"),
            (25.0, "25"),
            (0.1 + 0.2, "0.3"),
            (49.436734, "49.4367"),
            (999999.7, "1000000"),
            (120000.0, "120000"),
            (1.4e6, "1.4e6"),
            (-7.144291e-5, "-7.14429e-5"),
            (0.007144291, "0.00714429"),
            (f64::INFINITY, "inf"),
        ] {
            assert_eq!(number(x), text);
        }
    }
}
