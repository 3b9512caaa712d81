//! Faces that harm more than they add: slivers narrower than the resolution of the file, and faces that are there twice.

use super::brep::{Grant, Metered, NoSet, STEPS, bytes_of_edges, set_of};
use super::report::{CadFile, CadPatch};
use crate::project::Joining;
use crate::surface::{Surface, Vec3};
use crate::{NurbsPatch, PatchSet};
use serde::Serialize;
use std::collections::HashMap;

/// Slivers are narrower than the file's resolution, and the resolution counts within these shares of the size.
const NARROW: [f64; 2] = [1e-8, 1e-6];
/// Boxes of faces that may be one differ by this share of their diagonal at most.
const ALIKE: f64 = 0.02;
/// Faces compared with one face.
const COMPARED: usize = 32;

/// A face that was read but left out.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[non_exhaustive]
pub struct LeftOut {
    /// As in [`CadPatch::entity`].
    pub entity: u32,
    /// As in [`CadPatch::instance`].
    pub instance: u32,
    /// Why.
    #[serde(flatten)]
    pub why: LeftOutKind,
}

/// Why a face was left out.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[serde(tag = "kind", rename_all = "snake_case")]
#[non_exhaustive]
pub enum LeftOutKind {
    /// It is narrower than what the file tells apart.
    Sliver {
        /// Twice its area divided by the length of its border.
        width: f64,
    },
    /// It coincides with another face of the same body, or of a file without bodies.
    Duplicate {
        /// Number of the face that stays.
        of: u32,
        /// Largest distance between both.
        distance: f64,
    },
}

/// What was mended in a file beyond its boundary curves. Lengths are in the file's unit.
#[derive(Debug, Clone, PartialEq, Default, Serialize)]
#[non_exhaustive]
pub struct Healing {
    /// Number of slivers that were left out.
    pub slivers: usize,
    /// Width of the widest of them.
    pub widest_sliver: f64,
    /// Number of faces left out because they are there twice.
    pub duplicates: usize,
    /// The largest distance between one of them and the face that stays.
    pub farthest_duplicate: f64,
    /// Every face that was left out.
    pub left_out: Vec<LeftOut>,
}

impl Healing {
    fn add(&mut self, patch: &CadPatch, why: LeftOutKind) {
        match why {
            LeftOutKind::Sliver { width } => {
                self.slivers += 1;
                self.widest_sliver = self.widest_sliver.max(width);
            }
            LeftOutKind::Duplicate { distance, .. } => {
                self.duplicates += 1;
                self.farthest_duplicate = self.farthest_duplicate.max(distance);
            }
        }
        self.left_out.push(LeftOut {
            entity: patch.entity,
            instance: patch.instance,
            why,
        });
    }

    pub(super) fn scale(&mut self, factor: f64) {
        self.widest_sliver *= factor;
        self.farthest_duplicate *= factor;
        for left_out in &mut self.left_out {
            match &mut left_out.why {
                LeftOutKind::Sliver { width: length }
                | LeftOutKind::Duplicate {
                    distance: length, ..
                } => *length *= factor,
            }
        }
    }
}

/// Takes slivers and duplicates out of a file that was read. Comparing faces is charged to the grant of the file.
pub fn heal(file: &mut CadFile, grant: &Grant) {
    let outlines: Vec<Outline> = file.patches.iter().map(|p| Outline::of(&p.patch)).collect();
    let low = outlines.iter().map(|o| o.bounds[0]);
    let high = outlines.iter().map(|o| o.bounds[1]);
    let (Some(low), Some(high)) = (low.reduce(|a, b| a.inf(&b)), high.reduce(|a, b| a.sup(&b)))
    else {
        return;
    };
    let size = (high - low).norm();
    let [least, most] = NARROW.map(|share| share * size);
    let near = file.resolution.unwrap_or(0.0).clamp(least, most.max(least));
    let mut why: Vec<Option<LeftOutKind>> = outlines
        .iter()
        .map(|o| (o.width < near).then_some(LeftOutKind::Sliver { width: o.width }))
        .collect();
    // A file of nothing else is left as it is.
    if why.iter().all(Option::is_some) {
        return;
    }
    if !duplicates(file, &outlines, (near, grant), &mut why) {
        file.notes.push(
            "not all faces were compared with each other to find those that are there twice: that takes more work or memory than \
             a file of this length is granted"
                .to_owned(),
        );
    }
    for (patch, why) in file.patches.iter().zip(&why) {
        if let Some(why) = *why {
            file.healing.add(patch, why);
            if let Some(body) = patch.tags.body
                && let Some(body) = file.bodies.get_mut(body)
            {
                body.faces = body.faces.saturating_sub(1);
            }
        }
    }
    let mut why = why.into_iter();
    file.patches.retain(|_| why.next().flatten().is_none());
}

/// What is cheap to know of a face.
struct Outline {
    bounds: [Vec3; 2],
    /// No less than twice the area divided by the length of the border.
    width: f64,
}

impl Outline {
    fn of(patch: &NurbsPatch) -> Self {
        let rings = rings(patch);
        let domain = patch.domain();
        let (mut length, mut area) = (0.0, 0.0);
        for ring in &rings {
            let next = ring.iter().skip(1).chain(ring.first());
            for (a, b) in ring.iter().zip(next) {
                length += (patch.point(*a) - patch.point(*b)).norm();
                // About a corner of the domain: products of large parameters would cancel.
                let [x, y] = [0, 1].map(|d| a[d] - domain[d][0]);
                area += 0.5 * (x * (b[1] - a[1]) - y * (b[0] - a[0]));
            }
        }
        let (mut low, mut high) = (Vec3::repeat(f64::INFINITY), Vec3::repeat(f64::NEG_INFINITY));
        let mut stretch = 0.0f64;
        for xi in points(rings, patch) {
            let jet = patch.jet(xi);
            (low, high) = (low.inf(&jet.rho), high.sup(&jet.rho));
            stretch = stretch.max(jet.rho_i[0].cross(&jet.rho_i[1]).norm());
        }
        let most = 2.0 * area.abs() * stretch;
        Self {
            bounds: [low, high],
            width: if most > 0.0 { most / length } else { 0.0 },
        }
    }
}

/// Points along the border of a patch, loop by loop.
fn rings(patch: &NurbsPatch) -> Vec<Vec<[f64; 2]>> {
    if let Some(trim) = patch.trim() {
        let ring = |l: &crate::TrimLoop| {
            let mut ring = Vec::new();
            for curve in &l.curves {
                let basis = curve.parameter.basis();
                for span in 0..basis.span_count() {
                    let [a, b] = basis.span_range(span);
                    let steps = STEPS * basis.degree();
                    let at =
                        |k: usize| curve.parameter.point(a + (b - a) * k as f64 / steps as f64);
                    ring.extend((0..steps).map(|k| <[f64; 2]>::from(at(k))));
                }
            }
            ring
        };
        return trim.loops().iter().map(ring).collect();
    }
    let [[a, b], [c, d]] = patch.domain();
    let steps = [0, 1].map(|dir| {
        let ranges = patch.spans(dir).into_iter();
        let at = |[s, e]: [f64; 2]| (0..STEPS).map(move |k| s + (e - s) * k as f64 / STEPS as f64);
        ranges.flat_map(at).collect::<Vec<f64>>()
    });
    let mut ring: Vec<[f64; 2]> = steps[0].iter().map(|&x| [x, c]).collect();
    ring.extend(steps[1].iter().map(|&y| [b, y]));
    ring.extend(steps[0].iter().map(|&x| [a + b - x, d]));
    ring.extend(steps[1].iter().map(|&y| [a, c + d - y]));
    vec![ring]
}

/// Points of the border and of the inside.
fn points(rings: Vec<Vec<[f64; 2]>>, patch: &NurbsPatch) -> impl Iterator<Item = [f64; 2]> + '_ {
    rings.into_iter().flatten().chain(inside(patch))
}

/// Points of a grid that belong to the face.
fn inside(patch: &NurbsPatch) -> impl Iterator<Item = [f64; 2]> + '_ {
    const GRID: usize = 5;
    let [[a, b], [c, d]] = match patch.trim() {
        Some(trim) => trim.bounds(),
        None => patch.domain(),
    };
    let share = |k: usize| (k as f64 + 0.5) / GRID as f64;
    let all = (0..GRID * GRID)
        .map(move |k| [a + (b - a) * share(k % GRID), c + (d - c) * share(k / GRID)]);
    all.filter(|xi| patch.trim().is_none_or(|t| t.contains(*xi)))
}

/// Finds faces that coincide with one before them. Returns whether the work granted was enough for all of them.
fn duplicates(
    file: &CadFile,
    outlines: &[Outline],
    (near, grant): (f64, &Grant),
    why: &mut [Option<LeftOutKind>],
) -> bool {
    let mut order: Vec<usize> = (0..outlines.len()).filter(|&k| why[k].is_none()).collect();
    // Centres along a line that few directions of parts are perpendicular to.
    let middle = |k: usize| outlines[k].bounds[0] + outlines[k].bounds[1];
    let keys: Vec<f64> = (0..outlines.len())
        .map(|k| middle(k).dot(&Vec3::new(0.32, 0.25, 0.29)))
        .collect();
    order.sort_by(|&a, &b| keys[a].total_cmp(&keys[b]));
    let mut sets = Sets::default();
    let mut compared = false;
    // Of those before it a face is compared with the ones that stay.
    let mut staying: Vec<usize> = Vec::with_capacity(order.len());
    for &face in &order {
        // Two faces that are parametrised in other ways are sampled at other points.
        let [low, high] = outlines[face].bounds;
        let alike = near + ALIKE * (high - low).norm();
        let before = (0..staying.len()).rev();
        let candidates = before
            .take_while(|&k| keys[face] - keys[staying[k]] <= 2.0 * alike)
            .filter(|&k| {
                let (one, other) = (staying[k], face);
                let apart = |side: usize| {
                    (outlines[one].bounds[side] - outlines[other].bounds[side]).amax()
                };
                file.patches[one].tags.body == file.patches[other].tags.body
                    && apart(0).max(apart(1)) <= alike
            })
            .take(COMPARED);
        let candidates: Vec<usize> = candidates.collect();
        if !candidates.is_empty() && grant.is_spent() {
            return false;
        }
        compared |= !candidates.is_empty();
        let found = candidates.into_iter().find_map(|k| {
            let distance = coincide(file, [staying[k], face], (near, grant), &mut sets)?;
            Some((k, distance))
        });
        match found {
            Some((k, distance)) => {
                // The first in the file stays.
                let [stays, goes] = [staying[k].min(face), staying[k].max(face)];
                staying[k] = stays;
                sets.made.remove(&goes);
                let of = file.patches[stays].entity;
                why[goes] = Some(LeftOutKind::Duplicate { of, distance });
            }
            None => staying.push(face),
        }
    }
    // The last comparison may have ended for want of work.
    !(sets.too_large || compared && grant.is_spent())
}

/// Sets of single faces, by the number of the face, within the memory granted.
#[derive(Default)]
struct Sets<'f> {
    made: HashMap<usize, Option<PatchSet<Metered<'f>>>>,
    /// Bytes of each, also of those that are gone: those foreseen, and those of its edges.
    bytes: HashMap<usize, [u64; 2]>,
    /// Whether some were not made, for they are too large.
    too_large: bool,
}

impl<'f> Sets<'f> {
    /// Makes the sets of two faces; those of other faces go where there is no room for all.
    fn make(&mut self, file: &'f CadFile, pair: [usize; 2], grant: &'f Grant) {
        let room = grant.passing_bytes();
        let patch = |k: usize| Metered::trimmed(&file.patches[k].patch, grant);
        for k in pair {
            let foreseen = || [patch(k).bytes_for_projections(), 0];
            self.bytes.entry(k).or_insert_with(foreseen);
        }
        // What was compared long ago lies elsewhere.
        if self.made.len() > 2 * COMPARED || self.in_use(pair) > room {
            self.made.clear();
        }
        for (k, other) in [(pair[0], pair[1]), (pair[1], pair[0])] {
            if self.made.contains_key(&k) {
                continue;
            }
            let of_one = || vec![patch(k)];
            let mut set = Err(NoSet::Memory);
            if self.in_use(pair) <= room {
                let in_use = self.in_use([other; 2]);
                set = set_of(of_one(), Joining::default(), (grant, in_use));
            }
            let others = self.made.keys().any(|made| *made != other);
            if others && set.as_ref().is_err_and(|e| *e == NoSet::Memory) {
                self.made.retain(|made, _| *made == other);
                let in_use = self.in_use([other; 2]);
                set = set_of(of_one(), Joining::default(), (grant, in_use));
            }
            match &set {
                Ok(set) => {
                    let edges = bytes_of_edges(set);
                    self.bytes.entry(k).and_modify(|bytes| bytes[1] = edges);
                }
                Err(reason) => self.too_large |= *reason == NoSet::Memory,
            }
            self.made.insert(k, set.ok());
        }
    }

    /// Bytes of the sets that are there and of a pair.
    fn in_use(&self, pair: [usize; 2]) -> u64 {
        let others = self.made.keys().filter(|k| !pair.contains(k));
        let [one, other] = pair;
        let pair = [Some(one), (other != one).then_some(other)];
        let all = others.copied().chain(pair.into_iter().flatten());
        let bytes = all.filter_map(|k| self.bytes.get(&k));
        bytes
            .flatten()
            .fold(0, |sum, &bytes| sum.saturating_add(bytes))
    }
}

/// Largest distance between two faces, if they coincide.
fn coincide<'f>(
    file: &'f CadFile,
    pair: [usize; 2],
    (near, grant): (f64, &'f Grant),
    sets: &mut Sets<'f>,
) -> Option<f64> {
    sets.make(file, pair, grant);
    let [Some(one), Some(other)] = pair.map(|k| sets.made[&k].as_ref()) else {
        return None;
    };
    // Two sheets of one body may touch back to back, and so may the bodies of a file that does not list them.
    let body = file.patches[pair[0]]
        .tags
        .body
        .and_then(|k| file.bodies.get(k));
    let facing = body.is_none_or(|body| body.solid);
    let there = apart(one, other, near, facing)?;
    let found = there.max(apart(other, one, near, facing)?);
    (!grant.is_spent()).then_some(found)
}

/// Largest distance of points of `one` from `other`, if none is larger than `near`; with `facing`, only where the normals
/// agree.
fn apart(
    one: &PatchSet<Metered>,
    other: &PatchSet<Metered>,
    near: f64,
    facing: bool,
) -> Option<f64> {
    let mut worst = 0.0f64;
    let own = &one.patches()[0];
    for xi in points(rings(own.patch()), own.patch()) {
        let jet = own.jet(xi);
        let foot = other.project(&jet.rho, None, 2.0 * near)?;
        worst = worst.max(foot.distance);
        let [a, b] = [&jet, &foot.jet].map(|j| j.rho_i[0].cross(&j.rho_i[1]));
        if worst > near || (facing && a.dot(&b) < -0.5 * a.norm() * b.norm()) {
            return None;
        }
    }
    Some(worst)
}
