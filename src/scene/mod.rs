//! Scenes: what the user writes, read and checked.
//!
//! [`load`] reads a file into a [`LoadedScene`]; [`check()`] finds everything that is wrong without a mesh or CAD file
//! being read. Both say where in the file.
mod check;
mod decode;
mod expression;
mod json;
mod load;
mod problem;
mod schema;
mod types;
mod value;

pub use check::check;
pub use expression::{Expression, ExpressionError};
#[cfg(feature = "cli")]
pub(crate) use load::nearest_file;
pub use load::{FORMAT, LoadedScene, load, parse, pointer};
pub use problem::{Place, Problem, SceneError, nearest};
pub use schema::schema;
pub use types::*;
pub use value::{EvalError, POSITION_AND_TIME, TIME, TimeFunction, Value, ValueError};
