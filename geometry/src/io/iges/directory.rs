//! The directory section: two records of nine 8-column fields for each entity.

use super::super::error::{Fail, show};
use super::number;
use super::params::{Delimiters, Params};
use super::records::{Record, Sections};
use std::collections::BTreeSet;
use std::ops::Range;

/// Status number (directory field 9), two digits each.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Status {
    /// Hidden in the CAD system.
    pub blanked: bool,
    /// 0 independent, 1 physically dependent, 2 logically dependent, 3 both.
    pub subordinate: u8,
    /// 0 geometry, 1 annotation, 2 definition, 3 other, 4 logical, 5 parameter space, 6 construction.
    pub purpose: u8,
}

impl Status {
    /// Exists only as a part of another entity.
    pub fn physically_dependent(self) -> bool {
        self.subordinate == 1 || self.subordinate == 3
    }
}

/// One entity of the directory.
pub struct Entry {
    /// Directory sequence number of its first record: the entity's number, odd.
    pub number: u32,
    /// Line of its first record.
    pub line: usize,
    pub type_number: u32,
    pub form: i32,
    pub status: Status,
    /// Number of its transformation matrix, 0 for none.
    pub matrix: i64,
    /// Number of its level, 0 for none; negative: the pointer to a property (406) that lists several.
    pub level: i64,
    /// Number of its colour, 0 for none; negative: the pointer to a colour definition (314).
    pub colour: i64,
    /// Entity label with subscript, or empty.
    pub label: String,
    /// Its records in the parameter section.
    pub records: Range<usize>,
}

impl Entry {
    /// The entity's values; value 0 is the type number. Bytes after column 64 are not data.
    pub fn params<'a>(
        &self,
        sections: &'a Sections<'a>,
        delimiters: Delimiters,
    ) -> Result<Params<'a>, Fail> {
        let records = &sections.parameter[self.records.clone()];
        if records.is_empty() {
            let expected = format!("parameter data of entity {}", self.number);
            return Err(Fail::new((self.line, 9), expected, "none"));
        }
        let params = Params::read(records, 64, 0, delimiters)?;
        if params.integer(0, "the entity type number")? != i64::from(self.type_number) {
            let expected = format!("entity type {}, as the directory says", self.type_number);
            return Err(params.fail(0, expected));
        }
        match params.too_long.first() {
            // Harmless in the global section, but here a count that is off may hide other values.
            Some(&place) => Err(Fail::new(
                place,
                "a string of its stated length",
                "a shorter one",
            )),
            None => Ok(params),
        }
    }
}

/// Reads all directory entries. Each must have parameter records of its own.
pub fn read(sections: &Sections, notes: &mut Vec<String>) -> Result<Vec<Entry>, Fail> {
    let mut entries = Vec::with_capacity(sections.directory.len() / 2);
    let mut owner: Vec<u32> = vec![0; sections.parameter.len()];
    let mut astray = (0usize, 0usize);
    let mut long = (0usize, 0usize);
    // Where the data of any entity begins, from 0.
    let starts = (sections.directory.iter().step_by(2)).filter_map(|r| {
        field(r, 2, "")
            .ok()
            .and_then(|s| usize::try_from(s).ok()?.checked_sub(1))
    });
    let starts: BTreeSet<usize> = starts.collect();
    for (i, pair) in sections.directory.chunks(2).enumerate() {
        let [first, second] = pair else {
            let expected = "an even number of directory records, two for each entity";
            return Err(Fail::new(
                (pair[0].line, 73),
                expected,
                sections.directory.len().to_string(),
            ));
        };
        // A file of more than 4e9 records is beyond seven columns of sequence numbers.
        let number = u32::try_from(2 * i + 1).unwrap_or(u32::MAX);
        let type_number = field(first, 1, "the entity type number")?;
        let Ok(kind) = u32::try_from(type_number) else {
            return Err(wrong(first, 1, "an entity type number"));
        };
        if field(second, 1, "the entity type number")? != type_number {
            return Err(wrong(
                second,
                1,
                format!("entity type {type_number} as in the line above"),
            ));
        }
        let records = match kind {
            0 => 0..0,
            _ => {
                let (records, cut) = claim(sections, first, second, number, &starts, &mut owner)?;
                if cut {
                    long = (long.0 + 1, if long.0 == 0 { second.line } else { long.1 });
                }
                records
            }
        };
        for record in &sections.parameter[records.clone()] {
            // Columns 66 to 72 point back to the directory. The reader does not need them.
            if number::integer(record.columns(65, 72).trim_ascii()) != Some(i64::from(number)) {
                astray = (
                    astray.0 + 1,
                    if astray.0 == 0 { record.line } else { astray.1 },
                );
            }
        }
        let form = field(second, 5, "the form number")?;
        let Ok(form) = i32::try_from(form) else {
            return Err(wrong(second, 5, "a form number"));
        };
        entries.push(Entry {
            number,
            line: first.line,
            type_number: kind,
            form,
            status: status(first)?,
            matrix: field(first, 7, "the pointer to a transformation matrix")?,
            // Nothing that is read depends on these two.
            level: field(first, 5, "a level").unwrap_or(0),
            colour: field(second, 3, "a colour").unwrap_or(0),
            label: label(second),
            records,
        });
    }
    if long.0 > 0 {
        notes.push(format!(
            "line {}: {} entities state more parameter records than there are before those of the next one; the records \
             up to there were read",
            long.1, long.0
        ));
    }
    if astray.0 > 0 {
        notes.push(format!(
            "line {}: {} parameter records do not point back to their directory entry",
            astray.1, astray.0
        ));
    }
    Ok(entries)
}

/// The parameter records that an entry points to, and whether it states more of them than there are before those of the next
/// entity. No two entities may share one: that also bounds the work that a damaged file can cause.
fn claim(
    sections: &Sections,
    first: &Record,
    second: &Record,
    number: u32,
    starts: &BTreeSet<usize>,
    owner: &mut [u32],
) -> Result<(Range<usize>, bool), Fail> {
    let total = owner.len();
    let start = field(first, 2, "the sequence number of the parameter data")?;
    let start = usize::try_from(start)
        .ok()
        .filter(|s| (1..=total).contains(s));
    let start = start.ok_or_else(|| {
        wrong(
            first,
            2,
            format!("the sequence number of parameter data, 1 to {total}"),
        )
    })? - 1;
    let count = field(second, 4, "the number of parameter records")?;
    let next = starts.range(start + 1..).next().copied();
    let room = next.unwrap_or(total).min(total) - start;
    let mut cut = false;
    let count = match usize::try_from(count) {
        // Left out: the records say themselves whose they are.
        Ok(0) => sections.parameter[start..]
            .iter()
            .take_while(|r| {
                number::integer(r.columns(65, 72).trim_ascii()) == Some(i64::from(number))
            })
            .count(),
        Ok(count) if count <= room => count,
        Ok(_) => {
            cut = true;
            room
        }
        Err(_) => {
            let expected = format!("the number of parameter records, {room} are left");
            return Err(wrong(second, 4, expected));
        }
    };
    for slot in &mut owner[start..start + count] {
        if *slot != 0 {
            let found = format!("records of entity {slot}");
            return Err(Fail::new(
                (first.line, 9),
                "parameter records of its own",
                found,
            ));
        }
        *slot = number;
    }
    Ok((start..start + count, cut))
}

fn bytes<'a>(record: &'a Record, field: usize) -> &'a [u8] {
    record.columns(8 * field - 7, 8 * field)
}

fn wrong(record: &Record, field: usize, expected: impl Into<String>) -> Fail {
    Fail::new(
        (record.line, 8 * field - 7),
        expected,
        show(bytes(record, field)),
    )
}

/// Integer in field 1 to 9; blank means 0.
fn field(record: &Record, field: usize, what: &str) -> Result<i64, Fail> {
    let text = bytes(record, field).trim_ascii();
    if text.is_empty() {
        return Ok(0);
    }
    number::integer(text).ok_or_else(|| wrong(record, field, format!("{what} (an integer)")))
}

fn status(record: &Record) -> Result<Status, Fail> {
    let mut digits = [0u8; 8];
    for (digit, &byte) in digits.iter_mut().zip(bytes(record, 9)) {
        *digit = match byte {
            b' ' => 0,
            b'0'..=b'9' => byte - b'0',
            _ => return Err(wrong(record, 9, "a status number of eight digits")),
        };
    }
    let pair = |i: usize| 10 * digits[2 * i] + digits[2 * i + 1];
    Ok(Status {
        blanked: pair(0) == 1,
        subordinate: pair(1),
        purpose: pair(2),
    })
}

fn label(record: &Record) -> String {
    let latin = |b: &[u8]| {
        b.trim_ascii()
            .iter()
            .map(|&c| c as char)
            .collect::<String>()
    };
    let (label, subscript) = (latin(bytes(record, 8)), latin(bytes(record, 9)));
    if label.is_empty() || subscript.is_empty() || subscript == "0" {
        label
    } else {
        format!("{label} {subscript}")
    }
}
