//! What material laws remember at the points of an element.
use super::kinematics::V;
use super::material::{Collapsed, LawState, MaterialLaw, Metric, state_of};
use super::stress;

/// Advances the states of the law at all points of an element.
pub(super) fn advance<L: MaterialLaw>(
    law: &L,
    metrics: &[Metric],
    strains: &[[f64; 6]],
    states: &mut [f64],
) -> Result<(), (u8, Collapsed)> {
    if L::State::LEN == 0 {
        return Ok(());
    }
    let points = states
        .chunks_exact_mut(L::State::LEN)
        .zip(metrics)
        .zip(strains);
    for (g, ((state, metric), strain)) in points.enumerate() {
        let new = law
            .advance(metric, strain, &L::State::read(state))
            .map_err(|c| (g as u8, c))?;
        new.write(state);
    }
    Ok(())
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
