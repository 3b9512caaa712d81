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
            let n = if basis.span_count() > 8 { 1 } else { 12 };
            for k in 0..n {
                let h = (b - a) / f64::from(n);
                for (x, w) in GAUSS {
                    let jet = curve.parameter.jet(a + h * (f64::from(k) + x));
                    if jet.d1.y != 0.0 {
                        sum += w * h * jet.d1.y * strip(patch, jet.point.x, jet.point.y);
                    }
                }
            }
        }
    }
    sum
}

/// Lowest and highest x, y, z of the whole domain: the best of a grid, then a pattern search.
pub fn extremes(patch: &NurbsPatch) -> [f64; 6] {
    let domain = patch.domain();
    let steps = [0, 1].map(|d| (4 * patch.spans(d).len()).clamp(16, 48));
    let at = |s: [f64; 2]| {
        let xi = [0, 1].map(|d| domain[d][0] + (domain[d][1] - domain[d][0]) * s[d]);
        patch.point(xi)
    };
    let mut grid = Vec::new();
    for i in 0..=steps[0] {
        for j in 0..=steps[1] {
            let s = [i as f64 / steps[0] as f64, j as f64 / steps[1] as f64];
            grid.push((s, at(s)));
        }
    }
    let mut out = [0.0; 6];
    for (slot, value) in out.iter_mut().enumerate() {
        let (k, sign) = (slot % 3, if slot < 3 { -1.0 } else { 1.0 });
        let best = grid
            .iter()
            .max_by(|a, b| (sign * a.1[k]).total_cmp(&(sign * b.1[k])));
        let (mut s, x) = *best.unwrap();
        let mut found = sign * x[k];
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
                .map(|s| (s, sign * at(s)[k]))
                .max_by(|a, b| a.1.total_cmp(&b.1))
                .filter(|b| b.1 > found);
            match better {
                Some((next, value)) => (s, found) = (next, value),
                None => h *= 0.5,
            }
        }
        *value = sign * found;
    }
    out
}
