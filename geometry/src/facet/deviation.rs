//! How far a facet is from the surface that it stands for.

use crate::surface::{Surface, Vec3};

/// One cell of the grid of a patch.
#[derive(Debug, Clone, Copy)]
pub(super) struct Cell {
    /// Parameters: `[direction][start, end]`.
    pub domain: [[f64; 2]; 2],
    /// Which of its sides lie on the border of the patch: `[direction][start, end]`.
    pub border: [[bool; 2]; 2],
}

/// Parameters of a facet at which the deviation is measured, in each direction: the ends, the middle (largest error of
/// linear interpolation), and +- 1/sqrt 3 (of quadratic interpolation).
const PLACES: [f64; 5] = [
    -1.0,
    -0.577_350_269_189_625_8,
    0.0,
    0.577_350_269_189_625_8,
    1.0,
];

/// Largest distance of a facet from its cell. On the border of the patch the distance from the border counts, so that a
/// flat patch with a curved border is followed too.
pub(super) fn deviation<S: Surface>(
    patch: &S,
    cell: &Cell,
    facet: impl Fn([f64; 2]) -> Vec3,
) -> f64 {
    let mut largest = 0.0f64;
    for s in PLACES {
        for r in PLACES {
            let place = [r, s];
            let held = [0, 1].map(|k| {
                place[k] == -1.0 && cell.border[k][0] || place[k] == 1.0 && cell.border[k][1]
            });
            let xi = [0, 1].map(|k| {
                let [a, b] = cell.domain[k];
                match place[k] {
                    -1.0 => a,
                    1.0 => b,
                    x => 0.5 * (a + b) + 0.5 * x * (b - a),
                }
            });
            largest = largest.max(distance(patch, &facet(place), xi, held));
        }
    }
    largest
}

/// Distance of `p` from the patch near to `xi`: some Gauss-Newton steps from there, of which the nearest point counts.
/// Whatever is found is a point of the patch, so the distance is never too small.
fn distance<S: Surface>(patch: &S, p: &Vec3, mut xi: [f64; 2], held: [bool; 2]) -> f64 {
    let domain = patch.domain();
    let mut best = f64::INFINITY;
    for _ in 0..10 {
        let jet = patch.jet(xi);
        let d = p - jet.rho;
        let now = d.norm();
        let gain = best - now;
        best = best.min(now);
        if gain <= 1e-3 * best {
            break;
        }
        let [r1, r2] = jet.rho_i;
        let (a, b, c) = (r1.norm_squared(), r1.dot(&r2), r2.norm_squared());
        let (f, g) = (r1.dot(&d), r2.dot(&d));
        let det = a * c - b * b;
        let one = |slope: f64, metric: f64| if metric > 0.0 { slope / metric } else { 0.0 };
        let step = match held {
            [true, true] => break,
            [true, false] => [0.0, one(g, c)],
            [false, true] => [one(f, a), 0.0],
            _ if det > 1e-12 * a * c => [(c * f - b * g) / det, (a * g - b * f) / det],
            _ if a > c => [one(f, a), 0.0],
            _ => [0.0, one(g, c)],
        };
        for k in 0..2 {
            xi[k] = (xi[k] + step[k]).clamp(domain[k][0], domain[k][1]);
        }
    }
    best
}

/// How much of the deviation each direction makes: errors of interpolation (of degree 1 or 2) along the lines of a
/// cell, normal to the surface, and on the border of the patch normal to the line.
pub(super) fn shares<S: Surface>(patch: &S, cell: &Cell, degree: usize) -> [f64; 2] {
    let mut out = [0.0f64; 2];
    for (dir, out) in out.iter_mut().enumerate() {
        let across = 1 - dir;
        let at = |t: f64, s: f64| {
            let mut xi = [0.0; 2];
            for (k, x) in [(dir, t), (across, s)] {
                let [a, b] = cell.domain[k];
                xi[k] = 0.5 * (a + b) + 0.5 * x * (b - a);
            }
            xi
        };
        for s in [-1.0, 0.0, 1.0] {
            let [a, b, c] = [-1.0, 0.0, 1.0].map(|t| patch.point(at(t, s)));
            let on_border =
                s == -1.0 && cell.border[across][0] || s == 1.0 && cell.border[across][1];
            let places: &[f64] = if degree == 1 {
                &[0.0]
            } else {
                &[PLACES[1], PLACES[3]]
            };
            for &t in places {
                let jet = patch.jet(at(t, s));
                let chord = if degree == 1 {
                    (a + c) * 0.5
                } else {
                    a * (0.5 * t * (t - 1.0)) + b * (1.0 - t * t) + c * (0.5 * t * (t + 1.0))
                };
                let error = jet.rho - chord;
                let normal = jet.rho_i[0].cross(&jet.rho_i[1]).try_normalize(0.0);
                let size = match (on_border, normal) {
                    (false, Some(n)) => error.dot(&n).abs(),
                    _ => match jet.rho_i[dir].try_normalize(0.0) {
                        Some(t) => (error - t * error.dot(&t)).norm(),
                        None => error.norm(),
                    },
                };
                *out = out.max(size);
            }
        }
    }
    out
}
