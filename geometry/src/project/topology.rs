//! Common edges of patches: geometric matching, components and consistent orientation.

use super::EdgeKind;
use super::local::{Local, Region};
use super::set::{PatchSet, PatchSetError, SHARP_ANGLE};
use crate::frame::Frame;
use crate::surface::{Surface, Vec3};

/// Points of an edge that are compared with other edges; a contact shorter than one of the intervals may be missed.
const SAMPLES: usize = 13;

/// A whole edge of one patch that coincides with a whole edge of another patch (or of the same patch: a seam).
#[derive(Debug, Clone, PartialEq)]
pub struct Joint {
    /// Patch and edge number of both sides; edge 0 is xi1 = start, 1 is xi1 = end, 2 is xi2 = start, 3 is xi2 = end.
    pub edges: [(u32, u32); 2],
    /// Smooth or sharp.
    pub kind: EdgeKind,
    /// Largest angle between the normals at the points compared (radians).
    pub angle: f64,
    /// Largest distance at the points compared.
    pub gap: f64,
    /// Whether the free parameters of the two edges run against each other.
    pub reversed: bool,
}

/// An edge of which only a part coincides with an edge of another patch, or with several edges (a T-joint).
#[derive(Debug, Clone, PartialEq)]
pub struct PartialJoint {
    /// Patch and number of the edge.
    pub edge: (u32, u32),
    /// Patches and edges that parts of it coincide with.
    pub others: Vec<(u32, u32)>,
    /// Share of the points compared that lie on other edges. Where it is 1 the edge counts as joined, else as free.
    pub share: f64,
}

/// What was found about edges.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct EdgeReport {
    /// Whole edges joined in pairs.
    pub joints: Vec<Joint>,
    /// Edges that coincide with others in part.
    pub partial: Vec<PartialJoint>,
    /// Free edges: patch and number.
    pub free: Vec<(u32, u32)>,
    /// Edges that are one point in space.
    pub poles: Vec<(u32, u32)>,
    /// Edges at which more than two patches meet; the nearest pair is joined and orients the surface.
    pub branching: Vec<(u32, u32)>,
    /// Joints across which the surface is smooth.
    pub smooth: usize,
    /// Joints at an angle.
    pub sharp: usize,
    /// Largest gap over all joints.
    pub largest_gap: f64,
    /// The tolerance that edges were joined with.
    pub tolerance: f64,
}

/// The other side of an edge, or of a part of it.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Link {
    pub patch: u32,
    pub edge: u32,
    /// Side of the other patch over the side of this one.
    pub relation: f64,
}

/// State of one edge.
#[derive(Debug, Clone, Default)]
pub(super) struct Edge {
    /// `None` for a pole.
    pub kind: Option<EdgeKind>,
    pub links: Vec<Link>,
}

#[derive(Debug, Clone, Default)]
pub(super) struct Topology {
    pub edges: Vec<[Edge; 4]>,
    /// Patches that meet at the same point with a corner: patch and corner number.
    pub corner_groups: Vec<Vec<(u32, u32)>>,
    /// Number of the group of every corner.
    pub corners: Vec<[u32; 4]>,
    /// Patches of every connected component.
    pub components: Vec<Vec<usize>>,
    pub component_of: Vec<usize>,
    pub report: EdgeReport,
}

/// Sense in which an edge runs when the boundary of the patch is walked with the patch on the left, by edge number.
const SENSE: [f64; 4] = [-1.0, 1.0, 1.0, -1.0];

/// Sampled edge.
struct Samples {
    points: [Vec3; SAMPLES],
    tangents: [Vec3; SAMPLES],
    normals: [Option<Vec3>; SAMPLES],
    low: Vec3,
    high: Vec3,
    length: f64,
}

/// One edge against another one.
struct Contact {
    covered: [bool; SAMPLES],
    gap: f64,
    /// Sum of the signs of tangent products.
    sense: f64,
    /// Largest angle of normals, with the other normal taken as it is and reversed.
    angles: [f64; 2],
}

/// Finds edges, joints, components and sides of a set whose patches and tree are complete.
pub(super) fn build<S: Surface>(
    set: &mut PatchSet<S>,
    tolerance: Option<f64>,
) -> Result<(), PatchSetError> {
    let count = set.patches.len();
    let samples: Vec<Samples> = (0..4 * count).map(|k| sample(set, k / 4, k % 4)).collect();
    let pole_limit = 1e-7 * set.size;
    let pole: Vec<bool> = samples
        .iter()
        .map(|s| (s.high - s.low).norm() <= pole_limit.max(tolerance.unwrap_or(0.0)))
        .collect();
    let shortest = samples
        .iter()
        .zip(&pole)
        .filter(|(_, pole)| !**pole)
        .map(|(s, _)| s.length)
        .fold(f64::INFINITY, f64::min);
    set.tolerance = tolerance.unwrap_or_else(|| (1e-5 * set.size).min(1e-2 * shortest));

    let mut found = Found {
        links: vec![Vec::new(); 4 * count],
        covered: vec![[false; SAMPLES]; 4 * count],
        partial: vec![Vec::new(); 4 * count],
        joints: Vec::new(),
    };
    pair_edges(set, &samples, &pole, &mut found);
    let mut report = EdgeReport {
        tolerance: set.tolerance,
        ..EdgeReport::default()
    };
    let edges = classify(&samples, &pole, found, &mut report);
    let (components, component_of) = orient(&edges, &mut set.sides)?;
    let (corner_groups, corners) = corner_groups(set);
    set.topology = Topology {
        edges,
        corner_groups,
        corners,
        components,
        component_of,
        report,
    };
    Ok(())
}

/// The region that an edge is: one parameter fixed.
pub(super) fn edge_region<S: Surface>(set: &PatchSet<S>, patch: u32, edge: u32) -> Region {
    let grid = &set.grids[patch as usize];
    let (dir, end) = ((edge / 2) as usize, (edge % 2) as usize);
    let mut domain = [0, 1].map(|k| [grid.breaks[k][0], grid.breaks[k][grid.spans[k]]]);
    domain[dir] = [domain[dir][end]; 2];
    Region {
        patch,
        spans: grid.spans.map(|n| [0, n]),
        domain,
    }
}

/// Nearest point of an edge, from several starts in every span.
pub(super) fn nearest_on_edge<S: Surface>(
    set: &PatchSet<S>,
    q: &Vec3,
    patch: u32,
    edge: u32,
) -> Local {
    let region = edge_region(set, patch, edge);
    let along = 1 - (edge / 2) as usize;
    let grid = &set.grids[patch as usize];
    let start_xi = [region.domain[0][0], region.domain[1][0]];
    // The nearest of some points, then one iteration in its span and the neighbours.
    let mut best = (f64::INFINITY, start_xi, [0, 0]);
    for span in 0..grid.spans[along] {
        let [a, b] = [grid.breaks[along][span], grid.breaks[along][span + 1]];
        for step in 0..=4 {
            let mut xi = start_xi;
            xi[along] = a + (b - a) * f64::from(step) / 4.0;
            let mut spans = [0, 1].map(|k| {
                if region.domain[k][0] == grid.breaks[k][0] {
                    0
                } else {
                    grid.spans[k] - 1
                }
            });
            spans[along] = span;
            let d2 = (set.patches[patch as usize].jet_in_span(spans, xi).rho - q).norm_squared();
            if d2 < best.0 {
                best = (d2, xi, spans);
            }
        }
    }
    set.polish(q, set.state(q, &region, best.1, best.2))
}

fn sample<S: Surface>(set: &PatchSet<S>, patch: usize, edge: usize) -> Samples {
    let region = edge_region(set, patch as u32, edge as u32);
    let along = 1 - edge / 2;
    let mut out = Samples {
        points: [Vec3::zeros(); SAMPLES],
        tangents: [Vec3::zeros(); SAMPLES],
        normals: [None; SAMPLES],
        low: Vec3::from_element(f64::INFINITY),
        high: Vec3::from_element(f64::NEG_INFINITY),
        length: 0.0,
    };
    for k in 0..SAMPLES {
        let mut xi = [region.domain[0][0], region.domain[1][0]];
        let [a, b] = region.domain[along];
        xi[along] = a + (b - a) * k as f64 / (SAMPLES - 1) as f64;
        let jet = set.patches[patch].jet(xi);
        out.points[k] = jet.rho;
        out.tangents[k] = jet.rho_i[along];
        out.normals[k] = Frame::new(&jet, 1.0).map(|f| f.n);
        out.low = out.low.inf(&jet.rho);
        out.high = out.high.sup(&jet.rho);
        if k > 0 {
            out.length += (jet.rho - out.points[k - 1]).norm();
        }
    }
    out
}

struct Found {
    links: Vec<Vec<Link>>,
    covered: Vec<[bool; SAMPLES]>,
    /// Edges that cover a part: edge, contact sharp or smooth, link.
    partial: Vec<Vec<(usize, EdgeKind, Link)>>,
    joints: Vec<Joint>,
}

fn pair_edges<S: Surface>(
    set: &PatchSet<S>,
    samples: &[Samples],
    pole: &[bool],
    found: &mut Found,
) {
    // Boxes grow by a tenth of the length: more than an arc bulges between samples. Sweep along x so that far edges are never compared.
    let mut order: Vec<usize> = (0..samples.len()).filter(|&k| !pole[k]).collect();
    let grown = |k: usize| {
        let s = &samples[k];
        let grow = Vec3::from_element(0.1 * s.length + set.tolerance);
        [s.low - grow, s.high + grow]
    };
    let boxes: Vec<[Vec3; 2]> = (0..samples.len()).map(grown).collect();
    order.sort_by(|&a, &b| boxes[a][0].x.total_cmp(&boxes[b][0].x).then(a.cmp(&b)));
    let mut whole: Vec<Joint> = Vec::new();
    for (place, &first) in order.iter().enumerate() {
        for &second in &order[place + 1..] {
            if boxes[second][0].x > boxes[first][1].x {
                break;
            }
            let overlap = (1..3).all(|k| {
                boxes[first][0][k] <= boxes[second][1][k]
                    && boxes[second][0][k] <= boxes[first][1][k]
            });
            if overlap {
                compare(
                    set,
                    samples,
                    (first.min(second), first.max(second)),
                    found,
                    &mut whole,
                );
            }
        }
    }
    // Nearest pairs first; an edge is joined as a whole once.
    whole.sort_by(|a, b| a.gap.total_cmp(&b.gap).then(a.edges.cmp(&b.edges)));
    found.joints = whole;
}

fn compare<S: Surface>(
    set: &PatchSet<S>,
    samples: &[Samples],
    (a, b): (usize, usize),
    found: &mut Found,
    whole: &mut Vec<Joint>,
) {
    let ab = contact(set, &samples[a], &samples[b], b);
    let ba = contact(set, &samples[b], &samples[a], a);
    // Edges that only touch at a point share one sample at most.
    let touches = |c: &Contact| c.covered.iter().filter(|&&x| x).count() < 2;
    if touches(&ab) && touches(&ba) {
        return;
    }
    let sense = if ab.sense + ba.sense >= 0.0 {
        1.0
    } else {
        -1.0
    };
    let relation = -SENSE[a % 4] * SENSE[b % 4] * sense;
    let angle = if relation > 0.0 {
        ab.angles[0].max(ba.angles[0])
    } else {
        ab.angles[1].max(ba.angles[1])
    };
    let kind = if angle > SHARP_ANGLE {
        EdgeKind::Sharp
    } else {
        EdgeKind::Smooth
    };
    let all = |c: &Contact| c.covered.iter().all(|&x| x);
    let name = |k: usize| ((k / 4) as u32, (k % 4) as u32);
    if all(&ab) && all(&ba) {
        whole.push(Joint {
            edges: [name(a), name(b)],
            kind,
            angle,
            gap: ab.gap.max(ba.gap),
            reversed: sense < 0.0,
        });
    } else {
        for (one, other, c) in [(a, b, &ab), (b, a, &ba)] {
            let (patch, edge) = name(other);
            let link = Link {
                patch,
                edge,
                relation,
            };
            if c.covered.iter().any(|&x| x) {
                found.partial[one].push((other, kind, link));
                for (sum, x) in found.covered[one].iter_mut().zip(c.covered) {
                    *sum |= x;
                }
            }
        }
    }
}

/// Which samples of one edge lie on another one.
fn contact<S: Surface>(
    set: &PatchSet<S>,
    one: &Samples,
    other: &Samples,
    number: usize,
) -> Contact {
    let mut out = Contact {
        covered: [false; SAMPLES],
        gap: 0.0,
        sense: 0.0,
        angles: [0.0; 2],
    };
    let along = 1 - number % 4 / 2;
    let grow = Vec3::from_element(0.1 * other.length + set.tolerance);
    for k in 0..SAMPLES {
        let p = &one.points[k];
        if super::piece::box_distance2(p, &(other.low - grow), &(other.high + grow)) > 0.0 {
            continue;
        }
        let local = nearest_on_edge(set, p, (number / 4) as u32, (number % 4) as u32);
        let distance = local.d2.sqrt();
        if distance > set.tolerance {
            continue;
        }
        // Edges that cross are no joint.
        let (t, u) = (&one.tangents[k], &local.jet.rho_i[along]);
        let product = t.dot(u);
        if product.abs() < 0.9 * t.norm() * u.norm() {
            continue;
        }
        out.covered[k] = true;
        out.gap = out.gap.max(distance);
        if product != 0.0 {
            out.sense += product.signum();
        }
        if let (Some(n), Some(frame)) = (one.normals[k], Frame::new(&local.jet, 1.0)) {
            let angle = n.cross(&frame.n).norm().atan2(n.dot(&frame.n));
            out.angles[0] = out.angles[0].max(angle);
            out.angles[1] = out.angles[1].max(std::f64::consts::PI - angle);
        }
    }
    out
}

/// Decides what every edge is.
fn classify(
    samples: &[Samples],
    pole: &[bool],
    mut found: Found,
    report: &mut EdgeReport,
) -> Vec<[Edge; 4]> {
    let name = |k: usize| ((k / 4) as u32, (k % 4) as u32);
    let mut kinds: Vec<Option<EdgeKind>> = vec![None; samples.len()];
    for joint in std::mem::take(&mut found.joints) {
        let [a, b] = joint.edges.map(|(p, e)| 4 * p as usize + e as usize);
        if kinds[a].is_some() || kinds[b].is_some() {
            for k in [a, b] {
                if !report.branching.contains(&name(k)) {
                    report.branching.push(name(k));
                }
            }
            // What it is called is settled; what lies on the other side is not.
            for k in [a, b] {
                kinds[k].get_or_insert(EdgeKind::Sharp);
            }
            continue;
        }
        let sense = if joint.reversed { -1.0 } else { 1.0 };
        let relation = -SENSE[a % 4] * SENSE[b % 4] * sense;
        for (k, other) in [(a, b), (b, a)] {
            kinds[k] = Some(joint.kind);
            let (patch, edge) = name(other);
            found.links[k].push(Link {
                patch,
                edge,
                relation,
            });
        }
        match joint.kind {
            EdgeKind::Smooth => report.smooth += 1,
            _ => report.sharp += 1,
        }
        report.largest_gap = report.largest_gap.max(joint.gap);
        report.joints.push(joint);
    }
    for k in 0..samples.len() {
        if pole[k] {
            report.poles.push(name(k));
            continue;
        }
        if kinds[k].is_some() {
            continue;
        }
        let share = found.covered[k].iter().filter(|&&x| x).count() as f64 / SAMPLES as f64;
        let partial = std::mem::take(&mut found.partial[k]);
        let mut kind = EdgeKind::Free;
        if !partial.is_empty() {
            if share == 1.0 {
                let sharp = partial.iter().any(|p| p.1 == EdgeKind::Sharp);
                kind = if sharp {
                    EdgeKind::Sharp
                } else {
                    EdgeKind::Smooth
                };
            }
            report.partial.push(PartialJoint {
                edge: name(k),
                others: partial.iter().map(|p| name(p.0)).collect(),
                share,
            });
            found.links[k].extend(partial.into_iter().map(|p| p.2));
        }
        if kind == EdgeKind::Free {
            report.free.push(name(k));
        }
        kinds[k] = Some(kind);
    }
    let mut links = found.links.into_iter();
    kinds
        .chunks(4)
        .map(|kinds| {
            [0, 1, 2, 3].map(|k| Edge {
                kind: kinds[k],
                links: links.next().unwrap_or_default(),
            })
        })
        .collect()
}

/// Connected components and sides relative to the first patch of each.
#[allow(clippy::type_complexity)]
fn orient(
    edges: &[[Edge; 4]],
    sides: &mut [f64],
) -> Result<(Vec<Vec<usize>>, Vec<usize>), PatchSetError> {
    let mut component_of = vec![usize::MAX; edges.len()];
    let mut components: Vec<Vec<usize>> = Vec::new();
    for seed in 0..edges.len() {
        if component_of[seed] != usize::MAX {
            continue;
        }
        let number = components.len();
        let mut members = vec![seed];
        component_of[seed] = number;
        sides[seed] = 1.0;
        let mut next = 0;
        let mut conflict = None;
        while next < members.len() {
            let patch = members[next];
            next += 1;
            for link in edges[patch].iter().flat_map(|e| &e.links) {
                let other = link.patch as usize;
                let side = sides[patch] * link.relation;
                if component_of[other] == usize::MAX {
                    component_of[other] = number;
                    sides[other] = side;
                    members.push(other);
                } else if sides[other] != side && conflict.is_none() {
                    conflict = Some((patch.min(other), patch.max(other)));
                }
            }
        }
        members.sort_unstable();
        if let Some((a, b)) = conflict {
            return Err(PatchSetError::NotOrientable(a, b, members));
        }
        components.push(members);
    }
    Ok((components, component_of))
}

/// Corners that meet in space.
#[allow(clippy::type_complexity)]
fn corner_groups<S: Surface>(set: &PatchSet<S>) -> (Vec<Vec<(u32, u32)>>, Vec<[u32; 4]>) {
    let point = |patch: usize, corner: u32| {
        let domain = set.patches[patch].domain();
        let xi = [
            domain[0][(corner & 1) as usize],
            domain[1][(corner >> 1) as usize],
        ];
        set.patches[patch].point(xi)
    };
    let mut all: Vec<(Vec3, u32, u32)> = (0..set.patches.len())
        .flat_map(|p| (0..4).map(move |c| (p, c)))
        .map(|(p, c)| (point(p, c), p as u32, c))
        .collect();
    all.sort_by(|a, b| a.0.x.total_cmp(&b.0.x).then((a.1, a.2).cmp(&(b.1, b.2))));
    let limit = 2.0 * set.tolerance;
    let mut group = vec![u32::MAX; all.len()];
    let mut groups: Vec<Vec<(u32, u32)>> = Vec::new();
    let mut corners = vec![[0; 4]; set.patches.len()];
    for k in 0..all.len() {
        if group[k] == u32::MAX {
            group[k] = groups.len() as u32;
            groups.push(Vec::new());
        }
        let own = group[k];
        groups[own as usize].push((all[k].1, all[k].2));
        corners[all[k].1 as usize][all[k].2 as usize] = own;
        for later in k + 1..all.len() {
            if all[later].0.x - all[k].0.x > limit {
                break;
            }
            if group[later] == u32::MAX && (all[later].0 - all[k].0).norm() <= limit {
                group[later] = own;
            }
        }
    }
    (groups, corners)
}
