//! Swept and ruled surfaces of IGES files against their own definitions (IGES 5.3, ANS US PRO/IPO-100-1996, section 4): the patch
//! at the mapped parameters is the point that the entity's formula gives at the file's parameters.

use crate::builder::{Builder, values};
use crate::read::{patch, read, worst_on_patch};
use covact_geometry::{NurbsCurve, Vec3};
use nalgebra::{Rotation3, Unit, Vector2};
use std::f64::consts::{FRAC_PI_2, PI, TAU};

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
        let off = worst_on_patch(&base, |u, v| {
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
    let off = worst_on_patch(&base, |u, v| directrix(u) + Vec3::new(1.0, 0.5, 4.0) * v);
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
        let off = worst_on_patch(&base, |u, v| {
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
    let off = worst_on_patch(&base, |u, v| {
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
    let off = worst_on_patch(&base, |u, v| {
        rails[0].curve.point(u) * (1.0 - v) + rails[1].curve.point(u) * v
    });
    assert!(off < 1e-14, "{off:.1e}");
    assert_eq!((base.patch.degree(), base.deviation), ([2, 1], 0.0));
    let mut file = Builder::new();
    let a = file.add(100, "0.,0.,0.,1.,0.,1.,0.");
    let b = file.add(116, "0.,0.,2.,0");
    file.form(118, 0, &format!("{a},{b},0,0"));
    let off = worst_on_patch(&patch(&file), |u, v| {
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
    let off = worst_on_patch(&base, |u, v| {
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
