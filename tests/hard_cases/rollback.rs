//! A step that fails leaves nothing behind.
use crate::common::{PHYSICAL, done, plate};
use covact::solve::event::Event;
use serde_json::json;

#[test]
fn failed_steps_leave_no_trace() {
    let run = |initial: f64, iterations: u32| {
        let mut scene = plate(8, 8.0, 8);
        scene["solution"]["step"] = json!({ "initial": initial, "max": initial });
        scene["solution"]["newton"]["max_iterations"] = json!(iterations);
        done(&scene)
    };
    let small = run(1.0 / 32.0, 25);
    assert_eq!(small.summary.cuts, 0);
    // Five iterations are too few for the whole way at once.
    let large = run(1.0, 5);
    assert!(large.summary.cuts >= 2, "{} cuts", large.summary.cuts);
    let first_cut = large.events.iter().find_map(|e| match e {
        Event::StepCut { step, dt, .. } => Some((*step, *dt)),
        _ => None,
    });
    assert_eq!(first_cut, Some((1, 1.0)));
    println!(
        "{} cuts, {} steps against {}",
        large.summary.cuts, large.summary.steps, small.summary.steps
    );
    for name in PHYSICAL {
        let (a, b) = (small.at(name, 1.0), large.at(name, 1.0));
        assert!(a != 0.0, "{name}");
        assert!((b / a - 1.0).abs() < 1e-8, "{name}: {a} and {b}");
    }
}
