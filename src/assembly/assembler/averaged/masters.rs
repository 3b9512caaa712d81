//! The closest points of a pair with averaged gaps, on either kind of master.
use super::super::sliding::Slides;
use super::super::{Assembler, Fault};
use crate::contact::friction::law::Slide;
use crate::contact::kind::MasterKind;
use crate::contact::law::PairLaw;
use crate::contact::moving::MovingMaster;
use crate::contact::rigid::RigidMaster;
use crate::model::histories;
use crate::model::kernel::Kernel;
use crate::model::master::Master;
use crate::model::self_contact::{Accept, Opposing};
use crate::model::state::State;
use crate::model::surface::with_patches;
use std::ops::Range;

impl<L: PairLaw> Assembler<'_, L> {
    /// How friction is linearised.
    fn slides<const TANGENT: bool>(&self) -> Slides {
        let slide = self.linearization.slide;
        Slides {
            slide,
            note: TANGENT && slide != Slide::Stick,
        }
    }

    /// Finds the points of a pair with a rigid master; those of bodies are found before the pattern is known to do.
    pub(in crate::assembly::assembler) fn meet_rigid<const TANGENT: bool>(
        &mut self,
        index: usize,
        first: usize,
        state: &mut State,
        time: f64,
    ) -> Result<(), Fault> {
        let (slides, keep) = (self.slides::<TANGENT>(), self.linearization.keep_facets);
        let (model, pair) = (self.model, &self.model.pairs[index]);
        let (Master::Rigid(number), Some(averaged)) = (&pair.master, self.averaged.get_mut(index))
        else {
            return Ok(());
        };
        let master = model.surfaces[*number].at(time, &state.u)?;
        let states = &mut state.points[first..first + pair.points.len()];
        let (of_pair, reach) = (L::of(self.penalties[index]), pair.reach(model));
        let (known, u) = (
            histories::multipliers(&state.cuts, model, index),
            &state.u[..],
        );
        let multipliers = &state.histories[known.clone()];
        let law = with_patches!(master.surface, patches => {
            let master = RigidMaster {
                surface: patches,
                pose: master.pose,
                depth: master.depth,
                keep,
            };
            averaged.meet(model, pair, (&of_pair, multipliers), (u, time, keep), states, |_, x, at| {
                master.meet(x, at, reach)
            })
        })?;
        averaged.answer(self.answers.get_mut(known).unwrap_or_default());
        let mut ran = Kernel {
            master: model.surfaces[*number].kind(),
            law,
            ..model.kernel(index)
        };
        let range = histories::range(&state.cuts, model, index);
        if let (Some(friction), Some(range)) = (&pair.friction, range) {
            let now = friction.law.at(time)?;
            let eps_t = self.ratios[index] * self.penalties[index];
            let (histories, slips) = (&state.histories[range.clone()], &mut self.slips[range]);
            averaged.rub_rigid(
                (model, pair, u),
                &master.pose,
                (now, eps_t, slides),
                histories,
                slips,
            );
            ran.friction = now.kind();
        }
        self.ran[index] = Some(ran);
        Ok(())
    }

    /// Finds the points of a pair whose master is a body, the pair's in the state being `range`; says whether the pattern lacks
    /// facets that they feel.
    pub(in crate::assembly::assembler) fn meet_bodies<const TANGENT: bool>(
        &mut self,
        index: usize,
        range: Range<usize>,
        state: &mut State,
        time: f64,
    ) -> Result<bool, Fault> {
        let (slides, keep) = (self.slides::<TANGENT>(), self.linearization.keep_facets);
        let (model, pair) = (self.model, &self.model.pairs[index]);
        let (Some(master), Some(surface), Some(couplings), Some(averaged)) = (
            pair.body_master(),
            self.masters.surface(index),
            self.couplings.get(index),
            self.averaged.get_mut(index),
        ) else {
            return Ok(false);
        };
        let facets = MovingMaster {
            facets: &surface.facets,
            undeformed: &master.facets,
            depth: master.depth,
            keep,
        };
        let law = L::of(self.penalties[index]);
        let known = histories::multipliers(&state.cuts, model, index);
        let law = (&law, &state.histories[known.clone()]);
        let at = (&state.u[..], time, keep);
        let (states, reach) = (&mut state.points[range], pair.reach(model));
        let law = match &master.own {
            None => averaged.meet(model, pair, law, at, states, |_, x, at| {
                facets.meet(x, at, reach, |_| true)
            }),
            Some(own) => {
                let accept = Opposing {
                    own,
                    normals: &surface.normals,
                    position: |n: u32| model.position(n as usize, at.0),
                };
                averaged.meet(model, pair, law, at, states, |i, x, at| {
                    let own = accept.point(i);
                    facets.meet(x, at, reach, |f| accept.facet(own, f))
                })
            }
        }?;
        averaged.answer(self.answers.get_mut(known).unwrap_or_default());
        let mut ran = Kernel {
            law,
            master: match &master.own {
                None => MasterKind::Faces,
                Some(_) => MasterKind::OwnFaces,
            },
            ..model.kernel(index)
        };
        let range = histories::range(&state.cuts, model, index);
        let mut missing = averaged.touched().any(|(i, f)| !couplings.holds(i, f));
        if let (Some(friction), Some(range)) = (&pair.friction, range) {
            let now = friction.law.at(time)?;
            let eps_t = self.ratios[index] * self.penalties[index];
            let (histories, slips) = (&state.histories[range.clone()], &mut self.slips[range]);
            let what = (now, eps_t, slides);
            averaged.rub_bodies((model, pair, at.0), &facets, what, histories, slips)?;
            ran.friction = now.kind();
            // A closed node couples all facets that the points around it feel, so that they need no links.
            let anchor = |i: usize| histories[i].place.map(|at| at.patch);
            missing |= (averaged.touched())
                .filter_map(|(i, _)| Some((i, anchor(i)?)))
                .any(|(i, f)| !couplings.holds(i, f));
        }
        self.ran[index] = Some(ran);
        Ok(missing)
    }
}
