//! Query sets with known distances, shared by tests and benchmarks.
//!
//! Every truth is an upper bound that is known by construction, an analytic distance, or the answer of the exhaustive
//! search, so an answer that is farther away is wrong whatever the bound.

use covact_geometry::primitives::{sphere, sphere_without_poles};
use covact_geometry::{NurbsPatch, PatchSet, Vec3};

use super::{Random, bumpy, creased, curvature, exhaustive, normal};

/// Patches with queries and their distances.
pub struct QuerySet {
    pub name: &'static str,
    pub set: PatchSet,
    pub truths: Vec<(Vec3, f64)>,
}

fn made(name: &'static str, patches: Vec<NurbsPatch>) -> QuerySet {
    QuerySet {
        name,
        set: PatchSet::new(patches, None).unwrap(),
        truths: Vec::new(),
    }
}

/// Points at a distance along the normal, nearer than both the curvature radius and a small length: the foot is known
/// to be this near at most, and mostly is.
pub fn above(set: &PatchSet, count: usize, most: f64, seed: u64) -> Vec<(Vec3, f64)> {
    let mut random = Random(seed);
    let mut out = Vec::new();
    while out.len() < count {
        let patch = &set.patches()[(random.next() * set.patches().len() as f64) as usize];
        let xi = random.xi(patch);
        let (Some(n), Some(kappa)) = (normal(patch, xi), curvature(patch, xi)) else {
            continue;
        };
        let d = random.between(-1.0, 1.0) * most.min(0.9 / kappa.abs());
        out.push((patch.point(xi) + n * d, d.abs()));
    }
    out
}

/// Bicubic, 20 x 20 control points; polynomial or of the given kind.
pub fn near(count: usize, degree: usize, points: usize, rational: bool) -> QuerySet {
    let mut out = made("near", vec![bumpy(degree, points, rational, 7)]);
    out.truths = above(&out.set, count, 0.5, 11);
    out
}

/// A point of an edge or corner, moved within the cone of directions that it is the nearest point for. Every tenth of the
/// first 2,000 is searched exhaustively too.
pub fn edge_and_corner(count: usize) -> QuerySet {
    let mut out = made("edge and corner", vec![bumpy(3, 20, false, 7)]);
    let patch = &out.set.patches()[0];
    let mut random = Random(31);
    for k in 0..count {
        let edge = k % 4;
        let (dir, end) = (edge / 2, edge % 2);
        let along = 1 - dir;
        let mut xi = random.xi(patch);
        xi[dir] = end as f64;
        let corner = random.next() < 0.3;
        if corner {
            xi[along] = if random.next() < 0.5 { 0.0 } else { 1.0 };
        }
        let jet = patch.jet(xi);
        let n = normal(patch, xi).unwrap();
        let out_of = |k: usize| jet.rho_i[k].normalize() * if xi[k] == 0.0 { -1.0 } else { 1.0 };
        let mut conormal = out_of(dir);
        if corner {
            conormal = conormal * random.next() + out_of(along) * random.next();
        } else {
            let t = jet.rho_i[along].normalize();
            conormal -= t * conormal.dot(&t);
        }
        let d = (conormal.normalize() + n * random.between(-1.0, 1.0)).normalize()
            * random.between(0.01, 0.5);
        let q = jet.rho + d;
        let mut truth = d.norm();
        if k % 10 == 0 && k < 2000 {
            truth = truth.min(exhaustive(out.set.patches(), &q, 4, 20));
        }
        out.truths.push((q, truth));
    }
    out
}

/// From one to 1000 sizes away, every third at 1000; exhaustive search, coarse for two of three.
pub fn far(count: usize) -> QuerySet {
    let mut out = made("far", vec![bumpy(3, 20, false, 7)]);
    let mut random = Random(23);
    for k in 0..count {
        let away = if k % 3 == 1 {
            1000.0
        } else {
            10f64.powf(random.between(0.0, 3.0))
        };
        let q = random.direction() * (away * out.set.size());
        let (per_span, starts) = if k % 3 == 0 { (4, 30) } else { (2, 6) };
        let truth = exhaustive(out.set.patches(), &q, per_span, starts);
        out.truths.push((q, truth));
    }
    out
}

/// Within 2 % of a centre of curvature. Others may be nearer than the foot it was made from, so the distance along the
/// normal is a bound, and every tenth of the first 2,000 is searched exhaustively.
pub fn focal(count: usize, rational: bool) -> QuerySet {
    let points = if rational { 12 } else { 20 };
    let mut out = made("focal", vec![bumpy(3, points, rational, 3)]);
    let mut random = Random(5);
    while out.truths.len() < count {
        let patch = &out.set.patches()[0];
        let xi = random.xi(patch);
        let (Some(n), Some(kappa)) = (normal(patch, xi), curvature(patch, xi)) else {
            continue;
        };
        let d = random.between(0.98, 1.0) / kappa;
        if d.abs() < 5.0 {
            let q = patch.point(xi) + n * d;
            let mut truth = d.abs();
            let k = out.truths.len();
            if k.is_multiple_of(10) && k < 2000 {
                truth = truth.min(exhaustive(out.set.patches(), &q, 4, 20));
            }
            out.truths.push((q, truth));
        }
    }
    out
}

/// Centre, radius and axis of the spheres.
pub fn ball() -> (Vec3, f64, Vec3) {
    (
        Vec3::new(0.3, -0.2, 0.5),
        2.0,
        Vec3::new(0.2, 0.3, 0.9).normalize(),
    )
}

/// A sphere of one patch (with poles) or of six.
pub fn spherical(six: bool) -> Vec<NurbsPatch> {
    let (centre, radius, axis) = ball();
    if six {
        sphere_without_poles(radius, centre, axis).unwrap().to_vec()
    } else {
        vec![sphere(radius, centre, axis).unwrap()]
    }
}

pub fn sphere_near(count: usize, six: bool) -> QuerySet {
    let name = if six { "six patches" } else { "sphere, near" };
    let mut out = made(name, spherical(six));
    let (centre, radius, _) = ball();
    let mut random = Random(17);
    for _ in 0..count {
        let r = random.between(0.05, 2.0) * radius;
        let q = centre + random.direction() * r;
        out.truths.push((q, (r - radius).abs()));
    }
    out
}

/// On the axis and off it by 1e-12 to 0.1 of the distance from the centre.
pub fn sphere_pole(count: usize, six: bool) -> QuerySet {
    let name = if six {
        "six patches, pole"
    } else {
        "sphere, pole"
    };
    let mut out = made(name, spherical(six));
    let (centre, radius, axis) = ball();
    let mut random = Random(18);
    for k in 0..count {
        let tilt = random.direction() * 10f64.powf(random.between(-12.0, -1.0));
        let end = if k % 2 == 0 { axis } else { -axis };
        let tilt = if k % 10 == 0 { Vec3::zeros() } else { tilt };
        let offset = (end + tilt) * random.between(1.0, 3.0);
        out.truths
            .push((centre + offset, (offset.norm() - radius).abs()));
    }
    out
}

/// At the centre and off it by 1e-16 to 1e-3.
pub fn sphere_centre(count: usize, six: bool) -> QuerySet {
    let name = if six {
        "six patches, centre"
    } else {
        "sphere, centre"
    };
    let mut out = made(name, spherical(six));
    let (centre, radius, _) = ball();
    let mut random = Random(19);
    for k in 0..count {
        let away = 10f64.powf(random.between(-16.0, -3.0));
        let off = random.direction() * if k == 0 { 0.0 } else { away };
        out.truths.push((centre + off, radius - off.norm()));
    }
    out
}

/// About the ridge of a roof, searched exhaustively.
pub fn crease(count: usize) -> QuerySet {
    let mut out = made("C0 crease", vec![creased()]);
    let mut random = Random(43);
    for _ in 0..count {
        let q = Vec3::new(
            random.between(4.5, 5.5),
            random.between(0.0, 10.0),
            random.between(0.5, 3.0),
        );
        let truth = exhaustive(out.set.patches(), &q, 4, 16);
        out.truths.push((q, truth));
    }
    out
}

/// The near set with the sheet cut into `n` x `n` patches, wherever its knots are.
pub fn patchwork(count: usize, n: usize) -> QuerySet {
    let whole = bumpy(3, 20, false, 7);
    let cut = |k: usize| k as f64 / n as f64;
    let patches = (0..n * n)
        .map(|k| {
            let (i, j) = (k % n, k / n);
            whole
                .with_domain([[cut(i), cut(i + 1)], [cut(j), cut(j + 1)]])
                .unwrap()
        })
        .collect();
    let mut out = made("many patches", patches);
    let whole = PatchSet::new(vec![whole], None).unwrap();
    out.truths = above(&whole, count, 0.5, 11);
    out
}
