//! The files that checkpoints are written to in turn, and which of them is to be continued.
use super::{CheckpointError, FORMAT, HEAD, MARK, checked, damaged};
use crate::output::OutputError;
use crate::run::RunError;
use std::cmp::Reverse;
use std::fs::File;
use std::io::{self, Read};
use std::path::{Path, PathBuf};

/// One that is on the disk, the last one, and the one that is written.
pub const SLOTS: usize = 3;

/// Where a checkpoint is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Slot {
    pub index: usize,
    /// The checkpoint's number in its run.
    pub number: u64,
}

/// Where a run keeps a slot.
pub fn place(folder: &Path, index: usize) -> PathBuf {
    folder.join(format!("checkpoint.{index}.bin"))
}

/// What `open` makes of the newest slot that it does not find damaged, and what is wrong with those passed over; none where
/// the folder has no slot.
///
/// # Errors
/// [`CheckpointError`] where all that there are are damaged, one is no checkpoint, or `open` has anything else against it;
/// what the operating system has against reading one.
pub fn newest<T>(
    folder: &Path,
    mut open: impl FnMut(&Path, Slot, Vec<u8>) -> Result<T, CheckpointError>,
) -> Result<Option<(T, Vec<String>)>, RunError> {
    let (mut slots, mut faults) = (Vec::new(), Vec::new());
    for index in 0..SLOTS {
        let path = place(folder, index);
        match head(&path) {
            Ok(Ok(number)) => slots.push(Slot { index, number }),
            Ok(Err(fault)) => faults.push(passable(fault)?),
            Err(e)
                if matches!(
                    e.kind(),
                    io::ErrorKind::NotFound | io::ErrorKind::NotADirectory
                ) => {}
            Err(e) => return Err(OutputError::io("read", &path, e).into()),
        }
    }
    slots.sort_by_key(|slot| Reverse(slot.number));
    for slot in slots {
        let path = place(folder, slot.index);
        let bytes = read(&path).map_err(|e| OutputError::io("read", &path, e))?;
        match bytes.and_then(|bytes| open(&path, slot, bytes)) {
            Ok(opened) => {
                let words = |(path, reason): (PathBuf, String)| {
                    format!("`{}` is damaged: {reason}", path.display())
                };
                return Ok(Some((opened, faults.into_iter().map(words).collect())));
            }
            Err(fault) => faults.push(passable(fault)?),
        }
    }
    // All are named.
    let all = (faults.into_iter()).reduce(|(path, reasons), (other, reason)| {
        let reasons = format!("{reasons}; `{}` is damaged: {reason}", other.display());
        (path, reasons)
    });
    match all {
        Some((path, reason)) => Err(CheckpointError::Damaged { path, reason }.into()),
        None => Ok(None),
    }
}

/// What is wrong with a slot in whose place another one will do.
fn passable(fault: CheckpointError) -> Result<(PathBuf, String), CheckpointError> {
    match fault {
        CheckpointError::Damaged { path, reason } => Ok((path, reason)),
        other => Err(other),
    }
}

/// An open file behind its head, and the head, where it is a checkpoint.
fn start(path: &Path) -> io::Result<Result<(File, Vec<u8>), CheckpointError>> {
    let foreign = || {
        Ok(Err(CheckpointError::Foreign {
            path: path.to_path_buf(),
        }))
    };
    if !std::fs::metadata(path)?.is_file() {
        return foreign();
    }
    let mut file = File::open(path)?;
    let mut head = Vec::with_capacity(HEAD);
    Read::by_ref(&mut file)
        .take(HEAD as u64)
        .read_to_end(&mut head)?;
    if head.iter().all(|b| *b == 0) {
        return Ok(Err(damaged(path, "it is empty")));
    }
    // Zeros are what a crash of the machine may leave.
    let mut mark = head.iter().zip(MARK);
    if mark.clone().any(|(b, m)| b != m && *b != 0) {
        return foreign();
    }
    match head.len() == HEAD && mark.all(|(b, m)| b == m) {
        true => Ok(Ok((file, head))),
        false => Ok(Err(damaged(path, "it is not whole"))),
    }
}

/// Whether a file is a checkpoint of any version, whole or torn.
pub fn is_own(path: &Path) -> io::Result<bool> {
    let found = start(path)?;
    Ok(!matches!(found, Err(CheckpointError::Foreign { .. })))
}

fn word(head: &[u8], at: usize) -> u64 {
    let mut word = [0; 8];
    word.copy_from_slice(&head[at..at + 8]);
    u64::from_le_bytes(word)
}

/// The number of the checkpoint in a file. One of another format counts as the newest, so that it is not passed over.
fn head(path: &Path) -> io::Result<Result<u64, CheckpointError>> {
    Ok(start(path)?.map(|(_, head)| {
        match head[MARK.len()..MARK.len() + 4] == FORMAT.to_le_bytes() {
            true => word(&head, HEAD - 8),
            false => u64::MAX,
        }
    }))
}

/// The bytes of a checkpoint, as many as its head tells.
fn read(path: &Path) -> io::Result<Result<Vec<u8>, CheckpointError>> {
    let (file, head) = match start(path)? {
        Ok(start) => start,
        Err(e) => return Ok(Err(e)),
    };
    let length = word(&head, HEAD - 16);
    if length > file.metadata()?.len() || length < HEAD as u64 + 8 {
        return Ok(Err(damaged(path, "it is not whole")));
    }
    let mut bytes = Vec::new();
    let room = usize::try_from(length).map(|length| bytes.try_reserve_exact(length));
    if !matches!(room, Ok(Ok(()))) {
        return Ok(Err(damaged(path, "it is larger than the memory")));
    }
    bytes.extend_from_slice(&head);
    file.take(length - HEAD as u64).read_to_end(&mut bytes)?;
    Ok(match bytes.len() as u64 == length {
        true => Ok(bytes),
        false => Err(damaged(path, "it is not whole")),
    })
}

/// The slot that a run is continued from; the first where there is none.
pub fn current(folder: &Path) -> PathBuf {
    let found = newest(folder, |path, _, mut bytes| {
        checked(path, &mut bytes).map(|()| path.to_path_buf())
    });
    found
        .ok()
        .flatten()
        .map_or_else(|| place(folder, 0), |found| found.0)
}
