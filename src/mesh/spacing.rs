//! Node positions along one axis.
use super::{MAX_NODES, MeshError};
use crate::scene::Spacing;

/// Largest growth from one element to the next that `fine` spacing may need.
const MAX_GROWTH: f64 = 10.0;

/// Positions of the `elements + 1` nodes on `[0, length]`, strictly increasing, the ends exact.
///
/// `axis` names the axis in errors. Fails with [`MeshError::Spacing`] when the spacing cannot fill the axis.
pub fn positions(
    spacing: &Spacing,
    length: f64,
    elements: u32,
    axis: &str,
) -> Result<Vec<f64>, MeshError> {
    let error = |reason: String| MeshError::Spacing {
        axis: axis.to_string(),
        reason,
    };
    let n = elements as usize;
    if n == 0 || !(length.is_finite() && length > 0.0) {
        return Err(error(format!("{n} elements over a length of {length}")));
    }
    if u64::from(elements) >= MAX_NODES {
        return Err(error(format!(
            "{n} elements are more than the limit of {MAX_NODES} nodes"
        )));
    }
    let mut s = match *spacing {
        Spacing::Uniform => (0..=n).map(|i| length * i as f64 / n as f64).collect(),
        Spacing::Geometric { ratio } => {
            if !(ratio.is_finite() && ratio > 0.0) {
                return Err(error(format!(
                    "ratio is {ratio}, expected a positive number"
                )));
            }
            geometric(ratio, length, n)
        }
        Spacing::Fine {
            length: part,
            fine,
            from_end,
        } => {
            let s = fine_part(part, fine, length, elements).map_err(error)?;
            if from_end {
                s.iter().rev().map(|x| length - x).collect()
            } else {
                s
            }
        }
    };
    s[0] = 0.0;
    s[n] = length;
    if let Some(i) = (0..n).find(|&i| s[i + 1] - s[i] <= length * 1e-14) {
        return Err(error(format!(
            "element {} of {n} has no length left: the ratio is too far from 1",
            i + 1
        )));
    }
    Ok(s)
}

/// Lengths `h, h q, h q^2, ...`, `n` of them, that fill `length`; positions of their ends.
fn geometric(ratio: f64, length: f64, n: usize) -> Vec<f64> {
    // expm1 keeps ratios next to 1 exact; ratios above 1 are mirrored so that powers do not overflow.
    let mirrored = ratio > 1.0;
    let log = if mirrored { -ratio.ln() } else { ratio.ln() };
    if log == 0.0 {
        return (0..=n).map(|i| length * i as f64 / n as f64).collect();
    }
    let full = (n as f64 * log).exp_m1();
    let at = |i: usize| length * ((i as f64 * log).exp_m1() / full);
    if mirrored {
        (0..=n).map(|i| length - at(n - i)).collect()
    } else {
        (0..=n).map(at).collect()
    }
}

/// `fine` equal elements over `part`, then `elements - fine` growing ones over the rest.
fn fine_part(part: f64, fine: u32, length: f64, elements: u32) -> Result<Vec<f64>, String> {
    let slack = 1e-9 * length;
    if !(part.is_finite() && part > 0.0 && part <= length + slack) {
        return Err(format!(
            "the fine length is {part}, expected a length up to {length}"
        ));
    }
    if fine == 0 || fine > elements {
        return Err(format!(
            "{fine} fine elements, expected 1 to {elements} (all elements of the axis)"
        ));
    }
    let (rest, m) = (length - part, (elements - fine) as usize);
    let h = part / f64::from(fine);
    let equal = (0..=fine).map(|i| h * f64::from(i));
    match (rest <= slack, m) {
        (true, 0) => return Ok(equal.collect()),
        (true, _) => {
            return Err(format!(
                "{fine} fine elements fill the axis, but {m} more are asked for"
            ));
        }
        (false, 0) => {
            return Err(format!(
                "all {fine} elements are fine, but they leave {rest} of the axis unfilled: give more elements"
            ));
        }
        _ => {}
    }
    // h (q + q^2 + ... + q^m) = rest; the left side grows with q, so bisection on ln q always ends.
    let filled = |log: f64| {
        if log == 0.0 {
            h * m as f64
        } else {
            h * log.exp() * ((m as f64 * log).exp_m1() / log.exp_m1())
        }
    };
    if filled(0.0) > rest * (1.0 + 1e-9) {
        return Err(format!(
            "the {m} elements after the fine part would have to be shorter ({:.6}) than the fine ones ({h:.6}): \
             give fewer elements or more fine ones",
            rest / m as f64
        ));
    }
    let (mut low, mut high) = (0.0, MAX_GROWTH.ln());
    if filled(high) < rest {
        return Err(format!(
            "the {m} elements after the fine part would have to grow by more than {MAX_GROWTH} each: \
             give more elements"
        ));
    }
    for _ in 0..100 {
        let middle = 0.5 * (low + high);
        if filled(middle) < rest {
            low = middle;
        } else {
            high = middle;
        }
    }
    let grown = geometric((0.5 * (low + high)).exp(), rest, m);
    Ok(equal.chain(grown[1..].iter().map(|x| part + x)).collect())
}
