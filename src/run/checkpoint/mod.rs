//! What a run is continued from: `checkpoint.0.bin`, `checkpoint.1.bin` and `checkpoint.2.bin` in the folder of its results.
//!
//! One of these [slots] is written anew, in place, at every accepted step, once everything else of the step is written, and
//! never the one that was written last: whoever ends the process at any moment leaves the checkpoint of the last accepted
//! step, or of the one before where the last is torn, and files that are as new or newer. A run that goes on from it does
//! anew what came after. Nothing is waited for: a step costs a copy of its state into the memory of the system, which a
//! crash of the machine may lose or tear. So the table, the fields and the newest slot are brought to the disk, in this order,
//! as often as costs half a hundredth of the time, and that slot is left alone until another is there. At the end of the run the files are removed.
//!
//! The layout: a mark, the version of the format, the length, a number that grows by one with every checkpoint of a run, the
//! version of the program, the sections ([`bytes`]), and a checksum of all of it. What lies behind is left of an earlier and
//! longer checkpoint.
pub mod bytes;
mod error;
mod fingerprint;
mod slots;
pub mod stages;
pub mod state;
#[cfg(test)]
mod tests;

pub use error::CheckpointError;
pub use fingerprint::Fingerprint;
pub use slots::{Slot, is_own};

use crate::output::atomic::{overwrite, remove_file, sync_file};
use crate::output::sum::Sum;
use crate::output::{OutputError, RunStatus, Summary};
use crate::run::RunError;
use bytes::{Malformed, Reader, Writer};
use slots::{SLOTS, newest, place};
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

/// First bytes of a file; the line ends show where it was taken for text.
const MARK: &[u8; 8] = b"covact\r\n";
/// Version of the layout and of the sections; to be raised with every change of them.
const FORMAT: u32 = 34;
/// Mark, format, length and number.
const HEAD: usize = 28;
/// Time between two checkpoints that are brought to the disk, in times of what the last one took.
const RARELY: u32 = 200;
/// What bringing one to the disk is taken to cost before it has been tried.
const FIRST: Duration = Duration::from_millis(10);

/// Writes the checkpoints of a run.
pub struct Keeper {
    folder: PathBuf,
    scene: Fingerprint,
    out: Writer,
    /// The last one; none yet.
    newest: Option<Slot>,
    /// The slot that is on the disk, or that the run went on from; none yet.
    safe: Option<usize>,
    /// When one was brought to the disk, and what that took.
    synced: Instant,
    cost: Duration,
}

impl Keeper {
    /// For a run of `scene` with results in `folder`.
    pub fn new(folder: &Path, scene: Fingerprint) -> Self {
        Keeper {
            folder: folder.to_path_buf(),
            scene,
            out: Writer::default(),
            newest: None,
            safe: None,
            synced: Instant::now(),
            cost: FIRST,
        }
    }

    /// Goes on from a checkpoint, which stays until a later one is on the disk.
    pub fn go_on(&mut self, from: Slot) {
        (self.newest, self.safe) = (Some(from), Some(from.index));
    }

    /// Writes a checkpoint with the sections that `put` writes, and says whether it is time for [`Keeper::flush`]. On failure
    /// the one before is as it was.
    pub fn keep(&mut self, put: impl FnOnce(&mut Writer)) -> Result<bool, OutputError> {
        let slot = self.next();
        let out = &mut self.out;
        out.clear();
        seal(out, slot.number, |out| {
            out.section("scene", |out| self.scene.put(out));
            put(out);
        });
        overwrite(&place(&self.folder, slot.index), self.out.bytes())?;
        self.newest = Some(slot);
        Ok(self.synced.elapsed() >= RARELY * self.cost)
    }

    /// Brings the last checkpoint to the disk, after the files that it goes on from, which `others` brings there.
    pub fn flush(
        &mut self,
        others: impl FnOnce() -> Result<(), OutputError>,
    ) -> Result<(), OutputError> {
        let start = Instant::now();
        others()?;
        if let Some(slot) = self.newest {
            sync_file(&place(&self.folder, slot.index))?;
            self.safe = Some(slot.index);
        }
        (self.synced, self.cost) = (Instant::now(), start.elapsed());
        Ok(())
    }

    /// Where the next one belongs.
    fn next(&self) -> Slot {
        let last = self.newest.map(|slot| slot.index);
        let free = |index: &usize| Some(*index) != last && Some(*index) != self.safe;
        Slot {
            // Of three slots at most two are taken.
            index: (0..SLOTS).find(free).unwrap_or(0),
            number: self.newest.map_or(0, |slot| slot.number) + 1,
        }
    }

    /// Removes the checkpoints of a run that has reached its end: the last one last, so that none that is left is older.
    pub fn finish(&self) -> Result<(), OutputError> {
        let last = self.newest.map_or(0, |slot| slot.index);
        let others = (0..SLOTS).filter(|index| *index != last);
        (others.chain([last])).try_for_each(|index| remove_file(&place(&self.folder, index)))
    }
}

/// A whole checkpoint: the head, what `put` writes, and the checksum.
fn seal(out: &mut Writer, number: u64, put: impl FnOnce(&mut Writer)) {
    out.raw(MARK);
    out.u32(FORMAT);
    out.u64(0);
    out.u64(number);
    out.text(env!("CARGO_PKG_VERSION"));
    put(out);
    let length = out.bytes().len() as u64 + 8;
    out.set_u64(HEAD - 16, length);
    let sum = Sum::of(out.bytes());
    out.u64(sum);
}

/// Where a run may keep checkpoints.
pub fn places(folder: &Path) -> impl Iterator<Item = PathBuf> + '_ {
    (0..SLOTS).map(|index| place(folder, index))
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
    /// Where the checkpoint is.
    pub slot: Slot,
    /// What is wrong with later ones, which were passed over.
    pub passed_over: Vec<String>,
    bytes: Vec<u8>,
    /// Where they start, behind that of the scene.
    start: usize,
}

impl Sections {
    /// The folder that they were found in.
    pub fn folder(&self) -> &Path {
        self.path.parent().unwrap_or(Path::new("."))
    }

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

    /// Reads the first of them.
    ///
    /// # Errors
    /// [`CheckpointError::Damaged`] where `take` finds something that cannot be.
    pub fn read_first<T>(
        &self,
        name: &'static str,
        take: impl FnOnce(&mut Reader) -> Result<T, Malformed>,
    ) -> Result<T, CheckpointError> {
        let mut reader = Reader::new(&self.bytes[self.start..]);
        let out = reader.section(name, take);
        out.map_err(|fault| damaged(&self.path, fault.0))
    }
}

/// Looks for a run of `scene` in `folder`.
///
/// # Errors
/// [`CheckpointError`] where there is none that can be continued, or what the operating system has against reading it.
pub fn find(folder: &Path, scene: &Fingerprint) -> Result<Found, RunError> {
    let found = newest(folder, |path, slot, bytes| {
        open(path.to_path_buf(), slot, bytes, folder, scene)
    })?;
    match found {
        Some((mut sections, passed_over)) => {
            sections.passed_over = passed_over;
            Ok(Found::Unfinished(sections))
        }
        None => finished(folder, scene, place(folder, 0)),
    }
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

/// Takes the checksum, which has to be that of the bytes before it.
fn checked(path: &Path, bytes: &mut Vec<u8>) -> Result<(), CheckpointError> {
    let sum = bytes.split_off(bytes.len().saturating_sub(8));
    match sum == Sum::of(bytes).to_le_bytes() {
        true => Ok(()),
        false => Err(damaged(path, "its checksum is wrong")),
    }
}

/// The bytes with the length and the checksum that fit them, for those who try what else a reader makes of changed ones.
#[doc(hidden)]
pub fn resealed(mut bytes: Vec<u8>) -> Vec<u8> {
    let length = bytes.len() as u64;
    if let Some(place) = bytes.get_mut(HEAD - 16..HEAD - 8) {
        place.copy_from_slice(&length.to_le_bytes());
    }
    bytes.truncate(bytes.len().saturating_sub(8));
    let sum = Sum::of(&bytes);
    bytes.extend_from_slice(&sum.to_le_bytes());
    bytes
}

/// Checks everything that needs no model.
fn open(
    path: PathBuf,
    slot: Slot,
    mut bytes: Vec<u8>,
    folder: &Path,
    scene: &Fingerprint,
) -> Result<Sections, CheckpointError> {
    checked(&path, &mut bytes)?;
    let mut reader = Reader::new(&bytes);
    let mut head = || {
        reader.raw(MARK.len())?;
        let format = reader.u32()?;
        reader.raw(HEAD - MARK.len() - 4)?;
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
    Ok(Sections {
        path,
        slot,
        passed_over: Vec::new(),
        bytes,
        start,
    })
}
