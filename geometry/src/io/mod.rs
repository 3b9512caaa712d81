//! Readers of CAD files: STEP (AP203, AP214, AP242), IGES 5.3, and JSON of Kratos, geomdl and our own; writers of the latter
//! ([`write_json`]) and of IGES ([`write_iges`]).
//!
//! [`read_path`] tells the format from the content. What comes back is a [`CadFile`]: NURBS patches with
//! their trims, and an account of everything else the file holds. Nothing is dropped silently: a surface that was not read is
//! [`Skipped`] with its reason, and what was tolerated although the standard does not allow it is in the notes.

mod brep;
mod error;
mod file;
mod healing;
mod iges;
mod json;
mod report;
mod step;
mod stl;
mod surface;
mod unit;

pub use error::CadError;
pub use file::{MOST_BYTES, not_regular, read_whole, read_within};
pub use healing::{Healing, LeftOut, LeftOutKind};
pub use iges::{
    BasePatch, BaseSurface, Border, IgesCurve, IgesGeometry, IgesSurface, IgesWriteError,
    ParameterMap, Reparametrise, Unbounded, entity_name, read_iges, read_iges_geometry,
    read_iges_with, write_iges,
};
pub use json::{read_json, write_json};
pub use report::{
    CadBody, CadFile, CadFormat, CadPatch, CadTags, EntityCount, FaceBorder, SkipKind, Skipped,
    Summary, TrimReport,
};
pub use step::{read_step, read_step_watched, read_step_with};
pub use stl::{Stl, StlError, StlReport, read_stl, read_stl_path, write_stl};
pub use surface::{CadFace, CadSurface, SurfaceError};
pub use unit::LengthUnit;

use std::path::Path;

/// What to read of a CAD file.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct ReadOptions {
    /// Read what the CAD system hides as well (IGES: blanked entities; STEP: items of INVISIBILITY, by themselves or by
    /// their layer); otherwise it is skipped.
    pub hidden: bool,
}

/// Reads a CAD file, STEP, IGES or JSON by its content (the extension plays no part).
///
/// # Errors
/// [`CadError::Read`] when the file cannot be opened, [`CadError::Content`] with line and column when it is damaged,
/// and [`CadError::Format`] when it is none of these (an STL file, for one).
///
/// ```
/// use covact_geometry::io::{CadFormat, read_path};
/// let file = read_path("../assets/punch.igs".as_ref())?;
/// assert_eq!((file.format, file.patches.len()), (CadFormat::Iges, 45));
/// // What could not be read is named.
/// assert!(file.skipped.is_empty());
/// # Ok::<(), covact_geometry::io::CadError>(())
/// ```
pub fn read_path(path: &Path) -> Result<CadFile, CadError> {
    read_path_with(path, &ReadOptions::default())
}

/// Reads a CAD file as [`read_path`] does, with options.
///
/// # Errors
/// As [`read_path`].
pub fn read_path_with(path: &Path, options: &ReadOptions) -> Result<CadFile, CadError> {
    read_path_watched(path, options, &mut |_| {})
}

/// How far the reader of a file is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub struct ReadProgress {
    /// Faces that were read, or refused.
    pub faces: usize,
    /// Faces of the file.
    pub of: usize,
}

/// Reads a CAD file as [`read_path_with`] does and calls `watch` after every face of a STEP file. (Files of other formats are
/// read without a call.)
///
/// # Errors
/// As [`read_path`].
pub fn read_path_watched(
    path: &Path,
    options: &ReadOptions,
    watch: &mut dyn FnMut(ReadProgress),
) -> Result<CadFile, CadError> {
    let name = path.display().to_string();
    let bytes = read_whole(path).map_err(|source| CadError::Read {
        path: name.clone(),
        source,
    })?;
    let text = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(&bytes);
    let start = text.trim_ascii_start();
    if start.starts_with(b"{") || start.starts_with(b"[") {
        return read_json(text, &name);
    }
    if step::is_step(start) {
        return read_step_watched(text, &name, options, watch);
    }
    let kind = if start.is_empty() {
        Some("an empty file")
    } else if start.starts_with(b"solid") && !text[..text.len().min(80)].ends_with(b"S      1") {
        // An IGES comment may begin with the same word, but then its first line is 80 columns of section S.
        (text
            .split(|&b| b == b'\n')
            .next()
            .is_none_or(|l| l.len() < 73))
        .then_some("an STL file")
    } else if is_dxf(start) {
        Some("a DXF file, which holds a drawing")
    } else if start.starts_with(b"AC10") && text.len() > 6 {
        Some("a DWG file, which holds a drawing")
    } else if text[..text.len().min(400)].contains(&0) {
        Some("binary data")
    } else {
        None
    };
    match kind {
        Some(found) => Err(CadError::Format {
            path: name,
            found: found.to_owned(),
        }),
        None => read_iges_with(text, &name, options),
    }
}

/// A DXF file begins with the pair 0, SECTION (after comments 999), a value on each line.
fn is_dxf(text: &[u8]) -> bool {
    let mut lines = text.split(|&b| b == b'\n').map(<[u8]>::trim_ascii);
    let first = lines.next();
    let second = lines.next();
    match first {
        Some(b"0") => second == Some(b"SECTION"),
        Some(b"999") => lines
            .next()
            .is_some_and(|code| code == b"0" || code == b"999"),
        _ => false,
    }
}
