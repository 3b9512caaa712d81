//! Patches of one entity, with what bounds them.

use super::super::report::{FaceBorder, SkipKind};
use super::rivals::Rival;
use crate::NurbsPatch;

/// A reason to skip a surface.
pub type Refusal = (SkipKind, String);

/// A patch with what bounds it, and the one that other curves of the file would bound.
pub struct Piece {
    pub patch: NurbsPatch,
    pub border: FaceBorder,
    pub rival: Option<Rival>,
}

impl Piece {
    pub fn whole(patch: NurbsPatch) -> Self {
        Self {
            patch,
            border: FaceBorder::Natural,
            rival: None,
        }
    }
}

/// The patches of one entity.
pub type Found = Result<Vec<Piece>, Refusal>;

/// The pieces with the opposite normals.
pub fn turned(pieces: Vec<Piece>) -> Found {
    let turn = |piece: Piece| -> Result<Piece, crate::PatchError> {
        let rival = piece.rival.map(Rival::turned).transpose()?;
        Ok(Piece {
            patch: piece.patch.reversed(0)?,
            rival,
            ..piece
        })
    };
    let turned = pieces.into_iter().map(turn).collect::<Result<_, _>>();
    turned.map_err(|e| (SkipKind::Surface, e.to_string()))
}

/// How a patch is bounded, by whether it has a trim.
pub fn border_of(patch: &NurbsPatch) -> FaceBorder {
    match patch.trim() {
        Some(_) => FaceBorder::Trimmed,
        None => FaceBorder::Rectangle,
    }
}
