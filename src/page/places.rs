//! Places that warnings name.

/// The first place that a warning names, as "near (x, y, z)" or "one of them at (x, y, z)".
pub(super) fn place(warning: &str) -> Option<[f64; 3]> {
    let starts = ["near (", "of them at (", "most at ("];
    let at = |start: &str| warning.find(start).map(|at| at + start.len());
    let at = starts.iter().filter_map(|start| at(start)).min()?;
    let (inside, _) = warning[at..].split_once(')')?;
    let mut numbers = inside.split(',').map(|n| n.trim().parse::<f64>());
    let mut next = || numbers.next()?.ok().filter(|v| v.is_finite());
    let place = [next()?, next()?, next()?];
    numbers.next().is_none().then_some(place)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn places_are_read_off_warnings() {
        for (text, expected) in [
            (
                "passed near (1.5e0, -2.000000e-3, 0) there",
                Some([1.5, -0.002, 0.0]),
            ),
            (
                "3 point(s), one of them at (1, 2, 3), passed",
                Some([1.0, 2.0, 3.0]),
            ),
            (
                "still moves at the end, at (1, 2, 3) in a unit of time",
                None,
            ),
            ("near (1, 2)", None),
            ("near (1, 2, 3, 4)", None),
            ("near (NaN, 2, 3)", None),
            ("near (1, 2, 3", None),
        ] {
            assert_eq!(place(text), expected, "{text}");
        }
    }
}
