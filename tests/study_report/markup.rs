//! A strict reader of tags: names, nesting, attributes.

pub struct Tag {
    pub name: String,
    pub attributes: Vec<(String, String)>,
}

/// All opening tags of a text whose tags are balanced, whose attributes are quoted and whose text is escaped; else what is
/// wrong. Contents of `style` and `script` are not read.
pub fn tags(text: &str) -> Result<Vec<Tag>, String> {
    let mut out = Vec::new();
    let mut open: Vec<String> = Vec::new();
    let mut rest = text;
    while let Some(at) = rest.find('<') {
        plain(&rest[..at])?;
        rest = &rest[at + 1..];
        let end = rest.find('>').ok_or("a tag is not closed")?;
        let inside = &rest[..end];
        rest = &rest[end + 1..];
        if inside.starts_with("!DOCTYPE") {
            continue;
        }
        if let Some(name) = inside.strip_prefix('/') {
            let expected = open.pop().ok_or("closed too often")?;
            if expected != name {
                return Err(format!("</{name}> closes <{expected}>"));
            }
            continue;
        }
        let (inside, alone) = match inside.strip_suffix('/') {
            Some(inside) => (inside, true),
            None => (inside, false),
        };
        let tag = tag(inside)?;
        if !alone {
            if ["style", "script"].contains(&tag.name.as_str()) {
                let close = format!("</{}>", tag.name);
                let skip = rest.find(&close).ok_or("not closed")?;
                rest = &rest[skip..];
            }
            open.push(tag.name.clone());
        }
        out.push(tag);
    }
    plain(rest)?;
    match open.pop() {
        Some(name) => Err(format!("<{name}> is not closed")),
        None => Ok(out),
    }
}

fn plain(text: &str) -> Result<(), String> {
    if text.contains('>') {
        return Err(format!("`>` in the text {text:?}"));
    }
    for (at, _) in text.match_indices('&') {
        let end = text[at..].find(';').unwrap_or(0);
        if !["&amp", "&lt", "&gt", "&quot", "&apos"].contains(&&text[at..at + end]) {
            return Err(format!("`&` in the text {text:?}"));
        }
    }
    match text.chars().find(|c| c.is_control() && *c != '\n') {
        Some(c) => Err(format!("{c:?} in the text")),
        None => Ok(()),
    }
}

fn tag(inside: &str) -> Result<Tag, String> {
    let (name, mut rest) = inside.split_once(' ').unwrap_or((inside, ""));
    if name.is_empty() || !name.chars().all(|c| c.is_ascii_alphanumeric()) {
        return Err(format!("a tag of the name {name:?}"));
    }
    let mut attributes: Vec<(String, String)> = Vec::new();
    while !rest.trim().is_empty() {
        let (key, after) = rest
            .split_once("=\"")
            .ok_or(format!("an attribute without value in <{inside}>"))?;
        let (value, after) = after
            .split_once('"')
            .ok_or(format!("an attribute without end in <{inside}>"))?;
        plain(value)?;
        let key = key.trim();
        let fine = |c: char| c.is_ascii_alphanumeric() || c == '-' || c == ':';
        if !key.chars().all(fine) || attributes.iter().any(|a| a.0 == key) {
            return Err(format!("attribute {key:?} in <{inside}>"));
        }
        attributes.push((key.to_string(), value.to_string()));
        rest = after;
    }
    Ok(Tag {
        name: name.to_string(),
        attributes,
    })
}
