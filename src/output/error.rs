//! Why results could not be written.
use std::io;
use std::path::{Path, PathBuf};

/// Why results could not be written or read back.
#[derive(Debug, thiserror::Error)]
pub enum OutputError {
    /// The operating system refused; `reason` names a full disk or quota in plain words.
    #[error("cannot {action} `{}`: {reason}", path.display())]
    Io {
        /// What was tried: "write", "create the folder", ...
        action: &'static str,
        /// The file or folder.
        path: PathBuf,
        /// What went wrong, in words.
        reason: String,
        /// The error of the operating system.
        source: io::Error,
    },
    /// The path exists and is something else than a file (a folder, a device, a pipe), which is left alone.
    #[error("cannot write `{}`: it exists and is not a regular file", path.display())]
    NotAFile {
        /// The path.
        path: PathBuf,
    },
    /// A field's length does not fit its mesh.
    #[error("field `{field}` of `{part}` has {found} numbers where {expected} are needed")]
    FieldLength {
        /// Body, surface or file.
        part: String,
        /// Name of the field.
        field: String,
        /// Numbers needed.
        expected: usize,
        /// Numbers found.
        found: usize,
    },
    /// Two fields of one part have the same name and place.
    #[error("field `{field}` of `{part}` is given twice")]
    DuplicateField {
        /// Body, surface or file.
        part: String,
        /// Name of the field.
        field: String,
    },
    /// An element names a node that the mesh does not have.
    #[error("element {element} of `{part}` names node {node}, but there are {nodes} nodes")]
    NoSuchNode {
        /// Body, surface or file.
        part: String,
        /// Element, counted from 0.
        element: usize,
        /// The node it names.
        node: u32,
        /// Nodes of the mesh.
        nodes: usize,
    },
    /// A rigid surface has a piece that cannot be written.
    #[error("piece {piece} of surface `{surface}`: {reason}")]
    Piece {
        /// Name of the surface.
        surface: String,
        /// Piece, counted from 0.
        piece: usize,
        /// What is wrong with it.
        reason: super::bezier::BezierError,
    },
    /// The serialiser failed.
    #[error("cannot put `{part}` into the format of its file: {reason}")]
    Serialise {
        /// Body, surface or file.
        part: String,
        /// What went wrong, in words.
        reason: String,
    },
    /// A history column that the documentation does not know.
    #[error("history column `{0}` is not documented")]
    UnknownColumn(String),
    /// Two history columns of one name, e.g. a surface and a support that share theirs.
    #[error("history column `{0}` is named twice; give surfaces and supports different names")]
    DuplicateColumn(String),
    /// A row of the history has the wrong length.
    #[error("a row of `{}` has {found} numbers where {expected} are needed", path.display())]
    RowLength {
        /// The file or folder.
        path: PathBuf,
        /// Numbers needed.
        expected: usize,
        /// Numbers found.
        found: usize,
    },
    /// A table that is read back is not one.
    #[error("`{}`, line {line}: {reason}", path.display())]
    Table {
        /// The file or folder.
        path: PathBuf,
        /// Line, counted from 1.
        line: usize,
        /// What went wrong, in words.
        reason: String,
    },
}

impl OutputError {
    /// An error of the operating system, with the usual ones named in plain words.
    pub(crate) fn io(action: &'static str, path: &Path, source: io::Error) -> Self {
        let plain = match source.kind() {
            io::ErrorKind::StorageFull => "the disk is full",
            io::ErrorKind::QuotaExceeded => "the disk quota is used up",
            io::ErrorKind::ReadOnlyFilesystem => "the file system is read-only",
            io::ErrorKind::PermissionDenied => "permission denied",
            io::ErrorKind::AlreadyExists => "a file of this name is in the way",
            io::ErrorKind::NotADirectory => "a part of the path is a file, not a folder",
            io::ErrorKind::FileTooLarge => "the file is larger than the system allows",
            io::ErrorKind::NotFound => "no such file or folder",
            io::ErrorKind::InvalidFilename => {
                "a name in the path is too long, or holds what file names cannot"
            }
            io::ErrorKind::WriteZero => "the file takes no more data",
            _ => "",
        };
        let reason = if plain.is_empty() {
            source.to_string()
        } else {
            format!("{plain} ({source})")
        };
        OutputError::Io {
            action,
            path: path.to_path_buf(),
            reason,
            source,
        }
    }

    /// True when a full disk or quota is the reason.
    pub fn is_disk_full(&self) -> bool {
        matches!(self, OutputError::Io { source, .. }
            if matches!(source.kind(), io::ErrorKind::StorageFull | io::ErrorKind::QuotaExceeded))
    }
}
