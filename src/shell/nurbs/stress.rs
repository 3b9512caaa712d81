//! Stresses of a sheet.
use super::super::error::{ElementFault, FaultCause};
use super::super::kinematics::V;
use super::frame::NODES;
use super::plane_stress::PlaneStress;
use super::point::PLAIN;
use super::strain::Strains;
use super::{NurbsBlock, fault, with_sheet};
use crate::fem::gauss;
use crate::mesh::nurbs::Kept;
use covact_geometry::Vec3;

/// Membrane forces and moments of an element per undeformed length, Cartesian, in its mean.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct SheetResultants {
    /// `n^ij rho_i rho_j` over the current area: xx, yy, zz, xy, yz, xz.
    pub membrane: [f64; 6],
    /// `m^ij rho_i rho_j` likewise.
    pub moment: [f64; 6],
    /// Current thickness over the undeformed one.
    pub thinning: f64,
}

impl NurbsBlock {
    /// Mean over an element of the resultants at its Gauss points, weighted by area.
    ///
    /// # Errors
    /// [`ElementFault`] where the strain is impossible.
    pub fn mean_resultants(
        &self,
        e: usize,
        u: &[Vec3; NODES],
    ) -> Result<SheetResultants, ElementFault> {
        let u: [V<f64>; NODES] = u.map(Into::into);
        let groups = self.groups_of(e);
        let points = groups.clone().flat_map(|group| self.gauss(group));
        let area: f64 = points.map(|p| p.weight).sum();
        let mut out = SheetResultants::default();
        for group in groups {
            let strains = Strains::new(self, group, &u);
            with_sheet!(&self.plane, law => self.mean(group, &strains, law, area, &mut out))
                .map_err(|cause| fault(e, cause))?;
        }
        Ok(out)
    }

    /// Adds the share of a group in the mean over an element of this area.
    fn mean<L: PlaneStress>(
        &self,
        group: usize,
        strains: &Strains<f64>,
        law: &L,
        area: f64,
        out: &mut SheetResultants,
    ) -> Result<(), FaultCause> {
        let all = self.at_points(group, strains, law)?;
        for (point, p) in all.iter().zip(self.gauss(group)) {
            out.add(point, p.weight / area);
        }
        Ok(())
    }

    /// The resultants at the Gauss points; only the first are used.
    fn at_points<L: PlaneStress>(
        &self,
        group: usize,
        strains: &Strains<f64>,
        law: &L,
    ) -> Result<[SheetResultants; PLAIN], FaultCause> {
        let mut out = [SheetResultants::default(); PLAIN];
        for (g, p) in self.gauss(group).iter().enumerate() {
            let (_, r) = law.resultants(g, &p.place, &strains.strains[g])?;
            let at = &strains.frames[g].at;
            let [a11, a22, a12] = p.place.metric;
            let stretch = at.area / (a11 * a22 - a12 * a12).sqrt();
            let push = |s: &[f64]| {
                TENSOR.map(|(i, j)| {
                    let [u, v] = &at.r;
                    let mixed = u[i] * v[j] + v[i] * u[j];
                    (s[0] * u[i] * u[j] + s[1] * v[i] * v[j] + s[2] * mixed) / stretch
                })
            };
            out[g] = SheetResultants {
                membrane: push(&r[..3]),
                moment: push(&r[3..]),
                thinning: law.thinning(&p.place, &strains.strains[g]),
            };
        }
        Ok(out)
    }

    /// Cauchy stress of the bottom and the top at places in [0, 1]^2 of an element: linear through the current thickness, with
    /// resultants extended from the Gauss points; their mean in an element that a trim cuts, nothing where it leaves none.
    ///
    /// # Errors
    /// As [`Self::mean_resultants`].
    pub fn face_stresses(
        &self,
        e: usize,
        u: &[Vec3; NODES],
        places: &[[f64; 2]],
    ) -> Result<Vec<[[f64; 6]; 2]>, ElementFault> {
        let faces = |at: &SheetResultants| {
            let thickness = self.sheet.thickness * at.thinning;
            [-6.0, 6.0].map(|far| {
                std::array::from_fn(|c| {
                    at.membrane[c] / thickness + far * at.moment[c] / (thickness * thickness)
                })
            })
        };
        match self.sheet.kept(e) {
            Kept::Whole => {}
            Kept::Part(_) => return Ok(vec![faces(&self.mean_resultants(e, u)?); places.len()]),
            Kept::Nothing => return Ok(vec![[[0.0; 6]; 2]; places.len()]),
        }
        let u: [V<f64>; NODES] = u.map(Into::into);
        let group = self.groups_of(e).start;
        let strains = Strains::new(self, group, &u);
        let points = with_sheet!(&self.plane, law => self.at_points(group, &strains, law))
            .map_err(|cause| fault(e, cause))?;
        let side = if self.per == PLAIN { 4 } else { 3 };
        let rule = gauss(side).expect("a rule of three or four points exists");
        let nodes: Vec<f64> = rule.points().iter().map(|s| 0.5 * (1.0 + s)).collect();
        let out = places.iter().map(|[s, t]| {
            let (along, across) = (lagrange(&nodes, *s), lagrange(&nodes, *t));
            let mut at = SheetResultants::default();
            for (g, point) in points[..self.per].iter().enumerate() {
                at.add(point, along[g % side] * across[g / side]);
            }
            faces(&at)
        });
        Ok(out.collect())
    }

    /// Cauchy stress of the mid-surface: membrane forces over the current thickness.
    ///
    /// # Errors
    /// As [`Self::mean_resultants`].
    pub fn mean_stress(&self, e: usize, u: &[Vec3; NODES]) -> Result<[f64; 6], ElementFault> {
        if *self.sheet.kept(e) == Kept::Nothing {
            return Ok([0.0; 6]);
        }
        let mean = self.mean_resultants(e, u)?;
        let thickness = self.sheet.thickness * mean.thinning;
        Ok(mean.membrane.map(|n| n / thickness))
    }
}

/// Places of the components xx, yy, zz, xy, yz, xz.
const TENSOR: [(usize, usize); 6] = [(0, 0), (1, 1), (2, 2), (0, 1), (1, 2), (0, 2)];

impl SheetResultants {
    fn add(&mut self, other: &SheetResultants, part: f64) {
        for c in 0..6 {
            self.membrane[c] += part * other.membrane[c];
            self.moment[c] += part * other.moment[c];
        }
        self.thinning += part * other.thinning;
    }
}

/// The polynomials that are one at one of the nodes and zero at the others.
fn lagrange(nodes: &[f64], s: f64) -> Vec<f64> {
    let of = |i: usize| {
        let others = nodes.iter().enumerate().filter(|(j, _)| *j != i);
        others.map(|(_, x)| (s - x) / (nodes[i] - x)).product()
    };
    (0..nodes.len()).map(of).collect()
}
