//! Forms of STEP geometry that few systems write: splines whose type implies their knots, conics without ends as edges, tori
//! that cross themselves, copies and offsets of surfaces, models of faces, flags against the run of curves.

use crate::step_builder::{Step, area, box_faces, near, set, volume};
use covact_geometry::NurbsPatch;
use covact_geometry::io::CadFile;
use std::f64::consts::{FRAC_PI_2, PI, TAU};

const Z: [f64; 3] = [0., 0., 1.];
const X: [f64; 3] = [1., 0., 0.];
const ORIGIN: [f64; 3] = [0.; 3];

/// Surfaces that stand alone.
fn alone(mut step: Step, surfaces: &[&str]) -> CadFile {
    let set_of = step.add(format!("GEOMETRIC_SET('',({}))", surfaces.join(",")));
    step.whole(&[&set_of])
}

/// A bump over a net of points, with the second direction fastest as the file has it.
fn net(step: &mut Step, [n, m]: [usize; 2]) -> String {
    let rows = (0..n).map(|i| {
        let row = (0..m).map(|j| {
            let (x, y) = (i as f64, 1.5 * j as f64);
            step.point([
                x + 0.1 * y.sin(),
                y,
                (0.7 * x).sin() * (0.4 * y + 0.3).cos(),
            ])
        });
        format!("({})", row.collect::<Vec<_>>().join(","))
    });
    rows.collect::<Vec<_>>().join(",")
}

/// The surface of a type that implies its knots, and the same with its knots written out.
fn both(kind: &str, degrees: [usize; 2], counts: [usize; 2], knots: [&str; 4]) -> [NurbsPatch; 2] {
    let [mu, mv, u, v] = knots;
    let written = format!(",{mu},{mv},{u},{v},.UNSPECIFIED.");
    [(kind, ""), ("B_SPLINE_SURFACE_WITH_KNOTS", &written)].map(|(kind, rest)| {
        let mut step = Step::default();
        let (net, [p, q]) = (net(&mut step, counts), degrees);
        let text = format!("{kind}('',{p},{q},({net}),.UNSPECIFIED.,.F.,.F.,.F.{rest})");
        let surface = step.add(text);
        alone(step, &[&surface]).patches[0].patch.clone()
    })
}

#[test]
fn knots_that_a_type_implies() {
    let cases = [
        (
            both(
                "QUASI_UNIFORM_SURFACE",
                [3, 2],
                [6, 4],
                ["(4,1,1,4)", "(3,1,3)", "(0.,1.,2.,3.)", "(0.,1.,2.)"],
            ),
            "quasi-uniform",
        ),
        (
            both(
                "BEZIER_SURFACE",
                [2, 3],
                [5, 4],
                ["(3,2,3)", "(4,4)", "(0.,1.,2.)", "(0.,1.)"],
            ),
            "Bezier",
        ),
        (
            both(
                "UNIFORM_SURFACE",
                [2, 2],
                [5, 4],
                [
                    "(1,1,1,1,1,1,1,1)",
                    "(1,1,1,1,1,1,1)",
                    "(-2.,-1.,0.,1.,2.,3.,4.,5.)",
                    "(-2.,-1.,0.,1.,2.,3.,4.)",
                ],
            ),
            "uniform",
        ),
    ];
    for ([implied, written], name) in cases {
        assert_eq!(implied, written, "{name}");
        let [[a, b], [c, d]] = implied.domain();
        let middle = implied.point([0.4 * a + 0.6 * b, 0.3 * c + 0.7 * d]);
        assert!(middle.z.abs() > 1e-3, "{name}: {middle}");
    }
}

/// Five collinear points of a uniform quadratic: its domain is three spans, over each of which it advances by one.
#[test]
fn uniform_splines_end_inside_of_their_net() {
    let mut step = Step::default();
    let rows = (0..5).map(|i| {
        let pair = [0., 3.].map(|y| step.point([f64::from(i), y, 0.]));
        format!("({})", pair.join(","))
    });
    let rows: Vec<String> = rows.collect();
    let surface = step.add(format!(
        "B_SPLINE_SURFACE_WITH_KNOTS('',2,1,({}),.UNSPECIFIED.,.F.,.F.,.F.,(1,1,1,1,1,1,1,1),(2,2),(-2.,-1.,0.,1.,2.,3.,4.,5.),(0.,1.),.UNSPECIFIED.)",
        rows.join(",")
    ));
    let file = alone(step, &[&surface]);
    near(area(&set(&file, None)), 9., 1e-12);
}

/// A face of a plane within two edges: a conic and its chord at `x`, from `-y` to `y`.
fn within(conic: &str, numbers: &str, [x, y]: [f64; 2], turned: bool) -> CadFile {
    let mut step = Step::default();
    let place = step.placement(ORIGIN, Z, X);
    let plane = step.placed("PLANE", &place, "");
    let curve = step.placed(conic, &place, numbers);
    let ends = [[x, -y, 0.], [x, y, 0.]];
    let v = ends.map(|end| step.vertex(end));
    let chord = step.line([&v[1], &v[0]], [ends[1], ends[0]]);
    let bound = if turned {
        // The edge runs against its curve, and the loop against its edges.
        let bow = step.add(format!("EDGE_CURVE('',{},{},{curve},.F.)", v[1], v[0]));
        let uses = [
            step.add(format!("ORIENTED_EDGE('',*,*,{bow},.F.)")),
            step.add(format!("ORIENTED_EDGE('',*,*,{chord},.T.)")),
        ];
        let a_loop = step.add(format!("EDGE_LOOP('',({}))", uses.join(",")));
        step.add(format!("FACE_BOUND('',{a_loop},.F.)"))
    } else {
        let bow = step.edge([&v[0], &v[1]], &curve);
        step.bound(&[&format!("-{bow}"), &format!("-{chord}")])
    };
    let face = step.face(&[&bound], &plane, true);
    let sheet = step.sheet(&[&face]);
    step.whole(&[&sheet])
}

/// The largest value of a function of x and y, which is zero on the conic, at points of the curved border; and the area.
fn off_and_area(file: &CadFile, conic: impl Fn(f64, f64) -> f64) -> [f64; 2] {
    let patch = &file.patches[0].patch;
    let trim = patch.trim().expect("a curved border");
    let curves = trim.loops().iter().flat_map(|l| &l.curves);
    let bow = curves
        .map(|c| &c.parameter)
        .find(|c| c.degree() > 1)
        .expect("a conic");
    let [a, b] = bow.domain();
    let off = (0..=40).map(|k| {
        let xi = bow.point(a + (b - a) * f64::from(k) / 40.);
        let x = patch.point([xi.x, xi.y]);
        conic(x.x, x.y).abs()
    });
    [off.fold(0.0, f64::max), area(&set(file, None))]
}

#[test]
fn parabolas_and_hyperbolas_as_edges() {
    for turned in [false, true] {
        // 4 x = y^2 up to x = 1.
        let file = within("PARABOLA", "1.", [1., 2.], turned);
        let [off, found] = off_and_area(&file, |x, y| 4. * x - y * y);
        assert!(off < 1e-12, "{off}");
        near(found, 8. / 3., 1e-9);
        // (x / 3)^2 - (y / 2)^2 = 1 up to x = 5, and so far that the curve runs through its middle in no time.
        for c in [5f64, 500.] {
            let (a, b) = (3f64, 2f64);
            let root = (c * c / (a * a) - 1.).sqrt();
            let expected = a * b * (c / a * root - (c / a).acosh());
            let file = within("HYPERBOLA", "3.,2.", [c, b * root], turned);
            let [off, found] = off_and_area(&file, |x, y| (x / a).powi(2) - (y / b).powi(2) - 1.);
            assert!(off < 1e-11 * c * c, "{off}");
            near(found, expected, 1e-9);
        }
    }
}

/// A circle of radius 3 about an axis at the distance 2: what it sweeps outside of the axis (an apple), and inside (a lemon).
#[test]
fn tori_that_cross_themselves() {
    let (major, minor) = (2f64, 3f64);
    let angle = (-major / minor).acos();
    let apple = TAU * minor * 2. * (major * angle + minor * angle.sin());
    let lemon = TAU * minor * 2. * (minor * angle.sin() - major * (PI - angle));
    for (outer, expected) in [(".T.", apple), (".F.", lemon)] {
        let mut step = Step::default();
        let place = step.placement(ORIGIN, Z, X);
        let torus = step.placed(
            "DEGENERATE_TOROIDAL_SURFACE",
            &place,
            &format!("2.,3.,{outer}"),
        );
        near(area(&set(&alone(step, &[&torus]), None)), expected, 1e-9);
    }
}

#[test]
fn copies_of_surfaces() {
    let mut step = Step::default();
    let place = step.placement(ORIGIN, Z, X);
    let sphere = step.placed("SPHERICAL_SURFACE", &place, "2.");
    let eighth = step.add(format!(
        "RECTANGULAR_TRIMMED_SURFACE('',{sphere},0.,{FRAC_PI_2:?},0.,{FRAC_PI_2:?},.T.,.T.)"
    ));
    let at = step.point([10., 0., 0.]);
    let map = step.add(format!(
        "CARTESIAN_TRANSFORMATION_OPERATOR_3D('','',$,$,{at},3.,$)"
    ));
    let copy = step.add(format!("SURFACE_REPLICA('',{eighth},{map})"));
    let file = alone(step, &[&copy]);
    let set = set(&file, None);
    near(area(&set), FRAC_PI_2 * 36., 1e-9);
    let [low, high] = file.patches[0].patch.bounds();
    let corners = [low.x, low.y, low.z, high.x, high.y, high.z];
    for (found, expected) in corners.into_iter().zip([10., 0., 0., 16., 6., 6.]) {
        assert!((found - expected).abs() < 1e-12, "{found} {expected}");
    }
}

/// z = x^2 / 4 from x = -2 to 2, swept along y by 3 and moved towards its centres of curvature by .5: each curve gets shorter by
/// the distance times the angle that it turns by, a right angle.
#[test]
fn offsets_of_splines() {
    let mut step = Step::default();
    let rows = [[-2., 1.], [0., -1.], [2., 1.]].map(|[x, z]| {
        let pair = [0., 3.].map(|y| step.point([x, y, z]));
        format!("({})", pair.join(","))
    });
    let base = step.add(format!(
        "BEZIER_SURFACE('',2,1,({}),.UNSPECIFIED.,.F.,.F.,.F.)",
        rows.join(",")
    ));
    let offset = step.add(format!("OFFSET_SURFACE('',{base},0.5,.F.)"));
    let file = alone(step, &[&base, &offset]);
    let areas = set(&file, None).areas();
    let length = 2. * (2f64.sqrt() + 1f64.asinh());
    near(areas[0], 3. * length, 1e-9);
    near(areas[1], 3. * (length - 0.5 * FRAC_PI_2), 1e-6);
    let told = file.notes.iter().filter(|n| n.contains("differs by up to"));
    assert_eq!(told.count(), 1, "{:?}", file.notes);
}

/// A cube as a model of faces, and as an open shell that is used the other way round.
#[test]
fn models_of_faces_and_shells_turned_round() {
    let mut step = Step::default();
    let faces = box_faces(&mut step, [[0.; 3], [2.; 3]], [None, None]);
    let own = step.add(format!("CONNECTED_FACE_SET('',({}))", faces.join(",")));
    let model = step.add(format!("FACE_BASED_SURFACE_MODEL('cube',({own}))"));
    let file = step.whole(&[&model]);
    assert_eq!(file.bodies[0].name.as_deref(), Some("cube"));
    let whole = set(&file, None);
    near(area(&whole), 24., 1e-12);
    near(volume(&whole), 8., 1e-12);

    let mut step = Step::default();
    let faces = box_faces(&mut step, [[0.; 3], [2.; 3]], [None, None]);
    let shell = step.add(format!("OPEN_SHELL('',({}))", faces.join(",")));
    let turned = step.add(format!("ORIENTED_OPEN_SHELL('',*,{shell},.F.)"));
    let model = step.add(format!("SHELL_BASED_SURFACE_MODEL('',({turned}))"));
    let file = step.whole(&[&model]);
    assert_eq!(file.patches.len(), 6);
    // Normals point into the cube.
    for p in &file.patches {
        let [[a, b], [c, d]] = p.patch.domain();
        let jet = p.patch.jet([0.5 * (a + b), 0.5 * (c + d)]);
        let away = jet.rho.map(|x| x - 1.);
        let normal = jet.rho_i[0].cross(&jet.rho_i[1]);
        assert!(normal.dot(&away) < -0.1, "{normal} at {}", jet.rho);
    }
}
