//! Many queries at once.

use crate::parallel::*;

use super::{Foot, Hint, PatchSet};
use crate::surface::{Surface, Vec3};

/// Slices of a batch that do not fit together.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error("{points} points with {hints} hints and room for {out} feet")]
pub struct BatchError {
    /// Number of points.
    pub points: usize,
    /// Number of hints.
    pub hints: usize,
    /// Room for answers.
    pub out: usize,
}

/// Points that one thread takes at a time: some tens of microseconds, far above the cost of handing them out.
const CHUNK: usize = 64;

impl<S: Surface> PatchSet<S> {
    /// [`project`](Self::project) for many points, on the threads of the current rayon pool: `out[k]` is the answer for
    /// `points[k]` with `hints[k]` (no hints where `hints` is empty). Every answer is computed by itself, so it is the
    /// same, bit for bit, whatever the number of threads. Nothing is allocated per point.
    ///
    /// # Errors
    /// Slices of different lengths; nothing is written then.
    pub fn project_batch(
        &self,
        points: &[Vec3],
        hints: &[Option<Hint>],
        reach: f64,
        out: &mut [Option<Foot>],
    ) -> Result<(), BatchError> {
        let count = points.len();
        if out.len() != count || !(hints.is_empty() || hints.len() == count) {
            return Err(BatchError {
                points: count,
                hints: hints.len(),
                out: out.len(),
            });
        }
        out.par_chunks_mut(CHUNK)
            .enumerate()
            .for_each(|(chunk, out)| {
                let start = chunk * CHUNK;
                for (k, foot) in out.iter_mut().enumerate() {
                    let hint = hints.get(start + k).copied().flatten();
                    *foot = self.project(&points[start + k], hint, reach);
                }
            });
        Ok(())
    }
}
