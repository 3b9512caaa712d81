//! Nanoseconds per second-order jet (point, two first and three second derivatives) beside truck-geometry and
//! monstertruck-geometry, which evaluate the same six quantities one by one. Every number is the fastest of many short
//! batches, so that what else the machine does hardly counts; one thread, default build.

use std::hint::black_box;
use std::time::{Duration, Instant};

use covact_geometry::{Frame, Jet, NurbsPatch, PatchShape, Vec3};
use monstertruck_geometry::prelude as monster;
use truck_geometry::prelude::{NurbsSurface, Vector4};

/// Evaluations in a batch of the fast codes.
const BATCH: usize = 512;

fn random(state: &mut u64) -> f64 {
    *state = state
        .wrapping_mul(6_364_136_223_846_793_005)
        .wrapping_add(1_442_695_040_888_963_407);
    (*state >> 11) as f64 / (1u64 << 53) as f64
}

fn patch(degree: usize, count: usize, rational: bool) -> NurbsPatch {
    let mut state = 42;
    let inner = count - degree;
    let mut knots = vec![0.0; degree];
    knots.extend((0..=inner).map(|k| k as f64 / inner as f64));
    knots.extend(vec![1.0; degree]);
    let points: Vec<Vec3> = (0..count * count)
        .map(|k| Vec3::new((k % count) as f64, (k / count) as f64, random(&mut state)))
        .collect();
    let weights: Vec<f64> = points.iter().map(|_| 0.5 + random(&mut state)).collect();
    let weights = rational.then_some(weights.as_slice());
    let knots = [knots.clone(), knots];
    NurbsPatch::new([degree; 2], knots, [count; 2], &points, weights).expect("the patch is sound")
}

/// Nanoseconds per call of `f`, which takes one parameter pair.
fn time<T>(xi: &[[f64; 2]], mut f: impl FnMut([f64; 2]) -> T) -> f64 {
    let start = Instant::now();
    let (mut best, mut batches) = (Duration::MAX, 0);
    while batches < 20 || (start.elapsed() < Duration::from_millis(150) && batches < 3000) {
        let begin = Instant::now();
        for &xi in xi {
            black_box(&f(black_box(xi)));
        }
        best = best.min(begin.elapsed());
        batches += 1;
    }
    best.as_secs_f64() * 1e9 / xi.len() as f64
}

fn truck_jet(surface: &NurbsSurface<Vector4>, [u, v]: [f64; 2]) -> Jet {
    let x = surface.subs(u, v);
    let vector = |v: truck_geometry::prelude::Vector3| Vec3::new(v.x, v.y, v.z);
    Jet {
        rho: Vec3::new(x.x, x.y, x.z),
        rho_i: [vector(surface.uder(u, v)), vector(surface.vder(u, v))],
        rho_ij: [
            vector(surface.uuder(u, v)),
            vector(surface.uvder(u, v)),
            vector(surface.vvder(u, v)),
        ],
    }
}

type MonsterSurface = monster::NurbsSurface<monster::Vector4>;

fn to_monster(patch: &NurbsPatch) -> MonsterSurface {
    let [columns, rows] = patch.counts();
    let point = |i: usize, j: usize| monster::Vector4::from(patch.homogeneous()[i + columns * j]);
    let net = (0..columns).map(|i| (0..rows).map(|j| point(i, j)).collect());
    let knots = |dir| monster::KnotVector::from(patch.knots(dir).to_vec());
    let knots = (knots(0), knots(1));
    MonsterSurface::new(monster::BsplineSurface::new(knots, net.collect()))
}

fn monster_jet(surface: &MonsterSurface, [u, v]: [f64; 2]) -> Jet {
    use monster::ParametricSurface;
    let x = surface.evaluate(u, v);
    let vector = |v: monster::Vector3| Vec3::new(v.x, v.y, v.z);
    Jet {
        rho: Vec3::new(x.x, x.y, x.z),
        rho_i: [
            vector(surface.derivative_u(u, v)),
            vector(surface.derivative_v(u, v)),
        ],
        rho_ij: [
            vector(surface.derivative_uu(u, v)),
            vector(surface.derivative_uv(u, v)),
            vector(surface.derivative_vv(u, v)),
        ],
    }
}

fn main() {
    let mut state = 7;
    let mut pair = || [random(&mut state), random(&mut state)];
    let xi: Vec<[f64; 2]> = (0..BATCH).map(|_| pair()).collect();
    // Few enough that a batch of the slow codes fits between two interruptions.
    let few = &xi[..32];
    println!("ns per jet (point, first and second derivatives), one thread");
    println!(
        "{:<22} {:>9} {:>9} {:>9} {:>9} {:>9} {:>9} {:>14} {:>14}",
        "patch",
        "in span",
        "random",
        "portable",
        "random",
        "jet3",
        "shape",
        "monstertruck",
        "truck"
    );
    for (degree, count, rational) in [
        (2, 20, false),
        (2, 20, true),
        (3, 20, false),
        (3, 20, true),
        (3, 60, true),
        (5, 20, false),
        (5, 20, true),
        (9, 20, true),
    ] {
        let patch = patch(degree, count, rational);
        let portable = patch.clone().with_portable_kernel();
        let [a, b] = patch.spans(0)[5];
        let inside: Vec<[f64; 2]> = xi.iter().map(|x| x.map(|s| a + (b - a) * s)).collect();
        let mut shape = PatchShape::default();
        let surface = patch.to_truck();
        let monster = to_monster(&patch);
        let ours = [
            time(&inside, |xi| patch.jet_in_span(black_box([5, 5]), xi)),
            time(&xi, |xi| patch.jet(xi)),
            time(&inside, |xi| portable.jet_in_span(black_box([5, 5]), xi)),
            time(&xi, |xi| portable.jet(xi)),
            time(&xi, |xi| patch.jet3(xi)),
            time(&xi, |xi| patch.shape(xi, &mut shape)),
        ];
        let others = [
            time(few, |xi| monster_jet(&monster, xi)),
            time(few, |xi| truck_jet(&surface, xi)),
        ];
        let kind = if rational { "rational" } else { "plain" };
        print!("{:<22}", format!("p = {degree}, {count} x {count} {kind}"));
        ours.iter().for_each(|t| print!(" {t:>9.1}"));
        for t in others {
            print!(" {:>14}", format!("{t:.0} ({:.0}x)", t / ours[1]));
        }
        println!();
    }
    let patch = patch(3, 20, true);
    let frame = time(&xi, |xi| Frame::new(&patch.jet(xi), 1.0));
    println!("jet and local frame, p = 3, 20 x 20 rational: {frame:.1} ns");
    println!("portable kernel in use: {}", patch.has_portable_kernel());
}
