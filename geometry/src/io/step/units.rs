//! Units and tolerance of a representation's context (ISO 10303-41, measure schema).

use super::super::LengthUnit;
use super::entity::{Entity, Told};
use super::exchange::Exchange;
use std::f64::consts::PI;

/// Conversion-based units of conversion-based units may be nested this deep.
const DEPTH: usize = 8;

/// What the numbers of a representation mean.
#[derive(Debug, Clone, PartialEq)]
pub struct Units {
    pub length: LengthUnit,
    /// Radians in one unit of plane angles.
    pub angle: f64,
    /// Distance below which points count as the same, in the unit of lengths.
    pub uncertainty: Option<f64>,
}

impl Default for Units {
    fn default() -> Self {
        Self {
            length: LengthUnit::unspecified(),
            angle: 1.0,
            uncertainty: None,
        }
    }
}

impl Units {
    /// The units of a context; what it does not say is as in [`Units::default`].
    pub fn of(exchange: &Exchange, context: u32) -> Told<Self> {
        let mut units = Self::default();
        let context = Entity::read(exchange, context)?;
        if context.is("GLOBAL_UNIT_ASSIGNED_CONTEXT") {
            for unit in context.targets("GLOBAL_UNIT_ASSIGNED_CONTEXT", 0, "a unit")? {
                let unit = Entity::read(exchange, unit)?;
                if unit.is("LENGTH_UNIT") {
                    let metres = size(exchange, &unit, 0)?;
                    let name = unit.text("CONVERSION_BASED_UNIT", 0);
                    units.length = LengthUnit::from_metres(metres, name.as_deref());
                } else if unit.is("PLANE_ANGLE_UNIT") {
                    units.angle = size(exchange, &unit, 0)?;
                }
            }
        }
        // A degree of twelve digits is meant to be one.
        if (units.angle / (PI / 180.0) - 1.0).abs() < 1e-6 {
            units.angle = PI / 180.0;
        }
        if context.is("GLOBAL_UNCERTAINTY_ASSIGNED_CONTEXT") {
            let what = "an uncertainty";
            let list = context.targets("GLOBAL_UNCERTAINTY_ASSIGNED_CONTEXT", 0, what)?;
            units.uncertainty = list.into_iter().find_map(|one| {
                let one = Entity::read(exchange, one).ok()?;
                let value = one.real("MEASURE_WITH_UNIT", 0, what).ok()?;
                let unit = one
                    .member("MEASURE_WITH_UNIT", 1, "LENGTH_UNIT", "a unit")
                    .ok()?;
                let metres = value * size(exchange, &unit, 0).ok()?;
                let own = units.length.to_metre?;
                (metres > 0.0).then_some(metres / own)
            });
        }
        Ok(units)
    }
}

/// Metres or radians in one unit.
fn size(exchange: &Exchange, unit: &Entity, depth: usize) -> Told<f64> {
    let value = if unit.is("SI_UNIT") {
        let prefix = unit.attribute("SI_UNIT", 0, "the prefix of a unit")?;
        let super::scan::Value::Enumeration(prefix) = prefix.value else {
            return Ok(1.0);
        };
        match PREFIXES.iter().find(|p| p.0.as_bytes() == prefix) {
            Some(prefix) => prefix.1,
            None => {
                let item = unit.attribute("SI_UNIT", 0, "the prefix of a unit")?;
                return Err(unit.wrong(item, "a prefix of SI (.MILLI.)"));
            }
        }
    } else if unit.is("CONVERSION_BASED_UNIT") {
        if depth >= DEPTH {
            return Err(format!("{} is defined by itself", unit.describe()));
        }
        let what = "the factor of a unit";
        let factor = unit.member("CONVERSION_BASED_UNIT", 1, "MEASURE_WITH_UNIT", what)?;
        let value = factor.real("MEASURE_WITH_UNIT", 0, what)?;
        let base = factor.reference("MEASURE_WITH_UNIT", 1, "the unit of a factor")?;
        value * size(exchange, &Entity::read(exchange, base)?, depth + 1)?
    } else {
        return Err(format!(
            "{} is neither of SI nor a multiple of it",
            unit.describe()
        ));
    };
    if value > 0.0 && value.is_finite() {
        Ok(value)
    } else {
        Err(format!("{} has the size {value}", unit.describe()))
    }
}

const PREFIXES: [(&str, f64); 16] = [
    ("EXA", 1e18),
    ("PETA", 1e15),
    ("TERA", 1e12),
    ("GIGA", 1e9),
    ("MEGA", 1e6),
    ("KILO", 1e3),
    ("HECTO", 1e2),
    ("DECA", 1e1),
    ("DECI", 1e-1),
    ("CENTI", 1e-2),
    ("MILLI", 1e-3),
    ("MICRO", 1e-6),
    ("NANO", 1e-9),
    ("PICO", 1e-12),
    ("FEMTO", 1e-15),
    ("ATTO", 1e-18),
];
