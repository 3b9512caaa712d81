//! The surface of a CAD file: all its faces as one set, with what the file says of each.

use super::report::{CadFile, CadPatch, CadTags, FaceBorder, SkipKind};
use crate::project::{Foot, Joining, PatchSet, PatchSetError, QueryError};
use crate::surface::Vec3;

/// Why a file gives no surface.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SurfaceError {
    /// All faces of the file are hidden in the CAD system.
    #[error("{path}: all {count} faces are hidden; `ReadOptions::hidden` reads them")]
    Hidden {
        /// Path or name of the file.
        path: String,
        /// Number of hidden faces.
        count: usize,
    },
    /// The file has faces, but none that could be read.
    #[error("{path}: none of {count} faces could be read; the first: entity {entity}: {reason}")]
    Unread {
        /// Path or name of the file.
        path: String,
        /// Number of faces.
        count: usize,
        /// The first of them.
        entity: u32,
        /// Why it was not read.
        reason: String,
    },
    /// The file holds no faces.
    #[error("{path}: there are no faces in the file")]
    Empty {
        /// Path or name of the file.
        path: String,
    },
    /// The faces cannot be joined to a set.
    #[error("{path}: {source}")]
    Set {
        /// Path or name of the file.
        path: String,
        /// Why not.
        source: PatchSetError,
    },
}

/// What a file says of a face of its surface. Numbers as in [`CadPatch`].
#[derive(Debug, Clone, PartialEq, Eq)]
#[non_exhaustive]
pub struct CadFace {
    /// Number of the face in the file.
    pub entity: u32,
    /// IGES: type of the entity; else 0.
    pub type_number: u32,
    /// Number of the surface that carries the face.
    pub base: u32,
    /// Number of what places this copy of the face, 0 where it stands where it is defined.
    pub instance: u32,
    /// What bounds it.
    pub border: FaceBorder,
    /// Its name in the file.
    pub name: Option<String>,
    /// Its body, layer and colour.
    pub tags: CadTags,
}

impl From<&CadPatch> for CadFace {
    fn from(patch: &CadPatch) -> Self {
        Self {
            entity: patch.entity,
            type_number: patch.type_number,
            base: patch.base,
            instance: patch.instance,
            border: patch.border,
            name: patch.name.clone(),
            tags: patch.tags.clone(),
        }
    }
}

/// All faces of a file, joined over their common edges.
#[derive(Debug, Clone)]
pub struct CadSurface {
    set: PatchSet,
    faces: Vec<CadFace>,
}

impl CadSurface {
    /// Closest point of the surface to `q`; see [`PatchSet::closest`].
    ///
    /// # Errors
    /// [`QueryError::NotFinite`].
    pub fn closest(&self, q: &Vec3) -> Result<Foot, QueryError> {
        self.set.closest(q)
    }

    /// Closest point within the distance `reach`; see [`PatchSet::closest_within`].
    ///
    /// # Errors
    /// [`QueryError::BeyondReach`] where nothing lies within it, [`QueryError::NotFinite`].
    pub fn closest_within(&self, q: &Vec3, reach: f64) -> Result<Foot, QueryError> {
        self.set.closest_within(q, reach)
    }

    /// The face that a patch of the set stands for, by the number in [`Foot::patch`].
    pub fn face(&self, patch: u32) -> Option<&CadFace> {
        self.faces.get(patch as usize)
    }

    /// Number in the file of the face that a patch stands for; 0 for a patch that there is not.
    pub fn entity(&self, patch: u32) -> u32 {
        self.face(patch).map_or(0, |face| face.entity)
    }

    /// All faces, in the order of the patches.
    pub fn faces(&self) -> &[CadFace] {
        &self.faces
    }

    /// The patches with their edges, sides and volumes.
    pub fn set(&self) -> &PatchSet {
        &self.set
    }

    /// The patches alone.
    pub fn into_set(self) -> PatchSet {
        self.set
    }
}

impl CadFile {
    /// How edges of the file are joined unless somebody says otherwise: by its own resolution.
    pub fn joining(&self) -> Joining {
        Joining {
            tolerance: None,
            resolution: self.resolution,
        }
    }

    /// The faces that were read as one surface, in the unit of the file; [`skipped`](Self::skipped) are missing in it. Closed
    /// parts have their volume inside, cavities of a body outside.
    ///
    /// # Errors
    /// No faces, with the reason; faces of no usable size.
    pub fn surface(&self) -> Result<CadSurface, SurfaceError> {
        self.clone().into_surface()
    }

    /// [`surface`](Self::surface) without copies of the patches.
    ///
    /// # Errors
    /// As [`surface`](Self::surface).
    pub fn into_surface(self) -> Result<CadSurface, SurfaceError> {
        let path = self.path.clone();
        if self.patches.is_empty() {
            return Err(self.missing());
        }
        let joining = self.joining();
        let faces: Vec<CadFace> = self.patches.iter().map(CadFace::from).collect();
        let patches = self.patches.into_iter().map(|p| p.patch).collect();
        match PatchSet::join(patches, joining) {
            Ok(mut set) => {
                set.turn_cavities(|patch| faces[patch].tags.body);
                Ok(CadSurface { set, faces })
            }
            Err(source) => Err(SurfaceError::Set { path, source }),
        }
    }

    /// Why there are no patches.
    fn missing(self) -> SurfaceError {
        let hidden = |s: &&super::Skipped| s.kind == SkipKind::Blanked;
        let path = self.path;
        match self.skipped.iter().find(|s| !hidden(s)) {
            Some(first) => SurfaceError::Unread {
                path,
                count: self.skipped.len(),
                entity: first.entity,
                reason: first.reason.clone(),
            },
            None if self.skipped.is_empty() => SurfaceError::Empty { path },
            None => SurfaceError::Hidden {
                path,
                count: self.skipped.len(),
            },
        }
    }
}
