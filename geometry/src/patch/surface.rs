//! A NURBS patch as a [`Surface`].

use super::NurbsPatch;
use crate::bezier::{BezierPiece, bezier_piece, bezier_pieces};
use crate::surface::{Jet, Surface, Vec3};
use crate::trim::Trim;

impl Surface for NurbsPatch {
    fn domain(&self) -> [[f64; 2]; 2] {
        NurbsPatch::domain(self)
    }

    fn spans(&self, dir: usize) -> Vec<[f64; 2]> {
        NurbsPatch::spans(self, dir)
    }

    #[inline]
    fn find_span(&self, xi: [f64; 2]) -> [usize; 2] {
        NurbsPatch::find_span(self, xi)
    }

    #[inline]
    fn jet_in_span(&self, span: [usize; 2], xi: [f64; 2]) -> Jet {
        NurbsPatch::jet_in_span(self, span, xi)
    }

    #[inline]
    fn jet(&self, xi: [f64; 2]) -> Jet {
        NurbsPatch::jet(self, xi)
    }

    fn point(&self, xi: [f64; 2]) -> Vec3 {
        NurbsPatch::point(self, xi)
    }

    fn bezier_pieces(&self) -> Vec<BezierPiece> {
        bezier_pieces(self)
    }

    fn bezier_piece(&self, span: [usize; 2]) -> BezierPiece {
        bezier_piece(self, span)
    }

    fn crease_knots(&self, dir: usize) -> Vec<f64> {
        NurbsPatch::crease_knots(self, dir)
    }

    fn sharp_knots(&self, dir: usize, angle: f64) -> Vec<f64> {
        NurbsPatch::sharp_knots(self, dir, angle)
    }

    fn trim(&self) -> Option<&Trim> {
        NurbsPatch::trim(self)
    }
}
