//! Tables of the parent cube of Q18: shape functions at Gauss and tying points, and the weights of the strain
//! interpolation.
//!
//! The element is biquadratic in (r, s) and linear in t: `x = sum_a N_a(r, s) (m_a + t d_a)` with the mid-surface
//! positions `m_a` and half directors `d_a` of nine places `a = i + 3 j`. Inside the element these 18 vectors are the
//! unknowns, numbered m first; a row of 54 numbers holds them axis by axis: `18 axis + b`.
use std::sync::LazyLock;

/// Gauss points: 3 x 3 x 2, numbered `i + 3 j + 9 k`.
pub(super) const POINTS: usize = 18;
/// Samples of the strain that the assumed field is made of.
pub(super) const SAMPLES: usize = 53;

/// 1/sqrt(3): Gauss points along t, tying points of the directions that are tied at two points.
const A: f64 = 0.577_350_269_189_625_8;
/// sqrt(3/5): Gauss points along r and s, tying points of the directions that are tied at three points.
const B: f64 = 0.774_596_669_241_483_4;

const TWO: [f64; 2] = [-A, A];
const THREE: [f64; 3] = [-B, 0.0, B];

/// Strain component of a sample, by its pair of directions.
#[derive(Debug, Clone, Copy)]
pub(super) struct Sample {
    /// Directions i, j of `E_ij`; shears are `2 E_ij`.
    pub directions: [usize; 2],
    /// Derivatives of position along both: `x_,i = sum_b n[0][b] y_b`.
    pub n: [[f64; 18]; 2],
}

/// A Gauss point.
#[derive(Debug, Clone, Copy)]
pub(super) struct Point {
    /// Natural coordinates.
    pub xi: [f64; 3],
    /// Weight in the parent cube.
    pub weight: f64,
    /// Derivatives along r, s, t.
    pub n: [[f64; 18]; 3],
    /// For every Voigt component (11, 22, 33, 12, 23, 13): first sample and the weights of consecutive ones.
    pub tied: [(usize, [f64; 9]); 6],
}

/// Samples tied per component.
pub(super) const TIED: [usize; 6] = [6, 6, 9, 4, 6, 6];

pub(super) struct Tables {
    pub points: [Point; POINTS],
    pub samples: [Sample; SAMPLES],
    /// Derivatives at the centre.
    pub centre: [[f64; 18]; 3],
}

pub(super) static TABLES: LazyLock<Box<Tables>> = LazyLock::new(|| Box::new(tables()));

/// Quadratic Lagrange functions of the nodes -1, 0, 1, and their derivatives.
fn quadratic(x: f64) -> [[f64; 3]; 2] {
    [
        [0.5 * x * (x - 1.0), 1.0 - x * x, 0.5 * x * (x + 1.0)],
        [x - 0.5, -2.0 * x, x + 0.5],
    ]
}

/// Derivatives of position along r, s, t as weights of the 18 vectors.
fn derivatives([r, s, t]: [f64; 3]) -> [[f64; 18]; 3] {
    let (fr, fs) = (quadratic(r), quadratic(s));
    let mut n = [[0.0; 18]; 3];
    for a in 0..9 {
        let (i, j) = (a % 3, a / 3);
        let along_r = fr[1][i] * fs[0][j];
        let along_s = fr[0][i] * fs[1][j];
        (n[0][a], n[0][9 + a]) = (along_r, t * along_r);
        (n[1][a], n[1][9 + a]) = (along_s, t * along_s);
        n[2][9 + a] = fr[0][i] * fs[0][j];
    }
    n
}

/// Values at `x` of the Lagrange polynomials through `nodes`.
fn lagrange(nodes: &[f64], x: f64) -> [f64; 3] {
    let mut out = [0.0; 3];
    for (k, value) in out.iter_mut().enumerate().take(nodes.len()) {
        *value = (nodes.iter().enumerate())
            .filter(|(m, _)| *m != k)
            .map(|(_, node)| (x - node) / (nodes[k] - node))
            .product();
    }
    out
}

/// Tying points in the plane of a component, and the planes t at which it is tied.
fn tying(component: usize) -> (&'static [f64], &'static [f64], &'static [f64]) {
    match component {
        0 => (&TWO, &THREE, &TWO),
        1 => (&THREE, &TWO, &TWO),
        2 => (&[-1.0, 0.0, 1.0], &[-1.0, 0.0, 1.0], &[0.0]),
        3 => (&TWO, &TWO, &TWO),
        4 => (&THREE, &TWO, &[0.0]),
        _ => (&TWO, &THREE, &[0.0]),
    }
}

fn tables() -> Tables {
    let mut samples = Vec::with_capacity(SAMPLES);
    let mut first = [0; 6];
    for (component, first) in first.iter_mut().enumerate() {
        *first = samples.len();
        let (i, j) = crate::shell::VOIGT[component];
        let (rs, ss, ts) = tying(component);
        for &t in ts {
            for &s in ss {
                for &r in rs {
                    let n = derivatives([r, s, t]);
                    samples.push(Sample {
                        directions: [i, j],
                        n: [n[i], n[j]],
                    });
                }
            }
        }
    }
    let weights = [5.0 / 9.0, 8.0 / 9.0, 5.0 / 9.0];
    let points = std::array::from_fn(|g| {
        let (i, j, k) = (g % 3, g / 3 % 3, g / 9);
        let xi = [THREE[i], THREE[j], TWO[k]];
        let tied = std::array::from_fn(|component| {
            let (rs, ss, ts) = tying(component);
            let (wr, ws) = (lagrange(rs, xi[0]), lagrange(ss, xi[1]));
            let mut w = [0.0; 9];
            for (m, w) in w.iter_mut().enumerate().take(rs.len() * ss.len()) {
                *w = wr[m % rs.len()] * ws[m / rs.len()];
            }
            let plane = if ts.len() == 2 { k } else { 0 };
            (first[component] + plane * rs.len() * ss.len(), w)
        });
        Point {
            xi,
            weight: weights[i] * weights[j],
            n: derivatives(xi),
            tied,
        }
    });
    let samples: [Sample; SAMPLES] = std::array::from_fn(|k| samples[k]);
    Tables {
        points,
        samples,
        centre: derivatives([0.0; 3]),
    }
}
