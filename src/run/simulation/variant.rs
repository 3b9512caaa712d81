//! What a run that stopped is repeated with: bodies with other elements, where their default ones give way in strong
//! compression, and contacts with the edges of their masters, where such an edge lies on the slave.
use crate::model::error::number;
use crate::run::checkpoint::{self, Fingerprint};
use crate::scene::{Element, LoadedScene, Passes, pointer};
use std::path::Path;

/// A scene with other elements or passes than the default ones, and what is told of the change.
#[derive(Debug, Clone)]
pub(in crate::run) struct Safe {
    pub loaded: LoadedScene,
    pub changed: Vec<String>,
}

/// The scene with displacement elements for the bodies whose default elements a run could not go on with: enhanced strains lose
/// their hold in strong compression, and steps accepted before may have suffered. Nothing where the scene names the
/// elements.
pub(super) fn safe_variant<'n>(
    scene: &LoadedScene,
    before: Option<&Safe>,
    squeezed: impl Iterator<Item = &'n str>,
    time: f64,
) -> Option<Safe> {
    let when = format!("gave way at time {}", number(time));
    let mut safe = None;
    for body in squeezed {
        let before = safe.as_ref().or(before);
        safe = replaced(scene, before, body, &when).or(safe);
    }
    safe
}

/// The scene with displacement elements for a body, where it leaves the element to its default.
fn replaced(scene: &LoadedScene, before: Option<&Safe>, body: &str, when: &str) -> Option<Safe> {
    if names_element(scene, body) {
        return None;
    }
    let (mut loaded, mut changed) = match before {
        Some(Safe { loaded, changed }) => (loaded.clone(), changed.clone()),
        None => (scene.clone(), Vec::new()),
    };
    let element = &mut loaded.scene.bodies.get_mut(body)?.element;
    if *element != Element::H8 {
        return None;
    }
    *element = Element::H8Displacement;
    changed.push(format!(
        "body `{body}`: its default elements (`h8`) {when}, as they do in strong compression; the run was repeated with \
         `h8_displacement` for it, which is stiffer in bending: refine it where it bends, and name the `element` to have one of \
         them from the start"
    ));
    Some(Safe { loaded, changed })
}

/// The scene with the edges of masters as slaves, in every contact with another body that leaves its passes to the default.
pub(super) fn with_edges(
    scene: &LoadedScene,
    before: Option<&Safe>,
    time: Option<f64>,
) -> Option<Safe> {
    let (mut loaded, mut changed) = match before {
        Some(Safe { loaded, changed }) => (loaded.clone(), changed.clone()),
        None => (scene.clone(), Vec::new()),
    };
    let mut found = Vec::new();
    let of = |set: &str| set.split('.').next().map(str::to_owned);
    for (name, contact) in &mut loaded.scene.contacts {
        let bodies = [of(&contact.slave), of(&contact.master)];
        let other = bodies[0] != bodies[1] && !scene.scene.surfaces.contains_key(&contact.master);
        if other && contact.passes == Passes::One && !names_passes(scene, name) {
            contact.passes = Passes::Edges;
            found.push(format!("`{name}`"));
        }
    }
    if found.is_empty() {
        return None;
    }
    changed.push(format!(
        "contact {}: the run stopped{} while a sharp edge of the master lay on the slave, between its points; it was repeated \
         with such edges as slaves too (`\"passes\": \"edges\"`; `\"one\"` leaves them out, and the side with the edge as \
         slave needs none)",
        found.join(", "),
        time.map_or(String::new(), |t| format!(" at time {}", number(t)))
    ));
    Some(Safe { loaded, changed })
}

/// Whether a scene names the passes of a contact, rather than leaving them to their default.
fn names_passes(scene: &LoadedScene, contact: &str) -> bool {
    scene.has(&pointer(&["contacts", contact, "passes"]))
}

/// Bodies of a scene up to which all choices of them are looked through.
const MANY: usize = 6;

/// The variant of the scene that a folder holds an unfinished run of, where it is one with other elements for some bodies, or
/// with the edges of masters.
pub(in crate::run) fn variant_in(out: &Path, scene: &LoadedScene) -> Option<Safe> {
    let holds = |loaded: &LoadedScene| checkpoint::find(out, &Fingerprint::new(loaded)).is_ok();
    if holds(scene) {
        return None;
    }
    let bodies: Vec<&String> = scene.scene.bodies.keys().collect();
    // Of many bodies one of them, or all.
    let choices: Vec<Vec<bool>> = match bodies.len() {
        n @ ..=MANY => (1..1u32 << n)
            .map(|bits| (0..n).map(|k| bits >> k & 1 == 1).collect())
            .collect(),
        n => (0..=n)
            .map(|one| (0..n).map(|k| one == n || k == one).collect())
            .collect(),
    };
    let elements = choices.iter().filter_map(|chosen| {
        let chosen = bodies.iter().zip(chosen).filter(|(_, chosen)| **chosen);
        chosen.fold(None, |safe: Option<Safe>, (body, _)| {
            replaced(scene, safe.as_ref(), body, "gave way").or(safe)
        })
    });
    let elements: Vec<Safe> = elements.collect();
    let edges = |before: Option<&Safe>| with_edges(scene, before, None);
    let mut edged: Vec<Safe> = edges(None).into_iter().collect();
    edged.extend(elements.iter().filter_map(|before| edges(Some(before))));
    elements
        .into_iter()
        .chain(edged)
        .find(|safe| holds(&safe.loaded))
}

/// Whether a scene names the element of a body, rather than leaving it to its default.
pub(super) fn names_element(scene: &LoadedScene, body: &str) -> bool {
    scene.has(&pointer(&["bodies", body, "element"]))
}
