//! Springs between curves of trims and nodes on them, by which supports hold such a curve.
//!
//! Along the normal of the undeformed sheet they are stiff beside its bending, across it beside its stretching:
//! `alpha_n = 1e4 D / h^3` and `alpha_t = 1e4 E t / (h (1 - nu^2))`, with the width h of the element across the curve.
use super::NurbsBlock;
use super::frame::NODES;
use crate::mesh::nurbs::Anchor;
use covact_geometry::Vec3;
use nalgebra::Matrix3;

/// Control points of an element, and the node on the curve.
pub const ANCHOR_NODES: usize = NODES + 1;

/// Their degrees of freedom.
pub const ANCHOR_DOFS: usize = 3 * ANCHOR_NODES;

/// How stiff they are, in stiffnesses of the sheet over the width of an element.
const STIFF: f64 = 1e4;

/// A spring at a point of a curve.
#[derive(Debug, Clone)]
pub struct AnchorSpring {
    /// Control points, numbered in the sheet, then the node on the curve.
    pub nodes: [u32; ANCHOR_NODES],
    /// Shape functions, and minus one.
    n: [f64; ANCHOR_NODES],
    stiffness: Matrix3<f64>,
}

impl AnchorSpring {
    /// A spring that holds some components only: the others are free of force.
    fn new(anchor: &Anchor, held: [bool; 3], along: f64, across: f64) -> Option<AnchorSpring> {
        let p = &anchor.at;
        let normal = p.at.normal;
        let dyad = normal * normal.transpose();
        let full = Matrix3::identity() * across + dyad * (along - across);
        // What is held has the stiffness whose inverse is this part of the inverse.
        let mut soft = full.try_inverse()?;
        for c in (0..3).filter(|c| !held[*c]) {
            soft.fill_row(c, 0.0);
            soft.fill_column(c, 0.0);
            soft[(c, c)] = 1.0;
        }
        let mut stiffness = soft.try_inverse()?;
        for c in (0..3).filter(|c| !held[*c]) {
            stiffness[(c, c)] = 0.0;
        }
        stiffness = (stiffness + stiffness.transpose()) * (0.5 * p.length);
        let mut nodes = [anchor.node; ANCHOR_NODES];
        nodes[..NODES].copy_from_slice(&p.at.nodes);
        let mut n = [-1.0; ANCHOR_NODES];
        n[..NODES].copy_from_slice(&p.at.n);
        Some(AnchorSpring {
            nodes,
            n,
            stiffness,
        })
    }

    /// Energy at displacements `u`; forces, and with a room for it (columns of [`ANCHOR_DOFS`]) the tangent.
    pub fn evaluate(
        &self,
        u: &[Vec3; ANCHOR_NODES],
        f: &mut [f64; ANCHOR_DOFS],
        k: Option<&mut [f64]>,
    ) -> f64 {
        let jump: Vec3 = u.iter().zip(self.n).map(|(u, n)| u * n).sum();
        let force = self.stiffness * jump;
        for (f, n) in f.chunks_exact_mut(3).zip(self.n) {
            (0..3).for_each(|c| f[c] = force[c] * n);
        }
        if let Some(k) = k {
            for (b, nb) in self.n.iter().enumerate() {
                for c in 0..3 {
                    let column = &mut k[ANCHOR_DOFS * (3 * b + c)..][..ANCHOR_DOFS];
                    for (block, na) in column.chunks_exact_mut(3).zip(self.n) {
                        (0..3).for_each(|r| block[r] = self.stiffness[(r, c)] * (na * nb));
                    }
                }
            }
        }
        0.5 * force.dot(&jump)
    }
}

impl NurbsBlock {
    /// `E t^3 / 12 (1 - nu^2)`.
    pub(super) fn bending(&self) -> f64 {
        let nu = self.law.nu();
        self.law.young() * self.sheet.thickness.powi(3) / (12.0 * (1.0 - nu * nu))
    }

    /// Holds components of the anchors of the sheet.
    pub fn hold_anchors(&mut self, held: &[(usize, [bool; 3])]) {
        let bending = self.bending();
        let stretching = 12.0 * bending / (self.sheet.thickness * self.sheet.thickness);
        let springs = held.iter().filter_map(|(index, components)| {
            let anchor = self.sheet.anchors.get(*index)?;
            let h = anchor.at.width;
            let along = STIFF * bending / (h * h * h);
            AnchorSpring::new(anchor, *components, along, STIFF * stretching / h)
        });
        self.anchors = springs.collect();
    }

    /// Springs at points of trims that are held.
    pub fn anchors(&self) -> &[AnchorSpring] {
        &self.anchors
    }
}
