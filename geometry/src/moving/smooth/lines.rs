//! Strips of facets, and the knot intervals across them.

use super::{GRAIN, Mesh};

/// Opposite edges of a facet have the same interval, so that it is the same all along a strip of facets: the mean length of the
/// edges (as a mean of logarithms). Logarithms in units of [`GRAIN`], by edge.
pub(super) fn intervals(mesh: &Mesh) -> Vec<i64> {
    let topology = &mesh.topology;
    let mut parent: Vec<u32> = (0..topology.edge_count() as u32).collect();
    for facet in 0..topology.facet_count() as u32 {
        for [a, b] in [[0, 1], [2, 3]] {
            if let (Some(a), Some(b)) = (topology.edge(facet, a), topology.edge(facet, b)) {
                let (a, b) = (root(&mut parent, a), root(&mut parent, b));
                parent[a.max(b) as usize] = a.min(b);
            }
        }
    }
    let mut sums = vec![(0.0, 0.0); parent.len()];
    for edge in 0..parent.len() as u32 {
        let Some(&(facet, k)) = topology.edge_members(edge).first() else {
            continue;
        };
        let [a, b] = mesh.ends(facet, k as usize);
        let length = (mesh.point(a) - mesh.point(b)).norm();
        if length > 0.0 {
            let sum = &mut sums[root(&mut parent, edge) as usize];
            *sum = (sum.0 + length.ln(), sum.1 + 1.0);
        }
    }
    (0..parent.len() as u32)
        .map(|edge| {
            let (sum, count) = sums[root(&mut parent, edge) as usize];
            (sum / f64::max(count, 1.0) / GRAIN).round() as i64
        })
        .collect()
}

fn root(parent: &mut [u32], mut k: u32) -> u32 {
    while parent[k as usize] != k {
        let next = parent[parent[k as usize] as usize];
        parent[k as usize] = next;
        k = next;
    }
    k
}

/// Factors of the nodes before, at and behind a node for the derivative of the parabola through them, for a parameter that
/// grows by 1 from the node to the one behind; `ratio` of the interval before over the one behind.
pub(super) fn central(ratio: f64) -> [f64; 3] {
    let (ahead, back) = (ratio / (1.0 + ratio), 1.0 / (ratio * (1.0 + ratio)));
    [-back, back - ahead, ahead]
}

/// The same at the first of three nodes, for a parameter that grows by 1 to the second; `ratio` of the second interval over
/// the first.
pub(super) fn one_sided(ratio: f64) -> [f64; 3] {
    let (ahead, back) = (1.0 / (ratio * (1.0 + ratio)), ratio / (1.0 + ratio));
    // 2 (x_1 - x_0) less the derivative at the second node.
    [back - 2.0, 2.0 - back + ahead, -ahead]
}
