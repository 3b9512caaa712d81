//! Finished runs, kept in a file so that an interrupted command goes on where it stopped.
use super::Outcome;
use super::cases::{Case, MASTERS, SHELLS};
use std::fmt::Write as _;
use std::path::{Path, PathBuf};

/// A finished run.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Record {
    pub case: Case,
    /// Unknowns.
    pub dofs: usize,
    /// Force on the ball (N) at every depth.
    pub forces: [f64; 4],
    pub iterations: u64,
    pub seconds: f64,
}

/// All of them.
pub struct Runs {
    path: PathBuf,
    pub records: Vec<Record>,
}

const HEADER: &str =
    "shell,master,intervals,dofs,force_2.5,force_5,force_7.5,force_10,iterations,seconds";

impl Runs {
    /// The runs of a file, none where there is no such file yet.
    pub fn open(path: &Path) -> Outcome<Self> {
        let text = match std::fs::read_to_string(path) {
            Ok(text) => text,
            Err(e) if e.kind() == std::io::ErrorKind::NotFound => String::new(),
            Err(e) => return Err(format!("{}: {e}", path.display()).into()),
        };
        let mut records = Vec::new();
        for (number, line) in text.lines().enumerate().skip(1) {
            let place = || format!("{}:{}: not a run: {line}", path.display(), number + 1);
            records.push(parse(line).ok_or_else(place)?);
        }
        Ok(Runs {
            path: path.to_owned(),
            records,
        })
    }

    pub fn find(&self, case: &Case) -> Option<&Record> {
        self.records.iter().find(|r| r.case == *case)
    }

    /// Adds a run and writes the file whole, so that it never holds half a line.
    pub fn add(&mut self, record: Record) -> Outcome<()> {
        self.records.push(record);
        let mut text = format!("{HEADER}\n");
        for r in &self.records {
            let (shell, master) = (r.case.shell.name(), r.case.master.name());
            writeln!(
                text,
                "{shell},{master},{},{},{},{},{:.3}",
                r.case.intervals,
                r.dofs,
                r.forces.map(|f| format!("{f:.6}")).join(","),
                r.iterations,
                r.seconds
            )?;
        }
        let part = self.path.with_extension("part");
        std::fs::write(&part, text)?;
        std::fs::rename(&part, &self.path)?;
        Ok(())
    }
}

fn parse(line: &str) -> Option<Record> {
    let cells: Vec<&str> = line.split(',').collect();
    let [
        shell,
        master,
        intervals,
        dofs,
        a,
        b,
        c,
        d,
        iterations,
        seconds,
    ] = cells[..]
    else {
        return None;
    };
    Some(Record {
        case: Case {
            shell: SHELLS.into_iter().find(|s| s.name() == shell)?,
            master: MASTERS.into_iter().find(|m| m.name() == master)?,
            intervals: intervals.parse().ok()?,
        },
        dofs: dofs.parse().ok()?,
        forces: [
            a.parse().ok()?,
            b.parse().ok()?,
            c.parse().ok()?,
            d.parse().ok()?,
        ],
        iterations: iterations.parse().ok()?,
        seconds: seconds.parse().ok()?,
    })
}
