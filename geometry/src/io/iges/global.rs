//! The global section: delimiters, length unit, resolution.

use super::super::LengthUnit;
use super::super::error::{Fail, show};
use super::params::{Delimiters, Params, join};
use super::records::Sections;

/// The global parameters that the reader needs.
pub struct Global {
    pub delimiters: Delimiters,
    /// Unit of the real object (global parameters 14 and 15).
    pub unit: LengthUnit,
    /// Model space per real space (global parameter 13): coordinates are divided by it.
    pub scale: f64,
    /// Smallest distance that the writer tells apart (global parameter 19), in model space; 0 counts as not given.
    pub resolution: Option<f64>,
}

const WIDTH: usize = 72;

pub fn read(sections: &Sections, notes: &mut Vec<String>) -> Result<Global, Fail> {
    let records = &sections.global;
    let Some(first) = records.first() else {
        let line = sections.directory.first().map_or(1, |r| r.line);
        return Err(Fail::new((line, 73), "the global section G", "none"));
    };
    let text = join(records, WIDTH);
    let place = |at: usize| (first.line + at / WIDTH, at % WIDTH + 1);
    let (delimiters, start) = delimiters(&text, place)?;
    let params = Params::read(records, WIDTH, start, delimiters)?;
    for (line, column) in &params.too_long {
        notes.push(format!(
            "line {line}, column {column}: the string is shorter than its stated length"
        ));
    }
    // Values here are counted from 0 after the two delimiters: global parameter k is value k - 3.
    let scale = if params.is_default(10) {
        1.0
    } else {
        params.real(10, "the model space scale")?
    };
    if scale <= 0.0 {
        return Err(params.fail(10, "a positive model space scale"));
    }
    if scale != 1.0 {
        notes.push(format!(
            "model space scale {scale}: all coordinates were divided by it"
        ));
    }
    let unit = unit(&params, notes)?;
    let resolution = if params.is_default(16) {
        0.0
    } else {
        params.real(16, "the minimum resolution")?
    };
    if resolution < 0.0 {
        return Err(params.fail(16, "a minimum resolution that is not negative"));
    }
    Ok(Global {
        delimiters,
        unit,
        scale,
        resolution: (resolution > 0.0).then_some(resolution),
    })
}

/// The first two global parameters, `1H,` and `1H;` unless left out, say which characters delimit. Returns where the
/// third parameter begins.
fn delimiters(
    text: &[u8],
    place: impl Fn(usize) -> (usize, usize),
) -> Result<(Delimiters, usize), Fail> {
    let mut at = text.iter().take_while(|&&b| b == b' ').count();
    let declared = |at: usize| {
        text[at..]
            .strip_prefix(b"1H")
            .and_then(|rest| rest.first().copied())
    };
    let check = |at: usize, c: u8| {
        if c.is_ascii_graphic() && !c.is_ascii_digit() && !b"+-.DEH".contains(&c) {
            Ok(c)
        } else {
            Err(Fail::new(
                place(at),
                "a character that can be a delimiter",
                show(&[c]),
            ))
        }
    };
    let parameter = match declared(at) {
        Some(c) => {
            let c = check(at + 2, c)?;
            at += 3;
            c
        }
        None => b',',
    };
    let separator = |at: usize| {
        let found = text.get(at).map_or("nothing".to_owned(), |&c| show(&[c]));
        Fail::new(
            place(at),
            format!("the parameter delimiter \"{}\"", parameter as char),
            found,
        )
    };
    if text.get(at) != Some(&parameter) {
        return Err(separator(at));
    }
    at += 1;
    at += text[at..].iter().take_while(|&&b| b == b' ').count();
    let record = match declared(at) {
        Some(c) => {
            let c = check(at + 2, c)?;
            at += 3;
            c
        }
        None => b';',
    };
    if record == parameter {
        let expected = "two different delimiters";
        return Err(Fail::new(
            place(at.saturating_sub(1)),
            expected,
            show(&[record]),
        ));
    }
    match text.get(at) {
        Some(&c) if c == parameter => at += 1,
        // Everything else is left out.
        Some(&c) if c == record => {}
        _ => return Err(separator(at)),
    }
    Ok((Delimiters { parameter, record }, at))
}

/// Units flag (parameter 14) and units name (15); without them the standard means inches.
fn unit(params: &Params, notes: &mut Vec<String>) -> Result<LengthUnit, Fail> {
    const FLAGS: [(i64, &str); 10] = [
        (1, "in"),
        (2, "mm"),
        (4, "ft"),
        (5, "mi"),
        (6, "m"),
        (7, "km"),
        (8, "mil"),
        (9, "um"),
        (10, "cm"),
        (11, "uin"),
    ];
    let named = params.string(12, "the name of the length unit")?;
    let known = named.as_deref().and_then(LengthUnit::from_name);
    let flag = if params.is_default(11) {
        1
    } else {
        params.integer(11, "the units flag")?
    };
    if flag == 3 && named.as_deref().is_none_or(|name| name.trim().is_empty()) {
        notes.push(format!(
            "line {}: the units flag is 3, but there is no name of a unit; the unit is {}",
            params.place_of(11).0,
            LengthUnit::unspecified().name
        ));
        return Ok(LengthUnit::unspecified());
    }
    if flag == 3 {
        return known.ok_or_else(|| {
            params.fail(
                12,
                "the name of a length unit (MM, IN, M, ...), as the units flag is 3",
            )
        });
    }
    if flag == 0 {
        // No flag of the standard; the name counts, if there is one.
        let unit = known.unwrap_or_else(LengthUnit::unspecified);
        notes.push(format!(
            "line {}: the units flag is 0, which stands for no unit; the unit is {}",
            params.place_of(11).0,
            unit.name
        ));
        return Ok(unit);
    }
    let symbol = FLAGS.iter().find(|f| f.0 == flag).map(|f| f.1);
    let unit = symbol.and_then(LengthUnit::from_name);
    let unit = unit.ok_or_else(|| params.fail(11, "a units flag from 1 to 11"))?;
    match named {
        _ if params.is_default(11) && named.is_some() && known.as_ref() != Some(&unit) => {
            // A name without a flag would contradict the default flag: refuse to guess.
            Err(params.fail(11, "the units flag, as the unit has a name"))
        }
        Some(name) if known.as_ref() != Some(&unit) => {
            notes.push(format!(
                "line {}: the units flag {flag} means {}, the unit's name is \"{name}\"; the flag counts",
                params.place_of(11).0,
                unit.name
            ));
            Ok(unit)
        }
        _ => Ok(unit),
    }
}
