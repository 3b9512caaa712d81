//! `run.log` in the folder of the results: what a run says, with every iteration.
use super::progress::Table;
use super::report;
use crate::output::RUN_LOG;
use crate::solve::event::{Event, Observer};
use std::fs::{File, OpenOptions};
use std::io::Write;
use std::path::{Path, PathBuf};

/// Writes events to the log and passes them on.
pub(super) struct Log {
    path: PathBuf,
    end_time: f64,
    table: Table,
    /// Lines from before the folder is the run's own.
    pending: String,
    file: Option<File>,
    /// Something could not be written, which has been said.
    failed: bool,
    shown: Box<dyn Observer + Send>,
}

impl Log {
    pub fn new(folder: &Path, end_time: f64, shown: Box<dyn Observer + Send>) -> Self {
        Log {
            path: folder.join(RUN_LOG),
            end_time,
            table: Table::new(end_time, true),
            pending: String::new(),
            file: None,
            failed: false,
            shown,
        }
    }

    fn write(&mut self, text: &str) {
        let written = match &mut self.file {
            Some(file) => file.write_all(text.as_bytes()),
            None => {
                self.pending.push_str(text);
                Ok(())
            }
        };
        self.tell(written);
    }

    /// Opens the log once the run has taken its folder. A run that goes on adds to it.
    fn open(&mut self) {
        let mut open = OpenOptions::new();
        let opened = open.create(true).append(true).open(&self.path);
        match opened {
            Ok(file) => {
                self.file = Some(file);
                let pending = std::mem::take(&mut self.pending);
                self.write(&pending);
            }
            Err(e) => self.tell(Err(e)),
        }
    }

    fn tell(&mut self, written: std::io::Result<()>) {
        if let Err(e) = written
            && !std::mem::replace(&mut self.failed, true)
        {
            let path = self.path.display();
            report::warning(&format!("cannot write {path}: {e}"));
        }
    }
}

impl Observer for Log {
    fn event(&mut self, event: &Event) {
        match event {
            // Also where a run is repeated with other elements: its folder is cleared then.
            Event::Model { .. } => {
                self.file = None;
                self.table = Table::new(self.end_time, true);
                self.pending = format!("covact {}\n", env!("CARGO_PKG_VERSION"));
            }
            Event::StepStarted { .. } if self.file.is_none() && !self.failed => self.open(),
            _ => {}
        }
        let lines = self.table.lines(event);
        if !lines.is_empty() && !self.failed {
            self.write(&(lines.join("\n") + "\n"));
        }
        self.shown.event(event);
    }
}
