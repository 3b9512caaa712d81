//! The pattern of a model and where the blocks of everything that is assembled go.
use super::couplings::Couplings;
use super::per_pair::PerPair;
use super::{DofMap, Kind, Pattern, PatternError};
use super::{averaged, driven};
use crate::model::{Model, PairModel};

/// Places of all blocks on one pattern.
pub(super) struct Maps {
    pub elements: Vec<u32>,
    pub kinds: Vec<Kind>,
    /// Per pair with a rigid master: per point, where its blocks go.
    pub points: PerPair<Vec<u32>>,
    /// Per follower load: per face, where its blocks go.
    pub followers: Vec<Vec<u32>>,
}

/// The pattern of a model under its constraints: elements, and slave points with the facets that they may touch.
pub(super) fn pattern(
    model: &Model,
    dofs: &DofMap,
    couplings: &PerPair<Couplings>,
) -> Result<Pattern, PatternError> {
    let mut nodes: Vec<u32> = Vec::new();
    let mut starts = vec![0];
    let mut plain = Vec::new();
    let mut add = |group: &[u32]| {
        dofs.extend_nodes(group, &mut nodes);
        starts.push(nodes.len());
    };
    for body in &model.bodies {
        for e in 0..body.block.elements() {
            plain.clear();
            plain.extend(body.element_nodes(e));
            add(&plain);
        }
    }
    for (index, pair) in model.pairs.iter().enumerate() {
        let couplings = couplings.get(index);
        if let (Some(master), Some(couplings)) = (pair.body_master(), couplings) {
            for (cell, facet) in couplings.pairs() {
                plain.clear();
                plain.extend_from_slice(couplings.nodes(cell));
                plain.extend_from_slice(master.facets.nodes(facet));
                add(&plain);
            }
            for facets in couplings.links.pairs() {
                plain.clear();
                plain.extend(facets.iter().flat_map(|&f| master.facets.nodes(f)));
                add(&plain);
            }
        }
        averaged::groups(pair, couplings, &mut add);
    }
    let driven = driven::groups(model, |nodes, out| dofs.extend_nodes(nodes, out));
    let groups = starts.windows(2).map(|w| &nodes[w[0]..w[1]]);
    let groups = groups.chain(driven.iter().map(Vec::as_slice));
    let border = (model.nodes.len() - model.body_nodes()) as u32;
    Ok(Pattern::new(model.nodes.len(), groups)?.with_border(border))
}

impl Maps {
    pub fn new(model: &Model, dofs: &DofMap, pattern: &Pattern) -> Result<Self, PatternError> {
        let (mut elements, mut kinds) = (Vec::new(), Vec::new());
        let (mut nodes, mut extended) = (Vec::new(), Vec::new());
        for body in &model.bodies {
            for e in 0..body.block.elements() {
                nodes.clear();
                nodes.extend(body.element_nodes(e));
                pattern.element_map(&nodes, &mut elements)?;
                extended.clear();
                dofs.extend_nodes(&nodes, &mut extended);
                kinds.push(if extended.len() > nodes.len() {
                    Kind::Tied
                } else if dofs.constrains(&nodes) {
                    Kind::Prescribed
                } else {
                    Kind::Free
                });
            }
        }
        let mut points = Vec::new();
        let rigid = |p: &&PairModel| p.rigid_master().is_some();
        for (index, pair) in model.pairs.iter().enumerate().filter(|(_, p)| rigid(p)) {
            let mut maps = Vec::new();
            for p in &pair.points {
                pattern.element_map(&p.nodes[..p.count as usize], &mut maps)?;
            }
            maps.shrink_to_fit();
            points.push((index, maps));
        }
        let mut followers = Vec::new();
        // At small displacements pressures do not follow.
        let follower = model
            .follower_loads
            .iter()
            .filter(|_| model.small.is_none());
        for (_, load) in follower {
            let mut maps = Vec::new();
            for nodes in &load.faces {
                pattern.element_map(nodes.nodes(), &mut maps)?;
            }
            maps.shrink_to_fit();
            followers.push(maps);
        }
        elements.shrink_to_fit();
        kinds.shrink_to_fit();
        followers.shrink_to_fit();
        Ok(Maps {
            elements,
            kinds,
            points: PerPair::from(points),
            followers,
        })
    }
}
