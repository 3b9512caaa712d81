//! The lines along which patches are cut, and how they go on in the neighbours.

use crate::project::Joint;
use crate::surface::{Surface, Vec3};

/// Parameters of the lines of every patch: `[patch][direction]`, ascending, ends included.
pub(super) type Lines = Vec<[Vec<f64>; 2]>;

/// A line of one patch that meets a joint is the one that the neighbour has there if they are nearer than this share of the
/// neighbour's distance between lines.
const SAME: f64 = 0.3;

/// Rounds in which lines are carried over joints. A line that comes back displaced after a way round several patches is
/// taken for the one that set out, so few are needed.
const ROUNDS: usize = 16;

/// The direction in which an edge runs.
pub(super) fn along(edge: u32) -> usize {
    1 - (edge as usize / 2).min(1)
}

/// Adds to both patches at every joint the lines that only the other one has, again and again until nothing is new or
/// there are more than `limit` lines. Joints whose ends differ in the number of lines afterwards are not closed.
pub(super) fn carry<S: Surface>(patches: &[S], joints: &[Joint], lines: &mut Lines, limit: usize) {
    for _ in 0..ROUNDS {
        let mut changed = false;
        for joint in joints {
            for (from, to) in [(0, 1), (1, 0)] {
                changed |= carry_one(patches, joint, from, to, lines);
            }
        }
        let total: usize = lines.iter().map(|l| l[0].len() + l[1].len()).sum();
        if !changed || total > limit {
            return;
        }
    }
}

fn carry_one<S: Surface>(
    patches: &[S],
    joint: &Joint,
    from: usize,
    to: usize,
    lines: &mut Lines,
) -> bool {
    let (patch, edge) = joint.edges[from];
    let (other, other_edge) = joint.edges[to];
    let (Some(own), Some(theirs)) = (patches.get(patch as usize), patches.get(other as usize))
    else {
        return false;
    };
    let source = &lines[patch as usize][along(edge)];
    let target = &lines[other as usize][along(other_edge)];
    if source.len() < 3 {
        return false;
    }
    let [a, b] = own.domain()[along(edge)];
    let [c, d] = theirs.domain()[along(other_edge)];
    let mut mapped: Vec<f64> = source[1..source.len() - 1]
        .iter()
        .map(|&t| {
            let share = (t - a) / (b - a);
            let share = if joint.reversed { 1.0 - share } else { share };
            let point = own.point(on_edge(own, edge, t));
            nearest(theirs, other_edge, &point, c + share * (d - c))
        })
        .collect();
    mapped.sort_by(f64::total_cmp);
    // For every line of the target the mapped one nearest to it.
    let mut claimed: Vec<Option<(f64, usize)>> = vec![None; target.len()];
    for (k, &t) in mapped.iter().enumerate() {
        let after = target
            .partition_point(|&x| x < t)
            .clamp(1, target.len() - 1);
        let near = if t - target[after - 1] < target[after] - t {
            after - 1
        } else {
            after
        };
        let gap = target[after] - target[after - 1];
        let distance = (t - target[near]).abs();
        let inner = near > 0 && near + 1 < target.len();
        let same = if inner { SAME * gap } else { 1e-9 * (d - c) };
        if distance <= same && claimed[near].is_none_or(|c| distance < c.0) {
            claimed[near] = Some((distance, k));
        }
    }
    let mut is_old = vec![false; mapped.len()];
    for (_, k) in claimed.into_iter().flatten() {
        is_old[k] = true;
    }
    let new: Vec<f64> = mapped
        .iter()
        .zip(&is_old)
        .filter(|(t, old)| !**old && **t > c && **t < d)
        .map(|(t, _)| *t)
        .collect();
    if new.is_empty() {
        return false;
    }
    let target = &mut lines[other as usize][along(other_edge)];
    let before = target.len();
    target.extend(new);
    target.sort_by(f64::total_cmp);
    // Two lines in one place would make facets of no size.
    target.dedup_by(|x, y| (*x - *y).abs() <= 1e-9 * (d - c));
    target.len() > before
}

/// Parameters of the point `t` of an edge.
pub(super) fn on_edge<S: Surface>(patch: &S, edge: u32, t: f64) -> [f64; 2] {
    let domain = patch.domain();
    let fixed = 1 - along(edge);
    let mut xi = [t; 2];
    xi[fixed] = domain[fixed][(edge % 2) as usize];
    xi
}

/// Parameter of the point of an edge that is nearest to `p`, from the best of `guess` and some points of every span.
fn nearest<S: Surface>(patch: &S, edge: u32, p: &Vec3, guess: f64) -> f64 {
    let dir = along(edge);
    let [low, high] = patch.domain()[dir];
    let value = |t: f64| (patch.point(on_edge(patch, edge, t)) - p).norm_squared();
    let mut best = (value(guess), guess);
    for [a, b] in patch.spans(dir) {
        for k in 0..=4 {
            let t = a + (b - a) * f64::from(k) / 4.0;
            let now = value(t);
            if now < best.0 {
                best = (now, t);
            }
        }
    }
    for _ in 0..20 {
        let jet = patch.jet(on_edge(patch, edge, best.1));
        let metric = jet.rho_i[dir].norm_squared();
        if metric <= 0.0 {
            break;
        }
        let step = jet.rho_i[dir].dot(&(p - jet.rho)) / metric;
        let t = (best.1 + step).clamp(low, high);
        let now = value(t);
        if now >= best.0 {
            break;
        }
        best = (now, t);
    }
    best.1
}
