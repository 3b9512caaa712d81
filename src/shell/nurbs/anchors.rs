//! Springs between curves of trims and nodes on them, by which supports hold such a curve.
//!
//! Along the normal of the undeformed sheet they are stiff beside its bending, across it beside its stretching:
//! `alpha_n = 1e4 D / h^3 + 100 E t / (h (1 - nu^2))` (the second part for thin sheets under tension, whose slope takes up their load) and
//! `alpha_t = 1e4 E t / (h (1 - nu^2))`, with the width h of the element across the curve.
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

/// The same of stretching along the normal: more would lock thin sheets that bend.
const TAUT: f64 = 100.0;

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
            let along = STIFF * bending / (h * h * h) + TAUT * stretching / h;
            AnchorSpring::new(anchor, *components, along, STIFF * stretching / h)
        });
        self.anchors = springs.collect();
    }

    /// Springs at points of trims that are held.
    pub fn anchors(&self) -> &[AnchorSpring] {
        &self.anchors
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::nurbs::{BorderPoint, SheetPoint, TrimEdge};

    /// Forces are the derivative of the energy and the tangent that of the forces; a rigid shift strains nothing; components that are not
    /// held have no force, and what is held is as stiff as with the others free.
    #[test]
    fn springs_are_consistent() {
        let mut n = [0.0; 16];
        (0..16).for_each(|a| n[a] = (1.0 + a as f64) / 136.0);
        let at = SheetPoint {
            nodes: std::array::from_fn(|a| a as u32),
            n,
            n_i: [[0.0; 16]; 2],
            area: 1.0,
            weight: 1.0,
            normal: Vec3::new(0.6, 0.0, 0.8),
            position: Vec3::zeros(),
        };
        let at = BorderPoint {
            at,
            element: 0,
            length: 0.3,
            outward: [1.0, 0.0],
            width: 1.0,
        };
        let anchor = Anchor {
            trim: TrimEdge::first(),
            node: 16,
            at,
        };
        let u: [Vec3; ANCHOR_NODES] = std::array::from_fn(|a| {
            let a = a as f64;
            Vec3::new((3.1 * a).sin(), (5.3 * a).cos(), (0.7 * a).sin())
        });
        let mut f = [0.0; ANCHOR_DOFS];
        for held in [[true; 3], [false, true, true], [false, false, true]] {
            let spring = AnchorSpring::new(&anchor, held, 7.0, 100.0).unwrap();
            let mut k = vec![0.0; ANCHOR_DOFS * ANCHOR_DOFS];
            let energy = spring.evaluate(&u, &mut f, Some(&mut k));
            assert!(energy > 0.1, "{energy}");
            let flat: Vec<f64> = u.iter().flat_map(|u| u.iter().copied()).collect();
            for (row, f) in f.iter().enumerate() {
                let product: f64 = (0..ANCHOR_DOFS)
                    .map(|c| k[ANCHOR_DOFS * c + row] * flat[c])
                    .sum();
                assert!((product - f).abs() < 1e-12 * energy, "{product} {f}");
            }
            let work: f64 = flat.iter().zip(f).map(|(u, f)| u * f).sum();
            assert!((0.5 * work - energy).abs() < 1e-13 * energy);
            for c in (0..3).filter(|c| !held[*c]) {
                assert!(f.iter().skip(c).step_by(3).all(|f| *f == 0.0));
            }
            let shift = [Vec3::new(1.0, -2.0, 3.0); ANCHOR_NODES];
            assert!(spring.evaluate(&shift, &mut f, None) < 1e-25);
        }
        // Along z alone: the compliances along the normal and across it, by its components.
        let spring = AnchorSpring::new(&anchor, [false, false, true], 7.0, 100.0).unwrap();
        let exact = 0.3 / (0.64 / 7.0 + 0.36 / 100.0);
        assert!((spring.stiffness[(2, 2)] - exact).abs() < 1e-12 * exact);
    }
}
