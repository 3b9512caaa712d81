//! Stresses at the points and nodes of an element.
use super::{Formulation, H8Block, arrays, fault, head};
use crate::shell::error::ElementFault;
use crate::shell::history::cauchy;
use crate::shell::kinematics::{self, Fields};
use crate::shell::material::{Collapsed, with_law};
use crate::shell::reference::Reference;
use crate::shell::{brick, layered, mean_dilatation, stress};
use covact_geometry::Vec3;

impl H8Block {
    /// Cauchy stress (xx, yy, zz, xy, yz, xz) at the Gauss points `i + 2 j + 4 k`, those of [`Formulation::Layered`] being
    /// the lowest and the highest of each column. It is consistent with the assumed and enhanced strain: pushed forward
    /// with `F = R U`, U being the root of the modified C and R the rotation of the element's own deformation gradient.
    ///
    /// # Errors
    /// [`ElementFault`] where the strain is impossible.
    pub fn stresses(
        &self,
        e: usize,
        u: &[Vec3; 8],
        state: &[f64],
        out: &mut [[f64; 6]; 8],
    ) -> Result<(), ElementFault> {
        if self.formulation == Formulation::Layered {
            for (out, [at, _]) in out.iter_mut().zip(self.layered_stresses(e, u, state)?) {
                *out = at;
            }
            return Ok(());
        }
        let u = arrays(u);
        let re = &self.reference[e];
        let (big, du) = (Fields::new(&re.nodes), Fields::new(&u));
        let strain = self
            .strains(re, (&big, &du), state)
            .map_err(|(point, c)| fault(e, point, c))?;
        let states = &state[self.condensation_len().min(state.len())..];
        for g in 0..8 {
            out[g] = with_law!(&self.law, law => cauchy(
                law, (&re.metric[g], g), &big.at(g), &du.at(g), &strain[g], states
            ))
            .map_err(|c| fault(e, g as u8, c))?;
        }
        Ok(())
    }

    /// The same at the nodes.
    ///
    /// # Errors
    /// [`ElementFault`] where the strain is impossible.
    pub fn nodal_stresses(
        &self,
        e: usize,
        u: &[Vec3; 8],
        state: &[f64],
    ) -> Result<[[f64; 6]; 8], ElementFault> {
        if self.formulation == Formulation::Layered {
            return Ok(layered::to_nodes(&self.layered_stresses(e, u, state)?));
        }
        let mut points = [[0.0; 6]; 8];
        self.stresses(e, u, state, &mut points)?;
        Ok(stress::extrapolate(&points))
    }

    pub(super) fn strains(
        &self,
        re: &Reference,
        (big, du): (&Fields<f64>, &Fields<f64>),
        state: &[f64],
    ) -> Result<[[f64; 6]; 8], (u8, Collapsed)> {
        let shares = self.shares(state);
        Ok(match self.formulation {
            Formulation::Eas7 => kinematics::strains(re, big, du, &head::<7>(state), shares),
            Formulation::Eas3 => kinematics::strains(re, big, du, &head::<3>(state), shares),
            Formulation::Eas0 => kinematics::strains(re, big, du, &[], shares),
            Formulation::MeanDilatation => return mean_dilatation::strains(re, big, du),
            // Strains of layered elements are taken at other points.
            Formulation::Displacement | Formulation::Layered => {
                std::array::from_fn(|g| brick::strain(&big.at(g), &du.at(g)))
            }
        })
    }
}
