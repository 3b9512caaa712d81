//! Scenes: what the user writes, read and checked.
//!
//! [`load`] reads a file into a [`LoadedScene`]; [`check()`] finds everything that is wrong without a mesh or CAD file
//! being read. Both say where in the file.
mod builder;
mod check;
mod decode;
mod document;
mod expression;
mod json;
mod load;
mod problem;
mod schema;
mod stages;
mod types;
mod value;

pub use builder::SceneBuilder;
pub(crate) use check::Checker;
pub use check::check;
pub use document::{Document, pointer};
pub(crate) use document::{Form, load as load_document, nearest_file, parse as parse_document};
pub use expression::{Expression, ExpressionError};
pub use load::{FORMAT, LoadedScene, load, parse};
pub use problem::{Place, Problem, SceneError, nearest};
pub(crate) use problem::{shorten, suggestion};
pub(crate) use schema::printed as printed_schema;
pub use schema::schema;
pub use types::*;
pub use value::{EvalError, POSITION_AND_TIME, TIME, TimeFunction, Value, ValueError};
