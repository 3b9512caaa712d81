//! What a run that stopped is repeated with: bodies with other elements, where their default ones give way in strong
//! compression, and contacts with the edges of their masters, where such an edge lies on the slave, with their sides exchanged,
//! where the master is the softer one, or with smooth masters.
use super::again::Farthest;
use super::substitute::Former;
use crate::model::error::number;
use crate::output::Table;
use crate::scene::{
    Contact, Element, Friction, Kinematics, LoadedScene, MasterSurface, MeshSource, Passes, Points,
    Scene, SetNames, pointer,
};

/// Gauss points along each direction of a face that see what its nodes do not, and of an element of a CAD surface that bends, which
/// spans many of the faces that a shell of bricks would have.
const SEEING: u8 = 3;
const SEEING_SHEETS: u8 = 10;

/// How a run goes on with other elements: from time 0, or from where the others gave way.
pub(super) const BEGUN: &str = "the run was repeated with";
pub(super) const WENT_ON: &str = "from there the run went on with";

/// A scene with other elements or passes than the default ones, and what is told of the change.
#[derive(Debug, Clone)]
pub(super) struct Safe {
    pub loaded: LoadedScene,
    pub changed: Vec<String>,
    /// What is told of it where it leaves no doubt about the answer.
    pub notes: Vec<String>,
    /// The run before, as long as elements that took the place of others are compared with them.
    pub former: Option<Former>,
    /// Bodies whose elements stay as they are, whatever they do.
    pub kept: Vec<String>,
    /// Of the runs before that stopped, the one that came farthest.
    pub farthest: Option<Farthest>,
    /// Contacts of the scene that it has no more, since another one stands for them as well.
    pub joined: Vec<String>,
}

impl Safe {
    /// The one before, or the scene as it is.
    pub fn of(scene: &LoadedScene, before: Option<&Safe>) -> Self {
        before.cloned().unwrap_or_else(|| Safe {
            loaded: scene.clone(),
            changed: Vec::new(),
            notes: Vec::new(),
            former: None,
            kept: Vec::new(),
            farthest: None,
            joined: Vec::new(),
        })
    }
}

/// The scene with bricks of one change of volume each for the bodies whose default elements a run could not go on with: enhanced
/// strains lose their hold in strong compression, and steps accepted before may have suffered. Nothing where the scene
/// names the elements.
pub(super) fn safe_variant<'n>(
    scene: &LoadedScene,
    before: Option<&Safe>,
    squeezed: impl Iterator<Item = &'n str>,
    (time, history, accepted): (f64, &Table, bool),
) -> Option<Safe> {
    let when = format!("gave way at time {}", number(time));
    let mut safe = None;
    let mut bodies = Vec::new();
    for body in squeezed {
        let before = safe.as_ref().or(before);
        if let Some(found) = replaced(scene, before, body, &when) {
            safe = Some(found);
            bodies.push(body.to_owned());
        }
    }
    if let Some(safe) = &mut safe {
        safe.former = Some(Former::new(bodies, history, accepted));
    }
    safe
}

/// The scene with such bricks for a body, where it leaves the element to its default.
fn replaced(scene: &LoadedScene, before: Option<&Safe>, body: &str, when: &str) -> Option<Safe> {
    if names_element(scene, body) {
        return None;
    }
    let mut safe = Safe::of(scene, before);
    let element = &mut safe.loaded.scene.bodies.get_mut(body)?.element;
    if *element != Element::H8 {
        return None;
    }
    *element = Element::H8MeanDilatation;
    safe.changed.push(format!(
        "body `{body}`: its default elements (`h8`) {when}, as they do under large strains; {BEGUN} \
         `h8_mean_dilatation` for it, which bends less well: refine it where it bends, and name the `element` to have one of them \
         from the start"
    ));
    Some(safe)
}

/// The scene with the edges of masters as slaves, in every contact with another body that leaves its passes to the default and whose
/// friction has no direction of the master.
pub(super) fn with_edges(
    scene: &LoadedScene,
    before: Option<&Safe>,
    time: Option<f64>,
) -> Option<Safe> {
    let change = |contact: &mut Contact| {
        let default = contact.passes == Passes::Auto && !is_directed(contact);
        contact.passes = Passes::Edges;
        default
    };
    let text = "while a sharp edge of the master lay on the slave, between its points; it was repeated with such edges as slaves \
                too (`\"passes\": \"edges\"`; `\"one\"` leaves them out, and the side with the edge as slave needs none)";
    with_contacts(scene, before, time, ("passes", change, text))
}

/// Whether friction has a direction of the master, so that the sides of a contact are not alike.
pub(super) fn is_directed(contact: &Contact) -> bool {
    matches!(contact.friction, Some(Friction::Orthotropic { .. }))
}

/// Whether the edges of the master of a contact may become slaves by themselves: those of another body, or of a rigid surface whose
/// motion is prescribed, in a contact that leaves its passes to the default.
pub(super) fn edges_may(scene: &LoadedScene, contact: &Contact) -> bool {
    let surfaces = &scene.scene.surfaces;
    let prescribed = match contact.surface(surfaces) {
        Some(surface) => surface.motion.free.is_none(),
        None => !contact.is_own(surfaces),
    };
    let solution = &scene.scene.solution;
    contact.passes == Passes::Auto
        && !is_directed(contact)
        // Pieces of faces end at the edges of the master.
        && !matches!(contact.points, Points::Segments(_))
        && prescribed
        && solution.kinematics != Kinematics::Small
        && solution.dynamics.is_none()
}

/// Whether the slave of a contact may have more points by itself: its nodes, in a contact with a rigid surface or another body that
/// leaves them to the default and whose tractions are those of penalties at its points.
pub(super) fn points_may(scene: &LoadedScene, contact: &Contact) -> bool {
    contact.points == Points::Auto
        && contact.augmentation.is_none()
        && !contact.is_own(&scene.scene.surfaces)
}

/// The scene with Gauss points as the slave points of some contacts.
pub(super) fn with_points(
    scene: &LoadedScene,
    before: Option<&Safe>,
    time: Option<f64>,
    contacts: &[&str],
) -> Option<Safe> {
    let mut safe = Safe::of(scene, before);
    let mut found: [Vec<String>; 2] = Default::default();
    for name in contacts {
        let Scene {
            contacts, bodies, ..
        } = &mut safe.loaded.scene;
        let contact = contacts.get_mut(*name)?;
        if contact.points == Points::Auto {
            let body = bodies.get(contact.slave.body());
            let sheet = body.is_some_and(|body| matches!(body.mesh, MeshSource::Nurbs(_)));
            contact.points = Points::Gauss(if sheet { SEEING_SHEETS } else { SEEING });
            found[usize::from(sheet)].push(format!("`{name}`"));
        }
    }
    let words = [("nodes", SEEING), ("points", SEEING_SHEETS)];
    for (found, (seen, n)) in found
        .iter()
        .zip(words)
        .filter(|(found, _)| !found.is_empty())
    {
        let text = format!(
            "while the surface had sunk into the slave between its {seen}, pushed them aside, or left them hanging over its border; it was \
             repeated with {n} x {n} Gauss points a face as slave points (`\"points\": \"nodes\"` keeps them; where few of them carry, pressures at \
             single points scatter about those of the surface)"
        );
        safe.notes.push(stopped(found, time, &text));
    }
    found.iter().any(|found| !found.is_empty()).then_some(safe)
}

/// The scene with the rims of rigid surfaces as slaves, in every contact that may have them.
pub(super) fn with_rims(
    scene: &LoadedScene,
    before: Option<&Safe>,
    time: Option<f64>,
) -> Option<Safe> {
    let text = "while an edge or a tip of the surface had sunk into the slave, between its points; it was repeated with such edges as \
                slaves too (`\"passes\": \"edges\"`; `\"one\"` leaves them out)";
    let may = |contact: &Contact| edges_may(scene, contact);
    with_these(scene, before, time, (may, Passes::Edges, text))
}

/// The scene without edges of masters and Gauss points as slaves, where a run with them stopped as well.
pub(super) fn seeing_less(
    scene: &LoadedScene,
    before: Option<&Safe>,
    time: Option<f64>,
) -> Option<Safe> {
    let edges = "with edges of the surface as slaves, too; it was repeated without them, in smaller steps than they were given \
                 before (`\"passes\": \"one\"` has that from the start): what the edges carry is wrong by what they sink in";
    let points = "with Gauss points as slave points, too; it was repeated with the nodes, in smaller steps than they were given before \
                  (`\"points\": \"nodes\"` has that from the start)";
    let mut safe = Safe::of(scene, before);
    let [mut of_edges, mut of_points] = [Vec::new(), Vec::new()];
    for (name, contact) in &scene.scene.contacts {
        let Some(now) = safe.loaded.scene.contacts.get_mut(name) else {
            continue;
        };
        if edges_may(scene, contact) {
            if now.passes == Passes::Edges {
                of_edges.push(format!("`{name}`"));
            }
            now.passes = Passes::One;
        }
        if points_may(scene, contact) {
            let rigid = contact.surface(&scene.scene.surfaces).is_some();
            if now.points != Points::Auto {
                of_points.push(format!("`{name}`"));
            }
            if rigid || now.points != Points::Auto {
                now.points = Points::Nodes;
            }
        }
    }
    if of_edges.is_empty() && of_points.is_empty() && before.is_some() {
        return None;
    }
    safe.notes.retain(|text| !text.contains(STOPPED));
    for (found, text) in [(of_edges, edges), (of_points, points)] {
        if !found.is_empty() {
            safe.changed.push(stopped(&found, time, text));
        }
    }
    Some(safe)
}

/// The scene with other passes of some contacts.
fn with_these(
    scene: &LoadedScene,
    before: Option<&Safe>,
    time: Option<f64>,
    (may, passes, text): (impl Fn(&Contact) -> bool, Passes, &str),
) -> Option<Safe> {
    let mut safe = Safe::of(scene, before);
    let mut found = Vec::new();
    for (name, contact) in &scene.scene.contacts {
        let now = safe.loaded.scene.contacts.get_mut(name);
        if let Some(now) = now.filter(|_| may(contact)) {
            now.passes = passes;
            found.push(format!("`{name}`"));
        }
    }
    if found.is_empty() {
        return None;
    }
    // Of what the edges carry there is no doubt any more.
    safe.notes.push(stopped(&found, time, text));
    Some(safe)
}

/// The scene with smooth masters, in every contact with another body that leaves the surface of its master to the default: a
/// slave point that slides over flat faces meets edges, at which the force on it turns at once.
pub(super) fn with_smooth(
    scene: &LoadedScene,
    before: Option<&Safe>,
    time: Option<f64>,
) -> Option<Safe> {
    let change = |contact: &mut Contact| {
        let default = contact.master_surface.is_none();
        let cut = matches!(contact.points, Points::Segments(_));
        contact.master_surface = Some(MasterSurface::Smooth);
        default && !cut
    };
    let text = "; it was repeated with one smooth surface through the nodes of the master's faces \
                (`\"master_surface\": \"smooth\"`; `\"faces\"` leaves them flat)";
    with_contacts(scene, before, time, ("master_surface", change, text))
}

/// The scene with the sides exchanged of every contact whose master is softer than its slave, unless it names its passes or its
/// friction has a direction of the master: a soft
/// master bulges out between the points of a stiff slave, which snap from bulge to bulge where they slide. Of a `block` all faces
/// are the master: what is pressed in beside its edge comes up in front of the faces round it.
pub(super) fn with_exchanged(
    scene: &LoadedScene,
    before: Option<&Safe>,
    time: Option<f64>,
    block: &dyn Fn(&str) -> bool,
) -> Option<Safe> {
    let young = |side: &SetNames| {
        let body = scene.scene.bodies.get(side.body())?;
        let material = scene.scene.materials.get(&body.material)?;
        Some(material.law(&scene.scene.units)?.elastic().e)
    };
    let change = |contact: &mut Contact| {
        let stiffer = young(&contact.slave).zip(young(&contact.master));
        std::mem::swap(&mut contact.slave, &mut contact.master);
        let bodies = [&contact.slave, &contact.master].map(SetNames::body);
        if block(bodies[1]) && contacts_of(scene, bodies) == 1 {
            contact.master = SetNames::One(bodies[1].to_owned());
        }
        contact.passes == Passes::Auto
            && !is_directed(contact)
            && stiffer.is_some_and(|(slave, master)| slave > master)
    };
    let text = "in steps cut again and again, its master softer than its slave; it was repeated with the softer side as the slave, \
                of which now is what is told of a slave, and all faces of the other one as its master, where that is a block \
                (`\"passes\": \"one\"` keeps the sides as they are)";
    with_contacts(scene, before, time, ("passes", change, text))
}

/// The scene with all faces of a `block` as the master, in every contact whose master is only a part of them, unless it names its
/// passes: what is pressed in beside an edge comes up in front of the faces round it.
pub(super) fn with_sides(
    scene: &LoadedScene,
    before: Option<&Safe>,
    time: Option<f64>,
    block: &dyn Fn(&str) -> bool,
) -> Option<Safe> {
    let change = |contact: &mut Contact| {
        let bodies = [&contact.slave, &contact.master].map(SetNames::body);
        let whole = SetNames::One(bodies[1].to_owned());
        let part = contact.master != whole && block(bodies[1]);
        let alone = contacts_of(scene, bodies) == 1;
        contact.master = whole;
        part && alone
    };
    let text = "while a sharp edge of the master lay on the slave; it was repeated with all faces of that body as the master, since the \
                slave comes up in front of those beside the edge (`\"passes\": \"one\"` keeps the faces as they are)";
    with_contacts(scene, before, time, ("passes", change, text))
}

/// How many contacts there are between two bodies.
fn contacts_of(scene: &LoadedScene, [one, other]: [&str; 2]) -> usize {
    let contacts = scene.scene.contacts.values();
    let bodies = contacts.map(|c| [c.slave.body(), c.master.body()]);
    bodies
        .filter(|both| both.contains(&one) && both.contains(&other))
        .count()
}

/// The scene with a change to every contact with another body that does not name a key; `change` tells whether it applies.
fn with_contacts(
    scene: &LoadedScene,
    before: Option<&Safe>,
    time: Option<f64>,
    (key, change, text): (&str, impl Fn(&mut Contact) -> bool, &str),
) -> Option<Safe> {
    let mut safe = Safe::of(scene, before);
    let mut found = Vec::new();
    let surfaces = &scene.scene.surfaces;
    for (name, contact) in &mut safe.loaded.scene.contacts {
        let (own, rigid) = (
            contact.is_own(surfaces),
            contact.surface(surfaces).is_some(),
        );
        let named = scene.has(&pointer(&["contacts", name, key]));
        let mut other = contact.clone();
        if !own && !rigid && !named && change(&mut other) {
            *contact = other;
            found.push(format!("`{name}`"));
        }
    }
    if found.is_empty() {
        return None;
    }
    safe.changed.push(stopped(&found, time, text));
    Some(safe)
}

const STOPPED: &str = "the run stopped";

/// What is told of contacts with which a run stopped.
pub(super) fn stopped(contacts: &[String], time: Option<f64>, text: &str) -> String {
    let space = if text.starts_with(';') { "" } else { " " };
    format!(
        "contact {}: {STOPPED}{}{space}{text}",
        contacts.join(", "),
        time.map_or(String::new(), |t| format!(" at time {}", number(t)))
    )
}

/// Whether a scene names the element of a body, rather than leaving it to its default.
pub(super) fn names_element(scene: &LoadedScene, body: &str) -> bool {
    scene.has(&pointer(&["bodies", body, "element"]))
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    /// Under a direction of the master its sides are not alike: neither are they exchanged, nor does its edge slide over the slave.
    #[test]
    fn a_direction_of_the_master_keeps_the_sides_as_they_are() {
        let changed = |friction: serde_json::Value| {
            let block = |low: f64| json!({"block": {"min": [0, 0, low], "max": [1, 1, low + 1.0], "elements": [1, 1, 1]}});
            let scene = json!({
                "covact": 1,
                "materials": {
                    "soft": {"neo_hooke": {"E": 1, "nu": 0.3}}, "stiff": {"neo_hooke": {"E": 9, "nu": 0.3}}
                },
                "bodies": {
                    "lower": {"mesh": block(-1.0), "material": "soft"},
                    "upper": {"mesh": block(0.0), "material": "stiff"}
                },
                "contacts": {"c": {"slave": "upper.bottom", "master": "lower.top", "friction": friction}},
                "supports": {"ground": {"on": "lower.bottom", "fixed": true}}
            });
            let loaded = crate::scene::parse(&scene.to_string(), "scene.json").expect("a scene");
            let exchanged = with_exchanged(&loaded, None, Some(0.5), &|body| body == "upper");
            if let Some(safe) = &exchanged {
                // The bottom of the stiff block alone would end at its edges.
                let contact = &safe.loaded.scene.contacts["c"];
                let sides = [&contact.slave, &contact.master].map(ToString::to_string);
                assert_eq!(sides, ["lower.top", "upper"]);
            }
            let whole = |body: &str| with_sides(&loaded, None, None, &|block| block == body);
            assert!(whole("upper").is_none());
            let master = &whole("lower").unwrap().loaded.scene.contacts["c"].master;
            assert_eq!(master.to_string(), "lower");
            [exchanged, with_edges(&loaded, None, Some(0.5))].map(|safe| safe.is_some())
        };
        assert_eq!(changed(json!({"coulomb": {"mu": 0.3}})), [true; 2]);
        let two = json!({"orthotropic": {"mu": [0.1, 0.3], "direction": [1, 0, 0]}});
        assert_eq!(changed(two), [false; 2]);
    }
}
