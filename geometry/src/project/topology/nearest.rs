//! The nearest point of an edge.

use super::super::piece::box_distance2;
use super::super::set::PatchSet;
use super::edge::{BLOCK, Edge, EdgePoint, Sample, edge_point};
use crate::surface::{Surface, Vec3};

/// Most steps of the iteration, and halvings of one step.
const ITERATIONS: usize = 30;
const HALVINGS: usize = 12;
/// Blocks of an edge whose distances are kept while the nearest chord is looked for.
const KEPT: usize = 64;
/// Steps shorter than this share of the size are not halved.
const SHORT: f64 = 1e-9;

/// Nearest point of an edge to `q`: the nearest chord of the polyline gives the start of a safeguarded Newton iteration
/// along the edge.
pub(crate) fn nearest_on_edge<S: Surface>(set: &PatchSet<S>, q: &Vec3, edge: &Edge) -> EdgePoint {
    let mut best = (f64::INFINITY, edge.interval[0]);
    if edge.blocks.is_empty() {
        nearest_chord(q, &edge.samples, &mut best);
        return nearest_from(set, q, edge, best.1);
    }
    // The nearest block first: its chords leave few other blocks to look at. Distances of the first blocks are kept.
    let far = |k: usize| box_distance2(q, &edge.blocks[k][0], &edge.blocks[k][1]);
    let chords = |k: usize| {
        let end = ((k + 1) * BLOCK + 1).min(edge.samples.len());
        &edge.samples[k * BLOCK..end]
    };
    let count = edge.blocks.len();
    let mut kept = [0.0; KEPT];
    let mut nearest = (f64::INFINITY, 0);
    for k in 0..count {
        let distance2 = far(k);
        if let Some(kept) = kept.get_mut(k) {
            *kept = distance2;
        }
        if distance2 < nearest.0 {
            nearest = (distance2, k);
        }
    }
    let first = nearest.1;
    nearest_chord(q, chords(first), &mut best);
    for k in (0..count).filter(|&k| k != first) {
        if kept.get(k).map_or_else(|| far(k), |&distance2| distance2) < best.0 {
            nearest_chord(q, chords(k), &mut best);
        }
    }
    nearest_from(set, q, edge, best.1)
}

/// Takes a chord that is nearer to `q` than the best one: its squared distance and the parameter of its nearest point.
fn nearest_chord(q: &Vec3, samples: &[Sample], best: &mut (f64, f64)) {
    for pair in samples.windows(2) {
        let chord = pair[1].point - pair[0].point;
        let along = (q - pair[0].point).dot(&chord) / chord.norm_squared();
        let s = if along.is_finite() {
            along.clamp(0.0, 1.0)
        } else {
            0.0
        };
        let d2 = (pair[0].point + chord * s - q).norm_squared();
        if d2 < best.0 {
            *best = (d2, pair[0].t + s * (pair[1].t - pair[0].t));
        }
    }
}

fn nearest_from<S: Surface>(set: &PatchSet<S>, q: &Vec3, edge: &Edge, start: f64) -> EdgePoint {
    let [low, high] = edge.interval;
    let mut now = edge_point(set, edge, start.clamp(low, high));
    let mut d2 = (q - now.jet.rho).norm_squared();
    for _ in 0..ITERATIONS {
        let d = now.jet.rho - q;
        let a = now.d1.norm_squared();
        let slope = d.dot(&now.d1);
        let bend = a + d.dot(&now.d2);
        let f = if bend > 0.1 * a { bend } else { a };
        if f <= 0.0 || slope * slope <= 1e-32 * a * (d2 + set.size * set.size) {
            break;
        }
        let mut step = -slope / f;
        let mut better = None;
        // A step this short that leads no nearer is lost in rounding, and so are its parts.
        let short = SHORT * set.size;
        let halvings = if step * step * a <= short * short {
            1
        } else {
            HALVINGS
        };
        for _ in 0..halvings {
            let t = (now.t + step).clamp(low, high);
            if t == now.t {
                break;
            }
            let next = edge_point(set, edge, t);
            let next2 = (q - next.jet.rho).norm_squared();
            if next2 < d2 {
                better = Some((next, next2));
                break;
            }
            step *= 0.5;
        }
        let Some((next, next2)) = better else {
            break;
        };
        (now, d2) = (next, next2);
    }
    now
}
