//! What can be wrong with a scene (or a study, which is read alike), and where in the file.
use serde::Serialize;
use std::fmt;
use std::ops::Range;
use std::path::PathBuf;

/// A place in a text file; both numbers start at 1, columns count characters.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize)]
pub struct Place {
    /// Line, from 1.
    pub line: usize,
    /// Column, from 1, in characters.
    pub column: usize,
}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}:{}", self.line, self.column)
    }
}

/// One thing that is wrong in a scene.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Problem {
    /// What is wrong, in one sentence.
    pub message: String,
    /// What would be right: the nearest valid name, the list of names, a rule.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub help: Option<String>,
    /// JSON pointer (RFC 6901) of the value it belongs to, e.g. `/bodies/sheet/mesh/plate`.
    pub pointer: String,
    /// Where it stands in the text.
    #[serde(flatten)]
    pub place: Place,
    /// Bytes of the scene's text that are meant.
    #[serde(skip)]
    pub span: Range<usize>,
}

impl fmt::Display for Problem {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: {}", self.place, self.message)?;
        match &self.help {
            Some(help) => write!(f, " ({help})"),
            None => Ok(()),
        }
    }
}

/// Why a scene could not be read.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum SceneError {
    /// The file is not there, or is a folder.
    #[error("there is no {what} file `{}`{}", .path.display(), hint(.nearest))]
    Missing {
        /// What the file should hold, e.g. "scene".
        what: &'static str,
        /// The file that was asked for.
        path: PathBuf,
        /// A file of a similar name in the same folder.
        nearest: Option<String>,
    },
    /// The operating system refused to read the file.
    #[error("cannot read the {what} `{}`: {reason}", .path.display())]
    Io {
        /// What the file should hold, e.g. "scene".
        what: &'static str,
        /// The file.
        path: PathBuf,
        /// What the operating system says.
        reason: String,
    },
    /// The text is no valid scene.
    #[error("{}", listing(.name, .problems))]
    Wrong {
        /// Name of the scene as the user gave it.
        name: String,
        /// Text of the scene (bytes that are not UTF-8 replaced).
        text: String,
        /// At least one problem, in the order of the file.
        problems: Vec<Problem>,
    },
}

impl SceneError {
    /// Place of the first problem, where there is one.
    pub fn place(&self) -> Option<Place> {
        match self {
            SceneError::Wrong { problems, .. } => problems.first().map(|p| p.place),
            _ => None,
        }
    }
}

fn hint(nearest: &Option<String>) -> String {
    nearest
        .as_ref()
        .map_or(String::new(), |n| format!("; did you mean `{n}`?"))
}

/// One line a problem, each as `file:line:column: message`.
fn listing(name: &str, problems: &[Problem]) -> String {
    let lines: Vec<String> = problems.iter().map(|p| format!("{name}:{p}")).collect();
    lines.join("\n")
}

/// Line starts of a text.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Lines {
    starts: Vec<usize>,
}

impl Lines {
    pub fn new(text: &str) -> Lines {
        let ends = text
            .bytes()
            .enumerate()
            .filter(|(_, b)| *b == b'\n')
            .map(|(i, _)| i + 1);
        Lines {
            starts: std::iter::once(0).chain(ends).collect(),
        }
    }

    /// Place of a byte offset of `text`, the text these lines were made from.
    pub fn place(&self, text: &str, offset: usize) -> Place {
        let offset = offset.min(text.len());
        let line = self.starts.partition_point(|&s| s <= offset).max(1);
        let start = self.starts[line - 1];
        let before = text.as_bytes().get(start..offset).unwrap_or_default();
        // Bytes 10xxxxxx continue a character.
        let column = 1 + before.iter().filter(|b| (**b & 0xC0) != 0x80).count();
        Place { line, column }
    }
}

/// Names beyond this many are counted in messages, not listed.
const MOST_LISTED: usize = 30;
/// Bytes of a name.
pub(super) const MOST_IN_NAME: usize = 200;
/// Texts of more bytes than this are not compared letter by letter, which takes time like the product of their lengths.
const MOST_COMPARED: usize = 48;
/// Names of nearly the same letters that one is compared with.
const MOST_COMPARISONS: usize = 30;
/// Problems beyond this many are not looked for.
pub(super) const MOST_PROBLEMS: usize = 200;

/// The candidate closest to what was written, if one is close enough to be meant.
pub fn nearest<'a>(
    written: &str,
    candidates: impl IntoIterator<Item = &'a str>,
) -> Option<&'a str> {
    let lower = written.to_lowercase();
    let length = lower.chars().count();
    let mut compared = 0;
    candidates
        .into_iter()
        .filter_map(|c| {
            let other = c.to_lowercase();
            let other_length = other.chars().count();
            let allowed = (length.max(other_length) / 3).clamp(1, 3);
            // A part of the right name (`slave` for `slaves`, `E-modulus` for `E` is not) also counts.
            let part = length >= 3
                && (other.contains(&lower) || lower.contains(&other) && other.len() >= 3);
            if part {
                return Some((length.abs_diff(other_length), c));
            }
            // Every change of a letter changes at most one of the letters that both have.
            let may_be_near = length.abs_diff(other_length) <= allowed
                && lower.len() <= MOST_COMPARED
                && length.max(other_length) - in_common(&lower, &other) <= allowed;
            if !may_be_near || compared == MOST_COMPARISONS {
                return None;
            }
            compared += 1;
            let distance = strsim::damerau_levenshtein(&lower, &other);
            (distance <= allowed && distance < length.max(1)).then_some((distance, c))
        })
        .min_by_key(|(distance, _)| *distance)
        .map(|(_, c)| c)
        .filter(|c| *c != written)
}

/// How many letters two texts have in common, wherever they stand; letters beyond ASCII count as one.
fn in_common(one: &str, other: &str) -> usize {
    let mut counts = [0u8; 128];
    let place = |c: char| if c.is_ascii() { c as usize } else { 0 };
    for c in one.chars() {
        let count = &mut counts[place(c)];
        *count = count.saturating_add(1);
    }
    let mut common = 0;
    for c in other.chars() {
        let count = &mut counts[place(c)];
        common += usize::from(*count > 0);
        *count = count.saturating_sub(1);
    }
    common
}

/// "did you mean `b`? Known keys: `a`, `b`" in the words of `what`.
pub(crate) fn suggestion<'a>(
    written: &str,
    what: &str,
    candidates: impl IntoIterator<Item = &'a str> + Clone,
) -> String {
    let list = listed(candidates.clone());
    let known = match list.is_empty() {
        true => format!("there are no {what}"),
        false => format!("{what}: {list}"),
    };
    match nearest(written, candidates) {
        Some(near) => format!("did you mean `{near}`? {known}"),
        None => known,
    }
}

/// Names for a message, the first ones where there are many: "`a`, `b`".
pub(super) fn listed<'a>(names: impl IntoIterator<Item = &'a str>) -> String {
    let mut names = names.into_iter();
    let mut list: Vec<String> = (names.by_ref().take(MOST_LISTED))
        .map(|name| format!("`{}`", shorten(name)))
        .collect();
    match names.count() {
        0 => {}
        more => list.push(format!("and {more} more")),
    }
    list.join(", ")
}

/// At most 40 characters of a text.
pub(crate) fn shorten(text: &str) -> String {
    match text.char_indices().nth(40) {
        Some((i, _)) => format!("{}...", &text[..i]),
        None => text.to_string(),
    }
}
