//! Slave points: where contact is sampled on the slave surface.
use super::overhang::Overhang;

/// Radius by which a free border of a rigid surface is rounded off for a point, as a part of the distance of neighbouring nodes.
/// Twice as much would be easier for Newton's method, but carry nodes that a finer mesh would show to be off the surface.
pub const ROUNDING: f64 = 0.25;

/// A slave point: a fixed combination of at most nine nodes, standing for a piece of the undeformed slave area. Where it has
/// none it is at a height above a surface: the model holds its [`Lever`](super::lever::Lever), whose number is in the place of the
/// first node.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SlavePoint {
    /// Nodes of the point; only the first `count` are used.
    pub nodes: [u32; 9],
    /// Shape functions of those nodes at the point.
    pub shape: [f64; 9],
    /// Number of nodes that the point has.
    pub count: u8,
    /// Tributary area on the undeformed surface (length^2).
    pub area: f64,
    /// Radius by which free borders of rigid surfaces are rounded off for the point: [`ROUNDING`] of the shortest distance of
    /// neighbouring nodes there (length).
    pub rounding: f64,
}

impl SlavePoint {
    /// A point at a node, whose piece is as wide as it is long.
    pub fn at_node(node: u32, area: f64) -> Self {
        SlavePoint {
            nodes: [node, 0, 0, 0, 0, 0, 0, 0, 0],
            shape: [1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0],
            count: 1,
            area,
            rounding: ROUNDING * area.sqrt(),
        }
    }

    /// A point at a height above a surface, by the number of its lever.
    pub fn lever(number: u32, area: f64) -> Self {
        SlavePoint {
            count: 0,
            ..SlavePoint::at_node(number, area)
        }
    }

    /// What it may do past a free border of a rigid surface, having been `closed` or not.
    #[inline]
    pub fn overhang(&self, closed: bool) -> Overhang {
        Overhang {
            rounding: self.rounding,
            closed,
        }
    }

    /// The number of its lever, of a point at a height above a surface.
    #[inline]
    pub fn lever_number(&self) -> Option<usize> {
        (self.count == 0).then_some(self.nodes[0] as usize)
    }

    /// Nodes with their shape functions; none of a point at a height above a surface.
    pub fn terms(&self) -> impl Iterator<Item = (usize, f64)> + '_ {
        let n = self.count as usize;
        (self.nodes[..n].iter().zip(&self.shape[..n])).map(|(&node, &w)| (node as usize, w))
    }
}
