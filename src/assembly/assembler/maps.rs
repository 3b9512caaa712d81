//! The pattern of a model and where the blocks of everything that is assembled go.
use super::couplings::Couplings;
use super::elements::pairs;
use super::per_pair::PerPair;
use super::{DofMap, Kind, Pattern, PatternError};
use super::{averaged, driven};
use crate::contact::points::SlavePoint;
use crate::model::state::heap;
use crate::model::{Model, PairModel};

/// Places of all blocks on one pattern.
pub(super) struct Maps {
    pub elements: Vec<u32>,
    pub kinds: Vec<Kind>,
    /// Of the seams of all bodies, then of their springs.
    pub seams: Vec<u32>,
    /// Per pair with a rigid master.
    pub points: PerPair<PointMaps>,
    /// Per follower load: per face, where its blocks go.
    pub followers: Vec<Vec<u32>>,
}

/// Where the blocks of the points of a pair with a rigid master go.
#[derive(Debug, Clone, Default)]
pub(super) struct PointMaps {
    /// First values of the blocks of plain points, for [`SystemMatrix::scatter_point`](crate::system::SystemMatrix).
    places: Vec<u32>,
    /// Per point, where its own places begin; `u32::MAX` where it is not plain.
    starts: Vec<u32>,
}

impl PointMaps {
    fn new(
        model: &Model,
        points: &[SlavePoint],
        dofs: &DofMap,
        pattern: &Pattern,
    ) -> Result<Self, PatternError> {
        let mut out = PointMaps::default();
        let mut before: Option<([u32; 16], u32)> = None;
        for p in points {
            if let Some(number) = p.lever_number() {
                // Points of one element follow each other, and share its places.
                let nodes = model.levers[number].nodes;
                let start = match before {
                    Some((own, start)) if own == nodes => start,
                    _ if dofs.constrains(&nodes) => u32::MAX,
                    _ => {
                        let start = u32::try_from(out.places.len()).unwrap_or(u32::MAX);
                        pattern.element_map(&nodes, &mut out.places)?;
                        start
                    }
                };
                before = Some((nodes, start));
                out.starts.push(start);
                continue;
            }
            let nodes = &p.nodes[..p.count as usize];
            let start = match u32::try_from(out.places.len()) {
                Ok(start) if is_plain(nodes, dofs) => {
                    pattern.point_places(nodes, &mut out.places)?;
                    start
                }
                _ => u32::MAX,
            };
            out.starts.push(start);
        }
        out.places.shrink_to_fit();
        out.starts.shrink_to_fit();
        Ok(out)
    }

    /// Bytes of heap that the maps of such points hold, whatever the pattern.
    pub fn size(model: &Model, points: &[SlavePoint], dofs: &DofMap) -> usize {
        let mut levers: Vec<[u32; 16]> = (points.iter())
            .filter_map(|p| Some(model.levers[p.lever_number()?].nodes))
            .collect();
        levers.dedup();
        let whole = levers.iter().filter(|nodes| !dofs.constrains(&nodes[..]));
        let whole = whole.count() * pairs(16);
        let plain = points
            .iter()
            .filter(|p| p.count > 0)
            .map(|p| &p.nodes[..p.count as usize])
            .filter(|nodes| is_plain(nodes, dofs));
        let places: usize = plain.map(|nodes| pairs(nodes.len())).sum();
        size_of::<u32>() * (whole + places + points.len())
    }

    /// Bytes of heap that they hold.
    pub fn bytes(&self) -> usize {
        heap(&self.places) + heap(&self.starts)
    }

    /// The places of a point of `count` nodes none of which is constrained or occurs twice; nothing for others.
    #[inline(always)]
    pub fn plain(&self, point: usize, count: usize) -> Option<&[u32]> {
        match *self.starts.get(point)? {
            u32::MAX => None,
            start => Some(&self.places[start as usize..start as usize + pairs(count)]),
        }
    }
}

/// No node is prescribed or tied, or occurs twice: the blocks go straight into the matrix.
fn is_plain(nodes: &[u32], dofs: &DofMap) -> bool {
    let twice = |(i, node): (usize, &u32)| nodes[..i].contains(node);
    !dofs.constrains(nodes) && !nodes.iter().enumerate().any(twice)
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
        for seam in body.block.seams() {
            add(&seam.nodes.map(|n| n + body.first_node));
        }
        for spring in body.block.anchors() {
            plain.clear();
            plain.extend(spring.nodes().iter().map(|n| n + body.first_node));
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
    let border = 2 * model.driven().count() as u32;
    Ok(Pattern::new(model.nodes.len(), groups)?.with_border(border))
}

impl Maps {
    pub fn new(model: &Model, dofs: &DofMap, pattern: &Pattern) -> Result<Self, PatternError> {
        let (mut elements, mut kinds) = (Vec::new(), Vec::new());
        let mut seams = Vec::new();
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
        for body in &model.bodies {
            for seam in body.block.seams() {
                pattern.element_map(&seam.nodes.map(|n| n + body.first_node), &mut seams)?;
            }
        }
        for body in &model.bodies {
            for spring in body.block.anchors() {
                nodes.clear();
                nodes.extend(spring.nodes().iter().map(|n| n + body.first_node));
                pattern.element_map(&nodes, &mut seams)?;
            }
        }
        seams.shrink_to_fit();
        let mut points = Vec::new();
        // At small displacements points have a loop of their own.
        let rigid = |p: &PairModel| p.rigid_master().is_some() && model.small.is_none();
        for (index, pair) in model.pairs.iter().enumerate().filter(|(_, p)| rigid(p)) {
            points.push((index, PointMaps::new(model, &pair.points, dofs, pattern)?));
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
            for span in &load.spans {
                pattern.element_map(span.nodes(), &mut maps)?;
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
            seams,
            points: PerPair::from(points),
            followers,
        })
    }
}
