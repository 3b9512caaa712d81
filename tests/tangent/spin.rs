//! Rigid bodies whose motion is unknown: force, moment and tangent over translation and spin, against hyper-dual numbers
//! of the energy with the closest point solved again.
use crate::cases::{EPS_N, Hardening, energy};
use crate::support::{self, Patch, Shape, V};
use crate::surface::{Held, Surface};
use covact::contact::kernel::{self, SlotMatrix, Slots};
use covact::contact::law::NormalLaw;
use covact::contact::point::{PointGeometry, respond};
use covact::contact::rigid::Exact;
use covact::contact::spin::{RigidRows, moment_turn, node_block};
use covact_geometry::Frame;
use nalgebra::{DMatrix, DVector, Matrix3};
use num_dual::{Dual64, DualNum, HyperDual64};

type Point = (PointGeometry, [f64; 2], V<f64>, V<f64>);

/// A point under the patch: geometry, parameters, slave point, foot.
fn point(p: &Patch, held: Held) -> Point {
    let xi = match held {
        Held::Face => [0.43, 0.58],
        Held::Edge(0) => [0.4, 0.0],
        Held::Edge(_) => [1.0, 0.7],
        Held::Vertex => [1.0, 0.0],
    };
    let jet = support::jet(&p.points, &p.weights, xi);
    let frame = Frame::new(&jet, 1.0).unwrap();
    let down = V::new(0.1, 0.06, -0.9);
    let (d, geometry): (V<f64>, fn(_, _, _) -> _) = match held {
        Held::Face => (-frame.n * 0.11, |_, _, _| unreachable!()),
        Held::Vertex => (down * 0.13, |_, d, xi3| PointGeometry::Vertex { d, xi3 }),
        Held::Edge(k) => {
            let t = jet.rho_i[k].normalize();
            let d = (down - t * t.dot(&down)) * 0.13;
            if k == 0 {
                (d, |jet, d, xi3| {
                    PointGeometry::edge(&jet, [1.0, 0.0], d, xi3)
                })
            } else {
                (d, |jet, d, xi3| {
                    PointGeometry::edge(&jet, [0.0, 1.0], d, xi3)
                })
            }
        }
    };
    let geometry = match held {
        Held::Face => PointGeometry::Face { frame, xi3: -0.11 },
        _ => geometry(jet, d, -d.norm()),
    };
    (geometry, xi, jet.rho + d, jet.rho)
}

/// `exp(theta) v` to third order, which is exact in value and first two derivatives at `theta = 0`.
fn turn<D: DualNum<f64> + Copy>(theta: &V<D>, v: &V<D>) -> V<D> {
    let first = theta.cross(v);
    let second = theta.cross(&first);
    let third = theta.cross(&second);
    v + first + second * D::from(0.5) + third * D::from(1.0 / 6.0)
}

/// Distance vector in the body's coordinates: the body moves by `c` and turns about `centre`, so the slave point moves
/// the other way.
fn distance<D: DualNum<f64> + Copy>(
    p: &Patch,
    centre: &V<f64>,
    at: (&[f64; 2], Held),
    [q, c, theta]: [V<D>; 3],
) -> V<D> {
    let surface = Surface::Patch { weights: p.weights };
    let x: Vec<V<D>> = p.points.iter().map(|x| x.map(D::from)).collect();
    let centre = centre.map(D::from);
    let local = centre + turn(&-theta, &(q - c - centre));
    let xi = surface.project(0, &x, &local, *at.0, at.1, 4);
    local - surface.jet(0, &x, xi).rho
}

/// Gradient and Hessian of the energy over slave point, translation and spin.
fn reference(
    p: &Patch,
    centre: &V<f64>,
    q: &V<f64>,
    at: (&[f64; 2], Held),
) -> (DVector<f64>, DMatrix<f64>) {
    let (mut g, mut h) = (DVector::zeros(9), DMatrix::zeros(9, 9));
    for i in 0..9 {
        for j in 0..9 {
            let seed = |block: usize, v: &V<f64>| {
                V::from_fn(|c, _| {
                    let is = |k: usize| f64::from(u8::from(3 * block + c == k));
                    HyperDual64::new(v[c], is(i), is(j), 0.0)
                })
            };
            let zero = V::zeros();
            let d = distance(p, centre, at, [seed(0, q), seed(1, &zero), seed(2, &zero)]);
            let e = energy(d.dot(&d));
            g[i] = e.eps1;
            h[(i, j)] = e.eps1eps2;
        }
    }
    (g, h)
}

/// The same from the slots: a slave node and a rigid body.
fn assembled(rows: &RigidRows, r: &Slots, k: &SlotMatrix) -> (DVector<f64>, DMatrix<f64>) {
    let (mut f, mut out) = (DVector::zeros(9), DMatrix::zeros(9, 9));
    let slave = [1.0, 0.0, 0.0];
    let columns = rows.columns(k);
    let coupling = node_block(&columns, &slave);
    f.rows_mut(0, 3)
        .copy_from(&kernel::assemble_force(r, &slave));
    f.rows_mut(3, 6).copy_from(&rows.force(r));
    out.view_mut((0, 0), (3, 3))
        .copy_from(&kernel::assemble_block(k, &slave, &slave));
    out.view_mut((0, 3), (3, 6)).copy_from(&coupling);
    out.view_mut((3, 0), (6, 3))
        .copy_from(&coupling.transpose());
    out.view_mut((3, 3), (6, 6))
        .copy_from(&rows.tangent(r, &columns));
    (f, out)
}

const PLACES: [Held; 4] = [Held::Face, Held::Edge(0), Held::Edge(1), Held::Vertex];

#[test]
fn translation_and_spin_of_a_rigid_body() {
    let centre = V::new(0.7, -0.4, 1.3);
    for shape in [Shape::Dome, Shape::Bowl, Shape::Saddle] {
        for held in PLACES {
            let name = format!("{shape:?}, {held:?}");
            let p = support::patch(shape);
            let (geometry, xi, q, rho) = point(&p, held);
            let (g, h) = reference(&p, &centre, &q, (&xi, held));
            let normal = Hardening.response(geometry.xi3());
            let (r, k) = respond(&geometry, &normal, &Exact);
            let (f, k) = assembled(&RigidRows::new(rho - centre, &geometry), &r, &k);
            assert!(g.rows(6, 3).norm() > 0.1, "{name}: no moment");
            let error = (&f - &g).norm() / g.norm();
            assert!(error < 1e-11, "{name}: force and moment {error:e}");
            for (part, rows, columns) in [
                ("slave, slave", (0, 3), (0, 3)),
                ("slave, translation", (0, 3), (3, 3)),
                ("slave, spin", (0, 3), (6, 3)),
                ("translation, translation", (3, 3), (3, 3)),
                ("translation, spin", (3, 3), (6, 3)),
                ("spin, spin", (6, 3), (6, 3)),
            ] {
                let cut = |k: &DMatrix<f64>| {
                    k.view((rows.0, columns.0), (rows.1, columns.1))
                        .into_owned()
                };
                let error = crate::cases::relative(&cut(&k), &cut(&h));
                assert!(error < 1e-11, "{name}: {part}: {error:e}");
            }
            assert!(
                (&k - k.transpose()).norm() < 1e-13 * k.norm(),
                "{name}: symmetry"
            );
        }
    }
}

#[test]
fn the_moment_in_space_turns_with_the_body() {
    // Moment on the body about its moving centre, m = arm x force, differentiated as it stands.
    let centre = V::new(0.7, -0.4, 1.3);
    for held in PLACES {
        let p = support::patch(Shape::Saddle);
        let (geometry, xi, q, rho) = point(&p, held);
        let mut reference = Matrix3::zeros();
        for dof in 0..3 {
            let theta = V::from_fn(|c, _| Dual64::new(0.0, f64::from(u8::from(c == dof))));
            let still = V::from_element(Dual64::from(0.0));
            let d = distance(
                &p,
                &centre,
                (&xi, held),
                [q.map(Dual64::from), still, theta],
            );
            // In space again; d = q - rho, and the force on the slave side is secant d.
            let d = turn(&theta, &d);
            let scale = (d.dot(&d) * 20.0 + 1.0) * EPS_N;
            let arm = q.map(Dual64::from) - d - centre.map(Dual64::from);
            let moment = d.cross(&arm) * scale;
            (0..3).for_each(|c| reference[(c, dof)] = moment[c].eps);
        }
        let (r, k) = respond(&geometry, &Hardening.response(geometry.xi3()), &Exact);
        let rows = RigidRows::new(rho - centre, &geometry);
        let (f, k) = assembled(&rows, &r, &k);
        let moment = V::new(f[6], f[7], f[8]);
        let turned = moment_turn(&moment);
        assert!(turned.norm() > 0.05, "{held:?}: no moment");
        let spin: Matrix3<f64> = k.fixed_view::<3, 3>(6, 6).into_owned() + turned;
        let error = (spin - reference).norm() / reference.norm();
        assert!(error < 1e-11, "{held:?}: {error:e}");
    }
}
