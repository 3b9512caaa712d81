//! `covact check`: everything up to the first solve, and nothing of it.
use super::RunError;
use crate::model::initial::initial_gap;
use crate::model::{self};
use crate::scene::LoadedScene;
use serde::Serialize;

/// What a scene amounts to.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct CheckReport {
    pub title: String,
    pub nodes: usize,
    pub elements: usize,
    /// Unknowns, prescribed ones left out.
    pub dofs: usize,
    pub contact_points: usize,
    pub pairs: Vec<PairReport>,
    /// Effects that are on, by name.
    pub effects: Vec<String>,
    /// Choices the program made, in words.
    pub notes: Vec<String>,
    pub warnings: Vec<String>,
}

/// A contact pair before anything moves.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct PairReport {
    pub name: String,
    pub points: usize,
    /// Penalty (force / length^3).
    pub penalty: f64,
    /// Smallest and largest initial distance.
    pub gap: [f64; 2],
    /// Points that start in contact.
    pub touching: usize,
}

/// Reads and checks everything a scene names.
///
/// # Errors
/// [`RunError::Scene`] with the place of what is wrong.
pub fn check(scene: &LoadedScene) -> Result<CheckReport, RunError> {
    let model = model::build::build(scene).map_err(|e| RunError::model(scene, e))?;
    let mut pairs = Vec::new();
    for (i, pair) in model.pairs.iter().enumerate() {
        let gap = initial_gap(&model, i).map_err(|e| RunError::model(scene, e))?;
        pairs.push(PairReport {
            name: pair.name.clone(),
            points: pair.points.len(),
            penalty: pair.eps_n,
            gap: [gap.smallest, gap.largest],
            touching: gap.touching,
        });
    }
    Ok(CheckReport {
        title: model.title.clone(),
        nodes: model.nodes.len(),
        elements: model.bodies.iter().map(|b| b.block.elements()).sum(),
        dofs: model.unknowns(),
        contact_points: model.contact_points(),
        pairs,
        effects: model.effects.clone(),
        notes: model.notes.clone(),
        warnings: model.warnings.clone(),
    })
}
