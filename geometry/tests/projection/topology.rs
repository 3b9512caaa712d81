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

/// A band of eight bilinear patches about the z axis that is turned over once.
fn moebius_band() -> Vec<NurbsPatch> {
    let point = |k: usize, end: f64| {
        let angle = std::f64::consts::TAU * k as f64 / 8.0;
        let r = 2.0 + end * 0.5 * (0.5 * angle).cos();
        [
            r * angle.cos(),
            r * angle.sin(),
            end * 0.5 * (0.5 * angle).sin(),
        ]
    };
    let part = |k: usize| {
        quad([
            point(k, -1.0),
            point(k + 1, -1.0),
            point(k, 1.0),
            point(k + 1, 1.0),
        ])
    };
    (0..8).map(part).collect()
}

#[test]
fn a_moebius_band_has_distances_without_a_sign() {
    let band = moebius_band();
    let mut set = PatchSet::new(band.clone(), None).unwrap();
    let error = set.two_sided().unwrap_err();
    assert!(matches!(error, PatchSetError::NotOrientable(..)));
    let text = error.to_string();
    assert!(text.contains("[0, 1, 2, 3, 4, 5, 6, 7]"), "{text}");
    assert_eq!((set.sides(), set.volumes()), (&[0.0; 8][..], &[None][..]));

    // Nearest is the nearest of the patches, each by itself; from both sides of each.
    let parts: Vec<PatchSet> = (band.iter())
        .map(|p| PatchSet::new(vec![p.clone()], None).unwrap())
        .collect();
    for k in 0..400 {
        let a = f64::from(k);
        let q = Vec3::new(
            2.5 * (0.7 * a).sin(),
            2.5 * (1.1 * a).cos(),
            (0.37 * a).sin(),
        );
        let foot = set.project(&q, None, f64::INFINITY).unwrap();
        let nearest = (parts.iter())
            .map(|p| p.project(&q, None, f64::INFINITY).unwrap().distance)
            .fold(f64::INFINITY, f64::min);
        assert!((foot.distance - nearest).abs() < 1e-12, "{q:?}");
        assert!((foot.distance - (q - foot.jet.rho).norm()).abs() < 1e-14);
        assert!(foot.side == 0.0 && foot.signed_distance >= 0.0);
        assert!((foot.normal.norm() - 1.0).abs() < 1e-12);
        assert!(foot.normal.dot(&(q - foot.jet.rho)) >= 0.0);
        assert_eq!(foot.status, covact_geometry::Status::Unique);
    }
    // Nothing is there to decide, and nothing to set.
    let sides = set.orient_towards(&[Vec3::new(3.0, 0.0, 0.5)]).unwrap();
    assert_eq!(
        (sides[0].side, sides[0].outcome),
        (0.0, SideOutcome::OneSided)
    );
    set.set_side_as_given(true);
    assert_eq!(set.sides(), [0.0; 8]);
    let range = set.curvature_range();
    assert!(range.convex.is_some() && range.concave.is_some());

    // Beside an ordinary sheet only the band goes without a sign.
    let mut both = band.clone();
    both.push(plane(Vec3::new(0.0, 0.0, 9.0), Vec3::z(), [2.0, 2.0]).unwrap());
    let both = PatchSet::new(both, None).unwrap();
    assert_eq!(foot(&both, 0.0, 0.0, 8.5).signed_distance, -0.5);
    assert_eq!(foot(&both, 0.0, 0.0, 9.5).signed_distance, 0.5);

    // Cut open it has two sides.
    let open = PatchSet::new(band[..7].to_vec(), None).unwrap();
    assert!(open.two_sided().is_ok() && open.sides().iter().all(|s| s.abs() == 1.0));
}

/// Two bent sheets of 15 x 15, one above the other by `gap`.
fn sheets(gap: f64) -> Vec<NurbsPatch> {
    let sheet = |z: f64| {
        quad([
            [0.0, 0.0, z],
            [15.0, 0.0, z + 2.0],
            [0.0, 15.0, z],
            [15.0, 15.0, z],
        ])
    };
    vec![sheet(0.0), sheet(gap)]
}

#[test]
fn sheets_on_top_of_each_other_are_not_welded() {
    use covact_geometry::project::Joining;
    let joined = |patches: &[NurbsPatch], tolerance, resolution| {
        let joining = Joining {
            tolerance,
            resolution,
        };
        PatchSet::join(patches.to_vec(), joining).unwrap()
    };
    let gap = 1e-3;
    let sheets = sheets(gap);
    // By default and even if the tolerance says more: no body of volume 0.2, but two sheets, and what was not joined is
    // told.
    for tolerance in [None, Some(2e-3)] {
        let set = joined(&sheets, tolerance, Some(1e-6));
        assert_eq!(set.components(), [vec![0], vec![1]]);
        assert_eq!(set.volumes(), [None, None]);
        let report = set.edges();
        assert_eq!((report.joints.len(), report.free.len()), (0, 8));
        assert_eq!((report.stacked.len(), report.open_gaps.len()), (4, 0));
        for (k, pair) in report.stacked.iter().enumerate() {
            assert_eq!(pair.edges, [(0, k as u32), (1, k as u32)]);
            assert!(pair.gap <= gap + 1e-12 && pair.gap > 0.9 * gap, "{pair:?}");
        }
        // Both are as they were given: a point between them is above one and below the other.
        let near = |z: f64| {
            let foot = set.project(&Vec3::new(3.0, 13.0, z), None, f64::INFINITY);
            let foot = foot.unwrap();
            (foot.patch, foot.signed_distance > 0.0)
        };
        let z = set.patches()[0].point([0.2, 13.0 / 15.0]).z;
        assert_eq!(near(z + 0.2 * gap), (0, true));
        assert_eq!(near(z + 0.8 * gap), (1, false));
        assert_eq!(near(z + 1.2 * gap), (1, true));
        assert_eq!(near(z - 0.2 * gap), (0, false));
    }
    // A source that cannot tell the two edges apart means one edge.
    let coarse = joined(&sheets, None, Some(2e-3));
    assert_eq!(
        (coarse.components().len(), coarse.edges().joints.len()),
        (1, 4)
    );
    assert!(coarse.volumes()[0].is_some() && coarse.edges().stacked.is_empty());

    // Patches that leave the edge in different directions are joined as before, and the gap is told where the source is
    // finer.
    let left = plane(Vec3::zeros(), Vec3::z(), [15.0, 15.0]).unwrap();
    let right = plane(Vec3::new(15.0 + gap, 0.0, 0.0), Vec3::z(), [15.0, 15.0]).unwrap();
    let pair = [left, right];
    for (resolution, told) in [(None, 1), (Some(1e-6), 1), (Some(2e-3), 0)] {
        let set = joined(&pair, None, resolution);
        assert_eq!((set.components().len(), set.edges().joints.len()), (1, 1));
        let bridged = &set.edges().bridged;
        assert_eq!(bridged.len(), told, "{resolution:?}");
        for b in bridged {
            assert!(
                (b.gap - gap).abs() < 1e-12 && (b.at.x - 7.5).abs() < 0.01,
                "{b:?}"
            );
            assert_eq!(b.edges.map(|e| e.0), [0, 1]);
        }
    }
    // A plate as thin whose rim is closed by strips is a closed body.
    let z = |x: f64, top: f64| [x, 0.0, top];
    let side = |a: [f64; 3], b: [f64; 3]| {
        let up = |p: [f64; 3]| [p[0], p[1], p[2] + gap];
        quad([a, b, up(a), up(b)])
    };
    let corners = [
        z(0.0, 0.0),
        z(15.0, 0.0),
        [15.0, 15.0, 0.0],
        [0.0, 15.0, 0.0],
    ];
    let flat = |top: f64| {
        quad([
            [0.0, 0.0, top],
            [15.0, 0.0, top],
            [0.0, 15.0, top],
            [15.0, 15.0, top],
        ])
    };
    let mut plate = vec![flat(0.0), flat(gap)];
    plate.extend((0..4).map(|k| side(corners[k], corners[(k + 1) % 4])));
    let set = joined(&plate, None, Some(1e-6));
    assert_eq!((set.components().len(), set.edges().joints.len()), (1, 12));
    assert!((set.volumes()[0].unwrap() / (225.0 * gap) - 1.0).abs() < 1e-9);
    assert!(set.edges().stacked.is_empty() && set.edges().bridged.is_empty());
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
