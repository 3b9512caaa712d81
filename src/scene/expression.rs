//! Arithmetic expressions in named variables, read and evaluated by the crate nanoexpr.
//!
//! Usual rules: `^` (or `**`) binds tighter than a sign and from the right, so `-t^2` is -(t^2) and `2^3^2` is 2^9.
//! Of the crates measured only nanoexpr (MIT, no dependencies, no unsafe code) and meval have these rules; exmex,
//! fasteval and mathexpr read `-t^2` as (-t)^2, and meval is built on a release of nom that future compilers
//! refuse. What is left to do here: our names, IEEE arithmetic, limits, and errors in the scene's words.
use super::problem::{shorten, suggestion};
use nanoexpr::{Context, ErrorKind, Evaluator, Number};
use std::cell::Cell;
use std::ops::Range;

type Function1 = fn(f64) -> f64;
type Function2 = fn(f64, f64) -> f64;

/// Functions of one argument.
const FUNCTIONS_1: [(&str, Function1); 19] = [
    ("abs", f64::abs),
    ("acos", f64::acos),
    ("asin", f64::asin),
    ("atan", f64::atan),
    ("cbrt", f64::cbrt),
    ("ceil", f64::ceil),
    ("cos", f64::cos),
    ("cosh", f64::cosh),
    ("exp", f64::exp),
    ("floor", f64::floor),
    ("ln", f64::ln),
    ("log10", f64::log10),
    ("round", f64::round),
    ("sign", sign),
    ("sin", f64::sin),
    ("sinh", f64::sinh),
    ("sqrt", f64::sqrt),
    ("tan", f64::tan),
    ("tanh", f64::tanh),
];

/// Functions of two arguments; `min` and `max` take up to [`ARGUMENTS`].
const FUNCTIONS_2: [(&str, Function2); 5] = [
    ("atan2", f64::atan2),
    ("hypot", f64::hypot),
    ("max", max),
    ("min", min),
    ("mod", f64::rem_euclid),
];

const CONSTANTS: [(&str, f64); 2] = [("pi", std::f64::consts::PI), ("e", std::f64::consts::E)];

/// Parentheses, signs, operators and calls may be nested this deep: it bounds the stack.
const MAX_NESTING: usize = 64;
/// Bytes of an expression: it bounds the time.
const MAX_LENGTH: usize = 4096;
/// Arguments of a call.
const ARGUMENTS: usize = 8;

fn sign(x: f64) -> f64 {
    match x {
        x if x > 0.0 => 1.0,
        x if x < 0.0 => -1.0,
        x => x,
    }
}
// Unlike f64::min and f64::max these let NaN through, so that it is noticed.
fn min(a: f64, b: f64) -> f64 {
    if a.is_nan() || a < b { a } else { b }
}
fn max(a: f64, b: f64) -> f64 {
    if a.is_nan() || a > b { a } else { b }
}

/// Why an expression is not valid.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{message}")]
pub struct ExpressionError {
    /// What is wrong, in one sentence.
    pub message: String,
    /// What would be right.
    pub help: Option<String>,
    /// Bytes of the expression that are meant.
    pub span: Range<usize>,
}

/// A number by the rules of IEEE 754: infinities and NaN are results, which the caller judges. It has no order, so
/// comparisons, logic and factorials, which the crate also reads, are refused.
#[derive(Debug, Clone, Copy, Default)]
struct Real(f64);

impl Number for Real {
    fn parse(literal: &str) -> Option<Self> {
        let x: f64 = literal.parse().ok()?;
        x.is_finite().then_some(Real(x))
    }
    fn add(self, rhs: Self) -> Result<Self, ErrorKind> {
        Ok(Real(self.0 + rhs.0))
    }
    fn subtract(self, rhs: Self) -> Result<Self, ErrorKind> {
        Ok(Real(self.0 - rhs.0))
    }
    fn multiply(self, rhs: Self) -> Result<Self, ErrorKind> {
        Ok(Real(self.0 * rhs.0))
    }
    fn divide(self, rhs: Self) -> Result<Self, ErrorKind> {
        Ok(Real(self.0 / rhs.0))
    }
    fn remainder(self, _: Self) -> Result<Self, ErrorKind> {
        // A remainder's sign is a matter of taste; mod(a, b) says which it means.
        Err(ErrorKind::Unsupported)
    }
    fn power(self, rhs: Self) -> Result<Self, ErrorKind> {
        Ok(Real(self.0.powf(rhs.0)))
    }
    fn negate(self) -> Result<Self, ErrorKind> {
        Ok(Real(-self.0))
    }
}

/// What the names in an expression stand for.
struct Names<'a, V: Fn(&str) -> Option<f64>> {
    variable: V,
    /// Arguments that the last function called with the wrong number of them takes.
    wanted: &'a Cell<usize>,
}

impl<V: Fn(&str) -> Option<f64>> Context<Real> for Names<'_, V> {
    fn variable(&self, name: &str) -> Option<Real> {
        let constant = || CONSTANTS.iter().find(|c| c.0 == name).map(|c| c.1);
        (self.variable)(name).or_else(constant).map(Real)
    }

    fn call(&self, name: &str, arguments: &[Real]) -> Option<Result<Real, ErrorKind>> {
        let wrong = |wanted| {
            self.wanted.set(wanted);
            Some(Err(ErrorKind::ArgumentCount))
        };
        if let Some((_, f)) = FUNCTIONS_1.iter().find(|f| f.0 == name) {
            return match arguments {
                [a] => Some(Ok(Real(f(a.0)))),
                _ => wrong(1),
            };
        }
        let (_, f) = FUNCTIONS_2.iter().find(|f| f.0 == name)?;
        match arguments {
            [a, b] => Some(Ok(Real(f(a.0, b.0)))),
            [a, rest @ ..] if rest.len() > 1 && matches!(name, "min" | "max") => {
                Some(Ok(Real(rest.iter().fold(a.0, |a, b| f(a, b.0)))))
            }
            _ => wrong(2),
        }
    }
}

/// A checked expression. Evaluating it reads the text again, in one pass without allocating.
#[derive(Debug, Clone)]
pub struct Expression {
    text: String,
    variables: Vec<String>,
    /// Bit k is set when variable k occurs.
    used: u32,
}

impl Expression {
    /// Checks `text`, in which the names of `variables` (at most 32) may occur.
    ///
    /// # Errors
    /// [`ExpressionError`] with the place in the text.
    pub fn compile(text: &str, variables: &[&str]) -> Result<Expression, ExpressionError> {
        let whole = |message: String| ExpressionError {
            message,
            help: None,
            span: 0..text.len(),
        };
        if text.trim().is_empty() {
            return Err(whole("the expression is empty".into()));
        }
        if text.len() > MAX_LENGTH {
            return Err(whole(format!(
                "the expression is longer than {MAX_LENGTH} bytes"
            )));
        }
        let (used, wanted) = (Cell::new(0u32), Cell::new(0));
        // Every part of an expression is evaluated whatever the values, so one evaluation meets every error.
        let names = Names {
            variable: |name: &str| {
                let k = variables.iter().take(32).position(|v| *v == name)?;
                used.set(used.get() | 1 << k);
                Some(1.0)
            },
            wanted: &wanted,
        };
        match evaluator(&names).evaluate::<Real>(text) {
            Ok(_) => Ok(Expression {
                text: text.to_owned(),
                variables: variables.iter().map(|v| v.to_string()).collect(),
                used: used.get(),
            }),
            Err(e) => Err(explain(text, variables, e, wanted.get())),
        }
    }

    /// Whether variable `k` occurs.
    pub fn uses(&self, k: usize) -> bool {
        k < 32 && self.used & (1 << k) != 0
    }

    /// Value for the given variables (in the order of [`Expression::compile`]; missing ones count as NaN). The result
    /// may be infinite or NaN.
    pub fn eval(&self, variables: &[f64]) -> f64 {
        let wanted = Cell::new(0);
        let names = Names {
            variable: |name: &str| {
                let k = self.variables.iter().position(|v| v == name)?;
                Some(variables.get(k).copied().unwrap_or(f64::NAN))
            },
            wanted: &wanted,
        };
        match evaluator(&names).evaluate::<Real>(&self.text) {
            Ok(Real(x)) => x,
            Err(_) => f64::NAN,
        }
    }
}

fn evaluator<C: Context<Real>>(names: &C) -> Evaluator<'_, C, ARGUMENTS> {
    Evaluator::new(names).max_depth(MAX_NESTING)
}

/// The crate's error in the scene's words.
fn explain(
    text: &str,
    variables: &[&str],
    error: nanoexpr::Error,
    wanted: usize,
) -> ExpressionError {
    let mut span = error.span.start..error.span.end;
    let found = text.get(span.clone()).unwrap_or_default();
    let name = found.split(['(', ' ']).next().unwrap_or_default();
    let functions = (FUNCTIONS_1.iter().map(|f| f.0)).chain(FUNCTIONS_2.iter().map(|f| f.0));
    let mut help = None;
    let message = match error.kind {
        ErrorKind::UnknownVariable if functions.clone().any(|f| f == name) => {
            format!("the function `{name}` needs arguments, as in `{name}(...)`")
        }
        ErrorKind::UnknownVariable => {
            let known = (variables.iter().copied()).chain(CONSTANTS.iter().map(|c| c.0));
            help = Some(suggestion(name, "possible here", known));
            format!("unknown variable `{}`", shorten(name))
        }
        ErrorKind::UnknownFunction => {
            help = Some(suggestion(name, "functions", functions));
            format!("unknown function `{}`", shorten(name))
        }
        ErrorKind::ArgumentCount => {
            span.end = span.start + name.len();
            format!("`{name}` takes {wanted} argument{}", plural(wanted))
        }
        ErrorKind::TooManyArguments => format!("a function takes at most {ARGUMENTS} arguments"),
        ErrorKind::InvalidNumber => format!("`{}` is not a number", shorten(found)),
        ErrorKind::UnclosedParenthesis => "this `(` is not closed".to_owned(),
        ErrorKind::UnexpectedEnd => {
            "the expression ends where a number or name is expected".to_owned()
        }
        ErrorKind::TooDeep => {
            span = 0..text.len();
            format!("the expression is nested more than {MAX_NESTING} deep")
        }
        ErrorKind::Unsupported => {
            help = Some("there are `+ - * / ^`, and mod(a, b) for a remainder".to_owned());
            "comparisons, logic, factorials and `%` are not possible".to_owned()
        }
        ErrorKind::UnexpectedToken | ErrorKind::UnexpectedCharacter => {
            help = Some(match found {
                ")" => "there is no `(` that it closes, or nothing stands before it".to_owned(),
                _ => "an operator may be missing before it, e.g. `*`".to_owned(),
            });
            format!("unexpected `{}`", shorten(found))
        }
        other => other.to_string(),
    };
    ExpressionError {
        message,
        help,
        span,
    }
}

fn plural(n: usize) -> &'static str {
    if n == 1 { "" } else { "s" }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn value(text: &str, t: f64) -> f64 {
        Expression::compile(text, &["t"]).unwrap().eval(&[t])
    }

    #[test]
    fn precedence_follows_mathematics() {
        for (text, expected) in [
            ("-t^2", -9.0),
            ("2^3^2", 512.0),
            ("2**-1", 0.5),
            ("2^-t^2", 1.0 / 512.0),
            ("-t^-2*2", -2.0 / 9.0),
            ("10 - 2 - 3", 5.0),
            ("12 / 2 * t", 18.0),
            ("-2*-t", 6.0),
            ("1e-3*t", 3e-3),
            ("2.5E+1 + .5", 25.5),
            ("min(5, max(t, 4), 7)", 4.0),
            ("min(1, max(2, 3))", 1.0),
            ("max(1, 2, 3, 4, 5, 6, 7, 8)", 8.0),
            ("atan2(0, -1) - pi", 0.0),
            ("2*(t+1)*sin(pi/2)", 8.0),
            ("mod(-1, t)", 2.0),
            ("e^ln(t)", 3.0),
            ("hypot(3, 4)\t+\n1", 6.0),
            ("log10(1000) + sqrt(16) + abs(-1)", 8.0),
            ("floor(1.5) + ceil(1.5) + sign(-2)", 2.0),
            ("acos(cos(1)) + asin(sin(1)) + atan(tan(1))", 3.0),
            ("cosh(1) + sinh(1) + tanh(0) - exp(1)", 0.0),
        ] {
            assert!(
                (value(text, 3.0) - expected).abs() < 1e-14 * expected.abs().max(1.0),
                "{text}"
            );
        }
    }

    #[test]
    fn errors_have_a_place() {
        for (text, span, part) in [
            ("", 0..0, "empty"),
            ("2*s", 2..3, "unknown variable `s`"),
            ("sun(t)", 0..3, "unknown function `sun`"),
            ("t + sin", 4..7, "needs arguments"),
            ("sin t", 4..5, "unexpected `t`"),
            ("2t", 1..2, "unexpected `t`"),
            ("(1+t", 0..1, "not closed"),
            ("t)", 1..2, "unexpected `)`"),
            ("1+", 2..2, "ends where"),
            ("t*é", 2..4, "unexpected `é`"),
            ("t ° 2", 2..4, "unexpected `°`"),
            ("1 + sin(t, 2)", 4..7, "takes 1 argument"),
            ("hypot(t)", 0..5, "takes 2 arguments"),
            ("hypot(1,2,3)", 0..5, "takes 2 arguments"),
            ("min()", 0..3, "takes 2"),
            ("max(1,2,3,4,5,6,7,8,9)", 20..21, "at most 8"),
            ("1e999", 0..5, "not a number"),
            ("1.2.3", 3..5, "unexpected `.3`"),
            ("t < 1 ? 2 : 3", 0..5, "not possible"),
            ("t && s", 0..4, "not possible"),
            ("3!", 0..2, "not possible"),
            ("5 % 3", 0..5, "not possible"),
        ] {
            let error = Expression::compile(text, &["t"]).unwrap_err();
            assert!(error.message.contains(part), "{text}: {}", error.message);
            assert_eq!(error.span, span, "{text}: {}", error.message);
        }
        let help = |text| {
            Expression::compile(text, &["t"])
                .unwrap_err()
                .help
                .unwrap_or_default()
        };
        assert!(help("sqr(t)").starts_with("did you mean `sqrt`?"));
        assert!(help("2*po").starts_with("did you mean `pi`?"));
    }

    #[test]
    fn deep_nesting_is_refused_not_fatal() {
        let check = || {
            let units = ["(", "-", "2^", "min(1,", "1+(", "abs(-(", "t?", "!"];
            for (unit, n) in units
                .iter()
                .flat_map(|u| [MAX_NESTING, 600, 100_000].map(|n| (u, n)))
            {
                let text = unit.repeat(n) + "t";
                assert!(Expression::compile(&text, &["t"]).is_err(), "{unit} {n}");
            }
            // Long but not deep: no limit but the length.
            assert_eq!(value(&("t+".repeat(2000) + "t"), 2.0), 4002.0);
            assert!(Expression::compile(&("t+".repeat(3000) + "t"), &["t"]).is_err());
            let nested = |n: usize| format!("{}t{}", "1+(".repeat(n), ")".repeat(n));
            assert_eq!(value(&nested(31), 2.0), 33.0);
        };
        // A quarter of what a thread usually has.
        let small = std::thread::Builder::new().stack_size(512 << 10);
        small.spawn(check).unwrap().join().unwrap();
    }

    #[test]
    fn threads_may_share_an_expression() {
        fn shared<T: Send + Sync>() {}
        shared::<Expression>();
    }
}
