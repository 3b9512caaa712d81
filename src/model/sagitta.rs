//! Overclosures and clearances beside the sagitta of facets. A flat face of a curved body lies a sagitta off the surface that its nodes are
//! on, most in its middle. Where two such surfaces do not match node by node, overclosures are wrong by that, and with them
//! the pressures of an interference fit; so is the clearance of a pin in its bore. So the gaps of a pair that starts with an
//! overclosure, or both sides of which are curved and lie close to each other, are measured between the curved surfaces: what facets change of the gap
//! of each point at the start is taken out of it for the whole run.
use super::error::number;
use super::master::{MasterNow, Masters};
use super::state::PointState;
use super::{Model, PairModel};
use crate::contact::points::SlavePoint;
use crate::mesh::{Face, Mesh};
use crate::scene::Tangent;
use covact_geometry::Vec3;
use std::collections::HashMap;

/// Part of the overclosure, or of the distance, above which what facets add to it counts.
const COUNTS: f64 = 0.01;
/// Part of the slave that lies near a master that it fits.
const MOST: f64 = 0.5;
/// Faces whose normals differ by more than this (radians) meet at an edge of the body, not of its facets.
const EDGE: f64 = 0.8;

/// A flat face and the curved surface that its corners are on: an arc of a circle along either of its directions.
#[derive(Debug, Clone, Copy)]
struct Curved {
    /// Outward unit normal of the face.
    normal: Vec3,
    /// Unit vectors along u and v.
    along: [Vec3; 2],
    /// Half of the lengths along u and v.
    half: [f64; 2],
    /// Curvatures along u and v (1 / length): positive where the surface bulges outwards, negative where it is hollow.
    curvature: [f64; 2],
}

impl Curved {
    /// How far the surface lies outside a point of the face, along its own normal there (length), and that normal.
    fn outside(&self, xi: [f64; 2]) -> (f64, Vec3) {
        let (mut height, mut normal) = (0.0, self.normal);
        for (k, x) in xi.into_iter().enumerate() {
            let (a, kappa) = (self.half[k], self.curvature[k]);
            let turn = kappa * a;
            // R - sqrt(R^2 - a^2 (1 - xi^2)), without its cancellation.
            let inner = 1.0 - x * x;
            height += kappa * a * a * inner / (1.0 + (1.0 - turn * turn * inner).sqrt());
            normal += self.along[k] * (turn * x / (1.0 - turn * turn).sqrt());
        }
        (height, normal.normalize())
    }

    /// Where the normal of the surface through a point meets the face, from the foot of the point and its signed distance.
    fn below(&self, foot: [f64; 2], distance: f64) -> [f64; 2] {
        [0, 1].map(|k| {
            let turn = self.curvature[k] * self.half[k];
            foot[k] / (1.0 + self.curvature[k] * distance / (1.0 - turn * turn).sqrt())
        })
    }
}

/// The faces of one side of a pair as parts of curved surfaces.
#[derive(Debug)]
struct Surface {
    /// Per face.
    faces: Vec<Curved>,
    /// Number of a face by its corners, sorted.
    numbers: HashMap<[u32; 4], usize>,
}

fn key(mut corners: [u32; 4]) -> [u32; 4] {
    corners.sort_unstable();
    corners
}

impl Surface {
    /// From the angles between neighbouring faces; none where all are flat, and for quadratic faces, which follow the surface.
    fn new(mesh: &Mesh, faces: &[Face]) -> Option<Surface> {
        let corners: Vec<[u32; 4]> = faces.iter().map(|&f| mesh.face_corners(f)).collect();
        if faces.iter().any(|&f| mesh.face_nodes(f).count != [2, 2]) {
            return None;
        }
        let at = |n: u32| mesh.nodes[n as usize];
        let plane: Vec<(Vec3, Vec3)> = (faces.iter().zip(&corners))
            .map(|(&f, c)| {
                let center = c.iter().fold(Vec3::zeros(), |sum, &n| sum + at(n)) / 4.0;
                (center, mesh.face_area_normal(f).1)
            })
            .collect();
        // Sides -u, +u, -v, +v of every face by their nodes.
        let sides = |c: &[u32; 4]| {
            [[0, 2], [1, 3], [0, 1], [2, 3]].map(|[i, k]| [c[i].min(c[k]), c[i].max(c[k])])
        };
        let mut beside: HashMap<[u32; 2], Vec<usize>> = HashMap::new();
        for (number, c) in corners.iter().enumerate() {
            for side in sides(c) {
                beside.entry(side).or_default().push(number);
            }
        }
        let middle = |[a, b]: [u32; 2]| (at(a) + at(b)) * 0.5;
        let curved = |(number, c): (usize, &[u32; 4])| {
            let sides = sides(c);
            let mut out = Curved {
                normal: plane[number].1,
                along: [Vec3::zeros(); 2],
                half: [0.0; 2],
                curvature: [0.0; 2],
            };
            for k in 0..2 {
                let across = middle(sides[2 * k + 1]) - middle(sides[2 * k]);
                let length = across.norm();
                (out.along[k], out.half[k]) = (across / length, 0.5 * length);
                let (mut curvature, mut count) = (0.0, 0.0);
                for side in &sides[2 * k..2 * k + 2] {
                    for &other in beside[side].iter().filter(|o| **o != number) {
                        let ((a, n), (b, m)) = (&plane[number], &plane[other]);
                        let sine = n.cross(m).norm();
                        if sine.atan2(n.dot(m)) < EDGE {
                            // Chords of a circle of radius R that turn by an angle have their middles R sin(angle) apart.
                            let apart = b - a;
                            curvature += (sine / apart.norm()).copysign((m - n).dot(&apart));
                            count += 1.0;
                        }
                    }
                }
                if count > 0.0 {
                    // A face cannot span more than half of its circle.
                    let most = 0.9 / out.half[k];
                    out.curvature[k] = (curvature / count).clamp(-most, most);
                }
            }
            out
        };
        let faces: Vec<Curved> = corners.iter().enumerate().map(curved).collect();
        // What rounding leaves of flat faces is no curvature.
        let bends = |f: &Curved| (0..2).any(|k| (f.curvature[k] * f.half[k]).abs() > 1e-6);
        faces.iter().any(bends).then(|| Surface {
            faces,
            numbers: (corners.iter().enumerate())
                .map(|(i, c)| (key(*c), i))
                .collect(),
        })
    }
}

/// What facets change of the distance of faces that lie close to each other and do not overlap.
#[derive(Debug, Default)]
struct Beside {
    /// Of the points near the master (length^2).
    area: f64,
    /// Integrals over it: distance between the curved surfaces, and what facets change of it (length^3).
    distance: f64,
    changed: f64,
    /// Farthest that a facet lies off its surface there (length).
    largest: f64,
}

impl Beside {
    fn add(&mut self, area: f64, bow: f64, distance: f64, off: f64) {
        self.area += area;
        self.distance += area * distance;
        self.changed += area * bow.abs();
        self.largest = self.largest.max(off);
    }

    /// Whether most of the slave of area `all` lies near, as a pin in its bore does, and facets count in how near.
    fn counts(&self, all: f64) -> bool {
        self.area > MOST * all && self.changed > COUNTS * self.distance
    }
}

/// Both sides of a pair, as far as they are curved and made of flat faces.
pub(super) struct Sides {
    slave: Option<Surface>,
    master: Option<Surface>,
}

/// What is between the curved surfaces at a slave point.
struct CurvedGap {
    gap: f64,
    /// The larger of the distances of both facets from their surfaces there, and how far the master lies outside of its own (length).
    off: f64,
    height: f64,
}

/// The flat faces of a curved master, over which slave points may slide: what they change of a gap belongs to where the point lies.
#[derive(Debug)]
pub struct CurvedMaster {
    surface: Surface,
    /// Per slave point, how far the master lies outside of its face below the point at the start (length).
    heights: Vec<f64>,
    /// Overclosure, or distance of both sides, at the start, on the mean (length).
    distance: f64,
}

impl CurvedMaster {
    /// By how much the flat faces change the gaps of points in contact otherwise than at the start: on their mean, as a part of the
    /// overclosure or clearance there. `states` are those of the slave points, `faces` tells the face of the master that a patch is of.
    pub fn slid(
        &self,
        points: &[SlavePoint],
        states: &[PointState],
        faces: impl Fn(u32) -> u32,
    ) -> f64 {
        let (mut area, mut sum) = (0.0, 0.0);
        for ((point, state), start) in points.iter().zip(states).zip(&self.heights) {
            let Some(hint) = state.hint.filter(|_| state.closed) else {
                continue;
            };
            let (height, _) = self.surface.faces[faces(hint.patch) as usize].outside(hint.xi);
            area += point.area;
            sum += point.area * (height - start).abs();
        }
        match area > 0.0 {
            true => sum / (area * self.distance),
            false => 0.0,
        }
    }
}

/// What facets change of the overclosure of a pair at the start.
#[derive(Debug)]
pub(super) struct Correction {
    /// Per slave point: its normal coordinate less the gap between the curved surfaces (length); none where they change less than one
    /// per cent.
    pub bow: Vec<f64>,
    /// The master, where its facets change anything.
    pub below: Option<CurvedMaster>,
    /// What was found, in words.
    pub told: String,
    /// Why the gaps of the pair cannot be corrected, if so.
    pub refused: Option<&'static str>,
}

impl Sides {
    /// None where no side is curved and faceted, and for self contact.
    pub fn new(model: &Model, index: usize) -> Option<Sides> {
        let pair = &model.pairs[index];
        if pair.edges_of.is_some() || pair.master.is_own() {
            return None;
        }
        // What bends as a CAD surface is that surface.
        let faceted = |body: usize| model.bodies[body].block.sheet().is_none();
        let slave = (faceted(pair.body))
            .then(|| Surface::new(&model.bodies[pair.body].mesh, &pair.faces))
            .flatten();
        let master = (pair.body_master())
            .filter(|m| !m.smooth && faceted(m.body))
            .and_then(|m| Surface::new(&model.bodies[m.body].mesh, &m.faces));
        (slave.is_some() || master.is_some()).then_some(Sides { slave, master })
    }

    /// The gap between the curved surfaces at a slave point, which lies at `x`; none where the master is not found.
    fn gap(
        &self,
        (model, pair): (&Model, &PairModel),
        master: &MasterNow<'_>,
        (i, p, x): (usize, &SlavePoint, &Vec3),
    ) -> Option<CurvedGap> {
        let (mut at, mut off) = (*x, 0.0f64);
        if let (Some(slave), 4) = (&self.slave, p.count) {
            let first = model.bodies[pair.body].first_node;
            let corners = [0, 1, 2, 3].map(|k| p.nodes[k] - first);
            let [a, b, c, d] = [0, 1, 2, 3].map(|k| p.shape[k]);
            let xi = [b + d - a - c, c + d - a - b];
            if let Some(&face) = slave.numbers.get(&key(corners)) {
                let (height, normal) = slave.faces[face].outside(xi);
                at += normal * height;
                off = height.abs();
            }
        }
        let seen = master.see(i, &at, None)?;
        let (mut gap, mut height) = (seen.gap(pair.offset), 0.0);
        if let (Some(surface), Some(body)) = (&self.master, pair.body_master())
            && seen.counts()
        {
            let face = body.facets.source(seen.hint.patch) as usize;
            let face = &surface.faces[face];
            let (outside, normal) = face.outside(face.below(seen.hint.xi, seen.signed_distance));
            gap = seen.signed_distance / normal.dot(&seen.normal) - outside - pair.offset;
            (off, height) = (off.max(outside.abs()), outside);
        }
        Some(CurvedGap { gap, off, height })
    }

    /// What facets change of the overclosure of pair `index`, whose points have these normal coordinates at the start
    /// (not-a-number: none); nothing where it is less than one per cent, or nothing overlaps either way.
    pub fn correction(self, model: &Model, index: usize, gaps: &[f64]) -> Option<Correction> {
        let pair = &model.pairs[index];
        let zero = vec![0.0; 3 * model.nodes.len()];
        let masters = Masters::new(model);
        let master = masters.at(model, index, &zero, 0.0).ok()?;
        let mut bow = Vec::with_capacity(gaps.len());
        let mut heights = Vec::with_capacity(gaps.len());
        let (mut faceted, mut true_ones, mut area, mut largest) = (0.0, 0.0, 0.0, 0.0f64);
        let mut deepest = 0.0f64;
        let mut beside = Beside::default();
        for (i, (p, &gap)) in pair.points.iter().zip(gaps).enumerate() {
            let x = model.point_position(p, &zero);
            // Beyond an element nothing of the start is left when the point arrives.
            let near = gap.is_finite() && gap.abs() < pair.element_size;
            let found = match near {
                true => self.gap((model, pair), &master, (i, p, &x)),
                false => None,
            };
            heights.push(found.as_ref().map_or(0.0, |f| f.height));
            let Some(CurvedGap {
                gap: curved, off, ..
            }) = found
            else {
                bow.push(0.0);
                continue;
            };
            bow.push(gap - curved);
            beside.add(p.area, gap - curved, curved, off);
            deepest = deepest.min(curved).min(gap);
            faceted -= gap.min(0.0) * p.area;
            true_ones -= curved.min(0.0) * p.area;
            if gap < 0.0 || curved < 0.0 {
                (area, largest) = (area + p.area, largest.max(off));
            }
        }
        let added = faceted - true_ones;
        let overlaps = deepest < -1e-9 * pair.element_size;
        // Nothing, as long as the points stay where they are.
        let nothing = overlaps && added.abs() <= COUNTS * true_ones;
        let all: f64 = pair.points.iter().map(|p| p.area).sum();
        let fits = self.slave.is_some() && self.master.is_some() && beside.counts(all);
        if !overlaps && !fits {
            return None;
        }
        let refused = match (pair.tangent, pair.segments()) {
            (_, Some(_)) => Some("points of segments are others with every step"),
            (Tangent::Published { .. }, _) => {
                Some("the published tangent holds for gaps from the master itself")
            }
            _ => None,
        };
        let distance = match overlaps {
            true => true_ones / area,
            false => beside.distance / beside.area,
        };
        let below = (self.master).map(|surface| CurvedMaster {
            surface,
            heights,
            distance,
        });
        if nothing {
            return refused.is_none().then(|| Correction {
                bow: Vec::new(),
                below,
                told: String::new(),
                refused: None,
            });
        }
        if !overlaps {
            return refused.is_none().then(|| Correction {
                bow,
                below,
                told: format!(
                    "contact `{}`: flat facets stand for curved faces, up to {} off them, where the mean distance of both sides is {} \
                     at the start",
                    pair.name,
                    number(beside.largest),
                    number(distance),
                ),
                refused: None,
            });
        }
        Some(Correction {
            bow,
            below,
            told: format!(
                "contact `{}`: flat facets stand for curved faces, up to {} off them: they make an overclosure of {} at the \
                 start, on the mean of the points that overlap, which is {} between the curved surfaces",
                pair.name,
                number(largest),
                number(faceted / area),
                number(distance),
            ),
            refused,
        })
    }
}
