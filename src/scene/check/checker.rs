//! Collects problems; the rules that many fields share.
use crate::scene::document::{Document, nearest_file, pointer};
use crate::scene::json::MORE;
use crate::scene::problem::{MOST_PROBLEMS, Problem, shorten, suggestion};
use crate::scene::value::{Value, ValueError};
use covact_geometry::io::not_regular;
use std::fs::File;
use std::path::Path;

/// Bytes of a path in a message.
const MOST_OF_PATH: usize = 1000;

pub(crate) struct Checker<'a> {
    loaded: &'a Document,
    problems: Vec<Problem>,
}

/// A path for messages; of a very long one the end.
fn shorten_path(path: &Path) -> String {
    let shown = path.display().to_string();
    match shown.char_indices().rev().nth(MOST_OF_PATH / 4) {
        Some((i, _)) if shown.len() > MOST_OF_PATH => format!("...{}", &shown[i..]),
        _ => shown,
    }
}

/// JSON pointer of nested names.
pub(super) fn path(tokens: &[&str]) -> String {
    pointer(tokens)
}

impl<'a> Checker<'a> {
    pub fn new(loaded: &'a Document) -> Self {
        Checker {
            loaded,
            problems: Vec::new(),
        }
    }

    /// The problems in the order of the file.
    pub fn finish(mut self) -> Vec<Problem> {
        let more = self.problems.len() > MOST_PROBLEMS;
        self.problems.truncate(MOST_PROBLEMS);
        self.problems.sort_by_key(|p| p.span.start);
        if more {
            self.problems.push(self.loaded.problem("", MORE, None));
        }
        self.problems
    }

    /// Whether the file has a value at a JSON pointer.
    pub fn has(&self, at: &str) -> bool {
        self.loaded.has(at)
    }

    pub fn add(&mut self, at: &str, message: impl Into<String>, help: Option<String>) {
        if self.full() {
            return;
        }
        self.problems.push(self.loaded.problem(at, message, help));
    }

    /// Nothing that is found now will be told.
    pub fn full(&self) -> bool {
        self.problems.len() > MOST_PROBLEMS
    }

    pub fn positive(&mut self, at: &str, what: &str, value: f64) {
        if !(value > 0.0 && value.is_finite()) {
            self.add(
                at,
                format!("{what} is {value}"),
                Some("it must be positive".into()),
            );
        }
    }

    pub fn finite(&mut self, at: &str, values: &[f64]) {
        if !values.iter().all(|v| v.is_finite()) {
            self.add(at, "a number is not finite", None);
        }
    }

    /// A whole number from `min` to `max`.
    pub fn whole(&mut self, at: &str, value: u32, min: u32, max: u32) {
        if !(min..=max).contains(&value) {
            let key = at
                .rsplit('/')
                .find(|t| t.parse::<u32>().is_err())
                .unwrap_or_default();
            self.add(
                at,
                format!("`{key}` is {value}"),
                Some(format!("a whole number from {min} to {max}")),
            );
        }
    }

    /// `low < high`, both finite.
    pub fn ordered(&mut self, at: &str, what: &str, [low, high]: [f64; 2]) {
        let in_order = low < high && low.is_finite() && high.is_finite();
        if !in_order {
            let message = format!("{what} go from {low} to {high}");
            self.add(
                at,
                message,
                Some("the first must be smaller than the second".into()),
            );
        }
    }

    /// A direction that is not zero.
    pub fn direction(&mut self, at: &str, what: &str, v: [f64; 3]) {
        let length = v.iter().map(|x| x * x).sum::<f64>();
        if !(length > 0.0 && length.is_finite()) {
            self.add(
                at,
                format!("{what} has no direction"),
                Some("at least one component must not be zero".into()),
            );
        }
    }

    /// One and only one of the alternatives is given.
    pub fn exactly_one(&mut self, at: &str, what: &str, alternatives: &[(&str, bool)]) {
        let quoted = |given_only: bool| -> Vec<String> {
            let kept = alternatives
                .iter()
                .filter(|(_, given)| *given || !given_only);
            kept.map(|(name, _)| format!("`{name}`")).collect()
        };
        let given = quoted(true);
        let help = Some(format!("exactly one of {}", quoted(false).join(", ")));
        match given.len() {
            0 => self.add(at, format!("the {what} does not say what it is"), help),
            1 => {}
            _ => self.add(
                at,
                format!("the {what} has {} at once", given.join(" and ")),
                help,
            ),
        }
    }

    /// `name` is a key of the scene's section `section`.
    pub fn refers<'n>(
        &mut self,
        at: &str,
        what: &str,
        section: &str,
        name: &str,
        known: impl Iterator<Item = &'n String> + Clone,
    ) {
        if !self.full() && !known.clone().any(|k| k == name) {
            let help = suggestion(name, section, known.map(String::as_str));
            self.add(
                at,
                format!("there is no {what} `{}`", shorten(name)),
                Some(help),
            );
        }
    }

    /// The value compiles with these variables.
    pub fn value(&mut self, at: &str, value: &Value, variables: &[&str]) {
        if self.full() {
            return;
        }
        let Err(error) = value.compile(variables) else {
            return;
        };
        let message = error.to_string();
        match error {
            ValueError::Expression(e) => {
                let problem = self.loaded.problem_within(at, e.span, message, e.help);
                self.problems.push(problem);
            }
            ValueError::Order { row, .. } => {
                self.add(&format!("{at}/table/{row}/0"), message, None)
            }
            ValueError::Row { row } => self.add(&format!("{at}/table/{row}"), message, None),
            ValueError::EmptyTable => {
                self.add(
                    &format!("{at}/table"),
                    message,
                    Some("write `[[t, value], ...]`".into()),
                );
            }
            ValueError::Number(_)
            | ValueError::NotFinite { .. }
            | ValueError::Eval(_)
            | ValueError::Negative { .. }
            | ValueError::NoLength { .. } => {
                self.add(at, message, None);
            }
        }
    }

    /// The folder exists.
    pub fn folder(&mut self, at: &str, path: &Path) {
        let full = self.loaded.resolve(path);
        if !full.is_dir() {
            let what = self.loaded.what;
            let help = format!("paths are relative to the {what} file");
            let message = format!("there is no folder `{}`", shorten_path(&full));
            self.add(at, message, Some(help));
        }
    }

    /// The file exists and can be opened; its extension is one of `extensions` (none: any).
    pub fn file(&mut self, at: &str, path: &Path, extensions: &[&str]) {
        let full = self.loaded.resolve(path);
        let shown = shorten_path(&full);
        if path.as_os_str().is_empty() {
            return self.add(at, "the path is empty", None);
        }
        match std::fs::metadata(&full) {
            Ok(meta) if meta.is_dir() => {
                return self.add(at, format!("`{shown}` is a folder, not a file"), None);
            }
            // Not even opened: a pipe may block for ever.
            Ok(meta) => {
                if let Some(what) = not_regular(&meta) {
                    return self.add(at, format!("cannot read `{shown}`: {what}"), None);
                }
            }
            Err(e) if e.kind() == std::io::ErrorKind::NotFound => {
                let near = nearest_file(&full).map(|n| format!("did you mean `{n}`?"));
                let what = self.loaded.what;
                let help = near.unwrap_or_else(|| format!("paths are relative to the {what} file"));
                return self.add(at, format!("there is no file `{shown}`"), Some(help));
            }
            Err(e) => return self.add(at, format!("cannot read `{shown}`: {e}"), None),
        }
        let extension = full.extension().map(|e| e.to_string_lossy().to_lowercase());
        if !extensions.is_empty() && !extension.is_some_and(|e| extensions.contains(&e.as_str())) {
            let known: Vec<String> = extensions.iter().map(|e| format!("`.{e}`")).collect();
            let message = format!("the kind of file `{shown}` is not known by its extension");
            return self.add(at, message, Some(format!("possible: {}", known.join(", "))));
        }
        if let Err(e) = File::open(&full) {
            self.add(at, format!("cannot read `{shown}`: {e}"), None);
        }
    }
}
