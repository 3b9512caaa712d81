//! Hencky's law in scenes.
use crate::support::solve;
use serde_json::json;

/// A strip 10 x 4 x 1 drawn and compressed along x, free sideways: force `E ln l / l` per undeformed area, energy
/// `E ln^2 l / 2` per undeformed volume.
#[test]
fn uniaxial_force_follows_the_logarithm() {
    let (e, nu) = (1000.0, 0.3);
    for (element, stretch) in [("h8", 2.0f64), ("h8_displacement", 0.6), ("q18", 1.6)] {
        let scene = json!({
            "covact": 1,
            "materials": { "m": { "hencky": { "E": e, "nu": nu } } },
            "bodies": { "strip": {
                "element": element,
                "mesh": { "plate": { "size": [10, 4], "thickness": 1, "elements": [3, 2], "layers": 2 } },
                "material": "m"
            } },
            "supports": {
                "x": { "on": "strip.x_min", "symmetry": "x" },
                "y": { "on": "strip.y_min", "symmetry": "y" },
                "z": { "on": "strip.bottom", "symmetry": "z" },
                "pull": { "on": "strip.x_max", "displacement": { "x": format!("{}*t", 10.0 * (stretch - 1.0)) } }
            }
        });
        let outcome = solve(&scene);
        assert_eq!(outcome.summary.status.name(), "done");
        let effects = &outcome.summary.effects;
        assert!(
            effects.iter().any(|e| e == "material.hencky"),
            "{effects:?}"
        );
        let log = stretch.ln();
        let close = |name: &str, exact: f64| {
            let found = outcome.at(name, 1.0);
            assert!(
                (found / exact - 1.0).abs() < 1e-7,
                "{name}: {found} {exact}"
            );
        };
        close("force.pull.x", 4.0 * e * log / stretch);
        close("energy.internal", 40.0 * 0.5 * e * log * log);
    }
}
