//! Trims: the part of a patch's parameter rectangle that belongs to the surface.

use nalgebra::Vector2;

use crate::curve::NurbsCurve;

/// Why a trim could not be made.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum TrimError {
    /// A loop without curves.
    #[error("trim loop {0} has no curves")]
    Empty(usize),
    /// Two curves that follow each other in a loop do not meet.
    #[error("trim loop {0} is open: curve {1} ends {gap} (share of the domain) from where the next begins", gap = .2)]
    Open(usize, usize, f64),
}

/// One curve of a trim loop.
#[derive(Debug, Clone, PartialEq)]
pub struct TrimCurve {
    /// The curve in the parameter plane (xi1, xi2), in the direction of the loop.
    pub parameter: NurbsCurve<2>,
    /// The curve in space that the file gives beside it, if any. It runs from the same start to the same end; the
    /// parameters of both need not correspond.
    pub space: Option<NurbsCurve<3>>,
    /// The file's number of the curve or edge (0 where there is none): edges of neighbouring faces may share it.
    pub entity: u32,
}

/// A closed chain of curves.
#[derive(Debug, Clone, PartialEq)]
pub struct TrimLoop {
    /// Its curves, each beginning where the one before ends, the first where the last ends.
    pub curves: Vec<TrimCurve>,
}

/// The loops that bound the part of a patch's domain that belongs to the surface. A point belongs to it where a ray from
/// it crosses the loops an odd number of times, so the direction of loops does not matter.
#[derive(Debug, Clone, PartialEq)]
pub struct Trim {
    /// All loops; where the file gives no outer one, the border of the domain is the first.
    loops: Vec<TrimLoop>,
}

impl Trim {
    /// Takes closed loops; gaps up to `gap_allowed` (a share of the extent of `domain`) between curves that follow each
    /// other are closed by moving end points.
    ///
    /// # Errors
    /// Empty or open loops.
    pub fn new(
        loops: Vec<TrimLoop>,
        domain: [[f64; 2]; 2],
        gap_allowed: f64,
    ) -> Result<Self, TrimError> {
        let extent = Vector2::new(domain[0][1] - domain[0][0], domain[1][1] - domain[1][0]);
        for (number, a_loop) in loops.iter().enumerate() {
            let n = a_loop.curves.len();
            if n == 0 {
                return Err(TrimError::Empty(number));
            }
            for k in 0..n {
                let end = a_loop.curves[k].parameter.ends()[1];
                let start = a_loop.curves[(k + 1) % n].parameter.ends()[0];
                let gap = (end - start).component_div(&extent).amax();
                if gap.is_nan() || gap > gap_allowed {
                    return Err(TrimError::Open(number, k, gap));
                }
            }
        }
        Ok(Self { loops })
    }

    /// The loops.
    pub fn loops(&self) -> &[TrimLoop] {
        &self.loops
    }
}
