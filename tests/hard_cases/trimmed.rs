//! Contact with a trimmed face: the top of a die from an IGES file, a plane (z = 0) with a round opening of radius 26.
use crate::common::done;
use serde_json::{Value, json};

/// Radius of the opening where the fillet begins.
const OPENING: f64 = 26.0;

/// A plate of `n` x `n` elements whose bottom lies at z = 0, over that face alone.
fn scene(size: [f64; 2], origin: [f64; 2], n: [u32; 2]) -> Value {
    json!({
        "covact": 1,
        "units": { "length": "mm" },
        "materials": { "polymer": { "st_venant_kirchhoff": { "E": 2000, "nu": 0.3 } } },
        "bodies": { "plate": {
            "mesh": { "plate": {
                "size": size, "thickness": 1, "elements": n, "origin": [origin[0], origin[1], 0.5]
            } },
            "material": "polymer"
        } },
        "surfaces": { "die": { "cad": { "file": "../../assets/die.igs", "entities": [3] } } },
        "contacts": { "rest": { "slave": "plate.bottom", "master": "die" } },
        "solution": { "step": { "initial": 0.25, "max": 0.25 }, "threads": 1 }
    })
}

/// A quarter of a plate sags into the opening under pressure: it rests on the face and nowhere over the opening, but at nodes
/// that hang over by less than a quarter of an element, where the border is rounded off, though the plane of the face goes on there, and what the face bears is the pressure less what the clamped border bears.
#[test]
fn nothing_is_in_contact_over_the_opening() {
    let mut scene = scene([38.0, 38.0], [0.0, 0.0], [19, 19]);
    scene["supports"] = json!({
        "clamped_x": { "on": "plate.x_max", "fixed": true },
        "clamped_y": { "on": "plate.y_max", "fixed": true },
        "symmetry_x": { "on": "plate.x_min", "symmetry": "x" },
        "symmetry_y": { "on": "plate.y_min", "symmetry": "y" }
    });
    let pressure = 0.02;
    scene["loads"] = json!({ "air": { "on": "plate.top", "pressure": format!("{pressure}*t") } });
    let outcome = done(&scene);
    let body = outcome.body("plate", outcome.summary.steps);
    let (status, u) = (body.field("contact_status"), body.field("displacement"));
    let (mut over, mut closed, mut lowest) = (0, 0, 0.0f64);
    for (n, p) in body.points.iter().enumerate().filter(|(_, p)| p[2] < 1e-9) {
        let x = [0, 1, 2].map(|k| p[k] + u[3 * n + k]);
        let touches = status[n] == f64::from(covact::output::CLOSED);
        if x[0].hypot(x[1]) < OPENING {
            over += 1;
            lowest = lowest.min(x[2]);
            let carried = x[0].hypot(x[1]) > OPENING - 0.5;
            assert!(
                carried || !touches,
                "node {n} at {x:?} touches what is not there"
            );
        } else {
            closed += usize::from(touches);
            assert!(x[2] > -0.02, "node {n} at {x:?} sank through the face");
        }
    }
    assert!(over > 100 && closed > 10, "{over} {closed}");
    assert!(lowest < -0.5, "the plate must sag: {lowest}");
    let load = pressure * 38.0 * 38.0;
    let borne: f64 = ["die", "clamped_x", "clamped_y"]
        .map(|on| outcome.at(&format!("force.{on}.z"), 1.0))
        .iter()
        .sum();
    assert!((borne / load - 1.0).abs() < 1e-8, "{borne} {load}");
    assert!(outcome.at("force.die.z", 1.0) > 0.3 * load);
}

/// A small plate, pressed on the face by a hundredth, is carried over the opening: at every step those nodes are in contact that
/// lie outside of the circle, and none is left at the end. Of those that hang over it by less than a quarter of an element, where
/// the border is rounded off, some are.
#[test]
fn points_slide_off_at_the_trim_curve() {
    let mut scene = scene([6.0, 4.0], [27.5, 1.0], [12, 8]);
    scene["supports"] = json!({
        "held": { "on": "plate.top", "displacement": { "x": 0, "y": 0, "z": -0.01 } }
    });
    // The face moves instead of the plate.
    scene["surfaces"]["die"]["motion"] = json!({ "translation": ["9*t", 0, 0] });
    scene["solution"]["step"] = json!({ "initial": 0.05, "max": 0.05 });
    // What is counted are nodes of the plate.
    scene["contacts"]["rest"]["passes"] = json!("one");
    scene["contacts"]["rest"]["points"] = json!("nodes");
    let outcome = done(&scene);
    let (times, active) = (outcome.column("time"), outcome.column("points.active"));
    let mut seen = std::collections::BTreeSet::new();
    for (t, active) in times.iter().zip(active) {
        let (mut outside, mut rounded) = (0, 0);
        for i in 0..=12 {
            for j in 0..=8 {
                // The bottom keeps its grid but for what a hundredth of pressing changes, far less than the distance of
                // any node from the circle at the times that are compared.
                let (x, y) = (
                    27.5 + 0.5 * f64::from(i) - 9.0 * t,
                    1.0 + 0.5 * f64::from(j),
                );
                outside += u32::from(x.hypot(y) > OPENING);
                rounded += u32::from(x.hypot(y) > OPENING - 0.125);
            }
        }
        let [least, most] = [f64::from(outside) - 2.0, f64::from(rounded) + 2.0];
        assert!(
            (least..=most).contains(&active),
            "t = {t}: {active} in contact, {outside} outside of the circle, {rounded} with its rounding"
        );
        seen.insert(outside);
    }
    assert!(seen.len() > 8 && seen.contains(&117), "{seen:?}");
    assert_eq!(seen.first(), Some(&0));
}
