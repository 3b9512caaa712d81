//! What was found in a CAD file.

use super::healing::Healing;
use super::{CadError, LengthUnit};
use crate::NurbsPatch;
use serde::Serialize;

/// Format of a CAD file.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
#[non_exhaustive]
pub enum CadFormat {
    /// IGES (ANS US PRO/IPO-100), fixed-length ASCII records.
    Iges,
    /// STEP (ISO 10303-21), shapes of AP203, AP214 and AP242.
    Step,
    /// `*.cad.json` of Kratos Multiphysics.
    Kratos,
    /// JSON of the Python package geomdl (NURBS-Python).
    Geomdl,
    /// The lossless JSON of [`write_json`](super::write_json).
    Covact,
}

/// A surface that was read.
#[derive(Debug, Clone)]
#[non_exhaustive]
pub struct CadPatch {
    /// The patch, in the unit of the file.
    pub patch: NurbsPatch,
    /// IGES: directory sequence number; STEP: name of the instance (`12` for `#12`); Kratos: `brep_id` of the face; geomdl:
    /// place in the list, from 1.
    pub entity: u32,
    /// IGES: type of the entity: 144, 143, 510 for a face, else that of the surface itself. STEP, JSON: 0.
    pub type_number: u32,
    /// IGES, STEP: number of the surface that carries the face, `entity` itself where there is no face. JSON: `entity`.
    pub base: u32,
    /// Number of what places this copy of the entity: in IGES a subfigure or solid instance (408, 430), in STEP the
    /// outermost occurrence in an assembly or mapped item; 0 where it stands where it is defined.
    pub instance: u32,
    /// What bounds it.
    pub border: FaceBorder,
    /// Name in the file, if it gives one.
    pub name: Option<String>,
    /// What else the file says of it.
    pub tags: CadTags,
}

/// Which body of a file a surface belongs to, and how the file sorts and shows it. Only STEP files say so.
#[derive(Debug, Clone, PartialEq, Eq, Default, Serialize)]
#[non_exhaustive]
pub struct CadTags {
    /// Index of its body in [`CadFile::bodies`].
    pub body: Option<usize>,
    /// Name of its layer.
    pub layer: Option<String>,
    /// Name of its colour, or `#rrggbb`.
    pub colour: Option<String>,
}

/// A solid or a sheet of a file, where it stands in the assembly.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
#[non_exhaustive]
pub struct CadBody {
    /// Its own name, or else that of its product.
    pub name: Option<String>,
    /// Names of the products from the assembly as a whole down to the one that the body belongs to.
    pub path: Vec<String>,
    /// Number in the file.
    pub entity: u32,
    /// As in [`CadPatch::instance`].
    pub instance: u32,
    /// Whether the file says that its faces enclose a volume.
    pub solid: bool,
    /// Number of its faces that were read.
    pub faces: usize,
    /// Number of its faces that were not.
    pub skipped: usize,
}

impl CadPatch {
    /// Whether only a part of the patch's domain belongs to the surface.
    pub fn trimmed(&self) -> bool {
        self.patch.trim().is_some()
    }
}

/// What bounds a surface that was read.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum FaceBorder {
    /// Nothing but the end of the surface itself: the file gives no boundary curves.
    Natural,
    /// Boundary curves that follow lines of constant parameters all round: the patch's domain is that rectangle.
    Rectangle,
    /// Boundary curves, which the patch's trim holds.
    Trimmed,
}

/// How often an entity type occurs.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
#[non_exhaustive]
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
#[non_exhaustive]
pub struct Skipped {
    /// As in [`CadPatch::entity`].
    pub entity: u32,
    /// IGES entity type; 0 for JSON.
    pub type_number: u32,
    /// Name in the file, or else the name of the type.
    pub name: String,
    /// The kind of reason.
    pub kind: SkipKind,
    /// Why it was not read.
    pub reason: String,
}

/// Kinds of reasons not to read a surface.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum SkipKind {
    /// Hidden in the CAD system.
    Blanked,
    /// Marked as annotation, construction or the like.
    Purpose,
    /// A part of an entity that is not a surface.
    Dependent,
    /// A part of a subfigure that is placed nowhere.
    Template,
    /// An entity of a type that is not read.
    Unsupported,
    /// Whole data that gives no surface.
    Surface,
    /// Boundary curves that give no trim; the surface would be read without its border.
    Boundary,
}

/// How the boundary curves of all faces of a file became curves in the parameter planes of their patches. Lengths are in
/// the file's unit.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize)]
#[non_exhaustive]
pub struct TrimReport {
    /// Boundary curves (members of composite curves counted one by one).
    pub curves: usize,
    /// Of these: taken from the file's parameter plane without loss.
    pub exact: usize,
    /// Of these: refitted, because the patch's parameters are not those of the file.
    pub refitted: usize,
    /// Of these: space curves projected onto the surface.
    pub projected: usize,
    /// Faces whose curves in the parameter plane disagree with those in space by more than `tolerance`, so that the space
    /// curves were projected instead.
    pub rejected: usize,
    /// Largest distance between a curve in the parameter plane and the same curve in space, of all that were compared.
    pub largest_gap: f64,
    /// Largest distance in space of a fitted curve from what it stands for.
    pub largest_error: f64,
    /// Distance at which two curves count as the same (the largest of all faces).
    pub tolerance: f64,
    /// Gaps between curves of a boundary that are wider than ten times the tolerance of their face, but were closed, as they
    /// are small beside the whole part.
    pub bridged: usize,
    /// The largest of these.
    pub largest_bridge: f64,
}

/// Numbers of a file at a glance.
#[derive(Debug, Clone, PartialEq, Eq, Default, Serialize)]
#[non_exhaustive]
pub struct Summary {
    /// Surfaces and faces that became patches.
    pub patches: usize,
    /// Of these: with a trim.
    pub trimmed: usize,
    /// Of these: whose boundary curves are a rectangle of parameters.
    pub rectangles: usize,
    /// Surfaces and faces that were not read.
    pub skipped: usize,
    /// These by kind of reason, in the order of [`SkipKind`].
    pub reasons: Vec<(SkipKind, usize)>,
}

/// Content of a CAD file.
#[derive(Debug, Clone)]
#[non_exhaustive]
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
    /// The bodies that the surfaces belong to, where the file says so.
    pub bodies: Vec<CadBody>,
    /// Every entity of the file by type and form, in ascending order.
    pub entities: Vec<EntityCount>,
    /// Every surface that was not read.
    pub skipped: Vec<Skipped>,
    /// What happened to the boundary curves.
    pub trims: TrimReport,
    /// Faces that were read, but left out.
    pub healing: Healing,
    /// What was tolerated although the standard does not allow it, and what was changed on reading.
    pub notes: Vec<String>,
}

impl CadFile {
    /// Patches that come from no file, numbered from 1; lengths in `unit`. For [`write_json`](super::write_json).
    pub fn of(patches: Vec<NurbsPatch>, unit: LengthUnit) -> Self {
        let patches = (patches.into_iter().zip(1..)).map(|(patch, entity)| CadPatch {
            border: match patch.trim() {
                Some(_) => FaceBorder::Trimmed,
                None => FaceBorder::Natural,
            },
            patch,
            entity,
            type_number: 0,
            base: entity,
            instance: 0,
            name: None,
            tags: CadTags::default(),
        });
        CadFile {
            path: String::new(),
            format: CadFormat::Covact,
            unit,
            resolution: None,
            patches: patches.collect(),
            bodies: Vec::new(),
            entities: Vec::new(),
            skipped: Vec::new(),
            trims: TrimReport::default(),
            healing: Healing::default(),
            notes: Vec::new(),
        }
    }

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
    /// How much was read, and how much was not for which kind of reason.
    pub fn summary(&self) -> Summary {
        let mut reasons = std::collections::BTreeMap::new();
        for skipped in &self.skipped {
            *reasons.entry(skipped.kind).or_insert(0) += 1;
        }
        let count = |border| self.patches.iter().filter(|p| p.border == border).count();
        Summary {
            patches: self.patches.len(),
            trimmed: count(FaceBorder::Trimmed),
            rectangles: count(FaceBorder::Rectangle),
            skipped: self.skipped.len(),
            reasons: reasons.into_iter().collect(),
        }
    }

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
        for length in [
            &mut self.trims.largest_gap,
            &mut self.trims.largest_error,
            &mut self.trims.tolerance,
            &mut self.trims.largest_bridge,
        ] {
            *length *= factor;
        }
        self.healing.scale(factor);
        Ok(())
    }
}
