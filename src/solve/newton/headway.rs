//! What the linearisations of an attempt say of how it goes on: relative residuals and points whose status changed.

/// Points left to switch where an attempt is nearly done, and the iterations over which their number has to fall where more are left.
const LEFT: usize = 2;
const OVER: usize = 4;
/// Iteration from which on a residual that is more than this part of the one before it makes points keep their facets: those
/// that hop to and fro across a fold leave it where it is, and what is far from equilibrium may well hop.
const KEEP: usize = 3;
const HOPS: f64 = 0.3;

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
