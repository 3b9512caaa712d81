//! The file that a run is continued from: `checkpoint.bin` in the folder of its results.
//!
//! It is made at every accepted step, once everything else of the step is written, and replaces the one before as a whole:
//! whoever ends the process at any moment leaves a checkpoint of some accepted step and files that are as new or newer. A
//! run that goes on from it does anew what came after. Replacing a file may have to wait for the disk, so that steps which
//! take less than a hundred times as long share a checkpoint: a process that is killed loses no more than that, and one that
//! ends by itself nothing. At the end of the run the file is removed.
//!
//! The layout: a mark, the version of the format, the length of the file, the version of the program, the sections
//! ([`bytes`]), and a checksum of all of it. A crash of the machine may tear what was not yet on the disk, which the
//! checksum tells; the file is brought there as often as costs no more than a hundredth of the time.
pub mod bytes;
mod error;
mod fingerprint;
pub mod state;
#[cfg(test)]
mod tests;

pub use error::CheckpointError;
pub use fingerprint::Fingerprint;

use crate::output::atomic::{Sink, remove_file, write_whole_with};
use crate::output::sum::Sum;
use crate::output::{OutputError, RunStatus, Summary};
use crate::run::RunError;
use bytes::{Malformed, Reader, Writer};
use std::fs::{File, OpenOptions};
use std::io::{self, Read, Write};
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

/// First bytes of the file; the line ends show where it was taken for text.
const MARK: &[u8; 8] = b"covact\r\n";
/// Version of the layout and of the sections; to be raised with every change of them.
const FORMAT: u32 = 1;
/// Mark, format and length.
const HEAD: usize = 20;
/// Time between two checkpoints that are written, or brought to the disk, in times of what the last one took.
const RARELY: u32 = 100;
/// What bringing one to the disk is taken to cost before it has been tried.
const FIRST: Duration = Duration::from_millis(10);

/// Where a run keeps its checkpoint.
fn place(folder: &Path) -> PathBuf {
    folder.join("checkpoint.bin")
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

/// Writes the checkpoints of a run.
pub struct Keeper {
    path: PathBuf,
    scene: Fingerprint,
    out: Writer,
    /// The last one is not written yet.
    pending: bool,
    /// When one was written, and what that took; none yet.
    written: Option<(Instant, Duration)>,
    /// When one was brought to the disk, and what that took.
    synced: Instant,
    cost: Duration,
}

impl Keeper {
    /// For a run of `scene` with results in `folder`.
    pub fn new(folder: &Path, scene: Fingerprint) -> Self {
        Keeper {
            path: place(folder),
            scene,
            out: Writer::default(),
            pending: false,
            written: None,
            synced: Instant::now(),
            cost: FIRST,
        }
    }

    /// Makes a checkpoint with the sections that `put` writes, and writes it where it is time to. On failure the one before is
    /// as it was.
    pub fn keep(&mut self, put: impl FnOnce(&mut Writer)) -> Result<(), OutputError> {
        let out = &mut self.out;
        out.clear();
        seal(out, FORMAT, env!("CARGO_PKG_VERSION"), |out| {
            out.section("scene", |out| self.scene.put(out));
            put(out);
        });
        self.pending = true;
        match self.written {
            Some((when, cost)) if when.elapsed() < RARELY * cost => Ok(()),
            _ => self.flush(),
        }
    }

    /// Writes the last checkpoint, where it is not written yet. On failure the one before is as it was.
    pub fn flush(&mut self) -> Result<(), OutputError> {
        if !std::mem::take(&mut self.pending) {
            return Ok(());
        }
        let (out, start) = (&self.out, Instant::now());
        let create = |path: &Path| {
            let mut options = OpenOptions::new();
            options.write(true).create_new(true).open(path)
        };
        if self.synced.elapsed() < RARELY * self.cost {
            let unsynced = |path: &Path| create(path).map(Unsynced);
            let done = write_whole_with(&self.path, out.bytes(), unsynced);
            self.written = Some((start, start.elapsed()));
            return done;
        }
        self.synced = Instant::now();
        let written = write_whole_with(&self.path, out.bytes(), create);
        self.cost = self.synced.elapsed();
        written
    }

    /// Removes the checkpoint of a run that has reached its end.
    pub fn finish(&self) -> Result<(), OutputError> {
        remove_file(&self.path)
    }
}

/// A whole file: the head, what `put` writes, and the checksum.
fn seal(out: &mut Writer, format: u32, program: &str, put: impl FnOnce(&mut Writer)) {
    out.raw(MARK);
    out.u32(format);
    out.u64(0);
    out.text(program);
    put(out);
    let length = out.bytes().len() as u64 + 8;
    out.set_u64(HEAD - 8, length);
    let sum = Sum::of(out.bytes());
    out.u64(sum);
}

/// Makes room for a run that starts anew in `folder`: what it held was of another run. Says whether that was unfinished.
///
/// # Errors
/// What the operating system has against it.
pub fn start(folder: &Path) -> Result<bool, OutputError> {
    // An earlier summary must not pass for that of this run, should it be cut short.
    remove_file(&folder.join("summary.json"))?;
    let path = place(folder);
    let unfinished = path.exists();
    remove_file(&path)?;
    Ok(unfinished)
}

/// What there is to continue.
pub enum Found {
    /// A checkpoint.
    Unfinished(Sections),
    /// The run has reached its end.
    Finished(Box<Summary>),
}

/// The sections of a checkpoint that is whole, of this version and of this scene.
#[derive(Debug)]
pub struct Sections {
    path: PathBuf,
    bytes: Vec<u8>,
    /// Where they start, behind that of the scene.
    start: usize,
}

impl Sections {
    /// Reads them.
    ///
    /// # Errors
    /// [`CheckpointError::Damaged`] where `take` finds something that cannot be, or leaves something.
    pub fn read<T>(
        &self,
        take: impl FnOnce(&mut Reader) -> Result<T, Malformed>,
    ) -> Result<T, CheckpointError> {
        let mut reader = Reader::new(&self.bytes[self.start..]);
        let out = take(&mut reader).and_then(|out| reader.end().map(|()| out));
        out.map_err(|fault| damaged(&self.path, fault.0))
    }
}

/// Looks for a run of `scene` in `folder`.
///
/// # Errors
/// [`CheckpointError`] where there is none that can be continued, or what the operating system has against reading it.
pub fn find(folder: &Path, scene: &Fingerprint) -> Result<Found, RunError> {
    let path = place(folder);
    let bytes = match read(&path) {
        Ok(bytes) => bytes?,
        Err(e)
            if matches!(
                e.kind(),
                io::ErrorKind::NotFound | io::ErrorKind::NotADirectory
            ) =>
        {
            return finished(folder, scene, path);
        }
        Err(e) => return Err(OutputError::io("read", &path, e).into()),
    };
    Ok(Found::Unfinished(open(path, bytes, folder, scene)?))
}

/// Whether the folder holds the results of a run that reached its end.
fn finished(folder: &Path, scene: &Fingerprint, path: PathBuf) -> Result<Found, RunError> {
    let summary = match Summary::read(&folder.join("summary.json")) {
        Ok(summary) if matches!(summary.status, RunStatus::Done | RunStatus::NoContact) => summary,
        _ => return Err(CheckpointError::Missing { path }.into()),
    };
    if summary.scene != name(scene) {
        return Err(CheckpointError::Scene {
            folder: folder.to_path_buf(),
            difference: "it has reached its end, and the scene or a file it names has changed"
                .to_owned(),
        }
        .into());
    }
    Ok(Found::Finished(Box::new(summary)))
}

/// The fingerprint as summaries tell it.
pub fn name(scene: &Fingerprint) -> String {
    format!("{:016x}", scene.value())
}

fn damaged(path: &Path, reason: impl Into<String>) -> CheckpointError {
    CheckpointError::Damaged {
        path: path.to_path_buf(),
        reason: reason.into(),
    }
}

/// The bytes of a file whose head tells its length.
fn read(path: &Path) -> io::Result<Result<Vec<u8>, CheckpointError>> {
    let foreign = || {
        Ok(Err(CheckpointError::Foreign {
            path: path.to_path_buf(),
        }))
    };
    let meta = std::fs::metadata(path)?;
    if !meta.is_file() {
        return foreign();
    }
    let mut file = File::open(path)?;
    let mut head = Vec::with_capacity(HEAD);
    Read::by_ref(&mut file)
        .take(HEAD as u64)
        .read_to_end(&mut head)?;
    if !head.starts_with(MARK) {
        // Nothing but zeros is what a crash of the machine may leave.
        return match head.iter().all(|b| *b == 0) {
            true => Ok(Err(damaged(path, "it is empty"))),
            false => foreign(),
        };
    }
    let length = head.get(HEAD - 8..HEAD).map_or(0, |bytes| {
        let mut word = [0; 8];
        word.copy_from_slice(bytes);
        u64::from_le_bytes(word)
    });
    if length != meta.len() || length < HEAD as u64 + 8 {
        return Ok(Err(damaged(path, "it is not whole")));
    }
    let mut bytes = Vec::new();
    if bytes.try_reserve_exact(length as usize).is_err() {
        return Ok(Err(damaged(path, "it is larger than the memory")));
    }
    bytes.extend_from_slice(&head);
    file.take(length - HEAD as u64).read_to_end(&mut bytes)?;
    Ok(match bytes.len() as u64 == length {
        true => Ok(bytes),
        false => Err(damaged(path, "it is not whole")),
    })
}

/// Checks everything that needs no model.
fn open(
    path: PathBuf,
    bytes: Vec<u8>,
    folder: &Path,
    scene: &Fingerprint,
) -> Result<Sections, CheckpointError> {
    let mut bytes = bytes;
    let sum = bytes.split_off(bytes.len().saturating_sub(8));
    if sum != Sum::of(&bytes).to_le_bytes() {
        return Err(damaged(&path, "its checksum is wrong"));
    }
    let mut reader = Reader::new(&bytes);
    let mut head = || {
        reader.raw(MARK.len())?;
        let format = reader.u32()?;
        reader.u64()?;
        Ok((format, reader.text()?.to_owned()))
    };
    let (format, program) = head().map_err(|e: Malformed| damaged(&path, e.0))?;
    if format != FORMAT || program != env!("CARGO_PKG_VERSION") {
        let found = match program == env!("CARGO_PKG_VERSION") {
            true => format!("{program} with format {format} of checkpoints (here {FORMAT})"),
            false => program,
        };
        return Err(CheckpointError::Version { path, found });
    }
    let before = reader.section("scene", Fingerprint::take);
    let before = before.map_err(|e| damaged(&path, e.0))?;
    if let Some(difference) = scene.difference(&before) {
        let folder = folder.to_path_buf();
        return Err(CheckpointError::Scene { folder, difference });
    }
    let start = bytes.len() - reader.left();
    Ok(Sections { path, bytes, start })
}
