//! What material laws remember at the points of an element.
use super::kinematics::V;
use super::material::{Collapsed, LawState, MaterialLaw, Metric, state_of};
use super::stress;
use std::iter::Sum;

/// Advances the states of the law at all points of an element, whose metric and strain `at` gives; returns by how much the
/// equivalent plastic strain grew at most.
pub(super) fn advance<L: MaterialLaw>(
    law: &L,
    at: impl Fn(usize) -> (Metric, [f64; 6]),
    states: &mut [f64],
) -> Result<f64, (u8, Collapsed)> {
    let mut most = 0.0;
    if L::State::LEN == 0 {
        return Ok(most);
    }
    for (g, state) in states.chunks_exact_mut(L::State::LEN).enumerate() {
        let (metric, strain) = at(g);
        let old = L::State::read(state);
        let new = law
            .advance(&metric, &strain, &old)
            .map_err(|c| (g as u8, c))?;
        most = f64::max(most, law.flow(&old, &new));
        new.write(state);
    }
    Ok(most)
}

/// [`stress::cauchy`] at a point of an element with the states of its law.
pub(super) fn cauchy<L: MaterialLaw>(
    law: &L,
    (metric, point): (&Metric, usize),
    big: &[V<f64>; 3],
    du: &[V<f64>; 3],
    strain: &[f64; 6],
    states: &[f64],
) -> Result<[f64; 6], Collapsed> {
    stress::cauchy(law, metric, big, du, strain, &state_of::<L>(states, point))
}

/// [`MaterialLaw::flow_measures`] at a point of an element.
pub(super) fn measures<L: MaterialLaw>(
    law: &L,
    metric: &Metric,
    point: usize,
    states: &[f64],
) -> [f64; 2] {
    law.flow_measures(metric, &state_of::<L>(states, point))
}

/// Work that plastic flow has taken since the start.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct PlasticWork {
    /// The work itself: by the trapezoidal rule over each step, which closes the balance of energies because the stored
    /// energy is quadratic in the elastic strain.
    pub done: f64,
    /// The part of the energy of elements that stands for it: the integral of the yield stress over the plastic strain,
    /// of which stresses at the end of a step are the gradient.
    pub in_energy: f64,
}

impl Sum for PlasticWork {
    fn sum<I: Iterator<Item = PlasticWork>>(all: I) -> PlasticWork {
        all.fold(PlasticWork::default(), |sum, one| PlasticWork {
            done: sum.done + one.done,
            in_energy: sum.in_energy + one.in_energy,
        })
    }
}

/// That of an element, from the volumes and the states of its points.
pub(super) fn plastic_work<L: MaterialLaw>(
    law: &L,
    volumes: impl Iterator<Item = f64>,
    states: &[f64],
) -> PlasticWork {
    if L::State::LEN == 0 {
        return PlasticWork::default();
    }
    (states.chunks_exact(L::State::LEN).zip(volumes))
        .map(|(state, volume)| {
            let PlasticWork { done, in_energy } = law.plastic_work(&L::State::read(state));
            PlasticWork {
                done: volume * done,
                in_energy: volume * in_energy,
            }
        })
        .sum()
}
