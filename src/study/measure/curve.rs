//! How far two curves are apart.
use super::sample::{Difference, Note};
use std::borrow::Cow;

/// Shares of a range this close to 1 are all of it.
const ALL: f64 = 1.0 - 1e-6;

/// The curve from left to right; none where it goes back and forth.
pub(super) fn ascending(curve: &[[f64; 2]]) -> Option<Cow<'_, [[f64; 2]]>> {
    if curve.windows(2).all(|w| w[0][0] <= w[1][0]) {
        Some(Cow::Borrowed(curve))
    } else if curve.windows(2).all(|w| w[0][0] >= w[1][0]) {
        Some(Cow::Owned(curve.iter().rev().copied().collect()))
    } else {
        None
    }
}

/// Root of the mean square of the difference, and of the reference, over the range that both curves have. Both are straight
/// between their points (several at one place are a jump), so the integrals between the abscissae of either are exact.
///
/// # Errors
/// In words, where a curve goes back and forth or the curves have no range in common.
pub(super) fn difference(curve: &[[f64; 2]], reference: &[[f64; 2]]) -> Result<Difference, String> {
    let back = |what: &str| {
        format!(
            "the independent variable of the {what} goes back and forth: curves cannot be compared"
        )
    };
    let a = ascending(curve).ok_or_else(|| back("curve"))?;
    let b = ascending(reference).ok_or_else(|| back("reference"))?;
    let range = |c: &[[f64; 2]]| match (c.first(), c.last()) {
        (Some(first), Some(last)) => [first[0], last[0]],
        _ => [f64::NAN; 2],
    };
    let ([a0, a1], [b0, b1]) = (range(&a), range(&b));
    let (from, to) = (a0.max(b0), a1.min(b1));
    // Also where a curve is empty.
    if !(a0.max(b0) < a1.min(b1) && a0 < a1 && b0 < b1) {
        return Err("it has no range in common with the reference".into());
    }
    let mut places: Vec<f64> = (a.iter().chain(b.iter()))
        .map(|p| p[0])
        .filter(|x| *x > from && *x < to)
        .chain([from, to])
        .collect();
    places.sort_by(f64::total_cmp);
    let (mut of_a, mut of_b) = (Pieces::new(&a), Pieces::new(&b));
    let (mut apart, mut size) = (0.0, 0.0);
    for w in places.windows(2).filter(|w| w[0] < w[1]) {
        let (ya, yb) = (of_a.over([w[0], w[1]]), of_b.over([w[0], w[1]]));
        let length = w[1] - w[0];
        apart += length * square([ya[0] - yb[0], ya[1] - yb[1]]);
        size += length * square(yb);
    }
    let mut notes = Vec::new();
    let mut partly = |text: &str, whole: f64| {
        let share = (to - from) / whole;
        if share < ALL {
            notes.push(Note {
                text: text.to_string(),
                detail: Some(format!("{:.3} of its range", share)),
            });
        }
    };
    partly("the curve covers a part of the reference only", b1 - b0);
    partly("the reference covers a part of the curve only", a1 - a0);
    Ok(Difference {
        distance: (apart / (to - from)).sqrt(),
        size: (size / (to - from)).sqrt(),
        notes,
    })
}

/// Mean square of a straight piece with these ends.
fn square([y0, y1]: [f64; 2]) -> f64 {
    (y0 * y0 + y0 * y1 + y1 * y1) / 3.0
}

/// The straight pieces of a curve, gone through from left to right.
struct Pieces<'a> {
    curve: &'a [[f64; 2]],
    at: usize,
}

impl<'a> Pieces<'a> {
    fn new(curve: &'a [[f64; 2]]) -> Self {
        Pieces { curve, at: 0 }
    }

    /// Values at both ends of an interval that lies within a single piece.
    fn over(&mut self, ends: [f64; 2]) -> [f64; 2] {
        while self.at + 2 < self.curve.len() && self.curve[self.at + 1][0] <= ends[0] {
            self.at += 1;
        }
        let ([x0, y0], [x1, y1]) = (self.curve[self.at], self.curve[self.at + 1]);
        ends.map(|x| y0 + (y1 - y0) * ((x - x0) / (x1 - x0)))
    }
}
