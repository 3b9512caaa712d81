//! Scenes: what the user writes, read and checked.
mod types;
mod value;

pub use types::*;
pub use value::Value;
