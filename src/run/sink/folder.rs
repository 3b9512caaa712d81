//! The folder of the results: history, fields, checkpoint and summary.
use crate::output::atomic::sweep;
use crate::output::{History, OutputError, Results, RunStatus, Summary, Table, read_csv};
use crate::run::checkpoint::{self, CheckpointError, Fingerprint, Found, Keeper};
use crate::run::claim::{Claim, Entry};
use crate::run::march::KeptFiles;
use crate::run::{RunError, Simulation, Sink};
use std::fs::File;
use std::io::{BufRead, BufReader, Seek, SeekFrom};
use std::path::{Path, PathBuf};

/// Writes what `covact run` leaves in a folder: `history.csv`, fields for ParaView (`.vtu`, `.pvd`), a checkpoint while the
/// run goes on, and `summary.json`. No other run can write to the folder as long as this lives.
pub struct ResultsFolder {
    path: PathBuf,
    claim: Claim,
    /// The folder has been cleared for the run.
    entered: bool,
    files: Option<Files>,
    /// Not told yet.
    notes: Vec<String>,
}

/// The open files of a run.
struct Files {
    table: History,
    results: Results,
    keeper: Keeper,
    /// Last step whose fields were written.
    written: Option<u32>,
}

impl Files {
    /// Brings the table and the fields to the disk.
    fn sync(table: &History, results: &mut Results) -> Result<(), OutputError> {
        table.sync()?;
        results.sync()
    }
}

impl ResultsFolder {
    /// A folder for a new run. It is made where it is missing once the run begins.
    ///
    /// # Errors
    /// Another run writes to it, or it holds results, of which nothing is changed.
    pub fn new(path: impl AsRef<Path>) -> Result<Self, RunError> {
        Self::open(path.as_ref(), Entry::Start)
    }

    /// A folder for a new run, whose results replace those of the run that it holds, if any.
    ///
    /// # Errors
    /// Another run writes to it, or it holds files of others where results belong.
    pub fn replace(path: impl AsRef<Path>) -> Result<Self, RunError> {
        Self::open(path.as_ref(), Entry::Replace)
    }

    pub(in crate::run) fn open(path: &Path, entry: Entry) -> Result<Self, RunError> {
        Ok(ResultsFolder {
            path: path.to_path_buf(),
            claim: Claim::new(path, entry)?,
            entered: false,
            files: None,
            notes: Vec::new(),
        })
    }

    /// The run that the folder holds.
    pub(in crate::run) fn find(&self, scene: &Fingerprint) -> Result<Found, RunError> {
        checkpoint::find(&self.path, scene)
    }

    /// Makes the folder the run's own.
    pub(in crate::run) fn enter(&mut self, run: &Simulation) -> Result<(), RunError> {
        let fields = &run.run_state().course.outputs.fields;
        let parts = (run.scene().scene.output.every > 0).then(|| fields.part_names(run.model()));
        let replaced = self.claim.enter(parts.as_ref())?;
        let folder = self.path.display();
        if let Some(reason) = &self.claim.unlocked {
            self.notes.push(format!(
                "{folder} cannot be locked ({reason}): nothing keeps another run from writing there"
            ));
        }
        if replaced {
            self.notes.push(format!("the run in {folder} is replaced"));
        }
        self.entered = true;
        Ok(())
    }

    /// The history before the checkpoint that a run goes on from; nothing where it cannot be read.
    pub(in crate::run) fn earlier(&self) -> Option<Table> {
        read_csv(&self.path.join("history.csv")).ok()
    }

    /// Begins with empty files, and the rows of the steps that were accepted already.
    fn create(&self, run: &Simulation) -> Result<Files, RunError> {
        sweep(&self.path);
        let results = Results::create(&self.path)?;
        let columns = run.history().columns.clone();
        let mut table = History::create(&self.path.join("history.csv"), columns)?;
        for row in &run.history().rows {
            table.push(row)?;
        }
        Ok(Files {
            table,
            results,
            keeper: Keeper::new(&self.path, run.fingerprint().clone()),
            written: None,
        })
    }

    /// Takes up the files of a run that was kept: they are as they were then, and what was written later is dropped.
    fn take_up(&self, run: &Simulation, kept: &KeptFiles) -> Result<Files, RunError> {
        let path = self.path.join("history.csv");
        let lost = lines_behind(&path, kept.table.length);
        let columns = run.history().columns.clone();
        let Some(table) = History::resume(&path, columns, kept.table)? else {
            return Err(CheckpointError::History { path }.into());
        };
        let mut keeper = Keeper::new(&self.path, run.fingerprint().clone());
        keeper.go_on(kept.slot);
        sweep(&self.path);
        let parts = run
            .run_state()
            .course
            .outputs
            .fields
            .part_names(run.model());
        let last = kept.written.last().map(|last| last.0);
        let mut results = Results::resume(&self.path, kept.written.clone(), &parts)?;
        let (step, every) = (run.steps(), run.scene().scene.output.every);
        for step in (step..=step.saturating_add(lost)).filter(|_| every > 0) {
            // Written because the run ended there, which it does not.
            if last != Some(step) && !step.is_multiple_of(every) {
                results.remove(step, &parts)?;
            }
        }
        Ok(Files {
            table,
            results,
            keeper,
            written: last,
        })
    }
}

impl Files {
    /// Writes the fields of the last accepted step.
    fn write(&mut self, run: &Simulation) -> Result<(), OutputError> {
        let (step, time) = (run.steps(), run.time());
        let fields = &run.run_state().course.outputs.fields;
        let written = fields.write(run.model(), &mut self.results, step, time, run.state());
        self.written = Some(step);
        written
    }
}

impl Sink for ResultsFolder {
    fn begin(&mut self, run: &Simulation) -> Result<(), RunError> {
        if self.files.take().is_some() {
            // Of the run that began again.
            self.entered = false;
            self.claim.replace();
        }
        if !self.entered {
            self.enter(run)?;
        }
        let files = match run.kept_files() {
            Some(kept) => self.take_up(run, kept)?,
            None => {
                let mut files = self.create(run)?;
                if run.scene().scene.output.every > 0 {
                    files.write(run)?;
                }
                files
            }
        };
        self.files = Some(files);
        Ok(())
    }

    fn notes(&mut self) -> Vec<String> {
        std::mem::take(&mut self.notes)
    }

    fn step(&mut self, run: &Simulation) -> Result<(), RunError> {
        let Some(files) = &mut self.files else {
            return Ok(());
        };
        if let Some(row) = run.history().rows.last() {
            files.table.push(row)?;
        }
        let every = run.scene().scene.output.every;
        if every > 0 && run.steps().is_multiple_of(every) {
            files.write(run)?;
        }
        Ok(())
    }

    fn keep(&mut self, run: &Simulation) -> Result<(), RunError> {
        let Some(files) = &mut self.files else {
            return Ok(());
        };
        let Files {
            table,
            results,
            keeper,
            written: _,
        } = files;
        // The table and the fields are brought to the disk as rarely as checkpoints are.
        if (run.run_state()).keep(keeper, table.mark(), results.written())? {
            keeper.flush(|| Files::sync(table, results))?;
        }
        Ok(())
    }

    fn close(&mut self, run: &Simulation) -> Result<(), RunError> {
        let Some(files) = &mut self.files else {
            return Ok(());
        };
        // Whatever went wrong, the last accepted step is not lost.
        let flushed = match run.done() {
            true => Ok(()),
            false => (files.keeper).flush(|| Files::sync(&files.table, &mut files.results)),
        };
        if run.scene().scene.output.every > 0 && files.written != Some(run.steps()) {
            files.write(run)?;
        }
        flushed?;
        // Before the summary tells of them.
        Ok(Files::sync(&files.table, &mut files.results)?)
    }

    fn summary(&mut self, _: &Simulation, summary: &Summary) -> Result<(), RunError> {
        if !self.entered {
            return Ok(());
        }
        let path = self.path.join("summary.json");
        let mut written = summary.write(&path);
        // A device that is nearly full, or allows small files only, may take the account alone: most of a summary is its plan.
        if written.is_err() {
            written = Summary {
                plan: None,
                ..summary.clone()
            }
            .write(&path);
        }
        // Where not even that could be written, an earlier run's summary must not pass for this one's.
        if written.is_err() && path.is_file() {
            let _ = std::fs::remove_file(&path);
        }
        written?;
        let reached = matches!(summary.status, RunStatus::Done | RunStatus::NoContact);
        match &self.files {
            Some(files) if reached => Ok(files.keeper.finish()?),
            _ => Ok(()),
        }
    }
}

/// Number of lines that a table has behind its first `length` bytes; 0 where it cannot be read.
fn lines_behind(path: &Path, length: u64) -> u32 {
    let count = || -> std::io::Result<u32> {
        let mut file = File::open(path)?;
        file.seek(SeekFrom::Start(length))?;
        let mut lines = BufReader::new(file).split(b'\n');
        lines.try_fold(0, |count, line| line.map(|_| count + 1))
    };
    count().unwrap_or(0)
}
