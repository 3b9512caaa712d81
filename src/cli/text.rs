//! Text that people read in a terminal.

/// Columns that it fits in.
pub(super) const COLUMNS: usize = 80;
/// By how much the lines that go on are moved in.
const HANGING: &str = "    ";

/// The text with its lines broken where they are too long, and what goes on moved in.
pub(super) fn folded(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for line in text.lines() {
        let start = line.len() - line.trim_start().len();
        let indent = format!("{}{HANGING}", &line[..start]);
        let options = textwrap::Options::new(COLUMNS)
            .subsequent_indent(&indent)
            .break_words(false);
        out += &textwrap::fill(line, options);
        out.push('\n');
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn long_lines_go_on_below() {
        let line = format!("  area  {} end", "word ".repeat(30));
        let text = folded(&format!("{line}\n\nshort  one\n"));
        let lines: Vec<&str> = text.lines().collect();
        assert!(lines.iter().all(|l| l.chars().count() <= COLUMNS));
        assert!(lines[0].starts_with("  area  word") && lines[1].starts_with("      word"));
        assert_eq!(lines[lines.len() - 2..], ["", "short  one"]);
        let words = |text: &str| {
            text.split_whitespace()
                .map(str::to_owned)
                .collect::<Vec<_>>()
        };
        assert_eq!(words(&text), words(&format!("{line} short one")));
    }
}
