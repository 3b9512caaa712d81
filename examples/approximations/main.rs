//! Error against degrees of freedom for linear and quadratic shells on faceted, smooth and exact masters.
//!
//! ```sh
//! cargo run --release --example approximations -- OUT [INTERVALS]
//! ```
//!
//! The problem is the clamped plate under a rigid ball of the scene `ball_on_plate`, the error is
//! the mean of those of the force at four depths. `INTERVALS` (default 32) bounds the fineness of the meshes.
//! Master facets become finer together with the shell. `OUT` gets `runs.csv` (one row
//! per finished run; a run that is in it is not done again, so an interrupted command goes on where it stopped),
//! `approximations.csv` with the errors, `approximations.svg` and `approximations.md`, its caption. Runs that fail are
//! named, and the exit code is then 4.
mod cases;
mod errors;
mod plot;
mod record;

use cases::{Case, cases};
use record::{Record, Runs};
use std::error::Error;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::sync::atomic::AtomicBool;

type Outcome<T> = Result<T, Box<dyn Error>>;

fn main() -> ExitCode {
    let Some(out) = std::env::args_os().nth(1).map(PathBuf::from) else {
        eprintln!("usage: cargo run --release --example approximations -- OUT [INTERVALS]");
        return ExitCode::from(2);
    };
    let finest = match std::env::args().nth(2).map(|n| n.parse()) {
        None => u32::MAX,
        Some(Ok(n)) => n,
        Some(Err(e)) => {
            eprintln!("INTERVALS: {e}");
            return ExitCode::from(2);
        }
    };
    match study(&out, finest) {
        Ok(failed) if failed.is_empty() => ExitCode::SUCCESS,
        Ok(failed) => {
            eprintln!("{} run(s) failed:", failed.len());
            for line in failed {
                eprintln!("  {line}");
            }
            ExitCode::from(4)
        }
        Err(e) => {
            eprintln!("error: {e}");
            ExitCode::from(5)
        }
    }
}

/// Does all runs that are missing, then evaluates and draws them; the names of those that failed, with the reason.
fn study(out: &Path, finest: u32) -> Outcome<Vec<String>> {
    std::fs::create_dir_all(out)?;
    let mut runs = Runs::open(&out.join("runs.csv"))?;
    let mut failed = Vec::new();
    let all: Vec<Case> = (cases().into_iter())
        .filter(|c| c.intervals <= finest)
        .collect();
    for (number, case) in all.iter().enumerate() {
        if runs.find(case).is_some() {
            continue;
        }
        match solve(case) {
            Ok(record) => {
                println!(
                    "{:>2} of {}  {:<24} {:>6} unknowns  {:>9.3} N  {:>3} iterations  {:>6.1} s",
                    number + 1,
                    all.len(),
                    case.name(),
                    record.dofs,
                    record.forces[3],
                    record.iterations,
                    record.seconds
                );
                runs.add(record)?;
            }
            Err(e) => failed.push(format!("{}: {e}", case.name())),
        }
    }
    let errors = errors::Errors::new(&runs.records);
    std::fs::write(out.join("approximations.csv"), errors.table())?;
    plot::draw(&errors, &out.join("approximations.svg"))?;
    std::fs::write(out.join("approximations.md"), errors.caption())?;
    println!("{}", errors.caption());
    Ok(failed)
}

/// Runs one case in a folder that is removed afterwards.
fn solve(case: &Case) -> Outcome<Record> {
    let text = serde_json::to_string_pretty(&case.scene())?;
    let loaded = covact::scene::parse(&text, &case.name())?;
    if let Some(problem) = covact::scene::check(&loaded).first() {
        return Err(problem.message.clone().into());
    }
    let folder = tempfile::tempdir()?;
    let options = covact::run::RunOptions::default();
    let never = AtomicBool::new(false);
    let mut silent = Silent;
    let summary = covact::run::run(&loaded, folder.path(), &options, &mut silent, &never)?;
    if summary.status.name() != "done" {
        let reason = summary.reason.unwrap_or_default();
        return Err(format!("{} {reason}", summary.status.name()).into());
    }
    let history = covact::output::read_csv(&folder.path().join("history.csv"))?;
    let (times, force) = (history.column("time"), history.column("force.ball.z"));
    let (times, force) = times
        .zip(force)
        .ok_or("no force of the ball in the history")?;
    let mut forces = [0.0; 4];
    for (k, f) in forces.iter_mut().enumerate() {
        let time = 0.25 * (k + 1) as f64;
        let row = times.iter().position(|t| (t - time).abs() < 1e-9);
        // Of the whole plate, four quarters.
        *f = -4.0 * force[row.ok_or_else(|| format!("no step ends at {time}"))?];
    }
    Ok(Record {
        case: *case,
        dofs: summary.dofs,
        forces,
        iterations: summary.newton_iterations,
        seconds: summary.wall_s,
    })
}

/// Events of a run are not shown.
struct Silent;

impl covact::solve::event::Observer for Silent {
    fn event(&mut self, _event: &covact::solve::event::Event) {}
}
