//! Arrays of numbers, and their types by the names that VTK has for them.
use crate::mesh::MeshError;
use crate::mesh::cursor::{Cursor, Encoding};

/// Type of the numbers of an array.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Type {
    /// Whole numbers of so many bytes, signed or not.
    Whole { bytes: u8, signed: bool },
    /// Reals of 4 or 8 bytes.
    Real(u8),
}

impl Type {
    /// By the name in a legacy or XML file, without regard to case.
    pub fn of(name: &str) -> Option<Type> {
        let whole = |bytes, signed| Some(Type::Whole { bytes, signed });
        match name.to_ascii_lowercase().as_str() {
            "char" | "int8" | "vtktypeint8" | "signed_char" => whole(1, true),
            "unsigned_char" | "uint8" | "vtktypeuint8" => whole(1, false),
            "short" | "int16" | "vtktypeint16" => whole(2, true),
            "unsigned_short" | "uint16" | "vtktypeuint16" => whole(2, false),
            "int" | "int32" | "vtkidtype" | "vtktypeint32" => whole(4, true),
            "unsigned_int" | "uint32" | "vtktypeuint32" => whole(4, false),
            "long" | "int64" | "vtktypeint64" => whole(8, true),
            "unsigned_long" | "uint64" | "vtktypeuint64" => whole(8, false),
            "float" | "float32" => Some(Type::Real(4)),
            "double" | "float64" => Some(Type::Real(8)),
            _ => None,
        }
    }

    pub fn bytes(self) -> usize {
        match self {
            Type::Whole { bytes, .. } | Type::Real(bytes) => bytes.into(),
        }
    }
}

/// The numbers of an array.
#[derive(Debug)]
pub(super) enum Values {
    Whole(Vec<i64>),
    Real(Vec<f64>),
}

impl Values {
    /// `count` numbers from where a file is read; more than it can hold are refused before anything is allocated.
    pub fn read(c: &mut Cursor, kind: Type, count: usize, what: &str) -> Result<Values, MeshError> {
        let each = match c.encoding {
            Encoding::Text => 2,
            Encoding::Binary { .. } => kind.bytes(),
        };
        // The last number of a text needs no blank after it.
        let rest = c.bytes.len() - c.pos + 1;
        if count > rest / each {
            let found = format!("the end after at most {} of {count} numbers", rest / each);
            return Err(c.syntax(c.pos, what, found));
        }
        match kind {
            Type::Real(4) => {
                let all = (0..count).map(|_| c.single(what));
                Ok(Values::Real(all.collect::<Result<_, _>>()?))
            }
            Type::Real(_) => {
                let all = (0..count).map(|_| c.real(what));
                Ok(Values::Real(all.collect::<Result<_, _>>()?))
            }
            Type::Whole { bytes, signed } => {
                let all = (0..count).map(|_| c.whole(bytes, signed, what));
                Ok(Values::Whole(all.collect::<Result<_, _>>()?))
            }
        }
    }

    /// Passes over numbers that are of no use, whatever they are.
    pub fn skip(c: &mut Cursor, kind: Type, count: usize, what: &str) -> Result<(), MeshError> {
        if c.encoding == Encoding::Text {
            for _ in 0..count {
                c.word(what)?;
            }
            return Ok(());
        }
        let end = count
            .checked_mul(kind.bytes())
            .and_then(|n| c.pos.checked_add(n));
        match end.filter(|&end| end <= c.bytes.len()) {
            Some(end) => c.pos = end,
            None => return Err(c.syntax(c.bytes.len(), what, "the end of the file")),
        }
        Ok(())
    }

    /// As whole numbers; `None` for reals.
    pub fn whole(self) -> Option<Vec<i64>> {
        match self {
            Values::Whole(values) => Some(values),
            Values::Real(_) => None,
        }
    }

    /// As reals.
    pub fn real(self) -> Vec<f64> {
        match self {
            Values::Real(values) => values,
            Values::Whole(values) => values.into_iter().map(|v| v as f64).collect(),
        }
    }
}
