//! The blocks of the pattern that closed nodes with averaged gaps need.
use super::super::couplings::Couplings;
use crate::model::PairModel;

/// Nodes that a closed node of the slave couples: those of the faces around it, and those of the facets that these are
/// coupled with.
pub(in crate::assembly::assembler) fn groups(
    pair: &PairModel,
    couplings: Option<&Couplings>,
    mut add: impl FnMut(&[u32]),
) {
    let Some(nodes) = &pair.averaged else { return };
    let (mut group, mut cells) = (Vec::new(), Vec::new());
    for place in 0..nodes.len() {
        group.clear();
        cells.clear();
        for around in nodes.around(place) {
            let point = around.point as usize;
            let p = &pair.points[point];
            group.extend_from_slice(&p.nodes[..p.count as usize]);
            cells.extend(couplings.map(|c| c.cell(point)));
        }
        cells.dedup();
        if let (Some(couplings), Some(master)) = (couplings, pair.body_master()) {
            for facet in cells.iter().flat_map(|&cell| couplings.facets(cell)) {
                group.extend_from_slice(master.facets.nodes(facet));
            }
        }
        group.sort_unstable();
        group.dedup();
        add(&group);
    }
}
