//! Seams: derivatives against dual numbers, rigid motions, balance, and patches whose knots do not match.
use super::seam::{SEAM_DOFS, SEAM_NODES};
use super::*;
use crate::mesh::nurbs::{Fineness, Joints};
use crate::mesh::{Border, Edge};
use crate::scene::{Elastic, Material};
use covact_geometry::NurbsPatch;
use nalgebra::{DMatrix, Rotation3, SymmetricEigen};
use num_dual::Dual64;

/// Values without a pattern between -1 and 1.
fn noise(k: usize) -> f64 {
    let x = (12.9898 * k as f64 + 4.1).sin() * 43758.5453;
    2.0 * (x - x.floor()) - 1.0
}

fn law() -> Law {
    Law::new(&Material::StVenantKirchhoff(Elastic::new(1000.0, 0.3))).unwrap()
}

/// A biquadratic patch over `xi1 in x`, `xi2 in [0, 1]` of a map, with inner knots.
fn patch(x: [f64; 2], inner: [&[f64]; 2], map: impl Fn(f64, f64) -> Vec3) -> NurbsPatch {
    let knots = || vec![0.0, 0.0, 0.0, 1.0, 1.0, 1.0];
    let points: Vec<Vec3> = (0..9)
        .map(|k| {
            let (s, t) = ((k % 3) as f64 / 2.0, (k / 3) as f64 / 2.0);
            map(x[0] + (x[1] - x[0]) * s, t)
        })
        .collect();
    let patch = NurbsPatch::new([2, 2], [knots(), knots()], [3, 3], &points, None).unwrap();
    let patch = patch.elevated(0, 1).unwrap().elevated(1, 1).unwrap();
    let patch = patch.insert_knots(0, inner[0]).unwrap();
    patch.insert_knots(1, inner[1]).unwrap()
}

fn joined(a: NurbsPatch, b: NurbsPatch) -> NurbsSheet {
    NurbsSheet::joined(&[(7, a), (8, b)], 0.05, Fineness::Elements([1, 1]), true).unwrap()
}

/// Two patches in a fold of 69 degrees along a curved edge, with knots that do not match; the second is turned round, so that its
/// normal points to the other side, and its xi2 runs against the first one's.
fn folded() -> [NurbsPatch; 2] {
    let edge = |t: f64| Vec3::new(0.2 * t * (1.0 - t), 1.3 * t, 0.1 * t * t);
    let (sin, cos) = 69f64.to_radians().sin_cos();
    let a = patch([0.0, 1.0], [&[0.6], &[0.3, 0.7]], |x, t| {
        edge(t) + Vec3::new(x - 1.0, 0.0, 0.1 * (x - 1.0) * (x - 1.0))
    });
    let b = patch([0.0, 1.2], [&[], &[0.45]], |x, t| {
        edge(t) + Vec3::new(cos * x, 0.05 * x * t, sin * x)
    });
    [a, b.reversed(1).unwrap()]
}

fn moved(size: f64) -> [V<f64>; SEAM_NODES] {
    std::array::from_fn(|a| std::array::from_fn(|c| size * noise(100 + 3 * a + c)))
}

/// The tangent of a seam is the derivative of its forces, and those the gradient of its energy, at large displacements, in a fold
/// and with normals of either sense; forces and moments of the rotation part balance.
#[test]
fn derivatives_against_dual_numbers() {
    let sheet = joined(folded()[0].clone(), folded()[1].clone());
    // Patches as they come, the second upside down.
    let mut raw = sheet.clone();
    assert!(sheet.patches[1].reversed);
    raw.patches[1].patch = sheet.patches[1].patch.reversed(0).unwrap();
    let fine: Vec<&NurbsPatch> = raw.patches.iter().map(|p| &p.patch).collect();
    raw.joints = Joints::new(&fine, 0.05);
    for sheet in [&sheet, &raw] {
        let mut spans = SeamSpan::all(sheet, &law()).unwrap();
        assert!(spans.len() >= 3, "{}", spans.len());
        // A normal that is not across the edge, as gaps have it, much exaggerated.
        spans[1].with_angle([0.48, -0.64, 0.6]);
        let u = moved(0.05);
        let vectors = u.map(Vec3::from);
        let mut k = vec![0.0; SEAM_DOFS * SEAM_DOFS];
        let mut f = [0.0; SEAM_DOFS];
        for seam in &spans {
            let energy = seam.evaluate(&vectors, &mut f, Some(&mut k));
            let norm = k.iter().map(|k| k * k).sum::<f64>().sqrt();
            let size = f.iter().map(|f| f * f).sum::<f64>().sqrt();
            assert!(
                norm > 10.0 && size > 1.0 && energy > 1e-3,
                "{norm} {size} {energy}"
            );
            for dof in 0..SEAM_DOFS {
                let dual: [V<Dual64>; SEAM_NODES] = std::array::from_fn(|a| {
                    std::array::from_fn(|c| {
                        Dual64::new(u[a][c], if 3 * a + c == dof { 1.0 } else { 0.0 })
                    })
                });
                let (energy, forces) = seam.forces(&dual);
                assert!((energy.eps - f[dof]).abs() < 1e-12 * size);
                for row in 0..SEAM_DOFS {
                    let [exact, k] = [forces[row / 3][row % 3].eps, k[SEAM_DOFS * dof + row]];
                    assert!((exact - k).abs() < 1e-12 * norm, "{dof} {row}: {exact} {k}");
                }
            }
        }
    }
}

/// Of displacements alone the forces of both sides are equal; the part that holds the angle balances in force and moment.
#[test]
fn the_angle_part_balances() {
    let [a, b] = folded();
    let sheet = joined(a, b);
    let positions = sheet.positions();
    let mut spans = SeamSpan::all(&sheet, &law()).unwrap();
    spans.iter_mut().for_each(SeamSpan::without_shift);
    let u = moved(0.05).map(Vec3::from);
    let mut f = [0.0; SEAM_DOFS];
    for seam in &spans {
        seam.evaluate(&u, &mut f, None);
        let forces: Vec<Vec3> = f.chunks_exact(3).map(Vec3::from_column_slice).collect();
        let size: f64 = forces.iter().map(|f| f.norm()).sum();
        assert!(size > 1e-2, "{size}");
        let total: Vec3 = forces.iter().sum();
        let moment: Vec3 = (seam.nodes.iter().zip(&u).zip(&forces))
            .map(|((n, u), f)| (positions[*n as usize] + u).cross(f))
            .sum();
        assert!(total.norm() < 1e-13 * size, "{total}");
        assert!(moment.norm() < 1e-13 * size, "{moment}");
    }
}

/// A rotation by 52 degrees and a shift strain no seam, also where the edges are apart by a gap as CAD files leave them.
#[test]
fn a_rotation_strains_no_seam() {
    let turn = Rotation3::new(Vec3::new(0.3, -0.7, 0.5).normalize() * 52f64.to_radians());
    let [a, b] = folded();
    let apart = b
        .transformed(&|x| x + Vec3::new(8e-6, -3e-6, 5e-6))
        .unwrap();
    // With a gap the displacements of a rotation differ by the turned gap.
    for (other, slack) in [(b, 1e-13), (apart, 1e-5)] {
        let sheet = joined(a.clone(), other);
        let positions = sheet.positions();
        let mut f = [0.0; SEAM_DOFS];
        let spans = SeamSpan::all(&sheet, &law()).unwrap();
        assert!(!spans.is_empty());
        for seam in &spans {
            let energy = seam.evaluate(&[Vec3::zeros(); SEAM_NODES], &mut f, None);
            assert_eq!(energy, 0.0);
            assert!(f.iter().all(|f| *f == 0.0), "{f:?}");
            let u = seam.nodes.map(|n| {
                let x = positions[n as usize];
                turn * x - x + Vec3::new(3.0, 1.0, -2.0)
            });
            let energy = seam.evaluate(&u, &mut f, None);
            let largest = f.iter().fold(0.0f64, |a, f| a.max(f.abs()));
            assert!(largest < slack * seam.stretching(), "{largest}");
            assert!(energy < slack * slack * seam.stretching(), "{energy}");
        }
    }
}

/// Stiffness of a whole sheet at rest, seams included.
fn stiffness(block: &NurbsBlock, nodes: usize) -> DMatrix<f64> {
    let mut k = DMatrix::zeros(3 * nodes, 3 * nodes);
    let mut system = NurbsSystem::default();
    let mut add = |nodes: &[u32], own: &[f64]| {
        let size = 3 * nodes.len();
        for column in 0..size {
            for row in 0..size {
                let at = |d: usize| 3 * nodes[d / 3] as usize + d % 3;
                k[(at(row), at(column))] += own[size * column + row];
            }
        }
    };
    for e in 0..block.elements() {
        block
            .evaluate(e, &[Vec3::zeros(); NODES], None, &mut system)
            .unwrap();
        add(&block.nodes_of(e), &system.k[..]);
    }
    let mut own = vec![0.0; SEAM_DOFS * SEAM_DOFS];
    for seam in block.seams() {
        let mut f = [0.0; SEAM_DOFS];
        seam.evaluate(&[Vec3::zeros(); SEAM_NODES], &mut f, Some(&mut own));
        add(&seam.nodes, &own);
    }
    k
}

/// Two joined patches move as one body: six motions cost nothing and no other does, flat and in a fold.
#[test]
fn six_rigid_motions_of_two_patches() {
    let flat = [0.0, 1.0].map(|x0| {
        let inner: [&[f64]; 2] = if x0 == 0.0 {
            [&[], &[0.5]]
        } else {
            [&[0.4], &[0.3, 0.7]]
        };
        patch([x0, x0 + 1.0], inner, |x, t| Vec3::new(x, t, 0.0))
    });
    for [a, b] in [flat, folded()] {
        let sheet = joined(a, b);
        let block = NurbsBlock::new(&sheet, law()).unwrap();
        let eigen = SymmetricEigen::new(stiffness(&block, sheet.nodes())).eigenvalues;
        let largest = eigen.amax();
        let mut values: Vec<f64> = eigen.iter().map(|v| v.abs() / largest).collect();
        values.sort_by(f64::total_cmp);
        assert!(values[5] < 1e-13, "{:?}", &values[..8]);
        assert!(values[6] > 1e-9, "{:?}", &values[..8]);
        // Without the seam there are twelve.
        let mut loose = sheet.clone();
        loose.joints.seams.clear();
        let block = NurbsBlock::new(&loose, law()).unwrap();
        let eigen = SymmetricEigen::new(stiffness(&block, sheet.nodes())).eigenvalues;
        let none = eigen.iter().filter(|v| v.abs() < 1e-13 * largest);
        assert_eq!(none.count(), 12);
    }
}

/// A flat sheet of two patches whose knots and nets do not match, evenly stretched and sheared: no force inside and none at the seam,
/// whose sides have the same displacements.
#[test]
fn patch_test_over_a_seam_that_does_not_match() {
    let bend = |x: f64, t: f64| {
        let bump = x * (2.0 - x);
        Vec3::new(x + 0.15 * t * (1.0 - t) * bump, t + 0.08 * bump * t, 0.0)
    };
    let sheet = joined(
        patch([0.0, 1.0], [&[0.5], &[0.4]], bend),
        patch([1.0, 2.0], [&[0.3], &[0.35, 0.75]], bend),
    );
    let block = NurbsBlock::new(&sheet, law()).unwrap();
    let positions = sheet.positions();
    let u: Vec<Vec3> = (positions.iter())
        .map(|x| 1e-3 * Vec3::new(2.0 * x.x + 0.7 * x.y, -0.4 * x.x + 1.1 * x.y, 0.0))
        .collect();
    // Forces of the elements and of the seam, and the control points that move elements but lie on no border.
    let mut inner = vec![Vec3::zeros(); sheet.nodes()];
    for e in 0..block.elements() {
        let nodes = block.nodes_of(e);
        let mut f = [0.0; DOFS];
        block
            .residual(e, &nodes.map(|n| u[n as usize]), &mut f)
            .unwrap();
        for (node, f) in nodes.iter().zip(f.chunks_exact(3)) {
            inner[*node as usize] += Vec3::from_column_slice(f);
        }
    }
    let largest = inner.iter().map(|f| f.norm()).fold(0.0, f64::max);
    assert!(largest > 1e-2);
    let rim: Vec<u32> = (0..2)
        .flat_map(Edge::of)
        .flat_map(|edge| sheet.row(edge, 0))
        .collect();
    for (n, f) in inner.iter().enumerate() {
        assert!(
            rim.contains(&(n as u32)) || f.norm() < 1e-12 * largest,
            "{n}: {}",
            f.norm() / largest
        );
    }
    for seam in block.seams() {
        let mut f = [0.0; SEAM_DOFS];
        let energy = seam.evaluate(&seam.nodes.map(|n| u[n as usize]), &mut f, None);
        assert!(f.iter().all(|f| f.abs() < 1e-9 * largest), "{f:?}");
        assert!(energy < 1e-20, "{energy}");
    }
    // The forces that both sides exert along the seam are the traction that goes through it: they cancel.
    let across = |border: Border| -> Vec3 {
        let Border::Edge(edge) = border else {
            panic!("{border:?} is no edge");
        };
        let row = sheet.row(edge, 0);
        row.iter().map(|n| inner[*n as usize]).sum()
    };
    let edges = sheet.joints.seams[0].edges.map(across);
    // Corners take forces of the borders beside as well, the same on both sides of a straight border.
    assert!(edges[0].norm() > 1e-2 * largest);
}

/// The edges that are one: matched by their shape, whatever their direction, with names of their own; a half of a long edge; three at
/// one edge; none where the gap is too large, which is told.
#[test]
fn seams_are_found_by_their_shape() {
    let flat = |x: [f64; 2], y: [f64; 2], z: f64| {
        patch(x, [&[], &[]], move |x, t| {
            Vec3::new(x, y[0] + (y[1] - y[0]) * t, z)
        })
    };
    let find = |patches: &[NurbsPatch]| {
        let all: Vec<&NurbsPatch> = patches.iter().collect();
        Joints::new(&all, 0.1)
    };
    // A row of two, and one along both: a T.
    let (a, b) = (
        flat([0.0, 1.0], [0.0, 1.0], 0.0),
        flat([1.0, 2.0], [0.0, 1.0], 0.0),
    );
    let long = flat([0.0, 2.5], [1.0, 2.0], 0.0);
    let joints = find(&[a.clone(), b.clone(), long]);
    assert_eq!(joints.seams.len(), 3);
    assert_eq!(joints.inner.len(), 4, "{:?}", joints.inner);
    assert_eq!(joints.partial, vec![Border::Edge(Edge::of(2)[2])]);
    let seam = joints
        .seams
        .iter()
        .find(|s| s.edges == [Edge::of(1)[3], Edge::of(2)[2]].map(Border::Edge));
    let seam = seam.expect("the second lies on the long one");
    assert!((seam.ranges[1][0] - 0.4).abs() < 1e-12 && (seam.ranges[1][1] - 0.8).abs() < 1e-12);
    // A web below the seam of both.
    let web = patch([0.0, 1.0], [&[], &[]], |x, t| Vec3::new(1.0, t, -x));
    let joints = find(&[a.clone(), b.clone(), web]);
    assert_eq!(joints.seams.len(), 3);
    assert_eq!(joints.turned(3), Ok(vec![false; 3]));
    // Gaps.
    for (gap, joined, told) in [(1e-5, 1, 0), (1e-2, 0, 2), (0.2, 0, 0)] {
        let other = flat([1.0 + gap, 2.0], [0.0, 1.0], 0.0);
        let joints = find(&[a.clone(), other]);
        assert_eq!(
            (joints.seams.len(), joints.near.len()),
            (joined, told.min(1)),
            "{gap}"
        );
    }
    // A rib on the inside, whose edge is near no other.
    let rib = patch([0.0, 1.0], [&[], &[]], |x, t| Vec3::new(0.4, t, x));
    let joints = find(&[a.clone(), rib]);
    assert_eq!(
        (joints.seams.len(), joints.inside),
        (0, vec![(Border::Edge(Edge::of(1)[0]), 0)])
    );
    // Turned over.
    let joints = find(&[a.clone(), b.reversed(0).unwrap()]);
    assert_eq!(joints.turned(2), Ok(vec![false, true]));
    let joints = find(&[a, b.reversed(1).unwrap().reversed(0).unwrap()]);
    assert!(joints.seams[0].opposed);
    assert_eq!(joints.turned(2), Ok(vec![false, false]));
}
