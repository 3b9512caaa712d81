//! Text inside HTML and SVG.

pub(crate) use crate::output::escaped;

/// Escaped text; what stands between backquotes is set as code, and a power after `^` is raised.
pub(crate) fn prose(text: &str) -> String {
    let mut out = String::new();
    let parts: Vec<&str> = text.split('`').collect();
    for (i, part) in parts.iter().enumerate() {
        if i % 2 == 1 && i + 1 < parts.len() {
            out.push_str(&format!("<code>{}</code>", escaped(part)));
        } else {
            if i % 2 == 1 {
                out.push('`');
            }
            out.push_str(&raised(&escaped(part)));
        }
    }
    unbroken(&out)
}

/// Spaces between a number and its unit, and in "8 x 8", where no line is to end.
fn unbroken(text: &str) -> String {
    let chars: Vec<char> = text.chars().collect();
    let digit = |i: Option<usize>| {
        i.and_then(|i| chars.get(i))
            .is_some_and(char::is_ascii_digit)
    };
    let ends = |i: usize| chars.get(i).is_none_or(|c| !c.is_alphanumeric());
    let mut out = String::with_capacity(text.len() + 16);
    for (i, &c) in chars.iter().enumerate() {
        let at = |k: usize| chars.get(i + k).copied();
        let before = digit(i.checked_sub(1));
        let unit = matches!(at(1), Some('%' | 's' | 'h')) && ends(i + 2)
            || at(1) == Some('m') && at(2) == Some('s') && ends(i + 3);
        let into_cross = matches!(at(1), Some('x' | '×')) && at(2) == Some(' ');
        let past_cross = digit(Some(i + 1))
            && i > 1
            && matches!(chars[i - 1], 'x' | '×')
            && matches!(chars[i - 2], ' ');
        let keep = before && (unit || into_cross && digit(Some(i + 3))) || past_cross;
        out.push(if c == ' ' && keep { '\u{a0}' } else { c });
    }
    out
}

/// `h^1.9` with its power raised.
fn raised(text: &str) -> String {
    let mut out = String::new();
    let mut rest = text;
    while let Some(at) = rest.find('^') {
        let power = &rest[at + 1..];
        let mut end = power
            .find(|c: char| !(c.is_ascii_digit() || c == '.' || c == '-' || c == '−'))
            .unwrap_or(power.len());
        // A full stop behind the power ends the sentence.
        if power[..end].ends_with('.') {
            end -= 1;
        }
        if end == 0 {
            out.push_str(&rest[..=at]);
        } else {
            out.push_str(&format!("{}<sup>{}</sup>", &rest[..at], &power[..end]));
        }
        rest = &power[end..];
    }
    out + rest
}

/// A name for a file, of letters, digits and hyphens.
pub(crate) fn slug(name: &str) -> String {
    let mut out = String::new();
    for c in name.chars().take(60) {
        if c.is_ascii_alphanumeric() {
            out.push(c.to_ascii_lowercase());
        } else if !out.is_empty() && !out.ends_with('-') {
            out.push('-');
        }
    }
    let out = out.trim_end_matches('-');
    if out.is_empty() { "x" } else { out }.to_string()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_means_something_is_escaped() {
        assert_eq!(
            escaped("a<b & \"c\"\u{1}'>"),
            "a&lt;b &amp; &quot;c&quot; &apos;&gt;"
        );
        assert_eq!(
            prose("h^1.9. `a<b` 1 %"),
            "h<sup>1.9</sup>. <code>a&lt;b</code> 1\u{a0}%"
        );
        assert_eq!(
            prose("8 x 16 x 2 costs 3 s, 1 ms"),
            "8\u{a0}x\u{a0}16\u{a0}x\u{a0}2 costs 3\u{a0}s, 1\u{a0}ms"
        );
        assert_eq!(prose("one ` only ^ x"), "one ` only ^ x");
        assert_eq!(slug("Punch force (N) <z>"), "punch-force-n-z");
        assert_eq!(slug("«»"), "x");
    }
}
