//! Effects that a random scene has beside its tool, body, friction and motion.
use super::draw::{BodyKind, Held, RandomScene};
use super::write::Frame;
use covact_geometry::{NurbsPatch, Vec3};
use fastrand::Rng;
use serde_json::{Value, json};

/// How contacts end in a last stage.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Release {
    /// Their forces are let down.
    Forces,
    /// The tools go back.
    Tools,
}

/// A metal that flows.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Metal {
    /// Yield stress over Young's modulus.
    pub yields: f64,
    /// Slope of the yield stress over Young's modulus.
    pub slope: f64,
    /// r-values of a rolled sheet; none: flow after von Mises.
    pub rolled: Option<[f64; 3]>,
    /// How the contacts end.
    pub release: Option<Release>,
}

/// What a body is made of, or moves by, beside elements of elastic material in equilibrium.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub enum Matter {
    /// Nothing else.
    #[default]
    Elastic,
    /// The body flows.
    Metal(Metal),
    /// A sheet is a NURBS face that bends.
    Face,
    /// Bodies have inertia.
    Inertia {
        /// Speed of waves along a bar (length / time).
        speed: f64,
        /// Damping by mass (1 / time).
        damping: f64,
    },
}

/// Effects of a scene; none by default.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Effects {
    /// Points, penalties, steps and the element `h8` are left to the program.
    pub defaults: bool,
    /// Material, kind of body, or inertia.
    pub matter: Matter,
    /// Pressure on the far side of a sheet, over Young's modulus.
    pub pressure: Option<f64>,
    /// Friction between both bodies; none: as under the tool.
    pub between: Option<f64>,
    /// The block is the slave of the sheet that lies on it.
    pub swapped: bool,
}

fn between(rng: &mut Rng, low: f64, high: f64) -> f64 {
    low + (high - low) * rng.f64()
}

fn decades(rng: &mut Rng, low: f64, high: f64) -> f64 {
    10f64.powf(between(rng, low, high))
}

/// The effects of the scene that a seed means: the same on every machine.
pub fn draw_effects(scene: &RandomScene) -> Effects {
    let mut rng = Rng::with_seed(scene.seed.wrapping_mul(0xd134_2543_de82_ef95) ^ 0x2545_f491);
    let rng = &mut rng;
    let plate = matches!(
        scene.body,
        BodyKind::Sheet { .. } | BodyKind::SheetOnBlock { .. }
    );
    let two = matches!(scene.body, BodyKind::SheetOnBlock { .. });
    let driven = scene.motion.force.is_none();
    let metal = Metal {
        yields: decades(rng, -3.3, -2.0),
        slope: decades(rng, -3.0, -1.3),
        rolled: (rng.f64() < 0.2).then(|| [0; 3].map(|_| between(rng, 0.8, 2.5))),
        release: match rng.u32(0..5) {
            // A body that a sheet lies on has no way back.
            0 if !two => Some(Release::Tools),
            0..3 => Some(Release::Forces),
            _ => None,
        }
        .filter(|_| driven && scene.motion.turn == 0.0),
    };
    let matter = match rng.u32(0..100) {
        0..30 if scene.nu < 0.49 => Matter::Metal(metal),
        30..50 if plate => Matter::Face,
        50..62 if driven => Matter::Inertia {
            speed: decades(rng, 1.5, 2.5),
            damping: [0.0, between(rng, 0.5, 10.0)][rng.usize(0..2)],
        },
        _ => Matter::Elastic,
    };
    let inert = matches!(matter, Matter::Inertia { .. });
    Effects {
        defaults: rng.f64() < 0.7,
        matter,
        pressure: (rng.f64() < 0.2)
            .then(|| decades(rng, -6.0, -4.3))
            .filter(|_| plate && !inert),
        between: (rng.f64() < 0.4)
            .then(|| between(rng, 0.0, 0.6))
            .filter(|_| two),
        swapped: rng.f64() < 0.15 && two,
    }
}

impl Effects {
    /// When contacts begin to end; none: they do not.
    pub fn released_from(&self, scene: &RandomScene) -> Option<f64> {
        let end = scene.motion.path.last().map_or(1.0, |p| p.0);
        match self.matter {
            Matter::Metal(metal) => metal.release.map(|_| end),
            _ => None,
        }
    }

    /// Whether all forces on the bodies are in the history, so that they cancel at every step.
    pub fn balances(&self) -> bool {
        self.pressure.is_none() && !matches!(self.matter, Matter::Inertia { .. })
    }

    /// The face that a sheet is, for `sheet.json`; none: it is meshed.
    pub fn face(&self, scene: &RandomScene) -> Option<NurbsPatch> {
        let (BodyKind::Sheet { size, thickness }
        | BodyKind::SheetOnBlock {
            size, thickness, ..
        }) = scene.body
        else {
            return None;
        };
        let [x, y] = size.map(|s| 0.5 * s);
        let corners = [[-x, -y], [x, -y], [-x, y], [x, y]];
        let corners = corners.map(|[x, y]| Vec3::new(x, y, -0.5 * thickness));
        let knots = || vec![0.0, 0.0, 1.0, 1.0];
        let face = NurbsPatch::new([1, 1], [knots(), knots()], [2, 2], &corners, None);
        // The net above is valid for every seed.
        let face = face.unwrap_or_else(|e| unreachable!("a flat face: {e}"));
        (self.matter == Matter::Face).then_some(face)
    }

    /// Takes the effects into the scene as it is written without them.
    pub(super) fn apply(&self, of: &RandomScene, frame: &Frame, scene: &mut Value) {
        let inert = matches!(self.matter, Matter::Inertia { .. });
        if self.defaults {
            without(
                &mut scene["contacts"],
                &["points", "penalty", "augmentation"],
            );
        }
        if inert {
            without(&mut scene["contacts"], &["augmentation"]);
        }
        if self.defaults || inert {
            let solution = scene["solution"].as_object_mut();
            solution.and_then(|solution| solution.remove("step"));
        }
        match self.matter {
            Matter::Elastic => {}
            Matter::Metal(metal) => flow(&metal, (of, frame), scene),
            Matter::Face => bend(of, scene),
            Matter::Inertia { speed, damping } => {
                for law in values(&mut scene["materials"]).flat_map(values) {
                    law["density"] = json!(of.e / (speed * speed));
                }
                scene["solution"]["dynamics"] = match damping > 0.0 {
                    true => json!({ "damping": { "mass": damping } }),
                    false => json!({}),
                };
            }
        }
        let body = &mut scene["bodies"]["body"];
        if self.defaults && body["element"] == "h8" {
            // The default, which the program may exchange where it is not named.
            let body = body.as_object_mut();
            body.and_then(|body| body.remove("element"));
        }
        if let Some(pressure) = self.pressure {
            let table = json!([[0, 0], [0.3, pressure * of.e]]);
            scene["loads"] =
                json!({ "push": { "on": "body.bottom", "pressure": { "table": table } } });
        }
        if let Some(lie) = scene["contacts"].get_mut("lie") {
            if let Some(mu) = self.between {
                lie["friction"] = json!({ "coulomb": { "mu": mu } });
            }
            if self.swapped {
                (lie["slave"], lie["master"]) = (json!("base.top"), json!("body.bottom"));
            }
        }
    }

    /// What they are, in words.
    pub(super) fn story(&self) -> String {
        let mut words = Vec::new();
        match self.matter {
            Matter::Elastic => {}
            Matter::Metal(metal) => {
                words.push(match metal.rolled {
                    Some(_) => "rolled metal",
                    None => "metal",
                });
                words.extend(metal.release.map(|release| match release {
                    Release::Forces => "released by forces",
                    Release::Tools => "released by tools",
                }));
            }
            Matter::Face => words.push("a NURBS face that bends"),
            Matter::Inertia { .. } => words.push("inertia"),
        }
        words.extend(self.pressure.map(|_| "pressure"));
        words.extend(self.between.map(|_| "other friction between both"));
        words.extend(self.swapped.then_some("block as slave"));
        words.extend(self.defaults.then_some("defaults"));
        words.iter().map(|word| format!(", {word}")).collect()
    }
}

/// The values of an object; none of anything else.
fn values(of: &mut Value) -> impl Iterator<Item = &mut Value> {
    let object = of.as_object_mut().into_iter();
    object.flat_map(|object| object.values_mut())
}

/// Takes keys out of every object of an object.
fn without(objects: &mut Value, keys: &[&str]) {
    for object in values(objects).filter_map(Value::as_object_mut) {
        keys.iter().for_each(|key| {
            object.remove(*key);
        });
    }
}

/// Makes the body of metal, and lets it go at the end.
fn flow(metal: &Metal, (of, frame): (&RandomScene, &Frame), scene: &mut Value) {
    let hardening =
        json!({ "linear": { "yield_stress": metal.yields * of.e, "slope": metal.slope * of.e } });
    let mut law = json!({ "E": of.e, "nu": of.nu, "hardening": hardening });
    let name = match metal.rolled {
        Some(r) => {
            law["r"] = json!(r);
            law["rolling"] = json!(frame.vector([1.0, 0.0, 0.0]));
            "hill48"
        }
        None => "j2",
    };
    scene["materials"]["metal"] = json!({ name: law });
    let body = &mut scene["bodies"]["body"];
    body["material"] = json!("metal");
    if body["element"] == "q18" {
        // Two linear elements in the place of a quadratic one.
        body["element"] = json!("h8");
        for mesh in values(&mut body["mesh"]) {
            mesh["elements"] = json!(of.elements.map(|n| 2 * n));
        }
    }
    if let Some(release) = metal.release {
        let end = of.motion.path.last().map_or(1.0, |p| p.0);
        let how = match release {
            Release::Forces => "forces",
            Release::Tools => "tools",
        };
        scene["stages"] =
            json!([{ "name": "form", "until": end }, { "name": "release", "release": how }]);
        scene["solution"]["end_time"] = json!(1.5 * end);
    }
}

/// Makes the sheet of a NURBS face with as many elements.
fn bend(of: &RandomScene, scene: &mut Value) {
    let (BodyKind::Sheet { thickness, .. } | BodyKind::SheetOnBlock { thickness, .. }) = of.body
    else {
        return;
    };
    let body = &mut scene["bodies"]["body"];
    *body = json!({
        "nurbs": { "file": "sheet.json", "thickness": thickness, "elements": of.elements.map(|n| n.max(4)) },
        "material": "stuff",
        "placement": body["placement"]
    });
    let edges: &[usize] = match (of.held, of.mirrored) {
        (Held::AllRound, _) => &[1, 2, 3, 4],
        (Held::TwoEdges, _) => &[1, 2],
        (Held::OneEdge, false) => &[1],
        (Held::OneEdge, true) => &[2],
    };
    let edges: Vec<String> = edges.iter().map(|k| format!("body.edge.{k}")).collect();
    let mut supports = json!({ "edges": { "on": edges, "clamped": true } });
    if let Some(floor) = scene["supports"].get("floor") {
        supports["floor"] = floor.clone();
    }
    scene["supports"] = supports;
    // Its nodes are no slave points.
    for contact in values(&mut scene["contacts"]).filter_map(Value::as_object_mut) {
        if contact.get("points").is_some_and(Value::is_string) {
            contact.remove("points");
        }
    }
}
