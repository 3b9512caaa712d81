//! Offset surfaces (140): exact where the base is analytic, else within the tolerance that is told.

use super::support::{Entity, GLOBAL, area, entity, iges};
use covact_geometry::io::{CadFile, read_iges};
use covact_geometry::{NurbsPatch, PatchSet, Vec3};
use std::f64::consts::{PI, TAU};

fn read(entities: &[Entity]) -> CadFile {
    let text = iges(GLOBAL, entities);
    read_iges(text.as_bytes(), "hand.igs").unwrap_or_else(|e| panic!("{e}\n{text}"))
}

fn child(type_number: u32, values: &str) -> Entity<'static> {
    Entity {
        status: "00010000",
        ..entity(type_number, values)
    }
}

/// The entities with a status of their own for the first.
fn with_status(base: &[Entity], first: &'static str) -> Vec<Entity<'static>> {
    let copy = |(k, e): (usize, &Entity)| Entity {
        type_number: e.type_number,
        form: e.form,
        matrix: e.matrix,
        status: if k == 0 { first } else { "00010000" },
        label: "",
        values: e.values.clone(),
    };
    base.iter().enumerate().map(copy).collect()
}

/// A file with the offset (entity 1) of a base (entity 3), and one with the base alone.
fn both(base: &[Entity], offset: &str) -> [CadFile; 2] {
    let mut whole = vec![entity(140, offset)];
    whole.extend(with_status(base, "00010000"));
    let mut alone = vec![child(110, "0.,0.,0.,1.,0.,0.")];
    alone.extend(with_status(base, "00000000"));
    [read(&whole), read(&alone)]
}

fn patch(file: &CadFile) -> &NurbsPatch {
    assert_eq!((file.patches.len(), &file.skipped[..]), (1, &[][..]));
    &file.patches[0].patch
}

/// Points of `found` are `distance` from `base`, straight above the points with the same parameters; the largest
/// difference.
fn off(base: &NurbsPatch, found: &NurbsPatch, distance: f64) -> f64 {
    let [[a, b], [c, d]] = base.domain();
    assert_eq!(found.domain(), base.domain());
    let mut worst = 0.0f64;
    for k in 0..400 {
        let [s, t] = [0.618_034, 0.754_878].map(|g| (g * f64::from(k + 1)).fract());
        let xi = [a + (b - a) * s, c + (d - c) * t];
        let jet = base.jet(xi);
        let n = jet.rho_i[0].cross(&jet.rho_i[1]).normalize();
        worst = worst.max((found.point(xi) - jet.rho - n * distance).norm());
    }
    worst
}

#[test]
fn offsets_of_analytic_surfaces_are_exact() {
    let axis = || child(110, "0.,0.,0.,0.,0.,1.");
    let sphere = child(120, &format!("5,7,0.,{TAU:?}"));
    let half = child(100, "0.,0.,0.,0.,-3.,0.,3.");
    let cylinder = [
        child(120, &format!("5,7,0.,{TAU:?}")),
        axis(),
        child(110, "2.,0.,0.,2.,0.,5."),
    ];
    let cone = [
        child(120, &format!("5,7,0.,{TAU:?}")),
        axis(),
        child(110, "2.,0.,0.,4.,0.,2."),
    ];
    let torus = [
        child(120, &format!("5,7,0.,{TAU:?}")),
        child(110, "0.,0.,0.,0.,1.,0."),
        child(100, "0.,5.,0.,6.,0.,6.,0."),
    ];
    let ball = [sphere, child(110, "0.,0.,0.,0.,1.,0."), half];
    let plane = [child(
        128,
        "1,1,1,1,0,0,1,0,0,0.,0.,4.,4.,0.,0.,2.,2.,1.,1.,1.,1.,\
         0.,0.,0.,4.,0.,0.,0.,2.,0.,4.,2.,0.,0.,4.,0.,2.",
    )];
    // Cone: radii grow by cos 45 and shift along the axis by sin 45; the area by the mean radius.
    let d = 0.5;
    let slant = 8f64.sqrt();
    let cone_area = |d: f64| PI * (6.0 + 2.0 * d * 0.5f64.sqrt()) * slant;
    for (what, base, outward, expected) in [
        ("plane", &plane[..], "0.,0.,1.", [8.0, 8.0]),
        (
            "cylinder",
            &cylinder[..],
            "1.,0.,0.",
            [TAU * 2.5 * 5.0, TAU * 1.5 * 5.0],
        ),
        (
            "cone",
            &cone[..],
            "1.,0.,-1.",
            [cone_area(d), cone_area(-d)],
        ),
        (
            "ball",
            &ball[..],
            "-1.,0.,0.",
            [4.0 * PI * 3.5 * 3.5, 4.0 * PI * 2.5 * 2.5],
        ),
        (
            "torus",
            &torus[..],
            "1.,0.,0.",
            [TAU * TAU * 5.0 * 1.5, TAU * TAU * 5.0 * 0.5],
        ),
    ] {
        for (k, distance) in [d, -d].into_iter().enumerate() {
            let [file, alone] = both(base, &format!("{outward},{distance:?},3"));
            let (found, plain) = (patch(&file), patch(&alone));
            assert_eq!(found.counts(), plain.counts(), "{what}");
            let error = off(plain, found, d).min(off(plain, found, -d));
            assert!(error < 1e-13 * 10.0, "{what}: {error}");
            let area = area(found);
            assert!(
                (area / expected[k] - 1.0).abs() < 1e-9,
                "{what} {distance}: {area}"
            );
            assert!(
                !file.notes.iter().any(|n| n.contains("differs")),
                "{:?}",
                file.notes
            );
        }
    }
}

/// A bicubic patch with a hill, of which no point has a radius of curvature below 2.
fn hill() -> Entity<'static> {
    let mut points = Vec::new();
    for j in 0..4 {
        for i in 0..4 {
            let inner = (1..3).contains(&i) && (1..3).contains(&j);
            let z = if inner { 1.0 } else { 0.1 * f64::from(i) };
            points.push(format!(
                "{:?},{:?},{z:?}",
                2.0 * f64::from(i),
                1.5 * f64::from(j)
            ));
        }
    }
    child(
        128,
        &format!(
            "3,3,3,3,0,0,1,0,0,0.,0.,0.,0.,1.,1.,1.,1.,0.,0.,0.,0.,1.,1.,1.,1.,{},{},0.,1.,0.,1.",
            vec!["1."; 16].join(","),
            points.join(",")
        ),
    )
}

#[test]
fn offsets_of_splines_keep_the_tolerance_that_is_told() {
    for distance in [0.4, -0.4] {
        let [file, alone] = both(&[hill()], &format!("0.,0.,1.,{distance:?},3"));
        let (found, plain) = (patch(&file), patch(&alone));
        let [low, high] = plain.bounds();
        let tolerance = 1e-6 * ((high - low).norm() + 0.4);
        let error = off(plain, found, distance);
        assert!(
            error < 2.0 * tolerance && error > 1e-13,
            "{error} of {tolerance}"
        );
        assert!(found.counts()[0] < 60, "{:?}", found.counts());
        let told = file.notes.iter().find(|n| n.contains("differs by up to"));
        assert!(
            told.is_some_and(|n| n.contains("entity 1 (140")),
            "{:?}",
            file.notes
        );
        // As distances, too: the base is nowhere nearer.
        let set = PatchSet::new(vec![plain.clone()], None).unwrap();
        for xi in [[0.3, 0.4], [0.5, 0.5], [0.8, 0.7]] {
            let foot = set.project(&found.point(xi), None, f64::INFINITY).unwrap();
            assert!(
                (foot.distance - 0.4).abs() < 2.0 * tolerance,
                "{}",
                foot.distance
            );
        }
    }
}

#[test]
fn what_cannot_be_offset_is_named() {
    let refused = |base: &[Entity], offset: &str, part: &str| {
        let mut entities = vec![entity(140, offset)];
        entities.extend(with_status(base, "00010000"));
        let file = read(&entities);
        let [skipped] = &file.skipped[..] else {
            panic!("{part}: {:?}", file.skipped);
        };
        assert!(
            skipped.reason.contains(part),
            "no {part} in {}",
            skipped.reason
        );
    };
    // Beyond the radius of a hollow ball.
    let ball = [
        child(120, &format!("5,7,0.,{TAU:?}")),
        child(110, "0.,0.,0.,0.,1.,0."),
        child(100, "0.,0.,0.,0.,-3.,0.,3."),
    ];
    refused(
        &ball,
        "1.,0.,0.,3.5,3",
        "larger than its radius of curvature",
    );
    refused(&[hill()], "0.,0.,0.,0.4,3", "does not say on which side");
    // Two planes at an angle in one surface.
    let roof = child(
        128,
        "2,1,1,1,0,0,1,0,0,0.,0.,1.,2.,2.,0.,0.,1.,1.,1.,1.,1.,1.,1.,1.,\
         0.,0.,0.,1.,0.,1.,2.,0.,0.,0.,1.,0.,1.,1.,1.,2.,1.,0.,0.,2.,0.,1.",
    );
    refused(&[roof], "0.,0.,1.,0.1,3", "crease");
    refused(
        &[child(140, "0.,0.,1.,0.1,5"), hill()],
        "0.,0.,1.,0.1,3",
        "offsets of offset surfaces",
    );
}

/// A face (144) on an offset has the parameters of the base.
#[test]
fn faces_on_offsets_have_the_parameters_of_the_base() {
    let file = read(&[
        entity(144, "3,1,0,5"),
        child(140, "1.,0.,0.,1.,7"),
        child(142, "0,3,13,0,1"),
        child(120, &format!("9,11,0.,{TAU:?}")),
        child(110, "0.,0.,0.,0.,0.,1."),
        child(110, "2.,0.,0.,2.,0.,5."),
        child(102, "4,15,17,19,21"),
        child(110, "0.2,1.,0.,0.6,1.,0."),
        child(110, "0.6,1.,0.,0.6,2.,0."),
        child(110, "0.6,2.,0.,0.2,2.,0."),
        child(110, "0.2,2.,0.,0.2,1.,0."),
    ]);
    // A radian of radius 3 over 0.4 of the height 5.
    let found = patch(&file);
    assert!((area(found) / 6.0 - 1.0).abs() < 1e-9, "{}", area(found));
    let middle = found.domain().map(|[a, b]| 0.5 * (a + b));
    let x: Vec3 = found.point(middle);
    assert!((x.x.hypot(x.y) - 3.0).abs() < 1e-12 && (x.z - 2.0).abs() < 1e-9);
}
