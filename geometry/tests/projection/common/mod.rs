//! Shared by the tests of closest points: random numbers, sample surfaces, an exhaustive search.
#![allow(dead_code)]

pub mod sets;
pub mod wild;

use covact_geometry::{Foot, NurbsPatch, PatchSet, Vec3};

/// Number of queries of a test: a few hundred by default, more with the variable `COVACT_QUERIES`.
pub fn queries(default: usize) -> usize {
    std::env::var("COVACT_QUERIES")
        .ok()
        .and_then(|n| n.parse().ok())
        .unwrap_or(default)
}

/// Splitmix64.
pub struct Random(pub u64);

impl Random {
    pub fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 11) as f64 / (1u64 << 53) as f64
    }

    pub fn between(&mut self, a: f64, b: f64) -> f64 {
        a + (b - a) * self.next()
    }

    pub fn direction(&mut self) -> Vec3 {
        loop {
            let v = Vec3::new(
                self.between(-1.0, 1.0),
                self.between(-1.0, 1.0),
                self.between(-1.0, 1.0),
            );
            let n = v.norm();
            if n > 0.1 && n < 1.0 {
                return v / n;
            }
        }
    }

    /// Parameters on a patch.
    pub fn xi(&mut self, patch: &NurbsPatch) -> [f64; 2] {
        patch.domain().map(|[a, b]| self.between(a, b))
    }
}

/// Clamped uniform knots with `inner` extra copies of the knots in `double`.
pub fn clamped(degree: usize, count: usize) -> Vec<f64> {
    let spans = count - degree;
    let mut knots = vec![0.0; degree];
    knots.extend((0..=spans).map(|k| k as f64 / spans as f64));
    knots.extend(vec![1.0; degree]);
    knots
}

/// Bumpy graph over [0, 10]^2 of the given degree, irregular control points, rational or not.
pub fn bumpy(degree: usize, count: usize, rational: bool, seed: u64) -> NurbsPatch {
    let mut random = Random(seed);
    let mut points = Vec::new();
    let mut weights = Vec::new();
    for j in 0..count {
        for i in 0..count {
            let (x, y) = (
                10.0 * i as f64 / (count - 1) as f64,
                10.0 * j as f64 / (count - 1) as f64,
            );
            let z = (0.9 * x).sin() * (0.7 * y).cos() + random.between(-0.1, 0.1);
            points.push(Vec3::new(
                x + random.between(-0.05, 0.05),
                y + random.between(-0.05, 0.05),
                z,
            ));
            weights.push(if rational {
                random.between(0.7, 1.4)
            } else {
                1.0
            });
        }
    }
    let knots = clamped(degree, count);
    NurbsPatch::new(
        [degree; 2],
        [knots.clone(), knots],
        [count; 2],
        &points,
        rational.then_some(&weights[..]),
    )
    .unwrap()
}

/// Cubic roof with a crease along xi1 = 1/2: two slopes that meet at an angle, bent along the ridge.
pub fn creased() -> NurbsPatch {
    let knots1 = vec![
        0.0, 0.0, 0.0, 0.0, 0.25, 0.5, 0.5, 0.5, 0.75, 1.0, 1.0, 1.0, 1.0,
    ];
    let (n1, n2) = (9, 8);
    let mut points = Vec::new();
    for j in 0..n2 {
        for i in 0..n1 {
            // Greville abscissae keep the parametrisation even.
            let u = (knots1[i + 1] + knots1[i + 2] + knots1[i + 3]) / 3.0;
            let (x, y): (f64, f64) = (10.0 * u, 10.0 * j as f64 / (n2 - 1) as f64);
            let z = 1.5 - 0.4 * (x - 5.0).abs() + 0.5 * (0.8 * y).sin();
            points.push(Vec3::new(x, y, z));
        }
    }
    NurbsPatch::new([3; 2], [knots1, clamped(3, n2)], [n1, n2], &points, None).unwrap()
}

/// Unit normal where it exists.
pub fn normal(patch: &NurbsPatch, xi: [f64; 2]) -> Option<Vec3> {
    let jet = patch.jet(xi);
    jet.rho_i[0].cross(&jet.rho_i[1]).try_normalize(1e-9)
}

/// Largest principal curvature by absolute value and its sign about `rho_1 x rho_2`.
pub fn curvature(patch: &NurbsPatch, xi: [f64; 2]) -> Option<f64> {
    let frame = covact_geometry::Frame::new(&patch.jet(xi), 1.0)?;
    let [a, b] = frame.principal_curvatures();
    Some(if a.abs() > b.abs() { a } else { b })
}

/// Distance found by exhaustive search: a grid of points in every span, then a damped Gauss-Newton iteration with
/// clamping from the best ones. Shares no code with the search under test.
pub fn exhaustive(patches: &[NurbsPatch], q: &Vec3, per_span: usize, starts: usize) -> f64 {
    let mut seeds: Vec<(f64, usize, [usize; 2], [f64; 2])> = Vec::new();
    for (number, patch) in patches.iter().enumerate() {
        for (s1, [a1, b1]) in patch.spans(0).into_iter().enumerate() {
            for (s2, [a2, b2]) in patch.spans(1).into_iter().enumerate() {
                let mut best = (f64::INFINITY, [0.0; 2]);
                for k in 0..(per_span + 1) * (per_span + 1) {
                    let t = [k % (per_span + 1), k / (per_span + 1)]
                        .map(|k| k as f64 / per_span as f64);
                    let xi = [a1 + t[0] * (b1 - a1), a2 + t[1] * (b2 - a2)];
                    let d2 = (patch.jet_in_span([s1, s2], xi).rho - q).norm_squared();
                    if d2 < best.0 {
                        best = (d2, xi);
                    }
                }
                seeds.push((best.0, number, [s1, s2], best.1));
            }
        }
    }
    seeds.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut best = seeds[0].0;
    for &(_, number, span, xi) in seeds.iter().take(starts) {
        best = best.min(refine(&patches[number], span, xi, q));
    }
    best.sqrt()
}

pub fn refine(patch: &NurbsPatch, span: [usize; 2], mut xi: [f64; 2], q: &Vec3) -> f64 {
    let range = [0, 1].map(|k| patch.spans(k)[span[k]]);
    let value = |xi: [f64; 2]| (patch.jet_in_span(span, xi).rho - q).norm_squared();
    let mut now = value(xi);
    let mut damping = 1e-3;
    for _ in 0..200 {
        let jet = patch.jet_in_span(span, xi);
        let d = q - jet.rho;
        let g = [jet.rho_i[0].dot(&d), jet.rho_i[1].dot(&d)];
        let h = |i: usize, j: usize| jet.rho_i[i].dot(&jet.rho_i[j]) - jet.rho_ij[i + j].dot(&d);
        let a = [jet.rho_i[0].norm_squared(), jet.rho_i[1].norm_squared()];
        let shift = damping * (a[0].max(a[1]) + 1e-300);
        let held =
            |k: usize| xi[k] <= range[k][0] && g[k] < 0.0 || xi[k] >= range[k][1] && g[k] > 0.0;
        let (h11, h12, h22) = (h(0, 0) + shift, h(0, 1), h(1, 1) + shift);
        let step = match [held(0), held(1)] {
            [true, true] => return now,
            [true, false] => [0.0, g[1] / h22.abs().max(1e-300)],
            [false, true] => [g[0] / h11.abs().max(1e-300), 0.0],
            _ => {
                let det = h11 * h22 - h12 * h12;
                if det > 0.0 && h11 > 0.0 {
                    [
                        (h22 * g[0] - h12 * g[1]) / det,
                        (h11 * g[1] - h12 * g[0]) / det,
                    ]
                } else {
                    damping = damping.max(1e-3) * 4.0;
                    if damping > 1e12 {
                        return now;
                    }
                    continue;
                }
            }
        };
        let next = [0, 1].map(|k| (xi[k] + step[k]).clamp(range[k][0], range[k][1]));
        let then = value(next);
        if then < now {
            now = then;
            xi = next;
            damping *= 0.2;
        } else {
            damping = damping.max(1e-9) * 8.0;
            if damping > 1e9 || next == xi {
                return now;
            }
        }
    }
    now
}

/// Checks that a foot is a point of the set, as far away as it says, and stationary where it claims to be.
pub fn check_foot(set: &PatchSet, q: &Vec3, foot: &Foot) {
    let patch = &set.patches()[foot.patch as usize];
    let rho = patch.point(foot.xi);
    let noise = 1e-12 * (set.size() + q.norm());
    assert!((rho - foot.jet.rho).norm() <= noise, "{q:?} {foot:?}");
    assert!(
        ((q - rho).norm() - foot.distance).abs() <= noise,
        "{q:?} {foot:?}"
    );
    assert!((foot.signed_distance.abs() - foot.distance).abs() <= noise);
    assert!((foot.normal.norm() - 1.0).abs() < 1e-12, "{q:?} {foot:?}");
    if foot.location == covact_geometry::Location::Face
        && foot.status == covact_geometry::Status::Unique
    {
        for tangent in foot.jet.rho_i {
            let residual = tangent.dot(&(q - foot.jet.rho));
            // Near poles a tangent is a difference of large terms.
            let floor = 1e-4 * foot.jet.rho_i[0].norm().max(foot.jet.rho_i[1].norm());
            let scale = tangent.norm().max(floor) * foot.distance.max(set.size());
            assert!(
                residual.abs() <= 1e-11 * scale,
                "{residual:e} {q:?} {foot:?}"
            );
        }
    }
}

/// Counts wrong answers of a set of queries with known distances: farther than the truth by more than 1e-9 of the size,
/// cold, and warm from the foot of the query before. Prints the count.
pub fn count_wrong(name: &str, set: &PatchSet, truths: &[(Vec3, f64)]) -> usize {
    let mut wrong = 0;
    let mut unsure = 0;
    let mut hint = None;
    for (q, truth) in truths {
        let limit = truth + 1e-9 * set.size();
        let cold = set.project(q, None, f64::INFINITY).unwrap();
        check_foot(set, q, &cold);
        let warm = set.project(q, hint, f64::INFINITY).unwrap();
        check_foot(set, q, &warm);
        hint = Some(cold.hint());
        if cold.distance > limit || warm.distance > limit {
            if wrong < 3 {
                eprintln!(
                    "{name}: {q:?} truth {truth:e} cold {cold:?} warm {}",
                    warm.distance
                );
            }
            wrong += 1;
        }
        if cold.status == covact_geometry::Status::NotConverged {
            unsure += 1;
        }
    }
    eprintln!(
        "{name}: {wrong} wrong, {unsure} not converged, of {}",
        truths.len()
    );
    wrong + unsure
}
