//! What a point finds next to poles, creases and edges.
use super::*;
use crate::contact::law::{Augmented, Penalty, Shifted};
use covact_geometry::NurbsPatch;

/// The valley `z = |x| + |y|`, hollow along two creases that cross at the origin.
fn valley() -> PatchSet {
    creased(1.0)
}

/// `z = slope (|x| + |y|)`.
fn creased(slope: f64) -> PatchSet {
    let knots = || vec![0.0, 0.0, 0.5, 1.0, 1.0];
    let at = |i: usize| i as f64 - 1.0;
    let points: Vec<Vec3> = (0..9)
        .map(|k| (at(k % 3), at(k / 3)))
        .map(|(x, y)| Vec3::new(x, y, slope * (x.abs() + y.abs())))
        .collect();
    let patch = NurbsPatch::new([1, 1], [knots(), knots()], [3, 3], &points, None);
    PatchSet::new(vec![patch.unwrap()], None).unwrap()
}

#[test]
fn tractions_next_to_a_pole_keep_their_digits() {
    let radius = 0.5;
    let at = Vec3::new(0.3, -0.2, 1.0);
    let ball = covact_geometry::primitives::sphere(radius, at, Vec3::z()).unwrap();
    let set = PatchSet::new(vec![ball], None).unwrap();
    let master = RigidMaster {
        surface: &set,
        pose: Isometry3::identity(),
        depth: 0.1,
        keep: false,
    };
    let law = Penalty { eps_n: 5.0 };
    for away in [0.0, 1e-12, 1e-10, 1e-9, 1e-8, 1e-7, 1e-6, 3e-6, 1e-5, 1e-3] {
        for turn in [0.0f64, 0.7, 2.0, 4.0] {
            let beside = Vec3::new(turn.cos(), turn.sin(), 0.0) * away;
            let x = at + beside - Vec3::z() * (radius - 1e-3);
            let touch = master
                .touch(&x, (&mut None, Overhang::default()), &law, &Exact)
                .unwrap();
            let touch = touch.expect("contact");
            let n = (x - at).normalize();
            let gap = (x - at).norm() - radius;
            let error = (touch.residual / touch.n - n).norm();
            assert!(error < 1e-11, "{away:e}, {turn}: {error:e}");
            let across = Matrix3::identity() - n * n.transpose();
            let exact = n * n.transpose() * 5.0 + across * (5.0 * gap / (radius + gap));
            let error = (touch.tangent - exact).norm();
            assert!(error < 1e-6, "{away:e}, {turn}: {error:e}");
        }
    }
}

#[test]
fn an_offset_rounds_edges_and_vertices_off() {
    let set = creased(-1.0);
    let master = RigidMaster {
        surface: &set,
        pose: Isometry3::translation(0.3, 0.0, 0.0),
        depth: 0.01,
        keep: false,
    };
    let law = Shifted {
        law: Penalty { eps_n: 5.0 },
        z0: 0.5,
    };
    let touch = |x: Vec3| master.touch(&x, (&mut None, Overhang::default()), &law, &Exact);
    // Above the peak, a ridge and a face: pushed away from the vertex, the ridge, the face.
    for (x, n) in [
        (Vec3::new(0.32, 0.01, 0.4), Vec3::new(0.02, 0.01, 0.4)),
        (Vec3::new(0.8, 0.02, -0.1), Vec3::new(0.2, 0.02, 0.2)),
        (Vec3::new(0.8, 0.5, -0.7), Vec3::new(1.0, 1.0, 1.0)),
    ] {
        let at = touch(x).unwrap().expect("contact");
        assert!(at.xi3 > 0.0 && (at.gap - (at.xi3 - 0.5)).abs() < 1e-15);
        let error = (at.residual / at.n - n.normalize()).norm();
        assert!(error < 1e-9, "{x:?}: {:?}", at.residual / at.n);
        assert!((at.n - 5.0 * at.gap).abs() < 1e-12);
        for c in 0..3 {
            let mut step = Vec3::zeros();
            step[c] = 1e-6;
            let at_step = |s: f64| touch(x + step * s).unwrap().expect("contact").residual;
            let slope = (at_step(1.0) - at_step(-1.0)) / 2e-6;
            let error = (slope - at.tangent.column(c)).norm();
            assert!(error < 1e-6, "{x:?}, direction {c}: {error:e}");
        }
    }
    // Beyond the offset, and far past it: open. Deeper than the depth: open.
    assert_eq!(touch(Vec3::new(0.3, 0.0, 0.501)), Ok(None));
    assert_eq!(touch(Vec3::new(0.8, 0.5, -1.1)), Ok(None));
    // Next to the vertex the direction of the distance is lost, and the pseudo-normal stands in for it.
    let near = touch(Vec3::new(0.3, 0.0, 1e-7)).unwrap().expect("contact");
    assert!((near.residual / near.n - Vec3::z()).norm() < 1e-9);
}

#[test]
fn a_multiplier_holds_a_point_slightly_above_the_surface() {
    let set = creased(-1.0);
    let master = RigidMaster {
        surface: &set,
        pose: Isometry3::identity(),
        depth: 1e-3,
        keep: false,
    };
    let law = Augmented {
        law: Penalty { eps_n: 5.0 },
        z0: 0.0,
        lambda_n: -0.1,
        held: false,
    };
    let normal = Vec3::new(1.0, 1.0, 1.0).normalize();
    let foot = Vec3::new(0.4, 0.3, -0.7);
    let touch = |gap: f64| {
        master.touch(
            &(foot + normal * gap),
            (&mut None, Overhang::default()),
            &law,
            &Exact,
        )
    };
    let at = touch(0.019).unwrap().expect("held up to 0.1 / 5");
    assert!((at.n + 0.005).abs() < 1e-12 && (at.gap - 0.019).abs() < 1e-12);
    assert_eq!(touch(0.0201), Ok(None));
    // Deeper than the depth nothing is held.
    assert_eq!(touch(-0.002), Ok(None));
}

#[test]
fn tangents_where_creases_hold_the_foot() {
    let set = valley();
    let master = RigidMaster {
        surface: &set,
        pose: Isometry3::translation(0.3, 0.0, 0.0),
        depth: 1.0,
        keep: false,
    };
    let law = Penalty { eps_n: 5.0 };
    let touch = |x: Vec3| {
        (master.touch(&x, (&mut None, Overhang::default()), &law, &Exact))
            .unwrap()
            .expect("contact")
    };
    // Below the crossing: held in all directions; below one crease: free along it; below a face: along the normal.
    for (x, rank) in [
        (Vec3::new(0.3, 0.0, -0.1), 3),
        (Vec3::new(0.7, 0.0, 0.3), 2),
        (Vec3::new(0.7, 0.3, 0.6), 1),
    ] {
        let at = touch(x);
        assert_eq!(at.tangent.rank(1e-9), rank, "{x:?}");
        for c in 0..3 {
            let mut step = Vec3::zeros();
            step[c] = 1e-6;
            let slope = (touch(x + step).residual - touch(x - step).residual) / 2e-6;
            let error = (slope - at.tangent.column(c)).norm();
            assert!(error < 1e-7, "{x:?}, direction {c}: {error:e}");
        }
    }
}
