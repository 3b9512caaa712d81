//! The master's parametrisation is nobody's business: the same sphere swapped, reversed, stretched, from six patches.
use crate::common::{cad_file, difference, done, plate};
use crate::support::Outcome;
use covact_geometry::primitives::{sphere, sphere_without_poles};
use covact_geometry::{NurbsPatch, Vec3};
use serde_json::json;

/// The same patch with its parameters mapped affinely.
fn stretched(patch: &NurbsPatch) -> NurbsPatch {
    let knots = [0, 1].map(|d| {
        let map = |t: &f64| [1000.0, -3.0][d] + [1e3, 1e-3][d] * t;
        patch.knots(d).iter().map(map).collect()
    });
    let (points, weights) = (patch.points(), patch.weights());
    NurbsPatch::new(
        patch.degree(),
        knots,
        patch.counts(),
        &points,
        Some(&weights),
    )
    .unwrap()
}

fn run(patches: &[NurbsPatch]) -> Outcome {
    let folder = tempfile::tempdir().expect("temporary folder");
    let file = folder.path().join("ball.cad.json");
    cad_file(patches, &file);
    let mut scene = plate(8, 5.0, 4);
    let ball = scene["surfaces"]["ball"]
        .as_object_mut()
        .expect("a surface");
    ball.remove("sphere");
    ball.insert("cad".into(), json!({ "file": file }));
    done(&scene)
}

#[test]
fn parametrisation_does_not_change_the_result() {
    let center = Vec3::new(0.0, 0.0, 26.0);
    let one = sphere(25.0, center, Vec3::y()).unwrap();
    let reference = done(&plate(8, 5.0, 4));
    // An axis that puts neither poles nor seams nor knots where the plate is.
    let oblique = Vec3::new(1.0, -2.0, 0.5);
    let mut counts = vec![reference.summary.newton_iterations];
    for (name, patches) in [
        ("as made", vec![one.clone()]),
        ("swapped", vec![one.swapped().unwrap()]),
        ("reversed 1", vec![one.reversed(0).unwrap()]),
        ("reversed 2", vec![one.reversed(1).unwrap()]),
        ("stretched", vec![stretched(&one)]),
        ("oblique", vec![sphere(25.0, center, oblique).unwrap()]),
        (
            "six",
            sphere_without_poles(25.0, center, Vec3::y())
                .unwrap()
                .to_vec(),
        ),
        (
            "six oblique",
            sphere_without_poles(25.0, center, oblique)
                .unwrap()
                .to_vec(),
        ),
    ] {
        let other = run(&patches);
        let d = difference(&reference, &other, |_| 1.0);
        println!("{name}: {d:.1e}");
        assert!(d < 1e-8, "{name}: {d}");
        counts.push(other.summary.newton_iterations);
    }
    println!("iterations {counts:?}");
    assert!(
        counts.iter().all(|c| c.abs_diff(counts[0]) <= 2),
        "{counts:?}"
    );
}
