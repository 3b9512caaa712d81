//! The bytes of a checkpoint: numbers in little-endian order, in sections that have names.
//!
//! Whoever reads says what length it expects, or a limit, before anything is allocated; a section must be used up.

/// What is wrong with the bytes, in words.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Malformed(pub String);

/// Writes values one after the other.
#[derive(Debug, Default)]
pub struct Writer {
    bytes: Vec<u8>,
}

impl Writer {
    /// Forgets everything; the memory is kept.
    pub fn clear(&mut self) {
        self.bytes.clear();
    }

    pub fn bytes(&self) -> &[u8] {
        &self.bytes
    }

    pub fn raw(&mut self, bytes: &[u8]) {
        self.bytes.extend_from_slice(bytes);
    }

    pub fn u8(&mut self, x: u8) {
        self.bytes.push(x);
    }

    pub fn bool(&mut self, x: bool) {
        self.bytes.push(u8::from(x));
    }

    pub fn u32(&mut self, x: u32) {
        self.raw(&x.to_le_bytes());
    }

    pub fn u64(&mut self, x: u64) {
        self.raw(&x.to_le_bytes());
    }

    /// A length.
    pub fn count(&mut self, x: usize) {
        self.u64(x as u64);
    }

    /// Every bit of a number.
    pub fn f64(&mut self, x: f64) {
        self.raw(&x.to_bits().to_le_bytes());
    }

    /// Numbers whose count the reader knows.
    pub fn f64s(&mut self, xs: &[f64]) {
        self.bytes.reserve(8 * xs.len());
        xs.iter().for_each(|x| self.f64(*x));
    }

    /// Whether there is a value, and the value.
    pub fn option<T>(&mut self, x: Option<T>, put: impl FnOnce(&mut Self, T)) {
        self.bool(x.is_some());
        if let Some(x) = x {
            put(self, x);
        }
    }

    pub fn text(&mut self, x: &str) {
        self.count(x.len());
        self.raw(x.as_bytes());
    }

    /// A section: its name, its length, and what `put` writes.
    pub fn section(&mut self, name: &str, put: impl FnOnce(&mut Self)) {
        self.text(name);
        let at = self.bytes.len();
        self.u64(0);
        put(self);
        self.set_u64(at, (self.bytes.len() - at - 8) as u64);
    }

    /// Sets a number that was written before, at byte `at`.
    pub fn set_u64(&mut self, at: usize, x: u64) {
        self.bytes[at..at + 8].copy_from_slice(&x.to_le_bytes());
    }
}

/// Reads what [`Writer`] wrote.
#[derive(Debug, Clone)]
pub struct Reader<'a> {
    rest: &'a [u8],
    /// The section at hand, for messages.
    section: &'a str,
}

impl<'a> Reader<'a> {
    pub fn new(bytes: &'a [u8]) -> Self {
        Reader {
            rest: bytes,
            section: "head",
        }
    }

    /// A fault in the section at hand.
    pub fn malformed(&self, what: &str) -> Malformed {
        Malformed(format!("{what} in section `{}`", self.section))
    }

    pub fn raw(&mut self, length: usize) -> Result<&'a [u8], Malformed> {
        let Some((bytes, rest)) = self.rest.split_at_checked(length) else {
            return Err(self.malformed("the bytes end"));
        };
        self.rest = rest;
        Ok(bytes)
    }

    fn array<const N: usize>(&mut self) -> Result<[u8; N], Malformed> {
        let mut out = [0; N];
        out.copy_from_slice(self.raw(N)?);
        Ok(out)
    }

    pub fn u8(&mut self) -> Result<u8, Malformed> {
        Ok(self.array::<1>()?[0])
    }

    pub fn bool(&mut self) -> Result<bool, Malformed> {
        match self.u8()? {
            0 => Ok(false),
            1 => Ok(true),
            _ => Err(self.malformed("a byte that is neither yes nor no")),
        }
    }

    pub fn u32(&mut self) -> Result<u32, Malformed> {
        Ok(u32::from_le_bytes(self.array()?))
    }

    pub fn u64(&mut self) -> Result<u64, Malformed> {
        Ok(u64::from_le_bytes(self.array()?))
    }

    pub fn f64(&mut self) -> Result<f64, Malformed> {
        Ok(f64::from_bits(self.u64()?))
    }

    /// A length of values of at least `bytes` bytes each: no more than are left.
    pub fn count(&mut self, bytes: usize) -> Result<usize, Malformed> {
        let count = usize::try_from(self.u64()?).unwrap_or(usize::MAX);
        match count.checked_mul(bytes.max(1)) {
            Some(size) if size <= self.rest.len() => Ok(count),
            _ => Err(self.malformed("a length beyond the end")),
        }
    }

    /// A length that has to be `expected`.
    pub fn exactly(&mut self, expected: usize, what: &str) -> Result<(), Malformed> {
        let count = self.u64()?;
        if count == expected as u64 {
            return Ok(());
        }
        Err(self.malformed(&format!("{count} {what} in place of {expected}")))
    }

    /// As many numbers as `out` has room for.
    pub fn f64s(&mut self, out: &mut [f64]) -> Result<(), Malformed> {
        let bytes = self.raw(8 * out.len())?;
        for (x, bytes) in out.iter_mut().zip(bytes.chunks_exact(8)) {
            let mut word = [0; 8];
            word.copy_from_slice(bytes);
            *x = f64::from_bits(u64::from_le_bytes(word));
        }
        Ok(())
    }

    pub fn option<T>(
        &mut self,
        take: impl FnOnce(&mut Self) -> Result<T, Malformed>,
    ) -> Result<Option<T>, Malformed> {
        match self.bool()? {
            true => take(self).map(Some),
            false => Ok(None),
        }
    }

    pub fn text(&mut self) -> Result<&'a str, Malformed> {
        let length = self.count(1)?;
        let bytes = self.raw(length)?;
        std::str::from_utf8(bytes).map_err(|_| self.malformed("a text that is not UTF-8"))
    }

    /// The next section, which has to be called `name` and to be used up by `take`.
    pub fn section<T>(
        &mut self,
        name: &'static str,
        take: impl FnOnce(&mut Reader<'a>) -> Result<T, Malformed>,
    ) -> Result<T, Malformed> {
        let found = self.text()?;
        if found != name {
            return Err(self.malformed(&format!("`{name}` is missing")));
        }
        let length = self.count(1)?;
        let mut inner = Reader {
            rest: self.raw(length)?,
            section: name,
        };
        let out = take(&mut inner)?;
        inner.end()?;
        Ok(out)
    }

    /// Number of bytes left.
    pub fn left(&self) -> usize {
        self.rest.len()
    }

    /// Nothing may be left.
    pub fn end(&self) -> Result<(), Malformed> {
        match self.rest.is_empty() {
            true => Ok(()),
            false => Err(self.malformed("more bytes than expected")),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_come_back_and_lengths_are_checked() {
        let mut w = Writer::default();
        w.section("first", |w| {
            w.u32(7);
            w.f64s(&[1.5, f64::NAN, -0.0]);
            w.option(Some("text"), |w, t| w.text(t));
            w.option(None::<u8>, Writer::u8);
        });
        w.section("second", |w| w.count(1 << 60));
        let mut r = Reader::new(w.bytes());
        r.section("first", |r| {
            assert_eq!(r.u32()?, 7);
            let mut xs = [0.0; 3];
            r.f64s(&mut xs)?;
            assert_eq!(xs[0], 1.5);
            assert!(xs[1].is_nan() && xs[2].is_sign_negative());
            assert_eq!(r.option(|r| r.text())?, Some("text"));
            assert_eq!(r.option(|r| r.u8())?, None);
            Ok(())
        })
        .unwrap();
        let long = r.clone().section("second", |r| r.count(8)).unwrap_err();
        assert!(long.0.contains("length beyond the end"), "{long:?}");
        let other = r.section("third", |r| r.u64()).unwrap_err();
        assert!(other.0.contains("`third` is missing"), "{other:?}");
        let left = Reader::new(w.bytes()).section("first", |r| r.u8());
        assert!(left.unwrap_err().0.contains("more bytes"));
    }
}
