//! Small scenes, and changes to them.
use covact::model::{Model, build::build};
use covact::scene::{self, LoadedScene};
use serde_json::{Value, json};

/// A quarter of a clamped plate of 4 x 4 elements under a ball that pushes it down by 2.
pub fn plate() -> Value {
    json!({
        "covact": 1,
        "materials": {"steel": {"st_venant_kirchhoff": {"E": 12000, "nu": 0.3}}},
        "bodies": {"plate": {
            "mesh": {"plate": {"size": [40, 40], "thickness": 2, "elements": [4, 4]}},
            "material": "steel"
        }},
        "surfaces": {"ball": {
            "sphere": {"radius": 25, "center": [0, 0, 26]},
            "motion": {"translation": [0, 0, "-2*t"]}
        }},
        "contacts": {"press": {"slave": "plate.top", "master": "ball"}},
        "supports": {
            "clamp_x": {"on": "plate.x_max", "fixed": true},
            "clamp_y": {"on": "plate.y_max", "fixed": true},
            "symmetry_x": {"on": "plate.x_min", "symmetry": "x"},
            "symmetry_y": {"on": "plate.y_min", "symmetry": "y"}
        },
        "solution": {"step": {"initial": 0.5, "max": 0.5}, "threads": 1},
        "output": {"every": 0}
    })
}

/// A block of 3 x 3 elements pressed onto one of 2 x 2.
pub fn blocks() -> Value {
    json!({
        "covact": 1,
        "materials": {"m": {"st_venant_kirchhoff": {"E": 1e6, "nu": 0}}},
        "bodies": {
            "lower": {"mesh": {"block": {
                "min": [0, 0, -0.5], "max": [1, 1, 0], "elements": [2, 2, 1]
            }}, "material": "m"},
            "upper": {"mesh": {"block": {
                "min": [0, 0, 0], "max": [1, 1, 0.5], "elements": [3, 3, 1]
            }}, "material": "m"}
        },
        "contacts": {"press": {
            "slave": "upper.bottom", "master": "lower.top", "points": {"gauss": 2}
        }},
        "supports": {
            "ground": {"on": "lower.bottom", "displacement": {"z": 0}},
            "lower_x": {"on": "lower.x_min", "symmetry": "x"},
            "lower_y": {"on": "lower.y_min", "symmetry": "y"},
            "upper_x": {"on": "upper.x_min", "symmetry": "x"},
            "upper_y": {"on": "upper.y_min", "symmetry": "y"},
            "push": {"on": "upper.top", "displacement": {"z": "-0.01*t"}}
        },
        "solution": {"step": {"initial": 1, "max": 1}, "threads": 1},
        "output": {"every": 0}
    })
}

/// A scene with values at JSON pointers replaced or, in objects, added.
pub fn with(mut scene: Value, changes: &[(&str, Value)]) -> Value {
    for (pointer, value) in changes {
        let (parent, key) = pointer.rsplit_once('/').unwrap();
        let parent = scene.pointer_mut(parent).expect(pointer);
        parent[key] = value.clone();
    }
    scene
}

/// Coulomb's law.
pub fn coulomb() -> Value {
    json!({"coulomb": {"mu": 0.3}})
}

pub fn loaded(scene: &Value) -> LoadedScene {
    let text = serde_json::to_string_pretty(scene).unwrap();
    let loaded = scene::parse(&text, "scene.json").unwrap_or_else(|e| panic!("{e}"));
    let problems = scene::check(&loaded);
    assert!(problems.is_empty(), "{problems:?}");
    loaded
}

pub fn model(scene: &Value) -> Model {
    build(&loaded(scene)).unwrap_or_else(|e| panic!("{e} at {}", e.pointer))
}
