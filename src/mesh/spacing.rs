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
        Spacing::Geometric { ratio } | Spacing::FromMiddle { ratio } => {
            if !(ratio.is_finite() && ratio > 0.0) {
                return Err(error(format!(
                    "ratio is {ratio}, expected a positive number"
                )));
            }
            match spacing {
                Spacing::FromMiddle { .. } => from_the_middle(ratio, length, n),
                _ => geometric(ratio, length, n),
            }
        }
        Spacing::Fine {
            length: part,
            fine,
            from_end,
            from_middle,
        } => {
            let sides = match (from_end, from_middle) {
                (true, true) => {
                    let both = "`from_end` and `from_middle` are both asked for: the fine part lies at one place";
                    return Err(error(both.to_owned()));
                }
                (_, middle) => 1 + u32::from(middle),
            };
            let (equal, grown) = fine_part(part, fine, length, (elements, sides)).map_err(error)?;
            if from_middle {
                let rest = 0.5 * (length - part);
                let before = grown.iter().rev().map(|x| rest - x);
                let middle = equal.iter().map(|x| rest + x);
                let after = grown.iter().map(|x| rest + part + x);
                before.chain(middle).chain(after).collect()
            } else if from_end {
                let all = equal.iter().copied().chain(grown.iter().map(|x| part + x));
                let all: Vec<f64> = all.collect();
                all.iter().rev().map(|x| length - x).collect()
            } else {
                equal
                    .into_iter()
                    .chain(grown.iter().map(|x| part + x))
                    .collect()
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

/// Lengths that grow by `ratio` from the middle to both ends, with one element in the middle where `n` is odd; positions of their
/// ends.
fn from_the_middle(ratio: f64, length: f64, n: usize) -> Vec<f64> {
    // Powers of the distance from the middle, the largest of them 1, so that none overflows.
    let most = (n - 1) / 2;
    let power = |i: usize| {
        let out = i.abs_diff(n - 1 - i) / 2;
        match ratio > 1.0 {
            true => -((most - out) as f64) * ratio.ln(),
            false => out as f64 * ratio.ln(),
        }
    };
    let ends = (0..n).scan(0.0, |sum, i| {
        *sum += power(i).exp();
        Some(*sum)
    });
    let ends: Vec<f64> = std::iter::once(0.0).chain(ends).collect();
    ends.iter().map(|x| length * (x / ends[n])).collect()
}

/// Ends of `fine` equal elements over `part`, from 0 on, and those of the growing ones on each of the `sides` of it that have the
/// rest of `elements` and of `length`, counted from the fine part.
fn fine_part(
    part: f64,
    fine: u32,
    length: f64,
    (elements, sides): (u32, u32),
) -> Result<(Vec<f64>, Vec<f64>), String> {
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
    if !(elements - fine).is_multiple_of(sides) {
        return Err(format!(
            "the {} elements beside the fine part cannot be shared between both of its sides: give one more or one less",
            elements - fine
        ));
    }
    let (rest, m) = (
        (length - part) / f64::from(sides),
        ((elements - fine) / sides) as usize,
    );
    let h = part / f64::from(fine);
    let equal = (0..=fine).map(|i| h * f64::from(i)).collect();
    match (rest <= slack, m) {
        (true, 0) => return Ok((equal, Vec::new())),
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
    let mut grown = geometric((0.5 * (low + high)).exp(), rest, m);
    grown.remove(0);
    Ok((equal, grown))
}
