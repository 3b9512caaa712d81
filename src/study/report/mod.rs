//! The report of a study: tables, pictures and sentences, all computed from its [`Record`].
//!
//! [`write`] makes, in a folder:
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
mod markup;
mod number;
mod page;
mod plot;
mod rates;
mod style;
mod svg;
mod table;
mod view;
pub mod words;

pub use fit::{Rate, rate};
pub use front::pareto;

use super::record::Record;
use crate::output::OutputError;
use crate::output::atomic::{make_folder, write_whole};
use std::path::Path;
use view::View;

/// Writes the report of a study into the folder `out`, which is made where it is missing. Every file is written whole or
/// not at all; the page comes last, so that what it refers to is there.
///
/// # Errors
/// [`OutputError`] where the folder cannot be made or a file cannot be written.
pub fn write(record: &Record, out: &Path) -> Result<(), OutputError> {
    let view = View::new(record);
    let figures = figures::all(&view);
    make_folder(out)?;
    for figure in &figures {
        let path = out.join(format!("{}.svg", figure.file));
        write_whole(&path, figure.svg.standalone().as_bytes())?;
    }
    write_whole(&out.join("study.csv"), csv::table(&view).as_bytes())?;
    write_whole(
        &out.join("report.html"),
        page::html(&view, &figures).as_bytes(),
    )
}
