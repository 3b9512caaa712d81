//! Keyword and data lines of an input file.
use crate::mesh::field::Field;

/// Comma-separated fields of a line. A comma at the end starts no field.
pub(super) fn fields(line: &str, number: usize) -> impl Iterator<Item = Field<'_>> {
    let line = line.trim_end();
    let line = line.strip_suffix(',').unwrap_or(line);
    // Counted on, as lines may be long.
    let mut start = 0;
    line.split(',').map(move |part| {
        let blanks = part.chars().take_while(|c| c.is_whitespace()).count();
        let column = start + blanks + 1;
        start += part.chars().count() + 1;
        Field {
            text: part.trim(),
            line: number,
            column,
        }
    })
}

/// A keyword line: its name in capitals without blanks, and its parameters (name in capitals, value).
pub(super) struct Keyword<'a> {
    pub name: String,
    pub at: Field<'a>,
    parameters: Vec<(String, Field<'a>)>,
}

impl<'a> Keyword<'a> {
    pub fn new(line: &'a str, number: usize) -> Option<Keyword<'a>> {
        let mut parts = fields(line, number);
        let at = parts.next()?;
        let mut keyword = Keyword {
            name: squeezed(at.text),
            at,
            parameters: Vec::new(),
        };
        keyword.extend(parts);
        Some(keyword)
    }

    /// Takes the parameters of a continuation line.
    pub fn extend(&mut self, parts: impl Iterator<Item = Field<'a>>) {
        // A line of commas alone would need far more memory than itself.
        for part in parts.filter(|part| !part.text.is_empty()) {
            let (name, value) = part.text.split_once('=').unwrap_or((part.text, ""));
            let field = Field {
                text: value.trim().trim_matches('"'),
                ..part
            };
            self.parameters.push((squeezed(name), field));
        }
    }

    pub fn get(&self, name: &str) -> Option<Field<'a>> {
        self.parameters.iter().find(|p| p.0 == name).map(|p| p.1)
    }
}

fn squeezed(text: &str) -> String {
    text.chars()
        .filter(|c| !c.is_whitespace())
        .collect::<String>()
        .to_uppercase()
}
