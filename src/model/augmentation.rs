//! Augmentation of a contact pair: how near the tractions have to come to multipliers, and how stiff a penalty may become
//! on the way.
use super::penalty;
use crate::scene::Augmentation;

/// Augmentation of a pair.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AugmentationModel {
    /// Largest gap of a point in contact (length).
    pub gap: f64,
    /// Largest elastic slip of a point that sticks (length).
    pub slip: f64,
    /// Augmentations of a step after which it is cut.
    pub max: u32,
    /// Penalty up to which the augmentation may raise the pair's (force / length^3).
    pub stiffest: f64,
}

/// Penalty that augmentation may go to, as a multiple of the element stiffness `E / s`. The accuracy of a solve falls with
/// the penalty; at this multiple some six digits are left on a thin plate, and what the penalty does not give the multipliers
/// do.
const STIFFEST: f64 = 1e3;

impl AugmentationModel {
    /// The augmentation of a scene for slave elements of a size; `automatic` is the pair's automatic penalty.
    pub fn new(asked: &Augmentation, element_size: f64, automatic: f64) -> Self {
        AugmentationModel {
            gap: asked.gap * element_size,
            slip: asked.slip * element_size,
            max: asked.max,
            stiffest: STIFFEST / penalty::FACTOR * automatic,
        }
    }
}
