//! Elastic sheet under a punch of 45 NURBS patches read from an IGES file: no closed form, so coarse runs are held
//! against a finer run of our own, with the rate of an element that converges at second order.
use crate::support::{scene_json, set, solve};

/// Force of the punch on the whole sheet at 2, 4, 6 and 8 mm.
fn forces(n: u32) -> ([f64; 4], u64) {
    let mut scene = scene_json("punch_sheet.json");
    set(
        &mut scene,
        "/bodies/sheet/mesh/plate/elements",
        vec![n, 4 * n / 5],
    );
    scene["solution"]["stops"] = serde_json::json!([0.25, 0.5, 0.75]);
    scene["output"] = serde_json::json!({ "every": 0 });
    // What the penalty takes away is not to be seen beside what the mesh does.
    scene["contacts"]["press"]["accuracy"] = serde_json::json!(1e-4);
    let outcome = solve(&scene);
    assert_eq!(outcome.summary.status.name(), "done");
    let f = [0.25, 0.5, 0.75, 1.0].map(|t| -4.0 * outcome.at("force.punch.z", t));
    (f, outcome.summary.newton_iterations)
}

#[test]
fn converges_to_the_finer_run() {
    let fine: serde_json::Value =
        serde_json::from_str(include_str!("reference/punch_sheet.json")).unwrap();
    let reference: [f64; 4] = std::array::from_fn(|i| fine["force"][i].as_f64().unwrap());
    let error = |f: &[f64; 4]| {
        let sum: f64 = f
            .iter()
            .zip(&reference)
            .map(|(f, r)| (f / r - 1.0).abs())
            .sum();
        sum / 4.0
    };
    let ((coarse, i), (middle, j)) = (forces(20), forces(40));
    let (e, f) = (error(&coarse), error(&middle));
    println!(
        "errors {e}, {f}, rate {}, iterations {i}, {j}",
        (e / f).log2()
    );
    // Mesh of 2.5 mm under a fillet of 5 mm, then of 1.25 mm.
    assert!(e < 3e-2 && f < 7e-3, "{e} {f}");
    assert!((e / f).log2() > 1.6, "rate {}", (e / f).log2());
    // A regression, no verification.
    assert!(i <= 200 && j <= 200, "{i} and {j} iterations");
}
