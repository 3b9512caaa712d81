//! Metals that flow: elastic constants and hardening.
use super::Elastic;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Most rows of a table of yield stresses.
pub const MAX_ROWS: usize = 32;

/// Elastic constants and yield stress of a metal.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Metal {
    /// Young's modulus (force / length^2).
    #[serde(rename = "E")]
    pub e: f64,
    /// Poisson's ratio, at most 0.49.
    pub nu: f64,
    /// Mass per undeformed volume (force time^2 / length^4: t/mm^3 for N, mm and s). Loads by gravity ask for it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub density: Option<f64>,
    /// Yield stress over equivalent plastic strain, as Kirchhoff stress: true stress times the change of volume, which is below
    /// 0.3 % in metals.
    pub hardening: HardeningCurve,
}

impl Metal {
    /// Constants at small strain.
    pub fn elastic(&self) -> Elastic {
        let Metal { e, nu, density, .. } = *self;
        Elastic { e, nu, density }
    }
}

/// Elastic constants, yield stress along the rolling direction and r-values of a rolled sheet.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct RolledSheet {
    /// Young's modulus (force / length^2).
    #[serde(rename = "E")]
    pub e: f64,
    /// Poisson's ratio, at most 0.49.
    pub nu: f64,
    /// Mass per undeformed volume (force time^2 / length^4: t/mm^3 for N, mm and s). Loads by gravity ask for it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub density: Option<f64>,
    /// Yield stress of a strip along the rolling direction over its plastic strain, as Kirchhoff stress: true stress times the
    /// change of volume, which is below 0.3 % in metals.
    pub hardening: HardeningCurve,
    /// r-values `[r0, r45, r90]` of strips along the rolling direction, at 45 degrees to it and across it: plastic strain across the
    /// strip over that through its thickness. `[1, 1, 1]` is `j2`.
    pub r: [f64; 3],
    /// The rolling direction in space, of any length; in a curved sheet what of it lies in the sheet.
    pub rolling: [f64; 3],
}

impl RolledSheet {
    /// Constants at small strain.
    pub fn elastic(&self) -> Elastic {
        let RolledSheet { e, nu, density, .. } = *self;
        Elastic { e, nu, density }
    }
}

/// Elastic constants, yield stress and back stress of a metal that is loaded back and forth.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct CyclicMetal {
    /// Young's modulus (force / length^2).
    #[serde(rename = "E")]
    pub e: f64,
    /// Poisson's ratio, at most 0.49.
    pub nu: f64,
    /// Mass per undeformed volume (force time^2 / length^4: t/mm^3 for N, mm and s). Loads by gravity ask for it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub density: Option<f64>,
    /// Yield stress over equivalent plastic strain, as Kirchhoff stress: half of the width of the elastic range.
    pub hardening: HardeningCurve,
    /// Kinematic hardening: by how much the elastic range moves with the flow.
    pub back_stress: BackStress,
}

impl CyclicMetal {
    /// Constants at small strain.
    pub fn elastic(&self) -> Elastic {
        let CyclicMetal { e, nu, density, .. } = *self;
        Elastic { e, nu, density }
    }
}

/// Constants of a back stress that follows plastic flow, `X' = 2/3 modulus Ep' - recovery X p'`, written
/// `{"modulus": 4000, "recovery": 40}`.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct BackStress {
    /// Slope of the back stress over plastic strain in tension, where it begins (force / length^2).
    pub modulus: f64,
    /// How fast it saturates: in tension it tends to `modulus / recovery`, of which 63 % are reached after a plastic strain of
    /// `1 / recovery`. 0 (default): it grows without limit (Prager).
    #[serde(default)]
    pub recovery: f64,
}

/// Yield stress over equivalent plastic strain p, written as `{"linear": {"yield_stress": 200, "slope": 1000}}`.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
// Few of them, and plain values: a box would make them lose `Copy`.
#[allow(clippy::large_enum_variant)]
pub enum HardeningCurve {
    /// `yield_stress + slope p`.
    Linear(LinearHardening),
    /// Swift: `strength (offset + p)^exponent`.
    Swift(SwiftHardening),
    /// Voce: `yield_stress + rise (1 - exp(-rate p))`.
    Voce(VoceHardening),
    /// Rows `[p, yield stress]`, at most 32, with straight lines between them and the last yield stress beyond; the first p is 0.
    Table(YieldTable),
}

/// Constants of linear hardening.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct LinearHardening {
    /// Yield stress at the beginning.
    pub yield_stress: f64,
    /// Its slope over plastic strain; 0 (default) is perfect plasticity.
    #[serde(default)]
    pub slope: f64,
}

/// Constants of Swift's hardening.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SwiftHardening {
    /// Yield stress where `offset + p` is 1.
    pub strength: f64,
    /// Plastic strain from which the curve starts.
    pub offset: f64,
    /// Exponent n, at most 1.
    pub exponent: f64,
}

/// Constants of Voce's hardening.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct VoceHardening {
    /// Yield stress at the beginning.
    pub yield_stress: f64,
    /// How far it rises at last.
    pub rise: f64,
    /// How fast: after a plastic strain of `1 / rate`, 63 % of the rise are reached.
    pub rate: f64,
}

/// Yield stress by rows of plastic strain and stress.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(try_from = "Vec<[f64; 2]>", into = "Vec<[f64; 2]>")]
#[schemars(with = "Vec<[f64; 2]>")]
pub struct YieldTable {
    count: usize,
    rows: [[f64; 2]; MAX_ROWS],
}

impl YieldTable {
    /// Plastic strain and yield stress of each row.
    pub fn rows(&self) -> &[[f64; 2]] {
        &self.rows[..self.count]
    }
}

impl TryFrom<Vec<[f64; 2]>> for YieldTable {
    type Error = String;

    fn try_from(given: Vec<[f64; 2]>) -> Result<Self, String> {
        let (count, mut rows) = (given.len(), [[0.0; 2]; MAX_ROWS]);
        if count > MAX_ROWS {
            return Err(format!(
                "a table of yield stresses has at most {MAX_ROWS} rows, not {count}"
            ));
        }
        rows[..count].copy_from_slice(&given);
        Ok(YieldTable { count, rows })
    }
}

impl From<YieldTable> for Vec<[f64; 2]> {
    fn from(table: YieldTable) -> Self {
        table.rows().to_vec()
    }
}
