//! Spline surfaces, quadrics and planes of IGES files against their own definitions (IGES 5.3, ANS US PRO/IPO-100-1996, section 4): the patch
//! at the mapped parameters is the point that the entity's formula gives at the file's parameters.

use crate::builder::{Builder, values};
use crate::read::{patch, patches, read, unbounded, worst_on_patch};
use covact_geometry::Vec3;
use covact_geometry::io::read_iges_geometry;

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
    let off = worst_on_patch(&base, truth);
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
    let off = worst_on_patch(&base, |u, v| {
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
        assert!(worst_on_patch(part, |u, v| truth(u, v) + Vec3::z() * lift) < 1e-11);
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
        let off = worst_on_patch(&base, |u, v| circle(f, 2.0 + slope * v, u, v));
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
    assert!(worst_on_patch(&base, |u, v| o + e1 * u + e2 * v) < 1e-14);
    // Sphere and torus are whole.
    let mut file = Builder::new();
    let (pointers, f) = frame(&mut file);
    let p: Vec<&str> = pointers.split(',').collect();
    file.form(196, 1, &format!("{},5.,{},{}", p[0], p[1], p[2]));
    let off = worst_on_patch(&patch(&file), |u, v| {
        let v = v.to_radians();
        circle(f, 5.0 * v.cos(), u, 5.0 * v.sin())
    });
    assert!(off < 1e-14 * 2.0, "{off:.1e}");
    file.form(198, 1, &format!("{},{},5.,1.5,{}", p[0], p[1], p[2]));
    let off = worst_on_patch(&patch(&file), |u, v| {
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
