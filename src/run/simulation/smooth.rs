//! A run repeated with smooth masters, since slave points slide over flat faces that stand for curved ones: gaps are measured between the
//! curved surfaces as the points lie at the start, and elsewhere flat faces make other ones.
use super::variant::{Safe, stopped};
use crate::model::build::build_stage;
use crate::model::stages::StageStart;
use crate::model::{Model, PairModel};
use crate::scene::{Contact, LoadedScene, MasterSurface, Points};

/// How what is told of such a run begins.
const SLID: &str = "while its points slid over flat faces that stand for curved ones";

/// Whether the master of a contact may be a smooth surface by itself: the faces of another body, in a contact that leaves this to the
/// default.
pub(super) fn smooth_may(scene: &LoadedScene, contact: &Contact) -> bool {
    let surfaces = &scene.scene.surfaces;
    contact.master_surface.is_none()
        && !matches!(contact.points, Points::Segments(_))
        && !contact.is_own(surfaces)
        && contact.surface(surfaces).is_none()
}

/// The pairs of a model whose flat masters stand for curved ones, and may be smooth: of all of them the model is to be had.
pub(super) fn smooth_pairs(loaded: &LoadedScene, model: &Model, stage: &StageStart) -> Vec<usize> {
    let may = |p: &PairModel| {
        let contact = loaded.scene.contacts.get(&p.name);
        p.below.is_some() && contact.is_some_and(|contact| smooth_may(loaded, contact))
    };
    let found: Vec<usize> = (0..model.pairs.len())
        .filter(|i| may(&model.pairs[*i]))
        .collect();
    let names: Vec<&str> = found.iter().map(|i| &*model.pairs[*i].name).collect();
    let smooth = with_smooth_below(loaded, None, 0.0, &names);
    let built = smooth.is_some_and(|safe| build_stage(&safe.loaded, stage.clone(), None).is_ok());
    if built { found } else { Vec::new() }
}

/// The scene with smooth masters in some contacts.
pub(super) fn with_smooth_below(
    scene: &LoadedScene,
    before: Option<&Safe>,
    time: f64,
    contacts: &[&str],
) -> Option<Safe> {
    let mut safe = Safe::of(scene, before);
    let mut found = Vec::new();
    for name in contacts {
        let contact = safe.loaded.scene.contacts.get(*name)?;
        if smooth_may(scene, contact) {
            let contact = safe.loaded.scene.contacts.get_mut(*name)?;
            contact.master_surface = Some(MasterSurface::Smooth);
            found.push(format!("`{name}`"));
        }
    }
    let text = format!(
        "{SLID}, by which their gaps change; it was repeated with one smooth surface through the nodes of the master's faces \
         (`\"master_surface\": \"smooth\"`; `\"faces\"` leaves them flat)"
    );
    safe.notes.push(stopped(&found, Some(time), &text));
    (!found.is_empty()).then_some(safe)
}

/// The scene with flat faces again, where a run with smooth ones stopped.
pub(super) fn flat_again(scene: &LoadedScene, before: Option<&Safe>, time: f64) -> Option<Safe> {
    let mut safe = before?.clone();
    if !safe.notes.iter().any(|text| text.contains(SLID)) {
        return None;
    }
    let mut found = Vec::new();
    for (name, contact) in &scene.scene.contacts {
        let now = safe.loaded.scene.contacts.get_mut(name)?;
        if smooth_may(scene, contact) && now.master_surface == Some(MasterSurface::Smooth) {
            now.master_surface = Some(MasterSurface::Faces);
            found.push(format!("`{name}`"));
        }
    }
    safe.notes.retain(|text| !text.contains(SLID));
    let text = "with a smooth master; it was repeated with its flat faces (`\"master_surface\": \"faces\"` has that from the start)";
    safe.changed.push(stopped(&found, Some(time), text));
    (!found.is_empty()).then_some(safe)
}
