//! Error messages for people: `error: file:line:column: ...` with the line of the scene and a caret under it.
use super::exit;
use crate::run::RunError;
use crate::scene::{LoadedScene, Problem, SceneError};
use miette::{GraphicalReportHandler, GraphicalTheme, LabeledSpan, SourceCode, SourceSpan};
use serde::Serialize;
use std::fmt;
use std::io::{IsTerminal, Write};
use std::panic::PanicHookInfo;

/// Problems beyond this many are counted, not shown.
const SHOWN: usize = 20;

/// Of lines of more characters than this, as other programs write them, only what is around the problem is shown: a caret under their
/// end would be nowhere on the screen.
const LONGEST_LINE: usize = 200;

/// Characters that are shown of them before the problem, and from there on.
const AROUND: [usize; 2] = [30, 44];

/// Lines of a value that are shown.
const MOST_LINES: usize = 6;

/// Writes to standard error. Nothing can be done when that fails.
pub(super) fn stderr(text: &str) {
    let _ = std::io::stderr().lock().write_all(text.as_bytes());
}

/// Whether standard error is a terminal that wants colours (<https://no-color.org>).
pub(super) fn colours() -> bool {
    let set = |name| std::env::var_os(name).is_some_and(|v| !v.is_empty());
    std::io::stderr().is_terminal()
        && !set("NO_COLOR")
        && std::env::var_os("TERM").is_none_or(|t| t != "dumb")
}

fn paint(code: &str, text: &str) -> String {
    match colours() {
        true => format!("\x1b[{code}m{text}\x1b[0m"),
        false => text.to_string(),
    }
}

/// An error without a place.
pub(super) fn error(message: &str) {
    stderr(&format!("{} {message}\n", paint("1;31", "error:")));
}

/// A warning.
pub(super) fn warning(message: &str) {
    stderr(&format!("{} {message}\n", paint("1;33", "warning:")));
}

/// A problem with the line of the scene that it is about.
#[derive(Debug)]
struct Shown<'a> {
    problem: &'a Problem,
    text: &'a str,
}

impl fmt::Display for Shown<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.problem.message)
    }
}
impl std::error::Error for Shown<'_> {}
impl miette::Diagnostic for Shown<'_> {
    fn source_code(&self) -> Option<&dyn SourceCode> {
        Some(&self.text)
    }
    fn labels(&self) -> Option<Box<dyn Iterator<Item = LabeledSpan> + '_>> {
        let start = self.problem.span.start.min(self.text.len());
        let end = self.problem.span.end.min(self.text.len());
        let value = self.text.get(start..end).unwrap_or_default();
        let cut = value.match_indices('\n').nth(MOST_LINES - 1);
        let end = cut.map_or(end, |(length, _)| start + length);
        let span = SourceSpan::from((start, end.saturating_sub(start)));
        Some(Box::new(std::iter::once(LabeledSpan::new_with_span(
            None, span,
        ))))
    }
}

/// The lines around a problem, with a caret.
fn snippet(problem: &Problem, text: &str) -> String {
    if let Some(part) = part_of_line(problem, text) {
        return part;
    }
    let theme = match colours() {
        true => GraphicalTheme::unicode(),
        false => GraphicalTheme::unicode_nocolor(),
    };
    let handler = GraphicalReportHandler::new_themed(theme)
        .with_context_lines(1)
        .with_wrap_lines(false)
        .without_cause_chain();
    let mut out = String::new();
    if handler
        .render_report(&mut out, &Shown { problem, text })
        .is_err()
    {
        return String::new();
    }
    // The message itself is already told in the line before.
    let lines = out
        .lines()
        .skip_while(|l| !l.contains('╭'))
        .filter(|l| !l.trim().is_empty());
    lines.map(|l| format!("{l}\n")).collect()
}

/// What is around a problem in a line that is too long to be shown; none where it is not.
fn part_of_line(problem: &Problem, text: &str) -> Option<String> {
    let (before, rest) = text.split_at_checked(problem.span.start)?;
    let before = &before[before.rfind('\n').map_or(0, |end| end + 1)..];
    let rest = rest.lines().next().unwrap_or_default();
    let [left, right] = [before, rest].map(|part| part.chars().count());
    if left + right <= LONGEST_LINE {
        return None;
    }
    let dots = |cut: bool| if cut { "..." } else { "" };
    let [most, more] = AROUND;
    let head: String = before.chars().skip(left.saturating_sub(most)).collect();
    let tail: String = rest.chars().take(more).collect();
    let value = text.get(problem.span.start..problem.span.end);
    let marked = value
        .map_or(1, |v| v.chars().count())
        .clamp(1, tail.chars().count().max(1));
    let number = problem.place.line.to_string();
    let (margin, cut) = (" ".repeat(number.len()), dots(left > most));
    let indent = " ".repeat(cut.len() + head.chars().count());
    Some(format!(
        " {margin} ╭────\n {number} │ {cut}{head}{tail}{}\n {margin} · {indent}{}\n {margin} ╰────\n",
        dots(right > more),
        "─".repeat(marked)
    ))
}

fn problems(name: &str, text: &str, problems: &[Problem]) {
    let mut out = String::new();
    for problem in problems.iter().take(SHOWN) {
        out += &format!(
            "{} {name}:{}: {}\n",
            paint("1;31", "error:"),
            problem.place,
            problem.message
        );
        out += &snippet(problem, text);
        if let Some(help) = &problem.help {
            out += &format!("  {} {help}\n", paint("36", "help:"));
        }
    }
    if problems.len() > SHOWN {
        out += &format!("... and {} more\n", problems.len() - SHOWN);
    }
    if problems.len() > 1 {
        out += &format!("{} problems in {name}\n", problems.len());
    }
    stderr(&out);
}

/// What `--json` prints when a scene is wrong.
#[derive(Debug, Serialize)]
struct Failure<'a> {
    event: &'static str,
    exit_code: u8,
    message: String,
    #[serde(skip_serializing_if = "Option::is_none")]
    file: Option<&'a str>,
    #[serde(skip_serializing_if = "<[Problem]>::is_empty")]
    problems: &'a [Problem],
}

/// Tells why a scene could not be used and returns the exit code. With `json` the same goes to standard output as one
/// line.
pub(super) fn scene_error(error_: &SceneError, json: bool) -> u8 {
    let code = match error_ {
        SceneError::Missing { .. } | SceneError::Wrong { .. } => exit::SCENE,
        SceneError::Io { .. } => exit::IO,
    };
    match error_ {
        SceneError::Wrong {
            name,
            text,
            problems: all,
        } => {
            problems(name, text, all);
            if json {
                failure(code, "the scene is wrong".into(), Some(name), all);
            }
        }
        other => {
            error(&other.to_string());
            if json {
                failure(code, other.to_string(), None, &[]);
            }
        }
    }
    code
}

/// Tells of an error that has no place, with `json` on standard output, too, and returns the exit code.
pub(super) fn other_error(message: &str, code: u8, json: bool) -> u8 {
    error(message);
    if json {
        failure(code, message.to_owned(), None, &[]);
    }
    code
}

/// Tells why a run or check failed and returns the exit code.
pub(super) fn run_error(error_: &RunError, scene: &LoadedScene, json: bool) -> u8 {
    if let RunError::Scene { others, .. } = error_ {
        let mut problems: Vec<Problem> = (std::iter::once(error_).chain(others))
            .filter_map(|e| match e {
                RunError::Scene { pointer, help, .. } => {
                    Some(scene.problem(pointer, e.to_string(), help.clone()))
                }
                _ => None,
            })
            .collect();
        problems.sort_by_key(|p| p.span.start);
        return scene_error(&scene.error(problems), json);
    }
    error(&error_.to_string());
    let code = error_.exit_code();
    if code == exit::BUG {
        stderr(&format!("{}\n", please_report()));
    }
    if json {
        failure(code, error_.to_string(), None, &[]);
    }
    code
}

fn failure(exit_code: u8, message: String, file: Option<&str>, problems: &[Problem]) {
    let failure = Failure {
        event: "error",
        exit_code,
        message,
        file,
        problems,
    };
    if let Ok(line) = serde_json::to_string(&failure) {
        super::print(&(line + "\n"));
    }
}

fn please_report() -> String {
    format!(
        "This is a bug of covact {}. Please report it to its authors, with this message and the scene.",
        env!("CARGO_PKG_VERSION")
    )
}

/// The panic hook.
pub(super) fn panic(info: &PanicHookInfo<'_>) {
    let message = info.payload();
    let message = message
        .downcast_ref::<&str>()
        .copied()
        .or_else(|| message.downcast_ref::<String>().map(String::as_str))
        .unwrap_or("no message");
    let place = info
        .location()
        .map_or(String::new(), |l| format!(" at {l}"));
    error(&format!("internal error{place}: {message}"));
    stderr(&format!("{}\n", please_report()));
}
