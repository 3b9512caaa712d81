//! Normal contact: Konyukhov & Schweizerhof (2005), exact at every penetration and as published.
use crate::support::*;
use covact::contact::corner;
use covact::contact::kernel::{self, NodeRow, Normal, SlotMatrix, Slots};
use covact::contact::published::{self, Parts};
use covact_geometry::Frame;
use nalgebra::{Matrix3, Vector3};
use num_dual::{Dual64, DualNum};

const EPS_N: f64 = 3.0;
const XI: [f64; 2] = [0.43, 0.58];
const SHAPES: [Shape; 3] = [Shape::Dome, Shape::Bowl, Shape::Saddle];

/// Residual of all 17 nodes with the law `n(xi3)`, the projection re-solved.
fn residual<D: DualNum<f64> + Copy>(
    weights: &[f64; 16],
    points: &[V<D>; 16],
    slave: &V<D>,
    law: impl Fn(D) -> D,
) -> Vec<D> {
    let xi = project(points, weights, slave, XI);
    let frame = Frame::new(&jet(points, weights, xi), 1.0).expect("regular");
    let xi3 = (slave - frame.rho).dot(&frame.n);
    let r = kernel::normal_residual(
        &frame,
        &Normal {
            n: law(xi3),
            dn: D::zero(),
        },
    );
    let n = basis(weights, xi)[0];
    let mut out = Vec::new();
    for n in n {
        (0..3).for_each(|c| out.push(-n * r[c]));
    }
    (0..3).for_each(|c| out.push(r[c]));
    out
}

pub fn node_rows(weights: &[f64; 16], xi: [f64; 2]) -> Vec<NodeRow> {
    let b = basis(weights, xi);
    let mut rows: Vec<NodeRow> = (0..16).map(|k| [-b[0][k], b[1][k], b[2][k]]).collect();
    rows.push([1.0, 0.0, 0.0]);
    rows
}

pub fn assemble(k9: &SlotMatrix, rows: &[NodeRow]) -> Vec<Vec<f64>> {
    let n = rows.len();
    let mut k = vec![vec![0.0; 3 * n]; 3 * n];
    for (i, ri) in rows.iter().enumerate() {
        for (j, rj) in rows.iter().enumerate() {
            let block = kernel::assemble_block(k9, ri, rj);
            for a in 0..3 {
                for b in 0..3 {
                    k[3 * i + a][3 * j + b] = block[(a, b)];
                }
            }
        }
    }
    k
}

fn state(shape: Shape, ratio: f64) -> (Patch, V<f64>, Frame, f64) {
    let p = patch(shape);
    let xi3 = ratio * p.radius;
    let frame = Frame::new(&jet(&p.points, &p.weights, XI), 1.0).unwrap();
    (p, slave_at(&p, XI, xi3), frame, xi3)
}

#[test]
fn exact_tangent_on_a_moving_master() {
    for shape in SHAPES {
        for ratio in [-0.2, -0.05, -0.01, -1e-3, 0.0] {
            let (p, slave, frame, xi3) = state(shape, ratio);
            let reference =
                derivative(&p, &slave, |x, s| residual(&p.weights, x, s, |g| g * EPS_N));
            let normal = Normal {
                n: EPS_N * xi3,
                dn: EPS_N,
            };
            let k9 = kernel::normal_tangent(&frame, xi3, &normal);
            let k = assemble(&k9, &node_rows(&p.weights, XI));
            let error = relative(&k, &reference);
            assert!(error < 1e-12, "{shape:?} at {ratio}: {error:e}");
        }
    }
}

#[test]
fn exact_geometric_part_alone() {
    // A traction that does not depend on the gap (a multiplier) leaves the geometric part alone, at xi3 = 0 too.
    for shape in SHAPES {
        for ratio in [-0.2, -0.01, 0.0] {
            let (p, slave, frame, xi3) = state(shape, ratio);
            let reference = derivative(&p, &slave, |x, s| {
                residual(&p.weights, x, s, |_| Dual64::from(-0.7))
            });
            let normal = Normal { n: -0.7, dn: 0.0 };
            let k9 = kernel::normal_tangent(&frame, xi3, &normal);
            let k = assemble(&k9, &node_rows(&p.weights, XI));
            let error = relative(&k, &reference);
            assert!(error < 1e-12, "{shape:?} at {ratio}: {error:e}");
        }
    }
}

fn published_error(shape: Shape, ratio: f64, normal: impl Fn(f64) -> Normal) -> f64 {
    let (p, _, frame, xi3) = state(shape, ratio);
    let rows = node_rows(&p.weights, XI);
    let law = normal(xi3);
    let exact = assemble(&kernel::normal_tangent(&frame, xi3, &law), &rows);
    let published = assemble(&published::normal_tangent(&frame, &law, Parts::ALL), &rows);
    relative(&published, &exact)
}

#[test]
fn published_form_is_first_order_in_its_geometric_part_and_second_as_a_whole() {
    for shape in SHAPES {
        let geometric = |r| published_error(shape, r, |_| Normal { n: -1.0, dn: 0.0 });
        let whole = |r: f64| {
            published_error(shape, r, |xi3| Normal {
                n: EPS_N * xi3,
                dn: EPS_N,
            })
        };
        for (error, slope) in [
            (&geometric as &dyn Fn(f64) -> f64, 1.0),
            (&whole as &dyn Fn(f64) -> f64, 2.0),
        ] {
            let (coarse, fine) = (error(-1e-2), error(-1e-3));
            assert!(fine > 1e-9, "nothing to measure: {fine:e}");
            let measured = (coarse / fine).log10();
            assert!(
                (measured - slope).abs() < 0.1,
                "{shape:?}: slope {measured} instead of {slope}"
            );
        }
        assert!(geometric(0.0) < 1e-13);
    }
}

#[test]
fn parts_of_the_published_form_switch_by_themselves() {
    let (_, _, frame, xi3) = state(Shape::Saddle, -0.01);
    let normal = Normal {
        n: EPS_N * xi3,
        dn: EPS_N,
    };
    let k = |rotational, curvature| {
        published::normal_tangent(
            &frame,
            &normal,
            Parts {
                rotational,
                curvature,
            },
        )
    };
    let main = k(false, false);
    let both = k(true, true);
    let sum = k(true, false) + k(false, true) - main;
    assert!((both - sum).norm() < 1e-15 * both.norm());
    assert!((k(true, false) - main).norm() > 1e-4 * main.norm());
    assert!((k(false, true) - main).norm() > 1e-4 * main.norm());
    assert_eq!(main.rank(1e-12), 1);
}

#[test]
fn rigid_tangent_is_the_first_block() {
    for shape in SHAPES {
        for ratio in [-0.2, -0.01, 0.0] {
            let (_, _, frame, xi3) = state(shape, ratio);
            let normal = Normal { n: -0.7, dn: 2.0 };
            let full = kernel::normal_tangent(&frame, xi3, &normal);
            let block: Matrix3<f64> = full.fixed_view::<3, 3>(0, 0).into();
            let rigid = kernel::normal_tangent_rigid(&frame, xi3, &normal);
            assert!(rigid.norm() > 1.0);
            assert!((block - rigid).norm() < 1e-13 * rigid.norm());
            let p_block: Matrix3<f64> = published::normal_tangent(&frame, &normal, Parts::ALL)
                .fixed_view::<3, 3>(0, 0)
                .into();
            let p_rigid = published::normal_tangent_rigid(&frame, &normal, Parts::ALL);
            assert_eq!(p_block, p_rigid);
        }
    }
}

#[test]
fn rigid_motions_do_no_work_and_turn_the_residual() {
    let (p, slave, frame, xi3) = state(Shape::Saddle, -0.05);
    let normal = Normal {
        n: EPS_N * xi3,
        dn: EPS_N,
    };
    let rows = node_rows(&p.weights, XI);
    let k = assemble(&kernel::normal_tangent(&frame, xi3, &normal), &rows);
    let slots: Slots = kernel::normal_residual(&frame, &normal);
    let r: Vec<V<f64>> = (rows.iter())
        .map(|row| kernel::assemble_force(&slots, row))
        .collect();
    let x: Vec<V<f64>> = p.points.iter().copied().chain([slave]).collect();
    let omega = Vector3::new(0.3, -0.7, 0.5);
    let apply = |motion: &dyn Fn(&V<f64>) -> V<f64>| -> Vec<V<f64>> {
        (0..17)
            .map(|i| {
                let row = |a: usize| -> f64 {
                    (0..17)
                        .map(|j| {
                            let v = motion(&x[j]);
                            (0..3).map(|b| k[3 * i + a][3 * j + b] * v[b]).sum::<f64>()
                        })
                        .sum()
                };
                V::new(row(0), row(1), row(2))
            })
            .collect()
    };
    let turned = apply(&|x| omega.cross(x));
    let scale = r[16].norm();
    assert!(scale > 1e-3);
    for i in 0..17 {
        assert!((turned[i] - omega.cross(&r[i])).norm() < 1e-13 * EPS_N);
    }
    let moved = apply(&|_| omega);
    assert!(moved.iter().all(|v| v.norm() < 1e-13 * EPS_N));
    let total: V<f64> = r.iter().sum();
    let moment: V<f64> = x.iter().zip(&r).map(|(x, r)| x.cross(r)).sum();
    assert!(total.norm() < 1e-14 * scale && moment.norm() < 1e-14 * scale);
}

#[test]
fn neither_the_parametrisation_nor_the_side_of_the_normal_matters() {
    let (p, slave, frame, xi3) = state(Shape::Saddle, -0.05);
    let normal = Normal { n: -0.7, dn: 2.0 };
    let reference = kernel::normal_tangent_rigid(&frame, xi3, &normal);
    let swapped = std::array::from_fn(|k| p.points[4 * (k % 4) + k / 4]);
    let weights = std::array::from_fn(|k| p.weights[4 * (k % 4) + k / 4]);
    let xi = project(&swapped, &weights, &slave, [XI[1], XI[0]]);
    let other = Frame::new(&jet(&swapped, &weights, xi), -1.0).unwrap();
    let k = kernel::normal_tangent_rigid(&other, xi3, &normal);
    assert!((k - reference).norm() < 1e-13 * reference.norm());
    // Flipping the side flips n, h and xi3 together.
    let flipped = Frame::new(&jet(&p.points, &p.weights, XI), -1.0).unwrap();
    let mirrored = Normal { n: 0.7, dn: 2.0 };
    let k = kernel::normal_tangent_rigid(&flipped, -xi3, &mirrored);
    assert!((k - reference).norm() < 1e-13 * reference.norm());
}

#[test]
fn tangents_at_an_edge_and_a_vertex() {
    // Edge: the first boundary curve of the patch, closest point re-solved in dual arithmetic.
    let p = patch(Shape::Saddle);
    let curve = |s: Dual64| {
        jet(
            &p.points.map(|x| x.map(Dual64::from)),
            &p.weights,
            [s, Dual64::from(0.0)],
        )
    };
    for distance in [0.2, 1e-3, 0.0] {
        let at = jet(&p.points, &p.weights, [0.4, 0.0]);
        let across = at.rho_i[0].cross(&Vector3::new(0.3, 1.0, 0.8)).normalize();
        let slave = at.rho + across * distance;
        let mut reference = Matrix3::zeros();
        for dof in 0..3 {
            let q = V::from_fn(|c, _| Dual64::new(slave[c], if c == dof { 1.0 } else { 0.0 }));
            let mut s = Dual64::from(0.4);
            for _ in 0..12 {
                let j = curve(s);
                let d = q - j.rho;
                let slope = j.rho_i[0].dot(&d);
                let curvature = j.rho_i[0].dot(&j.rho_i[0]) - j.rho_ij[0].dot(&d);
                s += slope / curvature;
            }
            let force = corner::residual(&(q - curve(s).rho), Dual64::from(EPS_N));
            (0..3).for_each(|r| reference[(r, dof)] = force[r].eps);
        }
        let d = slave - at.rho;
        let k = corner::edge_tangent(&d, &at.rho_i[0], &at.rho_ij[0], EPS_N);
        assert!(reference.norm() > 1.0);
        let error = (k - reference).norm() / reference.norm();
        assert!(error < 1e-12, "distance {distance}: {error:e}");
    }
    assert_eq!(corner::vertex_tangent(EPS_N), Matrix3::identity() * EPS_N);
}
