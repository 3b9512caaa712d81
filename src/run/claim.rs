//! The folder of a run before anything is written: what it holds, and whether another run is at work there.
use super::checkpoint;
use crate::output::atomic::{Replaceable, make_folder, remove_file, replaceable};
use crate::output::{
    COLLECTIONS, FolderLock, Holder, Locking, OutputError, PartNames, RUN_LOG, listed,
};
use crate::page::{REPORT, is_page};
use serde_json::Value;
use std::collections::BTreeSet;
use std::fs::{self, File};
use std::io::{self, Read};
use std::path::{Path, PathBuf};

/// Why a folder is not taken; nothing in it has been changed.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum FolderError {
    /// Another run writes to it.
    #[error(
        "another run is writing to `{}`{}: wait until it has ended, or choose another folder",
        folder.display(), words(holder.as_ref())
    )]
    InUse {
        /// The folder.
        folder: PathBuf,
        /// Who writes to it; none where that is not known.
        holder: Option<Holder>,
    },
    /// It holds a run, which nobody asked to replace.
    #[error(
        "`{}` holds {}: {}, replace it with `--force`, or choose another folder",
        folder.display(),
        match unfinished { true => "an unfinished run", false => "the results of a run" },
        match unfinished { true => "continue it with `--resume`", false => "keep it with `--resume`" }
    )]
    Occupied {
        /// The folder.
        folder: PathBuf,
        /// It can be continued.
        unfinished: bool,
    },
    /// A file that the run would write over was not written by this program.
    #[error(
        "`{}` was not written by covact, and the run would replace it: move it, or choose another folder",
        path.display()
    )]
    Foreign {
        /// The file.
        path: PathBuf,
    },
}

fn words(holder: Option<&Holder>) -> String {
    holder.map_or(String::new(), |holder| format!(" ({holder})"))
}

/// Why a folder cannot be taken.
#[derive(Debug, thiserror::Error)]
pub enum ClaimError {
    /// The folder is in use, or holds what nobody asked to replace.
    #[error(transparent)]
    Folder(#[from] FolderError),
    /// The folder cannot be made or written to.
    #[error(transparent)]
    Output(#[from] OutputError),
}

/// How a run treats what its folder holds.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Entry {
    /// A run that is there stands against it.
    Start,
    /// A run that is there is replaced.
    Replace,
    /// The run that is there goes on.
    Resume,
}

/// What a folder holds, by files of the names that runs write.
#[derive(Debug, Default)]
struct Holdings {
    /// Files of an earlier run, with the fields that its collections list.
    own: Vec<PathBuf>,
    /// Files of others.
    foreign: Vec<PathBuf>,
    /// Symbolic links, which are replaced wherever they point to.
    links: Vec<PathBuf>,
    /// There is a checkpoint.
    unfinished: bool,
}

/// A folder that is a run's own until it ends.
#[derive(Debug)]
pub struct Claim {
    folder: PathBuf,
    entry: Entry,
    lock: Option<FolderLock>,
    /// Why it could not be locked; to be told.
    pub unlocked: Option<String>,
}

impl Claim {
    /// Looks whether a run may write to `folder`, and locks it where it exists already: what would be refused is refused
    /// before anything is computed.
    ///
    /// # Errors
    /// [`FolderError`], or what the operating system has against it.
    pub fn new(folder: &Path, entry: Entry) -> Result<Self, ClaimError> {
        let mut claim = Claim {
            folder: folder.to_path_buf(),
            entry,
            lock: None,
            unlocked: None,
        };
        if folder.is_dir() {
            match claim.lock() {
                // A run that has ended can be told of in a folder that is read-only.
                Err(ClaimError::Output(_)) if entry == Entry::Resume => {}
                locked => locked?,
            }
            claim.admit()?;
        }
        Ok(claim)
    }

    /// Makes and locks the folder where that has not been done, and clears it of a run that is to be replaced. `parts` are
    /// those whose fields the run will write, none where it writes no fields. Says whether a run was replaced.
    ///
    /// # Errors
    /// As [`Claim::new`], and [`FolderError::Foreign`] for a field of another program that the run would write over.
    pub fn enter(&mut self, parts: Option<&PartNames>) -> Result<bool, ClaimError> {
        make_folder(&self.folder)?;
        if self.lock.is_none() && self.unlocked.is_none() {
            self.lock()?;
        }
        let holdings = self.admit()?;
        parts.map_or(Ok(()), |parts| self.admit_fields(parts))?;
        if self.entry == Entry::Resume {
            return Ok(false);
        }
        for path in holdings.own.iter().chain(&holdings.links) {
            remove_file(path)?;
        }
        Ok(!holdings.own.is_empty())
    }

    /// The next time that it is entered, what the run itself has written is replaced.
    pub fn replace(&mut self) {
        self.entry = Entry::Replace;
    }

    fn admit_fields(&self, parts: &PartNames) -> Result<(), ClaimError> {
        let stems = parts.stems();
        let mut names: Vec<String> = (fs::read_dir(&self.folder).into_iter().flatten().flatten())
            .filter_map(|entry| entry.file_name().into_string().ok())
            .filter(|name| field_of(name).is_some_and(|stem| stems.contains(stem)))
            .collect();
        names.sort();
        for path in names.iter().map(|name| self.folder.join(name)) {
            if replaceable(&path)? == Replaceable::File && !begins(&path, &GRIDS)? {
                return Err(FolderError::Foreign { path }.into());
            }
        }
        Ok(())
    }

    fn lock(&mut self) -> Result<(), ClaimError> {
        match FolderLock::take(&self.folder)? {
            Locking::Locked(lock) => self.lock = Some(lock),
            Locking::Impossible(reason) => self.unlocked = Some(reason),
            Locking::InUse(holder) => {
                let folder = self.folder.to_path_buf();
                return Err(FolderError::InUse { folder, holder }.into());
            }
        }
        Ok(())
    }

    /// What the folder holds, where that does not stand against the run.
    fn admit(&self) -> Result<Holdings, ClaimError> {
        let mut holdings = look(&self.folder)?;
        if self.entry == Entry::Resume {
            // Whether there is a run to continue, and of which scene, is for the reader of checkpoints to say.
            (holdings.foreign)
                .retain(|path| path.extension().is_some_and(|e| e == "json" || e == "pvd"));
        }
        if let Some(path) = holdings.foreign.pop() {
            return Err(FolderError::Foreign { path }.into());
        }
        if self.entry == Entry::Start && !holdings.own.is_empty() {
            return Err(FolderError::Occupied {
                folder: self.folder.to_path_buf(),
                unfinished: holdings.unfinished,
            }
            .into());
        }
        Ok(holdings)
    }
}

/// Whether a run could start in `folder` as things stand: it is not there, or holds neither a run nor files of others in
/// the places of results.
///
/// # Errors
/// [`FolderError::Occupied`], [`FolderError::Foreign`], or what the operating system has against looking.
pub fn vacant(folder: &Path) -> Result<(), ClaimError> {
    let claim = Claim {
        folder: folder.to_path_buf(),
        entry: Entry::Start,
        lock: None,
        unlocked: None,
    };
    claim.admit().map(|_| ())
}

/// How field files begin, in either version of the format.
const GRIDS: [&str; 2] = [
    "<VTKFile type=\"UnstructuredGrid\" version=\"1.0\" byte_order=\"LittleEndian\"",
    "<VTKFile type=\"UnstructuredGrid\" version=\"2.2\" byte_order=\"LittleEndian\"",
];

/// Looks at the files that a run writes under fixed names, and at the fields that are listed.
fn look(folder: &Path) -> Result<Holdings, OutputError> {
    let mut out = Holdings::default();
    let mut fields = BTreeSet::new();
    for name in COLLECTIONS {
        let path = folder.join(name);
        out.sort(path, |path| {
            let text = fs::read_to_string(path).unwrap_or_default();
            Ok(listed(&text).map(|files| fields.extend(files)).is_some())
        })?;
    }
    // The fields first: a run that is removed by half is still known for one.
    let fields = fields.into_iter().map(|name| folder.join(name));
    let mut own: Vec<PathBuf> = fields.filter(|path| path.is_file()).collect();
    own.append(&mut out.own);
    out.own = own;
    out.sort(folder.join("history.csv"), is_history)?;
    for path in checkpoint::places(folder) {
        let before = out.own.len();
        out.sort(path, checkpoint::is_own)?;
        out.unfinished |= out.own.len() > before;
    }
    out.sort(folder.join("summary.json"), is_summary)?;
    out.sort(folder.join(REPORT), is_page)?;
    out.sort(folder.join(RUN_LOG), |path| {
        Ok(fs::read(path)?.starts_with(b"covact "))
    })?;
    Ok(out)
}

impl Holdings {
    fn sort(
        &mut self,
        path: PathBuf,
        own: impl FnOnce(&Path) -> io::Result<bool>,
    ) -> Result<(), OutputError> {
        let list = match replaceable(&path)? {
            Replaceable::Nothing => return Ok(()),
            Replaceable::Link => &mut self.links,
            Replaceable::File => match own(&path) {
                Ok(true) => &mut self.own,
                Ok(false) => &mut self.foreign,
                Err(e) => return Err(OutputError::io("read", &path, e)),
            },
        };
        list.push(path);
        Ok(())
    }
}

/// Whether a table has the first columns that the tables of every version have.
fn is_history(path: &Path) -> io::Result<bool> {
    const START: &str = "step,time,dt,";
    let mut head = Vec::new();
    (File::open(path)?.take(START.len() as u64)).read_to_end(&mut head)?;
    Ok(head == START.as_bytes())
}

/// Whether a file is the account of a run, of any version.
fn is_summary(path: &Path) -> io::Result<bool> {
    let text = fs::read(path)?;
    let Ok(account) = serde_json::from_slice::<Value>(&text) else {
        return Ok(false);
    };
    Ok(account.pointer("/versions/covact").is_some() && account.get("status").is_some())
}

/// Whether the text of a file begins with one of `starts`, behind a declaration of XML.
fn begins(path: &Path, starts: &[&str]) -> Result<bool, OutputError> {
    let mut head = Vec::new();
    let read = File::open(path).and_then(|file| file.take(400).read_to_end(&mut head));
    read.map_err(|e| OutputError::io("read", path, e))?;
    let head = String::from_utf8_lossy(&head);
    let body = match head.strip_prefix("<?xml") {
        Some(rest) => rest.split_once("?>").map_or("", |(_, body)| body),
        None => &head,
    };
    let body = body.trim_start();
    Ok(starts.iter().any(|start| body.starts_with(start)))
}

/// The part that a file's name is of, where it is that of a field file.
fn field_of(name: &str) -> Option<&str> {
    let (stem, step) = name.strip_suffix(".vtu")?.rsplit_once('_')?;
    let digits = step.len() >= 4 && step.bytes().all(|b| b.is_ascii_digit());
    digits.then_some(stem)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn files_of_runs_are_told_from_others() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("file");
        for (text, own) in [
            ("step,time,dt,iterations\n1,2,3,4\n", true),
            ("step,time,dt,\"force.a,b.x\"\n", true),
            ("step,time,salary\n1,2,3\n", false),
            ("x,y\n", false),
            ("", false),
        ] {
            fs::write(&path, text).unwrap();
            assert_eq!(is_history(&path).unwrap(), own, "{text}");
        }
        for (text, own) in [
            (
                r#"{"status": "done", "versions": {"covact": "0.0.1"}}"#,
                true,
            ),
            (r#"{"status": "done"}"#, false),
            ("[1]", false),
            ("", false),
        ] {
            fs::write(&path, text).unwrap();
            assert_eq!(is_summary(&path).unwrap(), own, "{text}");
        }
        assert_eq!(field_of("a_b_0012.vtu"), Some("a_b"));
        assert_eq!(field_of("a_12.vtu"), None);
        assert_eq!(field_of("a_00x1.vtu"), None);
    }
}
