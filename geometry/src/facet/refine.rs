//! Facets of smooth surfaces.

use crate::parallel::*;

use super::deviation::{Cell, deviation, shares};
use super::lines::{Lines, along, carry};
use super::{Bilinear, Biquadratic, FacetError, FacetMesh};
use crate::memory::available;
use crate::project::PatchSet;
use crate::surface::{Surface, Vec3};

/// How finely a surface is cut.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Refinement {
    /// That many facets in each direction of every span.
    PerSpan(u32),
    /// That many facets in each direction of every patch, shared among its spans by their lengths. A span is one facet at
    /// least, so a patch of more spans gets more.
    PerPatch([u32; 2]),
    /// Facets no longer than this (a length) along the lines of constant parameters that were measured, five in each span
    /// and direction.
    Size(f64),
    /// As many facets as keep them within this distance (a length) of the surface, and along the borders of patches within
    /// it of the border. A span is one facet at least.
    Chord(f64),
}

/// Which part of which patch a facet stands for.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FacetOrigin {
    /// Number of the patch.
    pub patch: u32,
    /// Its parameters: `[direction][start, end]`.
    pub domain: [[f64; 2]; 2],
    /// Whether xi1 of the facet runs along xi2 of the patch and the other way round, which makes `rho_1 x rho_2` of the facet
    /// point out of a patch whose own points in.
    pub swapped: bool,
}

/// A joint along which the nodes of the two sides are not the same.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Crack {
    /// Patch and edge number of both sides; of a T-joint the same edge twice.
    pub edges: [(u32, u32); 2],
    /// Facets along each of them.
    pub facets: [usize; 2],
}

/// Facets with an account of how they were made.
#[derive(Debug, Clone, PartialEq)]
pub struct Faceted<const N: usize> {
    /// The facets. Their nodes lie on the surface; along a joint on the edge of the patch with the lower number.
    pub mesh: FacetMesh<N>,
    /// Where each facet comes from.
    pub origin: Vec<FacetOrigin>,
    /// Largest distance of a facet from its patch, at 5 x 5 points of every facet, and at borders from the border.
    pub deviation: f64,
    /// Joints along which the facets of both sides do not share all nodes. Empty where the facets are as tight as the
    /// patches.
    pub cracks: Vec<Crack>,
    /// Facets left out because they have no area: both of two opposite edges, or two neighbouring ones, are points.
    pub dropped: usize,
}

/// More facets than this are refused.
pub(super) const LIMIT: usize = 4_000_000;

/// Bilinear facets of a set of patches.
///
/// Every patch is cut along lines of constant parameters. Lines go on in the neighbours, and both sides of a joint share
/// their nodes, so the facets are as tight as the patches; where that fails the joint is among the
/// [`cracks`](Faceted::cracks). An edge that is a point gives facets with two equal nodes there.
///
/// The distance from the surface falls with the square of the facets' size, the angle between the normals with
/// the size.
///
/// # Errors
/// Trimmed patches, useless numbers, joints open by more than half of the chord tolerance, more than four million facets.
pub fn bilinear_facets<S: Surface>(
    set: &PatchSet<S>,
    refinement: Refinement,
) -> Result<Faceted<4>, FacetError> {
    facets(set, refinement, |x, xi| Bilinear::jet_of(x, xi).rho)
}

/// Biquadratic facets of a set of patches: as [`bilinear_facets`], with nodes in the middles (of the parameters) too.
///
/// The distance from the surface falls with the third power of the facets' size (with the fourth where every middle
/// node is the middle of a circular arc), the angle between the normals with the second.
///
/// # Errors
/// As for [`bilinear_facets`].
pub fn biquadratic_facets<S: Surface>(
    set: &PatchSet<S>,
    refinement: Refinement,
) -> Result<Faceted<9>, FacetError> {
    facets(set, refinement, |x, xi| Biquadratic::jet_of(x, xi).rho)
}

/// The set of one patch, for the functions above: its seam and its poles are found.
///
/// # Errors
/// A patch without size.
pub fn facet_patch<S: Surface>(patch: S) -> Result<PatchSet<S>, FacetError> {
    Ok(PatchSet::new(vec![patch], None)?)
}

/// Facets per span: `[patch][direction][span]`.
type Counts = Vec<[Vec<usize>; 2]>;

fn facets<S: Surface, const N: usize>(
    set: &PatchSet<S>,
    refinement: Refinement,
    point: impl Fn(&[Vec3; N], [f64; 2]) -> Vec3 + Sync,
) -> Result<Faceted<N>, FacetError> {
    let patches = set.patches();
    if let Some(trimmed) = patches.iter().position(|p| p.trim().is_some()) {
        return Err(FacetError::Trimmed(trimmed));
    }
    let mut counts: Counts = (patches.iter())
        .map(|patch| super::counts::first(patch, refinement))
        .collect::<Result<_, _>>()?;
    let tolerance = match refinement {
        Refinement::Chord(tolerance) => Some(tolerance),
        _ => None,
    };
    if let Some(tolerance) = tolerance {
        // Shared nodes are off one of the two sides by the gap, however fine the facets.
        let gap = set.edges().largest_gap;
        if gap > 0.5 * tolerance {
            return Err(FacetError::Gap { gap, tolerance });
        }
    }
    let degree = if N == 4 { 1 } else { 2 };
    let most = LIMIT.min((available().bytes / bytes_of_facet::<N>()) as usize);
    let mut last = 0.0;
    loop {
        let too_many = FacetError::TooMany {
            limit: most,
            deviation: last,
            tolerance: tolerance.unwrap_or(0.0),
        };
        // Counted first: numbers alone must not fill the memory.
        if total(counts.iter().map(|c| c.each_ref().map(|c| c.iter().sum()))) > most {
            return Err(too_many);
        }
        let mut lines = lines_of(patches, &counts);
        carry(patches, &set.edges().joints, &mut lines, most);
        if total(lines.iter().map(|l| l.each_ref().map(Vec::len))) > most {
            return Err(too_many);
        }
        let (mut out, cells) = build::<S, N>(set, &lines, degree);
        let corners: Vec<[Vec3; N]> = out
            .mesh
            .facets
            .iter()
            .map(|f| f.map(|k| out.mesh.nodes[k as usize]))
            .collect();
        let found: Vec<f64> = (cells.par_iter().zip(&corners).zip(&out.origin))
            .map(|((cell, x), origin)| {
                let turn = |[r, s]: [f64; 2]| if origin.swapped { [s, r] } else { [r, s] };
                deviation(&patches[origin.patch as usize], cell, |xi| {
                    point(x, turn(xi))
                })
            })
            .collect();
        out.deviation = found.iter().copied().fold(0.0, f64::max);
        let Some(tolerance) = tolerance else {
            return Ok(out);
        };
        // Between the points measured it may be a little more.
        let allowed = 0.97 * tolerance;
        if out.deviation <= allowed {
            return Ok(out);
        }
        last = out.deviation;
        let wanted: Vec<_> = (cells.par_iter().zip(&found).zip(&out.origin))
            .filter(|((_, deviation), _)| **deviation > allowed)
            .map(|((cell, &deviation), origin)| {
                let patch = &patches[origin.patch as usize];
                let shares = shares(patch, cell, degree);
                (origin.patch, *cell, deviation, shares)
            })
            .collect();
        refine(patches, &mut counts, &wanted, allowed, degree);
    }
}

/// Bytes of a facet while it is made: nodes with their positions, its corners, cell, origin and distance.
const fn bytes_of_facet<const N: usize>() -> u64 {
    (N * (4 + 24 + 24) + 200) as u64
}

/// Facets of a grid of that many cells or lines per patch.
fn total(counts: impl Iterator<Item = [usize; 2]>) -> usize {
    counts.fold(0, |sum: usize, [a, b]| {
        sum.saturating_add(a.saturating_mul(b))
    })
}

/// Raises the counts of the spans in which cells are too far from the surface, in the direction that makes most of
/// the distance, or in both.
fn refine<S: Surface>(
    patches: &[S],
    counts: &mut Counts,
    wanted: &[(u32, Cell, f64, [f64; 2])],
    allowed: f64,
    degree: usize,
) {
    let before = counts.clone();
    for (patch, cell, deviation, shares) in wanted {
        let patch = *patch as usize;
        let larger = shares[0].max(shares[1]);
        // The best exponent of the rates is assumed, so that the count grows towards what is needed from below.
        let exponent = 0.5 / degree as f64;
        let factor = (deviation / allowed).powf(exponent);
        for dir in 0..2 {
            if shares[dir] < 0.6 * larger {
                continue;
            }
            let [a, b] = cell.domain[dir];
            let spans = patches[patch].spans(dir);
            let middle = 0.5 * (a + b);
            let span = spans
                .partition_point(|s| s[0] <= middle)
                .clamp(1, spans.len())
                - 1;
            let width = spans[span][1] - spans[span][0];
            let needed = (0.9 * factor * width / (b - a)).min(LIMIT as f64) as usize;
            let count = &mut counts[patch][dir][span];
            *count = (*count).max(needed).max(before[patch][dir][span] + 1);
        }
    }
}

/// Lines of the spans cut in equal parts.
fn lines_of<S: Surface>(patches: &[S], counts: &Counts) -> Lines {
    let one = |patch: &S, counts: &[Vec<usize>; 2], dir: usize| {
        let spans = patch.spans(dir);
        let [start, end] = patch.domain()[dir];
        let mut lines = vec![start];
        for ([a, b], &count) in spans.iter().zip(&counts[dir]) {
            lines.extend((1..count).map(|k| a + (b - a) * k as f64 / count as f64));
            lines.push(*b);
        }
        if let Some(last) = lines.last_mut() {
            *last = end;
        }
        lines
    };
    (patches.iter().zip(counts))
        .map(|(patch, counts)| [one(patch, counts, 0), one(patch, counts, 1)])
        .collect()
}

/// Nodes and facets of given lines, with the cell of each facet.
fn build<S: Surface, const N: usize>(
    set: &PatchSet<S>,
    lines: &Lines,
    degree: usize,
) -> (Faceted<N>, Vec<Cell>) {
    let patches = set.patches();
    // Parameters of the nodes: the lines, and the middles between them for degree 2.
    let places: Lines = lines
        .iter()
        .map(|lines| {
            lines.each_ref().map(|lines| {
                let mut out = vec![lines[0]];
                for pair in lines.windows(2) {
                    if degree == 2 {
                        out.push(0.5 * (pair[0] + pair[1]));
                    }
                    out.push(pair[1]);
                }
                out
            })
        })
        .collect();
    let mut offset = vec![0];
    for place in &places {
        offset.push(offset[offset.len() - 1] + (place[0].len() * place[1].len()) as u32);
    }
    let mut parent: Vec<u32> = (0..offset[patches.len()]).collect();
    // Number of node `k` of an edge.
    let node = |(patch, edge): (u32, u32), k: usize| {
        let [n1, n2] = places[patch as usize].each_ref().map(Vec::len);
        let end = (edge % 2) as usize;
        let [i, j] = match along(edge) {
            1 => [end * (n1 - 1), k],
            _ => [k, end * (n2 - 1)],
        };
        offset[patch as usize] + (i + n1 * j) as u32
    };
    let nodes_on = |(patch, edge): (u32, u32)| places[patch as usize][along(edge)].len();
    let mut cracks = Vec::new();
    for joint in &set.edges().joints {
        let counts = joint.edges.map(nodes_on);
        let last = counts[1] - 1;
        let turn = |k: usize| if joint.reversed { last - k } else { k };
        let tight = counts[0] == counts[1];
        if !tight {
            cracks.push(Crack {
                edges: joint.edges,
                facets: counts.map(|n| (n - 1) / degree),
            });
        }
        let ends = [[0, 0], [counts[0] - 1, last]];
        let all = (0..counts[0]).map(|k| [k, k]);
        let pairs: Vec<[usize; 2]> = if tight { all.collect() } else { ends.to_vec() };
        for [k, l] in pairs {
            let (a, b) = (node(joint.edges[0], k), node(joint.edges[1], turn(l)));
            join(&mut parent, a, b);
        }
    }
    for partial in &set.edges().partial {
        let count = (nodes_on(partial.edge) - 1) / degree;
        cracks.push(Crack {
            edges: [partial.edge; 2],
            facets: [count; 2],
        });
    }
    for &pole in &set.edges().poles {
        for k in 1..nodes_on(pole) {
            join(&mut parent, node(pole, 0), node(pole, k));
        }
    }
    // Roots are the lowest of their group, so they are numbered before the others ask for them.
    let mut number = vec![u32::MAX; parent.len()];
    let mut nodes = Vec::new();
    for (patch, place) in places.iter().enumerate() {
        let columns = place[0].len();
        for k in 0..columns * place[1].len() {
            let own = offset[patch] + k as u32;
            let root = root(&mut parent, own);
            if root == own {
                number[own as usize] = nodes.len() as u32;
                let xi = [place[0][k % columns], place[1][k / columns]];
                nodes.push(patches[patch].point(xi));
            } else {
                number[own as usize] = number[root as usize];
            }
        }
    }
    let mut out = Faceted {
        mesh: FacetMesh {
            nodes,
            facets: Vec::new(),
        },
        origin: Vec::new(),
        deviation: 0.0,
        cracks,
        dropped: 0,
    };
    let mut cells = Vec::new();
    for (patch, lines) in lines.iter().enumerate() {
        let columns = places[patch][0].len();
        let swapped = set.sides()[patch] < 0.0;
        let last = lines.each_ref().map(|l| l.len() - 2);
        for j in 0..=last[1] {
            for i in 0..=last[0] {
                let facet: [u32; N] = std::array::from_fn(|k| {
                    let (a, b) = (k % (degree + 1), k / (degree + 1));
                    let [a, b] = if swapped { [b, a] } else { [a, b] };
                    let at = offset[patch] as usize + i * degree + a + columns * (j * degree + b);
                    number[at]
                });
                let corners = [0, degree, N - 1 - degree, N - 1].map(|k| facet[k]);
                if distinct(corners) < 3 {
                    out.dropped += 1;
                    continue;
                }
                let place = [i, j];
                let domain = [0, 1].map(|k| [lines[k][place[k]], lines[k][place[k] + 1]]);
                out.mesh.facets.push(facet);
                out.origin.push(FacetOrigin {
                    patch: patch as u32,
                    domain,
                    swapped,
                });
                cells.push(Cell {
                    domain,
                    border: [0, 1].map(|k| [place[k] == 0, place[k] == last[k]]),
                });
            }
        }
    }
    (out, cells)
}

fn distinct(mut numbers: [u32; 4]) -> usize {
    numbers.sort_unstable();
    1 + numbers.windows(2).filter(|w| w[0] != w[1]).count()
}

fn root(parent: &mut [u32], mut k: u32) -> u32 {
    while parent[k as usize] != k {
        let next = parent[parent[k as usize] as usize];
        parent[k as usize] = next;
        k = next;
    }
    k
}

/// Makes two nodes one; the lower number stays.
fn join(parent: &mut [u32], a: u32, b: u32) {
    let (a, b) = (root(parent, a), root(parent, b));
    parent[a.max(b) as usize] = a.min(b);
}
