//! Friction with two coefficients on masters that deform: the direction is fixed to the surface, and residual and tangent follow it,
//! against dual numbers through closest point, undeformed facet, attraction point, law and all.
use crate::cases::{Case, Scheme};
use crate::friction::{Sliding, Where, facets};
use crate::pairs::{self, Master};
use crate::support::V;
use crate::surface::Held;
use covact::contact::friction::history::PointHistory;
use covact::contact::friction::law::{Coulomb, FrictionLaw, Slip};
use covact::contact::friction::moving::Full;
use covact::contact::friction::orthotropic::Orthotropic;
use covact::contact::friction::rigid::Friction;
use covact::contact::law::{Augmented, Penalty};
use covact::contact::moving::MovingMaster;
use covact::contact::rigid::Overhang;
use covact_geometry::{Frame, Hint, MovingFacets};
use nalgebra::{Matrix3, Rotation3, Unit, Vector3};
use num_dual::DualNum;

/// Where the nodes of a master were before it was bent, stretched and turned by 2.1 radians.
fn rest(x: &V<f64>) -> V<f64> {
    let bent = V::new(
        1.4 * x.x + 0.2 * x.y * x.y,
        0.7 * x.y + 0.25 * x.x,
        x.z + 0.3 * (1.1 * x.x).sin() - 0.2 * x.x * x.y,
    );
    Rotation3::new(V::new(1.2, -1.3, 1.1)) * bent + V::new(3.0, -1.0, 0.5)
}

/// Normals of the undeformed facets at the feet of a pair.
fn normals(case: &Case) -> Vec<V<f64>> {
    let mut undeformed = facets(case).clone();
    let nodes: Vec<V<f64>> = case.master.iter().map(rest).collect();
    undeformed.update(|n| nodes[n as usize]);
    let frame = |facet, xi| Frame::new(&undeformed.jet(facet, xi), 1.0).expect("regular");
    let feet = case.evaluate();
    feet.iter().map(|at| frame(at.facet, at.xi).n).collect()
}

/// Directions that lie in the undeformed tangent planes, lean out of them, and come near to the normal at the last point.
fn directions(case: &Case) -> Vec<(&'static str, Unit<V<f64>>)> {
    let n = normals(case)[case.points.len() - 1];
    let side = n.cross(&V::new(0.3, 1.0, 0.2)).normalize();
    vec![
        ("lying", Unit::new_normalize(side)),
        ("leaning", Unit::new_normalize(side * 0.8 - n)),
        ("near the normal", Unit::new_normalize(n + side * 0.05)),
        ("near the other", Unit::new_normalize(side * 0.04 - n)),
    ]
}

/// A law whose direction is told to stay where it is, whatever the master does.
#[derive(Clone, Copy)]
struct Frozen(Orthotropic);

impl FrictionLaw for Frozen {
    fn slip<D: DualNum<f64> + Copy>(&self, t: &Vector3<D>, n: &Vector3<D>, p: D) -> Slip<D> {
        self.0.slip(t, n, p)
    }

    fn direction(&self) -> Option<&Vector3<f64>> {
        self.0.direction()
    }

    fn slip_along<D: DualNum<f64> + Copy>(
        &self,
        t: &Vector3<D>,
        n: &Vector3<D>,
        p: D,
        e: &Vector3<D>,
    ) -> (Slip<D>, Matrix3<D>) {
        let none = Matrix3::from_element(D::zero());
        (self.0.slip_along(t, n, p, e).0, none)
    }
}

/// Error of the tangent of a law whose direction stays, relative to the exact one.
fn left_out(case: Case, place: Where, law: Orthotropic) -> f64 {
    let frozen = Sliding::new(case, place, Frozen(law), 0.0, true, rest);
    let (_, k) = frozen.assemble();
    let (_, exact) = frozen.reference();
    (k - &exact).norm() / exact.norm()
}

#[test]
fn the_direction_is_fixed_to_faces_that_bend_and_turn() {
    let mut worst = 0.0f64;
    let (mut blurred, mut counted) = (0, f64::INFINITY);
    for master in [
        Master::Bilinear,
        Master::Biquadratic,
        Master::Smooth,
        Master::Rational,
    ] {
        let new = || pairs::case(1, Scheme::Gauss(2), master);
        for (what, direction) in directions(&new()) {
            for place in [Where::Same, Where::Neighbour, Where::Far] {
                for (mu, approach, slides) in [
                    ([0.04, 0.15], 0.0, true),
                    ([0.15, 0.04], 0.02, true),
                    ([50.0, 30.0], 0.0, false),
                ] {
                    let law = Orthotropic::new(mu, direction);
                    for full in [true, false] {
                        let name = format!("{master:?}, {what}, {place:?}, {mu:?}, full {full}");
                        let sliding = Sliding::new(new(), place, law, approach, full, rest);
                        let moment = sliding.check(&name, slides);
                        match full {
                            true => assert!(moment < 1e-14, "{name}: moment {moment:e}"),
                            false => worst = worst.max(moment),
                        }
                    }
                }
            }
            let law = Orthotropic::new([0.04, 0.15], direction);
            blurred += (normals(&new()).iter()).filter(|n| law.blurs(n)).count();
            let error = left_out(new(), Where::Same, law);
            println!("{master:?}, {what}: {error:e} without the direction");
            counted = counted.min(error);
        }
    }
    assert!(worst > 1e-4, "{worst:e}");
    assert!(blurred >= 6, "{blurred} points near the normal");
    assert!(counted > 1e-3, "{counted:e}");
}

#[test]
fn the_direction_is_fixed_to_edges_and_vertices_too() {
    for order in [1, 2] {
        let new = || crate::edges::case("valley", order, [0.5, 0.7, 0.1], 0.1);
        let direction = Unit::new_normalize(V::new(0.7, 0.4, -0.5));
        for place in [Where::Same, Where::Neighbour] {
            let law = Orthotropic::new([0.04, 0.15], direction);
            let name = format!("valley, order {order}, {place:?}");
            let sliding = Sliding::new(new(), place, law, 0.0, true, rest);
            let on = |held: fn(&Held) -> bool| sliding.held.iter().filter(|h| held(h)).count();
            assert_eq!(on(|h| matches!(h, Held::Edge(_))), 4, "{name}");
            assert_eq!(on(|h| *h == Held::Vertex), 1, "{name}");
            sliding.check(&name, true);
            let error = left_out(new(), place, law);
            assert!(error > 1e-3, "{name}: {error:e}");
        }
    }
}

/// On a plane facet that is turned, stretched and sheared: `c^i rho_i` by hand, and the ellipse about it.
#[test]
fn the_direction_is_a_fibre_of_the_master() {
    let mu = [0.1, 0.3];
    let turn = Rotation3::new(V::new(0.4, -1.9, 0.8));
    let shear = Matrix3::new(1.3, 0.6, 0.0, 0.0, 0.8, 0.0, 0.0, 0.0, 1.0);
    let flat = |x: f64, y: f64| V::new(x, y, 0.0);
    // The nodes are those of the deformed state; at rest they were a unit square.
    let now = |x: f64, y: f64| turn * (shear * flat(x, y));
    let (nodes, faces) = crate::cases::mesh(2, 1, now);
    let (slave, _) = crate::cases::mesh(1, 1, |x, y| {
        turn * (shear * flat(0.4 + 0.1 * x, 0.45 + 0.1 * y) - V::z() * 0.02)
    });
    let back = shear.try_inverse().expect("regular");
    let surface = crate::surface::Surface::of(crate::cases::plain(&nodes, &faces, 1));
    let case = Case {
        name: "plane".to_owned(),
        points: crate::cases::slave_points(&slave, Scheme::Gauss(2)),
        slave,
        master: nodes,
        surface,
    };
    let given = V::new(0.6, 0.8, 0.4);
    let law = Orthotropic::new(mu, Unit::new_normalize(given));
    let sliding = Sliding::new(case, Where::Same, law, 0.0, true, |x| {
        back * (turn.inverse() * x)
    });
    let a = (turn * (shear * flat(0.6, 0.8))).normalize();
    let n = turn * V::z();
    let fixed = (turn * flat(0.6, 0.8)).normalize();
    assert!(a.dot(&fixed) < 0.95, "a stretch that turns the fibre");
    let b = n.cross(&a);
    for touch in sliding.touches(&Full) {
        let (t, p) = (touch.response.slip.t, -touch.n);
        assert!(touch.response.slip.slides && p > 0.01);
        let on = |a: &V<f64>, b: &V<f64>| (t.dot(a) / mu[0]).hypot(t.dot(b) / mu[1]) / p;
        assert!((on(&a, &b) - 1.0).abs() < 1e-12, "{}", on(&a, &b));
        // Not so about a direction that only turns.
        let other = on(&fixed, &n.cross(&fixed));
        assert!((other - 1.0).abs() > 0.02, "{other}");
    }
}

#[test]
fn equal_coefficients_are_coulombs_law_on_masters_that_deform() {
    for master in [Master::Bilinear, Master::Smooth, Master::Rational] {
        let new = || pairs::case(1, Scheme::Gauss(2), master);
        for (what, direction) in directions(&new()) {
            for mu in [0.1, 50.0] {
                let (place, full) = (Where::Neighbour, true);
                let law = Orthotropic::new([mu; 2], direction);
                let two = Sliding::new(new(), place, law, 0.0, full, rest).assemble();
                let one = Sliding::new(new(), place, Coulomb { mu }, 0.0, full, rest).assemble();
                let error = (&two.0 - &one.0).norm() / one.0.norm();
                assert!(error < 1e-14, "{what}: {error:e}");
                let error = (&two.1 - &one.1).norm() / one.1.norm();
                assert!(error < 1e-13, "{what}: {error:e}");
            }
        }
    }
}

/// At the tip of triangles, which are collapsed facets, there is no tangent plane and no direction: both coefficients are their root
/// mean square, and the tangent is the derivative of that.
#[test]
fn the_tip_of_triangles_knows_no_direction() {
    let ring = [(1.0, 0.0), (0.0, 1.0), (-1.0, 0.0), (0.0, -1.0)];
    let mut nodes = vec![V::zeros()];
    nodes.extend(ring.map(|(x, y)| V::new(x, y, 0.6)));
    let faces: Vec<[u32; 4]> = (0..4).map(|k| [1 + k, 1 + (k + 1) % 4, 0, 0]).collect();
    let list: Vec<(&[u32], [u8; 2])> = faces.iter().map(|f| (&f[..], [2; 2])).collect();
    let mut pit = MovingFacets::new(&list).expect("a surface");
    pit.update(|n| nodes[n as usize]);
    let mut undeformed = pit.clone();
    undeformed.update(|n| rest(&nodes[n as usize]));
    let master = MovingMaster {
        facets: &pit,
        undeformed: &undeformed,
        depth: 1.0,
        keep: false,
    };
    let law = Orthotropic::new([0.1, 0.3], Unit::new_normalize(V::new(0.3, 0.8, 0.1)));
    let normal = Augmented {
        law: Penalty { eps_n: 3.0 },
        z0: 0.0,
        lambda_n: 0.0,
        held: false,
    };
    let mut history = PointHistory {
        base: V::new(0.3, -0.2, -0.1),
        ..PointHistory::default()
    };
    let hint = Hint {
        patch: 1,
        xi: [0.2, -0.1],
    };
    master.attach(&mut history, Some(hint));
    let x = V::new(0.01, 0.02, -0.1);
    let touch = |mu: f64| {
        let even = Coulomb { mu };
        let (one, two) = (
            Friction {
                law: even,
                eps_t: 2.0,
            },
            Friction { law, eps_t: 2.0 },
        );
        let all = |_: u32| true;
        let one = master.touch_with_friction(
            &x,
            (&mut None, Overhang::default()),
            &normal,
            &one,
            &history,
            &Full,
            all,
        );
        let two = master.touch_with_friction(
            &x,
            (&mut None, Overhang::default()),
            &normal,
            &two,
            &history,
            &Full,
            all,
        );
        [one, two].map(|touch| touch.expect("regular").expect("contact"))
    };
    let [one, two] = touch(0.05f64.sqrt());
    let at = undeformed.jet(two.foot.patch, two.foot.xi);
    assert!(Frame::new(&at, 1.0).is_none(), "{:?}", two.foot);
    assert!(one.response.slip.slides && two.response.slip.t.norm() > 0.05);
    let error = (one.response.residual - two.response.residual).norm();
    assert!(error < 1e-14, "{error:e}");
    let (k, exact) = (two.response.tangent, one.response.tangent);
    assert!((k - exact).norm() < 1e-12 * exact.norm(), "{}", k - exact);
}
