//! The slave points of a pair without friction whose master is a body, evaluated at one state.
use crate::contact::friction::history::PointHistory;
use crate::contact::kind::{FrictionKind, LawKind, TangentKind};
use crate::contact::law::{Held, Multipliers, NoOffset, Offsets, PairLaw, PointLaw};
use crate::contact::moving::{MovingMaster, MovingTouch};
use crate::contact::point::FaceTangent;
use crate::contact::points::SlavePoint;
use crate::contact::rigid::{Exact, PointFault};
use crate::model::Model;
use crate::model::kernel::{GapKind, Kernel, SideKind};
use crate::model::self_contact::Accept;
use crate::model::state::PointState;
use rayon::prelude::*;

/// The slave points of a pair at one trial state.
pub(super) struct Batch<'a, L> {
    pub model: &'a Model,
    pub points: &'a [SlavePoint],
    pub master: MovingMaster<'a>,
    pub law: &'a L,
    pub kernel: &'a Kernel,
    pub u: &'a [f64],
}

/// What the gaps of the points of a pair are measured from.
#[derive(Clone, Copy)]
pub(super) struct Measured<'a> {
    /// Empty without multipliers.
    pub histories: &'a [PointHistory],
    pub offsets: Option<Offsets<'a>>,
    /// Points that stay in contact wherever they are.
    pub held: Option<&'a [bool]>,
}

impl<L: PairLaw> Batch<'_, L> {
    /// Evaluates every point under the law that the plan names: with gaps measured from where the pair says, and with
    /// multipliers where it has any. Returns what was run.
    pub fn offset<A: Accept>(
        &self,
        states: &mut [PointState],
        touches: &mut [Result<Option<MovingTouch>, PointFault>],
        Measured {
            histories,
            offsets,
            held,
        }: Measured,
        accept: &A,
    ) -> Kernel {
        if let Some(held) = held {
            let held = Held {
                held,
                histories,
                offsets,
            };
            return self.choose(states, touches, &held, accept);
        }
        match self.kernel.law {
            LawKind::Penalty | LawKind::Held => self.choose(states, touches, &NoOffset, accept),
            LawKind::Offset => self.choose(states, touches, &offsets.unwrap_or_default(), accept),
            LawKind::Multipliers => {
                let multipliers = Multipliers { histories, offsets };
                self.choose(states, touches, &multipliers, accept)
            }
        }
    }

    /// Evaluates every point under the tangent that the plan names.
    fn choose<O: PointLaw, A: Accept>(
        &self,
        states: &mut [PointState],
        touches: &mut [Result<Option<MovingTouch>, PointFault>],
        offsets: &O,
        accept: &A,
    ) -> Kernel {
        match self.kernel.tangent {
            TangentKind::Exact => self.evaluate(states, touches, offsets, accept, &Exact),
            TangentKind::Published(parts) => {
                self.evaluate(states, touches, offsets, accept, &parts)
            }
        }
    }

    /// Evaluates every point; law, offsets, tangent and the facets that exist are types here, nothing is chosen inside the
    /// loop.
    fn evaluate<O: PointLaw, A: Accept, T: FaceTangent>(
        &self,
        states: &mut [PointState],
        touches: &mut [Result<Option<MovingTouch>, PointFault>],
        offsets: &O,
        accept: &A,
        tangent: &T,
    ) -> Kernel {
        (self.points.par_iter())
            .zip(states.par_iter_mut())
            .zip(touches.par_iter_mut())
            .enumerate()
            .with_min_len(32)
            .for_each(|(i, ((p, s), out))| {
                let x = self.model.point_position(p, self.u);
                let at = accept.point(i);
                let facet = |f| accept.facet(at, f);
                let law = offsets.law(i, self.law);
                let known = (&mut s.hint, p.overhang(s.closed));
                *out = (self.master).touch(&x, known, &law, tangent, facet);
            });
        Kernel {
            gap: GapKind::Pointwise,
            master: A::KIND,
            law: O::KIND,
            friction: FrictionKind::None,
            tangent: tangent.kind(),
            // Which rows are summed is another loop's.
            sides: SideKind::Both,
        }
    }
}
