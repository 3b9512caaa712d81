//! Fields of bodies whose material flows.
use super::stresses::flow_measures;
use crate::model::Model;
use crate::model::state::State;
use crate::output::Field;

/// Values at the nodes of a body; none of one that does not flow.
pub(super) struct FlowFields {
    plastic_strain: Vec<f64>,
    yield_ratio: Vec<f64>,
}

impl FlowFields {
    /// Of all bodies.
    pub fn of(model: &Model, state: &State) -> Vec<FlowFields> {
        let bodies = flow_measures(model, state).into_iter();
        // Extended to the faces, a plastic strain that ends inside the sheet can fall below zero.
        bodies
            .map(|nodes| FlowFields {
                plastic_strain: nodes.iter().map(|[p, _]| p.max(0.0)).collect(),
                yield_ratio: nodes.iter().map(|[_, ratio]| ratio.max(0.0)).collect(),
            })
            .collect()
    }

    /// As fields of the output: `plastic_strain` (equivalent) and `yield_ratio` (equivalent stress over yield stress).
    pub fn fields(&self) -> impl Iterator<Item = Field<'_>> {
        let all = [
            ("plastic_strain", &self.plastic_strain),
            ("yield_ratio", &self.yield_ratio),
        ];
        (all.into_iter())
            .filter(|(_, data)| !data.is_empty())
            .map(|(name, data)| Field::point(name, data))
    }
}
