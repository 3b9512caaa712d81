//! `covact project`.
mod points;
mod rows;

use super::cad::{self, Stop};
use super::{ProjectArgs, exit, report};
use crate::machine;
use crate::machine::memory::peak_memory_mb;
use crate::output::atomic::AtomicFile;
use crate::scene::nearest_file;
use covact_geometry::project::Joining;
use covact_geometry::{Foot, PatchSet};
use points::{Points, PointsError};
use rayon::prelude::*;
use rows::{HEADER, Tally, rows};
use std::fs::File;
use std::io::{self, BufReader, Write};
use std::path::Path;
use std::time::{Duration, Instant};

/// Points in memory at a time.
const BLOCK: usize = 1 << 14;
/// Rows that one thread writes at a time.
const CHUNK: usize = 256;

/// Where rows go.
enum Target {
    File(AtomicFile),
    Stdout(io::Stdout),
}

impl Target {
    /// Writes text; false when the reader of a pipe has gone away.
    fn write(&mut self, text: &str) -> Result<bool, Stop> {
        match self {
            Target::File(file) => file.write(text.as_bytes())?,
            Target::Stdout(out) => match out.write_all(text.as_bytes()) {
                Ok(()) => {}
                Err(e) if e.kind() == io::ErrorKind::BrokenPipe => return Ok(false),
                Err(e) => {
                    let text = format!("cannot write to the standard output: {e}");
                    return Err(Stop(text, exit::IO));
                }
            },
        }
        Ok(true)
    }
}

/// What was done, and how long it took.
#[derive(Default)]
struct Account {
    tally: Tally,
    /// Time spent in projections.
    projecting: Duration,
    threads: usize,
}

pub(super) fn project(args: &ProjectArgs) -> u8 {
    let start = Instant::now();
    match run(args) {
        Ok(account) => {
            summary(args, &account, start.elapsed());
            match account.tally.not_converged {
                0 => 0,
                n => {
                    report::error(&format!("{n} projections did not converge"));
                    exit::NOT_CONVERGED
                }
            }
        }
        Err(Stop(text, code)) => {
            report::error(&text);
            code
        }
    }
}

fn run(args: &ProjectArgs) -> Result<Account, Stop> {
    if args.reach.is_some_and(|r| r.is_nan() || r < 0.0) {
        return Err(Stop("--reach: expected a length >= 0".into(), exit::USAGE));
    }
    let (threads, capped) = machine::threads(args.threads);
    if let Some(text) = capped {
        report::warning(&text);
    }
    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(threads)
        .build()
        .map_err(|e| Stop(format!("cannot start the threads: {e}"), exit::IO))?;
    let file = cad::read(&args.file, args.unit.as_deref())?;
    let entities: Vec<u32> = file.patches.iter().map(|p| p.entity).collect();
    let bodies: Vec<Option<usize>> = file.patches.iter().map(|p| p.tags.body).collect();
    let patches = file.patches.into_iter().map(|p| p.patch).collect();
    let joining = Joining {
        tolerance: None,
        resolution: file.resolution,
    };
    let mut set = PatchSet::join(patches, joining)
        .map_err(|e| Stop(format!("{}: {e}", file.path), exit::SCENE))?;
    set.turn_cavities(|patch| bodies[patch]);
    if let Err(e) = set.two_sided() {
        report::warning(&format!(
            "{}: {e}; distances from it carry no sign",
            file.path
        ));
    }

    let mut points: Points<Box<dyn io::BufRead>> = Points::new(match args.points.as_os_str() {
        name if name == "-" => Box::new(io::stdin().lock()),
        _ => Box::new(BufReader::with_capacity(1 << 16, open(&args.points)?)),
    });
    let mut target = match args.out.as_os_str() {
        name if name == "-" => Target::Stdout(io::stdout()),
        _ => Target::File(AtomicFile::create(&args.out)?),
    };
    if let Target::File(file) = &target {
        leave_nothing_behind(file.temporary(), &args.out);
    }
    let mut account = Account {
        threads: pool.current_num_threads(),
        ..Account::default()
    };
    if !args.json && !target.write(HEADER)? {
        return Ok(account);
    }
    let reach = args.reach.unwrap_or(f64::INFINITY);
    let mut block = Vec::with_capacity(BLOCK);
    let mut feet: Vec<Option<Foot>> = Vec::with_capacity(BLOCK);
    loop {
        points
            .read(&mut block, BLOCK)
            .map_err(|e| points_fault(&args.points, &e))?;
        if block.is_empty() {
            break;
        }
        let start = Instant::now();
        feet.clear();
        feet.resize(block.len(), None);
        pool.install(|| set.project_batch(&block, &[], reach, &mut feet))
            .map_err(|e| Stop(e.to_string(), exit::BUG))?;
        account.projecting += start.elapsed();
        let chunk = |feet: &[Option<Foot>]| rows(feet, &entities, args.json);
        let done: Vec<_> = pool.install(|| feet.par_chunks(CHUNK).map(chunk).collect());
        for part in done {
            let (text, tally) =
                part.map_err(|e| Stop(format!("cannot write a row as JSON: {e}"), exit::BUG))?;
            account.tally.add(&tally);
            if !target.write(&text)? {
                return Ok(account);
            }
        }
    }
    match target {
        Target::File(file) => file.commit()?,
        Target::Stdout(mut out) => match out.flush() {
            Err(e) if e.kind() != io::ErrorKind::BrokenPipe => {
                let text = format!("cannot write to the standard output: {e}");
                return Err(Stop(text, exit::IO));
            }
            _ => {}
        },
    }
    Ok(account)
}

/// Ctrl-C ends the program where it is (it may wait for points that never come) and removes the half of a table.
fn leave_nothing_behind(temporary: &Path, out: &Path) {
    let (temporary, out) = (temporary.to_path_buf(), out.display().to_string());
    let handler = super::interrupt::watch(move || {
        let _ = std::fs::remove_file(&temporary);
        report::error(&format!("interrupted; `{out}` was not written"));
        std::process::exit(exit::NOT_CONVERGED.into());
    });
    if let Err(e) = handler {
        report::warning(&format!(
            "interrupting will leave a temporary file behind: {e}"
        ));
    }
}

fn open(path: &Path) -> Result<File, Stop> {
    File::open(path).map_err(|e| match e.kind() {
        io::ErrorKind::NotFound => {
            let near =
                nearest_file(path).map_or(String::new(), |n| format!("; did you mean `{n}`?"));
            let text = format!("there is no file `{}`{near}", path.display());
            Stop(text, exit::SCENE)
        }
        _ => points_fault(path, &PointsError::Io(e)),
    })
}

fn points_fault(path: &Path, error: &PointsError) -> Stop {
    let name = match path.as_os_str() {
        name if name == "-" => "standard input".into(),
        _ => path.display().to_string(),
    };
    match error {
        PointsError::Io(_) => Stop(format!("{name}: {error}"), exit::IO),
        PointsError::Line { .. } => Stop(format!("{name}:{error}"), exit::SCENE),
    }
}

fn summary(args: &ProjectArgs, account: &Account, wall: Duration) {
    let t = &account.tally;
    let n = t.points();
    let each = match n {
        0 => String::new(),
        n => format!(
            ", {:.2} us per point for the projection ({} thread{}), {:.2} us with reading and writing",
            account.projecting.as_secs_f64() * 1e6 / n as f64,
            account.threads,
            if account.threads == 1 { "" } else { "s" },
            wall.as_secs_f64() * 1e6 / n as f64
        ),
    };
    let memory = peak_memory_mb().map_or(String::new(), |m| format!(", peak memory {m:.0} MB"));
    let unit = args.unit.as_ref().map_or("the unit of the CAD file", |u| u);
    report::stderr(&format!(
        "{n} points: {} unique, {} non-unique, {} not converged, {} beyond reach{each}{memory}; lengths in {unit}\n",
        t.unique, t.non_unique, t.not_converged, t.beyond_reach
    ));
}
