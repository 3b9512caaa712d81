//! Tests of facets with weights: the spans of rational patches.
use super::{CurvedRows, MovingFacets};
use crate::project::Status;
use crate::surface::Vec3;
use crate::{NurbsPatch, PatchSet};

/// Numbers without a pattern between 0 and 1.
struct Random(u64);

impl Random {
    fn next(&mut self) -> f64 {
        self.0 = self
            .0
            .wrapping_mul(6364136223846793005)
            .wrapping_add(1442695040888963407);
        (self.0 >> 11) as f64 / (1u64 << 53) as f64
    }
}

/// A patch of 3 x 2 spans with hills and weights between .6 and 1.6.
fn hills() -> NurbsPatch {
    let knots = |inner: &[f64]| [&[0.0; 4][..], inner, &[1.0; 4]].concat();
    let mut random = Random(7);
    let points: Vec<Vec3> = (0..30)
        .map(|k| {
            let (i, j) = (f64::from(k % 6), f64::from(k / 6));
            Vec3::new(
                i + 0.3 * random.next(),
                j + 0.3 * random.next(),
                1.5 * random.next(),
            )
        })
        .collect();
    let weights: Vec<f64> = (0..30).map(|_| 0.6 + random.next()).collect();
    let knots = [knots(&[0.3, 0.7]), knots(&[0.6])];
    NurbsPatch::new([3, 3], knots, [6, 5], &points, Some(&weights)).unwrap()
}

/// An eighth of a sphere without its pole, of 2 x 2 spans.
fn sphere(radius: f64) -> NurbsPatch {
    let arc = |a: f64, b: f64| {
        let (m, w) = (0.5 * (a + b), (0.5 * (b - a)).cos());
        [
            [a.cos(), a.sin(), 1.0],
            [m.cos() / w, m.sin() / w, w],
            [b.cos(), b.sin(), 1.0],
        ]
    };
    let half_turn = std::f64::consts::PI;
    let (mut points, mut weights) = (Vec::new(), Vec::new());
    for [c, s, w] in arc(-0.5, 1.2) {
        for [x, y, v] in arc(0.0, 0.5 * half_turn) {
            points.push(Vec3::new(c * x, c * y, s) * radius);
            weights.push(w * v);
        }
    }
    let knots = || vec![0.0, 0.0, 0.0, 1.0, 1.0, 1.0];
    let patch = NurbsPatch::new([2, 2], [knots(), knots()], [3, 3], &points, Some(&weights));
    [0, 1].into_iter().fold(patch.unwrap(), |patch, dir| {
        let patch = patch.elevated(dir, 1).unwrap();
        patch.insert_knots(dir, &[0.4]).unwrap()
    })
}

fn facets_of(patch: &NurbsPatch, reversed: bool) -> MovingFacets {
    let spans: Vec<usize> = (0..patch.spans(0).len() * patch.spans(1).len()).collect();
    let mut facets = MovingFacets::of_patch(patch, &spans, reversed, |n| n).unwrap();
    let points = patch.points();
    facets.update(|n| points[n as usize]);
    facets
}

/// Jets of the facets are those of the patch, and those of the shape functions, up to second derivatives.
#[test]
fn facets_are_the_spans() {
    let patch = hills();
    let points = patch.points();
    for reversed in [false, true] {
        let facets = facets_of(&patch, reversed);
        let mut rows = CurvedRows::default();
        for facet in 0..facets.len() as u32 {
            let span = facets.source(facet) as usize;
            let ranges = [0, 1].map(|dir| patch.spans(dir)[[span % 3, span / 3][dir]]);
            for at in [[-0.6, 0.9], [0.2, -0.3], [1.0, -1.0]] {
                let own = if reversed { [at[1], at[0]] } else { at };
                let half = ranges.map(|[a, b]| 0.5 * (b - a));
                let xi = [0, 1].map(|k| 0.5 * (ranges[k][0] + ranges[k][1]) + half[k] * own[k]);
                let jet = facets.jet(facet, at);
                // From the left at the end of a span, whose third derivatives jump there.
                let exact = patch.jet3_in_span([span % 3, span / 3], xi).jet;
                let [i, j] = if reversed { [1, 0] } else { [0, 1] };
                let first = [i, j].map(|k| exact.rho_i[k] * half[k]);
                let second = [(i, i), (i, j), (j, j)]
                    .map(|(k, l)| exact.rho_ij[k + l] * (half[k] * half[l]));
                assert!((jet.rho - exact.rho).norm() < 1e-13);
                for (a, b) in jet.rho_i.iter().zip(&first) {
                    assert!((a - b).norm() < 1e-12 && b.norm() > 1e-2);
                }
                for (a, b) in jet.rho_ij.iter().zip(&second) {
                    assert!((a - b).norm() < 1e-11 && b.norm() > 1e-3, "{a} {b}");
                }
                facets.curved_shape(facet, at, &mut rows);
                let sum = |w: &[f64]| -> Vec3 {
                    let nodes = facets.nodes(facet).iter();
                    nodes.zip(w).map(|(n, w)| points[*n as usize] * *w).sum()
                };
                let one: f64 = rows.rows.n[..16].iter().sum();
                assert!((one - 1.0).abs() < 1e-14);
                for (w, exact) in [
                    (&rows.rows.n, &jet.rho),
                    (&rows.rows.n_1, &jet.rho_i[0]),
                    (&rows.rows.n_2, &jet.rho_i[1]),
                    (&rows.n_11, &jet.rho_ij[0]),
                    (&rows.n_12, &jet.rho_ij[1]),
                    (&rows.n_22, &jet.rho_ij[2]),
                ] {
                    assert!((sum(w) - exact).norm() < 1e-12);
                }
            }
        }
    }
}

/// Distances from a sphere, inside and outside, are those of its radius.
#[test]
fn a_sphere_is_round() {
    let facets = facets_of(&sphere(10.0), false);
    let mut random = Random(3);
    for _ in 0..200 {
        let (a, b) = (0.2 + 1.1 * random.next(), -0.4 + 1.4 * random.next());
        let r = 4.0 + 20.0 * random.next();
        let n = Vec3::new(b.cos() * a.cos(), b.cos() * a.sin(), b.sin());
        let foot = facets
            .project(&(n * r), None, f64::INFINITY, |_| true)
            .unwrap();
        assert_eq!(foot.status, Status::Unique);
        assert!((foot.signed_distance - (r - 10.0)).abs() < 1e-12);
        assert!((foot.jet.rho - n * 10.0).norm() < 1e-11);
        assert!((foot.normal - n).norm() < 1e-12);
    }
}

/// The closest points of hills with weights are those that the projection on rigid patches finds, near them and beyond their
/// centres of curvature, with a wrong hint and without.
#[test]
fn closest_points_are_those_of_the_rigid_patch() {
    let patch = hills();
    let facets = facets_of(&patch, false);
    let set = PatchSet::new(vec![patch], None).unwrap();
    let mut random = Random(11);
    let mut inside = 0;
    for k in 0..2000 {
        let q = Vec3::new(
            7.0 * random.next() - 1.0,
            6.0 * random.next() - 1.0,
            5.0 * random.next() - 2.0,
        );
        let hint = (k % 2 == 1).then(|| crate::project::Hint {
            patch: (k % 6) as u32,
            xi: [0.3, -0.8],
        });
        let foot = facets.project(&q, hint, f64::INFINITY, |_| true).unwrap();
        let rigid = set.project(&q, None, f64::INFINITY).unwrap();
        assert_ne!(foot.status, Status::NotConverged);
        assert!(
            (foot.distance - rigid.distance).abs() < 1e-10,
            "{q}: {} {}",
            foot.distance,
            rigid.distance
        );
        inside += usize::from(foot.place == super::MovingPlace::Face);
    }
    assert!(inside > 500, "{inside}");
}
