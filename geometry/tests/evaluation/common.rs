//! Patches with known ingredients, and an evaluator written in another way: de Boor's corner cutting on control points,
//! differentiated by hyper-hyper-dual numbers. The library sums basis functions instead.

use covact_geometry::{NurbsPatch, Vec3};
use num_dual::{DualNum, HyperHyperDual64};

/// Pseudo-random numbers in [0, 1), the same in every run (splitmix64).
pub struct Random(pub u64);

impl Random {
    pub fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 11) as f64 / (1u64 << 53) as f64
    }
}

/// Kinds of knot vectors.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Knots {
    /// Clamped, spans of unequal length (1 : 4 at most).
    Clamped,
    /// Clamped, with a knot of each multiplicity up to the degree.
    Repeated,
    /// Not clamped, unequal spans, as a periodic surface has them.
    Unclamped,
}

pub fn knots(kind: Knots, degree: usize, random: &mut Random) -> Vec<f64> {
    let mut step = || 0.25 + 0.75 * random.next();
    let mut knots = Vec::new();
    match kind {
        Knots::Unclamped => {
            let mut t = -1.0;
            for _ in 0..2 * degree + 5 {
                knots.push(t);
                t += step();
            }
        }
        Knots::Clamped | Knots::Repeated => {
            knots.resize(degree + 1, 0.0);
            let mut t = 0.0;
            for inner in 1..=4 {
                t += step();
                let multiplicity = if kind == Knots::Repeated {
                    inner.min(degree)
                } else {
                    1
                };
                knots.resize(knots.len() + multiplicity, t);
            }
            if kind == Knots::Repeated {
                t += step();
                knots.resize(knots.len() + degree, t);
            }
            t += step();
            knots.resize(knots.len() + degree + 1, t);
        }
    }
    knots
}

/// A wavy sheet with random control points; the decimal logarithms of the weights are spread over `spread`.
pub fn patch(degree: [usize; 2], kind: [Knots; 2], spread: f64, seed: u64) -> NurbsPatch {
    let mut random = Random(seed);
    let knots = [0, 1].map(|d| knots(kind[d], degree[d], &mut random));
    let counts = [0, 1].map(|d| knots[d].len() - degree[d] - 1);
    let mut points = Vec::new();
    let mut weights = Vec::new();
    for j in 0..counts[1] {
        for i in 0..counts[0] {
            let jitter = Vec3::from_fn(|_, _| random.next() - 0.5) * 0.6;
            let (x, y) = (i as f64, j as f64);
            points.push(Vec3::new(x, y, (0.7 * x).sin() * (0.5 * y).cos()) + jitter);
            weights.push(10f64.powf(spread * (random.next() - 0.5)));
        }
    }
    let weights = (spread > 0.0).then_some(weights);
    NurbsPatch::new(degree, knots, counts, &points, weights.as_deref()).unwrap()
}

/// De Boor's algorithm for one curve, in the span `knots[i] <= t < knots[i+1]`.
fn de_boor<D: DualNum<f64> + Copy>(
    degree: usize,
    knots: &[f64],
    i: usize,
    points: &[[D; 4]],
    t: D,
) -> [D; 4] {
    let mut d: Vec<[D; 4]> = points[i - degree..=i].to_vec();
    for level in 1..=degree {
        for j in (level..=degree).rev() {
            let (low, high) = (knots[i - degree + j], knots[i + 1 + j - level]);
            let alpha = (t - low) / (high - low);
            d[j] = std::array::from_fn(|c| d[j - 1][c] * (-alpha + 1.0) + d[j][c] * alpha);
        }
    }
    d[degree]
}

/// Last span that starts at or before `t`.
fn scan(degree: usize, knots: &[f64], t: f64) -> usize {
    let last = knots.len() - degree - 2;
    (degree..=last)
        .rev()
        .find(|&i| knots[i] <= t && knots[i] < knots[i + 1])
        .unwrap()
}

/// Surface point of the patch by corner cutting, first along xi1 and then along xi2.
pub fn oracle<D: DualNum<f64> + Copy>(patch: &NurbsPatch, xi: [D; 2]) -> [D; 3] {
    let [p, q] = patch.degree();
    let columns = patch.counts()[0];
    let i = scan(p, patch.knots(0), xi[0].re());
    let j = scan(q, patch.knots(1), xi[1].re());
    let rows: Vec<[D; 4]> = patch
        .homogeneous()
        .chunks(columns)
        .map(|row| {
            let row: Vec<[D; 4]> = row.iter().map(|x| x.map(D::from)).collect();
            de_boor(p, patch.knots(0), i, &row, xi[0])
        })
        .collect();
    let [x, y, z, w] = de_boor(q, patch.knots(1), j, &rows, xi[1]);
    [x / w, y / w, z / w]
}

/// Value and all derivatives to third order of `f`: 0 | 1, 2 | 11, 12, 22 | 111, 112, 122, 222.
pub fn derivatives(
    f: impl Fn([HyperHyperDual64; 2]) -> [HyperHyperDual64; 3],
    xi: [f64; 2],
) -> [Vec3; 10] {
    // The three dual units go to the directions of the third derivative that is wanted.
    let run = |directions: [usize; 3]| {
        let seed = |dir: usize| {
            let unit = |k: usize| if directions[k] == dir { 1.0 } else { 0.0 };
            HyperHyperDual64::new(xi[dir], unit(0), unit(1), unit(2), 0.0, 0.0, 0.0, 0.0)
        };
        f([seed(0), seed(1)])
    };
    let (f111, f112, f122, f222) = (
        run([0, 0, 0]),
        run([0, 0, 1]),
        run([0, 1, 1]),
        run([1, 1, 1]),
    );
    let part = |f: &[HyperHyperDual64; 3], get: fn(&HyperHyperDual64) -> f64| {
        Vec3::new(get(&f[0]), get(&f[1]), get(&f[2]))
    };
    [
        part(&f112, |x| x.re),
        part(&f112, |x| x.eps1),
        part(&f112, |x| x.eps3),
        part(&f112, |x| x.eps1eps2),
        part(&f112, |x| x.eps1eps3),
        part(&f122, |x| x.eps2eps3),
        part(&f111, |x| x.eps1eps2eps3),
        part(&f112, |x| x.eps1eps2eps3),
        part(&f122, |x| x.eps1eps2eps3),
        part(&f222, |x| x.eps1eps2eps3),
    ]
}

/// A third-order jet as a list in the order of [`derivatives`].
pub fn list(jet: &covact_geometry::Jet3) -> [Vec3; 10] {
    let covact_geometry::Jet { rho, rho_i, rho_ij } = jet.jet;
    let r = &jet.rho_ijk;
    [
        rho, rho_i[0], rho_i[1], rho_ij[0], rho_ij[1], rho_ij[2], r[0], r[1], r[2], r[3],
    ]
}

/// Order of the derivative in each place of such a list.
pub const ORDER: [usize; 10] = [0, 1, 1, 2, 2, 2, 3, 3, 3, 3];

/// Parameters inside the domain, `count` of them, not on knots.
pub fn samples(patch: &NurbsPatch, count: usize, seed: u64) -> Vec<[f64; 2]> {
    let mut random = Random(seed);
    let [[a, b], [c, d]] = patch.domain();
    (0..count)
        .map(|_| [a + (b - a) * random.next(), c + (d - c) * random.next()])
        .collect()
}

/// Largest difference over all samples per order of derivative, divided by the largest reference value of that order
/// or the order below (so that derivatives that vanish have a scale).
pub fn worst(pairs: &[([Vec3; 10], [Vec3; 10])]) -> [f64; 4] {
    let (mut error, mut scale) = ([0f64; 4], [0f64; 4]);
    for (ours, reference) in pairs {
        for k in 0..10 {
            error[ORDER[k]] = error[ORDER[k]].max((ours[k] - reference[k]).norm());
            scale[ORDER[k]] = scale[ORDER[k]].max(reference[k].norm());
        }
    }
    assert!(scale[0] > 0.0 && scale[1] > 0.0, "nothing to compare");
    assert!(error.iter().all(|e| e.is_finite()));
    [0, 1, 2, 3].map(|m| error[m] / scale[m].max(scale[m.saturating_sub(1)]))
}
