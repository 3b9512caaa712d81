//! Pages of the book, and what stands in them.
use std::path::{Path, PathBuf};

pub fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

pub fn read(path: &Path) -> String {
    std::fs::read_to_string(path).unwrap_or_else(|e| panic!("{}: {e}", path.display()))
}

/// All pages in `docs` and its folders, without the table of contents.
pub fn all() -> Vec<PathBuf> {
    let mut folders = vec![root().join("docs")];
    let mut pages = Vec::new();
    while let Some(folder) = folders.pop() {
        for entry in std::fs::read_dir(folder).expect("a folder of docs") {
            let path = entry.expect("entry").path();
            if path.is_dir() {
                folders.push(path);
            } else if path.extension().is_some_and(|e| e == "md") && !path.ends_with("SUMMARY.md") {
                pages.push(path);
            }
        }
    }
    pages.sort();
    pages
}

/// Targets of the links and pictures of a page, except those on the web.
pub fn links(page: &str) -> impl Iterator<Item = &str> {
    page.split("](")
        .skip(1)
        .filter_map(|rest| rest.split_once(')'))
        .map(|(target, _)| target)
        .filter(|target| !target.starts_with("http"))
}

/// A fenced block of a page.
#[derive(Debug, PartialEq)]
pub struct Block<'p> {
    /// What follows the fence: `json`, `sh`.
    pub language: &'p str,
    pub text: String,
    /// The file named at the end of the line before the block, as in "Write `press.json`:".
    pub file: Option<&'p str>,
    pub line: usize,
}

/// The fenced blocks of a page, in order.
pub fn blocks(page: &str) -> Vec<Block<'_>> {
    let mut blocks = Vec::new();
    let mut lines = page.lines().enumerate();
    let mut before = "";
    while let Some((number, line)) = lines.next() {
        let Some(language) = line.strip_prefix("```") else {
            if !line.trim().is_empty() {
                before = line;
            }
            continue;
        };
        let mut text = String::new();
        for (_, line) in lines.by_ref().take_while(|(_, line)| *line != "```") {
            text.push_str(line);
            text.push('\n');
        }
        blocks.push(Block {
            language,
            text,
            file: named(before),
            line: number + 1,
        });
        before = "";
    }
    blocks
}

/// The name in backticks at the end of a line that leads to a block.
fn named(line: &str) -> Option<&str> {
    let line = line.trim_end().strip_suffix("`:")?;
    line.rsplit_once('`').map(|(_, name)| name)
}

#[test]
fn blocks_are_found_with_their_files() {
    let page = "Text\n\nWrite `a.json`:\n\n```json\n{\n}\n```\n\nThen `run`.\n\n```sh\ngo\n```\n";
    let found = blocks(page);
    assert_eq!(found.len(), 2);
    assert_eq!(
        (found[0].file, found[0].text.as_str()),
        (Some("a.json"), "{\n}\n")
    );
    assert_eq!((found[1].file, found[1].language), (None, "sh"));
}
