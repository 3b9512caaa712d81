//! Values that may vary: a number, a table over time, or an expression.
use super::expression::{Expression, ExpressionError};
use super::problem::shorten;
use covact_geometry::Vec3;
use schemars::JsonSchema;
use serde::de::{self, Deserializer, MapAccess, Visitor};
use serde::{Deserialize, Serialize};
use std::fmt;

/// A number, `{"table": [[t, v], ...]}` (linear between its rows, constant beyond), or an expression in `t` (and, where
/// the field says so, in the undeformed x, y, z) such as `"0.5*sin(3*t)"`. Expressions know `+ - * / ^`, parentheses,
/// `pi`, `e` and the functions abs, acos, asin, atan, atan2, cbrt, ceil, cos, cosh, exp, floor, hypot, ln, log10, max,
/// min, mod, round, sign, sin, sinh, sqrt, tan, tanh.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
#[serde(untagged)]
#[schemars(deny_unknown_fields)]
pub enum Value {
    /// A constant.
    Number(f64),
    /// Linear between its rows, constant beyond.
    Table {
        /// Rows of a time and a value; times increase.
        table: Vec<[f64; 2]>,
    },
    /// An expression in `t`, and in x, y, z where the field says so.
    Expression(String),
}

impl Default for Value {
    fn default() -> Self {
        Value::Number(0.0)
    }
}

// serde's own reading of untagged enums tries the variants in turn and forgets what was wrong with each, and where.
impl<'de> Deserialize<'de> for Value {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Value, D::Error> {
        deserializer.deserialize_any(ValueVisitor)
    }
}

struct ValueVisitor;

#[derive(Deserialize)]
#[serde(field_identifier, rename_all = "snake_case")]
enum Key {
    Table,
}

impl<'de> Visitor<'de> for ValueVisitor {
    type Value = Value;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(
            "a number, `{\"table\": [[t, value], ...]}` or an expression between double quotes",
        )
    }
    fn visit_f64<E: de::Error>(self, number: f64) -> Result<Value, E> {
        Ok(Value::Number(number))
    }
    fn visit_i64<E: de::Error>(self, number: i64) -> Result<Value, E> {
        Ok(Value::Number(number as f64))
    }
    fn visit_u64<E: de::Error>(self, number: u64) -> Result<Value, E> {
        Ok(Value::Number(number as f64))
    }
    fn visit_str<E: de::Error>(self, text: &str) -> Result<Value, E> {
        Ok(Value::Expression(text.to_string()))
    }
    fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<Value, A::Error> {
        let mut table = None;
        while let Some(Key::Table) = map.next_key()? {
            table = Some(map.next_value()?);
        }
        table
            .map(|table| Value::Table { table })
            .ok_or_else(|| de::Error::missing_field("table"))
    }
}

/// Why a [`Value`] cannot be used.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum ValueError {
    /// A constant is infinite or not a number.
    #[error("the number {0} is not finite")]
    Number(f64),
    /// A table has no rows.
    #[error("the table has no rows")]
    EmptyTable,
    /// Row counted from 0.
    #[error("times of a table must increase: row {} has t = {time} after t = {before}", .row + 1)]
    Order {
        /// The later row, from 0.
        row: usize,
        /// Its time.
        time: f64,
        /// The time of the row before.
        before: f64,
    },
    /// A time or a value of a table is infinite or not a number.
    #[error("row {} of the table is not finite", .row + 1)]
    Row {
        /// The row, from 0.
        row: usize,
    },
    /// An expression does not follow the rules of expressions.
    #[error("{0}")]
    Expression(#[from] ExpressionError),
    /// An expression without variables that is infinite or no number.
    #[error("the expression `{}` is {value}", shorten(.expression))]
    NotFinite {
        /// The expression.
        expression: String,
        /// What it gives.
        value: f64,
    },
    /// A function of time has no value at some time.
    #[error(transparent)]
    Eval(#[from] EvalError),
    /// Something that must not be negative becomes so.
    #[error("{what} is {value} at t = {time}, where it must not be negative")]
    Negative {
        /// What it is, in words.
        what: &'static str,
        /// Its value.
        value: f64,
        /// The time of that value.
        time: f64,
    },
    /// A vector that gives a direction is zero.
    #[error("{what} has no length")]
    NoLength {
        /// What it is, in words.
        what: &'static str,
    },
}

/// A [`TimeFunction`] gave something infinite or no number.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error("`{}` is {value} at t = {time}{}", shorten(.expression), position(.x))]
pub struct EvalError {
    /// The expression, or the table in words.
    pub expression: String,
    /// What it gives.
    pub value: f64,
    /// The time.
    pub time: f64,
    /// Where, for functions of position.
    pub x: Option<[f64; 3]>,
}

fn position(x: &Option<[f64; 3]>) -> String {
    x.map_or(String::new(), |x| {
        format!(", x = {}, y = {}, z = {}", x[0], x[1], x[2])
    })
}

/// Variables of functions of position and time.
pub const POSITION_AND_TIME: [&str; 4] = ["x", "y", "z", "t"];
/// Variables of functions of time.
pub const TIME: [&str; 1] = ["t"];

/// A compiled [`Value`]: a function of time and perhaps of the undeformed position.
#[derive(Debug, Clone)]
pub struct TimeFunction {
    form: Form,
}

#[derive(Debug, Clone)]
enum Form {
    Constant(f64),
    Table(Vec<[f64; 2]>),
    // Variables are always numbered as in POSITION_AND_TIME.
    Expression { text: String, program: Expression },
}

impl Value {
    /// Checks the value and makes it quick to evaluate. `variables` is [`TIME`] or [`POSITION_AND_TIME`] (any part of
    /// the latter may be allowed).
    ///
    /// # Errors
    /// [`ValueError`]: an expression that does not parse or names other variables, a table whose times do not
    /// increase, numbers that are not finite.
    pub fn compile(&self, variables: &[&str]) -> Result<TimeFunction, ValueError> {
        let form = match self {
            Value::Number(x) if !x.is_finite() => return Err(ValueError::Number(*x)),
            Value::Number(x) => Form::Constant(*x),
            Value::Table { table } => {
                check_table(table)?;
                match table.as_slice() {
                    [[_, value]] => Form::Constant(*value),
                    rows => Form::Table(rows.to_vec()),
                }
            }
            Value::Expression(text) => {
                // Compiled twice so that a forbidden variable is reported with the allowed ones.
                Expression::compile(text, variables)?;
                let program = Expression::compile(text, &POSITION_AND_TIME)?;
                if (0..4).any(|k| program.uses(k)) {
                    Form::Expression {
                        text: text.clone(),
                        program,
                    }
                } else {
                    let value = program.eval(&[]);
                    if !value.is_finite() {
                        let expression = text.clone();
                        return Err(ValueError::NotFinite { expression, value });
                    }
                    Form::Constant(value)
                }
            }
        };
        Ok(TimeFunction { form })
    }
}

fn check_table(table: &[[f64; 2]]) -> Result<(), ValueError> {
    if table.is_empty() {
        return Err(ValueError::EmptyTable);
    }
    if let Some(row) = table.iter().position(|r| !r.iter().all(|x| x.is_finite())) {
        return Err(ValueError::Row { row });
    }
    match table.windows(2).position(|w| w[1][0] <= w[0][0]) {
        Some(i) => Err(ValueError::Order {
            row: i + 1,
            time: table[i + 1][0],
            before: table[i][0],
        }),
        None => Ok(()),
    }
}

impl TimeFunction {
    /// The same value always and everywhere.
    pub fn constant(value: f64) -> TimeFunction {
        TimeFunction {
            form: Form::Constant(value),
        }
    }

    /// Value at a time, for functions that do not depend on position.
    ///
    /// # Errors
    /// [`ValueError::Eval`] when the result is not finite, which it never is for a function of position.
    pub fn eval(&self, t: f64) -> Result<f64, ValueError> {
        self.value([f64::NAN; 3], t, None)
    }

    /// Value at an undeformed position and a time.
    ///
    /// # Errors
    /// [`ValueError::Eval`] when the result is not finite.
    pub fn eval_at(&self, x: &Vec3, t: f64) -> Result<f64, ValueError> {
        let x = [x.x, x.y, x.z];
        self.value(x, t, Some(x))
    }

    fn value(&self, x: [f64; 3], t: f64, place: Option<[f64; 3]>) -> Result<f64, ValueError> {
        let value = match &self.form {
            Form::Constant(c) => *c,
            Form::Table(rows) => interpolate(rows, t),
            Form::Expression { program, .. } => program.eval(&[x[0], x[1], x[2], t]),
        };
        if value.is_finite() {
            return Ok(value);
        }
        let expression = match &self.form {
            Form::Expression { text, .. } => text.clone(),
            _ => "table".to_string(),
        };
        let x = place.filter(|_| self.depends_on_position());
        Err(ValueError::Eval(EvalError {
            expression,
            value,
            time: t,
            x,
        }))
    }

    /// The value when it is the same always and everywhere.
    pub fn as_constant(&self) -> Option<f64> {
        match self.form {
            Form::Constant(c) => Some(c),
            _ => None,
        }
    }

    /// Whether it is an expression, which may have any course between two times.
    pub fn is_expression(&self) -> bool {
        matches!(self.form, Form::Expression { .. })
    }

    /// Whether x, y or z occur.
    pub fn depends_on_position(&self) -> bool {
        matches!(&self.form, Form::Expression { program, .. } if (0..3).any(|k| program.uses(k)))
    }

    /// Whether the value changes in time.
    pub fn depends_on_time(&self) -> bool {
        match &self.form {
            Form::Constant(_) => false,
            Form::Table(_) => true,
            Form::Expression { program, .. } => program.uses(3),
        }
    }

    /// Times at which a table has a row; steps should end there. Empty for other forms.
    pub fn breakpoints(&self) -> Vec<f64> {
        match &self.form {
            Form::Table(rows) => rows.iter().map(|r| r[0]).collect(),
            _ => Vec::new(),
        }
    }
}

/// Linear between rows, constant beyond them.
fn interpolate(rows: &[[f64; 2]], t: f64) -> f64 {
    let after = rows.partition_point(|r| r[0] <= t);
    match (
        after.checked_sub(1).and_then(|i| rows.get(i)),
        rows.get(after),
    ) {
        (Some([t0, v0]), Some([t1, v1])) => v0 + (v1 - v0) * ((t - t0) / (t1 - t0)),
        (Some([_, v]), None) | (None, Some([_, v])) => *v,
        (None, None) => f64::NAN,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn function(value: &str, variables: &[&str]) -> Result<TimeFunction, ValueError> {
        serde_json::from_str::<Value>(value)
            .unwrap()
            .compile(variables)
    }

    #[test]
    fn tables_are_linear_inside_and_constant_beyond() {
        let f = function(r#"{"table": [[1, 10], [2, 20], [4, 0]]}"#, &TIME).unwrap();
        for (t, expected) in [
            (-5.0, 10.0),
            (1.0, 10.0),
            (1.25, 12.5),
            (2.0, 20.0),
            (3.0, 10.0),
            (4.0, 0.0),
            (9.0, 0.0),
        ] {
            assert_eq!(f.eval(t).unwrap(), expected, "t = {t}");
        }
        assert_eq!(f.breakpoints(), [1.0, 2.0, 4.0]);
        assert!(f.depends_on_time() && !f.depends_on_position());
    }

    #[test]
    fn tables_must_increase() {
        let error = function(r#"{"table": [[0, 0], [1, 1], [1, 2]]}"#, &TIME).unwrap_err();
        assert_eq!(
            error,
            ValueError::Order {
                row: 2,
                time: 1.0,
                before: 1.0
            }
        );
        assert_eq!(
            function(r#"{"table": []}"#, &TIME).unwrap_err(),
            ValueError::EmptyTable
        );
    }

    #[test]
    fn expressions_know_their_variables() {
        let f = function(r#""x + 10*y + 100*z + 1000*t""#, &POSITION_AND_TIME).unwrap();
        assert_eq!(f.eval_at(&Vec3::new(1.0, 2.0, 3.0), 4.0).unwrap(), 4321.0);
        assert!(f.depends_on_position() && f.depends_on_time());
        let error = function(r#""x*t""#, &TIME).unwrap_err();
        assert_eq!(error.to_string(), "unknown variable `x`");
        assert_eq!(
            function(r#""2*pi""#, &TIME).unwrap().as_constant(),
            Some(std::f64::consts::TAU)
        );
    }

    #[test]
    fn what_is_not_finite_is_an_error() {
        let f = function(r#""1/(t-1)""#, &TIME).unwrap();
        assert_eq!(f.eval(3.0).unwrap(), 0.5);
        let error = f.eval(1.0).unwrap_err();
        assert_eq!(error.to_string(), "`1/(t-1)` is inf at t = 1");
        let f = function(r#""sqrt(x)""#, &POSITION_AND_TIME).unwrap();
        let error = f.eval_at(&Vec3::new(-1.0, 0.0, 0.0), 0.0).unwrap_err();
        assert_eq!(
            error.to_string(),
            "`sqrt(x)` is NaN at t = 0, x = -1, y = 0, z = 0"
        );
        assert!(f.eval(0.0).is_err());
        assert!(matches!(
            function(r#""1/0""#, &TIME),
            Err(ValueError::NotFinite { .. })
        ));
        // min and max of the standard library would hide this one.
        assert!(
            function(r#""max(sqrt(0-t), 0)""#, &TIME)
                .unwrap()
                .eval(1.0)
                .is_err()
        );
    }
}
