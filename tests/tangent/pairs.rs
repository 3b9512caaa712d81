//! Tangents of every pair of slave points and master surface, all through one core: Konyukhov & Schweizerhof (2005) with
//! the exact terms at a finite penetration.
use crate::cases::*;
use crate::support::{self, Shape, V};
use crate::surface::{Held, Surface};
use covact::contact::rigid::{Exact, Overhang, RigidMaster};
use covact_geometry::{MovingFacets, NurbsPatch, PatchSet};
use nalgebra::{DMatrix, Isometry3};

/// Height of the master surfaces, not symmetric in anything.
fn height(x: f64, y: f64) -> f64 {
    0.15 * x * x - 0.2 * y * y + 0.12 * x * y + 0.05 * x - 0.03 * x * y * y
}

fn warped(x: f64, y: f64) -> V<f64> {
    V::new(x + 0.06 * (2.0 * y).sin(), y - 0.05 * x * y, height(x, y))
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Master {
    Bilinear,
    Biquadratic,
    Smooth,
    /// A rational patch whose control points move.
    Rational,
    Nurbs,
}

fn facets(master: Master) -> (Vec<V<f64>>, MovingFacets) {
    match master {
        Master::Biquadratic => {
            let (nodes, facets) = mesh(4, 2, warped);
            let facets = plain(&nodes, &facets, 2);
            (nodes, facets)
        }
        Master::Smooth => {
            let (nodes, facets) = mesh(4, 1, warped);
            let list: Vec<(&[u32], [u8; 2])> = facets.iter().map(|f| (&f[..], [2; 2])).collect();
            let at = |n: u32| nodes[n as usize];
            let mut smooth = MovingFacets::smooth(&list, at).expect("a mesh");
            smooth.update(at);
            (nodes, smooth)
        }
        _ => {
            let (nodes, facets) = mesh(4, 1, warped);
            let facets = plain(&nodes, &facets, 1);
            (nodes, facets)
        }
    }
}

/// The spans of a rational bicubic patch, whose weights differ by up to a half.
fn rational() -> (Vec<V<f64>>, Surface) {
    let knots = [&[0.0; 4][..], &[0.25, 0.5, 0.75], &[1.0; 4]].concat();
    let at = |k: usize| 2.0 * knots[k + 1..k + 4].iter().sum::<f64>() / 3.0 - 1.0;
    let nodes: Vec<V<f64>> = (0..49).map(|k| warped(at(k % 7), at(k / 7))).collect();
    let weights: Vec<f64> = (0..49)
        .map(|k| 1.0 + 0.5 * ((7 * k + 3) % 11) as f64 / 11.0)
        .collect();
    let patch = |points: &[V<f64>], weights: Option<&[f64]>| {
        let knots = [knots.clone(), knots.clone()];
        NurbsPatch::new([3, 3], knots, [7, 7], points, weights).unwrap()
    };
    let spans: Vec<usize> = (0..16).collect();
    let of = patch(&nodes, Some(&weights));
    let mut facets = MovingFacets::of_patch(&of, &spans, false, |n| n).unwrap();
    facets.update(|n| nodes[n as usize]);
    // The weight function as a coordinate of a polynomial patch.
    let heights: Vec<V<f64>> = weights.iter().map(|w| V::new(*w, 0.0, 0.0)).collect();
    let weight = patch(&heights, None);
    let surface = Surface::weighted(
        facets,
        Some(|facet: u32, xi: [f64; 2]| {
            let span = [facet % 4, facet / 4].map(f64::from);
            let at = [0, 1].map(|k| 0.25 * (span[k] + 0.5 * (xi[k] + 1.0)));
            weight.point(at).x
        }),
    );
    (nodes, surface)
}

pub fn case(slave_order: usize, scheme: Scheme, master: Master) -> Case {
    // A slave face that cuts 0.02 to 0.06 below the surface, turned against the facets.
    let (slave, nodes, surface) = if master == Master::Nurbs {
        let p = support::patch(Shape::Saddle);
        let (slave, _) = mesh(1, slave_order, |x, y| {
            let xi = [0.5 + 0.3 * x, 0.48 + 0.33 * y];
            support::slave_at(&p, xi, -0.04 - 0.012 * x + 0.008 * x * y)
        });
        let surface = Surface::Patch { weights: p.weights };
        (slave, p.points.to_vec(), surface)
    } else {
        let (nodes, surface) = match master {
            Master::Rational => rational(),
            _ => {
                let (nodes, facets) = facets(master);
                (nodes, Surface::of(facets))
            }
        };
        let facets = match &surface {
            Surface::Facets { facets, .. } => facets,
            Surface::Patch { .. } => unreachable!("facets"),
        };
        let (slave, _) = mesh(1, slave_order, |x, y| {
            let (u, v) = (0.3 * x - 0.07 * y + 0.08, 0.09 * x + 0.28 * y - 0.06);
            below(facets, 4, u, v, 0.04 + 0.012 * x - 0.008 * x * y)
        });
        (slave, nodes, surface)
    };
    Case {
        name: format!(
            "{scheme:?} on a {} slave face, {master:?} master",
            ["bilinear", "biquadratic"][slave_order - 1]
        ),
        points: slave_points(&slave, scheme),
        slave,
        master: nodes,
        surface,
    }
}

fn cases() -> Vec<Case> {
    let mut out = Vec::new();
    for master in [
        Master::Bilinear,
        Master::Biquadratic,
        Master::Smooth,
        Master::Rational,
        Master::Nurbs,
    ] {
        for (order, schemes) in [
            (1, [Scheme::Nodes, Scheme::Gauss(2), Scheme::Lobatto(3)]),
            (2, [Scheme::Nodes, Scheme::Gauss(3), Scheme::Lobatto(3)]),
        ] {
            out.extend(schemes.map(|s| case(order, s, master)));
        }
    }
    out
}

#[test]
fn tangents_on_deformable_and_rigid_masters() {
    let mut facets_met = 0;
    for case in cases() {
        let name = &case.name;
        let at = case.evaluate();
        assert!(
            at.iter().all(|p| p.held == Held::Face),
            "{name}: not on faces"
        );
        let mut met: Vec<u32> = at.iter().map(|p| p.facet).collect();
        met.sort();
        met.dedup();
        facets_met = facets_met.max(met.len());
        let (r, k) = case.assemble(&at);
        let (gradient, reference) = case.reference(&at);
        assert!(gradient.norm() > 1e-2, "{name}: nothing to compare");
        let error = (&r - &gradient).norm() / gradient.norm();
        assert!(error < 1e-11, "{name}: residual {error:e}");
        let error = relative(&k, &reference);
        assert!(error < 1e-11, "{name}: deformable master: {error:e}");
        // The parts of the tangent differ by orders of magnitude; every block must be right by itself.
        let s = 3 * case.slave.len();
        let m = k.nrows() - s;
        for (part, rows, columns) in [
            ("slave, slave (rigid master)", (0, s), (0, s)),
            ("slave, master", (0, s), (s, m)),
            ("master, slave", (s, m), (0, s)),
            ("master, master", (s, m), (s, m)),
        ] {
            let cut = |k: &DMatrix<f64>| {
                k.view((rows.0, columns.0), (rows.1, columns.1))
                    .into_owned()
            };
            let error = relative(&cut(&k), &cut(&reference));
            assert!(error < 1e-11, "{name}: {part}: {error:e}");
        }
        let asymmetry = (&k - k.transpose()).norm() / k.norm();
        assert!(asymmetry < 1e-13, "{name}: asymmetry {asymmetry:e}");
    }
    assert!(facets_met > 1, "all points met one facet");
}

/// The pairs above would prove little if main parts alone passed: these are far off.
#[test]
fn geometric_parts_count() {
    for case in cases() {
        let mut at = case.evaluate();
        let (_, whole) = case.assemble(&at);
        for point in &mut at {
            let n = point.residual.fixed_rows::<3>(0).normalize();
            let dn = n.dot(&(point.tangent.fixed_view::<3, 3>(0, 0) * n));
            point.tangent.fill(0.0);
            let main = n * n.transpose() * dn;
            point.tangent.fixed_view_mut::<3, 3>(0, 0).copy_from(&main);
        }
        let (_, main) = case.assemble(&at);
        let left_out = relative(&main, &whole);
        assert!(left_out > 1e-3, "{}: {left_out:e}", case.name);
    }
}

/// The rigid master of the toolkit (a set of NURBS patches at a pose) gives the first block of the same tangent.
#[test]
fn rigid_patches_give_the_first_block() {
    let p = support::patch(Shape::Saddle);
    let knots = || vec![0.0, 0.0, 0.0, 0.0, 1.0, 1.0, 1.0, 1.0];
    let weights = Some(&p.weights[..]);
    let patch = NurbsPatch::new([3, 3], [knots(), knots()], [4, 4], &p.points, weights).unwrap();
    let set = PatchSet::new(vec![patch], None).unwrap();
    let pose = Isometry3::new(V::new(0.3, -2.0, 1.0), V::new(0.4, 0.9, -0.3));
    let master = RigidMaster {
        surface: &set,
        pose,
        depth: 1.0,
        keep: false,
    };
    let turn = pose.rotation.to_rotation_matrix().into_inner();
    for order in [1, 2] {
        for scheme in [Scheme::Nodes, Scheme::Gauss(2), Scheme::Lobatto(3)] {
            let case = case(order, scheme, Master::Nurbs);
            for (point, at) in case.points.iter().zip(case.evaluate()) {
                let q = combine(&case.slave, &point.shape);
                let x = pose * nalgebra::Point3::from(q);
                let touch = (master.touch(
                    &x.coords,
                    (&mut None, Overhang::default()),
                    &Hardening,
                    &Exact,
                ))
                .unwrap()
                .expect("contact");
                let k = turn * at.tangent.fixed_view::<3, 3>(0, 0) * turn.transpose();
                let r = turn * at.residual.fixed_rows::<3>(0);
                assert!(k.norm() > 1.0 && r.norm() > 1e-2);
                assert!(
                    (touch.tangent - k).norm() < 1e-11 * k.norm(),
                    "{}",
                    case.name
                );
                assert!(
                    (touch.residual - r).norm() < 1e-11 * r.norm(),
                    "{}",
                    case.name
                );
                let meeting = (master.meet(&x.coords, (&mut None, 0.0), 1.0))
                    .unwrap()
                    .unwrap();
                let slots = meeting
                    .respond(&Hardening, &Exact)
                    .unwrap()
                    .expect("contact");
                let first = slots.tangent.fixed_view::<3, 3>(0, 0).into_owned();
                assert!((first - k).norm() < 1e-11 * k.norm(), "{}", case.name);
            }
        }
    }
}

#[test]
fn rigid_motions_and_balance() {
    for case in cases() {
        crate::balance::check(&case, 1e-12);
    }
}
