//! Springs between curves of trims and nodes on them, by which supports hold such a curve.
//!
//! At every point they are stiff beside the bending of the undeformed sheet along its normal, and beside its stretching across it:
//! `alpha_n = 1e4 D / h^3` and `alpha_t = 1e4 E t / (h (1 - nu^2))`, with the width h of the element across the curve. Thin sheets under
//! tension, whose slope takes up their load, need more along the normal, `100 E t / (h (1 - nu^2))`. That acts on the mean over stretches
//! of the curve as long as an element: at every point it would lock, because two points on each piece of a curve within an element
//! are more than the shape functions along the curve have numbers for.
use super::NurbsBlock;
use super::frame::NODES;
use crate::mesh::nurbs::Anchor;
use covact_geometry::Vec3;
use nalgebra::Matrix3;

/// How stiff they are, in stiffnesses of the sheet over the width of an element.
const STIFF: f64 = 1e4;

/// The same of stretching along the normal, of means: more would lock thin sheets that bend.
const TAUT: f64 = 100.0;

/// Parts of a normal along axes that are not held, up to which it counts as held.
const ROUNDING: f64 = 1e-9;

/// A spring at a point of a curve, or on the mean over a stretch of it.
#[derive(Debug, Clone)]
pub struct AnchorSpring {
    /// Control points, numbered in the sheet, then nodes on the curve.
    nodes: Vec<u32>,
    law: Spring,
}

#[derive(Debug, Clone)]
enum Spring {
    /// The displacement of the point from its node: shape functions, minus one, and what resists it.
    Point {
        n: Vec<f64>,
        stiffness: Matrix3<f64>,
    },
    /// The mean displacement along the normals from the nodes: its derivatives, and what resists it.
    Mean { n: Vec<Vec3>, stiffness: f64 },
}

impl AnchorSpring {
    /// A spring at a point that holds some components only: the others are free of force.
    fn at_point(anchor: &Anchor, held: [bool; 3], along: f64, across: f64) -> Option<AnchorSpring> {
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
        let mut nodes = p.at.nodes.to_vec();
        nodes.push(anchor.node);
        let mut n = p.at.n.to_vec();
        n.push(-1.0);
        let law = Spring::Point { n, stiffness };
        Some(AnchorSpring { nodes, law })
    }

    /// A spring on the mean over the points of a stretch, of a stiffness per length each.
    fn on_mean(anchors: &[(&Anchor, f64)]) -> AnchorSpring {
        let length: f64 = anchors.iter().map(|(a, _)| a.at.length).sum();
        let stiffness = anchors.iter().map(|(a, k)| k * a.at.length).sum();
        let (mut nodes, mut n): (Vec<u32>, Vec<Vec3>) = (Vec::with_capacity(4 * NODES), Vec::new());
        for (anchor, _) in anchors {
            let p = &anchor.at;
            let along = p.at.normal * (p.length / length);
            for (node, own) in p.at.nodes.iter().zip(p.at.n) {
                match nodes.iter().position(|other| other == node) {
                    Some(k) => n[k] += along * own,
                    None => {
                        nodes.push(*node);
                        n.push(along * own);
                    }
                }
            }
        }
        for (anchor, _) in anchors {
            nodes.push(anchor.node);
            n.push(anchor.at.at.normal * (-anchor.at.length / length));
        }
        let law = Spring::Mean { n, stiffness };
        AnchorSpring { nodes, law }
    }

    /// Control points, numbered in the sheet, then nodes on the curve: one at the end.
    pub fn nodes(&self) -> &[u32] {
        &self.nodes
    }

    /// Bytes of heap.
    pub(super) fn bytes(&self) -> usize {
        let own = match &self.law {
            Spring::Point { n, .. } => size_of_val(&n[..]),
            Spring::Mean { n, .. } => size_of_val(&n[..]),
        };
        size_of_val(&self.nodes[..]) + own
    }

    /// Energy at displacements `u` of the nodes; forces, and with a room for it (by columns) the tangent.
    pub fn evaluate(&self, u: &[Vec3], f: &mut [f64], k: Option<&mut [f64]>) -> f64 {
        match &self.law {
            Spring::Point { n, stiffness } => {
                let jump: Vec3 = u.iter().zip(n).map(|(u, n)| u * *n).sum();
                let force = stiffness * jump;
                for (f, n) in f.chunks_exact_mut(3).zip(n) {
                    (0..3).for_each(|c| f[c] = force[c] * n);
                }
                tangent(n, k, |a, b| stiffness * (a * b));
                0.5 * force.dot(&jump)
            }
            Spring::Mean { n, stiffness } => {
                let jump: f64 = u.iter().zip(n).map(|(u, n)| u.dot(n)).sum();
                let force = stiffness * jump;
                for (f, n) in f.chunks_exact_mut(3).zip(n) {
                    (0..3).for_each(|c| f[c] = force * n[c]);
                }
                tangent(n, k, |a, b| a * b.transpose() * *stiffness);
                0.5 * force * jump
            }
        }
    }
}

/// Writes the tangent, by columns, of which `block` has the part of two nodes.
fn tangent<N>(n: &[N], k: Option<&mut [f64]>, block: impl Fn(&N, &N) -> Matrix3<f64>) {
    let Some(k) = k else { return };
    let dofs = 3 * n.len();
    for (b, nb) in n.iter().enumerate() {
        for (a, na) in n.iter().enumerate() {
            let own = block(na, nb);
            for c in 0..3 {
                k[dofs * (3 * b + c) + 3 * a..][..3].copy_from_slice(own.column(c).as_slice());
            }
        }
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
        let (mut springs, mut run) = (Vec::new(), Vec::new());
        for (index, components) in held {
            let Some(anchor) = self.sheet.anchors.get(*index) else {
                continue;
            };
            let h = anchor.at.width;
            let (bent, taut) = (STIFF * bending / h.powi(3), TAUT * stretching / h);
            let normal = anchor.at.at.normal;
            let whole = (0..3).all(|c| components[c] || normal[c].abs() < ROUNDING);
            // Where the normal is held in part, what is taut acts at the point.
            let along = if whole { bent } else { bent + taut };
            springs.extend(AnchorSpring::at_point(
                anchor,
                *components,
                along,
                STIFF * stretching / h,
            ));
            if !run
                .last()
                .is_none_or(|(last, _): &(&Anchor, f64)| whole && last.precedes(anchor))
            {
                means(&run, &mut springs);
                run.clear();
            }
            if whole {
                run.push((anchor, taut));
            }
        }
        means(&run, &mut springs);
        self.anchors = springs;
    }

    /// Springs that hold trims: at their points, and on means over stretches.
    pub fn anchors(&self) -> &[AnchorSpring] {
        &self.anchors
    }
}

/// Springs on means over stretches, of the length of an element each, of points that follow each other on a curve.
fn means(run: &[(&Anchor, f64)], springs: &mut Vec<AnchorSpring>) {
    let of = |(anchor, _): &(&Anchor, f64)| anchor.at.length / anchor.at.along;
    let all: f64 = run.iter().map(of).sum();
    let count = all.round().max(1.0);
    let mut at = 0.0;
    let place = run.iter().map(|point| {
        let middle = at + 0.5 * of(point);
        at += of(point);
        (middle / all * count) as usize
    });
    let places: Vec<usize> = place.collect();
    let mut start = 0;
    for stretch in places.chunk_by(|a, b| a == b) {
        springs.push(AnchorSpring::on_mean(&run[start..start + stretch.len()]));
        start += stretch.len();
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::nurbs::{BorderPoint, SheetPoint, TrimEdge};

    const DOFS: usize = 3 * (NODES + 1);

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
            along: 1.0,
        };
        let anchor = Anchor {
            trim: TrimEdge::first(),
            node: 16,
            at,
        };
        let u: [Vec3; NODES + 1] = std::array::from_fn(|a| {
            let a = a as f64;
            Vec3::new((3.1 * a).sin(), (5.3 * a).cos(), (0.7 * a).sin())
        });
        let mut f = [0.0; DOFS];
        for held in [[true; 3], [false, true, true], [false, false, true]] {
            let spring = AnchorSpring::at_point(&anchor, held, 7.0, 100.0).unwrap();
            let mut k = vec![0.0; DOFS * DOFS];
            let energy = spring.evaluate(&u, &mut f, Some(&mut k));
            assert!(energy > 0.1, "{energy}");
            let flat: Vec<f64> = u.iter().flat_map(|u| u.iter().copied()).collect();
            for (row, f) in f.iter().enumerate() {
                let product: f64 = (0..DOFS).map(|c| k[DOFS * c + row] * flat[c]).sum();
                assert!((product - f).abs() < 1e-12 * energy, "{product} {f}");
            }
            let work: f64 = flat.iter().zip(f).map(|(u, f)| u * f).sum();
            assert!((0.5 * work - energy).abs() < 1e-13 * energy);
            for c in (0..3).filter(|c| !held[*c]) {
                assert!(f.iter().skip(c).step_by(3).all(|f| *f == 0.0));
            }
            let shift = [Vec3::new(1.0, -2.0, 3.0); NODES + 1];
            assert!(spring.evaluate(&shift, &mut f, None) < 1e-25);
        }
        let point = AnchorSpring::at_point(&anchor, [false, false, true], 7.0, 100.0).unwrap();
        // Of a mean: the normal part alone, and its rigid shift strains nothing either.
        let mean = AnchorSpring::on_mean(&[(&anchor, 7.0)]);
        assert_eq!(mean.nodes(), point.nodes());
        let mut k = vec![0.0; DOFS * DOFS];
        let energy = mean.evaluate(&u, &mut f, Some(&mut k));
        let jump: Vec3 = u.iter().zip(n).map(|(u, n)| u * n).sum::<Vec3>() - u[NODES];
        let along = jump.dot(&Vec3::new(0.6, 0.0, 0.8));
        assert!(energy > 0.01 && (energy - 0.5 * 7.0 * 0.3 * along * along).abs() < 1e-13 * energy);
        let flat: Vec<f64> = u.iter().flat_map(|u| u.iter().copied()).collect();
        for (row, f) in f.iter().enumerate() {
            let product: f64 = (0..DOFS).map(|c| k[DOFS * c + row] * flat[c]).sum();
            assert!((product - f).abs() < 1e-12 * energy, "{product} {f}");
        }
        assert!(mean.evaluate(&[Vec3::new(1.0, -2.0, 3.0); NODES + 1], &mut f, None) < 1e-25);
        // Along z alone: the compliances along the normal and across it, by its components.
        let exact = 0.3 / (0.64 / 7.0 + 0.36 / 100.0);
        let mut k = vec![0.0; DOFS * DOFS];
        point.evaluate(&u, &mut f, Some(&mut k));
        assert!((k[DOFS * DOFS - 1] - exact).abs() < 1e-12 * exact);
    }
}
