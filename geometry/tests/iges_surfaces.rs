//! Surface entities of IGES files against their own definitions (IGES 5.3, ANS US PRO/IPO-100-1996, section 4): the patch at
//! the mapped parameters is the point that the entity's formula gives at the file's parameters.

mod iges_builder;

use covact_geometry::io::{BasePatch, BaseSurface, IgesGeometry, Unbounded, read_iges_geometry};
use covact_geometry::{NurbsCurve, Vec3};
use iges_builder::{Builder, values};
use nalgebra::{Rotation3, Unit, Vector2};
use std::f64::consts::{FRAC_PI_2, PI, TAU};

fn read(file: &Builder) -> IgesGeometry {
    let text = file.text();
    read_iges_geometry(text.as_bytes(), "hand.igs").unwrap_or_else(|e| panic!("{e}\n{text}"))
}

fn patches(file: &Builder) -> Vec<BasePatch> {
    let found = read(file);
    assert!(found.skipped.is_empty(), "{:?}", found.skipped);
    match found.surfaces.last().map(|s| s.surface.clone()) {
        Some(BaseSurface::Patches(patches)) => patches,
        other => panic!("{other:?}"),
    }
}

fn patch(file: &Builder) -> BasePatch {
    let found = patches(file);
    assert_eq!(found.len(), 1);
    found[0].clone()
}

fn unbounded(file: &Builder) -> Unbounded {
    match read(file).surfaces.last().map(|s| s.surface.clone()) {
        Some(BaseSurface::Unbounded(surface)) => *surface,
        other => panic!("{other:?}"),
    }
}

/// Largest distance from `truth` at 41 x 41 parameters of the file.
fn worst(base: &BasePatch, truth: impl Fn(f64, f64) -> Vec3) -> f64 {
    let [[a, b], [c, d]] = base
        .parameters
        .directions
        .each_ref()
        .map(|m| m.file_range());
    let mut off = 0.0f64;
    for i in 0..=40 {
        for j in 0..=40 {
            let xi = [
                a + (b - a) * f64::from(i) / 40.0,
                c + (d - c) * f64::from(j) / 40.0,
            ];
            let own = base.parameters.to_patch(xi);
            let back = base.parameters.to_file(own);
            assert!((back[0] - xi[0]).abs() < 1e-12 * (b - a), "{xi:?} {back:?}");
            assert!((back[1] - xi[1]).abs() < 1e-12 * (d - c), "{xi:?} {back:?}");
            off = off.max((base.patch.point(own) - truth(xi[0], xi[1])).norm());
        }
    }
    off
}

/// Points turned about an axis that is none of the coordinates', by a negative start angle, a full turn, more than half.
#[test]
fn revolution_turns_the_generatrix_by_the_angle() {
    let (foot, tip) = (Vec3::new(1.0, 0.0, 0.5), Vec3::new(2.0, 2.0, 2.5));
    let axis = Unit::new_normalize(tip - foot);
    for [from, to] in [[-0.7, 2.0], [0.0, TAU], [FRAC_PI_2, 6.0], [TAU, 2.0 * TAU]] {
        let mut file = Builder::new();
        let line = file.add(110, &values(&[foot.x, foot.y, foot.z, tip.x, tip.y, tip.z]));
        let arc = file.add(100, "0.25,5.,1.,6.,1.,5.,2.");
        file.add(120, &format!("{line},{arc},{}", values(&[from, to])));
        let base = patch(&file);
        assert_eq!(base.parameters.directions[1].file_range(), [from, to]);
        assert_eq!(base.patch.domain()[1], [from, to]);
        let off = worst(&base, |u, v| {
            let c = Vec3::new(5.0 + u.cos(), 1.0 + u.sin(), 0.25);
            foot + Rotation3::from_axis_angle(&axis, v) * (c - foot)
        });
        assert!(off < 1e-14 * 4.0, "{off:.1e}");
        assert_eq!(base.deviation, 0.0);
    }
}

/// A half circle on the axis is a sphere with two poles that are points, also where the file has nine digits; matrices.
#[test]
fn revolution_with_poles() {
    let mut file = Builder::new();
    let turn = file.add(124, "0.,-1.,0.,10.,1.,0.,0.,0.,0.,0.,1.,5.");
    let upright = file.add(124, "1.,0.,0.,0.,0.,0.,-1.,0.,0.,1.,0.,0.");
    let line = file.add(110, "0.,0.,1.,0.,0.,0.");
    let arc = file.placed(100, upright, "0.,0.,0.,0.0000000003,-2.,0.,2.");
    file.placed(120, turn, &format!("{line},{arc},0.,6.283185307"));
    let base = patch(&file);
    assert_eq!(
        base.patch.degenerate_edges(1e-15),
        [true, true, false, false]
    );
    assert!(
        base.deviation > 1e-10 && base.deviation < 1e-9,
        "{}",
        base.deviation
    );
    let [[a, b], [c, d]] = base.patch.domain();
    assert_eq!(d, TAU);
    for k in 0..=20 {
        let xi = [a + (b - a) * f64::from(k) / 20.0, c + (d - c) * 0.37];
        let radius = (base.patch.point(xi) - Vec3::new(10.0, 0.0, 5.0)).norm();
        assert!((radius - 2.0).abs() < 1e-9, "{radius}");
    }
    // Writers give such a generatrix the angle from -pi / 2 on, the standard from 3 pi / 2 on.
    let turns = base.parameters.turns([[-FRAC_PI_2, FRAC_PI_2], [0.0, TAU]]);
    assert!(
        (turns[0] - TAU).abs() < 1e-15 && turns[1] == 0.0,
        "{turns:?}"
    );
}

/// Curves of the file's parameters: exact along one of them, fitted across.
#[test]
fn parameter_curves_are_mapped() {
    let mut file = Builder::new();
    let line = file.add(110, "0.,0.,0.,0.,0.,1.");
    let arc = file.add(110, "2.,0.,0.,1.,0.,3.");
    file.add(120, &format!("{line},{arc},0.,{TAU:?}"));
    let base = patch(&file);
    let map = &base.parameters;
    let along = NurbsCurve::line(Vector2::new(0.2, 0.5), Vector2::new(0.2, 6.0)).unwrap();
    let (image, off) = map.curve(&along, [0.0; 2], 1e-9).unwrap();
    assert_eq!((image.degree(), off), (1, 0.0));
    for (end, t) in image.ends().iter().zip([0.5, 6.0]) {
        assert!((end.y - map.to_patch([0.2, t])[1]).abs() < 1e-15);
    }
    let across = NurbsCurve::line(Vector2::new(0.1, 0.2), Vector2::new(0.9, 5.0)).unwrap();
    for tolerance in [1e-6, 1e-9, 1e-11] {
        let (image, off) = map.curve(&across, [0.0; 2], tolerance).unwrap();
        assert!(off > 0.0 && off <= tolerance);
        for k in 0..=200 {
            let t = f64::from(k) / 200.0;
            let truth = Vector2::from(map.to_patch(across.point(t).into()));
            let d = (image.point(t) - truth)
                .component_div(&Vector2::new(1.0, TAU))
                .norm();
            assert!(d <= 1.1 * tolerance, "{d:.1e} {tolerance:.0e}");
        }
    }
}

#[test]
fn tabulated_cylinders_normalise_the_directrix() {
    // A composite directrix: a line of range 1 and an arc of range pi / 2.
    let mut file = Builder::new();
    let line = file.add(110, "0.,0.,0.,2.,0.,0.");
    let arc = file.add(100, "0.,2.,1.,2.,0.,3.,1.");
    let whole = file.add(102, &format!("2,{line},{arc}"));
    file.add(122, &format!("{whole},1.,0.5,4."));
    let base = patch(&file);
    let end = 1.0 + FRAC_PI_2;
    let directrix = |u: f64| {
        let t = u * end;
        if t < 1.0 {
            Vec3::new(2.0 * t, 0.0, 0.0)
        } else {
            let angle = t - 1.0 + 1.5 * PI;
            Vec3::new(2.0 + angle.cos(), 1.0 + angle.sin(), 0.0)
        }
    };
    let off = worst(&base, |u, v| directrix(u) + Vec3::new(1.0, 0.5, 4.0) * v);
    assert!(off < 1e-14, "{off:.1e}");
    assert_eq!(base.parameters.directions[0].file_range(), [0.0, 1.0]);
}

#[test]
fn ruled_by_parameter() {
    // Two arcs of different angles, the second backwards: exact, both angles are shared out evenly.
    for direction in [0, 1] {
        let mut file = Builder::new();
        let a = file.add(100, &values(&[0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 1.0]));
        let b = file.add(100, &values(&[3.0, 0.0, 0.0, 2.0, 0.0, 0.0, 2.0]));
        file.form(118, 1, &format!("{a},{b},{direction},0"));
        let base = patch(&file);
        let off = worst(&base, |u, v| {
            let s = if direction == 0 { u } else { 1.0 - u };
            let (t, s) = (u * FRAC_PI_2, s * FRAC_PI_2);
            let first = Vec3::new(t.cos(), t.sin(), 0.0);
            let second = Vec3::new(2.0 * s.cos(), 2.0 * s.sin(), 3.0);
            first * (1.0 - v) + second * v
        });
        assert!(off < 1e-14, "{off:.1e}");
        assert_eq!((base.deviation, base.patch.degree()[0]), (0.0, 2));
    }
    // An arc and a line: the arc is fitted by its angle.
    let mut file = Builder::new();
    let a = file.add(100, &values(&[0.0, 0.0, 0.0, 1.0, 0.0, -1.0, 0.0]));
    let b = file.add(110, "1.,0.,3.,-1.,0.5,3.");
    file.form(118, 1, &format!("{a},{b},0,0"));
    let base = patch(&file);
    let off = worst(&base, |u, v| {
        let t = u * PI;
        let second = Vec3::new(1.0 - 2.0 * u, 0.5 * u, 3.0);
        Vec3::new(t.cos(), t.sin(), 0.0) * (1.0 - v) + second * v
    });
    assert!(
        base.deviation > 0.0 && base.deviation < 5e-9,
        "{:.1e}",
        base.deviation
    );
    assert!(
        off < 1.1 * base.deviation,
        "{off:.1e} {:.1e}",
        base.deviation
    );
    // Splines of different degree and knots; a point makes a cone.
    let mut file = Builder::new();
    let a = file.add(126, "3,2,0,0,1,0,0.,0.,0.,.4,1.,1.,1.,1.,1.,1.,1.,0.,0.,0.,1.,1.,0.,2.,0.,0.,3.,1.,1.,0.,1.,0.,0.,1.");
    let b = file.add(
        126,
        "2,1,0,0,1,0,0.,0.,.7,1.,1.,1.,1.,1.,0.,0.,4.,2.,2.,4.,3.,0.,4.,0.,1.,0.,0.,1.",
    );
    file.form(118, 1, &format!("{a},{b},0,0"));
    let base = patch(&file);
    let rails = read(&file).curves;
    let off = worst(&base, |u, v| {
        rails[0].curve.point(u) * (1.0 - v) + rails[1].curve.point(u) * v
    });
    assert!(off < 1e-14, "{off:.1e}");
    assert_eq!((base.patch.degree(), base.deviation), ([2, 1], 0.0));
    let mut file = Builder::new();
    let a = file.add(100, "0.,0.,0.,1.,0.,1.,0.");
    let b = file.add(116, "0.,0.,2.,0");
    file.form(118, 0, &format!("{a},{b},0,0"));
    let off = worst(&patch(&file), |u, v| {
        Vec3::new((u * TAU).cos(), (u * TAU).sin(), 0.0) * (1.0 - v) + Vec3::z() * (2.0 * v)
    });
    assert!(off < 1e-14, "{off:.1e}");
}

/// Form 0: equal shares of the length, for a parabola known in closed form: s(t) = (t sqrt(1 + t^2) + asinh t) / 2.
#[test]
fn ruled_by_length() {
    let mut file = Builder::new();
    let a = file.add(104, "1.,0.,0.,0.,-2.,0.,0.,0.,0.,2.,2.");
    let b = file.add(110, "0.,0.,3.,2.,0.,3.");
    file.add(118, &format!("{a},{b},0,0"));
    let base = patch(&file);
    let length = |t: f64| 0.5 * (t * t.hypot(1.0) + t.asinh());
    let total = length(2.0);
    let off = worst(&base, |u, v| {
        let mut t = 2.0 * u;
        for _ in 0..30 {
            t -= (length(t) - u * total) / t.hypot(1.0);
        }
        Vec3::new(t, 0.5 * t * t, 0.0) * (1.0 - v) + Vec3::new(2.0 * u, 0.0, 3.0) * v
    });
    assert!(base.deviation > 0.0 && base.deviation < 5e-9);
    assert!(
        off < 1.1 * base.deviation + 1e-13,
        "{off:.1e} {:.1e}",
        base.deviation
    );
}

type Coefficients = [[[f64; 4]; 4]; 3];

fn surface_114(breaks: [&[f64]; 2], piece: impl Fn(usize, usize) -> Coefficients) -> String {
    let [m, n] = breaks.map(|b| b.len() - 1);
    let mut numbers = breaks.concat();
    for i in 0..=m {
        for j in 0..=n {
            if i < m && j < n {
                numbers.extend(piece(i, j).iter().flatten().flatten());
            } else {
                numbers.extend([99.0; 48]);
            }
        }
    }
    format!("3,1,{m},{n},{}", values(&numbers))
}

/// A polynomial of u and v, expanded about the corner of each piece.
#[test]
fn parametric_spline_surfaces() {
    let breaks: [&[f64]; 2] = [&[0.0, 1.0, 1.5], &[2.0, 3.0, 3.5, 5.0]];
    // One bicubic everywhere: no knot is needed twice.
    let powers = |start: f64| {
        // x^k = sum_a C(k, a) start^(k - a) s^a, as the coefficient of s^a for each k.
        let mut table = [[0.0; 4]; 4];
        let choose = [
            [1.0, 0.0, 0.0, 0.0],
            [1.0, 1.0, 0.0, 0.0],
            [1.0, 2.0, 1.0, 0.0],
            [1.0, 3.0, 3.0, 1.0],
        ];
        for k in 0..4 {
            for a in 0..=k {
                table[k][a] = choose[k][a] * start.powi((k - a) as i32);
            }
        }
        table
    };
    let global = |c: usize, k: usize, l: usize| {
        // Something without symmetry.
        ((3 * c + 5 * k + 7 * l) % 11) as f64 / 10.0 - 0.5
            + if c == 0 && k == 1 { 2.0 } else { 0.0 }
    };
    let expand = |i: usize, j: usize| {
        let (u, v) = (powers(breaks[0][i]), powers(breaks[1][j]));
        let mut c = [[[0.0; 4]; 4]; 3];
        for (x, c) in c.iter_mut().enumerate() {
            for (k, u) in u.iter().enumerate() {
                for (l, v) in v.iter().enumerate() {
                    for (m, slot) in c.iter_mut().flatten().enumerate() {
                        *slot += global(x, k, l) * u[m % 4] * v[m / 4];
                    }
                }
            }
        }
        c
    };
    let truth = |u: f64, v: f64| {
        Vec3::from_fn(|x, _| {
            (0..16)
                .map(|m| global(x, m % 4, m / 4) * u.powi((m % 4) as i32) * v.powi((m / 4) as i32))
                .sum()
        })
    };
    let mut file = Builder::new();
    file.add(114, &surface_114(breaks, expand));
    let base = patch(&file);
    assert_eq!(base.patch.degree(), [3, 3]);
    assert_eq!(base.patch.counts(), [5, 6]);
    assert!(base.parameters.is_identity());
    // Coordinates reach 1e3.
    let off = worst(&base, truth);
    assert!(off < 1e-11, "{off:.1e}");
    // A kink along u = 1: that knot three times, the surface exact on both sides.
    let kinked = |i: usize, j: usize| {
        let mut c = expand(i, j);
        if i == 1 {
            c[2][0][1] += 3.0;
        }
        c
    };
    let mut file = Builder::new();
    file.add(114, &surface_114(breaks, kinked));
    let base = patch(&file);
    assert_eq!(base.patch.counts(), [7, 6]);
    assert_eq!(base.patch.crease_knots(0), vec![1.0]);
    let off = worst(&base, |u, v| {
        truth(u, v) + Vec3::z() * (3.0 * (u - 1.0).max(0.0))
    });
    assert!(off < 1e-11, "{off:.1e}");
    // A step along v = 3: two patches and a note.
    let stepped = |i: usize, j: usize| {
        let mut c = expand(i, j);
        if j > 0 {
            c[2][0][0] += 100.0;
        }
        c
    };
    let mut file = Builder::new();
    file.add(114, &surface_114(breaks, stepped));
    let parts = patches(&file);
    assert_eq!(parts.len(), 2);
    assert!(read(&file).notes[0].contains("several patches"));
    for (part, lift) in parts.iter().zip([0.0, 100.0]) {
        assert!(worst(part, |u, v| truth(u, v) + Vec3::z() * lift) < 1e-11);
    }
}

/// A 128 whose knots inside are repeated more often than the degree is as many patches as it has pieces.
#[test]
fn spline_surfaces_in_pieces() {
    let mut file = Builder::new();
    file.add(128, "3,1,1,1,0,0,1,0,0,0.,0.,1.,1.,2.,2.,0.,0.,1.,1.,1.,1.,1.,1.,1.,1.,1.,1.,\
                   0.,0.,0.,1.,0.,0.,5.,0.,0.,6.,0.,1.,0.,1.,0.,1.,1.,0.,5.,1.,0.,6.,1.,1.,0.,2.,0.,1.");
    let found = read(&file);
    assert!(
        found.notes[0].contains("read as 2 patches"),
        "{:?}",
        found.notes
    );
    let parts = patches(&file);
    assert_eq!(parts.len(), 2);
    assert_eq!(parts[0].patch.domain()[0], [0.0, 1.0]);
    assert_eq!(parts[1].patch.domain()[0], [1.0, 2.0]);
    assert!((parts[1].patch.point([1.5, 0.5]) - Vec3::new(5.5, 0.5, 0.5)).norm() < 1e-15);
}

/// Location, axis and reference direction, none along a coordinate.
fn frame(file: &mut Builder) -> (String, [Vec3; 4]) {
    let (origin, axis, reference) = (
        Vec3::new(1.0, 2.0, 3.0),
        Vec3::new(1.0, 1.0, 2.0),
        Vec3::new(1.0, 0.0, 0.0),
    );
    let point = file.add(116, "1.,2.,3.,0");
    let along = file.add(123, "1.,1.,2.");
    let across = file.add(123, "1.,0.,0.");
    let e3 = axis.normalize();
    let e1 = (reference - e3 * e3.dot(&reference)).normalize();
    (
        format!("{point},{along},{across}"),
        [origin, e1, e3.cross(&e1), e3],
    )
}

#[test]
fn analytic_surfaces() {
    let circle = |[o, e1, e2, e3]: [Vec3; 4], r: f64, u: f64, z: f64| {
        let u = u.to_radians();
        o + (e1 * u.cos() + e2 * u.sin()) * r + e3 * z
    };
    // Cylinder and cone: sized by points, angle in degrees and height as parameters.
    for (kind, slope) in [(192, 0.0), (194, 0.4)] {
        let mut file = Builder::new();
        let (pointers, f) = frame(&mut file);
        let p: Vec<&str> = pointers.split(',').collect();
        let angle = f64::atan(slope).to_degrees();
        let text = if kind == 192 {
            format!("{},{},2.,{}", p[0], p[1], p[2])
        } else {
            format!("{},{},2.,{angle:?},{}", p[0], p[1], p[2])
        };
        file.form(kind, 1, &text);
        let surface = unbounded(&file);
        let ends = [circle(f, 2.0, 10.0, -1.0), circle(f, 2.0, 200.0, 4.0)];
        let base = surface.sized(&ends).unwrap();
        let range = base.parameters.directions[1].file_range();
        assert!(range[0] < -1.0 && range[0] > -1.1 && range[1] > 4.0 && range[1] < 4.1);
        let off = worst(&base, |u, v| circle(f, 2.0 + slope * v, u, v));
        assert!(off < 1e-14 * 2.0, "{kind}: {off:.1e}");
        // In radians the same surface.
        let radians = base.parameters.in_radians([true, false]);
        let at = base.patch.point(radians.to_patch([1.0, 0.5]));
        let truth = circle(f, 2.0 + slope * 0.5, 1.0f64.to_degrees(), 0.5);
        assert!((at - truth).norm() < 1e-14);
        assert!(surface.sized(&[]).is_err());
        if kind == 194 {
            // Points beyond the tip: the patch ends there, in a pole.
            let cut = surface
                .sized(&[circle(f, 0.0, 0.0, -50.0), ends[1]])
                .unwrap();
            assert_eq!(
                cut.patch.degenerate_edges(1e-12),
                [false, false, true, false]
            );
        }
    }
    // Plane: lengths along the reference direction and across.
    let mut file = Builder::new();
    let (pointers, [o, e1, e2, _]) = frame(&mut file);
    file.form(190, 1, &pointers);
    let base = unbounded(&file).sized(&[o, o + e1 * 3.0 - e2]).unwrap();
    assert!(worst(&base, |u, v| o + e1 * u + e2 * v) < 1e-14);
    // Sphere and torus are whole.
    let mut file = Builder::new();
    let (pointers, f) = frame(&mut file);
    let p: Vec<&str> = pointers.split(',').collect();
    file.form(196, 1, &format!("{},5.,{},{}", p[0], p[1], p[2]));
    let off = worst(&patch(&file), |u, v| {
        let v = v.to_radians();
        circle(f, 5.0 * v.cos(), u, 5.0 * v.sin())
    });
    assert!(off < 1e-14 * 2.0, "{off:.1e}");
    file.form(198, 1, &format!("{},{},5.,1.5,{}", p[0], p[1], p[2]));
    let off = worst(&patch(&file), |u, v| {
        let u = u.to_radians();
        circle(f, 5.0 + 1.5 * u.cos(), 360.0 - v, 1.5 * u.sin())
    });
    assert!(off < 1e-14 * 2.0, "{off:.1e}");
}

#[test]
fn planes_by_their_equation() {
    let mut file = Builder::new();
    let border = file.add(100, "0.,0.,0.,1.,0.,1.,0.");
    file.form(108, 1, &format!("0.,0.,2.,6.,{border},0.,0.,3.,1."));
    let plane = unbounded(&file);
    assert_eq!(plane.border.map(|b| b.0), Some(border));
    let corner = [Vec3::new(-1.0, 2.0, 3.0), Vec3::new(4.0, -2.0, 3.0)];
    let base = plane.sized(&corner).unwrap();
    let [low, high] = base.patch.bounds();
    assert!(low.x < -1.0 && low.y < -2.0 && high.x > 4.0 && high.y > 2.0);
    assert!((low.z - 3.0).abs() < 1e-15 && (high.z - 3.0).abs() < 1e-15);
    let mut file = Builder::new();
    file.add(108, "0.,0.,0.,6.,0");
    assert!(read(&file).skipped[0].reason.contains("no normal"));
}

/// Every curve and surface entity of the sample files becomes one.
#[test]
fn all_entities_of_the_samples() {
    let assets = std::path::Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../assets/cad"));
    let mut folders = vec![assets.to_path_buf()];
    match std::env::var_os("COVACT_CAD_SAMPLES") {
        Some(folder) => {
            let folder = std::path::PathBuf::from(folder);
            folders.push(folder.join("../made_here"));
            folders.push(folder);
        }
        None => println!("only assets: COVACT_CAD_SAMPLES does not name a directory of CAD files"),
    }
    let known = |t: u32| {
        matches!(
            t,
            100 | 102
                | 104
                | 106
                | 110
                | 112
                | 126
                | 130
                | 108
                | 114
                | 118
                | 120
                | 122
                | 128
                | 140
                | 190
                | 192
                | 194
                | 196
                | 198
        )
    };
    let mut read = 0;
    for folder in folders {
        let Ok(entries) = std::fs::read_dir(&folder) else {
            continue;
        };
        for path in entries.flatten().map(|e| e.path()) {
            if !path.extension().is_some_and(|e| e == "igs" || e == "iges") {
                continue;
            }
            let bytes = std::fs::read(&path).unwrap();
            let name = path.display().to_string();
            let found = read_iges_geometry(&bytes, &name).unwrap();
            let file = covact_geometry::io::read_iges(&bytes, &name).unwrap();
            let count: usize = file
                .entities
                .iter()
                .filter(|e| known(e.type_number))
                .map(|e| e.count)
                .sum();
            assert!(found.skipped.is_empty(), "{name}: {:?}", found.skipped);
            assert_eq!(found.curves.len() + found.surfaces.len(), count, "{name}");
            read += count;
            println!(
                "{name}: {} curves, {} surfaces, notes {:?}",
                found.curves.len(),
                found.surfaces.len(),
                found.notes
            );
        }
    }
    assert!(read > 50, "{read}");
}
