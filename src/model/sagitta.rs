//! Overclosures beside the sagitta of facets. A flat face of a curved body lies a sagitta off the surface that its nodes are
//! on, most in its middle. Where two such surfaces do not match node by node, overclosures are wrong by that, and with them
//! the pressures of an interference fit.
use super::error::number;
use super::master::Masters;
use super::{Model, PairModel};
use crate::mesh::{Face, Mesh};
use covact_geometry::Vec3;
use std::collections::HashMap;

/// Part of the overclosure above which what facets add to it is warned of.
const WARNED: f64 = 0.01;
/// Faces whose normals differ by more than this (radians) meet at an edge of the body, not of its facets.
const EDGE: f64 = 0.8;

/// How far flat faces lie below the surface that their nodes are on, in the middle and along u and v (length): positive where
/// the surface bulges outwards, negative where it is hollow.
struct Sagittas {
    /// Per face.
    of: Vec<[f64; 2]>,
    /// Number of a face by its corners, sorted.
    numbers: HashMap<[u32; 4], usize>,
}

fn key(mut corners: [u32; 4]) -> [u32; 4] {
    corners.sort_unstable();
    corners
}

impl Sagittas {
    /// From the angles between neighbouring faces; none for quadratic faces, which follow the surface.
    fn new(mesh: &Mesh, faces: &[Face]) -> Option<Sagittas> {
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
        let of = corners.iter().enumerate().map(|(number, c)| {
            let sides = sides(c);
            [0, 1].map(|k| {
                let (mut curvature, mut count) = (0.0, 0.0);
                for side in &sides[2 * k..2 * k + 2] {
                    for &other in beside[side].iter().filter(|o| **o != number) {
                        let ((a, n), (b, m)) = (&plane[number], &plane[other]);
                        let angle = n.cross(m).norm().atan2(n.dot(m));
                        if angle < EDGE {
                            let apart = b - a;
                            let turn = 2.0 * (0.5 * angle).sin() / apart.norm();
                            curvature += turn.copysign((m - n).dot(&apart));
                            count += 1.0;
                        }
                    }
                }
                let length = (middle(sides[2 * k + 1]) - middle(sides[2 * k])).norm();
                match count > 0.0 {
                    true => curvature / count * length * length / 8.0,
                    false => 0.0,
                }
            })
        });
        Some(Sagittas {
            of: of.collect(),
            numbers: (corners.iter().enumerate())
                .map(|(i, c)| (key(*c), i))
                .collect(),
        })
    }

    /// How far a point of a face lies below the surface.
    fn at(&self, face: usize, xi: [f64; 2]) -> f64 {
        let bow = self.of.get(face).copied().unwrap_or_default();
        [0, 1].map(|k| bow[k] * (1.0 - xi[k] * xi[k])).iter().sum()
    }
}

/// A warning of overclosures that the facets of a pair change by more than one per cent; `overclosures` are the gaps of its
/// points at the start, zero or negative.
pub(super) fn beside(model: &Model, index: usize, overclosures: &[f64]) -> Option<String> {
    let pair = &model.pairs[index];
    if pair.body_master().is_some_and(|m| m.own.is_some()) {
        return None;
    }
    let found = Sums::new(model, index, pair, overclosures)?;
    let truly = found.overclosed - found.added;
    let share = found.added / truly;
    if share.abs() <= WARNED && truly > 0.0 {
        return None;
    }
    let mean = |sum: f64| number(sum / found.area);
    let off = match truly > 0.0 && share < 1.0 {
        true => format!("that is wrong by about {:+.1} %", 100.0 * share),
        false => "that is most of it, or all".to_owned(),
    };
    Some(format!(
        "contact `{}`: flat facets stand for curved faces, up to {} off them, and change the overclosure at the start by {} on \
         the mean, which is {}: {off}, and pressures with it. Use finer faces, element `q18`, or the same nodes on both sides",
        pair.name,
        number(found.largest),
        mean(found.added),
        mean(found.overclosed),
    ))
}

/// Sums over the points that start with an overclosure.
#[derive(Default)]
struct Sums {
    /// Overclosure by area (volume).
    overclosed: f64,
    /// The part of it that facets add, negative where they take away (volume).
    added: f64,
    area: f64,
    /// Largest distance of a facet from its surface at such a point (length).
    largest: f64,
}

impl Sums {
    fn new(model: &Model, index: usize, pair: &PairModel, overclosures: &[f64]) -> Option<Sums> {
        let body = &model.bodies[pair.body];
        let slave = Sagittas::new(&body.mesh, &pair.faces);
        let master = (pair.body_master())
            .filter(|m| !m.smooth && model.bodies[m.body].block.sheet().is_none())
            .and_then(|m| Sagittas::new(&model.bodies[m.body].mesh, &m.faces));
        if slave.is_none() && master.is_none() {
            return None;
        }
        let zero = vec![0.0; 3 * model.nodes.len()];
        let masters = Masters::new(model);
        let at_start = masters.at(model, index, &zero, 0.0).ok()?;
        let mut sums = Sums::default();
        let points = pair.points.iter().zip(overclosures).enumerate();
        for (i, (p, gap)) in points.filter(|(_, (_, gap))| **gap < 0.0) {
            let mut below = 0.0;
            if let (Some(slave), 4) = (&slave, p.count) {
                let corners = [0, 1, 2, 3].map(|k| p.nodes[k] - body.first_node);
                let [a, b, c, d] = [0, 1, 2, 3].map(|k| p.shape[k]);
                let xi = [b + d - a - c, c + d - a - b];
                below += (slave.numbers.get(&key(corners))).map_or(0.0, |f| slave.at(*f, xi));
            }
            if let (Some(facets), Some(master)) = (&master, pair.body_master()) {
                let x = model.point_position(p, &zero);
                let seen = at_start.see(i, &x, None)?;
                let face = master.facets.source(seen.hint.patch);
                below += facets.at(face as usize, seen.hint.xi);
            }
            sums.overclosed -= gap * p.area;
            sums.added -= below * p.area;
            sums.area += p.area;
            sums.largest = sums.largest.max(below.abs());
        }
        (sums.area > 0.0).then_some(sums)
    }
}
