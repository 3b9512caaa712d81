//! Faces of STEP files on spheres, cones and tori that hold a pole or go round, bounded by as few edges as kernels write: no
//! seams, no vertex at the pole, no curves in parameter planes. Areas and volumes in closed form.

use crate::step_builder::{Step, area, near, set, volume};
use covact_geometry::io::CadFile;
use std::f64::consts::PI;

const X: [f64; 3] = [1., 0., 0.];
const Y: [f64; 3] = [0., 1., 0.];
const Z: [f64; 3] = [0., 0., 1.];
const ORIGIN: [f64; 3] = [0.; 3];

fn along(at: [f64; 3], t: f64, d: [f64; 3]) -> [f64; 3] {
    [0, 1, 2].map(|k| at[k] + t * d[k])
}

/// A closed edge: a circle about `axis`, from the vertex in the direction `x`.
fn ring(step: &mut Step, center: [f64; 3], axis: [f64; 3], x: [f64; 3], radius: f64) -> String {
    let vertex = step.vertex(along(center, radius, x));
    let place = step.placement(center, axis, x);
    let circle = step.placed("CIRCLE", &place, &format!("{radius:?}"));
    step.edge([&vertex, &vertex], &circle)
}

/// The plane through a circle about `axis`, with that normal or the opposite one, bounded by the circle.
fn lid(step: &mut Step, center: [f64; 3], axis: [f64; 3], x: [f64; 3], edge: &str) -> String {
    let (bound, axis) = match edge.starts_with('-') {
        true => (step.bound(&[edge]), axis.map(|a| -a)),
        false => (step.bound(&[edge]), axis),
    };
    let place = step.placement(center, axis, x);
    let plane = step.placed("PLANE", &place, "");
    step.face(&[&bound], &plane, true)
}

/// A ball of radius 2 cut by the plane at `height` along `axis`: the part above, as a closed solid.
fn cap(axis: [f64; 3], x: [f64; 3], height: f64, below: bool) -> CadFile {
    let mut step = Step::default();
    let center = along(ORIGIN, height, axis);
    let edge = ring(&mut step, center, axis, x, (4. - height * height).sqrt());
    let (own, other) = match below {
        true => (format!("-{edge}"), edge.clone()),
        false => (edge.clone(), format!("-{edge}")),
    };
    let bound = step.bound(&[&own]);
    let place = step.placement(ORIGIN, Z, X);
    let sphere = step.placed("SPHERICAL_SURFACE", &place, "2.");
    let dome = step.face(&[&bound], &sphere, true);
    let lid = lid(&mut step, center, axis, x, &other);
    let solid = step.solid(&[&dome, &lid]);
    step.whole(&[&solid])
}

#[test]
fn caps_of_a_sphere() {
    let (s, c) = (0.6, 0.8);
    for (axis, x, height, below) in [
        // About the axis of the sphere, with one pole.
        (Z, X, 0., false),
        (Z, X, 1., false),
        (Z, X, -1., false),
        (Z, X, -1., true),
        (Z, Y, 0.5, true),
        // Beside the poles, and with both of them.
        (X, Y, 1., false),
        (X, Y, 1., true),
        (Y, Z, 0., false),
        (X, Z, 0., true),
        (Y, X, 0., false),
        (X, Y, 0., true),
        (Y, [0.6, 0., 0.8], 0., true),
        // Askew: round one pole.
        ([0., s, c], X, 0.5, false),
        ([0., s, c], X, 0.5, true),
        ([s, 0., -c], Y, 1.2, false),
        ([c, 0., s], Y, 1.5, false),
    ] {
        let file = cap(axis, x, height, below);
        let set = set(&file, None);
        let h = if below { 2. + height } else { 2. - height };
        println!("axis {axis:?}, height {height}, below {below}");
        let flat = PI * (4. - height * height);
        near(area(&set), 4. * PI * h + flat, 1e-7);
        near(volume(&set), PI * h * h * (2. - h / 3.), 1e-7);
    }
}

/// Two halves of a ball between meridians, as kernels write it that know no seams.
#[test]
fn halves_of_a_ball_between_meridians() {
    let mut step = Step::default();
    let (south, north) = (step.vertex([0., 0., -2.]), step.vertex([0., 0., 2.]));
    // From the south pole over +x and over -x to the north pole.
    let mut meridian = |axis: [f64; 3]| {
        let place = step.placement(ORIGIN, axis, [0., 0., -1.]);
        let circle = step.placed("CIRCLE", &place, "2.");
        step.edge([&south, &north], &circle)
    };
    let front = meridian([0., -1., 0.]);
    let back = meridian(Y);
    let place = step.placement(ORIGIN, Z, X);
    let sphere = step.placed("SPHERICAL_SURFACE", &place, "2.");
    let mut halves = Vec::new();
    // y < 0 lies to the left of the meridian over +x, seen from outside.
    for ring in [
        [front.clone(), format!("-{back}")],
        [back.clone(), format!("-{front}")],
    ] {
        let bound = step.bound(&[&ring[0], &ring[1]]);
        halves.push(step.face(&[&bound], &sphere, true));
    }
    let solid = step.solid(&[&halves[0], &halves[1]]);
    let file = step.whole(&[&solid]);
    let set = set(&file, None);
    for area in set.areas() {
        near(area, 8. * PI, 1e-9);
    }
    near(volume(&set), 32. / 3. * PI, 1e-9);
}

/// An eighth of a ball: the corner at the pole belongs to one face only.
#[test]
fn octant_of_a_sphere() {
    let mut step = Step::default();
    let tips = [X, Y, Z].map(|d| step.vertex(along(ORIGIN, 2., d)));
    let mut arc = |axis: [f64; 3], x: [f64; 3], ends: [usize; 2]| {
        let place = step.placement(ORIGIN, axis, x);
        let circle = step.placed("CIRCLE", &place, "2.");
        step.edge([&tips[ends[0]], &tips[ends[1]]], &circle)
    };
    let edges = [arc(Z, X, [0, 1]), arc(X, Y, [1, 2]), arc(Y, Z, [2, 0])];
    let bound = step.bound(&[&edges[0], &edges[1], &edges[2]]);
    let place = step.placement(ORIGIN, Z, X);
    let sphere = step.placed("SPHERICAL_SURFACE", &place, "2.");
    let face = step.face(&[&bound], &sphere, true);
    let sheet = step.sheet(&[&face]);
    near(area(&set(&step.whole(&[&sheet]), None)), 2. * PI, 1e-9);
}

/// A drill's tip: a cone with the circle at its base alone, and with a loop of the vertex at its tip.
#[test]
fn tips_of_cones() {
    for with_vertex in [false, true] {
        for up in [1., -1.] {
            let mut step = Step::default();
            // Radius 3 at the height 0, the tip at the height -4 along the axis of the cone.
            let axis = [0., 0., up];
            let edge = ring(&mut step, ORIGIN, axis, X, 3.);
            let mut bounds = vec![step.bound(&[&format!("-{edge}")])];
            if with_vertex {
                let vertex = step.vertex([0., 0., -4. * up]);
                let a_loop = step.add(format!("VERTEX_LOOP('',{vertex})"));
                bounds.push(step.add(format!("FACE_BOUND('',{a_loop},.T.)")));
            }
            let place = step.placement(ORIGIN, axis, X);
            let half = 0.75f64.atan();
            let cone = step.placed("CONICAL_SURFACE", &place, &format!("3.,{half:?}"));
            let bounds: Vec<&str> = bounds.iter().map(String::as_str).collect();
            let side = step.face(&bounds, &cone, true);
            let lid = lid(&mut step, ORIGIN, axis, X, &edge);
            let solid = step.solid(&[&side, &lid]);
            let file = step.whole(&[&solid]);
            let set = set(&file, None);
            near(area(&set), PI * 3. * 5. + PI * 9., 1e-9);
            near(volume(&set), PI * 9. * 4. / 3., 1e-9);
        }
    }
}

/// The upper half of a torus between its inner and its outer circle.
#[test]
fn torus_cut_across_its_axis() {
    let mut step = Step::default();
    let (inner, outer) = (
        ring(&mut step, ORIGIN, Z, X, 7.),
        ring(&mut step, ORIGIN, Z, X, 13.),
    );
    let bounds = [step.bound(&[&outer]), step.bound(&[&format!("-{inner}")])];
    let place = step.placement(ORIGIN, Z, X);
    let torus = step.placed("TOROIDAL_SURFACE", &place, "10.,3.");
    let top = step.face(&[&bounds[0], &bounds[1]], &torus, true);
    let bounds = [step.bound(&[&format!("-{outer}")]), step.bound(&[&inner])];
    let down = step.placement(ORIGIN, [0., 0., -1.], X);
    let plane = step.placed("PLANE", &down, "");
    let bottom = step.face(&[&bounds[0], &bounds[1]], &plane, true);
    let solid = step.solid(&[&top, &bottom]);
    let set = set(&step.whole(&[&solid]), None);
    near(area(&set), 2. * PI * PI * 30. + PI * (169. - 49.), 1e-9);
    near(volume(&set), PI * PI * 90., 1e-9);
}

/// A quarter of a torus between two circles about its tube, a bent pipe.
#[test]
fn torus_cut_along_its_axis() {
    let mut step = Step::default();
    // Both circles turn about the direction in which the pipe runs.
    let start = ring(&mut step, [10., 0., 0.], Y, X, 3.);
    let end = ring(&mut step, [0., 10., 0.], [-1., 0., 0.], Y, 3.);
    let bounds = [step.bound(&[&start]), step.bound(&[&format!("-{end}")])];
    let place = step.placement(ORIGIN, Z, X);
    let torus = step.placed("TOROIDAL_SURFACE", &place, "10.,3.");
    let pipe = step.face(&[&bounds[0], &bounds[1]], &torus, true);
    let sheet = step.sheet(&[&pipe]);
    near(
        area(&set(&step.whole(&[&sheet]), None)),
        PI * PI * 30.,
        1e-9,
    );
}

/// A can with a seam edge that lies anywhere but on the seam of the surface.
#[test]
fn seam_beside_that_of_the_surface() {
    let mut step = Step::default();
    let out = [0.6, -0.8, 0.];
    let feet = [out.map(|x| 2. * x), [1.2, -1.6, 5.]];
    let vertices = feet.map(|x| step.vertex(x));
    let [low, high] = [0, 1].map(|k| {
        let place = step.placement([0., 0., 5. * k as f64], Z, Y);
        let circle = step.placed("CIRCLE", &place, "2.");
        step.edge([&vertices[k], &vertices[k]], &circle)
    });
    let seam = step.line([&vertices[0], &vertices[1]], feet);
    let side = step.bound(&[&low, &seam, &format!("-{high}"), &format!("-{seam}")]);
    let place = step.placement(ORIGIN, Z, X);
    let cylinder = step.placed("CYLINDRICAL_SURFACE", &place, "2.");
    let side = step.face(&[&side], &cylinder, true);
    let bottom = lid(&mut step, ORIGIN, Z, X, &format!("-{low}"));
    let top = lid(&mut step, [0., 0., 5.], Z, X, &high);
    let solid = step.solid(&[&side, &bottom, &top]);
    let set = set(&step.whole(&[&solid]), None);
    near(area(&set), 4. * PI * 5. + 8. * PI, 1e-9);
    near(volume(&set), 4. * PI * 5., 1e-9);
}

/// A ball bounded by one meridian, there and back.
#[test]
fn ball_of_one_meridian() {
    let mut step = Step::default();
    let (south, north) = (step.vertex([0., 0., -2.]), step.vertex([0., 0., 2.]));
    let place = step.placement(ORIGIN, [0., -1., 0.], [0., 0., -1.]);
    let circle = step.placed("CIRCLE", &place, "2.");
    let seam = step.edge([&south, &north], &circle);
    let bound = step.bound(&[&seam, &format!("-{seam}")]);
    let place = step.placement(ORIGIN, Z, X);
    let sphere = step.placed("SPHERICAL_SURFACE", &place, "2.");
    let ball = step.face(&[&bound], &sphere, true);
    let solid = step.solid(&[&ball]);
    let set = set(&step.whole(&[&solid]), None);
    near(area(&set), 16. * PI, 1e-9);
    near(volume(&set), 32. / 3. * PI, 1e-9);
}
