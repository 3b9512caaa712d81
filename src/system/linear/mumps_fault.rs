//! What keeps MUMPS from solving a system.
use std::fmt;

/// Versions whose interface is known.
const KNOWN: &str = "5.3 to 5.5 and 5.7 to 5.9";

/// Why MUMPS did not do what was asked of it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum MumpsFault {
    /// None of the names under which the library is looked for was found.
    NoLibrary {
        /// The names that were tried.
        name: &'static str,
    },
    /// A library without this function.
    NoFunction {
        /// Name of the function.
        name: &'static str,
    },
    /// A version whose interface is not known.
    Version {
        /// The version of the library.
        found: [u16; 3],
    },
    /// What was loaded did not say its version.
    NoVersion,
    /// The library was built without this ordering.
    NoOrdering {
        /// Name of the ordering.
        asked: &'static str,
    },
    /// No folder for the factors can be made.
    Folder {
        /// What the operating system says.
        kind: std::io::ErrorKind,
    },
    /// The name of the folder for the factors is longer than the library takes.
    LongFolder {
        /// Bytes that the library takes.
        most: usize,
    },
    /// An error of the library: its `INFOG(1)` and `INFOG(2)`.
    Code {
        /// What was being done.
        phase: &'static str,
        /// `INFOG(1)`.
        code: i32,
        /// `INFOG(2)`.
        detail: i32,
    },
}

impl std::error::Error for MumpsFault {}

impl fmt::Display for MumpsFault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            MumpsFault::NoLibrary { name } => write!(
                f,
                "`{name}` was not found: install the sequential library (Debian: libmumps-seq-5.5), or name its folder in \
                 LD_LIBRARY_PATH"
            ),
            MumpsFault::NoFunction { name } => {
                write!(f, "the library that was found has no function `{name}`")
            }
            MumpsFault::Version { found: [a, b, c] } => write!(
                f,
                "the library is of version {a}.{b}.{c}, whose interface is not known (known are {})",
                KNOWN
            ),
            MumpsFault::NoVersion => write!(f, "the library does not say its version"),
            MumpsFault::NoOrdering { asked } => {
                write!(f, "the library was built without the ordering `{asked}`")
            }
            MumpsFault::Folder { kind } => {
                write!(f, "no folder for the factors can be made: {kind}")
            }
            MumpsFault::LongFolder { most } => write!(
                f,
                "the name of the folder for the factors is longer than {most} bytes"
            ),
            MumpsFault::Code {
                phase,
                code,
                detail,
            } => write!(
                f,
                "the {phase} failed: {} (code {code}, {detail})",
                words(*code)
            ),
        }
    }
}

/// `INFOG(1)` in words, as in the users' guide.
fn words(code: i32) -> &'static str {
    match code {
        -6 => "the matrix is singular by its structure",
        -10 => "the matrix is singular",
        -40 => "the matrix is not positive definite",
        -5 | -7 | -13 => "there is not enough memory",
        -8 | -9 | -11 | -12 | -14 | -15 | -17 | -18 | -20 => {
            "the work space that was estimated is too small"
        }
        -19 => "the memory that is allowed is too small",
        -16 => "the number of unknowns is out of range",
        -2 => "the number of entries is out of range",
        -21 | -23 => "MPI is not set up as the library wants it",
        -51 | -52 => "the ordering needs more entries than its indices can count",
        -38 | -39 | -87 | -88 | -89 => "the ordering failed",
        -53 | -3 => "it was called out of order",
        -90 => "the factors cannot be written to or read from the disk",
        -79..=-71 => "a file cannot be read or written",
        -1 => "a process failed",
        _ => "see the library's users' guide",
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn codes_are_told_in_words() {
        let fault = MumpsFault::Code {
            phase: "factorization",
            code: -13,
            detail: 5,
        };
        assert_eq!(
            fault.to_string(),
            "the factorization failed: there is not enough memory (code -13, 5)"
        );
        let version = MumpsFault::Version { found: [4, 10, 0] };
        assert!(version.to_string().contains("version 4.10.0"), "{version}");
    }
}
