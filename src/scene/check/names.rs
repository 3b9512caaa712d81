//! Names, and what refers to them.
use super::checker::{Checker, path};
use crate::scene::problem::{MOST_IN_NAME, listed, nearest, shorten, suggestion};
use crate::scene::types::*;
use std::collections::BTreeMap;

/// Names can be used in `body.set`, in columns of the history and in file names. Whether they are short enough for the
/// other checks, which repeat them for everything that they belong to.
pub(super) fn check(c: &mut Checker, scene: &Scene) -> bool {
    let sections: [(&str, Vec<&String>); 7] = [
        ("materials", scene.materials.keys().collect()),
        ("bodies", scene.bodies.keys().collect()),
        ("surfaces", scene.surfaces.keys().collect()),
        ("contacts", scene.contacts.keys().collect()),
        ("supports", scene.supports.keys().collect()),
        ("loads", scene.loads.keys().collect()),
        ("probes", scene.probes.keys().collect()),
    ];
    for (section, names) in &sections {
        for name in names {
            let dotless = matches!(*section, "bodies" | "probes");
            check_name(c, &path(&[section, name]), name, dotless);
        }
    }
    let long = |name: &String| name.len() > MOST_IN_NAME;
    if sections.iter().any(|s| s.1.iter().any(|name| long(name))) {
        return false;
    }
    for (name, body) in &scene.bodies {
        let (generated, what) = generated_sets(&body.mesh);
        for set in body.sets.keys() {
            let at = path(&["bodies", name, "sets", set]);
            check_name(c, &at, set, false);
            if generated.contains(&set.as_str()) {
                c.add(
                    &at,
                    format!("the {what} has a set `{set}` of its own"),
                    Some("choose another name".into()),
                );
            }
        }
    }
    // The history has columns such as `force.<name>.x` for each of these.
    let mut first: BTreeMap<&String, &str> = BTreeMap::new();
    for (section, names) in &sections {
        if !matches!(*section, "surfaces" | "supports" | "loads") {
            continue;
        }
        for &name in names {
            match first.get(name) {
                Some(other) => {
                    let message = format!("the name `{name}` is also used in `{other}`");
                    let help = "surfaces, supports and loads share the columns of the history; choose another name";
                    c.add(&path(&[section, name]), message, Some(help.into()));
                }
                None => {
                    first.insert(name, section);
                }
            }
        }
    }
    !scene.bodies.values().any(|b| b.sets.keys().any(long))
}

fn check_name(c: &mut Checker, at: &str, name: &str, dotless: bool) {
    if name.trim().is_empty() {
        return c.add(at, "a name is empty", None);
    }
    if name.len() > MOST_IN_NAME {
        let message = format!(
            "the name `{}` is longer than {MOST_IN_NAME} bytes",
            shorten(name)
        );
        let help = "names become columns of the history and parts of file names";
        return c.add(at, message, Some(help.into()));
    }
    let bad = |ch: char| ch.is_control() || matches!(ch, ',' | '"' | ';') || (dotless && ch == '.');
    if let Some(ch) = name.chars().find(|ch| bad(*ch)) {
        let help = match ch {
            '.' => "the dot separates names, as in `sheet.top` or in columns of the history",
            _ => "names become columns of the history",
        };
        c.add(
            at,
            format!("the name `{name}` holds the character {ch:?}"),
            Some(help.into()),
        );
    }
}

/// Sets of nodes of a CAD surface that bends.
const SHEET_SETS: [&str; 8] = [
    "edge.1", "edge.2", "edge.3", "edge.4", "corner.1", "corner.2", "corner.3", "corner.4",
];

/// Sets that a generator makes, and its name; none for files.
fn generated_sets(mesh: &MeshSource) -> (Vec<&'static str>, &'static str) {
    let turn = |range: [f64; 2]| (range[1] - range[0] - 360.0).abs() < 1e-9;
    let (mut sets, closed, what) = match mesh {
        MeshSource::Plate(_) => (
            vec!["bottom", "top", "x_min", "x_max", "y_min", "y_max"],
            false,
            "plate",
        ),
        MeshSource::CylinderPanel(p) => {
            let sets = vec!["inner", "outer", "phi_min", "phi_max", "y_min", "y_max"];
            (sets, turn(p.angles), "cylinder panel")
        }
        MeshSource::SpherePanel(p) => {
            let sets = vec![
                "inner",
                "outer",
                "latitude_min",
                "latitude_max",
                "longitude_min",
                "longitude_max",
            ];
            (sets, turn(p.longitude), "sphere panel")
        }
        MeshSource::Block(_) => {
            let sets = vec![
                "bottom", "top", "x_min", "x_max", "y_min", "y_max", "z_min", "z_max",
            ];
            (sets, false, "block")
        }
        MeshSource::File(_) => (Vec::new(), false, "file"),
        MeshSource::Arrays(_) | MeshSource::Cells(_) => (Vec::new(), false, "mesh"),
        MeshSource::Nurbs(_) => {
            let mut sets = vec!["bottom", "top"];
            sets.extend(SHEET_SETS);
            (sets, false, "CAD surface")
        }
    };
    if closed {
        sets.retain(|s| !s.starts_with("phi") && !s.starts_with("longitude"));
    }
    (sets, what)
}

/// The sets of all bodies, as far as they are known without reading a file.
pub(super) struct Sets<'a> {
    bodies: BTreeMap<&'a str, BodySets<'a>>,
}

struct BodySets<'a> {
    /// Name, and whether it has faces.
    sets: BTreeMap<&'a str, bool>,
    /// A mesh file may hold more.
    open: bool,
    /// It is a CAD surface that bends.
    sheet: bool,
}

impl<'a> Sets<'a> {
    pub fn new(scene: &'a Scene) -> Self {
        let bodies = scene.bodies.iter().map(|(name, body)| {
            let mut sets: BTreeMap<&str, bool> = generated_sets(&body.mesh)
                .0
                .into_iter()
                .map(|s| (s, !SHEET_SETS.contains(&s)))
                .collect();
            for (set, selection) in &body.sets {
                let faces = matches!(
                    selection,
                    Selection::FacesInBox(_) | Selection::FacesFacing { .. }
                );
                // A name that is taken is reported elsewhere.
                sets.entry(set).or_insert(faces);
            }
            if let MeshSource::Arrays(mesh) = &body.mesh {
                let own = (mesh.face_sets.keys().map(|set| (set, true)))
                    .chain(mesh.node_sets.keys().map(|set| (set, false)));
                for (set, faces) in own {
                    *sets.entry(set).or_insert(faces) |= faces;
                }
            }
            let open = match &body.mesh {
                MeshSource::File(_) | MeshSource::Cells(_) => true,
                // Of several faces each has sets of its own.
                MeshSource::Nurbs(nurbs) => nurbs.faces.len() != 1,
                _ => false,
            };
            let sheet = matches!(body.mesh, MeshSource::Nurbs(_));
            (name.as_str(), BodySets { sets, open, sheet })
        });
        Sets {
            bodies: bodies.collect(),
        }
    }

    /// Whether `reference` is `body.set` of a known body and a set that it has, as far as sets are known.
    pub fn knows(&self, reference: &str) -> bool {
        let Some((body, set)) = reference.split_once('.') else {
            return false;
        };
        (self.bodies.get(body)).is_some_and(|b| b.open || b.sets.contains_key(set))
    }

    /// `reference` should have been the name of a body.
    pub fn not_a_body(&self, c: &mut Checker, at: &str, reference: &str) {
        let name = reference.split('.').next().unwrap_or_default();
        let (message, help) = match self.bodies.contains_key(name) {
            true => (
                format!(
                    "gravity acts on whole bodies, and `{}` is a set",
                    shorten(reference)
                ),
                format!("write `{}`", shorten(name)),
            ),
            false => (
                format!("there is no body `{}`", shorten(reference)),
                suggestion(reference, "bodies", self.bodies.keys().copied()),
            ),
        };
        c.add(at, message, Some(help));
    }

    /// `reference` is `body.set` of a body and, where that is known, of one of its sets, or a body where no faces are needed; `user`
    /// is who needs it.
    pub fn check(&self, c: &mut Checker, at: &str, reference: &str, faces: bool, user: &str) {
        if c.full() {
            return;
        }
        let Some((body, set)) = reference.split_once('.') else {
            if !faces && self.bodies.contains_key(reference) {
                return;
            }
            return c.add(
                at,
                format!("`{}` does not name a set", shorten(reference)),
                Some(self.form(reference)),
            );
        };
        let Some(known) = self.bodies.get(body) else {
            let (body, set) = (shorten(body), shorten(set));
            let help = match nearest(&body, self.bodies.keys().copied()) {
                Some(near) => {
                    format!(
                        "did you mean `{}.{set}`? bodies: {}",
                        shorten(near),
                        self.list()
                    )
                }
                None => format!("bodies: {}", self.list()),
            };
            return c.add(at, format!("there is no body `{body}`"), Some(help));
        };
        match known.sets.get(set) {
            Some(has_faces) => {
                if faces && !has_faces {
                    let message = format!(
                        "`{}` is a set of nodes, but {user} needs faces",
                        shorten(reference)
                    );
                    let with: Vec<&str> = known
                        .sets
                        .iter()
                        .filter(|(_, f)| **f)
                        .map(|(s, _)| *s)
                        .collect();
                    c.add(
                        at,
                        message,
                        Some(format!(
                            "face sets of `{}`: {}",
                            shorten(body),
                            listed(with)
                        )),
                    );
                }
            }
            None if known.open => {}
            None => {
                let help = suggestion(
                    set,
                    &format!("sets of `{}`", shorten(body)),
                    known.sets.keys().copied(),
                );
                c.add(
                    at,
                    format!("the body `{}` has no set `{}`", shorten(body), shorten(set)),
                    Some(help),
                );
            }
        }
    }

    /// The faces of a side of a contact: sets of one body, or a whole body.
    pub fn check_side(&self, c: &mut Checker, at: &str, side: &SetNames, user: &str) {
        if side.iter().next().is_none() {
            let help = "write `body.set`";
            return c.add(at, "the list of sets is empty", Some(help.into()));
        }
        for (at, name) in side.places(at) {
            match self.bodies.get(name) {
                None => self.check(c, &at, name, true, user),
                Some(body) if body.sheet => {
                    let message = format!(
                        "`{}` is a body of kind `nurbs`, of which {user} needs one side",
                        shorten(name)
                    );
                    let help = listed(body.sets.keys().copied().filter(|s| body.sets[s]));
                    c.add(&at, message, Some(format!("name one: {help}")));
                }
                Some(_) => {}
            }
            let body = name.split_once('.').map_or(name, |(body, _)| body);
            if body != side.body() && self.bodies.contains_key(body) {
                let message = format!(
                    "`{}` and `{}` belong to two bodies",
                    shorten(side.iter().next().unwrap_or_default()),
                    shorten(name)
                );
                let help = "write a contact for each body: a list is for face sets of one body";
                c.add(&at, message, Some(help.into()));
            }
        }
        let several = side.iter().nth(1).is_some();
        if several && self.bodies.get(side.body()).is_some_and(|b| b.sheet) {
            let message = format!(
                "`{}` is a body of kind `nurbs`, of which {user} takes one set",
                shorten(side.body())
            );
            let help = "write a contact for each set";
            c.add(at, message, Some(help.into()));
        }
    }

    fn list(&self) -> String {
        listed(self.bodies.keys().copied())
    }

    fn form(&self, reference: &str) -> String {
        match self.bodies.get(reference) {
            Some(body) => {
                let set = body.sets.keys().next().copied().unwrap_or("set");
                format!(
                    "write body and set, as in `{}.{}`",
                    shorten(reference),
                    shorten(set)
                )
            }
            None => format!("write `body.set`; bodies: {}", self.list()),
        }
    }
}
