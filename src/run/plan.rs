//! `covact plan`: what a run of a scene would do, and nothing of it.
use super::Estimate;
use super::RunError;
use crate::model;
use crate::plan::Plan;
use crate::scene::LoadedScene;
use serde::Serialize;

/// The plan of a scene, with its sizes.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct PlanReport {
    /// The scene file as it was named.
    pub file: String,
    /// Title of the scene.
    pub title: String,
    /// Nodes of all bodies.
    pub nodes: usize,
    /// Elements of all bodies.
    pub elements: usize,
    /// Unknowns, prescribed ones left out.
    pub dofs: usize,
    /// Slave points of all contacts.
    pub contact_points: usize,
    /// Memory that a run takes at its largest, estimated.
    pub memory: Estimate,
    /// The effects and the contact pairs.
    #[serde(flatten)]
    pub plan: Plan,
}

/// Builds the model of a scene and plans its run.
///
/// # Errors
/// [`RunError::Scene`] with the place of what is wrong.
///
/// ```
/// let scene = covact::scene::load("examples/scenes/ironing.json")?;
/// let report = covact::run::plan(&scene)?;
/// assert!(report.plan.names().contains(&"contact.friction.coulomb".to_owned()));
/// assert!(report.dofs > 100);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn plan(scene: &LoadedScene) -> Result<PlanReport, RunError> {
    let model = model::build::build(scene).map_err(|e| RunError::model(scene, e))?;
    let memory = super::memory::estimate(scene, &model)?;
    Ok(PlanReport {
        file: scene.name.clone(),
        title: model.title.clone(),
        nodes: model.body_nodes(),
        elements: model.bodies.iter().map(|b| b.block.elements()).sum(),
        dofs: model.unknowns(),
        contact_points: model.contact_points(),
        memory,
        plan: Plan::new(scene, &model),
    })
}
