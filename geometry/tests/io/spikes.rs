//! Boundary curves that run back along each other, and curves in space that run at uneven speed beside those in the
//! parameter plane.

use super::support::{Entity, GLOBAL, child, entity, flat, iges, line};
use covact_geometry::io::{CadFile, CadSurface, read_iges};
use covact_geometry::{Location, Vec3};

fn read(entities: &[Entity]) -> CadFile {
    let text = iges(GLOBAL, entities);
    let file = read_iges(text.as_bytes(), "hand.igs").unwrap_or_else(|e| panic!("{e}\n{text}"));
    assert_eq!(file.skipped, [], "{:?}", file.notes);
    file
}

/// A face on the plane [0, 2] x [0, 2] bounded by curves in its parameter plane.
fn face(curves: Vec<Entity<'static>>) -> CadFile {
    let numbers: Vec<String> = (0..curves.len()).map(|k| (9 + 2 * k).to_string()).collect();
    let mut entities = vec![
        entity(144, "3,1,0,5"),
        child(128, &flat(2.0, 2.0)),
        child(142, "0,3,7,0,1"),
        child(102, &format!("{},{}", curves.len(), numbers.join(","))),
    ];
    entities.extend(curves);
    read(&entities)
}

/// A cubic of the parameter plane whose inner control points leave the straight line between its ends by `off`.
fn bent(from: [f64; 2], to: [f64; 2], off: f64) -> Entity<'static> {
    let at = |s: f64| [0, 1].map(|k| from[k] + s * (to[k] - from[k]));
    let [a, b] = [at(1.0 / 3.0), at(2.0 / 3.0)];
    let points = [from, [a[0] - off, a[1]], [b[0] - off, b[1]], to];
    let points: Vec<String> = (points.iter())
        .map(|[x, y]| format!("{x:?},{y:?},0."))
        .collect();
    let knots = "0.,0.,0.,0.,1.,1.,1.,1.,1.,1.,1.,1.";
    child(
        126,
        &format!("3,3,1,0,1,0,{knots},{},0.,1.,0.,0.,1.", points.join(",")),
    )
}

fn area(surface: &CadSurface) -> f64 {
    surface.set().areas()[0]
}

/// A triangle whose side along the border of the surface runs on past its corner and back, as in CATIA's
/// `CTS17806-38038.igs` by a curve that is no straight line to the last digit.
#[test]
fn what_runs_there_and_back_is_no_edge() {
    let corners = [[0.5, 0.5], [2.0, 0.5], [2.0, 1.2]];
    let tip = [2.0, 1.5];
    for off in [0.0, 2e-7] {
        for backwards in [false, true] {
            let mut curves = vec![
                line(corners[0], corners[1]),
                line(corners[1], tip),
                bent(tip, corners[2], off),
                line(corners[2], corners[0]),
            ];
            if backwards {
                curves = vec![
                    line(corners[0], corners[2]),
                    bent(corners[2], tip, off),
                    line(tip, corners[1]),
                    line(corners[1], corners[0]),
                ];
            }
            let file = face(curves);
            let told = "runs there and back over a length of 3.0e-1";
            assert!(
                file.notes.iter().any(|n| n.contains(told)),
                "{:?}",
                file.notes
            );
            let surface = file.into_surface().unwrap();
            let trim = surface.set().patches()[0].trim().unwrap();
            assert_eq!(trim.loops()[0].curves.len(), 3);
            assert!((area(&surface) - 0.5 * 1.5 * 0.7).abs() < 1e-12);
            // Above where the spike was, the corner is nearest.
            let q = Vec3::new(1.9, 1.5, 0.3);
            let foot = surface.closest(&q).unwrap();
            assert!((foot.jet.rho - Vec3::new(2.0, 1.2, 0.0)).norm() < 1e-12);
            assert!((foot.distance - (0.01 + 0.09 + 0.09f64).sqrt()).abs() < 1e-12);
            assert!(
                matches!(foot.location, Location::Corner { .. }),
                "{:?}",
                foot.location
            );
            assert!((foot.signed_distance.abs() - foot.distance).abs() < 1e-12);
        }
    }
}

/// A spike of several curves goes with all of them, and what only comes near is kept.
#[test]
fn spikes_of_several_curves_and_what_is_none() {
    // Out to (2, 1.8) in two steps and back in three.
    let file = face(vec![
        line([0.5, 0.5], [2.0, 0.5]),
        line([2.0, 0.5], [2.0, 1.2]),
        line([2.0, 1.2], [2.0, 1.5]),
        line([2.0, 1.5], [2.0, 1.8]),
        line([2.0, 1.8], [2.0, 1.7]),
        line([2.0, 1.7], [2.0, 1.4]),
        line([2.0, 1.4], [2.0, 1.2]),
        line([2.0, 1.2], [0.5, 0.5]),
    ]);
    let surface = file.into_surface().unwrap();
    assert!((area(&surface) - 0.5 * 1.5 * 0.7).abs() < 1e-12);
    assert_eq!(
        surface.set().patches()[0].trim().unwrap().loops()[0]
            .curves
            .len(),
        3
    );
    // A corner of a hundredth of a degree is one.
    let thin = 1.5 * 1.7e-4;
    let file = face(vec![
        line([0.5, 0.5], [2.0, 0.5]),
        line([2.0, 0.5], [0.5, 0.5 + thin]),
        line([0.5, 0.5 + thin], [0.5, 0.5]),
    ]);
    assert_eq!(file.notes, [""; 0]);
    let surface = file.into_surface().unwrap();
    assert!((area(&surface) / (0.5 * 1.5 * thin) - 1.0).abs() < 1e-9);
}

/// A spline 126 along y = 0.2 through points x.
fn level(degree: usize, knots: &[f64], x: &[f64], y: impl Fn(f64) -> f64) -> Entity<'static> {
    let points: Vec<String> = (x.iter())
        .map(|&x| format!("{x:?},{:?},0.", y(x)))
        .collect();
    let end = knots[knots.len() - 1];
    let knots: Vec<String> = knots.iter().map(|k| format!("{k:?}")).collect();
    let values = format!(
        "{},{degree},1,0,1,0,{},{},{},0.,{end:?},0.,0.,1.",
        x.len() - 1,
        knots.join(","),
        vec!["1."; x.len()].join(","),
        points.join(",")
    );
    child(126, &values)
}

/// A polyline of eighty sides over x from `a` to `b`.
fn dense(a: f64, b: f64, y: impl Fn(f64) -> f64) -> Entity<'static> {
    let x: Vec<f64> = (0..=80)
        .map(|k| a + (b - a) * f64::from(k) / 80.0)
        .collect();
    let mut knots = vec![0.0];
    knots.extend((0..=80).map(f64::from));
    knots.push(80.0);
    level(1, &knots, &x, y)
}

/// A face with the three curves in the parameter plane and in space, which agree to the last digits.
fn alike(plane: [Entity<'static>; 3], space: [Entity<'static>; 3]) {
    let mut entities = vec![
        entity(144, "3,1,0,5"),
        child(128, &flat(2.0, 2.0)),
        child(142, "0,3,7,15,0"),
        child(102, "3,9,11,13"),
    ];
    entities.extend(plane);
    entities.push(child(102, "3,17,19,21"));
    entities.extend(space);
    let file = read(&entities);
    assert_eq!(file.notes, [""; 0]);
    assert_eq!((file.trims.exact, file.trims.rejected), (3, 0));
    assert!(file.trims.largest_gap < 1e-12, "{}", file.trims.largest_gap);
}

/// In space the lowest side of a triangle is a cubic of three spans, the middle one a hundred times as slow as the others; in
/// the parameter plane it has many spans, as CATIA writes them.
#[test]
fn speed_makes_no_gap_between_both_kinds_of_curves() {
    let x = [0.2, 0.35, 0.6, 1.0, 1.002, 1.004, 1.006, 1.3, 1.6, 1.8];
    let knots = [0., 0., 0., 0., 1., 1., 1., 2., 2., 2., 3., 3., 3., 3.];
    let sides = [[0.2, 0.2], [1.8, 0.2], [0.2, 1.8]];
    let other = |k: usize| line(sides[k], sides[(k + 1) % 3]);
    let bottom = |_| 0.2;
    alike(
        [dense(0.2, 1.8, bottom), other(1), other(2)],
        [level(3, &knots, &x, bottom), other(1), other(2)],
    );
}

/// Two sides of a triangle leave their corner at a small angle: of the points looked at on the curves in space the nearest
/// one lies on the other side.
#[test]
fn narrow_corners_make_no_gap_between_both_kinds_of_curves() {
    let sides = [[0.2, 0.2], [1.8, 0.2], [1.8, 0.25]];
    let own = |k: usize| line(sides[k], sides[(k + 1) % 3]);
    let top = |x: f64| 0.2 + (x - 0.2) / 32.0;
    alike(
        [own(0), own(1), dense(1.8, 0.2, top)],
        [dense(0.2, 1.8, |_| 0.2), own(1), own(2)],
    );
}
