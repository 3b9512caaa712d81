//! Files written whole or not at all.
//!
//! The bytes go into a temporary file in the same folder, which takes the target's name once it is complete. Whoever reads
//! the target sees the earlier file or the new one, never a part, however the process ends. [`write_whole`] also waits until
//! the bytes are on the disk; [`write_soon`] leaves that to [`sync_files`], which its caller owes. The one exception is
//! [`overwrite`], for files of which there is another copy.
//!
//! A symbolic link at the target is replaced by the file, so that results never land where a link points to. [`write_through`] and
//! [`AtomicFile`] are for files that the user names, and follow links as a shell does.
use super::OutputError;
use std::fs::{self, File, OpenOptions};
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU64, Ordering};

/// Where bytes go. Files implement it; tests bring sinks that write short or fail.
pub trait Sink: Write {
    /// Returns when everything written is on the device.
    fn sync(&mut self) -> io::Result<()>;
}

impl Sink for File {
    fn sync(&mut self) -> io::Result<()> {
        sync(self)
    }
}

/// Writes all of `bytes`, however little the sink takes at a time, then flushes and syncs.
pub fn write_fully<S: Sink + ?Sized>(sink: &mut S, bytes: &[u8]) -> io::Result<()> {
    sink.write_all(bytes)?;
    sink.flush()?;
    sink.sync()
}

/// Replaces the file at `path` by `bytes`, which are then on the disk. On failure the temporary file is removed and the
/// earlier file is untouched. A target that exists and is not a regular file (a folder, a device, a pipe) is refused; a
/// symbolic link is replaced.
pub fn write_whole(path: &Path, bytes: &[u8]) -> Result<(), OutputError> {
    write_whole_with(path, bytes, create_new)
}

/// [`write_whole`] without the wait: a crash of the machine, not of the process, may lose the file until [`sync_files`]
/// has returned.
pub fn write_soon(path: &Path, bytes: &[u8]) -> Result<(), OutputError> {
    write_whole_with(path, bytes, |temporary| create_new(temporary).map(Unsynced))
}

/// [`write_whole`] into the file that a symbolic link at `path` points to.
pub fn write_through(path: &Path, bytes: &[u8]) -> Result<(), OutputError> {
    write_whole(&resolve(path)?, bytes)
}

/// Times that this process has waited for the disk.
static WAITS: AtomicU64 = AtomicU64::new(0);

/// How often this process has waited until something is on the disk.
pub fn waits() -> u64 {
    WAITS.load(Ordering::Relaxed)
}

/// Brings all of an open file to the disk.
pub fn sync(file: &File) -> io::Result<()> {
    WAITS.fetch_add(1, Ordering::Relaxed);
    file.sync_all()
}

/// Brings a file to the disk. One that has been removed since is passed over.
pub fn sync_file(path: &Path) -> Result<(), OutputError> {
    let opened = OpenOptions::new().write(true).open(path);
    match opened.and_then(|file| sync(&file)) {
        Err(e) if e.kind() == io::ErrorKind::NotFound => Ok(()),
        synced => synced.map_err(|e| OutputError::io("write", path, e)),
    }
}

/// Brings files of a folder to the disk, and their names. On Linux that is one wait for the whole file system, however many
/// files there are: one after the other, small files take some milliseconds each.
pub fn sync_files(folder: &Path, files: &[PathBuf]) -> Result<(), OutputError> {
    #[cfg(target_os = "linux")]
    {
        WAITS.fetch_add(1, Ordering::Relaxed);
        let opened = File::open(folder).map_err(|e| OutputError::io("write", folder, e))?;
        match rustix::fs::syncfs(&opened) {
            // Not every file system has it.
            Err(
                rustix::io::Errno::NOSYS | rustix::io::Errno::INVAL | rustix::io::Errno::OPNOTSUPP,
            ) => {}
            synced => return synced.map_err(|e| OutputError::io("write", folder, e.into())),
        }
    }
    files.iter().try_for_each(|file| sync_file(file))?;
    #[cfg(unix)]
    match File::open(folder).and_then(|folder| sync(&folder)) {
        // Some network file systems keep names by themselves, and refuse.
        Err(e) if e.kind() == io::ErrorKind::InvalidInput => {}
        synced => synced.map_err(|e| OutputError::io("write", folder, e))?,
    }
    #[cfg(not(unix))]
    let _ = folder;
    Ok(())
}

fn create_new(path: &Path) -> io::Result<File> {
    OpenOptions::new().write(true).create_new(true).open(path)
}

/// A file that is not waited for.
struct Unsynced(File);

impl Write for Unsynced {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.0.write(bytes)
    }
    fn flush(&mut self) -> io::Result<()> {
        self.0.flush()
    }
}

impl Sink for Unsynced {
    fn sync(&mut self) -> io::Result<()> {
        Ok(())
    }
}

/// [`write_whole`] through a sink of the caller's: `open` creates the temporary file at the given path.
pub fn write_whole_with<S: Sink>(
    path: &Path,
    bytes: &[u8],
    open: impl FnOnce(&Path) -> io::Result<S>,
) -> Result<(), OutputError> {
    replaceable(path)?;
    let temporary = temporary_name(path);
    let written = open(&temporary)
        .and_then(|mut sink| write_fully(&mut sink, bytes))
        .and_then(|()| fs::rename(&temporary, path));
    written.map_err(|source| {
        // The first error is the one to report; a temporary file that was never made cannot be removed.
        let _ = fs::remove_file(&temporary);
        OutputError::io("write", path, source)
    })
}

/// Writes `bytes` over the beginning of the file at `path`, which is made where it is missing and keeps what lies behind
/// them; nothing is waited for. On failure, or when the process is killed, a part of them may be there: this is for whoever
/// has another copy. Targets are refused as by [`write_whole`].
pub fn overwrite(path: &Path, bytes: &[u8]) -> Result<(), OutputError> {
    let mut file = open_in_place(path)?;
    (file.write_all(bytes)).map_err(|e| OutputError::io("write", path, e))
}

/// Opens the file of [`overwrite`], with all that is in it; a symbolic link is replaced by an empty file.
fn open_in_place(path: &Path) -> Result<File, OutputError> {
    // Opening a pipe would wait for its reader.
    if replaceable(path)? == Replaceable::Link {
        remove_file(path)?;
    }
    let mut options = OpenOptions::new();
    options.write(true).create(true).truncate(false);
    (options.open(path)).map_err(|e| OutputError::io("write", path, e))
}

/// A file that takes its name when it is complete: what is written goes into a temporary file beside it, which
/// [`commit`](Self::commit) renames and dropping removes. For contents that are not in memory at once.
#[derive(Debug)]
pub struct AtomicFile {
    /// None after it was renamed.
    file: Option<io::BufWriter<File>>,
    temporary: PathBuf,
    target: PathBuf,
}

impl AtomicFile {
    /// Opens the temporary file. Targets are refused as by [`write_whole`].
    pub fn create(path: &Path) -> Result<Self, OutputError> {
        let target = resolve(path)?;
        let temporary = temporary_name(&target);
        let file = OpenOptions::new()
            .write(true)
            .create_new(true)
            .open(&temporary)
            .map_err(|e| OutputError::io("write", path, e))?;
        Ok(AtomicFile {
            file: Some(io::BufWriter::with_capacity(1 << 16, file)),
            temporary,
            target,
        })
    }

    /// Where the bytes are until the file has its name; who ends the process at once has to remove it.
    pub fn temporary(&self) -> &Path {
        &self.temporary
    }

    /// Appends bytes.
    pub fn write(&mut self, bytes: &[u8]) -> Result<(), OutputError> {
        let file = self.file.as_mut().map(|file| file.write_all(bytes));
        file.unwrap_or(Ok(()))
            .map_err(|e| OutputError::io("write", &self.target, e))
    }

    /// Gives the file its name, after everything has reached the disk.
    pub fn commit(mut self) -> Result<(), OutputError> {
        let Some(file) = self.file.take() else {
            return Ok(());
        };
        let written = file
            .into_inner()
            .map_err(io::IntoInnerError::into_error)
            .and_then(|file| sync(&file))
            .and_then(|()| fs::rename(&self.temporary, &self.target));
        written.map_err(|source| {
            let _ = fs::remove_file(&self.temporary);
            OutputError::io("write", &self.target, source)
        })
    }
}

impl Drop for AtomicFile {
    fn drop(&mut self) {
        if self.file.take().is_some() {
            let _ = fs::remove_file(&self.temporary);
        }
    }
}

/// Makes a folder and its parents; an existing folder is fine.
pub fn make_folder(path: &Path) -> Result<(), OutputError> {
    fs::create_dir_all(path).map_err(|e| OutputError::io("create the folder", path, e))
}

/// Removes a file; that there is none is fine.
pub fn remove_file(path: &Path) -> Result<(), OutputError> {
    match fs::remove_file(path) {
        Err(e) if e.kind() != io::ErrorKind::NotFound => Err(OutputError::io("remove", path, e)),
        _ => Ok(()),
    }
}

/// What may be replaced by a file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Replaceable {
    /// There is nothing.
    Nothing,
    /// A regular file.
    File,
    /// A symbolic link, wherever it points to.
    Link,
}

/// What stands at `path`, links not followed.
///
/// # Errors
/// [`OutputError::NotAFile`] for a folder, a device or a pipe.
pub fn replaceable(path: &Path) -> Result<Replaceable, OutputError> {
    match fs::symlink_metadata(path) {
        Ok(meta) if meta.is_symlink() => Ok(Replaceable::Link),
        Ok(meta) if meta.is_file() => Ok(Replaceable::File),
        Ok(_) => Err(OutputError::NotAFile {
            path: path.to_path_buf(),
        }),
        // Not there; anything else wrong with the path shows when the file is made.
        Err(_) => Ok(Replaceable::Nothing),
    }
}

/// The file that `path` means, links followed; refuses what is not a regular file.
fn resolve(path: &Path) -> Result<PathBuf, OutputError> {
    match fs::metadata(path) {
        Ok(meta) if !meta.is_file() => Err(OutputError::NotAFile {
            path: path.to_path_buf(),
        }),
        Ok(_) => fs::canonicalize(path).map_err(|e| OutputError::io("write", path, e)),
        // Not there yet; anything else wrong with the path shows when the temporary file is made.
        Err(_) => Ok(path.to_path_buf()),
    }
}

/// Removes temporary files that a process left in a folder when it was killed. They harm nothing, so that what cannot be
/// removed stays.
pub fn sweep(folder: &Path) {
    let left_over = |name: &str| {
        let rest = name.strip_prefix('.')?.strip_suffix(".tmp")?;
        let (process, number) = rest.rsplit_once('.')?.1.split_once('-')?;
        let digits = |s: &str| !s.is_empty() && s.bytes().all(|b| b.is_ascii_digit());
        (digits(process) && digits(number)).then_some(())
    };
    for entry in fs::read_dir(folder).into_iter().flatten().flatten() {
        if entry.file_name().to_str().and_then(left_over).is_some() {
            let _ = fs::remove_file(entry.path());
        }
    }
}

/// A name in the target's folder that no other process or thread uses.
fn temporary_name(target: &Path) -> PathBuf {
    static COUNT: AtomicU64 = AtomicU64::new(0);
    let n = COUNT.fetch_add(1, Ordering::Relaxed);
    let name = target.file_name().unwrap_or_default().to_string_lossy();
    // Long names would pass the usual limit of 255 bytes with the additions.
    let short: String = name.chars().take(40).collect();
    target.with_file_name(format!(".{short}.{}-{n}.tmp", std::process::id()))
}
