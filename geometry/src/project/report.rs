//! What users and the contact code ask of a set as a whole.

use super::set::PatchSet;
use super::topology::EdgeReport;
use crate::frame::Frame;
use crate::surface::{Surface, Vec3};

/// Where a principal curvature is extreme.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CurvatureExtreme {
    /// Principal curvature (1 / length) about the outward normal: negative where the master is convex.
    pub kappa: f64,
    /// Patch number.
    pub patch: u32,
    /// Parameters.
    pub xi: [f64; 2],
}

impl CurvatureExtreme {
    /// Radius of curvature, infinite where it is flat.
    pub fn radius(&self) -> f64 {
        1.0 / self.kappa.abs()
    }
}

/// Sampled principal curvatures of a set.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CurvatureRange {
    /// The most convex point (smallest curvature), `None` if no sampled point is convex.
    pub convex: Option<CurvatureExtreme>,
    /// The most concave point (largest curvature), `None` if no sampled point is concave.
    pub concave: Option<CurvatureExtreme>,
    /// Points sampled.
    pub samples: usize,
    /// Points left out because the tangents do not span a plane there.
    pub skipped: usize,
}

/// Points and weights of the Gauss rule with four points on (0, 1).
const GAUSS: [(f64, f64); 4] = [
    (0.069_431_844_202_973_71, 0.173_927_422_568_726_93),
    (0.330_009_478_207_571_87, 0.326_072_577_431_273_07),
    (0.669_990_521_792_428_1, 0.326_072_577_431_273_07),
    (0.930_568_155_797_026_3, 0.173_927_422_568_726_93),
];

impl<S: Surface> PatchSet<S> {
    /// Length of the diagonal of [`bounds`](Self::bounds).
    pub fn size(&self) -> f64 {
        self.size
    }

    /// Lowest and highest corner of a box that holds all patches (around the control points of their Bezier pieces).
    pub fn bounds(&self) -> [Vec3; 2] {
        self.tree.bounds()
    }

    /// What was found about edges: joints, T-joints, free borders, poles, gaps.
    pub fn edges(&self) -> &EdgeReport {
        &self.topology.report
    }

    /// Most convex and most concave principal curvature with the present sides, sampled at 5 x 5 points of every Bezier
    /// piece (corners and edges included): between the points it may be more extreme.
    pub fn curvature_range(&self) -> CurvatureRange {
        let mut range = CurvatureRange {
            convex: None,
            concave: None,
            samples: 0,
            skipped: 0,
        };
        // Curvatures below rounding are flat.
        let flat = 1e-10 / self.size;
        for piece in &self.pieces.list {
            let patch = &self.patches[piece.patch as usize];
            for k in 0..25 {
                let xi = [0, 1].map(|dir| {
                    let [a, b] = piece.domain[dir];
                    let step = if dir == 0 { k % 5 } else { k / 5 };
                    a + (b - a) * step as f64 / 4.0
                });
                let jet = patch.jet_in_span(piece.span, xi);
                let Some(frame) = Frame::new(&jet, self.sides[piece.patch as usize]) else {
                    range.skipped += 1;
                    continue;
                };
                range.samples += 1;
                let [low, high] = frame.principal_curvatures();
                let point = |kappa| CurvatureExtreme {
                    kappa,
                    patch: piece.patch,
                    xi,
                };
                if low < -flat && range.convex.is_none_or(|c| low < c.kappa) {
                    range.convex = Some(point(low));
                }
                if high > flat && range.concave.is_none_or(|c| high > c.kappa) {
                    range.concave = Some(point(high));
                }
            }
        }
        range
    }

    /// Area of every patch, by Gauss quadrature with 4 x 4 points per Bezier piece (exact for flat patches of moderate
    /// degree, else an approximation of that order).
    pub fn areas(&self) -> Vec<f64> {
        let mut areas = vec![0.0; self.patches.len()];
        for piece in &self.pieces.list {
            let patch = &self.patches[piece.patch as usize];
            let [[a1, b1], [a2, b2]] = piece.domain;
            for (x2, w2) in GAUSS {
                for (x1, w1) in GAUSS {
                    let xi = [a1 + (b1 - a1) * x1, a2 + (b2 - a2) * x2];
                    let [r1, r2] = patch.jet_in_span(piece.span, xi).rho_i;
                    let weight = w1 * w2 * (b1 - a1) * (b2 - a2);
                    areas[piece.patch as usize] += weight * r1.cross(&r2).norm();
                }
            }
        }
        areas
    }
}
