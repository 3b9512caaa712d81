//! Contact with friction between bodies: as [`super::moving`], with histories, and columns for the facets that hold the
//! attraction points.
use super::answer::PointAnswer;
use super::moving::{room, same};
use super::per_pair::PerPair;
use super::rigid::rounding;
use super::touched::{self, Touched};
use super::{Assembler, Fault, Linearization, PairForce, SurfaceForce, Totals, put};
use crate::contact::clearance::Clearance;
use crate::contact::friction::history::PointHistory;
use crate::contact::friction::law::{FrictionLaw, Slide};
use crate::contact::friction::moving::{Form, Full, Reduced};
use crate::contact::friction::rigid::Friction;
use crate::contact::friction::scatter::{MOST, PointNodes};
use crate::contact::friction::touch::MovingFrictionTouch;
use crate::contact::friction::turning::Turning;
use crate::contact::kind::{LawKind, TangentKind};
use crate::contact::law::{Augmented, Offsets, PairLaw};
use crate::contact::lever;
use crate::contact::moving::MovingMaster;
use crate::contact::points::SlavePoint;
use crate::contact::rigid::PointFault;
use crate::model::friction::FrictionModel;
use crate::model::friction::with_law;
use crate::model::kernel::{GapKind, Kernel, SideKind};
use crate::model::master::{BodyMaster, BodySurface};
use crate::model::self_contact::{Accept, All, Opposing};
use crate::model::state::{PointState, State, heap, slaves};
use crate::model::{Model, PairModel};
use covact_geometry::{CurvedRows, ShapeRows, Vec3};
use rayon::prelude::*;
use std::ops::Range;
use std::sync::Arc;

/// Stands for a slave point itself among the nodes, where that is at a height above a mid-surface.
const POINT: u32 = u32::MAX;

/// Points whose matrices are formed before they are summed.
const CHUNK: usize = 64;

/// The slave points of a pair with friction at the state evaluated last, and room for their matrices.
#[derive(Debug, Clone, Default)]
pub(super) struct Sliding {
    touched: Touched<MovingFrictionTouch>,
    work: Vec<PointWork>,
    matrices: Vec<f64>,
    /// Numbers that the largest matrix has.
    stride: usize,
    /// The segments that the points are of.
    cut: Option<Arc<[SlavePoint]>>,
}

/// What is looked up for a point.
#[derive(Debug, Clone, Default)]
struct PointWork {
    nodes: PointNodes,
    shape: CurvedRows,
    anchor: ShapeRows,
}

impl Sliding {
    /// Bytes of heap for each point of a pair, and for all of it.
    pub fn sizes(pair: &PairModel) -> Option<[usize; 2]> {
        let stride = Sliding::stride(pair)?;
        let most = CHUNK.min(pair.points.len());
        let point = size_of::<Result<Option<MovingFrictionTouch>, PointFault>>();
        let room = most * (size_of::<PointWork>() + stride * size_of::<f64>());
        let point = point + size_of::<u32>();
        Some([point, PerPair::<Sliding>::HEAD + room])
    }

    /// Numbers that the largest matrix of a pair has; none where this is not for the pair.
    fn stride(pair: &PairModel) -> Option<usize> {
        let master = pair.body_master().filter(|_| pair.links())?;
        let facets = 0..master.facets.len() as u32;
        let facet = facets.map(|f| master.facets.nodes(f).len()).max();
        Some(room(pair, 2 * facet.unwrap_or(0)))
    }

    /// Bytes of heap that it holds.
    pub fn bytes(&self) -> usize {
        let Sliding {
            touched,
            work,
            matrices,
            stride: _,
            // Shared with the states.
            cut: _,
        } = self;
        touched.bytes() + heap(work) + heap(matrices)
    }

    /// Room for a pair; nothing without friction, or where the master is rigid.
    pub fn new(pair: &PairModel) -> Option<Self> {
        let mut out = Sliding {
            stride: Sliding::stride(pair)?,
            ..Sliding::default()
        };
        out.resize(pair.points.len());
        Some(out)
    }

    /// Room for another number of points.
    fn resize(&mut self, points: usize) {
        let most = CHUNK.min(points);
        self.touched.resize(points);
        self.work.resize(most, PointWork::default());
        self.matrices.resize(most * self.stride, 0.0);
    }

    /// Takes over the number of points of segments that were cut anew, and says whether they were.
    pub(super) fn follow(&mut self, cut: &Option<Arc<[SlavePoint]>>, points: usize) -> bool {
        let anew = !same(&self.cut, cut);
        if anew {
            self.cut.clone_from(cut);
            self.resize(points);
        }
        anew
    }

    /// Points in contact, with the facets at their feet and those of their attraction points.
    pub fn touched(&self) -> impl Iterator<Item = (usize, u32, u32)> + '_ {
        (self.touched.active.iter()).filter_map(|&i| {
            let t = self.touched.get(i)?;
            let foot = t.foot.patch;
            Some((i as usize, foot, t.anchor.map_or(foot, |a| a.patch)))
        })
    }

    /// What an augmentation makes of the points evaluated last.
    pub fn answer(
        &self,
        surface: &BodySurface,
        histories: &[PointHistory],
        eps_t: f64,
        answers: &mut [Option<PointAnswer>],
    ) {
        let facets = &surface.facets;
        for ((touch, history), answer) in self.touched.all.iter().zip(histories).zip(answers) {
            *answer = touched::of(touch).map(|t| PointAnswer::between(t, history, facets, eps_t));
        }
    }

    /// Evaluates every point of a pair; returns what was run.
    #[allow(clippy::too_many_arguments)]
    pub fn meet<L: PairLaw>(
        &mut self,
        model: &Model,
        (pair, points, kernel): (&PairModel, &[SlavePoint], &Kernel),
        (master, surface): (&BodyMaster, &BodySurface),
        (friction, [penalty, ratio], linearization): (&FrictionModel, [f64; 2], Linearization),
        u: &[f64],
        time: f64,
        states: &mut [PointState],
        (histories, slips, tangent): (&[PointHistory], &mut [Turning], bool),
    ) -> Result<Kernel, Fault> {
        let batch = Batch {
            model,
            points,
            kernel,
            master: MovingMaster {
                facets: &surface.facets,
                undeformed: &master.facets,
                depth: master.depth,
                keep: linearization.keep_facets,
            },
            law: L::of(penalty),
            u,
            histories,
            slides: Slides {
                slide: linearization.slide,
                note: tangent
                    && linearization.slide != Slide::Stick
                    && kernel.law != LawKind::Multipliers,
            },
            hold: linearization.keep_active,
            offsets: pair.offsets(time),
        };
        let eps_t = ratio * penalty;
        let touches = &mut self.touched.all;
        let now = friction.law.at(time)?;
        let ran = with_law!(now, law => {
            let friction = Friction { law, eps_t };
            match &master.own {
                None => batch.choose(states, (touches, slips), &friction, &All),
                Some(own) => {
                    let accept = Opposing {
                        own,
                        normals: &surface.normals,
                        position: |n: u32| model.position(n as usize, u),
                    };
                    batch.choose(states, (touches, slips), &friction, &accept)
                }
            }
        });
        (self.touched).settle(pair, |i| model.point_position(&points[i], u))?;
        Ok(Kernel {
            friction: now.kind(),
            ..ran
        })
    }
}

impl<L: PairLaw> Assembler<'_, L> {
    /// Begins a solution: no point has a traction to turn from, or is known to be open. What was known before would change
    /// the last bits of where searches end, and a run that is continued does not know it.
    pub fn begin_solution(&mut self) {
        self.slips.fill(Turning::default());
        self.clearances.fill(Clearance::default());
    }

    /// Whether points slide to and fro from one linearisation to the next.
    pub fn oscillates(&self) -> bool {
        self.slips.iter().any(Turning::oscillates)
    }

    /// Sums up a pair with friction that [`Assembler::meet`] has evaluated.
    #[allow(clippy::too_many_arguments)]
    pub(super) fn slide<const TANGENT: bool>(
        &mut self,
        index: usize,
        state: &mut State,
        range: Range<usize>,
        increments: Option<&[f64]>,
        residual: &mut [f64],
        rhs: &mut [f64],
        totals: &mut Totals,
    ) {
        // A half pass acts on its slave alone, so that the master's rows are not asked for.
        match self.model.kernel(index).sides {
            SideKind::Both => self.slide_as::<TANGENT, _>(
                index, state, range, increments, residual, rhs, totals, &Full,
            ),
            SideKind::Slave => self.slide_as::<TANGENT, _>(
                index, state, range, increments, residual, rhs, totals, &Reduced,
            ),
        }
    }

    #[allow(clippy::too_many_arguments)]
    fn slide_as<const TANGENT: bool, M: Form>(
        &mut self,
        index: usize,
        state: &mut State,
        range: Range<usize>,
        increments: Option<&[f64]>,
        residual: &mut [f64],
        rhs: &mut [f64],
        totals: &mut Totals,
        form: &M,
    ) {
        let model = self.model;
        let pair = &model.pairs[index];
        let points = slaves(&state.cuts, model, index);
        let u = &state.u[..];
        let half = pair.half.is_some();
        let (Some(surface), Some(couplings), Some(sliding)) = (
            self.masters.surface(index),
            self.couplings.get_mut(index),
            self.sliding.get_mut(index),
        ) else {
            return;
        };
        let facets = &surface.facets;
        let Sliding {
            touched,
            work,
            matrices,
            stride,
            cut: _,
        } = sliding;
        touched.note(&mut state.points[range], totals);
        let law = L::of(self.penalties[index]);
        let mut deepest = 0.0f64;
        let mut force = PairForce::default();
        let share = pair.share();
        for chunk in touched.active.chunks(CHUNK) {
            (chunk.par_iter())
                .zip(work.par_iter_mut())
                .zip(matrices.par_chunks_mut((*stride).max(1)))
                .with_min_len(8)
                .for_each(|((&i, work), ke)| {
                    let Some(touch) = touched.get(i) else { return };
                    let p = &points[i as usize];
                    let PointWork {
                        nodes,
                        shape,
                        anchor,
                    } = work;
                    let count = p.count as usize;
                    let lever = p.lever_number();
                    match lever {
                        Some(_) => nodes.start(&[POINT], &[1.0]),
                        None => nodes.start(&p.nodes[..count], &p.shape[..count]),
                    }
                    match M::FULL {
                        true => facets.curved_shape(touch.foot.patch, touch.foot.xi, shape),
                        false => {
                            facets.shape(touch.foot.patch, touch.foot.xi, &mut shape.rows);
                        }
                    }
                    nodes.facet(facets.nodes(touch.foot.patch), shape, !half);
                    if TANGENT {
                        if let Some(at) = touch.anchor {
                            facets.shape(at.patch, at.xi, anchor);
                            nodes.anchor(facets.nodes(at.patch), anchor);
                        }
                        let count = nodes.nodes().len();
                        let size = 3 * count;
                        match lever {
                            None => {
                                let ke = &mut ke[..size * size];
                                nodes.assemble(&touch.response, p.area, form, ke);
                            }
                            Some(number) => {
                                let others = count - 1;
                                let large = 3 * (lever::NODES + others);
                                let (ke, point) = ke.split_at_mut(large * large);
                                let point = &mut point[..size * size];
                                nodes.assemble(&touch.response, p.area, form, point);
                                let f = touch.response.residual.fixed_rows::<3>(0) * p.area;
                                let position = |n: u32| model.position(n as usize, u);
                                model.levers[number].expand(position, &f, others, point, ke);
                            }
                        }
                    }
                });
            for ((&i, work), ke) in
                (chunk.iter().zip(work.iter())).zip(matrices.chunks_mut(*stride))
            {
                let Some(touch) = touched.get(i) else {
                    continue;
                };
                let p = &points[i as usize];
                deepest = deepest.max(-touch.gap);
                totals.contact_energy += share * law.energy(touch.gap) * p.area;
                let x = self.model.point_position(p, u);
                totals.contact_rounding += rounding(&law, touch.gap, p, &x);
                let nodes = &work.nodes;
                let lever = p.lever_number().map(|number| &model.levers[number]);
                let mut add = |node: usize, f: &Vec3, side: &mut SurfaceForce| {
                    side.force -= f;
                    side.moment -= model.position(node, u).cross(f);
                    for c in 0..3 {
                        residual[3 * node + c] += f[c];
                        self.contact[3 * node + c] += f[c];
                    }
                };
                for (k, (node, f)) in nodes.forces(&touch.response, p.area).enumerate() {
                    match lever {
                        Some(lever) if k == 0 => {
                            let position = |n: u32| model.position(n as usize, u);
                            let forces = lever.spread(position, &f, None);
                            for (node, f) in lever.nodes.iter().zip(&forces) {
                                add(*node as usize, f, &mut force.slave);
                            }
                        }
                        _ if k < nodes.slave() => add(node as usize, &f, &mut force.slave),
                        _ => add(node as usize, &f, &mut force.master),
                    }
                }
                if TANGENT {
                    let mut all = [0; lever::NODES + MOST];
                    let own = match lever {
                        None => nodes.nodes(),
                        Some(lever) => {
                            let others = &nodes.nodes()[1..];
                            let count = lever::NODES + others.len();
                            all[..lever::NODES].copy_from_slice(&lever.nodes);
                            all[lever::NODES..count].copy_from_slice(others);
                            &all[..count]
                        }
                    };
                    let n = own.len();
                    let foot = touch.foot.patch;
                    let key = [
                        couplings.cell(i as usize) as u32,
                        foot,
                        touch.anchor.map_or(foot, |a| a.patch),
                    ];
                    let pattern = self.matrix.pattern();
                    let map = (couplings.links)
                        .map(key, |out| pattern.element_map(own, out))
                        .expect("the pattern was built with every facet that a point feels");
                    put(
                        &mut self.matrix,
                        self.dofs,
                        &mut self.work,
                        own,
                        &map[..n * (n + 1) / 2],
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

/// How friction is linearised.
#[derive(Debug, Clone, Copy)]
pub(super) struct Slides {
    pub slide: Slide,
    /// Whether the tractions found are those that the next linearisation compares with. Not so with multipliers: they hold a
    /// point already, and the secant, which knows nothing of them, leads to other equilibria.
    pub note: bool,
}

/// The slave points of a pair at one trial state.
struct Batch<'a, L> {
    model: &'a Model,
    points: &'a [SlavePoint],
    kernel: &'a Kernel,
    master: MovingMaster<'a>,
    law: L,
    u: &'a [f64],
    histories: &'a [PointHistory],
    slides: Slides,
    /// Points that are closed stay so.
    hold: bool,
    offsets: Option<Offsets<'a>>,
}

type Touches = [Result<Option<MovingFrictionTouch>, PointFault>];

impl<L: PairLaw> Batch<'_, L> {
    /// Evaluates every point with the virtual work that the pair needs.
    fn choose<F: FrictionLaw, A: Accept>(
        &self,
        states: &mut [PointState],
        found: (&mut Touches, &mut [Turning]),
        friction: &Friction<F>,
        accept: &A,
    ) -> Kernel {
        match self.kernel.sides {
            SideKind::Both => self.evaluate(states, found, friction, accept, &Full),
            SideKind::Slave => self.evaluate(states, found, friction, accept, &Reduced),
        }
    }

    /// Evaluates every point; law, form and the facets that exist are types here.
    fn evaluate<F: FrictionLaw, A: Accept, M: Form>(
        &self,
        states: &mut [PointState],
        (touches, slips): (&mut Touches, &mut [Turning]),
        friction: &Friction<F>,
        accept: &A,
        form: &M,
    ) -> Kernel {
        (self.points.par_iter())
            .zip(states.par_iter_mut())
            .zip(touches.par_iter_mut())
            .zip(slips.par_iter_mut())
            .zip(self.histories)
            .enumerate()
            .with_min_len(32)
            .for_each(|(i, ((((p, s), out), slip), history))| {
                let x = self.model.point_position(p, self.u);
                let law = Augmented {
                    held: self.hold && s.closed,
                    ..history.law(self.law, self.offsets.map_or(0.0, |o| o.at(i)))
                };
                let at = accept.point(i);
                let facet = |f| accept.facet(at, f);
                let hint = (&mut s.hint, p.overhang(s.closed));
                let secant = friction.sliding(self.slides.slide, slip);
                *out = (self.master)
                    .touch_with_friction(&x, hint, &law, &secant, history, form, facet);
                if self.slides.note {
                    slip.note(touched::of(out).map(|t| &t.response.slip));
                }
            });
        Kernel {
            gap: GapKind::Pointwise,
            master: A::KIND,
            // With a history every law has room for a multiplier, which without augmentation is zero.
            law: match self.offsets {
                _ if self.hold => LawKind::Held,
                _ if self.kernel.law == LawKind::Multipliers => LawKind::Multipliers,
                Some(_) => LawKind::Offset,
                None => LawKind::Penalty,
            },
            friction: self.kernel.friction,
            tangent: TangentKind::Exact,
            sides: match M::FULL {
                true => SideKind::Both,
                false => SideKind::Slave,
            },
        }
    }
}
