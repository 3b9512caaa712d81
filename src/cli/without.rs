//! `covact run --without`: what an effect changes, beside the full run.
use super::{RunArgs, exit, print, report};
use crate::model::build;
use crate::output::{Compared, Comparison, Cost, RunStatus, Summary, compare};
use crate::plan::Plan;
use crate::plan::without::{REMOVABLE, Removable, WithoutError};
use crate::run;
use crate::scene::{self, LoadedScene};
use serde::Serialize;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::atomic::{AtomicBool, Ordering};

/// The scene without an effect, or the exit code of what stands against it.
pub(super) fn scene_without(
    loaded: &LoadedScene,
    name: &str,
    json: bool,
) -> Result<LoadedScene, u8> {
    let removed = |removable: &Removable| -> Result<scene::Scene, u8> {
        let model = build::build(loaded).map_err(|e| {
            let text = format!("without {name}: {e}");
            let problem = loaded.problem(&e.pointer, text, e.help.clone());
            report::scene_error(&loaded.error(vec![problem]), json)
        })?;
        let plan = Plan::new(loaded, &model);
        removable.remove(&loaded.scene, &plan).map_err(refused)
    };
    let removable = Removable::named(name).map_err(refused)?;
    let mut changed = loaded.clone();
    changed.scene = removed(removable)?;
    let mut problems = scene::check(&changed);
    for problem in &mut problems {
        problem.message = format!("without {name}: {}", problem.message);
    }
    match problems.is_empty() {
        true => Ok(changed),
        false => Err(report::scene_error(&changed.error(problems), json)),
    }
}

fn refused(error: WithoutError) -> u8 {
    report::error(&error.to_string());
    exit::USAGE
}

/// Whether every effect can be turned off, before anything is run; else an exit code.
pub(super) fn check_names(loaded: &LoadedScene, args: &RunArgs) -> Result<(), u8> {
    for name in names(args) {
        scene_without(loaded, name, args.json)?;
    }
    Ok(())
}

/// Whether every what-if can write to its folder, before anything is run; else an exit code.
pub(super) fn check_folders(loaded: &LoadedScene, args: &RunArgs) -> Result<(), u8> {
    for name in names(args) {
        let out = folder(&args.out, name);
        if args.force || goes_on(args, &out) {
            continue;
        }
        run::vacant(&out).map_err(|e| report::run_error(&e.into(), loaded, args.json))?;
    }
    Ok(())
}

/// Whether a what-if continues what is in its folder: the full run may have been interrupted before it began.
fn goes_on(args: &RunArgs, out: &Path) -> bool {
    args.resume && out.join("history.csv").exists()
}

/// The effects to turn off by their own names, each once; names of none stay, to be told.
fn names(args: &RunArgs) -> Vec<&str> {
    let mut out = Vec::new();
    for name in &args.without {
        let name = Removable::named(name).map_or(name.as_str(), |r| r.name);
        if !out.contains(&name) {
            out.push(name);
        }
    }
    out
}

/// Folder of a what-if.
fn folder(out: &Path, name: &str) -> PathBuf {
    out.join(format!("without_{name}"))
}

/// Runs the scene without each of the effects, after the full run has ended with exit code `full`, and prints the
/// comparisons. Returns the full run's code, or that of the first what-if that was not fine.
///
/// A what-if is a process of its own, so that its time and its memory are its own.
pub(super) fn what_ifs(
    scene: &LoadedScene,
    args: &RunArgs,
    full: u8,
    interrupt: &AtomicBool,
) -> u8 {
    let mut code = full;
    for name in names(args) {
        if interrupt.load(Ordering::Relaxed) {
            break;
        }
        let out = folder(&args.out, name);
        if !args.json && !args.quiet {
            report::stderr(&format!("\nwithout {name}: into {}\n", out.display()));
        }
        let own = match run_without(args, name, &out) {
            Ok(own) => own,
            Err(e) => {
                report::error(&format!("cannot run the scene without {name}: {e}"));
                exit::IO
            }
        };
        if own != 0 {
            report::error(&format!(
                "without {name}: exit code {own} (the full run: {full})"
            ));
        }
        code = if code == 0 { own } else { code };
        // What cannot be compared has told why.
        if own != 0 && own != exit::NOT_CONVERGED {
            continue;
        }
        let surfaces: Vec<&str> = scene.scene.surfaces.keys().map(String::as_str).collect();
        let told = match compare([&args.out, &out], &surfaces) {
            Ok(found) => tell(&found, name, &left(&out, name), [full, own], args),
            Err(e) => {
                report::error(&e.to_string());
                exit::IO
            }
        };
        code = if code == 0 { told } else { code };
    }
    code
}

fn run_without(args: &RunArgs, name: &str, out: &Path) -> std::io::Result<u8> {
    let mut command = Command::new(super::program()?);
    command.arg("run").arg(&args.scene).arg("-o").arg(out);
    command.args(["--off", name]);
    command.arg("--threads").arg(args.threads.to_string());
    for (flag, on) in [
        ("--json", args.json),
        ("--quiet", args.quiet),
        ("--resume", goes_on(args, out)),
        ("--force", args.force),
        ("--no-report", args.no_report),
    ] {
        if on {
            command.arg(flag);
        }
    }
    let status = command.status()?;
    Ok(status.code().map_or(exit::BUG, |c| c as u8))
}

/// A comparison as one JSON object.
#[derive(Serialize)]
struct Told<'a> {
    event: &'static str,
    without: &'a str,
    /// Exit codes of both runs.
    exit_codes: [u8; 2],
    /// What still has the effect, in words.
    left: &'a [String],
    #[serde(flatten)]
    comparison: &'a Comparison,
}

/// What still had the effect in a run without it, in words: contacts whose other keys it goes with.
fn left(out: &Path, name: &str) -> Vec<String> {
    let (Ok(removable), Ok(summary)) = (
        Removable::named(name),
        Summary::read(&out.join("summary.json")),
    ) else {
        return Vec::new();
    };
    let mut told = Vec::new();
    for pair in summary.plan.iter().flat_map(|p| &p.pairs) {
        for effect in pair.effects.iter().filter(|e| removable.has(&e.name)) {
            let text = format!("contact `{}`, {}: {}", pair.name, effect.name, effect.why);
            if !told.contains(&text) {
                told.push(text);
            }
        }
    }
    told
}

fn tell(
    found: &Comparison,
    name: &str,
    left: &[String],
    exit_codes: [u8; 2],
    args: &RunArgs,
) -> u8 {
    if args.json {
        let told = Told {
            event: "comparison",
            without: name,
            exit_codes,
            left,
            comparison: found,
        };
        return match serde_json::to_string(&told) {
            Ok(line) => print(&(line + "\n")),
            Err(e) => {
                report::error(&format!("cannot write the comparison as JSON: {e}"));
                exit::BUG
            }
        };
    }
    print(&table(found, name, left))
}

/// A number as it is told, of six digits.
fn short(value: Option<f64>) -> String {
    match value {
        None => "-".to_owned(),
        Some(0.0) => "0".to_owned(),
        Some(v) if (1e-3..1e6).contains(&v.abs()) => {
            let digits = 5 - v.abs().log10().floor() as i32;
            let text = format!("{v:.*}", digits.max(0) as usize);
            match text.contains('.') {
                true => text.trim_end_matches('0').trim_end_matches('.').to_owned(),
                false => text,
            }
        }
        Some(v) => format!("{v:.5e}"),
    }
}

/// A relative difference in percent.
fn percent(change: Option<f64>) -> String {
    match change.map(|c| 100.0 * c) {
        None => String::new(),
        Some(0.0) => "same".to_owned(),
        Some(p) if p.abs() < 0.01 => format!("{p:+.0e} %"),
        Some(p) if p.abs() < 100.0 => format!("{p:+.2} %"),
        Some(p) => format!("{p:+.0} %"),
    }
}

fn table(found: &Comparison, name: &str, left: &[String]) -> String {
    let instead = Removable::named(name).map_or("", |r| r.instead);
    let without = format!("without {name}");
    let titles = ["", "end, full", &without, "", "peak, full", &without, ""];
    let mut rows = vec![titles.map(str::to_owned)];
    for column in &found.columns {
        let Compared {
            name, end, peak, ..
        } = column;
        rows.push([
            name.clone(),
            short(end[0]),
            short(end[1]),
            percent(column.change()),
            short(peak[0]),
            short(peak[1]),
            percent(column.peak_change()),
        ]);
    }
    let mut out =
        format!("\nwithout {name}: {instead}; values at the end, and those of largest magnitude\n");
    for text in left {
        out += &format!("left as it is: {text}\n");
    }
    lines(&mut out, &rows);
    out.push('\n');
    lines(&mut out, &costs(&found.cost, name));
    out
}

/// What both runs cost.
fn costs([full, other]: &[Cost; 2], name: &str) -> Vec<[String; 4]> {
    let numbers = |what: &str, of: [Option<f64>; 2]| {
        let change = of[0].zip(of[1]).map(|(a, b)| (b - a) / a);
        let change = change.filter(|c| c.is_finite());
        let [a, b] = of.map(short);
        [what.to_owned(), a, b, percent(change)]
    };
    let words = |what: &str, of: [String; 2]| {
        let [a, b] = of;
        [what.to_owned(), a, b, String::new()]
    };
    let both = |of: fn(&Cost) -> Option<f64>| [of(full), of(other)];
    let kinds = |cost: &Cost| {
        let kinds = cost.factorizations.iter().map(|(k, n)| format!("{k} {n}"));
        kinds.collect::<Vec<_>>().join(", ")
    };
    vec![
        words("", ["full".to_owned(), format!("without {name}")]),
        words(
            "ended",
            [full.status, other.status].map(|s: RunStatus| s.name().replace('_', " ")),
        ),
        numbers("time reached", both(|c| Some(c.time))),
        numbers("wall seconds", both(|c| Some(c.wall_s))),
        numbers("CPU seconds", both(|c| c.cpu_s)),
        numbers("steps", both(|c| Some(f64::from(c.steps)))),
        numbers("iterations", both(|c| Some(c.iterations as f64))),
        words("factorizations", [kinds(full), kinds(other)]),
        numbers("peak memory (MB)", both(|c| c.peak_memory_mb)),
        numbers("dofs", both(|c| Some(c.dofs as f64))),
    ]
}

/// Rows with columns as wide as what stands in them: names to the left, numbers to the right.
fn lines<const N: usize>(out: &mut String, rows: &[[String; N]]) {
    let mut widths = [0; N];
    for row in rows {
        for (width, cell) in widths.iter_mut().zip(row) {
            *width = cell.chars().count().max(*width);
        }
    }
    for row in rows {
        let mut line = String::new();
        for (k, (cell, width)) in row.iter().zip(widths).enumerate() {
            line += "  ";
            line += &match k {
                0 => format!("{cell:<width$}"),
                _ => format!("{cell:>width$}"),
            };
        }
        *out += line.trim_end();
        out.push('\n');
    }
}

/// What the program's help says of the option.
pub(super) fn help() -> String {
    let names: Vec<&str> = REMOVABLE.iter().map(|r| r.name).collect();
    format!(
        "Turn an effect off for a what-if, and compare: the scene runs as it is into FOLDER, then without the effect into \
         FOLDER/without_EFFECT. May be given several times. Effects: {}",
        names.join(", ")
    )
}
