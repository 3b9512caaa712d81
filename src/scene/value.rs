//! Values that may vary: a number, a table over time, or an expression.
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// A number, `{"table": [[t, v], ...]}` (linear between its rows, constant beyond), or an expression in `t` (and, where
/// the field says so, in the undeformed x, y, z) such as `"0.5*sin(3*t)"`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(untagged)]
pub enum Value {
    Number(f64),
    Table { table: Vec<[f64; 2]> },
    Expression(String),
}

impl Default for Value {
    fn default() -> Self {
        Value::Number(0.0)
    }
}
