//! What a run that was repeated has other than its scene, as checkpoints keep it. Summaries and checkpoints tell of the scene that was
//! given: whoever looks for a run of it finds one that was repeated as well.
use super::Rims;
use super::again::Farthest;
use super::substitute::Former;
use super::variant::Safe;
use crate::run::checkpoint::bytes::{Malformed, Reader};
use crate::run::checkpoint::{CheckpointError, Sections};
use crate::run::march::take_variant;
use crate::scene::{Contact, Element, LoadedScene};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

#[derive(Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Changes {
    /// Of bodies, by their names.
    elements: BTreeMap<String, Element>,
    contacts: BTreeMap<String, Contact>,
    /// What is told of them, as warnings and as notes.
    warnings: Vec<String>,
    notes: Vec<String>,
    rims: Rims,
    /// Those of older checkpoints have none.
    #[serde(default)]
    former: Option<Former>,
    #[serde(default)]
    kept: Vec<String>,
    #[serde(default)]
    farthest: Option<Farthest>,
    #[serde(default)]
    joined: Vec<String>,
}

impl Changes {
    /// Those of a run of `scene`.
    pub fn of(scene: &LoadedScene, safe: Option<&Safe>, rims: Rims) -> Self {
        let mut changes = Changes {
            elements: BTreeMap::new(),
            contacts: BTreeMap::new(),
            warnings: Vec::new(),
            notes: Vec::new(),
            rims,
            former: None,
            kept: Vec::new(),
            farthest: None,
            joined: Vec::new(),
        };
        let Some(safe) = safe else {
            return changes;
        };
        let (given, now) = (&scene.scene, &safe.loaded.scene);
        let bodies = now.bodies.iter().map(|(name, body)| (name, body.element));
        changes.elements = bodies
            .filter(|(name, element)| {
                given
                    .bodies
                    .get(*name)
                    .is_none_or(|b| b.element != *element)
            })
            .map(|(name, element)| (name.clone(), element))
            .collect();
        changes.contacts = (now.contacts.iter())
            .filter(|(name, contact)| given.contacts.get(*name) != Some(contact))
            .map(|(name, contact)| (name.clone(), contact.clone()))
            .collect();
        changes.warnings.clone_from(&safe.changed);
        changes.notes.clone_from(&safe.notes);
        changes.former.clone_from(&safe.former);
        changes.kept.clone_from(&safe.kept);
        changes.farthest.clone_from(&safe.farthest);
        changes.joined.clone_from(&safe.joined);
        changes
    }

    /// As checkpoints keep them.
    pub fn text(&self) -> String {
        // Names, numbers and choices of a scene, all of which JSON can hold.
        serde_json::to_string(self).unwrap_or_default()
    }

    /// Those of a checkpoint of a run of `scene`: the scene in its place, where it was repeated, and what has become of rims.
    ///
    /// # Errors
    /// [`CheckpointError::Damaged`]
    pub fn read(
        sections: &Sections,
        scene: &LoadedScene,
    ) -> Result<(Option<Safe>, Rims), CheckpointError> {
        sections.read_first("variant", |from| {
            let (text, _) = take_variant(from)?;
            Changes::apply(text, scene).ok_or_else(|| malformed(from))
        })
    }

    /// Those of [`Self::text`] on a scene; nothing where they do not fit it.
    pub fn apply(text: &str, scene: &LoadedScene) -> Option<(Option<Safe>, Rims)> {
        let Changes {
            elements,
            contacts,
            warnings,
            notes,
            rims,
            former,
            kept,
            farthest,
            joined,
        } = serde_json::from_str(text).ok()?;
        let told = !warnings.is_empty();
        if elements.is_empty() && contacts.is_empty() && kept.is_empty() && !told {
            return Some((None, rims));
        }
        let mut loaded = scene.clone();
        for (name, element) in elements {
            loaded.scene.bodies.get_mut(&name)?.element = element;
        }
        for (name, contact) in contacts {
            *loaded.scene.contacts.get_mut(&name)? = contact;
        }
        let mut safe = Safe {
            loaded,
            changed: warnings,
            notes,
            former,
            kept,
            farthest,
            joined: Vec::new(),
        };
        for name in joined {
            safe.remove(&name);
        }
        Some((Some(safe), rims))
    }
}

fn malformed(from: &Reader) -> Malformed {
    from.malformed("changes that do not fit the scene")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{self, MasterSurface, Passes, Points};

    /// Whatever a contact may be given comes back as it was.
    #[test]
    fn changes_come_back() {
        let scene = scene::parse(
            r#"{
                "covact": 1,
                "materials": {"m": {"neo_hooke": {"E": 1, "nu": 0.3}}},
                "bodies": {"b": {"mesh": {"block": {"min": [0, 0, 0], "max": [1, 1, 1], "elements": [1, 1, 1]}}, "material": "m"}},
                "surfaces": {"s": {"plane": {"center": [0, 0, 2], "size": [2, 2]}}},
                "contacts": {
                    "c": {"slave": "b.top", "master": "s", "friction": {"coulomb": {"mu": "0.1 + 0.1*t"}}, "penalty": {"value": 0.1}},
                    "d": {"slave": "b.bottom", "master": "s"}
                }
            }"#,
            "scene.json",
        )
        .unwrap();
        let mut safe = Safe {
            loaded: scene.clone(),
            changed: vec!["one".to_owned()],
            notes: vec!["two".to_owned()],
            former: None,
            kept: vec!["d".to_owned()],
            farthest: None,
            joined: Vec::new(),
        };
        safe.loaded.scene.bodies.get_mut("b").unwrap().element = Element::H8MeanDilatation;
        let contact = safe.loaded.scene.contacts.get_mut("c").unwrap();
        contact.points = Points::Gauss(3);
        contact.passes = Passes::Edges;
        contact.master_surface = Some(MasterSurface::Smooth);
        let changes = Changes::of(&scene, Some(&safe), Rims::Instead);
        assert_eq!((changes.elements.len(), changes.contacts.len()), (1, 1));
        let (back, rims) = Changes::apply(&changes.text(), &scene).unwrap();
        let back = back.unwrap();
        assert_eq!(back.loaded.scene, safe.loaded.scene);
        assert_eq!((back.changed, back.notes), (safe.changed, safe.notes));
        assert_eq!((back.former, back.kept), (safe.former, safe.kept));
        assert_eq!(rims, Rims::Instead);
        let none = Changes::of(&scene, None, Rims::Settled).text();
        let (back, rims) = Changes::apply(&none, &scene).unwrap();
        assert!(back.is_none() && rims == Rims::Settled);
        assert!(Changes::apply(&changes.text().replace("\"c\"", "\"e\""), &scene).is_none());
        let older = none.replace(",\"former\":null,\"kept\":[]", "");
        assert!(older != none && Changes::apply(&older, &scene).is_some());
    }
}
