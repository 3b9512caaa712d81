//! Which local direction of a hexahedron is the thickness? Mesh files do not say, shells must know.
//!
//! 1. A surface `top` (or `bottom`): from the opposite face to it, through all elements of the column below.
//! 2. Otherwise along the shortest way through the body, from face to opposite face through all elements on it: a layer may
//!    have elements that are shorter in its plane than it is thick. Clearest elements first, each passing its direction on through
//!    its column.
//! 3. Elements without a clearly shortest way follow their neighbours, and keep the file's order when no
//!    neighbour knows either.
//!
//! The sense of t is carried from neighbour to neighbour, so that bottom and top are the same side everywhere.
use super::measure::H8_EDGES;
use super::raw::ThicknessRule;
use super::topology::FaceTable;
use super::{Face, Mesh};

/// A way counts as shortest when it is shorter than this part of the next one.
const CLEARLY_SHORTER: f64 = 0.9;

const NO_FACE: Face = Face {
    element: u32::MAX,
    face: 0,
};

/// Chosen top faces of the elements.
struct Choice<'m> {
    mesh: &'m Mesh,
    /// Face on the other side of every face, element by element.
    beyond: Vec<[Face; 6]>,
    /// Local face that becomes t = +1.
    top: Vec<Option<u8>>,
    /// Elements for which two sources disagreed.
    conflicts: usize,
}

/// Rotates the elements so that t is the thickness, and their face sets with them. Returns the weakest rule used, and for
/// every element the local face that became its top.
pub(super) fn orient(
    mesh: &mut Mesh,
    given: &[bool],
    notes: &mut Vec<String>,
) -> (ThicknessRule, Vec<u8>) {
    let mut choice = Choice::new(mesh);
    for (e, given) in given.iter().enumerate() {
        if *given {
            choice.top[e] = Some(5);
        }
    }
    let mut rule = if given.iter().any(|g| *g) {
        ThicknessRule::FileOrder
    } else {
        ThicknessRule::Surface
    };
    for (name, flip) in [("top", 0), ("bottom", 1)] {
        for face in mesh.face_sets.get(name).into_iter().flatten() {
            choice.column(face.element, face.face ^ flip, true);
        }
    }
    if choice.conflicts > 0 {
        notes.push(format!(
            "thickness direction: surfaces `top` and `bottom` disagree at {} element(s); the first one was taken",
            choice.conflicts
        ));
    }
    if choice.top.contains(&None) {
        rule = ThicknessRule::ShortestWay;
        choice.shortest();
        let kept = choice.keep_order();
        if kept > 0 {
            rule = ThicknessRule::FileOrder;
            notes.push(format!(
                "thickness direction: {kept} of {} elements have no clearly shortest way through the body; the file's order is \
                 kept (t = local direction 3). Name a surface `top` to choose it",
                mesh.elements()
            ));
        } else {
            notes.push(
                "thickness direction: along the shortest way through the body. Name a surface `top` to choose it"
                    .to_string(),
            );
        }
    }
    let uneven = choice.uneven();
    if uneven > 0 {
        notes.push(format!(
            "thickness direction: {uneven} pair(s) of neighbouring elements have different ones"
        ));
    }
    let top: Vec<u8> = choice.top.iter().map(|t| t.unwrap_or(5)).collect();
    rotate(mesh, &top);
    (rule, top)
}

impl Choice<'_> {
    fn new(mesh: &Mesh) -> Choice<'_> {
        let mut beyond = vec![[NO_FACE; 6]; mesh.elements()];
        for group in FaceTable::new(mesh).groups() {
            if let [a, b] = group {
                beyond[a.1.element as usize][a.1.face as usize] = b.1;
                beyond[b.1.element as usize][b.1.face as usize] = a.1;
            }
        }
        Choice {
            mesh,
            beyond,
            top: vec![None; mesh.elements()],
            conflicts: 0,
        }
    }

    /// Makes `face` the top of `element`, and goes on downwards (and upwards) through the column. Elements that have a
    /// direction already end the way; with `count` a different direction is counted as a conflict.
    fn column(&mut self, element: u32, face: u8, count: bool) {
        if let Some(top) = self.top[element as usize] {
            self.conflicts += usize::from(count && top != face);
            return;
        }
        self.top[element as usize] = Some(face);
        for (down, mut at) in [(true, face ^ 1), (false, face)] {
            let mut e = element;
            loop {
                let next = self.beyond[e as usize][at as usize];
                if next == NO_FACE {
                    break;
                }
                let top = if down { next.face } else { next.face ^ 1 };
                if let Some(known) = self.top[next.element as usize] {
                    self.conflicts += usize::from(count && known != top);
                    break;
                }
                self.top[next.element as usize] = Some(top);
                e = next.element;
                at = next.face ^ 1;
            }
        }
    }

    /// Rules 2 and 3 for the elements that have no direction yet.
    fn shortest(&mut self) {
        // Directions first, with the file's sense; the sense follows in a second pass over the neighbours.
        let mut thin: Vec<(f64, u32, u8)> = Vec::new();
        for (e, ways) in self.ways().into_iter().enumerate() {
            if self.top[e].is_none() {
                let (ratio, axis) = shortest(ways);
                if ratio < CLEARLY_SHORTER {
                    thin.push((ratio, e as u32, 2 * axis + 1));
                }
            }
        }
        thin.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        let free: Vec<bool> = self.top.iter().map(Option::is_none).collect();
        for &(_, e, face) in &thin {
            self.column(e, face, false);
        }
        self.spread(&free);
    }

    /// For every element the ways through the body along its three directions: the sum of the mean lengths of the elements that one
    /// goes through, once round where it comes back.
    fn ways(&self) -> Vec<[f64; 3]> {
        let mut ways = vec![[0.0; 3]; self.mesh.elements()];
        let mut column = Vec::new();
        for e in 0..self.mesh.elements() as u32 {
            for axis in 0..3 {
                if ways[e as usize][axis as usize] > 0.0 {
                    continue;
                }
                let start = (e, 2 * axis);
                column.clear();
                column.push(start);
                for first in [start, (e, 2 * axis + 1)] {
                    let mut at = first;
                    loop {
                        let next = self.beyond[at.0 as usize][at.1 as usize];
                        if next == NO_FACE || next.element == e && next.face >> 1 == axis {
                            break;
                        }
                        at = (next.element, next.face ^ 1);
                        column.push(at);
                    }
                    // Once round: there is no other way to go.
                    if self.beyond[at.0 as usize][at.1 as usize] != NO_FACE {
                        break;
                    }
                }
                let length = |&(e, face): &(u32, u8)| mean_edge(self.mesh, e as usize, face >> 1);
                let way: f64 = column.iter().map(length).sum();
                for (e, face) in &column {
                    ways[*e as usize][(face >> 1) as usize] = way;
                }
            }
        }
        ways
    }

    /// Elements still without a direction keep the file's, column by column; returns their number.
    fn keep_order(&mut self) -> usize {
        let free: Vec<bool> = self.top.iter().map(Option::is_none).collect();
        let kept = free.iter().filter(|f| **f).count();
        for e in 0..self.top.len() {
            if self.top[e].is_none() {
                self.column(e as u32, 5, false);
            }
        }
        self.spread(&free);
        kept
    }

    /// Carries direction and sense from neighbour to neighbour. Among `free` elements the direction is kept where there
    /// is one and only its sense is adapted; the others are taken as they are and are where the way starts.
    fn spread(&mut self, free: &[bool]) {
        let n = self.top.len();
        let mut reached: Vec<bool> = free.iter().map(|f| !f).collect();
        let mut queue: std::collections::VecDeque<u32> =
            (0..n as u32).filter(|&e| reached[e as usize]).collect();
        let mut start = 0;
        loop {
            while let Some(e) = queue.pop_front() {
                for face in 0..6 {
                    let Some((other, top)) = self.carried(e, face) else {
                        continue;
                    };
                    if reached[other as usize] {
                        continue;
                    }
                    let own = self.top[other as usize];
                    // Another direction than the carried one (a wall meeting a floor) keeps its own sense for now.
                    if own.is_some_and(|own| own >> 1 != top >> 1) {
                        continue;
                    }
                    self.top[other as usize] = Some(top);
                    reached[other as usize] = true;
                    queue.push_back(other);
                }
            }
            match (start..n).find(|&e| !reached[e] && self.top[e].is_some()) {
                None => break,
                Some(e) => {
                    reached[e] = true;
                    queue.push_back(e as u32);
                    start = e + 1;
                }
            }
        }
    }

    /// The neighbour beyond `face` and the top face it has if its thickness continues that of `e`.
    fn carried(&self, e: u32, face: u8) -> Option<(u32, u8)> {
        let top = self.top[e as usize]?;
        let next = self.beyond[e as usize][face as usize];
        if next == NO_FACE {
            return None;
        }
        if face == top {
            return Some((next.element, next.face ^ 1));
        }
        if face == top ^ 1 {
            return Some((next.element, next.face));
        }
        // A side face: the neighbour's top is its other face at the edge that both faces have in common.
        let mesh = self.mesh;
        let ours = mesh.face_corners(Face {
            element: e,
            face: top,
        });
        let shared = mesh.face_corners(next);
        let edge: [bool; 4] = shared.map(|n| ours.contains(&n));
        let other = (0..6u8).filter(|f| f >> 1 != next.face >> 1).find(|&f| {
            let nodes = mesh.face_corners(Face {
                element: next.element,
                face: f,
            });
            (0..4).all(|i| nodes.contains(&shared[i]) == edge[i])
        })?;
        Some((next.element, other))
    }

    /// Pairs of neighbours whose thickness directions do not continue each other.
    fn uneven(&self) -> usize {
        let mut count = 0;
        for e in 0..self.top.len() as u32 {
            for face in 0..6 {
                if let Some((other, top)) = self.carried(e, face) {
                    count += usize::from(other > e && self.top[other as usize] != Some(top));
                }
            }
        }
        count
    }
}

/// Mean length of the edges of an element along a local direction.
fn mean_edge(mesh: &Mesh, e: usize, axis: u8) -> f64 {
    let x = mesh.element_positions(e);
    let edges = H8_EDGES[4 * axis as usize..][..4].iter();
    let length = |[a, b]: &[u8; 2]| (x[*b as usize] - x[*a as usize]).norm();
    0.25 * edges.map(length).sum::<f64>()
}

/// Ratio of the shortest of three ways to the next one, and its direction.
fn shortest(ways: [f64; 3]) -> (f64, u8) {
    let mut ways = [(ways[0], 0), (ways[1], 1), (ways[2], 2)];
    ways.sort_by(|a, b| a.0.total_cmp(&b.0));
    (ways[0].0 / ways[1].0, ways[0].1)
}

/// The rotation that makes a local face the top: old local directions along the new r, s and t, and whether t turns over.
/// It stays right-handed.
fn rotation(top: u8) -> ([usize; 3], bool) {
    let axis = usize::from(top >> 1);
    let (next, after) = ((axis + 1) % 3, (axis + 2) % 3);
    // (next, after, axis) is a rotation of (0, 1, 2); turning t over swaps the other two.
    if top & 1 == 1 {
        ([next, after, axis], false)
    } else {
        ([after, next, axis], true)
    }
}

/// Nodes of an element of `n` nodes along each direction, renumbered so that its local face `top` becomes t = +1.
pub(super) fn rotated<'e>(nodes: &'e [u32], n: usize, top: u8) -> impl Iterator<Item = u32> + 'e {
    let (from, flip) = rotation(top);
    (0..n * n * n).map(move |a| {
        let t = a / (n * n);
        let new = [a % n, a / n % n, if flip { n - 1 - t } else { t }];
        let mut old = 0;
        for (direction, place) in from.into_iter().zip(new) {
            old += place * n.pow(direction as u32);
        }
        nodes[old]
    })
}

/// Renumbers each element locally so that the face `top[e]` becomes t = +1.
fn rotate(mesh: &mut Mesh, top: &[u8]) {
    let mut face_map = vec![[0u8, 1, 2, 3, 4, 5]; top.len()];
    for (e, &top) in top.iter().enumerate() {
        let nodes: Vec<u32> = mesh.element(e).to_vec();
        for (slot, node) in mesh.connectivity[8 * e..8 * e + 8]
            .iter_mut()
            .zip(rotated(&nodes, 2, top))
        {
            *slot = node;
        }
        let ([r, s, t], flip) = rotation(top);
        for side in 0..2u8 {
            face_map[e][2 * r + usize::from(side)] = side;
            face_map[e][2 * s + usize::from(side)] = 2 + side;
            face_map[e][2 * t + usize::from(side)] = 4 + (side ^ u8::from(flip));
        }
    }
    for face in mesh.face_sets.values_mut().flatten() {
        face.face = face_map[face.element as usize][face.face as usize];
    }
}
