//! Contact with bodies: the slave points of a pair are evaluated in parallel, their matrices formed in parallel, and all
//! is summed in order.
mod meetings;

use super::answer::PointAnswer;
use super::couplings::Couplings;
use super::driven::DrivenBlock;
use super::links;
use super::per_pair::PerPair;
use super::pressing::{Batch, Measured};
use super::rigid::rounding;
use super::touched::{self};
use super::{Assembler, Fault, PairForce, PatternError, SurfaceForce, Totals, maps, put};
use crate::contact::kernel::assemble_force;
use crate::contact::kind::{FrictionKind, LawKind};
use crate::contact::law::PairLaw;
use crate::contact::lever;
use crate::contact::moving::MovingMaster;
use crate::contact::points::SlavePoint;
use crate::contact::scatter::{assemble_point, keep_slave_rows};
use crate::model::kernel::SideKind;
use crate::model::master::{MasterNow, Masters};
use crate::model::self_contact::{All, Opposing};
use crate::model::state::{PointState, State, slaves};
use crate::model::{Model, histories};
use covact_geometry::Vec3;
pub(super) use meetings::{Meetings, room, same};
use rayon::prelude::*;
use std::ops::Range;

/// Points whose matrices are formed before they are summed.
const CHUNK: usize = 64;

/// Couplings of all pairs before anything has moved.
pub(super) fn first_couplings(model: &Model, masters: &Masters) -> PerPair<Couplings> {
    let zero = vec![0.0; 3 * model.nodes.len()];
    let couplings = (model.pairs.iter().enumerate()).map(|(index, pair)| {
        let surface = masters.surface(index)?;
        let mut couplings = Couplings::new(&pair.points, &model.levers);
        if let Some(small) = &model.small {
            // Feet stay where they are.
            couplings.set(small.pairs[index].feet());
            return Some(couplings);
        }
        let near = near(model, masters, index, &pair.points, &zero, &[]);
        couplings.couple(&surface.facets, near.into_iter());
        if pair.links() {
            couplings.link(&surface.facets, std::iter::empty());
        }
        Some(couplings)
    });
    PerPair::new(couplings)
}

/// Points of a pair that are nearer to their master than an element or its depth, with the facets at their feet.
/// `states` may be empty.
fn near(
    model: &Model,
    masters: &Masters,
    index: usize,
    points: &[SlavePoint],
    u: &[f64],
    states: &[PointState],
) -> Vec<(usize, u32)> {
    let pair = &model.pairs[index];
    let Some(body) = pair.body_master() else {
        return Vec::new();
    };
    let master = MasterNow::Body {
        model,
        u,
        body,
        surface: masters.surface(index),
    };
    let reach = body.depth.max(pair.element_size + pair.offset);
    (points.iter().enumerate())
        .filter_map(|(i, p)| {
            let x = model.point_position(p, u);
            let hint = states.get(i).and_then(|s| s.hint);
            let seen = master.see_within(i, &x, hint, reach)?;
            Some((i, seen.hint.patch))
        })
        .collect()
}

impl<L: PairLaw> Assembler<'_, L> {
    /// Evaluates the points of all pairs with bodies as masters. Where a matrix is to be made, and one of them touches a
    /// facet that the pattern does not couple it with, the pattern is built anew.
    pub(super) fn meet<const TANGENT: bool>(
        &mut self,
        state: &mut State,
        time: f64,
    ) -> Result<(), Fault> {
        if self.couplings.is_empty() {
            return Ok(());
        }
        self.model.move_rims(&mut state.u, time)?;
        self.masters.update(self.model, &state.u);
        self.follow_cuts(state);
        let mut first = 0;
        let mut missing = false;
        for (index, pair) in self.model.pairs.iter().enumerate() {
            let points = slaves(&state.cuts, self.model, index);
            let range = first..first + points.len();
            first = range.end;
            if self.averaged.get(index).is_some() {
                missing |= self.meet_bodies::<TANGENT>(index, range, state, time)?;
                continue;
            }
            let (Some(master), Some(surface), Some(couplings)) = (
                pair.body_master(),
                self.masters.surface(index),
                self.couplings.get_mut(index),
            ) else {
                continue;
            };
            let kernel = self.model.kernel(index);
            let remembered = histories::range(&state.cuts, self.model, index);
            let cut = state.cuts.get(index).cloned().flatten();
            if let (Some(friction), Some(histories), Some(sliding)) = (
                &pair.friction,
                remembered.clone(),
                self.sliding.get_mut(index),
            ) {
                if sliding.follow(&cut, points.len()) {
                    couplings.resample(points);
                }
                let ran = sliding.meet::<L>(
                    self.model,
                    (pair, points, &kernel),
                    (master, surface),
                    (
                        friction,
                        [self.penalties[index], self.ratios[index]],
                        self.linearization,
                    ),
                    &state.u,
                    time,
                    &mut state.points[range],
                    (
                        &state.histories[histories.clone()],
                        &mut self.slips[histories.clone()],
                        TANGENT,
                    ),
                )?;
                self.ran[index] = Some(ran);
                if kernel.law == LawKind::Multipliers {
                    let eps_t = self.ratios[index] * self.penalties[index];
                    let known = &state.histories[histories.clone()];
                    sliding.answer(surface, known, eps_t, &mut self.answers[histories]);
                }
                missing |= (sliding.touched()).any(|t| !links::holds(couplings, t));
                continue;
            }
            let Some(meetings) = self.meetings.get_mut(index) else {
                continue;
            };
            if meetings.follow(&cut, points.len()) {
                couplings.resample(points);
            }
            let law = L::of(self.penalties[index]);
            let batch = Batch {
                model: self.model,
                points,
                master: MovingMaster {
                    facets: &surface.facets,
                    undeformed: &master.facets,
                    depth: master.depth,
                    keep: self.linearization.keep_facets,
                },
                law: &law,
                kernel: &kernel,
                u: &state.u,
            };
            let states = &mut state.points[range];
            let touches = &mut meetings.touched.all;
            let offsets = pair.offsets(time);
            let histories = match kernel.law {
                LawKind::Multipliers => remembered.clone().map(|range| &state.histories[range]),
                _ => None,
            };
            let known = histories.unwrap_or(&[]);
            let hold = self.linearization.keep_active;
            self.held.clear();
            if hold {
                self.held.extend(states.iter().map(|p| p.closed));
            }
            let measured = Measured {
                histories: known,
                offsets,
                held: hold.then_some(&self.held[..]),
            };
            let ran = match &master.own {
                None => batch.offset(states, touches, measured, &All),
                Some(own) => {
                    let accept = Opposing {
                        own,
                        normals: &surface.normals,
                        position: |n: u32| self.model.position(n as usize, &state.u),
                    };
                    batch.offset(states, touches, measured, &accept)
                }
            };
            self.ran[index] = Some(ran);
            if let (Some(_), Some(range)) = (histories, remembered) {
                let answers = self.answers[range].iter_mut().zip(touches.iter());
                for (i, (answer, touch)) in answers.enumerate() {
                    let z0 = offsets.as_ref().map_or(0.0, |o| o.at(i));
                    *answer =
                        touched::of(touch).map(|t| PointAnswer::without_friction(t.n, t.xi3 - z0));
                }
            }
            let position = |i: usize| self.model.point_position(&points[i], &state.u);
            meetings.touched.settle(pair, position)?;
            missing |= (meetings.touched()).any(|(i, facet)| !couplings.holds(i, facet));
        }
        if TANGENT && missing {
            self.couple_anew(state)?;
        }
        Ok(())
    }

    /// Builds the pattern anew for the points that are in contact or near it.
    fn couple_anew(&mut self, state: &State) -> Result<(), Fault> {
        let mut first = 0;
        for (index, pair) in self.model.pairs.iter().enumerate() {
            let points = state.slaves(self.model, index);
            let states = &state.points[first..first + points.len()];
            first += points.len();
            let (Some(surface), Some(couplings)) =
                (self.masters.surface(index), self.couplings.get_mut(index))
            else {
                continue;
            };
            let mut near = near(self.model, &self.masters, index, points, &state.u, states);
            let (meetings, averaged) = (self.meetings.get(index), self.averaged.get(index));
            near.extend(meetings.iter().flat_map(|m| m.touched()));
            near.extend(averaged.iter().flat_map(|a| a.touched()));
            let remembered = state.history(self.model, index);
            let (Some(histories), Some(_)) = (remembered, &pair.friction) else {
                couplings.couple(&surface.facets, near.into_iter());
                continue;
            };
            let touched = self.sliding.get(index).into_iter();
            near.extend((touched.flat_map(|s| s.touched())).map(|(i, facet, _)| (i, facet)));
            let links = links::with_anchors(&mut near, &state.histories[histories]);
            couplings.couple(&surface.facets, near.into_iter());
            if pair.links() {
                couplings.link(&surface.facets, links.into_iter());
            }
        }
        self.build_pattern()?;
        self.rebuilds += 1;
        Ok(())
    }

    /// Builds the pattern of the couplings as they are, and all that depends on it.
    pub(super) fn build_pattern(&mut self) -> Result<(), PatternError> {
        let pattern = std::sync::Arc::new(maps::pattern(self.model, self.dofs, &self.couplings)?);
        let maps = maps::Maps::new(self.model, self.dofs, &pattern)?;
        self.borders = DrivenBlock::all(self.model, &pattern)?;
        self.element_maps = maps.elements;
        self.kinds = maps.kinds;
        self.seams.place(maps.seams);
        self.point_maps = maps.points;
        self.follower_maps = maps.followers;
        self.matrix = super::system(self.model, pattern.clone());
        self.new_pattern = Some(pattern);
        Ok(())
    }

    /// Sums up a pair that [`Assembler::meet`] has evaluated.
    #[allow(clippy::too_many_arguments)]
    pub(super) fn moving<const TANGENT: bool>(
        &mut self,
        index: usize,
        state: &mut State,
        range: Range<usize>,
        time: f64,
        increments: Option<&[f64]>,
        residual: &mut [f64],
        rhs: &mut [f64],
        totals: &mut Totals,
    ) {
        let kernel = self.model.kernel(index);
        match (kernel.friction, kernel.sides) {
            (FrictionKind::None, SideKind::Both) => self.press::<TANGENT, false>(
                index, state, range, time, increments, residual, rhs, totals,
            ),
            (FrictionKind::None, SideKind::Slave) => self.press::<TANGENT, true>(
                index, state, range, time, increments, residual, rhs, totals,
            ),
            _ => self.slide::<TANGENT>(index, state, range, increments, residual, rhs, totals),
        }
    }

    /// Sums up a pair without friction; `HALF`: the slave's rows alone, one of two half passes.
    #[allow(clippy::too_many_arguments)]
    fn press<const TANGENT: bool, const HALF: bool>(
        &mut self,
        index: usize,
        state: &mut State,
        range: Range<usize>,
        time: f64,
        increments: Option<&[f64]>,
        residual: &mut [f64],
        rhs: &mut [f64],
        totals: &mut Totals,
    ) {
        let pair = &self.model.pairs[index];
        if let (true, Some(ran)) = (HALF, &mut self.ran[index]) {
            ran.sides = SideKind::Slave;
        }
        let points = slaves(&state.cuts, self.model, index);
        let u = &state.u[..];
        let states = &mut state.points[range];
        let (Some(surface), Some(couplings), Some(meetings)) = (
            self.masters.surface(index),
            self.couplings.get_mut(index),
            self.meetings.get_mut(index),
        ) else {
            return;
        };
        let facets = &surface.facets;
        let Meetings {
            touched,
            rows,
            matrices,
            stride,
            ..
        } = meetings;
        touched.note(states, totals);
        let mut deepest = 0.0f64;
        // Both passes of two are one contact with two sides, whose energy is the mean of both.
        let mut force = PairForce::default();
        let (law, share) = (L::of(self.penalties[index]), pair.share());
        let offsets = pair.offsets(time);
        for chunk in touched.active.chunks(CHUNK) {
            (chunk.par_iter())
                .zip(rows.par_iter_mut())
                .zip(matrices.par_chunks_mut((*stride).max(1)))
                .with_min_len(8)
                .for_each(|((&i, rows), ke)| {
                    let Some(touch) = touched.get(i) else { return };
                    let p = &points[i as usize];
                    facets.shape(touch.facet, touch.xi, rows);
                    if TANGENT && let Some(number) = p.lever_number() {
                        let size = 3 * (lever::NODES + rows.count);
                        let (ke, point) = ke.split_at_mut(size * size);
                        let size = 3 * (1 + rows.count);
                        let point = &mut point[..size * size];
                        assemble_point(&touch.tangent, &[1.0], rows, p.area, point);
                        let f = touch.residual.fixed_rows::<3>(0) * p.area;
                        let position = |n: u32| self.model.position(n as usize, u);
                        self.model.levers[number].expand(position, &f, rows.count, point, ke);
                    } else if TANGENT {
                        let slave = &p.shape[..p.count as usize];
                        let size = 3 * (slave.len() + rows.count);
                        let ke = &mut ke[..size * size];
                        assemble_point(&touch.tangent, slave, rows, p.area, ke);
                        if HALF {
                            keep_slave_rows(slave.len(), rows.count, ke);
                        }
                    }
                });
            for ((&i, rows), ke) in chunk
                .iter()
                .zip(rows.iter())
                .zip(matrices.chunks_mut(*stride))
            {
                let Some(touch) = touched.get(i) else {
                    continue;
                };
                let p = &points[i as usize];
                let offset = offsets.map_or(0.0, |o| o.at(i as usize));
                let gap = touch.xi3 - offset;
                deepest = deepest.max(-gap);
                totals.contact_energy += share * law.energy(gap) * p.area;
                let x = self.model.point_position(p, u);
                totals.contact_rounding += rounding(&law, gap, p, &x);
                let r = touch.residual * p.area;
                let mut add = |node: usize, f: &Vec3, side: &mut SurfaceForce| {
                    side.force -= f;
                    side.moment -= self.model.position(node, u).cross(f);
                    for c in 0..3 {
                        residual[3 * node + c] += f[c];
                        self.contact[3 * node + c] += f[c];
                    }
                };
                let lever = p.lever_number().map(|number| &self.model.levers[number]);
                if let Some(lever) = lever {
                    let f = assemble_force(&r, &[1.0, 0.0, 0.0]);
                    let forces = lever.spread(|n| self.model.position(n as usize, u), &f, None);
                    for (node, f) in lever.nodes.iter().zip(&forces) {
                        add(*node as usize, f, &mut force.slave);
                    }
                }
                for (node, w) in p.terms() {
                    add(node, &assemble_force(&r, &[w, 0.0, 0.0]), &mut force.slave);
                }
                let nodes = facets.nodes(touch.facet);
                let pushed = if HALF { &[] } else { nodes };
                for (k, &node) in pushed.iter().enumerate() {
                    let row = [-rows.n[k], rows.n_1[k], rows.n_2[k]];
                    add(node as usize, &assemble_force(&r, &row), &mut force.master);
                }
                if TANGENT {
                    let own = match lever {
                        Some(lever) => &lever.nodes[..],
                        None => &p.nodes[..p.count as usize],
                    };
                    let slave = own.len();
                    let n = slave + nodes.len();
                    let mut all = [0; lever::NODES + covact_geometry::moving::MAX];
                    all[..slave].copy_from_slice(own);
                    all[slave..n].copy_from_slice(nodes);
                    let pattern = self.matrix.pattern();
                    let made = couplings.map(i as usize, touch.facet, |_, out| {
                        pattern.element_map(&all[..n], out)
                    });
                    let start = made
                        .and_then(Result::ok)
                        .expect("the pattern was built with every facet that is touched");
                    let map = &couplings.maps()[start..start + n * (n + 1) / 2];
                    put(
                        &mut self.matrix,
                        self.dofs,
                        &mut self.work,
                        &all[..n],
                        map,
                        &mut ke[..9 * n * n],
                        increments,
                        rhs,
                    );
                }
            }
        }
        let touching = !touched.active.is_empty();
        totals.end_pair(self.model, index, force, deepest, touching);
    }
}
