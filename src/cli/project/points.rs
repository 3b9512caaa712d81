//! Points of a text file, read in blocks: a file of any length needs the memory of one block.
use covact_geometry::Vec3;
use std::io::{self, BufRead, Read};

/// Longest line that is read; a longer one is no list of three numbers.
const LONGEST_LINE: u64 = 1 << 16;

/// Why points could not be read.
#[derive(Debug, thiserror::Error)]
pub(super) enum PointsError {
    /// The operating system refused.
    #[error("cannot be read: {0}")]
    Io(#[from] io::Error),
    /// A line is not `x y z`. Line and column (bytes) count from 1.
    #[error("{line}:{column}: expected {expected}, found {found}")]
    Line {
        line: u64,
        column: usize,
        expected: &'static str,
        found: String,
    },
}

/// Reads `x y z` from every line, separated by blanks or commas. Empty lines, and whatever follows a `#`, are passed
/// over.
pub(super) struct Points<R> {
    source: R,
    line: u64,
    text: Vec<u8>,
}

impl<R: BufRead> Points<R> {
    pub fn new(source: R) -> Self {
        Points {
            source,
            line: 0,
            text: Vec::new(),
        }
    }

    /// Replaces `block` by the next points, at most `size` of them; none at the end of the file.
    pub fn read(&mut self, block: &mut Vec<Vec3>, size: usize) -> Result<(), PointsError> {
        block.clear();
        while block.len() < size {
            self.text.clear();
            let source = self.source.by_ref();
            if source
                .take(LONGEST_LINE)
                .read_until(b'\n', &mut self.text)?
                == 0
            {
                break;
            }
            self.line += 1;
            let mut text = &self.text[..];
            let mut bom = 0;
            if self.line == 1 && text.starts_with(b"\xef\xbb\xbf") {
                (text, bom) = (&text[3..], 3);
            }
            let point = if text.len() as u64 >= LONGEST_LINE && !text.ends_with(b"\n") {
                Err((
                    0,
                    "a line of three numbers",
                    "a line of 65536 bytes or more".into(),
                ))
            } else {
                point(text)
            };
            match point {
                Ok(Some(x)) => block.push(x),
                Ok(None) => {}
                Err((at, expected, found)) => {
                    return Err(PointsError::Line {
                        line: self.line,
                        column: bom + at + 1,
                        expected,
                        found,
                    });
                }
            }
        }
        Ok(())
    }
}

/// Place in the line, what was expected, what was found.
type Fault = (usize, &'static str, String);

/// The point of a line, none if the line holds nothing.
fn point(text: &[u8]) -> Result<Option<Vec3>, Fault> {
    let end = text.iter().position(|&b| b == b'#').unwrap_or(text.len());
    let text = text[..end].trim_ascii_end();
    let blanks = |from: usize| {
        let rest = &text[from..];
        from + rest.len() - rest.trim_ascii_start().len()
    };
    let mut at = blanks(0);
    if at == text.len() {
        return Ok(None);
    }
    let mut x = Vec3::zeros();
    for (k, expected) in ["x (a number)", "y (a number)", "z (a number)"]
        .into_iter()
        .enumerate()
    {
        if k > 0 {
            at = blanks(at);
            if text.get(at) == Some(&b',') {
                at = blanks(at + 1);
            }
        }
        let rest = &text[at..];
        let length = rest
            .iter()
            .position(|b| b.is_ascii_whitespace() || *b == b',')
            .unwrap_or(rest.len());
        let word = &rest[..length];
        let number = std::str::from_utf8(word)
            .ok()
            .and_then(|word| word.parse::<f64>().ok());
        x[k] = match number {
            Some(number) if number.is_finite() => number,
            Some(_) => return Err((at, "a finite number", shown(word))),
            None if rest.is_empty() => return Err((at, expected, "the end of the line".into())),
            None => return Err((at, expected, shown(if length == 0 { b"," } else { word }))),
        };
        at += length;
    }
    at = blanks(at);
    match text.len() == at {
        true => Ok(Some(x)),
        false => Err((at, "the end of the line after x y z", shown(&text[at..]))),
    }
}

/// Part of a line for a message.
fn shown(word: &[u8]) -> String {
    let text: String = String::from_utf8_lossy(&word[..word.len().min(80)])
        .chars()
        .take(40)
        .map(|c| if c.is_control() { '?' } else { c })
        .collect();
    format!("`{text}{}`", if word.len() > 40 { "..." } else { "" })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &str) -> Result<Vec<[f64; 3]>, String> {
        let mut points = Points::new(text.as_bytes());
        let (mut block, mut all) = (Vec::new(), Vec::new());
        loop {
            points.read(&mut block, 2).map_err(|e| e.to_string())?;
            if block.is_empty() {
                return Ok(all);
            }
            assert!(block.len() <= 2);
            all.extend(block.iter().map(|x| [x.x, x.y, x.z]));
        }
    }

    #[test]
    fn blanks_commas_comments_and_empty_lines() {
        let text = "\u{feff}1 2 3\n# a comment\n\n  4,5 ,\t6e1 # another\r\n-7 8,-.5\n   \n0 0 0";
        let expected = [
            [1.0, 2.0, 3.0],
            [4.0, 5.0, 60.0],
            [-7.0, 8.0, -0.5],
            [0.0; 3],
        ];
        assert_eq!(read(text).unwrap(), expected);
        assert_eq!(read("").unwrap(), [[0.0; 3]; 0]);
    }

    #[test]
    fn faults_have_a_place() {
        for (text, message) in [
            ("x,y,z\n", "1:1: expected x (a number), found `x`"),
            (
                "1 2 3\n1 2\n",
                "2:4: expected z (a number), found the end of the line",
            ),
            ("1,,3", "1:3: expected y (a number), found `,`"),
            (
                "1 2 3 4",
                "1:7: expected the end of the line after x y z, found `4`",
            ),
            (
                "1 2 3,",
                "1:6: expected the end of the line after x y z, found `,`",
            ),
            (
                "#\n\n 1 nan 3",
                "3:4: expected a finite number, found `nan`",
            ),
            ("1 2 1e999", "1:5: expected a finite number, found `1e999`"),
            ("1 2\u{e9} 3", "1:3: expected y (a number), found `2\u{e9}`"),
            (",1 2 3", "1:1: expected x (a number), found `,`"),
        ] {
            assert_eq!(read(text).unwrap_err(), message, "{text}");
        }
        let long = "1 ".repeat(1 << 16);
        assert_eq!(
            read(&long).unwrap_err(),
            "1:1: expected a line of three numbers, found a line of 65536 bytes or more"
        );
    }

    /// Gives the same line for ever and counts what was asked for.
    struct Endless(u64);

    impl Read for Endless {
        fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
            for b in buffer.iter_mut() {
                *b = b"1 2 3\n"[(self.0 % 6) as usize];
                self.0 += 1;
            }
            Ok(buffer.len())
        }
    }

    #[test]
    fn a_block_is_read_no_further_than_needed() {
        let mut points = Points::new(io::BufReader::with_capacity(600, Endless(0)));
        let mut block = Vec::new();
        for _ in 0..50 {
            points.read(&mut block, 100).unwrap();
            assert_eq!(block.len(), 100);
        }
        assert!(block.capacity() <= 256 && points.text.capacity() <= 4096);
        let read = points.source.get_ref().0;
        assert!((30_000..=30_600).contains(&read), "{read}");
    }
}
