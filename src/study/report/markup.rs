//! Text inside HTML and SVG.

/// Text with the characters escaped that mean something in HTML and XML, and without those that XML does not allow.
pub(crate) fn escaped(text: &str) -> String {
    let mut out = String::with_capacity(text.len() + 8);
    for c in text.chars() {
        match c {
            '&' => out.push_str("&amp;"),
            '<' => out.push_str("&lt;"),
            '>' => out.push_str("&gt;"),
            '"' => out.push_str("&quot;"),
            '\'' => out.push_str("&#39;"),
            '\t' | '\n' | '\r' => out.push(' '),
            c if c.is_control() || c == '\u{fffe}' || c == '\u{ffff}' => {}
            c => out.push(c),
        }
    }
    out
}

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
    out.replace(" %", "\u{a0}%")
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
            "a&lt;b &amp; &quot;c&quot;&#39;&gt;"
        );
        assert_eq!(
            prose("h^1.9. `a<b` 1 %"),
            "h<sup>1.9</sup>. <code>a&lt;b</code> 1\u{a0}%"
        );
        assert_eq!(prose("one ` only ^ x"), "one ` only ^ x");
        assert_eq!(slug("Punch force (N) <z>"), "punch-force-n-z");
        assert_eq!(slug("«»"), "x");
    }
}
