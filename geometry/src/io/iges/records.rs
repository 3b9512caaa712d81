//! The 80-column records of an IGES file and their sections: start, global, directory, parameter data, terminate.

use super::super::error::{Fail, show};
use super::drawing::is_annotation;
use std::borrow::Cow;

/// One record: its data (columns 1 to 72) and the line it stands on.
pub struct Record<'a> {
    /// Line of the file, from 1.
    pub line: usize,
    /// At least 72 bytes.
    text: Cow<'a, [u8]>,
}

impl Record<'_> {
    /// Columns `from..=to`, counted from 1, at most 72.
    pub fn columns(&self, from: usize, to: usize) -> &[u8] {
        &self.text[from - 1..to]
    }
}

/// The records of each section. The start section is free text and not kept.
#[derive(Default)]
pub struct Sections<'a> {
    pub global: Vec<Record<'a>>,
    pub directory: Vec<Record<'a>>,
    pub parameter: Vec<Record<'a>>,
}

const ORDER: [u8; 5] = *b"SGDPT";

/// Sorts the lines of a file into its sections and checks their order, their numbering and the totals of the
/// terminate record.
pub fn split<'a>(bytes: &'a [u8], notes: &mut Vec<String>) -> Result<Sections<'a>, Fail> {
    let mut sections = Sections::default();
    let mut counts = [0usize; 5];
    let mut section = 0;
    let mut last = (0, 0);
    let mut lines = lines(bytes).enumerate().map(|(i, text)| (i + 1, text));
    for (number, text) in &mut lines {
        last = (number, text.len());
        if text.trim_ascii().is_empty() {
            continue;
        }
        let text = as_columns(text);
        let place = (number, 73.min(text.len() + 1));
        let Some(&letter) = text.get(72) else {
            let found = format!("a line of {} characters", text.len());
            return Err(Fail::new(place, "an IGES record of 80 columns", found));
        };
        let Some(new) = ORDER.iter().position(|&c| c == letter) else {
            let found = match letter {
                b'C' if number == 1 => "a file in compressed form, which is not read".to_owned(),
                b'B' if number == 1 => "a file in binary form, which is not read".to_owned(),
                _ => show(&text[72..73]),
            };
            return Err(Fail::new(
                place,
                "the section letter S, G, D, P or T",
                found,
            ));
        };
        if new < section {
            let expected = format!("a record of section {} or later", ORDER[section] as char);
            return Err(Fail::new(
                place,
                expected,
                format!("section {}", letter as char),
            ));
        }
        section = new;
        counts[section] += 1;
        let digits = &text[73..text.len().min(80)];
        if parse_count(digits) != Some(counts[section]) {
            let expected = format!("sequence number {}{}", letter as char, counts[section]);
            return Err(Fail::new((number, 74), expected, show(digits)));
        }
        let record = Record { line: number, text };
        match letter {
            b'G' => sections.global.push(record),
            b'D' => sections.directory.push(record),
            b'P' => sections.parameter.push(record),
            b'T' => {
                check_totals(&record, &counts, notes)?;
                break;
            }
            _ => {}
        }
    }
    if counts[4] == 0 && is_complete(&sections) {
        notes.push("the terminate record T is missing; every entity is complete".to_owned());
    } else if counts[4] == 0 {
        let expected = "the terminate record T (the file is cut off)";
        let found = match of_drawing(&sections) {
            true => "the end of the file (what there is of it is a drawing, without surfaces)",
            false => "the end of the file",
        };
        return Err(Fail::new((last.0.max(1), last.1 + 1), expected, found));
    }
    if let Some((number, _)) = lines.find(|(_, text)| !text.trim_ascii().is_empty()) {
        notes.push(format!(
            "line {number}: text after the terminate record was not read"
        ));
    }
    Ok(sections)
}

/// Whether the directory ends with a whole entity, and the parameter data with the last record that an entity counts.
fn is_complete(sections: &Sections) -> bool {
    let count = |digits: &[u8]| parse_count(digits).filter(|&n| n > 0);
    let last = sections.directory.chunks(2).map(|pair| {
        let [first, second] = pair else {
            return None;
        };
        let (start, length) = (count(first.columns(9, 16))?, count(second.columns(25, 32))?);
        start.checked_add(length - 1)
    });
    // `None` for an entity that is not whole.
    let last: Option<Vec<usize>> = last.collect();
    last.and_then(|last| last.into_iter().max()) == Some(sections.parameter.len())
}

/// Whether the directory holds annotation, views or drawings and nothing that may be a surface or carry one.
fn of_drawing(sections: &Sections) -> bool {
    let types = (sections.directory.iter().step_by(2)).filter_map(|r| parse_count(r.columns(1, 8)));
    let types: Vec<u32> = types.filter_map(|t| u32::try_from(t).ok()).collect();
    let solid = |t: &u32| matches!(t, 108 | 114 | 118..=122 | 128 | 140..=198 | 502..=514);
    types.iter().any(|&t| is_annotation(t)) && !types.iter().any(solid)
}

/// The terminate record holds the number of records of each section, S, G, D, P, in 8 columns each.
fn check_totals(record: &Record, counts: &[usize; 5], notes: &mut Vec<String>) -> Result<(), Fail> {
    for (i, letter) in ORDER[..4].iter().enumerate() {
        let column = 8 * i + 1;
        let field = record.columns(column, column + 7);
        let stated = (field[0] == *letter)
            .then(|| parse_count(&field[1..]))
            .flatten();
        let Some(stated) = stated else {
            let expected = format!("the number of records of section {}", *letter as char);
            return Err(Fail::new((record.line, column), expected, show(field)));
        };
        if counts[i] < stated {
            let expected = format!("{stated} records of section {}", *letter as char);
            return Err(Fail::new(
                (record.line, column),
                expected,
                counts[i].to_string(),
            ));
        }
        if counts[i] > stated {
            notes.push(format!(
                "line {}: the terminate record counts {stated} records of section {}, there are {}",
                record.line, *letter as char, counts[i]
            ));
        }
    }
    Ok(())
}

fn parse_count(digits: &[u8]) -> Option<usize> {
    std::str::from_utf8(digits.trim_ascii()).ok()?.parse().ok()
}

/// Lines without their ends: `\n`, `\r\n` or `\r`, or none at all (records of 80 bytes back to back).
fn lines(bytes: &[u8]) -> Box<dyn Iterator<Item = &[u8]> + '_> {
    let strip = |line| <[u8]>::strip_suffix(line, b"\r").unwrap_or(line);
    if bytes.contains(&b'\n') {
        Box::new(bytes.split(|&b| b == b'\n').map(strip))
    } else if bytes.contains(&b'\r') {
        Box::new(bytes.split(|&b| b == b'\r'))
    } else {
        Box::new(bytes.chunks(80))
    }
}

/// The standard knows ASCII only. Latin-1 bytes take one column each; where a writer counted UTF-8 characters as one
/// column, the section letter stands too far right, and the line is counted in characters instead.
fn as_columns(line: &[u8]) -> Cow<'_, [u8]> {
    let misplaced = line.len() > 80 && !line.get(72).is_some_and(|c| ORDER.contains(c));
    if misplaced
        && !line.is_ascii()
        && let Ok(text) = std::str::from_utf8(line)
    {
        return text
            .chars()
            .map(|c| u8::try_from(u32::from(c)).unwrap_or(b'?'))
            .collect();
    }
    Cow::Borrowed(line)
}
