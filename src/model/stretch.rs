//! How far displacements move neighbouring nodes against each other.
use super::Model;
use covact_geometry::Vec3;

impl Model {
    /// By how much of their distance displacements `u` move neighbouring nodes of bodies against each other, at most.
    pub fn largest_stretch(&self, u: &[f64]) -> f64 {
        self.largest_stretches(u)[0]
    }

    /// By how much displacements `u` move neighbouring nodes of bodies against each other, at most: over their distance, and in all
    /// (length).
    pub fn largest_stretches(&self, u: &[f64]) -> [f64; 2] {
        let at = |n: u32| {
            Vec3::new(
                u[3 * n as usize],
                u[3 * n as usize + 1],
                u[3 * n as usize + 2],
            )
        };
        let mut most = [0.0f64; 2];
        for body in &self.bodies {
            let first = body.first_node;
            for e in 0..body.mesh.elements() {
                let nodes = body.mesh.element(e);
                for pair in nodes.windows(2) {
                    let [a, b] = [pair[0], pair[1]];
                    let apart = body.mesh.nodes[a as usize] - body.mesh.nodes[b as usize];
                    let moved = at(a + first) - at(b + first);
                    let moved = moved.norm_squared();
                    most[0] = most[0].max(moved / apart.norm_squared());
                    most[1] = most[1].max(moved);
                }
            }
        }
        most.map(f64::sqrt)
    }
}
