//! Stages: their times, and the names in them.
use super::checker::{Checker, path};
use crate::scene::problem::{shorten, suggestion};
use crate::scene::types::*;
use crate::scene::value::Value;
use std::collections::BTreeSet;

/// Problems of the stages of a scene.
pub(super) fn check(c: &mut Checker, scene: &Scene) {
    if scene.stages.is_empty() {
        return;
    }
    together(c, scene);
    let mut names = BTreeSet::new();
    for (index, stage) in scene.stages.iter().enumerate() {
        let at = path(&["stages", &index.to_string()]);
        if stage.name.trim().is_empty() {
            c.add(&format!("{at}/name"), "the name of a stage is empty", None);
        }
        if !names.insert(&stage.name) {
            let message = format!("two stages have the name `{}`", shorten(&stage.name));
            c.add(
                &format!("{at}/name"),
                message,
                Some("choose another name".into()),
            );
        }
        check_time(c, &at, scene, index);
        if check_names(c, &at, scene, stage) {
            check_release(c, &at, scene, index);
            check_starts(c, &at, scene, index);
        }
        check_tools(c, &at, scene, index);
        check_loads(c, &at, scene, stage);
    }
}

/// What stages do not go with.
fn together(c: &mut Checker, scene: &Scene) {
    if scene.solution.dynamics.is_some() {
        let message = "`stages` do not go with `dynamics`";
        let help = "leave out one of the two; tables of motions and loads go with inertia";
        c.add("/stages", message, Some(help.into()));
    }
    if scene.solution.kinematics == Kinematics::Small {
        let message = "`stages` do not go with small displacements, whose system is made once";
        let help = "take `\"kinematics\": \"large\"`";
        c.add("/solution/kinematics", message, Some(help.into()));
    }
    if scene.finds_supports() {
        for (section, taken) in [
            ("supports", scene.supports.contains_key(AUTOMATIC)),
            ("surfaces", scene.surfaces.contains_key(AUTOMATIC)),
            ("loads", scene.loads.contains_key(AUTOMATIC)),
        ] {
            if taken {
                let message = format!(
                    "`{AUTOMATIC}` is the name of the supports that stages find, and of columns of the history"
                );
                c.add(
                    &path(&[section, AUTOMATIC]),
                    message,
                    Some("choose another name".into()),
                );
            }
        }
    }
}

fn check_time(c: &mut Checker, at: &str, scene: &Scene, index: usize) {
    let (stage, end) = (&scene.stages[index], scene.solution.end_time);
    let last = index + 1 == scene.stages.len();
    let place = format!("{at}/until");
    let Some(until) = stage.until else {
        if !last {
            let message = format!(
                "the stage `{}` does not say when it ends",
                shorten(&stage.name)
            );
            let help = "give the time `until` which it goes; only the last stage ends with the run";
            c.add(at, message, Some(help.into()));
        }
        return;
    };
    let before = match index {
        0 => 0.0,
        _ => scene.stages[index - 1].until.unwrap_or(0.0),
    };
    if !(until > before && until.is_finite()) {
        let message = format!("the stage ends at {until}, and begins at {before}");
        c.add(&place, message, Some("times of stages increase".into()));
    } else if last && until != end {
        let message = format!("the last stage ends at {until}, and the run at {end}");
        let help = "leave `until` out, or give the run this `end_time` in `solution`";
        c.add(&place, message, Some(help.into()));
    } else if !last && until >= end {
        let message = format!("the stage ends at {until}, and the run at {end} already");
        let help = "end the stage sooner, or the run later (`end_time` in `solution`)";
        c.add(&place, message, Some(help.into()));
    }
}

/// Whether the contacts and supports that a stage names exist.
fn check_names(c: &mut Checker, at: &str, scene: &Scene, stage: &Stage) -> bool {
    let mut known = true;
    let places = |names: &Option<SetNames>, key: &str| -> Vec<(String, String)> {
        let at = format!("{at}/{key}");
        let places = names.iter().flat_map(|names| names.places(&at));
        places.map(|(at, name)| (at, name.to_owned())).collect()
    };
    for (place, name) in places(&stage.contacts, "contacts") {
        c.refers(&place, "contact", "contacts", &name, scene.contacts.keys());
        known &= scene.contacts.contains_key(&name);
    }
    let supports = || {
        let automatic = std::iter::once(AUTOMATIC);
        scene.supports.keys().map(String::as_str).chain(automatic)
    };
    for (place, name) in places(&stage.supports, "supports") {
        if !supports().any(|s| s == name) {
            let help = suggestion(&name, "supports", supports().collect::<Vec<_>>());
            let message = format!("there is no support `{}`", shorten(&name));
            c.add(&place, message, Some(help));
        }
    }
    known
}

fn check_release(c: &mut Checker, at: &str, scene: &Scene, index: usize) {
    let stage = &scene.stages[index];
    let place = format!("{at}/release");
    let Some(release) = stage.release else {
        return;
    };
    let ending = scene.ending_contacts(index);
    if ending.is_empty() {
        let message = match index {
            0 => "the first stage has nothing to release",
            _ => "no contact of the stage before ends here, so that nothing is released",
        };
        let help = "`contacts` lists those that go on; without the list all of them end";
        return c.add(&place, message, Some(help.into()));
    }
    if release == Release::Forces {
        return;
    }
    let active = scene.active_contacts(index);
    for name in &ending {
        let Some(contact) = scene.contacts.get(*name) else {
            continue;
        };
        let master = shorten(contact.master.single());
        let Some(surface) = contact.surface(&scene.surfaces) else {
            let message = format!(
                "the master `{master}` of contact `{name}` is a body, which has no way back of its own"
            );
            let help = "take `\"release\": \"forces\"`, or list the contact in `contacts`";
            c.add(&place, message, Some(help.into()));
            continue;
        };
        if surface.motion.free.is_some() {
            let message =
                format!("surface `{master}` is driven by force: it has no way back that is known");
            let help = "take `\"release\": \"forces\"`, or list its contacts in `contacts`";
            c.add(&place, message, Some(help.into()));
        }
        let shared = |other: &&&str| {
            !ending.contains(**other)
                && scene
                    .contacts
                    .get(**other)
                    .is_some_and(|o| o.master == contact.master)
        };
        if let Some(other) = active.iter().find(shared) {
            let message = format!(
                "surface `{master}` would go back, but contact `{other}`, which goes on, has it as its master"
            );
            let help = format!(
                "list contact `{name}` in `contacts` too, or take `\"release\": \"forces\"`"
            );
            c.add(&place, message, Some(help));
        }
    }
}

/// Contacts that begin in a later stage.
fn check_starts(c: &mut Checker, at: &str, scene: &Scene, index: usize) {
    let place = format!("{at}/contacts");
    let earlier = match index {
        0 => return check_driven(c, at, scene),
        _ => scene.active_contacts(index - 1),
    };
    for name in scene.active_contacts(index).difference(&earlier) {
        let Some(contact) = scene.contacts.get(*name) else {
            continue;
        };
        if contact.initial_overclosure != InitialOverclosure::Strain {
            let message = format!(
                "contact `{name}` begins with this stage, and its `initial_overclosure` is that of the undeformed bodies"
            );
            let help = "leave `initial_overclosure` out for a contact that begins later";
            c.add(&place, message, Some(help.into()));
        }
        let gone = (1..index).find(|k| scene.returning_tools(*k).contains(contact.master.single()));
        if let Some(gone) = gone {
            let message = format!(
                "contact `{name}` begins with this stage, but surface `{}` has gone back in the stage `{}`",
                shorten(contact.master.single()),
                shorten(&scene.stages[gone].name)
            );
            c.add(
                &place,
                message,
                Some("give the later contact a surface of its own".into()),
            );
        }
    }
}

/// A surface driven by force is in contact from the start: its place is not known otherwise.
fn check_driven(c: &mut Checker, at: &str, scene: &Scene) {
    let active = scene.active_contacts(0);
    for (name, contact) in &scene.contacts {
        let driven = contact
            .surface(&scene.surfaces)
            .is_some_and(|s| s.motion.free.is_some());
        if driven && !active.contains(name.as_str()) {
            let message = format!(
                "contact `{name}` is not active in the first stage, and its surface `{}` is driven by force: its place \
                 would not be known",
                shorten(contact.master.single())
            );
            let help = "list the contact in `contacts`, or prescribe the motion of the surface";
            c.add(&format!("{at}/contacts"), message, Some(help.into()));
        }
    }
}

fn check_tools(c: &mut Checker, at: &str, scene: &Scene, index: usize) {
    let returning = scene.returning_tools(index);
    for (name, way) in &scene.stages[index].tools {
        let place = format!("{at}/tools/{}", name.replace('~', "~0").replace('/', "~1"));
        c.finite(&place, way);
        let Some(surface) = scene.surfaces.get(name) else {
            c.refers(&place, "surface", "surfaces", name, scene.surfaces.keys());
            continue;
        };
        let zero = |v: &Value| *v == Value::Number(0.0);
        if !surface.motion.translation.iter().all(zero) {
            let message = format!(
                "surface `{}` has a `motion.translation` of its own, which is that of the whole run",
                shorten(name)
            );
            let help = "leave out one of the two";
            c.add(&place, message, Some(help.into()));
        }
        if returning.contains(name.as_str()) {
            let message = format!("surface `{}` goes back in this stage", shorten(name));
            let help = "leave it out of `tools`, or take `\"release\": \"forces\"`";
            c.add(&place, message, Some(help.into()));
        }
    }
}

fn check_loads(c: &mut Checker, at: &str, scene: &Scene, stage: &Stage) {
    for (name, factor) in &stage.loads {
        let place = format!("{at}/loads/{}", name.replace('~', "~0").replace('/', "~1"));
        c.finite(&place, &[*factor]);
        let Some(load) = scene.loads.get(name) else {
            c.refers(&place, "load", "loads", name, scene.loads.keys());
            continue;
        };
        let vectors = [&load.force, &load.traction, &load.gravity];
        let given = (vectors.into_iter().flatten().flatten())
            .chain(&load.pressure)
            .chain(&load.couple);
        if given.into_iter().any(|v| !matches!(v, Value::Number(_))) {
            let message = format!(
                "load `{}` is not given by numbers, which a stage could multiply",
                shorten(name)
            );
            let help = "give the load a number in place of a table or an expression, or leave it out of the stage";
            c.add(&place, message, Some(help.into()));
        }
    }
}
