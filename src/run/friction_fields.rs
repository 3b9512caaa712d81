//! What friction does at the nodes and at the slave points, for the output.
use crate::contact::friction::history::{PointHistory, PointStatus};
use crate::contact::points::SlavePoint;
use crate::model::state::State;
use crate::model::{BodyModel, Model, PairModel};
use crate::output::{CLOSED, Field, OPEN, Place, PointCloud, SLIP};
use covact_geometry::Vec3;

/// Fields of contacts with friction on all nodes of the model; empty where no contact has friction.
#[derive(Default)]
pub(super) struct FrictionFields {
    /// Traction that the masters exert on the slave, three numbers a node (force / length^2).
    traction: Vec<f64>,
    /// Length of the path slid so far.
    slip: Vec<f64>,
    /// Energy dissipated so far (force / length).
    dissipated: Vec<f64>,
    /// Weighted values of the pair at hand: traction, slip, dissipated.
    sums: Vec<[f64; 5]>,
    /// Weights of the pair at hand, zero outside [`Self::gather`].
    weight: Vec<f64>,
}

impl FrictionFields {
    pub fn new(model: &Model) -> Self {
        if !model.pairs.iter().any(|p| p.friction.is_some()) {
            return FrictionFields::default();
        }
        let n = model.nodes.len();
        FrictionFields {
            traction: vec![0.0; 3 * n],
            slip: vec![0.0; n],
            dissipated: vec![0.0; n],
            sums: vec![[0.0; 5]; n],
            weight: vec![0.0; n],
        }
    }

    /// Forgets what was gathered.
    pub fn clear(&mut self) {
        self.traction.fill(0.0);
        self.slip.fill(0.0);
        self.dissipated.fill(0.0);
    }

    /// Takes over the points of a pair with friction, by shape functions and areas. Tractions and energies of several
    /// surfaces on the same face add up; the path is the longest.
    pub fn gather(&mut self, model: &Model, points: &[SlavePoint], histories: &[PointHistory]) {
        for (p, h) in points.iter().zip(histories) {
            for (node, n) in model.terms(p) {
                let w = n * p.area;
                self.weight[node] += w;
                let values = [-h.t.x, -h.t.y, -h.t.z, h.slip, h.dissipated];
                for (sum, v) in self.sums[node].iter_mut().zip(values) {
                    *sum += w * v;
                }
            }
        }
        for (node, _) in points.iter().flat_map(|p| model.terms(p)) {
            let weight = std::mem::take(&mut self.weight[node]);
            let [x, y, z, slip, dissipated] = std::mem::take(&mut self.sums[node]);
            if weight > 0.0 {
                for (c, t) in [x, y, z].into_iter().enumerate() {
                    self.traction[3 * node + c] += t / weight;
                }
                self.slip[node] = self.slip[node].max(slip / weight);
                self.dissipated[node] += dissipated / weight;
            }
        }
    }

    /// The fields of a body; none where it is no slave with friction.
    pub fn of(&self, model: &Model, index: usize, body: &BodyModel) -> Vec<Field<'_>> {
        let slides = |p: &PairModel| p.body == index && p.friction.is_some();
        if !model.pairs.iter().any(slides) {
            return Vec::new();
        }
        let first = body.first_node as usize;
        let last = first + body.mesh.nodes.len();
        vec![
            Field {
                name: "friction_traction",
                components: 3,
                component_names: &[],
                data: &self.traction[3 * first..3 * last],
                place: Place::Point,
            },
            Field::point("slip", &self.slip[first..last]),
            Field::point("dissipated", &self.dissipated[first..last]),
        ]
    }
}

/// `contact_status` of a point with history.
pub(super) fn status(history: &PointHistory) -> u8 {
    match history.status {
        PointStatus::Open => OPEN,
        PointStatus::Stick => CLOSED,
        PointStatus::Slip => SLIP,
    }
}

/// What the slave points of a contact are called; all its passes have one name.
fn cloud_name(pair: &PairModel) -> String {
    let pass = match (pair.edges_of, pair.half) {
        (Some(_), _) => "_edges",
        (None, Some(half)) if half.back => "_back",
        (None, _) => "",
    };
    format!("{}{pass}_points", pair.name)
}

/// Names of [`clouds`].
pub(super) fn cloud_names(model: &Model) -> Vec<String> {
    let sliding = model.pairs.iter().filter(|p| p.friction.is_some());
    sliding.map(cloud_name).collect()
}

/// The slave points of every contact with friction; `gaps` are those of all points of the model (length).
pub(super) fn clouds(model: &Model, state: &State, gaps: &[f64]) -> Vec<PointCloud> {
    let mut first = 0;
    let mut out = Vec::new();
    if gaps.is_empty() {
        return out;
    }
    for (index, pair) in model.pairs.iter().enumerate() {
        let points = state.slaves(model, index);
        let own = first..first + points.len();
        first = own.end;
        let (Some(_), Some(range)) = (&pair.friction, state.history(model, index)) else {
            continue;
        };
        let histories = &state.histories[range];
        let positions = points.iter().map(|p| model.point_position(p, &state.u));
        out.push(PointCloud {
            name: cloud_name(pair),
            positions: positions.collect(),
            area: points.iter().map(|p| p.area).collect(),
            status: histories.iter().map(status).collect(),
            pressure: histories.iter().map(|h| -h.n).collect(),
            gap: gaps[own].to_vec(),
            friction_traction: histories.iter().map(|h| -h.t).collect::<Vec<Vec3>>(),
            slip: histories.iter().map(|h| h.slip).collect(),
            dissipated: histories.iter().map(|h| h.dissipated).collect(),
        });
    }
    out
}
