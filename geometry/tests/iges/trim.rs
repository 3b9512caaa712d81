//! Faces with boundaries in small IGES files written by hand, with areas known in closed form.

use crate::areas::trimmed_area;
use crate::support::{Entity, GLOBAL, bilinear, entity, iges};
use covact_geometry::io::{CadFile, FaceBorder, SkipKind, read_iges, read_path};
use covact_geometry::{PatchSet, Vec3};
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

/// A flat 128 over [0, 4] x [0, 2] with these as parameters.
const FLAT: &str = "1,1,1,1,0,0,1,0,0,0.,0.,4.,4.,0.,0.,2.,2.,1.,1.,1.,1.,\
                    0.,0.,0.,4.,0.,0.,0.,2.,0.,4.,2.,0.,0.,4.,0.,2.";

/// A cylinder of radius 2 about z between z = 0 and z = 5: a 120 (entity 1) with axis (3) and generatrix (5). Its
/// parameters are the share of the height, and the angle.
fn cylinder() -> [Entity<'static>; 3] {
    [
        child(120, &format!("3,5,0.,{TAU}")),
        child(110, "0.,0.,0.,0.,0.,1."),
        child(110, "2.,0.,0.,2.,0.,5."),
    ]
}

/// The only patch, and its area.
fn single(file: &CadFile) -> f64 {
    assert_eq!(
        (file.patches.len(), &file.skipped[..]),
        (1, &[][..]),
        "{:?}",
        file.notes
    );
    let patch = &file.patches[0].patch;
    let set = PatchSet::new(vec![patch.clone()], None).unwrap();
    // Distances are finite, and points of the surface that are left have none.
    for k in 0..20 {
        let a = f64::from(k);
        let q = Vec3::new(
            4.0 * (a * 0.7).sin(),
            3.0 * (a * 1.3).cos(),
            2.0 + 4.0 * (a * 0.31).sin(),
        );
        let foot = set.project(&q, None, f64::INFINITY).unwrap();
        assert!(foot.signed_distance.is_finite());
        let trim = patch.trim();
        if let Some(trim) = trim {
            assert!(
                trim.contains(foot.xi) || trim.on_border(foot.xi, 1e-6),
                "{:?}",
                foot.xi
            );
        }
        let back = set.project(&foot.jet.rho, None, f64::INFINITY).unwrap();
        assert!(back.distance < 1e-9, "{}", back.distance);
    }
    trimmed_area(patch)
}

fn near(found: f64, expected: f64, tolerance: f64) {
    assert!(
        (found / expected - 1.0).abs() < tolerance,
        "{found}, not {expected}"
    );
}

/// A triangle of lines in a composite curve, in the parameter plane and in space.
#[test]
fn polygon_with_curves_in_both_spaces() {
    let file = read(&[
        entity(144, "3,1,0,5"),
        child(128, FLAT),
        child(142, "0,3,7,9,1"),
        child(102, "3,11,13,15"),
        child(102, "3,17,19,21"),
        child(110, "1.,.5,0.,3.,.5,0."),
        child(110, "3.,.5,0.,1.,1.5,0."),
        child(110, "1.,1.5,0.,1.,.5,0."),
        child(110, "1.,.5,0.,3.,.5,0."),
        child(110, "3.,.5,0.,1.,1.5,0."),
        child(110, "1.,1.5,0.,1.,.5,0."),
    ]);
    near(single(&file), 1.0, 1e-12);
    let patch = &file.patches[0];
    assert_eq!(
        (patch.border, patch.base, patch.trimmed()),
        (FaceBorder::Trimmed, 3, true)
    );
    let curves = &patch.patch.trim().unwrap().loops()[0].curves;
    let entities: Vec<u32> = curves.iter().map(|c| c.entity).collect();
    assert_eq!(entities, [17, 19, 21]);
    assert!(curves.iter().all(|c| c.space.is_some()));
    assert_eq!((file.trims.exact, file.trims.projected), (3, 0));
}

/// BPTR = 0: a circle in space on a plane, as outer border and as a hole in the natural border. No approximation.
#[test]
fn space_circle_on_a_plane() {
    for (face, area) in [("3,1,0,5", 0.64 * PI), ("3,0,1,0,5", 8.0 - 0.64 * PI)] {
        let file = read(&[
            entity(144, face),
            child(128, FLAT),
            child(142, "0,3,0,7,2"),
            child(100, "0.,2.,1.,2.8,1.,2.8,1."),
        ]);
        // The tests' quadrature along the circle converges to about 1e-9.
        near(single(&file), area, 1e-8);
        assert_eq!((file.trims.projected, file.trims.largest_error), (1, 0.0));
        assert!(file.trims.largest_gap < 1e-14);
    }
}

/// A curve in the parameter plane that is not where the curve in space is: told, and the curve in space counts.
#[test]
fn parameter_curve_that_disagrees() {
    let file = read(&[
        entity(144, "3,1,0,5"),
        child(128, FLAT),
        child(142, "0,3,9,7,1"),
        child(100, "0.,2.,1.,2.8,1.,2.8,1."),
        child(100, "0.,2.,1.1,2.8,1.1,2.8,1.1"),
    ]);
    near(single(&file), 0.64 * PI, 1e-8);
    assert_eq!((file.trims.rejected, file.trims.projected), (1, 1));
    assert!(
        file.notes
            .iter()
            .any(|n| n.contains("which were projected")),
        "{:?}",
        file.notes
    );
}

/// The rational quadratic circle of radius 2 with z = height + slope x, a 126.
fn slanted_circle(height: f64, slope: f64) -> String {
    let w = 0.5f64.sqrt();
    let corners = [
        (1, 0),
        (1, 1),
        (0, 1),
        (-1, 1),
        (-1, 0),
        (-1, -1),
        (0, -1),
        (1, -1),
        (1, 0),
    ];
    let knots = "0.,0.,0.,.25,.25,.5,.5,.75,.75,1.,1.,1.";
    let weights: Vec<String> = (0..9)
        .map(|k| (if k % 2 == 0 { 1.0 } else { w }).to_string())
        .collect();
    let points = corners.map(|(x, y)| {
        let (x, y) = (2.0 * f64::from(x), 2.0 * f64::from(y));
        format!("{x},{y},{}", height + slope * x)
    });
    format!(
        "8,2,0,1,0,0,{knots},{},{},0.,1.,0.,0.,0.",
        weights.join(","),
        points.join(",")
    )
}

/// A cylinder between two slanted planes, bounded by two closed space curves that go round it, as 143 over 141 without
/// curves in the parameter plane. The area is the mean height times the circumference.
#[test]
fn loops_round_a_cylinder_are_projected_and_joined() {
    let [surface, axis, generatrix] = cylinder();
    let file = read(&[
        surface,
        axis,
        generatrix,
        entity(143, "0,1,2,9,11"),
        child(141, "0,2,1,1,13,1,0"),
        child(141, "0,2,1,1,15,2,0"),
        child(126, &slanted_circle(1.0, 0.25)),
        child(126, &slanted_circle(4.0, -0.4)),
    ]);
    near(single(&file), 3.0 * 2.0 * TAU, 1e-6);
    assert_eq!(file.trims.projected, 2);
    // Fitted to 1e-7 of the size of the cylinder.
    assert!(
        file.trims.largest_error < 1e-6,
        "{}",
        file.trims.largest_error
    );
    assert!(file.trims.largest_gap < 1e-9, "{}", file.trims.largest_gap);
}

/// Radius of the ball in [`sector`].
const BALL: f64 = 7.0;

/// A face of a ball: a 120 over a half circle that begins at one pole. The face reaches from the equator to the other pole
/// and turns from angle `a` to `b`; its boundary runs along the equator, down to the pole and back from it, or the other
/// way round. The curves in the parameter plane count the angle of the half circle from its start, as one writer does,
/// so that those in space are projected.
fn sector([a, b]: [f64; 2], backwards: bool) -> CadFile {
    let r = BALL;
    let at = |v: f64, y: f64| [-r * v.cos(), y, -r * v.sin()];
    let meridian = |v: f64, up: bool| {
        let mut points = [at(v, 0.0), at(v, -r), [0.0, -r, 0.0]];
        if up {
            points.reverse();
        }
        let [p, q, s] = points.map(|p| p.map(|x| format!("{x:?}")).join(","));
        let w = 0.5f64.sqrt();
        child(
            126,
            &format!("2,2,0,0,0,0,0.,0.,0.,1.,1.,1.,1.,{w:?},1.,{p},{q},{s},0.,1.,0.,0.,0."),
        )
    };
    // Angles grow with v in the plane of x and z; halves, as an arc that closes would be a full circle.
    let arc = |a: f64, b: f64| {
        let end = |v: f64| format!("{:?},{:?}", -r * v.cos(), -r * v.sin());
        Entity {
            matrix: 21,
            ..child(100, &format!("0.,0.,0.,{},{}", end(a), end(b)))
        }
    };
    let line = |p: [f64; 2], q: [f64; 2]| {
        child(
            110,
            &format!("{:?},{:?},0.,{:?},{:?},0.", p[0], p[1], q[0], q[1]),
        )
    };
    let (m, u) = (0.5 * (a + b), [PI / 2.0, PI]);
    let mut corners = [[u[0], m], [u[0], b], [u[1], b], [u[1], a], [u[0], a]];
    let mut entities = vec![
        entity(144, "3,1,0,5"),
        child(120, &format!("7,9,0.,{TAU:?}")),
        child(142, "1,3,11,13,1"),
        child(110, "0.,0.,0.,0.,-7.,0."),
        child(100, "0.,0.,0.,0.,7.,0.,-7."),
        child(102, "5,23,25,27,29,31"),
        child(102, "4,33,35,37,39"),
        child(110, "0.,0.,0.,1.,0.,0."),
        child(110, "0.,0.,0.,1.,0.,0."),
        child(110, "0.,0.,0.,1.,0.,0."),
        child(124, "1.,0.,0.,0.,0.,0.,-1.,0.,0.,1.,0.,0."),
    ];
    let space = [arc(m, b), meridian(b, false), meridian(a, true), arc(a, m)];
    if backwards {
        corners.reverse();
        corners.rotate_left(4);
        // Arcs run counterclockwise only: turned about the x axis they run the other way.
        let turned = |from: f64, to: f64| {
            let end = |v: f64| format!("{:?},{:?}", -r * v.cos(), r * v.sin());
            Entity {
                matrix: 15,
                ..child(100, &format!("0.,0.,0.,{},{}", end(from), end(to)))
            }
        };
        entities[7] = child(124, "1.,0.,0.,0.,0.,0.,1.,0.,0.,-1.,0.,0.");
        entities.extend((0..5).map(|k| line(corners[k], corners[(k + 1) % 5])));
        entities.extend([
            turned(m, a),
            meridian(a, false),
            meridian(b, true),
            turned(b, m),
        ]);
    } else {
        entities.extend((0..5).map(|k| line(corners[k], corners[(k + 1) % 5])));
        entities.extend(space);
    }
    read(&entities)
}

/// Loops that go to a pole along the seam and leave it at any angle bound the part of the ball between the two angles, not
/// the rest of it, whichever way they run.
#[test]
fn loops_through_pole_and_seam_bound_their_inside() {
    let [q, h] = [PI / 2.0, PI];
    for range in [
        [h, TAU],
        [q, TAU],
        [0.0, h],
        [0.0, h + q],
        [h, h + q],
        [1.0, 5.0],
    ] {
        for backwards in [false, true] {
            let file = sector(range, backwards);
            let area = (range[1] - range[0]) * BALL * BALL;
            near(single(&file), area, 1e-5);
            assert_eq!((file.trims.rejected, file.trims.projected), (1, 4));
            let set = PatchSet::new(vec![file.patches[0].patch.clone()], None).unwrap();
            assert_eq!(set.volumes(), [None], "{range:?} {backwards}");
        }
    }
}

/// A hole across the seam of a cylinder, given in the parameter plane where angles are not the patch's parameter: a circle
/// about angle 0.
#[test]
fn hole_across_the_seam() {
    let [surface, axis, generatrix] = cylinder();
    let file = read(&[
        surface,
        axis,
        generatrix,
        entity(144, "1,0,1,0,9"),
        child(142, "0,1,11,0,1"),
        child(100, "0.,.5,0.,.8,0.,.8,0."),
    ]);
    near(single(&file), 5.0 * 2.0 * TAU - PI * 0.09 * 5.0 * 2.0, 1e-6);
    assert_eq!((file.trims.refitted, file.trims.exact), (1, 0));
}

/// Boundaries that cannot be read: the face is skipped and named, never read without them.
#[test]
fn faces_without_usable_boundaries_are_skipped() {
    for (entities, reason) in [
        (
            vec![entity(144, "3,1,0,5"), child(128, FLAT), child(126, "0")],
            "neither a curve on a surface (142) nor a boundary (141)",
        ),
        (
            vec![
                entity(144, "3,1,0,5"),
                child(128, FLAT),
                child(142, "0,3,0,7,2"),
                child(110, "1.,1.,0.,3.,1.,0."),
            ],
            "is open",
        ),
        (
            vec![
                entity(144, "3,1,0,5"),
                child(128, FLAT),
                child(142, "0,3,0,7,2"),
                child(100, "3.,2.,1.,2.8,1.,2.8,1."),
            ],
            "off the surface",
        ),
        (
            vec![
                entity(144, "3,1,0,5"),
                child(128, FLAT),
                child(142, "0,3,0,0,0"),
            ],
            "neither a curve in the parameter plane nor one in space",
        ),
    ] {
        let file = read(&entities);
        assert_eq!((file.patches.len(), file.skipped.len()), (0, 1));
        let skipped = &file.skipped[0];
        assert_eq!((skipped.entity, skipped.kind), (1, SkipKind::Boundary));
        assert!(skipped.reason.contains(reason), "{}", skipped.reason);
        assert_eq!(file.summary().reasons, [(SkipKind::Boundary, 1)]);
    }
}

/// A subfigure placed twice inside of another that is placed once, with a scale: two copies.
#[test]
fn subfigures_are_placed() {
    let file = read(&[
        child(128, &bilinear()),
        entity(308, "0,4Hpart,1,1"),
        child(408, "3,10.,0.,0.,2."),
        child(408, "3,0.,10.,0."),
        entity(308, "1,5Hgroup,2,5,7"),
        entity(408, "9,0.,0.,100.,1."),
    ]);
    assert_eq!(
        (file.patches.len(), file.skipped.len()),
        (2, 0),
        "{:?}",
        file.skipped
    );
    let far: Vec<Vec3> = file
        .patches
        .iter()
        .map(|p| p.patch.point([1.0, 1.0]))
        .collect();
    assert_eq!(
        far,
        [Vec3::new(14.0, 2.0, 102.0), Vec3::new(2.0, 11.0, 101.0)]
    );
    assert!(
        file.patches
            .iter()
            .all(|p| (p.entity, p.instance) == (1, 11))
    );
    // Hidden instances place nothing that is seen.
    let hidden = Entity {
        status: "01000000",
        ..entity(408, "3,0.,0.,0.,1.")
    };
    let file = read(&[child(128, &bilinear()), entity(308, "0,4Hpart,1,1"), hidden]);
    assert_eq!(file.skipped[0].kind, SkipKind::Blanked);
    // A subfigure in itself.
    let text = iges(
        GLOBAL,
        &[
            child(128, &bilinear()),
            entity(308, "0,4Hpart,2,1,5"),
            entity(408, "3,0.,0.,0.,1."),
        ],
    );
    let message = read_iges(text.as_bytes(), "f").unwrap_err().to_string();
    assert!(message.contains("not in themselves"), "{message}");
    // Instances of instances that would make 2^20 copies.
    let mut entities = vec![child(128, &bilinear()), entity(308, "0,1Hp,1,1")];
    for k in 0..20 {
        let (below, first) = (4 * k + 3 + 2 * k, 2 * entities.len() + 1);
        entities.push(child(408, &format!("{below},0.,0.,0.,1.")));
        entities.push(child(408, &format!("{below},1.,0.,0.,1.")));
        entities.push(entity(308, &format!("0,1Hp,2,{first},{}", first + 2)));
    }
    let last = 2 * entities.len() - 1;
    entities.push(entity(408, &format!("{last},0.,0.,0.,1.")));
    let text = iges(GLOBAL, &entities);
    let message = read_iges(text.as_bytes(), "f").unwrap_err().to_string();
    assert!(message.contains("fewer copies"), "{message}");
}

/// What is no CAD file is named, with the formats that are read.
#[test]
fn files_of_other_kinds_are_named() {
    let path = std::env::temp_dir().join(format!("covact-{}.igs", std::process::id()));
    std::fs::write(&path, "a\0b").unwrap();
    let message = read_path(&path).unwrap_err().to_string();
    std::fs::remove_file(&path).unwrap();
    for word in ["binary data", "STEP", "IGES", "JSON"] {
        assert!(message.contains(word), "{message}");
    }
}
