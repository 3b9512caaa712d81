//! The report of a study: tables, pictures and sentences, all computed from its [`Record`].
//!
//! [`write()`] makes, in a folder:
//!
//! - `report.html`: one self-contained page, light and dark, readable without scripts;
//! - `study.csv`: a row per run;
//! - a `.svg` file per picture, named by quantity and picture, e.g. `force-error-time.svg`, to be shown elsewhere.

mod axis;
mod bars;
mod csv;
mod figures;
mod fit;
mod front;
mod legend;
mod page;
mod plot;
mod rates;
mod svg;
mod table;
mod view;
pub mod words;

pub use fit::{Rate, rate};
pub use front::pareto;

use super::record::Record;
use crate::output::OutputError;
use crate::output::atomic::{make_folder, remove_file, write_whole};
use std::collections::BTreeSet;
use std::path::Path;
use view::View;

/// Writes the report of a study into the folder `out`, which is made where it is missing. Every file is written whole or
/// not at all; the page comes last, so that what it refers to is there. Pictures that an earlier page there refers to and
/// this one does not have are removed.
///
/// # Errors
/// [`OutputError`] where the folder cannot be made or a file cannot be written.
pub fn write(record: &Record, out: &Path) -> Result<(), OutputError> {
    let view = View::new(record);
    let figures = figures::all(&view);
    make_folder(out)?;
    let page = out.join("report.html");
    let earlier = std::fs::read_to_string(&page).unwrap_or_default();
    for figure in &figures {
        let path = out.join(format!("{}.svg", figure.file));
        write_whole(&path, figure.svg.standalone().as_bytes())?;
    }
    write_whole(&out.join("study.csv"), csv::table(&view).as_bytes())?;
    write_whole(&page, page::html(&view, &figures).as_bytes())?;
    for name in pictures(&earlier) {
        if figures.iter().all(|f| f.file != name) {
            remove_file(&out.join(format!("{name}.svg")))?;
        }
    }
    Ok(())
}

/// The pictures that a page refers to, without `.svg`: files in its own folder only.
fn pictures(page: &str) -> BTreeSet<&str> {
    let links = page.split("<a href=\"").skip(1);
    let named = links.filter_map(|rest| rest.split_once('"')?.0.strip_suffix(".svg"));
    let own = |name: &&str| {
        let plain = |c: char| c.is_alphanumeric() || "-_.".contains(c);
        !name.is_empty() && name.chars().all(plain)
    };
    named.filter(own).collect()
}
