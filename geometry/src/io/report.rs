//! What was found in a CAD file.

use super::{CadError, LengthUnit};
use crate::NurbsPatch;
use serde::Serialize;

/// Format of a CAD file.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum CadFormat {
    /// IGES (ANS US PRO/IPO-100), fixed-length ASCII records.
    Iges,
    /// `*.cad.json` of Kratos Multiphysics.
    Kratos,
    /// JSON of the Python package geomdl (NURBS-Python).
    Geomdl,
}

/// A surface that was read.
#[derive(Debug, Clone)]
pub struct CadPatch {
    /// The patch, in the unit of the file.
    pub patch: NurbsPatch,
    /// IGES: directory sequence number; Kratos: `brep_id` of the face; geomdl: place in the list, from 1.
    pub entity: u32,
    /// IGES: 128, or 144 for an untrimmed parametric surface over a 128. JSON: 0.
    pub type_number: u32,
    /// Name in the file, if it gives one.
    pub name: Option<String>,
}

/// How often an entity type occurs.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct EntityCount {
    /// IGES entity type; 0 for JSON.
    pub type_number: u32,
    /// IGES form number; 0 for JSON.
    pub form: i32,
    /// Name of the type in the standard.
    pub name: String,
    /// Number of entities.
    pub count: usize,
}

/// A surface that was not read, and why.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Skipped {
    /// As in [`CadPatch::entity`].
    pub entity: u32,
    /// IGES entity type; 0 for JSON.
    pub type_number: u32,
    /// Name in the file, or else the name of the type.
    pub name: String,
    /// Why it was not read.
    pub reason: String,
}

/// Content of a CAD file.
#[derive(Debug, Clone)]
pub struct CadFile {
    /// Path or name, as messages show it.
    pub path: String,
    /// What kind of file it is.
    pub format: CadFormat,
    /// Length unit of all patches.
    pub unit: LengthUnit,
    /// Smallest distance between two points that the writer tells apart, in the file's unit.
    pub resolution: Option<f64>,
    /// The surfaces that were read, in the order of the file.
    pub patches: Vec<CadPatch>,
    /// Every entity of the file by type and form, in ascending order.
    pub entities: Vec<EntityCount>,
    /// Every surface that was not read.
    pub skipped: Vec<Skipped>,
    /// What was tolerated although the standard does not allow it, and what was changed on reading.
    pub notes: Vec<String>,
}

impl CadFile {
    /// Converts patches and resolution to another unit.
    ///
    /// # Errors
    /// [`CadError::UnknownUnit`] when the file or `unit` is unspecified; the file is unchanged then.
    pub fn convert_to(&mut self, unit: &LengthUnit) -> Result<(), CadError> {
        let Some(factor) = self.unit.factor_to(unit) else {
            return Err(CadError::UnknownUnit {
                path: self.path.clone(),
                wanted: unit.name.clone(),
            });
        };
        self.scale(factor)?;
        self.unit = unit.clone();
        Ok(())
    }
}

impl CadFile {
    /// Multiplies all lengths by `factor`; the unit is left as it is.
    fn scale(&mut self, factor: f64) -> Result<(), CadError> {
        let scaled = self
            .patches
            .iter()
            .map(|p| {
                let patch = p.patch.transformed(&|x| x * factor);
                patch.map_err(|e| CadError::Scale {
                    path: self.path.clone(),
                    entity: p.entity,
                    reason: e.to_string(),
                })
            })
            .collect::<Result<Vec<_>, _>>()?;
        for (old, new) in self.patches.iter_mut().zip(scaled) {
            old.patch = new;
        }
        self.resolution = self.resolution.map(|r| r * factor);
        Ok(())
    }
}
