//! The structure of an exchange file (ISO 10303-21): its sections, and where each instance stands.
//!
//! The file is checked from end to end once, and of each instance only name and place are kept. Values are read again
//! when they are asked for, so memory is bounded by the number of instances, not by their size.

use super::super::error::Fail;
use super::scan::{Damage, Item, Scanner, Value};

/// Name and place of an instance.
#[derive(Debug, Clone, Copy)]
struct Record {
    name: u64,
    /// Of the sign `#`.
    at: usize,
    /// Behind the equals sign.
    body: usize,
}

/// One leaf of an instance: an entity type and the values that it has of its own (or of all its supertypes, where the
/// instance has one leaf only).
#[derive(Debug, Clone)]
pub struct Leaf<'a> {
    pub keyword: &'a [u8],
    pub items: Vec<Item<'a>>,
    pub at: usize,
}

/// An exchange file.
pub struct Exchange<'a> {
    bytes: &'a [u8],
    /// In the order of the file.
    records: Vec<Record>,
    /// Numbers of records by ascending name.
    by_name: Vec<u32>,
    /// Whether a type of an instance is written in small letters.
    pub small_letters: bool,
    /// What is missing at the end of the data or of the file, where no instance can be.
    pub unended: Option<&'static str>,
    /// Names of the schemas.
    pub schemas: Vec<&'a [u8]>,
    /// For every block of [`BLOCK`] bytes the number of line ends in front of it and the start of the line it begins in.
    lines: Vec<(usize, usize)>,
}

const BLOCK: usize = 1 << 14;
const END: &str = "END-ISO-10303-21";

impl<'a> Exchange<'a> {
    /// Checks a whole file and lists its instances.
    pub fn read(bytes: &'a [u8]) -> Result<Self, Fail> {
        let (mut count, mut start) = (0, 0);
        let lines = bytes.chunks(BLOCK).enumerate().map(|(k, block)| {
            let before = (count, start);
            count += block.iter().filter(|&&b| b == b'\n').count();
            if let Some(last) = block.iter().rposition(|&b| b == b'\n') {
                start = k * BLOCK + last + 1;
            }
            before
        });
        let mut exchange = Self {
            bytes,
            lines: lines.collect(),
            records: Vec::new(),
            by_name: Vec::new(),
            small_letters: false,
            unended: None,
            schemas: Vec::new(),
        };
        match exchange.sections() {
            Ok(()) => {}
            Err(damage) => return Err(exchange.fail(damage)),
        }
        exchange.order()?;
        Ok(exchange)
    }

    fn fail(&self, damage: Damage) -> Fail {
        Fail::new(self.place(damage.at), damage.expected, damage.found)
    }

    /// Line and column of a byte, from 1.
    pub fn place(&self, at: usize) -> (usize, usize) {
        let at = at.min(self.bytes.len());
        let block = (at / BLOCK).min(self.lines.len().saturating_sub(1));
        let (lines, first) = self.lines.get(block).copied().unwrap_or_default();
        let before = &self.bytes[block * BLOCK..at];
        let line = lines + before.iter().filter(|&&b| b == b'\n').count();
        let last = before.iter().rposition(|&b| b == b'\n');
        let start = last.map_or(first, |k| block * BLOCK + k + 1);
        (line + 1, at - start + 1)
    }

    fn sections(&mut self) -> Result<(), Damage> {
        let mut scan = Scanner::new(self.bytes, 0);
        let start = "ISO-10303-21 at the start of a STEP file";
        if !(scan.keyword(start)?).eq_ignore_ascii_case(b"ISO-10303-21") {
            scan.at = 0;
            return Err(scan.damage(start));
        }
        scan.expect(b';', "a semicolon")?;
        let mut data = false;
        loop {
            scan.blank()?;
            let at = scan.at;
            let expected = "a section (HEADER, DATA) or END-ISO-10303-21";
            if data && scan.peek().is_none() {
                self.unended.get_or_insert(END);
                return Ok(());
            }
            let name = scan.keyword(expected)?;
            if name.eq_ignore_ascii_case(END.as_bytes()) {
                if !data {
                    scan.at = at;
                    return Err(scan.damage("a section DATA before the end"));
                }
                // The semicolon behind it is left out by some writers.
                return Ok(());
            }
            match &*name.to_ascii_uppercase() {
                b"HEADER" => {
                    scan.expect(b';', "a semicolon")?;
                    self.header(&mut scan)?;
                }
                b"DATA" => {
                    data = true;
                    scan.blank()?;
                    if scan.peek() == Some(b'(') {
                        scan.skip_list()?;
                    }
                    scan.expect(b';', "a semicolon")?;
                    self.data(&mut scan)?;
                }
                // Of the third edition: names for other files, names of other files, a digest.
                b"ANCHOR" | b"REFERENCE" | b"SIGNATURE" => {
                    let rest = &self.bytes[scan.at..];
                    let Some(end) = rest.windows(7).position(|w| w == b"ENDSEC;") else {
                        return Err(scan.damage("a section that ends (ENDSEC;)"));
                    };
                    scan.at += end + 7;
                }
                _ => {
                    scan.at = at;
                    return Err(scan.damage(expected));
                }
            }
        }
    }

    fn header(&mut self, scan: &mut Scanner<'a>) -> Result<(), Damage> {
        loop {
            scan.blank()?;
            let at = scan.at;
            let name = scan.keyword("an entry of the header or ENDSEC")?;
            if name.eq_ignore_ascii_case(b"ENDSEC") {
                return scan.expect(b';', "a semicolon after ENDSEC");
            }
            if name.eq_ignore_ascii_case(b"DATA") {
                // The header has no end of its own.
                scan.at = at;
                return Ok(());
            }
            let items = scan.list()?;
            scan.expect(b';', "a semicolon after an entry of the header")?;
            if name.eq_ignore_ascii_case(b"FILE_SCHEMA")
                && let Some(Item {
                    value: Value::List(names),
                    ..
                }) = items.first()
            {
                self.schemas = names
                    .iter()
                    .filter_map(|item| match item.value {
                        Value::Text(text) => Some(text),
                        _ => None,
                    })
                    .collect();
            }
        }
    }

    fn data(&mut self, scan: &mut Scanner<'a>) -> Result<(), Damage> {
        loop {
            scan.blank()?;
            let at = scan.at;
            if scan.peek() != Some(b'#') {
                let expected = "an instance (#12 = ...) or ENDSEC";
                let name = scan.keyword(expected)?;
                if name.eq_ignore_ascii_case(END.as_bytes()) {
                    self.unended = Some("ENDSEC at the end of the data");
                    scan.at = at;
                    return Ok(());
                }
                if !name.eq_ignore_ascii_case(b"ENDSEC") {
                    scan.at = at;
                    return Err(scan.damage(expected));
                }
                return scan.expect(b';', "a semicolon after ENDSEC");
            }
            let name = scan.name("the name of an instance (#12)")?;
            scan.expect(b'=', "an equals sign after the name of an instance")?;
            scan.blank()?;
            let body = scan.at;
            if scan.peek() == Some(b'(') {
                scan.at += 1;
                loop {
                    scan.blank()?;
                    if scan.peek() == Some(b')') {
                        scan.at += 1;
                        break;
                    }
                    scan.keyword("an entity type, or the end of an instance of several types")?;
                    scan.skip_list()?;
                }
            } else {
                let keyword = scan.keyword("an entity type (scopes are not read)")?;
                self.small_letters |= keyword.iter().any(u8::is_ascii_lowercase);
                scan.skip_list()?;
            }
            scan.expect(b';', "a semicolon after an instance")?;
            if self.records.len() >= u32::MAX as usize {
                return Err(scan.damage("fewer instances than 4294967295"));
            }
            self.records.push(Record { name, at, body });
        }
    }

    /// Sorts the instances by name, which must not be given twice.
    fn order(&mut self) -> Result<(), Fail> {
        let mut order: Vec<u32> = (0..self.records.len() as u32).collect();
        let records = &self.records;
        order.sort_by_key(|&k| records[k as usize].name);
        for pair in order.windows(2) {
            let [first, second] = [pair[0], pair[1]].map(|k| records[k as usize]);
            if first.name == second.name {
                let line = self.place(first.at).0;
                let found = format!("#{}, which stands in line {line} already", first.name);
                let expected = "the name of another instance";
                return Err(Fail::new(self.place(second.at), expected, found));
            }
        }
        self.by_name = order;
        Ok(())
    }

    /// Number of instances.
    pub fn len(&self) -> usize {
        self.records.len()
    }

    /// Length of the file.
    pub fn bytes(&self) -> usize {
        self.bytes.len()
    }

    /// Number (place in the file) of the instance with this name.
    pub fn find(&self, name: u64) -> Option<u32> {
        let at = |&k: &u32| self.records[k as usize].name;
        let k = self.by_name.binary_search_by_key(&name, at).ok()?;
        Some(self.by_name[k])
    }

    /// Name of an instance.
    pub fn name(&self, index: u32) -> u64 {
        self.records[index as usize].name
    }

    /// Largest name.
    pub fn largest_name(&self) -> u64 {
        self.by_name.last().map_or(0, |&k| self.name(k))
    }

    /// Where an instance stands.
    pub fn at(&self, index: u32) -> usize {
        self.records[index as usize].at
    }

    /// Keywords of an instance without its values, in one text: those of several types with blanks between them.
    pub fn keywords(&self, index: u32) -> Vec<&'a [u8]> {
        let mut scan = Scanner::new(self.bytes, self.records[index as usize].body);
        let mut keywords = Vec::new();
        let several = scan.peek() == Some(b'(');
        scan.at += usize::from(several);
        // What is read here was checked before.
        while let Ok(keyword) = scan.keyword("") {
            keywords.push(keyword);
            if !several || scan.skip_list().is_err() {
                break;
            }
        }
        keywords
    }

    /// The leaves of an instance with their values.
    pub fn leaves(&self, index: u32) -> Result<Vec<Leaf<'a>>, String> {
        let mut scan = Scanner::new(self.bytes, self.records[index as usize].body);
        let read = |scan: &mut Scanner<'a>| -> Result<Leaf<'a>, Damage> {
            scan.blank()?;
            let at = scan.at;
            let keyword = scan.keyword("an entity type")?;
            let items = scan.list()?;
            Ok(Leaf { keyword, items, at })
        };
        let all = |scan: &mut Scanner<'a>| -> Result<Vec<Leaf<'a>>, Damage> {
            if scan.peek() != Some(b'(') {
                return Ok(vec![read(scan)?]);
            }
            scan.at += 1;
            let mut leaves = Vec::new();
            loop {
                scan.blank()?;
                if scan.peek() == Some(b')') {
                    return Ok(leaves);
                }
                leaves.push(read(scan)?);
            }
        };
        all(&mut scan).map_err(|d| self.told(d.at, &d.expected, &d.found))
    }

    /// What is wrong at a byte, in words.
    pub fn told(&self, at: usize, expected: &str, found: &str) -> String {
        let (line, column) = self.place(at);
        format!("expected {expected}, found {found} (line {line}, column {column})")
    }
}
