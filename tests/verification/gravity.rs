//! Weight of bodies: gravity on the mass of their elements.
use crate::support::{Outcome, solve};
use covact::output::RunStatus;
use covact::scene;
use serde_json::{Value, json};

const E: f64 = 1000.0;
const DENSITY: f64 = 0.02;
const G: f64 = 10.0;
const HEIGHT: f64 = 8.0;

/// A column of cross-section 2 x 3 that hangs from its top.
fn column(element: &str, density: Option<f64>) -> Value {
    let mut material = json!({ "E": E, "nu": 0.0 });
    if let Some(density) = density {
        material["density"] = json!(density);
    }
    json!({
        "covact": 1,
        "materials": { "m": { "st_venant_kirchhoff": material } },
        "bodies": { "c": {
            "mesh": { "block": {
                "min": [0, 0, 0], "max": [2, 3, HEIGHT], "elements": [3, 2, 8], "spacing": ["uniform", "uniform", { "geometric": { "ratio": 1.2 } }]
            } },
            "material": "m", "element": element
        } },
        "supports": { "top": { "on": "c.z_max", "fixed": true } },
        "loads": { "weight": { "on": "c", "gravity": [0, 0, format!("-{G}*t")] } },
        "solution": { "step": { "initial": 1, "max": 1 } },
        "output": { "every": 1 }
    })
}

fn done(scene: &Value) -> Outcome {
    let outcome = solve(scene);
    let s = &outcome.summary;
    assert_eq!(s.status, RunStatus::Done, "{:?}", s.reason);
    outcome
}

/// Closed form of a hanging bar with `nu = 0`: the support carries `rho g V`, and the lower end sinks by `rho g L^2 / 2 E`. The
/// strain is `4e-4`, and terms beyond the linear ones are as small. Elements of unequal height: what a node carries is the integral of
/// its shape function.
#[test]
fn a_column_hangs_by_its_weight() {
    for (element, mesh) in [("h8", true), ("h8_displacement", true), ("q18", false)] {
        let mut scene = column(element, Some(DENSITY * 0.025));
        if !mesh {
            scene["bodies"]["c"]["mesh"]["block"] = json!({
                "min": [0, 0, 0], "max": [2, 3, HEIGHT], "elements": [3, 2, 8]
            });
        }
        let outcome = done(&scene);
        let rho_g = 0.025 * DENSITY * G;
        let weight = rho_g * 2.0 * 3.0 * HEIGHT;
        let force = outcome.at("force.top.z", 1.0);
        assert!(
            (force / weight - 1.0).abs() < 1e-9,
            "{element} {force} {weight}"
        );
        let body = outcome.body("c", 1);
        let u = body.field("displacement");
        let sinks = rho_g * HEIGHT * HEIGHT / (2.0 * E);
        let mut lower = 0;
        for (n, x) in body
            .points
            .iter()
            .enumerate()
            .filter(|(_, x)| x[2].abs() < 1e-9)
        {
            lower += 1;
            let found = -u[3 * n + 2];
            assert!(
                (found / sinks - 1.0).abs() < 1e-3,
                "{element} at {x:?}: {found} {sinks}"
            );
        }
        assert!(lower >= 12);
    }
}

/// Weight acts at the centre of mass: a body that leans has the moment of its whole mass about its support.
#[test]
fn weight_acts_at_the_centre_of_mass() {
    let mut scene = column("h8", Some(1e-6));
    scene["bodies"]["c"]["placement"] =
        json!({ "axis": [0, 1, 0], "angle": 30, "translation": [5, 0, 0] });
    let outcome = done(&scene);
    let weight = 1e-6 * G * 2.0 * 3.0 * HEIGHT;
    let (sin, cos) = 30f64.to_radians().sin_cos();
    let middle = [5.0 + cos + sin * 0.5 * HEIGHT, 1.5];
    // Moment of the reactions about the origin.
    let [x, y] = ["moment.top.x", "moment.top.y"].map(|m| outcome.at(m, 1.0));
    assert!((x / (weight * middle[1]) - 1.0).abs() < 1e-6, "{x}");
    assert!((y / (-weight * middle[0]) - 1.0).abs() < 1e-6, "{y}");
}

#[test]
fn what_gravity_asks_for_is_told() {
    let told = |scene: &Value| {
        let loaded = scene::parse(&scene.to_string(), "scene.json").unwrap();
        let found: Vec<String> = scene::check(&loaded)
            .iter()
            .map(|p| p.to_string())
            .collect();
        assert_eq!(found.len(), 1, "{found:?}");
        found.join("")
    };
    let none = told(&column("h8", None));
    assert!(
        none.contains("the material `m` of body `c` has no density"),
        "{none}"
    );
    let mut scene = column("h8", Some(1.0));
    scene["loads"]["weight"]["on"] = json!("c.z_min");
    let set = told(&scene);
    assert!(
        set.contains("gravity acts on whole bodies") && set.contains("write `c`"),
        "{set}"
    );
    scene["loads"]["weight"]["on"] = json!(["d"]);
    let body = told(&scene);
    assert!(body.contains("there is no body `d`"), "{body}");
    // By name, in the units of the scene: 7850 kg/m^3 are 7.85e-9 N s^2 / mm^4.
    let mut scene = column("h8", None);
    scene["units"] = json!({ "length": "mm", "force": "N" });
    scene["materials"]["m"] = json!("steel");
    let outcome = done(&scene);
    let weight = 7.85e-9 * G * 2.0 * 3.0 * HEIGHT;
    let force = outcome.at("force.top.z", 1.0);
    assert!((force / weight - 1.0).abs() < 1e-6, "{force} {weight}");
}
