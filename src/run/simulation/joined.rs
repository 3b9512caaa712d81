//! Contacts that are one: those of the same slave with neighbouring faces of a body. Taken each by itself their masters end at the edge
//! between them: a slave point that comes round it is beside one of them, and deep below the other, which it never touched.
use super::variant::Safe;
use crate::model::build::build_stage;
use crate::model::edges::border;
use crate::model::stages::StageStart;
use crate::model::{Model, PairModel};
use crate::scene::{Contact, LoadedScene, Scene, SetNames, Stage};
use covact_geometry::Vec3;
use std::collections::HashMap;

/// Sine of the angle by which a face rises above its neighbour from which on their edge is hollow.
const HOLLOW: f64 = 1e-3;

/// The scene with one contact for all that are one, under the name of the first, which is told; nothing where there are none.
pub(super) fn with_joined(scene: &LoadedScene) -> Option<Safe> {
    let alike = alike(&scene.scene);
    if alike.is_empty() {
        return None;
    }
    // What is wrong with the model is told where it is built in earnest.
    let model = build_stage(scene, StageStart::default(), None).ok()?;
    let mut safe = Safe::of(scene, None);
    for names in alike {
        for group in neighbours(&model, &names) {
            safe.join(&group);
        }
    }
    (!safe.joined.is_empty()).then_some(safe)
}

/// Names of contacts that are the same but for the faces of their master, all of one body, and act in the same stages.
fn alike(scene: &Scene) -> Vec<Vec<&str>> {
    let mut found: Vec<Vec<&str>> = Vec::new();
    for (name, contact) in &scene.contacts {
        let one = |other: &Vec<&str>| {
            let other =
                (other.first()).and_then(|other| Some((*other, scene.contacts.get(*other)?)));
            other.is_some_and(|(first, other)| {
                of_one_body(contact, other) && act_together(scene, [first, name])
            })
        };
        let bodies = contact.surface(&scene.surfaces).is_none() && !contact.is_own(&scene.surfaces);
        match found.iter_mut().find(|of| one(of)) {
            Some(of) if bodies => of.push(name),
            _ if bodies => found.push(vec![name]),
            _ => {}
        }
    }
    found.retain(|names| names.len() > 1);
    found
}

fn of_one_body(contact: &Contact, other: &Contact) -> bool {
    let master = SetNames::clone(&other.master);
    let same = Contact {
        master,
        ..contact.clone()
    };
    same == *other && contact.master.body() == other.master.body()
}

fn act_together(scene: &Scene, names: [&str; 2]) -> bool {
    (0..scene.stages.len()).all(|index| {
        let active = scene.active_contacts(index);
        let [first, second] = names.map(|name| active.contains(name));
        first == second
    })
}

/// Where a face meets the border of the faces of a master: its outward unit normal and its middle.
type Border = HashMap<[u32; 2], [Vec3; 2]>;

/// Of these contacts, groups whose masters are connected by edges that are not hollow: in a hollow one a point may bear on both faces.
fn neighbours<'n>(model: &Model, names: &[&'n str]) -> Vec<Vec<&'n str>> {
    let mut groups: Vec<(Vec<&str>, Vec<Border>)> = Vec::new();
    for &name in names {
        let of = |pair: &&PairModel| pair.name == name && pair.edges_of.is_none();
        let Some(master) = model.pairs.iter().find(of).and_then(|p| p.body_master()) else {
            continue;
        };
        let border = border(&model.bodies[master.body].mesh, &master.faces);
        let meets = |(_, borders): &(_, Vec<Border>)| borders.iter().any(|b| meet(b, &border));
        let (near, far) = groups.into_iter().partition::<Vec<_>, _>(meets);
        groups = far;
        let (mut names, mut borders): (Vec<_>, Vec<_>) = near.into_iter().unzip();
        names.push(vec![name]);
        borders.push(vec![border]);
        groups.push((names.concat(), borders.into_iter().flatten().collect()));
    }
    let names = groups.into_iter().map(|(names, _)| names);
    names.filter(|names| names.len() > 1).collect()
}

/// Whether two borders have edges in common, none of which is hollow.
fn meet(one: &Border, other: &Border) -> bool {
    let common = one
        .iter()
        .filter_map(|(edge, face)| Some((face, other.get(edge)?)));
    let hollow = |([n, at], [_, beside]): (&[Vec3; 2], &[Vec3; 2])| {
        let way = beside - at;
        way.dot(n) > HOLLOW * way.norm()
    };
    let mut hollow = common.map(hollow).peekable();
    hollow.peek().is_some() && !hollow.any(|hollow| hollow)
}

impl Safe {
    /// Makes one contact of these, which is told under the name of the first.
    fn join(&mut self, names: &[&str]) {
        let Some((&first, others)) = names.split_first() else {
            return;
        };
        let contacts = &mut self.loaded.scene.contacts;
        let masters: Vec<SetNames> = (names.iter())
            .filter_map(|name| Some(contacts.get(*name)?.master.clone()))
            .collect();
        let mut sets: Vec<String> = Vec::new();
        for set in masters.iter().flat_map(SetNames::iter) {
            if !sets.iter().any(|other| other == set) {
                sets.push(set.to_owned());
            }
        }
        let listed: Vec<String> = names.iter().map(|name| format!("`{name}`")).collect();
        self.notes.push(format!(
            "contacts {} have the same slave and neighbouring faces of body `{}` as their masters: they are taken as one contact, \
             `{first}`, with `\"master\": [{}]`, so that their common edge belongs to it; all forces are told there",
            listed.join(", "),
            masters.first().map_or("", SetNames::body),
            sets.iter().map(|set| format!("\"{set}\"")).collect::<Vec<_>>().join(", ")
        ));
        if let Some(contact) = contacts.get_mut(first) {
            contact.master = SetNames::List(sets);
        }
        for name in others {
            self.remove(name);
        }
    }

    /// Takes out a contact whose master another one has.
    pub(super) fn remove(&mut self, name: &str) {
        self.joined.push(name.to_owned());
        let scene = &mut self.loaded.scene;
        scene.contacts.remove(name);
        take_out(&mut scene.stages, &self.joined);
    }
}

/// Takes contacts out of the lists of stages.
pub(super) fn take_out(stages: &mut [Stage], names: &[String]) {
    for contacts in stages.iter_mut().filter_map(|s| s.contacts.as_mut()) {
        let left = contacts
            .iter()
            .filter(|name| !names.iter().any(|n| n == name));
        let left: Vec<String> = left.map(str::to_owned).collect();
        if left.len() < contacts.iter().count() {
            *contacts = SetNames::List(left);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two faces of unit size that meet at x = 0, the second one turned up by an angle.
    fn faces(angle: f64) -> [Border; 2] {
        let (sin, cos) = angle.sin_cos();
        let edge = [3, 7];
        [
            Border::from([(edge, [Vec3::z(), Vec3::new(-0.5, 0.0, 0.0)])]),
            Border::from([
                (
                    edge,
                    [
                        Vec3::new(-sin, 0.0, cos),
                        Vec3::new(0.5 * cos, 0.0, 0.5 * sin),
                    ],
                ),
                ([7, 8], [Vec3::z(), Vec3::zeros()]),
            ]),
        ]
    }

    #[test]
    fn faces_of_a_hollow_corner_stay_apart() {
        for (angle, joined) in [
            (-1.5, true),
            (-0.1, true),
            (0.0, true),
            (0.1, false),
            (1.5, false),
        ] {
            let [one, other] = faces(angle);
            assert_eq!(
                [meet(&one, &other), meet(&other, &one)],
                [joined; 2],
                "{angle}"
            );
        }
        let [one, mut other] = faces(-1.0);
        other.remove(&[3, 7]);
        assert!(!meet(&one, &other));
    }
}
