//! Knots as writers print them.

/// Knots that rounding has set apart: differences up to 1e-9 of the whole range, of either sign, are closed. Writers
/// print as few as 9 digits; a span of that size has no extent in space but spoils derivatives.
pub fn merge_close(knots: &mut [f64]) -> usize {
    let range = knots.iter().fold(f64::NEG_INFINITY, |a, &b| a.max(b))
        - knots.iter().fold(f64::INFINITY, |a, &b| a.min(b));
    let mut moved = 0;
    for i in 1..knots.len() {
        let step = knots[i] - knots[i - 1];
        if step != 0.0 && step.abs() <= 1e-9 * range {
            knots[i] = knots[i - 1];
            moved += 1;
        }
    }
    moved
}

/// Ranges of control points that hang together: a knot inside that is repeated `degree + 1` times ends one and begins the
/// next (control points between, of knots repeated even more often, act nowhere). One range where the knots are no good.
pub fn pieces(degree: usize, knots: &[f64], count: usize) -> Vec<std::ops::Range<usize>> {
    let mut ranges = Vec::new();
    let mut start = 0;
    let mut i = degree + 1;
    while i < count {
        let m = knots[i..].iter().take_while(|&&t| t == knots[i]).count();
        // Knots i .. i + m: the piece before ends with `degree + 1` of them, the next begins with the last as many.
        if m > degree && knots[i] > knots[start + degree] && knots[i] < knots[count] {
            ranges.push(start..i);
            start = i + m - degree - 1;
        }
        i += m;
    }
    ranges.push(start..count);
    ranges
}
