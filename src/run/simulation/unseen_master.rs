//! Contacts whose master lies between the points of its slave: a small, finely meshed body on a large one of a few elements. Hardly a
//! slave point meets such a master, and what it presses with is lost; with the sides exchanged, its own points meet the large one.
use super::variant::{Safe, is_directed};
use crate::model::{Model, PairModel};
use crate::scene::{LoadedScene, Passes, pointer};

/// How many times as long as the master's the edges of the slave's faces are, at least, and the part of the master's width (the root of
/// its area) above which they are as long as it is wide.
const COARSER: f64 = 3.0;
const WIDE: f64 = 0.5;

/// Whether the points of the slave hardly meet the master.
fn misses(pair: &PairModel) -> bool {
    let plain = pair.half.is_none() && pair.edges_of.is_none();
    let master = pair.body_master().filter(|m| plain && m.own.is_none());
    master.is_some_and(|master| {
        let width = master.element_size * (master.faces.len() as f64).sqrt();
        pair.element_size > COARSER * master.element_size && pair.element_size > WIDE * width
    })
}

/// The scene with the sides of such contacts exchanged, which is told, unless they name their passes, or their friction has a
/// direction of the master.
pub(super) fn with_seen_masters(
    scene: &LoadedScene,
    before: Option<&Safe>,
    model: &Model,
) -> Option<Safe> {
    if !model.pairs.iter().any(misses) {
        return None;
    }
    let mut safe = Safe::of(scene, before);
    let mut exchanged = false;
    for pair in model.pairs.iter().filter(|pair| misses(pair)) {
        let name = &pair.name;
        let Some(contact) = safe.loaded.scene.contacts.get_mut(name) else {
            continue;
        };
        let named = scene.has(&pointer(&["contacts", name, "passes"]));
        if named || contact.passes != Passes::Auto || is_directed(contact) {
            continue;
        }
        std::mem::swap(&mut contact.slave, &mut contact.master);
        exchanged = true;
        safe.notes.push(format!(
            "contact `{name}`: its sides are exchanged, and `{}` is the slave, of which now is what is told of a slave: it lies between \
             the points of `{}`, whose elements are far larger (`\"passes\": \"one\"` keeps the sides as they are)",
            contact.slave, contact.master
        ));
    }
    exchanged.then_some(safe)
}
