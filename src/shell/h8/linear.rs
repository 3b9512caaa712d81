//! Stresses of linear elements.
use super::{Formulation, H8Block, arrays, dual_head, fault};
use crate::shell::error::ElementFault;
use crate::shell::kinematics::{self, Fields};
use crate::shell::material::with_law;
use crate::shell::{brick, layered, mean_dilatation, stress};
use covact_geometry::Vec3;

impl H8Block {
    /// Stress of the linear element (xx, yy, zz, xy, yz, xz) at the Gauss points `i + 2 j + 4 k`: Hooke's law on the linear
    /// part of the assumed and enhanced strain. `alpha` are the enhanced strains that belong to `u`.
    ///
    /// # Errors
    /// [`ElementFault`] where the law has no stiffness.
    pub fn linear_stresses(
        &self,
        e: usize,
        u: &[Vec3; 8],
        alpha: &[f64],
        out: &mut [[f64; 6]; 8],
    ) -> Result<(), ElementFault> {
        let u = stress::from_zero(&arrays(u));
        let re = &self.reference[e];
        if self.formulation == Formulation::Layered {
            let alpha = dual_head(alpha);
            let strains = layered::Strains::new(&re.nodes, &u, &alpha);
            for (corner, out) in out.iter_mut().enumerate() {
                let [g, _] = layered::outer(corner);
                let (place, _, strain) = strains.at(g);
                *out = with_law!(&self.law, law => stress::linear(
                    law, &place.metric, &place.frame, &strain
                ))
                .map_err(|c| fault(e, g as u8, c))?;
            }
            return Ok(());
        }
        let (big, du) = (Fields::new(&re.nodes), Fields::new(&u));
        let strain = match self.formulation {
            Formulation::Eas7 => {
                kinematics::strains(re, &big, &du, &dual_head::<7>(alpha), [0.0; 2])
            }
            Formulation::Eas3 => {
                kinematics::strains(re, &big, &du, &dual_head::<3>(alpha), [0.0; 2])
            }
            Formulation::Eas0 => kinematics::strains(re, &big, &du, &[], [0.0; 2]),
            Formulation::MeanDilatation => {
                mean_dilatation::strains(re, &big, &du).map_err(|(point, c)| fault(e, point, c))?
            }
            Formulation::Displacement | Formulation::Layered => {
                std::array::from_fn(|g| brick::strain(&big.at(g), &du.at(g)))
            }
        };
        for g in 0..8 {
            out[g] = with_law!(&self.law, law => stress::linear(
                law, &re.metric[g], &big.at(g), &strain[g]
            ))
            .map_err(|c| fault(e, g as u8, c))?;
        }
        Ok(())
    }
}
