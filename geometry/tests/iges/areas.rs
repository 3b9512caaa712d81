//! Areas and boxes of patches with and without trims, computed apart from the library's own.

use covact_geometry::NurbsPatch;
use covact_geometry::trim::TrimLoop;

/// Points and weights of 6-point Gauss-Legendre quadrature on [0, 1].
const GAUSS: [(f64, f64); 6] = [
    (0.033_765_242_898_423_99, 0.085_662_246_189_585_17),
    (0.169_395_306_766_867_74, 0.180_380_786_524_069_3),
    (0.380_690_406_958_401_54, 0.233_956_967_286_345_52),
    (0.619_309_593_041_598_5, 0.233_956_967_286_345_52),
    (0.830_604_693_233_132_3, 0.180_380_786_524_069_3),
    (0.966_234_757_101_576, 0.085_662_246_189_585_17),
];

fn density(patch: &NurbsPatch, xi: [f64; 2]) -> f64 {
    let jet = patch.jet(xi);
    jet.rho_i[0].cross(&jet.rho_i[1]).norm()
}

/// The parts of the spans of one direction below `end`, each cut in two.
fn parts(patch: &NurbsPatch, dir: usize, end: f64) -> Vec<[f64; 2]> {
    patch
        .spans(dir)
        .into_iter()
        .filter(|s| s[0] < end)
        .flat_map(|[a, b]| {
            let b = b.min(end);
            let m = 0.5 * (a + b);
            [[a, m], [m, b]]
        })
        .collect()
}

/// Area of the whole domain.
pub fn area(patch: &NurbsPatch) -> f64 {
    let end = patch.domain()[1][1];
    let rows = parts(patch, 1, end);
    let end = patch.domain()[0][1];
    rows.iter()
        .flat_map(|&[a, b]| GAUSS.map(|(x, w)| (a + (b - a) * x, w * (b - a))))
        .map(|(v, w)| w * strip(patch, end, v))
        .sum()
}

/// Integral of the density along xi1 up to `u`.
fn strip(patch: &NurbsPatch, u: f64, v: f64) -> f64 {
    parts(patch, 0, u)
        .iter()
        .flat_map(|&[a, b]| GAUSS.map(|(x, w)| (a + (b - a) * x, w * (b - a))))
        .map(|(x, w)| w * density(patch, [x, v]))
        .sum()
}

/// Area inside of the trim, by Green's theorem: the outer loop's less that of all holes.
pub fn trimmed_area(patch: &NurbsPatch) -> f64 {
    let Some(trim) = patch.trim() else {
        return area(patch);
    };
    let loops: Vec<f64> = trim
        .loops()
        .iter()
        .map(|l| inside(patch, l).abs())
        .collect();
    2.0 * loops[0] - loops.iter().sum::<f64>()
}

fn inside(patch: &NurbsPatch, a_loop: &TrimLoop) -> f64 {
    let mut sum = 0.0;
    for curve in &a_loop.curves {
        let basis = curve.parameter.basis();
        for span in 0..basis.span_count() {
            let [a, b] = basis.span_range(span);
            // Splines of many spans are short in each; single pieces may wander over many spans of the patch.
            let n = if basis.span_count() > 8 { 2 } else { 16 };
            let mut cuts: Vec<f64> = (0..=n)
                .map(|k| a + (b - a) * f64::from(k) / f64::from(n))
                .collect();
            // The density has kinks at the patch's knots.
            let at = |t: f64| curve.parameter.point(t).y;
            for knot in patch.spans(1).iter().map(|s| s[0]) {
                for k in 0..cuts.len() - 1 {
                    let (mut low, mut high) = (cuts[k], cuts[k + 1]);
                    let below = at(low) < knot;
                    if below == (at(high) < knot) {
                        continue;
                    }
                    for _ in 0..50 {
                        let t = 0.5 * (low + high);
                        if (at(t) < knot) == below {
                            low = t;
                        } else {
                            high = t;
                        }
                    }
                    cuts.push(low);
                    cuts.sort_by(f64::total_cmp);
                    break;
                }
            }
            for pair in cuts.windows(2) {
                let h = pair[1] - pair[0];
                for (x, w) in GAUSS {
                    let jet = curve.parameter.jet(pair[0] + h * x);
                    if jet.d1.y != 0.0 {
                        sum += w * h * jet.d1.y * strip(patch, jet.point.x, jet.point.y);
                    }
                }
            }
        }
    }
    sum
}

/// Lowest and highest x, y, z of the whole domain: a pattern search from every local extreme of a grid.
pub fn extremes(patch: &NurbsPatch) -> [f64; 6] {
    let domain = patch.domain();
    let steps = [0, 1].map(|d| (4 * patch.spans(d).len()).clamp(16, 48));
    let at = |s: [f64; 2]| {
        let xi = [0, 1].map(|d| domain[d][0] + (domain[d][1] - domain[d][0]) * s[d]);
        patch.point(xi)
    };
    let place = |i: usize, j: usize| [i as f64 / steps[0] as f64, j as f64 / steps[1] as f64];
    let columns = steps[0] + 1;
    let grid: Vec<_> = (0..=steps[1])
        .flat_map(|j| (0..columns).map(move |i| (i, j)))
        .map(|(i, j)| at(place(i, j)))
        .collect();
    let mut out = [0.0; 6];
    for (slot, value) in out.iter_mut().enumerate() {
        let (k, sign) = (slot % 3, if slot < 3 { -1.0 } else { 1.0 });
        let height = |i: usize, j: usize| sign * grid[i + columns * j][k];
        let highest = grid
            .iter()
            .map(|x| sign * x[k])
            .fold(f64::NEG_INFINITY, f64::max);
        let lowest = grid
            .iter()
            .map(|x| sign * x[k])
            .fold(f64::INFINITY, f64::min);
        let mut best = highest;
        for j in 0..=steps[1] {
            for i in 0..columns {
                let here = height(i, j);
                let around = (i.saturating_sub(1)..=(i + 1).min(steps[0])).flat_map(|a| {
                    (j.saturating_sub(1)..=(j + 1).min(steps[1])).map(move |b| (a, b))
                });
                let is_top = around.into_iter().all(|(a, b)| height(a, b) <= here);
                if is_top && here > highest - 0.1 * (highest - lowest) {
                    best = best.max(climb(place(i, j), here, &|s| sign * at(s)[k]));
                    // A ridge of equal heights needs one climb.
                    if here == highest && best == highest {
                        break;
                    }
                }
            }
        }
        *value = sign * best;
    }
    out
}

fn climb(mut s: [f64; 2], mut found: f64, at: &dyn Fn([f64; 2]) -> f64) -> f64 {
    let mut h = 1.0 / 16.0;
    while h > 1e-9 {
        let tries = [
            [h, 0.0],
            [-h, 0.0],
            [0.0, h],
            [0.0, -h],
            [h, h],
            [-h, -h],
            [h, -h],
            [-h, h],
        ];
        let better = tries
            .map(|t| [0, 1].map(|d| (s[d] + t[d]).clamp(0.0, 1.0)))
            .into_iter()
            .map(|s| (s, at(s)))
            .max_by(|a, b| a.1.total_cmp(&b.1))
            .filter(|b| b.1 > found);
        match better {
            Some((next, value)) => (s, found) = (next, value),
            None => h *= 0.5,
        }
    }
    found
}
