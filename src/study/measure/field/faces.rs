//! Slave faces, as the results tell them.
use super::cell::Cell;
use crate::mesh::{Face, Mesh};
use crate::output::NOT_A_SLAVE;
use std::collections::HashMap;

/// Faces on the boundary whose nodes all have a status other than [`NOT_A_SLAVE`]. Where bottom and top of an element are
/// slaves its sides have such nodes too, and are left out.
pub(super) fn of_slaves(mesh: &Mesh, status: &[f64]) -> Vec<Cell> {
    let slave = |node: &u32| status[*node as usize] != f64::from(NOT_A_SLAVE);
    let all = |element: u32, face: u8| {
        let nodes = mesh.face_nodes(Face { element, face });
        nodes.nodes().iter().all(slave).then_some(nodes)
    };
    let key = |mut corners: [u32; 4]| {
        corners.sort_unstable();
        corners
    };
    let mut found = Vec::new();
    let mut times: HashMap<[u32; 4], u32> = HashMap::new();
    for element in 0..mesh.elements() as u32 {
        let both = all(element, 4).is_some() && all(element, 5).is_some();
        let first = if both { 4 } else { 0 };
        for face in 0..6 {
            let Some(nodes) = all(element, face) else {
                continue;
            };
            *times.entry(key(nodes.corners())).or_default() += 1;
            if face >= first {
                found.push(nodes);
            }
        }
    }
    found.retain(|nodes| times.get(&key(nodes.corners())) == Some(&1));
    found.iter().map(Cell::face).collect()
}
