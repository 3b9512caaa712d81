//! Why a CAD file could not be read.

/// Why a CAD file could not be read.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum CadError {
    /// The operating system refused.
    #[error("{path}: cannot be read: {source}")]
    Read {
        /// The path.
        path: String,
        /// What it said.
        #[source]
        source: std::io::Error,
    },
    /// The file is of a kind that is not read.
    #[error(
        "{path}: expected a STEP or IGES file, or JSON as Kratos or geomdl write it, found {found}"
    )]
    Format {
        /// Path or name of the file.
        path: String,
        /// What the file seems to be.
        found: String,
    },
    /// The content is damaged. Lines and columns (bytes) count from 1.
    #[error("{path}:{line}:{column}: expected {expected}, found {found}")]
    Content {
        /// Path or name of the file.
        path: String,
        /// Line, from 1.
        line: usize,
        /// Column in bytes, from 1.
        column: usize,
        /// What should stand there.
        expected: String,
        /// What stands there.
        found: String,
    },
    /// Lengths cannot be converted, because the file does not say which unit it uses.
    #[error("{path}: the file states no length unit, so it cannot be converted to {wanted}")]
    UnknownUnit {
        /// Path or name of the file.
        path: String,
        /// The unit asked for.
        wanted: String,
    },
    /// A patch cannot be scaled.
    #[error("{path}: entity {entity}: {reason}")]
    Scale {
        /// Path or name of the file.
        path: String,
        /// Entity number of the patch.
        entity: u32,
        /// Why the scaled patch is none.
        reason: String,
    },
}

impl CadError {
    /// Line and column (from 1) of the damage, where there is one.
    pub fn place(&self) -> Option<(usize, usize)> {
        match self {
            Self::Content { line, column, .. } => Some((*line, *column)),
            _ => None,
        }
    }
}

/// [`CadError::Content`] before the file's name is known.
#[derive(Debug)]
pub(super) struct Fail {
    pub line: usize,
    pub column: usize,
    pub expected: String,
    pub found: String,
}

impl Fail {
    pub fn new(
        (line, column): (usize, usize),
        expected: impl Into<String>,
        found: impl Into<String>,
    ) -> Self {
        Self {
            line,
            column,
            expected: expected.into(),
            found: found.into(),
        }
    }

    pub fn in_file(self, path: &str) -> CadError {
        let Self {
            line,
            column,
            expected,
            found,
        } = self;
        CadError::Content {
            path: path.to_owned(),
            line,
            column,
            expected,
            found,
        }
    }
}

/// Bytes of a damaged file for a message: latin-1, at most 40 characters, blanks named.
pub(super) fn show(bytes: &[u8]) -> String {
    let text = bytes.trim_ascii();
    if text.is_empty() {
        return if bytes.is_empty() {
            "nothing".to_owned()
        } else {
            "blanks".to_owned()
        };
    }
    let mut shown: String = text
        .iter()
        .take(40)
        .map(|&b| if b.is_ascii_control() { '?' } else { b as char })
        .collect();
    if text.len() > 40 {
        shown.push_str("...");
    }
    format!("\"{shown}\"")
}
