//! Results on disk: fields for ParaView, the history table, the summary.
//!
//! Every file is written whole or not at all ([`atomic`]); the history grows by whole lines. [`Results`] writes a folder:
//!
//! - `results.pvd` lists a `.vtu` file per accepted step for each body ([`BodyFields`]) and each rigid surface
//!   ([`SurfaceOutput`]), and on demand for the slave points of each contact with friction ([`PointCloud`]);
//!   `results_tessellated.pvd` is the same with rigid surfaces as flat quadrilaterals;
//! - `history.csv` has one line per accepted step ([`History`], its columns are documented in [`COLUMNS`]);
//! - `summary.json` says how the run went and what it cost ([`Summary`]).
//!
//! Points of a body stay at their undeformed positions and carry the displacement, so ParaView's "Warp By Vector"
//! deforms them. A rigid surface is written where it is. ParaView draws curved cells as flat ones unless "Nonlinear
//! Subdivision Level" is raised.

mod accuracy;
mod appended;
pub mod atomic;
mod bezier;
mod body;
mod chords;
mod cloud;
mod columns;
mod compare;
mod error;
mod history;
mod lock;
mod mid_surface;
mod packed;
mod planned;
pub(crate) mod read;
mod results;
pub(crate) mod sum;
mod summary;
mod surface;
mod template;
mod trimmed;
mod vtu;

pub use accuracy::{Accuracy, ContactAccuracy};
pub use appended::inlined;
pub use bezier::{BezierError, MAX_DEGREE, SurfacePiece};
pub use body::{
    BodyFields, CLOSED, ContactFields, NOT_A_SLAVE, OPEN, SLIP, STRESS_COMPONENTS, von_mises,
};
pub use cloud::PointCloud;
pub use columns::{COLUMNS, ColumnDoc, column_table, documented};
pub use compare::{Compared, Comparison, Cost, compare};
pub use error::OutputError;
pub use history::{History, HistoryMark, Table, read_csv};
pub use lock::{FolderLock, Holder, LOCK_FILE, Locking};
pub use mid_surface::MidSurface;
pub use planned::{EffectSummary, PairSummary, PlanSummary};
pub(crate) use results::{COLLECTIONS, listed};
pub use results::{PartNames, Results, SurfaceState, file_stem};
/// Name of the file in the folder of the results that tells of every iteration.
pub const RUN_LOG: &str = "run.log";

pub use summary::{
    GivenUp, ProbeSummary, RunStatus, SUMMARY_FORMAT, StageSummary, Summary, Versions,
};
pub use surface::{SurfaceOutput, Tessellation, flat_bytes};
pub(crate) use vtu::escaped;
pub use vtu::{Field, Place, Precision};
