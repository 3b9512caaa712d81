//! A tube with a slit along its length, twisted. St. Venant: a closed thin tube has the torsion constant `2 pi R^3 t`, a slit one
//! that of the rectangle it is rolled from, `b t^3 / 3 (1 - 0.63 t / b)` with `b = 2 pi R` (S. Timoshenko, J. N. Goodier, "Theory of
//! Elasticity", section 109).
use covact::run::{Options, Simulation};
use covact::scene;
use serde_json::json;
use std::f64::consts::TAU;
use std::fmt::Write;
use std::path::Path;

const RADIUS: f64 = 10.0;
const THICKNESS: f64 = 1.0;
const LENGTH: f64 = 12.0;
const E: f64 = 1000.0;
const NU: f64 = 0.3;
const ANGLE: f64 = 1e-3;

/// The middle of the tube's wall as quadrilaterals, with nodes of its own on either side of a slit or closed.
fn file(around: usize, along: usize, slit: bool) -> String {
    let columns = around + usize::from(slit);
    let mut text = "*NODE\n".to_owned();
    for j in 0..=along {
        for i in 0..columns {
            let phi = TAU * (i % around) as f64 / around as f64;
            let (x, z) = (RADIUS * phi.sin(), RADIUS * phi.cos());
            let y = LENGTH * j as f64 / along as f64;
            writeln!(text, "{}, {x}, {y}, {z}", 1 + i + columns * j).unwrap();
        }
    }
    text += "*ELEMENT, TYPE=S4, ELSET=wall\n";
    for j in 0..along {
        for i in 0..around {
            let at = |i: usize, j: usize| 1 + i % columns + columns * j;
            let (a, b, c, d) = (at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1));
            writeln!(text, "{}, {a}, {b}, {c}, {d}", 1 + i + around * j).unwrap();
        }
    }
    text
}

/// The tube with one end held in its plane, the other turned in it; both are free to warp.
fn simulation(folder: &Path, slits: bool) -> Result<Simulation<'static>, String> {
    let turn = |of: &str| format!("{} * {of} * t", ANGLE);
    let scene = json!({
        "covact": 1,
        "materials": { "m": { "st_venant_kirchhoff": { "E": E, "nu": NU } } },
        "bodies": { "tube": {
            "mesh": { "file": { "path": "tube.inp", "thickness": THICKNESS, "slits": slits } },
            "material": "m",
            "sets": {
                "start": { "nodes_in_box": { "min": [-20, -0.1, -20], "max": [20, 0.1, 20] } },
                "end": { "nodes_in_box": { "min": [-20, LENGTH - 0.1, -20], "max": [20, LENGTH + 0.1, 20] } },
                "point": { "nodes_in_box": { "min": [-0.1, -0.1, -11], "max": [0.1, 0.1, -10.2] } }
            }
        } },
        "supports": {
            "start": { "on": "tube.start", "displacement": { "x": 0, "z": 0 } },
            "point": { "on": "tube.point", "displacement": { "y": 0 } },
            "end": { "on": "tube.end", "displacement": { "x": turn("z"), "z": turn("(-x)") } }
        },
        "solution": { "end_time": 1, "kinematics": "small" }
    });
    let text = serde_json::to_string_pretty(&scene).expect("serialisable");
    let mut loaded = scene::parse(&text, "scene.json").unwrap_or_else(|e| panic!("{e}"));
    loaded.dir = folder.to_owned();
    Simulation::new(loaded, Options::default()).map_err(|e| e.to_string())
}

/// `2 W L / (G angle^2)` with the work W done at the turned end.
fn torsion_constant(folder: &Path, slits: bool) -> f64 {
    let mut run = simulation(folder, slits).unwrap_or_else(|e| panic!("{e}"));
    while run.step().expect("an equilibrium").is_some() {}
    let history = run.history();
    let column = |name: &str| history.columns.iter().position(|c| c == name).unwrap();
    let energy = history.rows.last().unwrap()[column("energy.internal")];
    2.0 * energy * LENGTH / (E / (2.0 * (1.0 + NU)) * ANGLE * ANGLE)
}

#[test]
fn a_slit_tube_twists_as_the_plate_it_is_rolled_from() {
    let folder = tempfile::tempdir().unwrap();
    let write = |text: String| std::fs::write(folder.path().join("tube.inp"), text).unwrap();
    let b = TAU * RADIUS;
    write(file(64, 4, true));
    let refused = simulation(folder.path(), false)
        .err()
        .expect("borders that touch");
    assert!(
        refused.contains("slit") && refused.contains("`\"slits\": true`"),
        "{refused}"
    );
    let open = torsion_constant(folder.path(), true);
    let plate = b * THICKNESS.powi(3) / 3.0 * (1.0 - 0.63 * THICKNESS / b);
    assert!((open / plate - 1.0).abs() < 0.01, "{open} {plate}");
    write(file(64, 4, false));
    let closed = torsion_constant(folder.path(), false);
    // Of chords, which enclose a little less, and of a wall that is not quite thin: (t / 2 R)^2.
    let ring = b * RADIUS * RADIUS * THICKNESS * (1.0 + 0.25 * (THICKNESS / RADIUS).powi(2));
    assert!((closed / ring - 1.0).abs() < 0.005, "{closed} {ring}");
}
