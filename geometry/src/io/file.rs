//! Whole files in memory, within limits.

use crate::memory::{Size, available};
use std::io::{self, Read};
use std::path::Path;

/// Larger files are refused whatever memory there is.
pub const MOST_BYTES: u64 = 8 << 30;
/// A file may take this part of the memory that is there: what is read from it takes several times as much.
const PART: u64 = 4;

/// Reads a file of data. Only regular files are read: a pipe may never end, a device may be endless.
///
/// # Errors
/// Those of the operating system; [`io::ErrorKind::InvalidInput`] for what is no regular file,
/// [`io::ErrorKind::FileTooLarge`] above [`MOST_BYTES`] and above a quarter of the memory that is available.
pub fn read_whole(path: &Path) -> io::Result<Vec<u8>> {
    read_within(path, MOST_BYTES.min(available().bytes / PART))
}

/// As [`read_whole`], with a limit of the caller's in bytes.
///
/// # Errors
/// As [`read_whole`].
pub fn read_within(path: &Path, most: u64) -> io::Result<Vec<u8>> {
    // Asked before the file is opened: opening a pipe may wait for ever.
    let meta = std::fs::metadata(path)?;
    if let Some(what) = not_regular(&meta) {
        return Err(io::Error::new(io::ErrorKind::InvalidInput, what));
    }
    let length = meta.len();
    if length > most {
        let text = format!(
            "it has {}, more than the {} that can be read here",
            Size(length),
            Size(most)
        );
        return Err(io::Error::new(io::ErrorKind::FileTooLarge, text));
    }
    let mut bytes = Vec::new();
    bytes.try_reserve_exact(length as usize)?;
    // Files may grow meanwhile, and those of /proc state no length.
    let mut file = std::fs::File::open(path)?.take(most + 1);
    file.read_to_end(&mut bytes)?;
    if bytes.len() as u64 > most {
        let text = format!("it has more than the {} that can be read here", Size(most));
        return Err(io::Error::new(io::ErrorKind::FileTooLarge, text));
    }
    Ok(bytes)
}

/// What a path is where it is no regular file, in words.
pub fn not_regular(meta: &std::fs::Metadata) -> Option<&'static str> {
    if meta.is_file() {
        return None;
    }
    if meta.is_dir() {
        return Some("it is a folder");
    }
    #[cfg(unix)]
    {
        use std::os::unix::fs::FileTypeExt;
        let kind = meta.file_type();
        if kind.is_fifo() {
            return Some("it is a pipe, not a file");
        }
        if kind.is_char_device() || kind.is_block_device() {
            return Some("it is a device, not a file");
        }
        if kind.is_socket() {
            return Some("it is a socket, not a file");
        }
    }
    Some("it is not a regular file")
}
