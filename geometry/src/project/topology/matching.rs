//! Pairs of edges that coincide, and what every edge is.

use crate::parallel::*;

use super::super::EdgeKind;
use super::super::set::{PatchSet, SHARP_ANGLE};
use super::super::tree::Tree;
use super::contact::{Contact, apart, contact};
use super::edge::{Edge, Link, subtract};
use super::nearest::nearest_on_edge;
use super::report::{EdgeReport, Gap, Joint, PartialJoint};
use crate::surface::{Surface, Vec3};

/// Edges that the file gives the same number are joined over gaps up to this multiple of the tolerance; pairs without a
/// common number up to the same gap are reported.
const WIDE: f64 = 100.0;
/// Without a stated tolerance, edges that coincide as a whole are joined over gaps up to this multiple of it.
const LOOSE: f64 = 10.0;
/// Gaps are no larger than this share of the shorter of two edges.
const SHORT: f64 = 0.05;
/// A joint that folds the surface back onto itself by more than this angle (radians) comes last: it is rather a copy of
/// the patch.
const FOLDED: f64 = 3.0;

/// Two edges in contact.
pub(super) struct Pair {
    /// Indices of the edges.
    edges: [usize; 2],
    /// The first against the second, the second against the first.
    contacts: [Contact; 2],
    /// Whether all of the first, of the second is covered; and of both.
    full: [bool; 2],
    whole: bool,
    same_entity: bool,
    relation: f64,
    reversed: bool,
    angle: f64,
    /// Both patches leave the edge in the same direction everywhere, like sheets on top of each other.
    stacked: bool,
    gap: f64,
    tolerance: f64,
}

/// A corner on the inside of an edge: index of the edge that ends there and which end, index of the edge and parameter.
pub(super) type Touch = ((usize, usize), (usize, f64));

/// Numbers of an edge for reports.
pub(super) fn name(edge: &Edge) -> (u32, u32) {
    (edge.patch, edge.number)
}

/// All pairs of the edges `chosen` that are in contact within `tolerance`; if `loose`, within ten times as much where that
/// makes all of an edge coincide with another one: a coincidence of that kind is no accident.
pub(super) fn pairs<S: Surface>(
    set: &PatchSet<S>,
    edges: &[Edge],
    chosen: &[usize],
    tolerance: f64,
    loose: bool,
) -> Vec<Pair> {
    let wide = if loose { LOOSE * tolerance } else { tolerance };
    let candidates = candidates(edges, chosen, tolerance, wide);
    let compare = |(a, b): (usize, usize)| {
        if !set.patches[edges[a].patch as usize].may_go_on() {
            return None;
        }
        let tight = pair(set, edges, a, b, tolerance);
        let shorter = edges[a].length.min(edges[b].length);
        if apart(&edges[a], &edges[b], wide.min(SHORT * shorter)) {
            return tight;
        }
        if !loose || tight.as_ref().is_some_and(|p| p.whole) {
            return tight;
        }
        // An edge that coincides as a whole has both ends near the other one.
        let near =
            |p: &Vec3, edge: &Edge| (nearest_on_edge(set, p, edge).jet.rho - p).norm() <= wide;
        let ends_near = |one: &Edge, other: &Edge| {
            let last = one.samples.len() - 1;
            near(&one.samples[0].point, other) && near(&one.samples[last].point, other)
        };
        if !ends_near(&edges[a], &edges[b]) && !ends_near(&edges[b], &edges[a]) {
            return tight;
        }
        let before = tight.as_ref().map_or([false; 2], |p| p.full);
        match pair(set, edges, a, b, wide) {
            Some(p) if p.whole || (0..2).any(|k| p.full[k] && !before[k]) => Some(p),
            _ => tight,
        }
    };
    candidates.into_par_iter().filter_map(compare).collect()
}

/// Pairs whose boxes meet: those of edges with the same number of the file, which may be joined over wide gaps, and all
/// others over narrow ones. A tree over the boxes finds them wherever the edges lie.
fn candidates(edges: &[Edge], chosen: &[usize], tolerance: f64, wide: f64) -> Vec<(usize, usize)> {
    let boxes: Vec<_> = (chosen.iter())
        .map(|&k| grown_box(edges[k].bounds, wide))
        .collect();
    let meet = |a: &[Vec3; 2], low: &Vec3, high: &Vec3| {
        (0..3).all(|k| a[0][k] <= high[k] && low[k] <= a[1][k])
    };
    let tree = Tree::new(&boxes);
    let found = boxes.par_iter().enumerate().flat_map_iter(|(first, own)| {
        let mut out = Vec::new();
        let measure = |low: &Vec3, high: &Vec3| f64::from(u8::from(!meet(own, low, high)));
        tree.scan(measure, 1.0, |second| {
            let second = second as usize;
            if second > first {
                let (a, b) = (chosen[first], chosen[second]);
                out.push((a.min(b), a.max(b)));
            }
            1.0
        });
        out
    });
    let mut out: Vec<(usize, usize)> = found.collect();
    let mut numbered: Vec<usize> = (chosen.iter().copied())
        .filter(|&k| edges[k].entity != 0)
        .collect();
    numbered.sort_by_key(|&k| (edges[k].entity, k));
    for group in numbered.chunk_by(|&a, &b| edges[a].entity == edges[b].entity) {
        for (place, &a) in group.iter().enumerate() {
            let own = grown_box(edges[a].bounds, 2.0 * WIDE * tolerance);
            let others = group[place + 1..].iter();
            let near = others.filter(|&&b| meet(&own, &edges[b].bounds[0], &edges[b].bounds[1]));
            out.extend(near.map(|&b| (a.min(b), a.max(b))));
        }
    }
    out.sort_unstable();
    out.dedup();
    out
}

fn grown_box([low, high]: [Vec3; 2], by: f64) -> [Vec3; 2] {
    let by = Vec3::from_element(by);
    [low - by, high + by]
}

fn pair<S: Surface>(
    set: &PatchSet<S>,
    edges: &[Edge],
    a: usize,
    b: usize,
    tolerance: f64,
) -> Option<Pair> {
    let (one, other) = (&edges[a], &edges[b]);
    let same_entity = one.entity != 0 && one.entity == other.entity;
    let shorter = one.length.min(other.length);
    let allowed = if same_entity {
        WIDE * tolerance
    } else {
        tolerance
    };
    let tolerance = allowed.min(SHORT * shorter);
    if apart(one, other, tolerance) {
        return None;
    }
    let contacts = [
        contact(set, one, other, tolerance),
        contact(set, other, one, tolerance),
    ];
    // Edges that only touch or cross are in contact over a few tolerances at most.
    let least = (4.0 * tolerance).min(0.5 * shorter);
    if contacts.iter().all(|c| c.length <= least) {
        return None;
    }
    let sense = if contacts[0].sense + contacts[1].sense >= 0.0 {
        1.0
    } else {
        -1.0
    };
    let relation = -one.sense * other.sense * sense;
    let which = usize::from(relation < 0.0);
    let full = [0, 1].map(|k| is_full([one, other][k], contacts[k].length, tolerance));
    Some(Pair {
        edges: [a, b],
        full,
        whole: full[0] && full[1],
        same_entity,
        relation,
        reversed: sense < 0.0,
        angle: contacts[0].angles[which].max(contacts[1].angles[which]),
        stacked: contacts.iter().all(|c| c.least_angles[which] > FOLDED)
            && contacts.iter().any(|c| c.least_angles[which].is_finite()),
        gap: contacts[0].gap.max(contacts[1].gap),
        tolerance,
        contacts,
    })
}

/// Whether a covered length is all of an edge.
fn is_full(edge: &Edge, covered: f64, tolerance: f64) -> bool {
    edge.length - covered <= 4.0 * tolerance.min(SHORT * edge.length) + 1e-9 * edge.length
}

fn kind_of(angle: f64) -> EdgeKind {
    if angle > SHARP_ANGLE {
        EdgeKind::Sharp
    } else {
        EdgeKind::Smooth
    }
}

/// Links the edges, nearest pairs first and whole ones before parts, and decides what every edge is.
pub(super) fn link(
    edges: &mut [Edge],
    poles: &[bool],
    mut pairs: Vec<Pair>,
    report: &mut EdgeReport,
) -> Vec<Touch> {
    pairs.sort_by(|a, b| {
        let key = |p: &Pair| (p.angle > FOLDED, !p.same_entity, !p.whole);
        key(a)
            .cmp(&key(b))
            .then(a.gap.total_cmp(&b.gap))
            .then(a.edges.cmp(&b.edges))
    });
    let mut touches = Vec::new();
    let mut joined = vec![false; edges.len()];
    let mut branching = vec![false; edges.len()];
    for pair in &pairs {
        // Patches that run over each other a little: their sides meet in part, each turned back onto the other. Joining them
        // there would take one of the patches for the back of the other.
        if pair.angle > FOLDED && !pair.full[0] && !pair.full[1] {
            continue;
        }
        // Sheets on top of each other are no closed body, however near they are, unless the file cannot tell their edges
        // apart or says that they are one.
        if pair.stacked && !pair.same_entity && pair.gap > report.resolution {
            continue;
        }
        // A part that is taken already is not linked again.
        let taken = |k: usize| {
            let edge = &edges[pair.edges[k]];
            let mut left = pair.contacts[k].covered.clone();
            for link in &edge.links {
                left = left
                    .iter()
                    .flat_map(|part| subtract(&[*part], link.own))
                    .collect();
            }
            let left: f64 = left.iter().map(|part| edge.length_between(*part)).sum();
            pair.contacts[k].length - left
                > (8.0 * pair.tolerance).min(0.5 * pair.contacts[k].length)
        };
        if taken(0) || taken(1) {
            pair.edges.iter().for_each(|&k| branching[k] = true);
            continue;
        }
        let kind = kind_of(pair.angle);
        for k in 0..2 {
            let (own, other) = (pair.edges[k], pair.edges[1 - k]);
            // As many as there are: a set of facets has hundreds of thousands of edges with one link each.
            edges[own]
                .links
                .reserve_exact(pair.contacts[k].covered.len());
            for &part in &pair.contacts[k].covered {
                edges[own].links.push(Link {
                    edge: other,
                    own: part,
                    relation: pair.relation,
                    reach: 2.0 * pair.tolerance.max(pair.gap),
                    kind,
                });
            }
            touches.extend(
                pair.contacts[k]
                    .ends
                    .iter()
                    .map(|&(end, t)| ((other, end), (own, t))),
            );
        }
        let names = pair.edges.map(|k| name(&edges[k]));
        if pair.stacked {
            report.folded.extend(names);
        }
        let widest = usize::from(pair.contacts[1].gap > pair.contacts[0].gap);
        let gap_at = pair.contacts[widest].gap_at;
        let gap = Gap {
            edges: names,
            gap: pair.gap,
            at: gap_at,
        };
        if pair.gap > report.resolution {
            report.bridged.push(gap.clone());
        }
        if pair.gap > report.largest_gap || report.largest_gap_at.is_none() {
            report.largest_gap = pair.gap;
            report.largest_gap_at = Some(gap);
        }
        if pair.whole {
            pair.edges.iter().for_each(|&k| joined[k] = true);
            match kind {
                EdgeKind::Smooth => report.smooth += 1,
                _ => report.sharp += 1,
            }
            report.joints.push(Joint {
                edges: names,
                kind,
                angle: pair.angle,
                gap: pair.gap,
                gap_at,
                reversed: pair.reversed,
                same_entity: pair.same_entity,
            });
        }
    }
    for k in 0..edges.len() {
        if poles[k] {
            report.poles.push(name(&edges[k]));
            continue;
        }
        if branching[k] {
            report.branching.push(name(&edges[k]));
        }
        let kind = settle(edges, k, joined[k], report);
        if kind == EdgeKind::Free {
            report.free.push(name(&edges[k]));
        }
        edges[k].kind = Some(kind);
    }
    touches
}

/// What an edge is as a whole, with an entry in the report where it is joined in parts.
fn settle(edges: &[Edge], k: usize, joined: bool, report: &mut EdgeReport) -> EdgeKind {
    let edge = &edges[k];
    if edge.links.is_empty() {
        return EdgeKind::Free;
    }
    let sharp = edge.links.iter().any(|l| l.kind == EdgeKind::Sharp);
    let kind = if sharp {
        EdgeKind::Sharp
    } else {
        EdgeKind::Smooth
    };
    if joined {
        return kind;
    }
    let free: f64 = edge
        .free_parts()
        .iter()
        .map(|part| edge.length_between(*part))
        .sum();
    let reach = edge.links.iter().map(|l| l.reach).sum::<f64>();
    let full = free <= 2.0 * reach.min(SHORT * edge.length) + 1e-9 * edge.length;
    let mut others: Vec<(u32, u32)> = edge.links.iter().map(|l| name(&edges[l.edge])).collect();
    others.sort_unstable();
    others.dedup();
    report.partial.push(PartialJoint {
        edge: name(edge),
        others,
        share: if full { 1.0 } else { 1.0 - free / edge.length },
    });
    if full { kind } else { EdgeKind::Free }
}

/// Pairs of free edges that are near each other but were not joined, by why they were not.
pub(super) fn open_gaps<S: Surface>(set: &PatchSet<S>, edges: &[Edge], report: &mut EdgeReport) {
    let free: Vec<usize> = (0..edges.len())
        .filter(|&k| edges[k].kind == Some(EdgeKind::Free))
        .collect();
    for pair in pairs(set, edges, &free, WIDE * report.tolerance, false) {
        let [a, b] = pair.edges;
        // What is joined already is no gap, unless the edges run on beside each other.
        let joined = edges[a].links.iter().filter(|link| link.edge == b);
        let joined: f64 = joined.map(|l| edges[a].length_between(l.own)).sum();
        if joined > 0.0 && pair.contacts[0].length <= joined + 8.0 * pair.tolerance {
            continue;
        }
        let widest = usize::from(pair.contacts[1].gap > pair.contacts[0].gap);
        let gap = Gap {
            edges: [name(&edges[a]), name(&edges[b])],
            gap: pair.gap,
            at: pair.contacts[widest].gap_at,
        };
        match pair.stacked {
            true => report.stacked.push(gap),
            false => report.open_gaps.push(gap),
        }
    }
}
