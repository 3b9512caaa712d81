//! Elements whose law remembers: what a step leaves in the states of their points, and what these say.
use super::{Formulation, H8Block, arrays, fault, head};
use crate::shell::error::ElementFault;
use crate::shell::history::{
    Flow, PlasticWork, Remembered, advance, cauchy, measures, plastic_work, start,
};
use crate::shell::kinematics::Fields;
use crate::shell::material::with_law;
use crate::shell::{layered, stress};
use covact_geometry::Vec3;

impl H8Block {
    /// Numbers that an element remembers of accepted steps, at the end of its state: those of the law at its points, then the shares that
    /// it takes off its thickness strain.
    pub fn history_len(&self) -> usize {
        self.law_len() + 2 * usize::from(self.has_shares())
    }

    /// Those of the law.
    pub(super) fn law_len(&self) -> usize {
        self.formulation.points() * self.law.state_len()
    }

    /// Stresses at the lowest and highest points of [`Formulation::Layered`], each with that of the next point inwards.
    pub(super) fn layered_stresses(
        &self,
        e: usize,
        u: &[Vec3; 8],
        state: &[f64],
    ) -> Result<[[[f64; 6]; 2]; 8], ElementFault> {
        let mut out = [[[0.0; 6]; 2]; 8];
        let points = std::array::from_fn(layered::outer);
        self.stresses_at(e, (u, state), &points, &mut out)?;
        Ok(out)
    }

    /// Stresses in the middle of the thickness of [`Formulation::Layered`] at the nodes, those above each other the same: the mean
    /// of the points next to it.
    ///
    /// # Errors
    /// [`ElementFault`] where the strain is impossible.
    pub fn middle_stresses(
        &self,
        e: usize,
        u: &[Vec3; 8],
        state: &[f64],
    ) -> Result<[[f64; 6]; 8], ElementFault> {
        let mut pairs = [[[0.0; 6]; 2]; 4];
        let points = std::array::from_fn(layered::inner);
        self.stresses_at(e, (u, state), &points, &mut pairs)?;
        let mean = pairs.map(|[a, b]| std::array::from_fn::<f64, 6, _>(|v| 0.5 * (a[v] + b[v])));
        Ok(std::array::from_fn(|a| layered::in_plane(a, &mean)))
    }

    /// Stresses at pairs of points of [`Formulation::Layered`].
    fn stresses_at<const P: usize>(
        &self,
        e: usize,
        (u, state): (&[Vec3; 8], &[f64]),
        points: &[[usize; 2]; P],
        out: &mut [[[f64; 6]; 2]; P],
    ) -> Result<(), ElementFault> {
        let nodes = &self.reference[e].nodes;
        let strains = layered::Strains::new(nodes, &arrays(u), &head(state));
        let states = &state[self.condensation_len()..];
        for (out, g) in out.as_flattened_mut().iter_mut().zip(points.as_flattened()) {
            let (place, du, strain) = strains.at(*g);
            *out = with_law!(&self.law, law => cauchy(
                law, (&place.metric, *g), &place.frame, &du, &strain, states
            ))
            .map_err(|c| fault(e, *g as u8, c))?;
        }
        Ok(())
    }

    /// Sets the states of the law to those of an element that nothing has happened to.
    pub fn start(&self, e: usize, state: &mut [f64]) {
        if self.law.state_len() == 0 {
            return;
        }
        let nodes = &self.reference[e].nodes;
        let fields = Fields::new(nodes);
        let states = &mut state[self.condensation_len()..][..self.law_len()];
        with_law!(&self.law, law => start(law, states, |g| match self.formulation {
            Formulation::Layered => layered::frame(nodes, g),
            _ => fields.at(g),
        }));
    }

    /// Takes a step that is accepted at displacements `u` and the enhanced strains in `state` into the states of the law and the shares
    /// that are taken off the thickness strain.
    ///
    /// # Errors
    /// [`ElementFault`] where the strain is impossible.
    pub fn remember(
        &self,
        e: usize,
        u: &[Vec3; 8],
        state: &mut [f64],
    ) -> Result<Remembered, ElementFault> {
        let flow = match self.law.state_len() {
            0 => Flow::default(),
            _ => self.advance(e, u, state)?,
        };
        let [_, energy] = self.press(e, u, state)?;
        Ok(Remembered { flow, energy })
    }

    fn advance(&self, e: usize, u: &[Vec3; 8], state: &mut [f64]) -> Result<Flow, ElementFault> {
        let u = arrays(u);
        let re = &self.reference[e];
        let (condensation, states) = state.split_at_mut(self.condensation_len());
        if self.formulation == Formulation::Layered {
            let strains = layered::Strains::new(&re.nodes, &u, &head(condensation));
            let at = |g| {
                let (place, _, strain) = strains.at(g);
                (place.metric, strain)
            };
            let volumes = layered::volumes(&re.nodes);
            return with_law!(&self.law, law => advance(law, at, volumes, states))
                .map_err(|(point, c)| fault(e, point, c));
        }
        let (big, du) = (Fields::new(&re.nodes), Fields::new(&u));
        let strain = self
            .strains(re, (&big, &du), condensation)
            .map_err(|(point, c)| fault(e, point, c))?;
        let at = |g: usize| (re.metric[g], strain[g]);
        with_law!(&self.law, law => advance(law, at, re.volume.into_iter(), states))
            .map_err(|(point, c)| fault(e, point, c))
    }

    /// Equivalent plastic strain, and equivalent stress over yield stress, at the nodes.
    pub fn flow_measures(&self, e: usize, state: &[f64]) -> [[f64; 2]; 8] {
        let (re, states) = (&self.reference[e], &state[self.condensation_len()..]);
        with_law!(&self.law, law => match self.formulation {
            Formulation::Layered => layered::to_nodes(&std::array::from_fn(|corner| {
                layered::outer(corner)
                    .map(|g| measures(law, &layered::metric(&re.nodes, g), g, states))
            })),
            _ => stress::extrapolate(&std::array::from_fn(|g| measures(law, &re.metric[g], g, states))),
        })
    }

    /// What the law has done with the work on the points of an element, times their volumes.
    pub fn plastic_work(&self, e: usize, state: &[f64]) -> PlasticWork {
        let (re, states) = (&self.reference[e], &state[self.condensation_len()..]);
        with_law!(&self.law, law => match self.formulation {
            Formulation::Layered => plastic_work(law, layered::volumes(&re.nodes), states),
            _ => plastic_work(law, re.volume.into_iter(), states),
        })
    }
}
