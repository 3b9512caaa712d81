//! One run at a time in a folder of results.
//!
//! A run holds the operating system's lock of a file in its folder, which also says who it is. The system releases the lock
//! when the process ends, however it ends, so that a killed run leaves the file but no lock.
use super::OutputError;
use super::atomic::{Replaceable, remove_file, replaceable};
use serde::{Deserialize, Serialize};
use std::fmt;
use std::fs::{File, OpenOptions, TryLockError};
use std::io::{self, Read, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};
use std::time::{Duration, SystemTime, UNIX_EPOCH};

/// Name of the locked file.
pub const LOCK_FILE: &str = ".covact.lock";

/// Times that a lock is asked for again because its file was removed by the run before, which just ended.
const ATTEMPTS: u32 = 100;

/// Who has locked a folder.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Holder {
    /// Number of its process.
    pub pid: u32,
    /// Name of its machine.
    pub host: String,
    /// When it began, in words.
    pub since: String,
}

impl fmt::Display for Holder {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "process {} on {}, since {}",
            self.pid, self.host, self.since
        )
    }
}

impl Holder {
    fn this_process() -> Self {
        let since_epoch = SystemTime::now().duration_since(UNIX_EPOCH);
        Holder {
            pid: std::process::id(),
            host: host(),
            since: utc(since_epoch.unwrap_or(Duration::ZERO)),
        }
    }
}

/// What came of asking for a lock.
#[derive(Debug)]
pub enum Locking {
    /// It is ours until it is dropped.
    Locked(FolderLock),
    /// Another process, or another part of this one, has it; its holder may not have written down who it is.
    InUse(Option<Holder>),
    /// The file system has no locks; the reason.
    Impossible(String),
}

/// A folder that no other run writes to. Dropping it removes the file and releases the lock.
#[derive(Debug)]
pub struct FolderLock {
    path: PathBuf,
    file: File,
}

impl FolderLock {
    /// Asks for the lock of a folder that exists, without waiting.
    ///
    /// # Errors
    /// The file cannot be made, or something else has its name.
    pub fn take(folder: &Path) -> Result<Locking, OutputError> {
        let path = folder.join(LOCK_FILE);
        let failed = |e| OutputError::io("write", &path, e);
        for _ in 0..ATTEMPTS {
            if replaceable(&path)? == Replaceable::Link {
                remove_file(&path)?;
            }
            let mut options = OpenOptions::new();
            options.read(true).write(true).create(true).truncate(false);
            let mut file = options.open(&path).map_err(failed)?;
            match file.try_lock() {
                Ok(()) => {}
                Err(TryLockError::WouldBlock) => return Ok(Locking::InUse(holder(&mut file))),
                Err(TryLockError::Error(e)) => return Ok(Locking::Impossible(e.to_string())),
            }
            // The one who had it removes the file before it lets go of the lock.
            if !is_at(&file, &path) {
                continue;
            }
            sign(&mut file).map_err(failed)?;
            return Ok(Locking::Locked(FolderLock { path, file }));
        }
        Ok(Locking::InUse(None))
    }
}

impl Drop for FolderLock {
    fn drop(&mut self) {
        if is_at(&self.file, &self.path) {
            // What cannot be removed locks nothing.
            let _ = std::fs::remove_file(&self.path);
        }
    }
}

/// Writes down who has the lock.
fn sign(file: &mut File) -> io::Result<()> {
    let text = serde_json::to_string(&Holder::this_process())?;
    file.set_len(0)?;
    file.seek(SeekFrom::Start(0))?;
    file.write_all(text.as_bytes())
}

fn holder(file: &mut File) -> Option<Holder> {
    let mut text = String::new();
    file.take(4096).read_to_string(&mut text).ok()?;
    serde_json::from_str(&text).ok()
}

/// Whether a path still leads to an open file.
fn is_at(file: &File, path: &Path) -> bool {
    #[cfg(unix)]
    {
        use std::fs::Metadata;
        use std::os::unix::fs::MetadataExt;
        let there = std::fs::symlink_metadata(path);
        let same = |a: &Metadata, b: &Metadata| (a.dev(), a.ino()) == (b.dev(), b.ino());
        matches!((file.metadata(), there), (Ok(a), Ok(b)) if same(&a, &b))
    }
    #[cfg(not(unix))]
    {
        // An open file keeps its name there.
        let _ = file;
        path.exists()
    }
}

/// Name of this machine.
fn host() -> String {
    let linux = std::fs::read_to_string("/proc/sys/kernel/hostname").ok();
    let variable = |name| std::env::var(name).ok();
    (linux.map(|name| name.trim().to_owned()))
        .or_else(|| variable("HOSTNAME"))
        .or_else(|| variable("COMPUTERNAME"))
        .filter(|name| !name.is_empty())
        .unwrap_or_else(|| "an unnamed machine".to_owned())
}

/// Date and time of day in UTC, of a time since the start of 1970.
fn utc(since: Duration) -> String {
    let seconds = since.as_secs();
    let (mut days, rest) = (seconds / 86_400, seconds % 86_400);
    let leap = |year: u64| {
        (year.is_multiple_of(4) && !year.is_multiple_of(100)) || year.is_multiple_of(400)
    };
    let mut year = 1970;
    while days >= 365 + u64::from(leap(year)) {
        days -= 365 + u64::from(leap(year));
        year += 1;
    }
    let february = 28 + u64::from(leap(year));
    let mut month = 1;
    for length in [31, february, 31, 30, 31, 30, 31, 31, 30, 31, 30, 31] {
        if days < length {
            break;
        }
        days -= length;
        month += 1;
    }
    let (hour, minute, second) = (rest / 3600, rest / 60 % 60, rest % 60);
    format!(
        "{year}-{month:02}-{:02} {hour:02}:{minute:02}:{second:02} UTC",
        days + 1
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn dates() {
        for (seconds, text) in [
            (0, "1970-01-01 00:00:00 UTC"),
            (951_782_400, "2000-02-29 00:00:00 UTC"),
            (1_709_251_199, "2024-02-29 23:59:59 UTC"),
            (1_709_251_200, "2024-03-01 00:00:00 UTC"),
            (4_102_444_799, "2099-12-31 23:59:59 UTC"),
        ] {
            assert_eq!(utc(Duration::from_secs(seconds)), text);
        }
    }

    #[test]
    fn a_lock_is_held_once_and_leaves_nothing() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join(LOCK_FILE);
        // What a killed run leaves.
        std::fs::write(&path, "{}").unwrap();
        let Locking::Locked(lock) = FolderLock::take(folder.path()).unwrap() else {
            panic!("not locked");
        };
        let Locking::InUse(Some(holder)) = FolderLock::take(folder.path()).unwrap() else {
            panic!("locked twice");
        };
        assert_eq!(holder.pid, std::process::id());
        assert!(holder.since.ends_with(" UTC") && !holder.host.is_empty());
        drop(lock);
        assert!(!path.exists());
        assert!(matches!(
            FolderLock::take(folder.path()).unwrap(),
            Locking::Locked(_)
        ));
    }

    #[cfg(unix)]
    #[test]
    fn a_link_in_its_place_is_not_followed() {
        let folder = tempfile::tempdir().unwrap();
        let other = folder.path().join("other");
        std::fs::write(&other, "mine").unwrap();
        std::os::unix::fs::symlink(&other, folder.path().join(LOCK_FILE)).unwrap();
        let lock = FolderLock::take(folder.path()).unwrap();
        assert!(matches!(lock, Locking::Locked(_)));
        assert_eq!(std::fs::read_to_string(&other).unwrap(), "mine");
    }
}
