//! Curves and surfaces of IGES files made by hand, and how far they lie from formulas.

use crate::builder::{Builder, values};
use covact_geometry::Vec3;
use covact_geometry::io::{
    BasePatch, BaseSurface, IgesCurve, IgesGeometry, Unbounded, read_iges_geometry,
};

pub fn read(file: &Builder) -> IgesGeometry {
    let text = file.text();
    read_iges_geometry(text.as_bytes(), "hand.igs").unwrap_or_else(|e| panic!("{e}\n{text}"))
}

/// The only curve of a file of one entity.
pub fn one(type_number: u32, form: i32, values: &str) -> IgesCurve {
    let mut file = Builder::new();
    file.form(type_number, form, values);
    let found = read(&file);
    assert!(found.skipped.is_empty(), "{:?}", found.skipped);
    assert!(found.notes.is_empty(), "{:?}", found.notes);
    found.curves[0].clone()
}

pub fn reason(type_number: u32, form: i32, values: &str) -> String {
    let mut file = Builder::new();
    file.form(type_number, form, values);
    let found = read(&file);
    assert!(found.curves.is_empty());
    found.skipped[0].reason.clone()
}

/// Largest distance between the curve and `truth` at parameters of the file, ends included.
pub fn worst_on_curve(curve: &IgesCurve, truth: impl Fn(f64) -> Vec3) -> f64 {
    let [a, b] = curve.parameters.file_range();
    let samples = (0..=200).map(|k| a + (b - a) * f64::from(k) / 200.0);
    samples
        .map(|t| {
            let own = curve.parameters.to_own(t);
            let back = curve.parameters.to_file(own);
            assert!((back - t).abs() < 1e-12 * (b - a), "{t} {back}");
            (curve.curve.point(own) - truth(t)).norm()
        })
        .fold(0.0, f64::max)
}

pub fn patches(file: &Builder) -> Vec<BasePatch> {
    let found = read(file);
    assert!(found.skipped.is_empty(), "{:?}", found.skipped);
    match found.surfaces.last().map(|s| s.surface.clone()) {
        Some(BaseSurface::Patches(patches)) => patches,
        other => panic!("{other:?}"),
    }
}

pub fn patch(file: &Builder) -> BasePatch {
    let found = patches(file);
    assert_eq!(found.len(), 1);
    found[0].clone()
}

pub fn unbounded(file: &Builder) -> Unbounded {
    match read(file).surfaces.last().map(|s| s.surface.clone()) {
        Some(BaseSurface::Unbounded(surface)) => *surface,
        other => panic!("{other:?}"),
    }
}

/// Largest distance from `truth` at 41 x 41 parameters of the file.
pub fn worst_on_patch(base: &BasePatch, truth: impl Fn(f64, f64) -> Vec3) -> f64 {
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

/// Coefficients (a, b, c, d by coordinate) of a 112 of several pieces.
pub fn spline_112(kind: u32, breaks: &[f64], pieces: &[[[f64; 4]; 3]]) -> String {
    let mut numbers: Vec<f64> = breaks.to_vec();
    numbers.extend(pieces.iter().flatten().flatten());
    // Values and derivatives at the end; not needed.
    numbers.extend([0.0; 12]);
    format!("{kind},2,3,{},{}", pieces.len(), values(&numbers))
}

/// The point of such a spline at `u`.
pub fn polynomial(breaks: &[f64], pieces: &[[[f64; 4]; 3]], u: f64) -> Vec3 {
    let last = pieces.len() - 1;
    let k = breaks[1..=last].iter().take_while(|&&b| u >= b).count();
    let s = u - breaks[k];
    Vec3::from(pieces[k].map(|[a, b, c, d]| a + (b + (c + d * s) * s) * s))
}
