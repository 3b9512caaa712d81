//! A bicubic rational patch whose control points may be dual numbers, with the closest point re-solved in the same
//! arithmetic, so that derivatives go through the projection.
use covact_geometry::{Frame, Jet};
use nalgebra::Vector3;
use num_dual::{Dual64, DualNum};

pub type V<D> = Vector3<D>;

/// Control net 4 x 4 (first direction fastest) with unequal weights.
#[derive(Clone, Copy)]
pub struct Patch {
    pub points: [V<f64>; 16],
    pub weights: [f64; 16],
    /// Radius of curvature at the middle, the length that penetrations are measured by.
    pub radius: f64,
}

fn bernstein<D: DualNum<f64> + Copy>(t: D) -> [[D; 4]; 3] {
    let s = D::one() - t;
    [
        [s * s * s, t * s * s * 3.0, t * t * s * 3.0, t * t * t],
        [
            -s * s * 3.0,
            s * s * 3.0 - t * s * 6.0,
            t * s * 6.0 - t * t * 3.0,
            t * t * 3.0,
        ],
        [s * 6.0, t * 6.0 - s * 12.0, s * 6.0 - t * 12.0, t * 6.0],
    ]
}

/// Rational basis: value, derivatives 1, 2, 11, 12, 22 of the sixteen functions.
pub fn basis<D: DualNum<f64> + Copy>(weights: &[f64; 16], xi: [D; 2]) -> [[D; 16]; 6] {
    let (u, v) = (bernstein(xi[0]), bernstein(xi[1]));
    let orders = [(0, 0), (1, 0), (0, 1), (2, 0), (1, 1), (0, 2)];
    let plain = orders
        .map(|(a, b)| std::array::from_fn::<D, 16, _>(|k| u[a][k % 4] * v[b][k / 4] * weights[k]));
    let w = plain.map(|row| row.iter().fold(D::zero(), |s, x| s + *x));
    let mut r = [[D::zero(); 16]; 6];
    for k in 0..16 {
        let p = |o: usize| plain[o][k];
        let r0 = p(0) / w[0];
        let r1 = (p(1) - r0 * w[1]) / w[0];
        let r2 = (p(2) - r0 * w[2]) / w[0];
        let r11 = (p(3) - r1 * w[1] * 2.0 - r0 * w[3]) / w[0];
        let r12 = (p(4) - r1 * w[2] - r2 * w[1] - r0 * w[4]) / w[0];
        let r22 = (p(5) - r2 * w[2] * 2.0 - r0 * w[5]) / w[0];
        for (o, value) in [r0, r1, r2, r11, r12, r22].into_iter().enumerate() {
            r[o][k] = value;
        }
    }
    r
}

pub fn jet<D: DualNum<f64> + Copy>(points: &[V<D>; 16], weights: &[f64; 16], xi: [D; 2]) -> Jet<D> {
    let r = basis(weights, xi)
        .map(|n| (0..16).fold(V::from_element(D::zero()), |s, k| s + points[k] * n[k]));
    Jet {
        rho: r[0],
        rho_i: [r[1], r[2]],
        rho_ij: [r[3], r[4], r[5]],
    }
}

/// Closest point by undamped Newton from `start`; enough steps for the derivative parts to converge too.
pub fn project<D: DualNum<f64> + Copy>(
    points: &[V<D>; 16],
    weights: &[f64; 16],
    q: &V<D>,
    start: [f64; 2],
) -> [D; 2] {
    let mut xi = start.map(D::from);
    for _ in 0..12 {
        let j = jet(points, weights, xi);
        let d = q - j.rho;
        let g = [j.rho_i[0].dot(&d), j.rho_i[1].dot(&d)];
        let f11 = j.rho_i[0].dot(&j.rho_i[0]) - j.rho_ij[0].dot(&d);
        let f12 = j.rho_i[0].dot(&j.rho_i[1]) - j.rho_ij[1].dot(&d);
        let f22 = j.rho_i[1].dot(&j.rho_i[1]) - j.rho_ij[2].dot(&d);
        let det = f11 * f22 - f12 * f12;
        xi[0] += (f22 * g[0] - f12 * g[1]) / det;
        xi[1] += (f11 * g[1] - f12 * g[0]) / det;
    }
    xi
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Shape {
    Dome,
    Bowl,
    Saddle,
}

/// Quadratic height field over a distorted net; the slave side is +z.
pub fn patch(shape: Shape) -> Patch {
    let radius = 2.0;
    let (k1, k2) = match shape {
        Shape::Dome => (-1.0, -0.8),
        Shape::Bowl => (1.0, 0.7),
        Shape::Saddle => (1.0, -0.9),
    };
    let points = std::array::from_fn(|k| {
        let (i, j) = ((k % 4) as f64 / 3.0 - 0.5, (k / 4) as f64 / 3.0 - 0.5);
        let x = i + 0.06 * (3.0 * j).sin();
        let y = 1.1 * j + 0.05 * i * i;
        V::new(
            x,
            y,
            0.5 * (k1 * x * x + k2 * y * y) / radius + 0.01 * i * j,
        )
    });
    let weights = std::array::from_fn(|k| 1.0 + 0.4 * ((7 * k + 3) % 11) as f64 / 11.0);
    Patch {
        points,
        weights,
        radius,
    }
}

/// Slave point over `xi` at normal coordinate `xi3`.
pub fn slave_at(p: &Patch, xi: [f64; 2], xi3: f64) -> V<f64> {
    let frame = Frame::new(&jet(&p.points, &p.weights, xi), 1.0).expect("regular patch");
    frame.rho + frame.n * xi3
}

/// Derivative of a vector function of all 51 degrees of freedom (16 master points, then the slave point).
pub fn derivative(
    p: &Patch,
    slave: &V<f64>,
    f: impl Fn(&[V<Dual64>; 16], &V<Dual64>) -> Vec<Dual64>,
) -> Vec<Vec<f64>> {
    let columns: Vec<Vec<f64>> = (0..51)
        .map(|dof| {
            let seed = |node: usize, v: &V<f64>| {
                V::new(0, 1, 2).map(|c: i32| {
                    let eps = if 3 * node + c as usize == dof {
                        1.0
                    } else {
                        0.0
                    };
                    Dual64::new(v[c as usize], eps)
                })
            };
            let points = std::array::from_fn(|k| seed(k, &p.points[k]));
            let s = seed(16, slave);
            f(&points, &s).iter().map(|x| x.eps).collect()
        })
        .collect();
    let rows = columns[0].len();
    (0..rows)
        .map(|r| columns.iter().map(|c| c[r]).collect())
        .collect()
}

/// Frobenius norm.
pub fn norm(m: &[Vec<f64>]) -> f64 {
    m.iter().flatten().map(|x| x * x).sum::<f64>().sqrt()
}

/// Relative difference in the Frobenius norm; the reference must not vanish.
pub fn relative(m: &[Vec<f64>], reference: &[Vec<f64>]) -> f64 {
    let scale = norm(reference);
    assert!(
        scale > 1e-6,
        "compared with nothing: reference norm {scale}"
    );
    let diff: f64 = (m.iter().flatten())
        .zip(reference.iter().flatten())
        .map(|(a, b)| (a - b) * (a - b))
        .sum();
    diff.sqrt() / scale
}
