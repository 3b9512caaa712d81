//! Entries of text files, each with its place.
use super::{MeshError, Position};
use std::path::Path;

/// One entry of a line, without the blanks around it.
#[derive(Debug, Clone, Copy)]
pub(super) struct Field<'a> {
    pub text: &'a str,
    pub line: usize,
    pub column: usize,
}

impl Field<'_> {
    pub fn syntax(&self, path: &Path, expected: &str) -> MeshError {
        self.syntax_found(
            path,
            expected,
            if self.text.is_empty() {
                "nothing"
            } else {
                self.text
            },
        )
    }

    pub fn syntax_found(&self, path: &Path, expected: &str, found: &str) -> MeshError {
        MeshError::Syntax {
            path: path.to_path_buf(),
            at: self.position(),
            expected: expected.to_string(),
            found: found.chars().take(40).collect(),
        }
    }

    pub fn unsupported(&self, path: &Path, what: String, help: &str) -> MeshError {
        MeshError::Unsupported {
            path: path.to_path_buf(),
            at: self.position(),
            what,
            help: help.to_string(),
        }
    }

    fn position(&self) -> Position {
        Position::Text {
            line: self.line,
            column: self.column,
        }
    }

    /// A whole number that is not negative.
    pub fn integer(&self, path: &Path, expected: &str) -> Result<u64, MeshError> {
        self.text.parse().map_err(|_| self.syntax(path, expected))
    }

    /// A finite real, with `d` as an exponent too.
    pub fn real(&self, path: &Path, expected: &str) -> Result<f64, MeshError> {
        let number = self.text.replace(['d', 'D'], "e").parse::<f64>();
        match number {
            Ok(x) if x.is_finite() => Ok(x),
            _ => Err(self.syntax(path, expected)),
        }
    }
}
