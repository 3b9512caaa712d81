//! The pattern of a model and where the blocks of everything that is assembled go.
use super::couplings::Couplings;
use super::{DofMap, Kind, Pattern, PatternError};
use super::{averaged, driven};
use crate::contact::points::SlavePoint;
use crate::model::Model;

/// Places of all blocks on one pattern.
pub(super) struct Maps {
    pub elements: Vec<u32>,
    pub kinds: Vec<Kind>,
    /// Per pair.
    pub points: Vec<PointMaps>,
    /// Per follower load: per face, where its blocks go.
    pub followers: Vec<Vec<u32>>,
}

/// Where the blocks of a pair's points go; empty unless its master is rigid.
#[derive(Debug, Clone, Default)]
pub(super) struct PointMaps {
    /// First values of the blocks of plain points, for [`SystemMatrix::scatter_point`](crate::assembly::SystemMatrix).
    places: Vec<u32>,
    /// Per point, where its own places begin; `u32::MAX` where it is not plain.
    starts: Vec<u32>,
}

impl PointMaps {
    fn new(points: &[SlavePoint], dofs: &DofMap, pattern: &Pattern) -> Result<Self, PatternError> {
        let mut out = PointMaps::default();
        for p in points {
            let nodes = &p.nodes[..p.count as usize];
            let twice = |(i, node): (usize, &u32)| nodes[..i].contains(node);
            let start = match u32::try_from(out.places.len()) {
                Ok(start) if !dofs.constrains(nodes) && !nodes.iter().enumerate().any(twice) => {
                    pattern.point_places(nodes, &mut out.places)?;
                    start
                }
                _ => u32::MAX,
            };
            out.starts.push(start);
        }
        Ok(out)
    }

    /// The places of a point of `count` nodes none of which is constrained or occurs twice; nothing for others.
    #[inline(always)]
    pub fn plain(&self, point: usize, count: usize) -> Option<&[u32]> {
        let start = self.starts[point];
        let pairs = count * (count + 1) / 2;
        match start {
            u32::MAX => None,
            _ => Some(&self.places[start as usize..start as usize + pairs]),
        }
    }
}

/// The pattern of a model under its constraints: elements, and slave points with the facets that they may touch.
pub(super) fn pattern(
    model: &Model,
    dofs: &DofMap,
    couplings: &[Option<Couplings>],
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
    for (pair, couplings) in model.pairs.iter().zip(couplings) {
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
        averaged::groups(pair, couplings.as_ref(), &mut add);
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
        for pair in &model.pairs {
            points.push(match pair.rigid_master() {
                Some(_) => PointMaps::new(&pair.points, dofs, pattern)?,
                None => PointMaps::default(),
            });
        }
        let mut followers = Vec::new();
        for (_, load) in &model.follower_loads {
            let mut maps = Vec::new();
            for nodes in &load.faces {
                pattern.element_map(nodes.nodes(), &mut maps)?;
            }
            followers.push(maps);
        }
        Ok(Maps {
            elements,
            kinds,
            points,
            followers,
        })
    }
}
