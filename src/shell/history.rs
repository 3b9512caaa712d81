//! What material laws remember at the points of an element.
use super::kinematics::V;
use super::material::{Collapsed, LawState, MaterialLaw, Metric, state_of};
use super::stress;
use std::iter::Sum;

/// How a material flowed over a step.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Flow {
    /// By how much the equivalent plastic strain of a point grew at most.
    pub most: f64,
    /// Work of the yield stress (energy).
    pub work: f64,
    /// Plastic work that a step leaves out because flow turns within it (energy): a step flows all along the direction of its
    /// end, while flow turns there from that of its start. Half of the chord between both directions, times the work: of first
    /// order in the step.
    pub lag: f64,
}

impl Sum for Flow {
    fn sum<I: Iterator<Item = Flow>>(all: I) -> Flow {
        all.fold(Flow::default(), |sum, one| Flow {
            most: sum.most.max(one.most),
            work: sum.work + one.work,
            lag: sum.lag + one.lag,
        })
    }
}

/// What the acceptance of a step changes in elements.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Remembered {
    /// How their material flowed.
    pub flow: Flow,
    /// By how much their strain energy changes, since they take other strains from there on (energy).
    pub energy: f64,
}

impl Sum for Remembered {
    fn sum<I: Iterator<Item = Remembered>>(all: I) -> Remembered {
        all.fold(Remembered::default(), |sum, one| Remembered {
            flow: [sum.flow, one.flow].into_iter().sum(),
            energy: sum.energy + one.energy,
        })
    }
}

/// Sets the states of the law at all points of an element to those before anything happens, where its undeformed frame is `frame`.
pub(super) fn start<L: MaterialLaw>(
    law: &L,
    states: &mut [f64],
    frame: impl Fn(usize) -> [V<f64>; 3],
) {
    for (g, state) in states.chunks_exact_mut(L::State::LEN.max(1)).enumerate() {
        law.start(&frame(g)).write(state);
    }
}

/// Advances the states of the law at all points of an element, whose metric and strain `at` gives; returns how it flowed there.
pub(super) fn advance<L: MaterialLaw>(
    law: &L,
    at: impl Fn(usize) -> (Metric, [f64; 6]),
    volumes: impl Iterator<Item = f64>,
    states: &mut [f64],
) -> Result<Flow, (u8, Collapsed)> {
    let mut all = Flow::default();
    if L::State::LEN == 0 {
        return Ok(all);
    }
    let states = states.chunks_exact_mut(L::State::LEN);
    for (g, (state, volume)) in states.zip(volumes).enumerate() {
        let (metric, strain) = at(g);
        let old = L::State::read(state);
        let new = law
            .advance(&metric, &strain, &old)
            .map_err(|c| (g as u8, c))?;
        let Flow { most, work, lag } = law.flow(&metric, &old, &new);
        all.most = all.most.max(most);
        all.work += volume * work;
        all.lag += volume * lag;
        new.write(state);
    }
    Ok(all)
}

/// Strain energy of an element of 2 x 2 x 2 points, whose metric, strain and volume `at` gives, and the mean of its stress along the
/// thickness.
pub(super) fn pressing<L: MaterialLaw>(
    law: &L,
    at: impl Fn(usize) -> (Metric, [f64; 6], f64),
    states: &[f64],
) -> Result<[f64; 2], (u8, Collapsed)> {
    let (mut energy, mut along, mut all) = (0.0, 0.0, 0.0);
    for g in 0..8 {
        let (metric, strain, volume) = at(g);
        let (psi, s) = law
            .stress(&metric, &strain, &state_of::<L>(states, g))
            .map_err(|c| (g as u8, c))?;
        energy += psi * volume;
        along += s[2] * metric.lower[2] * volume;
        all += volume;
    }
    Ok([energy, along / all])
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
