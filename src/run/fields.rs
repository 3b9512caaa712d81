//! Fields of an accepted state, gathered on nodes for the output.
mod bodies;

use super::RunError;
use super::averaged::{NodeNow, nodes_now};
use super::bearing::{Bearings, Carrier, Place as BearingPlace};
use super::edge_fields::{self, EdgeForce};
use super::friction_fields::{self, FrictionFields};
use super::motion_fields::MotionFields;
use super::sheet_fields::{mid_surface, sheet_name};
use super::strain_fields::is_shell;
use super::stresses::{follows_stress, nodal_stresses};
use super::surface_cells::pieces;
use super::traction_fields::TractionFields;
use crate::contact::friction::history::PointStatus;
use crate::contact::law::PairLaw;
use crate::model::averaged::Around;
use crate::model::master::{MasterNow, Masters};
use crate::model::state::State;
use crate::model::{BodyModel, Model, SurfaceModel};
use crate::output::{
    CLOSED, MidSurface, NOT_A_SLAVE, OPEN, OutputError, PartNames, Precision, Results, SLIP,
    SurfaceOutput, SurfaceState, von_mises,
};
use crate::scene::Output;
use covact_geometry::Vec3;

/// What is said where `output.shell_stresses` asks for nothing.
const NO_SHELL: &str = "`output.shell_stresses`: no body is a shell, at most a quarter as thick as it is long: none are written";

/// Contact fields on all nodes, and totals over all slave points. [`Fields::gather`] makes all of them from an accepted
/// state, so that a run that is continued has the same.
pub struct Fields {
    surfaces: Vec<SurfaceOutput>,
    notes: Vec<String>,
    pressure: Vec<f64>,
    gap: Vec<f64>,
    status: Vec<u8>,
    /// Weights of the pair at hand, zero outside [`Fields::gather`].
    weight: Vec<f64>,
    /// Weighted pressure and gap of the pair at hand.
    sums: Vec<[f64; 2]>,
    friction: FrictionFields,
    traction: TractionFields,
    /// Gaps of all slave points when last gathered, where clouds of points are written; else empty.
    gaps: Vec<f64>,
    /// Per slave point: in front of its surface or in contact when last gathered.
    front: Vec<bool>,
    /// Per pair: points that were in front of the surface or in contact when last gathered, and now lie below it,
    /// deeper than its depth.
    pub sunk: Vec<usize>,
    /// Smallest signed distance of a slave point.
    pub smallest_gap: f64,
    /// Largest pressure at a slave point.
    pub largest_pressure: f64,
    /// Slave area in contact.
    pub area: f64,
    /// Per pair whose overclosure shrinks, or is resolved by the first step and in its row only: sum of normal traction,
    /// overclosure at the start and area (energy).
    pub pressed: Vec<f64>,
    /// What the points in contact carry.
    pub bearings: Bearings,
    /// Von Mises stress at the nodes of bodies whose stress is followed, else 0; empty where that is none.
    pub von_mises: Vec<f64>,
    /// Gaps at the start where they are negative, between the first two times of gathering; empty where none are.
    start: Vec<f64>,
    gathered: bool,
    pub motion: Option<MotionFields>,
    /// Stresses of shells at the bottom, in the middle and at the top are written.
    shell_stresses: bool,
    /// How exactly fields of bodies are written.
    precision: Precision,
}

impl Fields {
    /// Prepares what `output` asks for; copies of surfaces only where fields are written at all.
    pub fn new(model: &Model, output: &Output) -> Result<Self, OutputError> {
        let mut notes = Vec::new();
        let mut surfaces = Vec::new();
        for surface in model.surfaces.iter().filter(|_| output.every > 0) {
            let pieces = pieces(surface, output.tessellation, model);
            let written = SurfaceOutput::new(&surface.name, pieces, output.tessellation)?;
            if !written.left_out().is_empty() {
                notes.push(format!(
                    "surface `{}`: {} Bezier piece(s) have a degree too high for VTK and are in the tessellated \
                     copy only",
                    surface.name,
                    written.left_out().len()
                ));
            }
            surfaces.push(written);
        }
        if output.shell_stresses && !model.bodies.iter().any(is_shell) {
            notes.push(NO_SHELL.to_owned());
        }
        let n = model.nodes.len();
        Ok(Fields {
            surfaces,
            notes,
            pressure: vec![0.0; n],
            gap: vec![f64::NAN; n],
            status: vec![NOT_A_SLAVE; n],
            weight: vec![0.0; n],
            sums: vec![[0.0; 2]; n],
            friction: FrictionFields::new(model),
            traction: match output.every {
                0 => TractionFields::default(),
                _ => TractionFields::new(n),
            },
            gaps: match output.contact_points {
                true => vec![f64::NAN; model.contact_points()],
                false => Vec::new(),
            },
            front: vec![false; model.contact_points()],
            sunk: vec![0; model.pairs.len()],
            smallest_gap: f64::NAN,
            largest_pressure: 0.0,
            area: 0.0,
            pressed: vec![0.0; model.pairs.len()],
            bearings: Bearings::new(model),
            von_mises: match (0..model.bodies.len()).any(|b| follows_stress(model, b)) {
                true => vec![0.0; n],
                false => Vec::new(),
            },
            start: Vec::new(),
            gathered: false,
            motion: None,
            shell_stresses: output.shell_stresses,
            precision: Precision::new(output.full_precision),
        })
    }

    /// What could not be prepared as asked for.
    pub fn notes(&self) -> Vec<String> {
        self.notes.clone()
    }

    /// Names of all that [`Fields::write`] writes.
    pub fn part_names(&self, model: &Model) -> PartNames {
        PartNames {
            bodies: model.bodies.iter().map(|b| b.name.clone()).collect(),
            surfaces: model.surfaces.iter().map(|s| s.name.clone()).collect(),
            still: (model.surfaces.iter().filter(|s| still(s)))
                .map(|s| s.name.clone())
                .collect(),
            clouds: match self.gaps.is_empty() {
                true => Vec::new(),
                false => friction_fields::cloud_names(model),
            },
            sheets: (model.bodies.iter().filter(|b| b.block.sheet().is_some()))
                .map(sheet_name)
                .collect(),
        }
    }

    /// Recovers pressure, gap and status at the nodes of all slave surfaces: averages over the slave points by their
    /// shape functions and areas, `p_I = sum w N_I p / sum w N_I`. With points at nodes that is the point's own
    /// pressure; as the areas are the modelled ones, it is right on symmetry planes too. Where gaps are averaged, they and
    /// the pressures are the nodes' own. Points with history have the pressure and the status that was solved for.
    pub fn gather<L: PairLaw>(
        &mut self,
        model: &Model,
        penalties: &[f64],
        masters: &mut Masters,
        state: &State,
        time: f64,
    ) -> Result<(), RunError> {
        if model.small.is_none() {
            masters.update(model, &state.u);
        }
        self.pressure.fill(0.0);
        self.gap.fill(f64::NAN);
        self.status.fill(NOT_A_SLAVE);
        self.smallest_gap = f64::INFINITY;
        self.largest_pressure = 0.0;
        self.area = 0.0;
        self.sunk.fill(0);
        self.pressed.fill(0.0);
        self.bearings.clear();
        let start = std::mem::take(&mut self.start);
        self.friction.clear();
        self.traction.clear();
        // Of a run that is continued, the segments may be other ones than the model's.
        self.front.resize(state.points.len(), false);
        if !self.gaps.is_empty() {
            self.gaps.resize(state.points.len(), f64::NAN);
        }
        let mut first = 0;
        for (index, (pair, penalty)) in model.pairs.iter().zip(penalties).enumerate() {
            let law = L::of(*penalty);
            let master = masters.at(model, index, &state.u, time)?;
            let points = state.slaves(model, index);
            let states = &state.points[first..first + points.len()];
            let fronts = &mut self.front[first..first + points.len()];
            if let Some(nodes) = &pair.averaged {
                let (now, sunk) = nodes_now(
                    model, index, nodes, &law, &master, state, first, time, fronts, &start,
                );
                self.sunk[index] += sunk;
                self.pressed[index] = now.iter().map(|n| n.pressed).sum();
                if !self.gathered && pair.strains() && now.iter().any(|n| n.closed) {
                    self.start.resize(state.points.len(), 0.0);
                    let offsets = pair.offsets(time);
                    for (i, p) in points.iter().enumerate() {
                        let x = model.point_position(p, &state.u);
                        let z0 = offsets.map_or(0.0, |o| o.at(i));
                        let seen = master.see(i, &x, states[i].hint);
                        self.start[first + i] = seen.map_or(0.0, |s| s.gap(z0).min(0.0));
                    }
                }
                now.iter().for_each(|n| self.take(n));
                if let (Some(_), Some(range)) = (&pair.friction, state.history(model, index)) {
                    let histories = &state.histories[range];
                    self.friction.gather(model, points, histories);
                    for (place, n) in now.iter().enumerate().filter(|(_, n)| n.closed) {
                        let slides = |a: &Around| histories[a.point as usize].slides();
                        if nodes.around(place).iter().any(slides) {
                            self.status[n.node] = SLIP;
                        }
                    }
                }
                if let Some(gaps) = self.gaps.get_mut(first..first + points.len()) {
                    let offsets = pair.offsets(time);
                    for (i, (p, kept)) in points.iter().zip(gaps).enumerate() {
                        let x = model.point_position(p, &state.u);
                        let z0 = offsets.map_or(0.0, |o| o.at(i));
                        let seen = master.see(i, &x, states[i].hint);
                        *kept = seen.map_or(f64::NAN, |s| s.gap(z0));
                    }
                }
                for (i, n) in now.iter().enumerate().filter(|(_, n)| n.closed) {
                    let carrier = Carrier {
                        index: i,
                        pressure: n.pressure,
                        gap: n.gap,
                        area: n.area,
                        share: pair.share(),
                        place: None,
                    };
                    self.bearings.add(model, index, &carrier);
                }
                first += points.len();
                continue;
            }
            // Both passes of two see the same area.
            let share = if pair.half.is_some() { 0.5 } else { 1.0 };
            let own = pair.master.is_own();
            let offsets = pair.offsets(time);
            let shrinking = pair.resolved(&start, first);
            let histories = (state.history(model, index)).map(|range| &state.histories[range]);
            let small = match &model.small {
                Some(small) => Some((&small.pairs[index], model.small_motion(pair, time)?)),
                None => None,
            };
            let pose = match (&master, &small) {
                (MasterNow::Rigid(_), Some(_)) => pair
                    .rigid_master()
                    .map(|s| model.surfaces[s].pose(0.0, &state.u)),
                (MasterNow::Rigid(master), None) => Some(Ok(master.pose)),
                (MasterNow::Body { .. }, _) => None,
            };
            let pose = pose.transpose()?;
            let into_master = |x: Vec3| match &pose {
                Some(pose) => pose.inverse_transform_point(&x.into()).coords,
                None => x,
            };
            let mut on_edges = Vec::new();
            for (i, ((p, s), front)) in points.iter().zip(states).zip(fronts).enumerate() {
                let z0 = offsets.map_or(0.0, |o| o.at(i));
                let place;
                // A point with no foot at all keeps the gap unknown.
                let gap = if let Some((own, motion)) = &small {
                    place = own.points[i].map(|at| (at.foot, at.hint, at.normal));
                    own.points[i].map_or(f64::NAN, |at| {
                        at.gap - z0 + own.approach(i, &at, p, motion.as_ref(), &state.u)
                    })
                } else {
                    let x = model.point_position(p, &state.u);
                    let from = (z0, p.overhang(s.closed));
                    let seen = master.see_hanging((i, &x), s.hint, f64::INFINITY, from);
                    place = seen.map(|s| (x, s.hint, s.normal));
                    let sunk = seen.is_some_and(|s| s.behind);
                    self.sunk[index] += usize::from(*front && sunk);
                    *front = seen.is_some_and(|s| s.in_front(own));
                    seen.map_or(f64::NAN, |s| s.gap(z0))
                };
                if let Some(kept) = self.gaps.get_mut(first + i) {
                    *kept = gap;
                }
                let history = histories.map(|h| &h[i]);
                let (closed, pressure) = match history {
                    // The step's own, which may be that of a point slightly above the surface.
                    Some(history) => (history.status != PointStatus::Open, -history.n),
                    None if gap < 0.0 => (true, -law.response(gap).n),
                    None => (false, 0.0),
                };
                let status = match history {
                    Some(history) => friction_fields::status(history),
                    None if closed => CLOSED,
                    None => OPEN,
                };
                let normal = place.filter(|_| closed).map(|(_, _, normal)| normal);
                let normal = normal.unwrap_or_default();
                let friction = history.filter(|_| closed).map_or(Vec3::zeros(), |h| -h.t);
                self.traction.add(model, p, pressure * normal + friction);
                if closed && let Some((x, hint, normal)) = place {
                    if pair.edges_of.is_some() {
                        on_edges.push(EdgeForce {
                            at: hint,
                            force: -(pressure * normal + friction) * p.area,
                            normal: pressure * p.area,
                        });
                    }
                    let carrier = Carrier {
                        index: i,
                        pressure,
                        gap,
                        area: p.area,
                        share: pair.share(),
                        place: Some(BearingPlace {
                            point: p,
                            x,
                            local: into_master(x),
                            hint,
                            normal,
                        }),
                    };
                    self.bearings.add(model, index, &carrier);
                }
                if gap < self.smallest_gap {
                    self.smallest_gap = gap;
                }
                self.largest_pressure = self.largest_pressure.max(pressure);
                self.area += if closed { share * p.area } else { 0.0 };
                if let Some(z0) = shrinking {
                    self.pressed[index] -= share * pressure * z0[i] * p.area;
                }
                if !self.gathered && gap < 0.0 && pair.strains() {
                    self.start.resize(state.points.len(), 0.0);
                    self.start[first + i] = gap;
                }
                for (node, n) in model.terms(p) {
                    let w = n * p.area;
                    self.weight[node] += w;
                    self.sums[node][0] += w * pressure;
                    self.sums[node][1] += w * gap;
                    self.status[node] = self.status[node].max(status);
                }
            }
            self.traction.end(model, points);
            if let MasterNow::Body {
                surface: Some(surface),
                ..
            } = &master
            {
                let fields = (&mut self.pressure[..], &mut self.traction);
                edge_fields::spread((model, state), pair, surface, &on_edges, fields);
            }
            if let (Some(_), Some(histories)) = (&pair.friction, histories) {
                self.friction.gather(model, points, histories);
            }
            // Pressures of several surfaces on the same face add up; the nearest surface gives the gap.
            for (node, _) in points.iter().flat_map(|p| model.terms(p)) {
                let weight = std::mem::take(&mut self.weight[node]);
                let [pressure, gap] = std::mem::take(&mut self.sums[node]);
                if weight > 0.0 {
                    self.pressure[node] += pressure / weight;
                    self.gap[node] = self.gap[node].min(gap / weight);
                }
            }
            first += points.len();
        }
        self.bearings.end();
        if !self.von_mises.is_empty() {
            self.follow_stress(model, state);
        }
        self.gathered = true;
        if self.smallest_gap == f64::INFINITY {
            self.smallest_gap = f64::NAN;
        }
        Ok(())
    }

    /// Von Mises stresses of the bodies that probes and yield strengths are about.
    fn follow_stress(&mut self, model: &Model, state: &State) {
        let stresses = nodal_stresses(model, state, |body| follows_stress(model, body));
        for (body, stress) in model.bodies.iter().zip(stresses) {
            let of = self.von_mises[body.first_node as usize..].iter_mut();
            (of.zip(&stress)).for_each(|(mises, stress)| *mises = von_mises(stress));
        }
        let highest = |body: &BodyModel| {
            let first = body.first_node as usize;
            let own = &self.von_mises[first..first + body.mesh.nodes.len()];
            body.metal
                .map_or(0.0, |_| own.iter().copied().fold(0.0, f64::max))
        };
        self.bearings.stress = model.bodies.iter().map(highest).collect();
    }

    /// What a gathering goes by that came before it, for one that is to be taken back.
    pub fn before(&self) -> (Vec<bool>, Vec<f64>) {
        (self.front.clone(), self.start.clone())
    }

    /// Takes gatherings back to [`Self::before`].
    pub fn back(&mut self, (front, start): &(Vec<bool>, Vec<f64>)) {
        self.front.clone_from(front);
        self.start.clone_from(start);
    }

    /// The start of the run has been gathered, by the process that it was continued from.
    pub fn went_on(&mut self) {
        self.gathered = true;
    }

    /// Takes over a node with an averaged gap.
    fn take(&mut self, n: &NodeNow) {
        self.smallest_gap = self.smallest_gap.min(n.gap);
        self.largest_pressure = self.largest_pressure.max(n.pressure);
        self.area += n.area;
        self.pressure[n.node] += n.pressure;
        self.gap[n.node] = self.gap[n.node].min(n.gap);
        let status = if n.closed { CLOSED } else { OPEN };
        self.status[n.node] = self.status[n.node].max(status);
    }

    /// Takes over the slave points of a state whose segments were cut anew; what was gathered stays.
    pub fn resample(
        &mut self,
        model: &Model,
        masters: &Masters,
        state: &State,
        time: f64,
    ) -> Result<(), RunError> {
        self.front.resize(state.points.len(), false);
        let mut first = 0;
        for index in 0..model.pairs.len() {
            let points = state.slaves(model, index);
            let range = first..first + points.len();
            first = range.end;
            let master = masters.at(model, index, &state.u, time)?;
            let fronts = self.front[range.clone()].iter_mut();
            let (own, offsets) = {
                let pair = &model.pairs[index];
                (pair.master.is_own(), pair.offsets(time))
            };
            for (i, ((p, s), front)) in points
                .iter()
                .zip(&state.points[range])
                .zip(fronts)
                .enumerate()
            {
                let x = model.point_position(p, &state.u);
                let z0 = offsets.map_or(0.0, |o| o.at(i));
                let from = (z0, p.overhang(s.closed));
                let seen = master.see_hanging((i, &x), s.hint, f64::INFINITY, from);
                *front = seen.is_some_and(|s| s.in_front(own));
            }
        }
        Ok(())
    }

    /// Writes all bodies and surfaces of an accepted step.
    pub fn write(
        &self,
        model: &Model,
        results: &mut Results,
        step: u32,
        time: f64,
        state: &State,
    ) -> Result<(), OutputError> {
        let poses: Vec<_> = (model.surfaces.iter())
            .map(|s| [s.motion.pose(0.0), s.pose(time, &state.u)].map(Result::unwrap_or_default))
            .collect();
        let surfaces: Vec<SurfaceState> = (self.surfaces.iter().zip(&poses).zip(&model.surfaces))
            .map(|((surface, [start, at]), model)| SurfaceState {
                surface,
                start,
                at,
                still: still(model),
            })
            .collect();
        let clouds = friction_fields::clouds(model, state, &self.gaps);
        let sheets: Vec<MidSurface> = (model.bodies.iter().enumerate())
            .filter_map(|(i, body)| {
                let slave = model.pairs.iter().any(|p| p.body == i);
                let pressure = slave.then_some(&self.pressure[..]);
                mid_surface(body, &state.u, pressure, self.precision)
            })
            .collect();
        self.with_bodies(model, time, state, |bodies| {
            results.write_all(step, time, bodies, &surfaces, (&clouds, &sheets))
        })
    }
}

/// Whether a surface never moves.
fn still(surface: &SurfaceModel) -> bool {
    !surface.motion.moves() && surface.driven.is_none()
}
