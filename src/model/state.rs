//! What a step may change, so that it can be taken back as a whole.
use super::{Model, histories};
use crate::contact::friction::history::PointHistory;
use crate::contact::points::SlavePoint;
use crate::shell::{Block, ElementBlock, ElementFault, PlasticWork, Remembered, with_block};
use covact_geometry::Hint;
use rayon::prelude::*;
use std::ops::Range;
use std::sync::Arc;

/// Where the last search for a slave point ended, and whether the point was closed. Nothing here outlives the next search.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct PointState {
    /// Where the search ended; none before the first.
    pub hint: Option<Hint>,
    /// Whether the point was in contact.
    pub closed: bool,
}

/// Everything that evolves: displacements, element states, point states. A trial copy is taken at the start of a step
/// and replaces the committed one when the step is accepted.
#[derive(Debug, Clone, PartialEq)]
pub struct State {
    /// Displacements, 3 per node of the model; those of driven surfaces are their translations and rotations.
    pub u: Vec<f64>,
    /// Element states, `state_len` per element, body after body.
    pub elements: Vec<f64>,
    /// Slave points, pair after pair.
    pub points: Vec<PointState>,
    /// Whether slave nodes were closed, pair after pair of those with averaged gaps.
    pub nodes: Vec<bool>,
    /// What slave points remember, pair after pair of those with friction or augmentation ([`State::history`]).
    pub histories: Vec<PointHistory>,
    /// Per pair, the slave points of its integration segments since they were last cut; none where the points are those
    /// of the model. Empty where no pair has segments.
    pub cuts: Vec<Option<Arc<[SlavePoint]>>>,
    /// Energy that stabilisation has dissipated since the start.
    pub stabilized: f64,
}

impl State {
    /// The undeformed state; surfaces driven by force stand where they first touch.
    pub fn new(model: &Model) -> Self {
        let elements = model
            .bodies
            .iter()
            .map(|b| model.state_len(b) * b.block.elements());
        let points = model.pairs.iter().map(|p| p.points.len());
        let nodes = (model.pairs.iter().filter_map(|p| p.averaged.as_ref())).map(|a| a.len());
        let mut u = vec![0.0; 3 * model.nodes.len()];
        for (_, _, driven) in model.driven() {
            u[driven.dof(0)..driven.dof(6)].copy_from_slice(&driven.start);
        }
        let mut elements = vec![0.0; elements.sum()];
        let mut rest = &mut elements[..];
        for body in &model.bodies {
            let len = model.state_len(body);
            let (own, others) = rest.split_at_mut(len * body.block.elements());
            rest = others;
            if len > 0 && body.block.history_len() > 0 {
                with_block!(&body.block, block => {
                    let states = own.chunks_exact_mut(len).enumerate();
                    states.for_each(|(e, state)| ElementBlock::start(block, e, state));
                });
            }
        }
        State {
            u,
            elements,
            points: vec![PointState::default(); points.sum()],
            nodes: vec![false; nodes.sum()],
            histories: vec![PointHistory::default(); model.histories()],
            cuts: match model.pairs.iter().any(|p| p.segments().is_some()) {
                true => vec![None; model.pairs.len()],
                false => Vec::new(),
            },
            stabilized: 0.0,
        }
    }

    /// The slave points of a pair.
    #[inline]
    pub fn slaves<'a>(&'a self, model: &'a Model, pair: usize) -> &'a [SlavePoint] {
        slaves(&self.cuts, model, pair)
    }

    /// Where the histories of a pair's points are among all; none where its points have none.
    #[inline]
    pub fn history(&self, model: &Model, pair: usize) -> Option<Range<usize>> {
        histories::range(&self.cuts, model, pair)
    }

    /// Histories that know of nothing, for as many points as its segments have now.
    pub fn forget_histories(&mut self, model: &Model) {
        let pairs = 0..model.pairs.len();
        let ranges = pairs.filter_map(|index| self.history(model, index));
        let count = ranges.map(|range| range.len()).sum();
        self.histories.clear();
        self.histories.resize(count, PointHistory::default());
    }

    /// Takes over points with history that were cut anew: each stands for the one of this number before.
    pub fn recut(&mut self, sources: &[usize]) {
        let source = |i: &usize| self.histories.get(*i).copied().unwrap_or_default();
        self.histories = sources.iter().map(source).collect();
    }

    /// Takes over another state, without allocating unless it has more slave points.
    pub fn copy_from(&mut self, other: &State) {
        self.u.copy_from_slice(&other.u);
        self.elements.copy_from_slice(&other.elements);
        self.points.clone_from(&other.points);
        self.nodes.copy_from_slice(&other.nodes);
        self.histories.clone_from(&other.histories);
        self.cuts.clone_from(&other.cuts);
        self.stabilized = other.stabilized;
    }

    /// Continues the change from `before` to `self` by `ratio` into `out`: a start for the next step that has the
    /// rotations right to second order, where standing still would stretch a thin shell. (The condensation caches
    /// among the element states are continued too, to no effect: the next linearisation writes them before they are
    /// read.) What elements and laws remember is kept as it is: it belongs to the last accepted step.
    pub fn extrapolate(&self, model: &Model, before: &State, ratio: f64, out: &mut State) {
        let along = |now: &[f64], before: &[f64], out: &mut [f64]| {
            for ((o, n), b) in out.iter_mut().zip(now).zip(before) {
                *o = n + ratio * (n - b);
            }
        };
        along(&self.u, &before.u, &mut out.u);
        along(&self.elements, &before.elements, &mut out.elements);
        for history in histories_of_laws(model) {
            out.elements[history.clone()].copy_from_slice(&self.elements[history]);
        }
        out.points.clone_from(&self.points);
        out.nodes.copy_from_slice(&self.nodes);
        // Normal multipliers are the tractions of an equilibrium and follow the same path; all else is what was.
        out.histories.clone_from(&self.histories);
        for (o, b) in out.histories.iter_mut().zip(&before.histories) {
            o.lambda_n = (o.lambda_n + ratio * (o.lambda_n - b.lambda_n)).min(0.0);
        }
        out.cuts.clone_from(&self.cuts);
        out.stabilized = self.stabilized;
    }

    /// Takes the displacements and enhanced strains of an accepted step into what elements and their laws remember.
    ///
    /// # Errors
    /// The body and the element whose strain is impossible.
    pub fn remember(&mut self, model: &Model) -> Result<Remembered, (String, ElementFault)> {
        let (mut first, mut all) = (0, Remembered::default());
        for body in &model.bodies {
            let len = model.state_len(body);
            let own = first..first + len * body.block.elements();
            first = own.end;
            if len == 0 || body.block.history_len() == 0 {
                continue;
            }
            let (u, states) = (&self.u, &mut self.elements[own]);
            // Collected, and summed one after the other: the same bits on any number of threads.
            let changes: Result<Vec<Remembered>, _> = with_block!(&body.block, block => {
                (states.par_chunks_mut(len).enumerate())
                    .with_min_len(64)
                    .map(|(e, state)| {
                        let u = body.displacements(block, e, u);
                        ElementBlock::remember(block, e, &u, state)
                    })
                    .collect()
            });
            let changes = changes.map_err(|fault| (body.name.clone(), fault))?;
            all = std::iter::once(all).chain(changes).sum();
        }
        Ok(all)
    }

    /// Whether there are elements that may take what presses on them into their strains, or have done so.
    pub fn may_be_pressed(&self, model: &Model) -> bool {
        let mut first = 0;
        model.bodies.iter().any(|body| {
            let len = model.state_len(body);
            let own = first..first + len * body.block.elements();
            first = own.end;
            match &body.block {
                Block::H8(block) if len > 0 => {
                    let mut states = self.elements[own].chunks(len);
                    block.may_be_pressed() || states.any(|state| block.is_pressed(state))
                }
                _ => false,
            }
        })
    }

    /// Takes what presses on elements into `elements`, which are those of `self` before, as [`Self::remember`] does in an accepted step: by how
    /// much a share changes at most, and the energy of all elements.
    ///
    /// # Errors
    /// As there.
    pub fn press(
        &self,
        model: &Model,
        elements: &mut [f64],
    ) -> Result<[f64; 2], (String, ElementFault)> {
        let (mut first, mut all) = (0, [0.0f64; 2]);
        for body in &model.bodies {
            let len = model.state_len(body);
            let own = first..first + len * body.block.elements();
            first = own.end;
            let block = match &body.block {
                Block::H8(block) if len > 0 && block.has_shares() => block,
                _ => continue,
            };
            let changes: Result<Vec<[f64; 2]>, _> = (elements[own].par_chunks_mut(len).enumerate())
                .with_min_len(64)
                .map(|(e, state)| block.press(e, &body.displacements(block, e, &self.u), state))
                .collect();
            let changes = changes.map_err(|fault| (body.name.clone(), fault))?;
            for [change, energy] in changes {
                all = [all[0].max(change), all[1] + energy];
            }
        }
        Ok(all)
    }

    /// Work that plastic flow has taken since the start; zero where no law flows.
    pub fn plastic_work(&self, model: &Model) -> PlasticWork {
        let mut first = 0;
        let bodies = model.bodies.iter().map(|body| {
            let len = model.state_len(body);
            let own = first..first + len * body.block.elements();
            first = own.end;
            if len == 0 || body.block.history_len() == 0 {
                return PlasticWork::default();
            }
            // One after the other: the same bits on any number of threads.
            with_block!(&body.block, block => {
                (self.elements[own].chunks(len).enumerate())
                    .map(|(e, state)| ElementBlock::plastic_work(block, e, state))
                    .sum()
            })
        });
        bodies.sum()
    }

    /// Bytes of heap that this state holds, by part.
    pub fn parts(&self) -> [(&'static str, usize); 6] {
        let State {
            u,
            elements,
            points,
            nodes,
            histories,
            cuts,
            stabilized: _,
        } = self;
        // Cut points are shared by all states that hold them.
        let cut = cuts.iter().flatten().map(|cut| size_of_val(&cut[..]));
        [
            ("displacements", heap(u)),
            ("element states", heap(elements)),
            ("points", heap(points)),
            ("averaged nodes", heap(nodes)),
            ("histories", heap(histories)),
            ("segments", heap(cuts) + cut.sum::<usize>()),
        ]
    }

    /// Bytes of heap that this state holds.
    pub fn bytes(&self) -> usize {
        self.parts().iter().map(|(_, bytes)| bytes).sum()
    }
}

/// Where the elements of bodies with such laws keep what their laws remember, among all element states.
pub fn histories_of_laws(model: &Model) -> impl Iterator<Item = Range<usize>> + '_ {
    let mut first = 0;
    (model.bodies.iter()).flat_map(move |body| {
        let (len, count) = (model.state_len(body), body.block.elements());
        let history = body.block.history_len().min(len);
        let start = first;
        first += len * count;
        let elements = if history > 0 { count } else { 0 };
        (0..elements).map(move |e| {
            let end = start + len * (e + 1);
            end - history..end
        })
    })
}

/// Bytes of heap that a vector holds itself.
pub fn heap<T>(of: &Vec<T>) -> usize {
    of.capacity() * size_of::<T>()
}

/// [`State::slaves`] where the rest of the state is borrowed.
#[inline]
pub fn slaves<'a>(
    cuts: &'a [Option<Arc<[SlavePoint]>>],
    model: &'a Model,
    pair: usize,
) -> &'a [SlavePoint] {
    match cuts.get(pair) {
        Some(Some(cut)) => cut,
        _ => &model.pairs[pair].points,
    }
}
