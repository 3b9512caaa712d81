//! The second-order jet of patches of degree 1 to 5, which is where the time of contact and projection goes: one kernel for
//! any processor and one for x86-64 with AVX2 and FMA, chosen when a patch is made.
//!
//! A homogeneous control point is four numbers, one 256-bit register. Both kernels do the same in the same order; they
//! differ by the rounding that fused operations save.

#[cfg(target_arch = "x86_64")]
mod avx2;
mod portable;

use crate::basis::{Basis, Lanes, TABLE_DEGREE, Table};
use crate::surface::Jet;

/// How the jets of a patch are computed, with the tables for it.
#[derive(Debug, Clone)]
pub(super) enum Kernel {
    /// A degree above 5: the recursion.
    General,
    /// Plain code.
    Portable([Table; 2]),
    /// AVX2 and FMA, which this processor has.
    #[cfg(target_arch = "x86_64")]
    Avx2([Table; 2], avx2::Available),
}

/// How a patch is evaluated is no part of what it is.
impl PartialEq for Kernel {
    fn eq(&self, _: &Self) -> bool {
        true
    }
}

impl Kernel {
    /// The fastest one for these bases on this processor.
    pub fn new(basis: &[Basis; 2]) -> Self {
        if basis.iter().any(|b| b.degree() > TABLE_DEGREE) {
            return Self::General;
        }
        let tables = [Table::new(&basis[0]), Table::new(&basis[1])];
        #[cfg(target_arch = "x86_64")]
        if let Some(available) = avx2::Available::detect() {
            return Self::Avx2(tables, available);
        }
        Self::Portable(tables)
    }

    /// The one for any processor.
    pub fn portable(self) -> Self {
        match self {
            #[cfg(target_arch = "x86_64")]
            Self::Avx2(tables, _) => Self::Portable(tables),
            other => other,
        }
    }

    pub fn is_portable(&self) -> bool {
        #[cfg(target_arch = "x86_64")]
        if matches!(self, Self::Avx2(..)) {
            return false;
        }
        true
    }
}

/// What a jet is made of.
struct Piece<'a> {
    /// The tables of the span in both directions.
    rows: [&'a [Lanes]; 2],
    /// The control points from the first active one on.
    points: &'a [[f64; 4]],
    /// From one row of the net to the next.
    stride: usize,
    /// The weight of all points, where they have the same.
    weight: Option<f64>,
}

impl<'a> Piece<'a> {
    #[inline(always)]
    fn new(patch: &'a super::NurbsPatch, tables: &'a [Table; 2], span: [usize; 2]) -> Self {
        let [b1, b2] = &patch.basis;
        let span = [
            span[0].min(b1.span_count() - 1),
            span[1].min(b2.span_count() - 1),
        ];
        let first = b1.first_function(span[0]) + b1.count() * b2.first_function(span[1]);
        Self {
            rows: [tables[0].span(span[0]), tables[1].span(span[1])],
            points: &patch.points[first..],
            stride: b1.count(),
            weight: (!patch.rational).then(|| patch.points[0][3]),
        }
    }
}

/// Calls a function with both degrees as constants.
macro_rules! with_degrees {
    ($degree:expr, $call:ident($($argument:expr),*)) => {
        with_degrees!(@first $degree, $call($($argument),*), 1 2 3 4 5)
    };
    (@first $degree:expr, $call:ident $arguments:tt, $($p:literal)*) => {
        match $degree[0] {
            $($p => with_degrees!(@second $degree, $call $arguments, $p),)*
            _ => with_degrees!(@second $degree, $call $arguments, 5),
        }
    };
    (@second $degree:expr, $call:ident($($argument:expr),*), $p:literal) => {
        match $degree[1] {
            1 => $call::<$p, 1>($($argument),*),
            2 => $call::<$p, 2>($($argument),*),
            3 => $call::<$p, 3>($($argument),*),
            4 => $call::<$p, 4>($($argument),*),
            _ => $call::<$p, 5>($($argument),*),
        }
    };
}
use with_degrees;

impl super::NurbsPatch {
    /// The jet by the patch's kernel; `None` where there are no tables.
    #[inline(always)]
    pub(super) fn fast_jet(&self, span: [usize; 2], xi: [f64; 2]) -> Option<Jet> {
        match &self.kernel {
            #[cfg(target_arch = "x86_64")]
            Kernel::Avx2(tables, available) => {
                let piece = Piece::new(self, tables, span);
                Some(available.jet(self.degree(), &piece, xi))
            }
            Kernel::Portable(tables) => {
                let piece = Piece::new(self, tables, span);
                Some(portable::jet(self.degree(), &piece, xi))
            }
            Kernel::General => None,
        }
    }
}

/// `s^k u^(D - k)` for degrees `D` = `P`, `P - 1` and `P - 2`, in that order.
#[inline(always)]
fn bernstein<const P: usize>([a, b, inverse, _]: [f64; 4], t: f64) -> [[f64; 6]; 3] {
    let (s, u) = ((t - a) * inverse, (b - t) * inverse);
    let (mut powers_s, mut powers_u) = ([1.0; 6], [1.0; 6]);
    for k in 1..=P {
        (powers_s[k], powers_u[k]) = (powers_s[k - 1] * s, powers_u[k - 1] * u);
    }
    let mut out = [[0.0; 6]; 3];
    for (m, out) in out.iter_mut().enumerate() {
        if m <= P {
            for k in 0..=P - m {
                out[k] = powers_s[k] * powers_u[P - m - k];
            }
        }
    }
    out
}
