//! Numbers as Fortran programs write them.

/// Integer with optional sign. A real number without a fraction counts, as some writers print `3.` for 3.
pub fn integer(text: &[u8]) -> Option<i64> {
    let text = std::str::from_utf8(text).ok()?;
    if let Ok(value) = text.parse() {
        return Some(value);
    }
    let value = real(text.as_bytes())?;
    // Exact up to 2^53; nothing in a file counts that far.
    (value.fract() == 0.0 && value.abs() < 9e15).then_some(value as i64)
}

/// Finite real number: `1.`, `.5`, `-1.5E-3`, `1.D0`, and `1.5-3` with the exponent letter left out.
pub fn real(text: &[u8]) -> Option<f64> {
    // Longest sensible number; longer ones are damage.
    let mut buffer = [0u8; 128];
    let mut length = 0;
    let mut exponent = false;
    for (i, &byte) in text.iter().enumerate() {
        let byte = match byte {
            b'0'..=b'9' | b'.' => byte,
            b'D' | b'd' | b'E' | b'e' => {
                exponent = true;
                b'e'
            }
            b'+' | b'-' => {
                if i > 0 && !exponent {
                    exponent = true;
                    *buffer.get_mut(length)? = b'e';
                    length += 1;
                }
                byte
            }
            _ => return None,
        };
        *buffer.get_mut(length)? = byte;
        length += 1;
    }
    let value: f64 = std::str::from_utf8(&buffer[..length]).ok()?.parse().ok()?;
    value.is_finite().then_some(value)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fortran_reals() {
        for (text, value) in [
            ("1.", 1.0),
            (".5", 0.5),
            ("-.5", -0.5),
            ("+2", 2.0),
            ("1.D0", 1.0),
            ("1.5E-3", 1.5e-3),
            ("1.5d+03", 1.5e3),
            ("1.5-3", 1.5e-3),
            ("-2.5+2", -250.0),
            ("3.937007874016E-011", 3.937007874016e-11),
        ] {
            assert_eq!(real(text.as_bytes()), Some(value), "{text}");
        }
        for text in [
            "", "-", ".", "inf", "nan", "1E999", "1..2", "1e", "1e5e5", "0x10", "****", "1 2",
        ] {
            assert_eq!(real(text.as_bytes()), None, "{text}");
        }
        assert_eq!(real(&[b'1'; 400]), None);
    }

    #[test]
    fn integers() {
        assert_eq!(integer(b"12"), Some(12));
        assert_eq!(integer(b"+12"), Some(12));
        assert_eq!(integer(b"-1"), Some(-1));
        assert_eq!(integer(b"3."), Some(3));
        assert_eq!(integer(b"3.5"), None);
        assert_eq!(integer(b"99999999999999999999"), None);
    }
}
