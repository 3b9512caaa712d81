//! Names of length units, as in scenes and CAD files.
use super::LengthUnit;

impl LengthUnit {
    /// The abbreviation used in scenes.
    pub const fn name(self) -> &'static str {
        match self {
            LengthUnit::Nanometre => "nm",
            LengthUnit::Micrometre => "um",
            LengthUnit::Millimetre => "mm",
            LengthUnit::Centimetre => "cm",
            LengthUnit::Metre => "m",
            LengthUnit::Kilometre => "km",
            LengthUnit::Inch => "in",
            LengthUnit::Foot => "ft",
        }
    }
}
