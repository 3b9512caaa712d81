//! The history table: a line of numbers per accepted step.
use super::OutputError;
use super::atomic::{Replaceable, replaceable, sync, write_soon};
use super::columns::documented;
use super::sum::Sum;
use std::collections::HashMap;
use std::fmt::Write as _;
use std::fs::{File, OpenOptions};
use std::io::{self, Read};
use std::path::{Path, PathBuf};

/// A CSV file that grows by one whole line at a time: whoever stops the program finds complete lines. Numbers are the
/// shortest that read back as the same double.
#[derive(Debug)]
pub struct History {
    path: PathBuf,
    columns: Vec<String>,
    index: HashMap<String, usize>,
    file: File,
    /// Bytes that are whole lines.
    length: u64,
    /// Sum of them.
    sum: Sum,
    line: String,
}

/// Where a table ended, so that a run that was interrupted finds its place.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct HistoryMark {
    /// Bytes of the table.
    pub length: u64,
    /// Checksum of them.
    pub sum: u64,
}

impl History {
    /// Replaces `path` by a table without rows.
    ///
    /// # Errors
    /// [`OutputError::UnknownColumn`] for a column that [`super::COLUMNS`] does not document,
    /// [`OutputError::DuplicateColumn`], or the operating system's.
    pub fn create(path: &Path, columns: Vec<String>) -> Result<Self, OutputError> {
        let index = places(&columns)?;
        let mut line = columns
            .iter()
            .map(|c| quoted(c))
            .collect::<Vec<_>>()
            .join(",");
        line.push('\n');
        write_soon(path, line.as_bytes())?;
        let file = OpenOptions::new()
            .append(true)
            .open(path)
            .map_err(|e| OutputError::io("open", path, e))?;
        let mut sum = Sum::new();
        sum.add(line.as_bytes());
        Ok(History {
            path: path.to_path_buf(),
            columns,
            index,
            file,
            length: line.len() as u64,
            sum,
            line,
        })
    }

    /// Goes on with the table at `path` from where it was at `mark`; what came after is cut off. Nothing where the table
    /// does not begin with what was there then, and it is left as it is.
    ///
    /// # Errors
    /// As [`History::create`].
    pub fn resume(
        path: &Path,
        columns: Vec<String>,
        mark: HistoryMark,
    ) -> Result<Option<Self>, OutputError> {
        let index = places(&columns)?;
        let failed = |action, e| OutputError::io(action, path, e);
        // A run leaves no links; what one points to is not ours to write to.
        if replaceable(path)? == Replaceable::Link {
            return Ok(None);
        }
        let mut options = OpenOptions::new();
        let mut file = match options.read(true).append(true).open(path) {
            Err(e) if e.kind() == io::ErrorKind::NotFound => return Ok(None),
            opened => opened.map_err(|e| failed("open", e))?,
        };
        let (mut sum, mut left) = (Sum::new(), mark.length);
        let mut buffer = [0; 1 << 14];
        while left > 0 {
            let most = left.min(buffer.len() as u64) as usize;
            let read = file
                .read(&mut buffer[..most])
                .map_err(|e| failed("read", e))?;
            if read == 0 {
                return Ok(None);
            }
            sum.add(&buffer[..read]);
            left -= read as u64;
        }
        if sum.value() != mark.sum {
            return Ok(None);
        }
        file.set_len(mark.length).map_err(|e| failed("write", e))?;
        Ok(Some(History {
            path: path.to_path_buf(),
            columns,
            index,
            file,
            length: mark.length,
            sum,
            line: String::new(),
        }))
    }

    /// Where the table ends now.
    pub fn mark(&self) -> HistoryMark {
        HistoryMark {
            length: self.length,
            sum: self.sum.value(),
        }
    }

    /// Column names, from left to right.
    pub fn columns(&self) -> &[String] {
        &self.columns
    }

    /// Place of a column in a row.
    pub fn column(&self, name: &str) -> Option<usize> {
        self.index.get(name).copied()
    }

    /// Brings all rows to the disk.
    ///
    /// # Errors
    /// The operating system's.
    pub fn sync(&self) -> Result<(), OutputError> {
        (sync(&self.file)).map_err(|e| OutputError::io("write", &self.path, e))
    }

    /// Appends a row, one number per column (NaN where there is none). The row outlives the process, but not a crash of the
    /// machine before [`History::sync`]. On failure, what was written of the line is taken back.
    pub fn push(&mut self, row: &[f64]) -> Result<(), OutputError> {
        if row.len() != self.columns.len() {
            return Err(OutputError::RowLength {
                path: self.path.clone(),
                expected: self.columns.len(),
                found: row.len(),
            });
        }
        self.line.clear();
        for (i, &x) in row.iter().enumerate() {
            if i > 0 {
                self.line.push(',');
            }
            push_number(&mut self.line, x);
        }
        self.line.push('\n');
        // A file that was removed takes rows that nobody will ever see.
        if removed(&self.file) {
            let gone = io::Error::new(io::ErrorKind::NotFound, "it was removed during the run");
            return Err(OutputError::io("write", &self.path, gone));
        }
        match append(&mut self.file, self.line.as_bytes(), self.length) {
            Ok(()) => {
                self.length += self.line.len() as u64;
                self.sum.add(self.line.as_bytes());
                Ok(())
            }
            Err(e) => Err(OutputError::io("write", &self.path, e)),
        }
    }
}

/// Whether an open file has no name any more.
fn removed(file: &File) -> bool {
    #[cfg(unix)]
    {
        use std::os::unix::fs::MetadataExt;
        file.metadata().is_ok_and(|meta| meta.nlink() == 0)
    }
    #[cfg(not(unix))]
    {
        let _ = file;
        false
    }
}

/// Places of columns that are documented and named once.
fn places(columns: &[String]) -> Result<HashMap<String, usize>, OutputError> {
    let mut index = HashMap::with_capacity(columns.len());
    for (i, column) in columns.iter().enumerate() {
        if !documented(column) {
            return Err(OutputError::UnknownColumn(column.clone()));
        }
        if index.insert(column.clone(), i).is_some() {
            return Err(OutputError::DuplicateColumn(column.clone()));
        }
    }
    Ok(index)
}

/// A sink whose end can be taken back.
pub(crate) trait Truncate: io::Write {
    fn truncate(&mut self, length: u64) -> io::Result<()>;
}

impl Truncate for File {
    fn truncate(&mut self, length: u64) -> io::Result<()> {
        self.set_len(length)
    }
}

/// Appends all of `line` or nothing: on failure the sink is cut to its `length` before.
pub(crate) fn append<S: Truncate>(sink: &mut S, line: &[u8], length: u64) -> io::Result<()> {
    (sink.write_all(line).and_then(|()| sink.flush())).inspect_err(|_| {
        // The first error is the one to report.
        let _ = sink.truncate(length);
    })
}

/// The shortest text that reads back as `x`; whole numbers without a point.
pub(crate) fn push_number(text: &mut String, x: f64) {
    // Writing to a String does not fail.
    let _ = if x.is_finite() && x.fract() == 0.0 && x.abs() < 1e15 {
        write!(text, "{x}")
    } else {
        write!(text, "{x:?}")
    };
}

/// A CSV cell, quoted where it has to be (RFC 4180).
fn quoted(text: &str) -> String {
    if text.contains([',', '"', '\n', '\r']) {
        format!("\"{}\"", text.replace('"', "\"\""))
    } else {
        text.to_string()
    }
}

/// A table read back.
#[derive(Debug, Clone, PartialEq)]
pub struct Table {
    /// Column names, from left to right.
    pub columns: Vec<String>,
    /// Rows from top to bottom, a number per column.
    pub rows: Vec<Vec<f64>>,
}

impl Table {
    /// The numbers of a column from top to bottom.
    pub fn column(&self, name: &str) -> Option<Vec<f64>> {
        let i = self.columns.iter().position(|c| c == name)?;
        Some(self.rows.iter().map(|row| row[i]).collect())
    }
}

/// Reads a table of numbers with a line of names on top, as [`History`] writes it.
///
/// # Errors
/// [`OutputError::Table`] with the line that has the wrong number of cells, or a cell that is no number.
pub fn read_csv(path: &Path) -> Result<Table, OutputError> {
    let text = std::fs::read_to_string(path).map_err(|e| OutputError::io("read", path, e))?;
    let wrong = |line: usize, reason: String| OutputError::Table {
        path: path.to_path_buf(),
        line,
        reason,
    };
    let mut records = records(&text).map_err(|line| wrong(line, "a quote is not closed".into()))?;
    if records.is_empty() {
        return Err(wrong(1, "there is no line of column names".into()));
    }
    let (_, columns) = records.remove(0);
    let mut rows = Vec::with_capacity(records.len());
    for (line, cells) in records {
        if cells.len() != columns.len() {
            let reason = format!("{} cells under {} columns", cells.len(), columns.len());
            return Err(wrong(line, reason));
        }
        let row = cells
            .iter()
            .map(|cell| {
                let number = cell.trim().parse::<f64>();
                number.map_err(|_| wrong(line, format!("`{cell}` is not a number")))
            })
            .collect::<Result<Vec<_>, _>>()?;
        rows.push(row);
    }
    Ok(Table { columns, rows })
}

/// Splits CSV text into records with the line each starts at; the error is the line of a quote that is not closed.
fn records(text: &str) -> Result<Vec<(usize, Vec<String>)>, usize> {
    let mut out = Vec::new();
    let mut cells = Vec::new();
    let mut cell = String::new();
    let (mut line, mut start) = (1, 1);
    let mut quote_line = None;
    let mut chars = text.chars().peekable();
    while let Some(c) = chars.next() {
        match (c, quote_line.is_some()) {
            ('"', true) if chars.peek() == Some(&'"') => {
                chars.next();
                cell.push('"');
            }
            ('"', true) => quote_line = None,
            ('"', false) if cell.is_empty() => quote_line = Some(line),
            (',', false) => cells.push(std::mem::take(&mut cell)),
            ('\r', false) if chars.peek() == Some(&'\n') => {}
            ('\n', false) => {
                cells.push(std::mem::take(&mut cell));
                out.push((start, std::mem::take(&mut cells)));
                start = line + 1;
            }
            (c, _) => cell.push(c),
        }
        if c == '\n' {
            line += 1;
        }
    }
    if let Some(line) = quote_line {
        return Err(line);
    }
    if !cell.is_empty() || !cells.is_empty() {
        cells.push(cell);
        out.push((start, cells));
    }
    Ok(out)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[derive(Default)]
    struct Full {
        data: Vec<u8>,
        room: usize,
    }

    impl io::Write for Full {
        fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
            let n = bytes.len().min(self.room - self.data.len());
            if n == 0 {
                return Err(io::ErrorKind::StorageFull.into());
            }
            self.data.extend_from_slice(&bytes[..n]);
            Ok(n)
        }
        fn flush(&mut self) -> io::Result<()> {
            Ok(())
        }
    }

    impl Truncate for Full {
        fn truncate(&mut self, length: u64) -> io::Result<()> {
            self.data.truncate(length as usize);
            Ok(())
        }
    }

    #[test]
    fn a_line_that_does_not_fit_is_taken_back() {
        let mut sink = Full {
            data: b"a,b\n1,2\n".to_vec(),
            room: 10,
        };
        let error = append(&mut sink, b"3,4\n", 8).unwrap_err();
        assert_eq!(error.kind(), io::ErrorKind::StorageFull);
        assert_eq!(sink.data, b"a,b\n1,2\n");
    }

    #[test]
    fn numbers_are_shortest_and_exact() {
        for (x, text) in [
            (3.0, "3"),
            (-0.1, "-0.1"),
            (0.1 + 0.2, "0.30000000000000004"),
            (1e-300, "1e-300"),
            (5e-324, "5e-324"),
            (1.7976931348623157e308, "1.7976931348623157e308"),
            (f64::NAN, "NaN"),
        ] {
            let mut out = String::new();
            push_number(&mut out, x);
            assert_eq!(out, text);
            let back: f64 = out.parse().unwrap();
            assert!(back.to_bits() == x.to_bits() || x.is_nan());
        }
    }
}
