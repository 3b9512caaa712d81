//! Shapes in STEP whose areas and volumes are known in closed form, without curves in parameter planes.

use crate::step_builder::{Step, area, box_faces, near, set, volume};
use covact_geometry::Vec3;
use std::f64::consts::{FRAC_PI_2, PI, TAU};

const Z: [f64; 3] = [0., 0., 1.];
const X: [f64; 3] = [1., 0., 0.];
const ORIGIN: [f64; 3] = [0.; 3];

/// A closed edge: a circle about the z axis from the vertex on the x axis.
fn circle(step: &mut Step, radius: f64, height: f64) -> (String, String) {
    let vertex = step.vertex([radius, 0., height]);
    let place = step.placement([0., 0., height], Z, X);
    let circle = step.placed("CIRCLE", &place, &format!("{radius:?}"));
    let edge = step.edge([&vertex, &vertex], &circle);
    (edge, vertex)
}

#[test]
fn sphere_of_one_vertex() {
    let mut step = Step::default();
    let vertex = step.vertex([1., 2., 3. - 2.5]);
    let a_loop = step.add(format!("VERTEX_LOOP('',{vertex})"));
    let bound = step.add(format!("FACE_BOUND('',{a_loop},.T.)"));
    let place = step.placement([1., 2., 3.], Z, X);
    let sphere = step.placed("SPHERICAL_SURFACE", &place, "2.5");
    let face = step.face(&[&bound], &sphere, true);
    let solid = step.solid(&[&face]);
    let set = set(&step.whole(&[&solid]), None);
    near(area(&set), 4. * PI * 6.25, 1e-9);
    near(volume(&set), 4. / 3. * PI * 2.5f64.powi(3), 1e-9);
}

#[test]
fn torus_cut_at_both_seams() {
    let (major, minor) = (10., 3.);
    let mut step = Step::default();
    let vertex = step.vertex([major + minor, 0., 0.]);
    let flat = step.placement(ORIGIN, Z, X);
    let around = step.placed("CIRCLE", &flat, "13.");
    let around = step.edge([&vertex, &vertex], &around);
    // Upwards on the outside, as the angle about the tube grows.
    let tall = step.placement([major, 0., 0.], [0., -1., 0.], X);
    let tube = step.placed("CIRCLE", &tall, "3.");
    let tube = step.edge([&vertex, &vertex], &tube);
    let bound = step.bound(&[&around, &tube, &format!("-{around}"), &format!("-{tube}")]);
    let torus = step.placed("TOROIDAL_SURFACE", &flat, "10.,3.");
    let face = step.face(&[&bound], &torus, true);
    let solid = step.solid(&[&face]);
    let set = set(&step.whole(&[&solid]), None);
    near(area(&set), 4. * PI * PI * major * minor, 1e-9);
    near(volume(&set), 2. * PI * PI * major * minor * minor, 1e-9);
}

/// Frustum of a cone between heights 0 and 5 with radii 3 and 1: its seam is used twice by the one loop.
fn frustum(angle: f64) -> Step {
    let mut step = Step::default();
    let ((low, a), (high, b)) = (circle(&mut step, 3., 0.), circle(&mut step, 1., 5.));
    let seam = step.line([&a, &b], [[3., 0., 0.], [1., 0., 5.]]);
    let side = step.bound(&[&low, &seam, &format!("-{high}"), &format!("-{seam}")]);
    // The axis points down, so that the cone widens along it.
    let place = step.placement([0., 0., 5.], [0., 0., -1.], X);
    let half = format!("1.,{:?}", angle);
    let cone = step.placed("CONICAL_SURFACE", &place, &half);
    let side = step.face(&[&side], &cone, true);
    let mut cap = |edge: &str, z: f64| {
        let bound = step.bound(&[edge]);
        let place = step.placement([0., 0., z], [0., 0., if z > 0. { 1. } else { -1. }], X);
        let plane = step.placed("PLANE", &place, "");
        step.face(&[&bound], &plane, true)
    };
    let (bottom, top) = (cap(&format!("-{low}"), 0.), cap(&high, 5.));
    step.solid(&[&side, &bottom, &top]);
    step
}

fn check_frustum(file: &covact_geometry::io::CadFile) {
    assert!(file.skipped.is_empty(), "{:?}", file.skipped);
    let set = set(file, None);
    let slant = 29f64.sqrt();
    near(area(&set), PI * (4. * slant + 9. + 1.), 1e-9);
    near(volume(&set), PI * 5. / 3. * (9. + 3. + 1.), 1e-9);
}

#[test]
fn frustum_of_a_cone() {
    let mut step = frustum(0.4f64.atan());
    let solid = format!("#{}", step.text().matches("\n#").count());
    let context = step.millimetres();
    step.shape(&[&solid], &context);
    check_frustum(&step.read());
}

#[test]
fn angles_in_degrees() {
    let mut step = frustum(0.4f64.atan().to_degrees());
    let solid = format!("#{}", step.text().matches("\n#").count());
    let length = step.add("(LENGTH_UNIT()NAMED_UNIT(*)SI_UNIT(.MILLI.,.METRE.))");
    let radian = step.add("(NAMED_UNIT(*)PLANE_ANGLE_UNIT()SI_UNIT($,.RADIAN.))");
    let factor = step.add(format!(
        "PLANE_ANGLE_MEASURE_WITH_UNIT(PLANE_ANGLE_MEASURE(1.745329251994E-2),{radian})"
    ));
    let none = step.add("DIMENSIONAL_EXPONENTS(0.,0.,0.,0.,0.,0.,0.)");
    let degree = step.add(format!(
        "(CONVERSION_BASED_UNIT('DEGREE',{factor})NAMED_UNIT({none})PLANE_ANGLE_UNIT())"
    ));
    let context = step.context(&length, &degree);
    step.shape(&[&solid], &context);
    check_frustum(&step.read());
}

/// The cylinder has two loops that go round it and no seam.
#[test]
fn box_with_a_hole() {
    let mut step = Step::default();
    let (low, high) = (circle(&mut step, 2., 0.).0, circle(&mut step, 2., 8.).0);
    let down = step.bound(&[&low]);
    let up = step.bound(&[&format!("-{high}")]);
    let mut faces = box_faces(
        &mut step,
        [[-5., -5., 0.], [5., 5., 8.]],
        [Some(&down), Some(&up)],
    );
    let bounds = [step.bound(&[&format!("-{low}")]), step.bound(&[&high])];
    let place = step.placement(ORIGIN, Z, X);
    let wall = step.placed("CYLINDRICAL_SURFACE", &place, "2.");
    faces.push(step.face(&[&bounds[0], &bounds[1]], &wall, false));
    let faces: Vec<&str> = faces.iter().map(String::as_str).collect();
    let solid = step.solid(&faces);
    let file = step.whole(&[&solid]);
    let set = set(&file, None);
    near(
        area(&set),
        2. * (100. - 4. * PI) + 4. * 80. + TAU * 2. * 8.,
        1e-9,
    );
    near(volume(&set), (100. - 4. * PI) * 8., 1e-9);
    // The wall's normal points to the axis.
    let wall = &file.patches[6].patch;
    let [[a, b], [c, d]] = wall.domain();
    let jet = wall.jet([a + 0.3 * (b - a), 0.5 * (c + d)]);
    let normal = jet.rho_i[0].cross(&jet.rho_i[1]);
    assert!(normal.dot(&Vec3::new(jet.rho.x, jet.rho.y, 0.)) < 0.);
}

#[test]
fn void_in_a_solid() {
    let mut step = Step::default();
    let faces = box_faces(&mut step, [[-5.; 3], [5.; 3]], [None, None]);
    let outer = step.add(format!("CLOSED_SHELL('',({}))", faces.join(",")));
    let vertex = step.vertex([0., 0., -3.]);
    let a_loop = step.add(format!("VERTEX_LOOP('',{vertex})"));
    let bound = step.add(format!("FACE_BOUND('',{a_loop},.T.)"));
    let place = step.placement(ORIGIN, Z, X);
    let sphere = step.placed("SPHERICAL_SURFACE", &place, "3.");
    let ball = step.face(&[&bound], &sphere, true);
    let inner = step.add(format!("CLOSED_SHELL('',({ball}))"));
    let void = step.add(format!("ORIENTED_CLOSED_SHELL('',*,{inner},.F.)"));
    let solid = step.add(format!("BREP_WITH_VOIDS('block',{outer},({void}))"));
    let file = step.whole(&[&solid]);
    assert_eq!(file.bodies.len(), 1);
    assert_eq!(file.bodies[0].name.as_deref(), Some("block"));
    assert!(file.bodies[0].solid && file.bodies[0].faces == 7);
    let set = set(&file, None);
    near(area(&set), 600. + 36. * PI, 1e-9);
    near(volume(&set), 1000. - 36. * PI, 1e-9);
}

/// A quarter of a cylinder as a rational surface, an instance of several types, with edges in space only.
#[test]
fn rational_surface_of_several_types() {
    let mut step = Step::default();
    let w = 0.5f64.sqrt();
    let rows = [[2., 0.], [2., 2.], [0., 2.]].map(|[x, y]| {
        let pair = [0., 3.].map(|z| step.point([x, y, z]));
        format!("({})", pair.join(","))
    });
    let weights = format!("(1.,1.),({w:?},{w:?}),(1.,1.)");
    let surface = step.add(format!(
        "(BOUNDED_SURFACE()B_SPLINE_SURFACE(2,1,({}),.UNSPECIFIED.,.F.,.F.,.F.)\
         B_SPLINE_SURFACE_WITH_KNOTS((3,3),(2,2),(0.,1.),(0.,1.),.UNSPECIFIED.)\
         GEOMETRIC_REPRESENTATION_ITEM()RATIONAL_B_SPLINE_SURFACE(({weights}))REPRESENTATION_ITEM('')SURFACE())",
        rows.join(",")
    ));
    let corners = [[2., 0., 0.], [0., 2., 0.], [0., 2., 3.], [2., 0., 3.]];
    let v = corners.map(|x| step.vertex(x));
    let mut arc = |z: f64, a: &str, b: &str| {
        let place = step.placement([0., 0., z], Z, X);
        let circle = step.placed("CIRCLE", &place, "2.");
        step.edge([a, b], &circle)
    };
    let (low, high) = (arc(0., &v[0], &v[1]), arc(3., &v[3], &v[2]));
    let up = step.line([&v[1], &v[2]], [corners[1], corners[2]]);
    let down = step.line([&v[3], &v[0]], [corners[3], corners[0]]);
    let bound = step.bound(&[&low, &up, &format!("-{high}"), &down]);
    let face = step.face(&[&bound], &surface, true);
    let sheet = step.sheet(&[&face]);
    let file = step.whole(&[&sheet]);
    near(area(&set(&file, None)), PI * 3., 1e-9);
    assert!(!file.bodies[0].solid);
}

/// An ellipse moved askew, cut by two planes: the area is the perimeter times the length, by the trapezoidal rule.
#[test]
fn extrusion_of_an_ellipse() {
    let mut step = Step::default();
    let place = step.placement(ORIGIN, Z, X);
    let ellipse = step.placed("ELLIPSE", &place, "3.,2.");
    let along = step.direction(Z);
    let along = step.add(format!("VECTOR('',{along},4.)"));
    let surface = step.add(format!("SURFACE_OF_LINEAR_EXTRUSION('',{ellipse},{along})"));
    let mut ring = |z: f64| {
        let vertex = step.vertex([3., 0., z]);
        let place = step.placement([0., 0., z], Z, X);
        let ellipse = step.placed("ELLIPSE", &place, "3.,2.");
        step.edge([&vertex, &vertex], &ellipse)
    };
    let (low, high) = (ring(1.), ring(6.));
    let bounds = [step.bound(&[&low]), step.bound(&[&format!("-{high}")])];
    let face = step.face(&[&bounds[0], &bounds[1]], &surface, true);
    let sheet = step.sheet(&[&face]);
    let file = step.whole(&[&sheet]);
    let n = 200;
    let speed = |k: i32| {
        let t = TAU * f64::from(k) / f64::from(n);
        (3. * t.sin()).hypot(2. * t.cos()) * TAU / f64::from(n)
    };
    near(
        area(&set(&file, None)),
        5. * (0..n).map(speed).sum::<f64>(),
        1e-9,
    );
}

/// A line turned about an axis that it does not meet, a quarter of a turn: a hyperboloid of one sheet.
#[test]
fn revolution_of_a_line() {
    let mut step = Step::default();
    let at = step.point([2., 0., 0.]);
    let along = step.direction([0., 1., 1.]);
    let along = step.add(format!("VECTOR('',{along},1.)"));
    let line = step.add(format!("LINE('',{at},{along})"));
    let foot = step.point(ORIGIN);
    let axis = step.direction(Z);
    let axis = step.add(format!("AXIS1_PLACEMENT('',{foot},{axis})"));
    let surface = step.add(format!("SURFACE_OF_REVOLUTION('',{line},{axis})"));
    let mut ring = |z: f64| {
        // The point of the line at the height z.
        let radius = (4. + z * z).sqrt();
        let vertex = step.vertex([2., z, z]);
        let place = step.placement([0., 0., z], Z, X);
        let circle = step.placed("CIRCLE", &place, &format!("{radius:?}"));
        step.edge([&vertex, &vertex], &circle)
    };
    let (low, high) = (ring(-1.), ring(2.));
    let bounds = [step.bound(&[&low]), step.bound(&[&format!("-{high}")])];
    let face = step.face(&[&bounds[0], &bounds[1]], &surface, true);
    let sheet = step.sheet(&[&face]);
    let file = step.whole(&[&sheet]);
    // r^2 = 4 + z^2: the integral of 2 pi r sqrt(1 + r'^2) = 2 pi sqrt(4 + 2 z^2).
    let whole = |z: f64| {
        let root = (4. + 2. * z * z).sqrt();
        0.5 * z * root + 2f64.sqrt() * (z / 2f64.sqrt()).asinh()
    };
    near(
        area(&set(&file, None)),
        TAU * (whole(2.) - whole(-1.)),
        1e-6,
    );
}

/// A line across its axis sweeps a plane twice. A disc on it, away from the axis, has its own area: the surface is not
/// integrated over where it folds.
#[test]
fn disc_on_a_surface_that_folds_elsewhere() {
    let mut step = Step::default();
    let points = [-2., 1., 4., 7.].map(|x| step.point([x, 0., 0.]));
    let line = step.add(format!(
        "B_SPLINE_CURVE_WITH_KNOTS('',3,({}),.UNSPECIFIED.,.F.,.F.,(4,4),(0.,1.),.UNSPECIFIED.)",
        points.join(",")
    ));
    let foot = step.point(ORIGIN);
    let axis = step.direction(Z);
    let axis = step.add(format!("AXIS1_PLACEMENT('',{foot},{axis})"));
    let surface = step.add(format!("SURFACE_OF_REVOLUTION('',{line},{axis})"));
    // Across the line between the first two quarters of the turn.
    let vertex = step.vertex([1., 5., 0.]);
    let place = step.placement([0., 5., 0.], Z, X);
    let circle = step.placed("CIRCLE", &place, "1.");
    let edge = step.edge([&vertex, &vertex], &circle);
    let bound = step.bound(&[&edge]);
    let face = step.face(&[&bound], &surface, true);
    let sheet = step.sheet(&[&face]);
    // The border is fitted to 1e-7 of the size of the surface.
    let file = step.whole(&[&sheet]);
    let whole = file.surface().unwrap();
    near(area(whole.set()), PI, 2e-6);
}

/// Offsets of a plane, a cylinder and a cone, each bounded by edges where the offset lies.
#[test]
fn offsets_of_analytic_surfaces() {
    let mut step = Step::default();
    let place = step.placement(ORIGIN, Z, X);
    let base = step.placed("CYLINDRICAL_SURFACE", &place, "2.");
    let surface = step.add(format!("OFFSET_SURFACE('',{base},0.5,.F.)"));
    let (low, high) = (circle(&mut step, 2.5, 1.).0, circle(&mut step, 2.5, 4.).0);
    let bounds = [step.bound(&[&low]), step.bound(&[&format!("-{high}")])];
    let wall = step.face(&[&bounds[0], &bounds[1]], &surface, true);
    let plane = step.placed("PLANE", &place, "");
    let plane = step.add(format!("OFFSET_SURFACE('',{plane},4.,.F.)"));
    let bound = step.bound(&[&high]);
    let lid = step.face(&[&bound], &plane, true);
    // A cone of radius 1 + z, moved out by 1: radius 1 + z + sqrt 2.
    let cone = step.placed("CONICAL_SURFACE", &place, &format!("1.,{:?}", PI / 4.));
    let cone = step.add(format!("OFFSET_SURFACE('',{cone},1.,.F.)"));
    let (r, s) = (1. + 2f64.sqrt(), 3. + 2f64.sqrt());
    let (low, high) = (circle(&mut step, r, 0.).0, circle(&mut step, s, 2.).0);
    let bounds = [step.bound(&[&low]), step.bound(&[&format!("-{high}")])];
    let funnel = step.face(&[&bounds[0], &bounds[1]], &cone, true);
    let sheet = step.sheet(&[&wall, &lid, &funnel]);
    let file = step.whole(&[&sheet]);
    let areas = set(&file, None).areas();
    near(areas[0], TAU * 2.5 * 3., 1e-9);
    near(areas[1], PI * 6.25, 1e-9);
    near(areas[2], PI * (r + s) * 8f64.sqrt(), 1e-9);
}

#[test]
fn rectangular_and_curve_bounded_surfaces() {
    let mut step = Step::default();
    let place = step.placement(ORIGIN, Z, X);
    let sphere = step.placed("SPHERICAL_SURFACE", &place, "2.");
    // An eighth of a sphere.
    let eighth = step.add(format!(
        "RECTANGULAR_TRIMMED_SURFACE('',{sphere},0.,{FRAC_PI_2:?},0.,{FRAC_PI_2:?},.T.,.T.)"
    ));
    // A plane bounded by a square of a polyline.
    let plane = step.placed("PLANE", &place, "");
    let corners = [[0., 0., 0.], [2., 0., 0.], [2., 3., 0.], [0., 3., 0.]].map(|x| step.point(x));
    let list = format!("{},{}", corners.join(","), corners[0]);
    let line = step.add(format!("POLYLINE('',({list}))"));
    let segment = step.add(format!("COMPOSITE_CURVE_SEGMENT(.CONTINUOUS.,.T.,{line})"));
    let border = step.add(format!("OUTER_BOUNDARY_CURVE('',({segment}),.F.)"));
    let square = step.add(format!("CURVE_BOUNDED_SURFACE('',{plane},({border}),.F.)"));
    let set_of = step.add(format!("GEOMETRIC_SET('',({eighth},{square}))"));
    let file = step.whole(&[&set_of]);
    let areas = set(&file, None).areas();
    near(areas[0], TAU, 1e-9);
    near(areas[1], 6., 1e-12);
}

/// A tetrahedron of poly loops under faces that name no surface.
#[test]
fn faceted_solid() {
    let mut step = Step::default();
    let x = [ORIGIN, [1., 0., 0.], [0., 2., 0.], [0., 0., 3.]].map(|x| step.point(x));
    let faces = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]].map(|ring| {
        let list = ring.map(|k| x[k].as_str()).join(",");
        let a_loop = step.add(format!("POLY_LOOP('',({list}))"));
        let bound = step.add(format!("FACE_OUTER_BOUND('',{a_loop},.T.)"));
        step.add(format!("FACE('',({bound}))"))
    });
    let shell = step.add(format!("CLOSED_SHELL('',({}))", faces.join(",")));
    let solid = step.add(format!("FACETED_BREP('',{shell})"));
    let set = set(&step.whole(&[&solid]), None);
    near(volume(&set), 1., 1e-12);
    let slope = 0.5 * (6f64.powi(2) + 3f64.powi(2) + 2f64.powi(2)).sqrt();
    near(area(&set), slope + 0.5 * (2. + 3. + 6.), 1e-12);
}

/// Half of a disc: an arc trimmed by parameters and a line, in a composite curve, and a parabola over its chord.
#[test]
fn trimmed_and_composite_curves() {
    let mut step = Step::default();
    let place = step.placement(ORIGIN, Z, X);
    let plane = step.placed("PLANE", &place, "");
    let circle = step.placed("CIRCLE", &place, "2.");
    let arc = step.add(format!(
        "TRIMMED_CURVE('',{circle},(PARAMETER_VALUE(0.)),(PARAMETER_VALUE({PI:?})),.T.,.PARAMETER.)"
    ));
    let ends = [[-2., 0., 0.], [2., 0., 0.]].map(|x| step.point(x));
    let along = step.direction(X);
    let along = step.add(format!("VECTOR('',{along},1.)"));
    let line = step.add(format!("LINE('',{},{along})", ends[0]));
    let chord = step.add(format!(
        "TRIMMED_CURVE('',{line},({}),({}),.T.,.CARTESIAN.)",
        ends[0], ends[1]
    ));
    // y = 1 - x^2 / 4 has its focus at the distance 1 from its top; it opens downwards.
    let top = step.placement([0., 1., 0.], Z, [0., -1., 0.]);
    let parabola = step.placed("PARABOLA", &top, "1.");
    let bow = step.add(format!(
        "TRIMMED_CURVE('',{parabola},({}),({}),.T.,.CARTESIAN.)",
        ends[0], ends[1]
    ));
    let mut bounded = |curves: [&str; 2]| {
        let segments = curves
            .map(|curve| step.add(format!("COMPOSITE_CURVE_SEGMENT(.CONTINUOUS.,.T.,{curve})")));
        let border = step.add(format!(
            "OUTER_BOUNDARY_CURVE('',({}),.F.)",
            segments.join(",")
        ));
        step.add(format!("CURVE_BOUNDED_SURFACE('',{plane},({border}),.F.)"))
    };
    let (half, moon) = (bounded([&arc, &chord]), bounded([&arc, &bow]));
    let set_of = step.add(format!("GEOMETRIC_SET('',({half},{moon}))"));
    let file = step.whole(&[&set_of]);
    let areas = set(&file, None).areas();
    near(areas[0], TAU, 1e-9);
    near(areas[1], TAU - 4. * 2. / 3., 1e-9);
}
