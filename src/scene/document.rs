//! Text files in JSON that people write, read into types, with the place of everything in them.
use super::decode::{Decoded, decode};
use super::json::{self, Fault, Kind, Node};
use super::problem::{Lines, Place, Problem, SceneError, nearest};
use covact_geometry::io::read_within;
use serde::de::DeserializeOwned;
use std::collections::HashSet;
use std::io;
use std::ops::Range;
use std::path::{Path, PathBuf};

/// Larger files are refused: they are text written by people, meshes and CAD data have files of their own.
const MAX_BYTES: u64 = 64 << 20;

/// A type that a file holds.
pub(crate) trait Form: DeserializeOwned {
    /// What messages call it.
    const NAME: &'static str;
    /// The key that holds the version of the format.
    const KEY: &'static str;
    /// Version of the format that this program reads.
    const VERSION: u32;
    /// What to do about an empty file.
    const START: &'static str;

    /// What is wrong beyond the form; asked where the form is wrong too, with placeholders in place of what could not be
    /// read, so that one round tells of both.
    fn problems(&self, _document: &Document) -> Vec<Problem> {
        Vec::new()
    }
}

/// The text of a file that was read, so that everything found later can point into it.
#[derive(Debug, Clone)]
pub struct Document {
    /// What the file holds, e.g. "scene".
    pub what: &'static str,
    /// Name of the file as the user gave it.
    pub name: String,
    /// Folder that paths in the file are relative to.
    pub dir: PathBuf,
    /// The whole text.
    pub text: String,
    root: Node,
    lines: Lines,
}

/// Reads a file.
///
/// # Errors
/// [`SceneError`]: the file cannot be read, is not JSON, or does not have the form of a `T`.
pub(crate) fn load<T: Form>(path: &Path) -> Result<(T, Document), SceneError> {
    let what = T::NAME;
    let failed = |e: io::Error| match e.kind() {
        io::ErrorKind::NotFound => SceneError::Missing {
            what,
            path: path.to_path_buf(),
            nearest: nearest_file(path),
        },
        io::ErrorKind::FileTooLarge => SceneError::Io {
            what,
            path: path.to_path_buf(),
            reason: format!(
                "it is larger than {} MB, too large for a {what}",
                MAX_BYTES >> 20
            ),
        },
        _ => SceneError::Io {
            what,
            path: path.to_path_buf(),
            reason: e.to_string(),
        },
    };
    let bytes = read_within(path, MAX_BYTES).map_err(failed)?;
    let name = path.display().to_string();
    let text = String::from_utf8(bytes).map_err(|e| not_utf8(&name, &e))?;
    let dir = match path.parent() {
        Some(parent) if !parent.as_os_str().is_empty() => parent.to_path_buf(),
        _ => PathBuf::from("."),
    };
    parse_in(&text, &name, dir)
}

/// Reads a text; `name` stands for the file in messages. Paths in it are relative to the current folder.
///
/// # Errors
/// [`SceneError::Wrong`] with everything that is wrong, as far as faults do not follow from each other.
pub(crate) fn parse<T: Form>(text: &str, name: &str) -> Result<(T, Document), SceneError> {
    parse_in(text, name, PathBuf::from("."))
}

/// A text that a program has written, and that is not decoded: for the places of what it holds.
pub(super) fn of_program<T: Form>(text: &str, name: &str) -> Result<Document, SceneError> {
    let (document, faults) = read_in::<T>(text, name, PathBuf::from("."))?;
    match faults.is_empty() {
        true => Ok(document),
        false => Err(document.wrong(faults, Vec::new())),
    }
}

/// The tree of a text, with faults that it can be read in spite of.
fn read_in<T: Form>(
    text: &str,
    name: &str,
    dir: PathBuf,
) -> Result<(Document, Vec<Fault>), SceneError> {
    let lines = Lines::new(text);
    let mut faults = Vec::new();
    let root = json::read(text, T::NAME, T::START, &mut faults);
    let mut document = Document {
        what: T::NAME,
        name: name.to_string(),
        dir,
        text: text.to_string(),
        root: Node {
            kind: Kind::Broken,
            span: 0..0,
        },
        lines,
    };
    match root {
        Ok(root) => document.root = root,
        Err(fault) => {
            faults.push(fault);
            return Err(document.wrong(faults, Vec::new()));
        }
    }
    Ok((document, faults))
}

fn parse_in<T: Form>(text: &str, name: &str, dir: PathBuf) -> Result<(T, Document), SceneError> {
    let (document, mut faults) = read_in::<T>(text, name, dir)?;
    if let Some(fault) = other_version::<T>(&document.root) {
        // Another version's keys would only add confusing faults.
        return Err(document.wrong(vec![fault], Vec::new()));
    }
    let mut decoded = decode::<T>(&document.root);
    faults.append(&mut decoded.faults);
    match decoded.value.take() {
        Some(content) if faults.is_empty() => Ok((content, document)),
        Some(content) => {
            let further = content.problems(&document);
            let further = document.independent(further, &decoded, &faults);
            Err(document.wrong(faults, further))
        }
        None => Err(document.wrong(faults, Vec::new())),
    }
}

fn other_version<T: Form>(root: &Node) -> Option<Fault> {
    let (node, _) = root.child(T::KEY)?;
    match node.kind {
        Kind::Number(n) if n != f64::from(T::VERSION) => Some(Fault {
            message: format!("version {n} of the {} format is not known", T::NAME),
            help: Some(format!(
                "this program ({}) reads version {}",
                env!("CARGO_PKG_VERSION"),
                T::VERSION
            )),
            span: node.span.clone(),
        }),
        _ => None,
    }
}

fn not_utf8(name: &str, error: &std::string::FromUtf8Error) -> SceneError {
    let bytes = error.as_bytes();
    let at = error.utf8_error().valid_up_to();
    let text = String::from_utf8_lossy(bytes).into_owned();
    let utf16 = matches!(bytes, [0xFF, 0xFE, ..] | [0xFE, 0xFF, ..]);
    let byte = bytes.get(at).copied().unwrap_or_default();
    let problem = Problem {
        message: format!("the file is not UTF-8 text: byte 0x{byte:02X}"),
        help: Some(match utf16 {
            true => "it looks like UTF-16; save it as UTF-8".into(),
            false => "save it as UTF-8".into(),
        }),
        pointer: String::new(),
        place: Lines::new(&text).place(&text, at),
        span: at..at + 1,
    };
    SceneError::Wrong {
        name: name.to_string(),
        text,
        problems: vec![problem],
    }
}

/// A file in the same folder whose name is like that of `path`.
pub(crate) fn nearest_file(path: &Path) -> Option<String> {
    let wanted = path.file_name()?.to_str()?;
    let parent = path.parent().filter(|p| !p.as_os_str().is_empty());
    let folder = std::fs::read_dir(parent.unwrap_or(Path::new("."))).ok()?;
    let mut names: Vec<String> = folder
        .filter_map(|e| e.ok()?.file_name().into_string().ok())
        .collect();
    // The order of a folder is not defined.
    names.sort();
    nearest(wanted, names.iter().map(String::as_str)).map(str::to_string)
}

impl Document {
    /// The error that lists faults of the form, and what else was found, in the order of the file.
    fn wrong(&self, faults: Vec<Fault>, further: Vec<Problem>) -> SceneError {
        let problem = |f: Fault| Problem {
            pointer: self.root.pointer_at(f.span.start),
            place: self.lines.place(&self.text, f.span.start),
            message: f.message,
            help: f.help,
            span: f.span,
        };
        let mut problems: Vec<Problem> = faults.into_iter().map(problem).collect();
        problems.extend(further);
        problems.sort_by_key(|p| p.span.start);
        self.error(problems)
    }

    /// The problems that do not follow from the faults of the form: those at values that could be read, about things that
    /// are whole.
    fn independent<T>(
        &self,
        problems: Vec<Problem>,
        decoded: &Decoded<T>,
        faults: &[Fault],
    ) -> Vec<Problem> {
        let (incomplete, misspelt) = (&decoded.incomplete, &decoded.misspelt);
        // Where a whole section may be missing, names lead nowhere.
        if incomplete.contains(&self.root.span.start) {
            return Vec::new();
        }
        let unread =
            |n: &Node| matches!(n.kind, Kind::Broken) || decoded.replaced.contains(&n.span.start);
        // Section and name of what has a fault; no name: the whole section has.
        let faulty: HashSet<(String, Option<String>)> = (faults.iter())
            .filter_map(|f| {
                let pointer = self.root.pointer_at(f.span.start);
                let mut tokens = pointer.split('/').skip(1).map(str::to_owned);
                let (section, name) = (tokens.next()?, tokens.next());
                let lost = || self.root.child(&section).filter(|(n, _)| unread(n));
                (name.is_some() || lost().is_some()).then_some((section, name))
            })
            .collect();
        let named = |own: &str, name: &str| {
            let name = json::escape(name);
            (faulty.iter())
                .any(|(section, of)| section != own && of.as_ref().is_none_or(|of| *of == name))
        };
        let holds = |p: &Problem| {
            let (way, whole) = self.way(&p.pointer);
            let last = way[way.len() - 1];
            // What is said of a thing as a whole may come from any of its parts.
            let parts = match &last.kind {
                Kind::Object(members) => members.iter().any(|m| unread(&m.value)),
                _ => false,
            };
            let start = &last.span.start;
            let doubtful = incomplete.contains(start) || !whole && misspelt.contains(start);
            if parts || doubtful || way.iter().any(|n| unread(n)) {
                return false;
            }
            let section = p.pointer.split('/').nth(1).unwrap_or_default();
            match &last.kind {
                Kind::Text(text) => {
                    let body = text.split_once('.').map_or(text.as_str(), |(body, _)| body);
                    !named(section, text) && !named(section, body)
                }
                _ => true,
            }
        };
        problems.into_iter().filter(holds).collect()
    }

    /// The root and the values on the way to that of a JSON pointer, and whether the file has all of them.
    fn way(&self, pointer: &str) -> (Vec<&Node>, bool) {
        let mut way = vec![&self.root];
        let mut node = &self.root;
        for token in pointer.split('/').skip(1) {
            let token = token.replace("~1", "/").replace("~0", "~");
            let Some((child, _)) = node.child(&token) else {
                return (way, false);
            };
            node = child;
            way.push(node);
        }
        (way, true)
    }

    /// The content as plain JSON: without comments, places and order.
    pub(crate) fn to_json(&self) -> serde_json::Value {
        self.root.to_json()
    }

    /// Whether the file has a value at a JSON pointer, rather than a default in its place.
    pub fn has(&self, pointer: &str) -> bool {
        let mut node = &self.root;
        for token in pointer.split('/').skip(1) {
            let token = token.replace("~1", "/").replace("~0", "~");
            match node.child(&token) {
                Some((child, _)) => node = child,
                None => return false,
            }
        }
        true
    }

    /// Where the value of a JSON pointer (`/contacts/c1/slave`) starts; of the innermost value on the way to it when
    /// it is not in the file (defaults).
    pub fn place_of(&self, pointer: &str) -> Place {
        self.lines.place(&self.text, self.span_of(pointer).start)
    }

    /// Bytes of the value of a JSON pointer, as for [`Document::place_of`]. Of objects and lists, their key.
    pub fn span_of(&self, pointer: &str) -> Range<usize> {
        let mut node = &self.root;
        let mut span = node.span.start..node.span.start + 1;
        for token in pointer.split('/').skip(1) {
            let token = token.replace("~1", "/").replace("~0", "~");
            let Some((child, key)) = node.child(&token) else {
                break;
            };
            node = child;
            span = match child.kind {
                Kind::Object(_) | Kind::Array(_) => key,
                _ => child.span.clone(),
            };
        }
        span
    }

    /// A problem at a JSON pointer.
    pub fn problem(
        &self,
        pointer: &str,
        message: impl Into<String>,
        help: Option<String>,
    ) -> Problem {
        Problem {
            message: message.into(),
            help,
            pointer: pointer.to_string(),
            place: self.place_of(pointer),
            span: self.span_of(pointer),
        }
    }

    /// A problem at a part (bytes) of a text value.
    pub(crate) fn problem_within(
        &self,
        pointer: &str,
        part: Range<usize>,
        message: impl Into<String>,
        help: Option<String>,
    ) -> Problem {
        let mut problem = self.problem(pointer, message, help);
        let span = problem.span.clone();
        // With escape sequences the text and its source do not run in step; then the whole text is meant.
        let plain = self
            .text
            .get(span.clone())
            .is_some_and(|s| s.starts_with('"') && !s.contains('\\'));
        if plain && span.start + 1 + part.end < span.end {
            problem.span = span.start + 1 + part.start..span.start + 1 + part.end;
            problem.place = self.lines.place(&self.text, problem.span.start);
        }
        problem
    }

    /// The error that lists these problems.
    pub fn error(&self, problems: Vec<Problem>) -> SceneError {
        SceneError::Wrong {
            name: self.name.clone(),
            text: self.text.clone(),
            problems,
        }
    }

    /// A path in the file, which is relative to its folder.
    pub fn resolve(&self, path: &Path) -> PathBuf {
        self.dir.join(path)
    }
}

/// JSON pointer of nested names, e.g. `["contacts", "c1", "slave"]`.
pub fn pointer(tokens: &[&str]) -> String {
    tokens
        .iter()
        .map(|t| format!("/{}", json::escape(t)))
        .collect()
}
