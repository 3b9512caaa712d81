//! Which slave points carry the force of a contact, and what its penalty stores: sums over the points of a pair that
//! [`super::fields::Fields::gather`] makes of what it knows of every point.
use crate::contact::points::SlavePoint;
use crate::model::penalty::Ruled;
use crate::model::sharp::{Lines, SharpEdges};
use crate::model::{Model, sharp};
use covact_geometry::{Hint, Vec3};
use std::collections::{BTreeMap, BTreeSet};

/// Points that carry most of a force are few up to one less than this number.
pub const FEW: usize = 5;
/// Part of a force that is most of it.
const MOST: f64 = 0.9;
/// A component of a unit normal below this does not matter.
const NO_COMPONENT: f64 = 1e-3;

/// A point in contact.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Deepest {
    /// Penetration (length, `> 0`).
    pub depth: f64,
    /// The point in space.
    pub x: Vec3,
    /// Outward unit normal of the master.
    pub normal: Vec3,
}

/// The point near a sharp convex edge of the master that carries most there.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AtEdge {
    /// Pressure times area (force).
    pub force: f64,
    /// The point in space.
    pub x: Vec3,
    /// Outward unit normal of the master.
    pub normal: Vec3,
}

/// Sums over the points of a pair in contact.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Bearing {
    /// Half of pressure times gap, whatever its sign, without points whose penetration is prescribed (energy).
    pub energy: f64,
    /// Pressure times area (force).
    pub force: f64,
    /// Area of the points in contact.
    pub area: f64,
    /// Sum of pressure times force: over the force, the pressure under which it is carried on average (force^2 / length^2).
    pub squared: f64,
    /// The part of it near sharp convex edges of the master (force).
    pub at_edges: f64,
    /// The point that carries most of that part.
    pub at_edge: Option<AtEdge>,
    /// The part of it near these or near free borders of the master (force).
    pub at_rims: f64,
    /// The part of it at points whose penetration is prescribed (force).
    pub prescribed: f64,
    /// Points in contact, or nodes where gaps are averaged.
    pub active: usize,
    /// The largest forces of single points, in descending order.
    largest: [f64; FEW - 1],
    /// The point that is deepest below the master, without those whose penetration is prescribed.
    pub deepest: Option<Deepest>,
    /// The largest penetration of these points relative to what is too deep there, where the run chooses the penalty.
    pub sunk: f64,
}

impl Bearing {
    /// Takes the force of a point, or of points side by side, to the largest ones.
    fn rank(&mut self, mut force: f64) {
        for largest in &mut self.largest {
            if force > *largest {
                std::mem::swap(&mut force, largest);
            }
        }
    }

    /// Number of points that carry most of the force where these are few; none where they are not, or nothing is carried.
    pub fn few(&self) -> Option<usize> {
        let mut sum = 0.0;
        for (i, force) in self.largest.iter().enumerate() {
            sum += force;
            if self.force > 0.0 && sum >= MOST * self.force {
                return Some(i + 1);
            }
        }
        None
    }
}

/// A slave point or node in contact at an accepted state.
pub struct Carrier<'a> {
    /// Its number among those of the pair.
    pub index: usize,
    pub pressure: f64,
    pub gap: f64,
    pub area: f64,
    /// Share of the pair in the energy of its contact.
    pub share: f64,
    /// Where it is, for points.
    pub place: Option<Place<'a>>,
}

/// Where a slave point is.
pub struct Place<'a> {
    pub point: &'a SlavePoint,
    pub x: Vec3,
    /// The same in the coordinates of a rigid master.
    pub local: Vec3,
    pub hint: Hint,
    /// Outward unit normal of the master.
    pub normal: Vec3,
}

/// Sums of all pairs, and what they need of the model.
pub struct Bearings {
    pub pairs: Vec<Bearing>,
    /// Largest von Mises stress of every body of a metal of known strength, 0 for others; empty where there are none.
    pub stress: Vec<f64>,
    /// Per node, which components of its displacement are prescribed, as bits.
    prescribed: Vec<u8>,
    /// Per pair: the master moves as prescribed.
    given: Vec<bool>,
    /// Per pair, the sharp convex edges of a rigid master.
    edges: Vec<Option<SharpEdges>>,
    /// Per pair, the free borders of a rigid master, and the distance of slave points.
    borders: Vec<Option<(Lines, f64)>>,
    /// Per pair, the rows of its points across a strip.
    rows: Vec<Option<Rows>>,
}

/// Points of a slave that is one or two elements wide, as plane strain is modelled: those side by side stand for one place.
struct Rows {
    /// The row of every point.
    of: Vec<u32>,
    /// What the points of every row carry (force).
    forces: Vec<f64>,
}

impl Rows {
    /// Places along a direction of a strip.
    const WIDE: usize = 3;

    /// None where the points lie side by side in no direction.
    fn of(points: &[Vec3], spacing: f64) -> Option<Self> {
        let near = 1e-3 * spacing;
        let key = |x: &Vec3, k: usize| (x[k] / near).round() as i64;
        let (axis, _) = (0..3)
            .map(|k| {
                (
                    k,
                    points
                        .iter()
                        .map(|x| key(x, k))
                        .collect::<BTreeSet<_>>()
                        .len(),
                )
            })
            .filter(|(_, places)| (2..=Self::WIDE).contains(places))
            .min_by_key(|(_, places)| *places)?;
        let mut numbers = BTreeMap::new();
        let row = |x: &Vec3| {
            let place = [(axis + 1) % 3, (axis + 2) % 3].map(|k| key(x, k));
            let next = numbers.len() as u32;
            *numbers.entry(place).or_insert(next)
        };
        let of: Vec<u32> = points.iter().map(row).collect();
        // Points that have nobody beside them make no strip.
        let rows = numbers.len();
        (2 * rows <= of.len()).then(|| Rows {
            of,
            forces: vec![0.0; rows],
        })
    }
}

impl Bearings {
    /// Pressure times area of all pairs (force).
    pub fn force(&self) -> f64 {
        self.pairs.iter().map(|pair| pair.force).sum()
    }

    pub fn new(model: &Model) -> Self {
        let mut prescribed = vec![0; model.nodes.len()];
        for p in &model.prescribed {
            prescribed[p.dof as usize / 3] |= 1 << (p.dof % 3);
        }
        let pairs = model.pairs.iter();
        let surface = |p: &crate::model::PairModel| p.rigid_master().map(|s| &model.surfaces[s]);
        let start = vec![0.0; 3 * model.nodes.len()];
        Bearings {
            stress: Vec::new(),
            pairs: vec![Bearing::default(); model.pairs.len()],
            prescribed,
            given: (pairs.clone())
                .map(|p| surface(p).is_some_and(|s| s.driven.is_none()))
                .collect(),
            edges: (pairs.clone())
                .map(|p| SharpEdges::of(surface(p)?))
                .collect(),
            borders: (pairs.clone())
                .map(|p| {
                    let borders = Lines::borders(surface(p)?);
                    Some((borders, sharp::spacing(model, p)))
                })
                .collect(),
            rows: pairs
                .map(|p| {
                    let at = |point| model.point_position(point, &start);
                    let places: Vec<Vec3> = match &p.averaged {
                        Some(_) => Vec::new(),
                        None => p.points.iter().map(at).collect(),
                    };
                    Rows::of(&places, sharp::spacing(model, p))
                })
                .collect(),
        }
    }

    /// Ends a gathering: what rows of points carry.
    pub fn end(&mut self) {
        for (sum, rows) in self.pairs.iter_mut().zip(&mut self.rows) {
            for force in rows.iter_mut().flat_map(|rows| &mut rows.forces) {
                sum.rank(std::mem::take(force));
            }
        }
    }

    /// Forgets the last state.
    pub fn clear(&mut self) {
        self.pairs.fill(Bearing::default());
    }

    /// Adds a point or node of a pair that is in contact.
    pub fn add(&mut self, model: &Model, pair: usize, carrier: &Carrier) {
        let Carrier {
            index,
            pressure,
            gap,
            area,
            share,
            place,
        } = carrier;
        let sum = &mut self.pairs[pair];
        let force = pressure * area;
        sum.active += 1;
        sum.force += force;
        match &mut self.rows[pair] {
            // Segments are cut anew in every step, and their points are not those of the model.
            Some(rows) if *index < rows.of.len() => rows.forces[rows.of[*index] as usize] += force,
            _ => sum.rank(force),
        }
        sum.area += area;
        sum.squared += force * pressure;
        let energy = 0.5 * share * (force * gap).abs();
        let Some(place) = place else {
            sum.energy += energy;
            return;
        };
        let mut at_edge = false;
        if let Some((borders, reach)) = &self.borders[pair] {
            let (patch, x) = (place.hint.patch, &place.local);
            let sharp = (self.edges[pair].as_ref()).is_some_and(|e| e.near(patch, x, *reach));
            at_edge = sharp;
            if sharp {
                sum.at_edges += force;
                if force > sum.at_edge.map_or(0.0, |most| most.force) {
                    sum.at_edge = Some(AtEdge {
                        force,
                        x: place.x,
                        normal: place.normal,
                    });
                }
            }
            if sharp || borders.near(patch, x, *reach) {
                sum.at_rims += force;
            }
        }
        if self.given[pair] && is_prescribed(&self.prescribed, place.point, &place.normal) {
            sum.prescribed += force;
            return;
        }
        sum.energy += energy;
        if let Some(ruled) = &model.pairs[pair].ruled {
            sum.sunk = sum
                .sunk
                .max(-gap / limit(model, pair, ruled, place.hint, at_edge));
        }
        if -gap > sum.deepest.map_or(0.0, |d| d.depth) {
            sum.deepest = Some(Deepest {
                depth: -gap,
                x: place.x,
                normal: place.normal,
            });
        }
    }
}

/// Penetration that is too deep at a point of a pair.
fn limit(model: &Model, pair: usize, ruled: &Ruled, hint: Hint, at_edge: bool) -> f64 {
    let surface = model.pairs[pair].rigid_master();
    let surface = surface.filter(|_| ruled.released.is_some() && !at_edge);
    ruled.limit(surface.map_or(0.0, |s| model.surfaces[s].radius_at(hint)))
}

/// Whether supports prescribe the displacement of a point along a direction.
fn is_prescribed(prescribed: &[u8], point: &SlavePoint, along: &Vec3) -> bool {
    let needed = (0..3).filter(|&c| along[c].abs() > NO_COMPONENT);
    let needed = needed.fold(0, |bits, c| bits | 1 << c);
    // Along a height above a mid-surface nothing prescribes a point.
    point.lever_number().is_none()
        && (point.terms()).all(|(node, w)| w == 0.0 || prescribed[node] & needed == needed)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn few_points_are_counted_by_what_they_carry() {
        let of = |forces: &[f64]| {
            let mut sum = Bearing::default();
            for force in forces {
                sum.force += force;
                sum.rank(*force);
            }
            sum.few()
        };
        assert_eq!(of(&[]), None);
        assert_eq!(of(&[3.0]), Some(1));
        assert_eq!(of(&[0.1, 0.05, 3.0, 0.1]), Some(1));
        assert_eq!(of(&[1.0, 2.0, 0.2, 0.05]), Some(2));
        assert_eq!(of(&[1.0; 4]), Some(4));
        assert_eq!(of(&[1.0; 5]), None);
        assert_eq!(of(&[1.0, 1.0, 1.0, 1.0, 0.4]), Some(4));
    }

    /// A strip of two rows is one of places; a face of as many points along both directions is none.
    #[test]
    fn points_side_by_side_are_one_place() {
        let grid = |n: usize, m: usize| -> Vec<Vec3> {
            let at = |i: usize| Vec3::new((i % n) as f64, (i / n) as f64, 0.1 * (i % n) as f64);
            (0..n * m).map(at).collect()
        };
        let strip = Rows::of(&grid(9, 2), 1.0).expect("rows");
        assert_eq!(
            (strip.forces.len(), strip.of[3], strip.of[9 + 3]),
            (9, 3, 3)
        );
        assert!(Rows::of(&grid(9, 5), 1.0).is_none());
        assert!(Rows::of(&grid(1, 9), 1.0).is_none());
        assert!(Rows::of(&[], 1.0).is_none());
    }
}
