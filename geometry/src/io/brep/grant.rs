//! What may be made of a file: work and memory in proportion to its length.
//!
//! A few numbers can ask for any number of pieces (a curve far from the surface it should lie on, a surface without its
//! digits), and a few pointers for any number of copies of a long curve. Files of CAD systems stay far below both limits.

use crate::{NurbsCurve, NurbsPatch};
use std::cell::Cell;

/// Evaluations of a surface granted to any file, and for each of its lines of parameter data. A span of a space curve takes a
/// hundred projections to be followed on its surface, some 6,000 evaluations, and stands on one to three lines. Borders that
/// are given in the parameter plane take next to nothing.
const WORK: [u64; 2] = [1_000_000, 4_000];
/// Evaluations that one projection counts for, and each part of the surface that the search for it looks into: mostly one or
/// two, thousands next to a surface that is millions of times as long as wide.
pub const FOOT: u64 = 32;
pub const PART: u64 = 32;
/// Bytes granted to any file, and for each of its records (of 80 bytes).
const BYTES: [u64; 2] = [500_000, 50 * 80];
/// Bytes that a control point of a patch, of a curve, and of a boundary curve in both its planes stand for: the last with the
/// pieces and boxes by which it is searched.
const PATCH_POINT: usize = 100;
const CURVE_POINT: usize = 100;
const TRIM_POINT: usize = 500;
/// Bytes that a body stands for, beside its faces and its names.
const BODY: usize = 200;

/// After so many refusals, surfaces are refused unread.
const REFUSALS: u32 = 20;

/// Evaluations granted to a file with so many lines of parameter data.
pub fn evaluations(lines: usize) -> u64 {
    WORK[0] + WORK[1] * lines as u64
}

/// What is left.
pub struct Grant {
    work: Cell<u64>,
    bytes: Cell<u64>,
    refusals: Cell<u32>,
}

impl Grant {
    /// For a file with so many lines of 80 bytes, of which `parameter` describe geometry.
    pub fn of_lines(parameter: usize, all: usize) -> Self {
        Self {
            work: Cell::new(evaluations(parameter)),
            bytes: Cell::new(BYTES[0] + BYTES[1] * all as u64),
            refusals: Cell::new(0),
        }
    }

    /// For a format without records of fixed length: 80 bytes count as one line.
    pub fn of_length(bytes: usize) -> Self {
        Self::of_lines(bytes / 80, bytes / 80)
    }

    /// An error when more of the file is not worth reading.
    pub fn open(&self) -> Result<(), String> {
        if self.refusals.get() < REFUSALS {
            return Ok(());
        }
        Err(format!(
            "not read, for {REFUSALS} surfaces before it take more work or memory than a file of this length is granted"
        ))
    }

    /// Takes work, in evaluations of a surface.
    pub fn work(&self, evaluations: u64) -> Result<(), String> {
        self.take(&self.work, evaluations).ok_or_else(|| {
            "its border curves take more work than a file of this length is granted".to_owned()
        })
    }

    /// Takes the memory of a patch.
    pub fn patch(&self, patch: &NurbsPatch) -> Result<(), String> {
        let [m, n] = patch.counts();
        self.memory(m.saturating_mul(n).saturating_mul(PATCH_POINT))
    }

    /// Takes the memory of a body with names of so many bytes.
    pub fn body(&self, names: usize) -> Result<(), String> {
        self.memory(BODY.saturating_add(names))
    }

    /// Takes the memory of a curve in space.
    pub fn curve(&self, curve: &NurbsCurve<3>) -> Result<(), String> {
        self.memory(curve.homogeneous().len().saturating_mul(CURVE_POINT))
    }

    /// Takes the memory and the work of loops from so many curves with so many control points.
    pub fn boundary(&self, curves: usize, points: usize) -> Result<(), String> {
        // Curves look for those that follow them, pair by pair.
        let curves = curves as u64;
        self.work(curves.saturating_mul(curves) / 4)?;
        self.memory(points.saturating_mul(TRIM_POINT))
    }

    /// Takes the memory of a cubic piece of a fitted boundary curve.
    pub fn piece(&self) -> Result<(), String> {
        self.memory(3 * TRIM_POINT)
    }

    fn memory(&self, bytes: usize) -> Result<(), String> {
        self.take(&self.bytes, bytes as u64).ok_or_else(|| {
            "with it the file would take more memory than one of this length is granted".to_owned()
        })
    }

    fn take(&self, left: &Cell<u64>, wanted: u64) -> Option<()> {
        let rest = left.get().checked_sub(wanted);
        match rest {
            Some(rest) => left.set(rest),
            None => self.refusals.set(self.refusals.get() + 1),
        }
        rest.map(|_| ())
    }
}
