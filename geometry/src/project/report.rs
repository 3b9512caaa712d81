//! What users and the contact code ask of a set as a whole.

use super::integrate;
use super::set::PatchSet;
use super::topology::EdgeReport;
use crate::frame::Frame;
use crate::surface::{Jet, Surface, Vec3};

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
    /// piece (corners and edges included) that belong to the surface: between the points it may be more extreme.
    pub fn curvature_range(&self) -> CurvatureRange {
        self.curvature_range_of(|_| true)
    }

    /// [`curvature_range`](Self::curvature_range) of the Bezier pieces for which `counts` holds. It is given the lowest and
    /// highest corner of a box around the sampled points of a piece.
    pub fn curvature_range_of(&self, counts: impl Fn(&[Vec3; 2]) -> bool) -> CurvatureRange {
        let mut range = CurvatureRange {
            convex: None,
            concave: None,
            samples: 0,
            skipped: 0,
        };
        // Curvatures below rounding are flat.
        let flat = 1e-10 / self.size;
        for piece in (0..self.pieces.count() as u32).map(|number| self.piece_place(number)) {
            let patch = &self.patches[piece.patch as usize];
            let places = (0..25).map(|k| {
                [0, 1].map(|dir| {
                    let [a, b] = piece.domain[dir];
                    let step = if dir == 0 { k % 5 } else { k / 5 };
                    a + (b - a) * step as f64 / 4.0
                })
            });
            let inside = places.filter(|xi| patch.trim().is_none_or(|trim| trim.contains(*xi)));
            let samples: Vec<([f64; 2], Jet)> = inside
                .map(|xi| (xi, patch.jet_in_span(piece.span, xi)))
                .collect();
            let bounds = samples.iter().map(|(_, jet)| [jet.rho; 2]);
            let bounds = bounds.reduce(|a, b| [a[0].inf(&b[0]), a[1].sup(&b[1])]);
            if !bounds.is_some_and(|bounds| counts(&bounds)) {
                continue;
            }
            for (xi, jet) in samples {
                // Without a side of the component, that of the patch.
                let side = self.sides[piece.patch as usize];
                let side = if side == 0.0 { 1.0 } else { side };
                let Some(frame) = Frame::new(&jet, side) else {
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

    /// Area of every patch, of trimmed ones that of the part inside the trim, by Gauss quadrature (exact for flat patches of
    /// moderate degree, else an approximation: 4 x 4 points per Bezier piece of an untrimmed patch).
    pub fn areas(&self) -> Vec<f64> {
        (0..self.patches.len() as u32)
            .map(|patch| {
                let [area] = integrate::over(self, patch, self.topology.of(patch), |jet| {
                    [jet.rho_i[0].cross(&jet.rho_i[1]).norm()]
                });
                area
            })
            .collect()
    }
}
