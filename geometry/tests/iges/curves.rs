//! Lines, composite and offset curves, matrices and numbers of IGES files against their own definitions (IGES 5.3, ANS US PRO/IPO-100-1996, section 4): each point of
//! the NURBS form at the mapped parameter is the point that the entity's formula gives.

use crate::builder::{Builder, Entity};
use crate::read::{one, polynomial, read, reason, spline_112, worst_on_curve};
use covact_geometry::Vec3;
use covact_geometry::io::read_iges_geometry;
use std::f64::consts::{FRAC_PI_2, PI};

#[test]
fn lines_and_polylines() {
    let line = one(110, 0, "1.,2.,3.,4.,6.,3.");
    assert!(worst_on_curve(&line, |t| Vec3::new(1.0 + 3.0 * t, 2.0 + 4.0 * t, 3.0)) < 1e-15 * 8.0);
    assert!(reason(110, 1, "0.,0.,0.,1.,0.,0.").contains("half line"));
    assert!(reason(110, 2, "0.,0.,0.,1.,0.,0.").contains("without ends"));
    let flat = one(106, 11, "1,3,7.,0.,0.,2.,0.,2.,5.");
    let corner = [[0.0, 0.0], [2.0, 0.0], [2.0, 5.0]];
    let along = |t: f64| {
        let k = (t.floor() as usize).min(1);
        let s = t - k as f64;
        let [p, q] = [corner[k], corner[k + 1]];
        Vec3::new(p[0] + (q[0] - p[0]) * s, p[1] + (q[1] - p[1]) * s, 7.0)
    };
    assert!(worst_on_curve(&flat, along) < 1e-15);
    for (form, text) in [
        (12, "2,3,0.,0.,1.,2.,0.,1.,2.,5.,1."),
        (2, "2,3,0.,0.,1.,2.,0.,1.,2.,5.,1."),
        (
            13,
            "3,3,0.,0.,1.,9.,9.,9.,2.,0.,1.,9.,9.,9.,2.,5.,1.,9.,9.,9.",
        ),
    ] {
        let curve = one(106, form, text);
        assert!(
            worst_on_curve(&curve, |t| along(t) - Vec3::z() * 6.0) < 1e-15,
            "{form}"
        );
    }
    let closed = one(106, 63, "1,4,0.,0.,0.,1.,0.,1.,1.,0.,0.");
    let [start, end] = closed.curve.ends();
    assert_eq!(start, end);
    assert!(reason(106, 20, "1,2,0.,0.,0.,1.,1.").contains("no curve"));
    assert!(reason(106, 11, "1,2,0.,1.,1.,1.,1.").contains("two different points"));
}

/// A line, an arc, a cubic: the parameter starts at 0 and counts on by each member's own range (IGES 5.3, entity 102).
#[test]
fn composites() {
    let mut file = Builder::new();
    let line = file.add(110, "0.,0.,0.,2.,0.,0.");
    let arc = file.add(100, "0.,2.,1.,2.,0.,3.,1.");
    let piece = [
        [3.0, 1.0, 0.5, 0.2],
        [1.0, 2.0, 0.0, -0.1],
        [0.0, 0.0, 1.0, 0.0],
    ];
    let spline = file.add(112, &spline_112(3, &[5.0, 7.0], &[piece]));
    let whole = file.add(102, &format!("3,{line},{arc},{spline}"));
    // Once more inside another composite.
    let outer = file.add(102, &format!("1,{whole}"));
    let found = read(&file);
    assert!(found.notes.is_empty() && found.skipped.is_empty());
    for number in [whole, outer] {
        let curve = found.curves.iter().find(|c| c.entity == number).unwrap();
        assert_eq!(curve.parts.len(), 3);
        assert!(curve.gap < 1e-15);
        let end = 1.0 + FRAC_PI_2 + 2.0;
        assert!((curve.parameters.file_range()[1] - end).abs() < 1e-14);
        let off = worst_on_curve(curve, |t| {
            if t < 1.0 {
                Vec3::new(2.0 * t, 0.0, 0.0)
            } else if t < 1.0 + FRAC_PI_2 {
                let angle = t - 1.0 + 1.5 * PI;
                Vec3::new(2.0 + angle.cos(), 1.0 + angle.sin(), 0.0)
            } else {
                polynomial(&[5.0, 7.0], &[piece], t - 1.0 - FRAC_PI_2 + 5.0)
            }
        });
        assert!(off < 1e-14 * 4.0, "{off:.1e}");
    }
    // Members that do not meet: the gap is told, the joined curve is closed over it.
    let mut file = Builder::new();
    let a = file.add(110, "0.,0.,0.,1.,0.,0.");
    let b = file.add(110, "1.,0.001,0.,1.,1.,0.");
    file.add(102, &format!("2,{a},{b}"));
    let found = read(&file);
    assert!((found.curves[2].gap - 1e-3).abs() < 1e-15);
    assert_eq!(found.curves[2].curve.point(1.0), Vec3::new(1.0, 0.0, 0.0));
    // A composite of itself, and one that multiplies its members.
    let mut file = Builder::new();
    file.add(102, "1,1");
    assert!(read(&file).skipped[0].reason.contains("over and over"));
    let mut file = Builder::new();
    let mut inner = file.add(110, "0.,0.,0.,1.,0.,0.");
    for _ in 0..40 {
        inner = file.add(102, &format!("4,{inner},{inner},{inner},{inner}"));
    }
    assert!(!read(&file).skipped.is_empty());
}

/// Matrices of members and of the composite, right- and left-handed (forms 0 and 1), in chains, and the model space scale.
#[test]
fn matrices_and_scale() {
    let mut file = Builder::new();
    file.global = file.global.replace(",,1.,2,2HMM", ",,2.,2,2HMM");
    let shift = file.add(124, "1.,0.,0.,0.,0.,1.,0.,0.,0.,0.,1.,5.");
    let turn = file.placed(124, shift, "0.,-1.,0.,10.,1.,0.,0.,0.,0.,0.,1.,0.");
    let mirror = file.form(124, 1, "1.,0.,0.,0.,0.,1.,0.,0.,0.,0.,-1.,0.");
    let arc = file.placed(100, turn, "1.,0.,0.,2.,0.,0.,2.");
    let whole = file.entity(Entity {
        matrix: mirror,
        ..Entity::new(102, &format!("1,{arc}"))
    });
    let found = read(&file);
    // (x, y, z) -> (10 - y, x, z + 5), halved; then z -> -z.
    for (number, sign) in [(arc, 1.0), (whole, -1.0)] {
        let curve = found.curves.iter().find(|c| c.entity == number).unwrap();
        let [from, _] = curve.parameters.file_range();
        let off = worst_on_curve(curve, |t| {
            let t = t - from;
            Vec3::new(10.0 - 2.0 * t.sin(), 2.0 * t.cos(), sign * 6.0) / 2.0
        });
        assert!(off < 1e-15 * 8.0, "{off:.1e}");
    }
    // In a parameter plane no scale counts.
    let mut file = Builder::new();
    file.global = file.global.replace(",,1.,2,2HMM", ",,2.,2,2HMM");
    file.entity(Entity {
        status: "00010500".to_owned(),
        ..Entity::new(110, "1.,2.,0.,3.,4.,0.")
    });
    assert_eq!(
        read(&file).curves[0].curve.ends()[1],
        Vec3::new(3.0, 4.0, 0.0)
    );
}

/// Other delimiters, D exponents, values left out, and a string where a number should be.
#[test]
fn free_format() {
    let mut file = Builder::new();
    file.delimiters = ['/', '#'];
    file.global = file
        .global
        .replace("1H,,1H;,", "1H/,1H#,")
        .replace(',', "/")
        .replace(';', "#");
    file.add(110, ",,1.D0,2.5D+1,+3.-1,");
    let curve = &read(&file).curves[0];
    assert_eq!(
        curve.curve.ends(),
        [Vec3::new(0.0, 0.0, 1.0), Vec3::new(25.0, 0.3, 0.0)]
    );
    let mut file = Builder::new();
    file.add(110, "0.,0.,0.,1.,3Habc,0.");
    let error = read_iges_geometry(file.text().as_bytes(), "f").unwrap_err();
    assert!(
        error.to_string().contains("a coordinate of an end point"),
        "{error}"
    );
    let mut file = Builder::new();
    file.add(126, "99999999,3,0,0,0,0,0.,1.");
    assert!(read_iges_geometry(file.text().as_bytes(), "f").is_err());
}

/// The offset of an ellipse, which is no rational curve of low degree: distance and direction at every parameter. The
/// tolerance is 1e-9 of the base's size, whose control points are less than 8 apart.
#[test]
fn offset_curves() {
    let mut file = Builder::new();
    let base = file.add(104, "4.,0.,9.,0.,0.,-36.,0.,3.,0.,-3.,0.");
    file.add(
        130,
        &format!("{base},1,0,1,0,0.5,0.,0.,0.,0.,0.,1.,0.25,3."),
    );
    let found = read(&file);
    assert!(found.skipped.is_empty(), "{:?}", found.skipped);
    let curve = &found.curves[1];
    assert!(curve.deviation > 0.0 && curve.deviation < 8e-9);
    assert!(
        found.notes[0].contains("fitted within"),
        "{:?}",
        found.notes
    );
    let [from, to] = curve.parameters.file_range();
    assert!((from - 0.25).abs() < 1e-14 && (to - 3.0).abs() < 1e-14);
    let off = worst_on_curve(curve, |t| {
        let (s, c) = t.sin_cos();
        let tangent = Vec3::new(-3.0 * s, 2.0 * c, 0.0).normalize();
        Vec3::new(3.0 * c, 2.0 * s, 0.0) + Vec3::z().cross(&tangent) * 0.5
    });
    assert!(
        off < 1.1 * curve.deviation,
        "{off:.1e} {:.1e}",
        curve.deviation
    );
    assert!(reason(130, 0, "1,2,0,1,0,0.5,0.,0.,0.,0.,0.,1.,0.,1.").contains("varies"));
}
