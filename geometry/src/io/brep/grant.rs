//! What may be made of a file: work and memory in proportion to its length.
//!
//! A few numbers can ask for any number of pieces (a curve far from the surface it should lie on, a surface without its
//! digits), and a few pointers for any number of copies of a long curve. Files of CAD systems stay far below both limits.

use crate::{NurbsCurve, NurbsPatch};
use std::sync::atomic::{AtomicU32, AtomicU64, Ordering::Relaxed};

/// Work granted to any file, and for each of its lines of parameter data. The unit is a control point that an evaluation of a
/// surface multiplies: an evaluation of a bicubic surface [costs 24](Grant::evaluation). In the fuzzing build a unit takes 30 ns,
/// so the work granted fills less than half of the time that the fuzz targets allow.
///
/// Following a span of a space curve on its surface takes a hundred projections. Each takes about five evaluations, fifty next to
/// the tip of a cone. A span stands on one to three lines. Borders that the file gives in the parameter plane cost almost nothing.
const WORK: [u64; 2] = [4_000_000, 24_000];
/// Cost of an evaluation in addition to its control points.
const EVALUATION: u64 = 8;
/// Cost, in evaluations, of each piece of a surface and each part of a piece that a search for closest points examines; of each
/// Bezier piece made for the search; and of each cell made when the search is set up.
pub const PART: u64 = 8;
pub const PIECE: u64 = 16;
pub const CELL: u64 = 4;
/// Evaluations per projection outside of the search.
pub const FOOT: u64 = 3;
/// Cost of comparing two boundary curves.
const PAIR: u64 = 4;
/// Bytes granted to any file, and for each of its records (of 80 bytes).
const BYTES: [u64; 2] = [500_000, 50 * 80];
/// Bytes that may be in use for a while beside those, and for each record.
const PASSING: [u64; 2] = [250_000, 25 * 80];
/// Bytes that a control point of a patch, of a curve, and of a boundary curve in both its planes stand for: the last with the
/// pieces and boxes by which it is searched.
const PATCH_POINT: usize = 100;
const CURVE_POINT: usize = 100;
const TRIM_POINT: usize = 500;
/// Bytes that a body stands for, beside its faces and its names.
const BODY: usize = 200;

/// After so many refusals, surfaces are refused unread.
const REFUSALS: u32 = 20;

/// The work and memory left to a file. Atomic, because surfaces that charge their evaluations to it must be `Sync`.
#[derive(Debug)]
pub struct Grant {
    work: AtomicU64,
    bytes: AtomicU64,
    passing: u64,
    /// Bytes that the set which is being made may take in addition to what was foreseen.
    more: AtomicU64,
    refusals: AtomicU32,
}

impl Grant {
    /// For a file with so many lines of 80 bytes, of which `parameter` describe geometry.
    pub fn of_lines(parameter: usize, all: usize) -> Self {
        Self {
            work: AtomicU64::new(WORK[0] + WORK[1] * parameter as u64),
            bytes: AtomicU64::new(BYTES[0] + BYTES[1] * all as u64),
            passing: PASSING[0] + PASSING[1] * all as u64,
            more: AtomicU64::new(0),
            refusals: AtomicU32::new(0),
        }
    }

    /// For a format without records of fixed length: 80 bytes count as one line.
    pub fn of_length(bytes: usize) -> Self {
        Self::of_lines(bytes / 80, bytes / 80)
    }

    /// An error when more of the file is not worth reading.
    pub fn open(&self) -> Result<(), String> {
        if self.refusals.load(Relaxed) < REFUSALS {
            return Ok(());
        }
        Err(format!(
            "not read, for {REFUSALS} surfaces before it take more work or memory than a file of this length is granted"
        ))
    }

    /// Takes work before it is done.
    pub fn work(&self, work: u64) -> Result<(), String> {
        self.take(&self.work, work).ok_or_else(|| {
            "its border curves take more work than a file of this length is granted".to_owned()
        })
    }

    /// Charges work that is being done; returns whether any work is left.
    pub fn spend(&self, work: u64) -> bool {
        let rest = self.work.load(Relaxed).saturating_sub(work);
        self.work.store(rest, Relaxed);
        rest > 0
    }

    /// Work that is left.
    #[cfg(test)]
    pub fn left(&self) -> u64 {
        self.work.load(Relaxed)
    }

    /// Whether no work is left.
    pub fn is_spent(&self) -> bool {
        self.work.load(Relaxed) == 0
    }

    /// Cost of an evaluation of a surface.
    pub fn evaluation(degree: [usize; 2]) -> u64 {
        let [m, n] = degree.map(|p| p as u64 + 1);
        EVALUATION + m * n
    }

    /// Cost of an evaluation of a curve. The recursion for its basis functions dominates.
    pub fn evaluation_of_curve(degree: usize) -> u64 {
        let n = degree as u64 + 1;
        EVALUATION + n * n / 2
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
        self.work(curves.saturating_mul(curves).saturating_mul(PAIR))?;
        self.memory(points.saturating_mul(TRIM_POINT))
    }

    /// Bytes that may be in use for a while: those granted and not taken, and some more.
    pub fn passing_bytes(&self) -> u64 {
        self.bytes.load(Relaxed) + self.passing
    }

    /// Lets a set that is made next take so many bytes more than was foreseen.
    pub fn allow_more(&self, bytes: u64) {
        self.more.store(bytes, Relaxed);
    }

    /// Takes some of these bytes; returns whether any are left.
    pub fn take_more(&self, bytes: u64) -> bool {
        let rest = self.more.load(Relaxed).saturating_sub(bytes);
        self.more.store(rest, Relaxed);
        rest > 0
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

    fn take(&self, left: &AtomicU64, wanted: u64) -> Option<()> {
        let rest = left.load(Relaxed).checked_sub(wanted);
        match rest {
            Some(rest) => left.store(rest, Relaxed),
            None => {
                self.refusals.fetch_add(1, Relaxed);
            }
        }
        rest.map(|_| ())
    }
}
