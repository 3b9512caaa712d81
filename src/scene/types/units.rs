//! Units of a scene.
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Units of the scene. CAD files state their own length unit and are converted to the scene's.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Units {
    /// Length unit of the scene.
    pub length: LengthUnit,
    /// Force unit of the scene. Only materials that are taken by name ask for it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub force: Option<ForceUnit>,
}

impl Units {
    /// Pascals in one unit of stress; none where the force unit is not given.
    pub fn pascals(&self) -> Option<f64> {
        let length = self.length.metres();
        self.force.map(|force| force.newtons() / (length * length))
    }

    /// Kilograms per cubic metre in one unit of density, time being in seconds; none where the force unit is not given.
    pub fn densities(&self) -> Option<f64> {
        let length = self.length.metres();
        Some(self.pascals()? / (length * length))
    }
}

/// Names of force units.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub enum ForceUnit {
    /// 1e-6 N.
    #[serde(rename = "uN")]
    Micronewton,
    /// 1e-3 N.
    #[serde(rename = "mN")]
    Millinewton,
    /// 1 N.
    #[serde(rename = "N")]
    Newton,
    /// 1e3 N.
    #[serde(rename = "kN")]
    Kilonewton,
    /// 1e6 N.
    #[serde(rename = "MN")]
    Meganewton,
    /// Kilogram-force, 9.80665 N.
    #[serde(rename = "kgf")]
    KilogramForce,
    /// Pound-force, 4.4482216152605 N.
    #[serde(rename = "lbf")]
    PoundForce,
}

impl ForceUnit {
    /// Newtons in one unit.
    pub fn newtons(self) -> f64 {
        match self {
            ForceUnit::Micronewton => 1e-6,
            ForceUnit::Millinewton => 1e-3,
            ForceUnit::Newton => 1.0,
            ForceUnit::Kilonewton => 1e3,
            ForceUnit::Meganewton => 1e6,
            ForceUnit::KilogramForce => 9.80665,
            ForceUnit::PoundForce => 4.4482216152605,
        }
    }
}

/// Names of length units.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub enum LengthUnit {
    /// 1e-9 m.
    #[serde(rename = "nm")]
    Nanometre,
    /// 1e-6 m.
    #[serde(rename = "um")]
    Micrometre,
    /// 1e-3 m.
    #[default]
    #[serde(rename = "mm")]
    Millimetre,
    /// 1e-2 m.
    #[serde(rename = "cm")]
    Centimetre,
    /// 1 m.
    #[serde(rename = "m")]
    Metre,
    /// 1e3 m.
    #[serde(rename = "km")]
    Kilometre,
    /// Inch, 25.4 mm.
    #[serde(rename = "in")]
    Inch,
    /// Foot, 304.8 mm.
    #[serde(rename = "ft")]
    Foot,
}

impl LengthUnit {
    /// Metres in one unit.
    pub fn metres(self) -> f64 {
        match self {
            LengthUnit::Nanometre => 1e-9,
            LengthUnit::Micrometre => 1e-6,
            LengthUnit::Millimetre => 1e-3,
            LengthUnit::Centimetre => 1e-2,
            LengthUnit::Metre => 1.0,
            LengthUnit::Kilometre => 1e3,
            LengthUnit::Inch => 0.0254,
            LengthUnit::Foot => 0.3048,
        }
    }

    /// Symbol, as scenes write it.
    pub fn name(self) -> &'static str {
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
