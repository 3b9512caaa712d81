//! From patch to patch over common edges, without a global search.

use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

use covact_geometry::bezier::BezierPiece;
use covact_geometry::primitives::{cylinder, plane, sphere_without_poles};
use covact_geometry::trim::Trim;
use covact_geometry::{Hint, Jet, NurbsPatch, PatchSet, Surface, Vec3};

/// A patch that counts its evaluations.
#[derive(Debug, Clone)]
struct Counted {
    patch: NurbsPatch,
    count: Arc<AtomicUsize>,
}

impl Surface for Counted {
    fn domain(&self) -> [[f64; 2]; 2] {
        self.patch.domain()
    }
    fn spans(&self, dir: usize) -> Vec<[f64; 2]> {
        self.patch.spans(dir)
    }
    fn find_span(&self, xi: [f64; 2]) -> [usize; 2] {
        self.patch.find_span(xi)
    }
    fn jet_in_span(&self, span: [usize; 2], xi: [f64; 2]) -> Jet {
        self.count.fetch_add(1, Ordering::Relaxed);
        self.patch.jet_in_span(span, xi)
    }
    fn bezier_pieces(&self) -> Vec<BezierPiece> {
        Surface::bezier_pieces(&self.patch)
    }
    fn crease_knots(&self, dir: usize) -> Vec<f64> {
        self.patch.crease_knots(dir)
    }
    fn sharp_knots(&self, dir: usize, angle: f64) -> Vec<f64> {
        self.patch.sharp_knots(dir, angle)
    }
    fn trim(&self) -> Option<&Trim> {
        self.patch.trim()
    }
}

fn counted(patches: Vec<NurbsPatch>) -> (PatchSet<Counted>, Arc<AtomicUsize>) {
    let count = Arc::new(AtomicUsize::new(0));
    let wrap = |patch| Counted {
        patch,
        count: count.clone(),
    };
    let set = PatchSet::new(patches.into_iter().map(wrap).collect(), None).unwrap();
    (set, count)
}

/// Walks along points with nothing but the foot before as a hint; every foot is as near as that of a search from nothing.
/// Returns the patches visited, the mean and the largest number of evaluations of a step.
fn walk(
    set: &PatchSet<Counted>,
    count: &AtomicUsize,
    points: impl Iterator<Item = Vec3>,
) -> (Vec<u32>, f64, usize) {
    let mut hint: Option<Hint> = None;
    let (mut seen, mut all, mut most, mut steps) = (Vec::new(), 0, 0, 0);
    for q in points {
        let cold = set.project(&q, None, f64::INFINITY).unwrap();
        if let Some(hint) = hint {
            let before = count.load(Ordering::Relaxed);
            let foot = set.track(&q, hint).unwrap();
            let used = count.load(Ordering::Relaxed) - before;
            (all, most, steps) = (all + used, most.max(used), steps + 1);
            let limit = 1e-11 * set.size();
            assert!(
                (foot.distance - cold.distance).abs() <= limit,
                "{q:?} {foot:?} {cold:?}"
            );
            assert!(
                (foot.jet.rho - cold.jet.rho).norm() <= 1e-7,
                "{foot:?} {cold:?}"
            );
            assert!((foot.signed_distance - cold.signed_distance).abs() <= limit);
            seen.push(foot.patch);
        }
        hint = Some(hint.map_or(cold, |h| set.track(&q, h).unwrap()).hint());
    }
    seen.sort_unstable();
    seen.dedup();
    (seen, all as f64 / steps as f64, most)
}

/// Great circle of radius `r` in a plane spanned by two vectors.
fn circle(r: f64, steps: usize) -> impl Iterator<Item = Vec3> {
    let a = Vec3::new(1.0, 0.2, 0.1).normalize();
    let b = Vec3::new(-0.3, 0.6, 0.9);
    let b = (b - a * a.dot(&b)).normalize();
    (0..=steps).map(move |k| {
        let (sin, cos) = (std::f64::consts::TAU * k as f64 / steps as f64).sin_cos();
        (a * cos + b * sin) * r
    })
}

#[test]
fn a_great_circle_over_six_patches() {
    let six = sphere_without_poles(2.0, Vec3::zeros(), Vec3::z()).unwrap();
    let (set, count) = counted(six.to_vec());
    for (radius, steps) in [(2.1, 360), (1.7, 360), (2.3, 24)] {
        let (seen, mean, most) = walk(&set, &count, circle(radius, steps));
        eprintln!("radius {radius}, {steps} steps: {mean:.1} evaluations a step, {most} at most");
        assert!(seen.len() >= 4, "{seen:?}");
        assert!(mean < 10.0 && most < 30, "{mean} {most}");
    }
}

#[test]
fn a_circle_around_a_seam_and_many_strips() {
    // Forty strips of a cylinder in shuffled order, every third turned over.
    let whole = cylinder(3.0, 2.0, Vec3::zeros(), Vec3::z()).unwrap();
    let width = std::f64::consts::TAU / 40.0;
    let strips = (0..40).map(|k| {
        let k = k * 7 % 40;
        let start = width * k as f64;
        let strip = whole
            .with_domain([[start, start + width], [0.0, 2.0]])
            .unwrap();
        if k % 3 == 0 {
            strip.swapped().unwrap()
        } else {
            strip
        }
    });
    let (set, count) = counted(strips.collect());
    assert_eq!((set.edges().smooth, set.edges().free.len()), (40, 80));
    let around = |steps: usize| {
        (0..=steps).map(move |k| {
            let (sin, cos) = (std::f64::consts::TAU * k as f64 / steps as f64).sin_cos();
            Vec3::new(3.2 * cos, 3.2 * sin, 0.3 * (3.0 * sin))
        })
    };
    // Steps of a fifth of a strip, and of three strips.
    for steps in [200, 13] {
        let (seen, mean, most) = walk(&set, &count, around(steps));
        eprintln!("{steps} steps: {mean:.1} evaluations a step, {most} at most");
        assert!(seen.len() >= 13);
        assert!(most < 40, "{most}");
    }
}

#[test]
fn around_trimmed_faces() {
    use crate::faces::{disc, trimmed_box};
    // Over a cylinder and its caps, along a loop that leaves the caps over their rims.
    let tube = cylinder(1.5, 2.0, Vec3::zeros(), Vec3::z()).unwrap();
    let caps = [disc(1.5, 1.0, &[0.7]), disc(1.5, -1.0, &[0.1, 0.15, 3.0])];
    let (set, count) = counted(vec![caps[0].clone(), tube, caps[1].clone()]);
    let around = |radius: f64, steps: usize, tilt: f64| {
        (0..=steps).map(move |k| {
            let (sin, cos) = (std::f64::consts::TAU * k as f64 / steps as f64 + 0.1).sin_cos();
            Vec3::new(radius * cos, tilt * radius * cos, 0.8 * radius * sin)
        })
    };
    let (seen, mean, most) = walk(&set, &count, around(2.4, 300, 0.3));
    eprintln!("cylinder with caps: {mean:.1} evaluations a step, {most} at most");
    assert_eq!(seen, [0, 1, 2]);
    assert!(mean < 20.0 && most < 60, "{mean} {most}");
    let (set, count) = counted(trimmed_box([1.0, 1.2, 0.9]));
    let (seen, mean, most) = walk(&set, &count, around(2.5, 300, 0.4));
    eprintln!("box: {mean:.1} evaluations a step, {most} at most");
    assert!(seen.len() >= 4, "{seen:?}");
    assert!(mean < 20.0 && most < 60, "{mean} {most}");
}

#[test]
fn vectors_are_carried_over_smooth_and_sharp_edges() {
    // Over the smooth joints of the sphere the vector itself stays.
    let six = sphere_without_poles(2.0, Vec3::zeros(), Vec3::z()).unwrap();
    let mut six = six.to_vec();
    six[2] = six[2].swapped().unwrap();
    let set = PatchSet::new(six, None).unwrap();
    let mut checked = 0;
    for patch in 0..6 {
        for edge in 0..4 {
            for s in [0.2, 0.9, 1.4] {
                let [dir, end] = [edge as usize / 2, edge as usize % 2];
                let mut xi = [s; 2];
                xi[dir] = set.patches()[patch as usize].domain()[dir][end];
                let other = set.neighbour(patch, edge, xi).unwrap();
                let (here, there) = (
                    set.patches()[patch as usize].jet(xi),
                    set.patches()[other.patch as usize].jet(other.xi),
                );
                assert!((here.rho - there.rho).norm() < 1e-13 && other.gap < 1e-13);
                assert!(other.angle < 1e-12);
                let v = [0.3, -0.8];
                let before = here.rho_i[0] * v[0] + here.rho_i[1] * v[1];
                let w = other.map.map(|m| m[0] * v[0] + m[1] * v[1]);
                let after = there.rho_i[0] * w[0] + there.rho_i[1] * w[1];
                assert!((before - after).norm() < 1e-11, "{before:?} {after:?}");
                let sides = set.sides()[patch as usize] * set.sides()[other.patch as usize];
                assert_eq!(other.relation, sides);
                // There and back.
                let back = set.neighbour(other.patch, other.edge, other.xi).unwrap();
                assert_eq!((back.patch, back.edge), (patch, edge));
                assert!((back.xi[0] - xi[0]).abs() + (back.xi[1] - xi[1]).abs() < 1e-12);
                checked += 1;
            }
        }
    }
    assert_eq!(checked, 72);
    // Over the edge of a right angle it is unfolded: what pointed out of the floor climbs the wall.
    let floor = plane(Vec3::zeros(), Vec3::z(), [2.0, 2.0]).unwrap();
    let wall = plane(Vec3::new(1.0, 0.0, 1.0), Vec3::x(), [2.0, 2.0]).unwrap();
    let set = PatchSet::new(vec![floor, wall], None).unwrap();
    let joint = &set.edges().joints[0];
    let (own, _) = (joint.edges[0], joint.edges[1]);
    let xi = [2.0, 0.7];
    assert_eq!(own, (0, 1));
    let other = set.neighbour(0, 1, xi).unwrap();
    assert!((other.angle - std::f64::consts::FRAC_PI_2).abs() < 1e-12 || other.relation < 0.0);
    let jet = set.patches()[1].jet(other.xi);
    let w = other.map.map(|m| m[0] * 0.6 + m[1] * 0.5);
    let after = jet.rho_i[0] * w[0] + jet.rho_i[1] * w[1];
    assert!(
        (after - Vec3::new(0.0, 0.5, 0.6)).norm() < 1e-13,
        "{after:?}"
    );
    // Free edges have nothing behind them.
    assert!(set.neighbour(0, 0, [0.0, 0.5]).is_none() && set.neighbour(0, 9, xi).is_none());
}

#[test]
fn part_of_an_edge_may_be_free() {
    use covact_geometry::{EdgeKind, Location};
    // A floor of 4 x 4 with a wall on the half y < 0 of its side x = 2.
    let floor = plane(Vec3::zeros(), Vec3::z(), [4.0, 4.0]).unwrap();
    let wall = plane(Vec3::new(2.0, -1.0, -1.0), Vec3::x(), [2.0, 2.0]).unwrap();
    let set = PatchSet::new(vec![floor, wall], None).unwrap();
    let foot = |x, y, z| {
        set.project(&Vec3::new(x, y, z), None, f64::INFINITY)
            .unwrap()
    };
    let kind = |location| match location {
        Location::Edge { kind, .. } => kind,
        other => panic!("{other:?}"),
    };
    let sharp = foot(3.0, -1.0, 1.0);
    assert_eq!(kind(sharp.location), EdgeKind::Sharp);
    assert!((sharp.normal.x.abs() - sharp.normal.z.abs()).abs() < 1e-12);
    let free = foot(3.0, 1.0, 1.0);
    assert_eq!(kind(free.location), EdgeKind::Free);
    assert!((free.normal.z.abs() - 1.0).abs() < 1e-12);
    assert!(set.neighbour(0, 1, [4.0, 1.0]).is_some());
    assert!(set.neighbour(0, 1, [4.0, 3.0]).is_none());
}
