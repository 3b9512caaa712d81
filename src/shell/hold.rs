//! Whether elements with assumed and enhanced strains lose their hold where they are squeezed.
//!
//! Shear strains that are assumed to be constant along an edge leave the tilting of the directors at its two ends against each
//! other to their bending alone, of stiffness `E (t / h)^2 / 3`, while a pressure through the thickness works on it in full; in the
//! plane the enhanced strains do the like (P. Wriggers and S. Reese, CMAME 135 (1996)). Under strong compression such an element
//! gives way in shapes in which the plain brick of the same corners is stable: the element does, not the structure.
use super::ElementFault;
use super::h8::{Formulation, H8Block, H8System};
use covact_geometry::Vec3;
use nalgebra::{SMatrix, SVector, SymmetricEigen};

type Matrix = SMatrix<f64, 24, 24>;

/// Part of the largest eigenvalue below which a negative one is rounding.
const ROUNDING: f64 = 1e-9;

impl H8Block {
    /// Whether element `e` has more shapes at nodal displacements `u` in which it gives way than the plain brick has there. Not
    /// asked of elements whose material flows, which softens them in many shapes.
    /// `state` as for [`H8Block::evaluate`], of which the enhanced strains are read.
    ///
    /// # Errors
    /// [`ElementFault`] where the strain is impossible.
    pub fn loses_hold(&self, e: usize, u: &[Vec3; 8], state: &[f64]) -> Result<bool, ElementFault> {
        if matches!(
            self.formulation(),
            Formulation::Displacement | Formulation::Layered
        ) {
            return Ok(false);
        }
        let mut system = H8System::default();
        let mut state = state.to_vec();
        self.evaluate(e, u, &mut state, &mut system)?;
        let own = unstable(&system, &self.corners(e, u));
        if own == 0 {
            return Ok(false);
        }
        self.evaluate_plain(e, u, &state, &mut system)?;
        Ok(own > unstable(&system, &self.corners(e, u)))
    }
}

/// Number of shapes of an element with corners at `x` that lower its energy, rigid motions left out: stresses that are not
/// in equilibrium within one element work on those.
fn unstable(system: &H8System, x: &[Vec3; 8]) -> usize {
    let middle = x.iter().sum::<Vec3>() / 8.0;
    let mut rigid: Vec<SVector<f64, 24>> = Vec::with_capacity(6);
    for k in 0..6 {
        let axis = Vec3::ith(k % 3, 1.0);
        let mut motion = SVector::<f64, 24>::zeros();
        for (n, x) in x.iter().enumerate() {
            let way = if k < 3 {
                axis
            } else {
                axis.cross(&(x - middle))
            };
            motion.fixed_rows_mut::<3>(3 * n).copy_from(&way);
        }
        for before in &rigid {
            motion -= before * before.dot(&motion);
        }
        rigid.extend(motion.try_normalize(0.0));
    }
    let k = Matrix::from_column_slice(&system.k);
    // Of laws whose tangents are not symmetric the symmetric part, which does the work.
    let mut k = (k + k.transpose()) * 0.5;
    for motion in &rigid {
        let less = Matrix::identity() - motion * motion.transpose();
        k = less * k * less;
    }
    let values = SymmetricEigen::new(k).eigenvalues;
    let limit = ROUNDING * values.amax();
    values.iter().filter(|v| **v < -limit).count()
}

#[cfg(test)]
mod tests {
    use super::super::Law;
    use super::super::tests::mesh;
    use super::*;
    use crate::scene::{Elastic, Material};

    /// One element of the given height on a unit square, shortened along z by a part of its height, the rest free to widen.
    fn squeezed(height: f64, part: f64, nu: f64) -> bool {
        let at = |a: usize, [x, y, z]: [f64; 3]| {
            let bit = |k: usize| f64::from(u8::from(a >> k & 1 == 1));
            Vec3::new(x * bit(0), y * bit(1), z * bit(2))
        };
        let nodes = std::array::from_fn(|a| at(a, [1.0, 1.0, height]));
        let law = Law::new(&Material::NeoHooke(Elastic {
            e: 5.0,
            nu,
            density: None,
        }))
        .unwrap();
        let block = H8Block::new(&mesh(&nodes), Formulation::Eas7, law).unwrap();
        let wide = (1.0 - part).powf(-nu);
        let now = |a: usize| at(a, [wide, wide, height * (1.0 - part)]);
        let u = std::array::from_fn(|a| now(a) - nodes[a]);
        block
            .loses_hold(0, &u, &vec![0.0; block.state_len()])
            .unwrap()
    }

    #[test]
    fn flat_elements_lose_their_hold_first() {
        // About E (t / h)^2 / 3 for flat ones; cubes give way at 13 %, where 2 x 2 x 2 of them have a negative pivot (14 %).
        for (height, holds, gives) in [(0.25, 0.01, 0.04), (0.5, 0.02, 0.08), (1.0, 0.1, 0.2)] {
            assert!(!squeezed(height, holds, 0.3), "{height}");
            assert!(squeezed(height, gives, 0.3), "{height}");
        }
        assert!(!squeezed(0.25, -0.3, 0.3), "pulled");
    }
}
