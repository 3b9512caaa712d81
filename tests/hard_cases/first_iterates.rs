//! Steps whose first iterate is far from equilibrium: contact lost by a path that is continued straight, friction that turns
//! round.
use crate::friction::{block, done, plane};
use crate::support::{Outcome, scene_json, set, solve};
use covact::solve::event::Event;
use serde_json::json;

/// New starts of steps, in words.
fn starts(outcome: &Outcome) -> Vec<(u32, &str)> {
    let starts = outcome.events.iter().filter_map(|e| match e {
        Event::StepRetried { step, start, .. } => Some((*step, start.as_str())),
        Event::StepCut { step, .. } => Some((*step, "cut")),
        _ => None,
    });
    starts.collect()
}

/// A block is pressed on a plane, where it bulges and slides outwards, and is then drawn along it: the step after the kink
/// starts from the last accepted state, with all traction at its limit in another direction. Tangents of sliding points send
/// them to and fro there until the step is cut.
#[test]
fn pressed_block_is_drawn_without_a_cut() {
    let mu = 0.3;
    for press in [-0.05, -0.04] {
        let top = json!({
            "x": { "table": [[0, 0], [0.2, 0], [1, 0.3]] }, "y": 0,
            "z": { "table": [[0, 0], [0.2, press], [1, press]] }
        });
        let outcome = done(&block(plane(), top, json!(mu), 10));
        assert_eq!(starts(&outcome), []);
        // At the end all of it slides.
        assert_eq!(outcome.column("points.stick").last(), Some(&0.0));
        let [x, z] = ["x", "z"].map(|axis| outcome.column(&format!("force.tool.{axis}")));
        let (x, z) = (x[x.len() - 1], z[z.len() - 1]);
        assert!(z > 1.0 && (x / (mu * z) + 1.0).abs() < 1e-3, "{x:e}, {z:e}");
    }
}

/// A thin sheet bent over three rollers under the penalty that suits its elements, without friction. The straight path takes points off the
/// rollers by more than they may sink in; the first linearisation keeps them, and no step needs a softened penalty once
/// contact is established.
#[test]
fn sheet_bent_over_rollers_keeps_its_points() {
    let mut scene = scene_json("draw_bead.json");
    for contact in ["above", "below"] {
        let contact = &mut scene["contacts"][contact];
        contact["penalty"] = json!({ "scaled": 1 });
        contact
            .as_object_mut()
            .expect("a contact")
            .remove("friction");
    }
    set(&mut scene, "/solution/end_time", 0.65);
    set(&mut scene, "/output/every", 0);
    let outcome = solve(&scene);
    let starts = starts(&outcome);
    assert_eq!(outcome.column("time").len(), 65);
    let kept = "the continued path with the points kept that it opens";
    assert!(starts.iter().any(|s| s.1 == kept), "{starts:?}");
    let late: Vec<_> = starts.iter().filter(|s| s.0 > 10 && s.1 != kept).collect();
    assert!(late.is_empty(), "{late:?}");
    let deepest = outcome
        .column("penetration.max")
        .into_iter()
        .fold(0.0, f64::max);
    assert!(deepest > 0.0 && deepest < 0.01, "{deepest:e}");
}

/// A sheet of rubber blown up by a pressure that follows it, in elements that do not turn inside out: from a flat start the first
/// increments are thousands of times as large as the sheet. Such attempts end after a few iterations, and a smaller step starts.
#[test]
fn increments_that_grow_without_bounds_end_an_attempt() {
    let outcome = solve(&json!({
        "covact": 1,
        "materials": { "rubber": { "neo_hooke": { "E": 5, "nu": 0.45 } } },
        "bodies": { "sheet": {
            "element": "h8_mean_dilatation",
            "mesh": { "plate": { "size": [20, 20], "thickness": 1, "elements": [10, 10] } }, "material": "rubber"
        } },
        "supports": {
            "sx": { "on": "sheet.x_min", "symmetry": "x" }, "sy": { "on": "sheet.y_min", "symmetry": "y" },
            "cx": { "on": "sheet.x_max", "fixed": true }, "cy": { "on": "sheet.y_max", "fixed": true }
        },
        "loads": { "p": { "on": "sheet.top", "pressure": "0.12*t", "follower": true } },
        "output": { "every": 0 }
    }));
    assert_eq!(outcome.summary.status.name(), "done");
    let failures: Vec<&str> = (outcome.events.iter())
        .filter_map(|e| match e {
            Event::StepRetried { reason, .. } | Event::StepCut { reason, .. } => {
                Some(reason.as_str())
            }
            _ => None,
        })
        .collect();
    println!("{failures:?}");
    let wild = failures
        .iter()
        .filter(|r| r.starts_with("increments grow without bounds"));
    assert!(wild.count() > 0, "{failures:?}");
    assert!(!failures.iter().any(|r| r.contains("not a finite number")));
    // Few iterations each: an attempt used to go on for ten and more.
    let failed = outcome.summary.failed_iterations;
    assert!(failed <= 8 * failures.len() as u64, "{failed}");
}
