//! Arithmetic expressions in named variables, compiled to a short postfix program.
//!
//! Usual rules: `^` (or `**`) binds tighter than a sign and from the right, so `-t^2` is -(t^2) and `2^3^2` is 2^9.
use super::problem::suggestion;
use std::ops::Range;

/// Functions of one argument.
const FUNCTIONS_1: [(&str, fn(f64) -> f64); 19] = [
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

/// Functions of two arguments; `min` and `max` take any number of them.
const FUNCTIONS_2: [(&str, fn(f64, f64) -> f64); 5] = [
    ("atan2", f64::atan2),
    ("hypot", f64::hypot),
    ("max", max),
    ("min", min),
    ("mod", f64::rem_euclid),
];

const CONSTANTS: [(&str, f64); 2] = [("pi", std::f64::consts::PI), ("e", std::f64::consts::E)];

/// Parentheses, signs and powers may be nested this deep.
const MAX_NESTING: usize = 64;
/// Numbers on the stack of a program.
const STACK: usize = 32;

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
    pub message: String,
    /// What would be right.
    pub help: Option<String>,
    /// Bytes of the expression that are meant.
    pub span: Range<usize>,
}

#[derive(Debug, Clone, Copy)]
enum Op {
    Number(f64),
    Variable(u8),
    Negate,
    Add,
    Subtract,
    Multiply,
    Divide,
    Power,
    Call1(fn(f64) -> f64),
    Call2(fn(f64, f64) -> f64),
}

/// A compiled expression.
#[derive(Debug, Clone)]
pub struct Expression {
    program: Vec<Op>,
    /// Bit k is set when variable k occurs.
    used: u32,
}

impl Expression {
    /// Compiles `text`, in which the names of `variables` (at most 32) may occur.
    ///
    /// # Errors
    /// [`ExpressionError`] with the place in the text.
    pub fn compile(text: &str, variables: &[&str]) -> Result<Expression, ExpressionError> {
        let mut parser = Parser {
            text,
            at: 0,
            variables,
            program: Vec::new(),
            used: 0,
            nesting: 0,
            height: 0,
        };
        parser.sum()?;
        match parser.peek() {
            None => Ok(Expression {
                program: parser.program,
                used: parser.used,
            }),
            Some(c) => {
                let help = match c {
                    ')' => "there is no `(` that it closes",
                    _ => "an operator is missing before it, e.g. `*`",
                };
                let found = &text[parser.token()];
                Err(parser.error(parser.token(), format!("unexpected `{found}`"), Some(help)))
            }
        }
    }

    /// Whether variable `k` occurs.
    pub fn uses(&self, k: usize) -> bool {
        k < 32 && self.used & (1 << k) != 0
    }

    /// Value for the given variables (in the order of [`Expression::compile`]; missing ones count as NaN). The result
    /// may be infinite or NaN.
    pub fn eval(&self, variables: &[f64]) -> f64 {
        let mut stack = [0.0; STACK];
        let mut n = 0;
        for op in &self.program {
            // Compilation bounds the height of the stack and gives every operator its operands.
            match *op {
                Op::Number(x) => {
                    stack[n] = x;
                    n += 1;
                }
                Op::Variable(k) => {
                    stack[n] = variables.get(usize::from(k)).copied().unwrap_or(f64::NAN);
                    n += 1;
                }
                Op::Negate => stack[n - 1] = -stack[n - 1],
                Op::Call1(f) => stack[n - 1] = f(stack[n - 1]),
                _ => {
                    let (a, b) = (stack[n - 2], stack[n - 1]);
                    n -= 1;
                    stack[n - 1] = match *op {
                        Op::Add => a + b,
                        Op::Subtract => a - b,
                        Op::Multiply => a * b,
                        Op::Divide => a / b,
                        Op::Power => a.powf(b),
                        Op::Call2(f) => f(a, b),
                        _ => f64::NAN,
                    };
                }
            }
        }
        stack[0]
    }
}

struct Parser<'a> {
    text: &'a str,
    at: usize,
    variables: &'a [&'a str],
    program: Vec<Op>,
    used: u32,
    nesting: usize,
    /// Height of the stack after the program so far.
    height: usize,
}

impl Parser<'_> {
    fn error(
        &self,
        span: Range<usize>,
        message: impl Into<String>,
        help: Option<&str>,
    ) -> ExpressionError {
        ExpressionError {
            message: message.into(),
            help: help.map(str::to_string),
            span,
        }
    }

    /// Skips space and looks at the next character.
    fn peek(&mut self) -> Option<char> {
        let rest = &self.text[self.at..];
        self.at += rest.len() - rest.trim_start().len();
        self.text[self.at..].chars().next()
    }

    /// The name, number or character at the present place.
    fn token(&self) -> Range<usize> {
        let rest = &self.text[self.at..];
        let word = rest
            .find(|c: char| !(c.is_alphanumeric() || c == '_'))
            .unwrap_or(rest.len());
        self.at..self.at + word.max(rest.chars().next().map_or(0, char::len_utf8))
    }

    fn eat(&mut self, c: char) -> bool {
        let found = self.peek() == Some(c);
        self.at += if found { c.len_utf8() } else { 0 };
        found
    }

    fn push(&mut self, op: Op) -> Result<(), ExpressionError> {
        match op {
            Op::Number(_) | Op::Variable(_) => self.height += 1,
            Op::Negate | Op::Call1(_) => {}
            _ => self.height -= 1,
        }
        if self.height > STACK {
            return Err(self.error(
                0..self.text.len(),
                "the expression is nested too deeply",
                None,
            ));
        }
        self.program.push(op);
        Ok(())
    }

    fn sum(&mut self) -> Result<(), ExpressionError> {
        self.product()?;
        loop {
            let op = match self.peek() {
                Some('+') => Op::Add,
                Some('-') => Op::Subtract,
                _ => return Ok(()),
            };
            self.at += 1;
            self.product()?;
            self.push(op)?;
        }
    }

    fn product(&mut self) -> Result<(), ExpressionError> {
        self.signed()?;
        loop {
            let op = match self.peek() {
                Some('*') => Op::Multiply,
                Some('/') => Op::Divide,
                _ => return Ok(()),
            };
            self.at += 1;
            self.signed()?;
            self.push(op)?;
        }
    }

    fn signed(&mut self) -> Result<(), ExpressionError> {
        self.nesting += 1;
        if self.nesting > MAX_NESTING {
            return Err(self.error(
                0..self.text.len(),
                "the expression is nested too deeply",
                None,
            ));
        }
        let result = match self.peek() {
            Some('-') => {
                self.at += 1;
                self.signed().and_then(|()| self.push(Op::Negate))
            }
            Some('+') => {
                self.at += 1;
                self.signed()
            }
            _ => self.power(),
        };
        self.nesting -= 1;
        result
    }

    fn power(&mut self) -> Result<(), ExpressionError> {
        self.primary()?;
        let next = self.peek();
        if next == Some('^') || self.text[self.at..].starts_with("**") {
            self.at += if next == Some('^') { 1 } else { 2 };
            self.signed()?;
            self.push(Op::Power)?;
        }
        Ok(())
    }

    fn primary(&mut self) -> Result<(), ExpressionError> {
        match self.peek() {
            Some('(') => {
                let open = self.at;
                self.at += 1;
                self.sum()?;
                self.close(open)
            }
            Some(c) if c.is_ascii_digit() || c == '.' => self.number(),
            Some(c) if c.is_alphabetic() || c == '_' => self.name(),
            Some(c) => {
                let message = format!("expected a number, a name or `(`, found `{c}`");
                Err(self.error(self.token(), message, None))
            }
            None if self.text.trim().is_empty() => {
                Err(self.error(0..self.text.len(), "the expression is empty", None))
            }
            None => {
                let end = self.text.len();
                Err(self.error(
                    end..end,
                    "the expression ends where a number or name is expected",
                    None,
                ))
            }
        }
    }

    fn close(&mut self, open: usize) -> Result<(), ExpressionError> {
        if self.eat(')') {
            return Ok(());
        }
        Err(match self.peek() {
            None => self.error(open..open + 1, "this `(` is not closed", None),
            Some(_) => {
                let message = format!(
                    "expected an operator or `)`, found `{}`",
                    &self.text[self.token()]
                );
                self.error(self.token(), message, None)
            }
        })
    }

    fn number(&mut self) -> Result<(), ExpressionError> {
        let bytes = &self.text.as_bytes()[self.at..];
        let digits = |from: usize| {
            bytes
                .iter()
                .skip(from)
                .take_while(|b| b.is_ascii_digit())
                .count()
        };
        let mut n = digits(0);
        if bytes.get(n) == Some(&b'.') {
            n += 1 + digits(n + 1);
        }
        if matches!(bytes.get(n), Some(b'e' | b'E')) {
            let sign = usize::from(matches!(bytes.get(n + 1), Some(b'+' | b'-')));
            let exponent = digits(n + 1 + sign);
            n += if exponent > 0 { 1 + sign + exponent } else { 0 };
        }
        if bytes.get(n) == Some(&b'.') {
            n += bytes
                .iter()
                .skip(n)
                .take_while(|b| b.is_ascii_digit() || **b == b'.')
                .count();
        }
        let span = self.at..self.at + n;
        let word = &self.text[span.clone()];
        match word.parse::<f64>() {
            Ok(x) if x.is_finite() => {
                self.at = span.end;
                self.push(Op::Number(x))
            }
            _ => Err(self.error(span, format!("`{word}` is not a number"), None)),
        }
    }

    fn name(&mut self) -> Result<(), ExpressionError> {
        let span = self.token();
        let name = &self.text[span.clone()];
        self.at = span.end;
        let function_1 = FUNCTIONS_1
            .iter()
            .find(|(n, _)| *n == name)
            .map(|(_, f)| *f);
        let function_2 = FUNCTIONS_2
            .iter()
            .find(|(n, _)| *n == name)
            .map(|(_, f)| *f);
        if self.peek() != Some('(') {
            if let Some(k) = self.variables.iter().position(|v| *v == name) {
                self.used |= 1 << k;
                return self.push(Op::Variable(k as u8));
            }
            if let Some((_, x)) = CONSTANTS.iter().find(|(n, _)| *n == name) {
                return self.push(Op::Number(*x));
            }
            if function_1.is_some() || function_2.is_some() {
                let message = format!("the function `{name}` needs arguments, as in `{name}(...)`");
                return Err(self.error(span, message, None));
            }
            let constants = CONSTANTS.iter().map(|(n, _)| *n);
            let known = self.variables.iter().copied().chain(constants);
            let help = suggestion(name, "possible here", known);
            return Err(self.error(span, format!("unknown variable `{name}`"), Some(&help)));
        }
        let open = self.at;
        self.at += 1;
        let arguments = |n| match n {
            1 => "1 argument".to_string(),
            n => format!("{n} arguments"),
        };
        let (wanted, any) = match (function_1, function_2) {
            (Some(_), _) => (1, false),
            (_, Some(_)) => (2, matches!(name, "min" | "max")),
            _ => {
                let functions = FUNCTIONS_1.iter().map(|(n, _)| *n);
                let known = functions.chain(FUNCTIONS_2.iter().map(|(n, _)| *n));
                let help = suggestion(name, "functions", known);
                return Err(self.error(span, format!("unknown function `{name}`"), Some(&help)));
            }
        };
        let mut given = 0;
        if self.peek() != Some(')') {
            loop {
                self.sum()?;
                given += 1;
                if given > 1
                    && let Some(f) = function_2
                {
                    self.push(Op::Call2(f))?;
                }
                // More arguments than wanted are refused at once, before they unbalance the stack.
                if !self.eat(',') || (given >= wanted && !any) {
                    break;
                }
            }
        }
        if given < wanted || self.text[..self.at].ends_with(',') {
            let message = format!("`{name}` takes {}", arguments(wanted));
            return Err(self.error(span, message, None));
        }
        self.close(open)?;
        match function_1 {
            Some(f) => self.push(Op::Call1(f)),
            None => Ok(()),
        }
    }
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
            ("10 - 2 - 3", 5.0),
            ("12 / 2 * t", 18.0),
            ("-2*-t", 6.0),
            ("1e-3*t", 3e-3),
            ("2.5E+1 + .5", 25.5),
            ("min(5, max(t, 4), 7)", 4.0),
            ("atan2(0, -1) - pi", 0.0),
            ("2*(t+1)*sin(pi/2)", 8.0),
            ("mod(-1, t)", 2.0),
            ("e^ln(t)", 3.0),
            ("hypot(3, 4)\t+\n1", 6.0),
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
            ("sin t", 0..3, "needs arguments"),
            ("2t", 1..2, "unexpected `t`"),
            ("(1+t", 0..1, "not closed"),
            ("t)", 1..2, "unexpected `)`"),
            ("1+", 2..2, "ends where"),
            ("t*é", 2..4, "unknown variable `é`"),
            ("t ° 2", 2..4, "unexpected `°`"),
            ("sin(t, 2)", 0..3, "takes 1 argument"),
            ("hypot(t)", 0..5, "takes 2 arguments"),
            ("hypot(1,2,3)", 0..5, "takes 2 arguments"),
            ("min()", 0..3, "takes 2"),
            ("1e999", 0..5, "not a number"),
            ("1.2.3", 0..5, "not a number"),
        ] {
            let error = Expression::compile(text, &["t"]).unwrap_err();
            assert!(error.message.contains(part), "{text}: {}", error.message);
            assert_eq!(error.span, span, "{text}: {}", error.message);
        }
        let help = Expression::compile("sqr(t)", &["t"])
            .unwrap_err()
            .help
            .unwrap();
        assert!(help.starts_with("did you mean `sqrt`?"), "{help}");
    }

    #[test]
    fn deep_nesting_is_refused_not_fatal() {
        for text in [
            "(".repeat(100_000),
            "-".repeat(100_000),
            "2^".repeat(100_000),
            "min(1,".repeat(100_000),
        ] {
            assert!(Expression::compile(&text, &["t"]).is_err());
        }
        // The longest stack that is allowed, and one more.
        let nested = |n: usize| format!("{}t{}", "1+(".repeat(n), ")".repeat(n));
        assert_eq!(value(&nested(STACK - 1), 2.0), 2.0 + (STACK - 1) as f64);
        assert!(Expression::compile(&nested(STACK), &["t"]).is_err());
    }
}
