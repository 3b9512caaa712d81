//! Memory that an assembler holds, by part, and what each part takes for a pair before it is taken.
use super::Assembler;
use super::couplings::Couplings;
use super::maps::PointMaps;
use super::moving::Meetings;
use super::sliding::Sliding;
use crate::contact::law::PairLaw;
use crate::model::state::heap;

/// Bytes of heap by what they are for, from the sizes of types alone: for plans.
pub(crate) mod sizes {
    use super::super::PointAnswer;
    use super::super::averaged::{Averaged, Rubs};
    use super::super::couplings::Couplings;
    use super::super::driven::DrivenBlock;
    use super::super::elements::pairs;
    use super::super::maps::PointMaps;
    use super::super::moving::Meetings;
    use super::super::per_pair::PerPair;
    use super::super::seams::Seams;
    use super::super::sliding::Sliding;
    use super::super::small::{Linear, Rubbing};
    use crate::contact::clearance::Clearance;
    use crate::contact::friction::turning::Turning;
    use crate::contact::points::SlavePoint;
    use crate::contact::rigid::{PointFault, Touch};
    pub use crate::effects::inertia::{Dashpots, Inertia, Mass};
    use crate::model::kernel::Kernel;
    use crate::model::master::BodySurface;
    use crate::model::{Model, PairModel};
    use std::collections::BTreeSet;
    use std::sync::Arc;

    /// A pair: its penalties, and the kernel that was run.
    pub const PAIR: usize = 2 * size_of::<f64>() + size_of::<Option<Kernel>>();
    /// The list of where the points of a pair with a rigid master go.
    pub const RIGID_MAP: usize = PerPair::<PointMaps>::HEAD;

    /// What is known of the distance of a point from a rigid master.
    pub const CLEARANCE: usize = size_of::<Clearance>();
    /// A point of a pair with a rigid master at the last state.
    pub const TOUCH: usize = size_of::<Result<Option<Touch>, PointFault>>();
    /// The surface of a body, but for what it holds.
    pub const MASTER: usize = size_of::<Option<BodySurface>>();
    /// What a pair couples, but for what it holds.
    pub const COUPLINGS: usize = PerPair::<Couplings>::HEAD;
    /// What an augmentation makes of a point.
    pub const ANSWER: usize = size_of::<Option<PointAnswer>>();
    /// The last traction of a point with history.
    pub const SLIP: usize = size_of::<Turning>();
    /// The segments of a pair, but for the points that states share.
    pub const CUT: usize = size_of::<Option<Arc<[SlavePoint]>>>();
    /// What small displacements are computed with, but for what it holds.
    pub const LINEAR: usize = size_of::<Linear>();
    /// The tangential traction of a point with friction at small displacements.
    pub const RUBBING: usize = size_of::<Rubbing>();
    /// A slave node of a driven surface.
    pub const BORDER_NODE: usize = DrivenBlock::NODE;
    /// The same with friction: more.
    pub const BELOW: usize = DrivenBlock::BELOW;

    /// The list of where the points of a pair with a rigid master go, beside [`RIGID_MAP`].
    pub fn rigid_map(model: &Model, pair: &PairModel) -> usize {
        PointMaps::size(model, &pair.points, &model.dofs)
    }

    /// For each point of a pair without friction on a body, and for all of the pair.
    pub fn meetings(pair: &PairModel) -> Option<[usize; 2]> {
        Meetings::sizes(pair)
    }

    /// For each point of a pair with friction on a body, and for all of the pair.
    pub fn sliding(pair: &PairModel) -> Option<[usize; 2]> {
        Sliding::sizes(pair)
    }

    /// For each point of a pair with averaged gaps, for each of its nodes, and for all of the pair.
    pub fn averaged(pair: &PairModel) -> [usize; 3] {
        Averaged::sizes(pair)
    }

    /// For each point of a pair with averaged gaps and friction, and for all of the pair.
    pub fn rubs(pair: &PairModel) -> Option<[usize; 2]> {
        Rubs::sizes(pair)
    }

    /// For a driven surface, beside its nodes.
    pub fn border(model: &Model) -> usize {
        DrivenBlock::whole(model)
    }

    /// Slave nodes of all pairs of a rigid surface.
    pub fn slave_nodes(model: &Model, surface: usize) -> usize {
        let own = (model.pairs.iter()).filter(|p| p.rigid_master() == Some(surface));
        let nodes: BTreeSet<usize> = own
            .flat_map(|p| {
                p.points
                    .iter()
                    .flat_map(|p| model.terms(p).map(|(node, _)| node))
            })
            .collect();
        nodes.len()
    }

    /// Where the tangents of seams go, and room for one.
    pub fn seams(model: &Model) -> usize {
        Seams::size(model)
    }

    /// Where the tangents of follower loads go.
    pub fn followers(model: &Model) -> usize {
        let of = |faces: &[crate::fem::FaceNodes]| -> usize {
            let entries: usize = faces.iter().map(|f| pairs(f.nodes().len())).sum();
            size_of::<Vec<u32>>() + size_of::<u32>() * entries
        };
        let loads = model
            .follower_loads
            .iter()
            .filter(|_| model.small.is_none());
        let spans = |load: &crate::model::loads::FollowerPressure| {
            size_of::<u32>() * pairs(16) * load.spans.len()
        };
        loads.map(|(_, load)| of(&load.faces) + spans(load)).sum()
    }
}

impl<L: PairLaw> Assembler<'_, L> {
    /// Bytes of heap that it holds, by part.
    pub fn parts(&self) -> Vec<(&'static str, usize)> {
        // Whoever adds a field decides here which part it belongs to.
        let Assembler {
            model: _,
            dofs: _,
            matrix,
            element_maps,
            kinds,
            point_maps,
            follower_maps,
            systems,
            seams,
            touches,
            clearances,
            held,
            answers,
            slips,
            masters,
            couplings,
            meetings,
            sliding,
            averaged,
            ran,
            // Shared with the matrix.
            new_pattern: _,
            rebuilds: _,
            work,
            external,
            contact,
            borders,
            effects,
            penalties,
            ratios,
            linearization: _,
            linear,
            law: _,
        } = self;
        let [values, transposed] = matrix.bytes();
        let followers: usize = follower_maps.iter().map(heap).sum();
        let mut driven = [heap(borders), 0];
        for border in borders {
            let [own, friction] = border.bytes();
            driven = [driven[0] + own, driven[1] + friction];
        }
        let links = couplings.inner(|c: &Couplings| c.links.bytes());
        let mut parts = vec![
            ("matrix", values),
            ("transposed matrix", transposed),
            ("pattern", matrix.pattern().bytes()),
            ("element maps", heap(element_maps) + heap(kinds)),
            ("seams", seams.bytes()),
            ("element work", systems.bytes()),
            ("scatter work", work.bytes()),
            ("rigid maps", point_maps.bytes(PointMaps::bytes)),
            ("rigid points", heap(touches)),
            ("clearances", heap(clearances)),
            ("points kept", heap(held)),
            ("follower maps", heap(follower_maps) + followers),
            ("answers", heap(answers)),
            ("slips", heap(slips)),
            ("masters", masters.bytes()),
            ("couplings", couplings.bytes(Couplings::bytes)),
            ("links", links),
            ("points on bodies", meetings.bytes(Meetings::bytes)),
            ("sliding points", sliding.bytes(Sliding::bytes)),
            ("averaged gaps", averaged.bytes(|a| a.bytes())),
            ("rubbing points", averaged.inner(|a| a.rubs())),
            ("loads", heap(external)),
            ("contact forces", heap(contact)),
            ("driven", driven[0]),
            ("driven friction", driven[1]),
            ("linear", linear.as_ref().map_or(0, |l| l.bytes())),
            ("pairs", heap(penalties) + heap(ratios) + heap(ran)),
        ];
        parts.extend(effects.parts());
        parts
    }
}
