//! What the linearisations of an attempt say of how it goes on: relative residuals and points whose status changed.

/// Points left to switch where an attempt is nearly done, and the iterations over which their number has to fall where more are left.
const LEFT: usize = 2;
const OVER: usize = 4;
/// Iteration from which on a residual that is more than this part of the one before it makes points keep their facets: those
/// that hop to and fro across a fold leave it where it is, and what is far from equilibrium may well hop.
const KEEP: usize = 3;
const HOPS: f64 = 0.3;
/// Longest period of residuals that come back that is looked for, and the part of them by which they may differ.
const LONGEST: usize = 4;
const SAME: f64 = 0.02;

/// Whether an attempt is nearly done: few points are left to switch, or ever fewer. One that switches none has no more reason
/// to go on than its iterations give.
pub fn nearly(history: &[(f64, usize)]) -> bool {
    let most = |from: usize, to: usize| {
        let range = history.len().saturating_sub(from)..history.len().saturating_sub(to);
        history[range].iter().map(|h| h.1).max().unwrap_or(0)
    };
    let now = most(OVER, 0);
    now > 0 && (now <= LEFT || now < most(2 * OVER, OVER))
}

/// Whether points may be hopping from facet to facet: the residual does not fall as it would near a solution.
pub fn hops(history: &[(f64, usize)]) -> bool {
    match history {
        [.., (before, _), (now, _)] => history.len() > KEEP && *now > HOPS * before,
        _ => false,
    }
}

/// The number of iterations after which residuals are as they were, where none of them switched a point: iterates that go round
/// a kink of the forces that no status tells of, at the rounded border of a surface or where feet go from facet to facet.
pub fn round(history: &[(f64, usize)]) -> Option<u32> {
    (2..=LONGEST).find_map(|period| {
        let last = &history[history.len().checked_sub(2 * period)?..];
        let (before, now) = last.split_at(period);
        let same = |(a, b): (&(f64, usize), &(f64, usize))| {
            a.1 == 0 && b.1 == 0 && (a.0 - b.0).abs() < SAME * a.0
        };
        before.iter().zip(now).all(same).then_some(period as u32)
    })
}

/// A word on points that keep switching at the end of a failed step.
pub fn oscillation(history: &[(f64, usize)]) -> String {
    let last = &history[history.len().saturating_sub(6)..];
    let switching = last.iter().map(|h| h.1).min().unwrap_or(0);
    if last.len() == 6 && switching > 0 {
        format!("; at least {switching} contact point(s) switched status in each of the last 6")
    } else {
        String::new()
    }
}

#[cfg(test)]
mod tests {
    use super::round;

    #[test]
    fn residuals_that_come_back_are_a_round() {
        let seen = |residuals: &[f64], switched: usize| {
            let history: Vec<_> = residuals.iter().map(|r| (*r, switched)).collect();
            round(&history)
        };
        assert_eq!(seen(&[5.0, 0.92, 4.09, 0.921, 4.091], 0), Some(2));
        assert_eq!(seen(&[3.0, 2.0, 1.0, 3.0, 2.0, 1.0], 0), Some(3));
        assert_eq!(
            seen(&[4.0, 1.0, 4.0, 1.0], 1),
            None,
            "points that switch are told by their sets"
        );
        assert_eq!(seen(&[4.0, 1.0, 3.0, 0.9], 0), None, "it falls");
        assert_eq!(seen(&[4.0, 1.0, 4.0], 0), None);
    }
}
