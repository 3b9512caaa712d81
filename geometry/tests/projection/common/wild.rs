//! Random patches of all degrees with weights over several orders of magnitude, and reference distances by dense sampling.

use covact_geometry::{NurbsPatch, Vec3};

use super::{Random, clamped, refine};

/// Sample points in each direction.
const SAMPLES: usize = 49;
/// Samples that local iterations start from.
const STARTS: usize = 4;

/// A random patch of degrees 1 to 7 with up to three spans in each direction. Its weights spread over `orders` orders of
/// magnitude; none for a polynomial patch. Every other net is scattered at random, the rest are bumpy sheets.
pub fn patch(seed: u64, orders: f64) -> NurbsPatch {
    let mut random = Random(seed.wrapping_mul(0x2545_f491_4f6c_dd1d) + 1);
    let mut whole = |most: usize| (random.next() * most as f64) as usize;
    let degree = [1 + whole(7), 1 + whole(7)];
    let counts = degree.map(|p| p + 1 + whole(3));
    let scattered = seed % 2 == 1;
    let (mut points, mut weights) = (Vec::new(), Vec::new());
    for j in 0..counts[1] {
        for i in 0..counts[0] {
            let at = |k: usize, n: usize| k as f64 / (n - 1) as f64;
            let mut any = || random.between(-0.5, 0.5);
            let noise = Vec3::new(any(), any(), any());
            points.push(if scattered {
                noise
            } else {
                let spread = Vec3::new(0.5 / counts[0] as f64, 0.5 / counts[1] as f64, 0.5);
                Vec3::new(at(i, counts[0]), at(j, counts[1]), 0.0) + noise.component_mul(&spread)
            });
            weights.push(10f64.powf(orders * random.between(-0.5, 0.5)));
        }
    }
    let knots = [0, 1].map(|k| clamped(degree[k], counts[k]));
    let weights = (orders > 0.0).then_some(&weights[..]);
    NurbsPatch::new(degree, knots, counts, &points, weights).unwrap()
}

/// Points in and around the box of a patch's control points; every fifth close to the surface.
pub fn points(patch: &NurbsPatch, count: usize, seed: u64) -> Vec<Vec3> {
    let mut random = Random(seed);
    let (low, high) = patch.points().iter().fold(
        (
            Vec3::from_element(f64::INFINITY),
            Vec3::from_element(f64::NEG_INFINITY),
        ),
        |(low, high), p| (low.inf(p), high.sup(p)),
    );
    let (middle, half) = ((low + high) * 0.5, (high - low) * 0.5);
    (0..count)
        .map(|k| {
            let mut any = |a: f64| random.between(-a, a);
            let away = Vec3::new(any(1.0), any(1.0), any(1.0)).component_mul(&half);
            if k % 5 == 0 {
                let xi = random.xi(patch);
                patch.point(xi) + away * 0.02
            } else {
                middle + away * 1.3
            }
        })
        .collect()
}

/// Samples of a patch, for reference distances.
pub struct Samples {
    places: Vec<([usize; 2], [f64; 2])>,
    points: Vec<Vec3>,
}

impl Samples {
    pub fn new(patch: &NurbsPatch) -> Samples {
        let domain = patch.domain();
        let mut samples = Samples {
            places: Vec::new(),
            points: Vec::new(),
        };
        for j in 0..SAMPLES {
            for i in 0..SAMPLES {
                // Denser towards the sides.
                let at = |k: usize, n: usize| {
                    let t = n as f64 / (SAMPLES - 1) as f64;
                    let t = 0.5 * t + 0.5 * t * t * (3.0 - 2.0 * t);
                    domain[k][0] + t * (domain[k][1] - domain[k][0])
                };
                let xi = [at(0, i), at(1, j)];
                samples.places.push((patch.find_span(xi), xi));
                samples.points.push(patch.point(xi));
            }
        }
        samples
    }

    /// Distance of the patch from `q`: local iterations from the nearest of those samples that are nearer than their
    /// neighbours.
    pub fn distance(&self, patch: &NurbsPatch, q: &Vec3) -> f64 {
        let d2: Vec<f64> = self.points.iter().map(|p| (p - q).norm_squared()).collect();
        let mut starts = [(f64::INFINITY, 0); STARTS];
        for (k, &d) in d2.iter().enumerate() {
            if d >= starts[STARTS - 1].0 {
                continue;
            }
            let (i, j) = (k % SAMPLES, k / SAMPLES);
            let (left, right) = (i.saturating_sub(1), (i + 1).min(SAMPLES - 1));
            let (down, up) = (j.saturating_sub(1), (j + 1).min(SAMPLES - 1));
            let least = (down..=up).all(|j| (left..=right).all(|i| d2[i + SAMPLES * j] >= d));
            if least {
                starts[STARTS - 1] = (d, k);
                starts.sort_by(|a, b| a.0.total_cmp(&b.0));
            }
        }
        let near = starts.iter().filter(|s| s.0.is_finite()).map(|&(_, k)| {
            let (span, xi) = self.places[k];
            refine(patch, span, xi, q)
        });
        near.fold(f64::INFINITY, f64::min).sqrt()
    }
}
