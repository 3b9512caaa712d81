//! Closest points of trimmed patches against constructions with known truth and against an exhaustive search.

use crate::common::{Random, bumpy, check_foot, queries};
use crate::curves::{dense, ellipse, one_curve, plate, polygon, rectangle, star};
use covact_geometry::bezier::BezierPiece;
use covact_geometry::{
    EdgeKind, Hint, Jet, Location, NurbsPatch, PatchSet, Status, Surface, Trim, TrimLoop, Vec3,
    primitives,
};
use nalgebra::Vector2;
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

fn trimmed(patch: NurbsPatch, loops: Vec<TrimLoop>) -> NurbsPatch {
    let trim = Trim::new(loops, patch.domain(), 1e-9).unwrap();
    patch.with_trim(Some(trim))
}

fn set(patches: Vec<NurbsPatch>) -> PatchSet {
    PatchSet::new(patches, None).unwrap()
}

/// Checks a foot of a set whose closest distance is known, cold and warm.
fn agrees(set: &PatchSet, q: &Vec3, hint: Option<Hint>, truth: f64) -> Hint {
    let limit = 1e-9 * set.size();
    let mut last = Hint {
        patch: 0,
        xi: [0.0; 2],
    };
    for hint in [None, hint] {
        let foot = set.project(q, hint, f64::INFINITY).unwrap();
        check_foot(set, q, &foot);
        assert!(
            (foot.distance - truth).abs() <= limit,
            "{q:?} hint {hint:?} truth {truth} {foot:?}"
        );
        assert_ne!(foot.status, Status::NotConverged, "{q:?} {foot:?}");
        let trim = set.patches()[foot.patch as usize].trim().unwrap();
        assert!(
            trim.contains(foot.xi) || trim.on_border(foot.xi, 1e-9),
            "{q:?} {foot:?}"
        );
        last = foot.hint();
    }
    last
}

#[test]
fn a_point_over_a_hole_has_its_foot_on_the_circle() {
    let radius = 0.5;
    let loops = vec![
        rectangle([[-1.0, 1.0]; 2]),
        ellipse([0.0; 2], [radius; 2], 0.4),
    ];
    let set = set(vec![trimmed(plate(), loops)]);
    let mut random = Random(1);
    let mut hint = None;
    let mut over = 0;
    for _ in 0..queries(1000) {
        let far = if random.next() < 0.1 { 100.0 } else { 1.5 };
        let q = Vec3::new(
            random.between(-far, far),
            random.between(-far, far),
            random.between(-far, far),
        );
        let r = q.x.hypot(q.y);
        let off = if r < radius {
            over += 1;
            radius - r
        } else {
            (q.x.abs() - 1.0).max(0.0).hypot((q.y.abs() - 1.0).max(0.0))
        };
        hint = Some(agrees(&set, &q, hint, off.hypot(q.z)));
        let foot = set.project(&q, None, f64::INFINITY).unwrap();
        if r < radius {
            assert!(
                matches!(
                    foot.location,
                    Location::Edge {
                        edge: 8,
                        kind: EdgeKind::Free
                    }
                ),
                "{foot:?}"
            );
        } else if q.x.abs().max(q.y.abs()) < 1.0 {
            assert_eq!(foot.location, Location::Face);
        } else if q.x.abs().min(q.y.abs()) > 1.0 {
            assert!(matches!(foot.location, Location::Corner { .. }), "{foot:?}");
        }
        // Within reach or not.
        assert!(set.project(&q, None, foot.distance * 0.999).is_none());
        assert!(set.project(&q, None, foot.distance * 1.001).is_some());
    }
    assert!(over > 20, "{over}");
}

#[test]
fn over_the_middle_of_a_hole_all_points_are_as_near() {
    let loops = vec![
        rectangle([[-1.0, 1.0]; 2]),
        ellipse([0.0; 2], [0.5; 2], 0.0),
    ];
    let set = set(vec![trimmed(plate(), loops)]);
    for z in [0.0, 1e-6, 0.3, 50.0] {
        let q = Vec3::new(0.0, 0.0, z);
        let foot = set.project(&q, None, f64::INFINITY).unwrap();
        assert!((foot.distance - 0.5f64.hypot(z)).abs() < 1e-12);
        assert_eq!(foot.status, Status::NonUnique, "{foot:?}");
    }
}

#[test]
fn an_octant_of_a_sphere_is_bounded_by_its_trim() {
    let sphere = primitives::sphere(1.0, Vec3::zeros(), Vec3::z()).unwrap();
    // The octant as the part of the domain that a point search says is x, y, z > 0.
    let domain = sphere.domain();
    let middle = Vec3::new(1.0, 1.0, 1.0).normalize();
    let whole = set_of_one(&sphere);
    let xi = whole
        .project(&(middle * 2.0), None, f64::INFINITY)
        .unwrap()
        .xi;
    // Quarter turns about the axis, and the equator, are known parameters of the primitive.
    let mut box_ = [[0.0; 2]; 2];
    for k in 0..2 {
        let mut breaks = vec![domain[k][0]];
        breaks.extend(sphere.spans(k).iter().map(|s| s[1]));
        let at = breaks.partition_point(|&b| b <= xi[k]);
        box_[k] = [breaks[at - 1], breaks[at]];
    }
    for (a, b) in [([0, 0], [1, 1])] {
        for corner in [a, b] {
            let p = sphere.point([0, 1].map(|k| box_[k][corner[k]]));
            assert!(p.iter().all(|x| *x > -1e-12), "{p:?}");
        }
    }
    let set = set(vec![trimmed(sphere, vec![rectangle(box_)])]);
    let mut random = Random(4);
    let mut hint = None;
    for _ in 0..queries(500) {
        let q = random.direction() * random.between(0.2, 3.0);
        // |q - u|^2 = |q|^2 + 1 - 2 q.u, and q.u is largest at the part of q in the octant.
        let positive = q.map(|x| x.max(0.0)).norm();
        let most = if positive > 0.0 { positive } else { q.max() };
        let truth = (q.norm_squared() + 1.0 - 2.0 * most).max(0.0).sqrt();
        hint = Some(agrees(&set, &q, hint, truth));
    }
}

fn set_of_one(patch: &NurbsPatch) -> PatchSet {
    set(vec![patch.clone()])
}

/// Nearest of many points inside and on the curves, each of the best ones refined. Shares no search code.
struct Exhaustive {
    patch: NurbsPatch,
    inside: Vec<(Vec3, [f64; 2])>,
    /// Points of curve (number), parameter, with the step between parameters.
    border: Vec<(Vec3, usize, f64, f64)>,
}

impl Exhaustive {
    fn new(patch: &NurbsPatch, n: usize, per_piece: usize) -> Self {
        let trim = patch.trim().unwrap();
        let domain = patch.domain();
        let mut inside = Vec::new();
        for k in 0..n * n {
            let xi = [0, 1].map(|d| {
                let share = ([k % n, k / n][d] as f64 + 0.5) / n as f64;
                domain[d][0] + share * (domain[d][1] - domain[d][0])
            });
            if trim.contains(xi) {
                inside.push((patch.point(xi), xi));
            }
        }
        let mut border = Vec::new();
        for number in 0..trim.curve_count() {
            let curve = &trim.curve(number).unwrap().parameter;
            for piece in curve.bezier_pieces() {
                let [a, b] = piece.domain;
                let step = (b - a) / per_piece as f64;
                for k in 0..=per_piece {
                    let t = a + step * k as f64;
                    let xi = curve.point(t);
                    border.push((patch.point([xi.x, xi.y]), number, t, step));
                }
            }
        }
        Self {
            patch: patch.clone(),
            inside,
            border,
        }
    }

    fn distance(&self, q: &Vec3) -> f64 {
        let trim = self.patch.trim().unwrap();
        let mut best = f64::INFINITY;
        let mut seeds: Vec<(f64, usize)> = (self.inside.iter().enumerate())
            .map(|(k, (p, _))| ((p - q).norm_squared(), k))
            .collect();
        let few = 6.min(seeds.len() - 1);
        seeds.select_nth_unstable_by(few, |a, b| a.0.total_cmp(&b.0));
        for &(d2, k) in &seeds[..=few] {
            best = best.min(d2.sqrt());
            // Newton's method on the stationary point, wherever it leads inside of the trim.
            let mut xi = self.inside[k].1;
            for _ in 0..30 {
                let jet = self.patch.jet(xi);
                let d = q - jet.rho;
                let [r1, r2] = jet.rho_i;
                let g = [r1.dot(&d), r2.dot(&d)];
                let h = [
                    r1.dot(&r1) - jet.rho_ij[0].dot(&d),
                    r1.dot(&r2) - jet.rho_ij[1].dot(&d),
                    r2.dot(&r2) - jet.rho_ij[2].dot(&d),
                ];
                let det = h[0] * h[2] - h[1] * h[1];
                let step = [
                    (h[2] * g[0] - h[1] * g[1]) / det,
                    (h[0] * g[1] - h[1] * g[0]) / det,
                ];
                xi = [xi[0] + step[0], xi[1] + step[1]];
                let domain = self.patch.domain();
                if !(0..2).all(|k| xi[k] >= domain[k][0] && xi[k] <= domain[k][1]) {
                    break;
                }
                if trim.contains(xi) {
                    best = best.min((self.patch.point(xi) - q).norm());
                }
            }
        }
        let mut seeds: Vec<(f64, usize)> = (self.border.iter().enumerate())
            .map(|(k, b)| ((b.0 - q).norm_squared(), k))
            .collect();
        seeds.select_nth_unstable_by(4, |a, b| a.0.total_cmp(&b.0));
        for &(_, k) in &seeds[..5] {
            let (_, number, t, step) = self.border[k];
            let curve = &trim.curve(number).unwrap().parameter;
            let [low, high] = curve.domain();
            let (mut a, mut b) = ((t - step).max(low), (t + step).min(high));
            let value = |t: f64| {
                let xi = curve.point(t);
                (self.patch.point([xi.x, xi.y]) - q).norm()
            };
            for _ in 0..60 {
                let (u, v) = (a + 0.382 * (b - a), a + 0.618 * (b - a));
                if value(u) < value(v) { b = v } else { a = u }
            }
            best = best.min(value(0.5 * (a + b)));
        }
        best
    }
}

/// Queries near and far against the exhaustive search: wrong where the foot is farther, or not on the trimmed surface.
fn compare(name: &str, patch: &NurbsPatch, count: usize, seed: u64) {
    let truth = Exhaustive::new(patch, 120, 60);
    let set = set_of_one(patch);
    let mut random = Random(seed);
    let limit = 1e-9 * set.size();
    let (mut wrong, mut unsure, mut on_border) = (0, 0, 0);
    let mut hint = None;
    let [low, high] = set.bounds();
    let (middle, half) = ((low + high) * 0.5, (high - low) * 0.5);
    for k in 0..count {
        let spread = [0.9, 1.5, 40.0][k % 3];
        let q = middle
            + Vec3::from_fn(|i, _| half[i].max(0.2 * half.max()) * random.between(-spread, spread));
        let d = truth.distance(&q);
        for hint in [None, hint] {
            let foot = set.project(&q, hint, f64::INFINITY).unwrap();
            check_foot(&set, &q, &foot);
            let trim = patch.trim().unwrap();
            let valid = trim.contains(foot.xi) || trim.on_border(foot.xi, 1e-9);
            if foot.distance > d + limit || !valid {
                wrong += 1;
                if wrong < 4 {
                    eprintln!("{name}: {q:?} truth {d} valid {valid} hint {hint:?} {foot:?}");
                }
            }
            unsure += usize::from(foot.status == Status::NotConverged);
            on_border += usize::from(foot.location != Location::Face);
        }
        hint = set.project(&q, None, f64::INFINITY).map(|f| f.hint());
    }
    eprintln!(
        "{name}: {wrong} wrong, {unsure} not converged, {on_border} on the border of 2 x {count}"
    );
    assert_eq!((wrong, unsure), (0, 0), "{name}");
    assert!(on_border > count / 10, "{on_border}");
}

#[test]
fn bumpy_surface_in_a_star() {
    let mut random = crate::curves::Random(3);
    let loops = vec![
        one_curve(star(&mut random, [0.5, 0.5], [0.25, 0.48], 3, 14, false)),
        one_curve(star(&mut random, [0.45, 0.55], [0.03, 0.15], 2, 6, true)),
    ];
    compare(
        "bicubic star",
        &trimmed(bumpy(3, 9, false, 2), loops),
        queries(2000) / 2,
        1,
    );
}

#[test]
fn rational_surface_in_a_polygon() {
    let corners: Vec<[f64; 2]> = (0..14)
        .map(|k| {
            let (angle, r) = (0.45 * f64::from(k), if k % 2 == 0 { 0.45 } else { 0.22 });
            [0.5 + r * angle.cos(), 0.5 + r * angle.sin()]
        })
        .collect();
    compare(
        "rational polygon",
        &trimmed(bumpy(2, 7, true, 5), vec![polygon(&corners)]),
        queries(2000) / 2,
        2,
    );
}

#[test]
fn half_a_cylinder_in_an_ellipse() {
    let points: Vec<Vec3> = [[-1.0, 0.0], [-1.0, 1.0], [0.0, 1.0], [1.0, 1.0], [1.0, 0.0]]
        .iter()
        .flat_map(|&[x, z]| [Vec3::new(x, -1.0, z), Vec3::new(x, 1.0, z)])
        .collect();
    let h = std::f64::consts::FRAC_1_SQRT_2;
    let weights = [1.0, 1.0, h, h, 1.0, 1.0, h, h, 1.0, 1.0];
    let knots = [
        vec![0.0, 0.0, 1.0, 1.0],
        vec![0.0, 0.0, 0.0, 0.5, 0.5, 1.0, 1.0, 1.0],
    ];
    let patch = NurbsPatch::new([1, 2], knots, [2, 5], &points, Some(&weights)).unwrap();
    let patch = trimmed(patch, vec![ellipse([0.5, 0.5], [0.4, 0.45], 0.3)]);
    compare("cylinder ellipse", &patch, queries(2000) / 4, 3);
}

#[test]
fn a_trim_along_the_whole_border_changes_nothing() {
    let patch = bumpy(3, 9, false, 8);
    let full = trimmed(patch.clone(), vec![rectangle(patch.domain())]);
    let (plain, full) = (set_of_one(&patch), set_of_one(&full));
    let mut random = Random(6);
    for _ in 0..queries(300) {
        let q = Vec3::from_fn(|_, _| random.between(-4.0, 14.0));
        let [a, b] = [&plain, &full].map(|s| s.project(&q, None, f64::INFINITY).unwrap());
        assert!(
            (a.distance - b.distance).abs() < 1e-11 * plain.size(),
            "{a:?} {b:?}"
        );
        assert!(
            (a.signed_distance - b.signed_distance).abs() < 1e-9,
            "{a:?} {b:?}"
        );
    }
}

#[test]
fn reversed_and_swapped_trimmed_patches_are_as_far_away() {
    let mut random = crate::curves::Random(13);
    let loops = vec![one_curve(star(
        &mut random,
        [0.5, 0.5],
        [0.2, 0.48],
        3,
        9,
        true,
    ))];
    let patch = trimmed(bumpy(3, 6, false, 4), loops);
    let sets = [
        patch.clone(),
        patch.reversed(0).unwrap(),
        patch.reversed(1).unwrap(),
        patch.swapped().unwrap(),
    ]
    .map(|p| set_of_one(&p));
    let mut random = Random(7);
    for _ in 0..queries(200) {
        let q = Vec3::from_fn(|_, _| random.between(-4.0, 14.0));
        let feet = sets
            .each_ref()
            .map(|s| s.project(&q, None, f64::INFINITY).unwrap());
        for foot in &feet[1..] {
            assert!((foot.distance - feet[0].distance).abs() < 1e-10, "{feet:?}");
        }
    }
}

/// A patch that counts its evaluations.
#[derive(Debug, Clone)]
struct Counted(NurbsPatch, Arc<AtomicUsize>);

impl Surface for Counted {
    fn domain(&self) -> [[f64; 2]; 2] {
        self.0.domain()
    }
    fn spans(&self, dir: usize) -> Vec<[f64; 2]> {
        self.0.spans(dir)
    }
    fn find_span(&self, xi: [f64; 2]) -> [usize; 2] {
        self.0.find_span(xi)
    }
    fn jet_in_span(&self, span: [usize; 2], xi: [f64; 2]) -> Jet {
        self.1.fetch_add(1, Ordering::Relaxed);
        self.0.jet_in_span(span, xi)
    }
    fn bezier_pieces(&self) -> Vec<BezierPiece> {
        Surface::bezier_pieces(&self.0)
    }
    fn trim(&self) -> Option<&Trim> {
        self.0.trim()
    }
}

#[test]
fn the_cost_hardly_grows_with_the_number_of_holes() {
    let mut means = Vec::new();
    for n in [1, 8, 22] {
        let mut loops = vec![rectangle([[-1.0, 1.0]; 2])];
        for k in 0..n * n {
            let centre = [k % n, k / n].map(|k| -1.0 + (2.0 * k as f64 + 1.0) / n as f64);
            loops.push(ellipse(centre, [0.6 / n as f64; 2], 0.0));
        }
        let count = Arc::new(AtomicUsize::new(0));
        let patch = trimmed(plate(), loops);
        let set = PatchSet::new(vec![Counted(patch, count.clone())], None).unwrap();
        count.store(0, Ordering::Relaxed);
        let mut random = Random(5);
        let size = 2.0 / n as f64;
        for _ in 0..200 {
            let q = Vec3::new(
                random.between(-1.0, 1.0),
                random.between(-1.0, 1.0),
                random.between(0.0, 0.2) * size,
            );
            let foot = set.project(&q, None, f64::INFINITY).unwrap();
            // The holes are wide apart, so the nearest is that of the point's own square.
            let local = Vector2::new(q.x, q.y).map(|x| (x + 1.0).rem_euclid(size) - 0.5 * size);
            let off = (0.6 / n as f64 - local.norm()).max(0.0);
            assert!(
                (foot.distance - off.hypot(q.z)).abs() < 1e-10,
                "{n} {q:?} {foot:?}"
            );
        }
        means.push(count.load(Ordering::Relaxed) as f64 / 200.0);
    }
    eprintln!("evaluations per query with 1, 64 and 484 holes: {means:?}");
    assert!(means[2] < 3.0 * means[0] && means[2] < 60.0, "{means:?}");
}

#[test]
fn a_trim_elsewhere_costs_an_untrimmed_patch_nothing() {
    let mut random = Random(2);
    let (near, far) = (bumpy(3, 9, false, 8), bumpy(3, 6, false, 9));
    let far = far
        .transformed(&|x| x + Vec3::new(200.0, 0.0, 0.0))
        .unwrap();
    let with = trimmed(far.clone(), vec![rectangle(far.domain())]);
    let count = Arc::new(AtomicUsize::new(0));
    let sets = [far, with].map(|far| {
        let patches = vec![
            Counted(near.clone(), count.clone()),
            Counted(far, count.clone()),
        ];
        PatchSet::new(patches, None).unwrap()
    });
    // The tree has more leaves and may be cut elsewhere, so the order of visits and with it the last bits may differ.
    let mut sums = [0; 2];
    for _ in 0..queries(300) {
        let q = Vec3::from_fn(|_, _| random.between(-2.0, 12.0));
        let [a, b] = [0, 1].map(|k| {
            count.store(0, Ordering::Relaxed);
            let foot = sets[k].project(&q, None, f64::INFINITY).unwrap();
            sums[k] += count.load(Ordering::Relaxed);
            foot
        });
        assert!((a.distance - b.distance).abs() <= 1e-12 * a.distance.max(1.0));
        assert_eq!((a.patch, a.location), (b.patch, b.location));
    }
    eprintln!("evaluations without and with a trim elsewhere: {sums:?}");
    assert!(sums[1] as f64 <= 1.05 * sums[0] as f64, "{sums:?}");
}

#[test]
fn dense_points_of_a_trim_lie_on_its_border() {
    let mut random = crate::curves::Random(1);
    let loops = vec![one_curve(star(
        &mut random,
        [0.5, 0.5],
        [0.2, 0.48],
        3,
        9,
        true,
    ))];
    let trim = Trim::new(loops, [[0.0, 1.0]; 2], 1e-9).unwrap();
    for point in dense(&trim, 7).concat() {
        assert!(trim.on_border([point.x, point.y], 1e-12));
    }
}
