//! The published tangents of sticking and sliding (Konyukhov & Schweizerhof, Comput. Mech. 35 (2005)) against the exact one of
//! the same rate law: `K = X^i x Dt_i + t_i D(X^i)`, the variations `X^i = dxi^i` from dual numbers through the projection.
use crate::normal::{assemble, node_rows};
use crate::support::*;
use covact::contact::friction::published::{FrictionParts, slip_tangent, stick_tangent};
use covact::contact::kernel::{self, Normal, SlotMatrix, Slots};
use covact_geometry::Frame;
use nalgebra::Vector3;
use num_dual::DualNum;

const XI: [f64; 2] = [0.43, 0.58];
const SHAPES: [Shape; 3] = [Shape::Dome, Shape::Bowl, Shape::Saddle];
const EPS_T: f64 = 2.0;
const MU: f64 = 0.3;
const NORMAL: Normal = Normal { n: -0.7, dn: 3.0 };
/// Covariant components of the (trial) traction.
const T: [f64; 2] = [0.5, -0.35];

type Dense = Vec<Vec<f64>>;

/// Generalised forces `t_k dxi^k` on all 17 nodes for components `t`, and the metric, at the re-solved projection.
fn forces<D: DualNum<f64> + Copy>(
    weights: &[f64; 16],
    points: &[V<D>; 16],
    slave: &V<D>,
    t: [f64; 2],
) -> (Vec<D>, [D; 3]) {
    let xi = project(points, weights, slave, XI);
    let b = basis(weights, xi);
    let frame = Frame::new(&jet(points, weights, xi), 1.0).expect("regular");
    let xi3 = (slave - frame.rho).dot(&frame.n);
    let [i11, i12, i22] = kernel::inverse_at_point(&frame, xi3);
    let up = [i11 * t[0] + i12 * t[1], i12 * t[0] + i22 * t[1]];
    let along = frame.rho_i[0] * up[0] + frame.rho_i[1] * up[1];
    let mut out = Vec::with_capacity(51);
    for (n, (n_1, n_2)) in b[0].iter().zip(b[1].iter().zip(&b[2])) {
        let f = frame.n * (xi3 * (up[0] * *n_1 + up[1] * *n_2)) - along * *n;
        (0..3).for_each(|c| out.push(f[c]));
    }
    (0..3).for_each(|c| out.push(along[c]));
    (out, frame.a)
}

struct Setup {
    patch: Patch,
    slave: V<f64>,
    frame: Frame,
    /// `X^1`, `X^2` over all degrees of freedom.
    x: [Vec<f64>; 2],
    g3: Vec<f64>,
}

fn setup(shape: Shape, ratio: f64) -> Setup {
    let p = patch(shape);
    let slave = slave_at(&p, XI, ratio * p.radius);
    let frame = Frame::new(&jet(&p.points, &p.weights, XI), 1.0).unwrap();
    let x = [[1.0, 0.0], [0.0, 1.0]].map(|t| forces(&p.weights, &p.points, &slave, t).0);
    let g3 = (node_rows(&p.weights, XI).iter())
        .flat_map(|row| (frame.n * row[0]).data.0[0])
        .collect();
    Setup {
        patch: p,
        slave,
        frame,
        x,
        g3,
    }
}

impl Setup {
    /// `t_k D(X^k)`.
    fn geometric(&self, t: [f64; 2]) -> Dense {
        derivative(&self.patch, &self.slave, |x, s| {
            forces(&self.patch.weights, x, s, t).0
        })
    }

    /// `Dt_i` of the rate law.
    fn rate(&self, t: [f64; 2]) -> [Vec<f64>; 2] {
        let gamma = self.frame.christoffel();
        [0, 1].map(|i| {
            let by = [0, 1].map(|j| {
                EPS_T * self.frame.a[i + j] + gamma[0][i + j] * t[0] + gamma[1][i + j] * t[1]
            });
            (0..51)
                .map(|c| by[0] * self.x[0][c] + by[1] * self.x[1][c])
                .collect()
        })
    }

    fn sum(&self, d: &[Vec<f64>; 2], mut k: Dense) -> Dense {
        for (i, row) in k.iter_mut().enumerate() {
            for (j, k) in row.iter_mut().enumerate() {
                *k += self.x[0][i] * d[0][j] + self.x[1][i] * d[1][j];
            }
        }
        k
    }

    fn stick(&self) -> Dense {
        self.sum(&self.rate(T), self.geometric(T))
    }

    fn slip(&self, dn: f64) -> Dense {
        let norm = self.trial().norm();
        let unit = T.map(|t| t / norm);
        let [a, b, c] = self.frame.a_inv;
        let up = [a * unit[0] + b * unit[1], b * unit[0] + c * unit[1]];
        let limit = -MU * NORMAL.n;
        let trial = self.rate(T);
        let metric = derivative(&self.patch, &self.slave, |x, s| {
            forces(&self.patch.weights, x, s, T).1.to_vec()
        });
        let d = [0, 1].map(|i| {
            (0..51)
                .map(|c| {
                    let along = up[0] * trial[0][c] + up[1] * trial[1][c];
                    let stretch = up[0] * up[0] * metric[0][c]
                        + 2.0 * up[0] * up[1] * metric[1][c]
                        + up[1] * up[1] * metric[2][c];
                    -MU * dn * unit[i] * self.g3[c]
                        + limit / norm * (trial[i][c] - unit[i] * along)
                        + 0.5 * limit * unit[i] * stretch
                })
                .collect()
        });
        self.sum(&d, self.geometric(unit.map(|t| t * limit)))
    }

    /// The trial traction in space.
    fn trial(&self) -> V<f64> {
        let up = self.frame.rho_up();
        up[0] * T[0] + up[1] * T[1]
    }

    fn limit(&self) -> V<f64> {
        self.trial().normalize() * (-MU * NORMAL.n)
    }

    fn assemble(&self, k: &SlotMatrix) -> Dense {
        assemble(k, &node_rows(&self.patch.weights, XI))
    }

    fn stick_slots(&self, parts: FrictionParts) -> SlotMatrix {
        stick_tangent(&self.frame, &self.trial(), EPS_T, parts)
    }

    fn slip_slots(&self, parts: FrictionParts) -> SlotMatrix {
        slip_tangent(&self.frame, &self.trial(), &NORMAL, MU, EPS_T, parts)
    }

    fn both(&self, parts: FrictionParts) -> [(&'static str, Dense, Dense); 2] {
        [
            (
                "stick",
                self.assemble(&self.stick_slots(parts)),
                self.stick(),
            ),
            (
                "slip",
                self.assemble(&self.slip_slots(parts)),
                self.slip(NORMAL.dn),
            ),
        ]
    }
}

/// Rows and columns of the slave node.
fn slave_block(k: &Dense) -> Dense {
    k[48..].iter().map(|row| row[48..].to_vec()).collect()
}

fn minus(a: &Dense, b: &Dense) -> Dense {
    (a.iter().zip(b))
        .map(|(a, b)| a.iter().zip(b).map(|(a, b)| a - b).collect())
        .collect()
}

#[test]
fn complete_form_is_the_exact_tangent_at_no_distance_and_first_order_beyond() {
    for shape in SHAPES {
        let at = setup(shape, 0.0);
        for (what, k, exact) in at.both(FrictionParts::COMPLETE) {
            let error = relative(&k, &exact);
            assert!(error < 1e-12, "{shape:?}, {what}: {error:e}");
        }
        let errors = [-1e-2, -1e-3].map(|ratio| {
            (setup(shape, ratio).both(FrictionParts::COMPLETE))
                .map(|(_, k, exact)| relative(&k, &exact))
        });
        for i in 0..2 {
            let slope = (errors[0][i] / errors[1][i]).log10();
            assert!(
                (slope - 1.0).abs() < 0.1,
                "{shape:?}: slope {slope} of {errors:?}"
            );
        }
    }
}

#[test]
fn published_form_is_exact_on_a_rigid_master_at_no_distance_and_first_order_beyond() {
    for shape in SHAPES {
        let errors = [0.0, -1e-2, -1e-3].map(|ratio| {
            (setup(shape, ratio).both(FrictionParts::PUBLISHED))
                .map(|(_, k, exact)| relative(&slave_block(&k), &slave_block(&exact)))
        });
        for i in 0..2 {
            assert!(errors[0][i] < 1e-12, "{shape:?}: {errors:?}");
            let slope = (errors[1][i] / errors[2][i]).log10();
            assert!(
                (slope - 1.0).abs() < 0.1,
                "{shape:?}: slope {slope} of {errors:?}"
            );
        }
    }
}

/// On a master that moves the published form misses the geometric part by tens of percents at every distance (the normal traction
/// decoupled from the gap, and the main part taken off both).
#[test]
fn published_form_misses_parts_on_a_master_that_moves() {
    // Sticking and sliding.
    let expected = [[0.5867, 0.7897], [0.5889, 0.7933], [0.5846, 0.7863]];
    for (shape, expected) in SHAPES.into_iter().zip(expected) {
        let at = setup(shape, 0.0);
        let decoupled = Normal { dn: 0.0, ..NORMAL };
        let slip = |parts| {
            let k = slip_tangent(&at.frame, &at.trial(), &decoupled, MU, EPS_T, parts);
            at.assemble(&k)
        };
        let main = slip(FrictionParts::MAIN);
        let exact = minus(&at.slip(0.0), &main);
        let missed = |parts| relative(&minus(&slip(parts), &main), &exact);
        let slip_error = missed(FrictionParts::PUBLISHED);
        assert!(missed(FrictionParts::COMPLETE) < 1e-12);
        let stick = |parts| at.assemble(&at.stick_slots(parts));
        let main = stick(FrictionParts::MAIN);
        let exact = minus(&at.stick(), &main);
        let missed = |parts| relative(&minus(&stick(parts), &main), &exact);
        let stick_error = missed(FrictionParts::PUBLISHED);
        assert!(missed(FrictionParts::COMPLETE) < 1e-12);
        for (error, expected) in [stick_error, slip_error].into_iter().zip(expected) {
            assert!((error - expected).abs() < 1e-4, "{shape:?}: {error}");
        }
    }
}

#[test]
fn parts_switch_by_themselves() {
    let at = setup(Shape::Saddle, 0.0);
    let none = FrictionParts::MAIN;
    let single = [
        FrictionParts {
            rotational: true,
            ..none
        },
        FrictionParts {
            curvature: true,
            ..none
        },
        FrictionParts {
            normal_rotational: true,
            ..none
        },
        FrictionParts {
            metric_rotational: true,
            ..none
        },
    ];
    let slip = |parts| at.slip_slots(parts);
    let stick = |parts| at.stick_slots(parts);
    let mut sum = slip(none);
    for (k, parts) in single.into_iter().enumerate() {
        let part = slip(parts) - slip(none);
        assert!(part.norm() > 1e-2, "part {k}");
        sum += part;
        // All but the metric-rotational part are those of sticking with the traction at the limit, and symmetric.
        let alike = stick_tangent(&at.frame, &at.limit(), EPS_T, parts)
            - stick_tangent(&at.frame, &at.limit(), EPS_T, none);
        let skew = (part - part.transpose()).norm();
        if k < 3 {
            assert!((part - alike).norm() < 1e-14 && skew < 1e-15, "part {k}");
        } else {
            assert!(alike.norm() == 0.0 && skew > 1e-2, "part {k}");
        }
    }
    assert!((slip(FrictionParts::COMPLETE) - sum).norm() < 1e-14);
    for parts in [none, FrictionParts::PUBLISHED, FrictionParts::COMPLETE] {
        let k = stick(parts);
        assert!((k - k.transpose()).norm() < 1e-15 * k.norm());
    }
    // Only the pressure and the metric make sliding unsymmetric.
    let k = slip(none);
    let coupling = at.limit().norm() / -NORMAL.n * NORMAL.dn * 2f64.sqrt();
    assert!(((k - k.transpose()).norm() - coupling).abs() < 1e-14);
    // Sticking, the main part is the penalty in the tangent plane.
    let block = stick(none).fixed_view::<3, 3>(0, 0) / EPS_T;
    let n = at.frame.n;
    assert!((block - (nalgebra::Matrix3::identity() - n * n.transpose())).norm() < 1e-14);
}

/// `K (omega x x) = omega x R`: a rigid rotation of the pair turns the residual. Without the normal-rotational part it does not.
#[test]
fn rigid_motions_of_the_pair_turn_the_residual() {
    let omega = Vector3::new(0.3, -0.7, 0.5);
    for (shape, missed) in SHAPES.into_iter().zip([0.6236, 0.5843, 0.6304]) {
        let at = setup(shape, 0.0);
        let mut motion = Slots::zeros();
        for j in 0..2 {
            (motion.fixed_rows_mut::<3>(3 * j + 3)).copy_from(&omega.cross(&at.frame.rho_i[j]));
        }
        for (what, traction, complete, published) in [
            (
                "stick",
                at.trial(),
                at.stick_slots(FrictionParts::COMPLETE),
                at.stick_slots(FrictionParts::PUBLISHED),
            ),
            (
                "slip",
                at.limit(),
                at.slip_slots(FrictionParts::COMPLETE),
                at.slip_slots(FrictionParts::PUBLISHED),
            ),
        ] {
            let expected = omega.cross(&traction);
            assert!(expected.norm() > 1e-2);
            let mut turned = Slots::zeros();
            turned.fixed_rows_mut::<3>(0).copy_from(&expected);
            let error = (complete * motion - turned).norm() / expected.norm();
            assert!(error < 1e-13, "{shape:?}, {what}: {error:e}");
            let error = (published * motion - turned).norm() / expected.norm();
            assert!((error - missed).abs() < 1e-4, "{shape:?}, {what}: {error}");
        }
    }
}

/// The exact tangent at hand is the derivative of what it says: a reference must not be taken on trust.
#[test]
fn the_reference_itself_is_symmetric_where_it_must_be() {
    for shape in SHAPES {
        for ratio in [0.0, -0.05] {
            let at = setup(shape, ratio);
            let k = at.geometric(T);
            let skew = (0..51).flat_map(|i| (0..i).map(move |j| (i, j)));
            let skew: f64 = skew
                .map(|(i, j)| (k[i][j] - k[j][i]).powi(2))
                .sum::<f64>()
                .sqrt();
            assert!(skew < 1e-12 * norm(&k), "{shape:?} at {ratio}: {skew:e}");
        }
    }
}
