//! The page of a run: bodies and tools in 3-D over time, curves, warnings, the plan and the accuracy of forces, in one
//! file that needs no network.
//!
//! [`write()`] makes `report.html` of what a run left in its folder, [`write_beside`] a page with two runs. The numbers
//! stand in the page packed (`pack.rs`); `web/` has its scripts, shaders and rules.

mod html;
pub(crate) mod markup;
pub(crate) mod number;
mod pack;
mod places;
mod shapes;
mod skin;
pub(crate) mod style;
mod table;
mod tool;

pub(crate) use html::head;

use crate::output::atomic::{Replaceable, replaceable, write_whole};
use crate::output::{OutputError, Summary, compare, read_csv};
use html::Run;
use pack::Pack;
use shapes::Budget;
use std::fs::File;
use std::io::{self, Read};
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

/// Name of the page in the folder of a run.
pub const REPORT: &str = "report.html";
/// Bytes of packed numbers in a page, which has 4 letters for 3 of them: the page stays below 3 MB.
const BYTES: usize = 2_000_000;
/// Time that reading steps may take at least, and as a part of the run's.
const SECONDS: f64 = 0.2;
const SHARE: f64 = 0.03;

/// Why a page could not be made.
#[derive(Debug, thiserror::Error)]
pub enum PageError {
    /// The folder has no results of a run, or something cannot be read or written.
    #[error(transparent)]
    Output(#[from] OutputError),
    /// A file of fields is not as the program writes it.
    #[error("{0}")]
    Fields(String),
    /// A file is in the way.
    #[error("`{}` was not written by covact: move it, or choose another name", .0.display())]
    Foreign(PathBuf),
}

/// Makes the page of the run in `folder` and writes it there. Steps beyond what a page holds, or what can be read in 3 % of
/// the time the run took (and .2 s), are left out, and the page says so.
///
/// # Errors
/// [`PageError`].
pub fn write(folder: &Path) -> Result<PathBuf, PageError> {
    let path = folder.join(REPORT);
    vacant(&path)?;
    let mut pack = Pack::default();
    let run = read(folder, &mut pack, 1)?;
    write_whole(&path, html::page(&[run], None, &pack).as_bytes())?;
    Ok(path)
}

/// Makes a page with two runs side by side.
///
/// # Errors
/// [`PageError`].
pub fn write_beside(folders: [&Path; 2], path: &Path) -> Result<(), PageError> {
    vacant(path)?;
    let mut pack = Pack::default();
    let first = read(folders[0], &mut pack, 2)?;
    let second = read(folders[1], &mut pack, 2)?;
    let surfaces: Vec<&str> = (first.surfaces.iter().chain(&second.surfaces))
        .map(String::as_str)
        .collect();
    let comparison = compare(folders, &surfaces)?;
    let page = html::page(&[first, second], Some(&comparison), &pack);
    write_whole(path, page.as_bytes())?;
    Ok(())
}

/// Whether a page may be written to `path`: nothing is there, or a page of this program.
fn vacant(path: &Path) -> Result<(), PageError> {
    match replaceable(path)? {
        Replaceable::File => match is_page(path) {
            Ok(true) => Ok(()),
            Ok(false) => Err(PageError::Foreign(path.to_path_buf())),
            Err(e) => Err(OutputError::io("read", path, e).into()),
        },
        _ => Ok(()),
    }
}

/// Whether a file is a page of this program.
///
/// # Errors
/// The operating system's.
pub fn is_page(path: &Path) -> io::Result<bool> {
    let mut start = Vec::new();
    let head = File::open(path)?.take(html::START.len() as u64);
    { head }.read_to_end(&mut start)?;
    Ok(start == html::START.as_bytes())
}

/// Reads a run, one of so many in the page.
fn read(folder: &Path, pack: &mut Pack, runs: u32) -> Result<Run, PageError> {
    let begun = Instant::now();
    let summary = Summary::read(&folder.join("summary.json"))?;
    let history = read_csv(&folder.join("history.csv"))?;
    let table = pack.add(table::text(&history).as_bytes());
    let seconds = SECONDS.max(SHARE * summary.wall_s.clamp(0.0, 1e6)) / f64::from(runs);
    let budget = Budget {
        bytes: pack.bytes.len() + (BYTES - pack.bytes.len().min(BYTES)) / runs as usize,
        until: begun + Duration::from_secs_f64(seconds),
    };
    let shapes = shapes::read(folder, pack, budget).map_err(PageError::Fields)?;
    let named = |column: &String| {
        let name = column.strip_prefix("force.")?.strip_suffix(".x")?;
        Some(name.to_owned())
    };
    Ok(Run {
        name: html::name(folder),
        surfaces: history.columns.iter().filter_map(named).collect(),
        summary,
        shapes,
        table,
    })
}
