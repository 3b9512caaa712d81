//! `covact project`.
mod points;
mod rows;

use super::{ProjectArgs, exit, inspect, report};
use crate::output::atomic::AtomicFile;
use crate::output::{OutputError, peak_memory_mb};
use crate::scene::{nearest, nearest_file};
use covact_geometry::io::{CadFile, LengthUnit, read_path};
use covact_geometry::{Foot, PatchSet, Vec3};
use points::{Points, PointsError};
use rayon::prelude::*;
use rows::{HEADER, Tally, rows};
use std::fs::File;
use std::io::{self, BufReader, Write};
use std::path::Path;
use std::time::{Duration, Instant};

/// Points in memory at a time.
const BLOCK: usize = 1 << 14;
/// Points that one thread projects in a row.
const CHUNK: usize = 256;
/// Surfaces that are named one by one when they were not read.
const NAMED: usize = 20;

/// Why the command ends early: what to say and the exit code.
struct Stop(String, u8);

impl From<OutputError> for Stop {
    fn from(e: OutputError) -> Self {
        Stop(e.to_string(), exit::IO)
    }
}

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
    /// Time spent in projections, of all threads together.
    projecting: Duration,
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
    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(args.threads)
        .build()
        .map_err(|e| Stop(format!("cannot start the threads: {e}"), exit::IO))?;
    let file = cad(args)?;
    let entities: Vec<u32> = file.patches.iter().map(|p| p.entity).collect();
    let patches = file.patches.into_iter().map(|p| p.patch).collect();
    let set = PatchSet::new(patches, None)
        .map_err(|e| Stop(format!("{}: {e}", file.path), exit::SCENE))?;

    let mut points: Points<Box<dyn io::BufRead>> = Points::new(match args.points.as_os_str() {
        name if name == "-" => Box::new(io::stdin().lock()),
        _ => Box::new(BufReader::with_capacity(1 << 16, open(&args.points)?)),
    });
    let mut target = match args.out.as_os_str() {
        name if name == "-" => Target::Stdout(io::stdout()),
        _ => Target::File(AtomicFile::create(&args.out)?),
    };
    let mut account = Account::default();
    if !args.json && !target.write(HEADER)? {
        return Ok(account);
    }
    let mut block = Vec::with_capacity(BLOCK);
    loop {
        points
            .read(&mut block, BLOCK)
            .map_err(|e| points_fault(&args.points, &e))?;
        if block.is_empty() {
            break;
        }
        let reach = args.reach.unwrap_or(f64::INFINITY);
        let chunk = |chunk: &[Vec3]| {
            let start = Instant::now();
            let feet: Vec<Option<Foot>> =
                chunk.iter().map(|q| set.project(q, None, reach)).collect();
            let time = start.elapsed();
            rows(&feet, &entities, args.json).map(|(text, tally)| (text, tally, time))
        };
        let done: Vec<_> = pool.install(|| block.par_chunks(CHUNK).map(chunk).collect());
        for part in done {
            let (text, tally, time) =
                part.map_err(|e| Stop(format!("cannot write a row as JSON: {e}"), exit::BUG))?;
            account.tally.add(&tally);
            account.projecting += time;
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

/// Reads the CAD file in the unit asked for and tells what it does not give.
fn cad(args: &ProjectArgs) -> Result<CadFile, Stop> {
    let unit = match &args.unit {
        None => None,
        Some(name) => Some(LengthUnit::from_name(name).ok_or_else(|| {
            let known = LengthUnit::names();
            let near =
                nearest(name, known).map_or(String::new(), |n| format!("; did you mean `{n}`?"));
            let text = format!(
                "--unit: expected one of {}, found `{name}`{near}",
                known.join(", ")
            );
            Stop(text, exit::USAGE)
        })?),
    };
    let mut file = read_path(&args.file).map_err(|e| {
        let (text, code) = inspect::fault(&args.file, &e);
        Stop(text, code)
    })?;
    for s in file.skipped.iter().take(NAMED) {
        report::warning(&format!(
            "{}: entity {}, {}, is left out: {}",
            file.path, s.entity, s.name, s.reason
        ));
    }
    if let more @ 1.. = file.skipped.len().saturating_sub(NAMED) {
        report::warning(&format!(
            "{}: {more} more surfaces are left out; `covact inspect` names them",
            file.path
        ));
    }
    if file.patches.is_empty() {
        let text = format!("{}: expected at least one surface, found none", file.path);
        return Err(Stop(text, exit::SCENE));
    }
    if let Some(unit) = unit {
        if file.unit.to_metre.is_none() {
            report::warning(&format!(
                "{} states no length unit; its numbers are taken as {}",
                file.path, unit.name
            ));
        } else {
            file.convert_to(&unit)
                .map_err(|e| Stop(e.to_string(), exit::SCENE))?;
        }
    }
    Ok(file)
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
            ", {:.2} us per projection and thread, {:.2} us per point in all",
            account.projecting.as_secs_f64() * 1e6 / n as f64,
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
