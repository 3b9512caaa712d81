//! On which side of its loops a trimmed surface lies.

use super::edge::Edge;

/// On which side of every loop the surface lies: inside of loops that an even number of others surround, whatever their
/// direction.
pub(super) fn senses(edges: &[Edge], first: &[usize]) -> Vec<f64> {
    let polygons: Vec<Vec<[f64; 2]>> = first
        .windows(2)
        .map(|w| {
            let samples = |e: &Edge| e.samples[..e.samples.len() - 1].to_vec();
            let all = edges[w[0]..w[1]].iter().flat_map(samples);
            all.map(|s| s.xi).collect()
        })
        .collect();
    let next = |polygon: &[[f64; 2]], k: usize| polygon[(k + 1) % polygon.len()];
    let boxes: Vec<[[f64; 2]; 2]> = polygons.iter().map(|p| bounds_of(p)).collect();
    polygons
        .iter()
        .enumerate()
        .map(|(number, own)| {
            let origin = own[0];
            let area: f64 = (0..own.len())
                .map(|k| {
                    let ([x0, y0], [x1, y1]) = (own[k], next(own, k));
                    (x0 - origin[0]) * (y1 - origin[1]) - (x1 - origin[0]) * (y0 - origin[1])
                })
                .sum();
            let around = polygons
                .iter()
                .enumerate()
                .filter(|(other, polygon)| {
                    let (mine, theirs) = (&boxes[number], &boxes[*other]);
                    let apart =
                        (0..2).any(|k| mine[0][k] > theirs[1][k] || mine[1][k] < theirs[0][k]);
                    if *other == number || apart {
                        return false;
                    }
                    // Loops may touch, so the vertices vote.
                    let inside = own.iter().filter(|p| within(polygon, **p)).count();
                    2 * inside > own.len()
                })
                .count();
            if (area > 0.0) == (around % 2 == 0) {
                1.0
            } else {
                -1.0
            }
        })
        .collect()
}

/// Lowest and highest corner of a polygon.
fn bounds_of(polygon: &[[f64; 2]]) -> [[f64; 2]; 2] {
    let mut out = [[f64::INFINITY; 2], [f64::NEG_INFINITY; 2]];
    for p in polygon {
        for k in 0..2 {
            out[0][k] = out[0][k].min(p[k]);
            out[1][k] = out[1][k].max(p[k]);
        }
    }
    out
}

/// Whether a point lies in a polygon (even-odd rule).
fn within(polygon: &[[f64; 2]], p: [f64; 2]) -> bool {
    let mut inside = false;
    let mut before = polygon[polygon.len() - 1];
    for &now in polygon {
        if (now[1] > p[1]) != (before[1] > p[1]) {
            let x = now[0] + (p[1] - now[1]) * (before[0] - now[0]) / (before[1] - now[1]);
            inside ^= p[0] < x;
        }
        before = now;
    }
    inside
}
