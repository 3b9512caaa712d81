//! Materials: laws with their constants, and well-known materials by name.
use super::{CyclicMetal, HardeningCurve, Metal, RolledSheet, Units};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// A constitutive law, written `{"st_venant_kirchhoff": {"E": 210000, "nu": 0.3}}`, or the name of a well-known material,
/// `"steel"`. A name needs `units` with `length` and `force`, in which its constants are taken.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
// Few of them, and plain values: a box would make them lose `Copy`.
#[allow(clippy::large_enum_variant)]
pub enum MaterialChoice {
    /// Linear law between Green-Lagrange strain and second Piola-Kirchhoff stress: large rotations, small strains.
    StVenantKirchhoff(Elastic),
    /// Compressible neo-Hooke: large strains.
    NeoHooke(Elastic),
    /// Hencky: linear law between logarithmic strain and its conjugate stress. Moderately large strains, stretches of 1/2 to 2.
    Hencky(Elastic),
    /// Metal plasticity after von Mises (J2) with isotropic hardening, in logarithmic strains: sheets that are formed.
    J2(Metal),
    /// Metal plasticity after Hill (1948) with isotropic hardening, in logarithmic strains: rolled sheets, which narrow and thin by
    /// their direction.
    Hill48(RolledSheet),
    /// Metal plasticity after von Mises with kinematic hardening after Armstrong and Frederick beside the isotropic one, in
    /// logarithmic strains: metal that is bent and straightened, or loaded back and forth.
    ArmstrongFrederick(CyclicMetal),
    /// Structural steel S235: E 210 GPa, nu 0.3 (EN 1993-1-1, 3.2.6); yield strength 235 MPa (EN 10025-2); 7850 kg/m^3.
    /// St. Venant-Kirchhoff.
    Steel,
    /// Stainless steel 1.4301: E 200 GPa, nu 0.3, yield strength 210 MPa (EN 1993-1-4, 2.1); 7900 kg/m^3. St. Venant-Kirchhoff.
    StainlessSteel,
    /// Aluminium EN AW-6061 T6: E 70 GPa, nu 0.3 (EN 1999-1-1, 3.2.5); yield strength 240 MPa (EN 755-2); 2700 kg/m^3.
    /// St. Venant-Kirchhoff.
    Aluminium,
    /// Rubber of Shore A hardness 40: E 1.69 MPa from the hardness (A. N. Gent, Rubber Chemistry and Technology 31, 1958),
    /// nu 0.499. Neo-Hooke.
    #[serde(rename = "rubber_40")]
    Rubber40,
    /// Rubber of Shore A hardness 50: E 2.46 MPa from the hardness (Gent 1958), nu 0.499. Neo-Hooke.
    #[serde(rename = "rubber_50")]
    Rubber50,
    /// Rubber of Shore A hardness 60: E 3.61 MPa from the hardness (Gent 1958), nu 0.499. Neo-Hooke.
    #[serde(rename = "rubber_60")]
    Rubber60,
    /// Rubber of Shore A hardness 70: E 5.52 MPa from the hardness (Gent 1958), nu 0.499. Neo-Hooke.
    #[serde(rename = "rubber_70")]
    Rubber70,
}

/// Constitutive law.
#[derive(Debug, Clone, Copy, PartialEq)]
// Few of them, and plain values: a box would make them lose `Copy`.
#[allow(clippy::large_enum_variant)]
pub enum Material {
    /// Linear law between Green-Lagrange strain and second Piola-Kirchhoff stress: large rotations, small strains.
    StVenantKirchhoff(Elastic),
    /// Compressible neo-Hooke: large strains.
    NeoHooke(Elastic),
    /// Hencky: linear law between logarithmic strain and its conjugate stress. Moderately large strains, stretches of 1/2 to 2.
    Hencky(Elastic),
    /// Metal plasticity after von Mises (J2) with isotropic hardening, in logarithmic strains: sheets that are formed.
    J2(Metal),
    /// Metal plasticity after Hill (1948) with isotropic hardening, in logarithmic strains: rolled sheets, which narrow and thin by
    /// their direction.
    Hill48(RolledSheet),
    /// Metal plasticity after von Mises with kinematic hardening after Armstrong and Frederick beside the isotropic one, in
    /// logarithmic strains: metal that is bent and straightened, or loaded back and forth.
    ArmstrongFrederick(CyclicMetal),
}

impl Material {
    /// The key in scenes; the name of its effect is `material.` and this key.
    pub fn key(&self) -> &'static str {
        match self {
            Material::StVenantKirchhoff(_) => "st_venant_kirchhoff",
            Material::NeoHooke(_) => "neo_hooke",
            Material::Hencky(_) => "hencky",
            Material::J2(_) => "j2",
            Material::Hill48(_) => "hill48",
            Material::ArmstrongFrederick(_) => "armstrong_frederick",
        }
    }

    /// The name in prose.
    pub fn title(&self) -> &'static str {
        match self {
            Material::StVenantKirchhoff(_) => "St. Venant-Kirchhoff",
            Material::NeoHooke(_) => "neo-Hooke",
            Material::Hencky(_) => "Hencky",
            Material::J2(_) => "von Mises plasticity",
            Material::Hill48(_) => "Hill plasticity",
            Material::ArmstrongFrederick(_) => "Armstrong-Frederick plasticity",
        }
    }

    /// Constants of the law at small strain.
    pub fn elastic(&self) -> Elastic {
        match self {
            Material::StVenantKirchhoff(elastic)
            | Material::NeoHooke(elastic)
            | Material::Hencky(elastic) => *elastic,
            Material::J2(metal) => metal.elastic(),
            Material::Hill48(sheet) => sheet.elastic(),
            Material::ArmstrongFrederick(metal) => metal.elastic(),
        }
    }

    /// The yield stress of a law that may flow.
    pub fn hardening(&self) -> Option<&HardeningCurve> {
        match self {
            Material::StVenantKirchhoff(_) | Material::NeoHooke(_) | Material::Hencky(_) => None,
            Material::J2(metal) => Some(&metal.hardening),
            Material::Hill48(sheet) => Some(&sheet.hardening),
            Material::ArmstrongFrederick(metal) => Some(&metal.hardening),
        }
    }

    /// Whether it may flow, so that it remembers what was done to it.
    pub fn flows(&self) -> bool {
        self.hardening().is_some()
    }

    /// Whether its tangent is symmetric: that of a back stress that recovers is not.
    pub fn is_symmetric(&self) -> bool {
        match self {
            Material::ArmstrongFrederick(metal) => {
                metal.back_stress.modulus == 0.0 || metal.back_stress.recovery == 0.0
            }
            _ => true,
        }
    }

    /// Whether stress and Green-Lagrange strain are proportional at any strain.
    pub fn is_linear(&self) -> bool {
        matches!(self, Material::StVenantKirchhoff(_))
    }
}

/// Young's modulus (force / length^2) and Poisson's ratio.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Elastic {
    /// Young's modulus (force / length^2).
    #[serde(rename = "E")]
    pub e: f64,
    /// Poisson's ratio, below 0.5.
    pub nu: f64,
    /// Mass per undeformed volume (force time^2 / length^4: t/mm^3 for N, mm and s). Loads by gravity ask for it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub density: Option<f64>,
}

/// Constants of a well-known material, in Pa.
struct KnownMaterial {
    name: &'static str,
    e: f64,
    nu: f64,
    /// Yield strength of a metal; none: a rubber.
    yield_strength: Option<f64>,
    /// Density (kg/m^3); none where it depends on what is mixed in.
    density: Option<f64>,
}

/// Young's modulus (Pa) of a rubber of this Shore A hardness after Gent (1958).
fn modulus_of_hardness(shore: f64) -> f64 {
    0.0981e6 * (56.0 + 7.62336 * shore) / (0.137505 * (254.0 - 2.54 * shore))
}

impl MaterialChoice {
    /// A law that is written out with its constants; none for a name.
    pub fn written(self) -> Option<Material> {
        match self {
            MaterialChoice::StVenantKirchhoff(e) => Some(Material::StVenantKirchhoff(e)),
            MaterialChoice::NeoHooke(e) => Some(Material::NeoHooke(e)),
            MaterialChoice::Hencky(e) => Some(Material::Hencky(e)),
            MaterialChoice::J2(metal) => Some(Material::J2(metal)),
            MaterialChoice::Hill48(sheet) => Some(Material::Hill48(sheet)),
            MaterialChoice::ArmstrongFrederick(metal) => Some(Material::ArmstrongFrederick(metal)),
            _ => None,
        }
    }

    fn known(self) -> Option<KnownMaterial> {
        let metal = |name, e, yield_strength, density| {
            Some(KnownMaterial {
                name,
                e,
                nu: 0.3,
                yield_strength: Some(yield_strength),
                density: Some(density),
            })
        };
        let rubber = |name, shore| {
            Some(KnownMaterial {
                name,
                e: modulus_of_hardness(shore),
                nu: 0.499,
                yield_strength: None,
                density: None,
            })
        };
        match self {
            MaterialChoice::StVenantKirchhoff(_)
            | MaterialChoice::NeoHooke(_)
            | MaterialChoice::Hencky(_)
            | MaterialChoice::J2(_)
            | MaterialChoice::Hill48(_)
            | MaterialChoice::ArmstrongFrederick(_) => None,
            MaterialChoice::Steel => metal("steel", 210e9, 235e6, 7850.0),
            MaterialChoice::StainlessSteel => metal("stainless_steel", 200e9, 210e6, 7900.0),
            MaterialChoice::Aluminium => metal("aluminium", 70e9, 240e6, 2700.0),
            MaterialChoice::Rubber40 => rubber("rubber_40", 40.0),
            MaterialChoice::Rubber50 => rubber("rubber_50", 50.0),
            MaterialChoice::Rubber60 => rubber("rubber_60", 60.0),
            MaterialChoice::Rubber70 => rubber("rubber_70", 70.0),
        }
    }

    /// Name of a well-known material; none for a law that is written out.
    pub fn name(self) -> Option<&'static str> {
        self.known().map(|k| k.name)
    }

    /// The law with its constants in the units of the scene; none for a name where the force unit is not given.
    pub fn law(self, units: &Units) -> Option<Material> {
        let Some(known) = self.known() else {
            return self.written();
        };
        let elastic = Elastic {
            e: known.e / units.pascals()?,
            nu: known.nu,
            density: known
                .density
                .zip(units.densities())
                .map(|(rho, unit)| rho / unit),
        };
        Some(match known.yield_strength {
            Some(_) => Material::StVenantKirchhoff(elastic),
            None => Material::NeoHooke(elastic),
        })
    }

    /// Yield strength of a metal that is taken by name, in the units of the scene.
    pub fn yield_strength(self, units: &Units) -> Option<f64> {
        Some(self.known()?.yield_strength? / units.pascals()?)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The constants that the descriptions state.
    #[test]
    fn rubbers_are_as_stiff_as_described() {
        for (rubber, e) in [
            (MaterialChoice::Rubber40, 1.69e6),
            (MaterialChoice::Rubber50, 2.46e6),
            (MaterialChoice::Rubber60, 3.61e6),
            (MaterialChoice::Rubber70, 5.52e6),
        ] {
            let known = rubber.known().map_or(0.0, |k| k.e);
            assert!((known / e - 1.0).abs() < 3e-3, "{known} for {e}");
        }
    }

    #[test]
    fn constants_follow_the_units() {
        let units: Units = serde_json::from_str(r#"{"length": "in", "force": "lbf"}"#).unwrap();
        let Some(Material::StVenantKirchhoff(steel)) = MaterialChoice::Steel.law(&units) else {
            panic!("no law");
        };
        // 210 GPa in psi.
        assert!((steel.e / 30.457925e6 - 1.0).abs() < 1e-6, "{}", steel.e);
        assert!(MaterialChoice::Steel.law(&Units::default()).is_none());
    }
}
