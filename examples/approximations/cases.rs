//! What is run: shells, masters and meshes.
use serde_json::{Value, json};
use std::fmt;

/// Shell element.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Shell {
    H8,
    Q18,
}

/// What stands for the ball.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Master {
    Facets,
    Smooth,
    Nurbs,
}

/// One run.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Case {
    pub shell: Shell,
    pub master: Master,
    /// Intervals between nodes along an edge of the quarter plate: as many linear elements, or half as many quadratic.
    pub intervals: u32,
}

pub const SHELLS: [Shell; 2] = [Shell::H8, Shell::Q18];
pub const MASTERS: [Master; 3] = [Master::Facets, Master::Smooth, Master::Nurbs];
/// Coarse first, so that an interrupted command has something of every curve. Finer meshes are as good as the reference.
pub const INTERVALS: [u32; 3] = [8, 16, 32];

/// All runs.
pub fn cases() -> Vec<Case> {
    let mut out = Vec::new();
    for intervals in INTERVALS {
        for shell in SHELLS {
            for master in MASTERS {
                out.push(Case {
                    shell,
                    master,
                    intervals,
                });
            }
        }
    }
    out
}

impl Shell {
    pub fn name(self) -> &'static str {
        match self {
            Shell::H8 => "H8",
            Shell::Q18 => "Q18",
        }
    }
}

impl Master {
    pub fn name(self) -> &'static str {
        match self {
            Master::Facets => "facets",
            Master::Smooth => "smooth",
            Master::Nurbs => "NURBS",
        }
    }
}

impl fmt::Display for Case {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "{} on {}, {}",
            self.shell.name(),
            self.master.name(),
            self.intervals
        )
    }
}

impl Case {
    /// Its name in messages.
    pub fn name(&self) -> String {
        self.to_string()
    }

    /// The scene `ball_on_plate` as this case wants it.
    pub fn scene(&self) -> Value {
        let (element, count, points) = match self.shell {
            Shell::H8 => ("h8", self.intervals, 3),
            Shell::Q18 => ("q18", self.intervals / 2, 4),
        };
        let mut ball = json!({
            "sphere": { "radius": 25, "center": [0, 0, 26] },
            "motion": { "translation": [0, 0, "-10*t"] }
        });
        // The exact sphere is six patches here; a facet is about as long as nodes of the plate are apart.
        let facets =
            |kind: &str| json!({ "kind": kind, "count": [self.intervals, self.intervals] });
        match self.master {
            Master::Facets => ball["facets"] = facets("bilinear"),
            Master::Smooth => ball["facets"] = facets("smooth"),
            Master::Nurbs => {}
        }
        json!({
            "covact": 1,
            "materials": { "plate": { "st_venant_kirchhoff": { "E": 12000, "nu": 0.3 } } },
            "bodies": { "plate": {
                "mesh": { "plate": { "size": [50, 50], "thickness": 2, "elements": [count, count] } },
                "material": "plate",
                "element": element
            } },
            "surfaces": { "ball": ball },
            "contacts": { "press": {
                "slave": "plate.top", "master": "ball",
                "penalty": { "value": 60000 }, "points": { "gauss": points }
            } },
            "supports": {
                "clamped_x": { "on": "plate.x_max", "fixed": true },
                "clamped_y": { "on": "plate.y_max", "fixed": true },
                "symmetry_x": { "on": "plate.x_min", "symmetry": "x" },
                "symmetry_y": { "on": "plate.y_min", "symmetry": "y" }
            },
            "solution": { "step": { "initial": 0.125, "max": 0.125 }, "stops": [0.25, 0.5, 0.75] },
            "output": { "every": 0 }
        })
    }
}
