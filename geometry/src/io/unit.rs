//! Length units of CAD files.

use serde::Serialize;

/// The length unit of a file.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct LengthUnit {
    /// Symbol: nm, um, mm, cm, m, km, in, ft, mi, mil, uin; "unspecified" where the file states none.
    pub name: String,
    /// Metres in one unit, `None` where the file states no unit.
    pub to_metre: Option<f64>,
}

/// Symbol, other spellings (upper case), metres.
const UNITS: [(&str, &[&str], f64); 11] = [
    ("nm", &["NM", "NANOMETER", "NANOMETRE"], 1e-9),
    ("in", &["IN", "INCH", "INCHES"], 0.0254),
    (
        "mm",
        &[
            "MM",
            "MILLIMETER",
            "MILLIMETERS",
            "MILLIMETRE",
            "MILLIMETRES",
        ],
        1e-3,
    ),
    ("ft", &["FT", "FOOT", "FEET"], 0.3048),
    ("mi", &["MI", "MILE", "MILES"], 1609.344),
    ("m", &["M", "METER", "METERS", "METRE", "METRES"], 1.0),
    (
        "km",
        &["KM", "KILOMETER", "KILOMETERS", "KILOMETRE", "KILOMETRES"],
        1e3,
    ),
    ("mil", &["MIL", "MILS"], 2.54e-5),
    (
        "um",
        &["UM", "MICRON", "MICRONS", "MICROMETER", "MICROMETRE"],
        1e-6,
    ),
    (
        "cm",
        &[
            "CM",
            "CENTIMETER",
            "CENTIMETERS",
            "CENTIMETRE",
            "CENTIMETRES",
        ],
        1e-2,
    ),
    ("uin", &["UIN", "MICROINCH", "MICROINCHES"], 2.54e-8),
];

impl LengthUnit {
    /// The unit called `name` ("mm", "MM", "millimetres", ...), or `None` for an unknown one.
    pub fn from_name(name: &str) -> Option<Self> {
        let upper = name.trim().to_ascii_uppercase();
        let (symbol, _, metres) = UNITS.iter().find(|u| u.1.contains(&upper.as_str()))?;
        Some(Self {
            name: (*symbol).to_owned(),
            to_metre: Some(*metres),
        })
    }

    /// The unit of a length of `metres`: a known one where the two differ by less than 1e-9 of it, else one called
    /// `name`.
    pub fn from_metres(metres: f64, name: Option<&str>) -> Self {
        let known = UNITS.iter().find(|u| (u.2 / metres - 1.0).abs() < 1e-9);
        let name = match (known, name) {
            (Some(unit), _) => unit.0.to_owned(),
            (None, Some(name)) => name.to_owned(),
            (None, None) => format!("{metres:e} m"),
        };
        Self {
            name,
            to_metre: Some(known.map_or(metres, |u| u.2)),
        }
    }

    /// Symbols of all units.
    pub fn names() -> [&'static str; 11] {
        UNITS.map(|u| u.0)
    }

    /// The unit of a file that states none.
    pub fn unspecified() -> Self {
        Self {
            name: "unspecified".to_owned(),
            to_metre: None,
        }
    }

    /// Factor that turns lengths of this unit into `other`, `None` when one of the two is unspecified.
    pub fn factor_to(&self, other: &Self) -> Option<f64> {
        Some(self.to_metre? / other.to_metre?)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn inches_to_millimetres() {
        let inch = LengthUnit::from_name(" Inch ").unwrap();
        let factor = inch
            .factor_to(&LengthUnit::from_name("mm").unwrap())
            .unwrap();
        assert!((factor - 25.4).abs() < 1e-13, "{factor}");
        assert_eq!(inch.factor_to(&LengthUnit::unspecified()), None);
        assert_eq!(LengthUnit::from_name("furlong"), None);
    }
}
