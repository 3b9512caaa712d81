//! Joints, components, sides and reports of patch sets.

use covact_geometry::primitives::{cylinder, plane, sphere, sphere_without_poles, torus};
use covact_geometry::project::{PatchSetError, SideError, SideOutcome};
use covact_geometry::{EdgeKind, Location, NurbsPatch, PatchSet, Vec3};

/// Flat or curved bilinear patch of four corners, xi1 fastest.
fn quad(corners: [[f64; 3]; 4]) -> NurbsPatch {
    let knots = vec![0.0, 0.0, 1.0, 1.0];
    let points = corners.map(Vec3::from);
    NurbsPatch::new([1; 2], [knots.clone(), knots], [2; 2], &points, None).unwrap()
}

/// Cube [-1, 1]^3; every other face has its parametrisation turned over.
fn cube() -> Vec<NurbsPatch> {
    let mut faces = Vec::new();
    for axis in 0..3 {
        for end in [-1.0, 1.0] {
            let corner = |a: f64, b: f64| {
                let mut p = [0.0; 3];
                p[axis] = end;
                p[(axis + 1) % 3] = a;
                p[(axis + 2) % 3] = b;
                p
            };
            faces.push(quad([
                corner(-1.0, -1.0),
                corner(1.0, -1.0),
                corner(-1.0, 1.0),
                corner(1.0, 1.0),
            ]));
        }
    }
    faces
}

fn foot(set: &PatchSet, x: f64, y: f64, z: f64) -> covact_geometry::Foot {
    set.project(&Vec3::new(x, y, z), None, f64::INFINITY)
        .unwrap()
}

#[test]
fn cube_is_closed_and_signed() {
    let mut set = PatchSet::new(cube(), None).unwrap();
    let report = set.edges();
    assert_eq!((report.sharp, report.smooth, report.free.len()), (12, 0, 0));
    assert_eq!(set.components().len(), 1);
    let sides = set.orient_towards(&[Vec3::new(0.2, 0.1, 3.0)]).unwrap();
    assert_eq!(
        sides[0].outcome,
        SideOutcome::Decided {
            votes: 1,
            ignored: 0
        }
    );
    // Every face has its normal outward now.
    for (patch, side) in set.patches().iter().zip(set.sides()) {
        let jet = patch.jet([0.5, 0.5]);
        assert!(jet.rho_i[0].cross(&jet.rho_i[1]).dot(&jet.rho) * side > 0.0);
    }
    let edge = foot(&set, 2.0, 2.0, 0.3);
    assert!(matches!(
        edge.location,
        Location::Edge {
            kind: EdgeKind::Sharp,
            ..
        }
    ));
    assert!((edge.normal - Vec3::new(1.0, 1.0, 0.0).normalize()).norm() < 1e-14);
    assert!((edge.signed_distance - 2f64.sqrt()).abs() < 1e-14);
    let corner = foot(&set, 2.0, -2.0, 2.0);
    assert!(matches!(
        corner.location,
        Location::Corner {
            kind: EdgeKind::Sharp,
            ..
        }
    ));
    assert!((corner.normal - Vec3::new(1.0, -1.0, 1.0).normalize()).norm() < 1e-14);
    assert!((corner.signed_distance - 3f64.sqrt()).abs() < 1e-14);
    let inside = foot(&set, 0.9, 0.3, -0.2);
    assert_eq!(inside.location, Location::Face);
    assert!((inside.signed_distance + 0.1).abs() < 1e-14);
    assert!((set.areas().iter().sum::<f64>() - 24.0).abs() < 1e-12);
    // From inside the other way round.
    let sides = set.orient_towards(&[Vec3::new(0.9, 0.1, 0.2)]).unwrap();
    assert_eq!(sides.len(), 1);
    assert!(foot(&set, 0.9, 0.3, -0.2).signed_distance > 0.0);
}

#[test]
fn seams_and_poles() {
    let ball = PatchSet::new(vec![sphere(2.0, Vec3::zeros(), Vec3::z()).unwrap()], None).unwrap();
    let report = ball.edges();
    assert_eq!((report.smooth, report.sharp, report.free.len()), (1, 0, 0));
    assert_eq!(report.poles, [(0, 2), (0, 3)]);
    let range = ball.curvature_range();
    let convex = range.convex.unwrap();
    assert!((convex.kappa + 0.5).abs() < 1e-8 && range.concave.is_none() && range.skipped > 0);
    assert!((convex.radius() - 2.0).abs() < 1e-7);

    let pipe = PatchSet::new(
        vec![cylinder(1.0, 3.0, Vec3::zeros(), Vec3::z()).unwrap()],
        None,
    )
    .unwrap();
    let report = pipe.edges();
    assert_eq!((report.smooth, report.free.len()), (1, 2));
    assert_eq!(report.joints[0].edges, [(0, 0), (0, 1)]);
    assert!(!report.joints[0].reversed);

    let ring = torus(3.0, 1.0, Vec3::zeros(), Vec3::z()).unwrap();
    let ring = PatchSet::new(vec![ring], None).unwrap();
    assert_eq!((ring.edges().smooth, ring.edges().free.len()), (2, 0));
    let range = ring.curvature_range();
    assert!((range.convex.unwrap().kappa + 1.0).abs() < 1e-9);
    assert!((range.concave.unwrap().kappa - 0.5).abs() < 1e-9);

    let six = sphere_without_poles(2.0, Vec3::zeros(), Vec3::z()).unwrap();
    let six = PatchSet::new(six.to_vec(), None).unwrap();
    assert_eq!((six.edges().smooth, six.edges().sharp), (12, 0));
    assert_eq!((six.edges().free.len(), six.components().len()), (0, 1));
}

#[test]
fn feet_on_smooth_joints_are_face_feet() {
    let ball = PatchSet::new(vec![sphere(2.0, Vec3::zeros(), Vec3::z()).unwrap()], None).unwrap();
    let seam = foot(&ball, 3.0, 0.0, 0.5);
    assert_eq!(seam.location, Location::Face);
    let pole = foot(&ball, 0.0, 0.0, 3.0);
    assert!((pole.normal - Vec3::z()).norm() < 1e-6);
    assert!((pole.signed_distance - 1.0).abs() < 1e-14);
    let six = sphere_without_poles(2.0, Vec3::zeros(), Vec3::z()).unwrap();
    let six = PatchSet::new(six.to_vec(), None).unwrap();
    for q in [[2.0, 2.0, 0.3], [2.0, 2.0, 2.0], [0.0, -3.0, 3.0]] {
        let foot = foot(&six, q[0], q[1], q[2]);
        assert_eq!(foot.location, Location::Face);
        assert!((foot.normal.cross(&Vec3::from(q).normalize())).norm() < 1e-12);
    }
}

#[test]
fn moebius_strip_is_refused() {
    let knots = vec![0.0, 0.0, 1.0, 1.0];
    let mut patches = Vec::new();
    let point = |k: usize, end: f64| {
        let angle = std::f64::consts::TAU * k as f64 / 8.0;
        let r = 2.0 + end * 0.5 * (0.5 * angle).cos();
        Vec3::new(
            r * angle.cos(),
            r * angle.sin(),
            end * 0.5 * (0.5 * angle).sin(),
        )
    };
    for k in 0..8 {
        let points = [
            point(k, -1.0),
            point(k + 1, -1.0),
            point(k, 1.0),
            point(k + 1, 1.0),
        ];
        patches.push(
            NurbsPatch::new(
                [1; 2],
                [knots.clone(), knots.clone()],
                [2; 2],
                &points,
                None,
            )
            .unwrap(),
        );
    }
    match PatchSet::new(patches.clone(), None) {
        Err(error @ PatchSetError::NotOrientable(..)) => {
            assert!(
                error.to_string().contains("[0, 1, 2, 3, 4, 5, 6, 7]"),
                "{error}"
            );
        }
        other => panic!("{other:?}"),
    }
    patches.pop();
    assert!(PatchSet::new(patches, None).is_ok());
}

#[test]
fn t_joint_is_noticed() {
    let large = quad([
        [0.0, 0.0, 0.0],
        [1.0, 0.0, 0.0],
        [0.0, 2.0, 0.0],
        [1.0, 2.0, 0.0],
    ]);
    let low = quad([
        [1.0, 0.0, 0.0],
        [2.0, 0.0, 0.0],
        [1.0, 1.0, 0.0],
        [2.0, 1.0, 0.0],
    ]);
    // Turned over.
    let high = quad([
        [2.0, 1.0, 0.0],
        [1.0, 1.0, 0.0],
        [2.0, 2.0, 0.0],
        [1.0, 2.0, 0.0],
    ]);
    let set = PatchSet::new(vec![large.clone(), low.clone(), high], None).unwrap();
    let partial = &set.edges().partial;
    let long = partial.iter().find(|p| p.edge == (0, 1)).unwrap();
    assert_eq!((long.share, &long.others[..]), (1.0, &[(1, 0), (2, 1)][..]));
    assert_eq!(set.components().len(), 1);
    assert_eq!(set.sides(), [1.0, 1.0, -1.0]);
    assert!(!set.edges().free.contains(&(0, 1)));
    // Half of the edge only.
    let set = PatchSet::new(vec![large, low], None).unwrap();
    let long = set
        .edges()
        .partial
        .iter()
        .find(|p| p.edge == (0, 1))
        .unwrap();
    assert!(long.share > 0.4 && long.share < 0.6, "{}", long.share);
    assert!(set.edges().free.contains(&(0, 1)));
}

#[test]
fn gaps_are_measured_and_bounded() {
    let left = plane(Vec3::zeros(), Vec3::z(), [2.0, 2.0]).unwrap();
    let gap = 1e-3;
    let right = plane(Vec3::new(2.0 + gap, 0.0, 0.0), Vec3::z(), [2.0, 2.0]).unwrap();
    let apart = PatchSet::new(vec![left.clone(), right.clone()], None).unwrap();
    assert_eq!((apart.components().len(), apart.edges().free.len()), (2, 8));
    let joined = PatchSet::new(vec![left, right], Some(2e-3)).unwrap();
    assert_eq!((joined.components().len(), joined.edges().smooth), (1, 1));
    assert!((joined.edges().largest_gap - gap).abs() < 1e-12);
    assert!(matches!(
        PatchSet::<covact_geometry::NurbsPatch>::new(Vec::new(), None),
        Err(PatchSetError::Empty)
    ));
    let patch = plane(Vec3::zeros(), Vec3::z(), [2.0, 2.0]).unwrap();
    assert!(matches!(
        PatchSet::new(vec![patch], Some(-1.0)),
        Err(PatchSetError::Tolerance(_))
    ));
}

#[test]
fn sides_from_points() {
    let sheet = plane(Vec3::zeros(), Vec3::z(), [2.0, 2.0]).unwrap();
    let lone = plane(Vec3::new(0.0, 0.0, 50.0), Vec3::z(), [2.0, 2.0]).unwrap();
    let mut set = PatchSet::new(vec![sheet, lone], None).unwrap();
    // Below the first sheet; one point beside it and one far below do not count; none is near the second sheet.
    let below = [
        Vec3::new(0.1, 0.2, -0.1),
        Vec3::new(-0.3, 0.2, -0.2),
        Vec3::new(1.5, 0.0, 0.4),
    ];
    let sides = set.orient_towards(&below).unwrap();
    assert_eq!(set.sides(), [-1.0, 1.0]);
    assert_eq!(
        sides[0].outcome,
        SideOutcome::Decided {
            votes: 2,
            ignored: 1
        }
    );
    assert_eq!(sides[1].outcome, SideOutcome::Undecided { ignored: 0 });
    let both = [
        Vec3::new(0.1, 0.2, -0.1),
        Vec3::new(0.1, 0.2, -0.2),
        Vec3::new(0.0, 0.0, 0.3),
    ];
    match set.orient_towards(&both) {
        Err(
            error @ SideError::BothSides {
                patch: 0,
                front: 1,
                back: 2,
                ..
            },
        ) => {
            assert!(error.to_string().contains("patch 0"), "{error}");
        }
        other => panic!("{other:?}"),
    }
    set.set_side_as_given(false);
    assert_eq!(set.sides(), [1.0, 1.0]);
    set.set_side_as_given(true);
    assert_eq!(set.sides(), [-1.0, -1.0]);
}

#[test]
fn reach_limits_the_search() {
    let set = PatchSet::new(cube(), None).unwrap();
    let q = Vec3::new(1.5, 0.0, 0.0);
    assert!(set.project(&q, None, 0.4999).is_none());
    let foot = set.project(&q, None, 0.5001).unwrap();
    assert!((foot.distance - 0.5).abs() < 1e-15);
    // A hint on the far face does not count as an answer.
    assert!(set.project(&q, Some(foot.hint()), 0.4999).is_none());
    assert!(
        set.project(&Vec3::new(f64::NAN, 0.0, 0.0), None, 1.0)
            .is_none()
    );
    assert!(set.project(&q, None, f64::NAN).is_none());
}
