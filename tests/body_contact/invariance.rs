//! What must not change a result.
use crate::blocks::done;
use crate::shells::arch_on_plate;
use serde_json::json;

#[test]
fn any_number_of_threads_gives_the_same_bits() {
    let history = |threads: u32| {
        let mut scene = arch_on_plate(2.0, 3, json!({"gauss": 5}));
        scene["solution"]["threads"] = json!(threads);
        let outcome = done(&scene);
        let used = (threads as usize).min(covact::machine::processors());
        assert_eq!(outcome.summary.threads, used);
        std::fs::read(outcome.folder.path().join("history.csv")).expect("history")
    };
    let one = history(1);
    assert!(one.iter().filter(|b| **b == b'\n').count() > 3);
    for threads in [2, 3] {
        assert!(one == history(threads), "{threads} threads differ");
    }
}

/// A second plate under the first: which pair comes first is a matter of their names.
#[test]
fn the_order_of_the_pairs_changes_nothing() {
    let force = |first: &str, second: &str| {
        let mut scene = arch_on_plate(1.5, 3, json!({"gauss": 2}));
        let press = scene["contacts"]["press"].take();
        scene["bodies"]["base"] = json!({"mesh": {"plate": {
            "size": [10, 4.3], "thickness": 0.3, "elements": [9, 3], "origin": [0, 0, -0.31]
        }}, "material": "m"});
        for (name, on, what) in [
            ("base_clamped", "base.x_max", json!({"fixed": true})),
            ("base_x", "base.x_min", json!({"symmetry": "x"})),
            ("base_y", "base.y_min", json!({"symmetry": "y"})),
        ] {
            scene["supports"][name] = what;
            scene["supports"][name]["on"] = json!(on);
        }
        let rest = json!({
            "slave": "plate.bottom", "master": "base.top", "points": {"gauss": 2},
            "penalty": {"value": 300}
        });
        scene["contacts"] = json!({first: press, second: rest});
        let outcome = done(&scene);
        let columns = [
            format!("slave.force.{first}.z"),
            format!("slave.force.{second}.z"),
            "energy.internal".to_owned(),
        ];
        columns.map(|c| *outcome.column(&c).last().expect("steps"))
    };
    let (a, b) = (force("a", "b"), force("z", "b"));
    println!("{a:?} {b:?}");
    for (a, b) in a.iter().zip(&b) {
        assert!(a.abs() > 1e-4, "{a:?}");
        assert!((a - b).abs() < 1e-9 * a.abs());
    }
}
