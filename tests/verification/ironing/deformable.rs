//! Shallow ironing: an elastic block with a round foot pressed into a softer foundation and drawn along it, in plane strain.
//!
//! K. A. Fischer and P. Wriggers, "Mortar based frictional contact formulation for higher order interpolations using the
//! moving friction cone", Comput. Methods Appl. Mech. Engrg. 195 (2006) 5020. There is no consensus among those who computed
//! it: at the end of the press the published V is 267.9 to 332.0 N/mm, at a quarter of the slide further (time 1.5) 337.4 to
//! 421.0 N/mm (Poulios and Renard 2015 and Code_Aster SSNP153 at the ends of the band).
//!
//! The foot, the small and the stiff side, is the slave: its points stay on the foundation wherever it goes, and few of the
//! points of the foundation would ever touch.
use crate::support::{Outcome, solve_in};
use serde_json::json;
use std::fmt::Write as _;
use std::path::Path;

const E: f64 = 689.6;
/// Nodes of the foundation are this far apart (mm); also the width of the slice.
const WIDTH: f64 = 0.25;

/// The block, 1.2 wide, .9 high at its sides and 1.2 in the middle, .2 above the foundation: `n` x `n` elements.
fn block(path: &Path, n: usize) {
    let (radius, half) = (0.75, 0.6f64);
    let angle = (half / radius).asin();
    let (mut text, mut elements) = ("*NODE\n".to_owned(), String::new());
    let node = |i: usize, j: usize, k: usize| 1 + 2 * (k * (n + 1) + i) + j;
    for k in 0..=n {
        let s = k as f64 / n as f64;
        for i in 0..=n {
            let turn = angle * (2.0 * i as f64 / n as f64 - 1.0);
            let (x0, z0) = (0.8 + radius * turn.sin(), 4.2 + radius * (1.0 - turn.cos()));
            let (x1, z1) = (0.2 + 1.2 * i as f64 / n as f64, 5.4);
            let (x, z) = (x0 + (x1 - x0) * s, z0 + (z1 - z0) * s);
            for (j, y) in [0.0, WIDTH].into_iter().enumerate() {
                writeln!(text, "{}, {x:e}, {y}, {z:e}", node(i, j, k)).expect("a string");
            }
        }
    }
    for k in 0..n {
        for i in 0..n {
            let ring = |k| {
                [
                    node(i, 0, k),
                    node(i + 1, 0, k),
                    node(i + 1, 1, k),
                    node(i, 1, k),
                ]
            };
            let nodes = [ring(k), ring(k + 1)].concat();
            let words: Vec<String> = nodes.iter().map(ToString::to_string).collect();
            writeln!(elements, "{}, {}", 1 + k * n + i, words.join(", ")).expect("a string");
        }
    }
    text += "*ELEMENT, TYPE=C3D8, ELSET=block\n";
    std::fs::write(path, text + &elements).expect("a mesh file");
}

/// Down by 1 until t = 1, then along x by 10 until t = 2; up to `end`.
fn ironed(end: f64) -> Outcome {
    let folder = tempfile::tempdir().expect("temporary folder");
    block(&folder.path().join("block.inp"), 8);
    let plane = |z: f64, normal: [f64; 3], y: f64| json!({ "nodes_near_plane": { "point": [0, y, z], "normal": normal, "tolerance": 1e-6 } });
    let scene = json!({
        "covact": 1,
        "materials": {
            "soft": { "neo_hooke": { "E": E, "nu": 0.32 } },
            "stiff": { "neo_hooke": { "E": 10.0 * E, "nu": 0.32 } }
        },
        "bodies": {
            "foundation": {
                "mesh": { "block": {
                    "min": [0, 0, 0], "max": [12, WIDTH, 4], "elements": [48, 1, 8],
                    "spacing": ["uniform", "uniform", { "geometric": { "ratio": 0.842 } }]
                } },
                "material": "soft", "element": "h8_displacement"
            },
            "block": {
                "mesh": { "file": { "path": "block.inp" } },
                "material": "stiff", "element": "h8_displacement",
                "sets": {
                    "foot": { "faces_facing": { "normal": [0, 0, -1], "angle": 60 } },
                    "head": plane(5.4, [0.0, 0.0, 1.0], 0.0),
                    "front": plane(0.0, [0.0, 1.0, 0.0], 0.0),
                    "back": plane(0.0, [0.0, 1.0, 0.0], WIDTH)
                }
            }
        },
        "contacts": { "iron": {
            "slave": "block.foot", "master": "foundation.top", "points": { "gauss": 3 },
            "penalty": { "scaled": 2 }, "friction": { "coulomb": { "mu": 0.3 } }
        } },
        "supports": {
            "floor": { "on": "foundation.bottom", "fixed": true },
            "front": { "on": "foundation.y_min", "symmetry": "y" },
            "back": { "on": "foundation.y_max", "symmetry": "y" },
            "block_front": { "on": "block.front", "symmetry": "y" },
            "block_back": { "on": "block.back", "symmetry": "y" },
            "head": { "on": "block.head", "displacement": {
                "x": { "table": [[0, 0], [1, 0], [2, 10]] },
                "z": { "table": [[0, 0], [1, -1], [2, -1]] }
            } }
        },
        "solution": {
            "end_time": end,
            "step": { "initial": 0.05, "max": 0.05, "min": 1e-4 }, "threads": 1
        },
        "output": { "every": 0 }
    });
    let outcome = solve_in(&scene, folder.path());
    let summary = &outcome.summary;
    assert_eq!(summary.status.name(), "done", "{:?}", summary.reason);
    println!("{} steps, {:.2} s", summary.steps, summary.wall_s);
    outcome
}

#[test]
fn a_block_is_pressed_in_within_the_published_band() {
    let outcome = ironed(1.0);
    let v = outcome.at("force.floor.z", 1.0) / WIDTH;
    println!("V(1) = {v:.1} N/mm");
    assert!((267.9..332.0).contains(&v));
}
