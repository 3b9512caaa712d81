//! Bodies that overlap at the start: strained, taken as touching, shrunk in, refused; and bodies that part again.
use crate::blocks::{DELTA, done, exact, patch};
use crate::support::solve;
use covact::{model, scene};
use serde_json::{Value, json};

/// The blocks of the patch test, the upper one put `DELTA` into the lower one and held there: once the overlap is
/// resolved, the state is that of the upper block pressed by `DELTA`.
fn overlapping(choice: Value) -> Value {
    let mut scene = patch(2, 2, json!({ "gauss": 2 }));
    scene["bodies"]["upper"]["placement"] = json!({ "translation": [0, 0, -DELTA] });
    scene["supports"]["push"]["displacement"]["z"] = json!(0);
    scene["contacts"]["press"]["initial_overclosure"] = choice;
    scene["solution"]["step"] = json!({ "initial": 0.25, "max": 0.25 });
    scene["solution"]["newton"]["tolerance"] = json!(1e-11);
    scene
}

#[test]
fn an_overlap_of_bodies_is_strained_or_shrunk_in_or_counts_as_touching() {
    let p = exact();
    let strained = done(&overlapping(json!("strain")));
    let shrunk = done(&overlapping(json!({ "shrink": { "until": 0.5 } })));
    for (name, outcome) in [("strain", &strained), ("shrink", &shrunk)] {
        let force = outcome.at("force.ground.z", 1.0);
        assert!(
            (force - p).abs() < 1e-8 * p,
            "{name}: {force} instead of {p}"
        );
    }
    // Half the overlap at half the time: that of a press by half the displacement.
    let mut half = patch(2, 2, json!({ "gauss": 2 }));
    half["supports"]["push"]["displacement"]["z"] = json!(format!("-{}*t", 0.5 * DELTA));
    half["solution"]["newton"]["tolerance"] = json!(1e-11);
    let half = done(&half).at("force.ground.z", 1.0);
    let found = shrunk.at("force.ground.z", 0.25);
    assert!(
        half > 0.4 * p && (found - half).abs() < 1e-8 * half,
        "{found} instead of {half}"
    );
    // The overlap counts as no gap: nothing is pressed, until the upper block is moved.
    let mut free = overlapping(json!("stress_free"));
    let table = json!({ "table": [[0, 0], [0.5, 0], [1, -DELTA]] });
    free["supports"]["push"]["displacement"]["z"] = table;
    let free = done(&free);
    assert!(free.at("force.ground.z", 0.5).abs() < 1e-9 * p);
    let pressed = free.at("force.ground.z", 1.0);
    assert!((pressed - p).abs() < 1e-8 * p, "{pressed} instead of {p}");
}

#[test]
fn an_overlap_of_bodies_is_refused_by_name() {
    let text = overlapping(json!("refuse")).to_string();
    let loaded = scene::parse(&text, "scene.json").unwrap();
    let error = model::build::build(&loaded).unwrap_err();
    assert_eq!(error.pointer, "/contacts/press/initial_overclosure");
    let message = error.to_string();
    assert!(
        message.contains("`press`") && message.contains("0.01"),
        "{message}"
    );
}

/// Pressed together and drawn apart: the force goes back to nothing, no point stays in contact, and pressing again gives the
/// same force.
#[test]
fn bodies_part_and_meet_again() {
    let mut scene = patch(3, 2, json!({ "gauss": 3 }));
    let path = [
        [0.0, 0.0],
        [0.25, -DELTA],
        [0.5, DELTA],
        [0.75, DELTA],
        [1.0, -DELTA],
    ];
    scene["supports"]["push"]["displacement"]["z"] = json!({ "table": path });
    // Held by itself where nothing touches.
    scene["supports"]["ground"]["displacement"] = json!({ "z": 0 });
    scene["solution"]["step"] = json!({ "initial": 0.25, "max": 0.25 });
    scene["solution"]["newton"]["tolerance"] = json!(1e-11);
    let outcome = solve(&scene);
    assert_eq!(
        outcome.summary.status.name(),
        "done",
        "{:?}",
        outcome.summary
    );
    let force = |t: f64| outcome.at("force.ground.z", t);
    assert!(force(0.25) > 0.9 * exact());
    assert!(force(0.5).abs() < 1e-9 * force(0.25) && force(0.75).abs() < 1e-9 * force(0.25));
    assert_eq!(outcome.at("points.active", 0.5), 0.0);
    assert!((force(1.0) / force(0.25) - 1.0).abs() < 1e-9);
}

/// A quarter of a tube shrunk on another whose mesh does not match, with an interference of a fifth of the sagitta of the facets:
/// mean and spread of the pressure.
fn shrunk(more: Value, slave: [u32; 2], master: [u32; 2]) -> [f64; 3] {
    let tube = |radius: f64, thickness: f64, [around, through]: [u32; 2]| {
        json!({
            "mesh": { "cylinder_panel": {
                "radius": radius, "thickness": thickness, "angles": [0, 90], "y": [0, 3],
                "elements": [around, 1], "layers": through
            } },
            "material": "steel"
        })
    };
    let mut scene = json!({
        "covact": 1,
        "materials": { "steel": { "st_venant_kirchhoff": { "E": 210000, "nu": 0.3 } } },
        "bodies": { "outer": tube(20.0, 5.0, master), "inner": tube(15.0, 5.02, slave) },
        "contacts": { "fit": { "slave": "inner.outer", "master": "outer.inner", "accuracy": 1e-4 } },
        "supports": {
            "x": { "on": ["outer.phi_min", "inner.phi_min"], "symmetry": "x" },
            "z": { "on": ["outer.phi_max", "inner.phi_max"], "symmetry": "z" },
            "y": { "on": ["outer.y_min", "outer.y_max", "inner.y_min", "inner.y_max"], "symmetry": "y" }
        },
        "output": { "every": 0 }
    });
    for (key, value) in more.as_object().unwrap() {
        scene["contacts"]["fit"][key] = value.clone();
    }
    let outcome = solve(&scene);
    assert_eq!(outcome.summary.status, covact::output::RunStatus::Done);
    let warned = |w: &String| w.contains("flat facets");
    assert!(!outcome.summary.warnings.iter().any(warned));
    // Force along x on a quarter: pressure times its projection.
    let force = outcome.at("slave.force.fit.x", 1.0).abs();
    let mean = force / (17.505 * 3.0);
    let largest = outcome.at("pressure.max", 1.0);
    [mean, largest, outcome.summary.accuracy.force_error]
}

/// G. Lame's pressure between two tubes of one material in plane strain, `p = delta E' / (2 R) (b^2 - R^2) (R^2 - a^2) / (R^2 (b^2 -
/// a^2))` with `E' = E / (1 - nu^2)` (S. P. Timoshenko and J. N. Goodier, Theory of Elasticity, section 28): within 1 to
/// 1.5 % on the mean at 12 elements a quarter on 8, .5 % on twice as many. Without the sagitta taken out it is five times as large.
#[test]
fn a_shrink_fit_of_facets_has_the_pressure_of_the_curved_surfaces() {
    let (delta, r, a, b) = (0.01, 17.505, 12.49, 22.5);
    let e = 210_000.0 / (1.0 - 0.09);
    let sq = |x: f64| x * x;
    let p = delta * e / (2.0 * r) * (sq(b) - sq(r)) * (sq(r) - sq(a)) / (sq(r) * (sq(b) - sq(a)));
    let gauss = json!({ "points": { "gauss": 2 } });
    let averaged = json!({ "gap": "averaged", "points": { "gauss": 2 } });
    for (name, tolerance, more, fine) in [
        ("nodes", 0.01, json!({ "points": "nodes" }), 1),
        ("Gauss points", 0.015, gauss.clone(), 1),
        ("averaged gaps", 0.015, averaged.clone(), 1),
        ("Gauss points, finer", 0.005, gauss, 2),
        ("averaged gaps, finer", 0.005, averaged, 2),
    ] {
        let [mean, largest, error] = shrunk(more, [12 * fine, 4 * fine], [8 * fine, 4 * fine]);
        println!("{name}: mean {mean:.4}, largest {largest:.4}, Lame {p:.4}; told {error:.1e}");
        assert!((mean / p - 1.0).abs() < tolerance, "{name}");
    }
}

/// Energy of a sleeve (inner radius b, outer c) shrunk by `delta` onto a hub (inner a, outer b) of height 4 between lubricated planes:
/// S. P. Timoshenko and J. N. Goodier, Theory of Elasticity, 28 (Lame), in plane strain.
fn lame(delta: f64) -> f64 {
    let [a, b, c]: [f64; 3] = [10.0, 20.0, 25.0];
    let give = |[e, nu]: [f64; 2], other: f64| {
        let around = ((1.0 - 2.0 * nu) * b * b + other * other) / (b * b - other * other).abs();
        b * (1.0 + nu) / e * around
    };
    let pressure = delta / (give([110e3, 0.34], a) + give([210e3, 0.3], c));
    0.5 * pressure * delta * std::f64::consts::TAU * b * 4.0
}

/// A sleeve that nothing hinders from turning on its hub turns to where their flat faces do not press: in the middle of its face the hub
/// lies .076 inside of its circle, more than the overclosure. It keeps its fit, as one that is held does, and so does one whose faces do
/// not match.
#[test]
fn a_sleeve_that_is_free_to_turn_keeps_its_fit() {
    const DELTA: f64 = 0.05;
    let fit = |around: u32| {
        let ring = |inner: f64, thickness: f64, around: u32| {
            json!({"cylinder_panel": {
                "radius": inner + 0.5 * thickness, "thickness": thickness, "angles": [0, 360], "y": [0, 4],
                "elements": [around, 1], "layers": 3
            }})
        };
        let scene = json!({
            "covact": 1,
            "materials": {
                "steel": {"st_venant_kirchhoff": {"E": 210_000, "nu": 0.3}},
                "bronze": {"st_venant_kirchhoff": {"E": 110_000, "nu": 0.34}}
            },
            "bodies": {
                "hub": {"mesh": ring(10.0, 10.0, 36), "material": "bronze"},
                "sleeve": {"mesh": ring(20.0 - DELTA, 5.0, around), "material": "steel"}
            },
            "contacts": {"fit": {"slave": "sleeve.inner", "master": "hub.outer"}},
            "supports": {"low": {"on": ["hub.y_min", "sleeve.y_min"], "symmetry": "y"},
                "high": {"on": ["hub.y_max", "sleeve.y_max"], "symmetry": "y"}},
            "output": {"every": 0}
        });
        done(&scene)
    };
    for around in [36, 48] {
        let outcome = fit(around);
        let energy = outcome.column("energy.internal");
        let exact = lame(DELTA);
        println!("{around}: {energy:?} of {exact}");
        // Rings of 36 flat elements are stiffer than round ones by less than that, and the load does not change.
        assert!(energy.iter().all(|e| (e / exact - 1.0).abs() < 0.03));
        let [first, last] = [energy[0], energy[energy.len() - 1]];
        assert!((first / last - 1.0).abs() < 1e-3, "{first} {last}");
    }
}

/// Whoever wants flat faces has them, and is told what they change once the sleeve has turned.
#[test]
fn flat_faces_that_were_asked_for_are_told() {
    let ring = |inner: f64, thickness: f64, around: u32| {
        json!({"cylinder_panel": {
            "radius": inner + 0.5 * thickness, "thickness": thickness, "angles": [0, 360], "y": [0, 4], "elements": [around, 1]
        }})
    };
    let scene = json!({
        "covact": 1,
        "materials": {"m": {"st_venant_kirchhoff": {"E": 110_000, "nu": 0.34}}},
        "bodies": {
            "hub": {"mesh": ring(15.0, 5.0, 36), "material": "m"},
            "sleeve": {"mesh": ring(19.95, 5.0, 36), "material": "m"}
        },
        "contacts": {"fit": {"slave": "sleeve.inner", "master": "hub.outer", "master_surface": "faces"}},
        "supports": {"low": {"on": ["hub.y_min", "sleeve.y_min"], "symmetry": "y"},
            "high": {"on": ["hub.y_max", "sleeve.y_max"], "symmetry": "y"},
            "turn": {"on": "sleeve.outer", "displacement": ["x*(cos(0.05*t)-1)+z*sin(0.05*t)", null, "z*(cos(0.05*t)-1)-x*sin(0.05*t)"]}},
        "output": {"every": 0}
    });
    let outcome = solve(&scene);
    let told = outcome
        .summary
        .warnings
        .iter()
        .find(|w| w.contains("slide over flat faces that stand for curved ones"));
    let told = told.unwrap_or_else(|| panic!("{:?}", outcome.summary.warnings));
    assert!(told.contains("`fit`") && told.contains("smooth"), "{told}");
    assert_eq!(outcome.summary.given_up.runs, 0);
}
