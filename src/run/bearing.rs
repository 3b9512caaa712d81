//! Which slave points carry the force of a contact, and what its penalty stores: sums over the points of a pair that
//! [`super::fields::Fields::gather`] makes of what it knows of every point.
use crate::contact::points::SlavePoint;
use crate::model::sharp::{Lines, SharpEdges};
use crate::model::{Model, sharp};
use covact_geometry::{Hint, Vec3};

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

/// Sums over the points of a pair in contact.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Bearing {
    /// Half of pressure times gap, whatever its sign, without points whose penetration is prescribed (energy).
    pub energy: f64,
    /// Pressure times area (force).
    pub force: f64,
    /// Area of the points in contact.
    pub area: f64,
    /// The part of it near sharp convex edges of the master (force).
    pub at_edges: f64,
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
}

impl Bearing {
    /// Adds the force of a point.
    fn add(&mut self, mut force: f64) {
        self.active += 1;
        self.force += force;
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
            borders: pairs
                .map(|p| {
                    let borders = Lines::borders(surface(p)?);
                    Some((borders, sharp::spacing(model, p)))
                })
                .collect(),
        }
    }

    /// Forgets the last state.
    pub fn clear(&mut self) {
        self.pairs.fill(Bearing::default());
    }

    /// Adds a point or node of a pair that is in contact.
    pub fn add(&mut self, pair: usize, carrier: &Carrier) {
        let Carrier {
            pressure,
            gap,
            area,
            share,
            place,
        } = carrier;
        let sum = &mut self.pairs[pair];
        let force = pressure * area;
        sum.add(force);
        sum.area += area;
        let energy = 0.5 * share * (force * gap).abs();
        let Some(place) = place else {
            sum.energy += energy;
            return;
        };
        if let Some((borders, reach)) = &self.borders[pair] {
            let (patch, x) = (place.hint.patch, &place.local);
            let sharp = (self.edges[pair].as_ref()).is_some_and(|e| e.near(patch, x, *reach));
            if sharp {
                sum.at_edges += force;
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
        if -gap > sum.deepest.map_or(0.0, |d| d.depth) {
            sum.deepest = Some(Deepest {
                depth: -gap,
                x: place.x,
                normal: place.normal,
            });
        }
    }
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
            forces.iter().for_each(|f| sum.add(*f));
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
}
