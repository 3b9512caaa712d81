//! Twists (mixed second derivatives) at the corners of facets.

use super::lines::{central, one_sided};
use super::tangents::{Rule, Tangents};
use super::{Combination, Mesh};
use crate::moving::topology::EDGES_AT;

/// Twist at a corner of a facet, for parameters that grow by 1 along both edges that leave the corner.
pub(super) fn twist(mesh: &Mesh, tangents: &Tangents, facet: u32, corner: usize) -> Combination {
    tensor(mesh, tangents, facet, corner).unwrap_or_else(|| coons(mesh, tangents, facet, corner))
}

/// Of the bilinearly blended Coons patch of the four edges: the tangents' changes along both edges less the change of the
/// bilinear facet's.
fn coons(mesh: &Mesh, tangents: &Tangents, facet: u32, corner: usize) -> Combination {
    let tangent = |dir: usize, corner: usize| {
        // The edge along xi1 is the second of a corner.
        tangents.of(mesh, facet, EDGES_AT[corner][1 - dir], corner)
    };
    let mut out = Combination::default();
    for dir in 0..2 {
        // The edge along `dir`, and the same behind the other edge.
        out.add(tangent(dir, corner ^ (2 >> dir)), 1.0);
        out.add(tangent(dir, corner), -1.0);
    }
    for (other, sign) in [(0, -1.0), (1, 1.0), (2, 1.0), (3, -1.0)] {
        out.add_node(mesh.node(facet, corner ^ other), sign);
    }
    out
}

/// A facet seen from one of its corners: node (i, j) is i steps along `u` and j along `v`.
#[derive(Debug, Clone, Copy, PartialEq)]
struct View {
    facet: u32,
    corner: usize,
    /// Bit of the corner number that changes along `u`; the other one changes along `v`.
    bit: usize,
}

impl View {
    fn corner(&self, [i, j]: [usize; 2]) -> usize {
        self.corner ^ (i * self.bit) ^ (j * (3 ^ self.bit))
    }

    fn node(&self, mesh: &Mesh, at: [usize; 2]) -> u32 {
        mesh.node(self.facet, self.corner(at))
    }

    /// Edge of the facet between two of its corners.
    fn edge(&self, a: [usize; 2], b: [usize; 2]) -> usize {
        let (a, b) = (self.corner(a), self.corner(b));
        let shared = EDGES_AT[a].into_iter().find(|e| EDGES_AT[b].contains(e));
        shared.unwrap_or(0)
    }

    /// The view of the facet across the side at the low (`high` false) or high end of direction `dir`; `None` where the
    /// surface is not smooth there.
    fn across(&self, mesh: &Mesh, dir: usize, high: bool) -> Option<View> {
        let end = usize::from(high);
        let side = [0, 1].map(|k| if dir == 0 { [end, k] } else { [k, end] });
        let edge = self.edge(side[0], side[1]);
        let number = mesh.topology.edge(self.facet, edge)?;
        if mesh.hard[number as usize] {
            return None;
        }
        let members = mesh.topology.edge_members(number);
        let &(facet, _) = members.iter().find(|m| m.0 != self.facet)?;
        let nodes = side.map(|at| self.node(mesh, at));
        let find = |node: u32| {
            let mut at = (0..4).filter(|&c| mesh.node(facet, c) == node);
            at.next().filter(|_| at.next().is_none())
        };
        let [a, b] = [find(nodes[0])?, find(nodes[1])?];
        // The bit that changes along the common side belongs to the other direction.
        let along = a ^ b;
        if along == 3 || along == 0 {
            return None;
        }
        let bit = if dir == 0 { 3 ^ along } else { along };
        // Of the low side the common edge is the neighbour's high one.
        let corner = if high { a } else { a ^ 3 ^ along };
        Some(View { facet, corner, bit })
    }
}

/// Nodes of a line of a tensor product (steps from the corner) and their factors.
struct Line {
    steps: &'static [i32],
    factors: [f64; 3],
    /// Where facets other than the corner's are needed: at the low or the high side.
    outside: Option<bool>,
}

/// Of the tensor product of the two lines that cross at the corner; `None` where they do not.
fn tensor(mesh: &Mesh, tangents: &Tangents, facet: u32, corner: usize) -> Option<Combination> {
    let own = View {
        facet,
        corner,
        bit: 1,
    };
    let line = |dir: usize| {
        let edge = EDGES_AT[corner][1 - dir];
        let number = mesh.topology.edge(facet, edge)?;
        let (steps, factors, outside, next): (&[i32], _, _, _) =
            match tangents.rule(mesh, facet, edge, corner) {
                Rule::Central(other) => {
                    let ratio = mesh.ratio(other.edge, number);
                    (
                        &[-1, 0, 1],
                        central(ratio),
                        Some(false),
                        Some((other.to, 0)),
                    )
                }
                Rule::OneSided(next) => {
                    let ratio = mesh.ratio(next.edge, number);
                    (&[0, 1, 2], one_sided(ratio), Some(true), Some((next.to, 1)))
                }
                Rule::Chord => (&[0, 1], [-1.0, 1.0, 0.0], None, None),
                Rule::Plane => return None,
            };
        // The line must run through the facet beside, not elsewhere.
        if let (Some(high), Some((to, i))) = (outside, next) {
            let beside = own.across(mesh, dir, high)?;
            let at = if dir == 0 { [i, 0] } else { [0, i] };
            if beside.node(mesh, at) != to {
                return None;
            }
        }
        Some(Line {
            steps,
            factors,
            outside,
        })
    };
    let (u, v) = (line(0)?, line(1)?);
    let beside = [(0, u.outside), (1, v.outside)]
        .map(|(dir, high)| high.and_then(|high| own.across(mesh, dir, high)));
    let diagonal = match (u.outside, v.outside) {
        (Some(first), Some(second)) => {
            let one = beside[0]?.across(mesh, 1, second)?;
            let other = beside[1]?.across(mesh, 0, first)?;
            if one != other {
                return None;
            }
            Some(one)
        }
        _ => None,
    };
    let mut out = Combination::default();
    for (&j, fv) in v.steps.iter().zip(v.factors) {
        for (&i, fu) in u.steps.iter().zip(u.factors) {
            let outside = [i, j].map(|k| !(0..=1).contains(&k));
            let view = match outside {
                [false, false] => own,
                [true, false] => beside[0]?,
                [false, true] => beside[1]?,
                [true, true] => diagonal?,
            };
            // Steps -1 and 2 are the far sides of the facets there.
            let at = [i, j].map(|k| usize::from(k > 0));
            out.add_node(view.node(mesh, at), fu * fv);
        }
    }
    Some(out)
}
