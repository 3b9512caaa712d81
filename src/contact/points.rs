//! Slave points: where contact is sampled on the slave surface.

/// A slave point: a fixed combination of at most nine nodes, standing for a piece of the undeformed slave area.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SlavePoint {
    /// Nodes of the point; only the first `count` are used.
    pub nodes: [u32; 9],
    /// Shape functions of those nodes at the point.
    pub shape: [f64; 9],
    pub count: u8,
    /// Tributary area on the undeformed surface (length^2).
    pub area: f64,
}

impl SlavePoint {
    /// A point at a node.
    pub fn at_node(node: u32, area: f64) -> Self {
        SlavePoint {
            nodes: [node, 0, 0, 0, 0, 0, 0, 0, 0],
            shape: [1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0],
            count: 1,
            area,
        }
    }

    /// Nodes with their shape functions.
    pub fn terms(&self) -> impl Iterator<Item = (usize, f64)> + '_ {
        let n = self.count as usize;
        (self.nodes[..n].iter().zip(&self.shape[..n])).map(|(&node, &w)| (node as usize, w))
    }
}
