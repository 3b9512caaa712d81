//! How many facets the spans of a patch are cut into at first.

use super::refine::Refinement;
use super::{FacetError, refine::LIMIT};
use crate::surface::Surface;

/// Lines along which the length of a span is measured.
const LINES: u32 = 4;
/// Chords of each of them.
const CHORDS: u32 = 8;

/// Facets per span of a patch, `[direction][span]`, before any refinement by error.
///
/// # Errors
/// Numbers that are no counts and lengths that are none.
pub(super) fn first<S: Surface>(
    patch: &S,
    refinement: Refinement,
) -> Result<[Vec<usize>; 2], FacetError> {
    let spans = [0, 1].map(|dir| patch.spans(dir).len());
    Ok(match refinement {
        Refinement::PerSpan(0) => return Err(FacetError::Count),
        Refinement::PerSpan(n) => spans.map(|count| vec![n as usize; count]),
        Refinement::PerPatch(counts) if counts.contains(&0) => return Err(FacetError::Count),
        Refinement::PerPatch(counts) => {
            [0, 1].map(|dir| shared(&lengths(patch, dir), counts[dir] as usize))
        }
        Refinement::Size(size) if size.is_finite() && size > 0.0 => [0, 1].map(|dir| {
            let lengths = lengths(patch, dir);
            // Just above a whole number is that number, but for rounding.
            let count = |l: &f64| (l / size - 1e-9).ceil().clamp(1.0, LIMIT as f64 + 1.0) as usize;
            lengths.iter().map(count).collect()
        }),
        Refinement::Chord(tolerance) if tolerance.is_finite() && tolerance > 0.0 => {
            spans.map(|count| vec![1; count])
        }
        Refinement::Size(length) | Refinement::Chord(length) => {
            return Err(FacetError::Tolerance(length));
        }
    })
}

/// Length of every span of direction `dir`: the longest of some lines along it.
fn lengths<S: Surface>(patch: &S, dir: usize) -> Vec<f64> {
    let [low, high] = patch.domain()[1 - dir];
    let mut out = Vec::new();
    for [a, b] in patch.spans(dir) {
        let mut longest = 0.0f64;
        for line in 0..=LINES {
            let across = low + (high - low) * f64::from(line) / f64::from(LINES);
            let at = |k: u32| {
                let along = a + (b - a) * f64::from(k) / f64::from(CHORDS);
                let mut xi = [along; 2];
                xi[1 - dir] = across;
                patch.point(xi)
            };
            let mut length = 0.0;
            let mut before = at(0);
            for k in 1..=CHORDS {
                let now = at(k);
                length += (now - before).norm();
                before = now;
            }
            longest = longest.max(length);
        }
        out.push(longest);
    }
    out
}

/// `total` facets shared among spans by their lengths, one to each at least: every further facet goes where facets are
/// longest.
fn shared(lengths: &[f64], total: usize) -> Vec<usize> {
    let sum: f64 = lengths.iter().sum();
    let rest = total.saturating_sub(lengths.len());
    // Most at once, so that large totals do not take one round each; a little less than the share is never too many.
    let mut out: Vec<usize> = lengths
        .iter()
        .map(|l| 1.max((l / sum * rest as f64) as usize))
        .collect();
    let mut left = total.saturating_sub(out.iter().sum());
    while left > 0 {
        let longest = (0..out.len())
            .max_by(|&i, &j| (lengths[i] / out[i] as f64).total_cmp(&(lengths[j] / out[j] as f64)));
        match longest {
            Some(span) => out[span] += 1,
            None => break,
        }
        left -= 1;
    }
    out
}

#[cfg(test)]
mod tests {
    use super::shared;

    #[test]
    fn facets_are_shared_by_length() {
        assert_eq!(shared(&[1.0; 4], 8), [2; 4]);
        assert_eq!(shared(&[1.0; 4], 3), [1; 4]);
        assert_eq!(shared(&[3.0, 1.0], 8), [6, 2]);
        assert_eq!(shared(&[3.0, 1e-9], 7), [6, 1]);
        assert_eq!(shared(&[2.0], 1_000_000), [1_000_000]);
        assert_eq!(shared(&[5.0, 2.0, 3.0], 1000), [500, 200, 300]);
    }
}
