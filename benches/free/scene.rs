//! The scene that is counted: a plate of H8 elements wrapped around a ball that has moved and turned.
use covact::model::state::State;
use covact::model::{Model, build::build};
use covact::scene;
use covact_geometry::Vec3;
use serde_json::{Value, json};

pub const RADIUS: f64 = 25.0;
/// Elements along a side of the plate; four slave points (Gauss 2) on each.
const ELEMENTS: usize = 12;
/// Time of the evaluation: the ball has moved by -1 along z and turned by 20 degrees.
pub const TIME: f64 = 1.0;

/// What of the scene's contact or ball is other than in the frictionless penalty on the exact ball.
#[derive(Debug, Clone, Default)]
pub struct Effects {
    /// Added to the keys of the contact.
    pub contact: Value,
    /// Added to the keys of the ball.
    pub ball: Value,
}

/// The balls that kernel and program are compared on, with what they add to its keys.
pub fn masters() -> [(&'static str, Value); 2] {
    [
        ("NURBS", Value::Null),
        (
            "bilinear facets",
            json!({ "facets": { "kind": "bilinear", "count": [12, 12] } }),
        ),
    ]
}

/// How far the points are from the ball.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Distance {
    /// All below the surface, by .3.
    Closed,
    /// All above it, by .3: near, so that every one is searched for, and open.
    Open,
    /// Hills and valleys of a height of .3.
    Mixed,
}

impl Distance {
    pub const ALL: [Distance; 3] = [Distance::Closed, Distance::Open, Distance::Mixed];

    pub fn name(self) -> &'static str {
        match self {
            Distance::Closed => "closed",
            Distance::Open => "open",
            Distance::Mixed => "mixed",
        }
    }

    fn at(self, x: f64, y: f64) -> f64 {
        match self {
            Distance::Closed => -0.3,
            Distance::Open => 0.3,
            Distance::Mixed => 0.3 * (0.7 * x).sin() * (0.9 * y).sin(),
        }
    }
}

/// The model of the scene.
pub fn model(effects: &Effects, elements: usize) -> Model {
    let mut scene = json!({
        "covact": 1,
        "title": "Plate around a ball",
        "materials": { "plate": { "st_venant_kirchhoff": { "E": 12000, "nu": 0.3 } } },
        "bodies": { "plate": {
            "mesh": { "plate": { "size": [24, 24], "thickness": 2, "elements": [elements, elements] } },
            "material": "plate"
        } },
        "surfaces": { "ball": {
            "sphere": { "radius": RADIUS, "center": [0, 0, 30] },
            "motion": {
                "translation": [0, 0, "-t"],
                "rotation": { "center": [0, 0, 30], "axis": [1, 2, 3], "angle": "20*t" }
            }
        } },
        "contacts": { "press": {
            "slave": "plate.top",
            "master": "ball",
            "penalty": { "value": 60000 },
            "points": { "gauss": 2 }
        } },
        "supports": { "held": { "on": "plate.bottom", "fixed": true } },
        "solution": { "step": { "initial": 0.5 } }
    });
    merge(&mut scene["contacts"]["press"], &effects.contact);
    merge(&mut scene["surfaces"]["ball"], &effects.ball);
    let text = serde_json::to_string_pretty(&scene).expect("JSON");
    let loaded = scene::parse(&text, "free.json").expect("a scene");
    build(&loaded).unwrap_or_else(|e| panic!("{e} at {}", e.pointer))
}

/// The model of the size that is counted.
pub fn counted(effects: &Effects) -> Model {
    model(effects, ELEMENTS)
}

fn merge(into: &mut Value, from: &Value) {
    for (key, value) in from.as_object().into_iter().flatten() {
        into[key] = value.clone();
    }
}

/// The plate wrapped around the ball at [`TIME`], turned by up to 78 degrees, as far away as told; `ahead` moves every
/// point on by this part of its way around, so that a search does not start where it ends.
pub fn state(model: &Model, distance: Distance, ahead: f64) -> State {
    let mut state = State::new(model);
    let center = Vec3::new(0.0, 0.0, 29.0);
    let top = (model.nodes.iter()).fold(f64::NEG_INFINITY, |top, x| top.max(x.z));
    for (node, at) in model.nodes.iter().enumerate() {
        let (way, turn) = (at.x.hypot(at.y), at.y.atan2(at.x));
        let (s, c) = ((1.0 + ahead) * way / RADIUS).sin_cos();
        let direction = Vec3::new(s * turn.cos(), s * turn.sin(), -c);
        let height = RADIUS + distance.at(at.x, at.y) + (top - at.z);
        let u = center + direction * height - at;
        state.u[3 * node..3 * node + 3].copy_from_slice(u.as_slice());
    }
    state
}

/// Number of slave points of what is counted.
pub fn points() -> usize {
    4 * ELEMENTS * ELEMENTS
}
