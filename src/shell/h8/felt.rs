//! The volume that an element's strains amount to, beside that between its corners.
use super::{Formulation, H8Block, arrays, fault, head};
use crate::shell::error::ElementFault;
use crate::shell::kinematics::{Fields, V};
use crate::shell::layered;
use crate::shell::material::{Collapsed, Metric, inverse};
use crate::shell::reference::det;
use covact_geometry::Vec3;

impl H8Block {
    /// Volume between the corners of element `e` at nodal displacements `u`.
    pub fn volume_between(&self, e: usize, u: &[Vec3; 8]) -> f64 {
        let x: [V<f64>; 8] = arrays(&self.corners(e, u));
        let fields = Fields::new(&x);
        // Gauss points have a weight of one each.
        (0..8).map(|g| det(&fields.at(g))).sum()
    }

    /// Volume of element `e` that its material feels there: that of the assumed and enhanced strains. `state` as for
    /// [`H8Block::evaluate`].
    ///
    /// # Errors
    /// [`ElementFault`] where the strain is impossible.
    pub fn volume_felt(&self, e: usize, u: &[Vec3; 8], state: &[f64]) -> Result<f64, ElementFault> {
        let re = &self.reference[e];
        let mut sum = 0.0;
        if self.formulation == Formulation::Layered {
            let strains = layered::Strains::new(&re.nodes, &arrays(u), &head(state));
            for g in 0..layered::POINTS {
                let (place, _, strain) = strains.at(g);
                sum += place.volume
                    * ratio(&place.metric, &strain).map_err(|c| fault(e, g as u8, c))?;
            }
            return Ok(sum);
        }
        let (big, du) = (Fields::new(&re.nodes), Fields::new(&arrays(u)));
        let strains = self
            .strains(re, (&big, &du), state)
            .map_err(|(point, c)| fault(e, point, c))?;
        for (g, strain) in strains.iter().enumerate() {
            sum += re.volume[g] * ratio(&re.metric[g], strain).map_err(|c| fault(e, g as u8, c))?;
        }
        Ok(sum)
    }
}

/// Change of volume of a covariant strain.
fn ratio(metric: &Metric, strain: &[f64; 6]) -> Result<f64, Collapsed> {
    let mut c = metric.lower;
    for (v, (c, e)) in c.iter_mut().zip(strain).enumerate() {
        *c += if v < 3 { 2.0 * e } else { *e };
    }
    let ratio = inverse(&c).1 / inverse(&metric.lower).1;
    match ratio > 0.0 {
        true => Ok(ratio.sqrt()),
        false => Err(Collapsed { ratio }),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{Elastic, Material};
    use crate::shell::Law;
    use crate::shell::tests::mesh;

    /// A unit cube about the origin whose corners `at` moves: the volume between them, and the one that it feels.
    fn volumes(formulation: Formulation, at: impl Fn(Vec3) -> Vec3) -> [f64; 2] {
        let half = |a: usize, bit: usize| f64::from(u8::from(a >> bit & 1 == 1)) - 0.5;
        let nodes = std::array::from_fn(|a| Vec3::new(half(a, 0), half(a, 1), half(a, 2)));
        let law = Law::new(&Material::NeoHooke(Elastic {
            e: 1.0,
            nu: 0.3,
            density: None,
        }))
        .unwrap();
        let block = H8Block::new(&mesh(&nodes), formulation, law).unwrap();
        let u = std::array::from_fn(|a| at(nodes[a]) - nodes[a]);
        let state = vec![0.0; block.state_len()];
        let felt = block.volume_felt(0, &u, &state).unwrap();
        [block.volume_between(0, &u), felt]
    }

    #[test]
    fn a_uniform_strain_is_felt() {
        for formulation in [
            Formulation::Eas7,
            Formulation::Layered,
            Formulation::Displacement,
        ] {
            let [between, felt] = volumes(formulation, |x| {
                Vec3::new(1.2 * x.x + 0.3 * x.z, 0.9 * x.y - 0.2 * x.x, 0.8 * x.z)
            });
            assert!((between - 1.2 * 0.9 * 0.8).abs() < 1e-14);
            assert!((felt - between).abs() < 1e-14, "{felt}");
        }
    }

    /// Two faces turned against each other, edges along the thickness as long as before: a trapezium is less high.
    #[test]
    fn what_is_lost_where_faces_turn_is_not_felt() {
        let (sine, cosine) = 0.4f64.sin_cos();
        for formulation in [Formulation::Eas7, Formulation::Layered] {
            let [between, felt] = volumes(formulation, |x| {
                Vec3::new(x.x * (1.0 + 2.0 * x.z * sine), x.y, x.z * cosine)
            });
            assert!((between - cosine).abs() < 1e-14);
            assert!((felt - 1.0).abs() < 1e-14, "{felt}");
        }
        let [between, felt] = volumes(Formulation::Displacement, |x| {
            Vec3::new(x.x * (1.0 + 2.0 * x.z * sine), x.y, x.z * cosine)
        });
        assert!((between - felt).abs() < 1e-14);
    }
}
